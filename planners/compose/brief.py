"""The brief of a room: a kind of room, things, sizes and relations, without positions.

A planner proposes it, and `problems` turns it into a layout problem. This module defines the type, its limits and the
error for a text without a brief.
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
Form = Literal["row", "grid", "circle", "back_to_back"]
_MOST = 200  # most things of one brief


class RefusedError(InstructionError):
    """The text is no room description. `verdict` and `unknown` are those of an `EditPlan`."""

    def __init__(self, message: str, verdict: Verdict, unknown: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.verdict = verdict
        self.unknown = unknown


class RoomSize(BaseModel):
    """The stated size of the room, metres and square metres; None for what was not stated."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    width: Extent | None = None
    depth: Extent | None = None
    height: Extent | None = None
    area: Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)] | None = None


class Arrangement(BaseModel):
    """How things of one kind stand together: in one row, in several rows one behind the other, in a circle, or in two
    rows back to back.

    Attributes:
        form: "row", "grid" (several rows), "circle" or "back_to_back".
        rows, columns: how many a grid has; None: as the number of things suggests.
        gap: metres between neighbours, where stated.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    form: Form
    rows: Annotated[int, Field(ge=1, le=60)] | None = None
    columns: Annotated[int, Field(ge=1, le=60)] | None = None
    gap: Annotated[float, Field(ge=0, le=20, allow_inf_nan=False)] | None = None


class Thing(BaseModel):
    """Things of one kind that are wanted.

    Attributes:
        id: by which relations name them; the name, unless the brief has the name twice.
        name: what they are, singular: "armchair".
        count: how many.
        color: colour word, "" if not stated.
        material: "wooden", "leather", "" if not stated.
        scale: size in words, relative to the usual size of the kind.
        width, depth, height: of each, metres, where stated.
        support: "floor", "wall" or "ceiling" where stated, None for the usual one; on another thing is a relation "on".
        optional: whether it was not asked for and may be left out where it does not fit.
        arrangement: how several of them stand together, where stated.
        called: the noun that was said, where `name` is another word for it.
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
    arrangement: Arrangement | None = None
    called: Annotated[str, Field(max_length=60)] = ""


class Relation(BaseModel):
    """A relation between things by their ids: "subject name objects".

    Several subjects are distributed evenly over several objects: of four chairs around two tables, two are at each.
    `hard`: it was stated; otherwise it is a habit. `wall` as in `Wish`. `distance`: metres between the two, where
    stated. `sides`: the subjects are shared out over two opposite sides of the object, or over opposite walls.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    subject: Word
    name: relations.WishName
    objects: Annotated[tuple[Word, ...], Field(max_length=2)] = ()
    wall: Wall | None = None
    hard: bool = True
    distance: Annotated[float, Field(ge=0, le=50, allow_inf_nan=False)] | None = None
    sides: bool = False


class Brief(BaseModel):
    """A room to be built.

    Attributes:
        kind: of room: "bedroom", "coffee shop"; "room" if none is stated.
        styles: words of style: "cozy", "industrial".
        size: the stated size; None: it follows from what the room has to hold.
        scale: its size in words.
        things: what is wanted in it, doors and windows included where they were mentioned.
        relations: wanted between them.
        without: names of things that must not be there.
        seats: how many people are to be seated.
        habits: whether usual things of the kind of room are added; not for "an empty room with one chair".
        features: of the room itself: "exposed beams", "brick wall", "white walls".
        remarks: what was understood and cannot be shown, or was read differently from the text; a sentence each.
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
            raise ValueError(f"a brief has at most {_MOST} things, got {sum(t.count for t in self.things)}")
        for r in self.relations:
            if missing := {r.subject, *r.objects} - known:
                raise ValueError(f"a relation names {sorted(missing)}, but no thing has such an id")
            kind = relations.named(r.name)
            if not min(kind.anchors, 1) <= len(r.objects) <= kind.anchors:  # "between the tables" names one group
                raise ValueError(f"{r.name} takes {kind.anchors} objects, got {len(r.objects)}")
            if r.wall and not kind.at_wall:
                raise ValueError(f"{r.name} takes no wall, got {r.wall}")
        return self

    def thing(self, id: str) -> Thing:
        """The thing with this id, which relations of a valid brief always name."""
        return next(t for t in self.things if t.id == id)
