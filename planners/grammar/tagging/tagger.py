"""From words to clauses of tagged tokens: which word class each phrase has where it stands.

Knows context: a verb begins a clause, "red" before a noun is an attribute and elsewhere what something becomes, "left"
is a direction or a side. Refuses to know the words that are read one by one (special.py), how tokens combine
(grammar.lark) and what they do (commands.py).

The rules of preference, in order:
1. The longest phrase wins; of equal ones quantities, then compounds, colours, the closed vocabulary, plain nouns.
2. A word that can be a verb is one only where a clause begins; after "and" it also needs an object behind it
   ("delete the chair and plant" has one clause, "delete the chair and plant a tree" would have two).
3. A colour, size or side is an attribute if a noun follows; "the light blue" at the end is a light and its new colour.
4. "this", "that" and the like are pronouns unless a noun follows.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..vocabulary import lexicon, quantities
from ..vocabulary.verbs import Entry
from .context_rules import CARRYING, NOUNISH, Special
from .lookahead import NOUN_COLORS, color_at, compounds, is_plain, match, verb_classes
from .tags import Clause, Tag
from .words import Word

# "the smaller of the two" picks as a superlative does.
_COMPARATIVES = {"bigger": "largest", "larger": "largest", "smaller": "smallest", "taller": "tallest",
                 "shorter": "shortest"}  # fmt: skip
_REPEATABLE = ("DELETE", "SELECT", "HIDE", "ISOLATE")
MAX_NOUN_WORDS = 4


class Tagger(Special):
    """Reads one sentence; `clauses()` gives its clauses."""

    def __init__(self, words: Sequence[Word]) -> None:
        super().__init__(words)
        self.done: list[Clause] = []
        self.particles: set[int] = set()

    # ---- clauses -------------------------------------------------------------------------------------------------

    def clauses(self) -> list[Clause]:
        i = self._open(0)
        while i < len(self.texts):
            i = i + 1 if i in self.particles else self._boundary(i) or self._step(i)
        self._close()
        return self.done

    def _close(self) -> None:
        while self.clause.tags and self.clause.tags[-1].type in ("COMMA", "AND"):
            self.clause.tags.pop()
        if self.clause.tags or self.clause.unsupported or self.clause.negated:
            self.done.append(self.clause)
        self.clause = Clause()

    def _open(self, i: int) -> int:
        """Begin a clause at `i`: drop politeness, read its verb; the position behind."""
        j, negated = self.read.skip_polite(i)
        if negated:
            self.clause.negated = True
            self.clause.tags.append(Tag("NEGATION", None, self.words[i : j + 1]))
        found = self.read.verb(j)
        unsupported = match(lexicon.UNSUPPORTED_PHRASES, self.texts, j)
        if unsupported and (not found or unsupported[1] > found[1]):
            self.clause.unsupported = unsupported[0]
            self.clause.tags.append(Tag("UNSUPPORTED", unsupported[0], self.words[j : j + unsupported[1]]))
            return j + unsupported[1]
        if not found or (j + found[1] < len(self.texts) and self.read.verb_is_noun(j, found[1])):
            return j
        (kind, value), taken, particle = found
        if particle is not None:
            self.particles.add(particle)
        self.clause.verb = kind
        self.clause.tags.append(Tag(kind, value, self.words[j : j + taken]))
        return j + taken

    def _boundary(self, i: int) -> int | None:
        """The position behind the verb of a new clause, if one begins at `i`."""
        texts = self.texts
        j = i
        if texts[j] in (",", "and", "&", "then", "but", "plus"):
            if texts[j] == "but" and self.read.phrase(j) != (("BUT", None), 1):
                return None
            while j < len(texts) and texts[j] in (",", "and", "&", "then", "but", "also", "plus"):
                j += 1
        if j == i:
            return None
        forced = "then" in texts[i:j]
        if j >= len(texts):
            return j if forced else None
        if not forced and not self.read.verb_begins(j):
            return None
        self._close()
        behind = self._open(j)
        before = self.done[-1] if self.done else None
        if forced and not self.clause.tags and before and before.verb in _REPEATABLE:
            # "delete the chair, then the table": the verb is said once.
            self.clause = Clause([before.tags[0]], before.verb)
        return behind

    # ---- tokens --------------------------------------------------------------------------------------------------

    def _step(self, i: int) -> int:
        """Tag what stands at `i`; the position behind it."""
        texts = self.texts
        if texts[i] == ",":
            return self._comma(i)
        if texts[i] == ":" and self._before in verb_classes():
            return i + 1
        phrase = self.read.phrase(i)
        length = phrase[1] if phrase else 0
        for reader in (self._special, self._quantity, self._compound, self._color, self._attribute):
            if (found := reader(i, length)) is not None:
                return found
        filler = match(lexicon.FILLER, texts, i)
        if filler and filler[1] > length:
            return i + filler[1]
        if texts[i] in lexicon.PARTICIPLES and self.read.preposition_at(i + 1):
            return i + 1
        if phrase:
            return self._phrase(i, *phrase)
        return self._noun(i)

    def _comma(self, i: int) -> int:
        after = self.texts[i + 1 : i + 2]
        if not after or after[0] in ("and", "&", ",") or not self.clause.tags or self._before in ("AND", "COMMA"):
            return i + 1
        rest = self.read.phrase(i + 1)
        if rest and rest[0][0] in ("BUT", "NOT", "REL", "WITH", "BY", "CLOCK", "DIR", "PREP", "BETWEEN"):
            return i + 1
        return self._put("COMMA", None, i, 1)

    def _quantity(self, i: int, length: int) -> int | None:
        found = quantities.read(self.texts[i:])
        if not found or found.taken < length:
            return None
        behind = i + found.taken
        headed = self._before in ("COLOR", "SIZE", "SUP", "ORDINAL", "ADJ", "OTHER")
        if self.texts[i] == "one" and found.kind == "NUMBER" and (headed or not self.read.nouny(behind)):
            return None
        if found.kind == "LENGTH":
            if self.texts[behind : behind + 1] in (("tall",), ("high",)):
                before_noun = self.read.nouny(behind + 1)
                if before_noun or self.clause.verb in ("ADD", "PUT", "WANT"):
                    if self._before == "COMMA":
                        self.clause.tags.pop()
                    kind = "TALL" if before_noun else "TALLER"
                    return self._put(kind, (found.value, found.unit), i, found.taken + 1)
            return self._put("LENGTH", (found.value, found.unit), i, found.taken)
        return self._put(found.kind, found.value, i, found.taken)

    def _compound(self, i: int, length: int) -> int | None:
        found = match(compounds(), self.texts, i)
        return self._noun(i, found[1]) if found and found[1] >= length else None

    def _color(self, i: int, length: int) -> int | None:
        found = color_at(self.texts, i)
        if not found or found[1] < length:
            return None
        name, taken = found
        joined, length_of_all = self.read.colors(i)
        if joined and self._before in ("DET", "NUMBER", "SIZE", "COMMA", "AND", *verb_classes()):
            return self._put("COLORS", joined, i, length_of_all)
        if self.read.nouny(i + taken) or (self._before == "DET" and self._shares_noun(i + taken)):
            return self._put("COLOR", name, i, taken)
        follows_det = self._before in ("DET", "SIZE", "SUP", "ORDINAL", "COLOR") or (
            self._before in ("", *verb_classes()) and self.clause.verb != ""
        )
        if follows_det and taken == 2 and (self.texts[i] == "light" or self.texts[i] in NOUN_COLORS):
            return self._put("NOUN", self.texts[i], i, 1)
        if follows_det and taken == 1 and name in NOUN_COLORS and not self._indefinite_hue(i):
            return self._put("NOUN", name, i, 1)
        if self._before == "EVERYTHING" and self.clause.verb in ("DELETE", "SELECT", "HIDE", "ISOLATE", "MOVE", "KEEP"):
            self._put("REL", None, i, 0)  # "everything red" is everything that is red
        return self._put("HUE", name, i, taken)

    def _shares_noun(self, i: int) -> bool:
        """ "the red and the blue chair": whether the noun comes with a second colour."""
        second = self.texts[i : i + 2] in (("and", "the"), ("and", "my")) and color_at(self.texts, i + 2)
        return bool(second) and self.read.nouny(i + 2)

    def _indefinite_hue(self, i: int) -> bool:
        """ "give it an orange colour": the article belongs to the colour word behind."""
        found = self.read.phrase(i + 1)
        return bool(found) and found[0][0] == "COLORWORD"  # type: ignore[index]

    def _attribute(self, i: int, length: int) -> int | None:
        found = match(lexicon.ATTRIBUTE_PHRASES, self.texts, i)
        if not found or found[1] < length:
            return None
        (kind, value), taken = found
        behind = self.texts[i + taken : i + taken + 1]
        after_det = self._before in ("DET", "POSS", "NUMBER", "ORDINAL")
        if self.read.nouny(i + taken) and (after_det or self._before not in NOUNISH):
            return self._put(kind, value, i, taken)
        if after_det and self.texts[i] in ("back", "top", "front", "bottom", "left", "right") and behind == ("of",):
            return self._put("NOUN", self.texts[i], i, 1)
        if kind == "SIZE" and self._before == "DET" and behind == ("of",) and self.texts[i] in _COMPARATIVES:
            return self._put("SUP", _COMPARATIVES[self.texts[i]], i, taken)
        if kind == "SUP" and after_det and (self._before == "DET" or self._before == "ORDINAL"):
            return self._put(kind, value, i, taken)
        if kind == "SIZE" and not length:
            return self._put("SIZEWORD", value, i, taken)
        return None

    def _phrase(self, i: int, entry: Entry, taken: int) -> int:
        """A phrase of the closed vocabulary, adjusted to its surroundings."""
        kind, value = entry
        text, behind = self.texts[i], i + taken
        if kind == "DET" and taken == 1:
            return self._determiner(i, value)
        if (
            kind == "ONE"
            and not value
            and self.read.nouny(behind)
            and self._before not in ("COLOR", "SIZE", "SUP", "DET")
        ):
            return self._put("NUMBER", 1.0, i, 1)
        if kind == "NOT" and self._before in ("EVERYTHING", "NOUN", "THING") and self.read.hue_follows(behind):
            self._put("REL", None, i, 0)
            return self._put("NOT", None, i, taken)
        sided = kind in ("DIR", "SIDE", "SPOT", "NOWHERE") and self.texts[i + 1 : i + 2] == ("the",)
        if sided and self.read.nouny(behind):
            # "to the left wall": the side belongs to the noun.
            return self._phrase(i, lexicon.INSIDE_PHRASES[text,], 1)
        if kind == "NOT" and self._before != "REL":
            return self._put("NOT" if self.read.preposition_at(behind) else "BUT", None, i, taken)
        if kind == "REL" and self.read.preposition_at(behind):
            return behind
        if kind == "AND":
            if self.read.preposition_at(behind):
                return self._put("ANDREL", None, i, taken)
            if text == "and" and self._before in ("AND", "COMMA"):
                return behind
        if kind == "PREP" and taken == 1 and text in ("in", "on", "at") and behind >= len(self.texts):
            return self._put("UNKNOWN", None, i, taken)
        if kind == "COLORWORD" and text == "tint" and self._before in NOUNISH:
            return self._put("UNKNOWN", None, i, taken)
        return self._put(kind, value, i, taken)

    def _determiner(self, i: int, value: str) -> int:
        """ "this" or "all": a determiner before a noun, a pronoun otherwise."""
        text = self.texts[i]
        noun_follows = self.read.nouny(i + 1) or self.read.opens_noun(i + 1)
        if text in ("this", "that", "these", "those") and not noun_follows:
            return self._put("PRON", "it", i, 1)
        if text == "all" and not noun_follows:
            return self._put("EVERYTHING", None, i, 1)
        if text == "both" and not noun_follows:
            return self._put("PRON", "it", i, 1)
        return self._put("DET", value, i, 1)

    def _noun(self, i: int, at_least: int = 0) -> int:
        """A run of plain words: a noun, or adjectives if a colour or size follows before the noun."""
        if not at_least and self.texts[i] == "non" and (found := color_at(self.texts, i + 1)):
            return self._put("NONCOLOR", found[0], i, 1 + found[1])
        if not at_least and not is_plain(self.texts[i]):
            return self._put("UNKNOWN", None, i, 1)
        j = i + max(at_least, 1)
        while j < len(self.texts) and self._continues_noun(j):
            j += 1
        kind = "NOUN" if j - i <= MAX_NOUN_WORDS else "UNKNOWN"
        if kind == "NOUN" and self._before in ("DET", "COLOR", "SIZE", "ADJ") and self.read.colored_noun(j):
            kind = "ADJ"
        return self._put(kind, " ".join(self.texts[i:j]), i, j - i)

    def _continues_noun(self, j: int) -> bool:
        texts = self.texts
        if not is_plain(texts[j]) or texts[j] == ",":
            return False
        tables = (lexicon.INSIDE_PHRASES, lexicon.FILLER)
        if (
            self._facing_at(j)
            or match(CARRYING, texts, j)
            or any(match(t, texts, j) for t in tables)
            or texts[j] in lexicon.PARTICIPLES
        ):
            return False
        return not color_at(texts, j) and not quantities.read(texts[j:])
