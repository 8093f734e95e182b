"""The judge of edits: clean edits pass, each way to go wrong is caught, and nothing that the edit reports is read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
import torch

from scenewright.gaussians.cloud import NO_GROUP
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection, mask_of
from scenewright.gaussians.scene import Scene
from scenewright.tools.cloud_diff import Draft
from scenewright.tools.execute import carry_out
from scenewright.tools.judging.case import Case
from scenewright.tools.judging.changes import changes_between
from scenewright.tools.judging.examine import Findings, examine
from scenewright.tools.judging.refile import refiled
from scenewright.tools.operation import Context
from scenewright.tools.registry import OPS, parse

TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)  # as the `corner` fixture numbers them
Json = dict[str, Any]
A_CHAIR = {"text": "chair"}
CLEAN: list[Json] = [
    {"op": "select", "target": A_CHAIR},
    {"op": "isolate", "target": A_CHAIR},
    {"op": "delete", "target": A_CHAIR},
    {"op": "recolor", "target": A_CHAIR, "color": "teal"},
    {"op": "recolor", "target": A_CHAIR, "adjust": "darker"},
    {"op": "recolor", "target": A_CHAIR, "adjust": "toward", "color": "red"},
    {"op": "restyle", "target": A_CHAIR, "material": "marble"},
    {"op": "relight", "target": A_CHAIR, "exposure": 1.3},
    {"op": "relight", "target": A_CHAIR, "mood": "evening"},
    {"op": "relight", "target": A_CHAIR, "color": "blue"},
    {"op": "opacity", "target": A_CHAIR, "value": 0.4},
    {"op": "move", "target": A_CHAIR, "direction": "left", "distance": {"value": 30, "unit": "cm"}},
    {"op": "move", "target": A_CHAIR, "toward": {"text": "table"}, "distance": {"value": 20, "unit": "cm"}},
    {"op": "move", "target": A_CHAIR, "place": {"relation": "next_to", "anchors": [{"text": "armchair"}]}},
    {"op": "move", "target": {"text": "vase"}, "place": {"relation": "on", "anchors": [{"text": "armchair"}]}},
    {"op": "move", "target": {"text": "table"}, "direction": "backward", "distance": {"value": 1, "unit": "m"}},
    {"op": "rotate", "target": A_CHAIR, "degrees": 70},
    {"op": "rotate", "target": A_CHAIR, "toward": {"text": "table"}},
    {"op": "scale", "target": A_CHAIR, "factor": 1.2},
    {"op": "scale", "target": A_CHAIR, "height": {"value": 60, "unit": "cm"}},
    {"op": "arrange", "target": A_CHAIR, "x": -0.4, "turn": 30},
    {"op": "exchange", "target": {"groups": [CHAIR, ARMCHAIR], "pick": "all"}},
    {"op": "reframe", "degrees": 30},
    {"op": "insert", "asset": "stool", "color": "red"},
    {"op": "insert", "asset": "vase", "place": {"relation": "on", "anchors": [{"text": "chair"}]}},
    {"op": "insert", "asset": "chair", "count": 2, "height": {"value": 70, "unit": "cm"}},
    {"op": "duplicate", "target": A_CHAIR},
    {"op": "replace", "target": A_CHAIR, "asset": "stool", "color": "blue"},
    {"op": "merge", "target": {"groups": [TABLE, VASE], "pick": "all"}},
    {"op": "split", "target": {"text": "table"}},
    {"op": "infill", "target": {"text": "table"}, "where": "under"},
    {"op": "shadow", "target": {"text": "table"}, "change": "cast"},
]


def edited(scene: Scene, data: Json, context: Context) -> Scene:
    return carry_out(scene, parse(data), context, seen=False).scene


def judge(before: Scene, after: Scene, data: Json, context: Context, chosen: Selection | None = None) -> Findings:
    return examine(Case(before, after, parse(data), context, chosen))


def failed(findings: Findings) -> set[str]:
    return {check.name for check in findings.failed}


def changed(scene: Scene, rows: torch.Tensor, column: str, change: Callable[[torch.Tensor], torch.Tensor]) -> Scene:
    draft = Draft(scene.cloud)
    draft.map(column, rows.nonzero().squeeze(1), change)
    return scene.replace(cloud=draft.done())


def test_every_operation_has_a_clean_edit_below() -> None:
    moving = {name for name, op in OPS.items() if op.makes_motion}  # see timing/test_through_time.py
    assert {data["op"] for data in CLEAN} == set(OPS) - moving


@pytest.mark.parametrize("data", CLEAN, ids=lambda d: f"{d['op']} {sorted(d)}")
def test_a_clean_edit_passes_and_no_report_of_it_is_read(corner: Scene, context: Context, data: Json) -> None:
    digests = corner.cloud.digest()
    after = edited(corner, data, context)
    found = judge(corner, after, data, context)
    assert found.passed, found.failed
    assert judge(corner, after.replace(language=None), data, context).checks == found.checks
    assert corner.cloud.digest() == digests


# A selection and a new grouping change no Gaussian, nothing may be missing where holes are filled, a thing may already
# face what it is turned to, or cast the shadow that it is to cast.
CHANGING = [
    d
    for d in CLEAN
    if d["op"] not in ("select", "merge", "split", "infill", "shadow") and not (d["op"] == "rotate" and "toward" in d)
]


@pytest.mark.parametrize("data", CHANGING, ids=lambda d: f"{d['op']} {sorted(d)}")
def test_nothing_changed_is_caught(corner: Scene, context: Context, data: Json) -> None:
    assert not judge(corner, corner, data, context).passed


@pytest.mark.parametrize("data", CLEAN, ids=lambda d: f"{d['op']} {sorted(d)}")
def test_something_else_gone_is_caught(corner: Scene, context: Context, data: Json) -> None:
    """One Gaussian of the floor is enough; where everything but the target goes, one of the target."""
    after = edited(corner, data, context)
    owner = CHAIR if data["op"] == "isolate" else FLOOR
    one = int((after.cloud.group == owner).nonzero()[0])
    rest = torch.arange(len(after.cloud)) != one
    found = judge(corner, after.replace(cloud=after.cloud[rest]), data, context)
    assert "nothing else changed" in failed(found)


TARGETED = [d for d in CLEAN if d["op"] in ("delete", "recolor", "opacity", "scale", "rotate", "replace", "move")
            and d["target"] == A_CHAIR and "toward" not in d]  # fmt: skip


@pytest.mark.parametrize("data", TARGETED, ids=lambda d: f"{d['op']} {sorted(d)}")
def test_a_wrong_target_is_caught(corner: Scene, context: Context, data: Json) -> None:
    ids = corner.cloud.ids[corner.cloud.group == ARMCHAIR]
    other = Selection(Query(text="chair"), "found", ids, (ARMCHAIR,))
    after = carry_out(corner, parse(data), context, other).scene
    found = judge(corner, after, data, context)
    assert "nothing else changed" in failed(found)
    # Whoever said that the armchair was meant agrees with the result.
    assert judge(corner, after, data, context, other).passed


@pytest.mark.parametrize("share", [0.05, 0.3])
@pytest.mark.parametrize("op", ["delete", "recolor", "move", "replace"])
def test_a_residue_of_the_selection_is_caught(corner: Scene, context: Context, op: str, share: float) -> None:
    data = next(d for d in TARGETED if d["op"] == op)
    rows = (corner.cloud.group == CHAIR).nonzero().squeeze(1)
    low = corner.cloud.means[rows, 2].argsort()
    ids = corner.cloud.ids[rows[low[round(share * len(rows)) :]]].sort().values
    part = Selection(Query(text="chair"), "found", ids, (CHAIR,))
    found = judge(corner, carry_out(corner, parse(data), context, part).scene, data, context)
    assert "all of it changed" in failed(found)


def reliable(scene: Scene) -> Scene:
    """The scene with sure labels, as a room that the encoder knows."""
    field = scene.language
    assert field is not None
    return scene.replace(language=replace(field, groups=tuple(replace(g, label_score=1.0) for g in field.groups)))


@pytest.mark.parametrize("owner", [NO_GROUP, FLOOR, TABLE])
def test_a_piece_that_the_field_missed_is_found_to_the_last_gaussian(
    corner: Scene, context: Context, owner: int
) -> None:
    """The chair's upper third is filed under nothing, the floor or the table: whoever asks the field misses it."""
    scene = reliable(corner)
    rows = (scene.cloud.group == CHAIR).nonzero().squeeze(1)
    height = scene.cloud.means[rows, 2]
    piece = rows[(height > 0.4 * height.max()) & (height < 0.75 * height.max())]
    group = scene.cloud.group.clone()
    group[piece] = owner
    scene = scene.replace(cloud=scene.cloud.replace(group=group))
    data: Json = {"op": "delete", "target": A_CHAIR}
    found = judge(scene, edited(scene, data, context), data, context)
    assert failed(found) == {"nothing left behind"}
    visible = piece[scene.cloud.opacities[piece] > 0.1]
    assert set(found.residue.tolist()) == set(scene.cloud.ids[visible].tolist())
    # Where no label is sure, it is told and not held against the edit.
    unsure = replace(scene.language, groups=tuple(replace(g, label_score=0.1) for g in scene.language.groups))  # type: ignore[arg-type, union-attr]
    doubtful = scene.replace(language=unsure)
    found = judge(doubtful, edited(doubtful, data, context), data, context)
    assert found.passed and not len(found.residue)


def test_what_was_left_is_filed_under_its_thing(corner: Scene) -> None:
    """Only groups change; counts and boxes are those of the chair as it really is."""
    scene = reliable(corner)
    piece = (scene.cloud.group == CHAIR) & (scene.cloud.means[:, 2] > 0.4)
    group = torch.where(piece, torch.full_like(scene.cloud.group, FLOOR), scene.cloud.group)
    torn = scene.replace(cloud=scene.cloud.replace(group=group))
    ids = torn.cloud.ids[torn.cloud.group == CHAIR]
    filed = refiled(torn, Selection(Query(text="chair"), "found", ids, (CHAIR,)), torn.cloud.ids[piece])
    assert filed is not None and filed.language is not None and scene.language is not None
    assert torch.equal(filed.cloud.group, scene.cloud.group) and filed.cloud.means is torn.cloud.means
    assert filed.language.groups == scene.language.groups
    assert refiled(torn, Selection(Query(text="chair"), "found", ids), torn.cloud.ids[piece]) is None


@pytest.mark.parametrize("lift", [0.08, -0.15, pytest.param(0.5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("data", [d for d in CLEAN if d["op"] in ("insert", "replace") or d.get("place")],
                         ids=lambda d: f"{d['op']} {sorted(d)}")  # fmt: skip
def test_a_floating_or_sunk_thing_is_caught(corner: Scene, context: Context, data: Json, lift: float) -> None:
    after = edited(corner, data, context)
    fresh = after.cloud.ids > int(corner.cloud.ids.max())
    if not bool(fresh.any()):
        fresh = after.cloud.group == (VASE if data["target"] == {"text": "vase"} else CHAIR)
    found = judge(corner, changed(after, fresh, "means", lambda m: m + torch.tensor([0, 0, lift])), data, context)
    assert failed(found) & {"carried", "free of others"}


def test_a_colour_that_bled_is_caught(corner: Scene, context: Context) -> None:
    data: Json = {"op": "recolor", "target": A_CHAIR, "color": "teal"}
    after = edited(corner, data, context)
    near = (after.cloud.group == FLOOR) & (
        torch.linalg.vector_norm(after.cloud.means - torch.tensor([-1.6, 0, 0]), dim=1) < 0.6
    )
    assert int(near.sum()) > 10
    found = judge(corner, changed(after, near, "sh", lambda sh: sh * 0.5), data, context)
    assert failed(found) == {"nothing else changed"}


def test_a_colour_nobody_sees_is_caught(corner: Scene, context: Context) -> None:
    data: Json = {"op": "recolor", "target": A_CHAIR, "color": "teal"}
    chair = corner.cloud.group == CHAIR
    found = judge(corner, changed(corner, chair, "sh", lambda sh: sh + 1e-3), data, context)
    assert failed(found) == {"seen in the colour", "hue as asked"}


def test_a_target_that_changed_in_another_way_is_caught(corner: Scene, context: Context) -> None:
    data: Json = {"op": "recolor", "target": A_CHAIR, "color": "teal"}
    after = edited(corner, data, context)
    chair = after.cloud.group == CHAIR
    for column, by in (("means", 0.01), ("scales", 0.001), ("opacities", -0.01)):
        found = judge(corner, changed(after, chair, column, lambda v, by=by: v + by), data, context)  # type: ignore[misc]
        assert "nothing else changed" in failed(found)


def test_another_kind_than_asked_is_caught(corner: Scene, context: Context) -> None:
    """The embedded encoder looks at what was inserted."""
    after = edited(corner, {"op": "insert", "asset": "guitar"}, context)
    found = judge(corner, after, {"op": "insert", "asset": "armchair"}, context)
    assert "looks as named" in failed(found)


def test_things_that_came_apart_or_went_elsewhere_are_caught(corner: Scene, context: Context) -> None:
    data: Json = {"op": "move", "target": A_CHAIR, "direction": "left", "distance": {"value": 30, "unit": "cm"}}
    after = edited(corner, data, context)
    chair = after.cloud.group == CHAIR
    spread = changed(after, chair, "means", lambda m: m * torch.tensor([1.3, 1.0, 1.0]))
    assert "kept its shape" in failed(judge(corner, spread, data, context))
    far = changed(after, chair, "means", lambda m: m + torch.tensor([0.0, 0.2, 0.0]))
    assert failed(judge(corner, far, data, context)) == {"moved as said"}


def test_changes_do_not_depend_on_the_order_of_rows(corner: Scene) -> None:
    order = torch.randperm(len(corner.cloud), generator=torch.Generator().manual_seed(3))
    same = changes_between(corner.cloud, corner.cloud[order])
    assert not bool(same.any.any()) and not len(same.added)
    fewer = changes_between(corner.cloud, corner.cloud[order[:100]])
    assert int(fewer.gone.sum()) == len(corner.cloud) - 100
    back = changes_between(corner.cloud[order[:100]], corner.cloud)
    assert len(back.added) == len(corner.cloud) - 100 and not bool(back.any.any())


def test_words_that_mean_nothing_in_the_scene_before_fail(corner: Scene, context: Context) -> None:
    found = judge(corner, corner, {"op": "delete", "target": {"text": "piano"}}, context)
    assert failed(found) == {"asked again"}


def test_a_scene_whose_rows_the_selection_lost_is_no_crash(corner: Scene, context: Context) -> None:
    empty = corner.replace(cloud=corner.cloud[torch.zeros(len(corner.cloud), dtype=torch.bool)])
    for data in CLEAN:
        found = judge(corner, empty, data, context)
        assert not found.passed, data
    assert bool(mask_of(corner.cloud, corner.cloud.ids).all())
