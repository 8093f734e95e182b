"""Choosing among what matches: the one, all, as many as were counted, the largest, the second from the left.

Knows candidates and where the viewer stands. Refuses to guess: several that match equally well are an ambiguity.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...world.box import Boxes, distances
from ...world.relation_geometry import Stand
from ..field.language_field import Group
from . import attributes
from .query import Query
from .selection import Candidate, Selection, Verdict, nothing
from .terms import Scored

CLEAR_LEAD = 0.55  # among equals in name and colour, a match is a rival from this share of the best one's score
NAME_LEAD = 0.35  # of equals in name, those less sure than this share of the surest are rather a piece or a look-alike
LISTED = 6  # candidates told in a sentence


@dataclass(frozen=True)
class Choice:
    """What was chosen, or why nothing was.

    Attributes:
        chosen: positions in the `Scored`, best first; empty unless found.
        refusal: the selection to answer with instead, or None.
    """

    chosen: list[int]
    refusal: Selection | None = None


def pick(query: Query, scored: Scored, stand: Stand) -> Choice:
    """Which of the matches a query means, by its `pick`. There is at least one match."""
    matches = scored.matches()
    if query.pick == "one":
        return _only_one(query, scored, matches)
    if query.pick in ("all", "rest"):
        return _counted(query, scored, matches)
    if query.pick == "any":
        return Choice(matches[:1])
    key = _keys(stand)[query.pick]
    ordered = sorted(_meant(scored, matches), key=lambda i: (key(scored.groups[i]), scored.groups[i].id))
    told = tuple(scored.candidate(i) for i in ordered)
    if query.pick == "middle" and len(ordered) % 2 == 0:
        reason = f"{query.describe()}: of {len(ordered)} none is in the middle ({listing(told)}); say which one"
        return Choice([], _refused(query, reason, told, "ambiguous"))
    rank = (query.ordinal or 1) if query.pick == "nth" else len(ordered) // 2 + 1 if query.pick == "middle" else 1
    if abs(rank) > len(ordered):
        return Choice([], nothing(query, f"{query.describe()}: there are only {len(ordered)}", told))
    return Choice([ordered[rank - 1 if rank > 0 else rank]])


def by_distance(query: Query, scored: Scored, anchors: Sequence[Group], nearest: bool) -> Choice:
    """The match nearest to the anchors, or the farthest from them; none of them is itself meant."""
    ids = {a.id for a in anchors if a.id >= 0}
    matches = _meant(scored, [i for i in scored.matches() if scored.groups[i].id not in ids])
    if not matches:
        return Choice([], nothing(query, f"{query.describe()}: there is nothing but what it is compared with"))
    boxes = Boxes.of([scored.groups[i].box for i in matches])
    gaps = np.min([distances(boxes, Boxes.of([a.box])) for a in anchors], axis=0)
    return Choice([matches[int(np.argmin(gaps) if nearest else len(gaps) - 1 - np.argmax(gaps[::-1]))]])


def rivals(scored: Scored, matches: list[int]) -> list[int]:
    """The matches that a person could mean as well as the best.

    What goes by the asked name and colour itself leaves no room for what only comes near to them: beside a red chair
    an orange one is not "the red chair". Among equals the relations decide, unless they decide too narrowly.
    """
    own = [i for i in matches if scored.own[i]]
    if "text" in scored.terms and own:
        sure = scored.terms["text"]
        own = [i for i in own if sure[i] >= NAME_LEAD * max(sure[own])]
    if not own:
        return [i for i in matches if scored.score[i] >= CLEAR_LEAD * scored.score[matches[0]]]
    placed = {i: _placed(scored, i) for i in own}
    best = max(placed.values())
    return [i for i in own if placed[i] >= CLEAR_LEAD * best]


def _meant(scored: Scored, matches: list[int]) -> list[int]:
    """The matches that go by the asked name and colour themselves if there are any, else all."""
    return [i for i in matches if scored.own[i]] or matches


def _placed(scored: Scored, index: int) -> float:
    """Product of the terms that are neither name nor colour."""
    held = [v[index] for name, v in scored.terms.items() if name != "text" and not name.startswith(("color ", "not "))]
    return float(np.prod(held)) if held else 1.0


def listing(candidates: Sequence[Candidate]) -> str:
    """The first few, in words."""
    return ", ".join(c.describe() for c in candidates[:LISTED])


def _only_one(query: Query, scored: Scored, matches: list[int]) -> Choice:
    left = rivals(scored, matches)
    if len(left) == 1:
        return Choice(left)
    told = tuple(scored.candidate(i) for i in left)
    reason = f"{query.describe()}: {len(told)} things match ({listing(told)}); say which one, or 'all'"
    return Choice([], _refused(query, reason, told, "ambiguous"))


def _counted(query: Query, scored: Scored, matches: list[int]) -> Choice:
    if query.pick == "rest" or query.count is None:
        return Choice(matches)
    for counted in (matches, _meant(scored, matches)):
        if query.count == len(counted):
            return Choice(counted)
    told = tuple(scored.candidate(i) for i in matches)
    reason = f"{query.describe()}: {query.count} were asked for, {len(told)} match ({listing(told)})"
    return Choice([], _refused(query, reason, told, "ambiguous" if len(told) > query.count else "absent"))


def _refused(query: Query, reason: str, told: tuple[Candidate, ...], verdict: Verdict) -> Selection:
    empty = nothing(query, reason, told)
    return Selection(query, verdict, empty.ids, (), told, reason)


def _keys(stand: Stand) -> dict[str, Callable[[Group], float]]:
    """What each superlative sorts by, smallest first."""

    def rightward(g: Group) -> float:
        return float(np.array(g.box.center) @ stand.right)

    def away(g: Group) -> float:
        return float(np.linalg.norm(np.array(g.box.center) - stand.eye))

    def height(g: Group) -> float:
        return float(np.array(g.box.center) @ stand.up)

    return {
        "largest": lambda g: -attributes.extent(g, "large"),
        "smallest": lambda g: attributes.extent(g, "large"),
        "tallest": lambda g: -g.box.size[2],
        "shortest": lambda g: g.box.size[2],
        "nearest": away,
        "farthest": lambda g: -away(g),
        "leftmost": rightward,
        "rightmost": lambda g: -rightward(g),
        "highest": lambda g: -height(g),
        "lowest": height,
        "nth": rightward,
        "middle": rightward,
    }
