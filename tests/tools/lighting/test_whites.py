"""White points: the locus, adaptation and its measurement."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.tools.lighting.whites import (
    NEUTRAL,
    balance,
    kelvin_of,
    planckian,
    to_display,
    to_linear,
    warmer_by,
    white,
)


def test_the_transfer_function_and_its_inverse() -> None:
    display = np.linspace(-0.2, 1.5, 200)
    assert np.allclose(to_display(to_linear(display)), display, atol=1e-9)
    assert to_linear(np.array(1.0)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("kelvin", "x", "y"),
    # Black bodies computed from Planck's law with the CIE 1931 observer (Wyszecki and Stiles 1982, table 1(3.11)).
    [(2000, 0.5267, 0.4133), (2856, 0.4476, 0.4074), (4000, 0.3805, 0.3768), (6500, 0.3135, 0.3237)],
)
def test_the_locus_goes_through_known_black_bodies(kelvin: float, x: float, y: float) -> None:
    assert planckian(kelvin) == pytest.approx((x, y), abs=2e-3)  # Kim et al. give errors below 0.001


def test_neutral_changes_nothing() -> None:
    assert np.array_equal(balance(NEUTRAL, NEUTRAL), np.eye(3))
    assert white(NEUTRAL) == pytest.approx(np.ones(3))


@pytest.mark.parametrize("kelvin", [1700, 2000, 2700, 3200, 4500, 9000, 15_000, 20_000])
def test_white_becomes_what_is_asked(kelvin: float) -> None:
    shown = balance(NEUTRAL, kelvin) @ np.ones(3)
    assert kelvin_of(shown) == pytest.approx(kelvin, rel=0.015)
    assert to_linear(shown) @ np.array([0.2126, 0.7152, 0.0722]) == pytest.approx(1.0, abs=0.01)  # as bright as before


@pytest.mark.parametrize(("old", "new"), [(6500, 3000), (5000, 8000), (3000, 6500)])
def test_there_and_back_is_nothing(old: float, new: float) -> None:
    assert balance(new, old) @ balance(old, new) == pytest.approx(np.eye(3), abs=1e-9)


def test_black_stays_black_and_mireds_add() -> None:
    assert balance(6500, 2700) @ np.zeros(3) == pytest.approx(np.zeros(3))
    assert warmer_by(warmer_by(6500, 30), 40) == pytest.approx(warmer_by(6500, 70))
