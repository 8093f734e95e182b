"""Why a query was answered as it was: every candidate with each term, what it is held against, and whether it holds.

Knows the terms of a query. Refuses to decide anything: it asks the resolver again and tells what that saw.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ...errors import UserError
from .picking import rivals
from .query import Query
from .resolve import Resolver, Unresolved
from .selection import Candidate, Verdict
from .terms import ALL, FLOATERS


@dataclass(frozen=True)
class Term:
    """One term of one candidate.

    Attributes:
        score: in [0, 1]; None where it was not asked, because another term already fails.
        threshold: the score from which it holds.
    """

    name: str
    score: float | None
    threshold: float

    @property
    def holds(self) -> bool:
        return self.score is not None and self.score >= self.threshold


@dataclass(frozen=True)
class Explained:
    """A candidate with its terms.

    Attributes:
        outcome: "selected"; "rival" of one that could be meant as well; "matches" if all terms hold and yet it was not
            taken; "fails" otherwise.
    """

    candidate: Candidate
    terms: tuple[Term, ...]
    outcome: str


@dataclass(frozen=True)
class Explanation:
    """A query, its verdict, its candidates best first, and the same of each query inside it, by its role in words."""

    asked: str
    verdict: Verdict
    reason: str
    candidates: tuple[Explained, ...]
    inside: tuple[tuple[str, Explanation], ...]

    def to_json(self) -> dict[str, Any]:
        """Plain numbers, lists and dictionaries."""
        return {
            "asked": self.asked,
            "verdict": self.verdict,
            "reason": self.reason,
            "candidates": [
                {
                    "group": e.candidate.group,
                    "label": e.candidate.label,
                    "color": e.candidate.color,
                    "score": round(e.candidate.score, 4),
                    "outcome": e.outcome,
                    "terms": [
                        {
                            "name": t.name, "score": None if t.score is None else round(t.score, 4),
                            "threshold": round(t.threshold, 4), "holds": t.holds,
                        }
                        for t in e.terms
                    ],
                }
                for e in self.candidates
            ],
            "inside": [{"role": role, **inner.to_json()} for role, inner in self.inside],
        }  # fmt: skip

    def lines(self, most: int = 6, indent: str = "") -> list[str]:
        """For a person: the verdict, the first `most` candidates, then what is inside."""
        told = [f"{indent}{self.asked}: {self.verdict}{f' ({self.reason})' if self.reason else ''}"]
        for e in self.candidates[:most]:
            terms = ", ".join(_told(t) for t in e.terms) or "no terms"
            told.append(f"{indent}  {e.outcome}: {e.candidate.describe()}: {terms}")
        if len(self.candidates) > most:
            told.append(f"{indent}  and {len(self.candidates) - most} more that fit less")
        for role, inner in self.inside:
            told += [f"{indent}  {role}:", *inner.lines(most, indent + "    ")]
        return told


def explain(resolver: Resolver, query: Query) -> Explanation:
    """What was seen when a query was answered.

    Raises:
        BackendError, UserError: as `resolve`.
    """
    found = resolver.select(query)
    inside = [(f"{r.name.replace('_', ' ')}", explain(resolver, a)) for r in query.relations for a in r.anchors]
    inside += [("and", explain(resolver, q)) for q in query.also]
    inside += [("but not", explain(resolver, q)) for q in query.exclude]
    return Explanation(
        query.describe(), found.verdict, found.reason, _candidates(resolver, query, set(found.groups)), tuple(inside)
    )


def _candidates(resolver: Resolver, query: Query, selected: set[int]) -> tuple[Explained, ...]:
    if query.last or query.groups or (query.text in ALL | FLOATERS and not query.colors):
        return ()
    try:
        rank = resolver.scored(query)
    except (Unresolved, UserError):
        return ()
    matches = rank.matches()
    close = set(rivals(rank, matches)) if matches else set()

    def outcome(i: int) -> str:
        if rank.groups[i].id in selected:
            return "selected"
        return "rival" if i in close else "matches" if rank.holds[i] else "fails"

    def terms(i: int) -> tuple[Term, ...]:
        scores = ((name, float(values[i])) for name, values in rank.terms.items())
        return tuple(Term(name, None if math.isnan(s) else s, rank.limits[name]) for name, s in scores)

    order = dict.fromkeys([*matches, *rank.nearest()])
    return tuple(Explained(rank.candidate(i), terms(i), outcome(i)) for i in order)


def _told(term: Term) -> str:
    if term.score is None:
        return f"{term.name} not asked"
    sign = ">=" if term.holds else "<"
    return f"{term.name} {term.score:.2f} {sign} {term.threshold:.2f}"
