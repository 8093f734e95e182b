"""A moving thing that is edited goes on moving, where and as the edit put it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Motion, Track, mentioned_ids, moving_ids
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import carry_out
from scenewright.tools.keeping_motion import STATIC_COPY
from scenewright.tools.operation import Context
from scenewright.tools.receipt import Receipt
from scenewright.tools.registry import parse

CHAIR, RED = 1, 2  # groups of the corner


@pytest.fixture(scope="module")
def moving(corner: Scene) -> Scene:
    """The corner in which the green chair turns by a quarter and the armchair rises by a metre."""
    ids = [corner.cloud.ids[corner.cloud.group == group].numpy() for group in (CHAIR, RED)]
    turning = Track.hinge(ids[0], [0, 1], [0, math.pi / 2], (0, 0, 1), (-1.6, 0.0, 0.0))
    rising = Track.slide(ids[1], [0, 1], [0, 1.0], (0, 0, 1))
    return corner.replace(motion=Motion((turning, rising), stop=2.0))


def done(scene: Scene, context: Context, **op: Any) -> tuple[Scene, Receipt]:
    result = carry_out(scene, parse(op), context)
    return result.scene, result.receipt


def middle(scene: Scene, group: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.asarray(scene.cloud.means[scene.cloud.group == group].double().mean(dim=0).numpy())


def test_colours_leave_the_motion_alone(moving: Scene, context: Context) -> None:
    after, _ = done(moving, context, op="recolor", target={"text": "chair"}, color="blue")
    assert after.motion is moving.motion
    assert torch.equal(at(after, 1.0).cloud.means, at(moving, 1.0).cloud.means)


def test_a_moved_thing_moves_in_its_new_place(moving: Scene, context: Context) -> None:
    after, _ = done(moving, context, op="move", target={"text": "chair"}, direction="left", distance={"value": 0.5})
    offset = middle(after, CHAIR) - middle(moving, CHAIR)
    assert float(np.abs(offset).max()) > 0.4
    np.testing.assert_allclose(middle(at(after, 1.0), CHAIR) - middle(at(moving, 1.0), CHAIR), offset, atol=1e-5)
    np.testing.assert_array_equal(middle(at(after, 1.0), RED), middle(at(moving, 1.0), RED))


def test_a_turned_and_a_scaled_thing_move_alike(moving: Scene, context: Context) -> None:
    turned, _ = done(moving, context, op="rotate", target={"text": "chair"}, degrees=90)
    there = at(turned, 1.0).cloud.means[turned.cloud.group == CHAIR]
    here = turned.cloud.means[turned.cloud.group == CHAIR]
    # The rotation keeps the foot of the box in place, and the hinge turns on by a quarter about the mapped pivot.
    assert turned.motion is not None
    pivot = turned.motion.tracks[0].pivot
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    np.testing.assert_allclose(there.double().numpy(), (here.double().numpy() - pivot) @ quarter.T + pivot, atol=1e-5)
    doubled, _ = done(moving, context, op="scale", target={"text": "armchair"}, factor=1.5)
    rise = middle(at(doubled, 1.0), RED) - middle(doubled, RED)
    np.testing.assert_allclose(rise, [0, 0, 1.5], atol=1e-5)


def test_a_removed_thing_takes_its_motion_along(moving: Scene, context: Context) -> None:
    after, _ = done(moving, context, op="delete", target={"text": "chair"})
    assert after.motion is not None and len(after.motion.tracks) == 1
    assert not np.isin(mentioned_ids(after.motion), moving.cloud.ids[moving.cloud.group == CHAIR].numpy()).any()
    none, _ = done(after, context, op="delete", target={"text": "armchair"})
    assert none.motion is None


@pytest.mark.slow
def test_what_is_new_does_not_move(moving: Scene, context: Context) -> None:
    after, _ = done(moving, context, op="insert", asset="vase")
    assert after.motion is moving.motion and len(after.cloud) > len(moving.cloud)
    copied, receipt = done(moving, context, op="duplicate", target={"text": "chair"})
    assert STATIC_COPY in receipt.notes
    assert moving_ids(copied.motion).tolist() == moving_ids(moving.motion).tolist()
    still, receipt = done(moving, context, op="duplicate", target={"text": "vase"})
    assert STATIC_COPY not in receipt.notes and still.motion is moving.motion


@pytest.mark.slow
def test_gaussians_that_a_finish_splits_move_with_their_thing(moving: Scene, context: Context) -> None:
    after, receipt = done(moving, context, op="restyle", target={"text": "chair"}, material="marble")
    assert receipt.added > 0
    own = after.cloud.ids[after.cloud.group == CHAIR].numpy()
    assert after.motion is not None
    assert after.motion.tracks[0].ids.tolist() == sorted(own.tolist())
    assert not np.isin(after.motion.tracks[1].ids, own).any()
