"""recolor: a new colour that keeps shading and texture."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from ..base import ColorName, TargetedOp

Adjust = Literal["darker", "lighter", "more_saturated", "less_saturated", "warmer", "cooler", "toward"]


class Recolor(TargetedOp):
    """Change the target's colour, keeping its shading and texture.

    Give either `color` alone ("make it teal"), or `adjust` with `amount` ("a bit darker": amount 0.25, "much darker":
    0.8). `adjust` "toward" also needs `color` ("a bit more blue": toward, blue, 0.25).
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the armchair teal",
        {"op": "recolor", "target": {"text": "armchair"}, "color": "teal"},
    )
    op: Literal["recolor"] = "recolor"
    color: ColorName | None = None
    """A CSS or everyday colour name ("teal", "dark green") or #rrggbb."""
    adjust: Adjust | None = None
    """A change relative to the colour it has."""
    amount: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.5
    """How far to adjust, 0 to 1; has no effect with `color` alone."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.adjust is None and self.color is None:
            raise ValueError("recolor needs a color or an adjust")
        if self.adjust == "toward" and self.color is None:
            raise ValueError('adjust "toward" needs the color to go toward')
        if self.adjust not in (None, "toward") and self.color is not None:
            raise ValueError(f'give either a color or adjust "{self.adjust}", not both')
        return self
