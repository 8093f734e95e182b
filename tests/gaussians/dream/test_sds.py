"""The gradient of score distillation, against one derived by hand; views and steps that are drawn."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
import torch
from torch import Tensor

from scenewright.gaussians.dream.sds import F64, Annealing, Denoiser, distilled
from scenewright.gaussians.dream.views import HIGHEST, LOWEST, Asked, drawn, view


@dataclass
class Linear:
    """Encodes by a matrix over channels, and sees noise that is a multiple of what it gets."""

    mixing: Tensor
    name: str = "linear"
    side: int = 8
    alphas: F64 = field(default_factory=lambda: np.linspace(0.99, 0.01, 50))
    gain: float = 0.3

    def encode(self, picture: Tensor) -> Tensor:
        return torch.einsum("dc,bchw->bdhw", self.mixing, picture)

    def noise(self, noisy: Tensor, step: int, asked: Asked) -> Tensor:
        return self.gain * noisy


def _linear() -> Linear:
    return Linear(torch.randn(4, 3, generator=torch.Generator().manual_seed(3)))


def _picture(low: float = 0.0, high: float = 1.0) -> np.ndarray:
    return np.random.default_rng(1).uniform(low, high, (8, 8, 3)).astype(np.float32)


def test_the_gradient_is_the_one_derived_by_hand() -> None:
    """(1 - a) (predicted - noise) through the transposed encoder, over the number of latents."""
    model, picture = _linear(), _picture()
    assert isinstance(model, Denoiser)
    _, found = distilled(model, picture, view(0, 0, 8), 0.4, np.random.default_rng(7))
    rng = np.random.default_rng(7)
    alpha = float(model.alphas[Annealing().step(0.4, 50, rng)])
    noise = rng.standard_normal((1, 4, 8, 8), dtype=np.float32)
    mixing = model.mixing.numpy()
    code = np.einsum("dc,hwc->dhw", mixing, picture)
    off = model.gain * (alpha**0.5 * code + (1 - alpha) ** 0.5 * noise[0]) - noise[0]
    expected = np.einsum("dc,dhw->hwc", mixing, (1 - alpha) * off / off.size)
    assert np.abs(found - expected).max() < 1e-6


def test_what_is_too_bright_can_come_back() -> None:
    _, found = distilled(_linear(), _picture(1.2, 1.5), view(0, 0, 8), 0.4, np.random.default_rng(7))
    assert np.abs(found).min() > 0


def test_a_picture_of_another_size_is_brought_to_that_of_the_denoiser() -> None:
    picture = np.random.default_rng(1).uniform(0, 1, (20, 20, 3)).astype(np.float32)
    _, found = distilled(_linear(), picture, view(0, 0, 20), 0.4, np.random.default_rng(7))
    assert found.shape == picture.shape
    assert np.isfinite(found).all()


@pytest.mark.parametrize("gain", [float("nan"), float("inf"), -float("inf")])
def test_nothing_that_a_denoiser_returns_does_harm(gain: float) -> None:
    model = _linear()
    model.gain = gain
    off, found = distilled(model, _picture(), view(0, 0, 8), 0.4, np.random.default_rng(7))
    assert off == 0 and not found.any()


@pytest.mark.parametrize("count", [1, 2, 50, 1000])
def test_steps_become_weaker(count: int) -> None:
    rng, annealing = np.random.default_rng(0), Annealing()
    early, late = ([annealing.step(share, count, rng) for _ in range(300)] for share in (0.0, 1.0))
    assert all(0 <= step < count for step in (*early, *late))
    assert max(late) <= annealing.last * count
    assert max(early) >= max(late)


def test_views_show_the_whole_object_from_all_around() -> None:
    rng = np.random.default_rng(0)
    ball = np.random.default_rng(1).normal(size=(500, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    asked = [drawn(rng, 64) for _ in range(200)]
    for one in asked:
        at, depth = one.camera.project(ball)
        assert depth.min() > 0
        assert at.min() > -2 and at.max() < 66  # a ball near the border bulges a little
        assert LOWEST <= one.elevation <= HIGHEST
        assert all(0 <= c <= 1 for c in one.background)
    assert {one.side for one in asked} == {"front", "side", "back", "above"}


def test_the_front_is_seen_from_minus_y() -> None:
    front, left = view(0, 0, 64), view(90, 0, 64)
    assert front.side == "front" and front.camera.position[1] < 0
    assert left.side == "side" and left.camera.position[0] > 0
    assert view(180, 0, 64).side == view(-180, 0, 64).side == "back"
    assert view(10, 65, 64).side == "above"
