"""The smooth solve and the copied texture on grids whose continuation is known."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.tools.filling.smooth import averaged, harmonic
from scenewright.tools.filling.texture import continued, moved

HOLE = np.zeros((40, 50), bool)
HOLE[12:26, 15:32] = True


def test_a_linear_function_is_continued_exactly() -> None:
    """Linear functions solve Laplace's equation."""
    y, x = np.mgrid[:40, :50].astype(float)
    values = np.stack([x, y, 2 * x - y], axis=2)
    found = harmonic(np.where(HOLE[..., None], -7.0, values), ~HOLE, HOLE)
    np.testing.assert_allclose(found, values, atol=1e-9)


def test_the_solution_keeps_the_maximum_principle_and_known_cells() -> None:
    values = np.random.default_rng(0).random((40, 50, 1))
    found = harmonic(values, ~HOLE, HOLE)
    assert (found[~HOLE] == values[~HOLE]).all()
    assert values[~HOLE].min() <= found[HOLE].min() and found[HOLE].max() <= values[~HOLE].max()


def test_an_area_that_touches_nothing_known_takes_the_mean() -> None:
    known = np.zeros((10, 10), bool)
    known[0, :2] = True
    unknown = np.zeros((10, 10), bool)
    unknown[5:8, 5:8] = True
    values = np.zeros((10, 10, 1))
    values[0, 1] = 1.0
    assert (harmonic(values, known, unknown)[unknown] == 0.5).all()


def test_averages_do_not_read_cells_without_weight() -> None:
    values, weight = np.ones((20, 20, 1)), np.ones((20, 20))
    values[5], weight[5] = 1e6, 0.0
    np.testing.assert_allclose(averaged(values, weight, 2.0), 1.0)


@pytest.mark.parametrize("shift", [(0, 0), (3, -4), (-50, 2), (2, 60)])
def test_a_shifted_picture_reads_its_source(shift: tuple[int, int]) -> None:
    dy, dx = shift
    values = np.arange(40 * 50).reshape(40, 50) + 1
    found = moved(values, dy, dx)
    for y in range(40):
        for x in range(50):
            inside = 0 <= y + dy < 40 and 0 <= x + dx < 50
            assert found[y, x] == (values[y + dy, x + dx] if inside else 0)


@pytest.mark.parametrize("period", [7, 10])
def test_tiles_keep_their_period_and_phase(period: int) -> None:
    """A chequered floor is continued so that every tile is where it belongs."""
    y, x = np.mgrid[:96, :96]
    tiles = 0.35 + 0.3 * (((x // period) + (y // period)) % 2)
    picture = np.repeat(tiles[..., None], 3, axis=2).astype(float)
    hole = np.zeros((96, 96), bool)
    hole[38:60, 36:62] = True
    found = continued(np.where(hole[..., None], 0.0, picture), ~hole, hole)
    wrong = np.abs(found.picture - picture)[hole]
    assert np.sqrt((wrong**2).mean()) < 0.05  # the mean alone would be wrong by 0.15
    assert (found.picture[~hole] == picture[~hole]).all()


def test_shading_goes_on_below_a_texture() -> None:
    """Stripes under a ramp of light: the stripes are copied, the ramp is solved for."""
    y, x = np.mgrid[:80, :80].astype(float)
    ramp = 0.3 + 0.4 * x / 80
    picture = np.repeat((ramp + 0.05 * np.sign(np.sin(2 * np.pi * y / 8)))[..., None], 3, axis=2)
    hole = np.zeros((80, 80), bool)
    hole[30:50, 30:50] = True
    found = continued(picture, ~hole, hole)
    assert np.sqrt(((found.picture - picture)[hole] ** 2).mean()) < 0.03
