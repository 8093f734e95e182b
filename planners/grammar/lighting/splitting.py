"""Takes what an instruction says of light out of it, clause by clause, and leaves the rest to the grammar."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from ....gaussians.language.query.query import Query
from ..tagging.words import Word, bag, split
from .lamps import switched
from .reading import Heard, read
from .vocabulary import meanings
from .wording import is_comparison, plainly

EVERYTHING = Query(text="everything", pick="all")
_MARKS = (",", ".", ";", "!", "?", ":", "\n")
_JOINING = ("and", "then", "but", "so", "because", "or")
_IT_IS = (("it", "is"), ("it", "looks"), ("it", "feels"), ("it", "seems"))
_HAVING = (("have", "it"), ("want", "it"), ("like", "it"), ("need", "it"), ("can", "it"), ("could", "it"))
_MOST = 12  # pieces of an instruction that are looked at
_PREPOSITIONS = (
    "on", "over", "above", "around", "onto", "at", "in", "near", "by", "under", "for", "behind", "of",
    "from", "beside", "next", "below", "beneath",
)  # fmt: skip
_TWO = (("next", "to"),)
_AREAS = bag("corner area spot space part bit side end nook zone section place region light")
_NEAR = ("over", "around", "near", "by", "under", "behind", "above", "at", "beside", "next", "below", "beneath")
_COMPARED = bag("brighter darker dimmer brighten darken twice half double less more warmer cooler softer as")
_TRIED = 8  # readings of a place that are tried
_SHINE = re.compile(
    r"(?:(?:please|can you|could you|now|just|i want you to) )*(?:light up|illuminate|"
    r"shine (?:a |some |more )?light on|"
    r"spotlight|put (?:a |the )?spotlight on|put (?:some |more )?light on|throw (?:some |more )?light on|"
    r"shed (?:some |more )?light on|cast (?:some |more )?light on) (?P<what>.+?)(?: please| up| a bit)?"
)
_SHONE = 1.6
_SWITCHING, _LAMPS = bag("switch turn flick"), bag("lamp lamps light lights lantern chandelier bulb")
_POINTED = bag("the that this my our your")  # "turn the lights on the left down"


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
    """The parts of an instruction, read in plain words if more of it is understood; see `_parts`."""
    plain = plainly(cleaned)
    if plain == cleaned:
        return _parts(cleaned, lit, alone, thing)
    found = _parts(plain, lit, alone, thing)
    if found is not None and all(part.fields is not None for part in found):
        return found
    said = _parts(cleaned, lit, alone, thing)
    return found if said is not None and found is not None and _read(found) > _read(said) else said


def _read(parts: Sequence[Part]) -> int:
    return sum(part.fields is not None for part in parts)


def _parts(cleaned: str, lit: bool, alone: bool, thing: Callable[[str], Query | None]) -> list[Part] | None:
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
            if end - at > 1 and _switched_apart(pieces[at:end], thing):
                continue
            understood = _clause(words, said or (alone and at == 0 and _bare(words)), thing)
            if understood is not None:
                before = found[-1][2] if found else None
                understood = _there(understood, before, words)
                if (
                    before is not None
                    and before.target == understood.target != EVERYTHING
                    and set(understood.fields) == {"kelvin"}
                ):
                    understood = replace(understood, fields={**before.fields, **understood.fields})
                    at = found.pop()[0]
                found.append((at, end, understood))
                at, said = end, True
                break
        else:
            explained = found and found[-1][2] is not None and is_comparison([w.text for w in pieces[at]])
            if not explained:  # "hard light, like the middle of July"
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
    r"\bstops?\b|\bev\b|cosi|cozi|\beyes\b|pitch|dinner|movie|romantic|date night|see (?:a|much)|rain|snow|storm|fog|"
    r"winter|novem|decem|cast\b|tint|tinge|bedtime|dinner|cinema|pendant|\d ?[ap]\.?m\b|"
    r"(?:less|more|too) (?:blue|yellow|orange|red|white)|exposed|"
    r"winter|nocturnal|tungsten|cinematic|bleach|washed|hygge|temperature",
    re.IGNORECASE,
)


_GREETING = re.compile(
    r"(?:(?:hi|hello|hey),? )?(?:a )?(?:very )?good (?:morning|evening|night|day)\b[\w ]*[.!]*", re.IGNORECASE
)


def may_be_light(cleaned: str) -> bool:
    """Whether any word could be about light; most instructions have none, and take no more time."""
    return _HINTS.search(cleaned) is not None and _GREETING.fullmatch(cleaned.strip()) is None


def _pieces(words: Sequence[Word]) -> list[list[Word]]:
    """The words between marks and conjunctions, without them."""
    found: list[list[Word]] = [[]]
    for word in words:
        degree = word.text == "so" and bool(found[-1]) and found[-1][-1].text in ("not", "is", "are", "ever")
        if word.text in _MARKS or (word.text in _JOINING and not degree):
            found.append([])
        else:
            found[-1].append(word)
    return [piece for piece in found if piece]


def _switched_apart(pieces: Sequence[Sequence[Word]], thing: Callable[[str], Query | None]) -> bool:
    """Whether the first and the last of several pieces switch lamps each: "table lamp on, floor lamp off"."""
    said = [[w.text for w in piece] for piece in (pieces[0], pieces[-1])]
    return all({"on", "off", "out"} & set(words) and switched(" ".join(words), thing) is not None for words in said)


def _is_filler(pieces: Sequence[Sequence[Word]]) -> bool:
    """Whether pieces only hold words that say nothing: "please"."""
    return all(any(m.slot == "filler" for m in meanings().get((w.text,), ())) for piece in pieces for w in piece)


def _bare(words: Sequence[str]) -> bool:
    """Whether words name nothing that they are about: "a bit brighter please", "it is too dark"."""
    if tuple(words[:2]) in _IT_IS or any(pair in _HAVING for pair in pairwise(words)):
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
    return _somewhere(words, loose, thing)


def _there(said: _Said, before: _Said | None, words: Sequence[str]) -> _Said:
    """A clause that says "it" of a place or lamp of the remark before: "the light there is too yellow, cool it"."""
    named = before is not None and before.remark and before.target != EVERYTHING
    toned = set(said.fields) == {"kelvin"} and words[0] in ("like", "at", "about", "around", "say")
    if toned and before is not None and said.target == EVERYTHING:
        return replace(said, target=before.target)  # "more light on the desk, like 4000 K"
    if named and before is not None and said.target == EVERYTHING and {"it", "that"} & set(words):
        return replace(said, target=before.target)
    return said


def _asked(words: Sequence[str]) -> bool:
    return bool({"make", "can", "could", "please", "want", "would"} & set(words))


def _somewhere(words: Sequence[str], loose: bool, thing: Callable[[str], Query | None]) -> _Said | None:
    """Light at a thing: "more light on the desk", "the corner by the plant is too dark"."""
    tried = 0
    for at in range(1, len(words) - 1):
        if words[at] not in _PREPOSITIONS:
            continue
        if words[at] == "on" and words[0] in _SWITCHING and words[at - 1] in _LAMPS and words[at + 1] not in _POINTED:
            continue  # "switch the lamp on, and an evening light"
        two = tuple(words[at : at + 2]) in _TWO
        start = at + 2 if two else at + 1
        before = _without_area(words[:at])
        for end in range(len(words), start, -1):
            left = [*before, *words[end:]]
            lit = _names_light(left) or before != list(words[:at])
            heard: Heard | None = read(left, lit or loose)
            near = loose and words[at] in _NEAR and bool(_COMPARED & set(left))
            if heard is None or "mood" in heard.fields or not (lit or near or (loose and heard.remark)):
                continue
            behind = _trimmed(words[start:end])
            tried += 1
            if behind and tried <= _TRIED and (query := thing(" ".join(behind))) is not None:
                return _Said(heard.fields, query, heard.remark and not _asked(words))
    return None


def _without_area(words: Sequence[str]) -> list[str]:
    """Words before a place without what stands for it: "the corner (by the plant)"; "the light" takes its part."""
    if len(words) > 1 and words[-1] in _AREAS and words[-2] in ("the", "that", "this", "my"):
        return [*words[:-2], "the", "light"]
    return list(words)


def _trimmed(words: Sequence[str]) -> list[str]:
    behind = list(words)
    while behind and behind[-1] in ("please", "thanks", "now"):
        behind.pop()
    return behind


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
