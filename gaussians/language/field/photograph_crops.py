"""Image vectors of groups from photographs: each group is cut out of the few photographs that show it best.

The cut follows the rendered silhouette of the group with occlusion by the rest of the scene, over neutral grey, framed
as renders of groups are, so that the same encoder serves both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from ...files.captures.capture import Capture
from ...render import render
from ...scene import Scene
from ...viewpoints.pictures import Picture, choose_photographs, read_photographs
from ..encoders import Encoder, cache, uses_background
from ..encoders.framing import crop

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

SIDE = 512  # pixels of the longer side of the photographs
COUNT = 32  # photographs
BEST = 4  # crops for each group
MIN_PIXELS = 150  # of a group in a photograph
SPECK = 0.1  # of the largest connected piece of a silhouette: smaller pieces are dropped
SOFT = 1.2  # pixels by which the rim of a silhouette is softened, as that of a render is
APART = 20.0  # degrees between the directions from which two crops of a group are taken, where there are enough
CUT_OFF = 0.3  # what a group at the border of a photograph is worth, of one that lies inside


@dataclass(frozen=True, eq=False)
class Crops:
    """What photographs say of G groups.

    Attributes:
        vectors: `[G, D]` float32, unit mean image vectors; zero rows for groups that no photograph shows well.
        pixels: `[G]` int64, pixels of each group in its best photograph.
        photographs: number of photographs that were searched.
    """

    vectors: F32
    pixels: NDArray[np.int64]
    photographs: int


@dataclass(frozen=True, eq=False)
class _Cut:
    """A crop of one group.

    Attributes:
        worth: decides which crops are kept.
        pixels: of the group in the photograph.
        direction: `[3]`, unit, world, in which the camera looks.
        images: for the encoder.
    """

    worth: float
    pixels: int
    direction: NDArray[np.float64]
    images: list[NDArray[np.uint8]]


def crops_of(
    scene: Scene, owner: I32, capture: Capture, encoder: Encoder, progress: Callable[[float], None] = lambda share: None
) -> Crops:
    """The vectors of groups from the photographs of a capture.

    Args:
        scene: its `cloud.group` is not used.
        owner: `[N]` int32, the group 0 … G - 1 of each Gaussian, -1 for none; parts count to their object.

    Raises:
        FileError: a photograph cannot be read.
        UserError: the photographs do not show the scene.
    """
    count = int(owner.max(initial=-1)) + 1
    best: list[list[_Cut]] = [[] for _ in range(count)]
    chosen = choose_photographs(scene, capture, COUNT) if encoder.image_size else ()
    cloud = scene.cloud.replace(group=torch.from_numpy(owner.astype(np.int32)), sh=scene.cloud.sh[:, :1].contiguous())
    for i, picture in enumerate(read_photographs(capture, chosen, SIDE)):
        seen = render(cloud, picture.camera)
        group = np.where(seen.alpha.numpy() > 0.5, seen.group.numpy(), -1)
        for g, cut in _cuts(picture, group, count, encoder).items():
            best[g] = _best([*best[g], cut])
        progress((i + 1) / len(chosen))
    vectors = np.zeros((count, encoder.dim), np.float32)
    images = [(g, cut.worth, image) for g in range(count) for cut in best[g] for image in cut.images]
    if images:
        found = cache.images(encoder, np.stack([image for _, _, image in images]))
        weight = np.sqrt([worth for _, worth, _ in images]).astype(np.float32)
        np.add.at(vectors, [g for g, _, _ in images], found * weight[:, None])
    norms = np.linalg.norm(vectors, axis=1, keepdims=True)
    units = (vectors / np.where(norms > 1e-8, norms, 1)).astype(np.float32)
    pixels = np.array([max((c.pixels for c in cuts), default=0) for cuts in best], np.int64)
    return Crops(units, pixels, len(chosen))


def _best(cuts: list[_Cut]) -> list[_Cut]:
    """At most BEST crops, the worthiest first; those from nearly one direction only where there are no others."""
    kept: list[_Cut] = []
    spare: list[_Cut] = []
    for cut in sorted(cuts, key=lambda c: -c.worth):  # stable: the earlier of two equal ones comes first
        near = any(float(cut.direction @ other.direction) > np.cos(np.radians(APART)) for other in kept)
        (spare if near else kept).append(cut)
    return [*kept, *spare][:BEST]


def _cuts(picture: Picture, group: I32, count: int, encoder: Encoder) -> dict[int, _Cut]:
    """The crops of all groups that a photograph shows with at least MIN_PIXELS pixels."""
    total = np.bincount(group[group >= 0], minlength=count)
    edge = np.concatenate([group[0], group[-1], group[1:-1, 0], group[1:-1, -1]])
    cut_off = np.bincount(edge[edge >= 0], minlength=count) > 2
    rgb = torch.from_numpy(picture.rgb.astype(np.float32) / 255)
    found = {}
    for g in np.flatnonzero(total >= MIN_PIXELS).tolist():
        mask = torch.from_numpy(_silhouette(group == g))
        images = [crop(rgb * mask[..., None], mask, encoder.image_size)]
        if uses_background(encoder):
            images.append(crop(rgb, torch.ones_like(mask), encoder.image_size, outline=mask))
        worth = float(total[g]) * (CUT_OFF if cut_off[g] else 1.0)
        shown = [image for image in images if image is not None]
        found[g] = _Cut(worth, int(total[g]), picture.camera.forward, shown)
    return found


def _silhouette(mask: NDArray[np.bool_]) -> F32:
    """A mask `[H, W]` without specks, with a soft rim, in [0, 1]."""
    pieces, number = ndimage.label(mask)
    if number > 1:
        size = np.bincount(pieces.ravel())
        size[0] = 0
        mask = (size >= SPECK * size.max())[pieces]
    soft: F32 = ndimage.gaussian_filter(mask.astype(np.float32), SOFT)
    return soft
