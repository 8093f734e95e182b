"""Draw materials at random: colours that are often close to each other, textures at many scales, gloss and bumps."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .textures import WIDTH, Kind, Slot

F32 = NDArray[np.float32]
Rgb = tuple[float, float, float]
# Textures of floors, of walls and of things, with weights.
FLOORS: dict[Kind, float] = {
    Kind.PLANKS: 5, Kind.TILES: 3, Kind.WEAVE: 4, Kind.NOISE: 2, Kind.CLOUDS: 1, Kind.FLAT: 1, Kind.CHECKS: 1,
    Kind.GRAIN: 1,
}  # fmt: skip
WALLS: dict[Kind, float] = {
    Kind.FLAT: 5, Kind.NOISE: 5, Kind.CLOUDS: 2, Kind.STRIPES: 1.5, Kind.TILES: 1.5, Kind.PATCHES: 0.7,
    Kind.PRINT: 0.7, Kind.GRADIENT: 1, Kind.DOTS: 0.3, Kind.PLANKS: 1, Kind.LEAVES: 0.5,
}  # fmt: skip
THINGS: dict[Kind, float] = {
    Kind.FLAT: 6, Kind.NOISE: 4, Kind.CLOUDS: 2, Kind.STRIPES: 2.5, Kind.CHECKS: 1.5, Kind.TILES: 0.6,
    Kind.PLANKS: 1, Kind.GRAIN: 3, Kind.DOTS: 1, Kind.PATCHES: 1.5, Kind.TEXT: 1, Kind.WEAVE: 2.5,
    Kind.PRINT: 2, Kind.GRADIENT: 1.5, Kind.LEAVES: 1.5,
}  # fmt: skip
# Features a metre: the range of each texture on things; others have 2 to 60.
SCALES: dict[Kind, tuple[float, float]] = {
    Kind.PLANKS: (5, 14), Kind.TILES: (2, 10), Kind.STRIPES: (3, 60), Kind.CHECKS: (4, 60), Kind.TEXT: (8, 40),
    Kind.PRINT: (1.5, 8), Kind.GRADIENT: (1, 12),
}  # fmt: skip


@dataclass
class Palette:
    """Colours of one picture; `alike` is the chance that a new colour is close to one that is already there."""

    rng: np.random.Generator
    alike: float
    colors: list[Rgb] = field(default_factory=list)

    def draw(self) -> Rgb:
        """A colour: a neutral, a wood, any hue, or nearly one drawn before."""
        rng = self.rng
        if self.colors and rng.random() < self.alike:
            base = np.array(self.colors[int(rng.integers(len(self.colors)))])
            rgb = base * np.exp(rng.normal() * 0.08) + rng.normal(size=3) * 0.02
        elif (draw := rng.random()) < 0.4:
            rgb = np.full(3, rng.choice([rng.uniform(0.02, 0.2), rng.uniform(0.2, 0.7), rng.uniform(0.7, 0.95)]))
            rgb = rgb + rng.normal(size=3) * 0.02
        elif draw < 0.6:
            rgb = np.array(colorsys.hsv_to_rgb(rng.uniform(0.04, 0.12), rng.uniform(0.2, 0.7), rng.uniform(0.15, 0.85)))
        else:
            rgb = np.array(colorsys.hsv_to_rgb(rng.random(), rng.beta(1.3, 1.8), rng.uniform(0.1, 0.95)))
        r, g, b = np.clip(rgb, 0.01, 0.98).tolist()
        self.colors.append((r, g, b))
        return r, g, b


def _pick(rng: np.random.Generator, weights: dict[Kind, float]) -> Kind:
    kinds = list(weights)
    p = np.array([weights[k] for k in kinds], np.float64)
    return kinds[int(rng.choice(len(kinds), p=p / p.sum()))]


def material(palette: Palette, weights: dict[Kind, float], size: float, own: float = 0.0) -> F32:
    """One material for a thing whose longest side is `size` metres, with the share `own` of its mesh's colours."""
    rng = palette.rng
    row = np.zeros(WIDTH, np.float32)
    kind = _pick(rng, weights)
    low, high = SCALES.get(kind, (2, 60))
    scale = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    if weights is THINGS:
        scale *= 1.0 / max(0.25, size) ** 0.7
    row[Slot.KIND], row[Slot.SCALE], row[Slot.SEED] = kind, scale, int(rng.integers(1 << 20))
    row[Slot.RED : Slot.BLUE + 1] = palette.draw()
    row[Slot.RED2 : Slot.BLUE2 + 1] = palette.draw() if rng.random() < 0.8 else rng.random(3)
    row[Slot.AMOUNT] = rng.beta(1.2, 1.2)
    row[Slot.OWN] = own
    row[Slot.GLOSS] = rng.uniform(0, 0.9) if rng.random() < 0.35 else 0.0
    row[Slot.SHARP] = np.exp(rng.uniform(np.log(5), np.log(200)))
    row[Slot.BUMP] = rng.uniform(0, 0.5) if rng.random() < 0.25 else 0.0
    row[Slot.TURN] = rng.choice([0.0, np.pi / 2, rng.uniform(0, np.pi)])
    return row


def of_thing(palette: Palette, parts: int, size: float) -> F32:
    """Materials `[parts, WIDTH]` of one thing. Its parts share a texture, or each has its own: part borders are none
    between things."""
    rng = palette.rng
    draw = rng.random()
    if draw < 0.35:  # the artist's colours, with a faint texture
        rows = np.stack([material(palette, THINGS, size, own=1.0) for _ in range(parts)])
        rows[:, Slot.AMOUNT] *= rng.random()
    elif draw < 0.6:  # one texture all over
        rows = np.repeat(material(palette, THINGS, size, own=float(rng.random() < 0.2))[None], parts, axis=0)
    else:
        rows = np.stack([material(palette, THINGS, size) for _ in range(parts)])
    return rows
