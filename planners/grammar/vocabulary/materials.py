"""Words for materials among words for colours: which is meant, and a word that stands for a material with its colours.

All forms of a new colour are forms of a new material too. A word that begins with "#" and is no hexadecimal value
stands for a material with its colours and the length of what repeats: `#marble~dark-green`, `#stripes~red~white@20-cm`.
`#photo~tiles@20-cm` stands for a photograph, what it is said to show, and the length of what repeats, or of the
photograph where nothing is said to; `#style~rustic` for a style; `like~wood` for the surface, said to be wood, of the
thing that is named behind it.
"""

from __future__ import annotations

from typing import Any

from ....gaussians import late_re as re
from ....gaussians.world.finishes import said as finish_said
from ....gaussians.world.lengths import UNITS
from ..tagging.words import bag

_HEX = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6})")
_MARK = re.compile(r"#[a-z][a-z-]+(?:~(?:[a-z-]+|#[0-9a-f]{6})){0,2}(?:@[\d.]+-[a-z]+)?")
LIKE, PHOTO, STYLE = "like~", "photo", "style"
ANYTHING = "material"  # what a surface is called that is not said to be wood, brick, ...
# Words that name colours at least as often as materials: they are materials only where that is said.
COLORS_TOO = bag(
    "gold silver rust rusty copper bronze brass terracotta clay sand slate stone grass denim chrome iron tin rock "
    "ebony "
    "cherry straw mahogany walnut chestnut bamboo metallic wool cotton linen silk canvas"
)
# Of these, the ones that are a colour on everything; the others are a material where a surface is asked for.
COLORS_FIRST = bag("sand grass clay stone slate straw cherry chestnut terracotta rock")
METALS_TOO = bag("gold silver")  # a colour of cloth, and a metal of what is hard

# Words that name things at least as often as materials.
THINGS_TOO = bag(
    "beams jeans lace battens plank slat cord paper flags flowers roses rubble patterned geometric knit oriental "
    "onyx metro"
)


def mark(name: str, *colors: str, size: tuple[str, str] | None = None) -> str:
    """The word that stands for a material with its colours, and a length of so many of a unit."""
    length = f"@{size[0]}-{UNITS[size[1]]}" if size is not None else ""
    return "#" + "~".join(word.strip().replace(" ", "-") for word in (name, *colors)) + length


def is_mark(hue: str) -> bool:
    """Whether a colour stands for a material."""
    return bool(_MARK.fullmatch(hue)) and not _HEX.fullmatch(hue)


def meant(hue: str) -> dict[str, Any]:
    """The fields of a new surface: of a colour, or of the material that a word stands for."""
    if is_mark(hue):
        named, _, size = hue[1:].partition("@")
        name, *said = (word.replace("-", " ") for word in named.split("~"))
        value, _, unit = size.partition("-")
        length = {"value": float(value), "unit": unit} if size else None
        if name == STYLE:
            return {"op": "restyle", "style": said[0]}
        if name == PHOTO:
            side = {"unit" if said else "width": length} if length is not None else {}
            return {"op": "restyle", "reference": name, **({"material": said[0]} if said else {}), **side}
        repeats = {"unit": length} if length is not None else {}
        return {**surfaced(name), **dict(zip(("color", "second"), said, strict=False)), **repeats}
    if hue not in COLORS_TOO and finish_said(hue) is not None:
        return surfaced(hue)
    return {"op": "recolor", "color": hue}


def surfaced(name: str) -> dict[str, Any]:
    """The fields of a new surface of a material by any of its names."""
    found = finish_said(name)
    assert found is not None
    return {"op": "restyle", "material": found.finish, **({"color": found.color} if found.color else {})}
