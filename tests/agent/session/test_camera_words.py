"""Words that move the camera, and words that only sound like it."""

from __future__ import annotations

import pytest

from scenewright.agent.session.camera_words import LITTLE, STEP, TURN, CameraMove, read_moves


@pytest.mark.parametrize(
    ("said", "move"),
    [
        ("look from the left", CameraMove("side", side="left")),
        ("Please look from the right side.", CameraMove("side", side="right")),
        ("from above", CameraMove("side", side="above")),
        ("show me the room from behind", CameraMove("side", side="behind")),
        ("top view", CameraMove("side", side="above")),
        ("bird's eye view", CameraMove("side", side="above")),
        ("orbit", CameraMove("orbit", azimuth=STEP)),
        ("orbit left", CameraMove("orbit", azimuth=-STEP)),
        ("orbit 90 degrees to the left", CameraMove("orbit", azimuth=-90.0)),
        ("walk around the table", CameraMove("orbit", azimuth=STEP, words="the table")),
        ("a bit closer", CameraMove("nearer", share=LITTLE, bare=True)),
        ("zoom out a bit", CameraMove("nearer", share=1 / LITTLE)),
        ("turn the camera to the left", CameraMove("turn", azimuth=TURN)),
        ("look down", CameraMove("turn", upward=-TURN)),
        ("look at the chair", CameraMove("thing", words="the chair")),
        ("look from the left at the chair", CameraMove("thing", words="the chair from the left")),
        ("show me the red chair from behind", CameraMove("thing", words="the red chair from behind")),
        ("back to the first view", CameraMove("home")),
    ],
)
def test_words_that_move_the_camera(said: str, move: CameraMove) -> None:
    assert read_moves(said) == (move,)


def test_moves_follow_each_other() -> None:
    moves = read_moves("look from the left, then closer and a bit higher please")
    assert moves is None  # "a bit higher" alone may be about a thing
    moves = read_moves("look from the left, then closer and go a bit higher please")
    assert moves is not None and [m.kind for m in moves] == ["side", "nearer", "orbit"]
    assert read_moves("look from the left and delete the chair") is None


@pytest.mark.parametrize(
    "said",
    ["delete the chair", "move the chair closer to the table", "the left one", "left", "turn the chair around", "back",
     "move it back", "show the chair", "put the lamp on the right", "move the box from the left to the right", "look",
     "rotate the chair 90 degrees", "higher", "move up", "what is left of the chair?", "closer " * 200, ""],
)  # fmt: skip
def test_words_that_do_not(said: str) -> None:
    assert read_moves(said) is None
