"""isolate: keep the target, remove everything else."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..base import TargetedOp


class Isolate(TargetedOp):
    """Keep only the target and remove everything else from the scene."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "isolate the guitar",
        {"op": "isolate", "target": {"text": "guitar"}},
    )
    op: Literal["isolate"] = "isolate"
