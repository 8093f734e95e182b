"""Values and rotations between keys: monotone cubics that do not overshoot, and turns that go the short way.

Before the first key and after the last one everything is constant.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


def between(times: F64, values: F64, at: F64, smooth: bool, ease: bool = True) -> F64:
    """Values `[T, D]` at times `[T]` of keys at `times` `[K]` ascending with `values` `[K, D]`.

    Args:
        smooth: monotone cubics (Fritsch and Carlson 1980, with the slopes of Fritsch and Butland 1984), which stay
            within the values of the two keys around; else straight lines.
        ease: whether the curve is at rest at its first and its last key, so that no speed jumps there. Else it starts
            and ends with the rate of its first and last interval.
    """
    if len(times) == 1:
        return np.repeat(values, len(at), axis=0)
    now = np.clip(at, times[0], times[-1])
    left = np.clip(np.searchsorted(times, now, side="right") - 1, 0, len(times) - 2)
    width = np.diff(times)
    u = ((now - times[left]) / width[left])[:, None]  # [T, 1], 0 at the key before, 1 at the key after
    start, end = values[left], values[left + 1]
    if not smooth:
        return np.asarray(start + u * (end - start))
    slopes = _slopes(width, values, ease) * 1.0
    rise, fall = slopes[left] * width[left][:, None], slopes[left + 1] * width[left][:, None]
    # Hermite's cubic, written around `start` so that equal keys give that very value.
    step = end - start
    curve = step * (u * u * (3 - 2 * u)) + rise * (u * (1 - u) ** 2) - fall * (u * u * (1 - u))
    return np.asarray(start + curve)


def _slopes(width: F64, values: F64, ease: bool) -> F64:
    """Slopes `[K, D]` at the keys: weighted harmonic means of the rates around, 0 at turning points."""
    rates = np.diff(values, axis=0) / width[:, None]  # [K - 1, D]
    slopes = np.zeros_like(values)
    if not ease:
        slopes[0], slopes[-1] = rates[0], rates[-1]
    before, after = rates[:-1], rates[1:]
    w1, w2 = (2 * width[1:] + width[:-1])[:, None], (width[1:] + 2 * width[:-1])[:, None]
    onward = before * after > 0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = (w1 + w2) / (w1 / before + w2 / after)
    slopes[1:-1] = np.where(onward, mean, 0.0)
    return slopes


def turns_between(times: F64, quats: F64, at: F64, smooth: bool) -> F64:
    """Unit quaternions `[T, 4]`, wxyz, at times `[T]`: from key to key about one axis, the short way.

    Smooth ones follow a monotone cubic of the angle turned so far, so that the turn does not stop at keys.
    """
    if len(times) == 1:
        return np.repeat(quats, len(at), axis=0)
    keys = quats * short_way(quats)[:, None]
    cosines = np.clip((keys[:-1] * keys[1:]).sum(axis=1), -1.0, 1.0)
    # atan2 keeps the angle of tiny turns, whose cosine is one.
    steps = 2 * np.arctan2(np.linalg.norm(keys[1:] - keys[:-1], axis=1), np.linalg.norm(keys[1:] + keys[:-1], axis=1))
    turned = np.concatenate([[0.0], np.cumsum(steps)])  # radians on the sphere of quaternions
    now = np.clip(at, times[0], times[-1])
    left = np.clip(np.searchsorted(times, now, side="right") - 1, 0, len(times) - 2)
    so_far = between(times, turned[:, None], now, smooth)[:, 0] - turned[left]
    step = steps[left]
    share = np.divide(so_far, step, out=np.zeros_like(so_far), where=step > 1e-12)[:, None]
    a, b, angle = keys[left], keys[left + 1], np.arccos(cosines[left])[:, None]
    near = angle < 1e-4  # the chord is the arc to 1e-9
    sine = np.where(near, 1.0, np.sin(angle))
    arc = np.where(near, a + share * (b - a), (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / sine)
    return np.asarray(arc / np.linalg.norm(arc, axis=1, keepdims=True))


def short_way(quats: F64) -> F64:
    """`[K]` signs by which quaternions `[K, 4]` are multiplied so that none is farther than a half turn from the one
    before."""
    turned_back = (quats[:-1] * quats[1:]).sum(axis=1) < 0
    signs: F64 = np.where(np.concatenate([[0], np.cumsum(turned_back)]) % 2 == 0, 1.0, -1.0)
    return signs


def matrices(quats: F64) -> F64:
    """Rotation matrices `[..., 3, 3]` of unit quaternions `[..., 4]`, wxyz."""
    w, x, y, z = np.moveaxis(quats, -1, 0)
    rows = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return np.stack(rows, axis=-1).reshape(*quats.shape[:-1], 3, 3)


def quaternions(rotations: F64) -> F64:
    """Unit quaternions `[K, 4]`, wxyz, w >= 0, of rotation matrices `[K, 3, 3]`."""
    import torch

    from ..rotations import from_matrix

    return np.asarray(from_matrix(torch.from_numpy(np.ascontiguousarray(rotations))).numpy())


def about(axis: F64, angles: F64) -> F64:
    """Unit quaternions `[K, 4]`, wxyz, of turns by `angles` `[K]` (radians) about a unit axis `[3]`."""
    half = angles[:, None] / 2
    return np.asarray(np.concatenate([np.cos(half), np.sin(half) * axis], axis=1))
