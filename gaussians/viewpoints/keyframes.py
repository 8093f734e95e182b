"""Ways of a camera through time: keyframes, and the smooth way between them.

Positions, targets and turns are cubic Hermite splines through the keyframes (Catmull-Rom's idea: a keyframe's speed is
that of its neighbours), with speeds limited so that no spline leaves its keyframes far behind: where two keyframes are
equal the camera rests. Knows cameras and seconds. Refuses to know files and pixels.
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

_FASTEST = 1.5  # times the slower of the two neighbouring chords: more may overshoot, and quaternions could meet zero


@dataclass(frozen=True, eq=False)
class Keyframe:
    """Where a camera is at one time.

    Attributes:
        time: seconds.
        camera: pose and lens; its size counts for nothing but the field of view.
        target: what it looks at, world; None if only its pose is known.
        up: what points to the top of the picture, world.
    """

    time: float
    camera: Camera
    target: Vec3 | None = None
    up: Vec3 = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class CameraPath:
    """At least one keyframe, times ascending.

    Attributes:
        keyframes: in the order of time.
        size: pictures' width and height in pixels, if the path says so.
        fps: pictures a second, if the path says so.
    """

    keyframes: tuple[Keyframe, ...]
    size: tuple[int, int] | None = None
    fps: float | None = None

    def __post_init__(self) -> None:
        times = [k.time for k in self.keyframes]
        if not times:
            raise UserError("a camera path needs at least one keyframe")
        if not all(map(math.isfinite, times)) or any(b <= a for a, b in itertools.pairwise(times)):
            raise UserError("the times of keyframes must be finite and ascend")

    @property
    def seconds(self) -> float:
        """From the first keyframe to the last."""
        return self.keyframes[-1].time - self.keyframes[0].time

    def cameras(self, times: Sequence[float], width: int, height: int) -> list[Camera]:
        """Cameras of one size at `times` (seconds after the first keyframe); before and after the path, its ends.

        If every keyframe has a target, the camera looks at a target that moves as smoothly as itself; otherwise
        it turns along a spline of unit quaternions.

        Raises:
            UserError: on its way the camera would stand in its own target.
        """
        at = np.clip(np.asarray(times, dtype=np.float64), 0.0, self.seconds)
        knots = np.array([k.time - self.keyframes[0].time for k in self.keyframes])
        eyes = through(knots, np.stack([k.camera.position for k in self.keyframes]), at)
        half = through(knots, np.array([[_half_angle(k.camera)] for k in self.keyframes]), at)[:, 0]
        poses = self._aimed(knots, eyes, at) if all(k.target for k in self.keyframes) else self._turned(knots, eyes, at)
        focal = 0.5 * height / np.tan(half)
        return [
            Camera(pose, f, f, width / 2, height / 2, width, height, f"at {t:.3f} s")
            for pose, f, t in zip(poses, focal.tolist(), at.tolist(), strict=True)
        ]

    def _aimed(self, knots: F64, eyes: F64, at: F64) -> list[F64]:
        """World-to-camera matrices that look at the moving target."""
        targets = through(knots, np.array([k.target for k in self.keyframes], dtype=np.float64), at)
        ups = through(knots, np.array([k.up for k in self.keyframes], dtype=np.float64), at)
        return [Camera.look_at(*aim).world_to_camera for aim in zip(eyes, targets, ups, strict=True)]

    def _turned(self, knots: F64, eyes: F64, at: F64) -> list[F64]:
        """World-to-camera matrices along the spline of turns."""
        from scipy.spatial.transform import Rotation

        quats = Rotation.from_matrix([k.camera.world_to_camera[:3, :3] for k in self.keyframes]).as_quat()
        for i in range(1, len(quats)):  # of q and -q, the same turn, the nearer one to the turn before
            quats[i] *= -1.0 if quats[i] @ quats[i - 1] < 0 else 1.0
        poses = np.tile(np.eye(4), (len(at), 1, 1))
        poses[:, :3, :3] = Rotation.from_quat(through(knots, quats, at)).as_matrix()
        poses[:, :3, 3] = -(poses[:, :3, :3] @ eyes[:, :, None])[:, :, 0]
        return list(poses)


def through(knots: F64, values: F64, at: F64) -> F64:
    """The spline through `values [K, D]` at ascending `knots [K]`, evaluated at `at [T]`: `[T, D]`."""
    if len(knots) == 1:
        return np.repeat(values, len(at), axis=0)
    from scipy.interpolate import CubicHermiteSpline

    chords = np.diff(values, axis=0) / np.diff(knots)[:, None]
    before, after = np.concatenate([chords[:1], chords]), np.concatenate([chords, chords[-1:]])
    speeds = (before + after) / 2
    limit = _FASTEST * np.minimum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    speeds *= np.minimum(1.0, limit / np.maximum(np.linalg.norm(speeds, axis=1), 1e-300))[:, None]
    found: F64 = CubicHermiteSpline(knots, values, speeds, axis=0)(at)
    return found


def _half_angle(camera: Camera) -> float:
    """Half the vertical field of view, radians."""
    return math.atan(0.5 * camera.height / camera.fy)
