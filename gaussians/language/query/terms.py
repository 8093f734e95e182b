"""The terms of a query, each scored for every candidate on its own: name, colours, size, relations.

Knows the table of groups and what each term is held against. Refuses to choose among what matches.

A name is held against its encoder's one threshold, fitted on other rooms and kinds (`Calibration.measured` has its
error rates). Asked for all 81 names in each of 12 embedded rooms, 0.21 found 96.3 % of what was there and refused
96.4 % of what was not; from 0.1 to 0.6 neither falls below 95 %, and the threshold that is best for eleven rooms does
no better than 0.3 points on the twelfth: it is nothing that wants tuning to a scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...camera import Vec3
from ...color import name_of
from ...errors import BackendError
from ...world import relations
from ...world.box import Boxes
from ...world.relation_geometry import HOLDS, Stand
from ...world.words import normalise
from ..encoders.probability import probability
from ..field.language_field import Group, LanguageField
from . import attributes
from .color_fallback import PARTS
from .query import Query, Relation
from .selection import Candidate

if TYPE_CHECKING:
    from ..encoders import Encoder

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

ANYTHING = frozenset({"", "thing", "object", "item", "one", "stuff", "furniture"})
ALL = frozenset({"everything", "all", "scene", "room", "whole scene"})
STRUCTURE = {
    "floor": "floor", "ground": "floor", "terrain": "floor", "soil": "floor", "grass": "floor", "carpeting": "floor",
    "wall": "wall", "ceiling": "ceiling",
}  # fmt: skip
FLOATERS = frozenset({"floater", "noise", "floating bit", "stray"})
ORDERING = frozenset(k.name for k in relations.KINDS if k.orders)
KEPT = 4096  # phrases and colours whose answers a table remembers
NAMED = 0.25  # a label less probable than this is not worth telling
OWN_COLOR = 0.5  # colour score from which no other basic colour is nearer


@dataclass(frozen=True, eq=False)
class Anchor:
    """What a relation relates to, and where one stands when saying so."""

    group: Group
    stand: Stand


@dataclass(frozen=True, eq=False)
class Scored:
    """Candidates of one query with their terms.

    Attributes:
        groups: `[C]`, the candidates.
        terms: `[C]` shares in [0, 1] a term; NaN where a term was not asked because another already fails.
        limits: the score from which each term holds.
        own: `[C]`, whether the name and the colours asked for are the ones the candidate itself would be given.
    """

    groups: tuple[Group, ...]
    terms: dict[str, F64]
    limits: dict[str, float]
    own: Flags

    @cached_property
    def score(self) -> F64:
        """`[C]` product of the terms."""
        score = np.ones(len(self.groups))
        for values in self.terms.values():
            score = score * np.where(np.isnan(values), 1.0, values)
        return score

    @cached_property
    def holds(self) -> Flags:
        """`[C]` whether every term holds."""
        held = np.ones(len(self.groups), bool)
        for name, values in self.terms.items():
            held &= values >= self.limits[name]
        return held

    @cached_property
    def named(self) -> frozenset[int]:
        """Groups that have the name asked for, whatever else fails; none if no name was asked."""
        if "text" not in self.terms:
            return frozenset()
        held = self.terms["text"] >= self.limits["text"]
        return frozenset(g.id for g, holds in zip(self.groups, held, strict=True) if holds)

    def without(self, ids: frozenset[int]) -> Scored:
        """The candidates that are none of these groups."""
        if ids.isdisjoint(g.id for g in self.groups):
            return self
        keep = np.array([g.id not in ids for g in self.groups], dtype=bool)
        groups = tuple(g for g in self.groups if g.id not in ids)
        return Scored(groups, {name: v[keep] for name, v in self.terms.items()}, self.limits, self.own[keep])

    def matches(self) -> list[int]:
        """Positions of the candidates for which every term holds, best first."""
        return [int(i) for i in self._ordered() if self.holds[i]]

    def nearest(self) -> list[int]:
        """Positions of all candidates: by name where it was asked and holds, by how many terms hold, by score."""
        held = [values >= self.limits[name] for name, values in self.terms.items()]
        name = self.terms["text"] >= self.limits["text"] if "text" in self.terms else np.zeros(len(self.groups), bool)
        count = np.sum(held, axis=0) if held else np.zeros(len(self.groups))
        return sorted((int(i) for i in self._ordered()), key=lambda i: (-int(name[i]), -int(count[i])))

    def candidate(self, index: int) -> Candidate:
        """One of them as a person is told of it."""
        terms = {name: float(v[index]) for name, v in self.terms.items() if not np.isnan(v[index])}
        return candidate_of(self.groups[index], float(self.score[index]), terms)

    def _ordered(self) -> NDArray[np.intp]:
        return np.lexsort((np.array([g.id for g in self.groups], dtype=np.int64), -self.score))


def candidate_of(group: Group, score: float = 1.0, terms: dict[str, float] | None = None) -> Candidate:
    """A group as a candidate; its label only where it is worth telling."""
    label = group.label if group.label_score >= NAMED else "object"
    return Candidate(group.id, label, _color_name(group.lab), group.box.center, group.box.size, score, terms or {})


@lru_cache(maxsize=4096)
def _color_name(lab: Vec3) -> str:
    return name_of(lab)


def alive(field: LanguageField, level: str) -> tuple[Group, ...]:
    """Groups that still have Gaussians: objects, structure, the leaves of the objects ("parts"), or all."""
    rows = (g for g in field.groups if g.count > 0)
    if level == "all":
        return tuple(rows)
    if level == "parts":
        split = {g.parent for g in field.groups if g.parent >= 0 and g.count > 0}
        return tuple(g for g in rows if g.level != "structure" and g.id not in split)
    return tuple(g for g in rows if g.level == level)


def pool(field: LanguageField, text: str) -> tuple[Group, ...]:
    """What a noun may mean at all."""
    if text in PARTS:
        return alive(field, "parts")
    if text in STRUCTURE:
        return tuple(g for g in alive(field, "structure") if g.label == STRUCTURE[text])
    return alive(field, "object")


def is_name(text: str) -> bool:
    """Whether a noun names a kind of thing, so that the encoder must be asked."""
    return text not in ANYTHING and text not in PARTS and text not in STRUCTURE


def likeness(field: LanguageField, encoder: Encoder | None, text: str, metres_per_unit: float | None) -> F64:
    """`[G]` how sure the encoder is that each group is a `text`; worked out once a phrase and table.

    A thing whose name is known but whose looks were never encoded (an insertion under another encoder) has it or not.

    Raises:
        BackendError: no encoder, or another than the table's.
    """
    if encoder is None:
        raise BackendError(f"finding {text!r} needs a text encoder; pass encoder='auto'")
    field.require_encoder(encoder.fingerprint)
    key = (encoder.fingerprint, text, str(metres_per_unit))
    if key not in field.answers:
        sizes = field.boxes.sizes * metres_per_unit if metres_per_unit is not None else None
        sure = probability(encoder, text, field.embeddings, sizes)
        meant = kinds_meant(encoder, text)
        unseen = ~field.embeddings.any(axis=1)
        named = [g.label_score >= OWN_COLOR and (g.label in meant or called(g.label, text)) for g in field.groups]
        known = np.array(named, dtype=bool)
        _make_room(field)
        field.answers[key] = np.where(unseen, known.astype(np.float64), sure)
    return field.answers[key]


def called(label: str, text: str) -> bool:
    """Whether a thing with this label is called so: "pastry display case" is a display case, and a case."""
    asked, name = normalise(text), normalise(label)
    return bool(asked) and name[-len(asked) :] == asked


def paintedness(field: LanguageField, word: str) -> F64:
    """`[G]` how well every group answers to a colour word; worked out once a word and table.

    Raises:
        UserError: unknown colour.
    """
    key = ("color", word)
    if key not in field.answers:
        _make_room(field)
        field.answers[key] = attributes.group_color_scores(field, word)
    return field.answers[key]


def _make_room(field: LanguageField) -> None:
    """Forget everything when much was asked: a batch of a million phrases must not fill the memory."""
    if len(field.answers) >= KEPT:
        field.answers.clear()


def kinds_meant(encoder: Encoder | None, text: str) -> frozenset[str]:
    """Names the encoder would give to what is asked for; empty where it has none, as for an open vocabulary."""
    return _covered(encoder, text) if encoder is not None and is_name(text) else frozenset()  # type: ignore[arg-type]


@lru_cache(maxsize=1024)
def _covered(encoder: Encoder, text: str) -> frozenset[str]:
    return encoder.vocabulary.covered(text, loose=True)


def scored(
    query: Query,
    field: LanguageField,
    encoder: Encoder | None,
    metres_per_unit: float | None,
    placed: Sequence[tuple[Relation, Sequence[Anchor]]],
) -> Scored:
    """Every candidate of a query with its terms.

    Args:
        metres_per_unit: of the scene, None if unknown.
        placed: the query's relations that are true or false, each with what it relates to.

    Raises:
        BackendError: the name needs an encoder that is not there.
        UserError: a colour word is unknown.
    """
    groups = pool(field, query.text)
    rows = np.array([g.id for g in groups], dtype=np.intp)
    terms: dict[str, F64] = {}
    limits: dict[str, float] = {}
    own = np.ones(len(groups), bool)
    if query.text in STRUCTURE:
        terms["text"], limits["text"] = np.ones(len(groups)), 0.5
    elif is_name(query.text) and groups:
        terms["text"] = likeness(field, encoder, query.text, metres_per_unit)[rows]
        limits["text"] = encoder.calibration.threshold if encoder is not None else 0.5
        meant = kinds_meant(encoder, query.text)
        own &= np.array([g.label in meant for g in groups], dtype=bool) if meant else True
    for word in query.colors:
        terms[f"color {word}"] = paintedness(field, word)[rows]
        limits[f"color {word}"] = attributes.COLOR_HOLDS
        own &= terms[f"color {word}"] >= OWN_COLOR
    for word in query.not_colors:
        terms[f"not {word}"] = 1 - paintedness(field, word)[rows]
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
    return Scored(groups, terms, limits, own)


def related(relation: Relation, groups: Sequence[Group], field: LanguageField, anchors: Sequence[Anchor]) -> F64:
    """`[C]` how well each group stands in a relation to the anchors, to the one it fits best; 0 for the anchors."""
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
