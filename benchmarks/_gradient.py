"""Times forward and backward pass of the fast renderer, and compares its gradients with the reference renderer's.

The reference renderer runs once, in float32, with torch's autograd; the loss weights every colour by a random number.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import torch
from torch import Tensor

from ..gaussians import compiled
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.render import differentiable, reference
from .harness import Metric

NAMES = ("means", "quats", "scales", "opacities", "sh")
BLACK = (0.0, 0.0, 0.0)

Columns = dict[str, Tensor]
Draw = Callable[[Columns], Tensor]  # columns to a picture, [H, W, 3]


def measure(name: str, cloud: GaussianCloud, camera: Camera, repeats: int) -> list[Metric]:
    """Times of both renderers, their ratio, and the relative difference of their gradients, on one scene."""
    weights = torch.randn(camera.height, camera.width, 3, generator=torch.Generator().manual_seed(0))

    def fast(columns: Columns) -> Tensor:
        return differentiable.draw(**columns, camera=camera, background=BLACK, centers=None)[0]

    def slow(columns: Columns) -> Tensor:
        return reference.render(cloud.replace(**columns), camera, BLACK).rgb

    least = math.inf
    stages: dict[str, float] = {}
    found: Columns = {}
    for _ in range(repeats):
        seconds, each, found = _once(fast, cloud, weights)
        if seconds < least:
            least, stages = seconds, each
    patient, _, wanted = _once(slow, cloud, weights)
    key = f"{name}.{camera.width}x{camera.height}.gradient"
    apart = max(float((found[n] - wanted[n]).norm() / wanted[n].norm().clamp(min=1e-30)) for n in NAMES)
    return [
        Metric(f"{key}.cpu", least * 1e3, "ms", "lower", 0.15),
        Metric(f"{key}.reference", patient * 1e3, "ms", "lower", 0.3),
        Metric(f"{key}.speedup", patient / least, "x", "higher", 0.3),
        Metric(f"{key}.apart", apart, "1", "lower", 0.5),
        *(Metric(f"{key}.stage.{stage}", seconds * 1e3, "ms") for stage, seconds in stages.items()),
    ]


def _once(draw: Draw, cloud: GaussianCloud, weights: Tensor) -> tuple[float, dict[str, float], Columns]:
    """Seconds of forward and backward pass, those of each stage, and the gradients by column."""
    columns = {n: getattr(cloud, n).clone().requires_grad_() for n in NAMES}
    with compiled.stage_times() as stages:
        start = time.perf_counter()
        (draw(columns) * weights).sum().backward()  # type: ignore[no-untyped-call]
        seconds = time.perf_counter() - start
    return seconds, dict(stages), {n: c.grad for n, c in columns.items() if c.grad is not None}
