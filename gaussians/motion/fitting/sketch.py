"""A film as the search for motion sees it (`sketched`): reduced frames of at most so many times.

What the search costs is bounded so, however long and large a film is. All frames are trained on afterwards, at their
full size; a path that was found has poses at their times too (`at_all_times`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...fit.train import Shot
from .bodies import Body
from .tracking import led

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MOST_TIMES = 64
MOST_PIXELS = 30_000  # of a frame
STEREO_FRAMES = 32  # that cover a film: others show little that is new, and need no more Gaussians
STEREO_PIXELS = 1_500_000  # of all frames whose depth is searched
PER_SECOND = 11_000  # of these pixels for each second of the fit: a search of all their depths takes a tenth of it


def stereo_pixels(seconds: float | None, frames: int) -> int:
    """Greatest number of pixels of each of some frames whose depth is searched, in a fit of so many seconds (None:
    one that is measured in steps)."""
    total = STEREO_PIXELS if seconds is None else min(STEREO_PIXELS, PER_SECOND * seconds)
    return max(1, int(total / max(1, min(frames, STEREO_FRAMES))))


def reduced(shot: Shot, pixels: int) -> Shot:
    """A frame with at most so many pixels, each the mean of those that it covers; itself if it has no more."""
    from PIL import Image

    height, width = shot.photo.shape[:2]
    if height * width <= pixels:
        return shot
    factor = (pixels / (height * width)) ** 0.5
    size = max(1, int(width * factor)), max(1, int(height * factor))
    photo = np.asarray(Image.fromarray(shot.photo).resize(size, Image.Resampling.BOX))
    return replace(shot, camera=shot.camera.resized(*size), photo=photo)


def sketched(shots: Sequence[Shot], pixels: int = MOST_PIXELS) -> tuple[Shot, ...]:
    """The frames of at most `MOST_TIMES` times, evenly chosen, the first and the last among them, reduced.

    Args:
        shots: frames with times.
        pixels: greatest number of each.
    """
    times = np.unique([shot.time for shot in shots if shot.time is not None])
    kept = set(times[np.linspace(0, len(times) - 1, min(MOST_TIMES, len(times))).round().astype(int)].tolist())
    return tuple(reduced(shot, pixels) for shot in shots if shot.time in kept)


def covering(cameras: Sequence[Camera], most: int = STEREO_FRAMES) -> I64:
    """At most so many cameras, ascending, none of which is far from all that are chosen: again and again the one that
    is farthest from these, by its place (of the radius of all) and by the direction of its sight (radians)."""
    if len(cameras) <= most:
        return np.arange(len(cameras))
    eyes, sights = np.stack([c.position for c in cameras]), np.stack([c.forward for c in cameras])
    radius = max(float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max()), 1e-9)
    chosen, nearest = [0], np.full(len(cameras), np.inf)
    while len(chosen) < most:
        own = chosen[-1]
        apart = np.linalg.norm(eyes - eyes[own], axis=1) / radius + np.arccos(np.clip(sights @ sights[own], -1, 1))
        nearest = np.minimum(nearest, apart)
        nearest[own] = -1.0
        chosen.append(int(nearest.argmax()))
    return np.array(sorted(chosen))


def at_all_times(body: Body, some: F64, times: F64) -> Body:
    """A path that is known at some times, at all: what is between two of them goes evenly from one pose to the other.

    Args:
        some: `[S]` seconds, ascending, of the poses.
        times: `[T]` seconds, ascending; before the first and after the last of `some` the path rests.
    """
    if len(some) == len(times):
        return body
    if body.bend is not None:
        return replace(at_all_times(replace(body, bend=None), some, times), bend=body.bend.at(some, times))
    if body.line is not None:
        return body.on(replace(body.line, values=np.interp(times, some, body.line.values)))
    after = np.clip(np.searchsorted(some, times, side="right"), 1, len(some) - 1)
    shares = np.clip((times - some[after - 1]) / (some[after] - some[after - 1]), 0, 1)
    poses = [
        led((body.quats[k - 1], body.offsets[k - 1]), (body.quats[k], body.offsets[k]), float(share))
        for k, share in zip(after, shares, strict=True)
    ]
    return Body(body.pivot, np.stack([quat for quat, _ in poses]), np.stack([offset for _, offset in poses]))
