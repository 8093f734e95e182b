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

SHORTEST, LONGEST = 0.02, 200.0  # focal lengths, of a picture's longer side: 175 and 0.3 degrees
KEPT = 0.5  # of the picture that a lens leaves in its place
STRIP = 1 << 22  # pixels that are straightened at a time


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

    def steady(self, x: F64, y: F64) -> NDArray[np.bool_]:
        """Whether what is seen there moves outwards as the ray does; a picture folds where it does not."""
        r = x * x + y * y
        return np.asarray(1 + r * (3 * self.k1 + r * (5 * self.k2 + r * 7 * self.k3)) > 0)


def check_lens(camera: Camera, lens: Lens) -> None:
    """That a camera and its lens could have taken a photograph.

    Raises:
        ValueError: the focal length is none of a lens, the optical axis misses the picture, or the distortion folds
            half of the picture, or throws it out.
    """
    longer = max(camera.width, camera.height)
    for focal in (camera.fx, camera.fy):
        if not SHORTEST * longer < focal < LONGEST * longer:
            raise ValueError(f"a focal length of {focal:g} pixels on {camera.width}x{camera.height} is none of a lens")
    if not (0 < camera.cx < camera.width and 0 < camera.cy < camera.height):
        raise ValueError(f"its principal point {camera.cx:g}, {camera.cy:g} is not inside the picture of "
                         f"{camera.width}x{camera.height}")  # fmt: skip
    if lens.bare:
        return
    rows, columns = np.mgrid[0 : camera.height : 24j, 0 : camera.width : 24j]
    x, y = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    with np.errstate(over="ignore", invalid="ignore"):
        seen_x, seen_y = lens.bent(x, y)
        at_x, at_y = seen_x * camera.fx + camera.cx, seen_y * camera.fy + camera.cy
        inside = (at_x >= 0) & (at_x <= camera.width) & (at_y >= 0) & (at_y <= camera.height)
        kept = inside & lens.steady(x, y)
    if kept.mean() < KEPT:
        raise ValueError(f"its lens distortion (k1 {lens.k1:g}, k2 {lens.k2:g}, k3 {lens.k3:g}, p1 {lens.p1:g}, "
                         f"p2 {lens.p2:g}) folds the picture or throws it out")  # fmt: skip


def straightened(photo: NDArray[np.uint8], camera: Camera, lens: Lens) -> NDArray[np.uint8]:
    """A photograph `[H, W, 3]` as the camera without its lens would have taken it; beyond the border, the border.

    Pixels between pixels are linear mixtures.
    """
    if lens.bare:
        return photo
    from scipy.ndimage import map_coordinates

    out = np.empty_like(photo)
    deep = photo.astype(np.float32)
    many = max(1, STRIP // camera.width)
    for top in range(0, camera.height, many):
        rows, columns = np.mgrid[top : min(top + many, camera.height), 0 : camera.width].astype(np.float64)
        x, y = lens.bent((columns + 0.5 - camera.cx) / camera.fx, (rows + 0.5 - camera.cy) / camera.fy)
        at = [y * camera.fy + camera.cy - 0.5, x * camera.fx + camera.cx - 0.5]
        for c in range(3):
            seen = map_coordinates(deep[..., c], at, order=1, mode="nearest")
            out[top : top + many, :, c] = np.clip(seen + 0.5, 0, 255)
    return out
