"""Estimated up and floor of rotated rooms, against the rotation that was applied."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import torch
from amounts import spread
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.segmentation.orient import estimate_frame
from scenewright.gaussians.language.segmentation.surface import surface_of
from scenewright.gaussians.scene import Frame

F64 = NDArray[np.float64]
WITHIN = 2.0  # degrees: a table looks level to the eye at this tilt
GRAY, WHITE, BROWN, RED = (0.6, 0.6, 0.6), (0.9, 0.9, 0.88), (0.45, 0.3, 0.16), (0.78, 0.13, 0.12)


def turned(axis: tuple[float, float, float], degrees: float) -> F64:
    """Rotation about an axis (Rodrigues)."""
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    r = math.radians(degrees)
    return np.eye(3) + math.sin(r) * cross + (1 - math.cos(r)) * cross @ cross


def off(one: F64, other: F64) -> float:
    return math.degrees(math.acos(min(1.0, float(one @ other) / float(np.linalg.norm(one) * np.linalg.norm(other)))))


def room(world: type[Any]) -> Any:
    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.06)
    made.sheet("wall", (-2, 1.5, 0), (4, 0, 0), (0, 0, 2.2), WHITE, 0.07)
    made.sheet("side", (-2, -1.5, 0), (0, 3, 0), (0, 0, 2.2), WHITE, 0.07)
    made.box("table", (-0.6, -0.4, 0.7), (0.6, 0.4, 0.75), RED).box("crate", (1, 0.5, 0), (1.5, 1.0, 0.5), GRAY)
    return made


def frame_of(cloud: GaussianCloud, cameras: tuple[Camera, ...] = (), known: Frame | None = None) -> Frame:
    return estimate_frame(surface_of(cloud), cameras, known or Frame())


@pytest.mark.parametrize(
    "tilt",
    spread(
        [((1, 0.3, 0), 9.0), ((1, 0, 0), 0.0), ((0.2, -1, 0), 17.0), ((0, 1, 0.5), -22.0), ((1, 1, 0), 20.0)],
        3,
    ),
)
def test_up_of_a_tilted_room_is_found(world: type[Any], tilt: tuple[tuple[float, float, float], float]) -> None:
    turn = turned(*tilt)
    frame = frame_of(room(world).cloud(turn))
    assert off(frame.up_vector, turn @ [0, 0, 1]) < WITHIN
    assert frame.up_source == "estimated"
    assert frame.floor == pytest.approx(0.0, abs=0.06)  # the floor runs through the origin; a spacing is 0.06


def test_a_photographed_scene_has_minus_y_up(world: type[Any]) -> None:
    turn = turned((1, 0, 0), 90 + 6)  # z to about -y, as in files made from photographs
    assert off(frame_of(room(world).cloud(turn)).up_vector, turn @ [0, 0, 1]) < WITHIN


def test_cameras_give_up_its_sign_even_upside_down(world: type[Any]) -> None:
    turn = turned((1, 0, 0), 180 - 8)  # upside down for any custom of axes
    up = turn @ [0, 0, 1]
    eyes = [turn @ np.array(p) for p in ((1.5, -1.2, 1.5), (-1, -1.2, 1.3), (0.5, -1, 1.8))]
    cameras = tuple(Camera.look_at(e, turn @ [0, 0, 0.4], up) for e in eyes)
    assert off(frame_of(room(world).cloud(turn), cameras).up_vector, up) < WITHIN


def test_what_is_known_is_kept(world: type[Any]) -> None:
    known = Frame((0.0, 1.0, 0.0), 3.0, 0.5, "given", "given")
    assert frame_of(room(world).cloud(), known=known) == known
    file = Frame((0.0, 0.0, 1.0), None, None, "file")
    found = frame_of(room(world).cloud(turned((1, 0, 0), 5)), known=file)
    assert (found.up, found.up_source) == (file.up, "file") and found.floor is not None


def test_the_floor_is_the_lowest_large_level_surface_not_the_largest(world: type[Any]) -> None:
    made = world().sheet("floor", (0, 0, -1.0), (2, 0, 0), (0, 2, 0), BROWN, 0.05)
    made.sheet("mezzanine", (0, 0, 0.5), (2.2, 0, 0), (0, 2.2, 0), WHITE, 0.05)
    made.sheet("step", (2.5, 0, -1.3), (0.4, 0, 0), (0, 0.4, 0), GRAY, 0.05)  # lower, but too small
    assert frame_of(made.cloud(), known=Frame(up_source="given")).floor == pytest.approx(-1.0, abs=0.05)


def test_a_lone_wall_has_no_floor(world: type[Any]) -> None:
    made = world().sheet("wall", (0, 0, 0), (3, 0, 0), (0, 0, 2), WHITE, 0.05)
    assert frame_of(made.cloud(), known=Frame(up_source="given")).floor is None


def test_a_tall_thing_alone_is_not_laid_on_its_side(world: type[Any]) -> None:
    slab = world().box("guitar", (-0.2, -1.0, -0.05), (0.2, 1.0, 0.05), RED, 0.03)  # stands along y, layered across z
    assert abs(frame_of(slab.cloud()).up[1]) > 0.9


@pytest.mark.slow
def test_the_same_cloud_gives_the_same_frame(world: type[Any]) -> None:
    assert frame_of(room(world).cloud()) == frame_of(room(world).cloud())


@pytest.mark.parametrize("count", [0, 1, 2, 5, 60])
@pytest.mark.parametrize("together", [True, False], ids=["one point", "spread"])
@pytest.mark.parametrize("eyes", [0, 1])
def test_degenerate_clouds_still_have_an_up(count: int, together: bool, eyes: int) -> None:
    means = (
        torch.full((count, 3), 0.3) if together else torch.rand(count, 3, generator=torch.Generator().manual_seed(2))
    )
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 0.01), torch.full((count,), 0.9),
        torch.zeros(count, 1, 3),
    )  # fmt: skip
    frame = frame_of(cloud, (Camera.look_at((3, 3, 3), (0, 0, 0), (0, 0, 1)),) * eyes)
    assert np.linalg.norm(frame.up_vector) == pytest.approx(1.0)
    assert frame.floor is None or math.isfinite(frame.floor)
