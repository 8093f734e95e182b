"""scale: make the target larger or smaller."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..base import TargetedOp


class Scale(TargetedOp):
    """Make the target larger (factor above 1) or smaller; it stays on its support and on its spot.

    `axis` stretches one dimension only: its width and depth are those of its own box, width the one that runs more
    across the viewer's sight.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the plant twice as tall",
        {"op": "scale", "target": {"text": "potted plant"}, "factor": 2, "axis": "height"},
    )
    op: Literal["scale"] = "scale"
    factor: Annotated[float, Field(ge=0.01, le=100, allow_inf_nan=False)]
    axis: Literal["all", "width", "depth", "height"] = "all"
