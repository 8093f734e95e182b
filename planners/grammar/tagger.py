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
from typing import Any

from . import lexicon, quantities
from .reading import NOUN_COLORS, Reading, color_at, compounds, is_plain, match, verb_classes
from .verbs import Entry
from .words import Word, phrases

_NOUNISH = frozenset({"NOUN", "ONE", "THING"})
_BOUNDARIES = frozenset(".;!?\n")
# "the smaller of the two" picks as a superlative does.
_COMPARATIVES = {"bigger": "largest", "larger": "largest", "smaller": "smallest", "taller": "tallest",
                 "shorter": "shortest"}  # fmt: skip
_COLORING = ("PAINT", "TINT", "GIVE", "MAKE", "WANT", "APPLY")
# Verbs whose object "with the vase" can only describe; "move the cup with the plate" may mean both.
_POINTING = ("DELETE", "SELECT", "HIDE", "ISOLATE", "FADE", "ADJUST", "ROTATE", "SCALE", "GROW")
_ON_IT = phrases(
    "on it, on top, on top of it, in it, inside, inside it, on them, standing on it, next to it, beside it, near it, on"
)
_CARRYING = phrases("that has, which has, that have, which have, that holds, that carries, holding, carrying")
_OUTSIDE = phrases("out of here, out of the room, out of the scene, out of sight, out of my sight, out of there")
_IT_IS = phrases("it is, this is, that is, there is, they are, these are")
_REPEATABLE = ("DELETE", "SELECT", "HIDE", "ISOLATE")
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


class Tagger:
    """Reads one sentence; `clauses()` gives its clauses."""

    def __init__(self, words: Sequence[Word]) -> None:
        self.words = tuple(words)
        self.texts = tuple(w.text for w in words)
        self.read = Reading(self.texts)
        self.clause = Clause()
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

    def _special(self, i: int, length: int) -> int | None:
        """Words whose class depends on the verb or on the very next word."""
        text, rest = self.texts[i], self.texts[i + 1 :]
        after = rest[0] if rest else ""
        verb = self.clause.verb
        if (found := self._owned_or_not(i)) is not None or (found := self._around(i)) is not None:
            return found
        if verb == "SELECT" and (pointed := self._pointing(i)) is not None:
            return pointed
        if text in ("left", "right") and after == "by" and quantities.read(rest[1:]):
            return self._put("DIR", text, i, 1)
        if text == "like" and after in ("the", "a", "an", "my", "that", "those") and verb in ("ADD", "WANT"):
            return self._put("LIKE", None, i, 1)
        if text == "out" and verb in ("TAKE", "MOVE") and (gone := match(_OUTSIDE, self.texts, i)):
            return self._put("AWAY", None, i, gone[1])
        onward = verb == "PUT" or (verb == "MOVE" and text in ("back", "up", "over") and after in ("against", "onto"))
        if text in ("down", "over", "back", "up") and length == 1 and onward and self.read.preposition_at(i + 1):
            return i + 1
        if text in ("thing", "thingy", "thingie") and self._before == "NOUN" and verb not in ("ADD", "PUT"):
            return i + 1
        if text in ("'s", "its", "their") and after:
            return self._owner(i)
        if text == "by" and verb in ("REPLACE", "SUBSTITUTE"):
            return self._put("WITH", None, i, 1)
        if text == "by" and after and (quantities.read(rest) or after in ("a", "half")) and length == 1:
            return self._put("BY", None, i, 1)
        if text == "into" and verb in ("TURN", "CHANGE", "MAKE"):
            return self._put("INTO", None, i, 1)
        if text == "from" and verb in ("CHANGE", "PAINT", "TURN") and self.read.hue_follows(i + 1):
            return self._put("FROMHUE", None, i, 1)
        if text in ("in", "with") and verb in _COLORING and self.read.hue_follows(i + 1):
            return i + 1 + (after in ("a", "an"))
        if text in ("on", "off") and not rest and verb == "TURN":
            return self._put("SWITCH", None, i, 1)
        if text == "over" and length == 1 and verb in ("TURN", "FLIP") and not rest:
            return self._put("UPSIDE", None, i, 1)
        if text in ("away", "out") and length == 1 and verb not in ("TAKE", "") and not rest:
            return self._put("DIR", "forward", i, 1) if verb in ("MOVE", "PUT") else None
        if text in ("closer", "nearer") and after == "to" and length == 2 and verb not in ("", "MOVE", "PUT", "TAKE"):
            return self._put("NEAR", "nearest_to", i, 2)
        if text in ("higher", "lower") and verb in ("MOVE", "PUT", "") and not self.read.nouny(i + 1):
            return self._put("DIR", "up" if text == "higher" else "down", i, 1)
        if text == "in" and rest[:2] == ("a", "row") and verb in ("COPY", "MAKE", "ADD"):
            return i + 3
        if text == "back" and length == 1 and self._returns() and not self.read.nouny(i + 1):
            return self._put("UNKNOWN", None, i, 1)
        if text in ("each", "apiece") and not rest and self.clause.tags:
            return i + 1
        if text == "again" and verb != "SELECT" and not rest:
            return i + 1
        if text == "more" and self._before == "NUMBER" and self.read.nouny(i + 1):
            return i + 1
        return None

    def _pointing(self, i: int) -> int | None:
        """ "select it is the chair …", "the chair is next to the bed": a description that is a sentence."""
        if len(self.clause.tags) == 1 and match(_IT_IS, self.texts, i):
            return i + 2
        if self.texts[i] in ("is", "are", "sits", "stands") and self._before in _NOUNISH:
            behind = self.read.skip_filler(i + 1)
            behind += behind < len(self.texts) and self.texts[behind] in (*lexicon.PARTICIPLES, "the", "also")
            phrase = self.read.phrase(behind) if behind < len(self.texts) else None
            if phrase and phrase[0][0] in ("PREP", "NEAR", "BETWEEN", "SIDE", "CENTER", "SPOT", "NOT"):
                return behind
            if self.read.hue_follows(i + 1):
                return self._put("REL", None, i, 1)
        return None

    def _owned_or_not(self, i: int) -> int | None:
        """ "with the vase on it", "without a lamp": what a thing carries or lacks."""
        if (found := match(_CARRYING, self.texts, i)) and self._before in _NOUNISH:
            lacks = self.texts[i + found[1] : i + found[1] + 1] == ("no",)
            if self.read.object_follows(i + found[1] + lacks):
                return self._put("LACKING" if lacks else "HAVING", None, i, found[1] + lacks)
        text, behind = self.texts[i], self.texts[i + 1 : i + 2]
        if text == "with" and behind == ("no",) and self.read.object_follows(i + 2):
            return self._put("LACKING", None, i, 2)
        held = any(t.type in ("HAVING", "LACKING") for t in self.clause.tags)
        if held and (found := match(_ON_IT, self.texts, i)):
            return self._put("ONIT", "next_to" if text in ("next", "beside", "near") else "below", i, found[1])
        if text == "without" and not match(lexicon.INSIDE_PHRASES, self.texts, i) and self.read.object_follows(i + 1):
            return self._put("LACKING", None, i, 1)
        definite = behind in (("the",), ("my",)) or (behind in (("a",), ("an",)) and self.clause.verb in _POINTING)
        if text in ("with", "holding", "carrying") and definite and self.clause.verb in (*_POINTING, "PAINT", "MAKE"):
            return self._put("HAVING", None, i, 1)
        return None

    def _around(self, i: int) -> int | None:
        """ "the chairs around the table" says where they are; "a round table" what it is."""
        if self.texts[i] not in ("around", "round"):
            return None
        if self.texts[i] == "round" and self._before not in ("NOUN", "PRON") and self.read.nouny(i + 1):
            return self._put("ADJ", None, i, 1)
        turning = self.clause.verb in ("TURN", "ROTATE", "TURNROUND", "FLIP", "TILT")
        if self._before in (*_NOUNISH, "AND") and self.read.object_follows(i + 1) and not turning:
            return self._put("PREP", "next_to", i, 1)
        return None

    def _owner(self, i: int) -> int:
        """ "'s", "its": of a part ("its legs") or of a property ("its size")."""
        if self.texts[i] != "'s":
            self._put("PRON", "it", i, 1)
        j = self.read.skip_filler(i + 1)
        owned = self.read.phrase(j) if j < len(self.texts) else None
        shade = self.texts[j : j + 1] == ("shade",) and bool(self.clause.tags) and "lamp" in self.clause.tags[-1].text
        of_property = owned is not None and owned[0][0] in ("COLORWORD", "OPACITYWORD", "PROP") and not shade
        return self._put("OWN" if of_property else "POSS", None, i, 1)

    def _returns(self) -> bool:
        """Whether "back" may mean where it was ("put the book back on the shelf") and not a direction."""
        return self.clause.verb in ("PUT", "TAKE") or (self.clause.verb == "MOVE" and self._before == "PRON")

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
        if self.read.nouny(i + taken) and (after_det or self._before not in _NOUNISH):
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
        if kind == "COLORWORD" and text == "tint" and self._before in _NOUNISH:
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
        if match(_CARRYING, texts, j) or any(match(t, texts, j) for t in tables) or texts[j] in lexicon.PARTICIPLES:
            return False
        return not color_at(texts, j) and not quantities.read(texts[j:])
