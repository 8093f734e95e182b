"""Free moves end at walls: where a box meets points, by a slow reference; and a room whose wall refuses a chair."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import torch
from amounts import some
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.language.field.language_field import Group
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.world.box import Box
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.placement.walls import free_share
from scenewright.tools.registry import parse

CHAIR, WALL = 1, 5  # as the `corner` fixture numbers them; the wall is added to it
WALL_X = -2.9


def wall() -> GaussianCloud:
    """A wall at the viewer's left, of splats 5 cm apart."""
    means = torch.cartesian_prod(torch.tensor([WALL_X]), torch.linspace(-3, 3, 120), torch.linspace(0.02, 2.5, 50))
    n = len(means)
    quats = torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous()
    scales = torch.tensor([0.002, 0.03, 0.03]).expand(n, 3).contiguous()
    return GaussianCloud.create(means, quats, scales, torch.full((n,), 0.95), torch.ones(n, 1, 3))


@pytest.fixture
def walled(corner: Scene) -> Scene:
    cloud, field = wall().with_degree(corner.cloud.degree), corner.language
    assert field is not None
    first = int(corner.cloud.ids.max()) + 1
    filed = torch.full((len(cloud),), WALL, dtype=torch.int32)
    cloud = cloud.replace(ids=torch.arange(first, first + len(cloud)), group=filed)
    box = box_of(cloud, corner.frame)
    row = Group(WALL, "structure", -1, "wall", 1.0, box, lab_of_cloud(cloud), len(cloud), 1, 1.0)
    vectors = np.concatenate([field.embeddings, np.zeros_like(field.embeddings[:1])])
    language = replace(field, groups=(*field.groups, row), embeddings=vectors)
    return corner.replace(cloud=concat([corner.cloud, cloud]), language=language)


def move(scene: Scene, context: Context, way: str, metres: float) -> Done:
    length = {"value": metres, "unit": "m"}
    op = parse({"op": "move", "target": {"text": "chair"}, "direction": way, "distance": length})
    return carry_out(scene, op, context)


@pytest.mark.parametrize("metres", [1.3, 2.5, 40.0])
def test_a_wall_is_not_crossed_and_the_way_left_is_told(walled: Scene, context: Context, metres: float) -> None:
    with pytest.raises(InstructionError, match="through a wall") as refused:
        move(walled, context, "left", metres)
    told = re.search(r"can move ([0-9.]+) m", str(refused.value))
    assert told is not None
    moved = move(walled, context, "left", float(told.group(1))).scene  # what was told can be done
    left = moved.cloud.means[moved.cloud.group == CHAIR, 0].min()
    # It stands at the wall: nearer than a hand's breadth, reaching into it by no more than the slack and some legs.
    assert -0.06 < float(left) - WALL_X < 0.1


def test_ways_along_and_from_a_wall_are_free(walled: Scene, context: Context) -> None:
    beside = move(walled, context, "left", 1.0).scene
    for way in ("forward", "backward", "right", "up", "down"):
        assert move(beside, context, way, 0.5).receipt.passed


def test_the_floor_ends_the_room_where_no_wall_does(corner: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="leave the room"):
        move(corner, context, "backward", 4.0)
    assert move(corner, context, "backward", 2.0).receipt.passed


@settings(max_examples=some(40), deadline=None)
@given(st.integers(0, 10**6))
def test_the_free_way_is_that_of_small_steps(seed: int) -> None:
    g = np.random.default_rng(seed)
    angle = g.uniform(0, np.pi)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    box = Box((0.0, 0.0, 0.0), ((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), (1.0, 0.6, 0.8))
    offset = g.normal(size=3) * 2
    points = g.uniform(-3, 3, size=(400, 3)).astype(np.float32)
    half = np.array(box.size) / 2
    entered = np.full(len(points), np.inf)
    for share in np.linspace(0, 1, 2001):
        inside = (np.abs(box.local(points - share * offset)) <= half).all(axis=1)
        entered = np.where(inside & np.isinf(entered), share, entered)
    met = entered[(entered > 0) & np.isfinite(entered)]
    free = free_share(box, points, offset)
    # Small steps miss what a corner of the box passes between two of them: a point or two of hundreds.
    if free is None:
        assert len(met) < 8
    elif len(met) >= 8:
        few = int(np.ceil(0.02 * len(met))) + 1
        assert (met < free - 1e-3).sum() <= few and free <= np.sort(met)[few] + 1e-3


def test_a_selection_says_how_much_it_found(corner: Scene, context: Context) -> None:
    done = carry_out(corner, parse({"op": "select", "target": {"text": "chair"}}), context)
    assert f"{len(done.selection):,} Gaussians in 1 thing selected" in done.receipt.sentence()
