"""Solid points of a part of the scene are those of the whole scene that lie there; columns over a box hold them all."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.rotations import to_matrix
from scenewright.gaussians.scene import Frame
from scenewright.gaussians.world.box import Box
from scenewright.tools.placement.bodies import contact_box
from scenewright.tools.placement.occupancy import column_of, obstacle_points, points_inside


def cloud(count: int = 4000, seed: int = 0) -> GaussianCloud:
    """Gaussians in a cube of side 4, a hundredth of them large, a third of them faint."""
    g = torch.Generator().manual_seed(seed)
    scales = 0.01 + 0.01 * torch.rand(count, 3, generator=g)
    scales[::100] *= 20
    return GaussianCloud.create(
        torch.rand(count, 3, generator=g) * 4 - 2, torch.nn.functional.normalize(torch.randn(count, 4, generator=g)),
        scales, torch.where(torch.rand(count, generator=g) < 0.3, 0.1, 0.8), torch.zeros(count, 1, 3),
    )  # fmt: skip


def plain(of: GaussianCloud, without: torch.Tensor) -> np.ndarray:
    """The definition, Gaussian by Gaussian: the centre of an opaque one, and 24 more points of one that is more than
    three times as wide as a typical opaque one."""
    solid = [i for i in range(len(of)) if float(of.opacities[i]) >= 0.3]
    typical = float(torch.stack([of.scales[i].max() for i in solid]).median())
    centers, more = [], []
    for i in (i for i in solid if not without[i]):
        centers.append(of.means[i].numpy())
        if float(of.scales[i].max()) <= 3 * typical:
            continue
        order = of.scales[i].argsort(descending=True)[:2]
        axes = to_matrix(of.quats[i : i + 1])[0][:, order] * of.scales[i][order]
        steps = [(x, y) for x in (-1, -0.5, 0, 0.5, 1) for y in (-1, -0.5, 0, 0.5, 1) if x or y]
        more += [(of.means[i] + axes @ torch.tensor(s, dtype=torch.float32)).numpy() for s in steps]
    return np.array([*centers, *more], dtype=np.float32)


def test_solid_points_are_those_of_the_definition() -> None:
    of = cloud()
    without = torch.arange(len(of)) % 7 == 0
    found, expected = obstacle_points(of, without), plain(of, without)
    assert found.shape == expected.shape and len(found) > 2000
    assert np.allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("without", [None, torch.arange(4000) % 3 == 0])
def test_points_of_a_part_are_those_of_the_whole_that_lie_there(without: torch.Tensor | None) -> None:
    of, low, high = cloud(), np.array([-1.0, -0.3, -2.0]), np.array([0.4, 1.0, 0.5])
    every, here = obstacle_points(of, without), obstacle_points(of, without, (low, high))
    expected = every[((every >= low) & (every <= high)).all(axis=1)]
    assert 50 < len(here) < len(every) / 2
    assert np.array_equal(here, expected)


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.3, -0.5, 0.8)])
def test_the_column_of_a_box_holds_all_that_is_over_and_under_it(up: tuple[float, float, float]) -> None:
    of, frame = cloud(), Frame(up=up)
    box = contact_box(of.means[:60].double().numpy() * 0.2 + 0.3, frame)
    every, here = obstacle_points(of), obstacle_points(of, None, column_of(of, box))
    assert len(every) > len(here)
    assert np.array_equal(here[box.covers(here)], every[box.covers(every)]) and box.covers(every).sum() > 20


def test_a_box_is_within_its_bounds() -> None:
    turned = Box((1.0, 2.0, 3.0), ((0.6, 0.8, 0.0), (-0.8, 0.6, 0.0), (0.0, 0.0, 1.0)), (2.0, 1.0, 4.0))
    low, high = turned.bounds()
    assert np.allclose(low, turned.corners().min(axis=0)) and np.allclose(high, turned.corners().max(axis=0))
    low, high = turned.bounds((-10.0, 20.0))
    assert (low[2], high[2]) == (-10.0, 20.0) and np.allclose(low[:2], turned.corners().min(axis=0)[:2])


def test_points_inside_need_only_what_is_in_the_box() -> None:
    of = cloud()
    placed = of.means[:2000].double().numpy() * 0.4
    box = contact_box(placed, Frame())
    every, here = (obstacle_points(of, None, within) for within in (None, box.bounds()))
    assert points_inside(placed, here, box, 0.0) == points_inside(placed, every, box, 0.0) > 10


def test_an_empty_cloud_has_no_obstacles() -> None:
    none = cloud()[torch.zeros(4000, dtype=torch.bool)]
    assert obstacle_points(none).shape == (0, 3)
    assert obstacle_points(none, None, (np.zeros(3), np.ones(3))).shape == (0, 3)
