"""Boxes on a floor: how much light they take, how dark their shadows are, and new things that are fitted to a room."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians import assets
from scenewright.gaussians.assets.modeling.make import basic_name
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc, dc_to_color
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.completing import completed
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.filling.charts import Chart
from scenewright.tools.filling.occlusion import blocked
from scenewright.tools.filling.planes import Plane
from scenewright.tools.harmony.carrier import carried
from scenewright.tools.harmony.form import Surround, form_light
from scenewright.tools.harmony.matched import matched
from scenewright.tools.harmony.shading import shading_of
from scenewright.tools.harmony.shadows import shadows_under, shadows_under_everything
from scenewright.tools.harmony.strength import FAINT, Strength, fitted, strength_of
from scenewright.tools.operation import Context
from scenewright.tools.placement.seen_surface import seen_height
from scenewright.tools.registry import parse

STEP = 0.04
VIEW = Camera.look_at([0.0, -2.4, 1.6], [0.0, 0.1, 0.2], [0, 0, 1], 160, 120)
FRAME = Frame((0, 0, 1), 0.0, 1.0, "given", "given")
GROUND = Plane(np.zeros(3), np.eye(3), 0.0, True, True)


def _sheet(points: np.ndarray, normal: int, rgb: np.ndarray, group: int) -> GaussianCloud:
    scales = np.full((len(points), 3), 0.6 * STEP)
    scales[:, normal] = 0.002
    quats = torch.tensor([1.0, 0, 0, 0]).expand(len(points), 4).contiguous()
    sh = color_to_dc(torch.from_numpy(rgb.astype(np.float32)))[:, None]
    owner = torch.full((len(points),), group, dtype=torch.int32)
    means, scale = (torch.from_numpy(a.astype(np.float32)) for a in (points, scales))
    return GaussianCloud.create(means, quats, scale, torch.full((len(points),), 0.95), sh, owner)


def _grid(low: tuple[float, float], high: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    a, b = (np.arange(lo, hi, STEP) + STEP / 2 for lo, hi in zip(low, high, strict=True))
    x, y = np.meshgrid(a, b, indexing="ij")
    return x.ravel(), y.ravel()


def _floor(tone: float = 0.55) -> GaussianCloud:
    x, y = _grid((-1.6, -1.6), (1.6, 1.6))
    tiles = tone + 0.1 * ((np.floor(x / 0.2) + np.floor(y / 0.2)) % 2)
    return _sheet(np.stack([x, y, 0 * x], 1), 2, np.stack([tiles, tiles, tiles], 1), 0)


def _box(
    middle: tuple[float, float], group: int = 1, size: float = 0.5, light: np.ndarray | None = None
) -> GaussianCloud:
    """A red cube on the floor whose faces are brighter towards `light`."""
    sides = []
    a, b = _grid((-size / 2, -size / 2), (size / 2, size / 2))
    for axis in range(3):
        for end in (-1, 1):
            bright = 1.0 if light is None else float(np.exp(0.3 * end * light[axis]))
            points = np.insert(np.stack([a, b], 1), axis, end * size / 2, axis=1)
            red = np.tile(np.array([0.6, 0.2, 0.15]) * bright, (len(a), 1))
            sides.append(_sheet(points + np.array([*middle, size / 2]), axis, red, group))
    return concat(_numbered(sides))


def _numbered(clouds: list[GaussianCloud]) -> list[GaussianCloud]:
    first, out = 0, []
    for cloud in clouds:
        out.append(cloud.replace(ids=torch.arange(first, first + len(cloud))))
        first += len(cloud)
    return out


def _scene(*clouds: GaussianCloud) -> Scene:
    return Scene(concat(_numbered(list(clouds))), FRAME)


def _rows(scene: Scene, group: int = 1) -> torch.Tensor:
    return (scene.cloud.group == group).nonzero().squeeze(1)


def _found(scene: Scene, query: Query, *_: object, **__: object) -> Selection:
    return Selection(query, "found", scene.cloud.ids[scene.cloud.group == 1], (1,))


def _field(scene: Scene) -> LanguageField:
    """The floor as a structure, and each box as an object."""
    rows = [
        Group(g, "object" if g else "structure", -1, "box" if g else "floor", 0.9, box_of(scene.cloud, FRAME, rows),
              (50.0, 0.0, 0.0), len(rows), 8, 1.0)
        for g, rows in ((g, _rows(scene, g)) for g in sorted(set(scene.cloud.group.tolist())))
    ]  # fmt: skip
    return LanguageField(tuple(rows), np.zeros((len(rows), 8), np.float32), "none")


def _do(scene: Scene, harmony: bool = True, **fields: object) -> Done:
    op = parse(fields)
    context = Context(VIEW, resolver=_found, harmony=harmony)
    return completed(scene, op, context, carry_out(scene, op, context))


@pytest.mark.parametrize("height", [0.15, 0.4])
def test_a_disc_takes_as_much_light_as_its_form_factor(height: float) -> None:
    """Under the middle of a disc of radius R at height h an even sky loses R² / (R² + h²)."""
    radius = 0.3
    x, y = np.meshgrid(np.linspace(-radius, radius, 61), np.linspace(-radius, radius, 61))
    inside = x**2 + y**2 <= radius**2
    points = np.stack([x[inside], y[inside], np.full(int(inside.sum()), height)], 1)
    chart = Chart(GROUND, np.array([-1.0, -1.0]), 2 / 80, (80, 80))
    share = blocked(points, chart, 0.6).shares
    expected = radius**2 / (radius**2 + height**2)
    assert share[0, 39:41, 39:41].mean() == pytest.approx(expected, abs=0.12)  # 60 directions, layers of finite height
    assert share.min() >= 0 and share.max() <= 1 + 1e-9
    assert share[0, 0].max() == 0  # nothing beyond its reach


def test_a_side_from_which_the_light_comes_is_blocked_by_what_stands_there() -> None:
    z, y = np.meshgrid(np.linspace(0, 0.5, 30), np.linspace(-0.3, 0.3, 40))
    wall = np.stack([0 * z.ravel() + 0.3, y.ravel(), z.ravel()], 1)
    chart = Chart(GROUND, np.array([-1.0, -1.0]), 2 / 80, (80, 80))
    share = blocked(wall, chart, 0.7).shares[:, 39:41, 46:48].mean(axis=(1, 2))  # at x = 0.175, the wall is on +u
    assert share[1] > 1.5 * share[0] > 0 and share[3] < 0.3 * share[1]


def test_a_lamp_throws_the_shadow_of_a_disc_to_its_other_side() -> None:
    """A narrow lamp with a slope of one throws the shadow as far aside as the disc is high, as large as it is."""
    x, y = np.meshgrid(np.linspace(-0.2, 0.2, 41), np.linspace(-0.2, 0.2, 41))
    inside = x**2 + y**2 <= 0.2**2
    points = np.stack([x[inside], y[inside], np.full(int(inside.sum()), 0.5)], 1)
    shade = blocked(points, Chart(GROUND, np.array([-1.0, -1.0]), 2 / 80, (80, 80)), 1.5)
    above, aside = shade.from_lamp(np.array([0.0, 0, 1]), 0.02), shade.from_lamp(np.array([-1.0, 0, 1]), 0.02)
    assert above[39:41, 39:41].min() > 0.95 and above[40, 60] < 0.05
    assert aside[39:41, 57:60].min() > 0.8 and aside[40, 40] < 0.05
    assert above.sum() * (2 / 80) ** 2 == pytest.approx(np.pi * 0.2**2, rel=0.15)


@pytest.mark.parametrize("wanted", [0.4, 1.0])
def test_the_strength_of_a_cast_shadow_is_measured_again(wanted: float) -> None:
    scene = _scene(_floor(), _box((0.1, 0.0)))
    dark, told = shadows_under(scene, [_rows(scene)], Strength(wanted, 1))
    assert told.darker > 200 and told.missing == 0
    place = carried(dark, _rows(dark))
    assert place is not None and place.level
    assert fitted(dark.cloud, place) == pytest.approx(wanted, abs=0.12)


def test_only_colours_of_the_ground_near_the_thing_change() -> None:
    scene = _scene(_floor(), _box((0.0, 0.0)))
    dark, told = shadows_under(scene, [_rows(scene)], Strength(0.8, 1))
    for name, column in scene.cloud.columns():
        if name != "sh":
            assert getattr(dark.cloud, name) is column, name
    changed = (dark.cloud.sh != scene.cloud.sh).any(dim=2).any(dim=1)
    assert int(changed.sum()) == told.darker
    assert set(scene.cloud.group[changed].tolist()) == {0}
    assert float(scene.cloud.means[changed, :2].abs().max()) < 1.0
    assert bool((dc_to_color(dark.cloud.sh[changed, 0]) <= dc_to_color(scene.cloud.sh[changed, 0])).all())


def test_only_ground_too_coarse_for_a_shadow_is_split() -> None:
    """Gaussians of the floor at a thing's foot that are wider than its shadow are split; others stay bit for bit."""
    wide = _floor()
    near = (wide.means[:, :2].abs() < 0.5).all(dim=1) & (torch.arange(len(wide)) % 9 == 0)
    scales = wide.scales.clone()
    scales[near, :2] = 0.15
    scene = _scene(wide.replace(scales=scales), _box((0.0, 0.0), size=0.3))
    dark, told = shadows_under(scene, [_rows(scene)], Strength(1.5, 1), split=True, layers=True)
    assert told.made > told.replaced > 0 and len(dark.cloud) == len(scene.cloud) + told.made - told.replaced
    gone = ~torch.isin(scene.cloud.ids, dark.cloud.ids)
    assert int(gone.sum()) == told.replaced and bool((scene.cloud.scales[gone, 0] > 0.1).all())
    kept = scene.cloud[~gone]
    old = dark.cloud[: len(kept)]
    for name, column in kept.columns():
        if name != "sh":
            assert torch.equal(getattr(old, name), column), name
    assert int((old.sh != kept.sh).any(dim=2).any(dim=1).sum()) == told.changed
    assert int(dark.cloud.ids[len(kept) :].min()) > int(scene.cloud.ids.max())


def test_a_thing_is_bright_above_and_dark_below_and_in_its_own_shade() -> None:
    ball = assets.make("ball", 0).cloud
    points = ball.means.double().numpy()
    normals = points - points.mean(axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    around = Surround(np.array([0.0, 0, 1]), np.array([1.0, 0, 1]), np.array([0.5, 0.3, 0.2]), 0.0)
    light = form_light(points, normals, around).mean(axis=1)
    rise = normals[:, 2]
    assert light[rise > 0.9].mean() > 1.8 * light[rise < -0.9].mean()
    level = np.abs(rise) < 0.3
    toward, away = level & (normals[:, 0] > 0.8), level & (normals[:, 0] < -0.8)
    assert light[toward].mean() > 1.1 * light[away].mean()  # the lamp stands there
    assert light.max() < 1.25 and light.min() > 0.1


def test_haze_over_a_floor_does_not_raise_what_stands_on_it() -> None:
    """A surface is seen between its haze and its opaque layer, in the share of the light that each shows."""
    floor = _floor()
    haze = floor.replace(means=floor.means + torch.tensor([0, 0, 0.05]), opacities=torch.full((len(floor),), 0.05))
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    foot, size = np.array([0.0, 0.0, 0.05]), (0.4, 0.4, 0.6)
    cloud = concat(_numbered([floor, haze]))
    height = seen_height(cloud, None, foot, axes, size)
    assert height is not None and -0.05 <= height < -0.02
    assert seen_height(cloud, None, foot + np.array([0, 0, 1.0]), axes, size) is None


def test_what_hangs_in_the_air_casts_none_and_it_is_told() -> None:
    lifted = _box((0.0, 0.0))
    lifted = lifted.replace(means=lifted.means + torch.tensor([0.0, 0.0, 0.6]))
    scene = _scene(_floor(), lifted)
    dark, told = shadows_under(scene, [_rows(scene)], Strength(0.8, 1))
    assert dark is scene and (told.things, told.missing) == (0, 1)


def test_light_is_told_by_how_things_are_shaded() -> None:
    toward = np.array([0.8, 0.0, 0.6])
    boxes = [_box((x, y), i + 1, light=toward) for i, (x, y) in enumerate([(-1, -1), (1, 1), (-1, 1), (1, -1)])]
    slope = shading_of(_scene(_floor(), *boxes)).slope
    assert slope @ toward / np.linalg.norm(slope) > 0.9
    assert 0.1 < np.linalg.norm(slope) < 0.45


def test_nothing_is_dark_in_a_scene_without_light() -> None:
    """Boxes of one colour on a plain floor: nothing in such a scene is shaded."""
    flat = _floor()
    flat = flat.replace(sh=torch.full_like(flat.sh, 0.3))
    scene = _scene(flat, _box((0.0, 0.4)))
    assert strength_of(scene) == Strength(0.0, 0, False)
    done = _do(scene, op="insert", asset="chair")
    assert torch.equal(done.scene.cloud.sh[: len(scene.cloud)], scene.cloud.sh)
    assert any("nothing in this scene is shaded" in note for note in done.receipt.notes)


def test_an_inserted_thing_stands_in_its_shadow_which_is_told() -> None:
    boxes = [_box((x, 1.1), i + 1, light=np.array([0, 0, 1.0])) for i, x in enumerate((-1.0, 1.0))]
    scene = _scene(_floor(), *boxes)
    assert strength_of(scene).value == FAINT
    done = _do(scene, op="insert", asset="stool")
    was, now = scene.cloud, done.scene.cloud
    changed = (now.sh[: len(was)] != was.sh).any(dim=2).any(dim=1)
    assert int(changed.sum()) == done.receipt.filled[0].darker > 20
    assert set(was.group[changed].tolist()) == {0}
    assert any("contact shadow" in note for note in done.receipt.notes)
    again = _do(scene, op="insert", asset="stool")
    assert again.scene.cloud.digest() == now.digest()
    bare = _do(scene, harmony=False, op="insert", asset="stool")
    assert torch.equal(bare.scene.cloud.sh[: len(was)], was.sh) and bare.receipt.filled == ()


def test_a_new_thing_takes_the_white_of_the_room_and_keeps_its_colour_name() -> None:
    x, z = _grid((-1.6, 0.0), (1.6, 1.6))
    wall = _sheet(np.stack([x, 0 * x + 1.6, z], 1), 1, np.tile([0.64, 0.58, 0.5], (len(x), 1)), 3)
    x, y = _grid((-1.6, -1.6), (1.6, 1.6))
    floor = _sheet(np.stack([x, y, 0 * x], 1), 2, np.tile([0.5, 0.3, 0.15], (len(x), 1)), 0)
    scene = _scene(floor, wall, _box((1.0, 1.0), light=np.array([0, 0, 1.0])))
    chair = assets.make("chair", 0, color="teal")
    fitted_chair, told = matched(chair.cloud, scene)
    assert told.describe().split(",")[0].endswith("darker") and "warmer" in told.describe()
    was, now = (dc_to_color(c.sh[chair.main, 0]).mean(dim=0) for c in (chair.cloud, fitted_chair))
    assert float(now.sum()) < float(was.sum())
    assert basic_name(tuple(now.tolist())) == basic_name(tuple(was.tolist()))
    for name, column in chair.cloud.columns():
        assert name == "sh" or getattr(fitted_chair, name) is column


def _shadow(scene: Scene, change: str) -> Done:
    return _do(scene, op="shadow", target={"groups": [1]}, change=change)


def test_a_shadow_is_removed_made_lighter_and_darker() -> None:
    plain = _scene(_floor(), _box((0.1, 0.0)))
    dark, _ = shadows_under(plain, [_rows(plain)], Strength(0.8, 1))
    strengths = {}
    for change in ("remove", "lighter", "darker"):
        done = _shadow(dark, change)
        place = carried(done.scene, _rows(done.scene))
        assert place is not None
        strengths[change] = fitted(done.scene.cloud, place)
        own = _rows(dark)
        assert torch.equal(done.scene.cloud.sh[own], dark.cloud.sh[own])
        assert done.receipt.changed > 100
    assert abs(strengths["remove"]) < 0.12 < strengths["lighter"] < 0.6 < 1.0 < strengths["darker"]
    error = [float((s.cloud.sh - plain.cloud.sh).abs().mean()) for s in (dark, _shadow(dark, "remove").scene)]
    assert error[1] < 0.25 * error[0]  # the goal for what is left of a shadow


def test_a_thing_is_given_a_shadow_once() -> None:
    plain = _scene(_floor(), _box((0.1, 0.0)))
    once = _shadow(plain, "cast").scene
    twice = _shadow(once, "cast")
    assert not torch.equal(once.cloud.sh, plain.cloud.sh)
    assert torch.equal(twice.scene.cloud.sh, once.cloud.sh)
    assert any("casts a shadow already" in note for note in twice.receipt.notes)


@pytest.mark.slow
def test_moving_back_and_forth_does_not_darken_the_floor() -> None:
    """Each move divides out where the thing stood what it multiplied in there before."""
    plain = _scene(_floor(), _box((0.4, 0.0), light=np.array([0, 0, 1.0])))
    scene, step = plain, {"value": 0.9, "unit": "m"}
    for way in ("left", "right", "left", "right"):
        scene = _do(scene, op="move", target={"groups": [1]}, direction=way, distance=step).scene
    floor = (plain.cloud.group == 0).nonzero().squeeze(1)
    change = dc_to_color(scene.cloud.sh[floor, 0]) - dc_to_color(plain.cloud.sh[floor, 0])
    away = scene.cloud.means[floor, 0] < -0.1  # where it does not stand now
    assert float(change[away].abs().mean()) < 0.01
    assert float(change.min()) > -0.45


def test_everything_casts_its_shadow_in_one_pass() -> None:
    boxes = [_box((x, 0.0), i + 1) for i, x in enumerate((-0.9, 0.9))]
    scene = _scene(_floor(), *boxes)
    scene = scene.replace(language=_field(scene))
    dark, told = shadows_under_everything(scene)
    assert told.things == 2
    both, _ = shadows_under(scene, [_rows(scene, 1), _rows(scene, 2)], Strength(FAINT, 0))
    assert torch.equal(dark.cloud.sh, both.cloud.sh)
    assert float(dark.cloud.means[(dark.cloud.sh != scene.cloud.sh).flatten(1).any(dim=1), 2].max()) < 0.01
