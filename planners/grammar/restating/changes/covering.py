"""Commands for a material in free order: "sofa in brown leather", "put big tiles on the floor, 60 by 60, light gray".

What is said of the surface is read word by word: names of materials, colours, lengths, and adjectives that change
nothing here. The command becomes one about a new colour: "paint the floor #tiles~light-gray@60-cm".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

from .....gaussians import late_re as re
from .....gaussians.color import QUALIFIERS
from .....gaussians.world import kinds
from .....gaussians.world.finishes import described, single_words
from .....gaussians.world.finishes import said as finish_said
from .....gaussians.world.lengths import UNITS
from .....gaussians.world.spelling import best_slip
from ...tagging.lookahead import color_at
from ...tagging.spelling import is_word
from ...tagging.words import bag
from ...vocabulary.materials import COLORS_FIRST, COLORS_TOO, METALS_TOO, mark
from ..chunks import is_thing
from ..speech.frames import is_reported
from .surfaces import is_fixed, is_soft, plainer, retold, style_words, subject

_MOST_WORDS = 26
_SHORT = 5  # letters; shorter words are not corrected
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
    "exposed bare brushed tumbled split rough-cut painted stained lacquered varnished sanded charred whitewashed "
    "reclaimed recycled crushed ribbed ridged woven quilted tufted padded buttoned silky shaggy thick-pile grained "
    "knotty gnarled cracked chipped rusted patinated oxidised oxidized mirrored reflective sparkly sparkling "
    "honed frosted iridescent crumpled grainy porous handmade hand artisan genuine authentic traditional rustic "
    "elegant luxurious luxury expensive cheap fancy posh fake faux imitation artificial industrial retro sleek "
    "untreated unpainted unfinished heavy lightweight crisp dirty used second-hand aged-looking "
    "light-coloured by x n tone toned coloured colored colour color please tinted horizontal vertical diagonal "
    "narrow broad subtle bold tiny little huge long short high satin-finish glazed unglazed sealed oiled waxed "
    "lacquer-finish new fresh warm cold cool veins veining grout joints cladding covering panels flooring "
    "wallpaper upholstery print design material fabric surface boards stuff square round hexagonal thing too not "
    "busy everywhere only"
)
_SHADES = bag("dark light pale deep bleached blond blonde")
_OUGHT = bag("should must needs be is wants")
_LOOKS = bag("texture look finish effect pattern material surface veneer cladding covering wallpaper design print")
_AS_VERBS = {
    "plaster": "plaster", "carpet": "carpet", "tile": "tiles", "turf": "turf", "gild": "gold", "brick": "brick",
    "pebble": "pebbles", "board": "boards", "panel": "panelling", "concrete": "concrete", "pave": "stone",
    "whitewash": "whitewash", "thatch": "thatch", "grass": "grass", "chrome": "chrome",
}  # fmt: skip
_DETERMINED = bag("the that this my our both all every")
_SECOND = bag("veins veining grout joints mortar lines dots stripes spots")
_KEPT = re.compile(
    r"(?: ,|,)? (?:and |but )?(?:(?:the|its) [^,]+? (?:stays?|remains?|can stay|should stay) "
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


def spelled(said: str) -> str:
    """A sentence with the names of materials spelt right."""
    return " ".join(map(_spelled, said.split()))


def _spelled(word: str) -> str:
    if len(word) < _SHORT or is_word(word) or word in single_words():
        return word
    meant = best_slip(word, single_words())
    return meant if meant and meant[-1] == word[-1] else word  # "upholster" is not "upholstery"


def covered(said: str) -> str | None:
    """A command for a material in other words; None if it is none, or if other rules know better."""
    texts = said.split()
    if len(texts) > _MOST_WORDS or not names_material(said) or texts[0] == "paint":
        return None
    bare = _KEPT.sub("", _KEPT.sub("", said)).strip(" ,")
    if (asked := _REMARKED.match(bare)) is not None and (told := _one(asked["ask"])) is not None:
        about = subject(asked["lead"].split())
        return told.replace("paint it ", f"paint {about} ") if about is not None else f"{asked['lead']} , {told}"
    if is_reported(bare):
        return None
    plain = plainer(bare)
    for reading in dict.fromkeys((bare, plain, *retold(plain), *retold(bare))):
        if (whole := _one(reading, bare != plain)) is not None:
            return whole
    parts = [p.strip(" ,") for p in re.split(r" , and | and | , but | , ", plain)]
    if not 2 <= len(parts) <= 4:
        return None
    verb = parts[0].split()[0]
    gapped = [parts[0], *(p if verb not in _DO or _one(p) else f"{verb} {p}" for p in parts[1:])]
    found = [_one(part) or _colored(part) for part in gapped]
    return " and ".join(f for f in found if f) if all(found) and any(map(_one, gapped)) else None


def _one(said: str, framed: bool = False) -> str | None:
    """One command with one material; `framed`: the words that ask for it were taken off."""
    if (tried := _TRIED.match(said)) is not None:
        return next(
            (f"paint {t} {s.mark}" for t, s in _split(f"{tried['thing']} {tried['rest']}".split(), {"", *_LINK})), None
        )
    opened = framed or _OPENING.match(said) is not None
    texts = _OPENING.sub("", said).split()
    while texts and texts[0] in _POLITE:
        texts = texts[1:]
    if not texts:
        return None
    readings: Iterator[tuple[str, _Surface]] = _verbed(texts)
    if (found := next(readings, None)) is not None:
        return f"paint {found[0]} {found[1].mark}"
    if texts[0] in _DO and texts[0] != "put":
        readings = _split(texts[1:], {"", *_LINK})
    if texts[0] == "put" and "in" in texts:
        readings = _split(texts[1:], {"in", "into"})
    found = next(readings, None) or next(_laid(texts), None)
    if found is None and texts[0] not in _DO:
        found = next(_split(texts, {"", ",", *_LINK} if opened else {*_PLAIN_LINKS, ","}), None)
        found = found or next(_before(texts), None)
    return f"paint {found[0]} {found[1].mark}" if found is not None else None


def _verbed(texts: Sequence[str]) -> Iterator[tuple[str, _Surface]]:
    """A material as the verb: "carpet the floor in beige", "plaster the right wall"."""
    noun = _AS_VERBS.get(texts[0])
    if noun is None or len(texts) < 3 or texts[1] not in _DETERMINED:
        return
    for end in range(len(texts), 2, -1):
        at = end + (end < len(texts) and texts[end] in ("in", "with"))
        surface = _surface([noun, *texts[at:]], True) if _is_target(texts[1:end]) else None
        if surface is not None:
            yield " ".join(texts[1:end]), surface


def _split(texts: Sequence[str], links: set[str]) -> Iterator[tuple[str, _Surface]]:
    """A thing, words that link, and a surface that ends the command."""
    for end in range(1, len(texts)):
        at = end
        while at < len(texts) and texts[at] in (_LINK | {":", ",", "should", "must", "needs", "wants", "is", "if"}):
            at += 1
        linked = texts[end:at]
        if (linked[0] if linked else "") not in links and not {"should", "must", "needs"} & set(linked):
            continue
        if linked[-1:] == [","] and (len(linked) > 1 or "," not in links):
            continue
        if linked[:1] == ["with"] and texts[end - 1] not in _FIXED and "" not in links:
            continue
        if not _is_target(texts[:end]):
            continue
        named = " ".join(texts[:end])
        surface = _surface(texts[at:], bool(_CUED & set(linked)), named)
        if surface is not None and _OUGHT & set(linked) and set(surface.names) <= METALS_TOO:
            continue  # "the car should be silver"
        if surface is None or surface.plain or _is_new_thing(texts[at - 1 : at], texts[at:]):
            continue
        yield " ".join(texts[:end]), surface


def _laid(texts: Sequence[str]) -> Iterator[tuple[str, _Surface]]:
    """A surface, "on", and a thing, perhaps with more of the surface behind a comma."""
    start = int(texts[0] in _LAY)
    if texts[start : start + 1] in (["a"], ["an"], ["the"]):
        at = next((i for i, t in enumerate(texts) if t in _ONTO), 0)
        if not at or texts[at - 1] not in _LOOKS or texts[start] == "the":
            return
        start += 1
    for at in range(start + 1, len(texts) - 1):
        if texts[at] not in _ONTO or "the" in texts[start:at]:
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
            article = texts[0] in ("a", "an", "the", "some")
            if surface is not None and not surface.plain and (not article or thing[-1] in _FIXED):
                yield f"the {' '.join(thing)}", surface


def _colored(said: str) -> str | None:
    """ "the right wall just plain white", "a grey rug" beside a command for a material."""
    alone = said.split()
    hue = color_at(alone, 1) if alone[0] in ("a", "an") else None
    if hue is not None and kinds.find(" ".join(alone[1 + hue[1] :])) is not None:
        return f"paint the {' '.join(alone[1 + hue[1] :])} {hue[0]}"
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


def _surface(texts: Sequence[str], cued: bool, thing: str = "") -> _Surface | None:
    """What words say of a surface, None if any of them says something else.

    Args:
        cued: whether the words before say that it is made of something; "sand" is a colour otherwise.
        thing: what gets it; "gold" is a colour of cloth, and a metal of a vase.
    """
    names: list[str] = []
    hues: list[str] = []
    second = ""
    size: tuple[str, str] | None = None
    i = 0
    while i < len(texts):
        if length := _length_at(texts, i):
            size, taken = (length[0], length[1]), length[2]
        elif name := _finish_at(texts, i, bool(thing) and not is_soft(thing)):
            names.append(name)
            taken = len(name.split())
        elif texts[i] in _SHADES and _finish_at(texts, i + 1):
            taken = 1  # "dark walnut"
        elif (hue := color_at(texts, i)) is not None:
            taken = hue[1]
            if texts[i + taken : i + taken + 1] and texts[i + taken] in _SECOND and names:
                second = hue[0]
            else:
                hues.append(hue[0])
        elif texts[i] in _ADJECTIVES or texts[i] in style_words() or texts[i] in QUALIFIERS or texts[i] in _SECOND:
            taken = 1
        else:
            return None
        i += taken
    return _told(_Read(tuple(texts), tuple(names), tuple(hues), second, size), cued, thing)


class _Read(NamedTuple):
    """The words of a surface, and the materials, colours and length among them."""

    texts: tuple[str, ...]
    names: tuple[str, ...]
    hues: tuple[str, ...]
    second: str
    size: tuple[str, str] | None


def _told(read: _Read, cued: bool, thing: str) -> _Surface | None:
    texts, names, second, size = read.texts, read.names, read.second, read.size
    hues = list(read.hues)
    if not names:
        return _Surface("", (), " ".join(hues)) if len(hues) == 1 else None
    if len(names) == 1 and _is_color(names[0], cued, thing):
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


def _is_color(name: str, cued: bool, thing: str) -> bool:
    """Whether a name that is a colour as well means one: "make the walls sand", "a gold sofa"."""
    if name in METALS_TOO:
        return not thing or is_soft(thing)
    if cued or name not in COLORS_TOO:
        return False
    return not thing or (name in COLORS_FIRST and not is_fixed(thing))


def _finish_at(texts: Sequence[str], i: int, metal: bool = False) -> str:
    """The longest name of a material at a position, "" if there is none; `metal`: "silver" is one."""
    if metal and texts[i : i + 1] == ["silver"]:
        return "silver"
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
