"""Optimise what a fill made against the photographs of the capture, in the pixels that see behind what is gone."""

from __future__ import annotations

import time

import torch

from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ..receipt import Lifted
from .behind import Behind, Photographs, seen_behind
from .optimise import optimised
from .target import psnr
from .told import PHOTOGRAPHS

HELD_EVERY = 8  # of the photographs that see behind, one is kept from the optimisation and measures it
FEWEST = 3  # photographs that see behind, of which one measures: fewer do not tell how far away a thing is
PIXELS = 100  # of all photographs: fewer tell nothing


def with_photographs(scene: Scene, photographs: Photographs, new: torch.Tensor, seed: int = 0) -> tuple[Scene, Lifted]:
    """The scene with its new Gaussians as photographs show their places, and what was measured; all others stay.

    What no photograph sees stays as the fill made it, and so does everything if that is nearer to the photographs.

    Args:
        scene: after an edit and its fill.
        new: `[M]`, ids of the fill's Gaussians.

    Raises:
        FileError: a photograph cannot be read.
    """
    started = time.perf_counter()
    behind = seen_behind(photographs, scene.cloud, new)
    if len(behind.targets) < FEWEST or behind.pixels < PIXELS:
        return scene, Lifted(
            source=PHOTOGRAPHS, looked=behind.looked, reason=_why_none(behind), seconds=_since(started)
        )
    first = min(HELD_EVERY, len(behind.targets)) // 2
    measured = behind.targets[first::HELD_EVERY]
    learnt = [t for k, t in enumerate(behind.targets) if (k - first) % HELD_EVERY]
    own = mask_of_ids(scene.cloud.ids, new)
    rows = own.nonzero().squeeze(1)
    changed, steps = optimised(scene.cloud[~own], scene.cloud[rows], learnt, seed)
    cloud = scene.cloud.replace(
        **{
            name: getattr(scene.cloud, name).index_copy(0, rows, getattr(changed, name))
            for name in ("means", "scales", "opacities", "sh")
        }
    )
    was, now = psnr(scene.cloud, measured), psnr(cloud, measured)
    kept = now > was
    told = Lifted(
        source=PHOTOGRAPHS, looked=behind.looked, views=len(behind.targets), held_out=len(measured),
        pixels=behind.pixels, psnr_before=was, psnr_after=now if kept else was,
        steps=steps, seconds=_since(started),
        reason="" if kept else "the fill is as near to the photographs as it gets",
    )  # fmt: skip
    return (scene.replace(cloud=cloud) if kept else scene), told


def _since(started: float) -> float:
    return round(time.perf_counter() - started, 3)


def _why_none(behind: Behind) -> str:
    if behind.unlike:
        return f"{behind.unlike} photographs that might see behind it do not show this scene as it was"
    if behind.targets:
        return f"only {len(behind.targets)} photographs see behind it, in {behind.pixels} pixels, which is too little"
    return "no photograph sees behind it" if behind.looked else "no photograph shows the place"
