"""What pictures look through (`Sight`), and a strategy that lets nothing grow there (`Carving`).

A Gaussian in the air before a plain wall, in the wall's colour, is right in every picture that is trained on, and wrong
from anywhere else. Nothing in the pictures' colours removes it. Copies are made where gradients are large, which they
are for what is near a camera, so that a few such Gaussians become hundreds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...fit.densify import PRUNE_OPA, MCMCStrategy
from ...fit.parameters import Parameters
from ...fit.train import Shot
from .stereo import confirms, denies, points_of

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Sight:
    """How far pictures of one time see.

    Attributes:
        cameras: of the pictures.
        depths: `[H, W]` of each picture, by stereo.
        sure: `[H, W]` of each picture, where another one confirms its depth.
    """

    cameras: tuple[Camera, ...]
    depths: tuple[F64, ...]
    sure: tuple[Flags, ...]

    @classmethod
    def of(cls, shots: Sequence[Shot], radius: float) -> Sight:
        """Compare pictures of one time.

        Args:
            radius: of the cameras around their middle, scene units.
        """
        cameras = tuple(shot.camera for shot in shots)
        found = points_of(cameras, [shot.colors for shot in shots], radius)
        ends = np.cumsum([camera.height * camera.width for camera in cameras])[:-1]
        shapes = [(camera.height, camera.width) for camera in cameras]
        depths, agreed = np.split(found.depths, ends), np.split(found.agreed, ends)
        return cls(
            cameras,
            tuple(d.reshape(s) for d, s in zip(depths, shapes, strict=True)),
            tuple((a > 0).reshape(s) for a, s in zip(agreed, shapes, strict=True)),
        )

    def through(self, means: NDArray[np.float32]) -> Flags:
        """`[N]` whether more pictures look through a place than have their own depth there.

        Args:
            means: `[N, 3]` world.
        """
        places, votes = means.astype(np.float64), np.zeros(len(means), np.int64)
        for camera, depth, sure in zip(self.cameras, self.depths, self.sure, strict=True):
            votes += denies(places, camera, depth, sure)
            votes -= confirms(places, camera, depth)
        return np.asarray(votes > 0)


@dataclass
class Carving(MCMCStrategy):
    """Relocates what pictures look through, as if it were transparent.

    Attributes:
        sight: of the pictures of the first time; None: nothing is looked through.
    """

    sight: Sight | None = None

    def refine(self, parameters: Parameters, step: int) -> None:
        """See `Strategy`."""
        if self.sight is not None:
            parameters.logit_opacities[self.sight.through(parameters.means)] = np.log(PRUNE_OPA / 2)
        super().refine(parameters, step)
