"""Finds the head noun of a description and the relations that it names, for counting descriptions by noun.

Handles the ways in which people introduce a description ("it's the …", "facing the window, …", "of the two chairs …").
The rest of the description need not be understood.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

from ..gaussians.errors import UserError
from ..gaussians.world.words import singular
from ..planners.grammar.tagging.lookahead import color_at, match
from ..planners.grammar.tagging.words import bag, clean, phrases, split
from ..planners.grammar.vocabulary import lexicon, nouns, quantities

_GENERIC = bag(
    "one ones option choice object item thing it pair set group row stack part side end top bottom bunch piece unit "
    "place spot answer target section portion middle corner area pile kind type correct left right view image photo "
    "room"
)
# Words that begin a clause about the speaker's position: the thing named there is not the one described.
_STANCE = bag(
    "go turn turning orient position facing face when if looking look standing stand sitting sit from as with while "
    "walking entering enter imagine staring viewing using on in at among amongst out between to coming lying laying "
    "upon under behind above"
)
# Openers of descriptions; "is" and "are" count only behind a word that names nothing ("the correct one is the lamp").
_OPENERS = phrases(
    "it is, this is, that is, choose, select, pick, find, locate, click, click on, you want, you are looking for, you "
    "should select, you should choose, you need, look for, i want, there is, there are, i am, i am looking for, its, "
    "they are, these are, you will want, you would want, please select, please choose, you will see, you see, "
    "pick out, grab, take, you need to choose, you need to select, you want to choose, you want to select, you want to "
    "pick, you need to pick, want, we want, we are looking for, looking for, searching for, locate for, see, the one"
)
_LEADING = bag("the a an two three four five six these those facing at")  # a noun phrase follows these words
_THE_ONE = phrases("the correct one, it is the, the one on, the correct choice", ",")
_SAID = bag("is are was were be")
_STOP = bag(
    "that which who whose where is are was were with without not and or but between opposite across facing has have "
    "touching holding against along you it there than then located standing sitting hanging placed leaning near by "
    "beside behind above below under over on in at to of from as attached underneath beneath inside directly "
    "immediately just while when if pushed mounted surrounded covering closes around surrounding has had running "
    "towards toward into through containing adjacent within being i underneath pulled turned for so because looking "
    "draped used out up down off laying lying tucked connected stuck going opposed slightly"
)
_ENDS = _STOP | bag("closest nearest closer farther further furthest farthest next left right away second third")
_BEFORE = bag(
    "the a an this that these those my your our his her two three four five six seven eight nine ten both all each "
    "every some any other another only correct same very most more really quite first second third fourth fifth last "
    "middle single left right closest nearest farthest furthest closer farther further far upper lower higher front "
    "back top bottom of one"
)


def head_noun(text: str) -> str:
    """The singular head noun of a description, "" if none is found.

    Raises:
        UserError: the text is too long.
    """
    texts = tuple(w.text for w in split(clean(text)))
    looked_at = ""  # last noun of a clause about the speaker's position: "facing the chairs, it's the one on the left"
    for clause in _clauses(texts):
        found, standing = _of_clause(clause)
        if found and not standing:
            return found
        looked_at = found or looked_at
    return looked_at


def relations_named(text: str) -> tuple[str, ...]:
    """Names of the relations that a description uses, in order."""
    try:
        texts = tuple(w.text for w in split(clean(text)))
    except UserError:
        return ()
    found, i = [], 0
    while i < len(texts):
        phrase = match(lexicon.CLOSED_PHRASES, texts, i)
        if phrase and phrase[0][0] in ("PREP", "NEAR", "BETWEEN", "SIDE", "CENTER", "SPOT"):
            found.append(str(phrase[0][1] or phrase[0][0].lower()))
        i += phrase[1] if phrase else 1
    return tuple(found)


def _clauses(texts: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """The words between punctuation marks; a comma between two adjectives does not split."""
    start = 0
    for i, text in enumerate((*texts, ".")):
        if text == "," and i and (texts[i - 1] in _adjectives() or color_at(texts, i - 1)):
            continue  # "the small, round table"
        if text in (".", ",", ";", "!", "?", ":", "\n"):
            if i > start:
                yield tuple(texts[start:i])
            start = i + 1


def _of_clause(texts: tuple[str, ...]) -> tuple[str, bool]:
    """The head noun of a clause, and whether the clause only gives the speaker's position."""
    if texts[:2] == ("do", "not") or texts[0] == "not":
        return "", True
    standing = texts[0] in _STANCE
    if standing:
        at = next((i + m[1] for i in range(1, len(texts)) if (m := match(_OPENERS, texts, i))), None)
        if at is not None and (behind := _noun_from(texts, at)):
            return behind, False
        texts = texts[: next((i for i in range(len(texts)) if texts[i : i + 3] in _THE_ONE), len(texts))]
        every = (_noun_from(texts, i) for i in range(1, len(texts)) if texts[i - 1] in _LEADING)
        return next(reversed([n for n in every if n]), "") or _noun_from(texts, 1), True
    i = 0
    while opener := match(_OPENERS, texts, i):
        i += opener[1]
    return _noun_from(texts, i), False


def _noun_from(texts: tuple[str, ...], i: int) -> str:
    """The head of the first noun phrase from `i` that names a kind of thing."""
    while i < len(texts):
        i = _skip(texts, i)
        j = i
        while j < len(texts) and texts[j] not in _ENDS and texts[j] != "'s" and texts[j][0].isalpha():
            j += 1
        if j == i + 1 and (texts[i] in _adjectives() or color_at(texts, i)) and not nouns.is_known(texts[i]):
            i = j + 1
            continue
        run, behind = texts[i:j], texts[j : j + 1]
        if run and run[-1] not in _GENERIC | _BEFORE and not _is_amount(run[-1]) and behind != ("'s",):
            return _head(run)
        named_later = behind in (("of",), ("'s",)) or (behind and behind[0] in _SAID and j + 1 < len(texts))
        if run and not named_later and texts[j : j + 2] not in (("you", "want"), ("you", "need")):
            return ""
        i = max(j, i) + 1  # "the pair of shoes", "the correct one is the lamp"
        while opener := match(_OPENERS, texts, i):
            i += opener[1]
    return ""


def _skip(texts: tuple[str, ...], i: int) -> int:
    """The position behind determiners, colours, sizes and amounts, as long as a word is left."""
    while i < len(texts) - 1:
        if texts[i] == ",":
            i += 1
            continue
        color = color_at(texts, i)
        attribute = match(lexicon.ATTRIBUTE_PHRASES, texts, i)
        step = color[1] if color else attribute[1] if attribute else 1 if texts[i] in _BEFORE else 0
        if not step or i + step >= len(texts) or texts[i + step] in _STOP - {"of"}:
            return i
        i += step
    return i


def _head(run: Sequence[str]) -> str:
    """The noun of a run of words: its last three words at most, without adjectives, in the singular."""
    words = [*run[:-1], singular(run[-1])]
    while len(words) > 1 and (words[0] in _adjectives() or color_at(words, 0)):
        words = words[1:]
    return " ".join(words[-3:])


def _is_amount(word: str) -> bool:
    return word in quantities.NUMBERS or word in quantities.ORDINALS or word.isdigit()


@cache
def _adjectives() -> frozenset[str]:
    """Words that give a property of a thing, not its kind."""
    sizes = {w for p in lexicon.ATTRIBUTE_PHRASES for w in p}
    return frozenset(sizes) | bag(
        "rectangular round square circular oval tallest shortest larger smaller wooden metal open closed empty lone "
        "corner middle single double same messy neat plain striped colored coloured dark light lower upper inner outer "
        "longest widest thinnest brightest darkest standing hanging free pulled out pushed in regular normal main"
    )
