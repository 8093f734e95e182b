"""The estimated importance of Gaussians against leaving each of them out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.slim.importance import measure, rank
from scenewright.gaussians.slim.loss import Truth
from scenewright.gaussians.slim.reductions import Reducer, Strength, gathered
from scenewright.gaussians.slim.views import View

PROBES = 200  # the standard deviation of their mean is a tenth of the mean: sqrt(2 / 200)


def some(count: int = 40, degree: int = 1) -> GaussianCloud:
    g = torch.Generator().manual_seed(4)
    sh = torch.randn(count, (degree + 1) ** 2, 3, generator=g) * 0.3
    sh[:, 0] += 0.8  # no colour is clamped at zero
    return GaussianCloud.create(
        torch.rand(count, 3, generator=g) - 0.5, torch.nn.functional.normalize(torch.randn(count, 4, generator=g)),
        0.05 + 0.1 * torch.rand(count, 3, generator=g), 0.2 + 0.6 * torch.rand(count, generator=g), sh,
    )  # fmt: skip


VIEW = View(Camera.look_at((0, -2.5, 0.6), (0, 0, 0), (0, 0, 1), 48, 48), (1.0, 1.0, 1.0))


def squared(a: GaussianCloud, b: GaussianCloud) -> float:
    first, second = (render(c, VIEW.camera, VIEW.background).rgb.double() for c in (a, b))
    return float((first - second).square().sum())


def test_the_estimate_is_the_error_of_leaving_each_gaussian_out() -> None:
    cloud = some()
    true = np.array([squared(cloud, cloud[torch.arange(len(cloud)) != i]) for i in range(len(cloud))])
    found = np.mean([measure(cloud, [VIEW], seed).removal for seed in range(PROBES)], axis=0)
    assert found.sum() == pytest.approx(true.sum(), rel=0.1)
    assert np.abs(found / true - 1)[true > 1e-3 * true.max()].max() < 0.5  # five standard deviations
    assert np.corrcoef(found, true)[0, 1] > 0.98


def test_the_estimate_of_the_bands_is_the_error_of_leaving_them_out() -> None:
    cloud = some()
    true = []
    for i in range(len(cloud)):
        sh = cloud.sh.clone()
        sh[i, 1:] = 0
        true.append(squared(cloud, cloud.replace(sh=sh)))
    found = np.mean([measure(cloud, [VIEW], seed).bands[:, 0] for seed in range(PROBES)], axis=0)
    assert found.sum() == pytest.approx(sum(true), rel=0.15)
    assert np.corrcoef(found, true)[0, 1] > 0.95


def test_what_a_wall_hides_goes_first() -> None:
    cloud = some(60, 0)
    wall = GaussianCloud.create(
        torch.tensor([[0.0, -0.9, 0.25]]), torch.tensor([[1.0, 0, 0, 0]]), torch.tensor([[2.0, 0.01, 2.0]]),
        torch.tensor([0.999]), torch.full((1, 1, 3), 0.5),
    )  # fmt: skip
    from scenewright.gaussians.cloud import concat

    whole = concat([cloud, wall.replace(ids=torch.tensor([60]))])
    order, importance = rank(whole, [VIEW])
    assert sorted(order.tolist()) == list(range(61))
    assert order[0] == 60
    assert importance.removal[60] > 100 * importance.removal[:60].max()


def test_equal_input_gives_equal_order() -> None:
    first, second = (rank(some(), [VIEW])[0] for _ in range(2))
    assert (first == second).all()


def test_dropped_bands_are_made_up_for_by_the_mean_colour() -> None:
    cloud = some(200)
    views = [
        View(Camera.look_at((2.5 * np.cos(a), 2.5 * np.sin(a), 0.6), (0, 0, 0), (0, 0, 1), 48, 48), (0.0, 0.0, 0.0))
        for a in (0.0, 0.3, 0.6)  # all from about one side
    ]
    order = np.arange(len(cloud))
    reducer = Reducer(Scene(cloud), order, measure(cloud, views), ".ply")
    truth = Truth(cloud, views)
    made_up, plain = reducer.plain(Strength(len(cloud), 0)), cloud.with_degree(0)
    assert truth.loss(made_up).psnr > truth.loss(plain).psnr + 6
    assert (reducer.plain(Strength(len(cloud), 1)).sh == cloud.sh).all()


def test_sets_are_few_and_finer_where_they_show() -> None:
    rng = np.random.default_rng(1)
    rest = rng.normal(size=(600, 3, 3)).astype(np.float32)
    plain = measure(some(600), [VIEW])
    heavy = np.where(np.arange(600) < 300, 1.0, 1e-6)
    given = replace(plain, weights=heavy, basis_spread=np.diag([1.0, 1e-3, 1e-3]))
    out = gathered(rest, 60, given)
    error = np.square(out - rest)
    assert len(np.unique(out.reshape(600, -1), axis=0)) <= 60
    assert error[:300, 0].mean() < 0.9 * error[300:, 0].mean()  # where the weight is
    assert error[:, 0].mean() < 0.5 * error[:, 1:].mean()  # in the direction that views see
