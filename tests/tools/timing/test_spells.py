"""From when to when something moves, each time and each way."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.motion.motion import Track
from scenewright.tools.timing.retiming import movement, spells

IDS = np.array([1, 2, 3])


def slide(times: list[float], places: list[float]) -> Track:
    return Track.slide(IDS, times, places, (1, 0, 0))


@pytest.mark.parametrize(
    ("track", "expected"),
    [
        (slide([1, 2], [0, 1]), [(1, 2)]),
        (slide([1, 2, 3.5, 4.5], [0, 0.3, 0.3, 0]), [(1, 2), (3.5, 4.5)]),  # out, a rest, and back
        (slide([1, 2, 3], [0, 0.3, 0]), [(1, 2), (2, 3)]),  # it turns back without a rest
        (slide([0, 1, 2, 3], [0, 0.1, 0.3, 0.7]), [(0, 3)]),
        (slide([0, 1], [0, 0]), []),
        (Track.hinge(IDS, [1, 2, 3], [0, 1.4, 0], (0, 0, 1), (0, 0, 0)), [(1, 2), (2, 3)]),
        (Track.spin(IDS, 1.0, (0, 0, 1), (0, 0, 0)), [(0, 5)]),
    ],
)
def test_spells_are_told_apart(track: Track, expected: list[tuple[float, float]]) -> None:
    assert spells([track], 0.0, 5.0) == expected


def test_spells_of_several_tracks_are_those_of_one_thing() -> None:
    one, other = slide([1, 2], [0, 1]), slide([1.5, 3], [0, 1])
    assert spells([one, other], 0.0, 5.0) == [(1, 3)]
    assert spells([one, slide([2, 3], [0, 1])], 0.0, 5.0) == [(1, 2), (2, 3)]  # what only meets is two


@given(
    steps=st.lists(st.tuples(st.floats(0.1, 1.0), st.floats(-0.5, 0.5)), min_size=1, max_size=6),
)
def test_a_movement_is_from_the_first_spell_to_the_last(steps: list[tuple[float, float]]) -> None:
    times = np.cumsum([0.0, *(wait for wait, _ in steps)])
    places = np.cumsum([0.0, *(far for _, far in steps)])
    track = slide(list(times), list(places))
    found, whole = spells([track], 0.0, float(times[-1])), movement([track], 0.0, float(times[-1]))
    assert (whole is None) == (not found)
    if whole is not None:
        assert whole == (found[0][0], found[-1][1])
    assert all(a < b for a, b in found) and all(b <= c for (_, b), (c, _) in pairwise(found))
