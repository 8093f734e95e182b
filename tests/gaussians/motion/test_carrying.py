"""Rows moved by a rigid map: the compiled way against the one in torch, and what it leaves alone."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians import compiled
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion.carrying import carry, carry_by_tensors, shift_means
from scenewright.gaussians.rotations import axis_rotation

TURN, SHIFT = axis_rotation(np.array([0.3, -0.5, 0.8]), 111.0), np.array([0.4, -2.0, 31.0])


def columns(count: int, bands: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    rng = np.random.default_rng(bands)
    shapes = (count, 3), (count, 4), (count, bands, 3)
    means, quats, sh = (torch.from_numpy(rng.normal(size=shape).astype(np.float32)) for shape in shapes)
    return means, quats / quats.norm(dim=1, keepdim=True), sh


def some_rows(count: int) -> torch.Tensor:
    """Rows with gaps, the last one among them: nothing lies behind it."""
    chosen = np.random.default_rng(count).random(count) < 0.6
    chosen[-1] = True
    return torch.from_numpy(np.flatnonzero(chosen))


@pytest.mark.parametrize("bands", [1, 4, 9, 16])
@pytest.mark.parametrize("count", [1, 40, 9000])
def test_kernels_carry_rows_as_tensors_do(count: int, bands: int) -> None:
    """Sums of at most seven products of float32: a few 1e-7 of numbers up to 5; places of up to 40 units, 1e-5."""
    own, rows = columns(count, bands), some_rows(count)
    fast, slow = (tuple(torch.full_like(column, 7.0) for column in own) for _ in range(2))
    for work, out in ((carry, fast), (carry_by_tensors, slow)):
        means, quats, sh = zip(own, out, strict=True)
        work(rows, means, quats, sh if bands > 1 else None, TURN, SHIFT)
    for name, got, want in zip(("means", "quats", "sh"), fast, slow, strict=True):
        torch.testing.assert_close(got, want, atol=1e-5 if name == "means" else 3e-6, rtol=0)
        others = torch.ones(count, dtype=torch.bool)
        others[rows] = False
        assert bool((got[others] == 7).all())
    if bands > 1:
        assert torch.equal(fast[2][rows, 0], own[2][rows, 0])
    else:
        assert bool((fast[2] == 7).all())


@pytest.mark.parametrize("bands", [1, 9, 16])
def test_columns_may_be_carried_in_place_on_any_number_of_threads(bands: int, monkeypatch: pytest.MonkeyPatch) -> None:
    own, rows = columns(9000, bands), some_rows(9000)
    found = []
    for threads in (1, 3):
        monkeypatch.setattr(compiled, "workers", lambda threads=threads: threads)
        here, apart = tuple(c.clone() for c in own), tuple(c.clone() for c in own)
        for out, source in ((here, here), (apart, own)):
            means, quats, sh = zip(source, out, strict=True)
            carry(rows, means, quats, sh if bands > 1 else None, TURN, SHIFT)
        found += [here, apart]
    for other in found[1:]:
        assert all(torch.equal(a, b) for a, b in zip(found[0], other, strict=True))


def test_places_far_from_the_origin_are_carried_to_the_last_bit() -> None:
    means = torch.tensor([[1e5, -3e5, 2e4], [0.1, 0.2, 0.3]])
    own, rows = columns(2, 1), torch.arange(2)
    out = torch.empty_like(means)
    carry(rows, (means, out), (own[1], own[1].clone()), None, TURN, SHIFT)
    want = (means.double().numpy() @ TURN.T + SHIFT).astype(np.float32)
    np.testing.assert_allclose(out.numpy(), want, rtol=1.2e-7, atol=0)
    shift_means(rows, (means, out), SHIFT)
    np.testing.assert_array_equal(out.numpy(), (means.double().numpy() + SHIFT).astype(np.float32))


def test_tensors_with_gradients_are_carried_in_torch_and_maps_that_scale_are_refused() -> None:
    means, quats, sh = columns(5, 4)
    rows, wanted = torch.tensor([1, 3]), torch.empty_like(means)
    out = torch.empty_like(means, dtype=torch.float64)
    carry(rows, (means, wanted), (quats, quats.clone()), None, TURN, SHIFT)
    carry(rows, (means.double(), out), (quats, quats.clone()), None, TURN, SHIFT)
    torch.testing.assert_close(out[rows].float(), wanted[rows], atol=1e-5, rtol=0)
    with pytest.raises(UserError, match="proper 3x3 rotation"):
        carry(rows, (means, means.clone()), (quats, quats.clone()), (sh, sh.clone()), 2 * TURN, SHIFT)
