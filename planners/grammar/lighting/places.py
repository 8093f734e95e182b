"""Reads light at a thing: "more light on the desk", "the corner by the plant is too dark", "brighten up the sofa area".

The words that name the thing are taken out, and what is left is read as light. It must name light, or the thing must be
named as a place ("the corner", "the sofa area", "only"): "make the sofa brighter" is about its paint.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....gaussians.world.words import singular
from ..restating.speech.frames import unframed
from ..tagging.words import bag
from ..vocabulary.nouns import is_known
from .lamps import is_lamp
from .reading import Heard, read
from .vocabulary import meanings

_PREPOSITIONS = (
    "on", "over", "above", "around", "onto", "at", "in", "near", "by", "under", "for", "behind", "of",
    "from", "beside", "next", "below", "beneath", "with", "through",
)  # fmt: skip
_TWO = (("next", "to"),)
_AREAS = bag("corner area spot space part bit side end nook zone section place region light")
_NEAR = ("over", "around", "near", "by", "under", "behind", "above", "at", "beside", "next", "below", "beneath")
_COMPARED = bag("brighter darker dimmer brighten darken twice half double less more warmer cooler softer as")
_TRIED = 8  # readings of a place that are tried
_SHINE = re.compile(
    r"(?:shine (?:a |some |more )?light on|spotlight|put (?:a |the |some )?(?:spotlight|spot light|accent light) on|"
    r"(?:put|throw|shed|cast|get|point) (?:some |more |a )?light (?:on|at|onto)|light up|illuminate) "
    r"(?P<what>.+?)(?: up| a bit| more)*"
)
_SHONE = 1.6
_SWITCHING, _LAMPS = bag("switch turn flick"), bag("lamp lamps light lights lantern chandelier bulb")
_POINTED = bag("the that this my our your")  # "turn the lights on the left down"
_PUTTING = bag("put place insert stand hang move set lay bring carry drag push add paint color colour recolor")
_ONLY = bag("only just solely exclusively")
_FIELD_MOODS = ("mood",)


class Somewhere(NamedTuple):
    """Light at a thing: what was understood of it, and the thing."""

    heard: Heard
    target: Query


Thing = Callable[[str], Query | None]


def somewhere(words: Sequence[str], loose: bool, thing: Thing) -> Somewhere | None:
    """What a clause says of the light at a thing, None if it says nothing of it.

    Args:
        words: in lower case, without marks.
        loose: whether "brighter" alone means the light; see `reading.read`.
        thing: reads a phrase for things.
    """
    plain = unframed(" ".join(words))
    shone = _SHINE.fullmatch(plain)
    query = thing(shone["what"]) if shone is not None and not is_lamp(shone["what"]) else None
    if query is not None and query.text not in ("room", "scene", "place"):
        return Somewhere(Heard({"exposure": _SHONE}, True), query)
    words = _without_room(words)
    return _behind_preposition(words, loose, thing) or _named_as_place(words, thing)


def _behind_preposition(words: Sequence[str], loose: bool, thing: Thing) -> Somewhere | None:
    """A place behind a preposition: "more light on the desk"."""
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
            heard = _plainly_read(left, lit or loose)
            near = loose and words[at] in _NEAR and bool(_COMPARED & set(left))
            if heard is None or not (lit or near or (loose and heard.remark) or _is_mood(heard, words)):
                continue
            behind = _trimmed(words[start:end])
            if not behind or (words[at] == "for" and not _is_noun(behind)) or _switches(left, behind):
                continue
            tried += 1
            if behind and tried <= _TRIED and _is_place(behind) and (query := thing(" ".join(behind))) is not None:
                return Somewhere(heard, query)
    return None


def _switches(left: Sequence[str], behind: Sequence[str]) -> bool:
    """Whether what is named is a lamp that is turned on or off: "night, with the lamp on"."""
    return bool({"on", "off"} & set(left)) and is_lamp(" ".join(behind))


def _plainly_read(words: Sequence[str], loose: bool) -> Heard | None:
    return read([w for w in words if w not in _ONLY], loose)


def _is_mood(heard: Heard, words: Sequence[str]) -> bool:
    """Whether a mood is asked for at a place: "golden hour on the bench"; not what is put there."""
    return "mood" in heard.fields and not _PUTTING & set(words)


def _named_as_place(words: Sequence[str], thing: Thing) -> Somewhere | None:
    """A thing that stands for its place: "brighten up the sofa area", "only the desk should be brighter"."""
    tried = 0
    for start, end, area in _spans(words):
        left = [w for w in (*words[:start], "the", "light", *words[end:]) if w not in _ONLY]
        bare = [w for w in (*words[:start], *words[end:]) if w not in _ONLY]
        if not (area or _ONLY & set(words[:start]) or _names_light(bare)) or _PUTTING & set(words[:start]):
            continue
        heard = read(left, True)
        if heard is None or "mood" in heard.fields:
            continue
        tried += 1
        if tried <= _TRIED and (query := thing(" ".join(words[start : end - area]))) is not None:
            return Somewhere(heard, query)
    return None


def _spans(words: Sequence[str]) -> Iterator[tuple[int, int, int]]:
    """Noun phrases that begin with a determiner: start, end, and how many words at their end say that a place is
    meant."""
    for start, word in enumerate(words):
        if word not in _POINTED:
            continue
        for end in range(min(len(words), start + 5), start + 1, -1):
            area = int(words[end - 1] in _AREAS and words[end - 1] != "light" and end - start > 2)
            phrase = words[start + 1 : end - area]
            if phrase and _is_noun(phrase):
                yield start, end, area
                break


def _is_noun(phrase: Sequence[str]) -> bool:
    last = phrase[-1]
    known = kinds.find(" ".join(phrase)) is not None or is_known(last)
    slots = {m.slot for m in meanings().get((last,), ())}
    return known and not slots & {"noun", "place", "air", "mood"} and singular(last) not in ("light", "room")


def _is_place(words: Sequence[str]) -> bool:
    """Whether words may name where light falls: some thing, not only what light is like."""
    article = words[0] in ("a", "an")
    return not article


def _without_room(words: Sequence[str]) -> Sequence[str]:
    """Words without the room in which a place is that is named behind it: "in the hallway by the door"."""
    for at in range(1, len(words) - 3):
        named = tuple(words[at : at + 2]) in (("in", "the"), ("in", "this"), ("in", "my"))
        room = any(m.slot == "place" for m in meanings().get((words[at + 2],), ()))
        if named and room and words[at + 3] in _PREPOSITIONS:
            return [*words[:at], *words[at + 3 :]]
    return words


def _without_area(words: Sequence[str]) -> list[str]:
    """Words before a place without what stands for it: "the corner (by the plant)"; "the light" takes its part."""
    if len(words) > 1 and words[-1] in _AREAS and words[-2] in ("the", "that", "this", "my"):
        return [*words[:-2], "the", "light"]
    return list(words)


def _trimmed(words: Sequence[str]) -> list[str]:
    behind = list(words)
    while behind and behind[-1] in ("please", "thanks", "now", "only", "too", "instead", "area"):
        behind.pop()
    return behind


def _names_light(words: Sequence[str]) -> bool:
    return bool({"light", "lights", "lighting", "illumination", "brightness", "exposure", "glow"} & set(words))
