"""Results on stdout, talk on stderr; batch files are checked line by line."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest

from scenewright.agent.terminal.output import Terminal, error_json, read_batch
from scenewright.gaussians.errors import AbsentError, CheckFailedError, FileError, UserError


def test_streams_are_kept_apart() -> None:
    out, err = io.StringIO(), io.StringIO()
    terminal = Terminal(out, err)
    terminal.result("text", {"a": 1})
    terminal.say("talk")
    terminal.progress("embedding", 0.5)  # no terminal: nothing is drawn
    assert (out.getvalue(), err.getvalue()) == ("text\n", "talk\n")
    terminal.as_json = True
    terminal.result("text", {"a": "ü"})
    assert json.loads(out.getvalue().splitlines()[1]) == {"a": "ü"}


def test_progress_is_drawn_on_a_terminal_and_removed() -> None:
    class Screen(io.StringIO):
        def isatty(self) -> bool:
            return True

    err = Screen()
    terminal = Terminal(io.StringIO(), err)
    terminal.progress("embedding", 0.5)
    assert "━" in err.getvalue() and "embedding" in err.getvalue()
    terminal.progress("embedding", 1.0)
    assert err.getvalue().endswith("\r\x1b[K")


def test_progress_never_wraps(monkeypatch: pytest.MonkeyPatch) -> None:
    class Screen(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setenv("COLUMNS", "60")
    err = Screen()
    Terminal(io.StringIO(), err).progress("planning with " + "x" * 200, 0.5)
    assert len(err.getvalue().removeprefix("\r\x1b[K")) == 59


@pytest.mark.parametrize(
    ("error", "verdict", "code"),
    [(AbsentError("x"), "absent", 3), (CheckFailedError("x"), "check_failed", 3), (FileError("x"), "file", 4),
     (UserError("x"), "user", 2)],
)  # fmt: skip
def test_errors_as_data(error: AbsentError, verdict: str, code: int) -> None:
    assert error_json(error) == {"verdict": verdict, "reason": "x", "exit_code": code}


def test_batch_rows(tmp_path: Path) -> None:
    path = tmp_path / "b.jsonl"
    path.write_text('{"id": 1, "text": "a"}\n\n{"id": "x", "text": "b", "context": "a"}\n')
    assert [r["id"] for r in read_batch(str(path))] == [1, "x"]


@pytest.mark.parametrize(
    ("line", "told"),
    [("nonsense", "line 2: not JSON"), ('{"id": 1}', "line 2: expected"), ('{"text": "a"}', "line 2: expected"),
     ('{"id": 1, "text": "a", "context": 3}', "line 2: context")],
)  # fmt: skip
def test_a_bad_batch_line_is_named(tmp_path: Path, line: str, told: str) -> None:
    path = tmp_path / "b.jsonl"
    path.write_text('{"id": 1, "text": "a"}\n' + line + "\n")
    with pytest.raises(UserError, match=told):
        read_batch(str(path))


def test_a_missing_batch_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot read"):
        read_batch(str(tmp_path / "none.jsonl"))
