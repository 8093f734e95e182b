"""The conversation: on prompt_toolkit's own test terminal, and on a pipe."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from prompt_toolkit.document import Document
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput

from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import COMMANDS, Chat
from scenewright.agent.terminal.completion import ChatCompleter
from scenewright.agent.terminal.input_lines import InputLines
from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.scene import Scene


def _talk(scene: Scene, encoder: Any, *lines: str, log: Path | None = None) -> tuple[Session, str, str]:
    """The session, stdout and stderr after these lines were typed."""
    terminal = Terminal(io.StringIO(), io.StringIO())
    session = Session(scene, encoder=encoder, log=log)
    with create_pipe_input() as pipe:
        pipe.send_text("".join(f"{line}\r" for line in (*lines, "/quit")))
        Chat(session, terminal, pipe, DummyOutput()).run()
    assert isinstance(terminal.out, io.StringIO) and isinstance(terminal.err, io.StringIO)
    return session, terminal.out.getvalue(), terminal.err.getvalue()


def test_an_instruction_is_carried_out_and_shown(boxes: Scene, encoder: Any) -> None:
    session, out, err = _talk(boxes, encoder, "make the green thing blue")
    assert session.done == ("make the green thing blue",)
    assert "recolor" in out and "checks passed" in out
    assert len([line for line in out.split("\n") if len(line) >= 40]) > 10  # the picture, in letters
    assert "was not saved" in err


@pytest.mark.parametrize("end", ["/quit", "/exit", "quit", "Exit"])
def test_what_is_said_after_the_end_is_not_heard(boxes: Scene, encoder: Any, end: str) -> None:
    session, _, err = _talk(boxes, encoder, end, "make the green thing blue")
    assert session.done == () and "was not saved" not in err


def test_an_ambiguity_is_asked_back_and_answered(boxes: Scene, encoder: Any) -> None:
    session, out, _ = _talk(boxes, encoder, "delete the red thing", "the left one")
    assert "  1. red box" in out and "Which one?" in out
    assert set(session.scene.cloud.group.unique().tolist()) == {1, 2, 3}


def test_a_question_does_not_stand_in_the_way_of_undoing(boxes: Scene, encoder: Any) -> None:
    session, out, _ = _talk(boxes, encoder, "make the green thing blue", "delete the red thing", "undo", "1")
    assert session.scene is boxes and session.question is None
    assert "undo: make the green thing blue" in out


@pytest.mark.parametrize("words", ["never mind", "None of them.", "cancel"])
def test_a_question_can_be_dismissed(boxes: Scene, encoder: Any, words: str) -> None:
    session, out, _ = _talk(boxes, encoder, "delete the red thing", words, "1")
    assert session.scene is boxes and session.question is None
    assert "nothing was changed" in out and "does not say which" not in out


def test_a_question_can_be_passed_over(boxes: Scene, encoder: Any) -> None:
    session, _, _ = _talk(boxes, encoder, "delete the red thing", "delete the green thing")
    assert set(session.scene.cloud.group.unique().tolist()) == {0, 2, 3}


def test_what_is_neither_an_answer_nor_an_instruction_leaves_the_question(boxes: Scene, encoder: Any) -> None:
    session, out, _ = _talk(boxes, encoder, "delete the red thing", "the green one", "7", "the left one")
    assert "none of the 2" in out and "a number from 1 to 2" in out
    assert session.done and set(session.scene.cloud.group.unique().tolist()) == {1, 2, 3}


def test_two_numbers_answer_a_question(boxes: Scene, encoder: Any) -> None:
    session, _, _ = _talk(boxes, encoder, "delete the red thing", "1 and 2")
    assert set(session.scene.cloud.group.unique().tolist()) == {1, 3}


def test_of_the_nearest_things_a_number_chooses_and_all_does_not(boxes: Scene, encoder: Any) -> None:
    session, out, _ = _talk(boxes, encoder, "delete the purple thing", "all")
    assert "The nearest things" in out and "no question is open" in out and session.scene is boxes
    session, out, _ = _talk(boxes, encoder, "delete the purple thing", "1")
    assert len(session.done) == 1 and len(session.scene.cloud) < len(boxes.cloud)


def test_commands(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    session, out, err = _talk(
        boxes, encoder, "/help", "make the green thing blue", "/undo", "/redo", "/plan delete the blue thing", "/plan",
        "/select the red thing", "/things", "/history", "/show", "/show 0", f"/save {target}", "/nonsense",
    )  # fmt: skip
    assert all(name in out for name in COMMANDS)
    assert "(not done)" in out and '"op": "recolor"' in out
    assert "  1. make the green thing blue" in out
    assert "there is no command /nonsense" in out
    assert target.is_file() and "not saved" not in err
    assert session.done == ("make the green thing blue",)


def test_what_an_earlier_chat_did_can_be_done_again(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    log = tmp_path / "s.jsonl"
    first, _, _ = _talk(boxes, encoder, "delete the green thing", "/replay", log=log)
    first.close()
    second, out, _ = _talk(boxes, encoder, "/replay", "/replay nobody", log=log)
    second.close()
    assert second.done == ("delete the green thing",) and "replayed session 1" in out and "no session nobody" in out
    assert second.digest == first.digest
    _, out, _ = _talk(boxes, encoder, "/replay")
    assert "begin it with --log FILE" in out


def test_errors_are_one_sentence_and_the_conversation_goes_on(boxes: Scene, encoder: Any) -> None:
    session, out, _ = _talk(boxes, encoder, "flurble the green thing", "/undo", "/save", "delete the green thing")
    assert "nothing to undo" in out and "/save out.ply" in out
    assert "Traceback" not in out
    assert session.done == ("delete the green thing",)


def test_a_bug_or_an_open_quotation_mark_does_not_end_the_conversation(
    boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(self: Session, phrase: object) -> Any:
        raise RuntimeError("boom")

    monkeypatch.setattr(Session, "select", broken)
    session, out, _ = _talk(
        boxes, encoder, "make the green thing blue", "/save it's.ply", "/select the box", "delete the blue thing"
    )
    assert "a quotation mark is open" in out and "internal error (RuntimeError: boom)" in out
    assert session.done == ("make the green thing blue", "delete the blue thing")


def test_ctrl_c_cancels_the_instruction_not_the_program(
    boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(self: Session, text: str) -> Any:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Session, "do", interrupted)
        session, out, _ = _talk(boxes, encoder, "delete the green thing", "/history")
    assert "cancelled; nothing was changed" in out and "nothing was done yet" in out
    assert session.scene is boxes


def test_ctrl_c_at_the_prompt_and_ctrl_d() -> None:
    with create_pipe_input() as pipe:
        pipe.send_text("half a line\x03\x04")
        assert list(InputLines(COMMANDS, tuple, input=pipe, output=DummyOutput())) == []


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("/un", ["/undo"]),
        ("/s", ["/select", "/shrink", "/show", "/save"]),
        ("del", ["delete"]),
        ("delete the coffee t", ["coffee table"]),
        ("delete the cha", ["chair"]),
        ("delete the ", []),
    ],
)
def test_completion(typed: str, offered: list[str]) -> None:
    completer = ChatCompleter(COMMANDS, lambda: ["chair", "coffee table", "delete", "move"])
    found = [c.text for c in completer.get_completions(Document(typed), None)]  # type: ignore[arg-type]
    assert found == offered


def test_a_pipe_works_line_by_line(boxes: Scene, tmp_path: Path) -> None:
    """Without a terminal: one JSON object for each line said. Inserted things need no embedding."""
    from scenewright.gaussians.files import save

    save(boxes, tmp_path / "boxes.ply")
    done = subprocess.run(
        [sys.executable, "-m", "scenewright", "chat", str(tmp_path / "boxes.ply"), "--json"],
        input="/history\n/undo\n/nonsense\n/quit\n", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert rows[0] == {"done": []}
    assert [r["verdict"] for r in rows[1:]] == ["not_understood", "not_understood"]
