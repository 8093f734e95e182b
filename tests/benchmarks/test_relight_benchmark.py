"""What `bench relight` measures with: temperatures of known lights, and light that was not changed."""

from __future__ import annotations

import pytest
import torch

from scenewright.benchmarks import relight


def test_white_of_the_display_is_daylight() -> None:
    assert relight._temperature(torch.ones(3, dtype=torch.float64)) == pytest.approx(6504, rel=0.005)


def test_a_wall_shows_the_light_that_falls_on_it() -> None:
    warm, neutral = (relight._temperature(relight._grey(k)) for k in (3000.0, 6504.0))
    assert warm == pytest.approx(3000, rel=0.05) and neutral == pytest.approx(6504, rel=0.02)
