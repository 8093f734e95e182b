"""Reads noun phrases of questions as queries, with the grammar of instructions."""

from __future__ import annotations

from functools import lru_cache

from ....gaussians.errors import UserError
from ....gaussians.language.query.query import Query
from ...grammar import GrammarPlanner

Words = tuple[str, ...]

_ANYTHING = frozenset(
    "anything something things thing objects object items item stuff everything furniture belongings".split()  # noqa: SIM905
)


@lru_cache(maxsize=4096)
def thing(words: Words) -> Query | None:
    """The query of a noun phrase, None if the words are none."""
    said = [w for w in words if w != ","]
    if not said or len(said) > 20:
        return None
    if said[0] in ("any", "some") and said[1:] and said[1] not in ("of", "other"):
        said = said[1:]
    if said[0] == "something":
        said[0] = "anything"
    try:
        plan = _grammar().plan(f"select {' '.join(said)}")
    except UserError:
        return None
    if len(plan.ops) != 1 or plan.ops[0].op != "select":
        return None
    return plan.ops[0].query()


def is_anything(query: Query) -> bool:
    """Whether a query names no kind of thing."""
    return not query.text or query.text in _ANYTHING


@lru_cache(maxsize=1)
def _grammar() -> GrammarPlanner:
    return GrammarPlanner()
