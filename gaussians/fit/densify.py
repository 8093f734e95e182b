"""Densification and pruning during training: two strategies behind one protocol. Names follow gsplat's strategies.

`MCMCStrategy` keeps to a maximum number: it relocates transparent Gaussians onto others and adds copies, where a group
of copies is rescaled to look like the original, and it adds noise to the positions of faint Gaussians (Kheradmand et
al. 2024, "3D Gaussian Splatting as Markov Chain Monte Carlo"). Unlike the published method, Gaussians to copy are drawn
not by opacity alone but by opacity times accumulated 2-D centre gradient, since that is large where the image is wrong.
`DefaultStrategy` splits and clones by the 2-D centre gradient, prunes faint Gaussians, and periodically resets all
opacities (Kerbl et al. 2023).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .. import compiled, rotations
from ..compiled import exact
from .parameters import Parameters

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]
Numbers = TypeVar("Numbers", F32, Tensor)  # on the host, or on a device
f4 = np.float32

# Logit of opacity 0.07, above which no noise is added: the published noise is 1/700 of its maximum there.
NOISE_MAX_LOGIT = math.log(0.07 / 0.93)
MAX_NOISE = 3.0  # standard deviation of the noise of one step, in the Gaussian's own standard deviations
PRUNE_OPA = 0.005  # Gaussians of lower opacity are relocated or pruned


class Strategy(Protocol):
    """Densifies and prunes. Changes parameters in place."""

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """Add the gradients of the strategy's regularisation terms."""
        ...

    def after_step(self, parameters: Parameters, centers: F32, size: tuple[int, int], means_lr: float) -> None:
        """After each step: accumulate the gradients of the footprint centres `[N, 2]` (1/px, image of `size`)."""
        ...

    def after_step_torch(
        self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], means_lr: float
    ) -> None:
        """`after_step` with the arrays of the parameters and the gradients as tensors on a device."""
        ...

    def refine(self, parameters: Parameters, step: int) -> None:
        """Densify and prune, and clear the accumulated gradients."""
        ...


@dataclass
class _Grad2d:
    """Accumulated gradients of the footprint centres since the last refinement.

    Attributes:
        grad2d: `[N]` summed lengths of the centre gradients, in 1/(half the image).
        count: `[N]` number of photographs with a non-zero gradient.
    """

    grad2d: F32 = field(default_factory=lambda: np.zeros(0, np.float32))
    count: F32 = field(default_factory=lambda: np.zeros(0, np.float32))

    def add(self, centers: F32, size: tuple[int, int]) -> None:
        """Add the gradients `[N, 2]` (1/px) of an image of `size`."""
        if len(self.grad2d) != len(centers):
            self.grad2d, self.count = np.zeros((2, len(centers)), np.float32)
        half = f4(size[0] / 2), f4(size[1] / 2)
        compiled.run(_add_lengths, compiled.workers(), centers, half, self.grad2d, self.count)


@dataclass
class MCMCStrategy:
    """Relocate, add copies and add noise, up to a maximum number of Gaussians.

    Attributes:
        cap_max: maximum number of Gaussians.
        rng: draws copies and noise.
        grow_share: Gaussians added per refinement, as a share of the current number. Published is 0.05, for trainings
            several times as long; so is `noise_lr`, 5e5 (measured in docs/fit.md).
        opacity_reg, scale_reg: weights of the mean opacity and the mean scale in the loss; Gaussians that no photograph
            needs fade.
        noise_lr: noise on the means of faint Gaussians, times the learning rate of means and their own covariance.
    """

    cap_max: int
    rng: np.random.Generator
    grow_share: float = 0.15
    opacity_reg: float = 0.01
    scale_reg: float = 0.01
    noise_lr: float = 5e4
    _grads: _Grad2d = field(default_factory=_Grad2d, repr=False)

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """See `Strategy`."""
        count = np.float32(max(len(opacities), 1))
        by_opacity, by_scale = np.float32(self.opacity_reg) / count, np.float32(self.scale_reg) / (3 * count)
        gradients["logit_opacities"] += float(by_opacity) * opacities * (1 - opacities)
        gradients["log_scales"] += float(by_scale) * scales

    def after_step(self, parameters: Parameters, centers: F32, size: tuple[int, int], means_lr: float) -> None:
        """See `Strategy`."""
        self._grads.add(centers, size)
        rows = np.flatnonzero(parameters.logit_opacities < NOISE_MAX_LOGIT)
        if not len(rows):
            return
        noise = self._noise(parameters.logit_opacities[rows], parameters.log_scales[rows], means_lr)
        columns = parameters.means, parameters.quats, parameters.log_scales
        compiled.run(_add_noise, compiled.workers(), rows, *columns, noise)

    def after_step_torch(
        self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], means_lr: float
    ) -> None:
        """See `Strategy`. Noise is drawn on the host, so that one generator covers the whole training."""
        self._grads.add(centers.cpu().numpy(), size)
        rows = (values["logit_opacities"] < NOISE_MAX_LOGIT).nonzero().squeeze(1)
        if not len(rows):
            return
        logits, log_scales = values["logit_opacities"][rows].cpu().numpy(), values["log_scales"][rows]
        noise = torch.from_numpy(self._noise(logits, log_scales.cpu().numpy(), means_lr)).to(log_scales.device)
        axes = rotations.to_matrix(rotations.normalize(values["quats"][rows]))
        values["means"][rows] += (axes * (noise * log_scales.exp())[:, None, :]).sum(dim=2)

    def _noise(self, logits: F32, log_scales: F32, means_lr: float) -> F32:
        """Noise of one step for faint Gaussians, `[M, 3]` along their axes, in their own standard deviations."""
        with np.errstate(over="ignore"):
            opacities = f4(1) / (f4(1) + np.exp(-logits))
            amount = means_lr * self.noise_lr / (1 + np.exp(100 * (opacities - PRUNE_OPA)))
        # Published is the covariance times noise without a bound, which throws wide Gaussians out of the scene.
        share = np.minimum(amount[:, None] * np.exp(log_scales), MAX_NOISE)
        return share.astype(np.float32) * self.rng.standard_normal((len(logits), 3), dtype=np.float32)

    def refine(self, parameters: Parameters, step: int) -> None:
        """See `Strategy`."""
        opacities = parameters.opacities
        count = len(parameters)
        dead, alive = np.flatnonzero(opacities <= PRUNE_OPA), np.flatnonzero(opacities > PRUNE_OPA)
        added = max(0, min(self.cap_max, int((1 + self.grow_share) * count)) - count)
        grad2d, self._grads = self._grads.grad2d, _Grad2d()
        if not len(alive) or not len(dead) + added:
            return
        weights = opacities[alive].astype(np.float64)
        if len(grad2d) == count and grad2d[alive].any():
            weights *= grad2d[alive]
        source = alive[self.rng.choice(len(alive), len(dead) + added, p=weights / weights.sum())]
        copied = np.unique(source)
        ratios = np.bincount(source, minlength=count)[copied] + 1
        opacity, scale = compute_relocation(opacities[copied], np.exp(parameters.log_scales[copied]), ratios)
        opacity = np.clip(opacity, PRUNE_OPA, 1 - 1e-6)
        parameters.logit_opacities[copied] = np.log(opacity / (1 - opacity))
        parameters.log_scales[copied] = np.log(scale)
        parameters.reset_optimisers(copied)
        parameters.overwrite(dead, source[: len(dead)])
        parameters.append(source[len(dead) :])


MAX_RATIO = 50  # larger numbers of copies count as this: the sum alternates and loses precision beyond


def compute_relocation(opacities: F32, scales: F32, ratios: I64) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Opacity `[M]` and scales `[M, 3]` of each of `ratios` `[M]` coincident copies that together look like one.

    Kheradmand et al. 2024, equation 9: equal transmittance at the centre, equal integrated alpha.
    """
    ratios = np.minimum(ratios, MAX_RATIO)
    original = opacities.astype(np.float64)
    each = 1 - (1 - original) ** (1 / ratios)
    denominator = np.zeros(len(original))
    for i in range(1, int(ratios.max(initial=1)) + 1):
        rows = ratios >= i
        for k in range(i):
            denominator[rows] += math.comb(i - 1, k) * (-1) ** k / math.sqrt(k + 1) * each[rows] ** (k + 1)
    return each, scales * (original / denominator)[:, None]


@dataclass
class DefaultStrategy:
    """Split, clone, prune and reset (Kerbl et al. 2023).

    Attributes:
        extent: of the scene, scene units.
        rng: draws the positions of splits.
        cap_max: number of Gaussians beyond which none are added; None: no limit.
        grow_grad2d: mean length of the centre gradient, in 1/(half the image), from which a Gaussian is split or
            cloned.
        grow_scale3d: larger Gaussians are split, smaller ones cloned; share of the extent.
        prune_scale3d: larger Gaussians are pruned after the first reset; share of the extent.
        reset_every: steps between two resets of the opacities.
    """

    extent: float
    rng: np.random.Generator
    cap_max: int | None = None
    grow_grad2d: float = 2e-4
    grow_scale3d: float = 0.01
    prune_scale3d: float = 0.1
    reset_every: int = 3000
    _grads: _Grad2d = field(default_factory=_Grad2d, repr=False)

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """See `Strategy`; no regularisation."""

    def after_step(self, parameters: Parameters, centers: F32, size: tuple[int, int], means_lr: float) -> None:
        """See `Strategy`."""
        self._grads.add(centers, size)

    def after_step_torch(
        self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], means_lr: float
    ) -> None:
        """See `Strategy`."""
        self._grads.add(centers.cpu().numpy(), size)

    def refine(self, parameters: Parameters, step: int) -> None:
        """See `Strategy`."""
        grow = self._grads.grad2d / np.maximum(self._grads.count, 1) >= self.grow_grad2d
        grow = grow if len(grow) == len(parameters) else np.zeros(len(parameters), bool)
        if self.cap_max is not None and len(parameters) + grow.sum() > self.cap_max:
            grow[:] = False
        large = np.exp(parameters.log_scales).max(axis=1) > self.grow_scale3d * self.extent
        self._split(parameters, np.flatnonzero(grow & large))
        parameters.append(np.flatnonzero(grow & ~large))
        prune = np.zeros(len(parameters), bool)
        prune[np.flatnonzero(grow & large)] = True  # replaced by the two of the split
        prune |= parameters.opacities < PRUNE_OPA
        if step > self.reset_every:
            prune |= np.exp(parameters.log_scales).max(axis=1) > self.prune_scale3d * self.extent
        if not prune.all():
            parameters.take(np.flatnonzero(~prune))
        if step % self.reset_every == 0:
            opacity, logits = 2 * PRUNE_OPA, parameters.logit_opacities
            logits[:] = np.minimum(logits, np.float32(math.log(opacity / (1 - opacity))))
            parameters.optimisers["logit_opacities"].reset(np.arange(len(parameters)))
        self._grads = _Grad2d()

    def _split(self, parameters: Parameters, rows: I64) -> None:
        """Append two smaller Gaussians for each row, at positions drawn from it."""
        for _ in range(2):
            first = len(parameters)
            parameters.append(rows)
            offsets = np.einsum("nij,nj->ni", _axes(parameters, rows), self.rng.standard_normal((len(rows), 3)))
            parameters.means[first:] += offsets.astype(np.float32)
            parameters.log_scales[first:] -= np.float32(math.log(1.6))


@exact
def _add_lengths(worker, workers, vectors, half, sums, times):  # type: ignore[no-untyped-def]
    """Add the lengths of vectors `[N, 2]`, each coordinate times its `half`, to sums; count the non-zero ones."""
    count = vectors.shape[0]
    for n in range(count * worker // workers, count * (worker + 1) // workers):
        x, y = vectors[n, 0] * half[0], vectors[n, 1] * half[1]
        length = np.sqrt(x * x + y * y)
        sums[n] += length
        times[n] += f4(length > f4(0))


@exact
def _add_noise(worker, workers, rows, means, quats, logs, amounts):  # type: ignore[no-untyped-def]
    """Move the means of some rows along their three axes by `amounts` `[M, 3]` standard deviations."""
    for k in range(rows.shape[0] * worker // workers, rows.shape[0] * (worker + 1) // workers):
        n = rows[k]
        w, x, y, z = quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3]
        s = f4(2) / max(w * w + x * x + y * y + z * z, f4(1e-30))
        a, b, c = (
            amounts[k, 0] * np.exp(logs[n, 0]), amounts[k, 1] * np.exp(logs[n, 1]), amounts[k, 2] * np.exp(logs[n, 2]),
        )  # fmt: skip
        means[n, 0] += a * (f4(1) - s * (y * y + z * z)) + b * s * (x * y - w * z) + c * s * (x * z + w * y)
        means[n, 1] += a * s * (x * y + w * z) + b * (f4(1) - s * (x * x + z * z)) + c * s * (y * z - w * x)
        means[n, 2] += a * s * (x * z - w * y) + b * s * (y * z + w * x) + c * (f4(1) - s * (x * x + y * y))


def _axes(parameters: Parameters, rows: I64) -> NDArray[np.float32]:
    """`[M, 3, 3]`: the axes of some Gaussians as columns, scaled by their standard deviations."""
    quats = torch.nn.functional.normalize(torch.from_numpy(parameters.quats[rows]), dim=1)
    axes: NDArray[np.float32] = rotations.to_matrix(quats).numpy() * np.exp(parameters.log_scales[rows])[:, None, :]
    return axes
