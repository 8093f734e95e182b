"""Sentences that ask for a material, with the material as a new colour: "clad it in brick" to "paint it #brick".

`vocabulary.materials` says what such a word stands for.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from .....gaussians import color as colors
from .....gaussians import late_re as re
from .....gaussians.world.finishes import words
from .....gaussians.world.lengths import UNITS
from ...vocabulary.materials import COLORS_TOO, THINGS_TOO, mark

_CUE = (
    r"(?:(?:to )?look(?:ing)? (?:like|as if) (?:it (?:is|were|was) )?(?:made )?(?:out )?(?:of )?|"
    r"(?:be )?made (?:out )?(?:of|from) |"
    r"(?:out )?of |into |to |in |with |from |as |using )?"
    r"(?:an? |some |real |solid |genuine |proper |old |nice |rustic |beautiful |plain )*"
)
_KIND = (
    r"(?: (?:finish|look|texture|surface|effect|pattern|style|material|veneer|cladding|covering|flooring|floor|"
    r"panels|panelling|paneling|wallpaper|design|print|upholstery|fabric))?"
)
_UNIT = "|".join(sorted((u for u in UNITS if u.isalpha() and UNITS[u] != "units"), key=lambda u: (-len(u), u)))
_SIZE = (
    rf"(?:\d[\d.]* ?(?:{_UNIT})? ?(?:x|by) )?\d[\d.]* ?(?:{_UNIT})\b"
    r"(?: (?:wide|square|big|large|long|broad|across|tall|high|apart|in size|thick))?"
)
_SIZED = re.compile(rf"(?P<n>\d[\d.]*) ?(?P<unit>{_UNIT})\b(?: [a-z]+)*\s*$")
_AFTER = re.compile(
    r"^(?:$|[,;.]| (?:,|and|please|but|then|instead|too|as well|now|thanks|on|for|to|over|this time|again))"
)
# Verbs that give a thing a surface, in place of "paint".
_COVER = (
    "cover|clad|panel|upholster|reupholster|wrap|finish|refinish|face|line|dress|do|redo|resurface|veneer|plate|remake|"
    "tile|retile|carpet|recarpet|wallpaper|paper|plaster|rebuild|pave|texture|retexture|coat|surface|sheathe|deck|redecorate|remodel|build|restyle|style|redress"
)
_COVERED = re.compile(rf"^(?:please )?(?:re )?(?:{_COVER})(?: up| over| out)? ")
_LAID = re.compile(
    r"^(?P<before>(?:please )?)(?:put|lay|use|add|apply|try|have|want|i want|i would like|slap|stick)(?: down)? "
    r"(?P<mark>#\S+) (?:on|onto|for|over|to|across|all over) (?P<thing>.+)$"
)
_BARE = re.compile(r"^(?P<mark>#\S+) (?:on|for|over) (?P<thing>.+)$")
_GIVEN = re.compile(r"^(?P<before>(?:please )?)give (?P<thing>.+?) (?P<mark>#\S+)")
_EXCHANGED = re.compile(
    r"^(?P<before>(?:please )?)(?:replace|swap|change|exchange|switch|convert|turn|transform) (?P<thing>.+?) "
    r"(?P<mark>#\S+)"
)
_VERBS: dict[str, str] = {
    "tile": "tiles", "retile": "tiles", "carpet": "carpet", "recarpet": "carpet", "wood panel": "planks",
    "board": "planks", "turf": "grass", "brick": "brick", "gild": "gold", "plaster": "plaster",
}  # fmt: skip
_VERB = re.compile(
    rf"^(?P<before>(?:please )?)(?P<verb>{'|'.join(_VERBS)}) (?P<thing>(?:the|that|this|my|our|all|every|both)\b.+)$"
)
_MOST = 6


@cache
def _material() -> re.Pattern[str]:
    """A material with its colours, and with the words that lead to it and belong to it."""
    names = "|".join(re.escape(w) for w in sorted(words(), key=lambda w: (-len(w), w)))
    plain = "|".join([*(q for q in colors.QUALIFIERS), *colors.BASIC, "grey"])
    hue = rf"(?:(?:{plain}|navy|cream|teal|turquoise|beige|burgundy|olive|mint|golden|charcoal) ?)+"
    return re.compile(
        rf"(?<![\w#~-])(?P<cue>{_CUE})(?P<size>{_SIZE} )?"
        rf"(?:(?P<one>{hue}) )??(?:and (?P<two>{hue}) )?(?P<name>{names}){_KIND}"
        rf"(?: (?:of |that are |which are |, )?(?P<after>{_SIZE})(?: each)?)?(?![\w-])"
    )


def in_materials(said: str) -> Iterator[str]:
    """The sentence with each material that it may ask for as a new colour."""
    if found := _VERB.match(said):
        yield f"{found['before']}paint {found['thing']} {mark(_VERBS[found['verb']])}"
    for count, match in enumerate(_material().finditer(said)):
        if count >= _MOST:
            return
        behind = said[match.end() :]
        if not _AFTER.match(behind) or (match["name"] in COLORS_TOO | THINGS_TOO and not _is_cued(match)):
            continue
        before = said[: match.start()].rstrip()
        found = _SIZED.search(match["size"] or match["after"] or "")
        size = (found["n"], found["unit"]) if found is not None else None
        marked = mark(match["name"], *filter(None, (match["one"], match["two"])), size=size)
        yield from _worded(f"{before} {marked}{behind}".strip())


def _is_cued(match: re.Match[str]) -> bool:
    """Whether words around a name say that a material is meant: "made of gold", "a copper finish"."""
    own = match[0][len(match["cue"]) :].split()
    return (
        any(word in match["cue"] for word in ("of ", "look", "solid ", "real ", "genuine "))
        or len(own) > len(match["name"].split()) + 2
    )


def _worded(said: str) -> Iterator[str]:
    """Sentences about a new colour that say the same."""
    if found := _LAID.match(said) or _BARE.match(said):
        yield f"paint {found['thing']} {found['mark']}"
        return
    if _COVERED.match(said):
        yield _COVERED.sub("paint ", said)
    if found := _GIVEN.match(said) or _EXCHANGED.match(said):
        thing = re.sub(r" (?:a|an|some|for|with|to|into|by)$", "", found["thing"])
        yield f"{found['before']}paint {thing} {found['mark']}{said[found.end() :]}"
    yield said
