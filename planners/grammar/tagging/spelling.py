"""Slips of the keyboard in words that are not nouns: one letter too many, too few, wrong, or two exchanged.

Knows the closed vocabulary. Refuses to touch nouns, because any word may be one: a noun is only ever compared with what
is there (see wordwise.py). A slip is corrected where exactly one word is meant, and the plan says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

from ....gaussians import color as colors
from ..vocabulary import lexicon, nouns, quantities
from .words import Word, bag

_SHORTEST = 4  # letters; shorter words have too many neighbours

# Words that people use in rooms and that are one letter from one of ours.
_REAL = bag(
    "barge beard beast best black block board boast bound bowl bowls bread break brick bride bright broad brown burn "
    "cable candy chain clock coach coast cove crate crown dove drive drown eight fable feast fern fight first fist "
    "flight flock found fright glide glove gong grate great greek green ground hole hope hose host knock large least "
    "light list long marble medal metal might mist mole most mound move nest night nose paint pale palm pane panel "
    "pedal petal place plane plate plaza plight point pole pose post pound price pride print rest right roast robe "
    "role rope rose round sable scale score screen self shall shelf shell shirt shore short sight slack slate slide "
    "slight small smell song sound spell stable stale stall stole stone store story stove table tern thunder tight "
    "toast tower track treat turn under vest west whale wheat while white wonder wound write yeast"
)


def respell(words: Sequence[Word]) -> tuple[tuple[Word, ...], tuple[str, ...]]:
    """The words with slips corrected, and for each correction a remark."""
    fixed, told = [], []
    for i, word in enumerate(words):
        opens = i == 0 or words[i - 1].text in (".", ";", ",", "and", "then", "please", "to", "you", "!")
        meant = _meant(word.text, opens)
        if meant:
            told.append(f"read “{word.text}” as {meant}")
        fixed.append(Word(meant or word.text, word.start, word.end))
    return tuple(fixed), tuple(told)


def _meant(text: str, opens: bool) -> str:
    """What a word that nobody knows is a slip of, "" if it is known or several words are as near."""
    if len(text) < _SHORTEST or not text.isalpha() or text in _known():
        return ""
    near = {w for w in _neighbours(text) if w in (_verbs() if opens else _closed())}
    near = {w for w in near if not text.startswith(w)}  # "nicer" is a form of nice, no slip
    near = {w for w in near if opens or _swapped(text, w) or (len(text) > _SHORTEST and w[0] == text[0])}
    if len({quantities.UNITS.get(w, w) for w in near}) == 1:
        return min(near)  # "metrs": metres or meters
    return ""


def slips(text: str, there: frozenset[str]) -> str:
    """The one word of those that are there which an unknown word is a slip of, else ""."""
    if len(text) < _SHORTEST or not text.isalpha() or text in _known():
        return ""
    near = {w for w in there.intersection(_neighbours(text)) if len(w) >= _SHORTEST}
    near = {w for w in near if len(text) > _SHORTEST or _swapped(text, w)}
    return near.pop() if len(near) == 1 else ""


def _neighbours(text: str) -> Iterator[str]:
    """Every string one slip away."""
    letters = "abcdefghijklmnopqrstuvwxyz"
    for i in range(len(text) + 1):
        head, tail = text[:i], text[i:]
        yield from (head + c + tail for c in letters)
        if tail:
            yield head + tail[1:]
            yield from (head + c + tail[1:] for c in letters)
        if len(tail) > 1:
            yield head + tail[1] + tail[0] + tail[2:]


def _swapped(text: str, word: str) -> bool:
    """Whether two neighbouring letters were exchanged."""
    return len(text) == len(word) and sorted(text) == sorted(word)


@cache
def _verbs() -> frozenset[str]:
    return frozenset(v[0] for v in lexicon.VERB_PHRASES if len(v[0]) >= _SHORTEST)


@cache
def _closed() -> frozenset[str]:
    """Words that are no nouns: of relations, colours, sizes, amounts."""
    said = {w for table in (lexicon.INSIDE_PHRASES, lexicon.ATTRIBUTE_PHRASES) for p in table for w in p}
    said |= {c for c in colors.names() if c.isalpha()} | {u for u in quantities.UNITS if u.isalpha()}
    said |= {*quantities.NUMBERS, *quantities.ORDINALS, *quantities.FRACTIONS, "degrees", "percent", "times", "turns"}
    return frozenset(w for w in said if len(w) >= _SHORTEST and w.isalpha())


@cache
def _known() -> frozenset[str]:
    """Every word that is spelt as it should be, as far as we know."""
    from ....gaussians.world.synonyms import every_word
    from ....gaussians.world.words import normalise
    from ...rooms.label_encoder import vocabulary

    tables = (lexicon.VERB_PHRASES, lexicon.UNSUPPORTED_PHRASES, lexicon.FILLER, lexicon.POLITE, lexicon.GERUND_OPENERS)
    said = {w for table in tables for p in table for w in p}
    said |= lexicon.CHAT | lexicon.QUESTION | lexicon.STATEMENT | lexicon.STRUCTURE | lexicon.ADVERB_NOUNS | _REAL
    said |= lexicon.COMMANDS | lexicon.ASKING | lexicon.PARTICIPLES | nouns.KNOWN | every_word()
    said |= {w for c in nouns.COMPOUNDS for w in c} | vocabulary().modifiers
    names = (n for kind, others in vocabulary().kinds.items() for n in (kind, *others))
    said |= {w for n in names for w in normalise(n)}
    return frozenset(said | _closed() | _verbs() | {w + "s" for w in said} | {w + "es" for w in said})
