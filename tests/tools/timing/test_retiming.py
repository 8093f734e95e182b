"""Motion at other times: what goes on for ever stops where it is told to."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.motion.motion import Look, Track
from scenewright.tools.timing.retiming import Warp, angles_at, playing, shown


@given(stop=st.floats(0.05, 8.0), begins=st.floats(0.0, 4.0), rate=st.floats(-2.0, 2.0).filter(lambda r: abs(r) > 0.05))
def test_what_turns_for_ever_stops_at_any_time(stop: float, begins: float, rate: float) -> None:
    track = Track.spin(np.arange(3), rate, (0, 0, 1), (0, 0, 0), start=begins)
    stopped = playing(track, Warp((stop,), (stop,), after=0.0))
    times = np.linspace(0, 10, 41)
    wanted = angles_at(track, np.minimum(times, stop))
    found = angles_at(stopped, times)
    assert found == pytest.approx(wanted, abs=1e-6 + 2 * math.pi * abs(rate) * 1e-6)
    assert stopped.kind == "hinge"


@pytest.mark.parametrize(
    ("warp", "spans"),
    [
        (Warp((0.0,), (0.0,), 1.0, 2.0), [(0.5, 1.0)]),  # twice as fast
        (Warp((0.0, 4.0), (4.0, 0.0), 0.0, 0.0), [(2.0, 3.0)]),  # backwards
        (Warp((0.0, 4.0, 4.001, 8.001), (0.0, 4.0, 0.0, 4.0), 0.0, 0.0), [(1.0, 2.0), (5.001, 6.001)]),  # twice
        (Warp((0.0,), (2.0,), 0.0, 1.0), []),  # only the rest of it
        (Warp((0.0,), (1.5,), 0.0, 0.0), [(-math.inf, math.inf)]),  # it stands still there
    ],
)
def test_looks_follow_what_is_played(warp: Warp, spans: list[tuple[float, float]]) -> None:
    look = Look(np.arange(2), 1.0, 2.0, opacities=torch.full((2,), 0.5))
    found = [(told.start, told.stop) for told in shown([look], warp)]
    assert len(found) == len(spans) and all(a == pytest.approx(b) for a, b in zip(found, spans, strict=True))
