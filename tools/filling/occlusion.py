"""How much of the light above a surface a thing takes from each place of it: ambient occlusion in layers.

The thing is cut into layers parallel to the surface. A direction is blocked at a place if it meets a filled cell of any
layer. Directions are spread over the hemisphere by the cosine law, so that their share is the share of the light of an
even sky that does not arrive (compare Zhukov et al., "An ambient light illumination model", 1998). Four further
shares count directions more that lean to one side, for light that comes from there.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import scipy

from .charts import Chart
from .planes import F64, Mask
from .texture import moved

SIDES = 4  # directions that a light may lean to, along the chart's axes: +u, +v, -u, -v
LOBES = 1 + SIDES
_LAYERS = 9
_UNEVEN = 1.6  # exponent of the layers' heights: thin ones near the surface
_RINGS, _AROUND = 5, 12  # directions: inclinations, and turns at each
_LEAST, _MOST = 0.15, 0.8  # of a footprint's extent: how far a shadow is looked at beyond it
_TALL = 0.6  # of a thing's height, likewise between the two
_FADES = 0.35  # of that reach: the outer part within which occlusion fades to none
_GAMMA, _REFLECTED = 1 / 2.2, 0.3  # of a display; share of the light that is there wherever it is blocked
_SOFT = 0.7  # cells: standard deviation by which the shares are smoothed


@dataclass(frozen=True, eq=False)
class Blocked:
    """Light that a thing takes from a surface.

    Attributes:
        chart: the surface.
        footprint: `[H, W]`, cells over which a part of the thing lies.
        touching: `[H, W]`, cells that its lowest layer fills.
        shares: `[LOBES, H, W]` in [0, 1]; the first of an even sky, the others of one that leans to a side.
        reach: how far beyond the footprint it goes, scene units.
        filled: `[L, H, W]`, cells that each layer of the thing fills.
        edges: `[L]`, height at which each layer ends, scene units.
    """

    chart: Chart
    footprint: Mask
    touching: Mask
    shares: F64
    reach: float
    filled: Mask
    edges: F64

    def from_lamp(self, toward: F64, soft: float, rays: int = 24) -> F64:
        """`[H, W]` the share of the light of a wide lamp that does not arrive.

        Args:
            toward: `[3]` towards its middle, along the chart's axes and its normal.
            soft: tangent of half the angle that it fills.
            rays: to it, spread evenly over its disc.
        """
        hit = np.zeros(self.chart.shape)
        k = np.arange(rays)
        radius, turn = soft * np.sqrt((k + 0.5) / rays), np.pi * (1 + 5**0.5) * k
        slope = toward[:2] / max(float(toward[2]), 1e-6)
        ways = slope + np.linalg.norm([*slope, 1.0]) * radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        low = np.concatenate([[0.0], self.edges[:-1]])
        for ray, way in enumerate(ways / self.chart.cell):
            # Each ray meets the layers at other heights, so that they leave no steps in the shadow.
            heights = low + (ray * 0.618 % 1) * (self.edges - low)
            one = np.zeros(self.chart.shape, bool)
            for layer, height in zip(self.filled, heights, strict=True):
                one |= moved(layer, round(float(height * way[1])), round(float(height * way[0])))
            hit += one
        return np.asarray(scipy.ndimage.gaussian_filter(hit / rays, _SOFT) * self._faded())

    def _faded(self) -> F64:
        away = scipy.ndimage.distance_transform_edt(~self.footprint) * self.chart.cell
        return np.asarray(np.clip((self.reach - away) / max(_FADES * self.reach, 1e-12), 0.0, 1.0))


def reach_of(extent: float, height: float) -> float:
    """How far a thing's shadow is looked at beyond its footprint.

    Args:
        extent: of the footprint, its longer side.
        height: of the thing above the surface.
    """
    return float(np.clip(_TALL * height, _LEAST * extent, _MOST * extent))


def blocked(points: F64, chart: Chart, reach: float) -> Blocked:
    """The light that points `[M, 3]` of a thing (world frame) take from a surface below them."""
    local = chart.plane.local(points)
    layers, edges = _layers(local, chart)
    heights = (np.concatenate([[0.0], edges[:-1]]) + edges) / 2
    footprint = scipy.ndimage.binary_closing(np.pad(layers.any(axis=0), 2), iterations=2)[2:-2, 2:-2]
    shares = np.zeros((LOBES, *chart.shape))
    weights = np.zeros(LOBES)
    for tangent, turn, lean in _directions():
        hit = np.zeros(chart.shape, bool)
        for layer, height in zip(layers, heights, strict=True):
            step = height * tangent / chart.cell
            hit |= moved(layer, round(step * float(np.sin(turn))), round(step * float(np.cos(turn))))
        shares += lean[:, None, None] * hit
        weights += lean
    shares = scipy.ndimage.gaussian_filter(shares / weights[:, None, None], (0, _SOFT, _SOFT))
    found = Blocked(chart, footprint, layers[0], shares, reach, layers, edges)
    return replace(found, shares=shares * found._faded())


def depth_of(share: F64) -> F64:
    """How dark a shadow is where a thing takes a share of the light, in units of its strength: minus the logarithm of a
    display's value for the light that is left, with what the room reflects into it. So it is soft where light comes
    from most sides, and narrow and dark at the contact."""
    return np.asarray(-_GAMMA * np.log1p(-(1 - _REFLECTED) * np.clip(share, 0, 1)))


@functools.cache
def _directions() -> tuple[tuple[float, float, F64], ...]:
    """Tangent of the inclination, turn about the normal, and weight `[LOBES]` for each lobe, of each direction."""
    found = []
    for ring in range(_RINGS):
        sine = np.sqrt((ring + 0.5) / _RINGS)
        for k in range(_AROUND):
            turn = 2 * np.pi * (k + 0.5 * (ring % 2)) / _AROUND
            leans = [1.0] + [sine * max(0.0, float(np.cos(turn - side * np.pi / 2))) for side in range(SIDES)]
            found.append((float(sine / np.sqrt(1 - sine**2)), float(turn), np.array(leans)))
    return tuple(found)


def _layers(local: F64, chart: Chart) -> tuple[Mask, F64]:
    """`[layers, H, W]` cells that a thing fills in each layer, and the height at which each ends; what its sides
    enclose is filled."""
    h, w = chart.shape
    top = max(float(local[:, 2].max()), 1e-9)
    edges = top * (np.arange(1, _LAYERS + 1) / _LAYERS) ** _UNEVEN
    index = np.floor((local[:, :2] - chart.low) / chart.cell).astype(np.int64)
    inside = ((index >= 0) & (index < [w, h])).all(axis=1)
    layer = np.minimum(np.searchsorted(edges, local[:, 2]), _LAYERS - 1)
    filled = np.zeros((_LAYERS, h, w), bool)
    filled[layer[inside], index[inside, 1], index[inside, 0]] = True
    for k in range(_LAYERS):
        if filled[k].any():
            closed = scipy.ndimage.binary_closing(np.pad(filled[k], 2), iterations=1)[2:-2, 2:-2]
            filled[k] = scipy.ndimage.binary_fill_holes(closed | filled[k])
    return filled, edges
