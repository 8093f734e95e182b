"""Spoilt outcomes are refused by the checks of every edit, and honest ones pass."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.benchmarks._edits.sabotage import LIES, Tried, figures
from scenewright.benchmarks._edits.spoiling import SPOILINGS, Attempt
from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import CheckFailedError
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Scene
from scenewright.tools import execute
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

HONEST: list[dict[str, Any]] = [
    {"op": "delete"},
    {"op": "recolor", "color": "teal"},
    {"op": "recolor", "adjust": "darker"},
    {"op": "recolor", "adjust": "lighter"},
    {"op": "move", "direction": "left", "distance": {"value": 40, "unit": "cm"}},
    {"op": "rotate", "degrees": 70},
    {"op": "scale", "factor": 1.3},
    {"op": "duplicate"},
    {"op": "replace", "asset": "stool", "color": "blue"},
    {"op": "insert", "asset": "stool"},
]


@pytest.fixture(scope="module")
def room() -> tuple[Scene, dict[str, int], Context]:
    """A furnished room with a field that is right by construction, and the groups of things of which there is one."""
    made = assets.furnish(8300)
    scene, groups = made.scene, []
    ids = made.truth.ids.to(torch.int32)
    for number, thing in enumerate(made.truth.objects):
        cloud = scene.cloud[ids == thing.id]
        box, lab = box_of(cloud, scene.frame), lab_of_cloud(cloud)
        groups.append(Group(number, "object", -1, thing.kind, 0.9, box, lab, len(cloud), 8, 1.0))
    shell = scene.cloud[ids < 0]
    groups.append(
        Group(len(groups), "object", -1, "shell", 0.9, box_of(shell, scene.frame), (60.0, 0.0, 0.0), len(shell), 8, 1.0)
    )
    owner = {thing.id: number for number, thing in enumerate(made.truth.objects)}
    filed = torch.tensor([owner.get(int(i), len(owner)) for i in ids], dtype=torch.int32)
    field = LanguageField(tuple(groups), np.zeros((len(groups), 8), np.float32), "none")
    scene = scene.replace(cloud=scene.cloud.replace(group=filed), language=field)
    kinds = [g.label for g in groups]
    single = {g.label: g.id for g in groups if kinds.count(g.label) == 1 and g.count > 400 and g.label != "shell"}
    return scene, single, Context(viewer=scene.cameras[0] if scene.cameras else Camera.look_at([0, -3, 2], [0, 0, 0.5]))


def outcome_of(room: tuple[Scene, dict[str, int], Context], data: dict[str, Any]) -> Attempt:
    scene, single, context = room
    name = next(n for n in ("chair", "armchair", "nightstand", "stool", "coffee table", *single) if n in single)
    chosen = Selection(Query(groups=(single[name],)), "found", scene.cloud.ids[scene.cloud.group == single[name]])
    if data["op"] == "insert":
        op, chosen = parse(data), Selection(Query(), "found", scene.cloud.ids[:0])
    else:
        op = parse({**data, "target": {"groups": [single[name]]}})
        chosen = replace(chosen, groups=(single[name],))
    others = tuple(scene.cloud.ids[scene.cloud.group == g] for n, g in single.items() if n != name)
    return Attempt(scene, op, context, chosen, op.apply(scene, chosen, context), others, np.random.default_rng(0))


@pytest.mark.parametrize("data", HONEST, ids=lambda d: " ".join(map(str, d.values()))[:30])
@pytest.mark.slow
def test_honest_edits_pass_and_spoilt_ones_are_refused(
    room: tuple[Scene, dict[str, int], Context], data: dict[str, Any]
) -> None:
    attempt = outcome_of(room, data)
    scene, op, context, chosen = attempt.scene, attempt.op, attempt.context, attempt.chosen
    execute.checked(scene, op, chosen, attempt.outcome, context, {})
    spoilt = {kind: spoil(attempt) for kind, spoil in SPOILINGS.items()}
    assert any(outcome is not None for outcome in spoilt.values())
    for kind, outcome in spoilt.items():
        if outcome is not None:
            with pytest.raises(CheckFailedError):
                execute.checked(scene, op, chosen, outcome, context, {})
                pytest.fail(f"{kind} was not caught")


def test_spoiling_leaves_the_honest_outcome_as_it_is(room: tuple[Scene, dict[str, int], Context]) -> None:
    attempt = outcome_of(room, {"op": "rotate", "degrees": 70})
    digest = attempt.outcome.scene.cloud.digest()
    for spoil in SPOILINGS.values():
        spoil(attempt)
    assert attempt.outcome.scene.cloud.digest() == digest


def test_figures_count_what_was_caught_and_what_was_refused_wrongly() -> None:
    kinds = [*SPOILINGS, *LIES]
    found = [Tried("room", False, k % 2 == 0, kind, {}, "refused") for k, kind in enumerate(kinds)]
    found += [Tried("room", False, False, kinds[0], {}, ""), Tried("room", False, True, "honest", {}, "refused")]
    found += [Tried("room", True, True, "honest", {}, "") for _ in range(3)]
    values = {m.key: m.value for m in figures(found)}
    assert values["checks.caught"] == pytest.approx(len(kinds) / (len(kinds) + 1))
    assert values["checks.false_alarms"] == pytest.approx(0.25)
    assert values["checks.held.false_alarms"] == pytest.approx(0.25)
    assert values[f"checks.caught.{kinds[0].replace(' ', '_')}"] == 0.5


def test_the_scenes_of_the_benchmark_are_named_in_the_table_of_things() -> None:
    from scenewright.benchmarks._edits.color import THINGS
    from scenewright.benchmarks._edits.sabotage import HELD_REAL, HELD_SEEDS, REAL, SEEDS

    assert set(REAL) | set(HELD_REAL) == set(THINGS) and not set(REAL) & set(HELD_REAL)
    assert not set(SEEDS) & set(HELD_SEEDS)
