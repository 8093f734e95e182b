"""select: point at something without changing it."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..base import TargetedOp


class Select(TargetedOp):
    """Select things without changing the scene, so that the next instruction can say "it" or "them"."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "select all the chairs",
        {"op": "select", "target": {"text": "chair", "pick": "all"}},
    )
    op: Literal["select"] = "select"
