"""What the search for motion costs: frames and pairs of frames are bounded, and each phase has its share of time."""

from collections.abc import Callable

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings
from scenewright.gaussians.fit.parameters import Parameters
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.motion.fitting import agreement, resting, start, stereo
from scenewright.gaussians.motion.fitting import fit as fitting
from scenewright.gaussians.motion.fitting.bodies import Body, Line, turned
from scenewright.gaussians.motion.fitting.budget import LASTING_UNTIL, LEAST, Budget, OutOfTime
from scenewright.gaussians.motion.fitting.finding import Finder
from scenewright.gaussians.motion.fitting.footage import Footage
from scenewright.gaussians.motion.fitting.resting import Ends
from scenewright.gaussians.motion.fitting.sketch import (
    MOST_PIXELS,
    MOST_TIMES,
    STEREO_FRAMES,
    STEREO_PIXELS,
    at_all_times,
    covering,
    reduced,
    sketched,
    stereo_pixels,
)
from scenewright.gaussians.motion.fitting.stereo import WITNESSES, neighbours, points_of, witnesses


def eyes(count: int, width: int = 16, height: int = 12) -> list[Camera]:
    """Cameras along an arc of a radian and a half around the origin."""
    angles = np.linspace(-0.75, 0.75, count)
    return [
        Camera.look_at((3 * np.sin(a), -3 * np.cos(a), 1.0), (0, 0, 0), (0, 0, 1), width, height, 60) for a in angles
    ]


def frames(count: int, width: int = 16, height: int = 12) -> list[Shot]:
    photo = np.random.default_rng(0).integers(0, 255, (height, width, 3), dtype=np.uint8)
    return [Shot(camera, photo, 0.1 * k) for k, camera in enumerate(eyes(count, width, height))]


def none() -> Points:
    return Points(np.zeros((0, 3)), np.zeros((0, 3)))


class Clock:
    """Seconds, as they are set."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


# --- pairs and sizes ---------------------------------------------------------------------------------------------


def test_the_pairs_of_pictures_that_are_compared_grow_with_their_number_and_not_with_its_square(monkeypatch):
    pairs, sources = [], []
    confirms, mapping = stereo.confirms, stereo._mapping
    monkeypatch.setattr(stereo, "confirms", lambda *a: pairs.append(1) or confirms(*a))
    monkeypatch.setattr(stereo, "_mapping", lambda *a: sources.append(1) or mapping(*a))
    for count in (8, 20, 40):
        pairs.clear(), sources.clear()
        shots = frames(count)
        points_of([s.camera for s in shots], [s.colors for s in shots], 3.0)
        assert len(pairs) == count * min(count - 1, WITNESSES) and len(sources) == count * stereo.NEIGHBOURS


def test_pictures_that_are_asked_are_near_and_far_and_look_the_same_way():
    cameras = eyes(40)
    backs = [Camera.look_at(c.position, 2 * c.position, (0, 0, 1), 16, 12, 60) for c in cameras[:20]]
    asked = witnesses(5, [*cameras, *backs])
    assert len(set(asked)) == WITNESSES and max(asked) < 40 and 5 not in asked
    assert min(asked, key=lambda k: abs(k - 5)) in (4, 6) and max(asked) > 30
    assert sorted(witnesses(2, cameras[:12])) == [k for k in range(12) if k != 2]


def test_a_depth_is_searched_by_the_nearest_pictures_that_stand_far_enough_aside():
    cameras = eyes(300)  # 0.005 radians from one to the next, at a distance of 3
    found = neighbours(100, cameras, 3.0)
    apart = [np.linalg.norm(cameras[k].position - cameras[100].position) for k in found]
    assert min(apart) >= stereo.ASIDE * 3 and max(apart) < 1.2 * stereo.ASIDE * 3
    assert sorted(neighbours(1, cameras[:5], 3.0)) == [0, 2, 3, 4]  # there are no others


def test_the_cameras_that_cover_a_film_leave_no_gap():
    cameras = eyes(300)
    chosen = covering(cameras)
    assert len(chosen) == STEREO_FRAMES and (np.diff(chosen) > 0).all()
    assert np.abs(np.arange(300)[:, None] - chosen).min(axis=1).max() < 2 * 300 / STEREO_FRAMES
    assert covering(cameras[:9]).tolist() == list(range(9))
    resting_camera = [*[cameras[0]] * 200, *cameras[:100]]
    assert (covering(resting_camera) >= 200).sum() >= STEREO_FRAMES - 1  # a camera that waits adds nothing


@pytest.mark.slow
def test_the_depth_of_no_more_frames_than_cover_a_film_is_searched(monkeypatch):
    counts = []

    def counted(cameras, photos, radius, beside):
        counts.append((len(cameras), {photo.shape for photo in (*photos, *beside[1])}, len(beside[0])))
        return points_of(cameras, photos, radius, beside)

    monkeypatch.setattr(start, "points_of", counted)
    monkeypatch.setattr(start, "_confirmed", lambda found, *_: np.arange(50))
    for count in (300, 600):
        start.start_points(frames(count), 3.0, 1000, np.random.default_rng(0), pixels=8 * 6)
    assert [(chosen, sizes) for chosen, sizes, _ in counts] == [(STEREO_FRAMES, {(6, 8, 3)})] * 2
    assert max(beside for _, _, beside in counts) <= stereo.NEIGHBOURS * STEREO_FRAMES


def test_a_short_fit_searches_depths_of_fewer_pixels():
    assert stereo_pixels(None, 12) == STEREO_PIXELS // 12 and stereo_pixels(None, 900) == STEREO_PIXELS // STEREO_FRAMES
    assert stereo_pixels(1e6, 12) == stereo_pixels(None, 12) and stereo_pixels(20, 900) * 3 == stereo_pixels(60, 900)


def test_the_sketch_of_a_long_film_has_few_small_frames_from_its_first_time_to_its_last():
    shots = frames(200, 320, 240)
    small = sketched(shots)
    assert len(small) == MOST_TIMES and small[0].time == shots[0].time and small[-1].time == shots[-1].time
    assert all(s.photo.shape[0] * s.photo.shape[1] <= MOST_PIXELS for s in small)
    short = frames(5)
    assert all(a is b for a, b in zip(sketched(short), short, strict=True))
    pairs = [Shot(s.camera, s.photo, s.time) for s in frames(100) for _ in range(2)]  # two cameras
    assert len(sketched(pairs)) == 2 * MOST_TIMES


def test_a_reduced_frame_shows_the_same_places_by_the_means_of_its_pixels():
    (shot, *_) = frames(3, 64, 48)
    small = reduced(shot, 32 * 24)
    assert small.photo.shape == (24, 32, 3) and small.time == shot.time
    means = shot.photo.reshape(24, 2, 32, 2, 3).mean(axis=(1, 3))
    assert np.abs(small.photo - means).max() <= 1  # rounded
    points = np.array([[0.3, 0.2, 0.1], [-0.2, 0.1, 0.4]])
    assert np.allclose(small.camera.project(points)[0] * 2, shot.camera.project(points)[0])


def test_a_path_of_the_sketch_has_poses_at_the_times_of_all_frames():
    some, times = np.array([0.0, 1.0, 2.0, 4.0]), np.linspace(0, 4, 17)
    body = Body.at_rest(np.ones(3), 4)
    for t in (2, 3):
        body.quats[t] = turned(body.quats[t - 1], np.array([0.0, 0.0, 0.6]))
        body.offsets[t] = body.offsets[t - 1] + [0.4, 0.0, 0.0]
    found = at_all_times(body, some, times)
    known = np.searchsorted(times, some)
    assert np.allclose(found.quats[known], body.quats) and np.allclose(found.offsets[known], body.offsets)
    assert found.runs[0] == (0, 5) and found.offsets[14, 0] == pytest.approx(0.7)  # at rest until 1 s; 3.5 s
    line = Line("hinge", np.array([0, 0, 1.0]), np.zeros(3), np.array([0, 0, 0.5, 1.5]))
    on = at_all_times(body.on(line), some, times)
    assert np.allclose(on.line.values, np.interp(times, some, line.values)) and len(on.quats) == 17
    assert at_all_times(body, some, some) is body


def test_the_start_of_cameras_that_stand_takes_first_frames_as_they_are_and_changes_in_reduced_ones(monkeypatch):
    cameras, rng = eyes(3, 320, 240), np.random.default_rng(0)
    moving = np.zeros((240, 320), bool)
    moving[60:120, 80:200] = True
    shots = []
    for k in range(70):
        for camera in cameras if k % 2 else cameras[::-1]:
            photo = np.full((240, 320, 3), 100, np.uint8)
            photo[moving] = 200 if k else 90
            shots.append(Shot(camera, photo, 0.1 * k))
    order = [shots[k] for k in rng.permutation(len(shots))]
    told = []
    monkeypatch.setattr(fitting, "start_cloud", lambda first, *more: told.append((first, more[-1])))
    film = fitting._Film(
        Photos(tuple(order), (), none(), 3.0), Settings(steps=10, degree=0), "rigid", lambda status: None
    )
    _ = film._start
    ((first, masks),) = told
    assert [shot.time for shot in first] == [0.0] * 3 and {shot.photo.shape for shot in first} == {(240, 320, 3)}
    assert len({shot.camera.position.tobytes() for shot in first}) == 3
    for mask in masks:
        assert mask.size <= MOST_PIXELS and mask.mean() == pytest.approx(moving.mean(), abs=0.01)


# --- shares of the time ------------------------------------------------------------------------------------------


def test_a_phase_ends_when_its_share_is_gone_and_a_fit_in_steps_has_no_limits():
    clock = Clock()
    budget, steps = Budget(20.0, clock), Budget(None, clock)
    clock.now = 7.9
    budget.check(0.4)
    assert budget.left(0.5) == pytest.approx(2.1) and budget.left(0.3) == pytest.approx(20 * LEAST)
    clock.now = 8.1
    with pytest.raises(OutOfTime):
        budget.check(0.4)
    clock.now = 1e9
    steps.check(0.4)
    assert steps.left(0.4) is None


def cloud(count: int = 60) -> GaussianCloud:
    means = torch.from_numpy(np.random.default_rng(1).uniform(-0.5, 0.5, (count, 3)).astype(np.float32))
    return GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 0.1), torch.full((count,), 0.6),
        color_to_dc(torch.full((count, 3), 0.5))[:, None],
    )  # fmt: skip


@pytest.mark.parametrize(("before", "share"), [(0.0, LASTING_UNTIL), (0.5, LEAST)])
def test_what_is_there_for_most_of_the_time_is_trained_for_its_share(before, share):
    clock, told = Clock(), []

    def tell(loss: float, gaussians: int) -> None:
        told.append(loss)
        clock.now += 1.0

    budget = Budget(100.0, clock)
    clock.now = 100 * before  # the stereo before it took that long
    agreement.lasting(frames(6), cloud(), 3.0, None, np.random.default_rng(0), budget, tell)
    assert len(told) == round(100 * share)


def ends_of(limit: float) -> tuple[Callable[[], resting.Resting], list[int]]:
    """The search of the ends of a film that has time for so many steps, and the steps that it took."""
    shots, told = frames(12), []

    def tell(loss: float, gaussians: int) -> None:
        told.append(1)
        if len(told) > limit:
            raise OutOfTime

    training = agreement.lasting(
        shots, cloud(), 3.0, 40, np.random.default_rng(0), Budget(None), lambda loss, gaussians: None
    )
    footage = Footage.of(shots, [s.time for s in shots])
    return Ends(training, footage, 3.0, np.random.default_rng(0), tell).best, told


def test_the_search_of_the_ends_stops_when_there_is_no_time(monkeypatch):
    best, told = ends_of(3)
    with pytest.raises(OutOfTime):
        best()
    assert len(told) == 4
    best, _ = ends_of(1e9)  # 8 steps: 4 for each end
    monkeypatch.setattr(resting, "until", lambda shown, core: core + 2)  # both ends rest, so that more is trained
    best, told = ends_of(9)
    assert best().beyond == 2 and len(told) == 10  # what was found before is kept


@pytest.mark.slow
def test_a_search_whose_time_is_gone_gives_up_and_says_so(swinging):
    columns, _, _, footage = swinging
    clock, parameters = Clock(), Parameters.of(as_cloud(columns))
    late = Finder(footage, 0, np.random.default_rng(0), Budget(100.0, clock), lambda: None)
    clock.now = 61.0
    labelled, bodies, tried = late.find(parameters)
    assert late.cut and bodies == [] and tried == 0 and not labelled.labels.any()
    whole = Finder(footage, 0, np.random.default_rng(0), Budget(None), lambda: None)
    _, bodies, _ = whole.find(parameters)
    assert not whole.cut and len(bodies) == 1


def test_a_path_that_was_found_in_time_is_kept_though_none_is_left_to_improve_it(swinging, monkeypatch):
    columns, labels, _, footage = swinging
    clock = Clock()
    finder = Finder(footage, 0, np.random.default_rng(0), Budget(100.0, clock), lambda: None)
    sort_out = finder._sort_out

    def slow(*arguments) -> None:
        sort_out(*arguments)
        clock.now = 71.0

    monkeypatch.setattr(finder, "_sort_out", slow)
    labelled, bodies, _ = finder.find(Parameters.of(as_cloud(columns)))
    assert finder.cut and len(bodies) == 1 and (labelled.labels[labels == 1] == 1).mean() > 0.5


def as_cloud(columns) -> GaussianCloud:
    return GaussianCloud.create(*(torch.from_numpy(c.copy()) for c in columns))
