"""Laws of tracks and motions: rest at the start, conjugation and its inverse, no overshoot, the short way."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion import keys
from scenewright.gaussians.motion.motion import (
    Look,
    Motion,
    Residual,
    Track,
    carried,
    combinations,
    composed,
    mentioned_ids,
    moving_ids,
    pose,
    poses,
    renumbered,
    without_ids,
)
from scenewright.gaussians.motion.runs import held_by, ids_of, runs_of

F64 = NDArray[np.float64]
FEW = settings(max_examples=25, deadline=None)
POINTS = np.random.default_rng(1).uniform(-2, 2, (5, 3))

numbers = st.floats(-3, 3).map(lambda v: round(v, 3))
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
directions = vectors.filter(lambda v: float(np.linalg.norm(v)) > 0.1)
widths = st.lists(st.floats(0.05, 2), min_size=1, max_size=5).map(lambda w: np.cumsum([0.0, *w]))


@st.composite
def tracks(draw: st.DrawFn) -> Track:
    """A track of any kind that is at rest at 0 s."""
    times = draw(widths)
    k, smooth = len(times), draw(st.booleans())
    pivot, axis = draw(vectors), draw(directions)
    values = np.array([0.0, *(draw(numbers) for _ in range(k - 1))])
    kind = draw(st.sampled_from(["rigid", "hinge", "slide", "spin"]))
    if kind == "hinge":
        return Track.hinge([1, 2], times, values, axis, pivot, smooth)
    if kind == "slide":
        return Track.slide([1, 2], times, values, axis, smooth)
    if kind == "spin":
        return Track.spin([1, 2], draw(numbers), axis, pivot)
    quats = keys.about(axis / np.linalg.norm(axis), values)
    offsets = np.array([np.zeros(3), *(draw(vectors) for _ in range(k - 1))])
    return Track.rigid([1, 2], times, quats, offsets, pivot, smooth)


@st.composite
def similarities(draw: st.DrawFn) -> tuple[F64, F64]:
    """A rotation with a scale, mirrored or not, and an offset."""
    axis, mirror = draw(directions), np.diag([draw(st.sampled_from([1.0, -1.0])), 1.0, 1.0])
    turn = Rotation.from_rotvec(axis).as_matrix() @ mirror
    return draw(st.floats(0.3, 3)) * turn, draw(vectors)


def moved(track: Track, points: F64, time: float) -> F64:
    turn, shift = pose(track, time)
    return np.asarray(points @ turn.T + shift)


@FEW
@given(tracks())
def test_the_pose_at_the_start_is_the_identity(track: Track) -> None:
    Motion((track,), stop=1.0)  # it would raise
    np.testing.assert_allclose(moved(track, POINTS, 0.0), POINTS, atol=1e-12)
    np.testing.assert_allclose(moved(track, POINTS, -1.0), POINTS, atol=1e-12)


@FEW
@given(tracks(), st.floats(-1, 9))
def test_poses_are_rigid_and_alike_for_one_time_and_many(track: Track, time: float) -> None:
    turns, shifts = poses(track, (time, 0.5))
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.tile(np.eye(3), (2, 1, 1)), atol=1e-12)
    assert np.linalg.det(turns[0]) == pytest.approx(1.0)
    np.testing.assert_array_equal(turns[0], pose(track, time)[0])
    np.testing.assert_array_equal(shifts[0], pose(track, time)[1])


@FEW
@given(tracks(), similarities(), st.floats(0, 9))
def test_a_mapped_track_moves_the_mapped_body_as_before(track: Track, by: tuple[F64, F64], time: float) -> None:
    matrix, offset = by
    mapped = carried(Motion((track,), stop=9.0), [1, 2], matrix, offset)
    assert mapped is not None
    here = moved(mapped.tracks[0], POINTS @ matrix.T + offset, time)
    np.testing.assert_allclose(here, moved(track, POINTS, time) @ matrix.T + offset, atol=1e-9)
    inverse = np.linalg.inv(matrix)
    back = carried(mapped, [1, 2], inverse, -inverse @ offset)
    assert back is not None
    np.testing.assert_allclose(moved(back.tracks[0], POINTS, time), moved(track, POINTS, time), atol=1e-9)


def test_a_path_around_a_corner_is_the_same_path_when_it_is_turned() -> None:
    """Between keys each component has a curve of its own, so that the components have to turn too."""
    path = [[0, 0, 0], [0, 0, 0], [0, 0, 1], [1, 0, 0]]
    track = Track.along([1], [0, 3, 5, 6], path)
    turn = Rotation.from_rotvec([0, 2.0, 0]).as_matrix()
    mapped = carried(Motion((track,), stop=6.0), [1], turn, np.zeros(3))
    assert mapped is not None
    np.testing.assert_allclose(moved(mapped.tracks[0], POINTS @ turn.T, 4.0), moved(track, POINTS, 4.0) @ turn.T)


def test_a_track_that_holds_more_than_what_is_mapped_is_divided() -> None:
    motion = Motion((Track.along([1, 2, 3], [0, 1], [[0, 0, 0], [1, 0, 0]]),), stop=1.0)
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    mapped = carried(motion, [2], quarter, np.zeros(3))
    assert mapped is not None
    stay, turned = mapped.tracks
    assert (stay.ids.tolist(), turned.ids.tolist()) == ([1, 3], [2])
    np.testing.assert_allclose(pose(turned, 1.0)[1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(pose(stay, 1.0)[1], [1, 0, 0], atol=1e-12)
    assert carried(motion, [7], quarter, np.zeros(3)) is motion


@FEW
@given(widths, st.data(), st.booleans(), st.booleans())
def test_monotone_cubics_pass_their_keys_and_do_not_overshoot(
    times: F64, data: st.DataObject, smooth: bool, ease: bool
) -> None:
    values = np.array([data.draw(vectors) for _ in times])
    np.testing.assert_allclose(keys.between(times, values, times, smooth, ease), values, atol=1e-12)
    for low, high, start, end in zip(times[:-1], times[1:], values[:-1], values[1:], strict=True):
        inside = keys.between(times, values, np.linspace(low, high, 21), smooth, ease)
        assert (inside >= np.minimum(start, end) - 1e-9).all()
        assert (inside <= np.maximum(start, end) + 1e-9).all()
    outside = keys.between(times, values, np.array([times[0] - 1, times[-1] + 1]), smooth, ease)
    np.testing.assert_allclose(outside, values[[0, -1]], atol=1e-12)


def test_inner_slopes_are_those_of_scipy() -> None:
    times, values = np.array([0, 0.7, 1.0, 2.5, 3.0, 4.2]), np.array([0, 1.0, 1.3, 1.1, 1.1, 4.0])
    want = PchipInterpolator(times, values)(np.linspace(0.7, 3.0, 50))
    np.testing.assert_allclose(keys.between(times, values[:, None], np.linspace(0.7, 3.0, 50), True)[:, 0], want)


@FEW
@given(directions, directions, st.floats(0, 1), st.sampled_from([1.0, -1.0]))
def test_turns_go_the_short_way_at_an_even_rate(a: F64, b: F64, share: float, sign: float) -> None:
    first, second = Rotation.from_rotvec(a), Rotation.from_rotvec(b)
    ends = np.stack([np.roll(first.as_quat(), 1), sign * np.roll(second.as_quat(), 1)])
    between = first.inv() * second
    if between.magnitude() > math.pi - 1e-3:  # both ways are as short
        return
    got = keys.turns_between(np.array([0.0, 1.0]), ends, np.array([share]), smooth=False)[0]
    want = first * Rotation.from_rotvec(share * between.as_rotvec())
    assert (want.inv() * Rotation.from_quat(np.roll(got, -1))).magnitude() < 1e-6


def test_smooth_turns_do_not_stop_at_keys_of_one_turn() -> None:
    times = np.linspace(0, 4, 5)
    quats = keys.about(np.array([0.0, 0, 1]), times * 0.4)
    near = keys.turns_between(times, quats, np.array([1.999, 2.001]), smooth=True)
    rate = 2 * math.acos(min(1.0, abs(float(near[0] @ near[1])))) / 0.002
    assert rate == pytest.approx(0.4, rel=0.05)


def test_a_spin_goes_on_and_a_hinge_stays() -> None:
    spin = Track.spin([0], 1.0, (0, 0, 2), (1, 0, 0), start=1.0)
    np.testing.assert_allclose(moved(spin, np.array([[2.0, 0, 0]]), 6.25), [[1, 1, 0]], atol=1e-9)
    np.testing.assert_allclose(moved(spin, np.array([[2.0, 0, 0]]), 0.5), [[2, 0, 0]], atol=1e-12)
    door = Track.hinge([0], [1, 2], [0, math.pi / 2], (0, 0, 1), (1, 0, 0))
    np.testing.assert_allclose(moved(door, np.array([[2.0, 0, 0]]), 9.0), [[1, 1, 0]], atol=1e-12)
    np.testing.assert_allclose(moved(door, np.array([[2.0, 0, 0]]), 1.5), [[1 + 0.5**0.5, 0.5**0.5, 0]], atol=1e-12)
    assert not spin.still and not door.still
    assert not Track.hinge([0], [0, 1], [0, 2 * math.pi], (0, 0, 1), (0, 0, 0)).still
    assert Track.hinge([0], [0, 1], [0, 0], (0, 0, 1), (0, 0, 0)).still


@FEW
@given(st.sets(st.integers(0, 60)), st.sets(st.integers(0, 60)))
def test_intervals_hold_what_they_are_made_of(inside: set[int], asked: set[int]) -> None:
    runs = runs_of(list(inside))
    assert ids_of(runs).tolist() == sorted(inside)
    assert held_by(runs, np.array(sorted(asked), dtype=np.int64)).tolist() == [i in inside for i in sorted(asked)]


def example() -> Motion:
    path = [[0, 0, 0], [1, 0, 0]]
    look = Look(np.array([3, 5]), 0, 1, torch.arange(6.0).reshape(2, 1, 3), torch.tensor([0.0, 0.5]))
    residual = Residual(np.array([2, 5]), [0, 1], [[0], [1]], [[[1, 0, 0]], [[0, 2, 0]]])  # type: ignore[arg-type]
    return Motion((Track.along([1, 2, 3], [0, 1], path), Track.along([3, 4], [0, 1], path)), (look,), (residual,), 0, 1)


def test_removed_ids_leave_every_part() -> None:
    motion = example()
    left = without_ids(motion, [3, 5])
    assert left is not None
    assert [t.ids.tolist() for t in left.tracks] == [[1, 2], [4]]
    assert left.looks == () and left.residuals[0].ids.tolist() == [2]
    assert without_ids(motion, [77]) is motion
    assert without_ids(motion, [1, 2, 3, 4, 5]) is None and without_ids(None, [1]) is None


def test_renumbered_ids_keep_what_was_said_of_each() -> None:
    left = renumbered(example(), [5, 3, 2, 9], [0, 1, 7, 8])
    assert left is not None
    assert [t.ids.tolist() for t in left.tracks] == [[1, 7], [1]]
    look, residual = left.looks[0], left.residuals[0]
    assert look.sh is not None and look.opacities is not None
    assert (look.ids.tolist(), look.opacities.tolist()) == ([0, 1], [0.5, 0.0])
    assert look.sh[:, 0, 0].tolist() == [3.0, 0.0]
    assert residual.ids.tolist() == [0, 7] and residual.weights[:, 0].tolist() == [[0, 2, 0], [1, 0, 0]]
    assert mentioned_ids(left).tolist() == [0, 1, 7]


def test_ids_are_grouped_by_the_tracks_that_hold_them() -> None:
    found = {tracks: ids_of(runs).tolist() for runs, tracks in combinations(example())}
    assert found == {(0,): [1, 2], (0, 1): [3], (1,): [4]}
    assert combinations(Motion()) == []


def test_what_moves_is_what_a_pose_or_a_residual_moves() -> None:
    assert moving_ids(example()).tolist() == [1, 2, 3, 4, 5]
    assert moving_ids(Motion((Track.along([1], [0, 1], np.zeros((2, 3))),), stop=1)).tolist() == []
    assert moving_ids(None).tolist() == []


def test_motions_join_where_they_begin_together() -> None:
    motion = example()
    both = composed(motion, Motion((Track.spin([9], 1, (0, 0, 1), (0, 0, 0)),), stop=3.0))
    assert both is not None and len(both.tracks) == 3 and both.stop == 3.0
    assert composed(None, motion) is motion and composed(motion, None) is motion
    with pytest.raises(UserError, match="cannot be joined"):
        composed(motion, Motion(start=1.0, stop=2.0))


def test_bad_motions_are_refused() -> None:
    with pytest.raises(UserError, match="not at rest at the start"):
        Motion((Track.along([1], [-1, 1], [[0, 0, 0], [1, 0, 0]]),))
    with pytest.raises(UserError, match="not 0 at the start"):
        Motion(residuals=(Residual([1], [0], [[1]], [[[1, 0, 0]]]),))  # type: ignore[arg-type]
    with pytest.raises(UserError, match="must ascend"):
        Track.along([1], [1, 1], [[0, 0, 0], [1, 0, 0]])
    with pytest.raises(UserError, match="length one"):
        Track.rigid([1], [0], [[2.0, 0, 0, 0]])
    with pytest.raises(UserError, match="finite"):
        Track.along([1], [0, 1], [[0, 0, 0], [math.nan, 0, 0]])
    with pytest.raises(UserError, match=r"finite, but at \[1\] there is nan"):
        Track.slide([1], [0, math.nan], [0, 1], (0, 0, 1))
    track = Track.slide([1], [0, 2], [0, 1], (0, 0, 1))
    with pytest.raises(UserError, match=r"no length.*stop=2"):
        Motion((track,))
    with pytest.raises(UserError, match=r"tuple, as in \(track,\), not Track"):
        Motion(track, stop=2)  # type: ignore[arg-type]
    with pytest.raises(UserError, match="whole numbers"):
        Track.slide([0.5], [0, 2], [0, 1], (0, 0, 1))
    with pytest.raises(UserError, match="whole numbers"):
        Track.slide("the door", [0, 2], [0, 1], (0, 0, 1))
    with pytest.raises(UserError, match="axis of a hinge"):
        Track.hinge([1], [0, 1], [0, 1], (0, 0, 0), (0, 0, 0))
    with pytest.raises(UserError, match="disjoint"):
        Track(np.array([[3, 5], [1, 2]]), *(np.zeros(s) for s in ((1,), (1, 4), (1, 3), (3,))))  # type: ignore[arg-type]
    with pytest.raises(UserError, match="begin before it ends"):
        Look(np.array([1]), 2.0, 1.0)
    with pytest.raises(UserError, match="opacities"):
        Look(np.array([1]), 0.0, 1.0, opacities=torch.tensor([1.0]))
    with pytest.raises(UserError, match="finite number of seconds"):
        pose(Track.along([1], [0], [[0, 0, 0]]), math.nan)
    with pytest.raises(UserError, match="numbers of seconds"):
        Look([1], "now", 1.0)  # type: ignore[arg-type]
    with pytest.raises(UserError, match="harmonics of a look must be numbers"):
        Look([1], 0.0, 1.0, "red")  # type: ignore[arg-type]
    with pytest.raises(UserError, match="whole numbers"):
        Look([0.5], 0.0, 1.0)  # type: ignore[arg-type]
    with pytest.raises(UserError, match="times of a motion must be numbers"):
        Track.along([1], ["a"], [[0, 0, 0]])


def test_a_look_takes_arrays_of_any_kind() -> None:
    look = Look([3, 5], 0, 1, np.ones((2, 1, 3)), [0.0, 0.5])  # type: ignore[arg-type]
    assert look.ids.dtype == np.int64
    assert look.sh is not None and look.sh.dtype == torch.float32 and torch.equal(look.sh, torch.ones(2, 1, 3))
    assert look.opacities is not None and torch.equal(look.opacities, torch.tensor([0.0, 0.5]))
    double = Look([3], 0, 1, torch.ones(1, 1, 3, dtype=torch.float64))  # type: ignore[arg-type]
    assert double.sh is not None and double.sh.dtype == torch.float32  # as motion files hold it
