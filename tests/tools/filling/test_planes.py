"""Which flat surfaces around a thing are its last ones, behind which nothing lies."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from scenewright.tools.filling.planes import planes_near

F64 = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])


def _level(height: float, step: float = 0.06) -> F64:
    """A level square of 4 by 4, `[M, 3]`."""
    x, y = np.meshgrid(np.arange(-2, 2, step), np.arange(-2, 2, step))
    return np.stack([x.ravel(), y.ravel(), np.full(x.size, height)], axis=1)


@pytest.fixture(scope="module")
def thing() -> F64:
    return np.random.default_rng(0).uniform([-1, -0.5, 0.1], [1, 0.5, 0.9], (600, 3))


def test_a_sheet_above_a_thing_is_its_last_surface_unless_photographs_look_at_it_from_behind(thing: F64) -> None:
    sheet = _level(1.0)
    below, above = np.tile([0.0, 3.0, 0.5], (6, 1)), np.tile([0.0, 3.0, 2.0], (6, 1))
    assert [p.last for p in planes_near(sheet, thing, UP, below)] == [True]
    assert not planes_near(sheet, thing, UP, above)  # nothing stands on what faces down


def test_clutter_over_a_floor_is_no_floor(thing: F64) -> None:
    around = np.random.default_rng(1).uniform([-2, -2, 0.07], [2, 2, 0.22], (400, 3))
    floors = planes_near(np.concatenate([_level(0.0), around]), thing, UP)
    assert [round(float(p.origin[2]), 2) for p in floors if p.last] == [0.0]
