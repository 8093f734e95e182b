"""Laws of moving Gaussians, and covariances against a slow float64 reference."""

from __future__ import annotations

import numpy as np
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import evaluate
from scenewright.gaussians.rotations import axis_rotation, normalize, to_matrix
from scenewright.tools.cloud_diff import Draft
from scenewright.tools.transform import stretch, stretch_matrix, stretched, transformed, turn

seeds = st.integers(0, 10**6)
units = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)).filter(lambda v: np.linalg.norm(v) > 0.1)


def cloud_of(n: int, seed: int, degree: int = 2) -> GaussianCloud:
    """Random Gaussians, flat ones among them, as surfaces have."""
    g = torch.Generator().manual_seed(seed)
    scales = 10 ** (torch.rand(n, 3, generator=g) * 3 - 3)
    quats = normalize(torch.randn(n, 4, generator=g))
    sh = torch.randn(n, (degree + 1) ** 2, 3, generator=g)
    return GaussianCloud.create(
        torch.randn(n, 3, generator=g), quats, scales, torch.rand(n, generator=g) * 0.9 + 0.05, sh
    )


def covariance(quats: Tensor, scales: Tensor) -> Tensor:
    axes = to_matrix(quats.double()) * scales.double()[:, None, :]
    return axes @ axes.transpose(1, 2)


@settings(max_examples=30, deadline=None)
@given(seeds, units, st.floats(0.05, 20))
def test_a_stretched_covariance_is_a_sigma_a_transposed(seed: int, axis: tuple[float, ...], factor: float) -> None:
    cloud = cloud_of(200, seed)
    matrix = stretch_matrix(np.array(axis) / np.linalg.norm(axis), factor)
    quats, scales = stretched(cloud.quats, cloud.scales, matrix)
    a = torch.from_numpy(matrix)
    wanted = a @ covariance(cloud.quats, cloud.scales) @ a.T
    got = covariance(quats, scales)
    size = wanted.diagonal(dim1=1, dim2=2).sum(dim=1)[:, None, None]
    # float32 orientations are known to about 1e-7; the stretch magnifies that by at most its own factor.
    assert bool(((got - wanted).abs() < 2e-5 * size).all())
    assert torch.allclose(torch.linalg.vector_norm(quats, dim=1), torch.ones(200), atol=1e-5)
    assert bool((scales > 0).all())


def test_thin_axes_keep_their_digits() -> None:
    cloud = cloud_of(500, 3)
    thin = cloud.replace(scales=torch.tensor([0.3, 0.2, 1e-5]).expand(500, 3).contiguous())
    matrix = stretch_matrix(np.array([0.6, 0.0, 0.8]), 2.0)
    _, scales = stretched(thin.quats, thin.scales, matrix)
    axes = torch.from_numpy(matrix) @ (to_matrix(thin.quats.double()) * thin.scales.double()[:, None, :])
    wanted = torch.linalg.svdvals(axes)
    # The thin extent is the volume over the other two; a float32 covariance would lose it altogether (1e-10 of 0.1).
    assert torch.allclose(scales.double(), wanted, rtol=2e-2)
    assert torch.allclose(scales.double()[:, :2], wanted[:, :2], rtol=1e-5)


@settings(max_examples=20, deadline=None)
@given(seeds, units, st.floats(-720, 720))
def test_turning_there_and_back_is_nothing(seed: int, axis: tuple[float, ...], degrees: float) -> None:
    cloud, rows = cloud_of(60, seed), torch.arange(0, 60, 2)
    matrix = axis_rotation(np.array(axis), degrees)
    draft = Draft(cloud)
    turn(draft, rows, matrix, np.zeros(3))
    turn(draft, rows, matrix.T, np.zeros(3))
    back = draft.done()
    # Two float32 roundings of numbers near one, with room for the harmonics' 7x7 sums.
    assert torch.allclose(back.means, cloud.means, atol=2e-6)
    assert torch.allclose(back.sh, cloud.sh, atol=1e-5)
    assert torch.allclose(to_matrix(back.quats), to_matrix(cloud.quats), atol=2e-6)


def test_a_turned_object_shows_its_colours_turned() -> None:
    cloud = cloud_of(50, 1, degree=3)
    matrix = axis_rotation(np.array([0.2, 0.5, 1.0]), 73)
    turned = transformed(cloud, matrix, np.zeros(3))
    way = torch.nn.functional.normalize(torch.randn(50, 3, generator=torch.Generator().manual_seed(0)), dim=1)
    seen = evaluate(turned.sh, way @ torch.from_numpy(matrix).float().T)
    assert torch.allclose(seen, evaluate(cloud.sh, way), atol=1e-4)  # 16 float32 terms of size three


def test_uniform_scaling_is_exact_and_shares_what_it_does_not_change() -> None:
    cloud = cloud_of(40, 2)
    draft = Draft(cloud)
    stretch(draft, torch.arange(40), np.eye(3) * 2.0, np.zeros(3))
    out = draft.done()
    assert torch.equal(out.scales, cloud.scales * 2) and torch.equal(out.means, cloud.means * 2)
    assert out.quats is cloud.quats and out.sh is cloud.sh and out.opacities is cloud.opacities
