"""When Gaussians come and go while a scene is trained: two strategies behind one protocol.

`Budgeted` keeps to a number: Gaussians that have become transparent move onto others, new ones are copies, and a group
of copies is made so that together it looks like the one it came from; a little noise lets faint ones wander (Kheradmand
et al. 2024, "3D Gaussian Splatting as Markov Chain Monte Carlo"). Copied are not the most opaque alone, as published,
but those that are also pulled about most, since there the picture is wrong. `Classic` splits and clones where
footprints are pulled about, prunes what is faint, and now and then makes everything faint (Kerbl et al. 2023).

Knows parameters and gradients. Refuses to know pictures and time.
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

WANDERING = math.log(0.07 / 0.93)  # logit of an opacity from which there is no noise to speak of: 1/700 of the most
FARTHEST = 3.0  # of its own widths that a faint Gaussian wanders in a step
FAINT = 0.005  # opacity below which a Gaussian is as good as gone


class Growth(Protocol):
    """A strategy. It changes parameters in place."""

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """Add to the gradients what the strategy wants besides a good picture."""
        ...

    def stepped(self, parameters: Parameters, centers: F32, size: tuple[int, int], rate: float) -> None:
        """After each step: note gradients of the footprints' centres `[N, 2]` (1/px, of a picture of `size`)."""
        ...

    def stepped_there(self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], rate: float) -> None:
        """`stepped`, where the arrays of the parameters and the gradients are tensors on a device."""
        ...

    def change(self, parameters: Parameters, step: int) -> None:
        """Every so many steps: let Gaussians come and go. What was noted before is forgotten."""
        ...


@dataclass
class _Pulls:
    """How much the photographs have pulled at the centre of each Gaussian since the number last changed.

    Attributes:
        sum: `[N]` lengths of the centres' gradients, in 1/(half the picture), added up.
        times: `[N]` photographs in which there was one.
    """

    sum: F32 = field(default_factory=lambda: np.zeros(0, np.float32))
    times: F32 = field(default_factory=lambda: np.zeros(0, np.float32))

    def note(self, centers: F32, size: tuple[int, int]) -> None:
        """Add the gradients `[N, 2]` (1/px) of a picture of `size`."""
        if len(self.sum) != len(centers):
            self.sum, self.times = np.zeros((2, len(centers)), np.float32)
        half = f4(size[0] / 2), f4(size[1] / 2)
        compiled.run(_add_lengths, compiled.workers(), centers, half, self.sum, self.times)


@dataclass
class Budgeted:
    """Growth by error under a budget.

    Attributes:
        most: Gaussians.
        rng: what copies are drawn by.
        share: how many are added at a time, of those there are. Published is 0.05, for trainings several times as long;
            so is `noise`, 5e5 (measured in docs/fit.md).
        opacity, scale: weights of the mean opacity and the mean scale in the loss: what a picture does not need fades.
        noise: of faint Gaussians, times the rate of means and their own covariance.
    """

    most: int
    rng: np.random.Generator
    share: float = 0.15
    opacity: float = 0.01
    scale: float = 0.01
    noise: float = 5e4
    _pulls: _Pulls = field(default_factory=_Pulls, repr=False)

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """See `Growth`."""
        count = np.float32(max(len(opacities), 1))
        by_opacity, by_scale = np.float32(self.opacity) / count, np.float32(self.scale) / (3 * count)
        gradients["logits"] += float(by_opacity) * opacities * (1 - opacities)
        gradients["logs"] += float(by_scale) * scales

    def stepped(self, parameters: Parameters, centers: F32, size: tuple[int, int], rate: float) -> None:
        """See `Growth`."""
        self._pulls.note(centers, size)
        rows = np.flatnonzero(parameters.logits < WANDERING)
        if not len(rows):
            return
        noise = self._noise(parameters.logits[rows], parameters.logs[rows], rate)
        columns = parameters.means, parameters.quats, parameters.logs
        compiled.run(_along_axes, compiled.workers(), rows, *columns, noise)

    def stepped_there(self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], rate: float) -> None:
        """See `Growth`. Chance is drawn on the host, so that one generator tells the whole training."""
        self._pulls.note(centers.cpu().numpy(), size)
        rows = (values["logits"] < WANDERING).nonzero().squeeze(1)
        if not len(rows):
            return
        logits, logs = values["logits"][rows].cpu().numpy(), values["logs"][rows]
        noise = torch.from_numpy(self._noise(logits, logs.cpu().numpy(), rate)).to(logs.device)
        axes = rotations.to_matrix(rotations.normalize(values["quats"][rows]))
        values["means"][rows] += (axes * (noise * logs.exp())[:, None, :]).sum(dim=2)

    def _noise(self, logits: F32, logs: F32, rate: float) -> F32:
        """How far faint Gaussians `[M]` wander in one step, in their own widths `[M, 3]`."""
        with np.errstate(over="ignore"):
            opacities = f4(1) / (f4(1) + np.exp(-logits))
            amount = rate * self.noise / (1 + np.exp(100 * (opacities - FAINT)))
        # Published is the covariance times noise, which throws wide ones out of the scene.
        share = np.minimum(amount[:, None] * np.exp(logs), FARTHEST)
        return share.astype(np.float32) * self.rng.standard_normal((len(logits), 3), dtype=np.float32)

    def change(self, parameters: Parameters, step: int) -> None:
        """See `Growth`."""
        opacities = parameters.opacities
        count = len(parameters)
        dead, alive = np.flatnonzero(opacities <= FAINT), np.flatnonzero(opacities > FAINT)
        added = max(0, min(self.most, int((1 + self.share) * count)) - count)
        pulled, self._pulls = self._pulls.sum, _Pulls()
        if not len(alive) or not len(dead) + added:
            return
        weights = opacities[alive].astype(np.float64)
        if len(pulled) == count and pulled[alive].any():
            weights *= pulled[alive]
        source = alive[self.rng.choice(len(alive), len(dead) + added, p=weights / weights.sum())]
        copied = np.unique(source)
        times = np.bincount(source, minlength=count)[copied] + 1
        opacity, scale = shared(opacities[copied], np.exp(parameters.logs[copied]), times)
        opacity = np.clip(opacity, FAINT, 1 - 1e-6)
        parameters.logits[copied] = np.log(opacity / (1 - opacity))
        parameters.logs[copied] = np.log(scale)
        parameters.forget(copied)
        parameters.put(dead, source[: len(dead)])
        parameters.append(source[len(dead) :])


MOST_SHARED = 50  # copies of one Gaussian that are told apart: the sums alternate and lose digits beyond


def shared(opacities: F32, scales: F32, times: I64) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Opacity `[M]` and scales `[M, 3]` of each of `times` copies in one place that together look like one Gaussian.

    Kheradmand et al. 2024, equation 9: the same transmittance at the centre, the same light in all.
    """
    times = np.minimum(times, MOST_SHARED)
    whole = opacities.astype(np.float64)
    each = 1 - (1 - whole) ** (1 / times)
    light = np.zeros(len(whole))
    for i in range(1, int(times.max(initial=1)) + 1):
        rows = times >= i
        for k in range(i):
            light[rows] += math.comb(i - 1, k) * (-1) ** k / math.sqrt(k + 1) * each[rows] ** (k + 1)
    return each, scales * (whole / light)[:, None]


@dataclass
class Classic:
    """Split, clone, prune and reset, as published.

    Attributes:
        extent: of the scene, scene units: what is large or small is said in shares of it.
        rng: what splits are drawn by.
        most: Gaussians, beyond which none are added; None: as many as come.
        pull: mean length of a centre's gradient, in 1/(half the picture), from which a Gaussian is not enough.
        reset_every: steps between two resets of the opacities.
    """

    extent: float
    rng: np.random.Generator
    most: int | None = None
    pull: float = 2e-4
    reset_every: int = 3000
    _pulls: _Pulls = field(default_factory=_Pulls, repr=False)

    def regularise(self, gradients: dict[str, Numbers], scales: Numbers, opacities: Numbers) -> None:
        """See `Growth`: nothing."""

    def stepped(self, parameters: Parameters, centers: F32, size: tuple[int, int], rate: float) -> None:
        """See `Growth`."""
        self._pulls.note(centers, size)

    def stepped_there(self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], rate: float) -> None:
        """See `Growth`."""
        self._pulls.note(centers.cpu().numpy(), size)

    def change(self, parameters: Parameters, step: int) -> None:
        """See `Growth`."""
        pulled = self._pulls.sum / np.maximum(self._pulls.times, 1) >= self.pull
        pulled = pulled if len(pulled) == len(parameters) else np.zeros(len(parameters), bool)
        if self.most is not None and len(parameters) + pulled.sum() > self.most:
            pulled[:] = False
        large = np.exp(parameters.logs).max(axis=1) > 0.01 * self.extent
        self._split(parameters, np.flatnonzero(pulled & large))
        parameters.append(np.flatnonzero(pulled & ~large))
        gone = np.zeros(len(parameters), bool)
        gone[np.flatnonzero(pulled & large)] = True  # two smaller ones stand in its place
        gone |= parameters.opacities < FAINT
        if step > self.reset_every:
            gone |= np.exp(parameters.logs).max(axis=1) > 0.1 * self.extent
        if not gone.all():
            parameters.take(np.flatnonzero(~gone))
        if step % self.reset_every == 0:
            faint = 2 * FAINT
            parameters.logits[:] = np.minimum(parameters.logits, np.float32(math.log(faint / (1 - faint))))
            parameters.memory["logits"].forget(np.arange(len(parameters)))
        self._pulls = _Pulls()

    def _split(self, parameters: Parameters, rows: I64) -> None:
        """Add two smaller ones for each, drawn from it."""
        for _ in range(2):
            first = len(parameters)
            parameters.append(rows)
            axes = _axes(parameters, rows)
            drawn = np.einsum("nij,nj->ni", axes, self.rng.standard_normal((len(rows), 3)))
            parameters.means[first:] += drawn.astype(np.float32)
            parameters.logs[first:] -= np.float32(math.log(1.6))


@exact
def _add_lengths(worker, workers, vectors, half, sums, times):  # type: ignore[no-untyped-def]
    """Add the lengths of vectors `[N, 2]`, each coordinate times its `half`, to sums; count those that have one."""
    count = vectors.shape[0]
    for n in range(count * worker // workers, count * (worker + 1) // workers):
        x, y = vectors[n, 0] * half[0], vectors[n, 1] * half[1]
        length = np.sqrt(x * x + y * y)
        sums[n] += length
        times[n] += f4(length > f4(0))


@exact
def _along_axes(worker, workers, rows, means, quats, logs, amounts):  # type: ignore[no-untyped-def]
    """Move each of some rows along its three axes by so many standard deviations `[M, 3]`."""
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
    """`[M, 3, 3]`: the axes of some Gaussians as columns, each as long as its standard deviation."""
    quats = torch.nn.functional.normalize(torch.from_numpy(parameters.quats[rows]), dim=1)
    axes: NDArray[np.float32] = rotations.to_matrix(quats).numpy() * np.exp(parameters.logs[rows])[:, None, :]
    return axes
