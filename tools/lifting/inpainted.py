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

from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.errors import ScenewrightError
from ...gaussians.harmonics import color_to_dc
from ...gaussians.render import render
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ..cloud_diff import joined
from ..field_update import recount
from ..receipt import Lifted
from .depth import continued_depth, seeds
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


def with_inpainted(
    before: Scene, after: Scene, new: Tensor, inpainter: Inpainter, seed: int = 0
) -> tuple[Scene, Tensor, Lifted]:
    """The scene with its hole filled by a model; the ids of all new Gaussians; what was done.

    The fill that is there gives the depth where it reaches, and takes the model's colours. If the model fails, the
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
    changed = optimised(revealed.rest, made, targets, seed, RATES)
    scene, ids = _merged(before, after, new, changed)
    told = Lifted(
        source=inpainter.name, looked=len(views), views=len(targets), made=len(ids) - len(new),
        pixels=sum(int(t.counts.sum()) for t in targets), psnr_before=psnr(after.cloud, targets),
        psnr_after=psnr(scene.cloud, targets), seconds=_since(started),
    )  # fmt: skip
    return scene, ids, told


def _merged(before: Scene, after: Scene, new: Tensor, changed: GaussianCloud) -> tuple[Scene, Tensor]:
    """The scene with the changed fill, and with the Gaussians that came after it added."""
    own = mask_of_ids(after.cloud.ids, new).nonzero().squeeze(1)
    columns = {
        name: getattr(after.cloud, name).index_copy(0, own, getattr(changed, name)[: len(own)])
        for name in ("means", "scales", "opacities", "sh")
    }
    cloud, added = after.cloud.replace(**columns), changed[torch.arange(len(own), len(changed), device=changed.device)]
    top = max(int(c.ids.max()) if len(c) else -1 for c in (before.cloud, cloud)) + 1
    added = added.replace(ids=torch.arange(top, top + len(added), device=cloud.device))
    cloud = joined(cloud, None, [added]) if len(added) else cloud
    return after.replace(cloud=cloud, language=recount(after.language, cloud)), torch.cat([new, added.ids])


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
        own = self.revealed.filled[self.revealed.new]
        made, targets = own, list[Target]()
        for k, view in enumerate(views):
            drawn = self.revealed.rest if k == 0 else self._with(made)
            shot = render(drawn, view.camera)
            missing = view.hole if k == 0 else _clean(view.hole & (shot.alpha.cpu().numpy() < _MISSING))
            rgb: F32 = shot.rgb.clamp(0, 1).cpu().numpy()
            if missing.sum() >= (1 if k == 0 else _FEWEST):
                rgb = self._filled(k, rgb, missing)
                if k == 0:
                    made = _recolored(made, self._with(made), view, rgb)
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
        """Gaussians for the pixels of a view in which nothing tells where they are."""
        whole, camera = self._with(made), view.camera
        shot = render(whole, camera)
        alpha, depth = shot.alpha.cpu().numpy(), shot.depth.cpu().numpy().astype(np.float64)
        own = torch.arange(len(whole), device=whole.device) >= len(self.revealed.rest)
        told = missing & (shares(whole, (own,), camera)[..., 0] > _THERE)
        hole = missing & ~told
        ring = ndimage.binary_dilation(missing, iterations=_RING) & ~missing
        thing = self.revealed.before[self.revealed.thing]
        front = render(thing, camera)
        nearest = np.where(front.alpha.cpu().numpy() > 0.3, front.depth.cpu().numpy(), 0.0).astype(np.float64)
        known = (told | ring) & (alpha > _SURE)
        there = continued_depth(depth, known, hole, rgb, nearest)
        found = seeds(camera, rgb, there, hole & (there > 0), self.revealed.rest)
        first = max([-1, *(int(c.ids.max()) for c in (self.revealed.before, whole) if len(c))]) + 1
        return found.replace(ids=torch.arange(first, first + len(found), device=found.device))


def _recolored(own: GaussianCloud, whole: GaussianCloud, view: View, rgb: F32) -> GaussianCloud:
    """A fill in the colours of a picture, where the view shows it."""
    if not len(own):
        return own
    pixels, depth = view.camera.project(own.means.to(torch.float64).cpu().numpy())
    at = np.floor(pixels).astype(np.int64)
    inside = view.camera.contains(pixels, depth)
    at[~inside] = 0
    seen = render(whole, view.camera)
    front = seen.depth.cpu().numpy()[at[:, 1], at[:, 0]]
    shown = inside & view.hole[at[:, 1], at[:, 0]] & (depth < 1.02 * front + own.scales.amax(dim=1).cpu().numpy())
    sh = own.sh.clone()
    rows = torch.from_numpy(np.flatnonzero(shown)).to(sh.device)
    sh[rows, 0] = color_to_dc(torch.from_numpy(rgb[at[shown, 1], at[shown, 0]])).to(sh.device)
    sh[rows, 1:] = 0
    return own.replace(sh=sh)


def _clean(mask: Mask) -> Mask:
    """A mask without specks."""
    return np.asarray(ndimage.binary_opening(ndimage.binary_closing(np.pad(mask, 2)))[2:-2, 2:-2])


def _name(k: int) -> str:
    return f"view_{k:02d}"


def _since(started: float) -> float:
    return round(time.perf_counter() - started, 3)
