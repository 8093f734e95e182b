"""rotate: turn the target on the spot."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..base import TargetedOp


class Rotate(TargetedOp):
    """Turn the target about its own centre; each of several things turns about its own.

    Positive degrees are counter-clockwise seen from the tip of the axis: about "up", seen from above. "right" and
    "forward" are the viewer's level axes (to tilt or topple); the thing stays at the height of its support.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "turn the chair 90 degrees clockwise",
        {"op": "rotate", "target": {"text": "chair"}, "degrees": -90},
    )
    op: Literal["rotate"] = "rotate"
    degrees: Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]
    axis: Literal["up", "right", "forward"] = "up"
