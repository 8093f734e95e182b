"""What training moves: a cloud as unbounded numbers, each with the memory of its optimiser.

Knows logarithms, logits and learning rates. Refuses to know pictures, and when Gaussians come and go (`growth`).
Rates are those of Kerbl et al. 2023 (their released defaults) but for the higher bands; those of means are multiplied
by the scene's extent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import SH_BANDS, GaussianCloud
from .adam import Adam

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]

QUATS, SCALES, OPACITIES, CONSTANT = 1e-3, 5e-3, 5e-2, 2.5e-3
HIGHER = CONSTANT / 5  # published is a twentieth, for trainings four times as long; see docs/fit.md


@dataclass
class Parameters:
    """N Gaussians under training.

    Attributes:
        means: `[N, 3]`, world, scene units.
        quats: `[N, 4]`, of any length.
        logs: `[N, 3]`, natural logarithms of the scales.
        logits: `[N]`, of the opacities.
        sh: `[N, K, 3]`, the constant band first.
        memory: an optimiser for each of them.
    """

    means: F32
    quats: F32
    logs: F32
    logits: F32
    sh: F32
    memory: dict[str, Adam]

    @classmethod
    def of(cls, cloud: GaussianCloud) -> Parameters:
        """To start from a cloud; its opacities must lie strictly between 0 and 1."""
        opacities = cloud.opacities.double().numpy()
        values = {
            "means": cloud.means.numpy().copy(),
            "quats": cloud.quats.numpy().copy(),
            "logs": np.log(cloud.scales.numpy()),
            "logits": np.log(opacities / (1 - opacities)).astype(np.float32),
            "sh": cloud.sh.numpy().copy(),
        }
        return cls(**values, memory={name: Adam.of(value) for name, value in values.items()})

    def __len__(self) -> int:
        return len(self.means)

    def arrays(self) -> dict[str, F32]:
        """Every array by its name."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "memory"}

    @property
    def degree(self) -> int:
        """Of the harmonics as they are now."""
        return SH_BANDS[self.sh.shape[1]]

    @property
    def opacities(self) -> F32:
        """`[N]`."""
        with np.errstate(over="ignore"):  # exp of a large number is infinity, and 1 / infinity what is meant
            return np.float32(1) / (np.float32(1) + np.exp(-self.logits))

    def columns(self) -> tuple[F32, F32, F32, F32, F32]:
        """Means, quats, scales, opacities and harmonics as a renderer takes them."""
        return self.means, self.quats, np.exp(self.logs), self.opacities, self.sh

    def cloud(self) -> GaussianCloud:
        """As a cloud of its own memory, with unit quaternions."""
        means, quats, scales, opacities, sh = (torch.from_numpy(c.copy()) for c in self.columns())
        return GaussianCloud.create(means, torch.nn.functional.normalize(quats, dim=1), scales, opacities, sh)

    def step(self, gradients: Mapping[str, F32], rate: float) -> None:
        """One step against the gradients of the arrays; `rate` is that of means, scene units."""
        each = rates(rate)
        for name, values in self.arrays().items():
            self.memory[name].step(values, gradients[name], each[name], HIGHER if name == "sh" else None)

    def take(self, rows: I64) -> None:
        """Only some rows, in the order given."""
        for name, values in self.arrays().items():
            setattr(self, name, np.ascontiguousarray(values[rows]))
            self.memory[name].take(rows)

    def put(self, rows: I64, source: I64) -> None:
        """Make `rows` copies of `source`, without memory."""
        for values in self.arrays().values():
            values[rows] = values[source]
        self.forget(rows)

    def append(self, source: I64) -> None:
        """Add copies of some rows at the end, without memory."""
        for name, values in self.arrays().items():
            setattr(self, name, np.concatenate([values, values[source]]))
            self.memory[name].extend(len(source))

    def forget(self, rows: I64) -> None:
        """Let the optimiser begin anew for some rows."""
        for memory in self.memory.values():
            memory.forget(rows)

    def widen(self, degree: int) -> None:
        """Harmonics up to `degree`; new bands begin at zero."""
        more = (degree + 1) ** 2 - self.sh.shape[1]
        if more > 0:
            nothing = np.zeros((len(self), more, 3), np.float32)
            self._change_bands(lambda bands: np.concatenate([bands, nothing], axis=1))

    def narrow(self, degree: int) -> None:
        """Harmonics up to `degree` alone."""
        self._change_bands(lambda bands: np.ascontiguousarray(bands[:, : (degree + 1) ** 2]))

    def _change_bands(self, how: Callable[[F32], F32]) -> None:
        memory = self.memory["sh"]
        self.sh, memory.first, memory.second = how(self.sh), how(memory.first), how(memory.second)

    def state(self) -> dict[str, Any]:
        """All arrays, those of the optimisers included, by name; `load` reads them."""
        told: dict[str, Any] = dict(self.arrays())
        for name, memory in self.memory.items():
            told |= {f"{name}.first": memory.first, f"{name}.second": memory.second, f"{name}.steps": memory.steps}
        return told

    @classmethod
    def load(cls, told: Mapping[str, Any]) -> Parameters:
        """What `state` gave; raises KeyError if something is missing."""
        names = [f.name for f in fields(cls) if f.name != "memory"]
        memory = {n: Adam(told[f"{n}.first"], told[f"{n}.second"], int(told[f"{n}.steps"])) for n in names}
        return cls(**{n: told[n] for n in names}, memory=memory)


def rates(means: float) -> dict[str, float]:
    """The rate of every array of `Parameters`, by its name; of the harmonics that of the constant band."""
    return {"means": means, "quats": QUATS, "logs": SCALES, "logits": OPACITIES, "sh": CONSTANT}


def chained(found: Any, scales: F32, opacities: F32) -> dict[str, F32]:
    """Gradients by the arrays of `Parameters` from those by a renderer's columns (`render.cpu.gradient.Gradients`)."""
    return {
        "means": found.means,
        "quats": found.quats,
        "logs": found.scales * scales,
        "logits": found.opacities * opacities * (1 - opacities),
        "sh": found.sh,
    }
