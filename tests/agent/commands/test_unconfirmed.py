"""`edit`, `select` and `plan` on what is chosen without a confirmed name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.files import load

ORDER = "delete the green gizmo"


def test_without_a_terminal_an_edit_is_refused_and_says_how_to_go_on(
    call: Any, gizmo_room: Path, tmp_path: Path
) -> None:
    answer = call("edit", gizmo_room, ORDER, "-o", tmp_path / "o.ply")
    assert answer.code == 3 and not (tmp_path / "o.ply").exists()
    assert "--yes" in answer.err and "green" in answer.err and "nothing was changed" in answer.err
    data = call("edit", gizmo_room, ORDER, "-o", tmp_path / "o.ply", "--json")
    assert data.code == 3 and data.data["verdict"] == "unconfirmed" and data.data["candidates"][0]["group"] == 1


@pytest.mark.slow
def test_yes_goes_on_with_what_was_chosen(call: Any, gizmo_room: Path, tmp_path: Path) -> None:
    answer = call("edit", gizmo_room, ORDER, "-o", tmp_path / "o.ply", "--yes", "--log", tmp_path / "log.jsonl")
    assert answer.code == 0, answer.err
    assert len(load(tmp_path / "o.ply").cloud) == len(load(gizmo_room).cloud) - 343
    again = call("edit", gizmo_room, "--replay", tmp_path / "log.jsonl", "-o", tmp_path / "again.ply")
    assert again.code == 0, again.err  # the same scene: the confirmation that was logged holds


@pytest.mark.parametrize("said", [True, False])
@pytest.mark.parametrize("dry", [(), ("--dry-run",)])
def test_on_a_terminal_the_user_is_asked(
    call: Any, gizmo_room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, said: bool, dry: tuple[str, ...]
) -> None:
    asked: list[str] = []
    monkeypatch.setattr(Terminal, "confirms", lambda self, question: asked.append(question) or said)
    answer = call("edit", gizmo_room, ORDER, "-o", tmp_path / "o.ply", *dry)
    assert len(asked) == 1 and "green" in asked[0] and "Go on with it?" in asked[0]
    assert answer.code == (0 if said else 3) and (tmp_path / "o.ply").exists() == (said and not dry)


def test_select_and_plan_tell_it(call: Any, gizmo_room: Path, tmp_path: Path) -> None:
    found = call("select", gizmo_room, "the green gizmo", "--json", "--ids", tmp_path / "ids.npy")
    assert found.code == 0 and found.data["verdict"] == "unconfirmed" and found.data["gaussians"] == 343
    assert call("select", gizmo_room, "the green gizmo").out.startswith("unconfirmed, 343 Gaussians")
    planned = call("plan", gizmo_room, ORDER, "--json")
    assert planned.code == 3 and planned.data["verdict"] == "unconfirmed" and "gizmo" in planned.data["reason"]


def test_a_question_is_not_answered_about_something_else(call: Any, gizmo_room: Path) -> None:
    answer = call("ask", gizmo_room, "is there a green gizmo?", "--json")
    assert answer.code in (0, 3) and answer.data["answer"] != "yes"
