"""Chosen views are few, deterministic and show the scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import contributions, render
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.viewpoints.coverage import candidates, choose_views, default_viewer, fit_camera

GRAY, RED = (0.6, 0.6, 0.6), (0.78, 0.13, 0.12)
SIZE = 64  # pixels: enough to see a crate, quick to draw


def crate(world: type[Any]) -> Scene:
    """A closed opaque box: each side needs a view of its own."""
    cloud = world().box("crate", (-0.5, -0.5, 0), (0.5, 0.5, 1), RED, 0.08).cloud()
    opaque = cloud.replace(opacities=torch.full((len(cloud),), 0.99), scales=cloud.scales * 1.8)
    return Scene(opaque, Frame(up_source="given"))


def yard(world: type[Any]) -> Scene:
    made = world().sheet("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), GRAY, 0.12)
    made.box("crate", (-0.4, -0.4, 0), (0.4, 0.4, 0.8), RED, 0.08)
    return Scene(made.cloud(), Frame(up_source="given"))


def test_a_few_views_see_all_that_can_be_seen_of_a_crate(world: type[Any]) -> None:
    scene = crate(world)
    views = choose_views(scene, size=SIZE)
    assert 2 <= len(views.cameras) <= 8
    assert views.seen_by.shape == (len(views.cameras), len(views.rows))
    every = candidates(scene.cloud, scene.frame, SIZE)
    visible = np.stack([(contributions(scene.cloud, c) > 0.01).numpy() for c in every]).any(axis=0)
    assert views.seen_by.any(axis=0).sum() >= 0.95 * visible.sum()
    assert views.unseen == pytest.approx(1 - visible.mean())


def test_the_best_view_comes_first_and_each_adds_something(world: type[Any]) -> None:
    views = choose_views(yard(world), size=SIZE)
    seen = views.seen_by
    assert seen[0].sum() == seen.sum(axis=1).max()
    for k in range(1, len(seen)):
        assert (seen[k] & ~seen[:k].any(axis=0)).any()


def test_the_same_scene_gives_the_same_views(world: type[Any]) -> None:
    one, two = choose_views(yard(world), size=SIZE), choose_views(yard(world), size=SIZE)
    assert [c.world_to_camera.tobytes() for c in one.cameras] == [c.world_to_camera.tobytes() for c in two.cameras]
    assert np.array_equal(one.seen_by, two.seen_by)


def test_max_views_is_a_bound_and_own_cameras_suffice_where_there_are_enough(world: type[Any]) -> None:
    scene = crate(world)
    assert len(choose_views(scene, max_views=2, size=SIZE).cameras) <= 2
    angles = np.radians(np.arange(6) * 60.0)
    own = tuple(
        Camera.look_at((3 * np.cos(a), 3 * np.sin(a), 1.5), (0, 0, 0.5), (0, 0, 1), 90, 60, name=f"mine {i}")
        for i, a in enumerate(angles)
    )
    chosen = choose_views(scene.replace(cameras=own), max_views=6, size=SIZE).cameras
    assert chosen and all(c.name.startswith("mine") for c in chosen)


def test_choosing_changes_nothing(world: type[Any]) -> None:
    scene = yard(world)
    before = scene.cloud.digest()
    choose_views(scene, size=SIZE)
    default_viewer(scene, 64, 48)
    assert scene.cloud.digest() == before


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.3, 0.2, 0.9)])
def test_the_default_viewer_sees_the_scene_upright(world: type[Any], up: tuple[float, float, float]) -> None:
    basis = Frame(up).basis()
    scene = yard(world)
    turned = Scene(world().box("crate", (0, 0, 0), (1, 1, 1), RED, 0.08).cloud(basis.T), Frame(up, up_source="given"))
    for seen, frame in ((turned, turned.frame), (scene, scene.frame)):
        camera = default_viewer(seen, 96, 72)
        assert (camera.width, camera.height) == (96, 72)
        assert float(render(seen.cloud, camera).alpha.mean()) > 0.05  # it looks at something
        assert abs(float(camera.right @ frame.up_vector)) < 1e-6  # and is held level
        assert float(-camera.world_to_camera[1, :3] @ frame.up_vector) > 0


def test_the_scenes_first_camera_is_the_viewer(world: type[Any]) -> None:
    own = Camera.look_at((0, -4, 2), (0, 0, 0.5), (0, 0, 1), 200, 100)
    camera = default_viewer(crate(world).replace(cameras=(own,)), 100, 100)
    assert np.array_equal(camera.world_to_camera, own.world_to_camera)
    assert (camera.width, camera.height) == (100, 100)


@pytest.mark.parametrize(("width", "height"), [(100, 100), (400, 100), (50, 300), (200, 100)])
def test_a_fitted_camera_shows_all_that_the_other_showed(width: int, height: int) -> None:
    camera = Camera.look_at((0, -4, 2), (0, 0, 0.5), (0, 0, 1), 200, 100)
    camera = replace(camera, cx=camera.cx + 20, cy=camera.cy - 7)  # its axis is not in the middle of the picture
    fitted = fit_camera(camera, width, height)
    rng = np.random.default_rng(0)
    points = rng.uniform(-1.5, 1.5, (200, 3))
    before, depth = camera.project(points)
    shown = (depth > 0) & (before >= 0).all(axis=1) & (before <= [200, 100]).all(axis=1)
    after, _ = fitted.project(points[shown])
    assert shown.sum() > 20
    assert (after >= -1e-6).all() and (after <= np.array([width, height]) + 1e-6).all()
    assert fitted.fx / fitted.fy == pytest.approx(camera.fx / camera.fy)  # not stretched


@pytest.mark.parametrize("count", [0, 1, 5])
@pytest.mark.parametrize("together", [True, False], ids=["one point", "spread"])
def test_degenerate_clouds_can_be_looked_at(count: int, together: bool) -> None:
    means = (
        torch.full((count, 3), 0.3) if together else torch.rand(count, 3, generator=torch.Generator().manual_seed(1))
    )
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 0.01), torch.full((count,), 0.9),
        torch.zeros(count, 1, 3),
    )  # fmt: skip
    views = choose_views(Scene(cloud), size=32)
    assert views.seen_by.shape == (len(views.cameras), count)
    assert 0 <= views.unseen <= 1
    assert np.isfinite(default_viewer(Scene(cloud), 32, 32).world_to_camera).all()


def test_a_closed_room_is_looked_at_from_inside_and_from_outside(world: type[Any]) -> None:
    made = world()
    made.box("outside", (-2.2, -2.2, -0.2), (2.2, 2.2, 2.7), GRAY, 0.12)
    made.box("inside", (-2, -2, 0), (2, 2, 2.5), RED, 0.12)
    cloud = made.cloud()
    opaque = cloud.replace(opacities=torch.full((len(cloud),), 0.99), scales=cloud.scales * 1.8)
    views = choose_views(Scene(opaque, Frame(up_source="given")), size=SIZE)
    names = {c.name.split()[0] for c in views.cameras}
    assert {"inside", "around"} <= names
    seen = views.seen_by.any(axis=0)
    assert seen[made.rows["inside"]].mean() > 0.85  # corners are seen at a grazing angle
    assert views.unseen == pytest.approx(1 - seen.mean(), abs=0.1)  # what the views leave out is hidden, not forgotten
