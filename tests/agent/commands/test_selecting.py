"""Changing and explaining a selection: from Python, in the chat, and on the command line."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenewright.agent.session.log import read_log
from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import Chat
from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.errors import AbsentError, UserError
from scenewright.gaussians.files import save
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.scene import Scene

GREEN = Query(text="thing", colors=("green",))


def _chat(session: Session, *lines: str) -> str:
    terminal = Terminal(io.StringIO(), io.StringIO())
    chat = Chat(session, terminal)
    for line in lines:
        chat.say(line)
    assert isinstance(terminal.out, io.StringIO)
    return terminal.out.getvalue()


def test_what_is_selected_grows_shrinks_and_turns_inside_out_and_each_can_be_undone(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    session.select(GREEN)
    assert session.last is not None
    first = set(session.last.ids.tolist())

    def now() -> set[int]:
        assert session.last is not None
        return set(session.last.ids.tolist())

    session.adjust(grow=0.5)
    wider = now()
    assert first < wider
    session.adjust(invert=True)
    assert now() == set(boxes.cloud.ids.tolist()) - wider
    session.undo()
    assert now() == wider
    session.adjust(grow=-0.5)
    assert first <= now() <= wider  # closing keeps what was there
    assert session.scene.cloud is boxes.cloud


def test_there_must_be_a_selection_and_something_left_of_it(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    with pytest.raises(AbsentError, match="'it'"):
        session.adjust(grow=0.1)
    session.select(GREEN)
    with pytest.raises(AbsentError, match="nothing is left"):
        session.adjust(grow=-50)
    with pytest.raises(UserError, match="metres"):
        session.adjust(grow=float("nan"))


@pytest.mark.slow
def test_a_changed_selection_is_logged_and_replayed(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    session = Session(boxes, encoder=encoder, log=tmp_path / "a.jsonl")
    session.do("select the green thing")
    session.adjust(grow=0.5)
    session.do("delete it")
    session.close()
    again = Session(boxes, encoder=encoder)
    again.replay(tmp_path / "a.jsonl")
    assert again.scene.cloud.digest() == session.scene.cloud.digest()
    assert len(read_log(tmp_path / "a.jsonl").sessions()[0]) > 3


def test_in_the_chat(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    said = _chat(
        session, "/select the green thing", "/grow", "/grow 0.3 m", "/shrink 0.1", "/invert", "/why the red thing"
    )
    assert "grown by 0.05 m" in said and "grown by 0.3 m" in said and "shrunk by 0.1 m" in said
    assert "everything but it" in said
    assert "ambiguous" in said and "rival: red box (group 0): color red" in said and "color red" in said
    assert "is not a distance" in _chat(session, "/grow far") and "metres above 0" in _chat(session, "/shrink -1")


def test_an_explanation_names_every_term_and_threshold(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    query = {"text": "thing", "colors": ["red"], "relations": [{"name": "left_of", "anchors": [GREEN]}]}
    explained = session.explain(Query.model_validate(query))
    assert explained.verdict == "found" and session.last is None
    assert [e.outcome for e in explained.candidates] == ["selected", "fails", "fails"]
    assert {t.name for e in explained.candidates for t in e.terms} == {"color red", "left_of"}
    for e in explained.candidates:
        assert (e.outcome == "fails") == any(not t.holds for t in e.terms)
    assert [(role, inner.verdict) for role, inner in explained.inside] == [("left of", "found")]
    assert json.loads(json.dumps(explained.to_json()))["candidates"][0]["terms"][0]["threshold"] > 0


def test_on_the_command_line(room: Path, boxes: Scene, call: Any, tmp_path: Path) -> None:
    def rows(*options: object) -> set[int]:
        target = tmp_path / "rows.npy"
        code, _, err = call("select", room, "the green thing", "--ids", target, "--force", *options)
        assert code == 0, err
        return set(np.load(target).tolist())

    plain, wide = rows(), rows("--grow", 0.5)
    assert plain < wide and rows("--invert") == set(range(len(boxes.cloud))) - plain
    assert plain <= rows("--grow", 0.5, "--shrink", 0.5) <= wide
    code, out, _ = call("select", room, "the green thing", "--grow", "0.5", "--json", "--explain")
    data = json.loads(out)
    assert code == 0 and data["asked"] == "the green thing grown by 0.5 m" and data["gaussians"] == len(wide)
    assert data["explained"]["candidates"][0]["outcome"] == "selected"
    code, _, err = call("select", room, "the green thing", "--grow", "-1")
    assert code == 2 and "--grow" in err


def test_a_field_made_for_another_version_of_the_file_is_told_and_not_used(
    room: Path, boxes: Scene, call: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenewright.gaussians.language.field import embed as embedding

    embedded: list[Scene] = []

    def embed(scene: Scene, *_: Any, **__: Any) -> Scene:
        embedded.append(scene)
        return boxes.replace(cloud=scene.cloud.replace(group=boxes.cloud.group[: len(scene.cloud)]))

    monkeypatch.setattr(embedding, "embed", embed)
    code, _, err = call("select", room, "the green thing")
    assert code == 0 and "another version" not in err and not embedded
    save(boxes.replace(cloud=boxes.cloud[: len(boxes.cloud) - 1], language=None), room, force=True)
    code, _, err = call("select", room, "the green thing")
    assert code == 0 and len(embedded) == 1
    assert "was made for another version of this file: embedding again" in err and f"scenewright embed {room}" in err
    code, _, err = call("embed", room)
    assert code == 0 and "another version" in err and len(embedded) == 2
    code, _, err = call("select", room, "the green thing")
    assert code == 0 and "another version" not in err and len(embedded) == 2


def test_a_selection_is_written_as_gaussians_or_as_a_mesh(call: Any, room: Path, tmp_path: Path) -> None:
    from scenewright.gaussians.files import load

    answer = call("select", room, "the green thing", "--save", tmp_path / "green.ply", "--json")
    assert answer.code == 0 and answer.data["path"] == str(tmp_path / "green.ply")
    assert len(load(tmp_path / "green.ply").cloud) == answer.data["gaussians"] == 343
    assert call("select", room, "the green thing", "--save", tmp_path / "green.glb").code == 0
    assert (tmp_path / "green.glb").read_bytes()[:4] == b"glTF"
    assert call("select", room, "the green thing", "--save", tmp_path / "green.glb").code == 2  # it exists
    assert call("select", room, "the purple thing", "--save", tmp_path / "b.glb").code == 3
    assert call("select", room, "the green thing", "--save", tmp_path / "b.xyz").code == 2
    assert {p.name for p in tmp_path.glob("*.glb")} == {"green.glb"} and not (tmp_path / "b.xyz").exists()
