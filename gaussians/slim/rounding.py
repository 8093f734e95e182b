"""Rounds the values of a cloud to coarser steps, so that formats which pack bytes without loss store fewer bits.

A format has one step for all values of a kind, and its steps suit scenes that must lose nothing. Rounding to every
second step saves one bit a value in SOG and less in SPZ. The steps here are chosen so that all values cause the same
error (reverse water-filling: a bit saved anywhere then costs the same).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..files.formats import spz_codes, values

F64 = NDArray[np.float64]

VALUES = 13  # stored for a Gaussian: positions, scales and colours 3 each, rotation 3, opacity 1
BYTE = 255  # steps of opacities and of quaternion components in SOG
TOP = 65535  # steps of positions in SOG
LEVELS = 256  # entries of a codebook in SOG; finer steps are left to its own choice of entries


@dataclass(frozen=True)
class Steps:
    """Steps of the stored values; zero leaves them as they are.

    Attributes:
        means: scene units (SPZ), or `sign(x) log(1 + |x|)` of them (SOG).
        log_scales, quats, opacities, sh: in the units of the cloud's columns, natural logarithms for scales.
    """

    means: float = 0.0
    log_scales: float = 0.0
    quats: float = 0.0
    opacities: float = 0.0
    sh: float = 0.0


def steps_for(slopes: dict[str, float], pixels: int, count: int, error: float, logarithmic: bool) -> Steps:
    """The steps with which rounding `count` Gaussians adds about `error` to the mean squared error of the pictures.

    Args:
        slopes, pixels: see `importance.Importance`.
        logarithmic: whether positions are rounded as logarithms.
    """
    if not error > 0:
        return Steps()
    each = error * pixels / (VALUES * count)

    def step(name: str) -> float:  # values rounded to steps of s have the mean squared error s^2 / 12
        return float(np.sqrt(12 * each / slopes[name])) if slopes[name] > 0 else 0.0

    means = step("log_means" if logarithmic else "means")
    return Steps(means, step("log_scales"), step("quats"), step("opacities"), step("sh"))


def round_for_sog(cloud: GaussianCloud, steps: Steps) -> GaussianCloud:
    """The cloud rounded to multiples of SOG's own steps that do not exceed `steps`; colours and scales to `steps`."""
    columns = {name: column.numpy() for name, column in cloud.columns()}
    quats = columns["quats"]
    if (by := _multiple(steps.quats, np.sqrt(2) / BYTE)) > 1:
        thirds, largest = values.without_largest(quats)
        codes = np.clip(np.rint(values.codes(thirds / 2 + 0.5, BYTE) / by) * by, 0, BYTE)
        quats = values.smallest_three(codes / BYTE, largest)
    return cloud.replace(
        means=torch.from_numpy(_log_positions(columns["means"], steps.means)),
        quats=torch.from_numpy(quats),
        scales=torch.from_numpy(_scales(columns["scales"], steps.log_scales)),
        opacities=torch.from_numpy(_opacities(columns["opacities"], steps.opacities)),
        sh=torch.from_numpy(_colors(columns["sh"], steps.sh)),
    )


def round_for_spz(cloud: GaussianCloud, steps: Steps) -> GaussianCloud:
    """The cloud with positions, opacities and colours in multiples of SPZ's own steps that do not exceed `steps`."""
    columns = {name: column.numpy() for name, column in cloud.columns()}
    own = 2.0 ** -spz_codes.fraction_bits(columns["means"])
    by = _power(steps.means / own) * own
    means = (np.rint(columns["means"].astype(np.float64) / by) * by).astype(np.float32)
    color = 1 / (BYTE * spz_codes.COLOR_GAIN)
    sh = _colors(columns["sh"], _multiple(steps.sh, color) * color)
    opacities = _opacities(columns["opacities"], steps.opacities)
    return cloud.replace(means=torch.from_numpy(means), opacities=torch.from_numpy(opacities), sh=torch.from_numpy(sh))


def _log_positions(means: values.Floats, step: float) -> values.Floats:
    """Positions whose codes in SOG are multiples of a power of two; the ends of each axis set the codes and stay."""
    logs = np.sign(means) * np.log1p(np.abs(means.astype(np.float64)))
    low, high = logs.min(axis=0), logs.max(axis=0)
    span = np.where(high > low, high - low, 1.0)
    by = np.array([_power(step * TOP / s) for s in span])
    codes = np.rint((logs - low) / span * TOP)
    rounded = np.clip(np.rint(codes / by) * by, 0, TOP)
    logs = np.where((codes == 0) | (codes == TOP), logs, low + span * rounded / TOP)
    return (np.sign(logs) * np.expm1(np.abs(logs))).astype(np.float32)


def _scales(scales: values.Floats, step: float) -> values.Floats:
    logs = values.logs_from_scales(scales)
    if not step > 0 or np.ptp(logs) / step >= LEVELS:
        return scales
    return values.scales_from_logs((np.rint(logs / step) * step).astype(np.float32))


def _opacities(opacities: values.Floats, step: float) -> values.Floats:
    by = _multiple(step, 1 / BYTE)
    if by == 1:
        return opacities
    codes = np.rint(values.codes(opacities, BYTE) / by) * by
    return values.opacities_from_bytes(np.clip(codes, min(by, BYTE), BYTE).astype(np.int64))


def _colors(sh: values.Floats, step: float) -> values.Floats:
    """`[N, K, 3]` with the constant band in steps."""
    if not step > 0 or np.ptp(sh[:, 0]) / step >= LEVELS:
        return sh
    out = sh.copy()
    out[:, 0] = np.rint(sh[:, 0] / np.float32(step)) * np.float32(step)
    return out


def _multiple(step: float, own: float) -> int:
    """How many steps of a format fit into `step`, at least one and at most a quarter of a byte."""
    return int(np.clip(np.floor(step / own), 1, 64))


def _power(ratio: float) -> int:
    """The largest power of two that is at most `ratio`, at least 1 and at most 4096."""
    return 1 << int(np.clip(np.floor(np.log2(max(ratio, 1.0))), 0, 12))
