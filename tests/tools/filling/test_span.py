"""Where a scene ends: nothing is made beyond it, and nothing is told to be missing there."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.filling.fill import merged, patches_behind
from scenewright.tools.filling.span import Span


def _sheet(low: tuple[float, float, float], high: tuple[float, float, float], step: float, rgb: float) -> GaussianCloud:
    """A grid of Gaussians in a box that is flat in one axis."""
    axes = [np.arange(a, b + 1e-9, step) if b > a else np.array([a]) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    n = len(points)
    return GaussianCloud.create(
        torch.from_numpy(points.astype(np.float32)), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1),
        torch.full((n, 3), 0.6 * step), torch.full((n,), 0.95), color_to_dc(torch.full((n, 3), rgb))[:, None],
    )  # fmt: skip


def _room() -> GaussianCloud:
    """Floor, back and left wall; in front and at the right nothing is."""
    parts = [_sheet((-2, -2, 0), (2, 2, 0), 0.05, 0.6), _sheet((-2, 2, 0), (2, 2, 2), 0.05, 0.8),
             _sheet((-2, -2, 0), (-2, 2, 2), 0.05, 0.7)]  # fmt: skip
    first, numbered = 0, []
    for part in parts:
        numbered.append(part.replace(ids=torch.arange(first, first + len(part))))
        first += len(part)
    return concat(numbered)


# One looks in from the open side, the others out through it.
EYES = (
    Camera.look_at([1.5, -1.0, 1.2], [-1.6, -1.7, 0.3], [0, 0, 1], 160, 120),
    Camera.look_at([0.5, 1.5, 1.5], [-1.6, -1.7, 0.3], [0, 0, 1], 160, 120),
    Camera.look_at([-1.0, 1.5, 1.5], [0.0, -1.0, 0.3], [0, 0, 1], 160, 120),
    Camera.look_at([0.5, 1.0, 0.6], [0.0, -1.0, 0.3], [0, 0, 1], 160, 120),
)


def _scene(cloud: GaussianCloud) -> Scene:
    return Scene(cloud, Frame((0, 0, 1), 0.0, 1.0, "given", "given"), cameras=EYES)


@pytest.mark.slow
def test_what_stands_at_the_end_of_a_scene_is_not_filled_beyond_it() -> None:
    """A box in the corner of wall, floor and open side, and the wall and floor that it hid."""
    room = _room()
    thing = _sheet((-1.95, -1.95, 0.05), (-1.3, -1.4, 0.8), 0.08, 0.2)
    hid = ((room.means > torch.tensor([-2.1, -2.1, -0.1])) & (room.means < torch.tensor([-1.4, -1.5, 0.7]))).all(dim=1)
    scene = _scene(room[~hid])
    new = merged(scene, patches_behind(scene, thing))
    assert len(new) > 20
    assert not Span.of(scene.cloud, 0.75).outside(new.means.double().numpy()).any()
    assert float(new.means[:, 1].min()) > -2.06


def test_nothing_is_missing_where_nothing_was() -> None:
    """A box in the middle of the floor, behind which cameras look out of the room: nothing is told to stay open."""
    scene = _scene(_room())
    thing = _sheet((-0.2, -1.2, 0.05), (0.2, -0.8, 0.6), 0.05, 0.2)
    assert not [p.reason for p in patches_behind(scene, thing) if p.reason]


def test_a_span_follows_the_hull() -> None:
    span = Span.of(_room(), 1.0)
    inside = np.array([[0.0, 0, 0], [1.9, 1.9, 1.9], [0, 1.99, 1.0], [0.0, 0.0, -0.02]])
    outside = np.array([[0.0, -2.2, 0], [1.9, -1.9, 1.9], [0, 2.1, 1.0], [0, 0, -0.1]])
    assert not span.outside(inside).any()
    assert span.outside(outside).all()


@pytest.mark.parametrize("count", [0, 3, 50])
def test_what_has_no_volume_limits_nothing(count: int) -> None:
    flat = _sheet((0, 0, 0), (1, 1, 0), 0.1, 0.5)[torch.arange(count)]
    assert not Span.of(flat, 1.0).outside(np.array([[9.0, 9, 9]])).any()
