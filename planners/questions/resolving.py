"""What noun phrases of questions mean: all things of a description, or the one or the several that a phrase names."""

from __future__ import annotations

from dataclasses import dataclass

from ...gaussians.language.query.query import Query
from .survey import Found, NotResolved, Survey, Thing


@dataclass(frozen=True)
class Meant:
    """The things that a phrase means.

    Attributes:
        query: the phrase.
        things: at least one.
        plural: whether the phrase means each of them ("the chairs"); else it means one, and these may be it.
        found: as resolved.
    """

    query: Query
    things: tuple[Thing, ...]
    plural: bool
    found: Found

    def differ(self) -> NotResolved:
        """What to raise where the candidates of a singular phrase do not agree."""
        return NotResolved(self.query, Found("ambiguous", self.things, reason=self.found.reason))


def meant(survey: Survey, query: Query) -> Meant:
    """The things that a definite phrase means; the candidates where it is singular and several match.

    Raises:
        NotResolved: nothing matches, or a phrase within it is absent or ambiguous.
    """
    found = survey.find(_plain(query))
    if found.verdict == "absent" or found.about is not None or not found.things:
        raise NotResolved(query, found)
    plural = query.pick in ("all", "rest") or bool(query.also) or (query.last and len(found.things) > 1)
    if found.verdict == "ambiguous" and query.count is not None and len(found.things) != query.count:
        raise NotResolved(query, found)
    return Meant(query, found.things, plural or bool(query.groups), found)


def all_of(survey: Survey, query: Query) -> tuple[tuple[Thing, ...], Found]:
    """Everything that a description fits, and how it was resolved; none if it is absent.

    Raises:
        NotResolved: a phrase within it is ambiguous.
    """
    things: dict[int, Thing] = {}
    first: Found | None = None
    for part in (query.model_copy(update={"also": ()}), *query.also):
        single = part.pick in ("one", "any", "all")
        found = survey.find(part.model_copy(update={"pick": "all", "count": None}) if single else part)
        if found.verdict == "ambiguous" or (found.about is not None and found.about.last):
            raise NotResolved(part, found)
        things |= {t.row: t for t in found.things} if found.verdict == "found" else {}
        first = first if first is not None and first.verdict == "absent" else found
    assert first is not None
    return tuple(things.values()), first


def _plain(query: Query) -> Query:
    """A phrase as a definite one: "a lamp" may be any, "any chairs" are all."""
    return query.model_copy(update={"pick": "one"}) if query.pick == "any" else query
