"""Places that an edit leaves open are outlined in the picture after it, and nothing else is drawn."""

from __future__ import annotations

import numpy as np

from scenewright.agent.pictures.unfilled import OUTLINE, with_unfilled
from scenewright.gaussians.camera import Camera
from scenewright.tools.receipt import Filled, Vec3

CAMERA = Camera.look_at([0, -4, 1], [0, 0, 0], [0, 0, 1], 160, 120)
GREY = np.full((120, 160, 3), 90, np.uint8)


def _left(place: tuple[Vec3, Vec3] | None) -> Filled:
    return Filled(
        surface="the wall", gaussians=0, area=1.0, sure=0.0, reason="" if place is None else "no", place=place
    )


def test_a_picture_without_such_places_stays_bit_for_bit() -> None:
    assert with_unfilled(GREY, CAMERA, [_left(None)]) is GREY


def test_a_place_is_outlined_where_it_is_and_dashed() -> None:
    drawn = with_unfilled(GREY, CAMERA, [_left(((-0.5, -0.2, -0.4), (0.5, 0.2, 0.4)))])
    changed = (drawn != GREY).any(axis=2)
    ys, xs = np.nonzero(changed)
    assert 55 < xs.min() < 75 and 85 < xs.max() < 105 and ys.min() > 30 and ys.max() < 100
    assert 0.005 < changed.mean() < 0.1, "thin"
    assert (drawn == OUTLINE).all(axis=2).any() and (GREY == 90).all()
    front = drawn[ys.max() - 1 : ys.max() + 1].reshape(2, 160, 3)
    row = (front != 90).any(axis=(0, 2))[xs.min() : xs.max()]
    assert 0.2 < row.mean() < 0.95, "dashes and gaps"


def test_a_place_behind_the_eye_is_not_drawn() -> None:
    assert (with_unfilled(GREY, CAMERA, [_left(((-0.5, -9.0, 0.0), (0.5, -8.0, 1.0)))]) == GREY).all()
