"""Fitting scenes with time: gradients of poses, tracks of few keys, bad input, and the whole on a small film."""

import json

import numpy as np
import pytest

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.motion import keys
from scenewright.gaussians.motion.fitting.bodies import Body, moved, pose_gradient, turned
from scenewright.gaussians.motion.fitting.footage import Footage
from scenewright.gaussians.motion.fitting.simplify import track_of

TIMES = np.linspace(0, 4, 21)
IDS = np.arange(10)


def camera(x: float = 0.0) -> Camera:
    return Camera.look_at((x, -3.0, 1.0), (0, 0, 0), (0, 0, 1), 16, 12)


def shot(x: float, value: int = 100) -> Shot:
    """A gray frame with a square of another gray."""
    photo = np.full((12, 16, 3), 100, np.uint8)
    photo[3:8, 4:9] = value
    return Shot(camera(x), photo)


def test_the_gradient_of_a_pose_is_that_of_finite_differences():
    rng = np.random.default_rng(0)
    means, quats = rng.normal(size=(7, 3)).astype(np.float32), rng.normal(size=(7, 4)).astype(np.float32)
    pivot, turn, offset = rng.normal(size=3), turned(np.array([1.0, 0, 0, 0]), rng.normal(size=3)), rng.normal(size=3)
    by_means, by_quats = rng.normal(size=(7, 3)).astype(np.float32), rng.normal(size=(7, 4)).astype(np.float32)

    def value(vector, shift):
        at, q = moved(means.astype(np.float64), quats.astype(np.float64), pivot, turned(turn, vector), offset + shift)
        return float((at * by_means).sum() + (q * by_quats).sum())

    at, q = moved(means, quats, pivot, turn, offset)
    by_turn, by_shift = pose_gradient(at, q, pivot + offset, by_means, by_quats)
    step = 1e-2  # `moved` returns float32
    for k in range(3):
        e = np.eye(3)[k] * step
        assert (value(e, 0) - value(-e, 0)) / (2 * step) == pytest.approx(by_turn[k], abs=2e-3)
        assert (value(0, e) - value(0, -e)) / (2 * step) == pytest.approx(by_shift[k], abs=2e-3)


def hinged(angles: np.ndarray, noise: float = 0.0) -> Body:
    """A body that turns about the vertical through (1, 0, 0)."""
    rng, line = np.random.default_rng(1), np.array([1.0, 0.0, 0.0])
    quats = keys.about(np.array([0.0, 0.0, 1.0]), angles)
    offsets = line - keys.matrices(quats) @ line
    offsets[1:] += noise * rng.normal(size=(len(angles) - 1, 3))
    return Body(np.zeros(3), quats, offsets)


def test_a_door_becomes_a_hinge_of_few_keys():
    angles = np.radians(80) * np.clip(TIMES - 1, 0, 1)
    found = track_of(hinged(angles, 0.002), IDS, TIMES, 0.5, 0.02, "door")
    assert found.kind == "hinge" and len(found.times) <= 5
    assert abs(found.axis[2]) > 0.99 and np.hypot(found.pivot[0] - 1, found.pivot[1]) < 0.02


def test_a_drawer_becomes_a_slide_and_a_thrown_thing_stays_rigid():
    out = np.zeros((21, 3))
    out[:, 1] = -0.3 * np.clip(TIMES - 1, 0, 1)
    still = np.tile([1.0, 0, 0, 0], (21, 1))
    slide = track_of(Body(np.zeros(3), still, out), IDS, TIMES, 0.3, 0.01, "drawer")
    assert slide.kind == "slide" and np.allclose(slide.axis, (0, -1, 0), atol=1e-6) and len(slide.times) <= 5
    out[:, 2] = -0.4 * np.clip(TIMES - 1, 0, 1) ** 2
    assert track_of(Body(np.zeros(3), still, out), IDS, TIMES, 0.3, 0.01, "ball").kind == "rigid"


def test_a_body_that_hardly_moves_has_no_track():
    assert track_of(hinged(np.full(21, 0.004)), IDS, TIMES, 0.5, 0.02, "wall") is None


def test_footage_sorts_frames_by_camera_and_time():
    footage = Footage.of([shot(0.0), shot(1.0), shot(0.0, 200), shot(1.0, 100)], [0.0, 0.0, 0.5, 0.5])
    assert footage.stands and len(footage.cameras) == 2 and footage.times.tolist() == [0.0, 0.5]
    assert footage.changed(2, 0)[4:7, 5:8].all() and footage.changed(2, 0).sum() <= 25
    assert not footage.changed(3, 1).any()
    assert not Footage.of([shot(0.0), shot(0.1), shot(0.2)], [0.0, 0.5, 1.0]).stands


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        ([0.0, None], "no finite time"),
        ([0.0, float("nan")], "no finite time"),
        ([1.0, 1.0], "two or more different times"),
    ],
)
def test_frames_without_sound_times_are_refused(seconds, said):
    with pytest.raises(UserError, match=said):
        Footage.of([shot(0.0), shot(1.0)], seconds)


def test_a_capture_gives_every_frame_its_time_or_none(tmp_path):
    pose = np.linalg.inv(camera().world_to_camera) * [1, -1, -1, 1]
    common = {"transform_matrix": pose.tolist(), "fl_x": 12.0, "w": 16, "h": 12}

    def read(*times):
        frames = [{**common, "file_path": f"{k}.png"} | ({} if t is None else {"time": t}) for k, t in enumerate(times)]
        (tmp_path / "transforms.json").write_text(json.dumps({"frames": frames}))
        return read_capture(tmp_path)

    assert read(0.0, 0.5).times == (0.0, 0.5) and read(None, None).times is None
    with pytest.raises(FileError, match="frame 1 has no time, and 1 other"):
        read(0.0, None)
    with pytest.raises(FileError, match="frame 1 has the time nan; give a finite"):
        read(0.0, float("nan"))
    with pytest.raises(FileError, match="frame 0 is invalid: time must be a number"):
        read("soon", 1.0)


@pytest.mark.slow
def test_a_rolling_ball_is_found_and_followed():
    from scenewright.benchmarks._motion import films
    from scenewright.gaussians.files.captures import colmap
    from scenewright.gaussians.fit import Photos, Settings
    from scenewright.gaussians.motion.fitting.fit import fit_film
    from scenewright.gaussians.motion.motion import poses

    film = films.film("ball", "12", (128, 96), fps=4)
    shots = tuple(Shot(f.camera, f.photo, f.time) for f in film.frames)
    none = colmap.Points(np.zeros((0, 3)), np.zeros((0, 3)))
    held = tuple(Shot(f.camera, f.photo, f.time) for f in film.held_out[::4])
    done = fit_film(Photos(shots, held, none, 3.6), Settings(steps=900, degree=0))
    assert done.quality.psnr > 28  # dB
    (track,) = done.scene.motion.tracks
    middle = films.middles(film.scene, film.times)[0]
    turns, shifts = poses(track, film.times)
    away = np.linalg.norm(turns @ middle[0] + shifts - middle, axis=1)
    assert away.mean() < 0.1 and len(track.times) < len(film.times)  # metres; the ball goes 4.3 m
