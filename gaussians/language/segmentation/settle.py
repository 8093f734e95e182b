"""Move the noisy points of a floor into its plane, so that what is decided afterwards does not depend on the noise.

A point belongs to the noisy layer of the floor if it lies within the layer and has the colour of the floor there.
Beneath the plane are only points of the floor; they tell its colour. Things that stand on the floor keep their shape
where their colour differs, however noisy the floor is; without noise nothing moves.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...cloud import GaussianCloud
from ...scene import Frame
from .ground import Ground, ground_of, layer
from .planes import level
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
LEAST_COLOR = 4.0  # Lab, standard deviation of one colour


def settled(surface: Surface, cloud: GaussianCloud, frame: Frame) -> Surface:
    """The surface with the noisy points of its floor in the floor's plane.

    Points that were too isolated for a surface, as the noise parts them, are added where they belong to the layer.

    Args:
        cloud: that the surface was taken from.
        frame: with the up direction.
    """
    flat = level(surface, frame)
    ground = ground_of(surface, flat) if len(surface) >= MIN_SURFACE else None
    if not isinstance(ground, Ground):
        return surface
    width = float(np.ptp(np.quantile(flat.points[:, :2], [0.01, 0.99], axis=0), axis=0).max())
    rows = np.union1d(surface.rows, solid_rows(cloud)) if len(surface) < MAX_POINTS else surface.rows
    points = cloud.means[torch.from_numpy(rows)].numpy()
    lab = base_lab(cloud[torch.from_numpy(rows)]).numpy() * np.array([LIGHTNESS, 1.0, 1.0], np.float32)
    places = points @ frame.basis().T
    on_surface = np.isin(rows, surface.rows)
    share, shift = np.zeros(len(rows)), np.zeros(len(rows))
    for at in ground.levels:
        off, noise, kept = ground.off(places) - at, ground.noise, on_surface
        for _ in range(ROUNDS):
            least = max(noise, CALM * surface.spacing)
            depth = DEPTH * width if at == min(ground.levels) else DEEP * least
            own = _in_layer(places, lab, off, kept, least, depth)
            kept = (own > 0.5) & (off > -4 * least)
            if kept.sum() < MIN_SURFACE:
                break
            height, noise = layer(off[kept], np.ones(int(kept.sum())), 0.0, width)
            off = off - height
            kept |= on_surface
        shift = np.where(own > share, off, shift)
        share = np.maximum(own, share)
    if not ((np.abs(shift) > CALM * surface.spacing) & (share > 0.5)).any():
        return surface
    kept = on_surface | (share > 0.5)
    up = (ground.normal @ frame.basis()).astype(np.float32)
    points = points - ((share * shift)[:, None] * up).astype(np.float32)
    sunk = (share > 0.5) & (shift < -CALM * surface.spacing)
    return surface_at(cloud, Known(rows[kept], points[kept], up, share[kept].astype(np.float32), sunk[kept]))


def _in_layer(places: F64, lab: F32, off: F64, kept: Mask, noise: float, depth: float) -> F64:
    """Probability `[M]` that each point is one of the floor's that its noise moved.

    Args:
        places: `[M, 3]` in the level frame.
        lab: `[M, 3]` colours, with lightness weighted.
        off: `[M]` distance from the plane.
        kept: `[M]` whether the point is used to learn the floor's colours.
        noise: standard deviation of the layer.
        depth: distance beneath the plane down to which all points are the floor's.
    """
    share = ((off < -DEEP * noise) & (off > -depth)).astype(np.float64)
    beneath = np.flatnonzero((off < -noise) & (off > -4 * noise) & kept)
    if len(beneath) < NEAREST + 1:
        return share
    sure = beneath[np.linspace(0, len(beneath) - 1, min(SURE, len(beneath))).astype(np.int64)]
    tree = cKDTree(places[sure, :2])
    own = _nearest_color(tree, places[sure, :2], lab[sure], lab[sure], 1)
    deviation = max(LEAST_COLOR, 1.5 * float(np.median(own)))
    within = np.flatnonzero((off >= -DEEP * noise) & (off < (LAYER + 2) * noise))
    gap = _nearest_color(tree, places[within, :2], lab[within], lab[sure], 0)
    beyond = np.maximum(off[within] / noise - LAYER, 0.0)
    share[within] = np.exp(-0.5 * ((gap / deviation) ** 2 + (beyond / 0.5) ** 2))
    return share


def _nearest_color(tree: cKDTree, places: F64, lab: F32, known: F32, skip: int) -> F64:
    """Least colour difference `[K]` between points and the known points nearest to them in plan, of which the first
    `skip` are left out."""
    near = tree.query(places, k=NEAREST + skip)[1][:, skip:]
    gap: F64 = np.linalg.norm(lab[:, None] - known[near], axis=2).min(axis=1).astype(np.float64)
    return gap
