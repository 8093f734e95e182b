"""Laws of merging: mass, moments and groups are kept, the result is the same every time, and pictures stay alike."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.merging import merge, merged_by, visibility
from scenewright.gaussians.reduce import psnr, rank_by_contribution
from scenewright.gaussians.rotations import to_matrix

EYES = [Camera.look_at(eye, (0, 0, 0), (0, 0, 1), 96, 96) for eye in ((3, 0, 1), (0, 3, 1), (-3, 1, 0), (1, -3, -1))]


def ball(count: int = 3000, degree: int = 1, groups: int = 3) -> GaussianCloud:
    """Flat Gaussians on a sphere, of a colour that changes slowly; groups are slices along z."""
    g = torch.Generator().manual_seed(3)
    out = torch.nn.functional.normalize(torch.randn(count, 3, generator=g))
    half = torch.nn.functional.normalize(out + torch.tensor([0.0, 0.0, 1.0]))  # turns the z axis onto `out`
    quats = torch.cat([torch.zeros(count, 1), half], dim=1)
    scales = torch.tensor([0.04, 0.05, 0.004]) * (0.7 + 0.6 * torch.rand(count, 1, generator=g))
    sh = torch.randn(count, (degree + 1) ** 2, 3, generator=g) * 0.02
    sh[:, 0] += torch.sin(2 * out)
    group = ((out[:, 2] + 1) / 2 * groups).int().clamp(0, groups - 1)
    return GaussianCloud.create(out, quats, scales, 0.3 + 0.6 * torch.rand(count, generator=g), sh, group)


def covariance(cloud: GaussianCloud) -> torch.Tensor:
    axes = to_matrix(cloud.quats.double()) * cloud.scales.double()[:, None]
    return axes @ axes.transpose(1, 2)


def mass(cloud: GaussianCloud) -> torch.Tensor:
    """Opacity times the root mean square of the projected area, measured from 20,000 directions."""
    g = torch.Generator().manual_seed(0)
    looks = torch.nn.functional.normalize(torch.randn(20000, 3, generator=g, dtype=torch.float64))
    c = covariance(cloud)
    adjugate = torch.linalg.inv(c) * torch.linalg.det(c)[:, None, None]
    return cloud.opacities.double() * torch.einsum("vi,nij,vj->nv", looks, adjugate, looks).mean(dim=1).sqrt()


def test_mass_position_covariance_and_harmonics_are_kept() -> None:
    cloud = ball(60)
    rows = np.arange(60) // 4
    done = merged_by(cloud.replace(opacities=cloud.opacities * 0.02), rows)
    assert mass(done).numpy() == pytest.approx(
        np.add.reduceat(0.02 * mass(cloud).numpy(), np.arange(0, 60, 4)), rel=0.02  # of the directions
    )  # fmt: skip
    # Each weight from the closed form: the sum of the principal minors of a covariance.
    c = covariance(cloud)
    minors = (torch.einsum("nii->n", c) ** 2 - torch.einsum("nij,nij->n", c, c)) / 2
    weights = cloud.opacities.double() * minors.sqrt()
    for k in range(15):
        own = slice(4 * k, 4 * k + 4)
        w = weights[own] / weights[own].sum()
        mean = (w[:, None] * cloud.means[own].double()).sum(dim=0)
        off = cloud.means[own].double() - mean
        spread = (w[:, None, None] * (c[own] + off[:, :, None] * off[:, None])).sum(dim=0)
        torch.testing.assert_close(done.means[k].double(), mean, atol=1e-6, rtol=0)  # float32 columns
        torch.testing.assert_close(covariance(done)[k], spread, atol=1e-6, rtol=0)
        torch.testing.assert_close(
            done.sh[k].double(), (w[:, None, None] * cloud.sh[own]).sum(dim=0), atol=1e-6, rtol=0
        )


def test_two_equal_gaussians_become_one_of_the_same_shape() -> None:
    one = ball(1)
    faint = one.replace(opacities=torch.tensor([0.2]))
    twice = GaussianCloud.create(*(torch.cat([c, c]) for _, c in faint.columns()[:5]))
    done = merge(twice, 1)
    torch.testing.assert_close(covariance(done.cloud), covariance(one), atol=1e-8, rtol=1e-5)
    torch.testing.assert_close(done.cloud.sh, one.sh)
    assert float(done.cloud.opacities) == pytest.approx(0.4)
    assert done.rows.tolist() == [0, 0]


def test_an_opaque_pair_stays_below_one() -> None:
    one = ball(1).replace(opacities=torch.tensor([0.95]))
    twice = GaussianCloud.create(*(torch.cat([c, c]) for _, c in one.columns()[:5]))
    assert 0.95 < float(merge(twice, 1).cloud.opacities) < 1


def test_equal_input_gives_equal_bytes_with_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    first = merge(ball(), 500)
    monkeypatch.setattr("scenewright.gaussians.merging.pairwise.workers", lambda: 3)
    again = merge(ball(), 500)
    assert first.cloud.digest() == again.cloud.digest() and (first.rows == again.rows).all()


def test_rows_lead_to_the_gaussian_that_each_became_a_part_of() -> None:
    cloud = ball()
    done = merge(cloud, 700)
    assert len(done.cloud) == 700 and set(done.rows.tolist()) == set(range(700))
    assert merged_by(cloud, done.rows).digest() == done.cloud.digest()
    firsts = [int(np.flatnonzero(done.rows == k)[0]) for k in range(700)]
    assert firsts == sorted(firsts)
    assert (done.rows[done.cloud.ids.numpy()] == np.arange(700)).all()  # the id is that of one of its rows


def test_what_is_not_merged_stays_bit_for_bit() -> None:
    cloud = ball(300)
    done = merge(cloud, 290)
    alone = np.flatnonzero(np.bincount(done.rows) == 1)
    own = cloud[done.cloud.ids[torch.from_numpy(alone)]]
    assert done.cloud[torch.from_numpy(alone)].digest() == own.digest()
    assert merge(cloud, 300).cloud.digest() == cloud.digest()


def test_groups_never_merge_unless_asked_for() -> None:
    cloud = ball()
    done = merge(cloud, 10)
    assert len(done.cloud) == 10
    assert (done.cloud.group[torch.from_numpy(done.rows)] == cloud.group).all()
    mixed = merge(cloud, 1, across_groups=True)
    assert len(mixed.cloud) == 1


def test_a_group_among_others_merges_with_its_own_however_far() -> None:
    cloud = ball(400)
    group = torch.zeros(400, dtype=torch.int32)
    group[[3, 200]] = 1  # each has only neighbours of the other group
    done = merge(cloud.replace(group=group), 2)
    assert sorted(done.cloud.group.tolist()) == [0, 1]


def test_a_level_is_merged_further() -> None:
    cloud = ball()
    first = merge(cloud, 1500, visibility(cloud, EYES))
    second = merge(first.cloud, 700, first.shown)
    rows = second.rows[first.rows]
    assert (second.cloud.group[torch.from_numpy(rows)] == cloud.group).all()
    assert second.shown is not None and len(second.shown) == 700


@pytest.mark.parametrize("share", [2, 4, 8])
def test_merging_keeps_more_than_leaving_out_what_shows_least(share: int) -> None:
    cloud = ball()
    count = len(cloud) // share
    kept = np.sort(rank_by_contribution(cloud, EYES)[:count])
    left_out = psnr(cloud, cloud[torch.from_numpy(kept)], EYES)
    merged = psnr(cloud, merge(cloud, count, visibility(cloud, EYES)).cloud, EYES)
    assert np.mean(merged) > np.mean(left_out) + 3


def test_what_is_hidden_and_what_lies_before_its_own_colour_show_little() -> None:
    x = torch.tensor([-0.6, 0.0, 0.6])
    wall = torch.stack([x, torch.zeros(3), torch.zeros(3)], dim=1)
    own = wall + torch.tensor([[0.0, -0.2, 0.0], [0.0, -0.2, 0.0], [0.0, 0.2, 0.0]])  # before, before, behind
    sh = torch.full((6, 1, 3), 1.0)
    sh[4] = -1.0  # of another colour than the wall
    cloud = GaussianCloud.create(
        torch.cat([wall, own]), torch.tensor([1.0, 0, 0, 0]).repeat(6, 1),
        torch.tensor([0.2, 0.01, 0.2]).repeat(6, 1) * torch.tensor([2.0] * 3 + [1.0] * 3)[:, None],
        torch.tensor([0.999] * 3 + [0.5] * 3), sh,
    )  # fmt: skip
    seen = visibility(cloud, [Camera.look_at((0, -3, 0), (0, 0, 0), (0, 0, 1), 96, 96)] * 8)
    same, other, hidden = seen[3:]
    assert hidden < 0.05 * other and same < 0.2 * other


def test_what_no_view_shows_is_merged_first() -> None:
    cloud = ball(800, groups=1)
    inside = cloud.replace(means=0.7 * cloud.means, opacities=torch.full((800,), 0.99), ids=cloud.ids + 800)
    shell = GaussianCloud.create(
        *(torch.cat([a, b]) for (_, a), (_, b) in zip(cloud.columns()[:5], inside.columns()[:5], strict=True))
    )
    shell = shell.replace(opacities=torch.full((1600,), 0.99), scales=shell.scales * 2)
    done = merge(shell, 1300, visibility(shell, EYES))
    merged = np.bincount(done.rows)[done.rows] > 1
    assert merged[800:].mean() > 4 * merged[:800].mean()


def test_a_number_below_that_of_the_groups_and_bad_values_are_refused() -> None:
    cloud = ball(100)
    with pytest.raises(UserError, match="100 Gaussians of 3 groups cannot be merged into 2"):
        merge(cloud, 2)
    with pytest.raises(UserError, match="must have 100 values, one for each Gaussian, got 3"):
        merge(cloud, 50, np.ones(3))
    means = cloud.means.clone()
    means[7, 0] = float("nan")
    with pytest.raises(UserError, match="not finite"):
        merge(cloud.replace(means=means), 50)
