"""The loss of training against the same in torch, its gradient against autograd in float64; Adam against torch's."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.fit.adam import Adam
from scenewright.gaussians.fit.loss import photometric, reference, ssim

F32 = NDArray[np.float32]


def pair(height: int, width: int, seed: int, noise: float = 0.1) -> tuple[F32, F32]:
    rng = np.random.default_rng(seed)
    photo = rng.random((height, width, 3), dtype=np.float32)
    return (photo + rng.normal(0, noise, photo.shape)).astype(np.float32), photo


@given(st.integers(1, 40), st.integers(1, 40), st.sampled_from([0.0, 0.2, 1.0]), st.integers(0, 1000))
def test_loss_and_gradient_are_those_of_the_readable_loss(height: int, width: int, share: float, seed: int) -> None:
    picture, photo = pair(height, width, seed)
    value, gradient = photometric(picture, photo, share)
    leaf = torch.from_numpy(picture).double().requires_grad_()
    wanted = reference(leaf, torch.from_numpy(photo).double(), share)
    wanted.backward()  # type: ignore[no-untyped-call]
    assert leaf.grad is not None
    assert abs(value - wanted.item()) < 1e-5
    # float32 loses up to 1e-7 of a variance around 0.03 near C2 = 9e-4: a few parts in 100,000 of the slope
    assert np.linalg.norm(gradient - leaf.grad.numpy()) <= 1e-4 * np.linalg.norm(leaf.grad.numpy())


def test_equal_pictures_are_perfectly_similar_and_have_no_loss() -> None:
    _, photo = pair(30, 20, 1)
    value, gradient = photometric(photo, photo.copy())
    assert abs(value) < 1e-6 and np.abs(gradient).max() < 1e-7
    assert ssim(torch.from_numpy(photo), torch.from_numpy(photo)) == pytest.approx(1, abs=1e-6)


def test_similarity_falls_with_noise_and_does_not_depend_on_the_order() -> None:
    values = []
    for noise in (0.01, 0.1, 0.3):
        a, b = (torch.from_numpy(p) for p in pair(40, 50, 2, noise))
        values.append(float(ssim(a, b)))
        assert ssim(a, b) == pytest.approx(float(ssim(b, a)), abs=1e-6)
    assert 1 > values[0] > values[1] > values[2] > 0


def test_the_same_pictures_give_the_same_bytes_on_any_number_of_threads() -> None:
    picture, photo = pair(61, 83, 3)
    before, seen = torch.get_num_threads(), set()
    try:
        for threads in (1, 2, 3, 2):
            torch.set_num_threads(threads)
            value, gradient = photometric(picture, photo)
            seen.add((value, gradient.tobytes()))
    finally:
        torch.set_num_threads(before)
    assert len(seen) == 1


@pytest.mark.parametrize("shape", [(7,), (50, 3), (20, 4, 3), (0, 3)])
def test_adam_steps_as_torchs_does(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(0)
    ours = rng.normal(size=shape).astype(np.float32)
    theirs = torch.from_numpy(ours.copy()).requires_grad_()
    stepper, other = Adam.of(ours), torch.optim.Adam([theirs], lr=0.01, eps=1e-15)
    for _ in range(20):
        gradient = rng.normal(size=shape).astype(np.float32)
        stepper.step(ours, gradient, 0.01)
        theirs.grad = torch.from_numpy(gradient)
        other.step()  # type: ignore[no-untyped-call]
    # twenty roundings of float32 in steps of 0.01
    assert np.abs(ours - theirs.detach().numpy()).max(initial=0) < 2e-6
