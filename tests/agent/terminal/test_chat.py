"""The conversation: on prompt_toolkit's own test terminal, and on a pipe."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from prompt_toolkit.document import Document
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput

from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import COMMANDS, Chat
from scenewright.agent.terminal.completion import ChatCompleter
from scenewright.agent.terminal.input_lines import InputLines
from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.scene import Scene


def _talk(scene: Scene, encoder: Any, *lines: str, log: Path | None = None) -> tuple[Session, str, str]:
    """The session, stdout and stderr after these lines were typed."""
    terminal = Terminal(io.StringIO(), io.StringIO())
    session = Session(scene, encoder=encoder, log=log)
    with create_pipe_input() as pipe:
        pipe.send_text("".join(f"{line}\r" for line in (*lines, "/quit", "no")))
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
        "/preview make the blue thing red", "/preview",
        "/select the red thing", "/things", "/history", "/show", "/show 0", f"/save {target}", "/nonsense",
    )  # fmt: skip
    assert all(name in out for name in COMMANDS)
    assert "it would change" in out and "say what to try" in out
    assert "(not done)" in out and '"op": "recolor"' in out
    assert "  1. make the green thing blue" in out
    assert "there is no command /nonsense" in out
    assert target.is_file() and "not saved" not in err
    assert "and the names of its things to out.ply.field.safetensors" in out and load(target).language is not None
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


def test_the_camera_moves_and_the_scene_does_not(boxes: Scene, encoder: Any) -> None:
    home = boxes.cameras[0]
    session, out, _ = _talk(boxes, encoder, "look from the left")
    assert session.viewer.position[0] < -3 and abs(session.viewer.forward[0]) > 0.7 and "from the left" in out
    session, _, _ = _talk(boxes, encoder, "look from the left", "look from the right")  # both of the first view
    assert session.viewer.position[0] > 3
    session, _, _ = _talk(boxes, encoder, "from above")
    assert session.viewer.forward[2] < -0.9
    near, _, _ = _talk(boxes, encoder, "closer")
    nearer, _, _ = _talk(boxes, encoder, "closer", "closer")
    from_far = [float(np.linalg.norm(s.viewer.position - [0, 0, 0.4])) for s in (nearer, near)]
    assert from_far[0] < from_far[1] < float(np.linalg.norm(home.position - [0, 0, 0.4]))
    session, _, _ = _talk(boxes, encoder, *["orbit"] * 8)
    np.testing.assert_allclose(session.viewer.position, home.position, atol=1e-6)
    session, out, _ = _talk(boxes, encoder, "orbit", "look up", "reset the view")
    assert session.viewer.name == "door" and session.scene is boxes and session.done == ()
    session, _, _ = _talk(boxes, encoder, "orbit the green thing", "look at the purple thing")
    pixel, _ = session.viewer.project(np.array([[0, 0.3, 0.3]]))
    assert abs(pixel[0] - [480, 320]).max() < 1e-6


def test_a_view_that_no_photograph_shows_is_told(boxes: Scene, encoder: Any) -> None:
    photographed = boxes.replace(cameras=boxes.cameras * 8)
    _, out, _ = _talk(photographed, encoder, "look from behind")
    assert "no photograph was taken" in out
    _, out, _ = _talk(photographed, encoder, "closer")
    assert "no photograph" not in out


def test_closer_goes_on_with_an_edit_until_the_camera_moves(boxes: Scene, encoder: Any) -> None:
    session, _, _ = _talk(boxes, encoder, "move the green thing 10 cm to the left", "closer")
    assert session.viewer.name == "door" and len(session.done) == 2
    session, _, _ = _talk(boxes, encoder, "move the green thing 10 cm to the left", "orbit", "closer")
    assert len(session.done) == 1


def test_left_and_right_follow_the_camera(boxes: Scene, encoder: Any) -> None:
    session, _, _ = _talk(boxes, encoder, "look from behind", "delete the left red thing")
    assert set(session.scene.cloud.group.unique().tolist()) == {0, 1, 3}


def test_leaving_with_an_unsaved_scene_asks_for_a_file(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    target = tmp_path / "my room.ply"
    _, _, err = _talk(boxes, encoder, "delete the green thing", "/quit", "no suffix", str(target))
    assert target.is_file() and err.count("was not saved") == 2  # asked again after a name that names no format
    _, _, err = _talk(boxes, encoder, "delete the green thing", "/undo")
    assert "not saved" not in err
    _, _, err = _talk(boxes, encoder, "delete the green thing", f"/save '{tmp_path / 'b.ply'}'", "/undo")
    assert "not saved" in err
    _, _, err = _talk(boxes, encoder, "/select the green thing", "select the green thing")
    assert "not saved" not in err


def test_on_a_pipe_leaving_is_told_and_not_asked(boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("delete the green thing\nlook from the left\n"))
    terminal = Terminal(io.StringIO(), io.StringIO())
    terminal.as_json = True
    Chat(Session(boxes, encoder=encoder), terminal).run()
    assert isinstance(terminal.out, io.StringIO) and isinstance(terminal.err, io.StringIO)
    done, looked = (json.loads(line) for line in terminal.out.getvalue().splitlines())
    assert done["verdict"] == looked["verdict"] == "ok" and looked["view"].count(":") == 2
    assert terminal.err.getvalue().count("was not saved") == 1


def test_what_is_selected_is_exported(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    target = tmp_path / "green.ply"
    _, out, _ = _talk(boxes, encoder, "/export a.ply", "/select the green thing", f"/export {target}", "/export")
    assert "nothing is selected" in out and f"wrote {target}: 343 Gaussians" in out and "/export out.ply" in out
    assert target.is_file()


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
