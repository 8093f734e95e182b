"""Take the texture of a thing: from the largest flat part of it that faces outward, seen straight from before it.

The thing is drawn alone from the sides of its box, nearly without perspective. What lies at one depth is flat; the
largest rectangle of it is the picture. It is divided by the light that falls on the thing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import Sample
from ...gaussians.scene import Scene
from ..color_map import LUMA
from ..coloring.scene_light import light_around, scene_light
from ..coloring.seen import lit_color, seen_colors
from ..filling.charts import Chart, seen
from ..filling.planes import Plane
from ..placement.bodies import Body
from .exemplar import FEWEST, Exemplar, Picture, exemplar_of

_MOST = 288  # cells along the longer side of a view
_LOOKS = 96  # the same of the views by which the side is chosen
_FINE = 0.5  # of the median size of its Gaussians: side of a cell
_SOLID = 0.6  # alpha of a cell that shows the thing
_DEEP = 0.04  # of the thing's longest side: half the depth within which a part is flat
_HOLES = 0.06  # share of a rectangle that may be unknown
_INWARD = 0.25  # by how much a side that faces the middle of the scene counts more than one that faces away
_TURNED = 0.999  # cosine above which two axes are one
_BRIGHTER = 1.6  # by which the lit faces of a thing may be brighter than the side that is taken


class Side(NamedTuple):
    """A side of a thing: its outward normal, the directions of columns and rows, and whether it is level."""

    normal: NDArray[np.float64]
    across: NDArray[np.float64]
    along: NDArray[np.float64]
    level: bool


class _Flat(NamedTuple):
    """The largest flat rectangle of a side: its corners in plane coordinates, its plane, and how much it is worth."""

    side: Side
    plane: Plane
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    worth: float


def texture_of(scene: Scene, body: Body, metres: float, name: str) -> Exemplar:
    """The texture of a thing's best side, as a pigment in good neutral light.

    Args:
        metres: metres per scene unit.
        name: what the thing is called, for the error.

    Raises:
        InstructionError: too little of it is flat, or seen in too few cells, to show a pattern.
    """
    cloud = scene.cloud[body.rows]
    found = _best(scene, cloud, body)
    spread = float(cloud.scales.sort(dim=1).values[:, 1].median())
    extent = float((found.high - found.low).max()) if found is not None else 0.0
    if found is None or extent <= 0:
        raise InstructionError(f"the {name} has no flat part large enough to take a pattern from: name another thing")
    cell = max(extent / _MOST, _FINE * spread)
    width, height = (round(float(s) / cell) for s in found.high - found.low)
    if min(width, height) < FEWEST:
        raise InstructionError(
            f"the {name} is too coarse to take a pattern from: its best flat part shows {width} x {height} points, "
            f"and a pattern needs {FEWEST} to each side; name a material, or another thing"
        )
    shown = seen(Chart(found.plane, found.low, cell, (height, width)), cloud)
    depth = _DEEP * max(body.box.size)
    known = (shown.alpha > _SOLID) & (np.abs(shown.height) < 2 * depth)
    rgb = shown.rgb / _light(scene, body.rows, shown.rgb[known])
    return exemplar_of(Picture(np.clip(rgb, 0, 1), known, cell * metres, found.side.level))


def _light(scene: Scene, rows: Tensor, seen_rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """`[3]` what the colours of a side are divided by to give pigments: the light there, and less of it where the side
    lies in the shade of the thing itself."""
    luma = torch.tensor(LUMA, dtype=torch.float64)
    lit = lit_color(seen_colors(scene, rows))
    white = torch.tensor(light_around(scene.cloud, rows, scene_light(scene.cloud), float(lit @ luma)).white)
    count = max(1, len(seen_rgb))
    shown = Sample(torch.from_numpy(seen_rgb), torch.full((len(seen_rgb),), 1 / count, dtype=torch.float64))
    side = float(lit_color(shown) @ luma) if len(seen_rgb) else 1.0
    shade = float(np.clip(side / max(float(lit @ luma), 1e-3), 1 / _BRIGHTER, 1.0))
    return np.maximum(white.double().numpy() * shade, 0.05)


def _best(scene: Scene, cloud: GaussianCloud, body: Body) -> _Flat | None:
    middle = scene.language.middle if scene.language is not None else body.center
    inward = np.asarray(middle, dtype=np.float64) - body.center
    inward /= max(float(np.linalg.norm(inward)), 1e-9)
    found = [flat for side in _sides(body) if (flat := _flat(cloud, body, side)) is not None]
    weighed = [f._replace(worth=f.worth * (1 + _INWARD * float(f.side.normal @ inward))) for f in found]
    return max(weighed, key=lambda f: f.worth, default=None)


def _sides(body: Body) -> list[Side]:
    """The sides of a thing's box but for its underside."""
    first, second, up = np.array(body.box.axes, dtype=np.float64)
    if body.box.size[1] > body.box.size[0]:
        first, second = second, -first
    sides = [Side(sign * n, sign * np.cross(up, n), up, False) for n in (first, second) for sign in (1.0, -1.0)]
    return [*sides, Side(up, np.cross(first, up), first, True)]


def _flat(cloud: GaussianCloud, body: Body, side: Side) -> _Flat | None:
    """The largest rectangle at one depth on a side."""
    # A chart's axes are right-handed with the normal: columns, rows, normal.
    axes = np.stack([side.across, side.along, side.normal])
    reach = np.abs(axes @ np.array(body.box.axes).T) @ (np.array(body.box.size) / 2)
    plane = Plane(body.center, axes, 0.0, last=False)
    low, high = -reach[:2], reach[:2]
    cell = float((high - low).max()) / _LOOKS
    shape = (max(2, int((high - low)[1] / cell)), max(2, int((high - low)[0] / cell)))
    shown = seen(Chart(plane, low, cell, shape), cloud)
    solid = shown.alpha > _SOLID
    if solid.sum() < 4:
        return None
    depth = _DEEP * max(body.box.size)
    heights = shown.height[solid]
    edges = np.arange(heights.min() - depth, heights.max() + 2 * depth, depth)
    held = np.convolve(np.histogram(heights, edges)[0], np.ones(2), mode="valid")
    level = float(edges[int(held.argmax()) + 1])
    near = solid & (np.abs(shown.height - level) < depth)
    rectangle = largest_rectangle(near, _HOLES)
    if rectangle is None:
        return None
    top, left, bottom, right = rectangle
    corner = low + np.array([left, top]) * cell
    far = low + np.array([right, bottom]) * cell
    origin = np.asarray(plane.world(np.array([0.0, 0.0, level])))
    return _Flat(side, Plane(origin, axes, 0.0, last=False), corner, far, float(np.prod(far - corner)))


def largest_rectangle(mask: NDArray[np.bool_], holes: float) -> tuple[int, int, int, int] | None:
    """Top, left, bottom and right (exclusive) of the largest rectangle of a mask `[H, W]` in which at most a share of
    `holes` is not set, and no side of it is mostly unset; None if nothing is set."""
    if not mask.any():
        return None
    sums = np.pad(mask.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    h, w = mask.shape
    best, found = 0, None
    lefts, rights = np.meshgrid(np.arange(w), np.arange(1, w + 1), indexing="ij")
    wide = rights - lefts
    for top in range(h):
        for bottom in range(h, top, -1):
            if (bottom - top) * w <= best:
                break
            band = sums[bottom] - sums[top]
            inside = band[rights] - band[lefts]
            area = wide * (bottom - top)
            good = (wide > 0) & (inside >= (1 - holes) * area)
            most = int(np.where(good, area, 0).max())
            if most > best:
                k = int(np.where(good, area, 0).argmax())
                best, found = most, (top, int(lefts.flat[k]), bottom, int(rights.flat[k]))
    return found
