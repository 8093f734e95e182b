"""Does one job: runs its command line in this process, with what it prints kept."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
import time
import traceback
from pathlib import Path
from typing import Any, NamedTuple, TypedDict

_KEPT = 4_000  # characters of messages


class Outcome(TypedDict):
    """What a job came to.

    `code` is the exit code of the command line, `result` what it printed as JSON (None if nothing), `messages` the end
    of what it said, `seconds` by the clock.
    """

    code: int
    result: Any
    messages: str
    seconds: float


class Task(NamedTuple):
    """A command line, and the folder for its results, which is emptied first: an earlier worker may have died in it."""

    command: list[str]
    folder: str


def work(task: Task) -> Outcome:
    """Run a command line; whatever it does, an outcome comes back."""
    from ..cli import main
    from ..terminal.output import terminal

    asked = terminal.as_json, terminal.debug  # of this batch, if it works in its own process
    shutil.rmtree(task.folder, ignore_errors=True)
    Path(task.folder).mkdir(parents=True, exist_ok=True)
    out, err = io.StringIO(), io.StringIO()
    started, code = time.perf_counter(), 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main(task.command)
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0 if end.code is None else 4
        except Exception as error:  # --debug lets errors through, with their traceback
            code = getattr(error, "exit_code", 4)
            err.write(traceback.format_exc())
        finally:
            terminal.as_json, terminal.debug = asked
    return Outcome(
        code=code, result=_printed(out.getvalue()), messages=err.getvalue().strip()[-_KEPT:],
        seconds=round(time.perf_counter() - started, 3),
    )  # fmt: skip


def _printed(text: str) -> Any:
    """What was printed: one JSON value, a list of those of its lines, or the text as it is."""
    text = text.strip()
    if not text:
        return None
    try:
        return json.loads(text)
    except ValueError:
        pass
    try:
        return [json.loads(line) for line in text.splitlines() if line.strip()]
    except ValueError:
        return text[-_KEPT:]
