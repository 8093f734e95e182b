"""The brief of a room, as a planner proposes it: a kind of room, things, sizes and relations, without any positions.

This module defines the type, its bounds and the refusal of a brief; problems.py turns a brief into a layout problem.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ...gaussians.errors import InstructionError
from ...gaussians.world import relations
from ..layout.problem import Wall
from ..plan import Verdict

Word = Annotated[str, Field(min_length=1, max_length=60)]
Extent = Annotated[float, Field(ge=0.005, le=100, allow_inf_nan=False)]
Scale = Literal["tiny", "small", "normal", "large", "huge"]
_MOST = 200  # things of one brief; more are no room that anyone arranges


class RefusedError(InstructionError):
    """A text that is no room description. `verdict` and `unknown` are those of an `EditPlan`."""

    def __init__(self, message: str, verdict: Verdict, unknown: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.verdict = verdict
        self.unknown = unknown


class RoomSize(BaseModel):
    """What was said of the room's size, metres and square metres; None where nothing was."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    width: Extent | None = None
    depth: Extent | None = None
    height: Extent | None = None
    area: Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)] | None = None


class Thing(BaseModel):
    """Things of one kind that are wanted.

    Attributes:
        id: what wishes call them; its name unless the brief has the name twice.
        name: what they are, singular: "armchair".
        count: how many.
        color: colour word, "" if free.
        material: "wooden", "leather", "" if free.
        scale: size in words, against what is usual for the kind.
        width, depth, height: of each, metres, where stated.
        support: where that is said: "floor", "wall" or "ceiling"; None as is usual. On another thing is a wish "on".
        optional: a habit, not asked for: may be left out where there is no room.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: Word
    name: Word
    count: Annotated[int, Field(ge=1, le=60)] = 1
    color: Annotated[str, Field(max_length=40)] = ""
    material: Annotated[str, Field(max_length=40)] = ""
    scale: Scale = "normal"
    width: Extent | None = None
    depth: Extent | None = None
    height: Extent | None = None
    support: Literal["floor", "wall", "ceiling"] | None = None
    optional: bool = False


class Relation(BaseModel):
    """A relation between things by their ids: "subject name objects".

    Several subjects share several objects out evenly: four chairs around two tables are two at each. `hard`: it was
    said; otherwise a habit. `wall` as in `Wish`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    subject: Word
    name: relations.WishName
    objects: Annotated[tuple[Word, ...], Field(max_length=2)] = ()
    wall: Wall | None = None
    hard: bool = True


class Brief(BaseModel):
    """A room to be built.

    Attributes:
        kind: of room: "bedroom", "coffee shop"; "room" if nothing is known.
        styles: words of style: "cozy", "industrial".
        size: what was said of its size; None leaves it to what it has to hold.
        scale: its size in words.
        things: what is wanted in it; doors and windows too, where they were spoken of.
        relations: what is wanted of them.
        without: names of things that must not be there.
        seats: how many people are to be seated.
        habits: whether what such rooms usually hold is added; not for "an empty room with one chair".
        features: of the room itself: "exposed beams", "brick wall", "white walls".
        remarks: what was understood and cannot be shown, or was read otherwise than written; a sentence each.
        unknown: words that were not understood.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Word = "room"
    styles: Annotated[tuple[Word, ...], Field(max_length=8)] = ()
    size: RoomSize | None = None
    scale: Scale = "normal"
    things: Annotated[tuple[Thing, ...], Field(max_length=64)] = ()
    relations: Annotated[tuple[Relation, ...], Field(max_length=256)] = ()
    without: Annotated[tuple[Word, ...], Field(max_length=32)] = ()
    seats: Annotated[int, Field(ge=1, le=100)] | None = None
    habits: bool = True
    features: Annotated[tuple[Word, ...], Field(max_length=16)] = ()
    remarks: Annotated[tuple[Annotated[str, Field(max_length=300)], ...], Field(max_length=64)] = ()
    unknown: Annotated[tuple[Word, ...], Field(max_length=64)] = ()

    @model_validator(mode="after")
    def _closed(self) -> Self:
        known = {t.id for t in self.things}
        if len(known) != len(self.things):
            raise ValueError("two things have the same id")
        if sum(t.count for t in self.things) > _MOST:
            raise ValueError(f"these are {sum(t.count for t in self.things)} things, at most {_MOST} are arranged")
        for r in self.relations:
            if missing := {r.subject, *r.objects} - known:
                raise ValueError(f"a relation names {sorted(missing)}, which is no id of a thing")
            kind = relations.named(r.name)
            if not min(kind.anchors, 1) <= len(r.objects) <= kind.anchors:  # "between the tables" names one group
                raise ValueError(f"{r.name} takes another number of objects than {len(r.objects)}")
            if r.wall and not kind.at_wall:
                raise ValueError(f"{r.name} is about no wall, got {r.wall}")
        return self

    def thing(self, id: str) -> Thing:
        """The thing with this id, which relations of a valid brief always name."""
        return next(t for t in self.things if t.id == id)
