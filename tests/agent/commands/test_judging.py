"""`edit --judge` and `chat --judge`: what is judged is told in JSON; a refused edit writes nothing."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from scenewright.tools import execute
from scenewright.tools.execute import Done

from .conftest import Answer

Call = Callable[..., Answer]
TEXT = "make the green thing blue"


@pytest.mark.parametrize("order", ["before", "after"])
def test_edit_tells_what_was_judged(call: Call, room: Path, tmp_path: Path, order: str) -> None:
    words = ["--judge", TEXT] if order == "before" else [TEXT, "--judge"]
    answer = call("edit", room, *words, "-o", tmp_path / "out.ply", "--json")
    assert answer.code == 0, answer.err
    judged = answer.data["receipts"][0]["judged"]
    assert judged["judge"] == "built-in" and all(c["passed"] for c in judged["checks"]) and not judged["repairs"]


def test_a_refused_edit_writes_nothing(call: Call, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = execute.carry_out

    def unchanged(scene: Any, *args: Any, **how: Any) -> Done:
        return first(scene, *args, **how)._replace(scene=scene)

    monkeypatch.setattr(execute, "carry_out", unchanged)
    answer = call("edit", room, TEXT, "-o", tmp_path / "out.ply", "--judge")
    assert answer.code == 3 and "judged a failure and taken back" in answer.err and "carried out again" in answer.err
    assert not (tmp_path / "out.ply").exists()


def test_an_unknown_judge_and_one_without_eyes_are_refused(call: Call, room: Path, tmp_path: Path) -> None:
    answer = call("edit", room, TEXT, "-o", tmp_path / "out.ply", "--judge=jury")
    assert answer.code == 2 and "there is no judge 'jury'" in answer.err
    answer = call("edit", room, TEXT, "-o", tmp_path / "out.ply", "--judge", "vlm")
    assert answer.code == 2 and "name one with --vlm" in answer.err


def test_the_chat_turns_the_judge_on_and_off(call: Call, room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = f"/judge\n{TEXT}\n/judge off\n/judge\n/judge nobody\n/quit\n"
    monkeypatch.setattr(sys, "stdin", io.StringIO(lines))
    rows = call("chat", room, "--judge", "--json").rows
    assert [r["judge"] for r in rows if "judge" in r] == ["built-in", "off", "off"]
    assert next(r for r in rows if "receipts" in r)["receipts"][0]["judged"]["judge"] == "built-in"
    assert any("there is no judge 'nobody'" in str(r) for r in rows)
