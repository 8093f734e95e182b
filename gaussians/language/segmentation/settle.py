"""Move the noisy points of floor, walls and ceiling into their planes, so that the noise decides nothing afterwards.

A point belongs to the noisy layer of a plane if it lies within the layer and has the colour of the layer there.
Behind the plane are only points of the layer; they tell its colour. Things before it keep their shape where their
colour differs, however noisy it is; without noise nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...cloud import GaussianCloud
from ...scene import Frame
from .ground import Ground, ground_of, layer
from .planes import CEILING, FLOOR, KINDS, NONE, UP, WALL, Level, extent_of, level, outer_layers
from .superpoints import LIGHTNESS
from .surface import F32, MAX_POINTS, Known, Surface, base_lab, solid_rows, surface_at

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

MIN_SURFACE = 200  # points; smaller surfaces have no floor
ROUNDS = 5  # the layer tells which points are its own, and these tell its noise
CALM = 0.02  # of the spacing: noise that changes nothing
DEEP = 2.5  # standard deviations beneath the plane: nothing but the floor is this deep
LAYER = 2.0  # standard deviations of the noise within which a point surely lies in the layer
DEPTH = 0.05  # of the scene's width: points this far beneath the floor are its own, as are those of its underside
SURE = 4000  # points of the floor that show its colours
NEAREST = 12  # of them that a point's colour is compared with
NOISY = 0.25  # of the spacing: noise of the floor from which walls are searched by positions alone
LEAST_COLOR = 4.0  # Lab, standard deviation of one colour


@dataclass(frozen=True)
class _Layer:
    """One noisy plane of the structure in the level frame: `normal @ point = offset`, the room on the positive side.

    Attributes:
        normal: `[3]` unit, into the room.
        noise: standard deviation of its points, scene units.
        depth: distance behind it down to which all points are its own.
        code: its structure code.
    """

    normal: F64
    offset: float
    noise: float
    depth: float
    code: int


def settled(surface: Surface, cloud: GaussianCloud, frame: Frame) -> Surface:
    """The surface with the noisy points of its floor, and where it is noisy of its walls and ceiling, in their planes.

    Points that were too isolated for a surface, as the noise parts them, are added where they belong to a layer.

    Args:
        cloud: that the surface was taken from.
        frame: with the up direction.
    """
    flat = level(surface, frame)
    ground = ground_of(surface, flat) if len(surface) >= MIN_SURFACE else None
    if not isinstance(ground, Ground):
        return surface
    rows = np.union1d(surface.rows, solid_rows(cloud)) if len(surface) < MAX_POINTS else surface.rows
    points = cloud.means[torch.from_numpy(rows)].numpy()
    lab = base_lab(cloud[torch.from_numpy(rows)]).numpy() * np.array([LIGHTNESS, 1.0, 1.0], np.float32)
    places = points @ frame.basis().T
    on_surface = np.isin(rows, surface.rows)
    share, shift, normals = np.zeros(len(rows)), np.zeros(len(rows)), np.tile(UP, (len(rows), 1))
    known = np.zeros(len(rows), np.int8)
    calm = CALM * surface.spacing
    noisy = ground.noise > NOISY * surface.spacing
    for one in _layers(surface, flat, ground, noisy):
        own, off = _points_of_layer(places, lab, on_surface, one, calm)
        better = own > share
        share, shift = np.where(better, own, share), np.where(better, off, shift)
        normals[better] = one.normal
        sure = (own > 0.5) & ((off < -calm) | noisy)
        known[better] = np.where(sure, one.code, NONE)[better]
    if not ((np.abs(shift) > calm) & (share > 0.5)).any():
        return surface
    kept = on_surface | (share > 0.5)
    toward = (normals @ frame.basis()).astype(np.float32)
    points = points - (share * shift)[:, None].astype(np.float32) * toward
    trust = share[kept].astype(np.float32)
    return surface_at(cloud, Known(rows[kept], points[kept], toward[kept], trust, known[kept]))


def _layers(surface: Surface, flat: Level, ground: Ground, noisy: bool) -> list[_Layer]:
    """The floor's levels; where the floor is noisy, so that normals tell little, also the walls and the ceiling."""
    width = float(extent_of(flat)[:2].max())
    lowest = min(ground.levels)
    normal = ground.normal
    base = float(ground.slope[0] * normal[2])
    layers = [
        _Layer(normal, base + at, ground.noise, DEPTH * width if at == lowest else DEEP * ground.noise, FLOOR)
        for at in ground.levels
    ]
    if noisy:
        found = outer_layers(flat, surface.area, surface.spacing, ground.noise, layer)
        for number, (normal, offset, noise) in enumerate(found):
            code = CEILING if normal[2] < -0.5 else WALL + KINDS * (number + 1)
            layers.append(_Layer(normal, offset, noise, DEPTH * width, code))
    return layers


def _points_of_layer(places: F64, lab: F32, kept: Mask, one: _Layer, calm: float) -> tuple[F64, F64]:
    """Probability `[M]` that each point belongs to a layer, and its distance from the layer's middle `[M]`."""
    off, noise, on_surface = places @ one.normal - one.offset, one.noise, kept
    axes = np.linalg.svd(one.normal[None])[2][1:]
    along, own = places @ axes.T, np.zeros(len(places))
    for _ in range(ROUNDS):
        least = max(noise, calm)
        own = _in_layer(along, lab, off, kept, least, max(one.depth, DEEP * least))
        kept = (own > 0.5) & (off > -4 * least)
        if kept.sum() < MIN_SURFACE:
            break
        height, noise = layer(off[kept], np.ones(int(kept.sum())), 0.0, float(np.ptp(along, axis=0).max()))
        off = off - height
        kept = kept | on_surface
    return own, off


def _in_layer(along: F64, lab: F32, off: F64, kept: Mask, noise: float, depth: float) -> F64:
    """Probability `[M]` that each point is one of the layer's that its noise moved.

    Args:
        along: `[M, 2]` places in the plane.
        lab: `[M, 3]` colours, with lightness weighted.
        off: `[M]` distance from the plane.
        kept: `[M]` whether the point is used to learn the layer's colours.
        noise: standard deviation of the layer.
        depth: distance beneath the plane down to which all points are the layer's.
    """
    share = ((off < -DEEP * noise) & (off > -depth)).astype(np.float64)
    beneath = np.flatnonzero((off < -noise) & (off > -4 * noise) & kept)
    if len(beneath) < NEAREST + 1:
        return share
    sure = beneath[np.linspace(0, len(beneath) - 1, min(SURE, len(beneath))).astype(np.int64)]
    tree = cKDTree(along[sure])
    own = _nearest_color(tree, along[sure], lab[sure], lab[sure], 1)
    deviation = max(LEAST_COLOR, 1.5 * float(np.median(own)))
    within = np.flatnonzero((off >= -DEEP * noise) & (off < (LAYER + 2) * noise))
    gap = _nearest_color(tree, along[within], lab[within], lab[sure], 0)
    beyond = np.maximum(off[within] / noise - LAYER, 0.0)
    share[within] = np.exp(-0.5 * ((gap / deviation) ** 2 + (beyond / 0.5) ** 2))
    return share


def _nearest_color(tree: cKDTree, places: F64, lab: F32, known: F32, skip: int) -> F64:
    """Least colour difference `[K]` between points and the known points nearest to them in plan, of which the first
    `skip` are left out."""
    near = tree.query(places, k=NEAREST + skip)[1][:, skip:]
    gap: F64 = np.linalg.norm(lab[:, None] - known[near], axis=2).min(axis=1).astype(np.float64)
    return gap
