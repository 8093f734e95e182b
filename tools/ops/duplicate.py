"""duplicate: more of the same."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from ..base import Direction, Length, Placement, TargetedOp


class Duplicate(TargetedOp):
    """Copy the target `count` times: in a row along `direction`, or to a `place`, or else to free spots beside it.

    `distance` is the step from one copy to the next and goes with `direction`; without it copies stand side by side.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "put another two chairs like this one to the right",
        {"op": "duplicate", "target": {"text": "chair"}, "count": 2, "direction": "right"},
    )
    op: Literal["duplicate"] = "duplicate"
    count: Annotated[int, Field(ge=1, le=50)] = 1
    direction: Direction | None = None
    distance: Length | None = None
    place: Placement | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.place is not None and self.direction is not None:
            raise ValueError("duplicate takes a direction or a place, not both")
        if self.distance is not None and self.direction is None:
            raise ValueError("a distance needs the direction it goes in")
        return self
