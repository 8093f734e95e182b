"""move: by a distance, toward something, or to a place."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

from pydantic import model_validator

from ...gaussians.language.query import Query
from ..base import Direction, Length, Placement, TargetedOp


class Move(TargetedOp):
    """Move the target: in a `direction`, `toward` something, or to a `place`; exactly one of the three.

    Directions are the viewer's: forward is away from the viewer, right is to the viewer's right. `distance` goes with
    `direction` or `toward`; without it the target moves by its own width, or until it stands next to what it goes to.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "move the lamp 40 cm to the left",
        {"op": "move", "target": {"text": "lamp"}, "direction": "left", "distance": {"value": 40, "unit": "cm"}},
    )
    op: Literal["move"] = "move"
    direction: Direction | None = None
    distance: Length | None = None
    place: Placement | None = None
    """Where to put it down: supported and free of collision."""
    toward: Query | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        said = [n for n in ("direction", "toward", "place") if getattr(self, n) is not None]
        if len(said) != 1:
            raise ValueError(f"move needs exactly one of direction, toward and place, got {said or 'none'}")
        if self.place is not None and self.distance is not None:
            raise ValueError("a distance goes with a direction or toward, not with a place")
        return self
