"""opacity: make the target see-through, or hide it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..base import TargetedOp


class Opacity(TargetedOp):
    """Make the target more transparent: `value` multiplies its opacity; 0.5 is half as opaque as now, 0 hides it."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the curtain half transparent",
        {"op": "opacity", "target": {"text": "curtain"}, "value": 0.5},
    )
    op: Literal["opacity"] = "opacity"
    value: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
