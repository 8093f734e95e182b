"""Commands for a material in free order: "sofa in brown leather", "put big tiles on the floor, 60 by 60, light gray".

What is said of the surface is read word by word: names of materials, colours, lengths, and adjectives that change
nothing here. The command becomes one about a new colour: "paint the floor #tiles~light-gray@60-cm".
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

from .....gaussians.color import QUALIFIERS
from .....gaussians.world import kinds
from .....gaussians.world.finishes import described, single_words
from .....gaussians.world.finishes import said as finish_said
from .....gaussians.world.lengths import UNITS
from ...tagging.lookahead import color_at
from ...tagging.words import bag
from ...vocabulary.materials import COLORS_TOO, mark
from ..chunks import is_thing

_MOST_WORDS = 26
_POLITE = bag("please now then also next finally and ok okay just maybe well so hey hi yes but")
_OPENING = re.compile(
    r"^(?:(?:can|could|would) (?:you|we) |i (?:would|'d) (?:like|love|prefer) |i (?:want|need) |we (?:want|need) |"
    r"let us |go ahead and |please |how about |what about |try |maybe )+"
)
_DO = bag(
    "make do cover upholster reupholster clad wrap finish refinish restyle texture retexture redo dress line "
    "style have turn render tile retile panel surface resurface decorate change switch convert build rebuild "
    "remake redecorate wallpaper recover coat give swap replace put set carpet pave plate veneer want let"
)
_LAY = bag("put use apply lay add spread try have stick get")
_LINK = bag(
    "to be in into with out of from for look looks looking like have has made get become becomes using all over "
    "done a an some it being up completely entirely covered upholstered finished go through as"
)
_PLAIN_LINKS = {"in", "of", "from", "out", "made", ":", "with", "to"}  # between a thing and its surface without a verb
_CUED = bag("in of from out made with look looks")  # behind these a word for a colour or a material is a material
_ONTO = bag("on onto over for across upon")
# What is said of a surface and changes nothing here.
_ADJECTIVES = bag(
    "polished glossy matte matt shiny rough smooth real solid nice old big large small smaller bigger larger wide "
    "thin thick raw plain patterned modern classic some a an the of in with sort kind maybe something really very "
    "quite more like style effect finish look texture pattern ones one type and , - chunky soft fine coarse "
    "brushed hammered wavy beautiful proper good worn weathered distressed aged vintage antique natural pure "
    "light-coloured by x n tone toned coloured colored colour color please tinted horizontal vertical diagonal "
    "narrow broad subtle bold tiny little huge long short high satin-finish glazed unglazed sealed oiled waxed "
    "lacquer-finish new fresh warm cold cool veins veining grout joints cladding covering panels flooring "
    "wallpaper upholstery print design material fabric surface boards stuff square round hexagonal thing too not "
    "busy everywhere only"
)
_SECOND = bag("veins veining grout joints mortar lines dots stripes spots")
_KEPT = re.compile(
    r",? ?(?:and |but )?(?:(?:the|its) [^,]+? (?:stays?|remains?|can stay|should stay) "
    r"(?:as (?:it |they )?(?:is|are|it is)|the same|like that|unchanged)|keep (?:the|its) [^,]+|"
    r"leave (?:the|its) [^,]+|do not (?:touch|change) [^,]+|nothing (?:too )?\w+|not too \w+|"
    r"if you can|if possible|thanks|thank you|please)$"
)
_TRIED = re.compile(
    r"^(?:would|could|can|might|should) (?P<thing>(?:the|my|our|this|that|it|both|all)\b.*?) "
    r"(?:look (?:nicer|better|good|nice|great|fine|ok|cool|prettier)?|have|get|be|become|go) ?(?P<rest>.+)$"
)
_REMARKED = re.compile(r"^(?P<lead>.+?) , (?P<ask>(?:could|can|would|should) (?:it|they|that) .+)$")
_LOOSE = bag(
    "sand gravel pebbles grass straw paper boards bricks rock rocks cloth flags flowers roses knit china felt "
    "cane clay turf lawn cord plank tile spots checks stars rubble mosaic"
)
_FIXED = bag("floor floors wall walls ceiling ground worktop countertop backsplash counter flooring")
_UNIT = "|".join(sorted((u for u in UNITS if u.isalpha() and UNITS[u] != "units"), key=lambda u: (-len(u), u)))


class _Surface(NamedTuple):
    """What is said of a surface, as a word that stands for it; `plain`: only a colour, in plain words."""

    mark: str
    names: tuple[str, ...]
    plain: str = ""


def names_material(said: str) -> bool:
    """Whether a word of a sentence may name a material."""
    return not single_words().isdisjoint(said.split())


def covered(said: str) -> str | None:
    """A command for a material in other words; None if it is none, or if other rules know better."""
    texts = said.split()
    if len(texts) > _MOST_WORDS or not names_material(said) or texts[0] == "paint":
        return None
    bare = _KEPT.sub("", _KEPT.sub("", said)).strip(" ,")
    if (asked := _REMARKED.match(bare)) is not None and (told := _one(asked["ask"])) is not None:
        return f"{asked['lead']} , {told}"
    whole = _one(bare)
    if whole is not None:
        return whole
    parts = [p.strip(" ,") for p in re.split(r" , and | and | , but | , ", bare)]
    if not 2 <= len(parts) <= 4:
        return None
    found = [_one(part) or _colored(part) for part in parts]
    return " and ".join(f for f in found if f) if all(found) and any(map(_one, parts)) else None


def _one(said: str) -> str | None:
    """One command with one material."""
    if (tried := _TRIED.match(said)) is not None:
        return next(
            (f"paint {t} {s.mark}" for t, s in _split(f"{tried['thing']} {tried['rest']}".split(), {"", *_LINK})), None
        )
    opened = _OPENING.match(said) is not None
    texts = _OPENING.sub("", said).split()
    while texts and texts[0] in _POLITE:
        texts = texts[1:]
    if not texts:
        return None
    readings: Iterator[tuple[str, _Surface]] = iter(())
    if texts[0] in _DO and texts[0] != "put":
        readings = _split(texts[1:], {"", *_LINK})
    if texts[0] == "put" and "in" in texts:
        readings = _split(texts[1:], {"in", "into"})
    found = next(readings, None) or next(_laid(texts), None)
    if found is None and texts[0] not in _DO:
        found = next(
            _split(texts, {"", *_LINK} if opened else {"in", "of", "from", "out", "made", ":", "with", "to"}), None
        )
        found = found or next(_before(texts), None)
    return f"paint {found[0]} {found[1].mark}" if found is not None else None


def _split(texts: Sequence[str], links: set[str]) -> Iterator[tuple[str, _Surface]]:
    """A thing, words that link, and a surface that ends the command."""
    for end in range(1, len(texts)):
        at = end
        while at < len(texts) and texts[at] in (_LINK | {":", "should", "must", "needs", "wants"}):
            at += 1
        linked = texts[end:at]
        if (linked[0] if linked else "") not in links and not {"should", "must", "needs"} & set(linked):
            continue
        if linked[:1] == ["with"] and texts[end - 1] not in _FIXED and "" not in links:
            continue
        if not _is_target(texts[:end]):
            continue
        surface = _surface(texts[at:], bool(_CUED & set(linked)))
        if surface is None or surface.plain or _is_new_thing(texts[at - 1 : at], texts[at:]):
            continue
        yield " ".join(texts[:end]), surface


def _laid(texts: Sequence[str]) -> Iterator[tuple[str, _Surface]]:
    """A surface, "on", and a thing, perhaps with more of the surface behind a comma."""
    start = int(texts[0] in _LAY)
    if texts[start : start + 1] in (["a"], ["an"], ["the"]):
        return
    for at in range(start + 1, len(texts) - 1):
        if texts[at] not in _ONTO:
            continue
        for end in range(len(texts), at + 1, -1):
            if end < len(texts) and texts[end] != ",":
                continue
            if not _is_target(texts[at + 1 : end]):
                continue
            surface = _surface([*texts[start:at], *texts[end:]], True)
            things = surface is not None and all(n in _LOOSE or kinds.find(n) is not None for n in surface.names)
            if surface is None or surface.plain or (things and texts[end - 1] not in _FIXED):
                continue
            yield " ".join(texts[at + 1 : end]), surface


def _before(texts: Sequence[str]) -> Iterator[tuple[str, _Surface]]:
    """ "stainless steel fridge", "checkerboard floor black and white": a surface before a thing without an article."""
    for at in range(1, len(texts)):
        for end in range(len(texts), at, -1):
            thing = texts[at:end]
            if len(thing) > 3 or (kinds.find(" ".join(thing)) is None and thing[-1] not in _FIXED):
                continue
            surface = _surface([*texts[:at], *texts[end:]], True)
            if surface is not None and not surface.plain and texts[0] not in ("a", "an", "the", "some"):
                yield f"the {' '.join(thing)}", surface


def _colored(said: str) -> str | None:
    """ "the right wall just plain white" beside a command for a material."""
    texts = [t for t in said.split() if t not in ("just", "plain", "only", "then")]
    for end in range(1, len(texts)):
        if _is_target(texts[:end]):
            at = end + (texts[end] in ("in", "to"))
            surface = _surface(texts[at:], False)
            if surface is not None and surface.plain:
                return f"paint {' '.join(texts[:end])} {surface.plain}"
    return None


def _is_target(texts: Sequence[str]) -> bool:
    """Whether words are one noun phrase that may get a surface: no part of one, and no material alone."""
    if tuple(texts) in (("it",), ("them",), ("this",), ("that",), ("everything",)):
        return True
    named = " ".join(texts)
    if texts[-1] in (":", ",") or finish_said(named) is not None or "," in texts or texts[-1] in _ADJECTIVES:
        return False
    return is_thing(tuple(texts))


def _is_new_thing(before: Sequence[str], texts: Sequence[str]) -> bool:
    """Whether words name a thing instead of a surface: "replace the rug with a carpet"."""
    article = [*before, *texts][:1] in (["a"], ["an"]) or texts[:1] in (["a"], ["an"])
    plain = [t for t in texts if t not in ("a", "an", "one")]
    return article and len(plain) == 1 and kinds.find(plain[0]) is not None


def _surface(texts: Sequence[str], cued: bool) -> _Surface | None:
    """What words say of a surface, None if any of them says something else.

    Args:
        cued: whether the words before say that it is made of something; "gold" is a colour otherwise.
    """
    names: list[str] = []
    hues: list[str] = []
    second = ""
    size: tuple[str, str] | None = None
    i = 0
    while i < len(texts):
        if length := _length_at(texts, i):
            size, taken = (length[0], length[1]), length[2]
        elif name := _finish_at(texts, i):
            names.append(name)
            taken = len(name.split())
        elif (hue := color_at(texts, i)) is not None:
            taken = hue[1]
            if texts[i + taken : i + taken + 1] and texts[i + taken] in _SECOND and names:
                second = hue[0]
            else:
                hues.append(hue[0])
        elif texts[i] in _ADJECTIVES or texts[i] in QUALIFIERS or texts[i] in _SECOND:
            taken = 1
        else:
            return None
        i += taken
    return _told(_Read(tuple(texts), tuple(names), tuple(hues), second, size), cued)


class _Read(NamedTuple):
    """The words of a surface, and the materials, colours and length among them."""

    texts: tuple[str, ...]
    names: tuple[str, ...]
    hues: tuple[str, ...]
    second: str
    size: tuple[str, str] | None


def _told(read: _Read, cued: bool) -> _Surface | None:
    texts, names, second, size = read.texts, read.names, read.second, read.size
    hues = list(read.hues)
    if not names:
        return _Surface("", (), " ".join(hues)) if len(hues) == 1 else None
    if not cued and all(name in COLORS_TOO for name in names) and len(names) == 1:
        return None
    said = described(" ".join(names))
    if said is None or said.finish is None:
        return None
    chosen = next((n for n in names if (f := finish_said(n)) is not None and f.finish == said.finish), names[-1])
    shade = next((q for q in ("dark", "light", "pale") if q in texts and not hues), "")
    shaded = described(f"{shade} {chosen}") if shade else None
    if second and not hues:
        own = color_at(chosen.split(), 0)
        hues = [own[0]] if own is not None else []
    hues = [*hues[:1], second] if second and hues else hues
    colors = hues[:2] or ([shaded.color] if shaded is not None and shaded.color else [])
    return _Surface(mark(chosen, *colors, size=size), tuple(names))


def _finish_at(texts: Sequence[str], i: int) -> str:
    """The longest name of a material at a position, "" if there is none."""
    for taken in (4, 3, 2, 1):
        name = " ".join(texts[i : i + taken])
        if i + taken <= len(texts) and finish_said(name) is not None:
            return name
    return ""


@cache
def _sized() -> re.Pattern[str]:
    return re.compile(rf"^(?P<n>\d[\d.]*)(?: ?(?P<u>{_UNIT}))?$")


def _length_at(texts: Sequence[str], i: int) -> tuple[str, str, int] | None:
    """A length at a position, with its unit and its number of words: "60 by 60", "10 cm", "30 cm x 30 cm"."""
    if not texts[i][0].isdigit() or _sized().match(texts[i]) is None:
        return None
    numbers, unit, at = [texts[i]], "", i + 1
    while at < len(texts) and (texts[at] in ("x", "by") or texts[at] in UNITS or texts[at][0].isdigit()):
        if texts[at] in UNITS:
            unit = texts[at]
        elif texts[at][0].isdigit():
            numbers.append(texts[at])
        at += 1
    value = max(float(n) for n in numbers if _sized().match(n))
    if not unit:
        unit = "m" if value < 3 else "cm" if value <= 200 else "mm"
    return f"{value:g}", unit, at - i
