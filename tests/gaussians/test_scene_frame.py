"""Laws of the frame: a level right-handed basis for any up, and heights that agree with it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Frame, Scene

component = st.floats(-10, 10).map(lambda v: round(v, 3))
ups = st.tuples(component, component, component).filter(lambda v: any(abs(c) > 1e-2 for c in v))


@given(ups, ups)
def test_basis_is_level_right_handed_and_agrees_with_heights(up: Any, point: Any) -> None:
    frame = Frame(up)
    basis = frame.basis()
    assert np.allclose(basis @ basis.T, np.eye(3), atol=1e-12) and np.linalg.det(basis) > 0
    assert np.allclose(basis[2], np.array(up) / np.linalg.norm(up))
    heights = frame.heights(np.array([point]))
    assert np.allclose(heights, (basis @ np.array(point))[2])
    assert frame.heights(np.array([point], dtype=np.float32)).dtype == np.float32


def test_basis_of_a_room_of_ours_is_the_identity() -> None:
    assert np.array_equal(Frame().basis(), np.eye(3))


@pytest.mark.parametrize(
    "wrong",
    [
        {"up": (0, 0, 0)},
        {"up": (math.nan, 0, 1)},
        {"up": (math.inf, 0, 0)},
        {"floor": math.nan},
        {"metres_per_unit": 0},
        {"metres_per_unit": -1},
        {"metres_per_unit": math.inf},
        {"metres_per_unit": math.nan},
    ],
)
def test_impossible_frames_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError, match="Frame"):
        Frame(**wrong)


def test_a_changed_scene_shares_what_did_not_change() -> None:
    scene = Scene(GaussianCloud.empty())
    moved = scene.replace(frame=Frame(floor=1.0))
    assert moved.cloud is scene.cloud and scene.frame.floor is None and moved.frame.floor == 1.0
