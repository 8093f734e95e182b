"""A scene (`Scene`): a cloud with its frame, cameras and language field; and the frame (`Frame`): up, floor, scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, Vec3
from .cloud import GaussianCloud
from .errors import UserError
from .painted import Painted

if TYPE_CHECKING:
    from .language.field.language_field import LanguageField
    from .motion.motion import Motion

Source = Literal["given", "file", "estimated", "unknown"]


@dataclass(frozen=True)
class Frame:
    """Up direction, floor height and scale of a scene, each with its source.

    Attributes:
        up: unit vector, world frame.
        floor: height of the floor along `up` (scene units), None if there is none.
        metres_per_unit: None if the scale is unknown; distances are then in scene units and labelled as such.
        up_source, scale_source: how up and scale were obtained.
    """

    up: Vec3 = (0.0, 0.0, 1.0)
    floor: float | None = None
    metres_per_unit: float | None = None
    up_source: Source = "unknown"
    scale_source: Source = "unknown"

    def __post_init__(self) -> None:
        length = math.sqrt(sum(c * c for c in self.up))
        if not 0 < length < math.inf:
            raise UserError(f"Frame.up must be a finite non-zero vector, got {self.up}")
        object.__setattr__(self, "up", tuple(float(c) / length for c in self.up))
        if self.floor is not None and not math.isfinite(self.floor):
            raise UserError(f"Frame.floor must be a finite height, got {self.floor}")
        if self.metres_per_unit is not None and not 0 < self.metres_per_unit < math.inf:
            raise UserError(f"Frame.metres_per_unit must be positive, got {self.metres_per_unit}")

    @property
    def up_vector(self) -> NDArray[np.float64]:
        """`[3]`, unit."""
        return np.array(self.up, dtype=np.float64)

    def heights(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """Height of world points `[M, 3]` along up, `[M]`, scene units, above the world origin."""
        return points @ self.up_vector.astype(points.dtype)

    def basis(self) -> NDArray[np.float64]:
        """`[3, 3]` rows east, north, up of a level right-handed frame; the identity when up is +z."""
        up = self.up_vector
        seed = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
        east = seed - up * (seed @ up)
        east /= np.linalg.norm(east)
        return np.stack([east, np.cross(up, east), up])


@dataclass(frozen=True, eq=False)
class Scene:
    """A frozen scene. An edit makes a new scene that shares what did not change.

    Attributes:
        cloud: the Gaussians.
        frame: up, floor and scale.
        cameras: cameras that came with the scene (may be empty); the first is the viewer by default.
        language: the groups that phrases resolve to, or None before embedding.
        path: the file it was loaded from, or None.
        painted: what was painted, with its colours before; None if nothing was, and in a scene just loaded.
        motion: what changes with time; None in a static scene. The cloud is the scene at `motion.start`, and
            `motion.at.at` gives it at any time.
    """

    cloud: GaussianCloud
    frame: Frame = Frame()
    cameras: tuple[Camera, ...] = ()
    language: LanguageField | None = None
    path: Path | None = None
    painted: Painted | None = None
    motion: Motion | None = None

    def replace(self, **changes: Any) -> Self:
        """A new scene with some fields replaced."""
        return replace(self, **changes)
