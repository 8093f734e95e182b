"""The measures of colour edits see what they are for: a hue shift of greys, a wrong colour, and only those."""

from __future__ import annotations

import pytest
import torch

from scenewright.benchmarks._edits import color
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.scene import Scene
from scenewright.tools.color_map import ColorMap
from scenewright.tools.coloring import adjust


def thing() -> color._Thing:
    """A grey block in uneven light before a white wall."""
    g = torch.Generator().manual_seed(0)
    block = torch.rand(4000, 3, generator=g) * torch.tensor([1.0, 1.0, 0.5])
    wall = torch.rand(3000, 3, generator=g) * torch.tensor([5.0, 0.1, 4.0]) + torch.tensor([-2.0, 2.0, -1.0])
    light = 0.6 + 0.4 * torch.rand(4000, 1, generator=g)
    rgb = torch.cat([light * torch.tensor([0.6, 0.59, 0.6]), torch.full((3000, 3), 0.92)])
    size = torch.tensor([0.03] * 4000 + [0.1] * 3000)[:, None].expand(-1, 3)
    cloud = GaussianCloud.create(
        torch.cat([block, wall]), torch.tensor([[1.0, 0, 0, 0]]).expand(7000, 4), size, torch.full((7000,), 0.95),
        color_to_dc(rgb)[:, None],
    )  # fmt: skip
    viewer = Camera.look_at((0.5, -3.0, 1.5), (0.5, 0.5, 0.3), (0.0, 0.0, 1.0), 120, 90, 50.0)
    return color._Thing(Scene(cloud), torch.arange(4000), viewer)


def test_the_product_meets_the_goals_on_a_plain_thing() -> None:
    seen = thing()
    assert color._grey(seen, "darker", 0.5) < 0.5
    for name in ("teal", "dark purple", "white"):
        assert color._color(seen, name)[0] < color.COLOR_GOAL


def test_a_hue_shift_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    blue = ColorMap(torch.diag(torch.tensor([0.5, 0.55, 0.75], dtype=torch.float64)), torch.zeros(3).double())
    monkeypatch.setattr(adjust, "darker", lambda *_: blue)
    monkeypatch.setattr("scenewright.tools.ops.recolor.grey_shift", lambda *_: 0.0)  # or its own check refuses it
    assert color._grey(thing(), "darker", 0.5) > 3 * color.GREY_GOAL


def test_a_wrong_colour_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    from scenewright.tools.ops import recolor

    magenta = torch.tensor([0.6, 0.0, 0.6], dtype=torch.float64)
    monkeypatch.setattr(recolor.Recolor, "_pigment", lambda self: magenta)
    assert color._color(thing(), "dark purple")[0] > 1.5 * color.COLOR_GOAL


def test_refused_edits_are_counted_and_left_out_of_the_means() -> None:
    nan = float("nan")
    greys = [color.Edit("s", "t", "darker", 0.5), color.Edit("s", "t", "lighter", nan)]
    colors = [color.Edit("s", "t", "teal", 4.0, 5.0), color.Edit("s", "t", "red", 8.0, 9.0)]
    found = {m.key: m.value for m in color.metrics(greys, colors)}
    assert found == {
        "color.grey_shift.worst": 0.5, "color.distance.mean": 6.0, "color.distance.strict": 7.0,
        "color.distance.within_goal": 0.5, "color.refused": 1.0,
    }  # fmt: skip
    assert color.metrics([], []) == ()
    assert "| s | t | 4.0 | 8.0 |" in color.table(colors)
