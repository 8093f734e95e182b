"""Fill what an edit revealed with what a model inpaints into views of it, lifted into Gaussians.

views of the hole -> the best is inpainted -> depth -> Gaussians -> drawn from the next view
-> only what is still missing there is inpainted -> ... -> all new Gaussians optimised against all views
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from scipy import ndimage
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.errors import ScenewrightError
from ...gaussians.render import render, split
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ..cloud_diff import joined
from ..field_update import recount
from ..receipt import Lifted
from .depth import F64, continued_depth, seeds
from .inpainters import F32, Inpainter, Mask, Shot, checked
from .optimise import Rates, optimised
from .target import Target, psnr, shares
from .views import Revealed, View, views_of

RATES = Rates(means=0.01, sizes=5e-3, opacities=2e-2, colors=1.5e-2, bands=5e-4)
_MISSING = 0.7  # alpha below which a pixel of a hole is still missing
_FEWEST = 24  # missing pixels that are worth another picture
_FEATHER = 3.0  # px over which a filled picture goes over into its surroundings
_RING = 3  # px around a hole from which depth is continued
_THERE = 0.5  # blending weight from which a fill tells the depth of a pixel
_SURE = 0.5  # alpha from which a depth is known
_FRONT = 0.3  # alpha from which the thing itself tells the least depth
_SEEN = 0.5  # pixels of a hole from which a Gaussian of the fill shows in it


def with_inpainted(
    before: Scene, after: Scene, new: Tensor, inpainter: Inpainter, seed: int = 0
) -> tuple[Scene, Tensor, Lifted]:
    """The scene with its hole filled by a model; the ids of all new Gaussians; what was done.

    The fill that is there tells the depth where it reaches; what views show of it is replaced. If the model fails, the
    scene stays as it is, and the reason is told.

    Args:
        before: the scene before the edit.
        after: after it and its fill.
        new: `[M]`, ids of the fill's Gaussians, possibly none.
    """
    started = time.perf_counter()
    revealed = Revealed.of(before, after, new)
    views = views_of(revealed, after.cameras, after.frame.up_vector)
    try:
        if not views:
            return after, new, Lifted(source=inpainter.name, reason="no view shows a hole that it left")
        made, targets = _Lifting(revealed, inpainter, seed).run(views)
    except ScenewrightError as error:
        told = Lifted(source=inpainter.name, looked=len(views), reason=str(error), seconds=_since(started))
        return after, new, told
    shown = _shown(revealed, views)
    kept = after.cloud[~shown]
    changed, steps = optimised(kept, made, targets, seed, RATES)
    top = max(int(c.ids.max()) if len(c) else -1 for c in (before.cloud, after.cloud)) + 1
    changed = changed.replace(ids=torch.arange(top, top + len(changed), device=changed.device))
    cloud = joined(kept, None, [changed])
    told = Lifted(
        source=inpainter.name, looked=len(views), views=len(targets), made=len(changed), replaced=int(shown.sum()),
        pixels=sum(int(t.counts.sum()) for t in targets), psnr_before=psnr(after.cloud, targets),
        psnr_after=psnr(cloud, targets), steps=steps, seconds=_since(started),
    )  # fmt: skip
    rest = kept.ids[mask_of_ids(kept.ids, new)]
    scene = after.replace(cloud=cloud, language=recount(after.language, cloud))
    return scene, torch.cat([rest, changed.ids]), told


def _shown(revealed: Revealed, views: Sequence[View]) -> Tensor:
    """`[M]` bool: the fill's Gaussians that a view shows in its hole."""
    weight = np.zeros(len(revealed.filled), np.float64)
    for view in views:
        found = split(revealed.filled, view.camera, view.hole.astype(np.int32))
        np.add.at(weight, found.rows[found.labels == 1], found.weights[found.labels == 1])
    return torch.from_numpy(weight > _SEEN).to(revealed.new.device) & revealed.new


@dataclass
class _Lifting:
    """The views of one hole filled one after another."""

    revealed: Revealed
    inpainter: Inpainter
    seed: int

    def run(self, views: Sequence[View]) -> tuple[GaussianCloud, list[Target]]:
        """The new Gaussians, those of the fill first, and the pictures that they are to look like.

        Raises:
            ScenewrightError: the model failed.
        """
        self.inpainter.prepare([self._shot(k, view) for k, view in enumerate(views)])
        made, targets = self.revealed.rest[:0], list[Target]()
        for k, view in enumerate(views):
            shot = render(self._with(made), view.camera)
            missing = view.hole if k == 0 else _clean(view.hole & (shot.alpha.cpu().numpy() < _MISSING))
            rgb: F32 = shot.rgb.clamp(0, 1).cpu().numpy()
            if missing.sum() >= (1 if k == 0 else _FEWEST):
                rgb = self._filled(k, rgb, missing)
                made = concat([made, self._seeds(view, rgb, missing, made)])
            targets.append(Target(view.camera, rgb, np.asarray(view.hole)))
        return made, targets

    def _with(self, made: GaussianCloud) -> GaussianCloud:
        """All Gaussians, the new ones last."""
        return concat([self.revealed.rest, made])

    def _shot(self, k: int, view: View) -> Shot:
        rgb = render(self.revealed.rest, view.camera).rgb.clamp(0, 1).cpu().numpy()
        return Shot(_name(k), rgb, self._grown(view.hole))

    def _grown(self, mask: Mask) -> Mask:
        grow = self.inpainter.grow
        return np.asarray(ndimage.binary_dilation(mask, iterations=grow)) if grow > 0 else mask

    def _filled(self, k: int, rgb: F32, missing: Mask) -> F32:
        """The picture with what is missing filled by the model, feathered into what was there."""
        mask = self._grown(missing)
        found = checked(
            self.inpainter.fill(Shot(_name(k), rgb, mask), self.seed), Shot(_name(k), rgb, mask), self.inpainter.name
        )
        # Full inside of the hole itself; over the pixels by which it was grown it goes over into the picture.
        away = ndimage.distance_transform_edt(~missing)
        share = np.clip(1 - away / (min(_FEATHER, self.inpainter.grow) + 1), 0, 1)[..., None].astype(np.float32)
        return np.asarray(rgb + share * (found - rgb), dtype=np.float32)

    def _seeds(self, view: View, rgb: F32, missing: Mask, made: GaussianCloud) -> GaussianCloud:
        """Gaussians for the missing pixels of a view, where the fill or what is around tells that they are."""
        camera, filled = view.camera, self.revealed.filled
        alpha, depth = _alpha_and_depth(self._with(made), camera)
        ring = ndimage.binary_dilation(missing, iterations=_RING) & ~missing & (alpha > _SURE)
        told = missing & (shares(filled, (self.revealed.new,), camera)[..., 0] > _THERE)
        if told.any():
            depth = np.where(told, _alpha_and_depth(filled, camera)[1], depth)
        front = _alpha_and_depth(self.revealed.before[self.revealed.thing], camera)
        nearest = np.where(front[0] > _FRONT, front[1], 0.0)
        there = continued_depth(depth, told | ring, missing & ~told, rgb, nearest)
        found = seeds(camera, rgb, there, missing & (there > 0), self.revealed.rest)
        first = max([-1, *(int(c.ids.max()) for c in (self.revealed.before, filled, made) if len(c))]) + 1
        return found.replace(ids=torch.arange(first, first + len(found), device=found.device))


def _alpha_and_depth(cloud: GaussianCloud, camera: Camera) -> tuple[F64, F64]:
    """`[H, W]` each."""
    shot = render(cloud, camera)
    return shot.alpha.cpu().numpy().astype(np.float64), shot.depth.cpu().numpy().astype(np.float64)


def _clean(mask: Mask) -> Mask:
    """A mask without specks."""
    return np.asarray(ndimage.binary_opening(ndimage.binary_closing(np.pad(mask, 2)))[2:-2, 2:-2])


def _name(k: int) -> str:
    return f"view_{k:02d}"


def _since(started: float) -> float:
    return round(time.perf_counter() - started, 3)
