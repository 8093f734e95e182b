"""Colours: names to RGB and back, and display RGB to CIE Lab and LCh and back.

Display space is sRGB with the D65 white point (IEC 61966-2-1); Lab is CIE 1976. Names are those of CSS Color Module
Level 4 (through Pillow's table) and some everyday names that CSS lacks.
"""

from __future__ import annotations

import math
import re

import torch
from torch import Tensor

from .errors import UserError
from .world.shades import FINISHES, PAINTS, SHADES
from .world.spelling import did_you_mean

LUMA = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709: what red, green and blue add to the brightness of a colour
Rgb = tuple[float, float, float]

# Everyday names that CSS lacks, or for which its value is not what people picture.
EVERYDAY: dict[str, str] = {
    "cream": "#fffdd0", "mustard": "#e1ad01", "rose": "#ff66a3", "charcoal": "#36454f", "burgundy": "#800020",
    "terracotta": "#e2725b", "mint": "#98ff98", "peach": "#ffcba4", "ochre": "#cc7722", "emerald": "#50c878",
    "sapphire": "#0f52ba", "ruby": "#9b111e", "amber": "#ffbf00", "lilac": "#c8a2c8", "mauve": "#c29bc2",
    "taupe": "#8b7d6b", "rust": "#b7410e", "copper": "#b87333", "bronze": "#cd7f32", "brass": "#b5a642",
    "sand": "#c2b280", "wine": "#722f37", "denim": "#1560bd", "forest green": "#228b22", "sage": "#9caf88",
    "blonde": "#e6c98f", "wooden": "#9a6a3c", "oak": "#b5894f", "walnut": "#5d432c", "green": "#1f8b24",
    "gold": "#cfa83a", "golden": "#cfa83a",
    "apricot": "#fbceb1", "scarlet": "#ff2400", "jade": "#00a86b", "off white": "#f5f2e8", "pink": "#ff8fb0",
}  # fmt: skip

# The basic colour terms (Berlin & Kay 1969) and the ones our users say most, each by one typical Lab value.
BASIC: dict[str, str] = {
    "red": "#c8201e", "orange": "#f07c1c", "yellow": "#f2d31b", "green": "#3c9a3f", "teal": "#128080",
    "blue": "#2a5ac8", "purple": "#7d3fa6", "pink": "#f08fb4", "brown": "#7a4a26", "beige": "#d9c4a0",
    "black": "#1a1a1a", "gray": "#808080", "white": "#f2f2f2",
}  # fmt: skip

# Colours and materials that people count to a basic colour, whatever a photometer says.
FAMILIES: dict[str, str] = {
    "navy": "blue", "indigo": "blue", "denim": "blue", "azure": "blue", "royalblue": "blue", "skyblue": "blue",
    "oak": "brown", "walnut": "brown", "wood": "brown", "wooden": "brown", "mahogany": "brown", "chestnut": "brown",
    "pine": "brown", "teak": "brown", "cherry": "brown", "maple": "brown", "bamboo": "beige", "chocolate": "brown",
    "bronze": "brown", "copper": "brown", "terracotta": "orange", "rust": "orange", "maroon": "red", "burgundy": "red",
    "crimson": "red", "scarlet": "red", "lilac": "purple", "lavender": "purple", "violet": "purple", "mauve": "purple",
    "cream": "white", "ivory": "white", "silver": "gray", "chrome": "gray", "steel": "gray", "metal": "gray",
    "charcoal": "gray", "gold": "yellow", "golden": "yellow", "brass": "yellow", "mustard": "yellow",
    "olive": "green", "sage": "green", "mint": "green", "emerald": "green", "turquoise": "teal", "aqua": "teal",
    "tan": "beige", "sand": "beige", "timber": "brown", "birch": "brown", "reclaimed": "brown", "leather": "brown",
    "rattan": "beige", "wicker": "beige", "cane": "beige", "straw": "beige", "jute": "beige", "metallic": "gray",
    "aluminium": "gray", "aluminum": "gray", "concrete": "gray", "stone": "gray", "stainless": "gray", "iron": "black",
    "marble": "white", "porcelain": "white", "ceramic": "white",
}  # fmt: skip

QUALIFIERS = ("very dark", "very light", "dark", "deep", "light", "pale", "bright", "vivid")

_DARKENING = ("very dark", "dark", "deep")

_TEXT_LIMIT = 80  # characters; no colour name with qualifiers is longer
NAMING_LIGHTNESS = 0.45

_LAST = frozenset({*BASIC, "grey"})  # what the last word of a colour of two names repeats ("navy blue")
_WORDS = re.compile(r"[^a-z0-9#]+")
_QUALIFIER = re.compile(rf"^({'|'.join(QUALIFIERS)}) (.+)$")


def names() -> tuple[str, ...]:
    """All colour names that `parse` accepts, without qualifiers."""
    from PIL import ImageColor

    return tuple(sorted(set(ImageColor.colormap) | set(EVERYDAY)))


def plain_color(text: str) -> str:
    """A colour as written, in lower case and with gray spelt one way."""
    return text.lower().replace("grey", "gray").strip()


def shade_of(text: str) -> Rgb:
    """RGB of a colour word: of a basic term what people picture and furniture wears, of others as in `parse`.

    CSS "blue" is a glowing #0000ff, which leaves a display no room for light and shadow and measures as purple. A
    dark shade of a basic term ("dark purple") is one of the same colour, not of the one in CSS.

    Raises:
        UserError: unknown colour.
    """
    plain = plain_color(text)
    found = _QUALIFIER.match(plain)
    if found and found.group(1) in _DARKENING and found.group(2) in BASIC:
        return _qualify(found.group(1), parse(BASIC[found.group(2)]))
    return parse(BASIC.get(plain, text))


def parse(text: str) -> Rgb:
    """RGB in [0, 1], display space, of a CSS name, an everyday name, `#rgb`, `#rrggbb`, or "dark/light/… NAME".

    Colours named after things ("bottle green", "mahogany") and mixtures ("blue green", "reddish brown") are known too.

    Raises:
        UserError: the colour is unknown; the message lists the closest known names.
    """
    if len(text) > _TEXT_LIMIT:
        raise UserError(f"unknown colour {text[:40]!r}…; use a CSS name such as teal, or #1f8a8a")
    if found := known(text):
        return found
    joined = _WORDS.sub(" ", text.lower()).strip().replace(" ", "")
    hint = did_you_mean(joined, names()) or "use a CSS name such as teal, or #1f8a8a"
    raise UserError(f"unknown colour {text!r}; {hint}")


def known(text: str) -> Rgb | None:
    """The value of a colour as in `parse`, None if it is unknown; much faster there, as no similar names are sought."""
    if len(text) > _TEXT_LIMIT:
        return None
    plain = _WORDS.sub(" ", text.lower()).strip()
    joined = plain.replace(" ", "")
    if named := _named(plain):
        return named
    if re.fullmatch(r"#([0-9a-f]{3}|[0-9a-f]{6})", joined):
        return _hex(joined)
    if found := _QUALIFIER.match(plain):
        base = known(found.group(2))
        return None if base is None else _qualify(found.group(1), base)
    stem = plain.removesuffix("ish")
    if stem != plain and (named := _named(stem) or _named(stem[:-1]) or _named(f"{stem}e")):
        return named  # greenish, reddish, bluish
    return _described(plain)


def _described(plain: str) -> Rgb | None:
    """The colour of a description in several words, or of a thing's name; None if it is none."""
    words = tuple(w for w in plain.split() if w != "s")  # robin's egg
    if (value := PAINTS.get(plain)) or (value := PAINTS.get(" ".join(words[:-1])) if words[-1:] else None):
        return _hex(value) if plain in PAINTS or words[-1] in _LAST else None
    if words in SHADES:
        return shade_of(SHADES[words])
    for taken in (2, 1):
        finish = FINISHES.get(" ".join(words[:taken])) if len(words) > taken else None
        if finish is not None and (base := known(BASIC.get(rest := " ".join(words[taken:]), rest))):
            return _qualify(finish, base) if finish else base
    if len(words) < 2:
        return _hex(BASIC[FAMILIES[plain]]) if plain in FAMILIES else None
    first, last = (known(BASIC.get(part, part)) for part in (" ".join(words[:-1]), words[-1]))
    if first is None or last is None:
        return None
    tinge = words[0].endswith("ish")  # reddish brown
    if words[-1] in _LAST and not tinge and words[0] not in _LAST:
        return first  # "navy blue"
    share = 0.3 if tinge else 0.5
    r, g, b = (share * x + (1 - share) * y for x, y in zip(first, last, strict=True))
    return (r, g, b)


def _named(plain: str) -> Rgb | None:
    """The colour of a name in lower case, if it is one."""
    from PIL import ImageColor

    joined = plain.replace(" ", "")
    for table in (EVERYDAY, ImageColor.colormap):
        value = table.get(plain) or table.get(joined) or table.get(joined.replace("grey", "gray"))
        if value:  # Pillow swaps a name's text for numbers once somebody has drawn with it
            return _hex(value) if isinstance(value, str) else (value[0] / 255, value[1] / 255, value[2] / 255)
    return None


def _hex(value: str) -> Rgb:
    digits = value.lstrip("#")
    if len(digits) == 3:
        digits = "".join(c * 2 for c in digits)
    return (int(digits[0:2], 16) / 255, int(digits[2:4], 16) / 255, int(digits[4:6], 16) / 255)


def _qualify(word: str, rgb: Rgb) -> Rgb:
    """Shift lightness or chroma of `rgb` in LCh as the qualifier says."""
    lightness, a, b = rgb_to_lab(torch.tensor(rgb)).tolist()
    chroma_gain = 1.3 if word in ("bright", "vivid", "deep") else 0.7 if word in ("pale", "light", "very light") else 1
    if word in _DARKENING:
        was, lightness = lightness, lightness * (0.35 if word == "very dark" else 0.6)
        # Less light on one pigment scales a and b with L + 16; deep dyes and paints are duller still.
        chroma_gain *= ((lightness + 16) / (was + 16)) ** 1.5
    elif word in ("light", "pale"):
        lightness += 0.5 * (100 - lightness)
    elif word == "very light":
        lightness += 0.75 * (100 - lightness)
    r, g, blue = displayable(torch.tensor([lightness, a * chroma_gain, b * chroma_gain])).tolist()
    return (r, g, blue)


# Rows: linear sRGB to XYZ, relative to the D65 white (0.95047, 1, 1.08883), so that white maps to (1, 1, 1).
_XYZ = torch.tensor(
    [
        [0.4124564 / 0.95047, 0.3575761 / 0.95047, 0.1804375 / 0.95047],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339 / 1.08883, 0.1191920 / 1.08883, 0.9503041 / 1.08883],
    ],
    dtype=torch.float64,
)


def rgb_to_lab(rgb: Tensor) -> Tensor:
    """Display RGB `[..., 3]` (0..1; values outside are extended by odd symmetry) to Lab `[..., 3]`, L in 0..100."""
    linear = torch.where(
        rgb.abs() <= 0.04045, rgb / 12.92, torch.sign(rgb) * ((rgb.abs() + 0.055) / 1.055).clamp(min=0) ** 2.4
    )
    xyz = linear @ _XYZ.to(rgb.device, rgb.dtype).T
    f = torch.where(xyz > (6 / 29) ** 3, xyz.clamp(min=1e-12) ** (1 / 3), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return torch.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], dim=-1)


def lab_to_rgb(lab: Tensor) -> Tensor:
    """Lab `[..., 3]` to display RGB `[..., 3]`, not clipped to the gamut."""
    fy = (lab[..., 0] + 16) / 116
    f = torch.stack([fy + lab[..., 1] / 500, fy, fy - lab[..., 2] / 200], dim=-1)
    xyz = torch.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29))
    linear = xyz @ torch.linalg.inv(_XYZ).to(lab.device, lab.dtype).T
    low = linear.abs() <= 0.0031308
    return torch.where(
        low, 12.92 * linear, torch.sign(linear) * (1.055 * linear.abs().clamp(min=1e-12) ** (1 / 2.4) - 0.055)
    )


def ciede2000(a: Tensor, b: Tensor) -> Tensor:
    """Visible difference of Lab colours `[..., 3]` by CIEDE2000 (ISO/CIE 11664-6:2014), its parametric factors 1."""
    mean_chroma = (a[..., 1:].norm(dim=-1) + b[..., 1:].norm(dim=-1)) / 2
    stretch = 1.5 - 0.5 * torch.sqrt(mean_chroma**7 / (mean_chroma**7 + 25.0**7))
    (l1, c1, h1), (l2, c2, h2) = (_stretched(lab, stretch) for lab in (a, b))
    both = (c1 * c2) > 0
    turn = torch.where(both, (h2 - h1 + math.pi) % (2 * math.pi) - math.pi, 0.0)
    light, chroma = (l1 + l2) / 2, (c1 + c2) / 2
    middle = torch.where(both, (h1 + torch.where((h2 - h1).abs() > math.pi, turn, h2 - h1) / 2), h1 + h2)
    d_light, d_chroma, d_hue = l2 - l1, c2 - c1, 2 * torch.sqrt(c1 * c2) * torch.sin(turn / 2)
    degrees = torch.rad2deg(middle) % 360

    def wave(factor: float, phase: float) -> Tensor:
        return torch.cos(torch.deg2rad(factor * degrees - phase))

    hues = 1 - 0.17 * wave(1, 30) + 0.24 * wave(2, 0) + 0.32 * wave(3, -6) - 0.20 * wave(4, 63)
    scale_light = 1 + 0.015 * (light - 50) ** 2 / torch.sqrt(20 + (light - 50) ** 2)
    scale_chroma, scale_hue = 1 + 0.045 * chroma, 1 + 0.015 * chroma * hues
    rotation = torch.sin(torch.deg2rad(60 * torch.exp(-(((degrees - 275) / 25) ** 2))))
    rotation = -2 * torch.sqrt(chroma**7 / (chroma**7 + 25.0**7)) * rotation
    by_light, by_chroma, by_hue = d_light / scale_light, d_chroma / scale_chroma, d_hue / scale_hue
    return torch.sqrt((by_light**2 + by_chroma**2 + by_hue**2 + rotation * by_chroma * by_hue).clamp(min=0))


def _stretched(lab: Tensor, stretch: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Lightness, chroma and hue (radians, 0 to 2 pi) of CIEDE2000, which stretches a near grey."""
    a, b = lab[..., 1] * stretch, lab[..., 2]
    return lab[..., 0], torch.hypot(a, b), torch.atan2(b, a) % (2 * math.pi)


def displayable(lab: Tensor) -> Tensor:
    """The display RGB `[..., 3]` in [0, 1] of Lab `[..., 3]`, with its chroma reduced until it fits the gamut.

    Lightness and hue are kept; the largest chroma that fits is found by bisection. Clipping the channels instead
    would turn a deep blue back into plain blue.
    """
    lightness, chroma = lab[..., :1].clamp(0, 100), lab[..., 1:]

    def shown(share: Tensor) -> tuple[Tensor, Tensor]:
        rgb = lab_to_rgb(torch.cat([lightness, chroma * share], dim=-1))
        return rgb, ((rgb >= -1e-4) & (rgb <= 1 + 1e-4)).all(dim=-1, keepdim=True)

    high = torch.ones_like(lightness)
    low = shown(high)[1].to(lab.dtype)  # where all of the chroma fits, the interval is already closed
    for _ in range(16):  # down to 1.5e-5 of the chroma, well below one step of eight bits
        middle = (low + high) / 2
        fits = shown(middle)[1]
        low, high = torch.where(fits, middle, low), torch.where(fits, high, middle)
    return shown(low)[0].clamp(0, 1)


def name_of(lab: tuple[float, float, float] | Tensor) -> str:
    """The basic colour term nearest to a Lab value, with "dark" or "light" where its lightness differs much."""
    lightness, a, b = (float(v) for v in lab)
    chroma = math.hypot(a, b)
    if chroma < 9:
        return (
            "black"
            if lightness < 22
            else "dark gray"
            if lightness < 42
            else "gray"
            if lightness < 72
            else ("light gray" if lightness < 86 else "white")
        )
    here = naming_space(torch.tensor([lightness, a, b], dtype=torch.float64))
    best = min(_BASIC_NAMING, key=lambda n: float(torch.linalg.norm(here - _BASIC_NAMING[n])))
    gap = lightness - _BASIC_LAB[best][0]
    return (
        f"dark {best}" if gap < -18 and best != "black" else f"light {best}" if gap > 22 and best != "white" else best
    )


def naming_space(lab: Tensor) -> Tensor:
    """Lab `[..., 3]` to a space whose distances follow colour names rather than visible difference.

    Lightness is weighted by `NAMING_LIGHTNESS`, because a name covers many shades. Chroma is compressed,
    C' = 45 C / (C + 15), because a dull dark purple is called purple for its hue although its chroma is low.
    """
    chroma = lab[..., 1:].norm(dim=-1, keepdim=True)
    return torch.cat([NAMING_LIGHTNESS * lab[..., :1], lab[..., 1:] * (45.0 / (chroma + 15.0))], dim=-1)


def _lab3(rgb: Rgb) -> tuple[float, float, float]:
    lightness, a, b = rgb_to_lab(torch.tensor(rgb, dtype=torch.float64)).tolist()
    return (lightness, a, b)


_BASIC_LAB: dict[str, tuple[float, float, float]] = {name: _lab3(_hex(value)) for name, value in BASIC.items()}
_BASIC_NAMING = {name: naming_space(torch.tensor(lab, dtype=torch.float64)) for name, lab in _BASIC_LAB.items()}
