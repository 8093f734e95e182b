"""Surface points and superpoints of clouds whose planes are known, and of degenerate clouds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.language.segmentation.structure import structures
from scenewright.gaussians.language.segmentation.superpoints import MIN_POINTS, links_of, superpoints, touching
from scenewright.gaussians.language.segmentation.surface import base_lab, surface_of
from scenewright.gaussians.scene import Frame

RED, BLUE, GRAY = (0.78, 0.13, 0.12), (0.16, 0.35, 0.78), (0.6, 0.6, 0.6)


def points_at(means: torch.Tensor, scale: float = 0.02, opacity: float = 0.9) -> GaussianCloud:
    n = len(means)
    return GaussianCloud.create(
        means.float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), scale),
        torch.full((n,), opacity), torch.zeros(n, 1, 3),
    )  # fmt: skip


def added(one: GaussianCloud, other: GaussianCloud) -> GaussianCloud:
    return concat([one, other.replace(ids=other.ids + len(one))])


def test_a_sheet_keeps_its_normal_colour_and_area(world: type[Any]) -> None:
    made = world().sheet("wall", (0, 0, 0), (1, 0, 0), (0, 0.6, 0.8), RED)  # normal (0, -0.8, 0.6)
    surface = surface_of(made.cloud())
    assert np.array_equal(surface.rows, np.arange(len(made)))
    cosine = np.abs(surface.normals @ np.array([0, -0.8, 0.6]))
    assert cosine.min() > 0.995 and np.median(surface.flatness) > 0.8
    assert np.allclose(np.linalg.norm(surface.normals, axis=1), 1, atol=1e-5)
    paint = rgb_to_lab(torch.tensor(RED)).numpy()
    assert np.linalg.norm(surface.lab.mean(axis=0) - paint) < 1.0  # the noise of the colours averages out
    assert surface.lab.std() <= surface.raw_lab.std()
    # 0.6 x 0.6 deviations times pi times opacity 0.9 is 1.02 of a cell
    assert surface.area.sum() == pytest.approx(1.0, rel=0.05)
    assert 0.02 < surface.spacing < 0.06


def test_floaters_haze_and_giants_are_not_skin(world: type[Any]) -> None:
    made = world().sheet("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0), GRAY)
    sheet = made.cloud()
    far = points_at(torch.tensor([[0.5, 0.5, 30.0]]))
    haze = points_at(torch.tensor([[0.5, 0.5, 0.02]]), opacity=0.05)
    giant = points_at(torch.tensor([[0.5, 0.5, 0.01]]), scale=3.0)
    surface = surface_of(added(added(added(sheet, far), haze), giant))
    assert np.array_equal(surface.rows, np.arange(len(sheet)))


def test_a_large_cloud_is_thinned_evenly(world: type[Any]) -> None:
    cloud = world().sheet("floor", (0, 0, 0), (4, 0, 0), (0, 4, 0), GRAY).cloud()
    surface = surface_of(cloud, most=1000)
    assert len(surface) <= 1000
    assert np.diff(surface.rows).min() >= 1
    assert np.ptp(surface.points[:, :2], axis=0).min() > 3.8  # still the whole sheet


def test_neighbours_are_the_nearest_by_brute_force(world: type[Any]) -> None:
    surface = surface_of(world().sheet("s", (0, 0, 0), (0.6, 0, 0), (0, 0.6, 0), GRAY).cloud())
    gaps = np.linalg.norm(surface.points[:, None] - surface.points[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    expected = np.sort(gaps, axis=1)[:, : surface.gaps.shape[1]]
    assert np.allclose(surface.gaps, expected, atol=1e-5)


def test_two_painted_halves_are_two_superpoints(world: type[Any]) -> None:
    made = (
        world().sheet("red", (0, 0, 0), (1, 0, 0), (0, 1, 0), RED).sheet("blue", (1, 0, 0), (1, 0, 0), (0, 1, 0), BLUE)
    )
    surface = surface_of(made.cloud())
    links = links_of(surface)
    labels = superpoints(surface, links)
    truth = made.labels(["red", "blue"])[surface.rows]
    both = [set(labels[truth == side].tolist()) for side in (0, 1)]
    assert not both[0] & both[1]  # no superpoint straddles the seam
    assert len(both[0] | both[1]) <= 4  # and hardly any inside
    near = touching(labels, links)
    assert any(b in near[a] for a in both[0] for b in both[1])


def test_an_edge_of_a_box_parts_its_faces_but_they_touch(world: type[Any]) -> None:
    made = (
        world().sheet("top", (0, 0, 1), (1, 0, 0), (0, 1, 0), GRAY).sheet("side", (0, 0, 0), (1, 0, 0), (0, 0, 1), GRAY)
    )
    surface = surface_of(made.cloud())
    labels = superpoints(surface, links_of(surface))
    truth = made.labels(["top", "side"])[surface.rows]
    mixed = sum(min((truth[labels == s] == 0).sum(), (truth[labels == s] == 1).sum()) for s in set(labels.tolist()))
    assert mixed <= 0.06 * len(surface)  # along the edge itself, two rows of 25 points have no side


def test_links_are_symmetric_short_and_told_once(world: type[Any]) -> None:
    made = world().sheet("a", (0, 0, 0), (1, 0, 0), (0, 1, 0), RED).sheet("b", (0, 0, 1), (1, 0, 0), (0, 1, 0), RED)
    surface = surface_of(made.cloud())
    links = links_of(surface)
    pairs = {tuple(sorted(p)) for p in links.pairs.tolist()}
    assert len(pairs) == len(links.pairs) and all(a != b for a, b in pairs)
    side = made.labels(["a", "b"])[surface.rows]
    assert (side[links.pairs[:, 0]] == side[links.pairs[:, 1]]).all()  # a metre of air is no contact
    assert np.isfinite(links.weight).all() and (links.weight >= 0).all()


def test_superpoints_are_numbered_from_zero_and_large_enough(world: type[Any]) -> None:
    made = world(3).box("crate", (0, 0, 0), (1, 1, 1), RED).box("tin", (0.2, 0.2, 1.0), (0.4, 0.4, 1.3), BLUE)
    surface = surface_of(made.cloud())
    labels = superpoints(surface, links_of(surface))
    assert labels.dtype == np.int32
    assert sorted(set(labels.tolist())) == list(range(labels.max() + 1))
    assert np.bincount(labels).min() >= MIN_POINTS


def test_the_same_cloud_gives_the_same_bytes(world: type[Any]) -> None:
    def once() -> tuple[bytes, bytes, bytes]:
        surface = surface_of(world(5).box("crate", (0, 0, 0), (1, 1, 1), RED).cloud())
        links = links_of(surface)
        return surface.normals.tobytes(), links.weight.tobytes(), superpoints(surface, links).tobytes()

    assert once() == once()


@pytest.mark.parametrize("count", [0, 1, 2, 3, 5, 11, 12])
@pytest.mark.parametrize("together", [True, False], ids=["one point", "spread"])
def test_degenerate_clouds_have_a_skin_without_nan(count: int, together: bool) -> None:
    generator = torch.Generator().manual_seed(1)
    means = torch.full((count, 3), 0.3) if together else torch.rand(count, 3, generator=generator)
    surface = surface_of(points_at(means))
    assert len(surface) <= count
    for column in (surface.points, surface.normals, surface.lab, surface.area, surface.gaps, surface.flatness):
        assert np.isfinite(column).all()
    links = links_of(surface)
    labels = superpoints(surface, links)
    assert len(labels) == len(surface)
    assert touching(labels, links) is not None
    assert (structures(surface, labels, Frame()) == 0).all()  # too little to be a floor


def test_faint_gaussians_are_the_surface_where_all_are_faint(world: type[Any]) -> None:
    """A short fit makes its surfaces of many Gaussians of a few hundredths of opacity."""
    cloud = (
        world().sheet("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0), GRAY).box("crate", (0, 0, 0), (1, 1, 1), RED).cloud()
    )
    faint = surface_of(cloud.replace(opacities=0.04 * cloud.opacities, scales=4 * cloud.scales))
    assert np.array_equal(faint.rows, surface_of(cloud).rows)


def test_a_cloud_of_haze_alone_has_no_skin() -> None:
    surface = surface_of(points_at(torch.rand(50, 3, generator=torch.Generator().manual_seed(1)), opacity=0.01))
    assert len(surface) == 0
    assert len(superpoints(surface, links_of(surface))) == 0


def test_base_colour_is_the_bare_colour_clipped_to_what_can_be_shown() -> None:
    cloud = points_at(torch.zeros(2, 3)).replace(sh=torch.tensor([[[0.0, 0, 0]], [[99.0, 99, 99]]]))
    lab = base_lab(cloud)
    assert lab[0].tolist() == pytest.approx(rgb_to_lab(torch.tensor([0.5, 0.5, 0.5])).tolist())
    assert lab[1].tolist() == pytest.approx([100.0, 0.0, 0.0], abs=0.01)
