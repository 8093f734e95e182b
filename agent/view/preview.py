"""A coarse level of a scene that a page shows while the scene comes, so that its first picture is early and whole.

Its Gaussians are in slots behind those of the scene. Each slot is emptied by the message that brings the Gaussians
around it, so that at the end nothing of it is left. P: its Gaussians.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import torch

from ...gaussians.cloud import NO_GROUP, GaussianCloud
from ...gaussians.files.formats import streamed_sog
from ...gaussians.files.formats.morton import morton_order
from .changes import Shown
from .slots import I64

MOST = 20_000  # Gaussians: a third of a message


@dataclass(frozen=True, eq=False)
class Preview:
    """What is shown of a scene before it is there.

    Attributes:
        cloud: P Gaussians of the scene's degree, in no group.
        until: `[P]`, how many slots of the scene come before or with those around each of them; at least one.
    """

    cloud: GaussianCloud
    until: I64

    @classmethod
    def of(cls, coarse: GaussianCloud, shown: Shown) -> Self:
        """A coarse level of a scene that is shown for the first time: its slots follow a Morton curve, on which the
        level has its places too."""
        fine = shown.scene.cloud
        both = torch.cat([fine.means, coarse.means]).cpu().numpy()
        order = morton_order(both)
        before = np.empty(len(both), np.int64)
        before[order] = np.cumsum(order < len(fine))
        groups = torch.full((len(coarse),), NO_GROUP, dtype=coarse.group.dtype)
        return cls(coarse.with_degree(fine.degree).replace(group=groups), np.maximum(before[len(fine) :], 1))

    def emptied(self, first: int, end: int) -> I64:
        """The Gaussians, ascending, whose slots the message with the slots `first` to `end` of the scene empties."""
        return np.flatnonzero((self.until > first) & (self.until <= end))


def coarse_level(path: Path) -> GaussianCloud | None:
    """The finest level of a scene file that is small enough to be shown first; None if there is none.

    Raises:
        FileError: the file has levels and cannot be read.
    """
    if not streamed_sog.recognises(path, b""):
        return None
    streamed = streamed_sog.Streamed.open(path)
    small = [k for k, count in enumerate(streamed.counts) if 0 < count <= MOST]
    if not small or not small[0]:
        return None
    cloud = streamed.level(small[0])[0]
    return cloud if len(cloud) <= MOST else None
