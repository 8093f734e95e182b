"""The order of a clause: verbs between a thing and its place, places that stand before their thing, asides.

`read.py` reads a description from left to right; what it cannot see from one word is decided here by looking ahead.
"""

from __future__ import annotations

from ....gaussians.world import everyday
from ....gaussians.world.words import singular
from ...grammar.tagging.lookahead import color_at, match
from ...grammar.tagging.words import bag
from ...grammar.vocabulary import quantities
from .. import knowledge
from . import vocabulary
from .noun_phrases import ADJECTIVES, NounPhrases
from .relating import sides_at

_BOUNDS = frozenset({",", ";", ".", ":", "-", "!", "?", "\n", "(", ")"})
_BEFORE_FRONT = frozenset({*_BOUNDS, "and", "but", "with", "where", "then", "while"})
_SENTENCE = frozenset({".", ";", ":", "!", "?", "\n", "-"})
# Verbs of being somewhere. Those that are nouns as well are verbs only where the words around them leave no noun.
_VERBS = bag(
    "stand stands sit sits hang hangs lie lies rest rests lean leans run runs go goes dangle dangles stood dangling "
    "sprawls sprawl hides wait waits tower towers await awaits occupies occupy"
)
_BEING = bag("there is are theres s was were you we has have find finds come comes be")
_ARTICLES = bag("a an the its their his her my our your this that one another some several many each every both")
_AFTER_VERB = _ARTICLES | bag(
    "on in at by near next under against behind along between from beside above over around opposite to before up"
)
_ASIDES = (
    ("used", "as"), ("serving", "as"), ("that", "serves", "as"), ("acting", "as"), ("shaped", "like"),
    ("in", "the", "shape", "of"), ("in", "the", "form", "of"), ("disguised", "as"), ("doubling", "as"),
    ("looking", "like"), ("that", "looks", "like"),
)  # fmt: skip
_MANTELS = bag("mantel mantelpiece mantle mantlepiece chimneypiece chimneybreast")
_SCENERY = bag(
    "lake sea ocean river beach shore seaside coast mountain mountains hills road roadside harbour harbor canal stream "
    "seafront waterfront riverside lakeside water valley cliff cliffs countryside sunset railway highway motorway"
)
_WAYS_IN = bag("entrance entry doorway entryway")
_TO_WAY_IN = frozenset({"by", "near", "beside", "to", "at", "opposite", "facing", "from", "flanking", "of", "behind"})
_AGENTS = ("er", "or", "ist", "man", "men", "woman", "ian", "smith", "mate", "ant")
_PRONOUNS = bag("it them this these those each both")
_MOST = 4  # unknown words of one noun phrase
NOBODY = frozenset({*vocabulary.PEOPLE, *bag(
    "painter potter artist musician chef cook baker writer student teenager kid grandma grandpa gran nan mum dad "
    "drummer dancer gamer reader barista waiter hairdresser customer shopper worshipper audience crowd everyone "
    "everybody someone anyone mothers parents staff spectators watching waiting lads lad boys girls folks team crew "
    "gang household newlyweds pensioner pensioners nurse nurses knights knight monk monks nun nuns king queen princess "
    "prince wizard witch pirate pirates vampire detective dog dogs cat cats"
)})  # fmt: skip


class Clauses(NounPhrases):
    """Questions about the clauses of one description."""

    def straighten(self) -> None:
        """Take away verbs of being somewhere and asides, and let "the entrance" be the door."""
        i = 0
        while i < len(self.texts):
            if self.texts[i] in ("separates", "separating", "divides", "dividing", "separate"):
                self._separate(i)
            asides = (self._aside, self._persons, self._potted, self._made_of, self._scenery)
            if taken := next((n for aside in asides if (n := aside(i))), 0):
                del self.texts[i : i + taken]
            elif self._is_being_verb(i):
                self.texts[i] = "is"
                i += 1
            else:
                if self.texts[i] in _MANTELS and "fireplace" in self.texts:
                    self.texts[i] = "fireplace"
                if self.texts[i] in _WAYS_IN and set(self.texts[max(i - 3, 0) : i]) & _TO_WAY_IN:
                    self.texts[i] = "door"
                i += 1

    def _separate(self, i: int) -> None:
        """Let "separates the bed from the sofa" be "between the bed and the sofa"."""
        end = self.phrase_end(i + 1)
        if end > i + 1 and self.texts[end : end + 1] in (["from"], ["and"]):
            self.texts[i], self.texts[end] = "between", "and"

    def _aside(self, i: int) -> int:
        """The number of words of an aside at position `i`: "used as a table", "shaped like a moon"."""
        for phrase in _ASIDES:
            if tuple(self.texts[i : i + len(phrase)]) == phrase:
                end = self.phrase_end(i + len(phrase))
                return max(end, i + len(phrase) + 1) - i
        return 0

    def _scenery(self, i: int) -> int:
        """The number of words of "by the lake" at position `i`: what is around the place is not built."""
        if self.texts[i] not in ("by", "near", "beside", "on", "overlooking", "at", "along", "with"):
            return 0
        sight = self.texts[i + 1 : i + 4] == ["a", "view", "of"]
        if self.texts[i] == "with" and not sight:
            return 0
        j = i + 1 + 3 * sight
        j += self.texts[j : j + 1] in (["the"], ["a"])
        ends = j + 1 >= len(self.texts) or self.texts[j + 1] in {*_BOUNDS, "and", "with", "where"}
        return j + 1 - i if j > i + 1 and ends and "".join(self.texts[j : j + 1]) in _SCENERY else 0

    def _potted(self, i: int) -> int:
        """The number of words of "in big pots" behind a plant at position `i`: it is drawn with its pot."""
        name = knowledge.lookup(knowledge.thing_words(), self.texts, i - 1) if self.texts[i] == "in" and i else None
        if name is None or everyday.shape(name[0]) not in ("potted plant", "bush", "tree"):
            return 0
        end = self.phrase_end(i + 1)
        return end - i if singular(self.texts[end - 1]) in ("pot", "tub", "planter", "box", "barrel", "urn") else 0

    def _made_of(self, i: int) -> int:
        """The number of words of "made of bamboo" at position `i`."""
        taken = 2 if self.texts[i : i + 2] in (["made", "of"], ["made", "from"], ["carved", "from"]) else 0
        taken = taken or 3 * (self.texts[i : i + 3] == ["made", "out", "of"])
        return taken and max(self.phrase_end(i + taken), i + taken + 1) - i

    def _persons(self, i: int) -> int:
        """The number of words of "for a painter", "for people waiting": whom a thing is for."""
        if self.texts[i] != "for" or not i:
            return 0
        j = i + 1
        while j < len(self.texts) and (self.texts[j] in _ARTICLES or self.texts[j] in ADJECTIVES):
            j += 1
        start = j
        while j < len(self.texts) and self.texts[j] in NOBODY:
            j += 1
        if j == start and (end := self._agent_end(j)):
            j = end
        ends = j == len(self.texts) or self.texts[j] in _BOUNDS or self.texts[j] in ("and", "with", "in", "by", "on")
        return j - i if j > start and (ends or match(vocabulary.RELATIONS, self.texts, j)) else 0

    def _agent_end(self, i: int) -> int:
        """The position behind "violin maker" at position `i`: somebody, by the ending of the last word; 0 if not."""
        for j in range(i, min(i + 3, len(self.texts))):
            if (
                self.texts[j] in _BOUNDS
                or match(vocabulary.RELATIONS, self.texts, j)
                or quantities.read([self.texts[j]])
            ):
                return 0
            word = singular(self.texts[j])
            last = (
                j + 1 == len(self.texts) or self.texts[j + 1] in _BOUNDS or self.texts[j + 1] in ("and", "with", "in")
            )
            known = knowledge.lookup(knowledge.thing_words(), self.texts, j)
            if last:
                named = word in NOBODY or (word.endswith(_AGENTS) and not known)
                return j + 1 if named else 0
        return 0

    def _is_being_verb(self, i: int) -> bool:
        """Whether a word is a verb of being somewhere: "the cage stands by", "on it sits a cake"."""
        word, after = self.texts[i], self.texts[i + 1] if i + 1 < len(self.texts) else "."
        if word not in _VERBS or not i:
            return False
        counted = quantities.read([after])
        if after not in _AFTER_VERB and not (counted and counted.kind == "NUMBER"):
            return False
        inverted = after in _ARTICLES or bool(counted)
        if inverted and (self.before(i) in _ARTICLES or color_at(self.texts, i - 1)):
            return False
        if not word.endswith("s"):  # "two chairs stand by": after a plural or a place
            return self.before(i).endswith(("s", "n")) or inverted
        return inverted or self._one_before(i)

    def _one_before(self, i: int) -> bool:
        """Whether the noun phrase that ends before position `i` is about one thing: "the bird cage stands"."""
        j, words = i - 1, 0
        while j >= 0 and words <= _MOST and self.texts[j] not in _BOUNDS:
            if self.texts[j] in ("a", "an", "the", "one", "my", "its", "another", "that", "which"):
                return words > 0 or self.texts[j] in ("that", "which")
            number = quantities.read([self.texts[j]])
            if number and number.kind == "NUMBER":
                return False
            j, words = j - 1, words + 1
        return False

    def is_heading(self, end: int) -> bool:
        """Whether a text begins with the place that it describes, without an article: "bus shelter, one bench, …"."""
        if self.texts[end : end + 1] != [","] or self.texts[0] in _ARTICLES or quantities.read(self.texts[:1]):
            return False
        number = quantities.read(self.texts[end + 1 :])
        return self.texts[end + 1 : end + 2] in (["a"], ["an"], ["one"], ["the"]) or bool(
            number and number.kind in ("NUMBER", "LENGTH")
        )

    # ---- places before their thing ---------------------------------------------------------------------------------

    def comes_first(self, i: int) -> bool:
        """Whether a place at position `i` stands before its thing: "…, on it two candles", "and under it a box"."""
        before = self.before(i)
        if before not in _BEFORE_FRONT:
            return False
        end = self._place_end(i)
        if not end:
            return False
        lone = before in _SENTENCE or (before == "," and i > 1 and self.texts[i - 2] in ("and", *_SENTENCE))
        j = end
        while j < len(self.texts) and (self.texts[j] in _BEING or self.texts[j] in _VERBS):
            j += 1
        verb = j > end
        if lone and self.texts[j : j + 1] in ([","], [":"]) and not verb:
            j += 1
        if j >= len(self.texts) or self.texts[j] in _BOUNDS:
            return False
        number = quantities.read(self.texts[j:])
        opened = self.texts[j] in ("a", "an", "another", "some", "several", "one") or (
            number is not None and number.kind == "NUMBER"
        )
        opened = opened or bool(match(vocabulary.COUNTS, self.texts, j)) or (verb and self.texts[j] in _ARTICLES)
        return opened or ((verb or end < j) and self.noun_follows(j))

    def goes_on(self, i: int, listed: bool) -> bool:
        """Whether the list that a comma at position `i` is in ends with "and": ", a drip stand and a curtain".

        `listed`: whether there was a comma in it before.
        """
        if self.texts[i + 1 : i + 2] == ["and"]:
            return listed
        for j in range(i + 1, len(self.texts)):
            if self.texts[j] in _SENTENCE or match(vocabulary.SPOTS, self.texts, j):
                return False
            if self.texts[j] == ",":
                return self.texts[j + 1 : j + 2] == ["and"]
            if self.texts[j] == "and":
                return True
            if match(vocabulary.RELATIONS, self.texts, j) and self.texts[j] not in ("of", "for"):
                return False
        return False

    def _place_end(self, i: int) -> int:
        """The position behind a place at position `i`; 0 if there is none."""
        if taken := sides_at(self.texts, i):
            of = self.texts[i + taken - 1] == "of"
            return self.phrase_end(i + taken) if of else i + taken
        spot, found = match(vocabulary.SPOTS, self.texts, i), match(vocabulary.RELATIONS, self.texts, i)
        if spot and (not found or spot[1] > found[1]) and self.texts[i + spot[1] : i + spot[1] + 1] != ["of"]:
            return i + spot[1]
        if found and self.texts[i] not in ("of", "from") and found[0] not in ("from",):
            end = self.phrase_end(i + found[1])
            if end > i + found[1]:
                return max(end, i + spot[1] if spot else 0)
        return i + spot[1] if spot else 0

    def phrase_end(self, i: int) -> int:
        """The position behind the noun phrase at position `i`; `i` if there is none."""
        texts, j = self.texts, i
        if texts[j : j + 1] and texts[j] in _PRONOUNS and self._closes(j + 1):
            return j + 1 + 2 * (texts[j + 1 : j + 3] in (["of", "them"], ["of", "these"]))
        while j < len(texts) and (texts[j] in _ARTICLES or texts[j] in ADJECTIVES or texts[j] in vocabulary.WALLS
                                  or color_at(texts, j) or quantities.read(texts[j : j + 1])):  # fmt: skip
            if self.name_at(j) and not color_at(texts, j):
                break
            j += 1
        for _ in range(_MOST):
            if j >= len(texts) or texts[j] in _BOUNDS or texts[j] in _BEING:
                break
            if texts[j] in vocabulary.PARTS and not self.name_at(j):
                j += 1
                return self.phrase_end(j + 1) if texts[j : j + 1] == ["of"] else j
            if found := self.name_at(j):
                j += found[1]
                while more := self.name_at(j):
                    j += more[1]
                end, content = self.content(j)
                return end if content else j
            if texts[j] in ("and", "with") or match(vocabulary.RELATIONS, texts, j):
                break
            j += 1
        return j

    def one_of(self, i: int) -> int:
        """The number of words of "one", "the other", "one of them", "the second" that stand for a thing; else 0."""
        texts = self.texts
        j = i + (texts[i : i + 1] in (["the"], ["each"]))
        if j >= len(texts) or texts[j] not in ("one", "other", "first", "second", "third", "latter", "former"):
            return 0
        j += 1
        j += texts[j : j + 1] == ["one"]
        if texts[j : j + 2] in (["of", "them"], ["of", "these"]):
            return j + 2 - i
        ends = j >= len(texts) or texts[j] in _BOUNDS or texts[j] in ("and", "with")
        return j - i if ends else 0

    def _closes(self, j: int) -> bool:
        """Whether a pronoun before position `j` stands alone."""
        return j >= len(self.texts) or not self.name_at(j)
