"""`Query`: the meaning of a noun phrase as data, independent of the sentence and of the scene.

Text similarity, measured attributes and geometry stay separate terms: a colour word never goes to the text encoder,
and negation is a set difference, because encoders are near bag-of-words on both (see FIELD figures in docs).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from ...world.lengths import Unit
from ...world.relations import QueryName, named

Name = Annotated[str, Field(max_length=80)]
Picks = Literal[
    "one", "all", "any", "largest", "smallest", "tallest", "shortest", "nearest", "farthest", "leftmost", "rightmost",
    "highest", "lowest", "middle", "nth", "rest", "front left", "front right", "back left", "back right",
]  # fmt: skip
CORNERS = ("front left", "front right", "back left", "back right")  # of the room, as the viewer sees it
ALL = frozenset({"everything", "all", "scene", "room", "whole scene"})  # nouns that mean every Gaussian
BACKGROUND = frozenset({"background", "backdrop", "surroundings", "surrounding", "environment"})
FLOATERS = frozenset({"floater", "noise", "floating bit", "stray", "haze", "speck"})
WEAKEST, STRONGEST = 0.1, 4.0  # strength with which floaters are looked for
Sizes = Literal["small", "large", "tall", "short", "wide", "narrow"]


class Relation(BaseModel):
    """A relation of what is sought to one or two anchors, in a named frame of reference.

    `frame="viewer"`: left, right, in front and behind as the current camera sees them; `"object"`: along the anchor's
    own axes, its front being the side it faces.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    name: QueryName
    anchors: Annotated[tuple[Query, ...], Field(min_length=1, max_length=2)]
    frame: Literal["viewer", "object"] = "viewer"

    def describe(self) -> str:
        """ "left of the sofa"."""
        return named(self.name).told(*(a.describe() for a in self.anchors))


class Region(BaseModel):
    """A part of space: over or below the floor or things, at a side of them, or near. "around" alone is a crop."""

    # Sides are the viewer's, and begin at the side of the things' box; without things, in the middle of the scene. A
    # `distance` makes an exact border, which cuts things; without one they are in or out as a whole.

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    name: Literal["above", "below", "left_of", "right_of", "in_front_of", "behind", "within", "around"]
    of: Annotated[tuple[Query, ...], Field(max_length=4)] = ()
    distance: Annotated[float, Field(ge=0, le=10_000, allow_inf_nan=False)] | None = None
    unit: Unit = "m"
    outside: bool = False

    def describe(self) -> str:
        """ "more than 1 m above the floor"."""
        far = "" if self.distance is None else f"{self.distance:g} {self.unit} "
        floor = "the floor" if self.name in ("above", "below") else "the middle of the scene"
        things = " and ".join(q.describe() for q in self.of) or floor
        if self.name == "within":
            return f"{'more than' if self.outside else 'within'} {far}{'from' if self.outside else 'of'} {things}"
        words = {"left_of": "left of", "right_of": "right of", "in_front_of": "in front of"}.get(self.name, self.name)
        lead = "more than " if far and self.name != "around" else ""
        lead = "" if far and self.name in ("above", "below") and not self.of else lead
        said = f"{lead}{far}{words} {things}"
        if far and self.name in ("above", "below") and not self.of:
            said = f"{words} {far}over {things}"
        return f"not {said}" if self.outside else said


class Query(BaseModel):
    """What to select.

    Attributes:
        text: the noun alone, singular ("coffee table"); "" means anything.
        colors: colour words that must hold as measured ("dark green"); every one of them.
        not_colors: colour words that must not hold.
        size: among those that otherwise match.
        relations: all must hold.
        region: only what lies in this part of space.
        moving: only what moves at some time, or only what never does.
        pick: of several matches. "one" demands exactly one; "any" takes the best; superlatives and "nth" (with
            `ordinal`) order them; "rest" takes everything but the matches.
        ordinal: from 1, left to right as the viewer sees them; negative: right to left. Of what is `moving`, in the
            order in which things begin to move.
        count: how many are meant ("two chairs", "the two tallest").
        exclude: set difference ("all chairs but the green one"); with pick "one" taken first ("the other chair").
        also: set union ("the chairs and the lamp").
        last: the selection of the instruction before ("it", "them").
        grow: metres by which the selection reaches out, or if negative draws back.
        invert: everything but what was found; after growing.
        groups: ids of groups that are shown; they override `text` and `pick`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    text: Name = ""
    colors: Annotated[tuple[Name, ...], Field(max_length=4)] = ()
    not_colors: Annotated[tuple[Name, ...], Field(max_length=4)] = ()
    size: Sizes | None = None
    relations: Annotated[tuple[Relation, ...], Field(max_length=4)] = ()
    region: Region | None = None
    moving: bool | None = None
    pick: Picks = "one"
    ordinal: Annotated[int, Field(ge=1, le=1000)] | Annotated[int, Field(ge=-1000, le=-1)] | None = None
    count: Annotated[int, Field(ge=1, le=1000)] | None = None
    exclude: Annotated[tuple[Query, ...], Field(max_length=4)] = ()
    also: Annotated[tuple[Query, ...], Field(max_length=8)] = ()
    last: bool = False
    grow: Annotated[float, Field(ge=-100, le=100, allow_inf_nan=False)] | None = None
    invert: bool = False
    groups: Annotated[tuple[Annotated[int, Field(ge=0, le=10**9)], ...], Field(max_length=256)] = ()
    # The user confirmed what is chosen, so that a selection that would be unconfirmed is found. Only the answer to that
    # question sets it, no planner (`nested.without_confirmation`): so it is in no schema, nor in the text above.
    confirmed: SkipJsonSchema[bool] = False
    # Of floaters: how readily a Gaussian counts as one; at 2 about twice as many do. Words about an edit that
    # was made set it ("more", "a bit less"), no planner.
    strength: SkipJsonSchema[Annotated[float, Field(ge=WEAKEST, le=STRONGEST)]] = 1.0

    @property
    def spatial(self) -> bool:
        """Whether it means a part of the scene, with what belongs to no thing, rather than things by their names."""
        return self.invert or self.pick == "rest" or self.text in ALL | BACKGROUND | FLOATERS

    def describe(self) -> str:
        """The query in words, for messages: "the red chair left of the sofa"."""
        said = "it" if self.last else self._own_words()
        for q in self.exclude:
            said += f" but not {q.describe()}"
        for q in self.also:
            said += f" and {q.describe()}"
        if self.grow:
            said += f" {'grown' if self.grow > 0 else 'shrunk'} by {abs(self.grow):g} m"
        return f"everything but {said}" if self.invert else said

    def _own_words(self) -> str:
        """The query in words without its set algebra."""
        said = " ".join([*([self.size] if self.size else []), *self.colors, self.text or "thing"])
        if self.pick not in ("one", "all", "any", "nth", "rest"):
            said = f"{self.pick} {said}"
        if self.pick == "nth" and self.ordinal:
            said = f"{said} number {self.ordinal}"
        if not (self.text == "everything" and said == self.text):
            said = f"{ {'all': 'every', 'any': 'any', 'rest': 'everything but the'}.get(self.pick, 'the') } {said}"
        if self.not_colors:
            said += f" that is not {' or '.join(self.not_colors)}"
        for r in self.relations:
            said += f" {r.describe()}"
        if self.region is not None:
            said += f" {self.region.describe()}"
        if self.moving is not None:
            said += " that moves" if self.moving else " that stands still"
        return said


Relation.model_rebuild()
Region.model_rebuild()
