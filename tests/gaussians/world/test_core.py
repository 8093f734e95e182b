"""The core of a selection: strays do not move it, and a thing without strays is whole."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians import assets
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.language.field.measure import centroid, reach, solid_points
from scenewright.gaussians.world.core import OPAQUE, core_of, least_opacity

KINDS = ("armchair", "floor lamp", "bicycle", "potted plant", "coat rack", "table")


@cache
def thing(kind: str) -> GaussianCloud:
    return assets.make(kind, 0, detail=0.5).cloud


def strays(count: int, distance: float, seed: int, like: GaussianCloud, opacity: float) -> GaussianCloud:
    """Small single Gaussians on a shell of that radius."""
    g = torch.Generator().manual_seed(seed)
    way = torch.nn.functional.normalize(torch.randn(count, 3, generator=g), dim=1)
    part = like[torch.arange(count)].replace(ids=torch.arange(count) + len(like))
    far = distance * (1 + torch.rand(count, 1, generator=g))
    return part.replace(means=way * far, opacities=torch.full((count,), opacity))


def measured(cloud: GaussianCloud) -> tuple[np.ndarray, np.ndarray]:
    """The middle of the extent and the extent `[3]`."""
    points = solid_points(cloud, torch.arange(len(cloud)))
    low, high = np.array([reach(points[:, i]) for i in range(3)]).T
    return (low + high) / 2, high - low


@settings(max_examples=25)
@given(st.sampled_from(KINDS), st.floats(3, 300), st.integers(0, 10**6), st.sampled_from([0.35, 0.95]))
def test_one_percent_of_far_strays_does_not_move_the_core(kind: str, far: float, seed: int, opacity: float) -> None:
    clean = thing(kind)
    middle, extent = measured(clean)
    size = float(extent.max())
    spoiled = concat([clean, strays(max(1, len(clean) // 100), far * size, seed, clean, opacity)])
    moved, now = measured(spoiled)
    assert np.linalg.norm(moved - middle) < 0.01 * size
    assert np.allclose(now, extent, atol=0.02 * size)
    shift = centroid(spoiled, torch.arange(len(spoiled))) - centroid(clean, torch.arange(len(clean)))
    assert np.linalg.norm(shift) < 0.01 * size
    core = core_of(spoiled, torch.arange(len(spoiled)))
    assert core.belongs[: len(clean)].all() and not core.belongs[len(clean) :].any()


@pytest.mark.slow
def test_a_thing_without_strays_is_whole() -> None:
    """No kind of the library has strays, and their box is that of all their solid Gaussians."""
    for kind in sorted(assets.KINDS)[::4]:
        cloud = thing(kind)
        core = core_of(cloud, torch.arange(len(cloud)))
        assert core.strays == 0, kind
        solid = (cloud.opacities >= OPAQUE).numpy()
        points = cloud.means.numpy()
        extent = np.ptp(points[solid], axis=0)
        # Wires of a hundredth of the typical coverage may count as haze; they extend no thing by more than this.
        assert np.allclose(np.ptp(points[core.solid], axis=0), extent, atol=0.01 * extent.max()), kind


def test_pieces_that_weigh_much_belong_wherever_they_are() -> None:
    first, second = thing("armchair"), thing("table")
    apart = second.replace(means=second.means + torch.tensor([40.0, 0.0, 0.0]), ids=second.ids + len(first))
    both = concat([first, apart])
    core = core_of(both, torch.arange(len(both)))
    assert core.strays == 0 and core.solid[: len(first)].any() and core.solid[len(first) :].any()


def test_a_faint_scene_has_solid_points() -> None:
    """After a short fit hardly a Gaussian is opaque; what is most opaque of a thing still is its surface."""
    cloud = thing("armchair")
    faint = cloud.replace(opacities=cloud.opacities * 0.05)
    assert least_opacity(faint.opacities) < 0.05 and least_opacity(cloud.opacities) == OPAQUE
    middle, extent = measured(cloud)
    moved, now = measured(faint)
    assert np.allclose(middle, moved, atol=0.03 * extent.max()) and np.allclose(extent, now, atol=0.05 * extent.max())


@pytest.mark.parametrize("count", [1, 2, 10, 60])
def test_few_gaussians_are_all_taken(count: int) -> None:
    cloud = thing("armchair")[torch.arange(0, count * 7, 7)]
    core = core_of(cloud, torch.arange(count))
    assert core.belongs.all() and core.solid.any()


def test_a_point_has_no_extent() -> None:
    cloud = thing("armchair")[torch.arange(100)]
    same = cloud.replace(means=torch.zeros(100, 3))
    assert core_of(same, torch.arange(100)).belongs.all()
