"""Lens distortion: its model, a check of its parameters, and the undistortion of photographs.

The model is the radial and tangential polynomial that OpenCV, COLMAP and nerfstudio share
(https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html). Fisheye models are not supported.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .camera import Camera

F64 = NDArray[np.float64]

MIN_FOCAL, MAX_FOCAL = 0.02, 200.0  # as shares of the image's longer side: fields of view of 175 and 0.3 degrees
MIN_VALID = 0.5  # share of the image that the distortion must map into the image without folding
STRIP_PIXELS = 1 << 22  # undistorted at a time


@dataclass(frozen=True)
class Lens:
    """Coefficients of radial (k1, k2, k3) and tangential (p1, p2) distortion of normalised image coordinates."""

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    @property
    def is_identity(self) -> bool:
        """Whether the lens does not distort."""
        return not any((self.k1, self.k2, self.k3, self.p1, self.p2))

    def distort(self, x: F64, y: F64) -> tuple[F64, F64]:
        """Normalised image coordinates at which the ray with tangents x, y appears."""
        r = x * x + y * y
        radial = 1 + r * (self.k1 + r * (self.k2 + r * self.k3))
        return (
            x * radial + 2 * self.p1 * x * y + self.p2 * (r + 2 * x * x),
            y * radial + 2 * self.p2 * x * y + self.p1 * (r + 2 * y * y),
        )

    def is_monotonic(self, x: F64, y: F64) -> NDArray[np.bool_]:
        """Whether the radial distortion grows with the radius at x, y; elsewhere it folds the image over itself."""
        r = x * x + y * y
        return np.asarray(1 + r * (3 * self.k1 + r * (5 * self.k2 + r * 7 * self.k3)) > 0)


def check_lens(camera: Camera, lens: Lens) -> None:
    """Check that a camera and its lens could have taken a photograph.

    Raises:
        ValueError: the focal length is implausible, the principal point lies outside the image, or the distortion
            folds more than half of the image or maps it outside.
    """
    longer = max(camera.width, camera.height)
    for focal in (camera.fx, camera.fy):
        if not MIN_FOCAL * longer < focal < MAX_FOCAL * longer:
            raise ValueError(f"a focal length of {focal:g} pixels is implausible for an image of "
                             f"{camera.width}x{camera.height}")  # fmt: skip
    if not (0 < camera.cx < camera.width and 0 < camera.cy < camera.height):
        raise ValueError(f"its principal point {camera.cx:g}, {camera.cy:g} is not inside the image of "
                         f"{camera.width}x{camera.height}")  # fmt: skip
    if lens.is_identity:
        return
    rows, columns = np.mgrid[0 : camera.height : 24j, 0 : camera.width : 24j]
    x, y = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    with np.errstate(over="ignore", invalid="ignore"):
        distorted_x, distorted_y = lens.distort(x, y)
        at_x, at_y = distorted_x * camera.fx + camera.cx, distorted_y * camera.fy + camera.cy
        inside = (at_x >= 0) & (at_x <= camera.width) & (at_y >= 0) & (at_y <= camera.height)
        valid = inside & lens.is_monotonic(x, y)
    if valid.mean() < MIN_VALID:
        raise ValueError(f"its lens distortion (k1 {lens.k1:g}, k2 {lens.k2:g}, k3 {lens.k3:g}, p1 {lens.p1:g}, "
                         f"p2 {lens.p2:g}) folds the image or maps it outside")  # fmt: skip


def undistort(photo: NDArray[np.uint8], camera: Camera, lens: Lens) -> NDArray[np.uint8]:
    """A photograph `[H, W, 3]` as the pinhole camera would have taken it, resampled linearly.

    Pixels from outside the photograph repeat its border.
    """
    if lens.is_identity:
        return photo
    from scipy.ndimage import map_coordinates

    out = np.empty_like(photo)
    values = photo.astype(np.float32)
    strip = max(1, STRIP_PIXELS // camera.width)  # rows
    for top in range(0, camera.height, strip):
        rows, columns = np.mgrid[top : min(top + strip, camera.height), 0 : camera.width].astype(np.float64)
        x, y = lens.distort((columns + 0.5 - camera.cx) / camera.fx, (rows + 0.5 - camera.cy) / camera.fy)
        at = [y * camera.fy + camera.cy - 0.5, x * camera.fx + camera.cx - 0.5]
        for c in range(3):
            sampled = map_coordinates(values[..., c], at, order=1, mode="nearest")
            out[top : top + strip, :, c] = np.clip(sampled + 0.5, 0, 255)
    return out
