"""Which photographs of a capture see behind a thing that is gone, and in which of their pixels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from scipy import ndimage
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.files.captures.capture import Capture
from ...gaussians.render import render
from ...gaussians.rows import mask_of_ids, rows_of_ids
from ...gaussians.viewpoints.pictures import present, read_photographs
from ..filling.new_rows import is_fill
from .target import Box, Mask, Target, box_around, part_of, shares

SIDE = 400  # px, longer side of the photographs
LOOKED = 120  # photographs that are looked at
MOST = 32  # photographs that are used, those that see most
_INSIDE = 0.25  # of the new Gaussians that a photograph must show
_PAD = 8  # px around them
HIDES = 0.02  # blending weight from which a Gaussian counts in a pixel
_SHOWS = 0.1  # likewise of the new ones
_MARGIN = 2  # px around what is not as photographed: outlines are soft
_FEWEST = 24  # pixels that a photograph must see behind
_UNLIKE = 0.15  # mean difference from the scene as photographed, display space, of a photograph that is not of it
_RING = 100  # px from which that is told


@dataclass(frozen=True, eq=False)
class Photographs:
    """The photographs of a scene.

    Attributes:
        capture: photographs and cameras.
        cloud: the Gaussians that were fitted to them, before any edit.
    """

    capture: Capture
    cloud: GaussianCloud

    @cached_property
    def fills(self) -> Tensor:
        """`[N]` bool: Gaussians of a fill that an earlier edit made; no photograph shows them."""
        return is_fill(self.cloud, torch.arange(len(self.cloud), device=self.cloud.device))


@dataclass(frozen=True, eq=False)
class Behind:
    """What photographs show of what an edit revealed.

    Attributes:
        targets: the photographs that see behind, each cut to the place.
        looked: photographs that show the place, whether or not they see behind.
        unlike: those that were left out because they are not of this scene as it was.
    """

    targets: tuple[Target, ...]
    looked: int
    unlike: int

    @property
    def pixels(self) -> int:
        """In which they see behind, of all of them."""
        return sum(int(target.counts.sum()) for target in self.targets)


def seen_behind(photographs: Photographs, after: GaussianCloud, new: Tensor) -> Behind:
    """The pixels in which photographs show new Gaussians' places, and nothing that is not there any more.

    Args:
        after: the Gaussians after the edit and its fill.
        new: `[M]`, ids of the fill's Gaussians.

    Raises:
        FileError: a photograph cannot be read.
    """
    own = mask_of_ids(after.ids, new)
    changed_before, changed_after = differing(photographs.cloud, after)
    marked = Marked(photographs.cloud, changed_before | photographs.fills, after, changed_after & ~own, own)
    places = _places(photographs.capture, after.means[own])
    seen = {index: marked.seen(part_of(*place)) for index, place in places.items()}
    best = sorted((i for i in seen if seen[i].sum() >= _FEWEST), key=lambda i: (-int(seen[i].sum()), i))[:MOST]
    targets, unlike = list[Target](), 0
    for index in sorted(best):
        camera, (left, top, right, bottom) = places[index]
        photo = next(read_photographs(photographs.capture, (index,), SIDE)).rgb
        rgb = np.ascontiguousarray(photo[top:bottom, left:right]).astype(np.float32) / np.float32(255)
        target = Target(part_of(camera, (left, top, right, bottom)), rgb, seen[index])
        if marked.is_of(target):
            targets.append(target)
        else:
            unlike += 1
    return Behind(tuple(targets), len(places), unlike)


def differing(before: GaussianCloud, after: GaussianCloud) -> tuple[Tensor, Tensor]:
    """`[N]` and `[M]` bool: the Gaussians of each cloud that the other does not have bit for bit."""
    a, b = rows_of_ids(before.ids, after.ids), rows_of_ids(after.ids, before.ids)
    out_a = torch.ones(len(before), dtype=torch.bool, device=before.device)
    out_b = torch.ones(len(after), dtype=torch.bool, device=after.device)
    if not bool((before.ids[a] == after.ids[b]).all()):  # in another order: sort both
        a, b = a[before.ids[a].argsort()], b[after.ids[b].argsort()]
    same = torch.ones(len(a), dtype=torch.bool, device=before.device)
    for name in ("means", "quats", "scales", "opacities", "sh"):
        x, y = getattr(before, name), getattr(after, name)
        if x is y and len(a) == len(x):
            continue
        if x.shape[1:] != y.shape[1:]:
            return out_a, out_b
        same &= (x[a] == y[b]).reshape(len(a), -1).all(dim=1)
    out_a[a[same]] = False
    out_b[b[same]] = False
    return out_a, out_b


@dataclass(frozen=True, eq=False)
class Marked:
    """Two clouds, before and after, with the Gaussians that photographs do not show as they are.

    Attributes:
        before: as photographed.
        gone: `[N]` bool, those that are gone or differ since.
        after: with the new ones.
        other: `[M]` bool, those that came or differ, but for the new ones.
        new: `[M]` bool.
    """

    before: GaussianCloud
    gone: Tensor
    after: GaussianCloud
    other: Tensor
    new: Tensor

    def seen(self, camera: Camera) -> Mask:
        """`[H, W]`: pixels that show new Gaussians, and nothing that is not as photographed."""
        after = shares(self.after, (self.new, self.other), camera)
        shown = after[..., 0] > _SHOWS
        if not shown.any():
            return np.asarray(shown)
        hidden = (shares(self.before, (self.gone,), camera)[..., 0] > HIDES) | (after[..., 1] > HIDES)
        return np.asarray(shown & ~ndimage.binary_dilation(hidden, iterations=_MARGIN))

    def is_of(self, target: Target) -> bool:
        """Whether a photograph shows the scene as it was, told by what did not change around."""
        after = shares(self.after, (self.new, self.other), target.camera)
        hidden = shares(self.before, (self.gone,), target.camera)[..., 0] > HIDES
        still = ~hidden & (after[..., :2] < HIDES).all(axis=2)
        shot = render(self.before, target.camera)
        still &= shot.alpha.cpu().numpy() > 0.5
        if still.sum() < _RING:
            return True
        off = np.abs(shot.rgb.clamp(0, 1).cpu().numpy() - target.rgb)[still].mean()
        return bool(off < _UNLIKE)


def _places(capture: Capture, means: Tensor) -> dict[int, tuple[Camera, Box]]:
    """Photographs that show a good part of the new Gaussians, at most `LOOKED`: camera at reduced size, and part."""
    found = dict[int, tuple[Camera, Box]]()
    for index in present(capture):
        full = capture.cameras[index]
        gain = min(1.0, SIDE / max(full.width, full.height))
        camera = full.resized(max(1, round(gain * full.width)), max(1, round(gain * full.height)))
        pixels, depth = camera.project(means.to(torch.float64).cpu().numpy())
        if camera.contains(pixels, depth).mean() >= _INSIDE and (box := box_around(camera, means, _PAD)) is not None:
            found[index] = camera, box
    keys = list(found)
    chosen = (
        keys if len(keys) <= LOOKED else [keys[i] for i in np.linspace(0, len(keys) - 1, LOOKED).round().astype(int)]
    )
    return {k: found[k] for k in chosen}
