"""Views of things from a side, and from things."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from boxed_room import Thing, room, shell

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.viewpoints.for_groups import Sights
from scenewright.gaussians.viewpoints.from_side import FAR, Side, view_from_side, view_from_thing
from scenewright.gaussians.world.person import EYE_HEIGHT, SEATED_EYES

SEAT, BALL, PICTURE = 6, 7, 8
VIEWER = Camera.look_at([0, -1.8, 1.5], [0, 0, 0.5], [0, 0, 1])
SIZE = (160, 120)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A chair in the middle whose back is at +x, so that it faces -x; a ball; a picture on the wall at +y."""
    scene = room(
        [
            *shell(),
            Thing("chair", (-0.25, -0.25, 0.0), (0.25, 0.25, 0.45), (0.9, 0.1, 0.1)),
            Thing("ball", (1.2, 1.0, 0.0), (1.5, 1.3, 0.3), (0.1, 0.1, 0.9)),
            Thing("picture", (-0.4, 1.95, 1.1), (0.4, 1.99, 1.7), (0.1, 0.8, 0.1)),
            Thing("back", (0.2, -0.25, 0.45), (0.25, 0.25, 1.0), (0.9, 0.1, 0.1)),
        ]
    )
    # The chair is one group: seat and back.
    field = scene.language
    assert field is not None
    box = replace(field.groups[SEAT].box, center=(0.0, 0.0, 0.5), size=(0.5, 0.5, 1.0))
    chair = replace(field.groups[SEAT], box=box)
    back = replace(field.groups[9], level="part", parent=SEAT)
    groups = (*field.groups[:SEAT], chair, *field.groups[SEAT + 1 : 9], back)
    return scene.replace(language=replace(field, groups=groups))


@pytest.fixture(scope="module")
def sights(scene: Scene) -> Sights:
    return Sights.of(scene)


@pytest.mark.parametrize(
    ("side", "way"),
    [("front", (-1, 0)), ("behind", (1, 0)), ("left", (0, -1)), ("right", (0, 1))],
)
def test_a_thing_with_a_front_is_seen_by_its_own_sides(sights: Sights, side: Side, way: tuple[float, float]) -> None:
    # Facing -x, its own left hand is at -y.
    found = view_from_side(sights, [SEAT], side, VIEWER, size=SIZE)
    eye = found.chosen.view.camera.position
    off = np.degrees(np.arccos(np.array(way) @ eye[:2] / np.linalg.norm(eye[:2])))
    assert found.whose == "object"
    assert off <= found.turned + 1 and found.turned <= 30
    assert found.chosen.shares[SEAT] > 0.02


@pytest.mark.parametrize(("side", "way"), [("front", (0, -1)), ("behind", (0, 1)), ("left", (-1, 0))])
def test_a_thing_without_a_front_is_seen_by_the_viewers_sides(
    sights: Sights, side: Side, way: tuple[float, float]
) -> None:
    found = view_from_side(sights, [BALL], side, VIEWER, size=SIZE)
    offset = (found.chosen.view.camera.position - np.array([1.35, 1.15, 0.15]))[:2]
    off = np.degrees(np.arccos(np.array(way) @ offset / np.linalg.norm(offset)))
    assert found.whose == "viewer" and off <= found.turned + 1
    assert found.chosen.shares[BALL] > 0.02


def test_from_above_far_and_at_eye_level(sights: Sights) -> None:
    above = view_from_side(sights, [SEAT], "above", VIEWER, size=SIZE).chosen.view.camera
    assert above.forward[2] < -0.85
    near = view_from_side(sights, [BALL], None, VIEWER, size=SIZE).chosen
    far = view_from_side(sights, [BALL], None, VIEWER, distance=FAR, size=SIZE).chosen
    assert 0 < far.shares[BALL] < 0.6 * near.shares[BALL]
    level = view_from_side(sights, [SEAT], "behind", VIEWER, eye_level=True, size=SIZE).chosen.view.camera
    assert level.position[2] == pytest.approx(EYE_HEIGHT)


def test_behind_a_picture_the_wall_is_cut_away(sights: Sights) -> None:
    found = view_from_side(sights, [PICTURE], "behind", VIEWER, size=SIZE)
    if found.chosen.view.camera.position[1] > 2:
        assert 4 in found.chosen.view.cut.groups
    assert found.chosen.shares[PICTURE] > 0.02


def test_what_is_inside_something_else_is_seen_from_nowhere() -> None:
    safe = Thing("safe", (-0.03, -0.03, 0.39), (0.03, 0.03, 0.45), (0.5, 0.5, 0.1), step=0.01)
    coin = Thing("coin", (-0.01, -0.01, 0.41), (0.01, 0.01, 0.43), (0.9, 0.8, 0.1), step=0.01)
    boxed = room([*shell(), safe, coin])
    with pytest.raises(InstructionError, match="cannot be seen"):
        view_from_side(Sights.of(boxed), [7], "front", VIEWER, size=SIZE)


def test_sitting_on_a_chair_one_looks_out_of_its_front_at_seated_height(sights: Sights) -> None:
    found = view_from_thing(sights, SEAT, size=SIZE)
    camera = found.chosen.view.camera
    assert found.whose == "object"
    assert camera.position[2] == pytest.approx(SEATED_EYES, abs=1e-6)
    assert np.linalg.norm(camera.position[:2]) < 0.8
    assert camera.forward[0] < -0.9


def test_looking_from_a_thing_toward_another(sights: Sights) -> None:
    found = view_from_thing(sights, SEAT, [BALL], size=SIZE)
    camera = found.chosen.view.camera
    toward = np.array([1.35, 1.15, 0.15]) - camera.position
    assert camera.forward @ toward / np.linalg.norm(toward) > 0.98
    assert found.chosen.shares[BALL] > 0.005  # the chair's own back, which one turns around to, is left out
    assert found.chosen.view.cut.groups == {SEAT}


def test_a_capture_is_shown_from_where_its_photographs_were_taken(scene: Scene) -> None:
    spots = [(-1.7, -0.2 * k, 1.0) for k in range(-4, 4)] + [(0.1 * k, -1.7, 1.2) for k in range(3)]
    cameras = tuple(Camera.look_at(s, [0, 0, 0.5], [0, 0, 1], 320, 240, 60) for s in spots)
    sights = Sights.of(scene.replace(cameras=cameras))
    for side, way in (("front", (-1.0, 0.0)), (None, None)):
        view = view_from_side(sights, [SEAT], side, VIEWER, size=SIZE).chosen  # type: ignore[arg-type]
        eye = view.view.camera.position
        assert min(np.linalg.norm(eye - s) for s in np.array(spots)) < 1e-9
        assert view.shares[SEAT] > 0.02
        if way is not None:
            assert np.array(way) @ eye[:2] / np.linalg.norm(eye[:2]) > np.cos(np.radians(30))
    behind = view_from_side(sights, [SEAT], "behind", VIEWER, size=SIZE).chosen.view.camera
    assert behind.position[0] > 0.3  # no photograph was taken there
