"""Which Gaussians of a fill stand before what views of the scene see past the thing that is gone.

A fill is guessed from some views; from others its place is not hidden, and what they show there is known: the scene
before, where the thing does not reach. Gaussians that make these pictures worse are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render, split
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ..cloud_diff import joined
from ..filling.fill import Patch, merged
from .behind import HIDES, differing
from .target import F32, box_around, part_of, shares

VIEWS, SIDE = 12, 200  # views that are asked, and pixels along their longer side
SEEN_PAST = "what other views see there is farther away"
_INSIDE = 0.25  # of the new Gaussians that a view must show
_PAD = 4  # px around them
_SHOWS = 0.02  # blending weight of the new ones from which they matter to a pixel
_WORSE = 0.02  # mean difference, display space, by which a Gaussian makes what is known worse
_LEAST = 0.5  # pixels in which it is known
_KNOWN = 0.5  # alpha of the scene before from which a pixel is known
_FAINT = 0.1  # alpha below which a colour is not told
_HIDDEN = 0.3  # blending weight of the thing from which it hid a pixel
_RATIO = 0.1  # of the pixels in which a Gaussian fills a hole: where it is known in fewer, it stays
_LEVELS = 100  # of a difference of one


def without_those_before(before: Scene, after: Scene, patches: Sequence[Patch]) -> list[Patch]:
    """The patches without the Gaussians that stand before what other views see; a patch that loses all says why.

    Args:
        before: the scene before the edit, with its cameras; without any, all stay.
        after: after it, without the patches.
    """
    new = merged(after, patches, int(before.cloud.ids.max()) if len(before.cloud) else -1)
    if not len(new) or not before.cameras:
        return list(patches)
    worse = mask_of_ids(new.ids, seen_past(before.cloud, joined(after.cloud, None, [new]), new.ids, before.cameras))
    kept, first = list[Patch](), 0
    for patch in patches:
        mine = worse[first : first + len(patch.cloud)]
        first += len(patch.cloud)
        if bool(mine.any()):
            rest = patch.cloud[~mine]
            patch = replace(patch, cloud=rest, reason="" if len(rest) else SEEN_PAST)
        kept.append(patch)
    return kept


def seen_past(before: GaussianCloud, after: GaussianCloud, new: Tensor, cameras: Sequence[Camera]) -> Tensor:
    """`[K]`, ids of the new Gaussians that make what is known worse.

    Args:
        after: with the new Gaussians.
        new: `[M]`, their ids.
    """
    own = mask_of_ids(after.ids, new)
    gone, other = differing(before, after)
    rest, other = after[~own], other & ~own
    worse, known, fills = (np.zeros(len(after)) for _ in range(3))
    for camera in _views(cameras, after.means[own]):
        now = shares(after, (own, other), camera)
        thing = shares(before, (gone,), camera)[..., 0]
        want, alpha = _picture(before, camera)
        # A pixel that shows nothing before is not known: it may be a hole of the scene itself.
        seen = (now[..., 0] > _SHOWS) & (now[..., 1] < HIDES) & (thing < HIDES) & (alpha > _KNOWN)
        off = _off(after, camera, want) - _off(rest, camera, want)
        level = np.clip(np.round(off * _LEVELS), -_LEVELS, _LEVELS).astype(np.int32) + _LEVELS + 2
        labels = np.where(seen, level, np.where(thing > _HIDDEN, 1, 0)).astype(np.int32)
        found = split(after, camera, labels)
        asked, hid = found.labels >= 2, found.labels == 1
        weight, by = found.weights.astype(np.float64), (found.labels - _LEVELS - 2) / _LEVELS
        np.add.at(worse, found.rows[asked], (weight * by)[asked])
        np.add.at(known, found.rows[asked], weight[asked])
        np.add.at(fills, found.rows[hid], weight[hid])
    out = (known > _LEAST) & (worse > _WORSE * known) & (known > _RATIO * fills)
    return after.ids[torch.from_numpy(out).to(own.device) & own]


def _views(cameras: Sequence[Camera], means: Tensor) -> list[Camera]:
    """Views that show a good part of some points, evenly chosen and cut to them."""
    points = means.to(torch.float64).cpu().numpy()
    found = list[Camera]()
    for camera in cameras:
        gain = min(1.0, SIDE / max(camera.width, camera.height))
        small = camera.resized(max(1, round(gain * camera.width)), max(1, round(gain * camera.height)))
        if small.contains(*small.project(points)).mean() >= _INSIDE and (box := box_around(small, means, _PAD)):
            found.append(part_of(small, box))
    chosen = np.linspace(0, len(found) - 1, min(VIEWS, len(found))).round().astype(int)
    return [found[i] for i in dict.fromkeys(chosen.tolist())]


def _picture(cloud: GaussianCloud, camera: Camera) -> tuple[F32, F32]:
    """Colours `[H, W, 3]` as they were over the whole of each pixel, and alpha `[H, W]`."""
    shot = render(cloud, camera)
    alpha: F32 = shot.alpha.cpu().numpy()
    rgb = shot.rgb.cpu().numpy() / np.maximum(alpha, _FAINT)[..., None]
    return np.clip(rgb, 0, 1).astype(np.float32), alpha


def _off(cloud: GaussianCloud, camera: Camera, want: F32) -> F32:
    """`[H, W]`, by how much a picture differs from the one that is wanted."""
    return np.asarray(np.abs(_picture(cloud, camera)[0] - want).mean(axis=2))
