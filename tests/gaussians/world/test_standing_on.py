"""What stands on a thing, found among those whose boxes reach it, is what each relation alone says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.scene import Frame
from scenewright.gaussians.world.box import Box
from scenewright.gaussians.world.relation_geometry import HOLDS, Stand
from scenewright.gaussians.world.relations import score
from scenewright.gaussians.world.support import standing_on


def crowd(seed: int, count: int = 40) -> LanguageField:
    """Boxes of many sizes and yaws on three tables, on the floor, and across their edges."""
    rng = np.random.default_rng(seed)
    groups = []
    for i in range(count):
        yaw = rng.uniform(0, np.pi)
        axes = ((np.cos(yaw), np.sin(yaw), 0.0), (-np.sin(yaw), np.cos(yaw), 0.0), (0.0, 0.0, 1.0))
        table = i < 3
        size = rng.uniform(0.05, 0.6, 3) if not table else np.array([1.6, 0.9, 0.7])
        low = 0.0 if table else float(rng.choice([0.0, 0.7, 0.72, 0.35]))
        center = (float(rng.uniform(-3, 3)), float(rng.uniform(-3, 3)), low + float(size[2]) / 2)
        if not table and rng.random() < 0.7:
            under = groups[int(rng.integers(3))].box
            center = (under.center[0] + rng.normal(0, 0.5), under.center[1] + rng.normal(0, 0.5), center[2])
        box = Box(tuple(map(float, center)), axes, tuple(map(float, size)))  # type: ignore[arg-type]
        groups.append(Group(i, "object", -1, "thing", 0.9, box, (50.0, 0.0, 0.0), 10, 3, 1.0))
    return LanguageField(tuple(groups), np.zeros((count, 2), np.float32), "test:1")


@pytest.mark.parametrize("seed", range(4))
def test_only_boxes_that_reach_are_scored_and_nothing_is_missed(seed: int) -> None:
    field, frame = crowd(seed), Frame((0, 0, 1), 0.0, 1.0, "given", "given")
    east, north, up = frame.basis()
    stand = Stand(east, north, up, np.zeros(3), field.typical_size)
    found = 0
    for support in field.groups[:6]:
        plain = [g for g in field.groups if g.id != support.id and score("on", g, [support], stand) >= HOLDS]
        assert list(standing_on(field, frame, support)) == plain
        found += len(plain)
    assert found > 3
    outside = replace(field.groups[0], id=-1)
    assert standing_on(field, frame, outside)[0] in (field.groups[0], *standing_on(field, frame, field.groups[0]))
