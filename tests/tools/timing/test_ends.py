"""What begins at the end of a scene with motion, or later, and what leaves no time for a movement."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.courses import course_of
from scenewright.gaussians.motion.events import movements
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.judging.changes import changes_between
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse
from scenewright.tools.timing.retiming import Warp
from scenewright.tools.timing.through_time import carry_through_time

TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)
A_CHAIR, A_VASE = {"groups": [CHAIR]}, {"groups": [VASE]}
Json = dict[str, Any]


@pytest.fixture
def rolling(corner: Scene) -> Scene:
    """The corner, in which the chair slides half a unit along x from 1 to 3 s; 0 to 3 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.along(ids, (1.0, 3.0), ((0, 0, 0), (0.5, 0, 0)), smooth=False)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 3.0))


@pytest.fixture
def opening(corner: Scene) -> Scene:
    """The corner, in which the chair slides away from 1 to 2 s, as a drawer does; 0 to 4 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.slide(ids, (1.0, 2.0), (0.0, 0.4), (1.0, 0.0, 0.0), smooth=False)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))


def done(scene: Scene, data: Json, context: Context) -> Done:
    return carry_through_time(scene, parse(data), context, None, partial(carry_out, seen=False))


def last(scene: Scene) -> float:
    assert scene.motion is not None
    return scene.motion.stop


def differs(before: Scene, after: Scene, time: float) -> list[int]:
    """The groups in which a Gaussian differs at a time."""
    was, now = at(before, time).cloud, at(after, time).cloud
    return sorted(was.group[changes_between(was, now).any].unique().tolist())


def test_a_warp_leaves_time_for_each_movement() -> None:
    for new in ((1.0, 1.0), (2.0, 1.0), (0.0, np.inf)):
        with pytest.raises(InstructionError, match="no time is left"):
            Warp(new, (0.0, 1.0))


def test_what_moves_to_the_end_of_the_scene_moves_later(rolling: Scene, context: Context) -> None:
    """Its movement lasts to the end of the scene, which is an end in seconds all the same."""
    data = {"op": "pace", "target": A_CHAIR, "change": "later", "seconds": 2, "when": {"during": {"state": "closing"}}}
    made = done(rolling, data, context).scene
    assert np.allclose(movements(course_of(made, CHAIR)), [(3.0, 5.0)], atol=0.06) and last(made) == pytest.approx(5)


def test_what_closes_later_and_only_opens_is_shut_so_long_after_it_has_opened(
    rolling: Scene, context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenewright.tools.ops.articulate import Articulate

    monkeypatch.setattr(Articulate, "begins_shut", lambda *_: True)
    assert rolling.motion is not None
    ids = rolling.motion.tracks[0].ids
    track = Track.slide(ids, (1.0, 3.0), (0.0, 0.5), (1.0, 0.0, 0.0))
    scene = rolling.replace(motion=rolling.motion.replace(tracks=(track,)))
    data = {"op": "pace", "target": A_CHAIR, "change": "later", "seconds": 2, "when": {"during": {"state": "closing"}}}
    made = done(scene, data, context).scene
    assert np.allclose(movements(course_of(made, CHAIR)), [(1.0, 3.0), (5.0, 7.0)], atol=0.06)


@pytest.mark.parametrize(
    ("data", "end"),
    [
        ({"op": "sway", "how": "hop"}, 6.6),
        ({"op": "spin", "turns": 1, "turns_per_second": 1}, 7.0),
        ({"op": "move", "direction": "up", "distance": {"value": 30, "unit": "cm"}}, 6.5),
        ({"op": "rotate", "degrees": 120}, 7.0),
    ],
)
def test_what_moves_later_than_the_scene_ends_makes_it_longer(
    rolling: Scene, context: Context, data: Json, end: float
) -> None:
    made = done(rolling, {**data, "target": A_VASE, "when": {"start": 6}}, context)
    assert last(made.scene) == pytest.approx(end) and f"the scene lasts {end:g} s now" in made.receipt.notes
    assert not differs(rolling, made.scene, 5.9) and VASE in differs(rolling, made.scene, 6.4)


def test_what_opens_closes_later_than_the_scene_ends(opening: Scene, context: Context) -> None:
    made = done(opening, {"op": "articulate", "target": A_CHAIR, "change": "close", "when": {"start": 6}}, context)
    assert np.allclose(movements(course_of(made.scene, CHAIR)), [(1.0, 2.0), (6.0, 7.0)], atol=0.06)
    assert "the scene lasts 7 s now" in made.receipt.notes


def test_a_look_is_not_put_behind_the_end(rolling: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="say an earlier time"):
        done(rolling, {"op": "recolor", "target": A_VASE, "color": "red", "when": {"start": 6}}, context)


def test_what_stops_as_the_scene_ends_has_stopped(rolling: Scene, context: Context) -> None:
    """A look that begins then is seen for a second, and a movement takes as long as it does."""
    stops = {"during": {"state": "moving", "of": A_CHAIR, "part": "after"}}
    red = done(rolling, {"op": "recolor", "target": A_VASE, "color": "red", "when": stops}, context)
    assert not differs(rolling, red.scene, 2.99) and differs(rolling, red.scene, 3.5) == [VASE]
    assert last(red.scene) == pytest.approx(4) and "the scene lasts 4 s now" in red.receipt.notes
    hop = done(rolling, {"op": "sway", "target": A_VASE, "how": "hop", "when": stops}, context).scene
    assert last(hop) == pytest.approx(3.6)
    until = {"during": {"state": "moving", "of": A_CHAIR, "part": "until_end"}}
    green = done(rolling, {"op": "recolor", "target": A_VASE, "color": "green", "when": until}, context).scene
    assert differs(rolling, green, 2.9) == [VASE] and last(green) == 3


def test_what_turns_without_an_end_does_not_stop(rolling: Scene, context: Context) -> None:
    assert rolling.motion is not None
    track = Track.spin(rolling.motion.tracks[0].ids, 1.0, (0, 0, 1), (0, 0, 0))
    scene = rolling.replace(motion=rolling.motion.replace(tracks=(track,)))
    stops = {"during": {"state": "moving", "of": A_CHAIR, "part": "after"}}
    with pytest.raises(InstructionError, match="does not end"):
        done(scene, {"op": "recolor", "target": A_VASE, "color": "red", "when": stops}, context)


def test_what_is_shut_is_not_closed(opening: Scene, context: Context) -> None:
    """Its own opening, which comes later, would be lost."""
    for when in ({"start": 0.2, "stop": 0.5}, {"start": 0.2}):
        with pytest.raises(InstructionError, match=r"is shut at 0\.2 s"):
            done(opening, {"op": "articulate", "target": A_CHAIR, "change": "close", "when": when}, context)


def test_what_is_open_is_not_opened(opening: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match=r"is open already at 3 s"):
        done(opening, {"op": "articulate", "target": A_CHAIR, "when": {"start": 3, "stop": 3.5}}, context)
    half = {"op": "articulate", "target": A_CHAIR, "share": 0.5, "when": {"start": 3, "stop": 3.5}}
    made = done(opening, half, context).scene
    assert float(course_of(made, CHAIR).centers(np.array([3.5]))[0, 0]) == pytest.approx(
        float(course_of(opening, CHAIR).centers(np.array([1.5]))[0, 0]), abs=1e-6
    )


def test_what_closes_within_a_time_does_so_when_it_has_opened(opening: Scene, context: Context) -> None:
    data = {"op": "articulate", "target": A_CHAIR, "change": "close", "when": {"lasting": 0.5}}
    made = done(opening, data, context).scene
    assert np.allclose(movements(course_of(made, CHAIR)), [(1.0, 2.5)], atol=0.06)
    assert float(course_of(made, CHAIR).boxes(np.array([0.0, 3.0])).centers[:, 0] @ [1, -1]) == pytest.approx(
        0, abs=1e-6
    )


@pytest.mark.parametrize(
    ("fields", "red", "end"),
    [
        ({"change": "speed", "factor": 2.0}, [(0.5, 1.0)], 1.5),
        ({"change": "reverse"}, [(1.0, 2.0)], 3.0),
        ({"change": "later", "seconds": 1.0}, [(2.0, 3.0)], 4.0),
        ({"change": "repeat", "times": 2}, [(1.0, 2.0), (4.0, 5.0)], 6.0),
        ({"change": "stop", "when": {"start": 1.5, "stop": 2.5}}, [(1.0, 3.0)], 4.0),
        ({"change": "stop", "when": {"start": 0.5}}, [(1.0, 2.0)], 3.0),
    ],
)
@pytest.mark.parametrize("moves", [True, False])
def test_looks_follow_the_whole_film(
    rolling: Scene, context: Context, fields: Json, red: list[tuple[float, float]], end: float, moves: bool
) -> None:
    """Also where nothing else changes with time."""
    when = {"start": 1.0, "stop": 2.0}
    scene = done(rolling, {"op": "recolor", "target": A_VASE, "color": "red", "when": when}, context).scene
    assert scene.motion is not None
    if not moves:
        scene = scene.replace(motion=scene.motion.replace(tracks=()))
    data = {"op": "pace", "target": {"text": "everything"}, **fields}
    made = done(scene, data, replace(context, resolver=None)).scene
    plain = made.replace(motion=made.motion.replace(looks=())) if made.motion is not None else made
    assert last(made) == pytest.approx(end, abs=0.01)
    for time in np.arange(0.05, end, 0.1):
        assert (differs(plain, made, float(time)) == [VASE]) == any(a < time < b for a, b in red), time
