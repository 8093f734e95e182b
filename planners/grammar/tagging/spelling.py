"""Corrects typing errors in an instruction where exactly one known word is near; the plan reports each correction.

`correct_spelling` corrects words of the closed vocabulary only. Any unknown word may be a noun, so nouns are compared
with the names of things in the scene instead (`misspelled_name`, called by label_encoder.py and compose).
"""

from __future__ import annotations

import gzip
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from itertools import islice
from pathlib import Path

from ....gaussians import color as colors
from ....gaussians.language.encoders.vocabulary import Vocabulary
from ....gaussians.world import kinds
from ....gaussians.world.lengths import UNITS
from ....gaussians.world.spelling import SHORTEST, best_slip, likely_slips
from ....gaussians.world.words import normalise, plural
from ..vocabulary import doings, lexicon, nouns, quantities
from .words import Word, bag

_CLAUSE_OPENERS = bag(". ; ! then please you")
_MAY_OPEN = bag(", and to")
_ARTICLES = bag("the a an this that these those my your our his her its their every each another any")
_DETERMINERS = _ARTICLES | bag("all both it them everything some one two three four five")
_BEHIND_NOUN = bag(
    ". , ; ! and or but then to from on onto in into at by near next under behind beside with over above below "
    "between left right up down forward backward"
)

_COMMON = 8000  # merges of CLIP's encoding whose words are never taken for errors

# Correct words that people use about rooms and that are one letter away from a word of the vocabulary.
_CORRECT_WORDS = bag(
    "barge beard beast best black block board boast bound bowl bowls bread break brick bride bright broad brown burn "
    "cable candy chain clock coach coast cove crate crown dove drive drown eight fable feast fern fight first fist "
    "flight flock found fright glide glove gong grate great greek green ground hole hope hose host knock large least "
    "light list long marble medal metal might mist mole most mound move nest night nose paint pale palm pane panel "
    "pedal petal place plane plate plaza plight point pole pose post pound price pride print rest right roast robe "
    "role rope rose round sable scale score screen self shall shelf shell shirt shore short sight slack slate slide "
    "slight small smell song sound spell stable stale stall stole stone store story stove table tern thunder tight "
    "toast tower track treat turn under vest west whale wheat while white wonder wound write yeast"
)


def correct_spelling(words: Sequence[Word], freely: bool = False) -> tuple[tuple[Word, ...], tuple[str, ...]]:
    """The words with typing errors corrected, and one remark for each correction.

    Args:
        freely: for an instruction that is not understood as it stands: also correct less probable errors, and words in
            the place of a noun that are one error away from a word of the closed vocabulary.
    """
    texts = [w.text for w in words]
    fixed, told = [], []
    for i, word in enumerate(words):
        meant = _correction(texts, i) or (_free_correction(texts, i) if freely else "")
        if meant:
            told.append(f"read “{word.text}” as {meant}")
        fixed.append(Word(meant or word.text, word.start, word.end))
    return tuple(fixed), tuple(told)


def _correction(texts: Sequence[str], i: int) -> str:
    """The correction of an unknown word; "" if the word is known or may be a noun, or if several words are as near."""
    text = texts[i]
    if is_word(text) or _noun_expected(texts, i) or is_common(text):
        return ""
    near = likely_slips(text, _verbs()) if _verb_expected(texts, i) else likely_slips(text, _closed_words())
    near = frozenset(w for w in near if not text.startswith(w))  # "nicer" is a form of nice, not an error
    if len({UNITS.get(w, w) for w in near}) == 1:
        return min(near)  # "metrs": metres or meters
    return ""


def _free_correction(texts: Sequence[str], i: int) -> str:
    """The most probable word of the closed vocabulary for an unknown word; a verb where one is expected."""
    text = texts[i]
    if is_word(text) or is_common(text):
        return ""
    near = best_slip(text, _verbs() if _verb_expected(texts, i) else _closed_words())
    return "" if near and text.startswith(near) else near


def _verb_expected(texts: Sequence[str], i: int) -> bool:
    """Whether a verb is expected at `i`: where a clause starts, and behind "and" or "to" if an object follows."""
    before = texts[i - 1] if i else "."
    return before in _CLAUSE_OPENERS or (before in _MAY_OPEN and " ".join(texts[i + 1 : i + 2]) in _DETERMINERS)


def _noun_expected(texts: Sequence[str], i: int) -> bool:
    """Whether only a noun fits at `i`: between a determiner and a word that follows noun phrases.

    "of" is not among these words, as a comparative may precede it ("the taller of the two").
    """
    behind = texts[i + 1] if i + 1 < len(texts) else "."
    j = i - 1
    while j > 0 and (texts[j] in colors.BASIC or (texts[j],) in lexicon.ATTRIBUTE_PHRASES or _is_strange(texts[j])):
        j -= 1
    if i and texts[i - 1] in (*colors.BASIC, "grey", "of"):
        return True  # a colour and its noun: "the grey lounger 80 cm to the right"
    ends = behind in _BEHIND_NOUN or behind[0].isdigit() or (behind,) in lexicon.CLOSED_PHRASES
    return i > 0 and texts[j] in _ARTICLES and (behind in _BEHIND_NOUN if j == i - 1 else ends)


def _is_strange(text: str) -> bool:
    """Whether a word is neither of the closed vocabulary nor an everyday noun, and so may be part of a name."""
    return text.isalpha() and text not in _ARTICLES and text not in _closed_words() and not nouns.is_known(text)


def misspelled_name(text: str, there: frozenset[str]) -> str:
    """The only name in `there` that an unknown word is a misspelling of; "" if there is none or more than one."""
    near = frozenset() if is_word(text) else likely_slips(text, there)
    return min(near) if len(near) == 1 else ""


def is_word(text: str) -> bool:
    """Whether a word is taken to be spelt correctly."""
    return any(text in words() for words in (_listed_words, _closed_words, _verbs, _plurals))


def is_common(text: str) -> bool:
    """Whether a word is so common in captions of pictures that it is meant as it stands: "team" is not teal."""
    return text in _captions(_COMMON)


def is_captioned(text: str) -> bool:
    """Whether a word stands in captions of pictures at all."""
    return text in _captions(None)


@cache
def _captions(most: int | None) -> frozenset[str]:
    """Words of the captions that CLIP learned from: those of the first merges of its byte-pair encoding, or of all."""
    spec = find_spec("open_clip")
    if spec is None or not spec.submodule_search_locations:
        return frozenset()
    with gzip.open(Path(spec.submodule_search_locations[0]) / "bpe_simple_vocab_16e6.txt.gz", "rt") as file:
        merges = ["".join(line.split()) for line in islice(file, 1, None if most is None else 1 + most)]
    return frozenset(word.removesuffix("</w>") for word in merges if word.endswith("</w>"))


@cache
def _verbs() -> frozenset[str]:
    return frozenset(v[0] for v in lexicon.VERB_PHRASES if len(v[0]) >= SHORTEST)


@cache
def _closed_words() -> frozenset[str]:
    """Words of the closed classes: relations, colours, sizes, amounts."""
    said = {w for table in (lexicon.CLOSED_PHRASES, lexicon.ATTRIBUTE_PHRASES) for p in table for w in p}
    said |= {c for c in colors.names() if c.isalpha()} | {u for u in UNITS if u.isalpha()}
    said |= {"please", "finally", "actually", "instead", "should", "would", "could"}
    said |= {*quantities.NUMBERS, *quantities.ORDINALS, *quantities.FRACTIONS, "degrees", "percent", "times", "turns"}
    return frozenset(w for w in said if len(w) >= SHORTEST and w.isalpha())


@cache
def _listed_words() -> frozenset[str]:
    """The words of all other tables."""
    tables = (lexicon.VERB_PHRASES, lexicon.UNSUPPORTED_PHRASES, lexicon.FILLER, lexicon.POLITE, lexicon.GERUND_OPENERS)
    said = {w for table in tables for p in table for w in p}
    said |= (
        lexicon.CHAT | lexicon.QUESTION | lexicon.STATEMENT | lexicon.STRUCTURE | lexicon.ADVERB_NOUNS | _CORRECT_WORDS
    )
    said |= lexicon.COMMANDS | lexicon.ASKING | lexicon.PARTICIPLES | nouns.everyday() | kinds.every_word()
    said |= {w for c in nouns.COMPOUNDS for w in c} | Vocabulary.household().modifiers
    said |= doings.plain() | doings.said_of_one() | doings.ongoing()
    said |= {w for n in kinds.every_word() for w in normalise(n)}
    return frozenset(said)


@cache
def _plurals() -> frozenset[str]:
    return frozenset(map(plural, _listed_words()))
