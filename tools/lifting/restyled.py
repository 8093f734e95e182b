"""Give a restyled thing the look that a model paints into views of it.

Views are drawn, painted by the model and fitted by the thing's colours, several times, each time with less freedom, so
that the views come to agree (the iterative update of Haque et al. 2023, Instruct-NeRF2NeRF). Only colours change.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import ScenewrightError
from ...gaussians.render import render
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ..field_update import after_recolor
from ..receipt import Lifted
from .inpainters import Shot
from .optimise import Rates, optimised
from .restylers import Restyler
from .target import Target, psnr, shares
from .views import views_showing

STRENGTHS = (0.6, 0.45, 0.3)  # of the model, round by round
PASSES = 15  # over the views in each round
RATES = Rates(means=0.0, sizes=0.0, opacities=0.0, colors=2e-2, bands=1e-3)
_SHOWS = 0.5  # blending weight of the thing from which a pixel is of it


def restyled(scene: Scene, ids: Tensor, prompt: str, restyler: Restyler, seed: int = 0) -> tuple[Scene, Lifted]:
    """The scene with the colours of some Gaussians as a model paints them; all others stay bit for bit.

    If the model fails, the scene stays as it is, and the reason is told.

    Args:
        ids: `[M]`, of the Gaussians.
        prompt: what they are to look like.
    """
    started = time.perf_counter()
    own = mask_of_ids(scene.cloud.ids, ids)
    views = views_showing(scene.cloud, own, scene.cameras, scene.frame.up_vector)
    if not views:
        return scene, Lifted(source=restyler.name, reason="no view shows it")
    rest, thing, targets, steps = scene.cloud[~own], scene.cloud[own], list[Target](), 0
    cloud, rows = scene.cloud, own.nonzero().squeeze(1)
    try:
        for k, strength in enumerate(STRENGTHS):
            targets = _painted(cloud, own, [v.camera for v in views], restyler, (prompt, strength, seed + k))
            thing, done = optimised(rest, thing, targets, seed + k, RATES, PASSES)
            steps += done
            cloud = scene.cloud.replace(sh=scene.cloud.sh.index_copy(0, rows, thing.sh))
    except ScenewrightError as error:
        told = Lifted(source=restyler.name, looked=len(views), reason=str(error), seconds=_since(started))
        return scene, told
    after = scene.replace(cloud=cloud)
    told = Lifted(
        source=restyler.name, looked=len(views), views=len(targets), pixels=sum(int(t.counts.sum()) for t in targets),
        psnr_before=psnr(scene.cloud, targets), psnr_after=psnr(cloud, targets), steps=steps,
        seconds=_since(started),
    )  # fmt: skip
    return after.replace(language=after_recolor(after, scene.cloud.ids[own])), told


def _painted(
    cloud: GaussianCloud, own: Tensor, cameras: Sequence[Camera], restyler: Restyler, asked: tuple[str, float, int]
) -> list[Target]:
    """The views as the model paints them.

    Args:
        own: `[N]` bool, the thing.
        asked: prompt, strength and seed.
    """
    targets = []
    for k, camera in enumerate(cameras):
        rgb = render(cloud, camera).rgb.clamp(0, 1).cpu().numpy()
        mask = np.asarray(shares(cloud, (own,), camera)[..., 0] > _SHOWS)
        targets.append(Target(camera, restyler.restyle(Shot(f"view_{k:02d}", rgb, mask), *asked), mask))
    return targets


def _since(started: float) -> float:
    return round(time.perf_counter() - started, 3)
