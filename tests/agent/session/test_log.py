"""Laws of the session log: what was appended can be read, whatever happens in between."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.agent.session.log import SCHEMA_VERSION, SessionLog, read_log, scrub
from scenewright.gaussians.errors import FileError

_leaves = (
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=40)
)
_fields = st.dictionaries(
    st.text(min_size=1, max_size=12).filter(lambda k: k not in ("v", "seq", "time", "kind")),
    st.recursive(_leaves, lambda x: st.lists(x, max_size=3) | st.dictionaries(st.text(max_size=5), x, max_size=3)),
    max_size=4,
)


@given(st.lists(_fields, max_size=6))
@settings(max_examples=40, deadline=None)
def test_what_is_appended_is_read(tmp_path_factory: pytest.TempPathFactory, rows: list[dict[str, Any]]) -> None:
    path = tmp_path_factory.mktemp("log") / "s.jsonl"
    with SessionLog(path) as log:
        for row in rows:
            log.append("do", row)
    content = read_log(path)
    assert not content.damage
    assert [r["seq"] for r in content.records] == list(range(1, len(rows) + 1))
    for record, row in zip(content.records, rows, strict=True):
        assert {k: record[k] for k in row} == row


@given(cut=st.integers(0, 400))
@settings(max_examples=60, deadline=None)
def test_a_log_cut_anywhere_keeps_its_whole_records_and_can_be_continued(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    path = tmp_path_factory.mktemp("log") / "s.jsonl"
    with SessionLog(path) as log:
        for i in range(4):
            log.append("do", {"text": f"made the chair {i} grün"})
    data = path.read_bytes()
    path.write_bytes(data[: min(cut, len(data))])
    kept = data[:cut].count(b"\n")
    torn = read_log(path)
    # A cut exactly before a line break loses nothing: the record itself is whole.
    assert len(torn.records) in (kept, kept + 1)
    assert len(torn.records) + len(torn.damage) >= kept
    with SessionLog(path) as log:
        log.append("undo", {"text": "after the crash"})
    content = read_log(path)
    assert content.records[-1]["text"] == "after the crash"
    assert content.records[:-1] == torn.records
    assert [r["seq"] for r in content.records] == list(range(1, len(content.records) + 1))


_WRITER = """
import sys
from scenewright.agent.session.log import SessionLog
log = SessionLog(sys.argv[1])
i = 0
while True:
    log.append("do", {"n": i, "text": "x" * (i * 37 % 5000)})
    i += 1
    print(i, flush=True)  # told to the parent only after append returned
"""


def test_kill_at_random_moments_loses_nothing_that_was_reported(tmp_path: Path) -> None:
    rng = random.Random(3)
    path = tmp_path / "s.jsonl"
    reported = 0
    for _ in range(4):
        child = subprocess.Popen([sys.executable, "-c", _WRITER, str(path)], stdout=subprocess.PIPE, text=True)
        assert child.stdout is not None
        child.stdout.readline()  # it has started writing
        time.sleep(rng.uniform(0.0, 0.06))
        os.kill(child.pid, signal.SIGKILL)
        reported += 1 + len([line for line in child.stdout.read().split("\n") if line])
        child.wait()
        content = read_log(path)
        # The record being written at the kill may be whole on disk and not yet reported; at most one a kill.
        assert len(content.records) >= reported
        assert [r["seq"] for r in content.records] == list(range(1, len(content.records) + 1))
        reported = len(content.records)


def test_an_existing_log_is_never_shortened(tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    with SessionLog(path) as log:
        log.append("open", {})
    before = path.read_bytes()
    with SessionLog(path) as log:
        log.append("open", {})
    assert path.read_bytes().startswith(before)
    assert len(read_log(path).sessions()) == 2


def test_nan_becomes_null_and_every_line_is_strict_json(tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    with SessionLog(path) as log:
        log.append("do", {"value": float("nan"), "deep": [{"x": float("inf")}]})

    def refuse(name: str) -> None:
        raise AssertionError(name)

    record = json.loads(path.read_text(), parse_constant=refuse)
    assert record["value"] is None and record["deep"] == [{"x": None}]


def test_secrets_never_reach_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOME_API_KEY", "very-private-value")
    path = tmp_path / "s.jsonl"
    with SessionLog(path) as log:
        log.append("do", {"text": "with very-private-value", "plan": {"note": "sk-abcdefghij0123456789ABCD"}})
    text = path.read_text()
    assert "very-private-value" not in text and "sk-abc" not in text
    assert read_log(path).records[0]["text"] == "with [secret removed]"
    assert scrub("an ordinary chair") == "an ordinary chair"


def test_a_later_schema_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "s.jsonl"
    path.write_text(json.dumps({"v": SCHEMA_VERSION + 1, "seq": 1, "kind": "do"}) + "\n")
    with pytest.raises(FileError, match="update Scenewright"):
        read_log(path)


def test_missing_and_unwritable_logs_are_file_errors(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot read"):
        read_log(tmp_path / "none.jsonl")
    with pytest.raises(FileError, match="cannot open"):
        SessionLog(tmp_path / "no folder" / "s.jsonl")
    log = SessionLog(tmp_path / "s.jsonl")
    log.close()
    with pytest.raises(FileError, match="cannot write"):
        log.append("do", {})
