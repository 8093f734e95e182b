"""The time of a session: words are meant as things are then, and undo brings back the very scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene


@pytest.fixture
def session(boxes: Scene, encoder: Any) -> Session:
    """The small scene of boxes, in which the green one rises by half a unit from 1 to 2 s."""
    session = Session(boxes, encoder=encoder, viewer=boxes.cameras[0])
    green = session.select("the green thing").ids.numpy()
    track = Track.along(green, (1.0, 2.0), ((0, 0, 0), (0, 0, 0.5)))
    moving = session.scene.replace(motion=Motion((track,), (), (), 0.0, 4.0))
    return Session(moving, encoder=encoder, viewer=boxes.cameras[0])


def test_the_time_of_a_session_is_one_of_the_scene(session: Session, boxes: Scene, encoder: Any) -> None:
    assert session.time == 0.0
    session.time = 2.5
    assert session.time == 2.5
    with pytest.raises(UserError, match="0 to 4 s"):
        session.time = 7
    with pytest.raises(UserError, match="nothing moves"):
        Session(boxes, encoder=encoder).time = 1


def test_words_about_time_are_edits_and_undo_is_a_reference(session: Session) -> None:
    before = session.scene
    result = session.do("make the green thing blue from 1 to 2 seconds")
    motion = session.scene.motion
    assert motion is not None and [(look.start, look.stop) for look in motion.looks] == [(1.0, 2.0)]
    assert result.receipts[0].passed and session.scene.cloud is before.cloud
    session.do("stop the green thing after 1.5 s")
    stopped = session.scene.motion
    assert stopped is not None and np.isclose(stopped.tracks[0].times[-1], 1.5)
    session.undo()
    session.undo()
    assert session.scene is before


def test_a_replay_says_words_at_the_time_at_which_they_were_said(
    session: Session, boxes: Scene, encoder: Any, tmp_path: Path
) -> None:
    moving, log = session.scene, tmp_path / "log.jsonl"
    told = Session(moving, encoder=encoder, viewer=boxes.cameras[0], log=log)
    told.time = 3
    told.do("put the left red thing on the green thing")
    told.close()
    at_the_start = Session(moving, encoder=encoder, viewer=boxes.cameras[0])
    at_the_start.do("put the left red thing on the green thing")
    assert at_the_start.digest != told.digest  # the green thing is higher at 3 s
    again = Session(moving, encoder=encoder, viewer=boxes.cameras[0])
    (replayed,) = again.replay(log)
    assert again.digest == told.digest and replayed.result is not None and replayed.result.said_at == 3
    assert again.said_at is None
