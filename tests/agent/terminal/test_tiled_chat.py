"""The chat on a scene in tiles: edits are in the folder at once, and what needs all of it in memory says so."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import pytest
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput

from scenewright.agent.session import tiled
from scenewright.agent.session.session import Session
from scenewright.agent.session.tiled import TiledSession
from scenewright.agent.terminal.output import Terminal
from scenewright.agent.terminal.tiled_chat import TiledChat
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import Tiles
from scenewright.gaussians.world import facing

SMALL, LARGE = 700_000, 10**7  # bytes: those of two boxes, and of more than the room


@pytest.fixture(autouse=True)
def unsynced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda handle: None)


@pytest.fixture
def folder(boxes: Scene, tmp_path: Path) -> Path:
    save(boxes, tmp_path / "boxes.ply")
    save_field(boxes, tmp_path / "boxes.ply")
    return make([tmp_path / "boxes.ply"], tmp_path / "boxes.tiles", most=400).folder


def talk(folder: Path, encoder: Any, *lines: str, memory: int = SMALL) -> tuple[str, str]:
    """What a chat prints after these lines were typed, on stdout and stderr."""
    terminal = Terminal(io.StringIO(), io.StringIO())
    session = TiledSession(Tiles.open(folder), memory, rows=2000, encoder=encoder, planner="grammar")
    with create_pipe_input() as pipe:
        pipe.send_text("".join(f"{line}\r" for line in (*lines, "/quit")))
        TiledChat(session, terminal, pipe, DummyOutput()).run()
    assert isinstance(terminal.out, io.StringIO) and isinstance(terminal.err, io.StringIO)
    return terminal.out.getvalue(), terminal.err.getvalue()


@pytest.mark.slow
def test_edits_are_in_the_folder_and_undo_reaches_those_of_earlier_chats(
    boxes: Scene, folder: Path, encoder: Any, tmp_path: Path
) -> None:
    first = Tiles.open(folder).digest()
    words = "make the green thing blue", "delete the red thing", "the left one", "/history"
    out, err = talk(folder, encoder, *words, memory=LARGE)
    assert "edits are in the folder at once" in err
    assert "not saved" not in err and "Which one?" in out
    assert "  1. make the green thing blue" in out and "  2. delete the red thing" in out
    memory = Session(load(tmp_path / "boxes.ply"), encoder=encoder, planner="grammar")
    memory.do("make the green thing blue")
    with pytest.raises(Exception, match="red"):
        memory.do("delete the red thing")
    memory.answer("the left one")
    assert Tiles.open(folder).every_row().digest() == memory.scene.cloud.digest()
    out, _ = talk(folder, encoder, "undo", "/undo", "/undo", f"/save {tmp_path / 'back.ply'}")
    assert "undo: make the green thing blue" in out and "nothing to undo" in out
    assert Tiles.open(folder).digest() == first
    assert (tmp_path / "back.ply").read_bytes() == (tmp_path / "boxes.ply").read_bytes()


def test_questions_are_answered_by_samples_as_in_memory(
    folder: Path, encoder: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tiled, "FACING_ROWS", 100)
    monkeypatch.setattr(facing, "SAMPLE", 100)
    asked = "how many red things are there?", "how wide is the green thing?", "what is left of the green thing?"
    session = TiledSession(Tiles.open(folder), SMALL, encoder=encoder, planner="grammar")
    known = Session(load(tmp_path / "boxes.ply"), encoder=encoder, planner="grammar", viewer=session.viewer)
    assert [session.ask(text) for text in asked] == [known.ask(text) for text in asked]
    assert session.survey().graph == known.survey().graph and 300 < len(session.scene.cloud) < 700
    assert "The green box is 60 cm wide." in talk(folder, encoder, asked[1])[0]


def test_what_needs_the_whole_scene_says_what_to_do(folder: Path, encoder: Any) -> None:
    out, _ = talk(folder, encoder, "/preview delete the green thing", "/grow", "/export a.glb", "make everything red")
    assert "/plan" in out and "/save" in out and "--save chair.glb" in out and "--memory" in out
    assert not Tiles.open(folder).head.past


def test_the_camera_moves_and_what_it_sees_is_drawn_of_the_tiles(folder: Path, encoder: Any) -> None:
    out, _ = talk(
        folder,
        encoder,
        "/show 0",
        "look at the green thing",
        "closer",
        "/select the green thing",
        "closer",
        memory=LARGE,
    )
    assert "looking at the green thing" in out and "closer" in out
    assert len([line for line in out.split("\n") if len(line) >= 40]) > 40  # pictures, in letters
