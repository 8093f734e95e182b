"""Optimise new Gaussians through the differentiable renderer so that they look like pictures; all others stay.

The number of steps depends on the size of the work alone, so that the same input and seed give the same bytes, unless
the machine is so slow that a clock ends it: the rates fall before that, and the steps that were done are told.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.fit.adam import Adam
from ...gaussians.fit.loss import BLACK, photometric
from ...gaussians.harmonics import dc_to_color
from ...gaussians.render import contributions, split
from ...gaussians.render.cpu import gradient
from .target import Target

F32 = NDArray[np.float32]
Columns = tuple[F32, F32, F32, F32, F32]  # means, quats, scales, opacities, harmonics, as a renderer takes them

PASSES = 40  # over all targets, if the work allows
MOST_STEPS, LEAST_STEPS = 1200, 120
WORK = 1.2e9  # (rows + pixels) of all steps: about half a minute on one core
SECONDS = 45.0  # wall time of all steps at most: with what comes before and after, an edit waits a minute for it
_LATE = 0.8  # of this time, from which on the rates fall as at the end
SSIM_SHARE = 0.2  # of the loss, as in training
LAST = 0.1  # of the rates, at the last step
_REACH = 2.0  # standard deviations of a new Gaussian that its centre may move
_SMALLEST, _LARGEST = 0.4, 2.0  # of its size
_FAINTEST, _SOLIDEST = 0.02, 0.99  # opacity
_LEAST, _HALF = 1.0, 2.0  # pixels that tell of a Gaussian: below which it stays, and at which it changes by half
_FLOOR = 1e-6  # distance of an opacity from 0 and 1 before its logit is taken


@dataclass(frozen=True)
class Rates:
    """Learning rates at the first step.

    Attributes:
        means: standard deviations a step.
        sizes: of logarithms.
        opacities: of logits.
        colors: display space.
        bands: of view-dependent bands, as `colors`.
    """

    means: float = 0.02
    sizes: float = 5e-3
    opacities: float = 2e-2
    colors: float = 8e-3
    bands: float = 1e-3


@dataclass
class _Free:
    """What may change of the new Gaussians.

    Attributes:
        start: as they were.
        spread: `[M, 1]`, their largest standard deviations, scene units.
        shifts: `[M, 3]` of the centres, in units of `spread`.
        log_sizes: `[M, 1]`, logarithm of the factor by which their size differs from that at the start.
        logits: `[M]` of the opacities.
        sh: `[M, K, 3]`.
    """

    start: GaussianCloud
    spread: F32
    shifts: F32
    log_sizes: F32
    logits: F32
    sh: F32

    @classmethod
    def of(cls, cloud: GaussianCloud) -> _Free:
        opacities = np.clip(cloud.opacities.numpy(), _FLOOR, 1 - _FLOOR)
        return cls(
            cloud, cloud.scales.amax(dim=1, keepdim=True).numpy(), np.zeros((len(cloud), 3), np.float32),
            np.zeros((len(cloud), 1), np.float32), np.log(opacities / (1 - opacities)).astype(np.float32),
            cloud.sh.numpy().copy(),
        )  # fmt: skip

    def columns(self) -> Columns:
        means = self.start.means.numpy() + self.shifts * self.spread
        scales = self.start.scales.numpy() * np.exp(self.log_sizes)
        opacities: F32 = np.float32(1) / (np.float32(1) + np.exp(-self.logits))
        return means, self.start.quats.numpy(), scales, opacities, self.sh

    def limit(self) -> None:
        """Take back what went beyond the limits."""
        np.clip(self.shifts, -_REACH, _REACH, out=self.shifts)
        np.clip(self.log_sizes, np.log(_SMALLEST), np.log(_LARGEST), out=self.log_sizes)
        np.clip(self.logits, _logit(_FAINTEST), _logit(_SOLIDEST), out=self.logits)

    def weighed(self, evidence: F32) -> GaussianCloud:
        """The Gaussians, changed the less the fewer pixels tell of them; what none tells of stays bit for bit.

        Args:
            evidence: `[M]`, pixels.
        """
        sure = np.where(evidence < _LEAST, 0, evidence / (evidence + _HALF)).astype(np.float32)[:, None]
        start, (means, _, scales, opacities, sh) = self.start, self.columns()

        def mixed(was: Tensor, now: F32) -> Tensor:
            flat = was.numpy().reshape(len(was), -1)
            return torch.from_numpy((flat + sure * (now.reshape(len(was), -1) - flat)).reshape(was.shape))

        return start.replace(
            means=mixed(start.means, means), scales=mixed(start.scales, scales),
            opacities=mixed(start.opacities, opacities), sh=mixed(start.sh, sh),
        )  # fmt: skip


class Optimised(NamedTuple):
    """New Gaussians as they were optimised, and the steps that this took."""

    cloud: GaussianCloud
    steps: int


def optimised(
    old: GaussianCloud,
    new: GaussianCloud,
    targets: Sequence[Target],
    seed: int = 0,
    rates: Rates | None = None,
    passes: int = PASSES,
    seconds: float = SECONDS,
) -> Optimised:
    """The new Gaussians, changed so that they and the old ones look like the targets where these count.

    Centres move at most two standard deviations, proportions and directions stay.

    Args:
        old: all other Gaussians; none of them changes.
        new: float32, on any device.
        seed: of the order of the targets.
        passes: over all targets, if the work allows.
        seconds: of wall time, after which no step is begun.
    """
    targets = [t for t in targets if t.counts.any()]
    if not targets or not len(new):
        return Optimised(new, 0)
    device, new = new.device, new.to(torch.device("cpu"))
    free, rates = _Free.of(new), rates or Rates()
    behind = [_visible(old, target) for target in targets]
    adam = {name: Adam.of(getattr(free, name)) for name in ("shifts", "log_sizes", "logits", "sh")}
    count = _steps(targets, behind, len(new), passes)
    started, done = time.perf_counter(), 0
    for step, which in enumerate(_order(len(targets), count, seed)):
        spent = (time.perf_counter() - started) / max(seconds, 1e-9)
        if spent >= 1:
            break
        slow = LAST ** max(step / max(count - 1, 1), (spent - _LATE) / (1 - _LATE))
        found = _gradients(free, behind[which], targets[which])
        adam["shifts"].step(free.shifts, found["shifts"], slow * rates.means)
        adam["log_sizes"].step(free.log_sizes, found["log_sizes"], slow * rates.sizes)
        adam["logits"].step(free.logits, found["logits"], slow * rates.opacities)
        dc = slow * rates.colors / _DC
        adam["sh"].step(free.sh, found["sh"], dc, slow * rates.bands / _DC)
        free.limit()
        done += 1
    return Optimised(free.weighed(_evidence(old, new, targets)).to(device), done)


_DC = float(dc_to_color(torch.ones(1)) - dc_to_color(torch.zeros(1)))


def _logit(share: float) -> float:
    return float(np.log(share / (1 - share)))


def _visible(old: GaussianCloud, target: Target) -> Columns:
    """The columns of the old Gaussians that a target shows if there are no new ones."""
    rows = (contributions(old, target.camera) > 0).nonzero().squeeze(1)
    cloud = old[rows].to(torch.device("cpu"))
    means, quats, scales, opacities, sh = cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh
    return _array(means), _array(quats), _array(scales), _array(opacities), _array(sh)


def _array(column: Tensor) -> F32:
    return np.ascontiguousarray(column.detach().numpy())


def _evidence(old: GaussianCloud, new: GaussianCloud, targets: Sequence[Target]) -> F32:
    """`[M]`: in how many pixels that count the new Gaussians show, by their blending weight."""
    cloud = concat([old.to(new.device), new])
    total = np.zeros(len(cloud), np.float64)
    for target in targets:
        found = split(cloud, target.camera, target.counts.astype(np.int32))
        counted = found.labels == 1
        np.add.at(total, found.rows[counted], found.weights[counted])
    return total[len(old) :].astype(np.float32)


def _steps(targets: Sequence[Target], behind: Sequence[Columns], new: int, passes: int) -> int:
    """How many steps the work allows."""
    one = float(np.mean([t.counts.size + len(b[0]) + new for t, b in zip(targets, behind, strict=True)]))
    return int(
        np.clip(WORK / max(one * 40, 1.0), LEAST_STEPS, min(MOST_STEPS, max(LEAST_STEPS, passes * len(targets))))
    )


def _order(targets: int, steps: int, seed: int) -> list[int]:
    """Which target each step is against: all of them in a random order, again and again."""
    draw = np.random.default_rng(seed)
    order = list[int]()
    while len(order) < steps:
        order += draw.permutation(targets).tolist()
    return order[:steps]


def _gradients(free: _Free, old: Columns, target: Target) -> dict[str, F32]:
    """Gradients of the loss on one target, by the arrays of the new Gaussians."""
    own = free.columns()
    columns = tuple(np.concatenate([a, b]).astype(np.float32, copy=False) for a, b in zip(old, own, strict=True))
    drawn = gradient.draw(columns, target.camera, BLACK)
    # Pixels that do not count are taken from the render itself: they have no error, and windows over them only that
    # of the pixels that count.
    wanted = np.where(target.counts[..., None], target.rgb, drawn.rgb).astype(np.float32)
    _, d_rgb = photometric(drawn.rgb, wanted, SSIM_SHARE)
    d_rgb *= (target.counts[..., None] * (target.counts.size / target.counts.sum())).astype(np.float32)
    found = gradient.draw_backward(drawn, d_rgb, np.zeros(d_rgb.shape[:2], np.float32))
    n = len(old[0])
    scales, opacities = own[2], own[3]
    return {
        "shifts": np.ascontiguousarray(found.means[n:] * free.spread),
        "log_sizes": np.ascontiguousarray((found.scales[n:] * scales).sum(axis=1, keepdims=True)),
        "logits": np.ascontiguousarray(found.opacities[n:] * opacities * (1 - opacities)),
        "sh": np.ascontiguousarray(found.sh[n:]),
    }
