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
    "plastic", "porcelain", "glass", "terrazzo", "stripes", "checks", "dots", "floral", "ornament", "stars",
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
    Finish("glass", "#cfdfdc", "", 0.3, 1, shine=1.0),
    Finish("terrazzo", "#d9d5cc", "", 0.05, 0.012, shine=0.6),
    Finish("stripes", "", "", 0.12, 0.02, True),
    Finish("checks", "", "", 0.10, 0.02, True),
    Finish("dots", "", "", 0.08, 0.015, True),
    Finish("floral", "", "", 0.30, 0.02, True),
    Finish("ornament", "", "", 0.40, 0.02, True),
    Finish("stars", "", "", 0.24, 0.02, True),
)  # fmt: skip

# Other words for a finish, with the pigment that they name; "" for that of the finish.
_WORDS: dict[FinishName, dict[str, str]] = {
    "wood": {
        "wooden": "", "timber": "", "oak": "#b98f5c", "walnut": "#6b4a32", "pine": "#d9b47a", "mahogany": "#6e3226",
        "cherry wood": "#8c4a2f", "birch": "#e0c9a0", "beech": "#d3a877", "maple": "#d8b98c", "teak": "#a06c3c",
        "ebony": "#35292a", "bamboo": "#d2b573", "cedar": "#a5653f", "ash wood": "#d5c2a0", "driftwood": "#a79f92",
        "rosewood": "#5e2f28", "hardwood": "", "plywood": "#d6b98b", "cork": "#b58a5c", "rustic wood": "#7d5a3a",
        "reclaimed wood": "#7d6248", "dark wood": "#5d432c", "light wood": "#d8b27c", "rough wood": "#7d5a3a",
        "aspen": "#dcc9a4", "larch": "#c08a52", "spruce": "#dcbf8f", "elm": "#a37b4d", "wood veneer": "", "veneer": "",
        "oak wood": "#b98f5c", "pine wood": "#d9b47a", "walnut wood": "#6b4a32", "redwood": "#8a4b32",
        "wenge": "#3f2e26",
    },
    "planks": {
        "floorboards": "", "floor boards": "", "boards": "", "wood planks": "", "wooden planks": "", "laminate": "",
        "wooden floorboards": "", "wood panelling": "", "wood paneling": "", "decking": "#9a7550", "shiplap": "#e9e6df",
        "wooden boards": "", "hardwood planks": "", "oak planks": "#b98f5c", "oak boards": "#b98f5c", "plank": "",
        "pine boards": "#d9b47a", "pine planks": "#d9b47a", "walnut planks": "#6b4a32", "oak slats": "#b98f5c",
        "slats": "", "slat": "", "oak slat": "#b98f5c", "wood slats": "", "wooden slats": "", "slatted wood": "",
        "panelling": "", "paneling": "",
        "panelled": "", "paneled": "", "wainscoting": "#e9e6df", "wainscotting": "#e9e6df", "beadboard": "#e9e6df",
        "weatherboard": "", "barn wood": "#8a7d6d", "barnwood": "#8a7d6d", "oak floorboards": "#b98f5c",
        "pallet wood": "", "wooden beams": "", "timber beams": "", "wood panels": "",
        "wooden panels": "", "battens": "", "clapboard": "",
    },
    "parquet": {
        "herringbone parquet": "", "wooden parquet": "", "oak parquet": "#b98f5c", "herringbone": "",
        "herringbone oak": "#b98f5c", "oak herringbone": "#b98f5c", "herringbone wood": "", "chevron parquet": "",
        "herringbone walnut": "#6b4a32", "walnut parquet": "#6b4a32", "parquetry": "", "parquet flooring": "",
    },
    "marble": {"white marble": "", "carrara marble": "", "onyx marble": "#33302f", "marbled": "", "onyx": "#33302f",
        "calacatta": "", "calacatta marble": "", "black marble": "#2f2e30",
    },
    "slate": {"slate stone": ""},
    "stone": {
        "stonework": "", "natural stone": "", "cobblestone": "#8b857b", "cobblestones": "#8b857b", "cobbles": "#8b857b",
        "quartzite": "#cfcac2", "fieldstone": "", "stone flags": "", "flags": "", "rough stone": "", "rubble": "",
        "limestone": "#cfc4ac", "sandstone": "#c9a877", "flagstone": "", "flagstones": "", "rock": "#8d867c",
        "stone blocks": "", "travertine": "#d3c2a3",
    },
    "granite": {"black granite": "#3c3b3d", "quartz": "#d8d5cf", "basalt": "#4a4a4c"},
    "brick": {
        "bricks": "", "exposed brick": "", "exposed bricks": "", "brickwork": "", "bare brick": "", "red brick": "",
        "red bricks": "", "brick wall": "", "bricked": "",
    },
    "tiles": {
        "tile": "", "tiled": "", "ceramic tiles": "", "white tiles": "", "subway tiles": "", "tiling": "",
        "metro": "", "metro tiles": "", "metro tile": "", "subway tile": "", "ceramic tile": "", "zellige": "",
        "zellij": "",
        "zellige tiles": "", "mosaic": "", "mosaic tiles": "", "penny tiles": "", "porcelain tiles": "",
        "azulejos": "#d9e3ee",
        "floor tiles": "", "wall tiles": "", "stone tiles": "#a79c8b", "slate tiles": "#4b5157",
        "marble tiles": "#ece9e4",
        "terracotta tiles": "#b8694a", "encaustic tiles": "", "hexagon tiles": "", "glazed tiles": "",
    },
    "concrete": {"cement": "", "raw concrete": "", "polished concrete": "", "exposed concrete": "", "microcement": "",
        "bare concrete": "", "poured concrete": "", "screed": "", "beton": "", "brushed concrete": "",
    },
    "plaster": {"stucco": "", "render": "", "clay plaster": "#c9a988", "limewash": "#ece7dc", "limewashed": "#ece7dc",
        "whitewash": "#f2f0ea", "whitewashed": "#f2f0ea", "venetian plaster": "", "tadelakt": "#c9b39a",
        "adobe": "#c08e66",
        "plastered": "", "plasterwork": "", "rough plaster": "", "chalk paint": "", "paper": "#efe9da",
        "washi": "#efe9da",
    },
    "terracotta": {"terra cotta": "", "clay": "", "earthenware": ""},
    "fabric": {
        "cloth": "", "linen": "#cfc3ab", "cotton": "#e4ded2", "wool": "#b7aa98", "denim": "#3f5a7d", "tweed": "#7d756a",
        "canvas": "#cdbfa1", "burlap": "#a98c62", "felt": "#7f7f7f", "jute": "#b5966a", "textile": "",
        "canvas cloth": "",
        "upholstery": "", "silk": "#d6c8b8", "woven fabric": "", "knitted wool": "#d8cfbf", "knit": "", "knitted": "",
        "chunky knit": "", "boucle": "#e6dfd2", "bouclé": "#e6dfd2", "cashmere": "", "satin": "", "jersey": "",
        "microfiber": "", "microfibre": "", "quilted": "", "quilted fabric": "", "hessian": "#a98c62",
        "sackcloth": "#a98c62",
        "mesh": "", "jeans": "#3f5a7d", "jeans material": "#3f5a7d", "jean": "#3f5a7d", "lace": "", "nylon": "",
        "polyester": "", "muslin": "#e4ded2", "crochet": "#e4ded2", "macrame": "#e4ded2",
        "flannel": "", "chenille": "", "sailcloth": "#e6e0d2", "woollen": "#b7aa98", "woolen": "#b7aa98",
    },
    "velvet": {
        "velour": "", "plush": "", "velveteen": "", "cord": "#7d5a3c", "suede": "#8a6a4d", "corduroy": "#7d5a3c",
    },
    "leather": {
        "leatherette": "", "brown leather": "", "black leather": "#2a2728", "faux leather": "", "cowhide": "",
        "nubuck": "#a3805c", "pleather": "",
        "tan leather": "#a8713f", "cognac leather": "#9a5a2c",
    },
    "fur": {"furry": "", "lambskin": "#e6dfd0", "sheep skin": "#e6dfd0", "fluffy": "",
        "faux fur": "", "sheepskin": "#e6dfd0", "shearling": "#e6dfd0"},
    "carpet": {"carpeting": "", "carpeted": "", "shag carpet": "", "shag": "", "wall to wall carpet": "",
        "deep pile carpet": "",
    },
    "wicker": {"rattan": "", "cane": "", "basketwork": "", "raffia": "", "straw": "#d2b469", "thatch": "#b99a5a",
        "seagrass": "#b9a876", "sisal": "#c9b48a", "tatami": "#c9bd86", "tatami mats": "#c9bd86", "webbing": "",
        "woven cane": "", "caning": "",
    },
    "metal": {
        "metallic": "", "steel": "", "stainless steel": "", "brushed steel": "", "aluminium": "#c3c6c9",
        "aluminum": "#c3c6c9", "iron": "#5b5c5f", "wrought iron": "#3a3b3e", "chrome": "#c9cdd2", "tin": "", "zinc": "",
        "brushed metal": "", "pewter": "#85878a", "sheet metal": "", "cast iron": "#3a3b3e", "titanium": "#8d8f93",
        "inox": "", "galvanised steel": "", "galvanized steel": "", "corrugated metal": "", "corrugated iron": "",
        "silver": "#c3c6c9", "solid silver": "#c3c6c9", "rust": "#8a4a2a", "rusty": "#8a4a2a", "platinum": "#c3c6c9",
        "corten": "#8a4a2a", "corten steel": "#8a4a2a", "rusty metal": "#8a4a2a", "rusted metal": "#8a4a2a",
        "gunmetal": "#55585c", "black steel": "#3a3b3e", "black metal": "#3a3b3e", "silver metal": "#c3c6c9",
    },
    "gold": {"solid gold": "", "gold leaf": "", "brass": "#b08d45", "brushed brass": "#b08d45",
        "polished brass": "#b08d45", "brushed gold": "", "gilt": "", "gilded": "", "antique brass": "#8f7238",
    },
    "copper": {"bronze": "#8a6a3f", "brushed copper": "", "polished copper": "", "hammered copper": ""},
    "grass": {"grassy": "", "turf": "", "lawn": "", "artificial grass": "", "astroturf": ""},
    "sand": {"sandy ground": ""},
    "gravel": {"pebbles": "#a8a298", "pebble": "#a8a298", "shingle": ""},
    "plastic": {
        "rubber": "#3a3a3c", "acrylic": "", "vinyl": "#b9b0a2", "linoleum": "#b3a48d", "lino": "#b3a48d",
        "resin": "#c9c7c2",
        "epoxy": "#c9c7c2", "melamine": "", "formica": "", "lacquer": "", "lacquered": "", "laminate plastic": "",
        "epoxy resin": "#c9c7c2",
    },
    "porcelain": {"ceramic": "", "china": "", "enamel": "", "enamelled": "", "enameled": "", "glazed ceramic": ""},
    "glass": {"frosted glass": "#dfe6e6", "tinted glass": "#8fa3a0", "smoked glass": "#6b6f70", "clear glass": ""},
    "terrazzo": {},
    "stripes": {"striped": "", "stripy": "", "stripey": "", "pinstripes": "", "pinstriped": ""},
    "checks": {
        "checked": "", "chequered": "", "checkered": "", "checkerboard": "", "chequerboard": "", "gingham": "",
        "chequers": "", "checkers": "", "plaid": "", "tartan": "", "checked fabric": "", "check pattern": "",
        "chessboard": "",
    },
    "floral": {
        "flowery": "", "flowered": "", "floral pattern": "", "flower pattern": "", "flower print": "",
        "floral print": "",
        "roses": "", "flowers": "", "botanical print": "", "leafy print": "", "something floral": "",
    },
    "ornament": {
        "ornamental": "", "persian": "", "persian pattern": "", "oriental": "", "damask": "", "paisley": "",
        "moroccan": "",
        "kilim": "", "arabesque": "", "art deco pattern": "", "geometric pattern": "", "patterned": "", "brocade": "",
        "oriental pattern": "", "baroque pattern": "", "geometric": "",
    },
    "stars": {"starry": "", "star pattern": "", "starred": "", "little stars": ""},
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


@cache
def single_words() -> frozenset[str]:
    """Every word of the names of finishes."""
    return frozenset(word for name in words() for word in name.split())


def said(text: str) -> Said | None:
    """The finish that a word or phrase names, None if it names none: "oak" is wood of the colour of oak."""
    return words().get(" ".join(text.lower().split()))


_PATTERNS: frozenset[FinishName] = frozenset({"stripes", "checks", "dots", "floral", "ornament", "stars", "parquet"})
_SHADES = {"dark": 0.62, "deep": 0.7, "light": 1.0, "pale": 1.0, "bleached": 1.0, "blond": 1.0, "blonde": 1.0}
_PALER = 0.4  # mixed with white: a light or pale wood


@dataclass(frozen=True)
class Described:
    """A surface in words.

    Attributes:
        finish: its material, None where only a colour is named.
        color, second: its colours as `color.parse` takes them, "" for the usual ones.
    """

    finish: FinishName | None
    color: str = ""
    second: str = ""


def described(text: str) -> Described | None:
    """What a phrase says of a surface: "dark walnut", "red and white striped wallpaper", "green"; None if nothing."""
    told = " ".join(text.lower().replace("-", " ").split()).split()
    found: list[tuple[int, int, Said]] = []
    i = 0
    while i < len(told):
        taken = next((n for n in range(min(4, len(told) - i), 0, -1) if " ".join(told[i : i + n]) in words()), 0)
        if taken:
            found.append((i, i + taken, words()[" ".join(told[i : i + taken])]))
        i += max(taken, 1)
    if not found:
        colors = _colors(told)
        return Described(None, *colors[:2]) if colors else None
    start, _, chosen = next((f for f in found if f[2].finish in _PATTERNS), found[-1])
    colors = _colors(told[:start])
    if colors:
        return Described(chosen.finish, *colors[:2])
    body = next((f[2] for f in found if f[2].finish not in _PATTERNS), None)
    if chosen.finish in _PATTERNS and not chosen.color and body is not None:  # "checkerboard marble"
        return Described(chosen.finish, body.color or FINISHES[body.finish].color)
    shade = next((w for w in told[:start] if w in _SHADES), "")
    return Described(chosen.finish, _shaded(chosen, shade))


def _colors(told: list[str]) -> list[str]:
    """The colours among some words, in order."""
    from ..color import BASIC, QUALIFIERS, known

    found: list[str] = []
    i = 0
    while i < len(told):
        for n in (3, 2, 1):
            phrase = " ".join(told[i : i + n])
            if i + n > len(told) or phrase in QUALIFIERS or phrase in ("and", "a", "the", "of", "in"):
                continue
            if known(phrase) is None:
                continue
            if n > 1 and not any(w in BASIC or w in QUALIFIERS or w == "grey" for w in told[i : i + n]):
                continue
            found.append(phrase)
            i += n - 1
            break
        i += 1
    return found


def _shaded(chosen: Said, shade: str) -> str:
    """The pigment of a word in a shade, "" for its own."""
    own = chosen.color or FINISHES[chosen.finish].color
    if not shade or not own:
        return chosen.color
    channels = [int(own[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    factor = _SHADES[shade]
    made = [c * factor if factor < 1 else c + _PALER * (1 - c) for c in channels]
    return "#" + "".join(f"{round(255 * c):02x}" for c in made)
