"""Parts of other hues are told from the main material; shading and fine patterns are not."""

from __future__ import annotations

import torch
from torch import Tensor

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.tools.coloring.materials import materials

BROWN, BLUE, GREY, BLACK, RED = (
    (0.5, 0.33, 0.2),
    (0.15, 0.25, 0.6),
    (0.7, 0.7, 0.7),
    (0.05, 0.05, 0.05),
    (0.7, 0.1, 0.1),
)


def slab(low: tuple[float, float, float], high: tuple[float, float, float], count: int, seed: int = 0) -> Tensor:
    g = torch.Generator().manual_seed(seed)
    a, b = torch.tensor(low), torch.tensor(high)
    return a + (b - a) * torch.rand(count, 3, generator=g)


def cloud_of(means: Tensor, rgb: Tensor, seed: int = 0) -> GaussianCloud:
    """Gaussians in uneven light, with the noise of a scan."""
    g = torch.Generator().manual_seed(seed)
    n = len(means)
    light = 0.55 + 0.45 * ((means[:, :1] - means[:, 0].min()) / (means[:, 0].max() - means[:, 0].min()))
    noisy = rgb * light + 0.04 * torch.randn(n, 3, generator=g)
    return GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4), torch.full((n, 3), 0.02), torch.full((n,), 0.9),
        color_to_dc(noisy)[:, None],
    )  # fmt: skip


def painted(means: Tensor, *regions: tuple[Tensor, tuple[float, float, float]]) -> GaussianCloud:
    rgb = torch.zeros(len(means), 3)
    for mask, color in regions:
        rgb[mask] = torch.tensor(color)
    return cloud_of(means, rgb)


def split(cloud: GaussianCloud) -> tuple[Tensor, tuple[tuple[str, float], ...]]:
    found = materials(cloud, torch.arange(len(cloud)))
    return found.main, found.shares


def test_a_cushion_on_a_chair_is_a_part() -> None:
    means = torch.cat([slab((0, 0, 0), (1, 1, 0.1), 4000), slab((0, 0, 0.1), (0.1, 1, 1), 4000, 1),
                       slab((0.2, 0.2, 0.1), (0.8, 0.8, 0.25), 2500, 2)])  # fmt: skip
    cushion = torch.arange(len(means)) >= 8000
    main, shares = split(painted(means, (~cushion, BROWN), (cushion, BLUE)))
    # Gaussians at the border lie in cells of both; 95 % are told apart.
    assert float((main != cushion).float().mean()) > 0.95
    assert [name.split()[-1] for name, _ in shares] == ["blue"]


def test_black_legs_of_a_light_thing_are_a_part() -> None:
    means = torch.cat([slab((0, 0, 0.5), (1, 1, 0.6), 6000), slab((0, 0, 0), (0.08, 1, 0.5), 2000, 1)])
    legs = torch.arange(len(means)) >= 6000
    main, shares = split(painted(means, (~legs, GREY), (legs, BLACK)))
    assert float((main != legs).float().mean()) > 0.9 and [name for name, _ in shares] == ["black"]


def test_light_and_shadow_are_one_material() -> None:
    means = slab((0, 0, 0), (1, 1, 0.2), 8000)
    for color in (BROWN, BLUE, GREY, RED):
        main, shares = split(painted(means, (torch.ones(8000, dtype=torch.bool), color)))
        assert bool(main.all()) and not shares


def test_a_fine_pattern_is_one_material() -> None:
    means = slab((0, 0, 0), (1, 1, 0.02), 20_000)
    stripes = (means[:, 0] * 60).floor().to(torch.int64) % 2 == 0
    main, shares = split(painted(means, (stripes, RED), (~stripes, GREY)))
    assert bool(main.all()) and not shares


def test_half_of_a_thing_is_no_part_of_it() -> None:
    means = slab((0, 0, 0), (1, 1, 0.2), 8000)
    left = means[:, 0] < 0.5
    main, shares = split(painted(means, (left, BLUE), (~left, BROWN)))
    assert bool(main.all()) and not shares


def test_few_gaussians_are_one_material() -> None:
    means = slab((0, 0, 0), (1, 1, 1), 20)
    main, shares = split(painted(means, (torch.arange(20) < 5, RED), (torch.arange(20) >= 5, BLUE)))
    assert bool(main.all()) and not shares
