"""Places and sizes where no room, no support and no scale is known, as in captures of one thing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import concat
from scenewright.gaussians.errors import UnconfirmedError
from scenewright.gaussians.language.field.measure import box_of
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box, overlap
from scenewright.tools.carried_objects import carried_on
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.new_objects import fitted, scene_scale
from scenewright.tools.operation import Context
from scenewright.tools.placement.bodies import Body, body_of
from scenewright.tools.registry import parse

from .conftest import Thing, build

TABLE, CHAIR, ARMCHAIR, VASE = range(4)
UP = np.array([0.0, 0.0, 1.0])


def do(scene: Scene, context: Context, op: str, **fields: Any) -> Done:
    return carry_out(scene, parse({"op": op, **fields}), context)


def body(scene: Scene, group: int) -> Body:
    return body_of(scene, (scene.cloud.group == group).nonzero().squeeze(1), group)


def alone(floor: float | None, kind: str = "armchair") -> Scene:
    """One thing, and nothing seen around it."""
    scene = build([Thing(kind, "red", (0.0, 0.0, 0.0))])
    assert scene.language is not None
    own = scene.cloud[(scene.cloud.group == 0).nonzero().squeeze(1)]
    language = replace(scene.language, groups=scene.language.groups[:1], embeddings=scene.language.embeddings[:1])
    return scene.replace(cloud=own, language=language, frame=Frame((0, 0, 1), floor, 1.0, "given", "given"))


@pytest.mark.parametrize("floor", [0.0, None])
def test_a_thing_that_stands_alone_can_be_copied_and_joined(floor: float | None, context: Context) -> None:
    scene = alone(floor)
    done = do(scene, context, "duplicate", target={"text": "armchair"}, count=2)
    boxes = [body(done.scene, g).box for g in range(3)]
    assert [b.bottom(UP) for b in boxes] == pytest.approx([boxes[0].bottom(UP)] * 3, abs=0.02)
    assert overlap(boxes[0], boxes[1]) == overlap(boxes[1], boxes[2]) == overlap(boxes[0], boxes[2]) == 0
    assert any("no room was seen" in n or "nothing was seen" in n for n in done.receipt.notes)
    place = {"relation": "next_to", "anchors": [{"text": "armchair"}]}
    beside = do(scene, context, "insert", asset="stool", place=place)
    assert body(beside.scene, 1).box.bottom(UP) == pytest.approx(0.0, abs=0.02)
    assert overlap(body(beside.scene, 0).box, body(beside.scene, 1).box) == 0


def in_the_air(corner: Scene, up: float, aside: float = 0.0) -> Scene:
    """The corner with its vase lifted, which then stands on nothing."""
    rows = corner.cloud.group == VASE
    means = corner.cloud.means.clone()
    means[rows] += torch.tensor([aside, 0.0, up])
    cloud = corner.cloud.replace(means=means)
    assert corner.language is not None
    groups = list(corner.language.groups)
    groups[VASE] = replace(groups[VASE], box=box_of(cloud, corner.frame, rows.nonzero().squeeze(1)))
    return corner.replace(cloud=cloud, language=replace(corner.language, groups=tuple(groups)))


def test_what_replaces_a_thing_in_the_air_stands_on_what_is_below(corner: Scene, context: Context) -> None:
    scene = in_the_air(corner, 0.3)
    done = do(scene, context, "replace", target={"text": "vase"}, asset="mug")
    new = max(int(g) for g in torch.unique(done.scene.cloud.group))
    box, table = body(done.scene, new).box, body(done.scene, TABLE).box
    assert box.bottom(UP) == pytest.approx(table.top(UP), abs=0.02)
    assert np.abs(table.local(np.array([box.center]))[0][:2]).max() < max(table.size) / 2


def unknown(scene: Scene, score: float, **labels: str) -> Scene:
    """The scene with an unknown scale, sixfold in size, and names of that probability."""
    assert scene.language is not None
    groups = []
    for g in scene.language.groups:
        box = Box(tuple(6 * c for c in g.box.center), g.box.axes, tuple(6 * s for s in g.box.size))  # type: ignore[arg-type]
        groups.append(replace(g, box=box, label=labels.get(g.label, g.label), label_score=score))
    cloud = scene.cloud.replace(means=scene.cloud.means * 6, scales=scene.cloud.scales * 6)
    return scene.replace(
        cloud=cloud, language=replace(scene.language, groups=tuple(groups)), frame=Frame((0, 0, 1), 0.0, None)
    )


def test_the_scale_is_told_by_things_that_have_the_shape_of_their_name(corner: Scene) -> None:
    sure = scene_scale(unknown(corner, 0.9))
    assert sure.units_per_metre == pytest.approx(6, rel=0.2) and not sure.guessed
    # A vase that is called a bed has neither its length nor its height: it says nothing, whatever its probability.
    wrong = scene_scale(unknown(corner, 0.9, vase="floor lamp"))
    assert wrong.units_per_metre == pytest.approx(6, rel=0.2) and "floor lamp" not in wrong.notes[0]
    doubtful = unknown(corner, 0.2)
    assert scene_scale(doubtful).guessed
    # What the user calls a thing counts, although the field is not sure of it.
    told = scene_scale(doubtful, [(body(doubtful, ARMCHAIR), "armchair")])
    assert told.units_per_metre == pytest.approx(6, rel=0.25) and not told.guessed


def test_what_replaces_a_thing_of_unknown_scale_is_as_large(corner: Scene, context: Context) -> None:
    scene = unknown(corner, 0.2, armchair="thing")
    was = body(scene, ARMCHAIR).box
    done = do(scene, context, "replace", target={"text": "thing"}, asset="chair")
    new = max(int(g) for g in torch.unique(done.scene.cloud.group))
    now = body(done.scene, new).box
    assert max(now.size) == pytest.approx(max(was.size), rel=0.35)
    assert any("as large as what it replaces" in note for note in done.receipt.notes)
    known = scene_scale(corner)
    assert fitted(known, "chair", was) is known


def test_a_crown_that_only_its_trunk_holds_goes_along(corner: Scene) -> None:
    """It stands on no flat top: its underside is below the trunk's top, and its middle is aside."""
    own = corner.cloud[(corner.cloud.group == VASE).nonzero().squeeze(1)]
    size = body(corner, VASE).box.size
    first = int(corner.cloud.ids.max()) + 1
    crown = own.replace(
        means=own.means + torch.tensor([0.45 * size[0], 0.0, 0.55 * size[2]]),
        ids=torch.arange(first, first + len(own)),
        group=torch.full_like(own.group, 5),
    )
    assert corner.language is not None
    group = replace(corner.language.groups[VASE], id=5, label="crown", label_score=0.1, box=box_of(crown, corner.frame))
    vectors = np.concatenate([corner.language.embeddings, corner.language.embeddings[:1]])
    language = replace(corner.language, groups=(*corner.language.groups, group), embeddings=vectors)
    scene = corner.replace(cloud=concat([corner.cloud, crown]), language=language)
    assert set(carried_on(scene, body(scene, TABLE))) == {VASE, 5}
    assert carried_on(scene, body(scene, CHAIR)) == ()


def test_a_selection_scattered_over_a_capture_asks_first(corner: Scene, context: Context) -> None:
    """Where the scale is unknown, as in captures; a thing in one piece, and what was confirmed, is taken."""
    scene = unknown(corner, 0.6)
    rows = scene.cloud.group == CHAIR
    half = rows.nonzero().squeeze(1)[::2]
    means = scene.cloud.means.clone()
    means[half] += torch.tensor([0.0, 30.0, 10.0])
    torn = scene.replace(cloud=scene.cloud.replace(means=means))
    with pytest.raises(UnconfirmedError, match="in one piece"):
        do(torn, context, "rotate", target={"text": "chair"}, degrees=20)
    for whole, target in ((scene, {"text": "chair"}), (torn, {"text": "chair", "confirmed": True})):
        assert do(whole, context, "recolor", target=target, color="red").receipt.passed
