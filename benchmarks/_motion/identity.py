"""Whether a thing stays itself: the Gaussians that a fit gives to it against those that show it (`belonging`).

Which Gaussians show a thing is told by its true masks: at the first time and at later ones, from the cameras of the
film, each Gaussian where the fit has it then. Each counts by its blending weight in those pictures. Edges of a thing
that is ten pixels wide do not count against it, as they do in the overlap of pixels: a Gaussian shows it or does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.motion.at import at
from ...gaussians.motion.fitting.seeds import weights
from ...gaussians.render import render
from ...gaussians.scene import Scene
from .films import Film, moving_things

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

TIMES = 4  # at which masks are looked at: the first, the last and some between, evenly
SHOWS = 0.5  # share of a Gaussian's blending weight within a thing's masks, from which it shows the thing
SEEN = 0.5  # pixels of blending weight, over all pictures of a time, below which a Gaussian is not seen then


@dataclass(frozen=True)
class Belonging:
    """How well the Gaussians of a fit follow the true things; means over things of intersection over union.

    Attributes:
        assigned: of those that the fit gives to the thing, by its best track, and those that show it by the masks of
            all times; weighted by their contribution to all pictures.
        kept: of those that show it at the first time and at a later one, a mean over later times; of those that are
            seen at both, weighted by the lesser contribution.
    """

    assigned: float
    kept: float


def belonging(scene: Scene, made: Film) -> Belonging:
    """Measure a fitted scene against the truth of its film."""
    truth = made.scene
    assert truth.motion is not None
    things = np.full(len(truth.cloud), -1, np.int32)
    each_ids = moving_things(truth.motion)
    for number, ids in enumerate(each_ids):
        things[np.isin(truth.cloud.ids.numpy(), ids)] = number
    marked = truth.replace(cloud=truth.cloud.replace(group=torch.from_numpy(things)), language=None)
    cameras = {frame.camera.name: frame.camera for frame in made.frames if frame.time == made.times[0]}
    chosen = made.times[np.unique(np.linspace(0, len(made.times) - 1, TIMES).astype(int))]
    count = len(each_ids)
    each = [_contributions(scene, marked, list(cameras.values()), float(t), count) for t in chosen]
    group = scene.cloud.group.numpy()
    found = [_of_thing(group, [(w[:, 0], w[:, 1 + k]) for w in each]) for k in range(count)]
    assigned, kept = np.mean(found, axis=0)
    return Belonging(float(assigned), float(kept))


def _contributions(scene: Scene, marked: Scene, cameras: list[Camera], time: float, things: int) -> F64:
    """`[N, 1 + things]` blending weight of each Gaussian of a fit at a time, pixels: in all, and within each thing."""
    cloud, true = at(scene, time).cloud, at(marked, time).cloud
    columns = tuple(
        np.ascontiguousarray(c.numpy(), np.float32)
        for c in (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)
    )
    total = np.zeros((len(cloud), 1 + things))
    for camera in cameras:
        seen = render(true, camera).group.numpy()
        masks = [np.ones_like(seen, bool), *(seen == k for k in range(things))]
        total += weights(columns, camera, masks)  # type: ignore[arg-type]
    return total


def _of_thing(group: NDArray[np.int32], each: list[tuple[F64, F64]]) -> tuple[float, float]:
    """`assigned` and `kept` of one thing, from each Gaussian's weights, in all and within the thing, at each time."""
    whole, within = (np.sum(w, axis=0) for w in zip(*each, strict=True))
    shows = within > SHOWS * whole
    assigned = max((_iou(group == k, shows, whole) for k in range(int(group.max(initial=-1)) + 1)), default=0.0)
    (first, first_within), *later = each
    kept = []
    for now, inside in later:
        both = np.minimum(first, now)
        shown = first_within > SHOWS * first, inside > SHOWS * now
        kept.append(_iou(*shown, both * (both > SEEN)))
    return assigned, float(np.mean(kept))


def _iou(a: Flags, b: Flags, weight: F64) -> float:
    """Weighted intersection over union; 0 where both are empty, since a thing that nothing shows is lost."""
    return float(weight[a & b].sum() / max(weight[a | b].sum(), 1e-9))
