"""Embedding by blocks: blocks hold what is near, pieces of one truth join to it again, and what stopped goes on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree
from street import saved_street

from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.tiles import blocks, changing, embedding
from scenewright.gaussians.tiles.blocks import Parts, block_of, divided, margin_of, sampled
from scenewright.gaussians.tiles.joining import Piece, join
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import PIECES, Tiles
from scenewright.gaussians.world.box import Box

MARGIN = 1.0
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Known:
    """An encoder of which only the name and the width are asked."""

    fingerprint, dim = "test:1", 2


@pytest.fixture
def tiles(tmp_path: Path) -> Tiles:
    return make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)


def told(truth: Scene) -> Any:
    """An `embed` that gives each row the group that it has in truth, under numbers of the block's own."""

    def embed(scene: Scene, encoder: Any, progress: Any) -> Scene:
        assert truth.language is not None and (scene.cloud.group == -1).all()
        group = truth.cloud.group[scene.cloud.ids].numpy()
        here = np.random.default_rng(len(group)).permutation(np.unique(group[group >= 0]))
        number = np.full(len(truth.language.groups) + 1, -1, np.int32)
        number[here] = np.arange(len(here))
        rows = [
            replace(truth.language.groups[g], id=k, count=int((group == g).sum())) for k, g in enumerate(here.tolist())
        ]
        field = LanguageField(tuple(rows), truth.language.embeddings[here], "test:1")
        return scene.replace(cloud=scene.cloud.replace(group=torch.from_numpy(number[group])), language=field)

    return embed


def embedded(tiles: Tiles, monkeypatch: pytest.MonkeyPatch, embed: Any) -> Tiles:
    """The tiles after `embed_tiles` with parts that cut through things."""
    monkeypatch.setattr(blocks, "ROWS", 2500)
    monkeypatch.setattr(blocks, "NARROW", 1.0)
    monkeypatch.setattr(embedding, "embed", embed)
    monkeypatch.setattr(embedding, "named", lambda field, *_, **__: field)
    encoder: Any = Known()
    return embedding.embed_tiles(tiles, encoder, 1 << 30, margin=MARGIN)


def same_partition(found: torch.Tensor, truth: torch.Tensor) -> bool:
    pairs = torch.unique(torch.stack([found, truth.long()], dim=1), dim=0)
    return len(pairs) == len(torch.unique(found)) == len(torch.unique(truth))


@pytest.fixture
def parts(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> Parts:
    monkeypatch.setattr(blocks, "ROWS", 800)
    return divided(tiles, sampled(tiles, 10**6), 2.0)


def test_parts_are_divided_where_little_is_and_hold_every_row_once(tiles: Tiles, parts: Parts) -> None:
    assert len(parts) == 3 and parts.held.sum() == len(tiles)  # the three rooms of the street, which are no wider
    rooms = parts.tree.leaf_of(tiles.every_row().means.numpy())
    truth = load(tiles.folder.with_name("street.ply")).cloud.group.numpy()
    assert all(len(np.unique(rooms[truth == g])) == 1 for g in range(truth.max() + 1))


def test_a_block_holds_its_part_and_every_row_within_the_margin(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "ROWS", 800)
    parts, whole = divided(tiles, sampled(tiles, 10**6), MARGIN / 2), tiles.every_row()
    assert len(parts) > 5
    for number in (0, 3):
        block = block_of(tiles, parts, number, MARGIN, 10**6)
        own = torch.from_numpy(block.inside)
        assert np.array_equal(block.inside, parts.tree.leaf_of(block.cloud.means.numpy()) == number)
        assert int(own.sum()) == parts.held[:, number].sum()
        away = cKDTree(whole.means[block.cloud.ids[own]]).query(whole.means)[0]
        held = np.isin(whole.ids.numpy(), block.cloud.ids.numpy())
        assert held[away <= MARGIN].all() and not held[away > 2 * np.sqrt(3) * MARGIN].any()
        assert torch.equal(block.cloud.means, whole.means[block.cloud.ids]) and (np.diff(block.cloud.ids) > 0).all()
        for k in np.unique(block.tile).tolist():
            mine = block.tile == k
            assert np.array_equal(tiles.column(k, "ids")[block.row[mine]], block.cloud.ids[torch.from_numpy(mine)])


def test_a_block_that_does_not_fit_gets_a_narrower_margin_or_is_refused(tiles: Tiles, parts: Parts) -> None:
    wide = block_of(tiles, parts, 1, 4.0, 10**6)
    rows = int(parts.held[:, 1].sum())
    narrow = block_of(tiles, parts, 1, 4.0, (len(wide.cloud) + rows) // 2)
    assert rows < len(narrow.cloud) <= (len(wide.cloud) + rows) // 2 and narrow.margin < 4.0
    with pytest.raises(UserError, match="--memory"):
        block_of(tiles, parts, 1, MARGIN, rows - 1)


def test_margins_follow_the_scale_or_the_tiles(tiles: Tiles) -> None:
    sample = sampled(tiles, 2000)
    assert margin_of(sample, 0.5) == 2.0
    assert 0.1 < margin_of(sample, None) < 2.0


@pytest.mark.slow
def test_groups_that_all_blocks_see_alike_are_those_of_the_whole_and_can_be_undone(
    tiles: Tiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = load(tiles.folder.with_name("street.ply"))
    first = tiles.digest()
    done = embedded(tiles, monkeypatch, told(truth))
    now = done.every_row()
    assert same_partition(now.group.long(), truth.cloud.group)
    assert done.field is not None and truth.language is not None
    assert len(done.field.groups) == len(truth.language.groups)
    levels = [g.level for g in done.field.groups]
    assert levels == sorted(levels, reverse=True)  # structure comes first
    for g in done.field.groups:
        held = now[now.group == g.id]
        old = truth.language.groups[int(truth.cloud.group[now.group == g.id][0])]
        assert (g.label, g.count) == (old.label, len(held)) == (old.label, done.count([g.id]))
        assert g.box == box_of(held, done.frame) and g.lab == lab_of_cloud(held)
    assert all(torch.equal(c, getattr(now, n)) for n, c in truth.cloud.columns() if n != "group")
    assert not (done.folder / PIECES).exists() and done.head.present.text == "embed"
    assert changing.undo(done.folder)[0].digest() == first


def test_what_one_block_sees_otherwise_at_its_border_goes_to_what_the_other_sees_there() -> None:
    """A chair, 70 of its rows in the first tile and 30 in the second, whose block sees them as one with half a rug."""
    chair, desk, rug, none = 0, 1, 2, -1
    near, far = np.arange(130, dtype=np.int32), np.arange(330, dtype=np.int32)
    tile = np.repeat(np.int32([0, 1]), 130)
    group = np.repeat(np.int32([chair, rug, chair, desk]), [70, 60, 30, 100])
    first = Piece(table(3), tile, np.concatenate([near, near]), group, tile == 0)
    desk_here, other = 0, 1
    tile = np.repeat(np.int32([0, 1]), [130, 330])
    group = np.repeat(np.int32([other, none, other, other, desk_here]), [35, 35, 60, 30, 300])
    second = Piece(table(2), tile, np.concatenate([near, far]), group, tile == 1)
    joined = join([first, second], [130, 330])
    assert joined.whole.tolist() == [0, 1, 2, 1, 4]
    columns = [joined.column(k).tolist() for k in (0, 1)]
    assert columns == [[0] * 70 + [2] * 60, [0] * 30 + [1] * 300]


def table(count: int) -> LanguageField:
    groups = tuple(
        Group(k, "object", -1, "", 0.0, Box((0, 0, 0), AXES, (1, 1, 1)), (50, 0, 0), 1, 1, 1.0) for k in range(count)
    )
    return LanguageField(groups, np.zeros((count, 2), np.float32), "test:1")


@pytest.mark.slow
def test_an_embedding_that_was_stopped_goes_on_where_it_stopped(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    truth = load(tiles.folder.with_name("street.ply"))
    made: list[int] = []
    known = told(truth)

    def stops(scene: Scene, encoder: Any, progress: Any) -> Scene:
        if len(made) == 3:
            raise KeyboardInterrupt
        made.append(len(scene.cloud))
        return known(scene, encoder, progress)  # type: ignore[no-any-return]

    first = tiles.digest()
    with pytest.raises(KeyboardInterrupt):
        embedded(tiles, monkeypatch, stops)
    assert Tiles.open(tiles.folder).digest() == first
    kept = sorted((tiles.folder / PIECES).glob("*/rows.*"))
    assert len(kept) == 3
    kept[0].write_bytes(b"torn")  # told by its hash, and made again
    again: list[int] = []

    def counts(scene: Scene, encoder: Any, progress: Any) -> Scene:
        again.append(len(scene.cloud))
        return known(scene, encoder, progress)  # type: ignore[no-any-return]

    done = embedded(tiles, monkeypatch, counts)
    assert done.field is not None and f"embedded in {len(again) + 2} blocks" in done.field.notes[0] and len(again) > 2
    assert same_partition(done.every_row().group.long(), truth.cloud.group)


def test_another_program_that_changed_the_scene_is_told(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    truth = load(tiles.folder.with_name("street.ply"))
    embedded(tiles, monkeypatch, told(truth))
    with pytest.raises(FileError, match="another program"):
        embedded(tiles, monkeypatch, told(truth))
