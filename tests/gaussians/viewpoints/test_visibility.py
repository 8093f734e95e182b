"""Counting visible pixels of groups, bounding them by boxes, free space, and cutting away what hides a room."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from boxed_room import Thing, room, shell
from scipy.spatial import ConvexHull

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.scene import Frame
from scenewright.gaussians.viewpoints.cutaway import NOTHING, Cut, from_above, toward_inside, wall_between
from scenewright.gaussians.viewpoints.free_space import FreeSpace
from scenewright.gaussians.viewpoints.visibility import GroupPixels, label_table, silhouettes
from scenewright.gaussians.world.box import Box

CUBE = Thing("box", (-0.3, 0.7, 0.0), (0.3, 1.3, 0.6), (0.9, 0.1, 0.1))


def _random_boxes(rng: np.random.Generator, count: int) -> list[Box]:
    found = []
    for _ in range(count):
        a = rng.uniform(0, np.pi)
        axes = ((np.cos(a), np.sin(a), 0.0), (-np.sin(a), np.cos(a), 0.0), (0.0, 0.0, 1.0))
        found.append(Box(tuple(rng.uniform(-1, 1, 3)), axes, tuple(rng.uniform(0.05, 0.8, 3))))
    return found


def test_silhouettes_are_the_convex_hulls_of_the_corners() -> None:
    rng = np.random.default_rng(0)
    boxes = _random_boxes(rng, 40)
    camera = Camera.look_at([0, -5, 1.5], [0.2, 0, 0], [0, 0, 1], 160, 120, 50)
    whole, within = silhouettes(camera, boxes)
    for box, area, inner in zip(boxes, whole, within, strict=True):
        hull = ConvexHull(camera.project(box.corners())[0]).volume / (
            160 * 120
        )  # the "volume" of a flat hull is its area
        assert area == pytest.approx(hull, rel=1e-9)
        assert inner <= area + 1e-12


def test_a_box_around_or_behind_the_eye() -> None:
    camera = Camera.look_at([0, 0, 0], [0, 1, 0], [0, 0, 1], 160, 120, 50)
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    around, behind = Box((0, 0, 0), axes, (1, 1, 1)), Box((0, -3, 0), axes, (1, 1, 1))
    whole, within = silhouettes(camera, [around, behind])
    assert np.isinf(whole).all() and within.tolist() == [1.0, 0.0]


def test_counted_shares_stay_within_the_bound_of_boxes() -> None:
    scene = room([*shell(False), CUBE])
    counter = GroupPixels(scene, [5])
    for x in (-1.5, 0.0, 1.0):
        camera = Camera.look_at([x, -1.7, 1.2], [0, 1, 0.3], [0, 0, 1], 256, 192, 60)
        _, within = silhouettes(camera, [scene.language.groups[5].box])  # type: ignore[union-attr]
        share = counter.shares(camera)[0]
        assert 0 < share <= within[0] * 1.4  # discs reach 0.04 over each border of a box of 0.6


def test_what_stands_before_a_thing_hides_it_and_cutting_that_shows_it() -> None:
    screen = Thing("screen", (-2, 0.2, 0), (2, 0.24, 2.6), (0.1, 0.6, 0.1))
    scene = room([*shell(), CUBE, screen])
    camera = Camera.look_at([0, -1.5, 1], [0, 1, 0.3], [0, 0, 1], 256, 192, 60)
    counter = GroupPixels(scene, [6, 7])
    hidden, shown = counter.shares(camera), counter.shares(camera, Cut(frozenset({7})))
    assert hidden[0] == 0 and hidden[1] > 0.5
    assert shown[0] > 0.02 and shown[1] == 0


def test_a_thing_behind_a_faint_wall_of_many_gaussians_is_not_visible() -> None:
    screen = Thing("screen", (-1, 0.3, 0), (1, 0.34, 1.5), (0.1, 0.6, 0.1), step=0.03)
    scene = room([CUBE, screen])
    opacity = np.where(scene.cloud.group.numpy() == 1, 0.3, 0.97).astype(np.float32)
    scene = scene.replace(cloud=scene.cloud.replace(opacities=torch.from_numpy(opacity)))
    camera = Camera.look_at([0, -1.5, 0.5], [0, 1, 0.3], [0, 0, 1], 256, 192, 50)
    assert GroupPixels(scene, [0]).shares(camera)[0] < 0.01


def test_the_label_of_a_part_is_its_own_where_both_are_asked_for() -> None:
    scene = room([CUBE, CUBE])
    field = scene.language
    assert field is not None
    part = replace(field.groups[1], level="part", parent=0)
    field = replace(field, groups=(field.groups[0], part))
    assert label_table(field, [0]).tolist() == [-1, 0, 0]
    assert label_table(field, [1, 0]).tolist() == [-1, 1, 0]


def test_clearance_is_the_distance_to_the_nearest_surface() -> None:
    scene = room([*shell(), CUBE])
    space = FreeSpace.of(scene.cloud, scene.frame)
    eye = np.array([[0.0, -0.5, 1.2], [0.0, 1.0, 0.3], [0.0, 0.6, 0.3], [0.0, 0.0, 9.0]])
    exact = [1.2, 0.3, 0.1, 9 - 2.6]  # to the floor, the inside of the cube's faces, its front, the ceiling
    assert space.clearance(eye) == pytest.approx(exact, abs=2 * space.step)
    assert space.sees(np.array([0, -1.5, 1.0]), np.array([1.5, -1.5, 1.0]), 0.1)
    assert not space.sees(np.array([0, -0.5, 0.3]), np.array([0, 1.8, 0.3]), 0.1)


def test_people_stand_where_nothing_else_does() -> None:
    scene = room([*shell(), Thing("block", (-2, -2, 0), (0.5, 2, 1.8), (0.9, 0.1, 0.1))])
    space = FreeSpace.of(scene.cloud, scene.frame)
    spots = space.stands(4, space.eye_height)
    assert len(spots) >= 1
    assert (spots[:, 0] > 0.5).all() and spots[:, 2] == pytest.approx(1.55)
    near = space.stands(1, space.eye_height, np.array([1.8, 1.8, 0.0]))
    assert np.linalg.norm(near[0, :2] - [1.8, 1.8]) < 1.0


def test_space_without_gaussians_is_free() -> None:
    space = FreeSpace.of(GaussianCloud.empty(), Frame())
    assert np.isinf(space.clearance(np.zeros((1, 3)))).all() and len(space.stands(2, 1.0)) == 2


def test_seen_from_above_the_ceiling_goes_and_what_is_asked_for_stays() -> None:
    lamp = Thing("lamp", (0.5, 0.5, 2.3), (0.8, 0.8, 2.55), (0.9, 0.9, 0.1))
    scene = room([*shell(), CUBE, lamp])
    cut = from_above(scene)
    assert cut.groups == {5} and cut.above == pytest.approx(2.2)
    assert set(scene.cloud.group[cut.kept(scene)].tolist()) == {0, 1, 2, 3, 4, 6}
    assert 7 in scene.cloud.group[from_above(scene, [7]).kept(scene)].tolist()
    assert NOTHING.apply(scene) is scene.cloud


def test_from_outside_the_near_walls_go_with_what_hangs_on_them() -> None:
    picture = Thing("picture", (-0.4, -1.99, 1.2), (0.4, -1.96, 1.6), (0.2, 0.2, 0.9))
    scene = room([*shell(), CUBE, picture])
    eye = np.array([0.0, -6.0, 3.0])
    assert toward_inside(scene, eye).groups == {3, 5, 7}  # the wall at -y, the ceiling, the picture
    assert toward_inside(scene, eye, [7]).groups == {3, 5}
    assert wall_between(scene, eye, np.array([0.0, 1.0, 0.3]))
    assert wall_between(scene, np.array([0.0, -3.0, 1.4]), np.array([0.0, -1.97, 1.4]))
    assert not wall_between(scene, np.array([0.0, -1.0, 1.4]), np.array([0.0, -1.97, 1.4]))
    assert 0 in toward_inside(scene, np.array([0.0, 0.0, -3.0])).groups
