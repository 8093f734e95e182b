"""Merging and splitting things: laws of the partition, names, what is refused, and that nothing looks different."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.group_index import index_groups
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)  # as the `corner` fixture numbers them


def do(scene: Scene, context: Context, op: str, **fields: Any) -> Done:
    return carry_out(scene, parse({"op": op, **fields}), context)


def ids_of(scene: Scene, *groups: int) -> set[int]:
    assert scene.language is not None
    leaves = [leaf for g in groups for leaf in scene.language.leaves(g)]
    return set(index_groups(scene.cloud).ids_of(leaves).tolist())


def iou(one: set[int], other: set[int]) -> float:
    return len(one & other) / len(one | other)


def test_merged_things_are_one_thing_of_the_largest_name(corner: Scene, context: Context) -> None:
    done = do(corner, context, "merge", target={"groups": [TABLE, VASE], "pick": "all"})
    (whole,) = done.selection.groups
    assert ids_of(done.scene, whole) == ids_of(corner, TABLE, VASE)
    assert done.scene.cloud.digest() == corner.cloud.digest()
    assert done.scene.language is not None
    row = done.scene.language.groups[whole]
    assert (row.label, row.named_by, row.count) == ("table", "user", len(ids_of(corner, TABLE, VASE)))
    named = do(corner, context, "merge", target={"groups": [TABLE, VASE], "pick": "all"}, name="still life")
    assert named.scene.language is not None
    assert named.scene.language.groups[named.selection.groups[0]].label == "still life"


def test_what_was_merged_is_split_along_the_same_border(corner: Scene, context: Context) -> None:
    merged = do(corner, context, "merge", target={"groups": [TABLE, VASE], "pick": "all"})
    split = do(merged.scene, context, "split", target={"groups": list(merged.selection.groups)})
    big, small = split.selection.groups
    assert iou(ids_of(split.scene, big), ids_of(corner, TABLE)) > 0.9
    assert iou(ids_of(split.scene, small), ids_of(corner, VASE)) > 0.9


@pytest.mark.parametrize("into", [2, 3])
def test_pieces_partition_the_thing_and_nothing_looks_different(corner: Scene, context: Context, into: int) -> None:
    done = do(corner, context, "split", target={"text": "armchair"} if into == 3 else {"text": "table"}, into=into)
    before = ids_of(corner, ARMCHAIR if into == 3 else TABLE)
    pieces = [ids_of(done.scene, g) for g in done.selection.groups]
    assert len(pieces) == into and sum(map(len, pieces)) == len(before) and set.union(*pieces) == before
    assert set(done.receipt.columns) == {"group"}
    assert [len(p) for p in pieces] == sorted((len(p) for p in pieces), reverse=True)
    again = do(corner, context, "split", target={"text": "armchair"} if into == 3 else {"text": "table"}, into=into)
    assert again.scene.cloud.digest() == done.scene.cloud.digest()


def test_names_go_to_the_pieces_that_look_like_them(corner: Scene, context: Context) -> None:
    """Whatever the order of the names, with an encoder that sees."""
    from dataclasses import replace

    encoder = encoders.load("embedded")
    assert corner.language is not None
    width = torch.zeros(len(corner.language.groups), encoder.dim).numpy()
    table = replace(corner.language, embeddings=width, encoder=encoder.fingerprint)
    scene = corner.replace(language=table)
    seeing = replace(context, encoder=encoder)
    merged = do(scene, seeing, "merge", target={"groups": [TABLE, VASE], "pick": "all"})
    for names in (["vase", "table"], ["table", "vase"]):
        done = do(merged.scene, seeing, "split", target={"groups": list(merged.selection.groups)}, names=names)
        assert done.scene.language is not None
        assert [done.scene.language.groups[g].label for g in done.selection.groups] == ["table", "vase"]


def test_what_cannot_be_done_is_told(corner: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="two things or more"):
        do(corner, context, "merge", target={"text": "table"})
    with pytest.raises(InstructionError, match="floor, walls and ceiling"):
        do(corner, context, "merge", target={"groups": [TABLE, FLOOR], "pick": "all"})
    with pytest.raises(InstructionError, match="one thing is split at a time"):
        do(corner, context, "split", target={"groups": [TABLE, VASE], "pick": "all"})
    with pytest.raises(InstructionError, match="no border"):
        do(corner, context, "split", target={"text": "vase"}, into=8)
    bare = corner.replace(language=None)
    chosen = context.resolve(corner, parse({"op": "select", "target": {"text": "table"}}).query())  # type: ignore[arg-type]
    with pytest.raises(InstructionError, match="embed it first"):
        carry_out(bare, parse({"op": "split", "target": {"text": "table"}}), context, chosen)
