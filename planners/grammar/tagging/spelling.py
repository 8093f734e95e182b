"""Slips of the keyboard in an instruction, corrected where exactly one word is meant; the plan says so.

Only words of the closed vocabulary are corrected here. Any word may be a noun, so a noun is only ever compared with the
names of what is there (`slips`, called by label_encoder.py and compose).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from ....gaussians import color as colors
from ....gaussians.language.encoders.vocabulary import Vocabulary
from ....gaussians.world import kinds
from ....gaussians.world.lengths import UNITS
from ....gaussians.world.spelling import SHORTEST, likely_slips, one_slip
from ....gaussians.world.words import normalise, plural
from ..vocabulary import lexicon, nouns, quantities
from .words import Word, bag

_CLAUSE_OPENERS = bag(". ; ! then please you")
_MAY_OPEN = bag(", and to")
_ARTICLES = bag("the a an this that these those my your our his her its their every each another any")
_DETERMINERS = _ARTICLES | bag("all both it them everything some one two three four five")
_BEHIND_NOUN = bag(
    ". , ; ! and or but then to from on onto in into at by near next under behind beside with over above below "
    "between left right up down forward backward"
)

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
    texts = [w.text for w in words]
    fixed, told = [], []
    for i, word in enumerate(words):
        meant = _meant(texts, i)
        if meant:
            told.append(f"read “{word.text}” as {meant}")
        fixed.append(Word(meant or word.text, word.start, word.end))
    return tuple(fixed), tuple(told)


def _meant(texts: Sequence[str], i: int) -> str:
    """What a word that nobody knows is a slip of, "" if it is known, may be a noun, or several words are as near."""
    text = texts[i]
    if text in _known() or _is_noun(texts, i):
        return ""
    near = one_slip(text, _verbs()) if _opens(texts, i) else likely_slips(text, _closed())
    near = frozenset(w for w in near if not text.startswith(w))  # "nicer" is a form of nice, no slip
    if len({UNITS.get(w, w) for w in near}) == 1:
        return min(near)  # "metrs": metres or meters
    return ""


def _opens(texts: Sequence[str], i: int) -> bool:
    """Whether a verb is expected: at the start of a clause, and behind "and" or "to" where its object follows."""
    before = texts[i - 1] if i else "."
    return before in _CLAUSE_OPENERS or (before in _MAY_OPEN and " ".join(texts[i + 1 : i + 2]) in _DETERMINERS)


def _is_noun(texts: Sequence[str], i: int) -> bool:
    """Whether only a noun fits: between a determiner and what follows a noun phrase.

    Before "of" a comparative may stand as well ("the taller of the two").
    """
    behind = texts[i + 1] if i + 1 < len(texts) else "."
    return i > 0 and texts[i - 1] in _ARTICLES and behind in _BEHIND_NOUN


def slips(text: str, there: frozenset[str]) -> str:
    """The one word of those that are there which an unknown word is a slip of, else ""."""
    near = frozenset() if text in _known() else likely_slips(text, there)
    return min(near) if len(near) == 1 else ""


@cache
def _verbs() -> frozenset[str]:
    return frozenset(v[0] for v in lexicon.VERB_PHRASES if len(v[0]) >= SHORTEST)


@cache
def _closed() -> frozenset[str]:
    """Words that are no nouns: of relations, colours, sizes, amounts."""
    said = {w for table in (lexicon.INSIDE_PHRASES, lexicon.ATTRIBUTE_PHRASES) for p in table for w in p}
    said |= {c for c in colors.names() if c.isalpha()} | {u for u in UNITS if u.isalpha()}
    said |= {*quantities.NUMBERS, *quantities.ORDINALS, *quantities.FRACTIONS, "degrees", "percent", "times", "turns"}
    return frozenset(w for w in said if len(w) >= SHORTEST and w.isalpha())


@cache
def _known() -> frozenset[str]:
    """Every word that is spelt as it should be, as far as we know."""
    tables = (lexicon.VERB_PHRASES, lexicon.UNSUPPORTED_PHRASES, lexicon.FILLER, lexicon.POLITE, lexicon.GERUND_OPENERS)
    said = {w for table in tables for p in table for w in p}
    said |= lexicon.CHAT | lexicon.QUESTION | lexicon.STATEMENT | lexicon.STRUCTURE | lexicon.ADVERB_NOUNS | _REAL
    said |= lexicon.COMMANDS | lexicon.ASKING | lexicon.PARTICIPLES | nouns.everyday() | kinds.every_word()
    said |= {w for c in nouns.COMPOUNDS for w in c} | Vocabulary.household().modifiers
    said |= {w for n in kinds.every_word() for w in normalise(n)}
    return frozenset(said | _closed() | _verbs() | set(map(plural, said)))
