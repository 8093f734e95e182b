"""Pinhole cameras (`Camera`) and rendered images (`Render`).

World-to-camera 4x4, OpenCV axes (+x right, +y down, +z forward), intrinsics in pixels, pixel centres at +0.5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from .errors import UserError

Vec3 = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera without distortion.

    Attributes:
        world_to_camera: `[4, 4]` float64, rigid, row-major; `x_cam = W[:3, :3] @ x_world + W[:3, 3]`.
        fx, fy: focal lengths in pixels.
        cx, cy: principal point in pixels from the outer corner of the top-left pixel.
        width, height: image size in pixels.
        name: its origin (a photograph's file name, "orbit 3", ...).
    """

    world_to_camera: NDArray[np.float64]
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    name: str = ""

    def __post_init__(self) -> None:
        pose = np.array(self.world_to_camera, dtype=np.float64)
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise UserError(f"Camera.world_to_camera must be a finite 4x4 matrix, got shape {list(pose.shape)}")
        if not np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-4) or np.linalg.det(pose[:3, :3]) < 0:
            raise UserError("Camera.world_to_camera must be rigid: its upper 3x3 block is not a rotation")
        if not np.allclose(pose[3], (0, 0, 0, 1), atol=1e-6):
            raise UserError(f"Camera.world_to_camera must be rigid: its last row is {pose[3].tolist()}, not 0 0 0 1")
        if self.width < 1 or self.height < 1 or not (0 < self.fx < math.inf and 0 < self.fy < math.inf):
            raise UserError(
                f"Camera needs a positive size and focal lengths, got {self.width}x{self.height}, "
                f"focal {self.fx}, {self.fy}"
            )
        if not (math.isfinite(self.cx) and math.isfinite(self.cy)):
            raise UserError(f"Camera needs a finite principal point, got {self.cx}, {self.cy}")
        pose.setflags(write=False)
        object.__setattr__(self, "world_to_camera", pose)

    @classmethod
    def look_at(
        cls,
        eye: ArrayLike,
        target: ArrayLike,
        up: ArrayLike,
        width: int = 512,
        height: int = 512,
        fov_y: float = 50.0,
        name: str = "",
    ) -> Self:
        """A camera at `eye` looking at `target` (world, scene units), `up` pointing to the image's top.

        `fov_y` is the vertical field of view in degrees. If the view runs along `up`, any perpendicular is used.
        """
        eye_, target_, up_ = (np.asarray(v, dtype=np.float64) for v in (eye, target, up))
        if not 0 < fov_y < 180:
            raise UserError(f"Camera.look_at: the field of view must lie between 0 and 180 degrees, got {fov_y}")
        with np.errstate(over="ignore", invalid="ignore"):
            forward = target_ - eye_
            length = float(np.linalg.norm(forward))
        if not length > 0:
            raise UserError("Camera.look_at: eye and target are the same point")
        if not math.isfinite(length):
            raise UserError("Camera.look_at: eye and target are too far apart")
        forward /= length
        right = np.cross(forward, up_)
        if np.linalg.norm(right) < 1e-6 * max(1.0, float(np.linalg.norm(up_))):
            right = np.cross(forward, np.eye(3)[int(np.argmin(np.abs(forward)))])
        right /= np.linalg.norm(right)
        down = np.cross(forward, right)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([right, down, forward])
        pose[:3, 3] = -pose[:3, :3] @ eye_
        focal = 0.5 * height / math.tan(math.radians(fov_y) / 2)
        return cls(pose, focal, focal, width / 2, height / 2, width, height, name)

    @property
    def position(self) -> NDArray[np.float64]:
        """`[3]`, the eye in world coordinates."""
        return -self.world_to_camera[:3, :3].T @ self.world_to_camera[:3, 3]

    @property
    def right(self) -> NDArray[np.float64]:
        """`[3]`, unit, world: the image's +x."""
        return self.world_to_camera[0, :3]

    @property
    def forward(self) -> NDArray[np.float64]:
        """`[3]`, unit, world: the viewing direction."""
        return self.world_to_camera[2, :3]

    def resized(self, width: int, height: int) -> Self:
        """The same view at another resolution; intrinsics scale with each side."""
        sx, sy = width / self.width, height / self.height
        return replace(
            self, fx=self.fx * sx, fy=self.fy * sy, cx=self.cx * sx, cy=self.cy * sy, width=width, height=height
        )

    def project(self, points: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """World points `[M, 3]` to pixels `[M, 2]` and camera depth `[M]` (points behind have depth <= 0)."""
        local = points @ self.world_to_camera[:3, :3].T + self.world_to_camera[:3, 3]
        depth = local[:, 2]
        safe = np.where(np.abs(depth) > 1e-9, depth, 1e-9)
        pixels = np.stack([self.fx * local[:, 0] / safe + self.cx, self.fy * local[:, 1] / safe + self.cy], axis=1)
        return pixels, depth

    def contains(self, pixels: NDArray[np.float64], depth: NDArray[np.float64]) -> NDArray[np.bool_]:
        """`[M]` bool, whether points, as `project` returned them, lie in front of the camera and inside the image."""
        inside = (pixels >= 0).all(axis=1) & (pixels < [self.width, self.height]).all(axis=1)
        return np.asarray((depth > 0) & inside)


@dataclass(frozen=True, eq=False)
class Render:
    """The images that a renderer returns for one camera.

    Attributes:
        rgb: `[H, W, 3]` float32, display space, composited over the background.
        alpha: `[H, W]` float32 in [0, 1], one minus the remaining transmittance.
        depth: `[H, W]` float32, camera z averaged with the blending weights, scene units; 0 where alpha is 0.
        group: `[H, W]` int32, group of the Gaussian with the largest blending weight; -1 where nothing was drawn.
    """

    rgb: Tensor
    alpha: Tensor
    depth: Tensor
    group: Tensor

    def to_uint8(self) -> NDArray[np.uint8]:
        """`[H, W, 3]` uint8 image, clipped and rounded."""
        image: NDArray[np.uint8] = (self.rgb.clamp(0, 1) * 255 + 0.5).to(torch.uint8).cpu().numpy()
        return image
