"""The ways to read the noun of a query: as the kind it names, as kinds it covers, by names that are only likely.

"The chair" is first a thing of the kind chair; where none stands, an armchair or office chair; where the encoder's
pictures are not trusted, what looks most like a chair; and a word that the encoder does not know is read as the kind
that it is a sort of. A query takes the first reading under which something matches. Each says what it is, and whether
the name is confirmed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError
from ...world import kinds
from ...world.words import normalise
from ..encoders.known_words import is_loose, known_as
from ..encoders.probability import why_unknown
from ..field.language_field import LanguageField
from ..field.posterior import SURE, Belief, belief_of

if TYPE_CHECKING:
    from ..encoders import Encoder

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

OWN_NAME = 0.5  # label score from which a group has a name of its own


@dataclass(frozen=True, eq=False)
class Reading:
    """One way to read a noun.

    Attributes:
        scores: `[G]` probability that each group is what is meant.
        limit: the score from which it counts.
        confirmed: whether a match is confirmed to be what the noun names, and not only likely.
        kinds: labels that are exactly what is meant; empty if the noun names no kind.
        note: what to tell the user, with `{label}` for the label of what was chosen; "" for the plain reading.
    """

    scores: F64
    limit: float
    confirmed: bool
    kinds: frozenset[str]
    note: str = ""


def readings(field: LanguageField, encoder: Encoder | None, text: str, metres: float | None) -> Iterator[Reading]:
    """The readings of a noun that names a kind of thing, the closest first; there is at least one.

    Raises:
        BackendError: there is no encoder, or it is not that of the field.
    """
    if encoder is None:
        raise BackendError(f"finding {text!r} needs a text encoder; pass encoder='auto'")
    field.require_encoder(encoder.fingerprint)
    belief = belief_of(field, encoder, metres)
    exact = encoder.vocabulary.covered(text, loose=True)
    fit = _fits_size(belief, text)
    sized = fit is None or belief.scale is not None
    alone = np.ones(len(field.groups)) if fit is None else fit.astype(np.float64)
    threshold = encoder.calibration.threshold
    scores = _by_given_names(belief, text, exact, belief.shares(text).total * alone)
    note = "" if sized else _only_likely(text)
    if is_loose(text, encoder.vocabulary):
        sized, note = False, _read_as(text, next(iter(sorted(exact))))
    yield Reading(scores, belief.confirms, sized, exact, note)
    wide = _wide(belief, text)
    if wide:
        note = f"no plain {text} is here, so the {{label}} is meant" if wide > encoder.vocabulary.covered(text) else ""
        limit = max(belief.confirms, SURE)
        yield Reading(_by_given_names(belief, text, wide, belief.of_kinds(wide)), limit, True, wide, note)
    if belief.confirms > threshold:
        likely = belief.shares(text, trusting=True).total * alone
        yield Reading(_by_given_names(belief, text, exact, likely), threshold, False, exact, _only_likely(text))
        if wide:
            likely = belief.of_kinds(wide, trusting=True)
            yield Reading(_by_given_names(belief, text, wide, likely), SURE, False, wide, _only_likely(text))
    sort = known_as(text, encoder.vocabulary)
    if sort.relation == "sort":
        meant = frozenset(sort.kinds)
        note = _read_as(text, sort.kinds[0])
        yield Reading(_by_given_names(belief, text, meant, belief.of_kinds(meant)), belief.confirms, False, meant, note)


def is_known(encoder: Encoder, field: LanguageField, text: str) -> bool:
    """Whether the encoder knows a phrase, or a detector of the scene named something so."""
    belief = belief_of(field, encoder, None)
    return why_unknown(encoder, text) is None or bool(belief.meant(text).any())


def _read_as(text: str, kind: str) -> str:
    return f"{text!r} is read as {kind}"


def _only_likely(text: str) -> str:
    return f"{text!r} is only likely: the encoder does not know scenes like this one well"


def _wide(belief: Belief, text: str) -> frozenset[str]:
    """Kinds that a word covers beyond the kind that it names, which are named after it: "chair" also armchairs, "table"
    coffee tables but no desks; all kinds of a word that names a family alone ("seat"); empty for other words."""
    own = belief.encoder.vocabulary.covered(text)
    phrase = " ".join(normalise(text))
    members = {*belief.encoder.vocabulary.covered(text, loose=True), *kinds.table().families.get(phrase, ())}
    after = {name for name in members if len(own) != 1 or name in own or name.endswith(phrase)}
    found = frozenset(name for name in belief.names if name in after)
    return found if found - own or len(found) > 1 else frozenset()


def _fits_size(belief: Belief, text: str) -> Flags | None:
    """Whether the size of each group `[G]` may be that of the kind that a phrase names; None if it need not be asked.

    It is asked where the phrase names another kind than the vocabulary has for it: an "exercise ball" is among balls to
    the encoder, and only its size tells that it is one.
    """
    kind, vocabulary = kinds.of(text), belief.encoder.vocabulary
    phrase = normalise(text)
    if kind is None or kind.name in vocabulary.names or not vocabulary.covered(text):
        return None
    own = [normalise(name) for name in (kind.name, *kind.also)]
    if not any(phrase[-len(name) :] == name for name in own) or " ".join(phrase) in kinds.table().families:
        return None  # a word that means other kinds as well
    if kind.name in belief.names:  # a detector knows it
        return None
    return _has_size(belief, kind.name)


def _has_size(belief: Belief, kind: str) -> Flags:
    """Whether the size of each group `[G]` may be that of a kind; all may where metres are not known."""
    count = len(belief.field.groups)
    if belief.scale is None:
        return np.ones(count, dtype=bool)
    (w0, w1), (d0, d1), (h0, h1) = kinds.extent(kind)
    sizes = belief.field.boxes.sizes.reshape(count, 3) * belief.scale
    long = sizes[:, :2].max(axis=1)
    fits: Flags = (long >= max(w0, d0)) & (long <= max(w1, d1)) & (sizes[:, 2] >= h0) & (sizes[:, 2] <= h1)
    return fits


def _called_by_family(belief: Belief, text: str) -> Flags:
    """Whether the given name of each group `[G]` is that of the family alone to which the kind that a phrase names
    belongs, and its size may be that of the kind: a "lamp" half a metre high may be the desk lamp, no floor lamp."""
    kind = kinds.of(text)
    if kind is None or belief.scale is None:
        return np.zeros(len(belief.field.groups), dtype=bool)
    families = kinds.table().families
    called = [
        g.named_by != "" and kind.name in families.get(g.label, ()) and label_matches(kind.name, g.label)
        for g in belief.field.groups
    ]
    return np.array(called, dtype=bool) & _has_size(belief, kind.name)


def _by_given_names(belief: Belief, text: str, meant: frozenset[str], scores: F64) -> F64:
    """Scores `[G]` in which names from elsewhere decide.

    A group with a label but without any evidence (inserted under another encoder) scores 1 or 0 by its label. One that
    was given its name scores 1 by that name, and 0 by the name of another kind. Where one is called by the very words,
    another word for the same kind is the name of something else: a dresser is no "drawer" where drawers have names.
    """
    field, scores = belief.field, scores.copy()
    seen: Flags = np.asarray(field.embeddings.any(axis=1))
    families = _called_by_family(belief, text)
    worded = any(g.named_by and g.count and label_matches(g.label, text) for g in field.groups)
    for g in field.groups:
        unseen = not seen[g.id] and not g.votes
        if not unseen and not g.named_by:
            continue
        own = label_matches(g.label, text)
        same = families[g.id] or (kinds.of(text) is not None and kinds.of(g.label) is kinds.of(text))
        other = worded and g.named_by != "" and not own and same
        known = g.label_score >= OWN_NAME and (g.label in meant or own or (same and not worded)) and not other
        if unseen or known or other or _another_kind(g.label, text):
            scores[g.id] = float(known)
    return scores


def label_matches(label: str, text: str) -> bool:
    """Whether a label ends in the words of `text`: "pastry display case" is a display case, and a case."""
    if not label:
        return False
    asked, name = normalise(text), normalise(label)
    return bool(asked) and name[-len(asked) :] == asked


def _another_kind(label: str, text: str) -> bool:
    """Whether a label and a phrase name two different kinds of things."""
    named, asked = kinds.of(label), kinds.of(text)
    return named is not None and asked is not None and named is not asked
