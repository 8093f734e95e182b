"""Find the flat surfaces around a thing that it may have hidden: what it stands on, what it stands before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

VOXELS = 28  # along the longest side of the thing: the surroundings are thinned to one point in each
_TRIED = 500  # planes through random points
_LOCAL = 150  # nearest points among which the other points of such a plane are
_POINTS, _BODY = 3000, 300  # points of the surroundings and of the thing that planes are tried on
_ROUNDS = 9  # planes that are looked at for these
_FEWEST = 40  # voxels of a surface
_MOST = 6  # surfaces of one thing
_BEYOND = 0.1  # of the thing's extent along the normal that may lie behind a surface
_ENDS = 0.05  # share of its points that are strays at either end
_FACING = -0.35  # upward part of a normal below which a surface faces down: only a ceiling is seen from below
_CARRIES = 0.85  # upward part of the normal of what things stand on
_REACHES = 0.12  # of the thing's extent: how near it comes to a surface that is neither floor nor wall
_LEVEL, _UPRIGHT = 1.15, 1.1  # weight of level and of upright planes against oblique ones
_BEHIND = 0.02  # share of the surroundings behind a plane up to which nothing lies behind it
_SAME = 0.9  # cosine between normals: a larger surface of the same side that lies behind another is the last of both
_EYES = 0.25  # of the photographs that look at the thing: where more lie behind a plane, something else does too
_STRAIGHT = 0.998  # cosine of the angle up to which a plane may be level or upright
_COARSE, _NOISIER = 3.0, 2.2  # the wider tolerance over the first, and by which it must hold more to be taken
_GROWS = 1.45  # by which twice the tolerance must hold more points for it to be too narrow
_THICKEST = 0.06  # of the thing's extent: largest tolerance
_SLAB = 0.03  # of the thing's size: first tolerance of a surface


@dataclass(frozen=True, eq=False)
class Plane:
    """A flat surface near a thing, which lies on the side of its normal.

    Attributes:
        origin: `[3]`, a point of it below the middle of the thing.
        axes: `[3, 3]`, rows: two unit vectors along it and its normal, right-handed.
        noise: how far its points lie from it, standard deviation, scene units.
        last: whether nothing lies behind it, as behind floors and walls.
        carries: whether it is level and the thing stands on it.
    """

    origin: F64
    axes: F64
    noise: float
    last: bool
    carries: bool = False

    @property
    def normal(self) -> F64:
        return np.asarray(self.axes[2])

    def height(self, points: F64) -> F64:
        """Signed distance of points `[M, 3]`, positive on the thing's side."""
        return np.asarray((points - self.origin) @ self.normal)

    def local(self, points: F64) -> F64:
        """`[M, 3]` coordinates along the axes."""
        return np.asarray((points - self.origin) @ self.axes.T)

    def world(self, local: F64) -> F64:
        """World points `[M, 3]` of local ones."""
        return np.asarray(local @ self.axes + self.origin)


def planes_near(around: F64, thing: F64, up: F64, eyes: F64 | None = None) -> list[Plane]:
    """The flat surfaces that a thing may have hidden, the largest first.

    Args:
        around: `[M, 3]` opaque points around the thing, without its own.
        thing: `[K, 3]` its points.
        up: `[3]`, unit.
        eyes: `[V, 3]` from where it was photographed: where many of them lie behind a surface, it is not the last one.
    """
    low, high = thing.min(axis=0), thing.max(axis=0)
    size = float((high - low).max())
    if len(around) < _FEWEST or size <= 0:
        return []
    points = _some(thinned(around, size / VOXELS), _POINTS)
    body = _some(thinned(thing, size / VOXELS), _BODY)
    tolerance, found = _SLAB * size / 2, list[Plane]()
    left = np.ones(len(points), bool)
    rng = np.random.default_rng(0)
    for _ in range(_ROUNDS):
        if len(found) >= _MOST or left.sum() < _FEWEST:
            break
        guess, width = _fine_or_coarse(points[left], body, up, tolerance, rng)
        if guess is None:
            break
        wide = _tolerance(points[left], guess, width, _THICKEST * size)
        plane = _refined(points[left], body, guess, up, wide)
        near = left & (np.abs(plane.height(points)) < max(2 * wide, 3 * plane.noise))
        if (left & near).sum() < 5:
            break
        left &= ~near
        behind = plane.height(points) < -2 * max(wide, plane.noise)
        last = bool(behind.mean() <= _BEHIND) and not _seen_from_behind(plane, eyes)
        last &= not any(p.last and p.normal @ plane.normal > _SAME and plane.height(p.origin) < 0 for p in found)
        gap = float(np.quantile(plane.height(body), _ENDS))
        if last or (gap < _REACHES * size and plane.normal @ up > _FACING):
            # What things stand on is found first, as it is the largest; shelves and seats above it carry nothing of it.
            carries = bool(plane.normal @ up > _CARRIES and gap < _REACHES * size) and not any(p.carries for p in found)
            if not (last or carries) and plane.normal @ up > _CARRIES and any(p.carries for p in found):
                continue
            found.append(Plane(plane.origin, plane.axes, plane.noise, last, carries))
    return found


def _seen_from_behind(plane: Plane, eyes: F64 | None) -> bool:
    return eyes is not None and len(eyes) > 0 and bool((plane.height(eyes) < 0).mean() > _EYES)


def _some(points: F64, most: int) -> F64:
    """At most `most` of some points, evenly spaced in their order."""
    return points[:: max(1, -(-len(points) // most))]


def plane_through(points: F64, before: F64, up: F64, size: float) -> Plane | None:
    """The plane that holds most of some points `[M, 3]`, facing `before` `[K, 3]`; None if none holds many.

    Args:
        size: extent of the points, scene units.
    """
    thin = _some(thinned(points, size / (2 * VOXELS)), _POINTS)
    tolerance = _SLAB * size / 4
    guess = _best(thin, np.median(before, axis=0)[None], up, tolerance, np.random.default_rng(0))
    if guess is None:
        return None
    wide = _tolerance(thin, guess, tolerance, _THICKEST * size / 2)
    return _refined(thin, np.median(before, axis=0)[None], guess, up, wide)


def thinned(points: F64, voxel: float) -> F64:
    """One of the points of each voxel, `[V, 3]`, in the order of the voxels.

    A mean would lie beside the surface wherever a voxel also holds something that stands on it.
    """
    cell = np.floor((points - points.min(axis=0)) / voxel).astype(np.int64)
    dims = cell.max(axis=0) + 1
    key = (cell[:, 0] * dims[1] + cell[:, 1]) * dims[2] + cell[:, 2]
    _, first = np.unique(key, return_index=True)
    return points[first]


def _best(points: F64, body: F64, up: F64, tolerance: float, rng: np.random.Generator) -> tuple[F64, float] | None:
    """Normal and offset of the plane through some points that holds most of them, before which the thing lies."""
    from scipy.spatial import cKDTree

    normals, offsets, weights = [], [], []
    heights = points @ up
    edges = np.arange(heights.min(), heights.max() + 2 * tolerance, tolerance)
    if len(edges) > 2:
        count = np.convolve(np.histogram(heights, edges)[0], np.ones(2), mode="same")
        for peak in np.argsort(-count, kind="stable")[:8]:
            normals.append(up)
            offsets.append(float(edges[peak]))
            weights.append(_LEVEL)
    seeds = rng.integers(len(points), size=_TRIED)
    around = cKDTree(points).query(points[seeds], k=min(_LOCAL, len(points)))[1]  # points of one surface are near
    pick = np.stack([seeds, *(around[np.arange(_TRIED), rng.integers(around.shape[1], size=_TRIED)] for _ in "ab")], 1)
    first, second, third = (points[pick[:, k]] for k in range(3))
    upright, oblique = np.cross(second - first, up), np.cross(second - first, third - first)
    for normal, weight in ((upright, _UPRIGHT), (oblique, 1.0)):
        length = np.linalg.norm(normal, axis=1)
        good = length > 1e-9
        unit = normal[good] / length[good, None]
        normals += list(unit)
        offsets += list((first[good] * unit).sum(axis=1))
        weights += [weight] * int(good.sum())
    normal, offset = np.array(normals), np.array(offsets)
    held = (np.abs(points @ normal.T - offset) < tolerance).sum(axis=0)  # [planes]
    score = np.where(_aside(body @ normal.T - offset, tolerance), held * np.array(weights), 0.0)
    best = int(score.argmax())
    return (normal[best], float(offset[best])) if held[best] >= _FEWEST and score[best] > 0 else None


def _fine_or_coarse(
    points: F64, body: F64, up: F64, tolerance: float, rng: np.random.Generator
) -> tuple[tuple[F64, float] | None, float]:
    """The best plane and the tolerance at which it was found: the given one, or a wider one where that holds so many
    more points that surfaces must be noisier."""
    fine, coarse = (_best(points, body, up, factor * tolerance, rng) for factor in (1.0, _COARSE))
    if fine is None or coarse is None:
        return (fine, tolerance) if coarse is None else (coarse, _COARSE * tolerance)
    held = [int((np.abs(points @ n - o) < t).sum()) for (n, o), t in ((fine, tolerance), (coarse, _COARSE * tolerance))]
    return (coarse, _COARSE * tolerance) if held[1] > _NOISIER * held[0] else (fine, tolerance)


def _aside(height: F64, tolerance: float) -> Mask:
    """Which planes have the thing on one side; `height` `[K, planes]` of its points above them."""
    low, high = np.quantile(height, [_ENDS, 1 - _ENDS], axis=0)
    beyond = np.minimum(np.maximum(-low, 0.0), np.maximum(high, 0.0))
    return np.asarray(beyond <= np.maximum(_BEYOND * (high - low), tolerance))


def _tolerance(points: F64, guess: tuple[F64, float], least: float, most: float) -> float:
    """How thick a surface is: the tolerance about a plane beyond which it holds hardly more points. A short fit
    scatters Gaussians about the surfaces that they show."""
    wide = least
    while 2 * wide <= most:
        normal, offset = _fitted(points, *guess, wide)
        height = np.abs(points @ normal - offset)
        if (height < 2 * wide).sum() < _GROWS * (height < wide).sum():
            break
        wide *= 2
    return wide


def _held(height: F64, tolerance: float) -> int:
    return int((np.abs(height) < tolerance / 2).sum())


def _fitted(points: F64, normal: F64, offset: float, tolerance: float) -> tuple[F64, float]:
    """Normal and offset of the plane fitted to the points near a guess; the guess where the fit holds fewer."""
    height = points @ normal
    offset = float(np.median(height[np.abs(height - offset) <= tolerance]))
    best = normal, offset
    for reach in (1.0, 0.7, 0.5, 0.5):
        near = points[np.abs(points @ normal - offset) < reach * tolerance]
        if len(near) < 8:
            break
        middle = near.mean(axis=0)
        fitted = np.linalg.eigh((near - middle).T @ (near - middle))[1][:, 0]
        normal = fitted * (1.0 if fitted @ normal > 0 else -1.0)
        offset = float(middle @ normal)
        if _held(points @ normal - offset, tolerance) >= _held(points @ best[0] - best[1], tolerance):
            best = normal, offset
    return best


def _refined(points: F64, body: F64, guess: tuple[F64, float], up: F64, tolerance: float) -> Plane:
    """The plane fitted to the points near a guess; level and upright planes stay so if they nearly are."""
    normal, offset = _fitted(points, *guess, tolerance)
    for exact in (up, normal - up * (normal @ up)):
        length = float(np.linalg.norm(exact))
        if length > _STRAIGHT:  # a plane that is level or upright but for noise is taken to be so
            exact = exact / length * (1.0 if exact @ normal > 0 else -1.0)
            if abs(exact @ normal) > _STRAIGHT:
                height = points @ exact
                middle = float(np.median(height[np.abs(points @ normal - offset) < tolerance]))
                if _held(height - middle, tolerance) >= 0.97 * _held(points @ normal - offset, tolerance):
                    normal, offset = exact, middle
    height = points @ normal - offset
    near = np.abs(height) < tolerance
    noise = 1.48 * float(np.median(np.abs(height[near]))) if near.any() else tolerance
    if float(np.median(body @ normal)) < offset:
        normal, offset = -normal, -offset
    middle = (body.min(axis=0) + body.max(axis=0)) / 2
    origin = middle - normal * (middle @ normal - offset)
    across = (
        np.cross(up, normal) if abs(normal @ up) < 0.9 else np.cross(np.eye(3)[int(np.abs(normal).argmin())], normal)
    )
    across /= np.linalg.norm(across)
    return Plane(origin, np.stack([across, np.cross(normal, across), normal]), noise, False)
