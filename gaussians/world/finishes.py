"""The materials that a surface can be given: their names as people say them, and the pigments they have.

A finish is a material with a texture: wood, marble, brick. `tools.finishing.textures` draws them; the grammar and the
schema of the operation `restyle` read the names here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

FinishName = Literal[
    "wood", "planks", "parquet", "marble", "granite", "slate", "stone", "brick",
    "tiles", "concrete", "plaster", "terracotta", "fabric", "velvet", "leather", "fur", "carpet",
    "wicker", "metal", "gold", "copper", "grass", "sand", "gravel",
    "plastic", "porcelain", "stripes", "checks", "dots",
]  # fmt: skip


@dataclass(frozen=True)
class Finish:
    """A material.

    Attributes:
        name: what the texture is called.
        color: display colour of its body in good neutral light, "#rrggbb"; "" for patterns on the thing's own colour.
        second: display colour of its joints, veins or second yarn; "" for a darker shade of the body.
        unit: length of its largest repeated unit, metres: a brick with its joint, a tile, a board's width, a vein.
        detail: size of its finest feature that is worth showing, metres: a joint, a vein, a fibre.
        periodic: whether the unit repeats with a fixed period, so that a length for it can be asked for.
        shine: share of a surface's own change of colour with the direction that it keeps, 0 (matt) to 1 (polished).
    """

    name: FinishName
    color: str
    second: str
    unit: float
    detail: float
    periodic: bool = False
    shine: float = 0.0


def _table(*finishes: Finish) -> dict[FinishName, Finish]:
    return {finish.name: finish for finish in finishes}


# Colours are those of common samples in daylight: red facing brick, Carrara marble, oiled oak, grey cement.
FINISHES: dict[FinishName, Finish] = _table(
    Finish("wood", "#a8743f", "", 0.12, 0.01, shine=0.3),
    Finish("planks", "#b5894f", "#3f2c1c", 0.12, 0.008, True, 0.3),
    Finish("parquet", "#b08653", "#4a3320", 0.07, 0.008, True, 0.4),
    Finish("marble", "#ece9e4", "#8d8f96", 0.35, 0.02, shine=0.8),
    Finish("granite", "#8f8c8a", "#3a3837", 0.02, 0.01, shine=0.7),
    Finish("slate", "#4b5157", "#363b40", 0.25, 0.03, shine=0.2),
    Finish("stone", "#a79c8b", "#6f675b", 0.35, 0.02, True),
    Finish("brick", "#9c4a36", "#b9b0a3", 0.225, 0.012, True),
    Finish("tiles", "#e4e6e6", "#a9abab", 0.20, 0.008, True, 0.7),
    Finish("concrete", "#a3a3a0", "#86867f", 0.4, 0.03),
    Finish("plaster", "#e6e0d4", "#d2cabb", 0.3, 0.05),
    Finish("terracotta", "#b8694a", "#9c5338", 0.2, 0.05),
    Finish("fabric", "#8a8479", "", 0.012, 0.006, True),
    Finish("velvet", "#6a2636", "", 0.15, 0.03, shine=0.3),
    Finish("leather", "#6b4029", "#4d2b1a", 0.02, 0.012, shine=0.5),
    Finish("fur", "#b9a68a", "#8b7759", 0.03, 0.012),
    Finish("carpet", "#8b8378", "#6f685f", 0.02, 0.01),
    Finish("wicker", "#b98d55", "#6d4d2a", 0.03, 0.012, True),
    Finish("metal", "#a9acb0", "", 0.05, 0.02, shine=1.0),
    Finish("gold", "#c99a3a", "", 0.05, 0.02, shine=1.0),
    Finish("copper", "#b06a41", "", 0.05, 0.02, shine=1.0),
    Finish("grass", "#5c8a3a", "#3f6a2a", 0.04, 0.015),
    Finish("sand", "#d8c193", "#c4aa78", 0.15, 0.05),
    Finish("gravel", "#9a948a", "#5d5850", 0.03, 0.012),
    Finish("plastic", "#c9c9c9", "", 0.3, 1, shine=0.5),
    Finish("porcelain", "#efeeea", "", 0.3, 1, shine=0.8),
    Finish("stripes", "", "", 0.12, 0.02, True),
    Finish("checks", "", "", 0.10, 0.02, True),
    Finish("dots", "", "", 0.08, 0.015, True),
)  # fmt: skip

# Other words for a finish, with the pigment that they name; "" for that of the finish.
_WORDS: dict[FinishName, dict[str, str]] = {
    "wood": {
        "wooden": "", "timber": "", "oak": "#b98f5c", "walnut": "#6b4a32", "pine": "#d9b47a", "mahogany": "#6e3226",
        "cherry wood": "#8c4a2f", "birch": "#e0c9a0", "beech": "#d3a877", "maple": "#d8b98c", "teak": "#a06c3c",
        "ebony": "#35292a", "bamboo": "#d2b573", "cedar": "#a5653f", "ash wood": "#d5c2a0", "driftwood": "#a79f92",
        "rosewood": "#5e2f28", "hardwood": "", "plywood": "#d6b98b", "cork": "#b58a5c", "rustic wood": "#7d5a3a",
        "reclaimed wood": "#7d6248", "dark wood": "#5d432c", "light wood": "#d8b27c",
    },
    "planks": {
        "floorboards": "", "floor boards": "", "boards": "", "wood planks": "", "wooden planks": "", "laminate": "",
        "wooden floorboards": "", "wood panelling": "", "wood paneling": "", "decking": "#9a7550", "shiplap": "#e9e6df",
        "wooden boards": "", "hardwood planks": "", "oak planks": "#b98f5c", "oak boards": "#b98f5c",
    },
    "parquet": {"herringbone parquet": "", "wooden parquet": "", "oak parquet": "#b98f5c"},
    "marble": {"white marble": "", "carrara marble": "", "onyx marble": "#33302f"},
    "slate": {"slate stone": ""},
    "stone": {
        "stonework": "", "natural stone": "", "cobblestone": "#8b857b", "cobblestones": "#8b857b", "cobbles": "#8b857b",
        "limestone": "#cfc4ac", "sandstone": "#c9a877", "flagstone": "", "flagstones": "", "rock": "#8d867c",
        "stone blocks": "", "travertine": "#d3c2a3",
    },
    "granite": {},
    "brick": {
        "bricks": "", "exposed brick": "", "exposed bricks": "", "brickwork": "", "bare brick": "", "red brick": "",
        "red bricks": "", "brick wall": "", "bricked": "",
    },
    "tiles": {"tile": "", "tiled": "", "ceramic tiles": "", "white tiles": "", "subway tiles": "", "tiling": ""},
    "concrete": {"cement": "", "raw concrete": "", "polished concrete": "", "exposed concrete": ""},
    "plaster": {"stucco": "", "render": "", "clay plaster": "#c9a988", "limewash": "#ece7dc"},
    "terracotta": {"terra cotta": "", "clay": "", "earthenware": ""},
    "fabric": {
        "cloth": "", "linen": "#cfc3ab", "cotton": "#e4ded2", "wool": "#b7aa98", "denim": "#3f5a7d", "tweed": "#7d756a",
        "canvas": "#cdbfa1", "burlap": "#a98c62", "felt": "#7f7f7f", "jute": "#b5966a", "textile": "",
        "canvas cloth": "",
        "upholstery": "", "silk": "#d6c8b8", "woven fabric": "",
    },
    "velvet": {"velour": "", "suede": "#8a6a4d", "corduroy": "#7d5a3c"},
    "leather": {"leatherette": "", "brown leather": "", "black leather": "#2a2728", "faux leather": "", "cowhide": ""},
    "fur": {"furry": "", "faux fur": "", "sheepskin": "#e6dfd0", "shearling": "#e6dfd0"},
    "carpet": {"carpeting": "", "carpeted": "", "shag carpet": ""},
    "wicker": {"rattan": "", "cane": "", "basketwork": "", "raffia": "", "straw": "#d2b469", "thatch": "#b99a5a"},
    "metal": {
        "metallic": "", "steel": "", "stainless steel": "", "brushed steel": "", "aluminium": "#c3c6c9",
        "aluminum": "#c3c6c9", "iron": "#5b5c5f", "wrought iron": "#3a3b3e", "chrome": "#c9cdd2", "tin": "", "zinc": "",
        "brushed metal": "", "pewter": "#85878a", "sheet metal": "", "cast iron": "#3a3b3e", "titanium": "#8d8f93",
    },
    "gold": {"solid gold": "", "gold leaf": "", "brass": "#b08d45", "brushed brass": "#b08d45"},
    "copper": {"bronze": "#8a6a3f", "brushed copper": ""},
    "grass": {"grassy": "", "turf": "", "lawn": "", "artificial grass": "", "astroturf": ""},
    "sand": {"sandy ground": ""},
    "gravel": {"pebbles": "#a8a298", "pebble": "#a8a298", "shingle": ""},
    "plastic": {"rubber": "#3a3a3c", "acrylic": ""},
    "porcelain": {"ceramic": "", "china": "", "enamel": ""},
    "stripes": {"striped": "", "stripy": "", "stripey": "", "pinstripes": "", "pinstriped": ""},
    "checks": {
        "checked": "", "chequered": "", "checkered": "", "checkerboard": "", "chequerboard": "", "gingham": "",
        "chequers": "", "checkers": "",
    },
    "dots": {"dotted": "", "polka dot": "", "polka dots": "", "spots": "", "spotted": "", "polka dotted": ""},
}  # fmt: skip


@dataclass(frozen=True)
class Said:
    """A finish as it was said.

    Attributes:
        finish: its name, a key of `FINISHES`.
        color: the pigment that the word names, "#rrggbb", or "" for the usual one.
    """

    finish: FinishName
    color: str


@cache
def words() -> dict[str, Said]:
    """Every word and phrase for a finish, in lower case."""
    found: dict[str, Said] = {name: Said(name, "") for name in FINISHES}
    for name, others in _WORDS.items():
        found |= {word: Said(name, color) for word, color in others.items()}
    return found


def said(text: str) -> Said | None:
    """The finish that a word or phrase names, None if it names none: "oak" is wood of the colour of oak."""
    return words().get(" ".join(text.lower().split()))
