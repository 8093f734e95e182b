"""White points: the Planckian locus, chromatic adaptation, and the display's transfer function.

Temperatures are kelvins. Neutral on a display (D65) counts as `NEUTRAL`; other temperatures are its chromaticity
adapted along the Planckian locus, so that `NEUTRAL` leaves colours as they are.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

NEUTRAL = 6500.0
COLDEST, WARMEST = 20_000.0, 1_700.0
_MATCH = (1667.0, 25_000.0)  # range of the approximation
# Linear sRGB to XYZ, IEC 61966-2-1.
_TO_XYZ: F64 = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
# XYZ to cone responses, Bradford (Lam 1985, as in ICC.1:2022, annex E).
_BRADFORD: F64 = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
LUMINANCE: F64 = _TO_XYZ[1]
_LEVELS = 6  # of each channel, of the colours that the map of display colours is fitted to
_DIMMEST = 0.05  # display value of the weakest channel of white
_EVEN = 30.0  # weight of white among them


def to_linear(display: F64) -> F64:
    """Linear light of display values (sRGB, IEC 61966-2-1), odd below zero."""
    size = np.abs(display)
    low = size / 12.92
    return np.asarray(np.sign(display) * np.where(size <= 0.04045, low, ((size + 0.055) / 1.055) ** 2.4))


def to_display(linear: F64) -> F64:
    """Display values of linear light; the inverse of `to_linear`."""
    size = np.abs(linear)
    high = 1.055 * np.maximum(size, 1e-12) ** (1 / 2.4) - 0.055
    return np.asarray(np.sign(linear) * np.where(size <= 0.0031308, 12.92 * size, high))


def luminance(display: F64) -> F64:
    """`[...]` relative luminance of display colours `[..., 3]`, clamped to what a display shows."""
    return np.asarray(to_linear(np.clip(display, 0.0, 1.0)) @ LUMINANCE)


def planckian(kelvin: float) -> tuple[float, float]:
    """CIE 1931 x, y of a black body.

    Cubic approximations of Kim et al., "Design of advanced color temperature control system for HDTV applications",
    J. Korean Physical Society 41 (2002), for 1667 to 25000 K; temperatures outside count as the nearest.
    """
    t = 1e3 / min(max(kelvin, _MATCH[0]), _MATCH[1])
    if kelvin <= 4000:
        x = ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
    else:
        x = ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390
    if kelvin <= 2222:
        y = ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
    elif kelvin <= 4000:
        y = ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
    else:
        y = ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483
    return x, y


def _xyz(kelvin: float) -> F64:
    x, y = planckian(kelvin)
    return np.array([x / y, 1.0, (1 - x - y) / y])


@cache
def _adaptation(old: float, new: float) -> F64:
    """`[3, 3]` linear sRGB under a white of `old` kelvins to that under `new`, Bradford; the luminance of neutral
    white stays."""
    was, now = _BRADFORD @ _xyz(old), _BRADFORD @ _xyz(new)
    in_xyz = np.linalg.inv(_BRADFORD) @ np.diag(now / was) @ _BRADFORD
    matrix = np.linalg.inv(_TO_XYZ) @ in_xyz @ _TO_XYZ
    return np.asarray(matrix / (LUMINANCE @ matrix @ np.ones(3)))


def white(kelvin: float) -> F64:
    """`[3]` linear colour of white paint in light of a temperature, of luminance 1, at least 0."""
    return np.maximum(_adaptation(NEUTRAL, kelvin) @ np.ones(3), 0.0)


@cache
def balance(old: float, new: float) -> F64:
    """`[3, 3]` map of display colours that changes the white from `old` kelvins to `new`; its inverse does it back."""
    return np.eye(3) if old == new else np.asarray(_from_neutral(new) @ np.linalg.inv(_from_neutral(old)))


@cache
def _from_neutral(kelvin: float) -> F64:
    """`[3, 3]` map of display colours that changes the white from `NEUTRAL`.

    Adaptation is linear in light, and harmonics are linear in display values. This is the matrix whose display colours
    are closest to the adapted ones over the display's range; white is exact.
    """
    matrix = _adaptation(NEUTRAL, kelvin)
    steps = np.linspace(0.1, 1.0, _LEVELS)
    colors = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    wanted = to_display(np.maximum(to_linear(colors) @ matrix.T, 0.0))
    shown = np.maximum(to_display(matrix @ np.ones(3)), _DIMMEST)
    found, *_ = np.linalg.lstsq(np.vstack([colors, _EVEN * np.ones(3)]), np.vstack([wanted, _EVEN * shown]), rcond=None)
    rows = found.T
    rows += np.diag(shown - rows.sum(axis=1))  # what is left of the error of white
    return np.asarray(rows)


@cache
def _locus() -> tuple[F64, F64]:
    """Mireds `[M]`, ascending, and CIE 1960 u, v `[M, 2]` of the Planckian locus."""
    mireds = np.arange(1e6 / _MATCH[1], 1e6 / _MATCH[0], 0.25)
    return mireds, np.array([_uv(_xyz(1e6 / m)) for m in mireds])


def _uv(xyz: F64) -> F64:
    total = xyz[0] + 15 * xyz[1] + 3 * xyz[2]
    return np.array([4 * xyz[0], 6 * xyz[1]]) / max(float(total), 1e-12)


def kelvin_of(display: F64) -> float:
    """Temperature of the light in which white paint has a display colour `[3]`: that of the nearest point of the locus
    in CIE 1960 u, v."""
    neutral = _TO_XYZ @ np.ones(3)
    ratio = (_BRADFORD @ _xyz(NEUTRAL)) / (_BRADFORD @ neutral)
    seen = np.linalg.inv(_BRADFORD) @ (ratio * (_BRADFORD @ _TO_XYZ @ to_linear(np.asarray(display, np.float64))))
    mireds, points = _locus()
    return float(1e6 / mireds[np.linalg.norm(points - _uv(seen), axis=1).argmin()])


def warmer_by(kelvin: float, mireds: float) -> float:
    """A temperature that is lower by so many mireds (1e6 / K), within the range that is shown."""
    return float(1e6 / min(max(1e6 / kelvin + mireds, 1e6 / COLDEST), 1e6 / WARMEST))
