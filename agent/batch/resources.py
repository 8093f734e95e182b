"""What a job needs of the worker that does it: CPUs, GPUs, memory."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from ...gaussians.errors import UserError
from ...gaussians.tiles.budget import parse_memory

NAMES = {"num_cpus": "CPUs", "num_gpus": "GPUs", "memory": "bytes of memory"}


def _amount(text: str | None) -> str | None:
    try:
        if text is not None:
            parse_memory(text)
    except UserError as error:
        raise ValueError(str(error)) from error
    return text


class Resources(BaseModel):
    """What a job needs, as Ray counts it; what is not said is not asked for.

    Attributes:
        num_cpus, num_gpus: a GPU may be shared: 0.5.
        memory: such as "16GB".
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    num_cpus: Annotated[float | None, Field(gt=0, le=4096)] = None
    num_gpus: Annotated[float | None, Field(ge=0, le=4096)] = None
    memory: Annotated[str | None, AfterValidator(_amount)] = None

    def asked(self) -> dict[str, Any]:
        """As it was written."""
        return self.model_dump(exclude_none=True)

    def amounts(self) -> dict[str, float]:
        """As numbers; memory in bytes."""
        return {k: float(parse_memory(v)) if k == "memory" else float(v) for k, v in self.asked().items()}

    def lacking(self, there: Mapping[str, float]) -> str | None:
        """What a machine does not have of it, in words; None if it has all."""
        for name, wanted in self.amounts().items():
            if wanted > there.get(name, 0.0):
                return f"{wanted:,.10g} {NAMES[name]}, and there are {there.get(name, 0.0):,.10g}"
        return None


NOTHING = Resources()


def parse_needs(text: str) -> tuple[str, Resources]:
    """The verb and the resources of "fit:num_gpus=1,memory=16GB".

    Raises:
        UserError: it is not of this form.
    """
    verb, _, told = text.partition(":")
    try:
        return verb, Resources.model_validate(dict(part.split("=", 1) for part in told.split(",")))
    except ValueError as error:
        raise UserError(
            f"{text!r} is no need of a verb; write for example fit:num_gpus=1,num_cpus=4,memory=16GB"
        ) from error


def of_this_machine(gpus: bool) -> dict[str, float]:
    """What this machine has; its GPUs are counted if they matter, as that loads torch."""
    found = {"num_cpus": float(os.cpu_count() or 1)}
    found["memory"] = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    if gpus:
        import torch

        found["num_gpus"] = float(torch.cuda.device_count())
    return found
