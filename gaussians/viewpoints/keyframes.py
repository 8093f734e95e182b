"""Camera paths: keyframes in time and smooth interpolation between them.

Positions, targets and rotations are cubic Hermite splines through the keyframes. The speed at a keyframe is the mean
of the chords to its neighbours (as in Catmull-Rom splines), limited so that the spline does not overshoot far: between
two equal keyframes the camera rests.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, Vec3
from ..errors import UserError

F64 = NDArray[np.float64]

_MAX_SPEED = 1.5  # times the slower of the two neighbouring chords; more may overshoot, and quaternions may reach zero


@dataclass(frozen=True, eq=False)
class Keyframe:
    """A camera at one time.

    Attributes:
        time: seconds.
        camera: pose and intrinsics; only its vertical field of view matters, not its image size.
        target: the point it looks at, world; None if only its pose is known.
        up: the direction of the top of the image, world.
    """

    time: float
    camera: Camera
    target: Vec3 | None = None
    up: Vec3 = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class CameraPath:
    """At least one keyframe, times ascending.

    Attributes:
        keyframes: sorted by time.
        size: width and height of the images in pixels, if the path gives them.
        fps: images per second, if the path gives it.
    """

    keyframes: tuple[Keyframe, ...]
    size: tuple[int, int] | None = None
    fps: float | None = None

    def __post_init__(self) -> None:
        times = [k.time for k in self.keyframes]
        if not times:
            raise UserError("a camera path needs at least one keyframe")
        if not all(map(math.isfinite, times)) or any(b <= a for a, b in itertools.pairwise(times)):
            raise UserError("the times of keyframes must be finite and ascending")

    @property
    def seconds(self) -> float:
        """Duration from the first keyframe to the last."""
        return self.keyframes[-1].time - self.keyframes[0].time

    def cameras(self, times: Sequence[float], width: int, height: int) -> list[Camera]:
        """Cameras of one size at `times` (seconds after the first keyframe, clamped to the path).

        If every keyframe has a target, the camera looks at an interpolated target; otherwise its rotation is
        interpolated by a spline of quaternions.

        Raises:
            UserError: the camera's position would meet its target.
        """
        at = np.clip(np.asarray(times, dtype=np.float64), 0.0, self.seconds)
        knots = np.array([k.time - self.keyframes[0].time for k in self.keyframes])
        eyes = spline(knots, np.stack([k.camera.position for k in self.keyframes]), at)
        half = spline(knots, np.array([[_half_angle(k.camera)] for k in self.keyframes]), at)[:, 0]
        targeted = all(k.target for k in self.keyframes)
        poses = self._target_poses(knots, eyes, at) if targeted else self._rotation_poses(knots, eyes, at)
        focal = 0.5 * height / np.tan(half)
        return [
            Camera(pose, f, f, width / 2, height / 2, width, height, f"at {t:.3f} s")
            for pose, f, t in zip(poses, focal.tolist(), at.tolist(), strict=True)
        ]

    def _target_poses(self, knots: F64, eyes: F64, at: F64) -> list[F64]:
        """World-to-camera matrices that look at the interpolated target."""
        targets = spline(knots, np.array([k.target for k in self.keyframes], dtype=np.float64), at)
        ups = spline(knots, np.array([k.up for k in self.keyframes], dtype=np.float64), at)
        return [Camera.look_at(*aim).world_to_camera for aim in zip(eyes, targets, ups, strict=True)]

    def _rotation_poses(self, knots: F64, eyes: F64, at: F64) -> list[F64]:
        """World-to-camera matrices with interpolated rotations."""
        from scipy.spatial.transform import Rotation

        quats = Rotation.from_matrix([k.camera.world_to_camera[:3, :3] for k in self.keyframes]).as_quat()
        for i in range(1, len(quats)):  # of q and -q, the same rotation, take the one nearer to the previous one
            quats[i] *= -1.0 if quats[i] @ quats[i - 1] < 0 else 1.0
        poses = np.tile(np.eye(4), (len(at), 1, 1))
        poses[:, :3, :3] = Rotation.from_quat(spline(knots, quats, at)).as_matrix()
        poses[:, :3, 3] = -(poses[:, :3, :3] @ eyes[:, :, None])[:, :, 0]
        return list(poses)


def spline(knots: F64, values: F64, at: F64) -> F64:
    """The spline through `values [K, D]` at ascending `knots [K]`, evaluated at `at [T]`: `[T, D]`."""
    if len(knots) == 1:
        return np.repeat(values, len(at), axis=0)
    from scipy.interpolate import CubicHermiteSpline

    chords = np.diff(values, axis=0) / np.diff(knots)[:, None]
    before, after = np.concatenate([chords[:1], chords]), np.concatenate([chords, chords[-1:]])
    speeds = (before + after) / 2
    limit = _MAX_SPEED * np.minimum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    speeds *= np.minimum(1.0, limit / np.maximum(np.linalg.norm(speeds, axis=1), 1e-300))[:, None]
    found: F64 = CubicHermiteSpline(knots, values, speeds, axis=0)(at)
    return found


def _half_angle(camera: Camera) -> float:
    """Half the vertical field of view, radians."""
    return math.atan(0.5 * camera.height / camera.fy)
