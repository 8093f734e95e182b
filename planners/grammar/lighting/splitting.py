"""Takes what an instruction says of light out of it, clause by clause, and leaves the rest to the grammar."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ....gaussians.language.query.query import Query
from ..tagging.words import Word, split
from .lamps import switched
from .reading import Heard, read
from .vocabulary import meanings

EVERYTHING = Query(text="everything", pick="all")
_MARKS = (",", ".", ";", "!", "?", ":", "\n")
_JOINING = ("and", "then", "but", "so", "because", "or")
_IT_IS = (("it", "is"), ("it", "looks"), ("it", "feels"), ("it", "seems"))
_MOST = 12  # pieces of an instruction that are looked at
_PREPOSITIONS = ("on", "over", "above", "around", "onto", "at", "in", "near", "by", "under", "for", "behind", "of")
_SHINE = re.compile(
    r"(?:(?:please|can you|could you|now|just|i want you to) )*(?:light up|illuminate|"
    r"shine (?:a |some |more )?light on|"
    r"spotlight|put (?:a |the )?spotlight on|put (?:some |more )?light on|throw (?:some |more )?light on|"
    r"shed (?:some |more )?light on|cast (?:some |more )?light on) (?P<what>.+?)(?: please| up| a bit)?"
)
_SHONE = 1.6


@dataclass(frozen=True)
class Part:
    """A part of an instruction.

    Attributes:
        text: its words as they stand.
        fields: of the operation, without its target; None where the grammar reads it.
        target: what of the scene it means.
    """

    text: str
    fields: dict[str, Any] | None = None
    target: Query = EVERYTHING


def parts_of(cleaned: str, lit: bool, alone: bool, thing: Callable[[str], Query | None]) -> list[Part] | None:
    """The parts of an instruction, None if nothing of it is about light.

    Args:
        cleaned: see `tagging.words.clean`.
        lit: whether the instruction before was about light.
        alone: whether there was no instruction before.
        thing: reads a phrase for things.
    """
    pieces = _pieces(split(cleaned))
    if not pieces or len(pieces) > _MOST:
        return None
    found: list[tuple[int, int, _Said | None]] = []
    at, said = 0, lit
    while at < len(pieces):
        for end in range(len(pieces), at, -1):
            words = [w.text for piece in pieces[at:end] for w in piece if w.text not in _MARKS]
            understood = _clause(words, said or (alone and at == 0 and _bare(words)), thing)
            if understood is not None:
                found.append((at, end, understood))
                at, said = end, True
                break
        else:
            found.append((at, at + 1, None))
            at += 1
    if all(one is None for _, _, one in found):
        return None
    return _joined(cleaned, pieces, found)


@dataclass(frozen=True)
class _Said:
    fields: dict[str, Any]
    target: Query
    remark: bool = False


_HINTS = re.compile(
    r"light|lit\b|bright|dark|dim|lamp|warm|cool|cold|glow|sun|moon|night|evening|dusk|dawn|morning|day|candle|mood|"
    r"atmos|ambi|kelvin|\bk\b|\d{4,5} ?k|exposure|illum|gloom|ding|murk|overcast|cloud|noon|twilight|golden|contrast|"
    r"shadow|lantern|chandelier|cosy|cozy|sconce|bulb|fire|rainy|white balance|vibe|romantic|shade|blinding|glar|"
    r"(?:less|more|too) (?:blue|yellow|orange|red|white)|exposed|"
    r"winter|nocturnal|tungsten|cinematic|bleach|washed|hygge|temperature",
    re.IGNORECASE,
)


def may_be_light(cleaned: str) -> bool:
    """Whether any word could be about light; most instructions have none, and take no more time."""
    return _HINTS.search(cleaned) is not None


def _pieces(words: Sequence[Word]) -> list[list[Word]]:
    """The words between marks and conjunctions, without them."""
    found: list[list[Word]] = [[]]
    for word in words:
        if word.text in _MARKS or word.text in _JOINING:
            found.append([])
        else:
            found[-1].append(word)
    return [piece for piece in found if piece]


def _is_filler(pieces: Sequence[Sequence[Word]]) -> bool:
    """Whether pieces only hold words that say nothing: "please"."""
    return all(any(m.slot == "filler" for m in meanings().get((w.text,), ())) for piece in pieces for w in piece)


def _bare(words: Sequence[str]) -> bool:
    """Whether words name nothing that they are about: "a bit brighter please", "it is too dark"."""
    if tuple(words[:2]) in _IT_IS:
        return True
    return len(words) > 1 and not {"it", "this", "that", "them", "these", "those"} & set(words)


def _clause(words: Sequence[str], loose: bool, thing: Callable[[str], Query | None]) -> _Said | None:
    """What one clause says of light."""
    said = " ".join(words)
    if (lamps := switched(said, thing)) is not None:
        return _Said(lamps.fields, lamps.target or EVERYTHING)
    if (heard := read(words, loose)) is not None:
        return _Said(heard.fields, EVERYTHING, heard.remark and not _asked(words))
    if (shone := _SHINE.fullmatch(said)) is not None and (query := thing(shone["what"])) is not None:
        return _Said({"exposure": _SHONE}, query)
    return _somewhere(words, thing)


def _asked(words: Sequence[str]) -> bool:
    return bool({"make", "can", "could", "please", "want", "would"} & set(words))


def _somewhere(words: Sequence[str], thing: Callable[[str], Query | None]) -> _Said | None:
    """Light at a thing: "more light on the desk"."""
    for at in range(2, len(words) - 1):
        if words[at] not in _PREPOSITIONS:
            continue
        heard: Heard | None = read(words[:at])
        if heard is None or "mood" in heard.fields or not _names_light(words[:at]):
            continue
        behind = list(words[at + 1 :])
        while behind and behind[-1] in ("please", "thanks", "now"):
            behind.pop()
        if behind and (query := thing(" ".join(behind))) is not None:
            return _Said(heard.fields, query)
    return None


def _names_light(words: Sequence[str]) -> bool:
    return bool({"light", "lights", "lighting", "illumination", "brightness", "exposure", "glow"} & set(words))


def _joined(cleaned: str, pieces: list[list[Word]], found: list[tuple[int, int, _Said | None]]) -> list[Part]:
    """Parts in their order; what is not about light in runs, with the words between them. A remark ("too dark") behind
    or before which something is asked of the light says nothing more."""
    asked = any(one is not None and not one.remark for _, _, one in found)
    parts: list[Part] = []
    start: int | None = None
    for i, (first, last, one) in enumerate(found):
        if one is None and _is_filler(pieces[first:last]):
            continue
        if one is None:
            start = pieces[first][0].start if start is None else start
            following = found[i + 1][2] if i + 1 < len(found) else one
            if i + 1 == len(found) or following is not None:
                end = pieces[last - 1][-1].end
                parts.append(Part(cleaned[start:end]))
                start = None
            continue
        if one.remark and asked:
            continue
        text = cleaned[pieces[first][0].start : pieces[last - 1][-1].end]
        parts.append(Part(text, one.fields, one.target))
    return parts
