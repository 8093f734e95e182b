"""The light of a scene is found from its white surfaces, and left alone where nothing can be white."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.field.measure import Sample
from scenewright.tools.coloring.scene_light import WHITE, SceneLight, light_around, light_of


def room(walls: tuple[float, float, float], share: float = 0.3, seed: int = 0) -> Sample:
    """Walls in light and shade, and things of many colours."""
    g = torch.Generator().manual_seed(seed)
    count = int(2000 * share)
    light = 0.7 + 0.3 * torch.rand(count, 1, generator=g, dtype=torch.float64)
    wall = light * torch.tensor(walls, dtype=torch.float64)
    things = 0.1 + 0.4 * torch.rand(2000 - count, 3, generator=g, dtype=torch.float64) * torch.tensor([1.0, 0.6, 0.3])
    return Sample(torch.cat([wall, things]), torch.full((2000,), 1 / 2000, dtype=torch.float64))


def test_white_walls_in_good_light_say_so() -> None:
    light = light_of(room((0.93, 0.93, 0.93)))
    assert light.white == pytest.approx((1, 1, 1), abs=0.03)
    assert light.note() is None


@pytest.mark.parametrize("level", [0.72, 0.8, 0.9])
def test_exposure_is_that_of_the_walls(level: float) -> None:
    light = light_of(room((level * WHITE,) * 3))
    # The 95 % quantile of walls lit from 0.7 to 1 is at 0.985.
    assert light.level == pytest.approx(level, abs=0.03)


def test_warm_walls_mean_warm_light() -> None:
    red, _, blue = light_of(room((0.93, 0.88, 0.78))).white
    # 0.78 / 0.93 is 0.84; four fifths of the cast are taken for light.
    assert 0.82 < blue / red < 0.9
    assert "warm" in str(light_of(room((0.93, 0.88, 0.78))).note())


def test_white_things_beside_painted_walls_decide() -> None:
    painted, white = room((0.9, 0.84, 0.7), 0.2), room((0.92, 0.92, 0.92), 0.2)
    both = Sample(torch.cat([painted.rgb, white.rgb]), torch.cat([painted.weight, white.weight]) / 2)
    red, _, blue = light_of(both).white
    assert blue == pytest.approx(red, abs=1e-6)


def test_without_anything_white_the_light_is_neutral() -> None:
    light = light_of(room((0.9, 0.2, 0.1)))
    assert light.share == 0 and len(set(light.white)) == 1


def placed(offset: float, level: float, count: int = 600, seed: int = 0) -> tuple[Tensor, Tensor]:
    """Positions and colours of a blob of grey Gaussians."""
    g = torch.Generator().manual_seed(seed)
    return torch.randn(count, 3, generator=g) + offset, torch.full((count, 3), level)


def test_a_place_with_dark_surroundings_has_less_light() -> None:
    dark_things, bright_things = placed(0, 0.3), placed(100, 0.3)
    around = [placed(0, 0.4, seed=1), placed(100, 0.9, seed=2)]
    means = torch.cat([p for p, _ in (dark_things, bright_things, *around)])
    rgb = torch.cat([c for _, c in (dark_things, bright_things, *around)])
    n = len(means)
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4), torch.full((n, 3), 0.1), torch.full((n,), 0.9),
        color_to_dc(rgb)[:, None],
    )  # fmt: skip
    scene = SceneLight((0.98, 0.98, 0.98), 0.5)
    dim = light_around(cloud, torch.arange(600), scene)
    bright = light_around(cloud, torch.arange(600, 1200), scene)
    assert dim.level == pytest.approx(0.9 * scene.level, abs=0.01)
    assert bright.level == pytest.approx(scene.level, abs=0.02)
    assert light_around(cloud, torch.arange(600, 1200), scene, lit=0.05).level < bright.level
