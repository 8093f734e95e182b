"""Recolouring as an operation: pixels follow the model, parts are left and told, the light is the scene's."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

VIEWER = Camera.look_at((0.5, -2.5, 1.5), (0.5, 0.5, 0.3), (0.0, 0.0, 1.0), 96, 72, 60.0)
GREY, BLUE, WALL = (0.55, 0.55, 0.56), (0.15, 0.25, 0.6), (0.9, 0.9, 0.9)


def block(low: tuple[float, float, float], high: tuple[float, float, float], count: int, seed: int) -> torch.Tensor:
    g = torch.Generator().manual_seed(seed)
    a, b = torch.tensor(low), torch.tensor(high)
    return a + (b - a) * torch.rand(count, 3, generator=g)


def scene(degree: int = 0, noise: float = 0.0) -> Scene:
    """A grey seat with a blue cushion before a white wall."""
    means = torch.cat([block((0, 0, 0), (1, 1, 0.3), 5000, 0), block((0.3, 0.3, 0.3), (0.7, 0.7, 0.45), 1500, 1),
                       block((-2, 2, -1), (3, 2.1, 3), 5000, 2)])  # fmt: skip
    rgb = torch.cat([torch.tensor(c).expand(n, 3) for c, n in ((GREY, 5000), (BLUE, 1500), (WALL, 5000))])
    g = torch.Generator().manual_seed(3)
    sh = torch.zeros(len(means), (degree + 1) ** 2, 3)
    sh[:, 0] = color_to_dc(rgb + noise * torch.randn(len(means), 3, generator=g))
    sh[:, 1:] = 0.05 * torch.randn(len(means), (degree + 1) ** 2 - 1, 1, generator=g)
    n = len(means)
    size = torch.where(torch.arange(n) < 6500, 0.02, 0.08)[:, None].expand(n, 3)
    cloud = GaussianCloud.create(means, torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4), size, torch.full((n,), 0.95), sh)
    return Scene(cloud)


def do(where: Scene, rows: slice, **fields: Any) -> Done:
    selection = Selection(Query(last=True), "found", where.cloud.ids[rows])
    return carry_out(where, parse({"op": "recolor", "target": {"last": True}, **fields}), Context(VIEWER), selection)


def test_a_cushion_is_left_and_told() -> None:
    before = scene(noise=0.02)
    done = do(before, slice(0, 6500), color="teal")
    same = (done.scene.cloud.sh == before.cloud.sh).all(dim=2).all(dim=1)
    assert float(same[5000:6500].float().mean()) > 0.9 and float(same[:5000].float().mean()) < 0.1
    assert any("blue" in note and "left" in note for note in done.receipt.notes)


@pytest.mark.parametrize("fields", [{"adjust": "darker"}, {"adjust": "warmer"}, {"adjust": "lighter", "amount": 0.1}])
@pytest.mark.parametrize("degree", [0, 2])
def test_what_is_seen_is_the_model_of_what_was_seen(fields: dict[str, Any], degree: int) -> None:
    """Linear maps commute with blending: where all is selected, each pixel has the map of its colour."""
    before = scene(degree)
    everything = slice(0, len(before.cloud))
    after = do(before, everything, **fields).scene
    was, now = render(before.cloud, VIEWER), render(after.cloud, VIEWER)
    solid = was.alpha > 0.99
    a, b = was.rgb[solid].double(), now.rgb[solid].double()
    matrix = torch.linalg.lstsq(a, b).solution
    # One linear map explains every pixel, whatever mixture it shows; the colour of a Gaussian that a direction makes
    # negative is clamped before blending, which these do not reach.
    assert float((a @ matrix - b).abs().max()) < 2e-3


def test_white_pixels_stay_grey_when_darkened() -> None:
    before = scene(2)
    after = do(before, slice(0, len(before.cloud)), adjust="darker", amount=0.8).scene
    was, now = (rgb_to_lab(render(s.cloud, VIEWER).rgb.double()) for s in (before, after))
    wall = (was[..., 0] > 80) & (was[..., 1:].norm(dim=-1) < 3)
    assert int(wall.sum()) > 500
    assert float((now - was)[wall][:, 1:].norm(dim=1).max()) < 2


def test_a_colour_in_a_dim_room_is_dim() -> None:
    bright = scene()
    dim = bright.replace(cloud=bright.cloud.replace(sh=color_to_dc(0.75 * (0.5 + 0.28209479 * bright.cloud.sh))))
    seen = []
    for where in (bright, dim):
        done = do(where, slice(0, 5000), color="purple")
        seen.append(0.5 + 0.28209479 * done.scene.cloud.sh[:5000, 0].mean(dim=0))
    assert torch.allclose(seen[1] / seen[0], torch.full((3,), 0.8), atol=0.06)
    assert any("white shows at" in note for note in done.receipt.notes)


def test_dark_purple_is_purple_and_dark() -> None:
    done = do(scene(), slice(0, 5000), color="dark purple")
    red, green, blue = (0.5 + 0.28209479 * done.scene.cloud.sh[:5000, 0].mean(dim=0)).tolist()
    assert green < red < blue < 0.5  # and no magenta, in which red is as strong as blue
    assert blue > 1.15 * red


def test_an_edit_does_not_touch_the_scene_before() -> None:
    before = scene(2, 0.02)
    kept = before.cloud.sh.clone()
    for fields in ({"color": "gold"}, {"adjust": "lighter"}, {"adjust": "more_saturated"}):
        do(before, slice(0, 6500), **fields)
    assert torch.equal(before.cloud.sh, kept)


def test_the_whole_thing_includes_the_cushion() -> None:
    before = scene(noise=0.02)
    done = do(before, slice(0, 6500), color="teal", whole=True)
    same = (done.scene.cloud.sh == before.cloud.sh).all(dim=2).all(dim=1)
    assert not bool(same[:6500].any())
    hue = rgb_to_lab(0.5 + 0.28209479 * torch.stack([done.scene.cloud.sh[r, 0].mean(dim=0) for r in (
        slice(0, 5000), slice(5000, 6500))]))  # fmt: skip
    assert bool((hue[:, 1] < -10).all())  # both are teal
    assert not any("left as they" in note for note in done.receipt.notes)


def test_dark_wood_can_be_lightened() -> None:
    """Dark browns are nearly grey; light changes their tint by more than its rule of thumb says, which is no fault."""
    before = scene()
    wood = torch.tensor([0.16, 0.13, 0.11]) * (0.5 + torch.rand(5000, 1, generator=torch.Generator().manual_seed(0)))
    sh = before.cloud.sh.clone()
    sh[:5000, 0] = color_to_dc(wood)
    dark = before.replace(cloud=before.cloud.replace(sh=sh))
    assert do(dark, slice(0, 5000), adjust="lighter").receipt.passed


def test_a_second_coat_is_as_if_it_were_the_first() -> None:
    """Whatever was painted before, and adjusted on the way: shading is not lost twice."""
    before = scene(2)
    at_once = do(before, slice(0, 5000), color="teal").scene
    now = before
    for fields in ({"color": "white"}, {"adjust": "darker"}, {"color": "black"}, {"color": "pink"}):
        now = do(now, slice(0, 5000), **fields).scene
    assert do(now, slice(0, 5000), color="teal").scene.cloud.digest() == at_once.cloud.digest()


def test_things_of_different_colours_part_again_after_one_coat() -> None:
    before = scene(0, 0.02)
    at_once = do(before, slice(0, 6500), color="teal", whole=True).scene
    white = do(before, slice(0, 6500), color="white", whole=True).scene
    again = do(white, slice(0, 6500), color="teal").scene
    assert torch.allclose(again.cloud.sh, at_once.cloud.sh, atol=0.02)


def test_paint_starts_from_what_something_else_made_of_it() -> None:
    """A thing that was relit, or given a material, after it was painted is painted as it looks now."""
    white = do(scene(0, 0.05), slice(0, 5000), color="white").scene
    sh = white.cloud.sh.clone()
    sh[:5000] *= 0.5
    changed = white.replace(cloud=white.cloud.replace(sh=sh))
    again = do(changed, slice(0, 5000), color="teal").scene
    bare = do(changed.replace(painted=None), slice(0, 5000), color="teal").scene
    assert again.cloud.digest() == bare.cloud.digest()
    # Deleted and dropped rows, and dropped bands, do no harm.
    fewer = white.replace(cloud=white.cloud[torch.arange(100, 11500)])
    assert do(fewer, slice(0, 4900), color="teal").receipt.passed
