"""The scene at its start: Gaussians trained on the first frame of every camera (`trainer`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...camera import Camera
from ...cloud import GaussianCloud
from ...errors import UserError
from ...fit.fitting import Settings
from ...fit.initialize import initial_cloud
from ...fit.parameters import Parameters
from ...fit.photographs.photos import Photos
from ...fit.train import Schedule, Shot, Trainer
from ...harmonics import color_to_dc
from .budget import START_UNTIL, Budget
from .carving import Carving, Sight
from .covering import uncovered
from .footage import Footage
from .sketch import covering, reduced
from .stereo import Points, neighbours, points_of

I64 = NDArray[np.int64]

SPACING = 2.0  # pixels, at the distance of the cameras' radius, between two points that are confirmed
FINER = 0.5  # of that, where something may move
LONG = 0.25  # share of the times at which a pixel is of another colour, from which something may have gone from there
PIXELS = 12  # pixels of the first frames for each Gaussian
CONFIRMED = 0.85  # share of the Gaussians at points that are confirmed; the others cover what these leave bare
PICTURES = 8  # of fewer pictures, only what is confirmed: too few see what is wrong
BLOCKS = range(4, 13)  # pixels, side of the blocks that are covered: the first that keeps within the number
WIDEST = 0.07  # of the cameras' radius: a standard deviation
OPACITY = 0.6
PASSES = 150  # over the first frames at most: more fits a few pictures by what no other picture sees
ROOM = 1.1  # times the number of points: greatest number of Gaussians


def start_points(
    shots: Sequence[Shot], radius: float, most: int, rng: np.random.Generator,
    changing: Sequence[NDArray[np.bool_]] = (), pixels: int | None = None,
) -> GaussianCloud:  # fmt: skip
    """Gaussians at points whose depth pictures agree on, the best confirmed first; wide ones at what these leave bare.

    Args:
        shots: of many, the depth of some is searched that cover the film, beside the others.
        most: Gaussians.
        changing: `[H, W]` of each picture, where its colour is another one at later times: there may be something that
            moves, whose points are nearer to each other and come first.
        pixels: to which pictures are reduced; None: they are not.

    Raises:
        UserError: pictures agree on the depth of fewer than two points.
    """
    every = [s.camera for s in shots]
    chosen = covering(every)
    asked = {k for i in chosen for k in neighbours(int(i), every, radius)} - set(chosen.tolist())
    small, beside = (
        [shots[k] if pixels is None else reduced(shots[k], pixels) for k in some] for some in (chosen, sorted(asked))
    )
    changing = [_sampled(changing[k], shot.camera) for k, shot in zip(chosen, small, strict=True)] if changing else []
    cameras = [s.camera for s in small]
    others = [s.camera for s in beside], [s.colors for s in beside]
    found = points_of(cameras, [s.colors for s in small], radius, others)
    budget = min(most, len(found.means) // PIXELS)
    spacing = SPACING * radius / cameras[0].fx
    share = CONFIRMED if len(small) >= PICTURES else 1.0
    moves = np.concatenate([c.reshape(-1) for c in changing]) if changing else np.zeros(len(found.means), bool)
    best = _confirmed(found, spacing, moves, rng)[: round(share * budget)]
    more, block = best[:0], 0
    if share < 1:
        for block in BLOCKS:
            more = uncovered(found, cameras, best, spacing, block)
            if len(best) + len(more) <= budget:
                break
    rows = np.concatenate([best, more])[:budget]
    if len(best) < 2:  # no distance to another one tells their size
        raise UserError(
            "the first frames of the film agree on no depths: check the poses, let the views of the cameras overlap, "
            "or give surveyed points"
        )
    widths = np.r_[np.full(len(best), WIDEST * radius), block * found.sizes[rows[len(best) :]]]
    return at_points(found, rows, widths, radius)


def at_points(found: Points, rows: I64, widths: NDArray[np.float64], radius: float) -> GaussianCloud:
    """A Gaussian at each of some points, as wide as the distance to the next ones and at most so wide.

    Args:
        rows: of two points or more.
        widths: `[n]` greatest standard deviations, scene units.
    """
    means = found.means[rows]
    away, _ = cKDTree(means).query(means, k=min(4, len(means)))
    sizes = np.clip(0.7 * np.sqrt((away[:, 1:] ** 2).mean(axis=1)), 1e-6 * radius, widths)
    count = len(means)
    return GaussianCloud.create(
        torch.from_numpy(means).float(), torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(count, 1),
        torch.from_numpy(np.repeat(sizes[:, None], 3, axis=1)).float(), torch.full((count,), OPACITY),
        color_to_dc(torch.from_numpy(found.colors[rows]).float())[:, None],
    )  # fmt: skip


def _confirmed(found: Points, spacing: float, moves: NDArray[np.bool_], rng: np.random.Generator) -> I64:
    """Rows of confirmed points, one in each cell of a grid (scene units): those that may move, in finer cells, before
    the others, and of these the best confirmed first."""
    order = rng.permutation(len(found.means))
    order = order[np.lexsort((-np.minimum(found.agreed[order], 4), ~moves[order]))]
    order = order[(found.agreed >= np.maximum(found.denied, 1))[order]]
    cells = np.floor(found.means[order] / np.where(moves[order], FINER * spacing, spacing)[:, None]).astype(np.int64)
    _, first = np.unique(np.c_[cells, moves[order]], axis=0, return_index=True)
    return order[np.sort(first)]


def start_cloud(
    shots: Sequence[Shot], photos: Photos, most: int, rng: np.random.Generator, pixels: int,
    changing: Sequence[NDArray[np.bool_]] = (),
) -> GaussianCloud:  # fmt: skip
    """Gaussians at surveyed points where the capture has them, else at those of the pictures' own stereo.

    Args:
        pixels: greatest number of each picture whose depth is searched.
    """
    if len(photos.points.means):
        return initial_cloud(photos, most, rng)
    return start_points(shots, photos.extent, most, rng, changing, pixels)


def _sampled(mask: NDArray[np.bool_], camera: Camera) -> NDArray[np.bool_]:
    """A mask `[H, W]` at the size of a camera, by the nearest pixels."""
    rows, columns = (
        ((np.arange(count) + 0.5) * of / count).astype(int)
        for count, of in zip((camera.height, camera.width), mask.shape, strict=True)
    )
    return mask[rows[:, None], columns]


def trainer(
    footage: Footage, cloud: GaussianCloud, extent: float, settings: Settings, sight: Sight, rng: np.random.Generator,
    budget: Budget,
) -> Trainer:  # fmt: skip
    """A training of Gaussians on the first frames.

    Args:
        extent: radius of the cameras, scene units.
        sight: how far the first frames see.
        budget: of which it takes its share, if the fit is not measured in steps.
    """
    shots, most = [footage.shots[i] for i in footage.first], settings.max_gaussians
    steps = PASSES * len(shots)
    if settings.steps is not None:
        steps = min(steps, max(1, round(START_UNTIL * settings.steps)))
    schedule = Schedule(steps, budget.left(START_UNTIL), settings.coarse)
    strategy = Carving(min(most, int(ROOM * len(cloud)) + 1), rng, sight=sight)
    return Trainer(shots, Parameters.of(cloud), strategy, extent, schedule, rng)


def changing(footage: Footage) -> list[NDArray[np.bool_]]:
    """`[H, W]` of each camera, the pixels whose colour is not that of the first time for long."""
    found = []
    for c, first in enumerate(footage.first):
        own = [i for i in np.flatnonzero(footage.who == c) if i != first]
        if not len(own):  # a camera with a frame of the first time alone
            found.append(np.zeros(footage.shots[first].photo.shape[:2], bool))
            continue
        often = np.sum([footage.changed(int(i), int(first)) for i in own], axis=0)
        found.append(np.asarray(often >= LONG * len(own), dtype=bool))
    return found
