"""Words for materials among words for colours: which is meant, and a word that stands for a material with its colours.

All forms of a new colour are forms of a new material too. A word that begins with "#" and is no hexadecimal value
stands for a material with its colours: `#marble~dark-green`, `#stripes~red~white`.
"""

from __future__ import annotations

import re
from typing import Any

from ....gaussians.world.finishes import said as finish_said
from ..tagging.words import bag

_HEX = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6})")
_MARK = re.compile(r"#[a-z][a-z-]+(?:~[a-z-]+){0,2}")
# Words that name colours at least as often as materials: they are materials only where that is said.
COLORS_TOO = bag(
    "gold copper bronze brass terracotta clay sand slate stone grass denim chrome iron tin rock ebony "
    "cherry straw mahogany walnut chestnut bamboo metallic wool cotton linen silk canvas"
)


def mark(name: str, *colors: str) -> str:
    """The word that stands for a material with its colours."""
    return "#" + "~".join(word.strip().replace(" ", "-") for word in (name, *colors))


def is_mark(hue: str) -> bool:
    """Whether a colour stands for a material."""
    return bool(_MARK.fullmatch(hue)) and not _HEX.fullmatch(hue)


def meant(hue: str) -> dict[str, Any]:
    """The fields of a new surface: of a colour, or of the material that a word stands for."""
    if is_mark(hue):
        name, *said = (word.replace("-", " ") for word in hue[1:].split("~"))
        return {**surfaced(name), **dict(zip(("color", "second"), said, strict=False))}
    if hue not in COLORS_TOO and finish_said(hue) is not None:
        return surfaced(hue)
    return {"op": "recolor", "color": hue}


def surfaced(name: str) -> dict[str, Any]:
    """The fields of a new surface of a material by any of its names."""
    found = finish_said(name)
    assert found is not None
    return {"op": "restyle", "material": found.finish, **({"color": found.color} if found.color else {})}
