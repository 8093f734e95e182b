"""Explain how a query was resolved: each candidate with the score and threshold of every term.

The resolver is run again; nothing is decided here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ...errors import UserError
from .picking import rivals
from .query import ALL, BACKGROUND, FLOATERS, Query
from .resolve import Resolver, Unresolved
from .selection import Candidate, Verdict
from .terms import name_shares


@dataclass(frozen=True)
class Term:
    """One term of one candidate.

    Attributes:
        score: in [0, 1]; None if it was not computed, because another term already fails.
        threshold: the score from which the term holds.
        sources: of a name: the probability that each source of names alone gives it.
    """

    name: str
    score: float | None
    threshold: float
    sources: tuple[tuple[str, float], ...] = ()

    @property
    def holds(self) -> bool:
        return self.score is not None and self.score >= self.threshold


@dataclass(frozen=True)
class Explained:
    """A candidate with its terms.

    Attributes:
        outcome: "selected"; "rival" if it could be meant as well; "matches" if all terms hold but it was not selected;
            "fails" otherwise.
    """

    candidate: Candidate
    terms: tuple[Term, ...]
    outcome: str


@dataclass(frozen=True)
class Explanation:
    """A query, its verdict, its candidates (best first), and the explanations of its inner queries by role."""

    asked: str
    verdict: Verdict
    reason: str
    candidates: tuple[Explained, ...]
    inside: tuple[tuple[str, Explanation], ...]

    def to_json(self) -> dict[str, Any]:
        """The explanation as JSON values."""
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
                            **({"sources": {k: round(v, 4) for k, v in t.sources}} if t.sources else {}),
                        }
                        for t in e.terms
                    ],
                }
                for e in self.candidates
            ],
            "inside": [{"role": role, **inner.to_json()} for role, inner in self.inside],
        }  # fmt: skip

    def lines(self, most: int = 6, indent: str = "") -> list[str]:
        """The explanation as text: the verdict, the first `most` candidates, then the inner queries."""
        lines = [f"{indent}{self.asked}: {self.verdict}{f' ({self.reason})' if self.reason else ''}"]
        for e in self.candidates[:most]:
            terms = ", ".join(_term_text(t) for t in e.terms) or "no terms"
            lines.append(f"{indent}  {e.outcome}: {e.candidate.describe()}: {terms}")
        if len(self.candidates) > most:
            lines.append(f"{indent}  and {len(self.candidates) - most} more that fit less")
        for role, inner in self.inside:
            lines += [f"{indent}  {role}:", *inner.lines(most, indent + "    ")]
        return lines


def explain(resolver: Resolver, query: Query) -> Explanation:
    """The explanation of a query.

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
    if query.last or query.groups or (query.text in ALL | BACKGROUND | FLOATERS and not query.colors):
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

    shares = {}
    if "text" in rank.terms:
        shares = name_shares(resolver.field, resolver.encoder, query.text, resolver.scene.frame.metres_per_unit)

    def terms(i: int) -> tuple[Term, ...]:
        own = tuple((source, float(values[rank.groups[i].id])) for source, values in shares.items())
        scores = ((name, float(values[i])) for name, values in rank.terms.items())
        return tuple(
            Term(name, None if math.isnan(s) else s, rank.limits[name], own if name == "text" else ())
            for name, s in scores
        )

    order = dict.fromkeys([*matches, *rank.nearest()])
    return tuple(Explained(rank.candidate(i), terms(i), outcome(i)) for i in order)


def _term_text(term: Term) -> str:
    if term.score is None:
        return f"{term.name} not asked"
    sign = ">=" if term.holds else "<"
    said = f"{term.name} {term.score:.2f} {sign} {term.threshold:.2f}"
    return said + (f" ({', '.join(f'{name} {value:.2f}' for name, value in term.sources)})" if term.sources else "")
