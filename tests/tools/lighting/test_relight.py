"""Relight: laws of light, what is measured in pictures, lamps, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import AbsentError, UserError
from scenewright.gaussians.harmonics import color_to_dc, dc_to_color
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.render import render
from scenewright.gaussians.rotations import axis_rotation, normalize
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.lighting.light import Light, Tone, colors_of, mean_luminance, relit, tone_of, toned
from scenewright.tools.lighting.moods import light_of, moods
from scenewright.tools.lighting.whites import balance, kelvin_of, luminance
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse
from scenewright.tools.transform import transformed
from tests.tools.conftest import Thing, build

ALL = {"text": "everything", "pick": "all"}
TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)
seeds = st.integers(0, 10**6)


def cloud_of(seed: int, count: int = 400, most: float = 0.6) -> GaussianCloud:
    """Random Gaussians of degree 1 whose colours leave room for brighter ones."""
    g = torch.Generator().manual_seed(seed)
    colors = most * torch.rand(count, 3, generator=g) + 0.02
    sh = torch.cat([color_to_dc(colors)[:, None], 0.05 * torch.randn(count, 3, 3, generator=g)], dim=1)
    return GaussianCloud.create(
        2 * torch.rand(count, 3, generator=g) - 1,
        normalize(torch.randn(count, 4, generator=g)),
        0.02 + 0.1 * torch.rand(count, 3, generator=g),
        0.2 + 0.7 * torch.rand(count, generator=g),
        sh,
    )


def everything(scene: Scene) -> Selection:
    return Selection(Query(text="everything", pick="all"), "found", scene.cloud.ids.sort().values)


def relight(scene: Scene, context: Context, target: Any = None, **fields: Any) -> Done:
    op = parse({"op": "relight", "target": target or ALL, **fields})
    return carry_out(scene, op, context, everything(scene) if target is None else None)


# ---- laws ----


@settings(max_examples=10)
@given(seeds)
def test_no_change_is_bit_for_bit_none(seed: int) -> None:
    cloud = cloud_of(seed)
    after = relit(cloud, None, np.eye(3), Tone())
    assert torch.allclose(after.sh, cloud.sh, atol=1e-6)
    light = Light()
    assert not light.changes and tone_of(light, colors_of(cloud)).gain == 1.0


@settings(max_examples=10)
@given(seeds, st.floats(0.2, 1.6))
def test_brighter_and_back(seed: int, factor: float) -> None:
    cloud = cloud_of(seed, most=0.5)
    for light in (Light(factor), Light(1 / factor)):
        cloud, was = relit(cloud, None, light.matrix, tone_of(light, colors_of(cloud))), cloud
        ratio = _level(cloud) / _level(was)
        assert ratio == pytest.approx(light.exposure, rel=0.01)  # nothing is rolled off
    assert torch.allclose(cloud.sh, cloud_of(seed, most=0.5).sh, atol=5e-3)


def _level(cloud: GaussianCloud) -> float:
    colors = colors_of(cloud)
    return mean_luminance(colors.rgb, colors.weight)


@settings(max_examples=10)
@given(seeds, st.sampled_from(["evening", "overcast", "night", "sunny"]))
def test_light_commutes_with_turning_the_scene(seed: int, mood: str) -> None:
    cloud, named = cloud_of(seed), moods()[mood]
    light = light_of(named.exposure, 6500, named.kelvin or 6500, named.contrast, named.saturation)
    turn, away = axis_rotation(np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8]), 70), np.array([1.0, 2, 3])

    def lit(c: GaussianCloud) -> GaussianCloud:
        return relit(c, None, light.matrix, tone_of(light, colors_of(c)))

    one, two = transformed(lit(cloud), turn, away), lit(transformed(cloud, turn, away))
    assert torch.allclose(one.sh, two.sh, atol=2e-4)  # harmonics are turned in single precision


@settings(max_examples=10)
@given(seeds)
def test_a_pixel_becomes_the_same_multiple(seed: int) -> None:
    """All bands follow, so a dimmer scene is a dimmer picture, from every side."""
    from scenewright.gaussians.camera import Camera

    cloud = cloud_of(seed)
    after = relit(cloud, None, np.eye(3), Tone(0.6))
    camera = Camera.look_at([0, -4, 1], [0, 0, 0], [0, 0, 1], 40, 30)
    assert torch.allclose(render(after, camera).rgb, 0.6 * render(cloud, camera).rgb, atol=2e-3)


def test_the_kernel_agrees_with_plain_arithmetic() -> None:
    g = torch.Generator().manual_seed(3)
    rgb, matrix, tone = torch.rand(500, 3, generator=g), balance(6500, 4000), Tone(1.4, 1.1, 0.4)
    got = toned(rgb, matrix, tone)
    luma = (rgb @ torch.tensor([0.2126, 0.7152, 0.0722])).clamp(0, 1)
    steep = ((luma + 0.03) / 0.43) ** 0.1
    want = 1.4 * steep[:, None] * (rgb @ torch.from_numpy(matrix).float().T)
    top, was = want.amax(dim=1), rgb.amax(dim=1)
    free = (top <= 0.9) | (top <= was)
    assert free.any() and not free.all()
    assert torch.allclose(got[free], want[free], atol=1e-5)
    ratio = top / was
    start, slope = 0.9 / ratio, ratio * (1 - 0.9 / ratio) / 0.1
    way = (was - start) / (1 - start)
    rolled = 0.9 + 0.1 * slope * way / (1 + (slope - 1) * way)
    assert torch.allclose(got.amax(dim=1)[~free], rolled[~free], atol=1e-4)
    assert float(got.max()) <= 1.0 + 1e-5


def test_black_stays_black_and_white_white() -> None:
    ends = torch.tensor([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.99, 0.99, 0.99]])
    lit = toned(ends, np.eye(3), Tone(2.0))
    assert lit[0].abs().max() < 1e-6
    assert torch.allclose(lit[1], torch.ones(3), atol=1e-5)
    assert 0.99 < float(lit[2, 0]) <= 1.0


# ---- in a room ----


@pytest.mark.parametrize("factor", [0.5, 0.75, 1.2])
def test_exposure_is_met_in_pictures(corner: Scene, context: Context, factor: float) -> None:
    """In pixels that do not come near the end of the display's range."""
    after = relight(corner, context, exposure=factor).scene
    was, now = (render(s.cloud, context.viewer).rgb.double().numpy() for s in (corner, after))
    seen = (was.max(axis=2) > 0.05) & (now.max(axis=2) < 0.88)
    assert seen.mean() > 0.2
    assert luminance(now[seen]).mean() / luminance(was[seen]).mean() == pytest.approx(factor, rel=0.05)


def test_the_white_point_is_met_and_told(corner: Scene, context: Context) -> None:
    done = relight(corner, context, kelvin=3200)
    floor = (corner.cloud.group == FLOOR).nonzero().squeeze(1)
    shown = dc_to_color(done.scene.cloud.sh[floor, 0]).double().mean(dim=0).numpy()
    assert kelvin_of(shown) == pytest.approx(3200, rel=0.03)  # the floor is grey
    assert "6500 -> 3200 K" in done.receipt.notes[0]


@pytest.mark.parametrize(("color", "most", "least"), [("blue", 2, 0), ("red", 0, 1), ("purple", 2, 1)])
def test_coloured_light_keeps_its_own_channel_best(
    corner: Scene, context: Context, color: str, most: int, least: int
) -> None:
    done = relight(corner, context, color=color)
    before, after = (dc_to_color(s.cloud.sh[:, 0]).clamp(0.01, 1) for s in (corner, done.scene))
    kept = (after / before).median(dim=0).values
    assert kept[most] == kept.max() and kept[most] > 2 * kept[least]
    assert mean_luminance(*_of(done.scene)) <= mean_luminance(*_of(corner)) * 1.01
    assert f"{color} light" in done.receipt.notes[0]


def _of(scene: Scene) -> tuple[torch.Tensor, torch.Tensor]:
    """Colours and weights of the sampled surfaces."""
    found = colors_of(scene.cloud)
    return found.rgb, found.weight


def test_things_outside_a_selection_stay_bit_for_bit(corner: Scene, context: Context) -> None:
    done = relight(corner, context, {"text": "chair"}, exposure=1.4, warmth=0.3)
    other = corner.cloud.group != CHAIR
    assert torch.equal(done.scene.cloud.sh[other], corner.cloud.sh[other])
    assert not torch.equal(done.scene.cloud.sh[~other], corner.cloud.sh[~other])
    assert done.receipt.outside_changed == 0


def test_only_colours_change_and_the_same_twice(corner: Scene, context: Context) -> None:
    one, two = (relight(corner, context, mood="evening").scene.cloud for _ in range(2))
    assert one.digest() == two.digest()
    for name, column in corner.cloud.columns():
        assert name == "sh" or getattr(one, name) is column


@pytest.mark.parametrize("mood", sorted(moods()))
def test_every_mood_passes_its_checks(corner: Scene, context: Context, mood: str) -> None:
    done = relight(corner, context, mood=mood)
    assert done.receipt.passed
    assert "no light was traced" in done.receipt.notes[0]


def test_light_from_a_side_reaches_what_faces_it(corner: Scene, context: Context) -> None:
    left, right = (relight(corner, context, side=side).scene.cloud for side in ("left", "right"))
    floor = corner.cloud.group == FLOOR
    step = (left.sh - right.sh)[floor, 0].mean(dim=1)
    x = corner.cloud.means[floor, 0]
    assert float(step[x < -1.5].mean()) > 0.05 > -0.05 > float(step[x > 1.5].mean())
    assert _level(left) == pytest.approx(_level(corner.cloud), rel=0.02)  # not brighter as a whole


def test_the_second_half_of_a_strength(corner: Scene) -> None:
    """ "More" after it doubles the step, "less" halves it, and both return."""
    op = parse({"op": "relight", "target": ALL, "exposure": 1.5, "warmth": 0.5, "kelvin": None})
    twice = op.stronger(2.0)
    assert twice is not None and twice.exposure == pytest.approx(2.25)  # type: ignore[attr-defined]
    back = twice.stronger(0.5)
    assert back is not None and back.exposure == pytest.approx(1.5)  # type: ignore[attr-defined]
    assert back.warmth == pytest.approx(0.5)  # type: ignore[attr-defined]
    white = parse({"op": "relight", "target": ALL, "kelvin": 3000}).stronger(0.5)
    assert white is not None and 3000 < white.kelvin < 6500  # type: ignore[attr-defined]


# ---- lamps ----


@pytest.fixture(scope="module")
def lit_corner() -> Scene:
    """A floor lamp beside a table that hides the floor behind it."""
    return build([Thing("floor lamp", "white", (-1.2, 0.0, 0.0)), Thing("wardrobe", "brown", (0.3, 0.0, 0.0), 90)])


def test_a_lamp_lights_what_is_near_and_itself(lit_corner: Scene, context: Context) -> None:
    done = relight(lit_corner, context, {"text": "floor lamp"}, lamps="on")
    gain = (done.scene.cloud.sh - lit_corner.cloud.sh)[:, 0].mean(dim=1)
    cloud, floor = lit_corner.cloud, lit_corner.cloud.group == 2
    x, y = cloud.means[:, 0], cloud.means[:, 1]
    near = floor & ((x + 1.2).hypot(y) < 0.8)
    far = floor & ((x + 1.2).hypot(y) > 2.6) & (x < 0)
    behind = floor & (x > 1.0) & (x < 1.8) & (y.abs() < 0.3)
    beside = floor & ((x + 1.2).hypot(y) > 2.2) & ((x + 1.2).hypot(y) < 3.0) & (x < -0.5)
    assert float(gain[near].mean()) > 2 * float(gain[far].mean()) > 0
    assert float(gain[behind].mean()) < 0.6 * float(gain[beside].mean())  # in the shadow of the wardrobe
    top = (cloud.group == 0) & (cloud.means[:, 2] > 1.2)
    assert float(gain[top].mean()) > 0.1
    assert "light of 1 lamp" in done.receipt.notes[0]


def test_a_lamp_goes_out_again(lit_corner: Scene, context: Context) -> None:
    on = relight(lit_corner, context, {"text": "floor lamp"}, lamps="on").scene
    off = relight(on, context, {"text": "floor lamp"}, lamps="off").scene
    apart = [float((s.cloud.sh - lit_corner.cloud.sh)[:, 0].abs().mean()) for s in (on, off)]
    assert apart[1] < 0.6 * apart[0]  # what was rolled off beside the lamp does not come back


def test_what_is_no_lamp_is_refused(corner: Scene, context: Context) -> None:
    with pytest.raises(AbsentError, match="no lamp"):
        relight(corner, context, {"text": "chair"}, lamps="on")
    with pytest.raises(AbsentError):
        relight(corner, context, {"text": "lamp"}, lamps="on")


def test_all_lights_of_a_room(lit_corner: Scene, corner: Scene, context: Context) -> None:
    on = relight(lit_corner, context, lamps="on")
    assert "light of 1 lamp" in on.receipt.notes[0]
    off = relight(lit_corner, context, lamps="off")
    assert _level(off.scene.cloud) < 0.3 * _level(lit_corner.cloud)
    raised = relight(corner, context, lamps="on")
    assert any("no lamp was found" in note for note in raised.receipt.notes)
    assert _level(raised.scene.cloud) > 1.1 * _level(corner.cloud)


@pytest.mark.parametrize(
    "wrong",
    [{}, {"exposure": 0}, {"exposure": float("nan")}, {"kelvin": 500}, {"warmth": 2}, {"mood": "disco"},
     {"side": "below"}, {"exposure": 1.5, "glow": 1}],
)  # fmt: skip
def test_nonsense_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError):
        parse({"op": "relight", "target": ALL, **wrong})


def test_an_empty_and_a_black_scene(context: Context) -> None:
    black = cloud_of(1).replace(sh=torch.full((400, 4, 3), 0.0))
    black.sh[:, 0] = color_to_dc(torch.zeros(3))
    scene = Scene(black, Frame())
    done = relight(scene, context, exposure=2.0)
    assert torch.allclose(dc_to_color(done.scene.cloud.sh[:, 0]), torch.zeros(400, 3), atol=1e-6)
