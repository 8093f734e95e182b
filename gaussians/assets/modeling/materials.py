"""Materials of pieces (a colour and the name of a pattern), palettes, and the colours of one design.

`patterns` draws the patterns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ... import color as colors
from ...color import Rgb

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """Colour and pattern of a surface.

    Attributes:
        color: display RGB in [0, 1].
        pattern: a key of `patterns.PATTERNS`.
        second: the second colour of a two-coloured pattern.
        scale: period or feature size, metres.
        axis: 0, 1 or 2, the axis along which a directed pattern runs.
        seed: seed of the pattern's irregularities.
        main: whether this is the colour that the object is named by.
    """

    color: Rgb
    pattern: str = "plain"
    second: Rgb = (1.0, 1.0, 1.0)
    scale: float = 0.1
    axis: int = 0
    seed: int = 0
    main: bool = False

    def along(self, axis: int) -> Self:
        """The same material with its pattern along another axis."""
        return replace(self, axis=axis)

    def shaded(self, factor: float) -> Self:
        """A darker (< 1) or lighter (> 1) version."""
        return replace(self, color=shade(self.color, factor), second=shade(self.second, factor))


def shade(rgb: Rgb, factor: float) -> Rgb:
    """Darken by `factor` (< 1), or mix with white by `factor - 1` (> 1)."""
    if factor <= 1:
        return (rgb[0] * factor, rgb[1] * factor, rgb[2] * factor)
    t = min(factor - 1, 1.0)
    return (rgb[0] + (1 - rgb[0]) * t, rgb[1] + (1 - rgb[1]) * t, rgb[2] + (1 - rgb[2]) * t)


def mix(a: Rgb, b: Rgb, t: float) -> Rgb:
    """Linear interpolation from `a` (t = 0) to `b` (t = 1)."""
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


# --- palettes --------------------------------------------------------------------------------------------------------

WOODS = ("#b5894f", "#8a5a33", "#5d432c", "#d8b27c", "#6e3b22", "#a8743f", "#c79a63", "#42301f")
METALS = ("#b9bcc0", "#8f9398", "#3a3b3e", "#c0a062", "#a8643c", "#d7d9db")
PALETTES: dict[str, tuple[str, ...]] = {
    # two or three shades of each basic colour term, so that colour words can be trained and measured
    "any": ("#c8201e", "#a61c28", "#f07c1c", "#e06a2a", "#f2d31b", "#e3bc2e", "#3c9a3f", "#2f7d46", "#6fae4a",
            "#128080", "#2a9a94", "#2a5ac8", "#3f79c9", "#1f3f8f", "#7d3fa6", "#6a3a8c", "#f08fb4", "#e87aa4",
            "#7a4a26", "#d9c4a0", "#202024", "#808080", "#6c7076", "#f2f2f2", "#e8e6e0"),
    "fabric": ("#c8201e", "#8f2430", "#e07b30", "#e3bc2e", "#3c7a4a", "#5f8f5a", "#128080", "#2a5ac8", "#33508a",
               "#6f8fb8", "#7d3fa6", "#e58fae", "#7a4a26", "#d9c4a0", "#c9b48f", "#2a2a2e", "#808080", "#5e6166",
               "#ece8df"),
    "wood": (*WOODS, *WOODS[:4], "#ece9e2", "#2a2826", "#4d6a8a", "#5d7d60", "#8d8f92"),
    "appliance": ("#f0f0ee", "#e6e6e4", "#b9bcc0", "#2a2b2e", "#b02a2a", "#9fc9c2", "#e8d9b0", "#4a6fa5"),
    "dark": ("#1d1e21", "#26272b", "#3a3b3f", "#8f9398", "#c9cbce", "#ededeb"),
    "leaf": ("#2f7d32", "#3f9142", "#5a9a3a", "#2c6b45", "#76a843"),
    "light": ("#f2f0ea", "#efe3c8", "#e8d5a8", "#f2e9d5", "#d96f4a", "#4f9a9a", "#c8b48a", "#e2b93b", "#7a9ac2"),
}  # fmt: skip


STEEL = Material((0.75, 0.76, 0.78), "brushed")


class Tone:
    """The colours of one design: a main colour, requested or drawn from the kind's palette, and matching ones."""

    def __init__(self, rng: np.random.Generator, palette: str, wanted: Rgb | None = None) -> None:
        self.rng = rng
        drawn = _jitter(rng, _pick(rng, PALETTES[palette]))  # drawn in any case: the design stays the same
        wooden = palette == "wood" and (_is_brown(wanted) if wanted else _is_brown(drawn))
        self.color: Rgb = wanted if wanted is not None else drawn
        self.asked = wanted is not None
        self.wooden = wooden
        self.seed = int(rng.integers(1 << 30))
        self.second: Rgb = self._companion()

    def _companion(self) -> Rgb:
        """A second colour that contrasts with the main one without changing the object's colour name."""
        light = 0.3 * self.color[0] + 0.59 * self.color[1] + 0.11 * self.color[2]
        if self.rng.random() < 0.6:
            return mix(self.color, (0.97, 0.96, 0.93), 0.75) if light < 0.6 else shade(self.color, 0.55)
        return mix(self.color, (0.08, 0.08, 0.1), 0.6) if light > 0.35 else mix(self.color, (1, 1, 1), 0.55)

    def in_white(self) -> Material:
        """The requested colour, or else the white of baths and kitchen fronts, which becomes the main colour."""
        if not self.asked:
            self.color = (0.94, 0.94, 0.92)
        return Material(self.color, main=True)

    @property
    def main(self) -> Material:
        """Main colour on hard surfaces: wood grain if it is a wood colour, plain paint otherwise."""
        return Material(self.color, "wood" if self.wooden else "plain", self.second, seed=self.seed, main=True)

    def textile(self, scale: float = 0.08, plain: float = 0.55) -> Material:
        """Main colour on cloth: plain or woven with probability `plain`, else stripes, checks, dots or leaves."""
        kind = str(self.rng.choice(["stripes", "checks", "dots", "leaves"]))
        chosen = str(self.rng.choice(["plain", "weave"])) if self.rng.random() < plain else kind
        size = float(scale * self.rng.uniform(0.8, 1.6))
        second = mix(self.color, self.second, 0.8)
        return Material(self.color, chosen, second, size, int(self.rng.integers(0, 2)), self.seed, True)

    def glazed(self, scale: float = 0.03) -> Material:
        """Main colour on pottery: plain, banded, or dotted."""
        chosen = str(self.rng.choice(["plain", "plain", "stripes", "dots", "marble"]))
        return Material(self.color, chosen, mix(self.color, self.second, 0.8), scale, 2, self.seed, True)

    def wood(self) -> Material:
        """A random wood, for legs and frames."""
        return Material(_jitter(self.rng, _pick(self.rng, WOODS)), "wood", seed=self.seed + 1, axis=2)

    def metal(self) -> Material:
        """A random metal: steel, black, brass or copper."""
        return Material(_pick(self.rng, METALS), "brushed", seed=self.seed)

    def accent(self) -> Material:
        """A random colour independent of the main one, for books, cushions and trims."""
        return Material(_jitter(self.rng, _pick(self.rng, PALETTES["any"])), seed=int(self.rng.integers(1 << 20)))

    def frame(self) -> Material:
        """A random wood or metal."""
        return self.wood() if self.rng.random() < 0.6 else self.metal()

    @staticmethod
    def plain(text: str, name: str = "plain", **options: float | int | str | Rgb) -> Material:
        """A fixed colour, given as `color.parse` takes it, with the pattern `name`."""
        return Material(colors.parse(text), name, **options)  # type: ignore[arg-type]


def _pick(rng: np.random.Generator, table: tuple[str, ...]) -> Rgb:
    return colors.parse(table[int(rng.integers(len(table)))])


def _jitter(rng: np.random.Generator, rgb: Rgb) -> Rgb:
    gain = rng.uniform(0.9, 1.08)
    r, g, b = (float(np.clip(c * gain + rng.normal(0, 0.012), 0.02, 0.98)) for c in rgb)
    return (r, g, b)


def _is_brown(rgb: Rgb) -> bool:
    r, g, b = rgb
    return r > 1.12 * g > 1.12 * b and r - b > 0.08
