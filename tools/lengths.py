"""A length with its unit, as operations and times have it."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from ..gaussians.scene import Frame
from ..gaussians.world.lengths import Unit, in_metres


class Length(BaseModel):
    """A length with its unit. "units" are the scene's own units; the others are converted by the scene's scale."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    value: Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)]
    unit: Unit = "m"

    def in_units(self, frame: Frame) -> float:
        """This length in scene units; one unit counts as one metre where the scale is unknown (see `assumption`)."""
        if self.unit == "units":
            return self.value
        return in_metres(self.value, self.unit) / (frame.metres_per_unit or 1.0)

    def times(self, factor: float) -> Length:
        """This length `factor` times, at most the longest that there is."""
        return Length(value=min(self.value * factor, 10_000.0), unit=self.unit)

    def assumption(self, frame: Frame) -> tuple[str, ...]:
        """The assumptions that converting it took, as notes for the receipt; empty if there were none."""
        if self.unit == "units" or frame.metres_per_unit is not None:
            return ()
        return (f"the scene's scale is unknown: {self.describe()} was read with one scene unit as one metre",)

    def describe(self) -> str:
        """ "40 cm"."""
        return f"{self.value:g} {self.unit}"
