"""Posed frames with times, by camera and time (`Footage`), and which of their pixels are not as at the first time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...camera import Camera
from ...errors import UserError
from ...fit.train import Shot

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]
I64 = NDArray[np.int64]

MOST = 0.6  # share of the cameras that have a frame of the time at which a film begins
SAME_PLACE = 1e-4  # of the numbers of a pose: cameras within it are one camera that stands
CHANGED = 0.05  # least difference of a colour, of 1, that counts as a change; more where frames are noisy
NOISES = 4.0  # times the frames' own noise, from which a difference counts
DIFFERS = 0.08  # difference of a colour to those of a render around a pixel, from which a frame shows something else


@dataclass(frozen=True, eq=False)
class Footage:
    """Frames of a scene that moves.

    Attributes:
        shots: the frames.
        seconds: `[F]` the time of each.
        times: `[T]` the different times, ascending.
        when: `[F]` index into `times`.
        cameras: the different cameras.
        who: `[F]` index into `cameras`.
        at_first: of each camera, what it would see at the first time, as rendered; none: it is a camera that stands,
            which has a frame of then.
    """

    shots: tuple[Shot, ...]
    seconds: F64
    times: F64
    when: I64
    cameras: tuple[Camera, ...]
    who: I64
    at_first: tuple[U8, ...] = ()

    @classmethod
    def of(cls, shots: Sequence[Shot], seconds: Sequence[float | None]) -> Footage:
        """Sort frames.

        Raises:
            UserError: a time is missing or not finite, or all are the same.
        """
        taken = np.array([np.nan if s is None else s for s in seconds], dtype=np.float64)
        if not np.isfinite(taken).all():
            bad = int(np.flatnonzero(~np.isfinite(taken))[0])
            raise UserError(f"frame {shots[bad].camera.name!r} has no finite time; every frame of a film needs one")
        times, when = np.unique(taken, return_inverse=True)
        if len(times) < 2:
            raise UserError(f"all frames are of one time ({times[0]:g} s); a film needs two or more different times")
        cameras: list[Camera] = []
        poses, who = np.zeros((len(shots), 4, 4)), []
        for shot in shots:
            near = np.abs(poses[: len(cameras)] - shot.camera.world_to_camera).max(axis=(1, 2))
            same = next(
                (int(i) for i in np.flatnonzero(near < _slack(shot.camera)) if _alike(cameras[i], shot.camera)), None
            )
            if same is None:
                same = len(cameras)
                poses[same] = shot.camera.world_to_camera
                cameras.append(shot.camera)
            who.append(same)
        return cls(tuple(shots), taken, times, when.reshape(-1), tuple(cameras), np.array(who))

    @cached_property
    def frames(self) -> dict[tuple[int, int], int]:
        """Number of the frame of a camera at a time, by both indices."""
        return {(int(c), int(t)): i for i, (c, t) in enumerate(zip(self.who, self.when, strict=True))}

    @cached_property
    def first(self) -> I64:
        """`[C]` the first frame of each camera."""
        return np.array(
            [min(np.flatnonzero(self.who == c), key=lambda i: self.when[i]) for c in range(len(self.cameras))]
        )

    @property
    def stands(self) -> bool:
        """Whether the cameras stand: several have frames at many times, and most of them at one from which on the film
        can be followed (`begins`)."""
        return len(self.cameras) > 1 and len(self.shots) >= 2 * len(self.cameras) and self.begins is not None

    @cached_property
    def begins(self) -> int | None:
        """The first of the times, but the last, of which most cameras have a frame; None: there is none."""
        most = np.bincount(self.when, minlength=len(self.times))[:-1] >= MOST * len(self.cameras)
        return int(most.argmax()) if most.any() else None

    def since(self, t: int) -> Footage:
        """The frames from a time on."""
        return self._of(self.when >= t)

    @property
    def steady(self) -> Footage:
        """The frames of the cameras that have one of the first time."""
        return self._of((self.when[self.first] == 0)[self.who])

    def _of(self, kept: NDArray[np.bool_]) -> Footage:
        """Some of the frames; itself if they are all."""
        rows = np.flatnonzero(kept)
        return self if kept.all() else Footage.of([self.shots[i] for i in rows], self.seconds[rows].tolist())

    def backwards(self) -> Footage:
        """The same frames in the opposite order: its seconds are negated."""
        return Footage.of(self.shots, (-self.seconds).tolist())

    def beginning(self, at_first: Sequence[U8]) -> Footage:
        """The same frames, of which is known what each camera would see at the first time."""
        return replace(self, at_first=tuple(at_first))

    @property
    def radius(self) -> float:
        """1.1 times the radius of the cameras around their middle, scene units."""
        eyes = np.stack([c.position for c in self.cameras])
        return 1.1 * float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max())

    @cached_property
    def least(self) -> float:
        """The difference of colour that counts as a change: above the noise between successive frames."""
        noises = []
        for c in range(len(self.cameras)):
            own = sorted(np.flatnonzero(self.who == c), key=lambda i: self.when[i])
            for a, b in zip(own[:-1:4], own[1::4], strict=False):
                off = self.shots[a].photo.astype(np.int16) - self.shots[b].photo
                noises.append(float(np.median(np.abs(off))) / 255 / 0.6745 / np.sqrt(2))
        return max(CHANGED, NOISES * float(np.median(noises or [0.0])))

    def moved(self, camera: int, t: int) -> NDArray[np.bool_]:
        """`[H, W]` pixels of a camera's frame at a time that are not as at the first time."""
        frame = self.frames[camera, t]
        if self.at_first:
            off = differs(self.at_first[camera], self.shots[frame].photo)
            return np.asarray(ndimage.binary_dilation(off), dtype=bool)  # what is beside an edge differs less
        return self.changed(frame, int(self.first[camera]))

    def changed(self, frame: int, other: int) -> NDArray[np.bool_]:
        """`[H, W]` pixels whose colour differs between two frames of one camera."""
        off = np.abs(self.shots[frame].photo.astype(np.int16) - self.shots[other].photo).max(axis=2) > 255 * self.least
        return np.asarray(ndimage.median_filter(off, 3), dtype=bool)


def rounded(drawn: F32) -> U8:
    """Rendered colours as those of a photograph."""
    return np.asarray((255 * drawn.clip(0, 1)).round(), np.uint8)


def differs(drawn: U8, photo: U8, least: float = DIFFERS) -> NDArray[np.bool_]:
    """`[H, W]` where the colour of a picture is like none that a render has at the pixel and beside it."""
    (height, width, _), around = drawn.shape, np.pad(drawn.astype(np.int16), ((1, 1), (1, 1), (0, 0)), mode="edge")
    off = np.full((height, width), 255, np.int16)
    for y, x in np.ndindex(3, 3):
        off = np.minimum(off, np.abs(around[y : y + height, x : x + width] - photo).max(axis=2))
    return np.asarray(ndimage.median_filter(off > 255 * least, 3), dtype=bool)


def _slack(camera: Camera) -> float:
    """Difference of the numbers of a pose up to which a camera stands where this one stood."""
    return SAME_PLACE * (1 + float(np.abs(camera.world_to_camera).max()))


def _alike(a: Camera, b: Camera) -> bool:
    """Whether two cameras have the same size and focal length."""
    return (a.width, a.height) == (b.width, b.height) and abs(a.fx - b.fx) <= SAME_PLACE * a.fx
