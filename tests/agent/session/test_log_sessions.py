"""Sessions that share a log: one at a time, each with an id, told apart, continued and replayed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.log import SessionLog, read_log
from scenewright.agent.session.log_lock import SUFFIX
from scenewright.agent.session.log_sessions import logged_session, problems, sessions_of
from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files import load
from scenewright.gaussians.language.field.store import load_field, save_field
from scenewright.gaussians.scene import Scene

_HOLDER = """
import sys
from scenewright.agent.session.log import SessionLog
log = SessionLog(sys.argv[1])
print("open", flush=True)
sys.stdin.read()
"""


def _other_process(log: Path) -> subprocess.Popen[str]:
    """Another process that has the log open, until its input ends."""
    child = subprocess.Popen(
        [sys.executable, "-c", _HOLDER, str(log)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None and child.stdout.readline() == "open\n"
    return child


def test_two_processes_do_not_write_to_one_log_and_a_lock_left_by_a_crash_is_taken_over(tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    child = _other_process(path)
    with pytest.raises(FileError, match=f"in use by process {child.pid} on .*; end that session"):
        SessionLog(path)
    read_log(path)  # reading is allowed
    os.kill(child.pid, signal.SIGKILL)
    child.communicate()
    assert path.with_name(path.name + SUFFIX).exists()  # nobody removed it
    with SessionLog(path) as log:
        log.append("open", {})
        assert json.loads(path.with_name(path.name + SUFFIX).read_text())["process"] == os.getpid()
    assert os.listdir(tmp_path) == ["s.jsonl"]


def test_a_session_holds_its_log_until_it_is_closed_or_gone(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    first = Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    with pytest.raises(FileError, match="in use"):
        Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    first.close()
    log = SessionLog(tmp_path / "s.jsonl")
    del log
    Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl").close()


def test_a_log_that_cannot_be_read_is_not_kept_locked(tmp_path: Path) -> None:
    (tmp_path / "s.jsonl").write_text('{"v": 99, "seq": 1, "kind": "open"}\n')
    with pytest.raises(FileError, match="later version"):
        SessionLog(tmp_path / "s.jsonl")
    assert os.listdir(tmp_path) == ["s.jsonl"]


@pytest.mark.slow
def test_each_session_has_an_id_by_which_it_is_replayed(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    for text in ("delete the green thing", "make the green thing blue"):
        session = Session(boxes, encoder=encoder, log=path)
        session.do(text)
        session.close()
    first, second = sessions_of(read_log(path))
    assert len({first.id, second.id, ""}) == 3 and (first.number, second.number) == (1, 2)
    for which in (first.id, "1", 0, -2):
        again = Session(boxes, encoder=encoder)
        again.replay(path, session=which)
        assert again.done == ("delete the green thing",)
    with pytest.raises(UserError, match=rf"no session nobody, but 1 \({first.id}, 1 edit\), 2 \("):
        logged_session(path, "nobody")


def test_a_session_on_the_same_scene_is_told_of_the_edits_that_it_can_replay(
    boxes: Scene, encoder: Any, tmp_path: Path
) -> None:
    first = Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    assert first.log_notes == ()
    first.do("delete the green thing")
    first.close()
    second = Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    assert "session 1" in second.log_notes[0] and "began with this scene" in second.log_notes[0]
    assert second.done == () and second.last is None
    second.close()


@pytest.mark.parametrize("through_a_file", [False, True])
def test_a_session_goes_on_where_the_last_one_of_its_log_ended(
    boxes: Scene, encoder: Any, tmp_path: Path, through_a_file: bool
) -> None:
    first = Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    first.do("delete the green thing")
    first.do("move the nearest red thing 20 cm to the left")
    scene = first.scene
    if through_a_file:
        first.save(tmp_path / "out.ply")
        save_field(first.scene, tmp_path / "out.ply")
        loaded = load_field(load(tmp_path / "out.ply"), tmp_path / "out.ply")
        assert loaded is not None
        scene = loaded
    first.close()
    second = Session(scene, encoder=encoder, log=tmp_path / "s.jsonl")
    assert any("goes on where session 1" in note for note in second.log_notes)
    assert first.last is not None and second.last is not None and second.last.groups == first.last.groups
    second.do("move it 10 cm up")
    second.close()
    one, two = sessions_of(read_log(tmp_path / "s.jsonl"))
    assert two.records[0]["continues"] == one.id


def test_it_is_not_taken_over_where_the_groups_are_others(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    first = Session(boxes, encoder=encoder, log=tmp_path / "s.jsonl")
    first.do("make the green thing blue")
    first.save(tmp_path / "out.ply")
    first.close()
    changed = first.scene.replace(
        path=tmp_path / "out.ply", cloud=first.scene.cloud.replace(group=(first.scene.cloud.group + 2) % 4)
    )
    second = Session(changed, encoder=encoder, log=tmp_path / "s.jsonl")
    assert any("goes on where session 1" in note for note in second.log_notes) and second.last is None
    second.close()


def test_broken_lines_missing_records_and_scenes_that_do_not_follow_are_told(
    boxes: Scene, encoder: Any, tmp_path: Path
) -> None:
    path = tmp_path / "s.jsonl"
    session = Session(boxes, encoder=encoder, log=path)
    for text in ("make the green thing blue", "delete the blue thing", "undo", "redo"):
        session.do(text)
    session.save(tmp_path / "out.ply")
    session.close()
    assert problems(read_log(path)) == ()
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:2], *lines[3:]]) + "\n")  # one edit is gone
    missing, chain = problems(read_log(path))
    assert missing.startswith("record 4 follows record 2") and chain.startswith("record 4 ('delete the blue thing')")
    path.write_text("\n".join([lines[0], lines[1][:-40], *lines[2:]]) + "\n")  # one is broken
    assert "line 2 is not a whole record" in problems(read_log(path))[0]
    again = Session(boxes, encoder=encoder, log=path)
    assert any("line 2 is not a whole record" in note for note in again.log_notes)
    again.close()


def test_a_replay_that_leads_elsewhere_says_so(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    session = Session(boxes, encoder=encoder, log=path)
    session.do("make the green thing blue")
    session.close()
    assert [r.note for r in Session(boxes, encoder=encoder).replay(path)] == [""]
    after = read_log(path).records[1]["after"]
    path.write_text(path.read_text().replace(after, "0" * 64))
    (replayed,) = Session(boxes, encoder=encoder).replay(path)
    assert replayed.error is None and "digests do not match" in replayed.note
