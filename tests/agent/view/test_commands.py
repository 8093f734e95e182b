"""Slash commands in the page: those of the chat, with files in the scene's folder."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.session import Session
from scenewright.agent.terminal.slash_commands import SLASH_COMMANDS
from scenewright.agent.toolbox.folder import Folder
from scenewright.agent.view.commands import PageCommands
from scenewright.benchmarks._view.client import Page, Server, asked, same, served
from scenewright.gaussians.files import load
from scenewright.gaussians.scene import Scene


@pytest.fixture
def server(boxes: Scene, encoder: Any, tmp_path: Path) -> Iterator[Server]:
    with served(Session(boxes, encoder=encoder, log=tmp_path / "log.jsonl"), Folder(tmp_path)) as made:
        yield made


@pytest.fixture
def page(server: Server) -> Iterator[Page]:
    with Page(server.port, server.cookie) as made:
        yield made


def test_commands_do_what_they_do_in_the_chat(server: Server, page: Page) -> None:
    session = server.hub.session
    told = page.ask("say", text="/why the green thing")
    assert told["ok"] and [told["text"], *told["lines"]] == session.explain("the green thing").lines()
    assert page.ask("say", text="/select the green thing")["ok"]
    assert page.state["selection"]["groups"] == [1]
    assert page.ask("say", text="make it blue")["ok"] and page.state["can_undo"]
    plan = page.ask("say", text="/plan")
    assert "recolor" in plan["text"] and session.done == ("make it blue",)
    assert page.ask("say", text="/undo")["ok"] and not page.state["can_undo"] and same(page, server.hub)
    again = page.ask("say", text="/redo")
    assert again["ok"] and page.state["can_undo"] and same(page, server.hub)
    assert "make it blue" in page.ask("say", text="/history")["text"]
    things = page.ask("say", text="/things")
    assert [things["text"], *things["lines"]][1] == "1 · blue box · 343"


@pytest.mark.slow
def test_a_preview_has_a_picture_and_a_view_moves_the_camera(server: Server, page: Page) -> None:
    before = page.state["digest"]
    tried = page.ask("say", text="/preview remove the green thing")
    assert tried["ok"] and page.state["digest"] == before
    assert asked(server.port, tried["pictures"][0], {"Cookie": server.cookie})[0] == 200
    camera = page.ask("say", text="/show 0,-4,2:0,0,0")["camera"]
    assert camera["position"] == pytest.approx([0, -4, 2])


def test_files_stay_in_the_folder_of_the_scene(server: Server, page: Page, tmp_path: Path, boxes: Scene) -> None:
    assert page.ask("say", text="/save out.ply")["ok"]
    assert len(load(tmp_path / "out.ply").cloud) == len(boxes.cloud)
    assert not page.ask("say", text="/save out.ply")["ok"]  # it exists
    assert page.ask("say", text="/save out.ply --force")["ok"]
    page.ask("say", text="/select the green thing")
    assert page.ask("say", text="/export part.ply")["ok"]
    assert len(load(tmp_path / "part.ply").cloud) == 343
    for name in ("/tmp/out.ply", "../out.ply", "~/out.ply", "a" * 300 + ".ply"):
        for command in ("save", "export", "reference"):
            refused = page.ask("say", text=f"/{command} {name}")
            assert refused["type"] == "said" and not refused["ok"], (command, name, refused)
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix == ".ply") == ["out.ply", "part.ply"]


def test_help_lists_what_works_here_and_the_rest_says_what_to_do_instead(page: Page) -> None:
    told = page.ask("say", text="/help")
    listed = {line.split(" · ")[0] for line in told["lines"] if line.startswith("/")}
    assert listed == set(SLASH_COMMANDS) - set(PageCommands.elsewhere)
    leave = page.ask("say", text="/quit")
    assert not leave["ok"] and "close the tab" in leave["text"]
    assert "/help" in page.ask("say", text="/nonsense")["text"]
