"""delete: remove the target."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..base import TargetedOp


class Delete(TargetedOp):
    """Remove the target from the scene."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "remove the coffee table",
        {"op": "delete", "target": {"text": "coffee table"}},
    )
    op: Literal["delete"] = "delete"
