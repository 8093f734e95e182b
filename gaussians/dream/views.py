"""Views of an object in the middle: drawn at random, and what a prompt says of them.

The object stands upright around the origin, its front towards -y, and a sphere of radius 1 encloses it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..camera import Camera, Vec3

LOWEST, HIGHEST = -10.0, 70.0  # degrees of elevation
FOV = 45.0  # degrees
FILLS = (0.75, 1.0)  # of the picture that the enclosing sphere fills
FRONT, BACK, ABOVE = 45.0, 135.0, 55.0  # degrees of azimuth up to which it is the front, from which the back; elevation
_PLAIN = 0.5  # share of the backgrounds that are grey


@dataclass(frozen=True, eq=False)
class Asked:
    """A view that is asked for.

    Attributes:
        camera: looks at the origin, square.
        background: display-space RGB.
        azimuth: degrees from the front, counter-clockwise seen from above, in [-180, 180).
        elevation: degrees above the horizon.
    """

    camera: Camera
    background: Vec3
    azimuth: float
    elevation: float

    @property
    def side(self) -> str:
        """ "front", "side", "back" or "above"."""
        if self.elevation > ABOVE:
            return "above"
        away = abs(self.azimuth)
        return "front" if away <= FRONT else "back" if away >= BACK else "side"


def view(azimuth: float, elevation: float, size: int, fills: float = 0.9, background: Vec3 = (1.0, 1.0, 1.0)) -> Asked:
    """A view from an azimuth and an elevation, degrees, of `size` px.

    Args:
        fills: share of the picture's side that the enclosing sphere fills.
    """
    around, above = math.radians(azimuth), math.radians(elevation)
    away = 1 / (fills * math.sin(math.radians(FOV) / 2))
    eye = away * np.array([math.sin(around) * math.cos(above), -math.cos(around) * math.cos(above), math.sin(above)])
    camera = Camera.look_at(eye, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), size, size, FOV, f"{azimuth:.0f}_{elevation:.0f}")
    return Asked(camera, background, azimuth, elevation)


def drawn(rng: np.random.Generator, size: int) -> Asked:
    """A random view: even over the sphere between the elevations, before a random background."""
    azimuth = float(rng.uniform(-180, 180))
    low, high = (math.sin(math.radians(e)) for e in (LOWEST, HIGHEST))
    elevation = math.degrees(math.asin(float(rng.uniform(low, high))))
    fills = float(rng.uniform(*FILLS))
    color = rng.uniform(0, 1, 3)
    grey = bool(rng.uniform() < _PLAIN)
    red, green, blue = (float(c) for c in (np.full(3, color[0]) if grey else color))
    return view(azimuth, elevation, size, fills, (red, green, blue))
