"""Trainable parameters of a cloud (log scales, logit opacities) with one Adam optimiser per array.

Learning rates are the released defaults of Kerbl et al. 2023, except for the higher SH bands. The rate of means is
multiplied by the scene's extent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import SH_BANDS, GaussianCloud
from .adam import Adam

F32 = NDArray[np.float32]
Columns = tuple[F32, F32, F32, F32, F32]  # means, quats, scales, opacities, harmonics
I64 = NDArray[np.int64]

QUATS_LR, SCALES_LR, OPACITIES_LR = 1e-3, 5e-3, 5e-2
SH0_LR = 2.5e-3  # of SH band 0
SHN_LR = SH0_LR / 5  # of higher bands; published is a twentieth, for trainings four times as long, see docs/fit.md


@dataclass
class Parameters:
    """N Gaussians in training.

    Attributes:
        means: `[N, 3]`, world, scene units.
        quats: `[N, 4]`, wxyz, of any length.
        log_scales: `[N, 3]`, natural logarithms of the scales.
        logit_opacities: `[N]`.
        sh: `[N, K, 3]`, band 0 first.
        optimisers: one for each array, by its name.
    """

    means: F32
    quats: F32
    log_scales: F32
    logit_opacities: F32
    sh: F32
    optimisers: dict[str, Adam]

    @classmethod
    def of(cls, cloud: GaussianCloud) -> Parameters:
        """The parameters of a cloud, whose opacities must lie strictly between 0 and 1."""
        opacities = cloud.opacities.double().numpy()
        values = {
            "means": cloud.means.numpy().copy(),
            "quats": cloud.quats.numpy().copy(),
            "log_scales": np.log(cloud.scales.numpy()),
            "logit_opacities": np.log(opacities / (1 - opacities)).astype(np.float32),
            "sh": cloud.sh.numpy().copy(),
        }
        return cls(**values, optimisers={name: Adam.of(value) for name, value in values.items()})

    def __len__(self) -> int:
        return len(self.means)

    def arrays(self) -> dict[str, F32]:
        """All arrays by name."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "optimisers"}

    @property
    def degree(self) -> int:
        """Current SH degree."""
        return SH_BANDS[self.sh.shape[1]]

    @property
    def opacities(self) -> F32:
        """`[N]`."""
        with np.errstate(over="ignore"):  # exp may overflow to infinity; 1 / infinity is the right limit
            return np.float32(1) / (np.float32(1) + np.exp(-self.logit_opacities))

    def columns(self) -> Columns:
        """Means, quats, scales, opacities and harmonics as a renderer takes them, with activations applied."""
        return self.means, self.quats, np.exp(self.log_scales), self.opacities, self.sh

    def cloud(self) -> GaussianCloud:
        """A copy as a cloud, with unit quaternions."""
        means, quats, scales, opacities, sh = (torch.from_numpy(c.copy()) for c in self.columns())
        return GaussianCloud.create(means, torch.nn.functional.normalize(quats, dim=1), scales, opacities, sh)

    def step(self, gradients: Mapping[str, F32], means_lr: float) -> None:
        """One optimiser step; `means_lr` is the learning rate of means, scene units."""
        rates = learning_rates(means_lr)
        for name, values in self.arrays().items():
            self.optimisers[name].step(values, gradients[name], rates[name], SHN_LR if name == "sh" else None)

    def take(self, rows: I64) -> None:
        """Keep only some rows, in the order given."""
        for name, values in self.arrays().items():
            setattr(self, name, np.ascontiguousarray(values[rows]))
            self.optimisers[name].take(rows)

    def only(self, rows: I64) -> Parameters:
        """A copy of some rows, in the order given."""
        arrays = {name: np.ascontiguousarray(values[rows]) for name, values in self.arrays().items()}
        adams = {n: Adam(a.first[rows], a.second[rows], a.steps) for n, a in self.optimisers.items()}
        return Parameters(**arrays, optimisers=adams)

    @classmethod
    def joined(cls, parts: Sequence[Parameters]) -> Parameters:
        """All rows of several, with the bands of the highest degree; changes their degree."""
        degree = max(part.degree for part in parts)
        for part in parts:
            part.raise_degree(degree)
        arrays = {name: np.concatenate([part.arrays()[name] for part in parts]) for name in parts[0].arrays()}
        adams = {}
        for name in parts[0].optimisers:
            each = [part.optimisers[name] for part in parts]
            first, second = np.concatenate([a.first for a in each]), np.concatenate([a.second for a in each])
            adams[name] = Adam(first, second, max(a.steps for a in each))
        return cls(**arrays, optimisers=adams)

    def overwrite(self, rows: I64, source: I64) -> None:
        """Overwrite `rows` with copies of `source`, with fresh optimiser state."""
        for values in self.arrays().values():
            values[rows] = values[source]
        self.reset_optimisers(rows)

    def append(self, source: I64) -> None:
        """Append copies of some rows, with fresh optimiser state."""
        for name, values in self.arrays().items():
            setattr(self, name, np.concatenate([values, values[source]]))
            self.optimisers[name].extend(len(source))

    def reset_optimisers(self, rows: I64) -> None:
        """Zero the optimiser state of some rows."""
        for optimiser in self.optimisers.values():
            optimiser.reset(rows)

    def raise_degree(self, degree: int) -> None:
        """Add SH bands up to `degree`, initialised with zero."""
        more = (degree + 1) ** 2 - self.sh.shape[1]
        if more > 0:
            zeros = np.zeros((len(self), more, 3), np.float32)
            self._change_bands(lambda bands: np.concatenate([bands, zeros], axis=1))

    def lower_degree(self, degree: int) -> None:
        """Drop SH bands above `degree`."""
        self._change_bands(lambda bands: np.ascontiguousarray(bands[:, : (degree + 1) ** 2]))

    def _change_bands(self, change: Callable[[F32], F32]) -> None:
        adam = self.optimisers["sh"]
        self.sh, adam.first, adam.second = change(self.sh), change(adam.first), change(adam.second)

    def state(self) -> dict[str, Any]:
        """All arrays by name, including those of the optimisers; `load` reads them."""
        state: dict[str, Any] = dict(self.arrays())
        for name, adam in self.optimisers.items():
            state |= {f"{name}.first": adam.first, f"{name}.second": adam.second, f"{name}.steps": adam.steps}
        return state

    @classmethod
    def load(cls, state: Mapping[str, Any]) -> Parameters:
        """Rebuild from `state`; raises KeyError if an entry is missing."""
        names = [f.name for f in fields(cls) if f.name != "optimisers"]
        optimisers = {n: Adam(state[f"{n}.first"], state[f"{n}.second"], int(state[f"{n}.steps"])) for n in names}
        return cls(**{n: state[n] for n in names}, optimisers=optimisers)


def learning_rates(means_lr: float) -> dict[str, float]:
    """Learning rate of every array of `Parameters` by name; of the harmonics that of band 0."""
    return {
        "means": means_lr, "quats": QUATS_LR, "log_scales": SCALES_LR, "logit_opacities": OPACITIES_LR, "sh": SH0_LR,
    }  # fmt: skip


def parameter_gradients(found: Any, scales: F32, opacities: F32) -> dict[str, F32]:
    """Gradients by the arrays of `Parameters` from those by a renderer's columns (`render.cpu.gradient.Gradients`)."""
    return {
        "means": found.means,
        "quats": found.quats,
        "log_scales": found.scales * scales,
        "logit_opacities": found.opacities * opacities * (1 - opacities),
        "sh": found.sh,
    }
