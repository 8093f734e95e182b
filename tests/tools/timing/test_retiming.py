"""Motion at other times: what goes on for ever stops where it is told to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.motion.motion import Track
from scenewright.tools.timing.retiming import Warp, angles_at, playing


@given(stop=st.floats(0.05, 8.0), begins=st.floats(0.0, 4.0), rate=st.floats(-2.0, 2.0).filter(lambda r: abs(r) > 0.05))
def test_what_turns_for_ever_stops_at_any_time(stop: float, begins: float, rate: float) -> None:
    track = Track.spin(np.arange(3), rate, (0, 0, 1), (0, 0, 0), start=begins)
    stopped = playing(track, Warp((stop,), (stop,), after=0.0))
    times = np.linspace(0, 10, 41)
    wanted = angles_at(track, np.minimum(times, stop))
    found = angles_at(stopped, times)
    assert found == pytest.approx(wanted, abs=1e-6 + 2 * math.pi * abs(rate) * 1e-6)
    assert stopped.kind == "hinge"
