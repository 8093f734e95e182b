"""From words to clauses of tagged tokens: which word class each phrase has where it stands.

Knows context: a verb begins a clause, "red" before a noun is an attribute and elsewhere what something becomes, "left"
is a direction or a side. Refuses to know how tokens combine (grammar.lark) and what they do (commands.py).

The rules of preference, in order:
1. The longest phrase wins; of equal ones quantities, then compounds, colours, the closed vocabulary, plain nouns.
2. A word that can be a verb is one only where a clause begins; after "and" it also needs an object behind it
   ("delete the chair and plant" has one clause, "delete the chair and plant a tree" would have two).
3. A colour, size or side is an attribute if a noun follows; "the light blue" at the end is a light and its new colour.
4. "this", "that" and the like are pronouns unless a noun follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from ...gaussians import color as colors
from . import lexicon, nouns, quantities
from .words import Word, bag

# Colours that are things as well ("delete the orange").
NOUN_COLORS = bag("orange rose peach apricot olive lime tomato salmon plum chocolate snow sand coral orchid wine mint")
_QUALIFIERS = ("very dark", "very light", "dark", "deep", "light", "pale", "bright", "vivid")
_OPENERS = frozenset({"DET", "PRON", "EVERYTHING", "NUMBER", "OTHERS"})
_NOUNISH = frozenset({"NOUN", "ONE", "THING"})
_BOUNDARIES = frozenset(".;!?\n:")
MAX_NOUN_WORDS = 4


@dataclass(frozen=True)
class Tag:
    """One token for the grammar: its class, what it means, and the words it was made from."""

    type: str
    value: Any
    words: tuple[Word, ...]

    @property
    def text(self) -> str:
        return " ".join(w.text for w in self.words)

    def __str__(self) -> str:
        return self.text


@dataclass
class Clause:
    """Tagged tokens of one clause; `verb` is the class of its first token, "" if it does not begin with a verb."""

    tags: list[Tag] = field(default_factory=list)
    verb: str = ""
    negated: bool = False
    unsupported: str = ""


def sentences(words: Sequence[Word]) -> Iterator[tuple[tuple[Word, ...], str]]:
    """The sentences and the mark each ends with ("" at the end of the text)."""
    start = 0
    for i, word in enumerate(words):
        if word.text in _BOUNDARIES:
            if i > start:
                yield tuple(words[start:i]), word.text
            start = i + 1
    if start < len(words):
        yield tuple(words[start:]), ""


@cache
def _color_names() -> frozenset[str]:
    return frozenset(n.replace(" ", "") for n in colors.names()) - {"transparent"}


def color_at(texts: Sequence[str], i: int) -> tuple[str, int] | None:
    """The colour phrase at `i` and how many words it has."""
    for taken in (4, 3, 2, 1):
        if i + taken > len(texts):
            continue
        phrase = " ".join(texts[i : i + taken])
        if _is_color(phrase):
            return phrase, taken
    return None


def _is_color(phrase: str) -> bool:
    joined = phrase.replace(" ", "").replace("grey", "gray")
    if joined in _color_names() or phrase.startswith("#"):
        return len(phrase) < 30
    for qualifier in _QUALIFIERS:
        if phrase.startswith(qualifier + " "):
            return _is_color(phrase[len(qualifier) + 1 :])
    if phrase.endswith("ish") and " " not in phrase:
        stem = phrase[:-3]
        return stem in _color_names() or stem.removesuffix("d") in _color_names()
    return False


def _match(table: Any, texts: Sequence[str], i: int) -> tuple[Any, int] | None:
    """The longest phrase of `table` (a dict or a set of word tuples) at `i`, with its entry and length."""
    for taken in range(min(lexicon.LONGEST, len(texts) - i), 0, -1):
        key = tuple(texts[i : i + taken])
        if key in table:
            return (table[key] if isinstance(table, dict) else key), taken
    return None


def is_plain(text: str) -> bool:
    """Whether a word may be (part of) a noun as far as its own form goes."""
    if not text[0].isalpha() or text in lexicon.STRUCTURE:
        return False
    return not (text.endswith("ly") and len(text) > 3 and text not in lexicon.ADVERB_NOUNS)


class Tagger:
    """Reads one sentence; `clauses()` gives its clauses."""

    def __init__(self, words: Sequence[Word]) -> None:
        self.words = tuple(words)
        self.texts = tuple(w.text for w in words)
        self.clause = Clause()
        self.done: list[Clause] = []

    # ---- clauses -------------------------------------------------------------------------------------------------

    def clauses(self) -> list[Clause]:
        i = self._open(0)
        while i < len(self.texts):
            i = self._boundary(i) or self._step(i)
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
        j, negated = self._skip_polite(i)
        if negated:
            self.clause.negated = True
            self.clause.tags.append(Tag("NEGATION", None, self.words[i : j + 1]))
        found = _match(lexicon.VERB_PHRASES, self.texts, j)
        unsupported = _match(lexicon.UNSUPPORTED_PHRASES, self.texts, j)
        if unsupported and (not found or unsupported[1] > found[1]):
            self.clause.unsupported = unsupported[0]
            self.clause.tags.append(Tag("UNSUPPORTED", unsupported[0], self.words[j : j + unsupported[1]]))
            return j + unsupported[1]
        if not found or (j + found[1] < len(self.texts) and self._verb_is_noun(j, found[1])):
            return i if not negated else j
        (kind, value), taken = found
        self.clause.verb = kind
        self.clause.tags.append(Tag(kind, value, self.words[j : j + taken]))
        return j + taken

    def _verb_is_noun(self, i: int, taken: int) -> bool:
        """ "light blue" or "cool colours" where a clause begins: an attribute, not a verb."""
        return taken == 1 and (found := color_at(self.texts, i)) is not None and found[1] > 1

    def _skip_polite(self, i: int) -> tuple[int, bool]:
        """Behind politeness, if a verb follows it, and whether the clause forbids; else `i` itself."""
        j = i
        while j < len(self.texts):
            texts = self.texts
            if texts[j] == "never" or texts[j : j + 2] == ("do", "not"):
                return j + (1 if texts[j] == "never" else 2), True
            verb = _match(lexicon.VERB_PHRASES, texts, j)
            polite = _match(lexicon.POLITE, texts, j) or _match(lexicon.FILLER, texts, j)
            if polite and (not verb or polite[1] > verb[1]):
                j += polite[1]
            elif texts[j] in (",", "to") and j > i:
                j += 1
            else:
                known = verb or _match(lexicon.UNSUPPORTED_PHRASES, texts, j)
                return (j, False) if known else (self._skip_filler(i), False)
        return self._skip_filler(i), False

    def _skip_filler(self, i: int) -> int:
        while found := _match(lexicon.FILLER, self.texts, i):
            i += found[1]
        return i

    def _boundary(self, i: int) -> int | None:
        """The position behind the verb of a new clause, if one begins at `i`."""
        texts = self.texts
        j = i
        if texts[j] in (",", "and", "&", "then", "but", "plus"):
            if texts[j] == "but" and _match(lexicon.INSIDE_PHRASES, texts, j) != (("BUT", None), 1):
                return None
            while j < len(texts) and texts[j] in (",", "and", "&", "then", "but", "also", "plus"):
                j += 1
        if j == i:
            return None
        forced = "then" in texts[i:j]
        if j >= len(texts):
            return j if forced else None
        if not forced and not self._verb_begins(j):
            return None
        self._close()
        return self._open(j)

    def _verb_begins(self, j: int) -> bool:
        """Whether a clause with a verb begins at `j`, behind "and" or a comma."""
        k, negated = self._skip_polite(j)
        if negated:
            return True
        if k < len(self.texts) and self.texts[k] == "first" and k == j:
            return False
        found = _match(lexicon.VERB_PHRASES, self.texts, k) or _match(lexicon.UNSUPPORTED_PHRASES, self.texts, k)
        if not found:
            return False
        taken = found[1]
        if taken > 1 or self.texts[k] not in lexicon.NOUN_VERBS:
            return True
        if _match(_compounds(), self.texts, k) or self._verb_is_noun(k, taken):
            return False
        return self._object_follows(k + 1)

    def _object_follows(self, i: int) -> bool:
        if i >= len(self.texts):
            return False
        found = _match(lexicon.INSIDE_PHRASES, self.texts, i)
        if found and found[0][0] in _OPENERS:
            return True
        return not found and (self._nouny(i) or quantities.read(self.texts[i:]) is not None)

    # ---- tokens --------------------------------------------------------------------------------------------------

    def _put(self, kind: str, value: Any, i: int, taken: int) -> int:
        self.clause.tags.append(Tag(kind, value, self.words[i : i + taken]))
        return i + taken

    @property
    def _before(self) -> str:
        return self.clause.tags[-1].type if self.clause.tags else ""

    def _step(self, i: int) -> int:
        """Tag what stands at `i`; the position behind it."""
        texts = self.texts
        if texts[i] == ",":
            return self._comma(i)
        phrase = _match(lexicon.INSIDE_PHRASES, texts, i)
        length = phrase[1] if phrase else 0
        for reader in (self._special, self._quantity, self._compound, self._color, self._attribute):
            if (found := reader(i, length)) is not None:
                return found
        filler = _match(lexicon.FILLER, texts, i)
        if filler and filler[1] > length:
            return i + filler[1]
        if texts[i] in lexicon.PARTICIPLES and self._preposition_at(i + 1):
            return i + 1
        if phrase:
            return self._phrase(i, *phrase)
        return self._noun(i)

    def _comma(self, i: int) -> int:
        after = self.texts[i + 1 : i + 2]
        if not after or after[0] in ("and", "&", ",") or not self.clause.tags or self._before in ("AND", "COMMA"):
            return i + 1
        rest = _match(lexicon.INSIDE_PHRASES, self.texts, i + 1)
        if rest and rest[0][0] in ("BUT", "NOT", "REL", "WITH", "BY", "CLOCK", "DIR") and self._before != "":
            return i + 1
        return self._put("COMMA", None, i, 1)

    def _preposition_at(self, i: int) -> bool:
        found = _match(lexicon.INSIDE_PHRASES, self.texts, i) if i < len(self.texts) else None
        return bool(found) and found[0][0] in ("PREP", "BETWEEN", "NEAR", "SIDE", "SPOT", "CENTER")  # type: ignore[index]

    def _nouny(self, i: int) -> bool:
        """Whether a noun stands at `i`, perhaps behind further attributes."""
        while i < len(self.texts):
            if self.texts[i] in ("one", "ones") or _match(_compounds(), self.texts, i):
                return True
            phrase = _match(lexicon.INSIDE_PHRASES, self.texts, i)
            if phrase and phrase[0][0] == "THING":
                return True
            step = color_at(self.texts, i) or _match(lexicon.ATTRIBUTE_PHRASES, self.texts, i)
            number = quantities.read(self.texts[i:])
            if step:
                i += step[1]
            elif number and number.kind in ("NUMBER", "ORDINAL"):
                i += number.taken
            else:
                filler = _match(lexicon.FILLER, self.texts, i)
                return not phrase and not number and not filler and is_plain(self.texts[i])
        return False

    def _special(self, i: int, length: int) -> int | None:
        """Words whose class depends on the verb or on the very next word."""
        text, rest = self.texts[i], self.texts[i + 1 :]
        after = rest[0] if rest else ""
        verb = self.clause.verb
        if text == "'s":
            return self._put("POSS", None, i, 1)
        if text in ("its", "their") and after:
            self._put("PRON", "it", i, 1)
            return self._put("POSS", None, i, 1)
        if text == "by" and after and (quantities.read(rest) or after in ("a", "half")) and length == 1:
            return self._put("BY", None, i, 1)
        if text == "by" and verb in ("REPLACE", "SUBSTITUTE"):
            return self._put("WITH", None, i, 1)
        if text == "into" and verb in ("TURN", "CHANGE", "MAKE"):
            return self._put("INTO", None, i, 1)
        if text == "from" and verb == "CHANGE" and self._hue_follows(i + 1):
            return self._put("FROMHUE", None, i, 1)
        if text in ("in", "with") and verb in ("PAINT", "TINT", "GIVE", "MAKE") and self._hue_follows(i + 1):
            return i + 1 + (after in ("a", "an"))
        if text in ("on", "off") and not rest and verb == "TURN":
            return self._put("SWITCH", None, i, 1)
        if text == "over" and length == 1 and verb in ("TURN", "FLIP") and not rest:
            return self._put("UPSIDE", None, i, 1)
        if text in ("away", "out") and length == 1 and verb not in ("TAKE", "") and not rest:
            return self._put("DIR", "forward", i, 1) if verb in ("MOVE", "PUT") else None
        if text in ("higher", "lower") and verb in ("MOVE", "PUT", "") and not self._nouny(i + 1):
            return self._put("DIR", "up" if text == "higher" else "down", i, 1)
        if text == "more" and self._before == "NUMBER" and self._nouny(i + 1):
            return i + 1
        return None

    def _hue_follows(self, i: int) -> bool:
        i += self.texts[i : i + 1] in (("a",), ("an",))
        found = color_at(self.texts, i)
        return bool(found) and not self._nouny(i + found[1])  # type: ignore[index]

    def _quantity(self, i: int, length: int) -> int | None:
        found = quantities.read(self.texts[i:])
        if not found or found.taken < length:
            return None
        behind = i + found.taken
        headed = self._before in ("COLOR", "SIZE", "SUP", "ORDINAL", "ADJ", "OTHER")
        if self.texts[i] == "one" and found.kind == "NUMBER" and (headed or not self._nouny(behind)):
            return None
        if found.kind == "LENGTH":
            if self.texts[behind : behind + 1] in (("tall",), ("high",)) and self._nouny(behind + 1):
                return self._put("TALL", (found.value, found.unit), i, found.taken + 1)
            return self._put("LENGTH", (found.value, found.unit), i, found.taken)
        return self._put(found.kind, found.value, i, found.taken)

    def _compound(self, i: int, length: int) -> int | None:
        found = _match(_compounds(), self.texts, i)
        return self._noun(i, found[1]) if found and found[1] >= length else None

    def _color(self, i: int, length: int) -> int | None:
        found = color_at(self.texts, i)
        if not found or found[1] < length:
            return None
        name, taken = found
        if self._nouny(i + taken):
            return self._put("COLOR", name, i, taken)
        follows_det = self._before in ("DET", "SIZE", "SUP", "ORDINAL") or (
            self._before in ("", *lexicon_verbs()) and self.clause.verb != ""
        )
        if follows_det and self.texts[i] == "light" and taken == 2:
            return self._put("NOUN", "light", i, 1)
        if follows_det and taken == 1 and name in NOUN_COLORS and not self._indefinite_hue(i):
            return self._put("NOUN", name, i, 1)
        return self._put("HUE", name, i, taken)

    def _indefinite_hue(self, i: int) -> bool:
        """ "give it an orange colour": the article belongs to the colour word behind."""
        found = _match(lexicon.INSIDE_PHRASES, self.texts, i + 1)
        return bool(found) and found[0][0] == "COLORWORD"  # type: ignore[index]

    def _attribute(self, i: int, length: int) -> int | None:
        found = _match(lexicon.ATTRIBUTE_PHRASES, self.texts, i)
        if not found or found[1] < length:
            return None
        (kind, value), taken = found
        behind = self.texts[i + taken : i + taken + 1]
        after_det = self._before in ("DET", "POSS", "NUMBER", "ORDINAL")
        if self._nouny(i + taken) and (after_det or self._before not in _NOUNISH):
            return self._put(kind, value, i, taken)
        if after_det and self.texts[i] in ("back", "top", "front", "bottom", "left", "right") and behind == ("of",):
            return self._put("NOUN", self.texts[i], i, 1)
        if kind == "SUP" and after_det and (self._before == "DET" or self._before == "ORDINAL"):
            return self._put(kind, value, i, taken)
        if kind == "SIZE" and not length:
            return self._put("SIZEWORD", value, i, taken)
        return None

    def _phrase(self, i: int, entry: lexicon.Entry, taken: int) -> int:
        """A phrase of the closed vocabulary, adjusted to its surroundings."""
        kind, value = entry
        text, behind = self.texts[i], i + taken
        if kind == "DET" and taken == 1:
            return self._determiner(i, value)
        if kind == "ONE" and not value and self._nouny(behind) and self._before not in ("COLOR", "SIZE", "SUP", "DET"):
            return self._put("NUMBER", 1.0, i, 1)
        if kind == "NOT" and self._before != "REL":
            return self._put("NOT" if self._preposition_at(behind) else "BUT", None, i, taken)
        if kind == "REL" and self._preposition_at(behind):
            return behind
        if kind == "AND":
            if self._preposition_at(behind):
                return self._put("ANDREL", None, i, taken)
            if text == "and" and self._before in ("AND", "COMMA"):
                return behind
        if kind == "PREP" and taken == 1 and text in ("in", "on", "at") and behind >= len(self.texts):
            return self._put("UNKNOWN", None, i, taken)
        if kind == "COLORWORD" and text == "tint" and self._before in _NOUNISH:
            return self._put("UNKNOWN", None, i, taken)
        return self._put(kind, value, i, taken)

    def _determiner(self, i: int, value: str) -> int:
        """ "this" or "all": a determiner before a noun, a pronoun otherwise."""
        text = self.texts[i]
        noun_follows = self._nouny(i + 1) or self._opens_noun(i + 1)
        if text in ("this", "that", "these", "those") and not noun_follows:
            return self._put("PRON", "it", i, 1)
        if text == "all" and not noun_follows:
            return self._put("EVERYTHING", None, i, 1)
        if text == "both" and not noun_follows:
            return self._put("PRON", "it", i, 1)
        return self._put("DET", value, i, 1)

    def _opens_noun(self, i: int) -> bool:
        """Whether "all" goes on as a noun phrase at `i` ("all non-red chairs", "all other chairs")."""
        if i >= len(self.texts):
            return False
        if self.texts[i] in ("non", "other", "remaining"):
            return True
        number = quantities.read(self.texts[i:])
        return number is not None and number.kind in ("NUMBER", "ORDINAL", "LENGTH")

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
        if kind == "NOUN" and color_at(self.texts, j) and self._nouny(j) and self._before in ("DET", "COLOR", "SIZE"):
            kind = "ADJ"
        return self._put(kind, " ".join(self.texts[i:j]), i, j - i)

    def _continues_noun(self, j: int) -> bool:
        texts = self.texts
        if not is_plain(texts[j]) or texts[j] == ",":
            return False
        tables = (lexicon.INSIDE_PHRASES, lexicon.FILLER)
        if any(_match(t, texts, j) for t in tables) or texts[j] in lexicon.PARTICIPLES:
            return False
        return not color_at(texts, j) and not quantities.read(texts[j:])


@cache
def lexicon_verbs() -> frozenset[str]:
    """The classes of verbs."""
    return frozenset(kind for kind, _ in lexicon.VERB_PHRASES.values())


@cache
def _compounds() -> frozenset[tuple[str, ...]]:
    """The compounds, with a singular and a plural head ("wine glasses")."""
    plural = {c[-1]: c[-1] + ("es" if c[-1].endswith(("s", "x", "sh", "ch")) else "s") for c in nouns.COMPOUNDS}
    return nouns.COMPOUNDS | {(*c[:-1], plural[c[-1]]) for c in nouns.COMPOUNDS}
