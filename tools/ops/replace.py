"""replace: another object where the target stands."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..base import AssetName, ColorName, TargetedOp


class Replace(TargetedOp):
    """Take the target away and put a new object of another kind in its place."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "replace the stool with a green armchair",
        {"op": "replace", "target": {"text": "stool"}, "asset": "armchair", "color": "green"},
    )
    op: Literal["replace"] = "replace"
    asset: AssetName
    """Kind of the new object, singular."""
    color: ColorName | None = None
