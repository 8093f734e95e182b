"""A session on a moving scene: edits, undo, save and load keep what moves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import torch

from scenewright.agent.session.session import Session
from scenewright.benchmarks._motion.rooms import moving_room
from scenewright.benchmarks._motion.soft import soft_room
from scenewright.gaussians.errors import ScenewrightError
from scenewright.gaussians.files import load
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene


def test_motion_survives_edits_undo_save_and_load(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    green, right = (boxes.cloud.ids[boxes.cloud.group == group].numpy() for group in (1, 2))
    rising, sliding = Track.slide(green, [0, 2], [0, 1], (0, 0, 1)), Track.slide(right, [0, 2], [0, 1], (0, 1, 0))
    moving = boxes.replace(motion=Motion((rising, sliding), stop=2.0))
    session = Session(moving, encoder=encoder, viewer=boxes.cameras[0])
    session.do("make the green thing blue")
    assert session.scene.motion is moving.motion
    session.do("delete the left red thing")  # the rows of all that moves have other numbers now
    session.do("delete the blue thing")
    assert session.scene.motion is not None and len(session.scene.motion.tracks) == 1
    session.undo()
    assert session.scene.motion is moving.motion
    session.save(tmp_path / "a.ply")
    back = load(tmp_path / "a.ply")
    assert torch.equal(back.cloud.ids, torch.arange(len(back.cloud)))
    assert torch.equal(at(back, 2.0).cloud.means, at(session.scene, 2.0).cloud.means)
    assert torch.equal(back.cloud.means, session.scene.cloud.means)
    assert not torch.equal(at(back, 2.0).cloud.means, back.cloud.means)


def test_a_wish_for_what_stands_still_is_none_about_its_motion(boxes: Scene, encoder: Any) -> None:
    """ "Leave it out between 1 and 2 s" stops what moves, and hides what does not."""
    green = boxes.cloud.ids[boxes.cloud.group == 1].numpy()
    moving = boxes.replace(motion=Motion((Track.slide(green, [0, 3], [0, 1], (0, 0, 1)),), stop=3.0))
    session = Session(moving, encoder=encoder, viewer=boxes.cameras[0])
    assert (
        session.moves(Query(colors=("green",))) is True and session.moves(Query(colors=("red",), pick="all")) is False
    )
    assert Session(boxes, encoder=encoder).moves(Query(colors=("green",))) is None
    wish = "I'd rather nobody saw the left red thing until the green thing has stopped"
    (op,) = session.plan(wish).ops
    assert op.op == "opacity"


def test_a_plan_that_fails_in_its_scene_is_tried_as_its_kind_of_wish() -> None:
    """Rules read "the coat rack with it" as one thing made of two."""
    session = Session(moving_room("door", 0.1))
    session.do("Take the bench away, and the coat rack with it. I like bare walls.")
    for name in ("bench", "coat rack"):
        assert not session.select(name).chosen
    scene = session.scene
    with pytest.raises(ScenewrightError, match="piano"):
        session.do("take the piano away, and the doormat with it")  # neither way; the first error is told
    assert session.scene is scene


def test_a_session_tells_how_something_would_move() -> None:
    session = Session(moving_room("ball", 0.1))
    before = session.scene
    (stopped,) = session.plan("stop the ball at 2 s").ops
    (reversing,) = session.plan("let the ball roll back once it is at the wall").ops
    ball = Query(text="ball")
    now = session.movement(ball)
    assert now is not None and [pytest.approx(end, abs=0.02) for end in now.spells[0]] == [0.5, 3.5]
    after = session.after([stopped], ball)
    assert after is not None and after.spells[-1][1] == pytest.approx(2.0, abs=0.02)
    there_and_back = session.after([reversing], ball)
    assert there_and_back is not None and len(there_and_back.spells) == 2  # where it turns back, another spell begins
    assert session.after([session.plan("paint the sofa red").ops[0]], ball) is None  # that is no change of a motion
    assert session.after([stopped.model_copy(update={"when": None})], ball) == (0.0, 0.0, False, 5.0, 0.0, 0.0, (), ())
    assert session.scene is before


def test_what_changes_its_shape_is_asked_of_and_told_when_to() -> None:
    session = Session(soft_room("towel", 0.1), accept_unconfirmed=True)
    assert session.ask("what moves?").answer == "towel"
    assert session.ask("when does the towel start to wave?").answer == pytest.approx(0.5, abs=0.05)
    assert session.ask("when does the towel stop flapping?").answer == pytest.approx(4.5, abs=0.05)
    assert session.ask("does the bench move?").answer == "no"
    session.do("let the towel wave twice as fast")
    assert session.ask("how long does the towel wave?").answer == pytest.approx(2.0, abs=0.05)
    session.undo()
    assert session.ask("how long does the towel wave?").answer == pytest.approx(4.0, abs=0.05)
