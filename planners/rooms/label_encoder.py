"""A text encoder that compares phrases with the labels of a scene graph by their words, without a neural network.

It compares head nouns ("lamp" means a floor lamp), synonyms and words for families from the table of kinds. It
implements the `Encoder` protocol, so that queries on a graph use the same resolver as queries on scenes: a thing's
vector is one-hot on its label, and a phrase's vector holds how well it names each label.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from ...gaussians.errors import BackendError
from ...gaussians.language.encoders.calibration import Calibration
from ...gaussians.language.encoders.vocabulary import Vocabulary
from ...gaussians.world import kinds
from ...gaussians.world.everyday_names import GENERIC, PEOPLE, same_name
from ...gaussians.world.kinds import Phrase
from ...gaussians.world.words import AFTER_HEAD, normalise
from ..grammar.tagging.spelling import misspelled_name

# Probability that a phrase means a label, by how the two agree; BESIDE is that of a synonym where another label is the
# very name, and less than the share of that one's score at which the resolver sees a rival (`picking.NAME_LEAD`).
EXACT, ALIKE, LOOSE, BROADER, NOT = 0.98, 0.5, 0.4, 0.26, 1e-4
BESIDE = 0.28
THRESHOLD = 0.2
_SHORTEST_END, _SHORTEST_START = 5, 3  # letters of the two halves of a compound in one word
_CAMEL = re.compile(r"(?<=[a-z]{2})(?=[A-Z][a-z]{2})")
_FIXED = frozenset({("wall",), ("floor",), ("ceiling",)})
_ABSENT = "nothing of all this"
# Of "a stack of books" either may be meant, the stack or the books; "a picture of a dog" is only a picture.
_COLLECTIVE = frozenset({"stack", "pile", "pair", "bunch", "set", "row", "group", "bouquet", "collection"})


@cache
def vocabulary() -> Vocabulary:
    """The vocabulary of the embedded encoder, without loading its weights."""
    return Vocabulary.household()


@dataclass(frozen=True)
class _Labels(Vocabulary):
    """What competes with a phrase: that it names nothing here, and no kinds; and which labels it names best.

    Attributes:
        labels: of the graph.
    """

    labels: tuple[str, ...] = ()

    def covered(self, text: str, loose: bool = False) -> frozenset[str]:
        """With `loose`, the labels that agree best with a phrase: an exact name leaves no room for a synonym."""
        if not loose:
            return frozenset()
        found = agreement(text, self.labels)
        best = max(found, default=NOT)
        return frozenset(n for n, p in zip(self.labels, found, strict=True) if p == best >= THRESHOLD)


@dataclass(frozen=True, eq=False)
class WordEncoder:
    """The labels of one graph as an encoder.

    Attributes:
        labels: what is there, as written; one axis each.
    """

    labels: tuple[str, ...]

    @cached_property
    def fingerprint(self) -> str:
        return "words-" + hashlib.sha256("\n".join(self.labels).encode()).hexdigest()[:16]

    @property
    def dim(self) -> int:
        return max(len(self.labels), 1)

    @property
    def image_size(self) -> int:
        return 1

    @cached_property
    def vocabulary(self) -> Vocabulary:
        return _Labels({}, {}, (_ABSENT,), labels=self.labels)

    @property
    def calibration(self) -> Calibration:
        return Calibration(scale=1.0, threshold=THRESHOLD)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        """`[T, D]`: for each label the log odds that the phrase means it. The rows are not unit vectors: against the
        zero row of "nothing of all this", the rule of calibration.py turns them back into these probabilities."""
        rows = np.zeros((len(texts), self.dim), dtype=np.float32)
        for row, text in zip(rows, texts, strict=True):
            if text != _ABSENT:
                row[: len(self.labels)] = [math.log(p / (1 - p)) for p in agreement(text, self.labels)]
        return rows

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Refused.

        Raises:
            BackendError: always; a graph has no pictures.
        """
        raise BackendError("the word encoder sees no pictures; embed a scene with another encoder")

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()

    def knows(self, text: str) -> bool:
        return True

    def meant(self, text: str) -> str:
        """What a misspelt phrase was read as, "" if it was taken as it stands."""
        asked = words(text)
        plain = [_agrees(asked, words(label)) for label in self.labels]
        if all(p < THRESHOLD for p in plain) and not any(_covers(asked, words(label)) for label in self.labels):
            meant = respelt(asked, self.labels)
            return " ".join(meant) if meant != asked else ""
        return ""

    def of(self, label: str) -> NDArray[np.float32]:
        """`[D]`, a thing's vector."""
        row = np.zeros(self.dim, dtype=np.float32)
        if label in self.labels:
            row[self.labels.index(label)] = 1.0
        return row


def agreement(text: str, labels: Sequence[str]) -> list[float]:
    """How likely `text` means a thing with each of the labels; a looser word only where no label agrees better."""
    asked = words(text)
    found = [_says(asked, label) for label in labels]
    if max(found, default=NOT) > LOOSE:
        found = [NOT if p == LOOSE else p for p in found]
    if max(found, default=NOT) == EXACT:
        synonym = [p == ALIKE and not set(asked) <= set(words(n)) for p, n in zip(found, labels, strict=True)]
        found = [BESIDE if other else p for p, other in zip(found, synonym, strict=True)]
    if all(p < THRESHOLD for p in found):
        found = [_by_everyday_name(asked, _label_words(label)) for label in labels]
    if all(p < THRESHOLD for p in found):
        found = [
            BROADER if _covers(asked, _label_words(label)) or _closes(asked, _label_words(label)) else p
            for label, p in zip(labels, found, strict=True)
        ]
    if all(p < THRESHOLD for p in found) and (meant := respelt(asked, labels)) != asked:
        found = [_says(meant, label) for label in labels]
    return found


@cache
def _by_everyday_name(asked: Phrase, label: Phrase) -> float:
    """How a phrase agrees with a label by another everyday word for its head, or without whose it is."""
    if not asked:
        return NOT
    owned = asked[1:] if len(asked) > 1 and asked[0] in PEOPLE else asked
    heads = (owned[-1], *sorted(same_name(owned[-1])))
    best = max(_agrees((*owned[:-1], head), label) for head in heads)
    if best < THRESHOLD and owned == asked and len(asked) == 1 and asked[0] in GENERIC and label not in _FIXED:
        return BROADER
    return min(best, ALIKE)


def respelt(asked: Phrase, labels: Sequence[str]) -> Phrase:
    """A phrase with its unknown words exchanged for the one word of the labels that is a slip of the keyboard away."""
    return _respelt(asked, frozenset(w for label in labels for w in words(label)))


@cache
def _respelt(asked: Phrase, there: frozenset[str]) -> Phrase:
    return tuple(misspelled_name(w, there) or w for w in asked)


@cache
def words(text: str) -> Phrase:
    """A phrase as singular words in lower case; a script without Latin letters counts as one word.

    "CoffeeTable" is two words, and "003" the number 3.
    """
    found = normalise(_CAMEL.sub(" ", text)) or tuple(text.casefold().split())
    return tuple(w.lstrip("0") or "0" if w.isdecimal() else w for w in found)


@cache
def _label_words(label: str) -> Phrase:
    """The words of a label without the serial number at its end: "Chair.003", "bed #2", "lamp (1)"."""
    found = words(label)
    while len(found) > 1 and found[-1].isdecimal():
        found = found[:-1]
    return found


def _says(asked: Phrase, label: str) -> float:
    """How a phrase agrees with a label, with its serial number or without."""
    whole, plain = words(label), _label_words(label)
    how = _agrees(asked, whole)
    return how if plain == whole or how > NOT else _agrees(asked, plain)


@cache
def _agrees(asked: Phrase, label: Phrase) -> float:
    if not asked or not label:
        return NOT
    if asked == label:
        return EXACT
    if "".join(asked) == "".join(label):
        return EXACT  # "lawnmower" and "lawn mower"
    if (how := _names(asked, label)) > NOT:
        return how
    plain = _plainer(asked)
    # A "round table" may be a plain "table", but not a "square table".
    same = plain != asked and asked not in _own_names() and set(label) - set(_plainer(label)) <= set(asked)
    return _names(plain, label) if same and _may_be(asked, plain, label) else NOT


def _may_be(asked: Phrase, plain: Phrase, label: Phrase) -> bool:
    """Whether a phrase without its modifiers may still mean a label.

    A phrase that names a kind ("wine rack", "dining table") means another kind only by its plain name: a "dining table"
    may be labelled "table", but it is no "coffee table", and a "wine rack" is neither a "coat rack" nor a "shelf".
    """
    own, other = kinds.find(" ".join(asked)), kinds.find(" ".join(label))
    return own is None or other is None or own == other or label == plain


def _names(asked: Phrase, label: Phrase) -> float:
    """ALIKE: the label ends with what is asked, holds all of it with its head, or is a synonym of it as a whole. LOOSE:
    it only ends with a synonym ("lamp": ceiling light)."""
    alike = _alike(asked)
    ends = (
        alike - kinds.whole_labels() - ({asked[-1:]} if len(asked) > 1 else set())
    )  # a square table ends like a round one
    best = NOT
    for form in _forms(label):
        if form[-len(asked) :] == asked or form in alike or asked in _alike(form):
            return ALIKE
        if form[-1] == asked[-1] and set(asked) <= set(form):
            return ALIKE
        if any(form[i:] in ends for i in range(1, len(form))):
            best = LOOSE
    return best


def _closes(asked: Phrase, label: Phrase) -> bool:
    """Whether one word is the end of a compound that a label writes as one: "bench" of "workbench"."""
    if len(asked) != 1 or len(asked[0]) < _SHORTEST_END:
        return False
    head = label[-1]
    return head.endswith(asked[0]) and len(head) - len(asked[0]) >= _SHORTEST_START


def _forms(label: Phrase) -> tuple[Phrase, ...]:
    """The label without what stands behind its head; of a collection ("stack of books") also what it is made of."""
    cut = next((i for i, w in enumerate(label) if i and w in AFTER_HEAD), len(label))
    head = label[:cut]
    if "of" not in head[1:-1]:
        return (head,)
    at = head.index("of", 1)
    return (head[:at], head[at + 1 :], head) if head[at - 1] in _COLLECTIVE else (head[:at], head)


@cache
def _alike(phrase: Phrase) -> frozenset[Phrase]:
    """The phrase and its synonyms, also those of its head alone ("floor light": floor lamp)."""
    found = kinds.same(phrase)
    if len(phrase) == 2:
        found |= {(*phrase[:-1], *other) for other in kinds.same(phrase[-1:]) if len(other) == 1}
    return found


def _plainer(asked: Phrase) -> Phrase:
    """Without leading words that do not change what a thing is: "wooden dining table" to "table"."""
    i = 0
    while i < len(asked) - 1 and asked[i] in vocabulary().modifiers:
        i += 1
    return asked[i:]


@cache
def _own_names() -> frozenset[Phrase]:
    """The names of kinds that looks tell apart. A "wall cabinet" or "round table" may be labelled by its plain name."""
    return frozenset(normalise(kind.name) for kind in kinds.table().kinds.values() if kind.shown)


@cache
def _covers(asked: Phrase, label: Phrase) -> bool:
    """Whether what is asked is a word for a family that the label belongs to."""
    return any(_names(member, label) > NOT for member in kinds.narrower(asked))
