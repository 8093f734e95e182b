"""Edits in scenes with time: they hold when they are said to, nothing else changes, and undo is a reference."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.errors import InstructionError, UserError
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.courses import course_of
from scenewright.gaussians.motion.events import movements
from scenewright.gaussians.motion.motion import Motion, Residual, Track, moving_ids
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.judging.changes import changes_between
from scenewright.tools.operation import Context
from scenewright.tools.registry import OPS, parse
from scenewright.tools.timing.circling import Circling
from scenewright.tools.timing.retiming import Warp, angles_at
from scenewright.tools.timing.through_time import carry_through_time

TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)
A_CHAIR = {"groups": [CHAIR]}
Json = dict[str, Any]


@pytest.fixture
def moving(corner: Scene) -> Scene:
    """The corner, in which the chair slides half a unit along x from 1 to 3 s; 0 to 4 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.along(ids, (1.0, 3.0), ((0, 0, 0), (0.5, 0, 0)), smooth=False)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))


def done(scene: Scene, data: Json, context: Context) -> Done:
    return carry_through_time(scene, parse(data), context, None, partial(carry_out, seen=False))


def middle(scene: Scene, time: float, group: int = CHAIR) -> np.ndarray:
    cloud = at(scene, time).cloud
    return cloud.means[cloud.group == group].double().mean(dim=0).numpy()


def differs(before: Scene, after: Scene, time: float) -> torch.Tensor:
    """The groups in which a Gaussian differs at a time."""
    was, now = at(before, time).cloud, at(after, time).cloud
    return was.group[changes_between(was, now).any].unique()


def test_a_look_holds_in_its_time_and_nothing_else_changes(moving: Scene, context: Context) -> None:
    data = {"op": "recolor", "target": A_CHAIR, "color": "red", "when": {"start": 1.5, "stop": 2.5}}
    made = done(moving, data, context)
    assert made.scene.cloud is moving.cloud and made.receipt.op["when"] == {"start": 1.5, "stop": 2.5}
    assert differs(moving, made.scene, 2.0).tolist() == [CHAIR]
    for time in (0.0, 1.49, 2.5, 4.0):
        assert not len(differs(moving, made.scene, time))
    told = {c.name: c for c in made.receipt.checks}
    assert told["as before at other times"].value == 0 and told["changed in time"].value > 0


def test_what_fades_out_before_the_end_stays_so(moving: Scene, context: Context) -> None:
    faded = {"start": 1.0, "stop": 2.5, "gradual": True}
    made = done(moving, {"op": "opacity", "target": {"groups": [VASE]}, "value": 0.0, "when": faded}, context)
    seen = [int((at(made.scene, t).cloud.group == VASE).sum()) for t in (0.5, 3.5)]
    assert seen[0] > 0 == seen[1]
    half = at(made.scene, 1.75).cloud
    assert float(half.opacities[half.group == VASE].max()) < float(
        moving.cloud.opacities[moving.cloud.group == VASE].max()
    )
    told = {c.name: c for c in made.receipt.checks}
    assert told["as before at other times"].value == 0 and told["changed in time"].value > 0


def test_what_is_deleted_for_a_while_comes_back(moving: Scene, context: Context) -> None:
    data = {"op": "delete", "target": {"groups": [VASE]}, "infill": False, "when": {"start": 1, "lasting": 1}}
    made = done(moving, data, context)
    assert len(made.scene.cloud) == len(moving.cloud)
    there = [int((at(made.scene, t).cloud.group == VASE).sum()) for t in (0.5, 1.5, 2.5)]
    assert there[0] == there[2] > 0 == there[1]


def test_a_way_starts_where_it_is_then_and_goes_on_with_what_was_there(moving: Scene, context: Context) -> None:
    far = {"value": 30, "unit": "cm"}
    data = {"op": "move", "target": A_CHAIR, "direction": "up", "distance": far, "when": {"start": 2, "stop": 3}}
    made = done(moving, data, context)
    for time in (0.0, 1.5, 2.0):
        assert np.allclose(middle(made.scene, time), middle(moving, time), atol=1e-6)
    for time in (3.0, 4.0):  # the way of the chair and the new one add up
        assert np.allclose(middle(made.scene, time) - middle(moving, time), [0, 0, 0.3], atol=1e-5)


def test_a_size_cannot_change_for_a_while(moving: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="size"):
        done(moving, {"op": "scale", "target": A_CHAIR, "factor": 2, "when": {"start": 1}}, context)


@pytest.mark.slow
def test_an_edit_without_a_time_holds_at_all_times_and_is_placed_at_the_time_it_is_said(
    moving: Scene, context: Context
) -> None:
    far = {"value": 20, "unit": "cm"}
    data = {"op": "move", "target": A_CHAIR, "direction": "up", "distance": far}
    for said in (None, 2.0):
        made = done(moving, data, replace(context, time=said))
        for time in (0.0, 2.0, 4.0):
            assert np.allclose(middle(made.scene, time) - middle(moving, time), [0, 0, 0.2], atol=1e-5)
    turned = done(moving, {"op": "rotate", "target": A_CHAIR, "degrees": 90}, replace(context, time=3.0))
    off = middle(turned.scene, 3.0) - middle(moving, 3.0)  # it turns about its box, not the mean of its Gaussians
    assert np.linalg.norm(off) < 0.15  # about its place at the start it would be 0.7 away
    assert not len(differs(moving, turned.scene, 3.0)[differs(moving, turned.scene, 3.0) != CHAIR])


CLEAN: list[Json] = [
    {"op": "pace", "target": A_CHAIR, "change": "stop", "when": {"start": 2}},
    {"op": "spin", "target": A_CHAIR, "turns_per_second": 1},
    {"op": "articulate", "target": {"groups": [TABLE]}, "degrees": 30, "when": {"start": 0, "stop": 1}},
    {"op": "order", "target": {"groups": [CHAIR, VASE], "pick": "all"}, "order": "reversed"},
    {"op": "sway", "target": {"groups": [VASE]}, "how": "hop", "times": 2, "when": {"start": 1}},
    {"op": "tip", "target": {"groups": [VASE]}, "when": {"start": 1}},
    {"op": "orbit", "target": {"groups": [VASE]}, "around": {"groups": [TABLE]}, "when": {"start": 1, "stop": 3}},
    {"op": "follow", "target": {"groups": [VASE]}, "leader": {"groups": [CHAIR]}},
]


def test_every_operation_that_makes_motion_is_tried_here() -> None:
    assert {data["op"] for data in CLEAN} == {name for name, op in OPS.items() if op.makes_motion}


@pytest.mark.parametrize(
    ("more", "places"),
    [
        ({"change": "stop", "when": {"start": 2}}, {1.0: 0.0, 2.0: 0.25, 3.0: 0.25, 4.0: 0.25}),
        ({"change": "stop", "when": {"start": 1.5, "stop": 2.0}}, {2.0: 0.125, 3.0: 0.375, 3.5: 0.5}),
        ({"change": "stop"}, {2.0: 0.0, 4.0: 0.0}),
        ({"change": "stop", "when": {"stop": 0.5}}, {1.0: 0.0, 2.0: 0.25, 3.0: 0.5}),  # as it is
        ({"change": "stop", "when": {"stop": 1.5}}, {1.5: 0.0, 2.5: 0.25, 3.5: 0.5}),
        ({"change": "begin", "when": {"start": 0}}, {1.0: 0.25, 2.0: 0.5}),
        ({"change": "begin", "when": {"start": 2, "lasting": 1}}, {2.0: 0.0, 2.5: 0.25, 3.0: 0.5}),
        ({"change": "speed", "factor": 2}, {1.0: 0.0, 1.5: 0.25, 2.0: 0.5, 4.0: 0.5}),
        ({"change": "later", "seconds": 0.5}, {1.5: 0.0, 2.5: 0.25, 3.5: 0.5}),
        ({"change": "reverse"}, {0.0: 0.5, 1.0: 0.5, 2.0: 0.25, 3.0: 0.0}),
        ({"change": "return"}, {3.0: 0.5, 4.001: 0.25, 5.001: 0.0}),
        ({"change": "part", "share": 0.5}, {1.0: 0.0, 2.0: 0.25, 3.0: 0.25}),
        ({"change": "part", "distance": {"value": 10, "unit": "cm"}}, {2.0: 0.1, 4.0: 0.1}),
        ({"change": "repeat", "times": 1, "when": {"start": 4}}, {3.0: 0.5, 4.002: 0.0, 5.001: 0.25, 6.001: 0.5}),
        ({"change": "repeat", "times": 2}, {2.0: 0.25, 2.99: 0.4975, 4.001: 0.25, 5.0: 0.5}),
        ({"change": "back_and_forth", "times": 1}, {2.0: 0.25, 3.0: 0.5, 4.0: 0.25, 5.0: 0.0}),
    ],
)
def test_motion_is_played_at_other_times(
    moving: Scene, context: Context, more: Json, places: dict[float, float]
) -> None:
    made = done(moving, {"op": "pace", "target": A_CHAIR, **more}, context)
    start = middle(moving, 0.0)[0]
    for time, place in places.items():
        assert middle(made.scene, time)[0] - start == pytest.approx(place, abs=2e-3)


def of_two(moving: Scene) -> Scene:
    """The chair slides from 1 to 3 s, and the vase, as far, from 2 to 3 s."""
    assert moving.motion is not None
    ids = moving.cloud.ids[moving.cloud.group == VASE].numpy()
    also = Track.along(ids, (2.0, 3.0), ((0, 0, 0), (0.5, 0, 0)), smooth=False)
    return moving.replace(motion=moving.motion.replace(tracks=(*moving.motion.tracks, also)))


@pytest.mark.parametrize(
    ("more", "begins"),
    [
        ({"order": "reversed"}, (2.0, 1.0)),
        ({"order": "listed", "first": [{"groups": [VASE]}]}, (2.0, 1.0)),
        ({"order": "listed", "last": A_CHAIR}, (2.0, 1.0)),
        ({"order": "listed", "last": {"groups": [VASE]}}, (1.0, 2.0)),
        ({"order": "together"}, (1.0, 1.0)),
        ({"order": "together", "when": {"start": 0.5}}, (0.5, 0.5)),
        ({"order": "kept", "gap": 0.5}, (1.0, 1.5)),
    ],
)
def test_several_things_begin_in_another_order(
    moving: Scene, context: Context, more: Json, begins: tuple[float, float]
) -> None:
    scene = of_two(moving)
    made = done(scene, {"op": "order", "target": {"groups": [CHAIR, VASE], "pick": "all"}, **more}, context).scene
    for group, begin, taken in zip((CHAIR, VASE), begins, (2.0, 1.0), strict=True):
        for share in (0.0, 0.5, 1.0):
            way = middle(made, begin + share * taken, group) - middle(scene, 0.0, group)
            assert way[0] == pytest.approx(0.5 * share, abs=2e-3)


def test_an_order_needs_several_things_that_move(moving: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="several things that move"):
        done(moving, {"op": "order", "target": {"groups": [CHAIR, VASE], "pick": "all"}}, context)


def test_an_order_is_listed_by_what_is_first_or_last_alone() -> None:
    for wrong in ({"order": "listed"}, {"order": "reversed", "last": A_CHAIR}):
        with pytest.raises(UserError, match=r"first|last"):
            parse({"op": "order", "target": A_CHAIR, **wrong})


@pytest.mark.parametrize(
    ("gone", "begins"),
    [
        ({}, 2.0),
        ({"share": 0.25}, 1.5),
        ({"distance": {"value": 40, "unit": "cm"}}, 2.6),
    ],
)
def test_a_rest_begins_where_a_thing_has_gone_so_far(
    moving: Scene, context: Context, gone: Json, begins: float
) -> None:
    """The chair goes half a unit in two seconds: it rests for half a second where it then is, and goes on."""
    when = {"during": {"state": "halfway", "part": "from", **gone}, "lasting": 0.5}
    made = done(moving, {"op": "pace", "target": A_CHAIR, "change": "stop", "when": when}, context).scene
    assert np.allclose(middle(made, begins + 0.02), middle(made, begins + 0.48), atol=1e-4)
    assert middle(made, begins + 0.1)[0] == pytest.approx(middle(moving, begins)[0], abs=0.01)
    assert np.allclose(middle(made, 3.5), middle(moving, 3.0), atol=1e-4)


def test_what_opens_rests_at_an_angle(corner: Scene, context: Context) -> None:
    ids = corner.cloud.ids[corner.cloud.group == TABLE].numpy()
    swings = Track.hinge(ids, [1, 3], [0, math.radians(80)], (0, 0, 1), tuple(middle(corner, 0.0, TABLE)), smooth=False)
    scene = corner.replace(motion=Motion((swings,), (), (), 0.0, 4.0))
    when = {"during": {"state": "halfway", "part": "from", "degrees": 20}}
    made = done(scene, {"op": "pace", "target": {"groups": [TABLE]}, "change": "stop", "when": when}, context).scene
    assert made.motion is not None
    assert math.degrees(float(angles_at(made.motion.tracks[0], np.array([4.0]))[0])) == pytest.approx(20, abs=0.5)
    when["during"]["degrees"] = 100  # further than it opens
    with pytest.raises(InstructionError):
        done(scene, {"op": "pace", "target": {"groups": [TABLE]}, "change": "stop", "when": when}, context)


def test_an_amount_is_of_what_has_gone_so_far_alone() -> None:
    for during in ({"state": "moving", "degrees": 20}, {"state": "halfway", "degrees": 20, "share": 0.5}):
        with pytest.raises(UserError, match=r"halfway|amount|share"):
            parse({"op": "pace", "target": A_CHAIR, "change": "stop", "when": {"during": during}})


@pytest.mark.parametrize("degrees", [45, 90, 180, 270])
def test_what_turns_on_its_way_turns_by_another_angle(corner: Scene, context: Context, degrees: float) -> None:
    """0.4 along x, a quarter turn to the left, 0.3 on: the way behind the turn is as long, in the new direction."""
    scene, here = turning(corner)
    data = {"op": "pace", "target": {"groups": [VASE]}, "change": "turn", "degrees": degrees}
    made = done(scene, data, context).scene
    angle = math.radians(degrees)
    for time in (0.5, 1.0):
        assert np.allclose(middle(made, time, VASE), middle(scene, time, VASE), atol=1e-4)
    ends = here + np.array([0.4 + 0.3 * math.cos(angle), 0.3 * math.sin(angle), 0])
    assert np.allclose(middle(made, 3.0, VASE), ends, atol=2e-3)
    course = course_of(made, VASE)
    turned = np.trapezoid(course.turns(course.grid()) @ [0, 0, 1], course.grid())
    assert math.degrees(turned) == pytest.approx(degrees, abs=2)


def test_what_goes_straight_on_or_only_turns_takes_no_turn(moving: Scene, corner: Scene, context: Context) -> None:
    for scene, group in ((moving, CHAIR), (spinning(corner), VASE)):
        with pytest.raises(InstructionError, match="takes no turn"):
            done(scene, {"op": "pace", "target": {"groups": [group]}, "change": "turn", "degrees": 45}, context)


def spinning(corner: Scene) -> Scene:
    ids = corner.cloud.ids[corner.cloud.group == VASE].numpy()
    track = Track.hinge(ids, [0, 2], [0, math.pi], (0, 0, 1), tuple(middle(corner, 0.0, VASE)))
    return corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))


def turning(corner: Scene) -> tuple[Scene, np.ndarray]:
    """The vase goes 0.4 along x, turns left on the spot, and goes 0.3 on; and its place at the start."""
    ids = corner.cloud.ids[corner.cloud.group == VASE].numpy()
    turns = [np.eye(3), np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [[0, -1, 0], [1, 0, 0], [0, 0, 1]]]
    here = middle(corner, 0.0, VASE)
    places = np.array([[0, 0, 0], [0.4, 0, 0], [0.4, 0, 0], [0.4, 0.3, 0]])
    shifts = [here + p - np.array(r) @ here for p, r in zip(places, turns, strict=True)]
    track = Track.poses_at(ids, (0.0, 1.0, 1.5, 2.5), turns, shifts, here)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 3.0)), here


def test_what_turns_left_on_its_way_turns_right(corner: Scene, context: Context) -> None:
    scene, here = turning(corner)
    made = done(scene, {"op": "pace", "target": {"groups": [VASE]}, "change": "mirror"}, context).scene
    for time in (0.5, 1.2, 2.0, 3.0):
        was, now = (middle(s, time, VASE) - here for s in (scene, made))
        assert np.allclose(now, was * [1, -1, 1], atol=1e-4)
    straight = of_two(corner.replace(motion=Motion((), (), (), 0.0, 4.0)))
    with pytest.raises(InstructionError, match="straight"):
        done(straight, {"op": "pace", "target": {"groups": [VASE]}, "change": "mirror"}, context)


def test_what_is_sent_elsewhere_does_not_go_where_it_would_have_gone(moving: Scene, context: Context) -> None:
    beside = {"relation": "next_to", "anchors": [{"groups": [ARMCHAIR]}]}
    data = {"op": "move", "target": A_CHAIR, "place": beside, "when": {"start": 2}}
    made = done(moving, data, context).scene
    assert np.allclose(middle(made, 1.9), middle(moving, 1.9), atol=1e-6)
    assert made.motion is not None
    last = middle(made, made.motion.stop)
    assert np.allclose(middle(made, made.motion.stop + 2), last)
    assert np.linalg.norm(last - middle(made, 0.0, ARMCHAIR)) < 1.5


def test_a_look_that_blinks_comes_and_goes(moving: Scene, context: Context) -> None:
    data = {"op": "opacity", "target": {"groups": [VASE]}, "value": 0.0, "when": {"start": 1, "stop": 3, "every": 1}}
    made = done(moving, data, context)
    there = [int((at(made.scene, t).cloud.group == VASE).sum()) > 0 for t in (0.5, 1.2, 1.7, 2.2, 2.7, 3.5)]
    assert there == [True, False, True, False, True, True]


def test_what_follows_goes_the_way_of_the_other(moving: Scene, context: Context) -> None:
    along = {"op": "follow", "target": {"groups": [VASE]}, "leader": A_CHAIR, "how": "along"}
    made = done(moving, along, context).scene
    for time in (0.5, 2.0, 3.5):
        ways = [middle(made, time, g) - middle(moving, 0.0, g) for g in (VASE, CHAIR)]
        assert np.allclose(ways[0], ways[1], atol=2e-3)
    behind = done(moving, {**along, "how": "behind"}, context).scene
    apart = [float(np.linalg.norm((middle(behind, t, VASE) - middle(behind, t, CHAIR))[:2])) for t in (0.0, 2.0, 4.0)]
    assert apart == sorted(apart, reverse=True) and apart[-1] < 0.75 * apart[0]  # it catches up, and is close behind
    here, there = middle(behind, 0.0, VASE), middle(behind, 4.0, VASE)
    assert (there - here) @ (middle(moving, 0.0, CHAIR) - here) > 0  # by way of where the other set out
    with pytest.raises(InstructionError, match="does not move"):
        done(moving, {**along, "leader": {"groups": [TABLE]}}, context)


def test_what_goes_round_another_thing_keeps_its_distance(
    moving: Scene, context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where nothing is in its way."""
    monkeypatch.setattr(Circling, "best", lambda self: (self.radius, ()))
    data = {"op": "orbit", "target": {"groups": [VASE]}, "around": {"groups": [ARMCHAIR]}, "turns": 1,
            "when": {"start": 1, "stop": 3}}  # fmt: skip
    made = done(moving, data, context).scene
    assert np.allclose(middle(made, 3.0, VASE), middle(moving, 0.0, VASE), atol=1e-4)
    opposite = middle(made, 2.0, VASE) - middle(moving, 0.0, VASE)
    assert np.linalg.norm(opposite[:2]) > 0.2 and abs(opposite[2]) < 1e-4


@pytest.mark.parametrize("how", ["hop", "bob", "shake", "swing", "wobble"])
def test_what_sways_ends_where_it_was(moving: Scene, context: Context, how: str) -> None:
    data = {"op": "sway", "target": {"groups": [VASE]}, "how": how, "when": {"start": 1, "stop": 2}}
    made = done(moving, data, context).scene
    places = [middle(made, t, VASE) for t in np.linspace(0.9, 2.1, 25)]
    assert np.allclose(places[0], places[-1], atol=1e-5)
    assert max(np.linalg.norm(p - places[0]) for p in places) > 2e-3


def test_what_tips_over_lies_on_the_level_on_which_it_stood(moving: Scene, context: Context) -> None:
    data = {"op": "tip", "target": {"groups": [VASE]}, "direction": "left", "when": {"start": 1, "stop": 2}}
    made = done(moving, data, context).scene
    rows = moving.cloud.group == VASE
    was, now = (at(s, 3.0).cloud.means[rows] for s in (moving, made))
    assert float(now[:, 2].min()) == pytest.approx(float(was[:, 2].min()), abs=0.03)
    assert float(now[:, 2].max()) < float(was[:, 2].max())
    assert float(now[:, 0].mean()) < float(was[:, 0].mean())


def test_one_thing_is_played_backwards_in_its_own_time(moving: Scene, context: Context) -> None:
    longer = moving.replace(motion=replace(moving.motion, stop=6.0))
    made = done(longer, {"op": "pace", "target": A_CHAIR, "change": "reverse"}, context)
    for time in (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0):  # it moves from 1 to 3 s
        assert np.allclose(middle(made.scene, time), middle(longer, 4.0 - time), atol=2e-3)


def test_what_goes_there_and_back_is_played_backwards_in_the_time_of_the_scene(moving: Scene, context: Context) -> None:
    there = {"op": "pace", "target": A_CHAIR, "change": "back_and_forth", "times": 1}
    even = done(moving.replace(motion=replace(moving.motion, stop=6.0)), there, context).scene  # from 1 to 5 s
    late = done(even, {"op": "pace", "target": A_CHAIR, "change": "later", "seconds": 0.5}, context).scene
    made = done(late, {"op": "pace", "target": A_CHAIR, "change": "reverse"}, context).scene
    assert made.motion is not None and made.motion.stop == 6.0
    for time in (0.0, 1.0, 2.0, 3.0, 4.0, 6.0):
        assert np.allclose(middle(made, time), middle(late, 6.0 - time), atol=2e-3)


def test_the_whole_scene_at_half_speed_lasts_twice_as_long(moving: Scene, context: Context) -> None:
    everything = {"text": "everything", "pick": "all"}
    made = done(
        moving, {"op": "pace", "target": everything, "change": "speed", "factor": 0.5}, replace(context, resolver=None)
    )
    assert made.scene.motion is not None and made.scene.motion.stop == 8.0
    assert np.allclose(middle(made.scene, 4.0), middle(moving, 2.0), atol=1e-6)


def test_what_turns_while_it_goes_somewhere_keeps_its_path(moving: Scene, context: Context) -> None:
    made = done(moving, {"op": "spin", "target": A_CHAIR, "turns_per_second": 1}, context).scene
    assert made.motion is not None and moving.motion is not None
    assert [t.kind for t in made.motion.tracks] == ["spin", *(t.kind for t in moving.motion.tracks)]
    for t in (0.5, 1.3, 2.6):
        # The mean of its Gaussians circles the middle of its box, at up to 7 cm; the path is metres long.
        assert np.linalg.norm(middle(made, t) - middle(moving, t)) < 0.15


def test_another_rate_for_a_while_leaves_what_was_before(corner: Scene, context: Context) -> None:
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    always = Track.spin(ids, 1.0, (0, 0, 1), middle(corner, 0.0))
    scene = corner.replace(motion=Motion((always,), (), (), 0.0, 6.0))
    fast = {"op": "spin", "target": A_CHAIR, "turns_per_second": 3, "when": {"start": 2, "stop": 4}}
    made = done(scene, fast, context).scene.motion
    assert made is not None
    turned = angles_at(made.tracks[0], np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])) / (2 * math.pi)
    np.testing.assert_allclose(turned, [1, 2, 5, 8, 9, 10], atol=1e-6)


def test_what_is_moved_while_it_is_painted_is_not_painted_for_good(corner: Scene, context: Context) -> None:
    red = {"op": "recolor", "target": A_CHAIR, "color": "red", "when": {"start": 1, "stop": 3}}
    painted = done(corner, red, context).scene
    moved = done(
        painted, {"op": "move", "target": A_CHAIR, "direction": "left", "distance": {"value": 0.2, "unit": "m"}},
        replace(context, time=2.0),
    ).scene  # fmt: skip
    rows = corner.cloud.group == CHAIR
    assert not torch.equal(moved.cloud.means[rows], corner.cloud.means[rows])
    assert torch.equal(moved.cloud.sh[rows], corner.cloud.sh[rows])
    assert not torch.equal(at(moved, 2.0).cloud.sh[rows], corner.cloud.sh[rows])


def test_what_turns_and_then_rests_turns_at_the_rate_that_is_said(corner: Scene, context: Context) -> None:
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    angles = (0.0, 8 * math.pi, 8 * math.pi)
    track = Track.hinge(ids, (0.0, 4.0, 5.0), angles, (0, 0, 1), middle(corner, 0.0), smooth=False)
    scene = corner.replace(motion=Motion((track,), (), (), 0.0, 5.0))
    made = done(scene, {"op": "spin", "target": A_CHAIR, "turns_per_second": 2}, context).scene.motion
    assert made is not None and made.tracks[0].angles is not None
    np.testing.assert_allclose(made.tracks[0].angles / (2 * math.pi), [0, 8, 8], atol=1e-6)


def _turning(corner: Scene) -> Scene:
    """The corner, in which the chair turns once a second until 4 s and rests until 5 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    angles = (0.0, 8 * math.pi, 8 * math.pi)
    track = Track.hinge(ids, (0.0, 4.0, 5.0), angles, (0, 0, 1), middle(corner, 0.0), smooth=False)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 5.0))


@pytest.mark.parametrize(
    ("when", "span"), [(None, (0.0, 5.0)), ({"stop": 2}, (0.0, 2.0)), ({"start": 1, "stop": 3}, (1.0, 3.0))]
)
def test_what_turns_already_turns_at_the_time_that_is_said(
    corner: Scene, context: Context, when: Json | None, span: tuple[float, float]
) -> None:
    data = {"op": "spin", "target": A_CHAIR} | ({"when": when} if when else {})
    made = done(_turning(corner), data, context).scene
    assert movements(course_of(made, CHAIR)) == [pytest.approx(span, abs=0.02)]
    assert made.motion is not None
    (track,) = made.motion.tracks
    at_first, later = angles_at(track, np.array([span[0], span[0] + 0.25]))
    assert later - at_first == pytest.approx(math.pi / 2)  # still once a second


@pytest.mark.parametrize(("stop", "end"), [("end", 5.0), (4.8, 4.8), (None, 8.5)])
def test_what_turns_again_stops_when_that_is_said(
    corner: Scene, context: Context, stop: float | str | None, end: float
) -> None:
    when = {"start": 4.5} | ({"stop": stop} if stop is not None else {})
    data = {"op": "pace", "target": A_CHAIR, "change": "repeat", "times": 1, "when": when}
    made = done(_turning(corner), data, context).scene
    assert movements(course_of(made, CHAIR)) == [pytest.approx(span, abs=0.02) for span in ((0.0, 4.0), (4.5, end))]
    assert made.motion is not None and made.motion.stop == pytest.approx(max(5.0, end), abs=0.01)


def test_going_there_and_back_makes_a_short_scene_longer(moving: Scene, context: Context) -> None:
    made = done(moving, {"op": "pace", "target": A_CHAIR, "change": "back_and_forth"}, context).scene
    assert made.motion is not None and made.motion.stop == pytest.approx(5.0)  # it goes from 1 to 3 s
    assert np.allclose(middle(made, 5.0), middle(moving, 0.0), atol=1e-4)


@pytest.fixture
def swaying(moving: Scene) -> Scene:
    """The moving scene, in which the vase changes its shape, too, from 1 to 3 s, and does not come back."""
    ids = moving.cloud.ids[moving.cloud.group == VASE].numpy()
    weights = np.random.default_rng(0).normal(size=(len(ids), 2, 3)).astype(np.float32) / 20
    basis = np.array([[0, 0], [0, 0], [1, 0.5], [0.5, -1], [0.5, -1]])
    assert moving.motion is not None
    residual = Residual(ids, np.array([0.0, 1.0, 2.0, 3.0, 4.0]), basis, weights)
    return moving.replace(motion=replace(moving.motion, residuals=(residual,)))


@pytest.mark.parametrize(
    ("fields", "shows"),
    [
        ({"change": "reverse"}, lambda t: np.clip(4.0 - t, 1.0, 3.0)),
        ({"change": "speed", "factor": 2.0}, lambda t: 1.0 + 2.0 * (t - 1.0) if t > 1.0 else t),
        ({"change": "later", "seconds": 0.5}, lambda t: max(t - 0.5, 0.0)),
        ({"change": "stop", "when": {"start": 2.0}}, lambda t: min(t, 2.0)),
        ({"change": "begin", "when": {"start": 2.0, "lasting": 1.0}}, lambda t: 1.0 + 2.0 * np.clip(t - 2.0, 0.0, 1.0)),
    ],
)
def test_what_changes_its_shape_does_so_at_other_times(
    swaying: Scene, context: Context, fields: dict[str, Any], shows: Callable[[float], float]
) -> None:
    made = done(swaying, {"op": "pace", "target": {"groups": [VASE]}, **fields}, context).scene
    own, other = swaying.cloud.group == VASE, swaying.cloud.group != VASE
    for t in np.linspace(0.0, 4.0, 17):
        found = at(made, t).cloud.means
        torch.testing.assert_close(found[own], at(swaying, float(shows(t))).cloud.means[own], atol=2e-3, rtol=0)
        torch.testing.assert_close(found[other], at(swaying, t).cloud.means[other], atol=1e-5, rtol=0)


def test_shapes_have_a_place_in_an_order(swaying: Scene, context: Context) -> None:
    """The chair and the vase both begin at 1 s; one after the other, the second begins at 3 s."""
    both = {"groups": [CHAIR, VASE], "pick": "all"}
    made = done(swaying, {"op": "order", "target": both, "order": "kept", "gap": 2.0}, context).scene
    found = {}
    for group in (CHAIR, VASE):
        own = swaying.cloud.group == group
        late = [
            float((at(made, t).cloud.means[own] - at(swaying, max(t - 2.0, 0.0)).cloud.means[own]).abs().max())
            for t in np.linspace(0.0, 5.0, 11)
        ]
        found[group] = max(late) < 2e-3
    assert sorted(found.values()) == [False, True]


def test_a_shape_has_no_turn_to_be_another(swaying: Scene, context: Context) -> None:
    for change in ({"change": "mirror"}, {"change": "part", "share": 0.5}, {"change": "go_on"}):
        with pytest.raises(InstructionError, match="changes its shape"):
            done(swaying, {"op": "pace", "target": {"groups": [VASE]}, **change}, context)
    done(swaying, {"op": "pace", "target": A_CHAIR, "change": "reverse"}, context)


def test_what_spins_turns_about_itself_as_often_as_was_said(corner: Scene, context: Context) -> None:
    made = done(corner, {"op": "spin", "target": A_CHAIR, "turns": 2, "when": {"start": 1, "stop": 3}}, context)
    motion = made.scene.motion
    assert motion is not None and len(motion.tracks) == 1
    (track,) = motion.tracks
    assert track.angles is not None and track.angles[-1] == pytest.approx(4 * math.pi)
    assert np.allclose(middle(made.scene, 3.0), middle(corner, 0.0), atol=1e-5)
    assert set(moving_ids(motion).tolist()) == set(corner.cloud.ids[corner.cloud.group == CHAIR].tolist())


def test_a_door_that_opens_by_itself_opens_as_far_as_is_said(corner: Scene, context: Context) -> None:
    ids = corner.cloud.ids[corner.cloud.group == TABLE].numpy()
    track = Track.hinge(ids, (1.0, 2.0), (0.0, 1.0), (0, 0, 1), (0.5, 0, 0))
    scene = corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))
    table = {"groups": [TABLE]}
    half = done(scene, {"op": "articulate", "target": table, "share": 0.5}, context).scene.motion
    assert half is not None and half.tracks[0].angles is not None and half.tracks[0].angles[-1] == 0.5
    shut = done(
        scene, {"op": "articulate", "target": table, "change": "close", "when": {"start": 3, "stop": 4}}, context
    )
    assert np.allclose(middle(shut.scene, 4.0, TABLE), middle(scene, 0.0, TABLE), atol=1e-6)
    assert np.allclose(middle(shut.scene, 2.5, TABLE), middle(scene, 2.5, TABLE), atol=1e-6)
    alike = done(scene, {"op": "articulate", "target": table, "change": "close", "when": {"start": 2.5}}, context)
    assert alike.scene.motion is not None and alike.scene.motion.tracks[0].times[-1] == pytest.approx(3.5)  # 1 s, too


def test_what_moves_is_told_from_what_stands(moving: Scene, context: Context) -> None:
    from scenewright.gaussians.language.query.query import Query
    from scenewright.gaussians.language.query.resolve import resolve

    found = [resolve(moving, Query(pick="all", moving=m), context.viewer) for m in (True, False)]
    assert found[0].groups == (CHAIR,) and CHAIR not in found[1].groups and len(found[1].groups) > 1
    none = resolve(moving.replace(motion=None), Query(pick="all", moving=True), context.viewer)
    assert none.verdict == "absent" and "nothing moves" in none.reason


def test_a_warp_is_undone_by_its_inverse() -> None:
    warp = Warp((0.0, 1.0, 3.0), (0.0, 2.0, 3.0), 1.0, 0.5)
    for old in (-1.0, 0.5, 2.5, 4.0):
        assert warp(warp.when(np.array([old]))) == pytest.approx(old)


@pytest.mark.parametrize(
    ("state", "start", "stop"), [("opening", 0.5, 1.0), ("closing", 2.0, 3.0), ("moving", 0.5, 3.0)]
)
def test_what_goes_away_opens_and_what_comes_back_closes(
    corner: Scene, context: Context, state: str, start: float, stop: float
) -> None:
    """The chair slides away from .5 to 1 s and back from 2 to 3 s, as a drawer does."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.slide(ids, (0.5, 1.0, 2.0, 3.0), (0.0, 0.4, 0.4, 0.0), (1.0, 0.0, 0.0))
    scene = corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))
    during = {"state": state, "of": A_CHAIR}
    data = {"op": "recolor", "target": {"groups": [VASE]}, "color": "red", "when": {"during": during}}
    made = done(scene, data, context).scene
    red = {t: bool(len(differs(scene, made, t))) for t in (0.4, 0.6, 0.9, 1.5, 2.1, 2.9, 3.1)}
    assert all(red[t] == (start < t < stop) for t in red if state != "moving" or t != 1.5)


def test_what_begins_open_closes_as_it_moves(moving: Scene, context: Context) -> None:
    """A chair that only moves away may be a gate that stood open: then it closes while it moves."""
    during = {"state": "closing", "of": A_CHAIR, "part": "after"}
    data = {"op": "recolor", "target": {"groups": [VASE]}, "color": "red", "when": {"during": during}}
    made = done(moving, data, context).scene
    assert not len(differs(moving, made, 2.9)) and differs(moving, made, 3.1).tolist() == [VASE]


@pytest.mark.parametrize(("part", "red"), [("from", (0.8, 3.9)), ("until", (0.1, 0.7)), ("while", (0.8, 0.95))])
def test_halfway_is_the_second_half_of_a_way(
    corner: Scene, context: Context, part: str, red: tuple[float, float]
) -> None:
    """The chair slides at an even speed from .5 to 1 s: it has gone half its way at .75 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.slide(ids, (0.5, 1.0), (0.0, 0.4), (1.0, 0.0, 0.0), smooth=False)
    scene = corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))
    during = {"state": "halfway", "of": A_CHAIR, "part": part}
    data = {"op": "recolor", "target": {"groups": [VASE]}, "color": "red", "when": {"during": during}}
    made = done(scene, data, context).scene
    assert all(len(differs(scene, made, t)) for t in red)
    others = {"from": (0.1, 0.7), "until": (0.8, 3.9), "while": (0.7, 1.05)}[part]
    assert not any(len(differs(scene, made, t)) for t in others)


def test_a_movement_once_more_does_not_hide_the_first(corner: Scene, context: Context) -> None:
    """It jumps back to where it began, which tells nothing of how fast it moves."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.slide(ids, (0.5, 1.0), (0.0, 0.4), (1.0, 0.0, 0.0))
    scene = corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))
    data = {"op": "pace", "target": A_CHAIR, "change": "repeat", "times": 1, "when": {"start": 3.0}}
    spans = movements(course_of(done(scene, data, context).scene, CHAIR))
    assert [tuple(round(t, 1) for t in span) for span in spans] == [(0.5, 1.0), (3.0, 3.5)]


@pytest.fixture
def drawn(corner: Scene) -> Scene:
    """The corner, in which the chair slides away from .5 to 1 s and back from 2 to 3 s, as a drawer does; 0 to 4 s."""
    ids = corner.cloud.ids[corner.cloud.group == CHAIR].numpy()
    track = Track.slide(ids, (0.5, 1.0, 2.0, 3.0), (0.0, 0.4, 0.4, 0.0), (1.0, 0.0, 0.0), smooth=False)
    return corner.replace(motion=Motion((track,), (), (), 0.0, 4.0))


@pytest.mark.parametrize(
    ("fields", "spans"),
    [
        ({"change": "speed", "factor": 0.5, "during": "opening"}, [(0.5, 1.5), (2.0, 3.0)]),
        ({"change": "speed", "factor": 2.0, "during": "closing"}, [(0.5, 1.0), (2.0, 2.5)]),
        ({"change": "begin", "lasting": 0.25, "during": "opening"}, [(0.5, 0.75), (2.0, 3.0)]),
        ({"change": "later", "seconds": 0.5, "during": "closing"}, [(0.5, 1.0), (2.5, 3.5)]),
        ({"change": "later", "seconds": -0.5, "during": "closing"}, [(0.5, 1.0), (1.5, 2.5)]),
        ({"change": "speed", "factor": 0.25, "during": "opening"}, [(0.5, 2.5), (3.5, 4.5)]),  # the rest has to wait
    ],
)
def test_one_of_several_movements_gets_another_pace(
    drawn: Scene, context: Context, fields: Json, spans: list[tuple[float, float]]
) -> None:
    own = {k: v for k, v in fields.items() if k not in ("during", "lasting")}
    when = {"during": {"state": fields["during"]}, **{k: v for k, v in fields.items() if k == "lasting"}}
    made = done(drawn, {"op": "pace", "target": A_CHAIR, **own, "when": when}, context).scene
    found = movements(course_of(made, CHAIR))
    assert np.allclose(found, spans, atol=0.06)
    assert middle(made, 0.0) == pytest.approx(middle(drawn, 0.0), abs=1e-6)
    rest = (spans[0][1] + spans[1][0]) / 2
    assert middle(made, rest) == pytest.approx(middle(drawn, 1.5), abs=1e-3)


@pytest.mark.parametrize(("start", "spans"), [(1.2, [(1.2, 1.7), (2.0, 3.0)]), (1.8, [(1.8, 2.3), (3.3, 4.3)])])
def test_what_opens_by_itself_opens_at_another_time(
    drawn: Scene, context: Context, start: float, spans: list[tuple[float, float]]
) -> None:
    data = {"op": "articulate", "target": A_CHAIR, "change": "open", "when": {"start": start}}
    made = done(drawn, data, context).scene
    assert np.allclose(movements(course_of(made, CHAIR)), spans, atol=0.06)


def test_what_closes_by_itself_closes_later(drawn: Scene, context: Context) -> None:
    data = {"op": "articulate", "target": A_CHAIR, "change": "close", "when": {"start": 2.5}}
    made = done(drawn, data, context).scene
    assert np.allclose(movements(course_of(made, CHAIR)), [(0.5, 1.0), (2.5, 3.5)], atol=0.06)
    assert middle(made, 2.4) == pytest.approx(middle(drawn, 1.5), abs=5e-3)  # it stays open until then


def test_what_closes_by_itself_may_close_by_half(drawn: Scene, context: Context) -> None:
    data = {"op": "articulate", "target": A_CHAIR, "change": "close", "share": 0.5, "when": {"start": 1.5}}
    made = done(drawn, data, context).scene
    way = [float(np.linalg.norm(middle(made, t) - middle(drawn, 0.0))) for t in (1.4, 4.0)]
    assert way[1] == pytest.approx(way[0] / 2, rel=0.02)  # it stays there


@pytest.mark.parametrize(
    ("when", "red"),
    [
        ({"during": {"state": "opening", "part": "after"}, "until": {"state": "closing", "part": "until"}}, (1.0, 2.0)),
        (
            {"during": {"state": "opening", "part": "from"}, "until": {"state": "closing", "part": "until_end"}},
            (0.5, 3.0),
        ),
        ({"start": 1.5, "until": {"state": "closing", "part": "until"}}, (1.5, 2.0)),
    ],
)
def test_what_happens_may_end_a_time(
    drawn: Scene, context: Context, when: dict[str, Any], red: tuple[float, float]
) -> None:
    when = {key: {**told, "of": A_CHAIR} if isinstance(told, dict) else told for key, told in when.items()}
    data = {"op": "recolor", "target": {"groups": [VASE]}, "color": "red", "when": when}
    made = done(drawn, data, context).scene
    for t in np.arange(0.05, 4.0, 0.1):
        assert bool(len(differs(drawn, made, float(t)))) == (red[0] < t < red[1]), t


def test_a_time_that_nothing_ends_is_told(drawn: Scene, context: Context) -> None:
    until = {"state": "opening", "of": A_CHAIR, "part": "until"}
    data = {"op": "recolor", "target": {"groups": [VASE]}, "color": "red", "when": {"start": 1.5, "until": until}}
    with pytest.raises(InstructionError, match=r"does not happen after 1\.5 s"):
        done(drawn, data, context)


def test_only_an_end_ends_a_time() -> None:
    with pytest.raises(UserError, match="until or until_end"):
        parse({"op": "recolor", "target": A_CHAIR, "color": "red", "when": {"until": {"state": "moving"}}})


def test_what_is_to_be_shut_by_a_time_is_shut_then(drawn: Scene, context: Context) -> None:
    data = {"op": "articulate", "target": A_CHAIR, "change": "close", "when": {"stop": 2.5}}
    spans = movements(course_of(done(drawn, data, context).scene, CHAIR))
    assert [tuple(round(t, 1) for t in span) for span in spans] == [(0.5, 1.0), (2.0, 2.5)]


def test_a_movement_that_would_end_as_it_begins_is_refused(moving: Scene, context: Context) -> None:
    data = {
        "op": "pace",
        "target": A_CHAIR,
        "change": "begin",
        "when": {"during": {"state": "moving", "part": "until"}},
    }
    with pytest.raises(InstructionError, match="say when it is to begin"):
        done(moving, data, context)
