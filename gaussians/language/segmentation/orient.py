"""Estimate the up direction and the height of the floor of a cloud whose file states neither.

The up direction comes from the surface points and, if there are any, the cameras. Results are marked "estimated".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...scene import Frame
from .surface import Surface

F64 = NDArray[np.float64]

# Common up axes and their weights: captures have the first camera's down along +y (COLMAP), other files use z or y up.
COMMON_UPS = ((np.array([0.0, -1.0, 0.0]), 1.0), (np.array([0.0, 0.0, 1.0]), 0.7), (np.array([0.0, 1.0, 0.0]), 0.4))
AXIS_REACH = 12.0  # degrees within which a common axis supports a direction
AXIS_BONUS = 0.35  # of the strongest layering
TOP_REACH = 50.0  # degrees between up and the mean of the cameras' up vectors: cameras look down
ROLL_REACH = 10.0  # degrees of camera roll
CANDIDATES = 8  # directions that are refined
SEPARATION = 6.0  # degrees between them
MIN_SURFACE = 50  # surface points needed for an estimate
GROUND_ASPECT = 2.5  # a floor plan is at most this many times as long as it is wide
DIRECTIONS = 2500
SAMPLES = 12_000
BINS = 300
FLOOR_SHARE = 0.2  # the floor is the lowest level surface with at least this share of the largest one's area


def estimate_frame(surface: Surface, cameras: Sequence[Camera], known: Frame) -> Frame:
    """`known` with a missing up direction and floor height estimated: up from the cameras or the level surfaces."""
    frame = known
    if known.up_source == "unknown":
        up = _up_from_cameras(surface, cameras) if cameras else _up_from_surfaces(surface)
        frame = replace(frame, up=(float(up[0]), float(up[1]), float(up[2])), up_source="estimated")
    if frame.floor is None:
        frame = replace(frame, floor=_floor(surface, frame.up_vector))
    return frame


def _up_from_cameras(surface: Surface, cameras: Sequence[Camera]) -> F64:
    """The most layered direction that agrees with the cameras: near their mean up vector, and level right vectors. The
    mean up vector alone leans forward where all cameras look down on the scene from one side."""
    mean = -np.mean([c.world_to_camera[1, :3] for c in cameras], axis=0)
    mean /= max(float(np.linalg.norm(mean)), 1e-12)
    around = np.concatenate([mean[None], _directions()])
    roll = np.sqrt(np.mean((around @ np.stack([c.right for c in cameras]).T) ** 2, axis=1))
    upward = around @ mean > np.cos(np.radians(TOP_REACH))
    level = roll < roll[upward].min(initial=1.0) + np.sin(np.radians(ROLL_REACH))
    if len(surface) < MIN_SURFACE or not (upward & level).any():
        return mean if mean.any() else COMMON_UPS[0][0]
    lines, layering = _most_layered(surface, around[upward & level])
    return lines[int(np.argmax(layering))]


def _up_from_surfaces(surface: Surface) -> F64:
    """The direction along which the scene is most layered; common up axes get a bonus and decide the sign."""
    if len(surface) < MIN_SURFACE:
        return COMMON_UPS[0][0]
    lines, layering = _most_layered(surface, _directions()[:DIRECTIONS])
    bonus = np.max([w * (np.abs(lines @ a) > np.cos(np.radians(AXIS_REACH))) for a, w in COMMON_UPS], axis=0)
    line = lines[int(np.argmax(layering / max(float(layering.max()), 1e-12) + AXIS_BONUS * bonus))]
    if not _is_ground_like(surface, line):
        return COMMON_UPS[0][0]
    return max((line, -line), key=lambda up: max(w * float(up @ a) for a, w in COMMON_UPS))


def _most_layered(surface: Surface, directions: F64) -> tuple[F64, F64]:
    """The most layered of some directions `[L, 3]`, SEPARATION apart and refined, and their layering `[L]`.

    Two degrees off the true up a floor loses most of its layering, by an amount that varies by chance, so unrefined
    directions cannot be compared.
    """
    layering = _layering(surface, directions)
    lines: list[F64] = []
    while len(lines) < CANDIDATES and layering.max() > 0:
        best = directions[int(np.argmax(layering))]
        lines.append(_refine(surface, best))
        layering = np.where(np.abs(directions @ best) > np.cos(np.radians(SEPARATION)), 0.0, layering)
    found = np.stack(lines) if lines else directions[:1]
    return found, _layering(surface, found)


def _is_ground_like(surface: Surface, up: F64) -> bool:
    """Whether the plan across `up` is broad: a tall object alone (a guitar, a statue) is layered along its front."""
    side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    side /= np.linalg.norm(side)
    across = surface.points @ np.stack([side, np.cross(up, side)], axis=1)
    axes = np.linalg.eigh(np.cov(across.T))[1]
    extents = np.ptp(np.quantile(across @ axes, [0.05, 0.95], axis=0), axis=0)
    return bool(extents.max() < GROUND_ASPECT * max(float(extents.min()), 1e-12))


def _directions() -> F64:
    """Unit vectors `[2 * DIRECTIONS, 3]` on a Fibonacci lattice: the hemisphere around +z, then their opposites."""
    i = np.arange(DIRECTIONS)
    z = (i + 0.5) / DIRECTIONS
    angle = i * np.pi * (3 - np.sqrt(5))
    r = np.sqrt(1 - z**2)
    half = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
    return np.concatenate([half, -half])


def _layering(surface: Surface, directions: F64) -> F64:
    """How much the area concentrates in thin layers along each direction `[D]`: the sum of squared histogram shares.

    Level surfaces (floor, table tops, seats, ceiling) form layers along the true up. Positions show this far more
    clearly than the normals of trained Gaussians.
    """
    step = max(1, len(surface) // SAMPLES)
    points = surface.points[::step].astype(np.float64)
    area = surface.area[::step].astype(np.float64)
    area = np.minimum(area, np.quantile(area, 0.9)) / max(float(area.sum()), 1e-20)  # very large ones count less
    points = points - np.median(points, axis=0)
    reach = 3 * float(np.median(np.linalg.norm(points, axis=1))) + 1e-12
    layers = []
    for direction in directions:
        share = np.histogram(points @ direction, BINS, range=(-reach, reach), weights=area)[0]
        layers.append(float((share**2).sum()))
    return np.array(layers)


def _refine(surface: Surface, up: F64) -> F64:
    """The most layered direction near `up`, searched on rings that shrink from 3 to 0.2 degrees."""
    for radius in (3.0, 1.2, 0.5, 0.2):
        side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
        side /= np.linalg.norm(side)
        other = np.cross(up, side)
        angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        ring = up + np.tan(np.radians(radius)) * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * other)
        ring = np.concatenate([up[None], ring / np.linalg.norm(ring, axis=1, keepdims=True)])
        up = ring[int(np.argmax(_layering(surface, ring)))]
    return up


def _floor(surface: Surface, up: F64) -> float | None:
    """Height of the lowest large level surface along up, None where nothing is level."""
    level = np.abs(surface.normals @ up) > 0.85
    if level.sum() < MIN_SURFACE:
        return None
    heights, area = surface.points[level] @ up, surface.area[level] * surface.flatness[level]
    low, high = np.quantile(heights, [0.002, 0.998])
    bins = np.linspace(low, high + 1e-9, 101)
    histogram = np.histogram(heights, bins, weights=area)[0]
    spread = np.convolve(histogram, np.ones(3), mode="same")
    lowest = int(np.argmax(spread >= FLOOR_SHARE * spread.max()))
    window = (heights >= bins[max(lowest - 1, 0)]) & (heights <= bins[min(lowest + 3, 100)])
    return float(np.median(heights[window]))
