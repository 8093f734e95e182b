"""A texture from a picture of a surface: its own shading divided out, made to repeat without a seam, in metres.

A picture whose pattern has a period is cut to whole periods, as many as it shows, so that the period stays. The ends
of another overlap and go over into each other where they agree best. Cells that are not known are filled as holes are
(`filling.texture`). What a picture shows is not finer than its cells, and every look-up is averaged over the blur of
the point that asks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from ..color_map import LUMA
from ..filling.smooth import F64, Mask, averaged
from ..filling.texture import continued
from .noise import F32
from .periods import Periods, periods
from .textures import Floats, Spots

FEWEST = 12  # cells along the shorter side of a picture
_DARK = 0.03  # added to colours before the logarithm
_SHADE = 0.3  # of the picture's shorter side: standard deviation of the low-pass that counts as shading
_PLAIN = 0.012  # standard deviation of a texture that cannot be seen, display values
_BLEND = 0.2  # of a period: width of the seam between whole periods
_SEAM = 0.22  # of a picture without a period: how far its ends overlap
_SOFT = 1.0  # cells over which it goes over from one end to the other
_LEVELS = 6  # of blur, each twice the one before
_KEEPS = 0.85  # share of its contrast that a texture keeps at the size of its finest feature
_STEEPEST = 2.0  # shading is between 1 / this and this


@dataclass(frozen=True, eq=False)
class Exemplar:
    """A texture that repeats.

    Attributes:
        levels: `[L, H, W, 3]` float32 display colours of the pigment in good neutral light, each level blurred more
            than the one before; columns run across the texture, rows along it (upward in one from a wall).
        cell: side of a cell along columns and along rows, metres.
        period: length that repeats along columns and along rows, metres, None where there is none.
        lies: whether it comes from a level surface, where rows run along the longer side.
        contrast: standard deviation of its display colours.
    """

    levels: F32
    cell: tuple[float, float]
    period: tuple[float | None, float | None]
    lies: bool
    contrast: float

    @property
    def plain(self) -> bool:
        """Whether it shows no pattern."""
        return self.contrast < _PLAIN

    @property
    def mean(self) -> tuple[float, float, float]:
        """Its mean display colour."""
        red, green, blue = self.levels[0].reshape(-1, 3).mean(axis=0).tolist()
        return red, green, blue

    @property
    def unit(self) -> float | None:
        """The length of what repeats, metres: of a brick the longer side; None if nothing does."""
        return max((p for p in self.period if p is not None), default=None)

    @property
    def detail(self) -> float:
        """Size of its finest feature that is worth showing, metres."""
        spread = self.levels.reshape(len(self.levels), -1, 3).std(axis=1).mean(axis=1)
        told = np.flatnonzero(spread < _KEEPS * max(float(spread[0]), 1e-9))
        fine = _blurs()[int(told[0]) - 1] if len(told) else _blurs()[-1]
        return float(2.0 * max(fine, 1.0) * max(self.cell))

    def scaled(self, factor: float) -> Exemplar:
        """The texture with all lengths times a factor."""
        across, along = self.period
        return replace(
            self,
            cell=(factor * self.cell[0], factor * self.cell[1]),
            period=(across and factor * across, along and factor * along),
        )

    def colored(self, color: tuple[float, float, float]) -> Exemplar:
        """The texture with another mean colour."""
        gain = np.array(color) / np.maximum(np.array(self.mean), 0.02)
        return replace(self, levels=np.clip(self.levels * gain, 0, 1).astype(np.float32))


def pigment_of(exemplar: Exemplar, spots: Spots) -> F32:
    """Display colours `[N, 3]` of a texture laid on a surface.

    On what stands, rows run upward, and those from a level surface along the thing's longest side; on what lies they
    run along its longer side.
    """
    rising = np.abs(spots.normal[:, 2]) < 0.7
    turned = ~rising | (exemplar.lies and spots.grain != 2)
    across = np.where(turned, spots.plane[:, 1], spots.plane[:, 0]) / np.float32(exemplar.cell[0])
    along = np.where(turned, spots.plane[:, 0], spots.plane[:, 1]) / np.float32(exemplar.cell[1])
    blur = spots.blur / np.float32(np.sqrt(exemplar.cell[0] * exemplar.cell[1]))
    steps = np.log2(np.maximum(_blurs()[1:], 1e-9))
    level = np.clip(np.interp(np.log2(np.maximum(blur, 1e-6)), steps, np.arange(1, len(steps) + 1)), 0, _LEVELS - 1)
    level = np.where(blur < _blurs()[1], blur / _blurs()[1], level)
    low = np.minimum(np.floor(level), _LEVELS - 2).astype(np.int64)
    share = (level - low)[:, None].astype(np.float32)
    found = (1 - share) * _read(exemplar.levels, low, across, along) + share * _read(
        exemplar.levels, low + 1, across, along
    )
    return np.clip(found, 0, 1).astype(np.float32)


def _read(levels: F32, level: NDArray[np.int64], across: Floats, along: Floats) -> F32:
    """`[N, 3]` bilinear values of levels at places in cells, which wrap around."""
    _, h, w, _ = levels.shape
    x, y = across - 0.5, along - 0.5
    x0, y0 = np.floor(x), np.floor(y)
    fx, fy = (x - x0)[:, None].astype(np.float32), (y - y0)[:, None].astype(np.float32)
    xs = [np.mod(x0 + k, w).astype(np.int64) for k in (0, 1)]
    ys = [np.mod(y0 + k, h).astype(np.int64) for k in (0, 1)]
    top = (1 - fx) * levels[level, ys[0], xs[0]] + fx * levels[level, ys[0], xs[1]]
    below = (1 - fx) * levels[level, ys[1], xs[0]] + fx * levels[level, ys[1], xs[1]]
    return np.asarray((1 - fy) * top + fy * below, dtype=np.float32)


def _blurs() -> F64:
    """Blur of each level, cells."""
    return np.array([0.0, *(0.75 * 2.0**k for k in range(_LEVELS - 1))])


class Picture(NamedTuple):
    """A picture of one surface, rows upward.

    Attributes:
        rgb: `[H, W, 3]` display colours.
        known: `[H, W]`, cells that show the surface.
        cell: side of a cell, metres.
        lies: whether it shows a level surface, its rows along the longer side.
    """

    rgb: F64
    known: Mask
    cell: float
    lies: bool


def exemplar_of(picture: Picture) -> Exemplar:
    """The texture that a picture shows; at least `FEWEST` cells to each side."""
    rgb = np.clip(picture.rgb, 0, 1)
    if not picture.known.all():
        rgb = np.clip(continued(rgb, picture.known, ~picture.known).picture, 0, 1)
    flat, found = flattened(rgb)
    tile, cell = _seamless(flat, found, picture.cell)
    contrast = float(tile.std(axis=(0, 1)).mean())
    levels = [tile]
    for blur in _blurs()[1:]:
        levels.append(
            np.stack([scipy.ndimage.gaussian_filter(tile[..., c], blur, mode="wrap") for c in range(3)], axis=2)
        )
    period = (found.across and found.across * picture.cell, found.up and found.up * picture.cell)
    return Exemplar(np.stack(levels).astype(np.float32), cell, period, picture.lies, contrast)


def flattened(rgb: F64) -> tuple[F64, Periods]:
    """A picture with its shading divided out, mean luma kept, and the periods of what is left.

    Light and pigment multiply, so shading is a low frequency of the logarithm of luma; hues stay. Where a pattern
    repeats, luma is averaged over whole periods first.
    """
    short = min(rgb.shape[:2])
    logs = np.log(rgb + _DARK)
    found = periods(logs - _low(logs, _SHADE * short))
    luma = np.log(rgb @ np.array(LUMA) + _DARK)[..., None]
    shading = _low(luma, _SHADE * short, found)
    shading = np.clip(shading - shading.mean(), -np.log(_STEEPEST), np.log(_STEEPEST))
    flat = np.clip(np.exp(logs - shading) - _DARK, 0, 1)
    gain = (rgb @ np.array(LUMA)).mean() / max(float((flat @ np.array(LUMA)).mean()), 1e-6)
    flat = np.clip(flat * gain, 0, 1)
    again = np.log(flat + _DARK)
    return flat, periods(again - _low(again, _SHADE * short, found))


def _low(values: F64, sigma: float, repeats: Periods | None = None) -> F64:
    """A quadratic through values `[H, W, C]` and the low frequencies of the rest, which do not pull at the rim.

    Args:
        repeats: periods over which the values are averaged first; cells within half a period of the rim do not count.
    """
    h, w, _ = values.shape
    valid = np.ones((h, w))
    for axis, period in enumerate((repeats.up, repeats.across)) if repeats is not None else ():
        size = round(period) if period is not None else 0
        if 1 < size < 0.6 * values.shape[axis]:
            values = scipy.ndimage.uniform_filter1d(values, size, axis=axis, mode="nearest")
            index = np.arange(values.shape[axis])
            inside = (index >= size // 2) & (index < values.shape[axis] - size // 2)
            valid *= inside[:, None] if axis == 0 else inside[None, :]
    y, x = np.meshgrid(np.linspace(-1, 1, h), np.linspace(-1, 1, w), indexing="ij")
    basis = np.stack([np.ones_like(x), x, y, x * y, x * x, y * y], axis=2).reshape(-1, 6)
    counted = valid.reshape(-1) > 0
    fitted = basis @ np.linalg.lstsq(basis[counted], values.reshape(h * w, -1)[counted], rcond=None)[0]
    smooth = fitted.reshape(values.shape)
    return np.asarray(smooth + averaged(values - smooth, valid, sigma))


def _seamless(flat: F64, found: Periods, cell: float) -> tuple[F64, tuple[float, float]]:
    """A tile that repeats without a seam along both sides, and its cells in metres."""
    tile, cells = flat, [cell, cell]
    healed = list[int]()
    for axis, period in ((1, found.across), (0, found.up)):
        cut = _whole(tile, axis, period) if period is not None else None
        if cut is None:
            healed.append(axis)
            continue
        tile, factor = cut
        cells[1 - axis] *= factor
    return _healed(tile, healed), (cells[0], cells[1])


def _whole(picture: F64, axis: int, period: float) -> tuple[F64, float] | None:
    """As many whole periods along an axis as fit, blended at the seam, and the length of its cells relative to those
    before; None if not one fits."""
    size = picture.shape[axis]
    blend = max(2, round(_BLEND * period))
    most = int((size - blend) // period)
    if most < 1:
        return None
    turned = np.moveaxis(picture, axis, 0)
    counts = range(max(1, (most + 1) // 2), most + 1)  # bricks repeat after two courses: the best count is taken
    count = min(counts, key=lambda n: (_apart(turned, n * period, blend), -n))
    length = count * period
    cells = max(FEWEST // 2, round(length))
    places = np.arange(cells) * (length / cells)
    tile = _sampled(turned, places)
    share = np.clip(1 - places / blend, 0, 1).reshape(-1, *[1] * (turned.ndim - 1))
    later = _sampled(turned, np.minimum(places + length, size - 1))
    tile = (1 - share) * tile + share * later
    return np.moveaxis(tile, 0, axis), length / cells


def _apart(turned: F64, length: float, blend: int) -> float:
    """How much a picture differs from itself a length further on, within a band; rounded, as ties go to the longer."""
    places = np.arange(blend, dtype=np.float64)
    later = np.minimum(places + length, len(turned) - 1)
    return round(float(((_sampled(turned, places) - _sampled(turned, later)) ** 2).mean()) ** 0.5, 2)


def _sampled(turned: F64, places: Floats) -> F64:
    """Rows of a picture at places between them."""
    low = np.clip(np.floor(places).astype(np.int64), 0, len(turned) - 1)
    high = np.minimum(low + 1, len(turned) - 1)
    share = (places - low).reshape(-1, *[1] * (turned.ndim - 1))
    return np.asarray((1 - share) * turned[low] + share * turned[high])


def _healed(tile: F64, axes: list[int]) -> F64:
    """A tile whose opposite sides meet along some axes too: its ends overlap, and it goes over from one to the other
    where they agree best (Efros and Freeman, "Image Quilting", 2001)."""
    for axis in axes:
        if _meets(tile, axis):
            continue
        turned = np.moveaxis(tile, axis, 0)
        wide = max(3, round(_SEAM * len(turned)))
        kept = turned[:-wide].copy()
        own, later = kept[:wide], turned[-wide:]
        cut = _cheapest_path(((own - later) ** 2).sum(axis=2))
        own_side = (np.arange(wide)[:, None] > cut[None]).astype(np.float64)
        share = scipy.ndimage.gaussian_filter1d(own_side, _SOFT, axis=0, mode="nearest")[..., None]
        kept[:wide] = share * own + (1 - share) * later
        tile = np.moveaxis(kept, 0, axis)
    return tile


def _cheapest_path(cost: F64) -> NDArray[np.int64]:
    """`[N]` row of the cheapest path through the columns of a table `[B, N]` that wraps around."""
    wide, n = cost.shape
    thrice = np.concatenate([cost, cost, cost], axis=1)
    total = thrice.copy()
    for k in range(1, 3 * n):
        before = np.pad(total[:, k - 1], 1, constant_values=np.inf)
        total[:, k] += np.minimum(np.minimum(before[:-2], before[1:-1]), before[2:])
    path = np.zeros(3 * n, dtype=np.int64)
    path[-1] = int(total[:, -1].argmin())
    for k in range(3 * n - 2, -1, -1):
        low, high = max(0, path[k + 1] - 1), min(wide, path[k + 1] + 2)
        path[k] = low + int(total[low:high, k].argmin())
    return path[n : 2 * n]


def _meets(tile: F64, axis: int) -> bool:
    """Whether the opposite sides of a tile are alike as they are, as those of stripes along it."""
    turned = np.moveaxis(tile, axis, 0)
    apart = float(np.abs(turned[0] - turned[-1]).mean())
    usual = float(np.abs(np.diff(turned, axis=0)).mean())
    return apart <= 1.5 * usual + 0.004
