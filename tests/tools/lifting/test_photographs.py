"""A fill is optimised against the photographs that see behind what is gone; all else stays as it was."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files import load, save
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.render import render
from scenewright.gaussians.rows import mask_of_ids
from scenewright.gaussians.scene import Scene
from scenewright.tools import completing
from scenewright.tools.execute import carry_out
from scenewright.tools.filling.new_rows import is_fill
from scenewright.tools.lifting import optimise
from scenewright.tools.lifting.behind import Photographs, differing, seen_behind
from scenewright.tools.lifting.photographs import with_photographs
from scenewright.tools.lifting.told import note
from scenewright.tools.operation import Context
from scenewright.tools.receipt import Filled, Lifted
from scenewright.tools.registry import parse

from .conftest import BOX, Room, ring, write_capture

Result = tuple[Scene, Lifted]


@pytest.fixture(scope="module")
def lifted(room: Room) -> Result:
    return with_photographs(room.filled, room.photographs, room.new)


def _same(a: GaussianCloud, b: GaussianCloud) -> bool:
    return all(torch.equal(x, y) for (_, x), (_, y) in zip(a.columns(), b.columns(), strict=True))


@pytest.mark.slow
def test_old_gaussians_stay_bit_for_bit(room: Room, lifted: Result) -> None:
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    assert _same(room.filled.cloud[~own], lifted[0].cloud[~own])
    assert torch.equal(room.filled.cloud.ids, lifted[0].cloud.ids)
    assert not _same(room.filled.cloud[own], lifted[0].cloud[own])


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(room: Room, lifted: Result) -> None:
    again, told = with_photographs(room.filled, room.photographs, room.new)
    assert _same(again.cloud, lifted[0].cloud)
    assert told.model_copy(update={"seconds": 0.0}) == lifted[1].model_copy(update={"seconds": 0.0})


def test_what_photographs_see_behind_comes_near_them(room: Room, lifted: Result) -> None:
    scene, told = lifted
    assert told.reason == "" and told.views >= 6 and told.held_out >= 1
    assert told.psnr_before is not None and told.psnr_after is not None
    assert told.psnr_after > told.psnr_before + 5
    # The stripe that the grey fill did not know is red again, seen from where no photograph was taken.
    camera = ring(24)[7]
    want, was, now = (render(c, camera).rgb.numpy() for c in (room.truth, room.filled.cloud, scene.cloud))
    stripe = (want[..., 0] > 2 * want[..., 1]) & (np.abs(want - was).max(axis=2) > 0.2)
    assert stripe.sum() > 20
    assert np.abs(now - want)[stripe].mean() < 0.3 * np.abs(was - want)[stripe].mean()


def test_what_no_photograph_sees_stays(room: Room, lifted: Result) -> None:
    """The middle of the floor under the box is hidden from all sides."""
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    was, now = room.filled.cloud[own], lifted[0].cloud[own]
    under = (was.means[:, :2].abs() < 0.1).all(dim=1)
    assert under.any() and _same(was[under], now[under])


def test_a_clock_ends_the_steps(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    old, new = room.filled.cloud[~own], room.filled.cloud[own]
    targets = seen_behind(room.photographs, room.filled.cloud, room.new).targets[:2]
    ticks = itertools.count()
    clock = SimpleNamespace(perf_counter=lambda: float(next(ticks)))  # a second a step
    monkeypatch.setattr(optimise, "time", clock)
    changed, steps = optimise.optimised(old, new, targets, seconds=4.0)
    assert steps == 3 and not _same(changed, new)
    same, none = optimise.optimised(old, new, targets, seconds=0.0)
    assert none == 0 and torch.equal(same.means, new.means)


def test_limits_of_what_may_change(room: Room, lifted: Result) -> None:
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    was, now = room.filled.cloud[own], lifted[0].cloud[own]
    side = was.scales.amax(dim=1, keepdim=True)
    assert bool(((now.means - was.means).abs() <= 2.001 * side).all())
    factor = now.scales / was.scales
    assert bool(((factor > 0.39) & (factor < 2.01)).all())
    assert torch.allclose(factor, factor[:, :1].expand_as(factor), rtol=1e-4)  # proportions stay
    assert bool(((now.opacities > 0) & (now.opacities < 1)).all())


def test_an_optimised_fill_is_still_known_as_one(room: Room, lifted: Result, tmp_path: Path) -> None:
    """Another fill of the place must not take it for what was there; in a file as well."""
    scene = lifted[0]
    save(scene, tmp_path / "scene.ply")
    own = mask_of_ids(scene.cloud.ids, room.new)
    for cloud in (scene.cloud, load(tmp_path / "scene.ply").cloud):
        assert bool(is_fill(cloud, own.nonzero().squeeze(1)).all())


def test_pixels_that_the_thing_covers_do_not_count(room: Room) -> None:
    behind = seen_behind(room.photographs, room.filled.cloud, room.new)
    assert behind.looked == 12 and behind.unlike == 0
    blue = [(t.rgb[..., 2] > 1.5 * t.rgb[..., 0]) & t.counts for t in behind.targets]
    assert sum(int(b.sum()) for b in blue) == 0


def test_without_a_view_behind_the_fill_stays_and_the_receipt_says_so(room: Room) -> None:
    """Only what is under the box is new, which no photograph shows."""
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    cloud = room.filled.cloud
    under = own & (cloud.means[:, :2].abs() < 0.12).all(dim=1)
    scene = room.filled.replace(cloud=cloud[~own | under])
    after, told = with_photographs(scene, room.photographs, cloud.ids[under])
    assert after is scene and told.views == 0
    assert note(told) == "the fill was not compared with photographs: no photograph sees behind it"


def test_photographs_of_another_scene_are_left_out(room: Room, tmp_path: Path) -> None:
    other = room.truth.replace(sh=-room.truth.sh)
    folder = write_capture(tmp_path / "other", other, ring(8))
    wrong = Photographs(read_capture(folder), room.photographs.cloud)
    after, told = with_photographs(room.filled, wrong, room.new)
    assert after is room.filled and "do not show this scene" in told.reason


def test_what_an_earlier_edit_took_away_is_in_the_photographs(room: Room) -> None:
    """Photographs are compared with the scene as it was fitted, not as it was before the last edit."""
    cloud = room.filled.cloud
    own = mask_of_ids(cloud.ids, room.new)
    fair = seen_behind(room.photographs, cloud, room.new)
    forgotten = seen_behind(Photographs(room.photographs.capture, cloud[~own]), cloud, room.new)
    assert forgotten.pixels > fair.pixels  # with the box forgotten, pixels that show it count


def test_differing_finds_what_changed(room: Room) -> None:
    before = room.fitted.cloud
    sh = before.sh.clone()
    sh[5] += 1
    changed = before.replace(sh=sh)
    after = concat([changed[10:], changed[:10]])[:-1]  # in another order, and the tenth is gone
    a, b = differing(before, after)
    assert a.nonzero().squeeze(1).tolist() == [5, 9]
    assert after.ids[b].tolist() == [5]


@pytest.mark.slow
def test_delete_with_photographs(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole way: the box is deleted, the floor is filled in grey, and this is optimised."""
    grey = Filled(surface="the floor", gaussians=len(room.new), area=0.4, sure=0.5)
    monkeypatch.setattr(completing, "filled", lambda before, after, moved: (room.filled, (grey,), room.new))
    scene = room.fitted
    target = Selection(Query(), "found", scene.cloud.ids[scene.cloud.group == BOX])
    op = parse({"op": "delete", "target": {"groups": [BOX]}})
    context = Context(viewer=scene.cameras[0], photographs=room.photographs)
    done = completing.completed(scene, op, context, carry_out(scene, op, context, target, seen=False))
    told = done.receipt.lifted
    assert len(told) == 1 and told[0].views > 0 and done.receipt.added == len(room.new)
    assert done.receipt.notes[-1] == note(told[0]) and "lift" in done.receipt.seconds
    alone, _ = with_photographs(room.filled, room.photographs, room.new)
    assert _same(done.scene.cloud, alone.cloud)
    plain = replace(context, photographs=None)
    done = completing.completed(scene, op, plain, carry_out(scene, op, plain, target, seen=False))
    assert done.receipt.lifted == () and done.scene is room.filled


def test_a_session_takes_a_capture(room: Room, tmp_path: Path) -> None:
    from scenewright.agent.session.session import Session

    bare = room.fitted.replace(cameras=())
    session = Session(bare, capture=room.photographs.capture.path)
    assert len(session.scene.cameras) == 12
    with pytest.raises(FileError, match=r"nothing\.json"):
        Session(bare, capture=tmp_path / "nothing.json")
    gone = replace(room.photographs.capture, photos=tuple(tmp_path / f"{k}.png" for k in range(12)))
    with pytest.raises(FileError, match="none of the 12 photographs"):
        Session(bare, capture=gone)
