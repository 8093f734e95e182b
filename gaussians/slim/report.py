"""Figures about a slimmed scene: its size as INRIA .ply, and whether its things are still there and where they were."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..render import render
from ..scene import Scene
from .views import View

SOLID = 0.5  # alpha from which a pixel shows a thing


def inria_bytes(cloud: GaussianCloud) -> int:
    """Bytes of a cloud's rows as INRIA .ply of its SH degree."""
    return len(cloud) * row_bytes_of(cloud.degree)


def row_bytes_of(degree: int) -> int:
    """Bytes of a row of INRIA .ply: 17 floats and the higher coefficients."""
    return 4 * (14 + 3 * (degree + 1) ** 2)


def things_left(scene: Scene) -> tuple[int, int] | None:
    """How many objects of the language field have Gaussians, and how many there are; None without a field."""
    if scene.language is None:
        return None
    objects = scene.language.objects()
    return sum(g.count > 0 for g in objects), len(objects)


def same_thing(before: Scene, after: Scene, views: Sequence[View]) -> float | None:
    """Share of the pixels that show a thing before and show the same thing after; None without a language field."""
    if before.language is None:
        return None
    owner = np.array([g.parent if g.parent >= 0 else g.id for g in before.language.groups] + [-1])
    same = shown = 0
    for view in views:
        (was, solid), (now, _) = _things(before, view, owner), _things(after, view, owner)
        seen = solid & (was >= 0)
        same, shown = same + int((was == now)[seen].sum()), shown + int(seen.sum())
    return same / shown if shown else None


def _things(scene: Scene, view: View, owner: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """`[H, W]` object of each pixel (-1: none), and whether anything solid shows."""
    drawn = render(scene.cloud, view.camera, view.background)
    return owner[drawn.group.numpy()], (drawn.alpha > SOLID).numpy()
