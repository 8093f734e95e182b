"""insert: a new object from the asset library."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..base import AssetName, ColorName, EditOp, Length, Placement


class Insert(EditOp):
    """Add new objects of a kind from the asset library, standing at `place` (or on a free spot of the floor)."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "put a red vase on the coffee table",
        {
            "op": "insert", "asset": "vase", "color": "red",
            "place": {"relation": "on", "anchors": [{"text": "coffee table"}]},
        },
    )  # fmt: skip
    op: Literal["insert"] = "insert"
    asset: AssetName
    """Kind of object, singular: "armchair", "floor lamp"."""
    count: Annotated[int, Field(ge=1, le=50)] = 1
    color: ColorName | None = None
    height: Length | None = None
    """How tall it is to be; otherwise as tall as such things are."""
    place: Placement | None = None
