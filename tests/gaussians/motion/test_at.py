"""The scene at a time against a plain loop over tracks and rows; what is shared; boxes of groups."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.harmonics import rotate
from scenewright.gaussians.language.field.measure import box_of
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.boxes import boxes_over
from scenewright.gaussians.motion.motion import Motion, Track, pose
from scenewright.gaussians.rotations import from_matrix, multiply
from scenewright.gaussians.scene import Scene
from tests.support.moving_balls import moving
from tests.support.three_balls import balls


def slowly(scene: Scene, time: float) -> Scene:
    """`at` for the cloud, row by row: the readable reference."""
    motion = scene.motion
    assert motion is not None
    cloud = scene.cloud
    means, quats, sh = cloud.means.double(), cloud.quats.clone(), cloud.sh.clone()
    opacities = cloud.opacities.clone()
    for row, name in enumerate(cloud.ids.tolist()):
        for residual in motion.residuals:
            for place in np.flatnonzero(residual.ids == name):
                means[row] += torch.from_numpy(residual.displacements(time)[place])
        for look in motion.looks:
            for place in np.flatnonzero(look.ids == name):
                if look.start <= time < look.stop:
                    sh[row] = sh[row] if look.sh is None else look.sh[place][: sh.shape[1]]
                    opacities[row] = opacities[row] if look.opacities is None else look.opacities[place]
        for track in motion.tracks:
            if name in track.ids:
                turn, shift = (torch.from_numpy(v) for v in pose(track, time))
                means[row] = turn @ means[row] + shift
                quats[row] = multiply(from_matrix(turn).float(), quats[row])
                sh[row] = rotate(sh[row][None], turn)[0]
    kept = opacities > 0
    return scene.replace(
        cloud=cloud.replace(means=means.float(), quats=quats, sh=sh, opacities=opacities)[kept], motion=None
    )


@pytest.mark.parametrize("time", [0.0, 0.7, 1.6, 2.7, 9.0])
def test_the_scene_at_a_time_is_what_a_plain_loop_gives(time: float) -> None:
    scene = moving()
    got, want = at(scene, time).cloud, slowly(scene, time).cloud
    assert len(got) == len(want)
    assert torch.equal(got.ids, want.ids) and torch.equal(got.group, want.group)
    assert torch.equal(got.opacities, want.opacities)
    # float32 in other orders of operations
    torch.testing.assert_close(got.means, want.means, atol=2e-6, rtol=0)
    torch.testing.assert_close(got.sh, want.sh, atol=2e-6, rtol=0)
    # a quaternion and its negative are one rotation
    assert float((got.quats * want.quats).sum(dim=1).abs().min()) > 1 - 2e-6


def test_rows_in_another_order_and_with_gaps_are_found_by_their_ids() -> None:
    scene = moving()
    order = torch.randperm(len(scene.cloud), generator=torch.Generator().manual_seed(0))[:100]
    mixed = scene.replace(cloud=scene.cloud[order])
    here = at(scene, 1.0).cloud
    there = at(mixed, 1.0).cloud
    assert torch.equal(there.means, here.means[order]) and torch.equal(there.sh, here.sh[order])


def test_a_static_scene_is_itself_and_columns_are_shared() -> None:
    static = balls(300)
    assert at(static, 3.0) is static
    scene = moving()
    start = at(scene, 0.0)
    assert start.motion is None and start.cloud.means is not scene.cloud.means  # a residual says where they are
    slid = scene.replace(motion=Motion(scene.motion.tracks[1:2], stop=4.0)) if scene.motion else scene
    assert at(slid, 0.0).cloud is scene.cloud and at(slid, 0.0).language is not None
    later = at(slid, 2.0).cloud
    for name in ("quats", "scales", "opacities", "sh", "group", "ids"):
        assert getattr(later, name) is getattr(scene.cloud, name)
    assert later.means is not scene.cloud.means


def test_nothing_is_written_in_place() -> None:
    scene = moving()
    before = scene.cloud.digest()
    at(scene, 2.7)
    assert scene.cloud.digest() == before


def test_a_moment_that_is_held_stays_as_it_is_and_one_that_is_not_is_written_again() -> None:
    """Columns of earlier moments are memory for later ones, if nobody holds them, not even as an array."""
    scene = moving()
    fresh = {time: slowly(scene, time).cloud for time in (0.7, 1.6, 2.7)}
    held = at(scene, 0.7).cloud
    digest = held.digest()
    array = at(scene, 1.6).cloud.sh.numpy()
    kept = array.copy()
    for time in (2.7, 1.6, 0.7, 2.7, 0.0, 1.6):
        got = at(scene, time).cloud
        if time in fresh:
            torch.testing.assert_close(got.means, fresh[time].means, atol=2e-6, rtol=0)
            torch.testing.assert_close(got.sh, fresh[time].sh, atol=2e-6, rtol=0)
        del got
    assert held.digest() == digest and np.array_equal(array, kept)
    where = at(scene, 1.0).cloud.sh.data_ptr()
    assert at(scene, 1.1).cloud.sh.data_ptr() == where  # the first of the two was let go
    both = at(scene, 1.0).cloud.sh, at(scene, 1.1).cloud.sh
    assert both[0].data_ptr() != both[1].data_ptr()


def test_a_time_must_be_finite() -> None:
    for wrong in (math.inf, math.nan, "1", None, [1, 2]):
        for scene in (moving(), moving().replace(motion=None)):
            with pytest.raises(UserError, match="finite number of seconds"):
                at(scene, wrong)  # type: ignore[arg-type]
    assert torch.equal(at(moving(), np.float32(1)).cloud.means, at(moving(), 1).cloud.means)


def measured(scene: Scene) -> Scene:
    """The scene with the boxes of its groups as embedding measures them."""
    assert scene.language is not None
    groups = []
    for group in scene.language.groups:
        rows = (scene.cloud.group == group.id).nonzero().squeeze(1)
        groups.append(replace(group, box=box_of(scene.cloud, scene.frame, rows, group.box.axes)))
    return scene.replace(language=replace(scene.language, groups=tuple(groups)))


def test_boxes_at_the_start_are_the_stored_ones_and_later_near_those_measured_again() -> None:
    scene = measured(moving())
    assert scene.language is not None and scene.motion is not None
    scene = scene.replace(motion=scene.motion.replace(residuals=()))
    over = boxes_over(scene, (0.0, 1.0, 2.2))
    assert sorted(over) == [0, 1]
    for group, boxes in over.items():
        np.testing.assert_allclose(boxes[0].center, scene.language.groups[group].box.center, atol=1e-9)
        np.testing.assert_allclose(boxes[0].size, scene.language.groups[group].box.size, atol=1e-9)
        for time, box in zip((1.0, 2.2), boxes[1:], strict=True):
            there = at(scene, time).cloud
            again = box_of(there, scene.frame, (there.group == group).nonzero().squeeze(1), box.axes)
            # Measured sizes leave out the outermost 1 % of some 100 Gaussians: 5 cm of a ball of one metre.
            np.testing.assert_allclose(box.center, again.center, atol=0.05)
            np.testing.assert_allclose(box.size, again.size, atol=0.1)


def test_a_box_turns_with_its_group_about_the_vertical_and_keeps_its_size() -> None:
    scene = measured(moving())
    assert scene.language is not None
    ids = scene.cloud.ids[scene.cloud.group == 0].numpy()
    turning = scene.replace(motion=Motion((Track.hinge(ids, [0, 1], [0, 1.0], (0, 0, 1), (0, 0, 0)),), stop=1.0))
    stored, now = scene.language.groups[0].box, at(turning, 1.0).language
    assert now is not None
    box = now.groups[0].box
    np.testing.assert_allclose(box.axes[0], [math.cos(1), math.sin(1), 0], atol=1e-9)
    np.testing.assert_allclose(box.size, stored.size, atol=1e-9)
    x, y, z = stored.center
    np.testing.assert_allclose(
        box.center, [x * math.cos(1) - y * math.sin(1), x * math.sin(1) + y * math.cos(1), z], atol=1e-9
    )
    assert now.groups[1] is scene.language.groups[1]


def test_a_group_of_which_a_part_moves_has_the_box_of_all_of_it() -> None:
    scene = measured(moving())
    assert scene.language is not None
    ids = scene.cloud.ids[(scene.cloud.group == 0) & (scene.cloud.means[:, 2] > 0.8)].numpy()
    lifted = scene.replace(motion=Motion((Track.slide(ids, [0, 1], [0, 2.0], (0, 0, 1)),), stop=1.0))
    stored, box = scene.language.groups[0].box, boxes_over(lifted, (1.0,))[0][0]
    up = np.array([0.0, 0, 1])
    assert box.bottom(up) == pytest.approx(stored.bottom(up))
    assert box.top(up) == pytest.approx(stored.top(up) + 2.0)


def test_looks_change_the_colour_and_the_count_of_their_group() -> None:
    scene = moving()
    assert scene.language is not None
    blue, hidden = at(scene, 2.0).language, at(scene, 2.7).language
    assert blue is not None and hidden is not None
    assert blue.groups[1].lab[2] < -30 and blue.groups[0].lab == scene.language.groups[0].lab
    count = int((scene.cloud.group == 1).sum())
    assert hidden.groups[1].count == count - len(range(0, count, 3))
    assert at(scene, 3.5).language is not None
