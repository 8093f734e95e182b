"""Motion found in frames: the bodies that made them, what follows none of them, and what is no sequence."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.motion.sequence import motion_of
from scenewright.gaussians.scene import Scene
from tests.support.three_balls import balls

TIMES = np.linspace(0, 3, 16)


def scene_of_two_bodies() -> Scene:
    scene = balls(600)
    ids = [scene.cloud.ids[scene.cloud.group == i].numpy() for i in range(3)]
    turning = Track.hinge(ids[0], [0, 3], [0, 2.0], (0, 0, 1), (-1.2, 0, 0))
    falling = Track.along(ids[1], [0.5, 1.5], [[0, 0, 0], [0, 0.4, -0.7]])
    return scene.replace(motion=Motion((turning, falling), stop=3.0))


def test_bodies_are_found_and_move_as_in_the_frames() -> None:
    scene = scene_of_two_bodies()
    found = motion_of([lambda t=t: at(scene, t).cloud for t in TIMES], TIMES.tolist())  # type: ignore[misc]
    assert scene.motion is not None and found.motion is not None
    assert sorted(found.bodies) == sorted(len(t) for t in scene.motion.tracks)
    assert {tuple(t.ids) for t in found.motion.tracks} == {tuple(t.ids) for t in scene.motion.tracks}
    assert (found.left, found.rank, found.recolored) == (0, 0, 0)
    size = float((scene.cloud.means.amax(dim=0) - scene.cloud.means.amin(dim=0)).norm())
    assert found.worst < 2e-4 * size
    again = scene.replace(motion=found.motion)
    for time in TIMES:
        there, here = at(again, float(time)).cloud.means, at(scene, float(time)).cloud.means
        assert float((there - here).norm(dim=1).max()) <= found.worst + 1e-6
    falling = min(found.motion.tracks, key=lambda t: float(t.offsets[-1, 2]))
    assert len(falling.times) < len(TIMES)  # no keys where a curve between others says the same


def test_what_follows_no_body_gets_a_residual() -> None:
    scene = balls(400)
    loose = scene.cloud.group == 2
    way = torch.randn(400, 3, generator=torch.Generator().manual_seed(0)) * 0.1 * loose[:, None]

    def frame(time: float) -> Scene:
        return scene.replace(cloud=scene.cloud.replace(means=scene.cloud.means + way * float(np.sin(time))))

    found = motion_of([lambda t=t: frame(float(t)).cloud for t in TIMES], TIMES.tolist())  # type: ignore[misc]
    assert found.motion is not None and found.bodies == ()
    assert found.left == int((way.norm(dim=1) > 0).sum()) and found.rank == 1
    again = at(scene.replace(motion=found.motion), float(TIMES[5])).cloud.means
    torch.testing.assert_close(again, frame(float(TIMES[5])).cloud.means, atol=1e-5, rtol=0)


def test_still_frames_have_no_motion_and_changed_colours_are_told() -> None:
    cloud = balls(100).cloud
    painted = cloud.replace(sh=cloud.sh + 0.5 * (cloud.group == 1)[:, None, None])
    found = motion_of([lambda: cloud, lambda: painted], [0.0, 1.0])
    assert found.motion is None and found.recolored == int((cloud.group == 1).sum())


def test_other_rows_are_refused() -> None:
    cloud = balls(100).cloud
    with pytest.raises(UserError, match=r"file 2 .* has 99 Gaussians and the first one 100"):
        motion_of([lambda: cloud, lambda: cloud[1:]], [0.0, 1.0])
    with pytest.raises(UserError, match="another order"):
        motion_of([lambda: cloud, lambda: cloud[torch.arange(99, -1, -1)]], [0.0, 1.0])
