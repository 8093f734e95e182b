"""What a description says of floor, walls and ceiling: taken out of its words before the things are read.

"an oak floor", "walls of exposed brick", "carpet on the floor", "herringbone parquet" become features of the brief,
each a phrase and the part of the room that it is about: "oak floor", "exposed brick walls".
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from ....gaussians.world.finishes import FinishName, described, said
from ....gaussians.world.styles import ROLES
from ....gaussians.world.words import singular
from ...grammar.tagging.words import bag

PARTS = {
    "floor": "floor", "floors": "floor", "flooring": "floor", "ground": "floor", "floorboards": "floor",
    "wall": "walls", "walls": "walls", "wallpaper": "walls", "wallpapers": "walls", "backsplash": "walls",
    "ceiling": "ceiling", "ceilings": "ceiling", "furniture": "furniture", "furnishings": "furniture",
}  # fmt: skip
_BETWEEN = bag("is are be in of made out with covered painted from a an the has all done clad tiled as")
_OVER = bag("on across over for")
_BEFORE_PART = bag("the all every its their four three both")
# Behind a part of the room these words make it a name: "floor lamp", "wall clock".
_NAMED = bag(
    "lamp lamps clock shelf shelves cabinet cabinets mirror cushion cushions light lights art hanging hangings mounted "
    "speaker fan unit units plan space area to length high sconce sconces bed rail hooks"
)
# Materials that are said alone and lie on floors, or cover walls.
_FLOORS: frozenset[FinishName] = frozenset({"parquet", "planks"})
_ALONE_FLOOR = ("tatami", "terrazzo", "laminate", "linoleum", "lino", "floorboards", "stone flags", "flags",
                "polished concrete", "poured concrete")  # fmt: skip
_ALONE_WALL = ("exposed brick", "exposed bricks", "bare brick", "brick", "brickwork", "metro tiles", "subway tiles",
               "wainscoting", "shiplap", "whitewashed", "limewashed")  # fmt: skip
_LONGEST = 5  # words of a phrase
_ENDS = bag(", . ; : ! ? and with")
_QUIET = bag(
    "polished raw rough old plain patterned sloped shiny glossy matte matt worn wide broad big large small bare "
    "exposed warm cold dark light pale tiled painted smooth natural solid real"
)


class Extracted(NamedTuple):
    """The words that are left, and the features that were taken out of the others."""

    texts: list[str]
    features: list[str]


def extracted(texts: Sequence[str]) -> Extracted:
    """The words of a description without what they say of floor, walls and ceiling."""
    words = _made_of(list(texts))
    features: list[str] = []
    i = 0
    while i < len(words):
        found = _before(words, i) or _behind(words, i) or _over(words, i) or _alone(words, i)
        if found is None:
            i += 1
            continue
        start, end, feature = found
        features.append(feature)
        words[start:end] = _left(words, start, end)
        i = start
    return Extracted(words, features)


def _made_of(words: list[str]) -> list[str]:
    """The words with "a workbench of plywood" as "a plywood workbench"."""
    i = 1
    while i < len(words):
        at = i + 1 + (words[i : i + 2] == ["made", "of"])
        if words[i] in ("of", "in", "made") and singular(words[i - 1]) in _furniture():
            for end in range(min(len(words), at + 3), at, -1):
                told = described(" ".join(words[at:end]))
                if (end == len(words) or words[end] in _ENDS) and told and told.finish and _tells(words[at:end]):
                    start = i - 1 - (" ".join((*words[i - 2 : i - 1], singular(words[i - 1]))) in _furniture())
                    words[start:end] = [*words[at:end], *words[start:i]]
                    break
        i += 1
    return words


@cache
def _furniture() -> frozenset[str]:
    """Names of furniture, which may be made of something."""
    return frozenset(name for names in ROLES.values() for name in names)


def _left(words: Sequence[str], start: int, end: int) -> list[str]:
    """What stands in place of words that were taken out: nothing beside a mark, else a comma."""
    before = words[start - 1] if start else "."
    behind = words[end] if end < len(words) else "."
    return [] if before in _ENDS or behind in _ENDS else [","]


def _phrase(words: Sequence[str]) -> str:
    """A phrase that says what a surface is like, "" if it does not."""
    told = " ".join(words)
    return told[:50] if words and described(told) is not None else ""


def _is_part(words: Sequence[str], i: int) -> str:
    """The part of the room that a word names; not as part of a name: "floor lamp", "wall clock"."""
    part = PARTS.get(words[i], "") if i < len(words) else ""
    if not part:
        return ""
    return "" if i + 1 < len(words) and words[i + 1] in _NAMED else part


def _before(words: Sequence[str], i: int) -> tuple[int, int, str] | None:
    """ "an oak floor", "white metro tile walls" with the first word of the phrase at position `i`."""
    for end in range(min(len(words), i + _LONGEST), i, -1):
        part = _is_part(words, end)
        if not part or any(w in _ENDS and w != "and" for w in words[i:end]):
            continue
        phrase = words[i:end]
        if not _tells(phrase):
            continue
        start = i - (i > 0 and words[i - 1] in ("a", "an", "the"))
        stop = end + 1 + (words[end] == "wallpaper" and words[end + 1 : end + 3] == ["on", "the"] and 3)
        color, stop = _color_behind(words, min(stop, len(words)))
        return start, stop, f"{color}{_phrase(phrase)} {part}"
    return None


def _color_behind(words: Sequence[str], i: int) -> tuple[str, int]:
    """The colour in "panelled walls in dark blue", from position `i` on, and where it ends."""
    at = i
    while at < len(words) and at < i + 2 and words[at] in ("in", "painted"):
        at += 1
    for end in range(min(len(words), at + 3), at, -1) if at > i else ():
        told = described(" ".join(words[at:end])) if all(w.isalpha() for w in words[at:end]) else None
        if told is not None and told.finish is None and told.color.split() == list(words[at:end]):
            return f"{told.color} ", end
    return "", i


def _tells(phrase: Sequence[str]) -> bool:
    """Whether every word of a phrase belongs to what it says of a surface."""
    if not _phrase(phrase) or phrase[0] in ("and", "of", "in") or "with" in phrase:
        return False
    return all(
        w in _QUIET or w == "and" or described(w) is not None or _inside(phrase, k) for k, w in enumerate(phrase)
    )


def _inside(phrase: Sequence[str], k: int) -> bool:
    """Whether a word is part of the name of a material or of a colour of several words."""
    return any(
        said(" ".join(phrase[a:b])) is not None
        for a in range(max(0, k - 2), k + 1)
        for b in range(k + 1, min(len(phrase), k + 3) + 1)
        if b - a > 1
    )


def _behind(words: Sequence[str], i: int) -> tuple[int, int, str] | None:
    """ "walls of exposed brick", "the floor grey tile", "wallpaper with stars" with the part at position `i`."""
    part = _is_part(words, i)
    if not part:
        return None
    start = i - (i > 0 and words[i - 1] in ("the", "its", "all"))
    at = i + 1
    while at < len(words) and words[at] in _BETWEEN | {":"}:
        at += 1
    for end in range(min(len(words), at + _LONGEST), at, -1):
        if _tells(words[at:end]) and not _is_part(words, end) and (end == len(words) or words[end] in _ENDS):
            return start, end, f"{_phrase(words[at:end])} {part}"
    return None


def _over(words: Sequence[str], i: int) -> tuple[int, int, str] | None:
    """ "carpet on the floor", "green tiles behind" with the phrase at position `i`."""
    for end in range(min(len(words), i + _LONGEST), i, -1):
        if not _tells(words[i:end]) or end >= len(words) or words[end] not in _OVER:
            continue
        at = end + 1
        while at < len(words) and words[at] in _BEFORE_PART:
            at += 1
        if at < len(words) and (part := _is_part(words, at)):
            start = i - (i > 0 and words[i - 1] in ("a", "an", "the"))
            return start, at + 1, f"{_phrase(words[i:end])} {part}"
    return None


def _alone(words: Sequence[str], i: int) -> tuple[int, int, str] | None:
    """ "herringbone parquet", "exposed brick", "white metro tiles" between marks, with its first word at `i`."""
    if i and words[i - 1] not in _ENDS:
        return None
    for end in range(min(len(words), i + _LONGEST), i, -1):
        if (end < len(words) and words[end] not in _ENDS) or not _tells(words[i:end]) or "and" in words[i:end]:
            continue
        told = described(" ".join(words[i:end]))
        last = [" ".join(words[k:end]) for k in range(i, end)]
        if told is None or told.finish is None:
            continue
        if any(w in _ALONE_WALL for w in last) or (told.finish == "tiles" and len(last) > 1):
            return i, end, f"{_phrase(words[i:end])} walls"
        if told.finish == "wood" and words[end - 1] in ("wood", "timber") and i and words[i - 1] == "with":
            return i, end, f"{_phrase(words[i:end])} furniture"
        if any(w in _ALONE_FLOOR for w in last) or (told.finish in _FLOORS and singular(words[end - 1]) != "panel"):
            return i, end, f"{_phrase(words[i:end])} floor"
    return None
