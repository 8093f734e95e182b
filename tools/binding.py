"""Binds the targets of all steps of a plan in the scene before the first step.

A step changes colours and places, and with them what the words of the next would mean: "paint the red chair blue and
the blue one red" means the two chairs as they are when it is said. A step whose target an earlier step makes ("add a
lamp and paint the lamp red") is resolved when its turn comes, and so is one that means nothing, or several things,
before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..gaussians.errors import ScenewrightError
from ..gaussians.language.query.nested import queries
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection
from ..gaussians.world.words import head, normalise
from .operation import EditOp

Find = Callable[[Query, Selection | None], Selection]  # find(query, last): what a query means before the first step

_MAKING = ("insert", "replace", "duplicate")
_RENAMING = ("merge", "split", "reframe")  # behind these, groups or places are others than before
_IT = Query(last=True)


def bound_targets(ops: Sequence[EditOp], find: Find, last: Selection | None = None) -> tuple[Selection | None, ...]:
    """For each step the things that it is about, found before the first step; None where its turn decides.

    Args:
        find: resolves a query in the scene before the first step. Its errors leave a step unbound.
        last: what "it" means in the first step.
    """
    if len(ops) < 2:
        return (None,) * len(ops)
    bound: list[Selection | None] = []
    known = True  # whether `last` is what "it" means here
    pointed = any(q is not None and _points(q) for q in (op.query() for op in ops[1:]))
    for i, op in enumerate(ops):
        query = op.query()
        found = None
        if (
            (i or pointed)
            and query is not None
            and query != _IT
            and (known or not _points(query))
            and not _is_made(query, ops[:i])
        ):
            found = _found(find, query, last)
        bound.append(None if i == 0 or any(e.op in _RENAMING for e in ops[:i]) else found)
        if op.op in _MAKING:
            last, known = None, False
        elif query != _IT and query is not None:
            last, known = found, found is not None
    return tuple(bound)


def exchanged_likes(ops: Sequence[EditOp], find: Find, last: Selection | None = None) -> frozenset[int]:
    """The steps that take the look of a thing which an earlier step gives theirs: both are meant as they were before.

    "Paint the chair like the table and the table like the chair" exchanges two colours.
    """
    likes = {i: like for i, op in enumerate(ops) if (like := getattr(op, "like", None)) is not None}
    if len(likes) < 2:
        return frozenset()
    pairs: dict[int, tuple[frozenset[int], frozenset[int]]] = {}
    for i, like in likes.items():
        query = ops[i].query()
        target = _found(find, query, last) if query is not None else None
        model = _found(find, like, last)
        if target is not None and model is not None:
            pairs[i] = (frozenset(target.groups), frozenset(model.groups))
    return frozenset(
        i
        for i, (target, model) in pairs.items()
        if any((model, target) == other for j, other in pairs.items() if j != i)
    )


def _found(find: Find, query: Query, last: Selection | None) -> Selection | None:
    try:
        found = find(query, last)
    except ScenewrightError:
        return None
    return found if found.verdict == "found" else None


def _points(query: Query) -> bool:
    """Whether a query refers to the step before."""
    return any(q.last for _, q in queries((query,)))


def _is_made(query: Query, before: Sequence[EditOp]) -> bool:
    """Whether an earlier step makes a thing that a query may mean."""
    asked = [q for q in (query, *query.also) if not q.last]
    made = [n for op in before if op.op in _MAKING for n in _names(op)]
    return any(not q.text or q.spatial or _alike(q.text, name) for q in asked for name in made)


def _names(op: EditOp) -> list[str]:
    """What a step that makes things calls them."""
    query = op.query() if op.op == "duplicate" else None
    return [str(getattr(op, "asset", "")) if query is None else query.text]


def _alike(text: str, name: str) -> bool:
    return not name or head(text) == head(name) or bool(set(normalise(text)) & set(normalise(name)))
