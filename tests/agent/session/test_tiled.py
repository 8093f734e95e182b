"""Edits of a scene in tiles give the bytes of the same edits in memory, from windows that hold a part of the scene."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
import torch
from street import saved_street

from scenewright.agent.session.session import Session
from scenewright.agent.session.tiled import TiledSession
from scenewright.gaussians.errors import AbsentError, AmbiguousError, UserError
from scenewright.gaussians.files import load as load_file
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import Tiles
from scenewright.planners.plan import EditPlan
from scenewright.tools.ops.delete import Delete
from scenewright.tools.ops.move import Move
from scenewright.tools.ops.opacity import Opacity
from scenewright.tools.ops.recolor import Recolor

PIANO, ARMCHAIRS = Query(groups=(20,)), Query(groups=(5, 12, 19))


@pytest.fixture(autouse=True)
def unsynced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda handle: None)


@pytest.fixture
def source(tmp_path: Path) -> Path:
    return saved_street(tmp_path)


def tiled(source: Path, encoder: Any, memory: int) -> TiledSession:
    made = make([source], source.with_suffix(".tiles"), most=1000, force=True)
    return TiledSession(made, memory, encoder=encoder, planner="grammar")


@pytest.mark.parametrize(
    "ops",
    [
        (Delete(target=PIANO), Recolor(target=ARMCHAIRS, color="blue")),
        pytest.param((Recolor(target=PIANO, color="teal"),), marks=pytest.mark.slow),
        pytest.param(
            (Recolor(target=ARMCHAIRS, adjust="darker"), Opacity(target=PIANO, value=0.5)), marks=pytest.mark.slow
        ),
        pytest.param(
            (
                Opacity(target=PIANO, value=0.5),
                Delete(target=PIANO, on_it="goes"),
                Recolor(target=ARMCHAIRS, color="#206040"),
            ),
            marks=pytest.mark.slow,
        ),
    ],
    ids=["both", "recolor", "two", "three"],
)
def test_an_edit_in_a_window_has_the_bytes_of_the_edit_in_memory(source: Path, encoder: Any, ops: Any) -> None:
    plan = EditPlan(instruction="edit", ops=ops, planner="said")
    whole = Session(load(source), encoder=encoder, planner="grammar")
    room = len(whole.scene.cloud) * 2 // 3
    session = tiled(source, encoder, room * 68 * 12)
    first = session.tiles.digest()
    known, found = whole.apply(plan), session.apply(plan)
    now = session.tiles.every_row()
    for name, column in whole.scene.cloud.columns():
        assert torch.equal(column, getattr(now, name)), name
    assert session.tiles.field is not None and whole.scene.language is not None
    assert session.tiles.field.groups == whole.scene.language.groups
    assert [r.total for r in found.receipts][-1] == [r.total for r in known.receipts][-1] == len(now)
    assert len(found.before.cloud) <= room
    session.undo()
    assert session.tiles.digest() == first
    session.redo()
    assert torch.equal(session.tiles.every_row().sh, now.sh)


@pytest.mark.slow
def test_what_looks_further_has_the_same_bytes_where_all_of_it_fits(source: Path, encoder: Any) -> None:
    plan = EditPlan(
        instruction="move", ops=(Move(target=PIANO, direction="left", distance={"value": 0.3}),), planner="said"
    )
    whole, session = Session(load(source), encoder=encoder), tiled(source, encoder, 1 << 30)
    whole.apply(plan)
    session.apply(plan)
    now = session.tiles.every_row()
    assert all(torch.equal(column, getattr(now, name)) for name, column in whole.scene.cloud.columns())


@pytest.mark.slow
def test_names_are_told_by_the_table_and_edits_of_earlier_sessions_can_be_undone(source: Path, encoder: Any) -> None:
    session = tiled(source, encoder, 1 << 30)
    found = session.select(Query(text="piano", groups=(20,)))
    assert found.verdict == "found" and len(found) == session.tiles.count([20])
    blue = Recolor(target=Query(last=True), color="blue")
    session.apply(EditPlan(instruction="make it blue", ops=(blue,), planner=""))
    again = TiledSession(Tiles.open(session.tiles.folder), 1 << 30, encoder=encoder)
    assert again.do("undo").text == "undo: make it blue"
    assert again.do("redo").text == "redo: make it blue"
    with pytest.raises(UserError, match="nothing to redo"):
        again.do("redo")


@pytest.mark.slow
def test_what_does_not_fit_or_is_not_there_is_told_and_nothing_changes(source: Path, encoder: Any) -> None:
    session = tiled(source, encoder, 300_000)
    first = session.tiles.digest()
    with pytest.raises(UserError, match=r"Gaussians in memory.*--memory"):
        red = Recolor(target=Query(text="everything"), color="red")
        session.apply(EditPlan(instruction="x", ops=(red,), planner=""))
    with pytest.raises(AbsentError):
        session.apply(EditPlan(instruction="x", ops=(Delete(target=Query(groups=(99,))),), planner=""))
    assert session.tiles.digest() == first and not Tiles.open(session.tiles.folder).head.past


@pytest.mark.slow
def test_tiles_without_names_say_what_to_do(source: Path, encoder: Any, tmp_path: Path) -> None:
    save(load_file(source), tmp_path / "bare.ply")
    session = tiled(tmp_path / "bare.ply", encoder, 1 << 30)
    with pytest.raises(UserError, match="scenewright embed"):
        session.select(Query(text="piano"))


@pytest.mark.slow
def test_several_matches_are_a_question(source: Path, encoder: Any) -> None:
    session = tiled(source, encoder, 1 << 30)
    with pytest.raises(AmbiguousError):
        session.apply(
            EditPlan(instruction="x", ops=(Recolor(target=Query(text="", colors=("red",)), color="blue"),), planner="")
        )
    assert session.question is not None and len(session.question.candidates) == 3
    plan = session.answered("2")
    result = session.apply(plan)
    assert result.selection is not None and result.selection.groups == (12,)
