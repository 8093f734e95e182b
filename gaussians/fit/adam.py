"""The Adam optimiser (Kingma & Ba 2015) over numpy arrays, one compiled pass over each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import compiled
from ..compiled import exact, exact_helper

F32 = NDArray[np.float32]
BETAS = (0.9, 0.999)
EPSILON = 1e-15  # Kerbl et al. 2023; gradients of single Gaussians are far below Adam's usual 1e-8
f4 = np.float32


@dataclass
class Adam:
    """Optimiser state of one array `[N, ...]`.

    Attributes:
        first, second: first and second moment (running means of the gradient and of its square), of the array's shape.
        steps: number of steps taken.
    """

    first: F32
    second: F32
    steps: int = 0

    @classmethod
    def of(cls, values: F32) -> Adam:
        """Fresh state for an array."""
        return cls(np.zeros_like(values), np.zeros_like(values))

    def step(self, values: F32, gradient: F32, rate: float, rest_rate: float | None = None) -> None:
        """Update `values` in place. With `rest_rate`, all but the first entry `[:, 0]` have that learning rate."""
        self.steps += 1
        bias = [1 - beta**self.steps for beta in BETAS]
        numbers = f4(1 / np.sqrt(bias[1])), f4(EPSILON), f4(BETAS[0]), f4(BETAS[1])
        arrays = values, gradient, self.first, self.second
        if rest_rate is None or values.shape[1] == 1:
            flat = (a.reshape(-1) for a in arrays)
            compiled.run(_step, compiled.workers(), *flat, f4(rate / bias[0]), numbers)
        else:
            rows = (a.reshape(len(a), -1) for a in arrays)
            rates = f4(rate / bias[0]), f4(rest_rate / bias[0])
            compiled.run(_step_rows, compiled.workers(), *rows, values.shape[2], rates, numbers)

    def take(self, rows: NDArray[np.int64]) -> None:
        """Keep only some rows, in the order given."""
        self.first, self.second = (np.ascontiguousarray(a[rows]) for a in (self.first, self.second))

    def extend(self, count: int) -> None:
        """Append rows with zero state."""
        zeros = np.zeros((count, *self.first.shape[1:]), np.float32)
        self.first, self.second = (np.concatenate([a, zeros]) for a in (self.first, self.second))

    def reset(self, rows: NDArray[np.int64]) -> None:
        """Zero the state of some rows."""
        self.first[rows] = self.second[rows] = 0


@exact_helper
def _move(values, gradient, first, second, i, rate, numbers):  # type: ignore[no-untyped-def]
    scale, epsilon, beta1, beta2 = numbers
    g = gradient[i]
    a = beta1 * first[i] + (f4(1) - beta1) * g
    b = beta2 * second[i] + (f4(1) - beta2) * (g * g)
    first[i], second[i] = a, b
    values[i] -= rate * a / (np.sqrt(b) * scale + epsilon)


@exact
def _step(worker, workers, values, gradient, first, second, rate, numbers):  # type: ignore[no-untyped-def]
    size = values.shape[0]
    for i in range(size * worker // workers, size * (worker + 1) // workers):
        _move(values, gradient, first, second, i, rate, numbers)


@exact
def _step_rows(worker, workers, values, gradient, first, second, head, rates, numbers):  # type: ignore[no-untyped-def]
    """As `_step` for arrays `[N, C]` whose first `head` columns have one learning rate and the others another."""
    count, width = values.shape
    for n in range(count * worker // workers, count * (worker + 1) // workers):
        for i in range(head):
            _move(values[n], gradient[n], first[n], second[n], i, rates[0], numbers)
        for i in range(head, width):
            _move(values[n], gradient[n], first[n], second[n], i, rates[1], numbers)
