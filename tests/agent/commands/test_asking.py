"""The verbs that question a scene: ask, describe, name-all; and questions in the chat."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import Chat
from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.scene import Scene

ROOM = {
    "room": {"size": [5, 4, 2.5]},
    "nodes": [
        {"id": "desk", "label": "desk", "color": "brown", "size": [1.4, 0.7, 0.75], "position": [0, 1.5, 0.375]},
        {"id": "lamp", "label": "table lamp", "color": "white", "size": [0.2, 0.2, 0.4], "position": [0.4, 1.5, 0.95],
         "support": "desk"},
        {"id": "sofa", "label": "sofa", "color": "red", "size": [2.0, 0.9, 0.8], "position": [0, -1, 0.4]},
    ],
}  # fmt: skip


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.json"
    path.write_text(json.dumps(ROOM))
    return path


def test_a_graph_is_asked_with_json(call: Any, room: Path) -> None:
    code, out, _ = call("ask", "what is on the desk?", "--graph", room, "--json")
    answer = json.loads(out)
    assert code == 0
    assert set(answer) == {"answer", "answer_type", "text", "confidence", "source", "evidence", "frame", "unit"}
    assert (answer["answer"], answer["answer_type"], answer["source"]) == (["table lamp"], "list", "geometry")
    assert answer["evidence"]["ids"][0] == "lamp"


def test_a_batch_answers_line_by_line_with_context(call: Any, room: Path, tmp_path: Path) -> None:
    lines = [
        {"id": 1, "text": "how many sofas are there?"},
        {"id": 2, "text": "what colour is it?", "context": "is there a sofa?"},
        {"id": 3, "text": "x" * 2000},
        {"id": 4, "text": "who owns the sofa?"},
    ]
    batch = tmp_path / "batch.jsonl"
    batch.write_text("\n".join(map(json.dumps, lines)))
    code, out, _ = call("ask", "--graph", room, "--batch", batch)
    answers = [json.loads(line) for line in out.splitlines()]
    assert code == 0 and [a["id"] for a in answers] == [1, 2, 3, 4]
    assert [a["answer"] for a in answers] == [1, "red", None, None]
    assert answers[3]["source"] == "none"


def test_what_is_not_understood_ends_with_3(call: Any, room: Path) -> None:
    code, out, _ = call("ask", "flurb the wibble at noon?", "--graph", room)
    assert code == 3 and "not understood" in out


def test_wrong_arguments_are_told(call: Any, room: Path) -> None:
    assert call("ask", "is there a sofa?").code == 2
    assert call("ask", "is there a sofa?", "--graph", room, "--picture", "x.png").code == 2
    assert call("ask", "is there a sofa?", "--graph", room.with_name("none.json")).code == 4
    assert call("describe").code == 2


def test_a_graph_is_described(call: Any, room: Path) -> None:
    code, out, _ = call("describe", "--graph", room, "--json")
    told = json.loads(out)
    assert code == 0 and {t["id"] for t in told["things"]} == {"desk", "lamp", "sofa"}
    assert "desk" in told["text"] and "5.0 m" in told["text"]


def test_questions_in_the_chat_are_answered_there(
    boxes: Scene, encoder: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    session = Session(boxes, planner="grammar", encoder=encoder, vlm=None)
    chat = Chat(session, Terminal())
    chat.say("how many green things are there?")
    assert "There is a box" in capsys.readouterr().out
    chat.say("make it blue")
    assert len(session.done) == 1 and session.last is not None and session.last.groups == (1,)
    before = session.scene
    chat.say("how far is it from the floor?")
    assert session.scene is before
