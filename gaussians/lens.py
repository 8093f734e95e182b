"""What a real lens does to a picture, and a picture as if it had been taken without it.

Knows the radial and tangential polynomial that OpenCV, COLMAP and nerfstudio share
(https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html). Refuses to know files and fisheyes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .camera import Camera

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Lens:
    """Radial (k1, k2, k3) and tangential (p1, p2) distortion of the tangents of the viewing angle."""

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    @property
    def bare(self) -> bool:
        """Whether it does nothing."""
        return not any((self.k1, self.k2, self.k3, self.p1, self.p2))

    def bent(self, x: F64, y: F64) -> tuple[F64, F64]:
        """Where the ray with tangents x, y is seen."""
        r = x * x + y * y
        radial = 1 + r * (self.k1 + r * (self.k2 + r * self.k3))
        return (
            x * radial + 2 * self.p1 * x * y + self.p2 * (r + 2 * x * x),
            y * radial + 2 * self.p2 * x * y + self.p1 * (r + 2 * y * y),
        )


def straightened(photo: NDArray[np.uint8], camera: Camera, lens: Lens) -> NDArray[np.uint8]:
    """A photograph `[H, W, 3]` as the camera without its lens would have taken it; beyond the border, the border.

    Pixels between pixels are linear mixtures.
    """
    if lens.bare:
        return photo
    from scipy.ndimage import map_coordinates

    rows, columns = np.mgrid[0 : camera.height, 0 : camera.width].astype(np.float64)
    x, y = lens.bent((columns + 0.5 - camera.cx) / camera.fx, (rows + 0.5 - camera.cy) / camera.fy)
    at = [y * camera.fy + camera.cy - 0.5, x * camera.fx + camera.cx - 0.5]
    channels = [map_coordinates(photo[..., c].astype(np.float32), at, order=1, mode="nearest") for c in range(3)]
    return np.clip(np.stack(channels, axis=-1) + 0.5, 0, 255).astype(np.uint8)
