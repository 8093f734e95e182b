"""Noun phrases of a description: names of things at a position, words before the head, and what follows "of".

`read.py` reads the phrases in their order and keeps the modifiers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ....gaussians.world.words import is_plural, singular
from ...grammar.tagging.lookahead import color_at, match, may_be_noun
from ...grammar.vocabulary import quantities
from .. import knowledge
from . import vocabulary
from .drafts import Said

_BEFORE_VERBS = frozenset({"to", "you", "we", "i", "can", "that", "which", "who", "will", "should", "must", "they"})
ADJECTIVES = frozenset(
    {*vocabulary.SIZES, *vocabulary.MATERIALS, *vocabulary.SHAPES, "old", "new", "wooden", "empty", "full", "plain"}
)


class NounPhrases:
    """Questions about the noun phrases of one description.

    Attributes:
        texts: its words.
        said: the modifiers before the next noun.
    """

    def __init__(self, texts: Sequence[str]) -> None:
        self.texts = list(texts)
        self.said = Said()
        self.has_place = False  # whether the place that is described was named, so that "the bar" is a thing in it

    def before(self, i: int) -> str:
        """The word before position `i`, "" at the beginning."""
        return self.texts[i - 1] if i else ""

    def sort(self, lead: Sequence[str], name: str) -> str:
        """The name of a thing with the words before it, unless those are materials or colours."""
        plain = [w for w in lead if w not in vocabulary.MATERIALS and w not in vocabulary.FILLER]
        for word in lead:
            if word in vocabulary.MATERIALS and not self.said.material:
                self.said = replace(self.said, material=word)
        return " ".join([*plain, name]) if plain else ""

    def name_at(self, i: int) -> tuple[str, int] | None:
        """The name of a thing at position `i`, unless it is a relation or a verb there."""
        if i >= len(self.texts) or self.texts[i] in (",", "and"):
            return None
        if self.is_verb(i, 1):
            found = knowledge.lookup(knowledge.thing_words(), self.texts, i)
            return found if found and found[1] > 1 else None  # a "floor lamp"
        if match(vocabulary.RELATIONS, self.texts, i) or match(vocabulary.SPOTS, self.texts, i):
            return None
        return knowledge.lookup(knowledge.thing_words(), self.texts, i)

    def names_room(self, i: int, taken: int) -> bool:
        """Whether a name at position `i` is part of that of a room: "vegetable garden", "bus station cafe"."""
        texts, j = self.texts, i + taken
        rooms = knowledge.room_words()
        if is_plural(texts[j - 1]):  # "the dogs room", of the dog
            return texts[j : j + 1] == ["room"] and not self.said.count
        if knowledge.lookup(rooms, texts, j):
            return True
        plain = j + 1 < len(texts) and texts[j] in vocabulary.PLACES and not self.name_at(j)
        return plain and knowledge.lookup(rooms, texts, j + 1) is not None

    def compound_at(self, i: int) -> tuple[int, tuple[str, int]] | None:
        """The head of a compound whose first noun ends before position `i`: where it begins, its name and length.

        An unknown word may stand between them: "dog food bags".
        """
        if found := self.name_at(i):
            return i, found
        if i + 1 >= len(self.texts) or not self._may_be_inner(i):
            return None
        found = self.name_at(i + 1)
        return (i + 1, found) if found else None

    def _may_be_inner(self, i: int) -> bool:
        text = self.texts[i]
        if not may_be_noun(text) or text in vocabulary.FILLER or text in vocabulary.PRONOUNS or text in ADJECTIVES:
            return False
        if text.endswith(("ed", "ing", "ly")) or is_plural(text) or text in vocabulary.PARTS or text in _BEFORE_VERBS:
            return False
        phrase = match(vocabulary.RELATIONS, self.texts, i) or match(vocabulary.SPOTS, self.texts, i)
        amount = quantities.read(self.texts[i : i + 1]) or match(vocabulary.COUNTS, self.texts, i)
        told = phrase or amount or color_at(self.texts, i) or match(vocabulary.NEGATIONS, self.texts, i)
        return not told and not match(vocabulary.ONLY, self.texts, i) and text not in ("each", "plus", "also", "facing")

    def noun_follows(self, i: int) -> bool:
        """Whether a noun phrase goes on at position `i` with the name of a thing, past adjectives."""
        while i < len(self.texts) and (self.texts[i] in ADJECTIVES or color_at(self.texts, i)):
            if self.name_at(i):
                return True
            i += 1
        return i < len(self.texts) and self.name_at(i) is not None

    def is_verb(self, i: int, taken: int) -> bool:
        """Whether a name of one word is a verb or a part of the room here: "can fit", "to plan", "the back"."""
        if taken > 1:
            return False
        text, before = self.texts[i], self.before(i)
        if text in ("bar", "bars") and self.has_place:
            return False
        return text in vocabulary.PARTS or (before in _BEFORE_VERBS and text not in knowledge.things())

    def content(self, i: int) -> tuple[int, str]:
        """What a thing is full of or made of: "of oranges" at position `i`; the end of the phrase and the noun."""
        texts = self.texts
        if texts[i : i + 1] != ["of"] or texts[i + 1 : i + 2] in (["each"], ["every"], ["them"]):
            return i, ""
        j = i + 1
        if quantities.read(texts[j : j + 1]):
            return i, ""
        while j < len(texts) and (texts[j] in ADJECTIVES or texts[j] in ("a", "an", "the", "some", "many")):
            j += 1
        while j < len(texts) and color_at(texts, j) and not self.name_at(j):
            j += color_at(texts, j)[1]  # type: ignore[index]
        if found := self.name_at(j):
            return j + found[1], found[0]
        if (
            j < len(texts)
            and not match(vocabulary.RELATIONS, texts, j)
            and may_be_noun(texts[j])
            and texts[j] not in vocabulary.FILLER
        ):
            if texts[j].endswith("ing") and (rest := self.name_at(j + 1)):
                return j + 1 + rest[1], f"{texts[j]} {rest[0]}"  # "wrapping paper"
            return j + 1, singular(texts[j])
        if j > i + 1 and texts[j - 1] in vocabulary.MATERIALS:
            return j, texts[j - 1]  # "a basket of wool"
        return i, ""

    def stood_before(self, i: int) -> bool:
        """Whether the word before position `i` ends a noun phrase."""
        return bool(i) and knowledge.lookup(knowledge.thing_words(), self.texts, i - 1) is not None
