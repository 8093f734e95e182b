"""Lookups in the vocabulary tables at a position of a sentence, for the tagger.

Every function and method answers one question about the words from a position on and changes nothing; tagger.py and
context_rules.py decide which tag a word gets.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from ....gaussians import color as colors
from ....gaussians.world.shades import DYES, shade_at
from ....gaussians.world.words import plural
from ..vocabulary import lexicon, nouns, quantities
from ..vocabulary.verbs import Entry
from .words import bag

# Colour names that are nouns as well ("delete the orange").
NOUN_COLORS = bag(
    "orange rose peach apricot olive lime tomato salmon plum chocolate snow sand coral orchid wine mint "
    "lavender lilac violet sage mustard lemon cherry honey heather hyacinth iris jade amber fern "
    "heliotrope"
)
_OPENERS = frozenset({"DET", "PRON", "EVERYTHING", "NUMBER", "OTHERS"})
_PARTICLES = frozenset({"up", "down", "out", "away", "off", "over"})


@cache
def _color_names() -> frozenset[str]:
    return (frozenset(n.replace(" ", "") for n in colors.names()) | DYES) - {"transparent"}


def color_at(texts: Sequence[str], i: int) -> tuple[str, int] | None:
    """The colour phrase at `i` and its number of words, None if there is none."""
    known = _named_color_at(texts, i)
    shade = shade_at(texts, i) if i < len(texts) else None
    return shade if shade and (known is None or known[1] < shade[1]) else known


def is_hue(words: Sequence[str]) -> bool:
    """Whether some words are the name of a colour, and nothing else."""
    found = color_at(words, 0)
    return found is not None and found[1] == len(words)


def _named_color_at(texts: Sequence[str], i: int) -> tuple[str, int] | None:
    """The colour at `i` whose name has a value of its own, and its number of words."""
    for taken in (4, 3, 2, 1):
        if i + taken > len(texts):
            continue
        phrase = " ".join(texts[i : i + taken])
        if _is_color(phrase):
            return _without_basic(phrase, taken, texts[i + taken : i + taken + 1])
    return None


def _without_basic(phrase: str, taken: int, behind: Sequence[str]) -> tuple[str, int]:
    """Count a basic colour behind a precise one as part of it: "navy blue" is navy, "mint green" is mint."""
    precise = phrase not in colors.BASIC and phrase not in ("grey", *colors.QUALIFIERS) and not phrase.startswith("#")
    doubled = taken == 1 and precise and bool(behind) and behind[0] in (*colors.BASIC, "grey")
    return phrase, taken + doubled


def _is_color(phrase: str) -> bool:
    joined = phrase.replace(" ", "").replace("grey", "gray")
    if joined in _color_names() or (phrase.startswith("#") and " " not in phrase):
        return len(phrase) < 60
    for qualifier in colors.QUALIFIERS:
        if phrase.startswith(qualifier + " "):
            return _is_color(phrase[len(qualifier) + 1 :])
    if phrase.endswith("ish") and " " not in phrase:
        stem = phrase[:-3]
        return stem in _color_names() or stem.removesuffix("d") in _color_names()
    return False


def match(table: Any, texts: Sequence[str], i: int) -> tuple[Any, int] | None:
    """The longest phrase of `table` (a dict or a set of word tuples) at `i`, with its entry and length."""
    for taken in range(min(lexicon.LONGEST, len(texts) - i), 0, -1):
        key = tuple(texts[i : i + taken])
        if key in table:
            return (table[key] if isinstance(table, dict) else key), taken
    return None


def may_be_noun(text: str) -> bool:
    """Whether a word may be (part of) a noun, judged by its form alone."""
    if not text[0].isalpha() or text in lexicon.STRUCTURE:
        return False
    return not (text.endswith("ly") and len(text) > 3 and text not in lexicon.ADVERB_NOUNS)


class Lookahead:
    """Questions about the words of one sentence, each asked at a position `i`."""

    def __init__(self, texts: Sequence[str]) -> None:
        self.texts = tuple(texts)

    def phrase(self, i: int) -> tuple[Entry, int] | None:
        """The phrase of the closed vocabulary at `i`."""
        return match(lexicon.CLOSED_PHRASES, self.texts, i)

    def verb(self, i: int) -> tuple[Entry, int, int | None] | None:
        """The verb at `i`, its number of words there, and the position of its particle if that follows the object."""
        if found := self.gerund(i):
            return (*found, None)
        if apart := self.separable(i):
            return apart
        found = match(lexicon.VERB_PHRASES, self.texts, i)
        return (*found, None) if found else None

    def separable(self, j: int) -> tuple[Entry, int, int] | None:
        """The verb at `j` whose particle follows its object within the clause ("blow it up"); see `verb`."""
        for k in range(j + 2, min(j + 10, len(self.texts))):
            if self.texts[k] in (",", "and", "then"):
                break
            entry = lexicon.VERB_PHRASES.get((self.texts[j], self.texts[k])) if self.texts[k] in _PARTICLES else None
            if entry and self.texts[k + 1 : k + 2] not in (("to",), ("of",), ("against",), ("from",), ("the",)):
                return entry, 1, k
        return None

    def gerund(self, j: int) -> tuple[Entry, int] | None:
        """The verb of an -ing form at `j` behind an opener such as "would you mind" ("would you mind removing")."""
        opened = any(self.texts[max(j - len(p), 0) : j] == p for p in lexicon.GERUND_OPENERS)
        text = self.texts[j] if j < len(self.texts) else ""
        if not opened or not text.endswith("ing"):
            return None
        stem = text[:-3]
        stems = (stem, stem + "e", stem[:-1] if stem[-1:] == stem[-2:-1] else stem)
        entry = next((lexicon.VERB_PHRASES[s,] for s in stems if (s,) in lexicon.VERB_PHRASES), None)
        return (entry, 1) if entry else None

    def verb_is_noun(self, i: int, taken: int) -> bool:
        """Whether a word that could be a verb begins a colour phrase ("light blue") where a clause begins."""
        return taken == 1 and (found := color_at(self.texts, i)) is not None and found[1] > 1

    def skip_polite(self, i: int) -> tuple[int, bool]:
        """The position behind polite phrases and filler, and whether the clause is a prohibition ("do not", "never").

        Polite phrases are skipped only if a verb follows them; otherwise only filler and interjections are.
        """
        j = i
        while j < len(self.texts):
            texts = self.texts
            if texts[j] == "never" or texts[j : j + 2] == ("do", "not"):
                return j + (1 if texts[j] == "never" else 2), True
            verb = match(lexicon.VERB_PHRASES, texts, j)
            polite = match(lexicon.POLITE, texts, j) or match(lexicon.FILLER, texts, j)
            opener = match(lexicon.GERUND_OPENERS, texts, j)
            if opener and self.gerund(j + opener[1]):
                return j + opener[1], False
            if polite and (not verb or polite[1] > verb[1]):
                j += polite[1]
            elif texts[j] in (",", "to") and j > i:
                j += 1
            else:
                known = verb or match(lexicon.UNSUPPORTED_PHRASES, texts, j)
                return (j, False) if known else (self.skip_interjections(i), False)
        return self.skip_interjections(i), False

    def skip_interjections(self, i: int) -> int:
        """The position behind interjections and filler ("no, darker")."""
        i = self.skip_filler(i)
        while i + 1 < len(self.texts) and self.texts[i] in lexicon.INTERJECTIONS:
            i = self.skip_filler(i + 1 + (self.texts[i + 1] == ","))
        return i

    def skip_filler(self, i: int) -> int:
        """The position behind filler words."""
        while found := match(lexicon.FILLER, self.texts, i):
            i += found[1]
        return i

    def verb_begins(self, j: int) -> bool:
        """Whether a clause with a verb of its own begins at `j`, which is behind "and" or a comma."""
        k, negated = self.skip_polite(j)
        if negated:
            return True
        if k < len(self.texts) and self.texts[k] == "first" and k == j:
            return False
        found = match(lexicon.VERB_PHRASES, self.texts, k) or match(lexicon.UNSUPPORTED_PHRASES, self.texts, k)
        if not found:
            return False
        taken = found[1]
        if taken > 1 or self.texts[k] not in lexicon.NOUN_VERBS:
            return True
        if match(compounds(), self.texts, k) or self.verb_is_noun(k, taken):
            return False
        return self.object_follows(k + 1)

    def object_follows(self, i: int) -> bool:
        """Whether a noun phrase begins at `i`."""
        if i >= len(self.texts):
            return False
        found = self.phrase(i)
        if found and found[0][0] in _OPENERS:
            return True
        return not found and (self.noun_at(i) or quantities.read(self.texts[i:]) is not None)

    def preposition_at(self, i: int) -> bool:
        """Whether a phrase of place begins at `i`."""
        found = self.phrase(i) if i < len(self.texts) else None
        return bool(found) and found[0][0] in ("PREP", "BETWEEN", "NEAR", "SIDE", "SPOT", "CENTER")  # type: ignore[index]

    def noun_at(self, i: int) -> bool:
        """Whether a noun is at `i`, possibly behind further attributes."""
        while i < len(self.texts):
            if self.texts[i] in ("one", "ones") or match(compounds(), self.texts, i):
                return True
            phrase = self.phrase(i)
            if phrase and phrase[0][0] == "THING":
                return True
            if self.texts[i] == "round" and self.noun_at(i + 1):
                return True
            step = color_at(self.texts, i) or match(lexicon.ATTRIBUTE_PHRASES, self.texts, i)
            number = quantities.read(self.texts[i:])
            if step and step[1] == 2 and self.texts[i] == "light" and not self.noun_at(i + 2):
                return True  # "light" is the noun, its new colour follows
            if step:
                i += step[1]
            elif number and number.kind in ("NUMBER", "ORDINAL"):
                i += number.taken
            else:
                filler = match(lexicon.FILLER, self.texts, i)
                return not phrase and not number and not filler and may_be_noun(self.texts[i])
        return False

    def colors(self, i: int) -> tuple[tuple[str, ...], int]:
        """Colours joined by "and" or "or" before one noun ("red and blue mugs"), and their number of words."""
        found, j = [], i
        while color := color_at(self.texts, j):
            found.append(color[0])
            j += color[1]
            if self.texts[j : j + 1] not in (("and",), ("or",), (",",)) or not color_at(self.texts, j + 1):
                break
            j += 1
        return (tuple(found), j - i) if len(found) > 1 and self.noun_at(j) else ((), 0)

    def colored_noun(self, i: int) -> bool:
        """Whether a colour and then its noun are at `i`; in "the sofa light blue" no noun follows the colour."""
        found = color_at(self.texts, i)
        if not found:
            return False
        shade = found[1] == 2 and self.texts[i] == "light"
        return self.noun_at(i + found[1]) if shade else self.noun_at(i)

    def hue_follows(self, i: int) -> bool:
        """Whether a colour without a noun behind it is at `i`."""
        i += self.texts[i : i + 1] in (("a",), ("an",))
        found = color_at(self.texts, i)
        return bool(found) and not self.noun_at(i + found[1])  # type: ignore[index]

    def opens_noun(self, i: int) -> bool:
        """Whether the words at `i` continue a noun phrase that "all" began ("all non-red chairs")."""
        if i >= len(self.texts):
            return False
        if self.texts[i] in ("non", "other", "remaining"):
            return True
        number = quantities.read(self.texts[i:])
        return number is not None and number.kind in ("NUMBER", "ORDINAL", "LENGTH")


@cache
def verb_classes() -> frozenset[str]:
    """The token types of verbs."""
    return frozenset(kind for kind, _ in lexicon.VERB_PHRASES.values())


@cache
def compounds() -> frozenset[tuple[str, ...]]:
    """The compound nouns, with singular and with plural head ("wine glass", "wine glasses")."""
    return nouns.COMPOUNDS | {(*c[:-1], plural(c[-1])) for c in nouns.COMPOUNDS}
