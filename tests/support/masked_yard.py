"""A small yard of four things on a floor, cameras around it, and the masks of a perfect detector."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from painted_world import World

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.render import render

THINGS = ("chair", "table", "cup", "crate")
SIZE = (96, 72)


def yard() -> World:
    """A cup on a table, a chair close to it, a crate farther off, on a floor."""
    made = World().sheet("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), (0.6, 0.6, 0.55), 0.06)
    made.box("chair", (-1.1, -0.3, 0.02), (-0.6, 0.2, 0.7), (0.7, 0.2, 0.2), 0.04)
    made.box("table", (-0.5, -0.4, 0.02), (0.5, 0.4, 0.5), (0.5, 0.35, 0.2), 0.04)
    made.box("cup", (-0.1, -0.1, 0.52), (0.1, 0.1, 0.75), (0.2, 0.3, 0.7), 0.02)
    made.box("crate", (0.9, 0.7, 0.02), (1.4, 1.2, 0.5), (0.3, 0.6, 0.3), 0.04)
    return made


def around(count: int) -> list[Camera]:
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return [
        Camera.look_at(
            [3.2 * np.cos(a), 3.2 * np.sin(a), 1.6 + 0.5 * np.sin(3 * a)], [0, 0, 0.3], [0, 0, 1], *SIZE, 48, str(i)
        )
        for i, a in enumerate(angles)
    ]


def seen_by(cloud: GaussianCloud, truth: NDArray[np.int64], cameras: Sequence[Camera]) -> list[ViewMasks]:
    """Masks of a perfect detector for each view: the visible pixels of every object, with its name."""
    marked = cloud.replace(group=torch.from_numpy(truth.astype(np.int32)))
    views = []
    for camera in cameras:
        ids = render(marked, camera).group.numpy()
        there = [i for i in range(len(THINGS)) if (ids == i).sum() >= 4]
        place = np.full(len(THINGS) + 1, -1, np.int32)
        place[there] = np.arange(len(there))
        labels = tuple(THINGS[i] for i in there)
        views.append(ViewMasks(camera, place[ids], labels, np.full(len(there), 0.8, np.float32)))
    return views


def table_top(cloud: GaussianCloud, truth: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which Gaussians are the top of the table."""
    top: NDArray[np.bool_] = (truth == 1) & (cloud.means[:, 2] > 0.47).numpy()
    return top


def with_tops(cloud: GaussianCloud, truth: NDArray[np.int64], views: Sequence[ViewMasks]) -> list[ViewMasks]:
    """The masks of views with one more, without a name, of the top of the table in each."""
    marked = cloud.replace(group=torch.from_numpy(table_top(cloud, truth).astype(np.int32)))
    made = []
    for v in views:
        part = np.where((render(marked, v.camera).group.numpy() == 1), len(v), -1)
        ids = np.stack([v.ids, part]).astype(np.int32)
        made.append(ViewMasks(v.camera, ids, (*v.labels, ""), np.append(v.scores, 0.8)))
    return made
