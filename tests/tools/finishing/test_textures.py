"""Textures: every material has one, its seed determines it, its unit repeats at its length, a blur takes detail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenewright.gaussians.color import parse
from scenewright.gaussians.world.finishes import FINISHES, FinishName, said, words
from scenewright.tools.finishing.noise import F32, cellular, fractal, gradient_noise
from scenewright.tools.finishing.textures import TEXTURES, Look, Spots, pigment

BRICK = Look(parse("#9c4a36"), parse("#b9b0a3"), 0.225, 0)


def wall(across: F32, up: F32, blur: float = 1e-4) -> Spots:
    """Spots on a wall that faces the viewer."""
    xyz = np.stack([across, np.zeros_like(across), up], axis=1)
    normal = np.tile(np.array([0, 1, 0], np.float32), (len(across), 1))
    return Spots(xyz, np.stack([across, up], axis=1), normal, np.full(len(across), blur, np.float32), 0)


def scattered(count: int = 4000, blur: float = 1e-4) -> Spots:
    points = np.random.default_rng(0).uniform(0, 4, (count, 2)).astype(np.float32)
    return wall(points[:, 0], points[:, 1], blur)


def look_of(name: FinishName) -> Look:
    finish = FINISHES[name]
    color = parse(finish.color or "#3f6d9c")
    return Look(color, parse(finish.second) if finish.second else (0.9, 0.9, 0.9), finish.unit, 3)


def test_every_finish_has_a_texture_and_every_texture_a_finish() -> None:
    assert TEXTURES.keys() == FINISHES.keys()


@pytest.mark.parametrize("name", FINISHES)
def test_pigments_are_colours_and_the_same_every_time(name: FinishName) -> None:
    spots, look = scattered(500), look_of(name)
    found = pigment(name, look, spots)
    assert found.shape == (500, 3)
    assert found.dtype == np.float32
    assert np.isfinite(found).all()
    assert (found >= 0).all()
    assert (found <= 1).all()
    assert np.array_equal(found, pigment(name, look, spots))


@pytest.mark.parametrize("name", FINISHES)
def test_a_wide_blur_shows_one_colour_that_is_the_mean(name: FinishName) -> None:
    sharp, blurred = (pigment(name, look_of(name), scattered(blur=b)) for b in (1e-4, 3.0))
    assert blurred.std(axis=0).max() < 0.03
    assert np.abs(blurred.mean(axis=0) - sharp.mean(axis=0)).max() < 0.06


@pytest.mark.parametrize(("name", "unit"), [("brick", 0.225), ("brick", 0.3), ("tiles", 0.2), ("tiles", 0.45)])
def test_the_unit_repeats_at_its_length(name: FinishName, unit: float) -> None:
    """Joints along a row of spots are a unit apart, within 5 %."""
    across = np.linspace(0, 12, 24_000, dtype=np.float32)
    look = replace(look_of(name), unit=unit)
    row = pigment(name, look, wall(across, np.full_like(across, unit / 6)))
    joint = np.linalg.norm(row - np.array(look.second), axis=1) < np.linalg.norm(row - np.array(look.color), axis=1) / 2
    begins = across[1:][joint[1:] & ~joint[:-1]]
    assert len(begins) >= 10 / unit
    assert np.median(np.diff(begins)) == pytest.approx(unit, rel=0.05)


def test_a_course_of_bricks_is_shifted_by_half_a_brick() -> None:
    height = BRICK.unit / 3
    across = np.linspace(0, 4.5, 2000, dtype=np.float32)
    rows = [pigment("brick", BRICK, wall(across, np.full_like(across, (k + 0.5) * height))) for k in (0, 1)]
    joints = [np.linalg.norm(row - np.array(BRICK.second), axis=1) < 0.12 for row in rows]
    places = [np.unwrap(2 * np.pi * across[joint] / BRICK.unit) for joint in joints]
    phase = [np.angle(np.exp(1j * 2 * np.pi * across[joint] / BRICK.unit).mean()) for joint in joints]
    assert min(len(p) for p in places) > 20
    assert abs(np.angle(np.exp(1j * (phase[0] - phase[1])))) == pytest.approx(np.pi, abs=0.3)


def test_noise_is_smooth_seeded_and_centred() -> None:
    points = np.random.default_rng(1).uniform(-50, 50, (20_000, 3)).astype(np.float32)
    found = gradient_noise(points, 7)
    assert np.array_equal(found, gradient_noise(points, 7))
    assert not np.array_equal(found, gradient_noise(points, 8))
    assert abs(float(found.mean())) < 0.02
    near = gradient_noise(points + np.float32(1e-3), 7)
    assert np.abs(near - found).max() < 0.02
    cells = cellular(points, 2.0, 7)
    assert (cells.edge >= 0).all()
    assert (cells.chance >= 0).all() and (cells.chance < 1).all()
    assert np.abs(fractal(points, 1.0, np.full(len(points), 40.0, np.float32), 7)).max() < 1e-3


def test_every_word_names_a_finish_and_its_colour_can_be_read() -> None:
    for word, meant in words().items():
        assert word == " ".join(word.lower().split())
        assert meant.finish in FINISHES
        if meant.color:
            parse(meant.color)
    assert said("  Exposed   Brick ") == said("brick")
    assert said("cheese") is None
