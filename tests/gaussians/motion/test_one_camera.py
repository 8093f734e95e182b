"""Films of one moving camera: what frames agree on, what rests at an end, and paths that pictures tell in part."""

from dataclasses import replace

import numpy as np
import pytest

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings
from scenewright.gaussians.fit.initialize import MIN_POINTS
from scenewright.gaussians.fit.parameters import Parameters
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.motion.fitting import fit as fitting
from scenewright.gaussians.motion.fitting.agreement import Agreement
from scenewright.gaussians.motion.fitting.bodies import Body, Labelled, Line, placed, turn_around, turned
from scenewright.gaussians.motion.fitting.footage import Footage, differs, rounded
from scenewright.gaussians.motion.fitting.resting import until
from scenewright.gaussians.motion.fitting.seeds import gone
from scenewright.gaussians.motion.fitting.smoothing import smoothed
from scenewright.gaussians.motion.fitting.stillness import OFF, difference_of, nothing_moves, otherwise
from scenewright.gaussians.motion.fitting.supposing import supposed
from scenewright.gaussians.motion.fitting.tracking import Tracker
from scenewright.gaussians.render.cpu import gradient

FRAMES = 14


def eye(t: int) -> Camera:
    """A camera that is carried by 1.5 to the right."""
    return Camera.look_at((-0.7 + 1.5 * t / (FRAMES - 1), -2.4, 0.5), (0, 0, 0), (0, 0, 1), 48, 40, 60)


def columns_of(means: np.ndarray, sizes: np.ndarray, colors: np.ndarray):
    """Columns of round Gaussians."""
    count = len(means)
    return (
        means.astype(np.float32), np.tile(np.float32([1, 0, 0, 0]), (count, 1)),
        np.repeat(sizes[:, None], 3, axis=1).astype(np.float32), np.full(count, 0.9, np.float32),
        ((colors - 0.5) / SH_C0).astype(np.float32)[:, None],
    )  # fmt: skip


@pytest.fixture(scope="module")
def room():
    """A leaf of many colours before a gray wall: columns and labels."""
    rng = np.random.default_rng(5)
    x, z = (a.reshape(-1) for a in np.meshgrid(np.linspace(-0.5, 0.5, 11), np.linspace(-0.4, 0.4, 9)))
    leaf = np.stack([x, 0 * x, z], axis=1)
    x, z = (a.reshape(-1) for a in np.meshgrid(np.linspace(-2.4, 2.4, 24), np.linspace(-1.5, 1.5, 16)))
    wall = np.stack([x, 0 * x + 0.8, z], axis=1)
    patches = rng.permutation([[a, b, c] for a in (0.1, 0.9) for b in (0.1, 0.9) for c in (0.1, 0.9)])
    place = np.floor((leaf[:, 0] + 0.55) / 0.3).astype(int) + 4 * (leaf[:, 2] > 0)
    colors = np.concatenate([patches[place], np.full((len(wall), 3), 0.5)])
    sizes = np.r_[np.full(len(leaf), 0.05), np.full(len(wall), 0.13)]
    labels = np.r_[np.ones(len(leaf)), np.zeros(len(wall))].astype(np.int32)
    return columns_of(np.concatenate([leaf, wall]), sizes, colors), labels


def filmed(columns, labels, body: Body) -> Footage:
    """The film of one moving camera, and what each frame would show at the first time."""
    shots, first = [], []
    for t in range(FRAMES):
        now, start = (gradient.draw(placed(columns, labels, [body], k), eye(t), (0.0, 0.0, 0.0)).rgb for k in (t, 0))
        shots.append(Shot(eye(t), rounded(now), 0.1 * t))
        first.append(rounded(start))
    return Footage.of(shots, [s.time for s in shots]).beginning(first)


def tracker_of(columns, labels, footage: Footage) -> Tracker:
    return Tracker(columns, np.flatnonzero(labels), labels == 0, footage, 0)


def test_a_colour_that_a_render_has_beside_a_pixel_is_no_difference():
    drawn = np.zeros((20, 20, 3), np.uint8)
    drawn[:, 10:] = 200
    shifted, other = np.roll(drawn, 1, axis=1), drawn.copy()
    shifted[:, 0] = 0
    assert not differs(drawn, shifted).any()
    other[5:12, 2:8] = 120
    assert differs(drawn, other)[6:11, 3:7].all() and differs(drawn, other).sum() <= 42


def test_the_same_movement_from_another_time_and_backwards_places_points_alike():
    rng = np.random.default_rng(1)
    body = Body.at_rest(rng.normal(size=3), 4)
    for t in range(1, 4):
        body.quats[t], body.offsets[t] = turned(body.quats[t - 1], rng.normal(size=3)), rng.normal(size=3)
    points, quats = rng.normal(size=(6, 3)), np.tile([1.0, 0, 0, 0], (6, 1))
    there, turned_there = body.placed(3, points, quats)
    other = body.started_at(3).backwards()
    assert np.allclose(other.quats[0], [1, 0, 0, 0]) and np.allclose(other.offsets[0], 0)
    for t in range(4):
        at, q = other.placed(3 - t, there, turned_there)
        was, p = body.placed(t, points, quats)
        assert np.allclose(at, was, atol=1e-5) and np.allclose(np.abs((p * q).sum(axis=1)), 1, atol=1e-5)


def test_a_hinge_that_was_followed_backwards_is_the_same_hinge(room):
    columns, labels = room
    line = Line("hinge", np.array([0, 0, 1.0]), np.array([-0.5, 0, 0]), np.linspace(0, 1, 5))
    body, parameters = Body.at_rest(np.zeros(3), 5).on(line), Agreement([], wall(columns), 1, 1, None).parameters
    labelled = Labelled.labelled(parameters, labels)
    before = placed(columns, labels, [body], 4)[0]
    bodies = [body]
    turn_around(labelled, bodies)
    assert np.allclose(labelled.means, before, atol=1e-5)
    assert np.allclose(bodies[0].line.values, np.linspace(0, -1, 5)) and np.allclose(bodies[0].line.pivot, line.pivot)
    back = placed((labelled.means, *columns[1:]), labels, bodies, 4)[0]
    assert np.allclose(back, columns[0], atol=1e-5)


def wall(columns) -> Parameters:
    """Parameters of columns."""
    import torch

    from scenewright.gaussians.cloud import GaussianCloud

    return Parameters.of(GaussianCloud.create(*(torch.from_numpy(c.copy()) for c in columns)))


@pytest.mark.parametrize(
    ("shown", "frames"),
    [
        ([1, 1, 1, 1, 0.9, 0.8, 0.1, 0.9], 6),
        ([1, 1, 1, 1, np.nan, 0.9, 0.8, 0.0], 7),  # a frame that does not show the place
        ([1, 1, 1, 1, np.nan, np.nan, 0.9, 0.0], 4),  # one frame of three is too little
        ([1, 1, 1, 1, 1, 1, 1, 1], 4),  # it is always there, so that it does not move
        ([1, 1, 1, 1], 4),
    ],
)
def test_an_end_lasts_until_frames_no_longer_show_it(shown, frames):
    assert until(np.array(shown, float), 4) == frames


def test_what_few_frames_show_is_left_out_and_not_learned(room):
    columns, labels = room
    empty = tuple(c[labels == 0] for c in columns)
    shots = []
    for t in range(FRAMES):
        photo = rounded(gradient.draw(empty, eye(t), (0.0, 0.0, 0.0)).rgb)
        if t % 3 == 0:
            photo[10:22, 14:28] = (220, 30, 30)
        shots.append(Shot(eye(t), photo))
    clean = rounded(gradient.draw(empty, eye(3), (0.0, 0.0, 0.0)).rgb).astype(int)
    off = []
    for left_out in (range(FRAMES), ()):
        training = Agreement(shots, wall(empty), len(empty[0]) + 1, 2.0, np.random.default_rng(0))
        training.leave_out(left_out)
        for k in range(150):
            training.step(k / 150)
        off.append(np.abs(training.drawn(3).astype(int) - clean)[10:22, 14:28].mean())
    assert off[0] < 0.5 and off[1] > 3 * off[0]  # of 255: it smears otherwise


def test_what_leaves_before_a_moving_camera_is_gone_and_the_wall_is_not(room):
    columns, labels = room
    body = Body.at_rest(np.zeros(3), FRAMES)
    body.offsets[5:, 2] = 3.0  # out of sight
    flags = gone(columns, filmed(columns, labels, body))
    leaf = np.flatnonzero(labels)
    assert flags[leaf][:, 5:].mean() > 0.9 and not flags[leaf][:, :5].any()
    assert flags[labels == 0].mean() < 0.15  # what the leaf hid changes too


def test_a_path_that_errs_along_the_line_of_sight_is_mended_by_the_times_around(room):
    columns, labels = room
    rng, body = np.random.default_rng(2), Body.at_rest(np.zeros(3), FRAMES)
    body.offsets[:, 0] = 0.6 * np.clip(np.arange(FRAMES) / 10 - 0.3, 0, 0.7)
    footage = filmed(columns, labels, body)
    tracker = tracker_of(columns, labels, footage)
    true = body.seen_from(tracker.pivot)
    rough = Body(true.pivot, true.quats.copy(), true.offsets.copy())
    for t in range(1, FRAMES):
        ray = tracker.pivot + true.offsets[t] - eye(t).position
        rough.offsets[t] += 0.15 * rng.normal() * ray / np.linalg.norm(ray)
    found = smoothed(tracker, rough, footage.radius)

    def off(b: Body) -> float:
        return float(np.linalg.norm(b.offsets - true.offsets, axis=1)[1:].mean())

    assert off(rough) > 0.08 and off(found) < 0.03  # scene units; the leaf is 1 wide
    assert np.allclose(found.offsets[0], 0) and np.allclose(found.quats[0], [1, 0, 0, 0])


@pytest.mark.slow
def test_a_leaf_that_swings_before_a_moving_camera_is_a_hinge_at_its_edge(room):
    columns, labels = room
    values = -1.2 * np.clip((np.arange(FRAMES) - 3) / 7, 0, 1)
    line = Line("hinge", np.array([0, 0, 1.0]), np.array([-0.5, 0, 0]), values)
    body = Body.at_rest(np.zeros(3), FRAMES).on(line)
    footage = filmed(columns, labels, body)
    found = supposed(tracker_of(columns, labels, footage), FRAMES).line
    assert found is not None and found.kind == "hinge" and abs(found.axis[2]) > 0.97
    assert np.hypot(*(found.pivot - line.pivot)[:2]) < 0.1
    assert np.abs(found.values * np.sign(found.axis[2]) - values).max() < 0.2  # radians


def test_a_place_looks_otherwise_in_a_run_of_frames_that_show_it():
    seen, off = np.ones((6, 12), bool), np.full((6, 12), 0.01, np.float32)
    off[0, 3:6] = 0.3  # moved
    off[1, [2, 5, 9]] = 0.3  # now and then
    off[2] = 0.3  # never explained
    seen[3, 1:9:2], off[3, 2:8] = False, 0.3  # three of the frames that show it
    seen[4, 5:], off[4, 1:4] = False, 0.3  # too few show it
    off[5, 7:] = 0.3
    level = np.full(12, 0.01, np.float32)
    level[7:] = 0.2  # frames that are explained badly all over
    found = otherwise(seen, off, level)
    assert np.flatnonzero(found[0]).tolist() == [3, 4, 5] and np.flatnonzero(found[3]).tolist() == [2, 4, 6]
    assert not found[[1, 2, 4, 5]].any()


def test_exposure_a_gloss_and_an_edge_that_is_a_pixel_off_are_no_difference_and_a_thing_is():
    rng = np.random.default_rng(4)
    drawn = np.kron(rng.integers(60, 180, (5, 6, 3)), np.ones((8, 8, 1))).astype(np.uint8)
    taken = np.roll(drawn, 1, axis=1) * 0.8 + 20
    y, x = np.mgrid[:40, :48]
    taken += 35 * np.exp(-((x - 24) ** 2 + (y - 20) ** 2) / (2 * 15**2))[..., None]
    off = difference_of(drawn, taken.round().clip(0, 255).astype(np.uint8))[3:-3, 3:-3]
    assert np.quantile(off, 0.98) < OFF
    taken[12:19, 20:27] = 250
    assert difference_of(drawn, taken.round().clip(0, 255).astype(np.uint8))[14:17, 22:25].min() > OFF


@pytest.mark.parametrize("exposed", [False, True])
@pytest.mark.slow
def test_whether_anything_moves_is_told_by_a_short_training(room, exposed):
    columns, labels = room
    rng, body = np.random.default_rng(3), Body.at_rest(np.zeros(3), FRAMES)
    body.offsets[5:, 2] = 3.0
    start = wall(columns).cloud()
    for path, still in ((Body.at_rest(np.zeros(3), FRAMES), True), (body, False)):
        shots = filmed(columns, labels, path).shots
        if exposed:
            bright = rng.uniform(0.8, 1.1, (FRAMES, 3))
            shots = [Shot(s.camera, rounded(s.colors * b), s.time) for s, b in zip(shots, bright, strict=True)]
        assert nothing_moves(shots, start, 1.2, 0) == still
    again = [nothing_moves(shots, start, 1.2, 0) for _ in range(2)]
    assert again == [False, False]


def test_a_film_in_which_nothing_moves_is_left_to_photographs_with_points_of_its_stereo(room, monkeypatch):
    columns, labels = room
    shots = filmed(columns, labels, Body.at_rest(np.zeros(3), FRAMES)).shots
    none = Points(np.zeros((0, 3)), np.zeros((0, 3)))
    photos = Photos(shots, (), none, 1.2)
    monkeypatch.setattr(fitting, "nothing_moves", lambda *_: True)
    left = fitting.fit_what_moves(photos, Settings(steps=50, degree=0))
    assert isinstance(left, fitting.Still) and left.tried == 0 and not left.cut
    assert len(left.photos.points.means) >= MIN_POINTS and left.photos.shots == shots
    colors = left.photos.points.colors
    assert colors.shape == left.photos.points.means.shape and colors.min() >= 0 and colors.max() <= 1
    surveyed = Points(np.random.default_rng(0).normal(size=(200, 3)), np.full((200, 3), 0.5))
    kept = fitting.fit_what_moves(replace(photos, points=surveyed), Settings(steps=50, degree=0))
    assert isinstance(kept, fitting.Still) and kept.photos.points is surveyed


def film_of(name: str, **options):
    """A small film of one moving camera as photographs, and the film."""
    from scenewright.benchmarks._motion import films

    film = films.film(name, "1", (128, 96), **options)
    shots = tuple(Shot(f.camera, f.photo, f.time) for f in film.frames)
    held = tuple(Shot(f.camera, f.photo, f.time) for f in film.held_out[::4])
    return film, Photos(shots, held, Points(np.zeros((0, 3)), np.zeros((0, 3))), 2.6)


@pytest.mark.slow
def test_a_robot_that_walks_before_one_moving_camera_is_found_and_followed():
    from scenewright.benchmarks._motion import films
    from scenewright.gaussians.motion.fitting.fit import fit_film
    from scenewright.gaussians.motion.motion import poses

    film, photos = film_of("toy")
    still, moving = (fit_film(photos, Settings(steps=1200, degree=0), detail=d) for d in ("static", "rigid"))
    assert still.scene.motion is None and moving.quality.psnr > still.quality.psnr + 1  # dB
    middle = films.middles(film.scene, film.times)[0]
    away = []
    for track in moving.scene.motion.tracks:
        turns, shifts = poses(track, film.times)
        away.append(np.linalg.norm(turns @ middle[0] + shifts - middle, axis=1).mean())
    assert min(away) < 0.2  # metres; the robot goes 2.5 m
