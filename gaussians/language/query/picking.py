"""Choose among the matches of a query by its `pick`: the only one, all, a count, the largest, the second from the left.

Several matches of equal quality for pick "one" are an ambiguity, and so are those that are equal in what a superlative
compares; none of them is chosen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...world.box import Boxes, distances
from ...world.relation_geometry import Stand
from ..field.language_field import Group
from . import attributes
from .query import CORNERS, Query
from .selection import Candidate, Selection, Verdict, nothing
from .terms import Scored

CLEAR_LEAD = 0.55  # share of the best score from which a match of the same name and colour is a rival
NAME_LEAD = 0.35  # share of the best name score below which a match is rather a fragment or a similar object
EQUAL_SIZE = 1.12  # factor of volume up to which sizes are equal: boxes are measured no better
EQUAL_PLACE = 0.01  # of a typical object size: difference of places that cannot be measured
EQUAL_TIME = 0.05  # seconds: things that begin to move within this begin together
MAX_LISTED = 6  # candidates listed in a sentence


@dataclass(frozen=True)
class Choice:
    """The chosen matches, or a selection that says why none is chosen.

    Attributes:
        chosen: positions in `Scored`, best first; empty with a refusal.
        refusal: the selection to return instead, or None.
    """

    chosen: list[int]
    refusal: Selection | None = None


def pick(query: Query, scored: Scored, stand: Stand, begins: Callable[[Group], float] | None = None) -> Choice:
    """The matches that a query refers to, by its `pick`. There must be at least one match.

    Args:
        begins: seconds at which a group begins to move: what moves is counted in this order.
    """
    matches = scored.matches()
    if query.pick == "one":
        return _unique(query, scored, matches)
    if query.pick in ("all", "rest"):
        return _counted(query, scored, matches)
    if query.pick == "any":
        return Choice(matches[:1])
    in_time = begins if query.pick == "nth" and query.moving else None
    key = in_time or _keys(stand)[query.pick if query.pick != "middle" else _row(matches, scored, stand)]
    values = {i: key(scored.groups[i]) for i in (matches if in_time else _preferred(scored, matches))}
    ordered = sorted(values, key=lambda i: (values[i], scored.groups[i].id))
    told = tuple(scored.candidate(i) for i in ordered)
    if query.pick == "middle" and len(ordered) % 2 == 0:
        reason = f"{query.describe()}: of {len(ordered)} none is in the middle ({listing(told)}); say which one"
        return Choice([], _refused(query, reason, told, "ambiguous"))
    ranked = query.pick not in ("nth", "middle", *CORNERS)  # "the two tallest"
    if query.count is not None and query.count > 1 and ranked and len(ordered) >= query.count:
        return Choice(sorted(ordered[: query.count]))
    if len(tied := _tied(ordered, scored, query, stand)) > 1:
        told = tuple(scored.candidate(i) for i in tied)
        reason = f"{query.describe()}: {len(tied)} are equal in that ({listing(told)}); say which one, or 'all'"
        return Choice([], _refused(query, reason, told, "ambiguous"))
    rank = (query.ordinal or 1) if query.pick == "nth" else len(ordered) // 2 + 1 if query.pick == "middle" else 1
    if abs(rank) > len(ordered):
        return Choice([], nothing(query, f"{query.describe()}: there are only {len(ordered)}", told))
    found = ordered[rank - 1 if rank > 0 else rank]
    together = [i for i in ordered if abs(values[i] - values[found]) < EQUAL_TIME] if in_time else []
    if len(together) > 1:
        told = tuple(scored.candidate(i) for i in together)
        reason = f"{query.describe()}: {len(together)} begin at the same time ({listing(told)}); say which one"
        return Choice([], _refused(query, reason, told, "ambiguous"))
    return Choice([found])


def _row(matches: Sequence[int], scored: Scored, stand: Stand) -> Literal["middle", "lowest"]:
    """Along what the middle one is in the middle: from left to right, or from the bottom up in a stack."""
    spans = [np.ptp([_keys(stand)[name](scored.groups[i]) for i in matches]) for name in ("middle", "lowest")]
    return "lowest" if spans[1] > spans[0] else "middle"


def by_distance(query: Query, scored: Scored, anchors: Sequence[Group], nearest: bool) -> Choice:
    """The match nearest to the anchors, or the farthest from them; the anchors themselves are excluded."""
    ids = {a.id for a in anchors if a.id >= 0}
    matches = _preferred(scored, [i for i in scored.matches() if scored.groups[i].id not in ids])
    if not matches:
        return Choice([], nothing(query, f"{query.describe()}: there is nothing but what it is compared with"))
    boxes = Boxes.of([scored.groups[i].box for i in matches])
    gaps = np.min([distances(boxes, Boxes.of([a.box])) for a in anchors], axis=0)
    if query.count is not None and query.count > 1 and query.pick == "all":
        order = np.argsort(gaps if nearest else -gaps, kind="stable")
        return Choice(sorted(matches[int(i)] for i in order[: query.count]))
    return Choice([matches[int(np.argmin(gaps) if nearest else len(gaps) - 1 - np.argmax(gaps[::-1]))]])


def rivals(scored: Scored, matches: list[int]) -> list[int]:
    """The matches that the query could refer to as well as to the best one.

    A match that has exactly the name and colour of the query excludes those that only come close: beside a red chair
    an orange one is not "the red chair". Among matches of equal name and colour the relations decide, unless their
    scores are too close.
    """
    own = [i for i in matches if scored.own[i]]
    if "text" in scored.terms and own:
        sure = scored.terms["text"]
        own = [i for i in own if sure[i] >= NAME_LEAD * max(sure[own])]
    own += _alike(scored, matches, own)
    if not own:
        return [i for i in matches if scored.score[i] >= CLEAR_LEAD * scored.score[matches[0]]]
    placed = {i: _other_terms(scored, i) for i in own}
    best = max(placed.values())
    return [i for i in own if placed[i] >= CLEAR_LEAD * best]


def _preferred(scored: Scored, matches: list[int]) -> list[int]:
    """The matches that have exactly the name and colour of the query, and those nearly as sure, if there are any; else
    all."""
    own = [i for i in matches if scored.own[i]]
    return sorted([*own, *_alike(scored, matches, own)], key=matches.index) or matches


def _alike(scored: Scored, matches: list[int], own: list[int]) -> list[int]:
    """The matches with another label that are nearly as surely what is named as the best of `own`.

    Of two cabinets an encoder may call one a dresser: it is meant as well as the other.
    """
    if not own or "text" not in scored.terms or any(name.startswith("color ") for name in scored.terms):
        return []
    sure = scored.terms["text"]
    least = NAME_LEAD * max(sure[own])
    return [i for i in matches if not scored.own[i] and sure[i] >= least]


def _tied(ordered: list[int], scored: Scored, query: Query, stand: Stand) -> list[int]:
    """The first of an order by a superlative, and those that are equal to it as far as can be measured."""
    groups = [scored.groups[i] for i in ordered]
    if query.pick in ("largest", "smallest", "tallest", "shortest"):
        word = "large" if query.pick in ("largest", "smallest") else "tall"
        equal = math.log(EQUAL_SIZE) / (3 if word == "tall" else 1)
        sizes = np.log(np.maximum([attributes.extent(g, word) for g in groups], 1e-12))
        apart = np.abs(sizes - sizes[0])
    elif query.pick in ("highest", "lowest", "leftmost", "rightmost", "nearest", "farthest", *CORNERS):
        equal = EQUAL_PLACE * stand.scale
        places = np.array([_keys(stand)[query.pick](g) for g in groups])
        apart = places - places[0]
    else:
        return ordered[:1]
    return [i for i, gap in zip(ordered, apart, strict=True) if gap < equal]


def _other_terms(scored: Scored, index: int) -> float:
    """Product of the terms other than name and colour."""
    held = [v[index] for name, v in scored.terms.items() if name != "text" and not name.startswith(("color ", "not "))]
    return float(np.prod(held)) if held else 1.0


def listing(candidates: Sequence[Candidate]) -> str:
    """The first candidates in words."""
    return ", ".join(c.describe() for c in candidates[:MAX_LISTED])


def _unique(query: Query, scored: Scored, matches: list[int]) -> Choice:
    left = rivals(scored, matches)
    if len(left) == 1:
        return Choice(left)
    told = tuple(scored.candidate(i) for i in left)
    reason = f"{query.describe()}: {len(told)} things match ({listing(told)}); say which one, or 'all'"
    return Choice([], _refused(query, reason, told, "ambiguous"))


def _counted(query: Query, scored: Scored, matches: list[int]) -> Choice:
    if query.pick == "rest" or query.count is None:
        return Choice(matches)
    for counted in (matches, _preferred(scored, matches)):
        if query.count == len(counted):
            return Choice(counted)
    told = tuple(scored.candidate(i) for i in matches)
    reason = f"{query.describe()}: {query.count} were asked for, {len(told)} match ({listing(told)})"
    return Choice([], _refused(query, reason, told, "ambiguous" if len(told) > query.count else "absent"))


def _refused(query: Query, reason: str, told: tuple[Candidate, ...], verdict: Verdict) -> Selection:
    return Selection(query, verdict, nothing(query, reason, told).ids, (), told, reason)


def _keys(stand: Stand) -> dict[str, Callable[[Group], float]]:
    """The sort key of each superlative, smallest first."""

    def rightward(g: Group) -> float:
        return float(np.array(g.box.center) @ stand.right)

    def away(g: Group) -> float:
        return float(np.linalg.norm(np.array(g.box.center) - stand.eye))

    def deep(g: Group) -> float:
        return float(np.array(g.box.center) @ stand.forward)

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
        "front left": lambda g: rightward(g) + deep(g),
        "front right": lambda g: deep(g) - rightward(g),
        "back left": lambda g: rightward(g) - deep(g),
        "back right": lambda g: -rightward(g) - deep(g),
    }
