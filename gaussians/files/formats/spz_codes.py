"""Quantises the attributes of an SPZ file to bytes and back.

The quantisation is Niantic's (github.com/nianticlabs/spz, README "File Format" and load-spz.cc): 24-bit fixed-point
positions, log scales in sixteenths, rotations as three bytes (versions 1 and 2) or 32 bits (3 and 4), opacities and
wide colours in a byte, harmonics as signed 128ths. Axes are right-up-back in the file and right-down-forward here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import values

Bytes = NDArray[np.uint8]
Signs = tuple[int, int, int]

RIGHT_UP_BACK: Signs = (1, -1, -1)  # signs of the file's axes in our right-down-forward axes (those of .ply)
COLOR_GAIN = 0.15  # of the constant coefficient: leaves room for colours that higher bands bring back into range
BITS_FIRST, BITS_HIGHER = 5, 4  # bits kept of the first band and of those above, as in Niantic's writer
STANDARD_FRACTION = 12  # fractional bits of Niantic's writer
_MIN_BITS = 16  # per axis, for the extent of the middle 98 % of a scene
_LIMIT = (1 << 23) - 1
# Parity of each coefficient above the constant band in x, y and z: -1 to this power is its sign after a flip.
_PARITY = np.array(
    [
        (0, 1, 0), (0, 0, 1), (1, 0, 0),
        (1, 1, 0), (0, 1, 1), (0, 0, 0), (1, 0, 1), (0, 0, 0),
        (0, 1, 0), (1, 1, 1), (0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 0, 1), (1, 0, 0),
    ]
)  # fmt: skip


def fraction_bits(means: values.Floats) -> int:
    """Fractional bits for positions `[N, 3]`: 12, more for small scenes, fewer if the positions would not fit.

    A scene is small if 12 fractional bits would give its middle 98 % less than 16 bits per axis. The result is
    negative if the farthest position cannot be represented.
    """
    farthest = float(np.abs(means).max(initial=0))
    span = float((np.quantile(means, 0.99, axis=0) - np.quantile(means, 0.01, axis=0)).max())
    wanted = STANDARD_FRACTION if span <= 0 else max(STANDARD_FRACTION, _MIN_BITS - int(np.floor(np.log2(span))))
    fits = 24 if farthest == 0 else int(np.floor(np.log2(_LIMIT / farthest)))
    return min(wanted, fits, 24)


def positions(packed: Bytes, fraction: int, signs: Signs) -> values.Floats:
    """Positions `[N, 3]` of 24-bit fixed-point numbers `[N, 9]`."""
    words = np.zeros((len(packed) * 3, 4), np.uint8)
    words[:, 1:] = packed.reshape(-1, 3)
    fixed = words.view("<i4").reshape(-1, 3) >> 8  # keeps the sign
    means: values.Floats = fixed.astype(np.float32) * (np.array(signs, np.float32) * np.float32(2.0**-fraction))
    return means


def pack_positions(means: values.Floats, fraction: int) -> Bytes:
    """`[N, 9]` bytes of positions `[N, 3]`."""
    scaled = means.astype(np.float64) * np.array(RIGHT_UP_BACK) * 2.0**fraction
    fixed = np.clip(np.rint(scaled), -_LIMIT - 1, _LIMIT).astype("<i4")
    return np.ascontiguousarray(fixed.reshape(-1, 1).view(np.uint8)[:, :3]).reshape(-1, 9)


def half_positions(packed: Bytes, signs: Signs) -> values.Floats:
    """Positions `[N, 3]` of version 1, half floats `[N, 6]`."""
    return packed.reshape(-1, 6).view("<f2").astype(np.float32) * np.array(signs, np.float32)


def scales(packed: Bytes) -> values.Floats:
    """Standard deviations `[N, 3]`."""
    return values.scales_from_logs(packed.astype(np.float32) / np.float32(16) - np.float32(10))


def pack_scales(deviations: values.Floats) -> Bytes:
    """`[N, 3]` bytes of standard deviations `[N, 3]`, clamped to e^-10 to e^5.9375."""
    return _bytes((values.logs_from_scales(deviations).astype(np.float64) + 10) * 16)


def rotations(packed: Bytes, signs: Signs) -> values.Floats:
    """Quaternions `[N, 4]` wxyz of three bytes each (x, y, z; w is not negative) or four (see `pack_rotations`)."""
    if packed.shape[1] == 3:
        vector = packed.astype(np.float64) / 127.5 - 1
        real = np.sqrt(np.maximum(0, 1 - np.einsum("ij,ij->i", vector, vector)))
        quats = np.concatenate([real[:, None], vector], axis=1)
    else:
        words = np.ascontiguousarray(packed).view("<u4")[:, 0]
        fields = np.stack([words >> np.uint32(shift) for shift in (20, 10, 0)], axis=1)
        size = (fields & np.uint32(511)) / 511
        thirds = np.where(fields & np.uint32(512), -size, size) / 2 + 0.5
        quats = values.smallest_three(thirds, words >> np.uint32(30))[:, [3, 0, 1, 2]].astype(np.float64)
    return (quats * np.array((1, *signs))).astype(np.float32)


def pack_rotations(quats: values.Floats, width: int) -> Bytes:
    """`[N, width]` bytes of quaternions `[N, 4]` wxyz.

    With width 4 they form a word: the index of the largest of x, y, z, w in the two highest bits, then the other three
    in order, each a sign and nine bits of magnitude relative to 1/√2. With width 3 they are x, y, z.
    """
    turned = values.unit_quats(quats)[0] * np.array((1, *RIGHT_UP_BACK), np.float32)
    if width == 3:
        upright = np.where(turned[:, :1] < 0, -turned, turned).astype(np.float64)
        return _bytes(upright[:, 1:] * 127.5 + 127.5)
    thirds, largest = values.without_largest(turned[:, [1, 2, 3, 0]])
    words = largest.astype(np.uint32)
    for i in range(3):
        size = values.codes(np.abs(thirds[:, i]), 511)
        words = (words << np.uint32(10)) | (np.signbit(thirds[:, i]).astype(np.uint32) << np.uint32(9)) | size
    return words.astype("<u4")[:, None].view(np.uint8)


def colors(packed: Bytes) -> values.Floats:
    """Constant coefficients `[N, 3]`."""
    return (packed.astype(np.float32) / np.float32(255) - np.float32(0.5)) / np.float32(COLOR_GAIN)


def pack_colors(dc: values.Floats) -> Bytes:
    """`[N, 3]` bytes of constant coefficients `[N, 3]`, clamped to ±3.33."""
    return _bytes(dc.astype(np.float64) * COLOR_GAIN * 255 + 127.5)


def harmonics(packed: Bytes, signs: Signs) -> values.Floats:
    """Coefficients above the constant band `[N, K - 1, 3]` of bytes `[N, 3 (K - 1)]`, channel innermost."""
    count = packed.shape[1] // 3
    flip = np.prod(np.array(signs) ** _PARITY[:count], axis=1).astype(np.float32) / np.float32(128)
    bands: values.Floats = (packed.reshape(len(packed), count, 3).astype(np.float32) - np.float32(128)) * flip[:, None]
    return bands


def pack_harmonics(rest: values.Floats) -> Bytes:
    """`[N, 3 (K - 1)]` bytes of coefficients clamped to ±1, rounded to `BITS_FIRST` and `BITS_HIGHER` bits."""
    count = rest.shape[1]
    flip = np.prod(np.array(RIGHT_UP_BACK) ** _PARITY[:count], axis=1).astype(np.float32)
    step = np.where(np.arange(count) < 3, 1 << (8 - BITS_FIRST), 1 << (8 - BITS_HIGHER)).astype(np.float32)
    scaled = np.clip(rest * flip[:, None], -1, 1) * np.float32(128) / step[:, None]
    return _bytes((np.rint(scaled) * step[:, None] + 128).reshape(len(rest), 3 * count))


def _bytes(scaled: NDArray[np.floating]) -> Bytes:
    return np.clip(np.rint(scaled), 0, 255).astype(np.uint8)
