"""The table of spatial relations: name, phrases, permitted uses and scoring function of each.

Queries, placements, layout wishes and stated relations of a scene graph take names from here; the grammar and the
reader of room descriptions take phrases, and messages take sentences. The geometry is in `relation_geometry`.
To add a relation, add an entry to `KINDS` and, where none fits, a scoring function.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ..language.field.language_field import Group
from . import relation_geometry as geometry
from .box import Boxes
from .relation_geometry import F64, Score, Stand, Things

Use = Literal["query", "placement", "wish", "stated"]
Region = Literal["top", "inside", "under", "between", "beside", "across"]


@dataclass(frozen=True)
class Phrases:
    """Phrases for a relation, separated by commas.

    Attributes:
        shared: used in commands and in descriptions of rooms.
        commands, descriptions: used only there.
        reversed: in descriptions, with subject and object exchanged: "a table surrounded by chairs".
    """

    shared: str = ""
    commands: str = ""
    descriptions: str = ""
    reversed: str = ""

    def in_commands(self) -> Iterator[str]:
        """Phrases that a command may use."""
        yield from _listed(self.shared, self.commands)

    def in_descriptions(self) -> Iterator[str]:
        """Phrases that a description may use, subject first."""
        yield from _listed(self.shared, self.descriptions)

    def in_reverse(self) -> Iterator[str]:
        """Phrases that a description may use, object first."""
        yield from _listed(self.reversed)


@dataclass(frozen=True)
class RelationKind:
    """One relation.

    Attributes:
        name: as in JSON.
        uses: where it may be used, separated by spaces: "query", "placement", "wish", "stated" (in a scene graph).
        words: "left of {}"; with two anchors "{}" stands for both, joined by "and".
        score: scoring function; None where boxes alone do not decide it (an order, a wall of the room).
        anchors: number of anchors: 0, 1 or 2.
        default: anchor of a placement that names none ("on" alone is on the floor); "": it needs one.
        phrases: said before an anchor.
        alone: said without an anchor: "in the corner".
        aliases: further names in scene graphs.
        inverse: the relation of the anchor to the subject, if there is one.
        sentence: predicate in a sentence about the subject, if not "is" and `words`.
        at_wall: the predicate with a named wall, for wishes that may name one.
        aim: the side, (to the right, behind), for relations that depend on a frame of reference.
        region: where a placement looks for a place; "beside" at a distance of `gap`.
        gap: metres between the two, for a placement.
        query_as, placement_as: the relation that replaces it in a query or placement, where it has no such use.
        own_frame: whether a query uses the anchor's own frame.
        enters: where its subject may enter the clear floor of the anchor: nowhere, at its sides, or in front of it too
            ("a stool at a piano").
        orders: whether it orders the candidates instead of being true or false.
    """

    name: str
    uses: str
    words: str
    score: Score | None = None
    anchors: int = 1
    default: str = ""
    phrases: Phrases = Phrases()
    alone: Phrases = Phrases()
    aliases: tuple[str, ...] = ()
    inverse: str = ""
    sentence: str = ""
    at_wall: str = ""
    aim: tuple[float, float] | None = None
    region: Region = "beside"
    gap: float = 0.03
    query_as: str = ""
    placement_as: str = ""
    own_frame: bool = False
    enters: Literal["no", "beside", "before"] = "no"
    orders: bool = False

    def used(self, use: Use) -> bool:
        """Whether it has this use."""
        return use in self.uses.split()

    def told(self, *anchors: str) -> str:
        """In words: "left of the sofa", "between the two chairs"."""
        return self.words.partition("{}")[0] + " and ".join(anchors) if self.anchors else self.words

    def says(self, *anchors: str) -> str:
        """As a predicate: "is left of the sofa", "faces the sofa"."""
        return self.sentence.format(*anchors) if self.sentence else f"is {self.told(*anchors)}"


def _listed(*phrases: str) -> Iterator[str]:
    yield from (p.strip() for listed in phrases for p in listed.split(",") if p.strip())


def _side(name: str, words: str, aim: tuple[float, float], inverse: str, **more: object) -> RelationKind:
    """The relation of being at a side of the anchor in a frame of reference."""
    uses = "query placement wish stated"
    made: RelationKind = RelationKind(
        name, uses, words, geometry.toward(aim), aim=aim, inverse=inverse, **more  # type: ignore[arg-type]
    )  # fmt: skip
    return made


KINDS: tuple[RelationKind, ...] = (
    _side(
        "left_of", "left of {}", (-1.0, 0.0), "right_of",
        phrases=Phrases("to the left of, left of, on the left of, at the left of, to the left side of, on the left "
                        "side of, to the left hand side of, on the left hand side of"),
        aliases=("left", "to_the_left_of"),
    ),
    _side(
        "right_of", "right of {}", (1.0, 0.0), "left_of",
        phrases=Phrases("to the right of, right of, on the right of, at the right of, to the right side of, on the "
                        "right side of, to the right hand side of, on the right hand side of"),
        aliases=("right", "to_the_right_of"),
    ),
    _side(
        "in_front_of", "in front of {}", (0.0, -1.0), "behind",
        phrases=Phrases("in front of, to the front of, at the front of", descriptions="at the foot of, before"),
        aliases=("front",), enters="before",
    ),
    _side(
        "behind", "behind {}", (0.0, 1.0), "in_front_of",
        phrases=Phrases("behind, in back of, at the back of, to the back of, in the back of"),
    ),
    RelationKind(
        "on", "query placement wish stated", "on {}", geometry.resting, default="the floor", region="top",
        enters="before",
        phrases=Phrases("on, on top of, onto, on to, upon, atop, on the top of, to the top of",
                        reversed="topped with, topped by, holding, carrying, stocked with, laden with, covered with"),
        aliases=("on_top_of", "upon"),
    ),
    RelationKind(
        "under", "query placement wish stated", "under {}", geometry.beneath, region="under", enters="before",
        phrases=Phrases("under, underneath, beneath"), aliases=("beneath", "underneath"),
    ),
    RelationKind(
        "above", "query placement wish stated", "above {}", geometry.over, enters="before",
        phrases=Phrases("above, over", descriptions="hanging over, hung over, hanging above, mounted above, hung "
                        "above, up above"),
        aliases=("over",),
    ),
    RelationKind(
        "below", "query wish stated", "below {}", geometry.beneath, placement_as="under", enters="before",
        phrases=Phrases("below, below the level of"),
    ),
    RelationKind(
        "inside", "query placement wish stated", "inside {}", geometry.within, region="inside", enters="before",
        phrases=Phrases("inside, in, into, within, inside of"), aliases=("in", "within"),
    ),
    RelationKind(
        "next_to", "query placement wish stated", "next to {}", geometry.near, inverse="next_to", enters="beside",
        phrases=Phrases(
            "next to, beside, by, near, near to, close to, alongside, adjacent to, at, at the side of, to the side of, "
            "by the side of, right next to, right by, close by, right beside, surrounding, around by, in the vicinity "
            "of, not far from, next",
            descriptions="nearby, on each side of, on both sides of, on either side of, at each side of, along with "
            "the, on one side of, beside the, next the",
            reversed="flanked by, framed by, bordered by",
        ),
        aliases=("near", "beside", "by", "adjacent_to", "close_to"),
    ),
    RelationKind(
        "diagonally_opposite", "query placement wish stated", "diagonally opposite {}", geometry.across,
        region="across",
        phrases=Phrases("diagonally opposite, diagonally opposite to, diagonally opposite from, diagonally across "
                        "from, diagonally across the room from"),
        aliases=("diagonally_across_from",),
    ),
    RelationKind(
        "between", "query placement wish", "between {}", geometry.between, anchors=2, region="between",
        phrases=Phrases("between, in between"), enters="before",
    ),
    RelationKind("nearest_to", "query", "nearest to {}", placement_as="next_to", orders=True,
                 phrases=Phrases(commands="nearest, nearest to, closest to, closest, nearest from")),
    RelationKind("farthest_from", "query", "farthest from {}", orders=True,
                 phrases=Phrases(commands="farthest from, furthest from, farthest away from, furthest away from")),
    RelationKind("part_of", "query", "part of {}"),
    # For placements only.
    RelationKind(
        "opposite", "placement", "opposite {}", aim=(0.0, -1.0), own_frame=True, gap=1.2, query_as="in_front_of",
        phrases=Phrases(commands="opposite, opposite to, opposite of, across from, directly across from, across the "
                        "room from"),
    ),
    RelationKind(
        "against", "placement", "against {}", default="a wall", gap=0.0, query_as="next_to",
        phrases=Phrases("against, up against, along, flush against",
                        descriptions="leaning against, lining, pushed against, leaning on"),
    ),
    RelationKind(
        "center", "placement", "in the middle of {}", default="the room", region="top",
        phrases=Phrases(commands="in the middle of, in the center of, in the centre of, to the middle of, to the "
                        "center of, to the centre of, at the center of, at the centre of"),
        alone=Phrases(
            "in the middle, in the center, in the centre, in the middle of the room, in the center of the room, in the "
            "centre of the room, at the center of the room, at the centre of the room",
            commands="to the center, to the centre, to the middle, at the middle of the room, to the middle of the "
            "room, to the center of the room, to the centre of the room, into the middle, into the middle of the room, "
            "into the center of the room, into the centre of the room",
            descriptions="centered, centred, centered in the room, centred in the room, centrally, at the center, at "
            "the centre, in its center",
        ),
    ),
    RelationKind(
        "corner", "placement", "in a corner of {}", default="the room", region="top",
        alone=Phrases(
            "in the corner, in the corner of the room, in a corner, in one corner",
            commands="to the corner, into the corner, to the corner of the room, into a corner, into the corner of the "
            "room, to a corner",
            descriptions="in the corners, in each corner, in every corner, at the corners, in all corners, in a corner "
            "of the room, in the corners of the room, in the other corner, in another corner, at the corners of the "
            "room, in opposite corners, in the far corner, in two corners",
        ),
    ),
    # For layouts.
    RelationKind(
        "facing", "wish stated", "facing {}", geometry.facing, sentence="faces {}", aliases=("faces",), enters="beside",
        phrases=Phrases(descriptions="facing, turned to, turned toward, turned towards, facing toward, facing towards, "
                        "looking at, opposite, opposite to, across from, looking out of, looking out, overlooking, "
                        "that faces, which faces"),
        alone=Phrases(descriptions="facing each other, opposite each other, facing one another, face to face, across "
                      "from each other"),
    ),
    RelationKind(
        "around", "wish", "around {}", sentence="stands around {}", enters="before",
        phrases=Phrases(descriptions="around, all around, gathered around, arranged around, set around",
                        reversed="surrounded by, ringed by, encircled by"),
    ),
    RelationKind("against_wall", "wish", "against a wall", anchors=0, at_wall="is against the {} wall"),
    RelationKind("in_corner", "wish", "in a corner", anchors=0, at_wall="is in a corner at the {} wall"),
    RelationKind("in_center", "wish", "in the middle of the room", anchors=0),
    RelationKind("at_window", "wish", "at a window", anchors=0, at_wall="is at a window in the {} wall"),
    RelationKind("far_from", "wish", "far from {}",
                 phrases=Phrases(descriptions="far from, away from, far away from")),
    RelationKind(
        "aligned_with", "wish", "in line with {}",
        phrases=Phrases(descriptions="aligned with, in line with, parallel to, lined up with"),
        alone=Phrases(descriptions="in a row, in rows, lined up, in a line, in two rows, side by side, next to each "
                      "other, in three rows, aligned, beside each other, parallel to each other"),
    ),
)  # fmt: skip

_BY_NAME = {kind.name: kind for kind in KINDS}
_BY_ALIAS = {alias: kind for kind in KINDS for alias in kind.aliases}


def named(name: str) -> RelationKind:
    """The relation with this name, as in JSON.

    Raises:
        ValueError: there is none.
    """
    if name not in _BY_NAME:
        raise ValueError(f"unknown relation {name}")
    return _BY_NAME[name]


def stated(said: str) -> RelationKind | None:
    """The relation that a scene graph states, in any spelling ("to the left of"); None if it cannot be checked."""
    name = said.strip().lower().replace(" ", "_")
    kind = _BY_NAME.get(name) or _BY_ALIAS.get(name)
    return kind if kind is not None and kind.used("stated") else None


def names(use: Use) -> tuple[str, ...]:
    """Names of the relations with this use, in the order of the table."""
    return tuple(kind.name for kind in KINDS if kind.used(use))


def placed_as(name: str) -> str:
    """The placement that a relation means, "" if there is none."""
    kind = named(name)
    return kind.name if kind.used("placement") else kind.placement_as


if TYPE_CHECKING:
    QueryName = str
    PlacementName = str
    WishName = str
else:  # enumerations for pydantic; a type checker cannot evaluate them
    QueryName = Literal[names("query")]
    PlacementName = Literal[names("placement")]
    WishName = Literal[names("wish")]


def score(name: str, candidate: Group, anchors: Sequence[Group], stand: Stand) -> float:
    """How well one `candidate` fulfils relation `name` to the anchors; see `scores`."""
    flat = candidate.level == "structure"
    return float(scores(name, Boxes.of([candidate.box]), anchors, stand, np.array([flat]))[0])


def scores(
    name: str, candidates: Boxes, anchors: Sequence[Group], stand: Stand, structure: NDArray[np.bool_] | None = None
) -> F64:
    """`[C]` how well each candidate fulfils relation `name` ("between" uses two anchors, all others the first).

    Args:
        structure: `[C]`, which candidates are floors, walls or ceilings; None: none of them.

    Raises:
        ValueError: the relation has no scoring function.
    """
    measure = named(name).score
    if measure is None:
        raise ValueError(f"{name} cannot be scored from boxes alone")
    flags = np.zeros(len(candidates), bool) if structure is None else structure
    parties = [Things(Boxes.of([a.box]), np.array([a.level == "structure"]), a.label == "wall") for a in anchors]
    return measure(Things(candidates, flags), parties, stand)
