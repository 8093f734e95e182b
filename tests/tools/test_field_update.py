"""Edits in a row on things with parts: the table says what would be measured afresh, and queries see every change."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import AbsentError, InstructionError
from scenewright.gaussians.language.field.language_field import Group
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

EDITS: tuple[dict[str, Any], ...] = (
    {"op": "recolor", "color": "teal"},
    {"op": "recolor", "adjust": "darker"},
    {"op": "move", "direction": "right", "distance": {"value": 20, "unit": "cm"}},
    {"op": "move", "direction": "up", "distance": {"value": 10, "unit": "cm"}},
    {"op": "rotate", "degrees": 35},
    {"op": "scale", "factor": 1.2},
    {"op": "scale", "factor": 0.8, "axis": "height"},
    {"op": "duplicate", "direction": "up"},
    {"op": "opacity", "value": 0.6},
    {"op": "delete"},
    {"op": "replace", "asset": "stool"},
    {"op": "insert", "asset": "lamp"},
)


def with_parts(scene: Scene, owners: tuple[int, ...]) -> Scene:
    """The scene with some objects split into an upper and a lower part."""
    field = scene.language
    assert field is not None
    column, groups = scene.cloud.group.clone(), list(field.groups)
    for owner in owners:
        rows = (column == owner).nonzero().squeeze(1)
        high = scene.cloud.means[rows, 2] > scene.cloud.means[rows, 2].median()
        for half in (rows[high], rows[~high]):
            column[half] = len(groups)
            part = scene.cloud[half]
            groups.append(
                Group(
                    len(groups),
                    "part",
                    owner,
                    "",
                    0.0,
                    box_of(part, scene.frame),
                    lab_of_cloud(part),
                    len(part),
                    8,
                    1.0,
                )
            )
    vectors = np.concatenate([field.embeddings, np.zeros((len(groups) - len(field.groups), 4), np.float32)])
    language = replace(field, groups=tuple(groups), embeddings=vectors)
    return scene.replace(cloud=scene.cloud.replace(group=column), language=language)


def assert_true(scene: Scene) -> None:
    """Counts, boxes and colours of every row, parents' too, are what is measured of its Gaussians, to the last bit."""
    assert scene.language is not None
    for g in scene.language.groups:
        part = scene.cloud[torch.isin(scene.cloud.group, torch.tensor(scene.language.leaves(g.id), dtype=torch.int32))]
        assert g.count == len(part), g
        if g.count:
            assert g.box == box_of(part, scene.frame, axes=g.box.axes), g
            assert g.lab == lab_of_cloud(part), g


def assert_seen(scene: Scene, viewer: Camera) -> None:
    """Queries by group and by colour answer from the present cloud and table, not from one before."""
    assert scene.language is not None
    for g in scene.language.groups:
        leaves = torch.tensor(scene.language.leaves(g.id), dtype=torch.int32)
        own = scene.cloud.ids[torch.isin(scene.cloud.group, leaves)].sort().values
        answer = resolve(scene, Query(groups=(g.id,)), viewer)
        assert torch.equal(answer.ids, own) and (answer.verdict == "found") == bool(g.count)
    fresh = scene.replace(
        cloud=scene.cloud.replace(group=scene.cloud.group.clone()), language=replace(scene.language)
    )  # nothing remembered
    for word in ("teal", "brown", "red"):
        query = Query(colors=(word,), pick="all")
        assert resolve(scene, query, viewer).groups == resolve(fresh, query, viewer).groups


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.slow
def test_a_row_of_random_edits_keeps_the_table_true(corner: Scene, context: Context, viewer: Camera, seed: int) -> None:
    scene = with_parts(corner, (0, 1))
    assert_true(scene)
    rng = np.random.default_rng(seed)
    done = 0
    for _ in range(12):
        assert scene.language is not None
        alive = [g.id for g in scene.language.groups if g.count and g.level != "structure"]
        edit = EDITS[int(rng.integers(len(EDITS)))]
        target = {"groups": (int(rng.choice(alive)),)}
        fields = edit if edit["op"] == "insert" else {**edit, "target": target}
        try:
            scene = carry_out(scene, parse(fields), context).scene
        except (InstructionError, AbsentError):
            continue  # it does not fit there; nothing changed
        done += 1
        assert_true(scene)
        assert_seen(scene, viewer)
    assert done >= 4
