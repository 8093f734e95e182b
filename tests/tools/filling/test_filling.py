"""A box on a chequered floor before a wall; what the box hides is not there, as in a capture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc, dc_to_color
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.completing import completed, filled
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.filling.fill import beyond, merged, patches_behind
from scenewright.tools.filling.missing import patches_in
from scenewright.tools.filling.shadow import Shadow, _levelled, multiplied
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

STEP = 0.04
FLOOR, WALL, BOX = 0, 1, 2
VIEW = Camera.look_at([0.0, -2.4, 1.6], [0.0, 0.1, 0.2], [0, 0, 1], 160, 120)


def _sheet(points: np.ndarray, normal: int, rgb: np.ndarray, group: int) -> GaussianCloud:
    scales = np.full((len(points), 3), 0.6 * STEP)
    scales[:, normal] = 0.002
    quats = torch.tensor([1.0, 0, 0, 0]).expand(len(points), 4).contiguous()
    sh = color_to_dc(torch.from_numpy(rgb.astype(np.float32)))[:, None]
    owner = torch.full((len(points),), group, dtype=torch.int32)
    f32 = (torch.from_numpy(a.astype(np.float32)) for a in (points, scales))
    means, scale = f32
    return GaussianCloud.create(means, quats, scale, torch.full((len(points),), 0.95), sh, owner)


def _grid(low: tuple[float, float], high: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    a = np.arange(low[0], high[0], STEP) + STEP / 2
    b = np.arange(low[1], high[1], STEP) + STEP / 2
    x, y = np.meshgrid(a, b, indexing="ij")
    return x.ravel(), y.ravel()


def _floor() -> GaussianCloud:
    x, y = _grid((-1.6, -1.6), (1.6, 0.8))
    tiles = 0.45 + 0.2 * ((np.floor(x / 0.2) + np.floor(y / 0.2)) % 2)
    return _sheet(np.stack([x, y, 0 * x], 1), 2, np.stack([tiles, tiles, tiles], 1), FLOOR)


def _wall() -> GaussianCloud:
    x, z = _grid((-1.6, 0.0), (1.6, 1.6))
    rgb = np.stack([0.7 + 0.05 * x, 0.6 + 0 * x, 0.4 + 0.1 * z], 1)
    return _sheet(np.stack([x, 0 * x + 0.8, z], 1), 1, rgb, WALL)


def _box(y: float = 0.35, z: float = 0.0, size: float = 0.6) -> GaussianCloud:
    sides = []
    a, b = _grid((-size / 2, -size / 2), (size / 2, size / 2))
    red = np.tile([0.8, 0.1, 0.1], (len(a), 1))
    for axis in range(3):
        for end in (-size / 2, size / 2):
            points = np.insert(np.stack([a, b], 1), axis, end, axis=1)
            sides.append(_sheet(points + np.array([0, y, z + size / 2]), axis, red, BOX))
    return _numbered(sides)


def _numbered(clouds: list[GaussianCloud]) -> GaussianCloud:
    first, out = 0, []
    for cloud in clouds:
        out.append(cloud.replace(ids=torch.arange(first, first + len(cloud))))
        first += len(cloud)
    return concat(out)


def _scene(box: GaussianCloud, *surfaces: GaussianCloud) -> Scene:
    """The surfaces without what the box hides from above and from before, and the box."""
    kept = []
    low, high = box.means.amin(dim=0), box.means.amax(dim=0)
    for cloud in surfaces:
        inside = ((cloud.means >= low) & (cloud.means <= high))[:, :2].all(dim=1)
        under = inside & (cloud.means[:, 2] < 0.01) & (low[2] < 0.05)
        behind = (cloud.means[:, 0].abs() < 0.3) & (cloud.means[:, 1] > 0.79) & (cloud.means[:, 2] < 0.55)
        kept.append(cloud[~(under | (behind & (high[1] > 0.6)))])
    return Scene(_numbered([*kept, box]), Frame((0, 0, 1), 0.0, 1.0, "given", "given"))


@pytest.fixture(scope="module")
def room() -> Scene:
    return _scene(_box(), _floor(), _wall())


def _delete(scene: Scene, infill: bool = True, context: Context | None = None) -> Done:
    op = parse({"op": "delete", "target": {"groups": [BOX]}, "infill": infill})
    context = context or Context(VIEW, resolver=_found)
    return completed(scene, op, context, carry_out(scene, op, context))


def _found(scene: Scene, query: Query, *_: object, **__: object) -> Selection:
    return Selection(query, "found", scene.cloud.ids[scene.cloud.group == BOX], (BOX,))


@pytest.mark.slow
def test_the_hole_is_closed_and_looks_like_the_floor_and_the_wall(room: Scene) -> None:
    bare, done = _delete(room, infill=False), _delete(room)
    truth = render(_numbered([_floor(), _wall()]), VIEW)
    shots = [render(d.scene.cloud, VIEW) for d in (bare, done)]
    hole = (shots[0].alpha < 0.5) & (truth.alpha > 0.9)
    assert hole.sum() > 300
    assert (shots[1].alpha[hole] > 0.5).float().mean() > 0.98
    error = [float(((s.rgb - truth.rgb)[hole] ** 2).mean().sqrt()) for s in shots]
    assert error[1] < 0.08 < 0.4 < error[0]
    assert done.receipt.added == len(done.scene.cloud) - len(bare.scene.cloud) > 100
    assert {f.surface for f in done.receipt.filled} >= {"the floor", "the wall"}
    assert any("filled what it hid" in note for note in done.receipt.notes)


@pytest.mark.slow
def test_old_rows_stay_bit_for_bit_and_new_ones_continue_their_groups(room: Scene) -> None:
    bare, done = _delete(room, infill=False).scene.cloud, _delete(room).scene.cloud
    shaded = (done.sh[: len(bare)] != bare.sh).any(dim=2).any(dim=1)
    assert not bool(shaded.any()), "this box casts no shadow"
    for name, column in bare.columns():
        assert torch.equal(getattr(done, name)[: len(bare)], column), name
    new = done[torch.arange(len(bare), len(done))]
    assert int(new.ids.min()) > int(room.cloud.ids.max())
    floor = new.means[:, 2] < 0.005
    assert set(new.group[floor].tolist()) == {FLOOR} and set(new.group[new.means[:, 2] > 0.1].tolist()) == {WALL}


@pytest.mark.slow
def test_the_same_edit_gives_the_same_bytes_and_leaves_the_scene_alone(room: Scene) -> None:
    was = room.cloud.digest()
    assert _delete(room).scene.cloud.digest() == _delete(room).scene.cloud.digest()
    assert room.cloud.digest() == was


@pytest.mark.slow
def test_filling_again_adds_nothing(room: Scene) -> None:
    thing = room.cloud[room.cloud.group == BOX]
    scene = _delete(room).scene
    for _ in range(10):
        assert len(merged(scene, patches_behind(scene, thing))) == 0


def test_a_fill_that_fails_leaves_the_edit_as_it_is(room: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """The deletion is done and checked before; the receipt says what went wrong."""
    from scenewright.tools import completing

    def broken(*_: object) -> None:
        raise ZeroDivisionError("no border")

    monkeypatch.setattr(completing, "filled", broken)
    bare, done = _delete(room, infill=False), _delete(room)
    assert done.scene.cloud.digest() == bare.scene.cloud.digest() and done.receipt.passed
    assert any("not filled" in note and "no border" in note for note in done.receipt.notes)


@pytest.mark.slow
def test_a_hole_that_stays_is_said_with_its_place() -> None:
    """A box at the edge of all that is seen: what lies behind it on the other side nobody knows."""
    floor = _floor()
    done = _delete(_scene(_box(y=0.0), floor[floor.means[:, 0] < 0.1]))
    left = [f for f in done.receipt.filled if f.reason]
    for one in left:
        assert one.place is not None and any(one.reason in note for note in done.receipt.notes)
        (a, b), middle = one.place, (0.0, 0.0, 0.3)
        assert all(p - 1.5 < m < q + 1.5 for p, m, q in zip(a, middle, b, strict=True))
    assert left and not any(f.gaussians for f in left)


def test_no_infill_leaves_the_hole(room: Scene) -> None:
    op = parse({"op": "delete", "target": {"groups": [BOX]}})
    context = Context(VIEW, resolver=_found)
    plain = carry_out(room, op, context)
    assert completed(room, op, replace(context, infill=False), plain) is plain
    assert _delete(room, infill=False).receipt.filled == ()


def test_nothing_is_made_where_nothing_is_behind() -> None:
    """A box in the air before no wall hid nothing that could be continued."""
    scene = _scene(_box(y=-0.6, z=0.9, size=0.4), _floor())
    done = _delete(scene)
    assert done.receipt.added == 0


def test_the_middle_of_a_ring_of_things_is_not_closed() -> None:
    """The tops of four stools form no surface over the place of the table between them."""
    tops = []
    for x, y in ((-0.7, 0.0), (0.7, 0.0), (0.0, -0.7), (0.0, 0.7)):
        a, b = _grid((x - 0.16, y - 0.16), (x + 0.16, y + 0.16))
        tops.append(_sheet(np.stack([a, b, 0 * a + 0.3], 1), 2, np.tile([0.1, 0.7, 0.1], (len(a), 1)), FLOOR))
    scene = _scene(_box(y=0.0, z=0.0, size=0.7), _floor(), *tops)
    new = _delete(scene).scene.cloud
    made = new[torch.arange(len(scene.cloud) - int((scene.cloud.group == BOX).sum()), len(new))]
    assert len(made) > 50 and float(made.means[:, 2].max()) < 0.1


@pytest.mark.slow
def test_a_move_fills_where_it_was_and_not_where_it_is(room: Scene) -> None:
    op = parse({"op": "move", "target": {"groups": [BOX]}, "direction": "left", "distance": {"value": 1, "unit": "m"}})
    context = Context(VIEW, resolver=_found)
    done = completed(room, op, context, carry_out(room, op, context))
    new = done.scene.cloud[torch.arange(len(room.cloud), len(done.scene.cloud))]
    assert len(new) > 100 and float(new.means[:, 0].abs().max()) < 0.45
    assert done.receipt.added == len(new)


def test_a_surface_that_goes_is_not_filled(room: Scene) -> None:
    bare = room.replace(cloud=room.cloud[room.cloud.group != WALL])
    wall = room.cloud[room.cloud.group == WALL]
    assert all(abs(p.plane.normal[1]) < 0.9 for p in patches_behind(bare, wall) if len(p.cloud))


def test_a_named_wall_is_filled_and_an_opening_is_left(room: Scene) -> None:
    """The operation closes the hole behind the box once; what is seen through an opening keeps it open."""
    bare = _delete(room, infill=False).scene
    op = parse({"op": "infill", "target": {"groups": [WALL]}})

    def wall(scene: Scene, query: Query, *_: object, **__: object) -> Selection:
        return Selection(query, "found", scene.cloud.ids[scene.cloud.group == WALL], (WALL,))

    context = Context(VIEW, resolver=wall)
    x, z = _grid((0.6, 0.7), (1.2, 1.2))
    cut = (bare.cloud.group == WALL) & (bare.cloud.means[:, 0] > 0.6) & (bare.cloud.means[:, 0] < 1.2)
    cut &= (bare.cloud.means[:, 2] > 0.7) & (bare.cloud.means[:, 2] < 1.2)
    garden = _sheet(np.stack([x, 0 * x + 1.6, z], 1), 1, np.tile([0.2, 0.6, 0.2], (len(x), 1)), 3)
    open_ = bare.replace(cloud=_numbered([bare.cloud[~cut], garden]))
    first = carry_out(open_, op, context)
    made = first.scene.cloud[torch.arange(len(open_.cloud), len(first.scene.cloud))]
    assert len(made) == 0 or float(made.means[:, 0].max()) < 0.6
    assert any("window" in note for note in first.receipt.notes)
    again = carry_out(first.scene, op, context)
    assert again.receipt.added == 0


@pytest.mark.slow
def test_things_that_touch_are_filled_together_without_a_seam(room: Scene) -> None:
    """The box as two halves in two groups: deleted together they leave the same as in one piece."""
    halves = room.cloud.group.clone()
    halves[(halves == BOX) & (room.cloud.means[:, 0] > 0)] = BOX + 1
    parts = room.replace(cloud=room.cloud.replace(group=halves))
    gone = room.cloud.group == BOX
    one, two = (filled(s, s.replace(cloud=s.cloud[~gone]))[0].cloud for s in (room, parts))
    assert one.digest() == two.digest()


@pytest.mark.slow
def test_fill_of_a_fill_ten_times_does_not_drift(room: Scene) -> None:
    """A box put back ten times onto what its deletion made, and deleted again: rows and picture stay."""
    box = room.cloud[room.cloud.group == BOX]
    done = _delete(room).scene
    first, count = render(done.cloud, VIEW).rgb, len(done.cloud)
    for _ in range(10):
        back = box.replace(ids=torch.arange(len(box)) + int(done.cloud.ids.max()) + 1)
        done = _delete(done.replace(cloud=concat([done.cloud, back]))).scene
    assert len(done.cloud) == count
    assert float((render(done.cloud, VIEW).rgb - first).abs().max()) < 1e-3


# ---- contact shadows: taken off where a thing stood, put on where it stands; patterns are left

CONTEXT = Context(VIEW, resolver=_found)


def test_nothing_is_filled_where_everything_is_gone(room: Scene) -> None:
    empty = room.replace(cloud=room.cloud[:0])
    scene, told, ids = filled(room, empty)
    assert scene is empty and told == () and not len(ids)


def test_a_surface_without_extent_has_no_hole(room: Scene) -> None:
    rows = torch.arange(60)
    means = room.cloud.means.clone()
    means[rows] = means[0].clone()
    assert patches_in(room.replace(cloud=room.cloud.replace(means=means)), rows) == []


def _shadowed(darkness: float) -> tuple[Scene, torch.Tensor]:
    """A small box on a large floor under its shadow, and the ratio of each floor Gaussian's colour."""
    floor, box = _floor(), _box(y=-0.4, size=0.5)
    away = (floor.means[:, :2] - torch.tensor([0.0, -0.4])).abs().amax(dim=1) - 0.25
    ratio = 1 - darkness * torch.exp(-0.5 * (away.clamp(min=0) / 0.06) ** 2)
    shaded = floor.replace(sh=color_to_dc(dc_to_color(floor.sh) * ratio[:, None, None]))
    return Scene(_numbered([shaded, box]), Frame((0, 0, 1), 0.0, 1.0, "given", "given")), ratio


def _do(scene: Scene, **fields: object) -> Done:
    op = parse({"target": {"groups": [BOX]}, **fields})
    return completed(scene, op, CONTEXT, carry_out(scene, op, CONTEXT))


def test_a_deletion_takes_the_shadow_off() -> None:
    """At most a quarter of it is left, in the mean over the floor that it darkened."""
    scene, ratio = _shadowed(0.4)
    done = _do(scene, op="delete")
    now = dc_to_color(done.scene.cloud.sh[: len(ratio), 0]) / dc_to_color(_floor().sh[:, 0])
    dark = (ratio < 0.95) & (ratio < 1)
    assert float((now.mean(dim=1) - 1)[dark].abs().mean()) < 0.25 * float((1 - ratio)[dark].mean()) + 0.02
    assert done.receipt.filled[0].lighter > 50
    far = ratio > 0.999
    assert torch.equal(done.scene.cloud.sh[: len(ratio)][far], scene.cloud.sh[: len(ratio)][far])


@pytest.mark.parametrize("wrong", [0.75, 1.25])
def test_a_shadow_told_too_dark_or_too_faint_is_corrected(wrong: float) -> None:
    """An even floor under a round shadow, whose logarithm was told wrong by a factor."""
    y, x = np.mgrid[:60, :60] - 30.0
    true = np.exp(-0.6 * np.exp(-(x**2 + y**2) / 150))
    floor = 0.6 + np.random.default_rng(0).normal(0, 0.01, (60, 60, 1)) + np.zeros(3)
    every = np.ones((60, 60), bool)
    found = _levelled(floor * true[..., None], every, every, Shadow(np.where(true < 0.99, true**wrong, 1.0), 0.0)).ratio
    assert np.abs(np.log(found / true)).max() < 0.5 * np.abs(np.log(true)).max() * abs(wrong - 1)
    assert found.max() <= 1.0


def test_a_move_takes_the_shadow_along() -> None:
    scene, ratio = _shadowed(0.4)
    done = _do(scene, op="move", direction="left", distance={"value": 0.8, "unit": "m"})
    now = dc_to_color(done.scene.cloud.sh[: len(ratio), 0]) / dc_to_color(scene.cloud.sh[: len(ratio), 0])
    there = scene.cloud.means[: len(ratio)]
    new = ((there[:, 0] + 0.8).abs() < 0.2) & ((there[:, 1] + 0.4).abs() < 0.2)
    assert float(now[new].mean()) < 0.85 and float(now[ratio < 0.7].mean()) > 1.2
    assert any(f.darker for f in done.receipt.filled)


def test_a_floor_without_a_shadow_keeps_every_bit() -> None:
    scene, ratio = _shadowed(0.0)
    after = _do(scene, op="delete").scene.cloud
    assert torch.equal(after.sh[: len(ratio)], scene.cloud.sh[: len(ratio)])


def test_a_spotted_floor_has_no_shadow_that_could_be_told() -> None:
    """Dark and bright spots of all sizes, as of a meadow."""
    scene, ratio = _shadowed(0.0)
    x, y = scene.cloud.means[: len(ratio), :2].T.double().numpy()
    rng = np.random.default_rng(3)
    spots = sum(np.sin(rng.normal(0, 8) * x + rng.normal(0, 8) * y + rng.uniform(0, 6)) for _ in range(9))
    rgb = torch.from_numpy(np.clip(0.45 + 0.12 * spots, 0.02, 1).astype(np.float32))[:, None].expand(-1, 3)
    sh = scene.cloud.sh.clone()
    sh[: len(ratio), 0] = color_to_dc(rgb)
    spotted = scene.replace(cloud=scene.cloud.replace(sh=sh))
    after = _do(spotted, op="delete").scene.cloud
    assert torch.equal(after.sh[: len(ratio)], sh[: len(ratio)])


def test_colours_are_multiplied_in_all_bands() -> None:
    sh = torch.randn(5, 4, 3, generator=torch.Generator().manual_seed(0))
    factor = torch.tensor([0.5, 1.0, 2.0, 1.5, 0.25])
    out = multiplied(sh, factor)
    torch.testing.assert_close(dc_to_color(out[:, 0]), dc_to_color(sh[:, 0]) * factor[:, None])
    torch.testing.assert_close(out[:, 1:], sh[:, 1:] * factor[:, None, None])


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_broken_gaussians_are_passed_over(room: Scene, value: float) -> None:
    """Neither a broken thing nor broken surroundings raise, and nothing broken is made."""
    means, scales = room.cloud.means.clone(), room.cloud.scales.clone()
    means[::17], scales[5::17] = value, value
    broken = room.replace(cloud=room.cloud.replace(means=means, scales=scales))
    gone = broken.cloud.group == BOX
    patches = patches_behind(broken.replace(cloud=broken.cloud[~gone]), broken.cloud[gone])
    new = merged(broken, patches)
    assert len(new) > 50 and bool(torch.isfinite(new.means).all() and torch.isfinite(new.sh).all())


def test_a_surface_is_not_extended_into_the_void() -> None:
    """Beyond what is seen of it a surface goes on only up to another surface that ends it."""
    covered = np.zeros((40, 40), dtype=bool)
    covered[20:, 2:38] = True  # the near half of a floor
    hole = np.zeros_like(covered)
    hole[10:20, 10:30] = True  # beyond it
    hole[25:30, 15:20] = True  # and inside of it
    covered &= ~hole
    everywhere = np.ones_like(covered)
    void = beyond(hole, covered, everywhere)
    assert void[10:19, 10:30].all()
    assert not void[25:30].any()
    before_wall = everywhere.copy()
    before_wall[:10] = before_wall[:, :10] = before_wall[:, 30:] = False  # walls around it
    assert not beyond(hole, covered, before_wall).any()
