"""The terms of a query (name, colours, size, relations), each scored separately for every candidate.

The threshold of a name is that of its encoder where its pictures are trusted (`field/posterior.py`), fitted on other
things (`Calibration.measured` has its error rates). In 12 embedded rooms, 0.16 and 0.2 found 97 % of what was present
once and refused 97 % of what was absent; from 0.12 to 0.25 neither falls below 95 %, so that it need not be tuned to
a scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...camera import Vec3
from ...color import name_of
from ...world import relations
from ...world.box import Boxes
from ...world.relation_geometry import HOLDS, Stand
from ..field.language_field import Group, LanguageField
from ..field.posterior import belief_of
from . import attributes
from .color.fallback import PARTS
from .query import Query, Relation
from .readings import Reading, readings
from .selection import Candidate

if TYPE_CHECKING:
    from ..encoders import Encoder

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

ANYTHING = frozenset({"", "thing", "object", "item", "one", "stuff", "furniture"})
STRUCTURE = {
    "floor": "floor", "ground": "floor", "terrain": "floor", "soil": "floor", "grass": "floor", "carpeting": "floor",
    "wall": "wall", "ceiling": "ceiling",
}  # fmt: skip
COLORED = {"grass": "green"}  # structure that has its name by its colour: a paved ground is no grass
# Relations that are read as to whichever anchor fits: "the lamp on the desk" where there are two desks.
LOOSE = frozenset({"on", "inside", "under", "below", "above", "next_to"})
ORDERING = frozenset(k.name for k in relations.KINDS if k.orders)
MAX_CACHED = 4096  # phrases and colours whose scores a field caches
MIN_LABEL_SCORE = 0.25  # labels less probable than this are not shown
OWNED = "part_of"  # the term whether a candidate is a part of the thing that is named
OWN_COLOR = 0.5  # colour score from which no other basic colour is nearer


@dataclass(frozen=True, eq=False)
class Anchor:
    """The object that a relation refers to, and the frame in which the relation is evaluated."""

    group: Group
    stand: Stand


@dataclass(frozen=True, eq=False)
class Scored:
    """Candidates of one query with their terms.

    Attributes:
        groups: the C candidates.
        terms: `[C]` scores in [0, 1] of each term; NaN where one was not computed because another already fails.
        limits: threshold of each term.
        own: `[C]`, whether the candidate's own label and colour are exactly those of the query.
        reading: how its noun was read; None without a name.
    """

    groups: tuple[Group, ...]
    terms: dict[str, F64]
    limits: dict[str, float]
    own: Flags
    reading: Reading | None = None

    @property
    def confirmed(self) -> bool:
        """Whether a match is confirmed to be what the noun names, and not only likely."""
        return self.reading is None or self.reading.confirmed

    @cached_property
    def score(self) -> F64:
        """Product `[C]` of the terms."""
        score = np.ones(len(self.groups))
        for values in self.terms.values():
            score = score * np.where(np.isnan(values), 1.0, values)
        return score

    @cached_property
    def holds(self) -> Flags:
        """Whether every term holds `[C]`."""
        held = np.ones(len(self.groups), bool)
        for name, values in self.terms.items():
            held &= values >= self.limits[name]
        return held

    @cached_property
    def named(self) -> frozenset[int]:
        """Groups that are what the noun names, whatever the other terms; none without a name term."""
        owned = self.terms.get(OWNED, np.ones(len(self.groups))) >= HOLDS
        return frozenset(g.id for g, own in zip(self.groups, owned, strict=True) if own) & self.likely

    @cached_property
    def likely(self) -> frozenset[int]:
        """Groups whose name term holds, also where they are parts of other things; none without a name term."""
        if "text" not in self.terms:
            return frozenset()
        held = self.terms["text"] >= self.limits["text"]
        return frozenset(g.id for g, holds in zip(self.groups, held, strict=True) if holds)

    def without(self, ids: frozenset[int]) -> Scored:
        """The candidates without these groups."""
        if ids.isdisjoint(g.id for g in self.groups):
            return self
        keep = np.array([g.id not in ids for g in self.groups], dtype=bool)
        groups = tuple(g for g in self.groups if g.id not in ids)
        return Scored(
            groups, {name: v[keep] for name, v in self.terms.items()}, self.limits, self.own[keep], self.reading
        )

    def matches(self) -> list[int]:
        """Positions of the candidates for which every term holds, best first."""
        return [int(i) for i in self._ordered() if self.holds[i]]

    def nearest(self) -> list[int]:
        """Positions of all candidates, ordered by whether they are what is named, whether they are called so, how many
        terms hold, and the score."""
        held = [values >= self.limits[name] for name, values in self.terms.items()]
        name = [(g.id in self.named) + (g.id in self.likely) for g in self.groups]
        count = np.sum(held, axis=0) if held else np.zeros(len(self.groups))
        return sorted((int(i) for i in self._ordered()), key=lambda i: (-int(name[i]), -int(count[i])))

    def candidate(self, index: int) -> Candidate:
        """One of the groups as a `Candidate`."""
        terms = {name: float(v[index]) for name, v in self.terms.items() if not np.isnan(v[index])}
        return candidate_of(self.groups[index], float(self.score[index]), terms)

    def _ordered(self) -> NDArray[np.intp]:
        return np.lexsort((np.array([g.id for g in self.groups], dtype=np.int64), -self.score))


def candidate_of(group: Group, score: float = 1.0, terms: dict[str, float] | None = None) -> Candidate:
    """A group as a `Candidate`, labelled "object" if its label is too improbable."""
    label = group.label if group.label_score >= MIN_LABEL_SCORE else "object"
    return Candidate(group.id, label, _color_name(group.lab), group.box.center, group.box.size, score, terms or {})


@lru_cache(maxsize=4096)
def _color_name(lab: Vec3) -> str:
    return name_of(lab)


def present_groups(field: LanguageField, level: str) -> tuple[Group, ...]:
    """Groups that still have Gaussians, of one level: objects, structure, leaves of objects ("parts"), or all."""
    rows = (g for g in field.groups if g.count > 0)
    if level == "all":
        return tuple(rows)
    if level == "parts":
        split = {g.parent for g in field.groups if g.parent >= 0 and g.count > 0}
        room = {g.id for g in field.groups if g.level == "structure"}
        return tuple(g for g in rows if g.id not in split | room and g.parent not in room)
    return tuple(g for g in rows if g.level == level)


def candidate_groups(field: LanguageField, text: str) -> tuple[Group, ...]:
    """The groups that a noun may refer to."""
    if text in PARTS:
        return present_groups(field, "parts")
    if text in STRUCTURE:
        return tuple(g for g in present_groups(field, "structure") if g.label == STRUCTURE[text])
    return present_groups(field, "object")


def is_name(text: str) -> bool:
    """Whether a noun names a kind of thing, so that the encoder is needed."""
    return text not in ANYTHING and text not in PARTS and text not in STRUCTURE


def name_readings(
    field: LanguageField, encoder: Encoder | None, text: str, metres_per_unit: float | None
) -> tuple[Reading, ...]:
    """The readings of a noun, the closest first, cached per phrase and field.

    Raises:
        BackendError: there is no encoder, or it is not that of the field.
    """
    key = (encoder.fingerprint if encoder is not None else "", text, str(metres_per_unit))
    if key not in field.readings:
        made = tuple(readings(field, encoder, text, metres_per_unit))
        if len(field.readings) >= MAX_CACHED:
            field.readings.clear()
        field.readings[key] = made
    found: tuple[Reading, ...] = field.readings[key]
    return found


def name_shares(
    field: LanguageField, encoder: Encoder | None, text: str, metres_per_unit: float | None
) -> dict[str, F64]:
    """The probability `[G]` that each source of names alone gives a `text`; empty where no encoder is asked."""
    if encoder is None or not is_name(text):
        return {}
    return dict(belief_of(field, encoder, metres_per_unit).shares(text).sources)


def color_term(field: LanguageField, word: str) -> F64:
    """Score `[G]` of a colour word for every group, cached per word and field.

    Raises:
        UserError: unknown colour.
    """
    key = ("color", word)
    if key not in field.answers:
        _limit_cache(field)
        field.answers[key] = attributes.group_color_scores(field, word)
    return field.answers[key]


def _limit_cache(field: LanguageField) -> None:
    """Empty the cache when it is full: a batch of a million phrases must not fill the memory."""
    if len(field.answers) >= MAX_CACHED:
        field.answers.clear()


def scored(
    query: Query,
    field: LanguageField,
    encoder: Encoder | None,
    metres_per_unit: float | None,
    placed: Sequence[tuple[Relation, Sequence[Anchor]]],
    beside: Sequence[Group] = (),
) -> Iterator[Scored]:
    """The candidates of a query with their terms, under each reading of its noun, the closest first; at least one.

    Args:
        metres_per_unit: of the scene, None if unknown.
        placed: the query's relations, except orderings, each with its anchors.
        beside: further candidates beside the objects that the noun may refer to.

    Raises:
        BackendError: the name needs an encoder and there is none.
        UserError: a colour word is unknown.
    """
    if is_name(query.text) and candidate_groups(field, query.text):
        for reading in name_readings(field, encoder, query.text, metres_per_unit):
            yield _scored(query, field, placed, reading, beside)
    else:
        yield _scored(query, field, placed, None, beside)


def _scored(
    query: Query,
    field: LanguageField,
    placed: Sequence[tuple[Relation, Sequence[Anchor]]],
    reading: Reading | None,
    beside: Sequence[Group],
) -> Scored:
    """The candidates of a query with their terms under one reading of its noun."""
    groups = (*candidate_groups(field, query.text), *beside)
    rows = np.array([g.id for g in groups], dtype=np.intp)
    terms: dict[str, F64] = {}
    limits: dict[str, float] = {}
    own = np.ones(len(groups), bool)
    if query.text in STRUCTURE:
        terms["text"], limits["text"] = np.ones(len(groups)), attributes.COLOR_HOLDS
        if query.text in COLORED:
            terms["text"] = color_term(field, COLORED[query.text])[rows]
    elif reading is not None:
        terms["text"], limits["text"] = reading.scores[rows], reading.limit
        own &= np.array([g.label in reading.kinds for g in groups], dtype=bool) if reading.kinds else True
    for word in query.colors:
        terms[f"color {word}"] = color_term(field, word)[rows]
        limits[f"color {word}"] = attributes.COLOR_HOLDS
        own &= terms[f"color {word}"] >= OWN_COLOR
    for word in query.not_colors:
        terms[f"not {word}"] = 1 - color_term(field, word)[rows]
        limits[f"not {word}"] = 1 - attributes.COLOR_HOLDS
    for relation, anchors in placed:
        name = relation.name if relation.name not in terms else f"{relation.name} {len(terms)}"
        terms[name], limits[name] = related(relation, groups, field, anchors), HOLDS
    if query.size is not None:
        before = Scored(groups, dict(terms), limits, own)
        fit = np.flatnonzero(before.holds & own) if (before.holds & own).any() else np.flatnonzero(before.holds)
        sized = np.full(len(groups), np.nan)
        sized[fit] = attributes.size_scores([groups[i] for i in fit], query.size)
        terms[query.size], limits[query.size] = sized, 0.5
    return Scored(groups, terms, limits, own, reading)


def related(relation: Relation, groups: Sequence[Group], field: LanguageField, anchors: Sequence[Anchor]) -> F64:
    """Score `[C]` of a relation between each group and its best-fitting anchor; 0 for the anchors themselves."""
    ids = {a.group.id for a in anchors if a.group.id >= 0}
    if relation.name == "part_of":
        return np.array([float(g.parent >= 0 and g.parent in ids) for g in groups])
    tabled = all(g.id >= 0 for g in groups)
    boxes = field.boxes.at([g.id for g in groups]) if tabled else Boxes.of([g.box for g in groups])
    wide = np.array([g.level == "structure" for g in groups], dtype=bool)
    if relations.named(relation.name).anchors == 2:
        best = relations.scores(relation.name, boxes, [a.group for a in anchors], anchors[0].stand)
    else:
        best = np.zeros(len(groups))
        for anchor in anchors:
            best = np.maximum(best, relations.scores(relation.name, boxes, [anchor.group], anchor.stand, wide))
    return np.where(np.array([g.id in ids for g in groups], dtype=bool), 0.0, best)
