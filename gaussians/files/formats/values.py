"""Converts between stored values (logits, logarithms, packed rotations) and physical ones, and drops invalid rows.

Conversions run in float64 and are rounded once to float32. With correct rounding of a smooth function and its inverse,
a second conversion returns the bits of the first: either the value or its logarithm lies on the coarser grid.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...errors import FileError, UserError

Floats = NDArray[np.float32]

OPACITY_MIN = 2.0**-24  # the largest float32 below one is 1 - 2^-24; both ends keep a finite logit of 16.6
OPACITY_MAX = 1.0 - 2.0**-24
SCALE_MIN = float(np.finfo(np.float32).tiny)
UNIT_TOLERANCE = 1e-6  # rounding a unit quaternion to float32 changes its length by at most 1.2e-7
_BLOCK = 1 << 16  # rows converted at a time, so that float64 temporaries stay in cache


def scales_from_logs(logs: Floats) -> Floats:
    """Standard deviations `[N, 3]` of stored logarithms; minus infinity (a flat Gaussian) becomes `SCALE_MIN`."""
    return _by_block(logs, lambda block: np.maximum(np.exp(block), SCALE_MIN))


def logs_from_scales(scales: Floats) -> Floats:
    """Stored logarithms `[N, 3]` of standard deviations."""
    return _by_block(scales, lambda block: np.log(np.maximum(block, SCALE_MIN)))


def opacities_from_logits(logits: Floats) -> Floats:
    """Opacities `[N]` in (0, 1); infinite logits, which some converters write for 0 and 1, are clamped."""
    return _by_block(logits, lambda block: np.clip(1 / (1 + np.exp(-block)), OPACITY_MIN, OPACITY_MAX))


def logits_from_opacities(opacities: Floats) -> Floats:
    """Stored logits `[N]`; opacities are first clamped away from 0 and 1."""

    def logit(block: NDArray[np.float64]) -> NDArray[np.float64]:
        inside = np.clip(block, OPACITY_MIN, OPACITY_MAX)
        return np.log(inside) - np.log1p(-inside)

    return _by_block(opacities, logit)


def rounded(values: NDArray[np.float64]) -> Floats:
    """Round to float32; values that are too large become infinite, and `sound_cloud` reports them."""
    with np.errstate(over="ignore", invalid="ignore"):
        return values.astype(np.float32)


def opacities_from_bytes(codes: NDArray[np.integer]) -> Floats:
    """Opacities `[N]` in (0, 1) of linear bytes 0 to 255."""
    return np.clip(codes / 255, OPACITY_MIN, OPACITY_MAX).astype(np.float32)


def smallest_three(thirds: NDArray[np.float64], largest: NDArray[np.integer]) -> Floats:
    """Unpack unit quaternions `[N, 4]` wxyz that were stored without their largest component, which is positive.

    Args:
        thirds: `[N, 3]` in [0, 1], the other components in order, mapped from -1/√2 to 1/√2.
        largest: `[N]` index 0 to 3 of the missing component.
    """
    three = (thirds - 0.5) * np.sqrt(2)
    index = largest.astype(np.int64)
    rest = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[index]
    quats = np.empty((len(three), 4))
    np.put_along_axis(quats, rest, three, axis=1)
    missing = np.sqrt(np.maximum(0, 1 - np.einsum("ij,ij->i", three, three)))
    np.put_along_axis(quats, index[:, None], missing[:, None], axis=1)
    return quats.astype(np.float32)


def without_largest(quats: Floats) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Pack quaternions `[N, 4]` without their largest component; inverse of `smallest_three` up to the range.

    Returns:
        `[N, 3]` the other components in order, times √2 and so in [-1, 1], of q or -q, whichever has a positive
        largest component; and `[N]` the index of the largest.
    """
    unit = unit_quats(quats)[0].astype(np.float64)
    index = np.argmax(np.abs(unit), axis=1)
    sign = np.where(np.take_along_axis(unit, index[:, None], axis=1) < 0, -1.0, 1.0)
    rest = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[index]
    return np.clip(np.take_along_axis(unit, rest, axis=1) * sign * np.sqrt(2), -1, 1), index


def codes(values: NDArray[np.floating], top: int) -> NDArray[np.uint32]:
    """Quantise values, clamped to [0, 1], to the integers 0 to `top`."""
    return np.rint(np.clip(values, 0, 1) * top).astype(np.uint32)


def columns(cloud: GaussianCloud) -> dict[str, Floats]:
    """The cloud's columns as NumPy arrays by name, for formats that cannot store non-finite values.

    Raises:
        UserError: some rows hold NaN or infinite values.
    """
    found = {name: column.detach().cpu().numpy() for name, column in cloud.columns()}
    sound = np.isfinite(found["opacities"])
    for name in ("means", "quats", "scales", "sh"):
        sound &= _finite_rows(found[name])
    if not sound.all():
        raise UserError(
            f"{int((~sound).sum()):,} Gaussians hold NaN or infinite values, which only INRIA .ply can store; remove "
            "them first"
        )
    return found


def unit_quats(quats: Floats) -> tuple[Floats, int]:
    """Quaternions `[N, 4]` scaled to unit length, and the number of zero or non-finite ones, which become the identity.

    Rows of unit length within float32 rounding are kept, so that reading a written file changes no bit.
    """
    length = np.sqrt(np.einsum("ij,ij->i", quats, quats, dtype=np.float64))
    lost = ~(length > 0) | ~np.isfinite(length)
    off = (np.abs(length - 1) > UNIT_TOLERANCE) | lost
    if not off.any():
        return quats, 0
    out = quats.copy()
    with np.errstate(all="ignore"):
        out[off] = quats[off] / length[off, None]
    out[lost] = (1, 0, 0, 0)
    return out, int(lost.sum())


def sound_cloud(
    means: Floats, quats: Floats, scales: Floats, opacities: Floats, sh: Floats
) -> tuple[GaussianCloud, tuple[str, ...]]:
    """A cloud of the finite rows, with row numbers of the file as ids, and a note for each kind of repair.

    Args:
        means, quats, scales, opacities, sh: physical values in the cloud's shapes, possibly invalid.

    Raises:
        FileError: no row is usable.
    """
    cloud, turned = sound_rows(means, quats, scales, opacities, sh)
    if not len(cloud):
        raise FileError(f"none of its {len(means):,} Gaussians is usable: every row holds NaN or infinite values")
    return cloud, repairs(len(means), len(cloud), turned)


def sound_rows(
    means: Floats, quats: Floats, scales: Floats, opacities: Floats, sh: Floats, first: int = 0
) -> tuple[GaussianCloud, int]:
    """A cloud of the finite rows, which may be none, and the number of quaternions that became the identity.

    Args:
        means, quats, scales, opacities, sh: as in `sound_cloud`, of some rows of a file.
        first: row number in the file of the first of them.
    """
    sound = np.isfinite(opacities)
    for column in (means, quats, scales, sh):
        sound &= _finite_rows(column)
    ids = np.arange(first, first + len(means), dtype=np.int64)
    if not sound.all():
        means, quats, scales, opacities, sh = (c[sound] for c in (means, quats, scales, opacities, sh))
        ids = ids[sound]
    quats, turned = unit_quats(quats)
    columns = {"means": means, "quats": quats, "scales": scales, "opacities": opacities, "sh": sh, "ids": ids}
    return GaussianCloud.create(**{name: torch.from_numpy(c) for name, c in columns.items()}), turned


def repairs(rows: int, loaded: int, turned: int) -> tuple[str, ...]:
    """What was repaired in a file of `rows`, of which `loaded` were sound, a sentence for each kind."""
    notes = []
    if loaded < rows:
        notes.append(f"{rows - loaded:,} of {rows:,} Gaussians were dropped: NaN or infinite values")
    if turned:
        notes.append(f"{turned:,} zero quaternions were replaced by the identity rotation")
    return tuple(notes)


def _finite_rows(column: Floats) -> NDArray[np.bool_]:
    """`[N]`, whether all values of a row are finite, by their sum: one pass without a mask."""
    flat = column.reshape(len(column), -1)
    with np.errstate(all="ignore"):
        total = flat.sum(axis=1, dtype=np.float64)  # float64 so that large float32 terms cannot overflow
    finite: NDArray[np.bool_] = np.isfinite(total)
    return finite


def _by_block(values: Floats, function: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Floats:
    """`function` on float64 copies of blocks of rows, rounded into a new float32 array."""
    out = np.empty_like(values)
    with np.errstate(all="ignore"):  # overflow gives infinity, which `sound_cloud` reports
        for start in range(0, len(values), _BLOCK):
            out[start : start + _BLOCK] = function(values[start : start + _BLOCK].astype(np.float64))
    return out
