"""Does one job: runs its command line in this process, with what it prints kept."""

from __future__ import annotations

import contextlib
import io
import json
import secrets
import shutil
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any, NamedTuple, NotRequired, TypedDict

from ...gaussians.errors import FileError, ScenewrightError
from ..urls import local_words
from .jobs import OUT
from .resources import NOTHING, Resources

_KEPT = 4_000  # characters of messages
_PUTS, _PAUSE = 3, 0.5  # how often results are sent to a store that fails, seconds between


class Outcome(TypedDict):
    """What a job came to.

    `code` is the exit code of the command line, `result` what it printed as JSON (None if nothing), `messages` the end
    of what it said, `seconds` by the clock. Where the worker writes the results to a store, `written` is the folder of
    its attempt and `files` the bytes of each file there. `retries` says why earlier workers did not get to its end.
    """

    code: int
    result: Any
    messages: str
    seconds: float
    written: NotRequired[str]
    files: NotRequired[dict[str, int]]
    retries: NotRequired[list[str]]


class Task(NamedTuple):
    """A command line, and the folder for its results, which is emptied first: an earlier worker may have died in it.

    With a `store`, a URL, the results go there, and `folder` is a name below the worker's temporary folder, which takes
    the place of `{out}` in the words.
    """

    command: list[str]
    folder: str
    store: str = ""
    resources: Resources = NOTHING


def work(task: Task) -> Outcome:
    """Run a command line; whatever it does, an outcome comes back."""
    folder = Path(tempfile.gettempdir(), task.folder) if task.store else Path(task.folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        words = local_words([word.replace(OUT, str(folder)) for word in task.command], own=folder)
        given = {file: file.stat().st_mtime_ns for file in folder.iterdir() if file.is_file()}  # copies of scenes
        outcome = _run(words)
        for file, when in given.items():
            if file.is_file() and file.stat().st_mtime_ns == when:  # no result
                file.unlink()
        return _stored(outcome, folder, task.store) if task.store else outcome
    except ScenewrightError as error:
        return Outcome(code=error.exit_code, result=None, messages=f"scenewright: {error}", seconds=0.0)
    finally:
        if task.store:
            shutil.rmtree(folder, ignore_errors=True)


def _stored(outcome: Outcome, folder: Path, store: str) -> Outcome:
    """The outcome of a job whose results are in a store now."""
    from ...gaussians.files.remote import cleaned, sent

    if outcome["code"] or not any(folder.iterdir()):
        return outcome
    for tries in range(_PUTS, 0, -1):
        place = f"{store}/{secrets.token_hex(16)}"  # no other attempt writes there
        try:
            files = sent(folder, place)
            break
        except FileError:
            if tries == 1:
                raise
            time.sleep(_PAUSE)
    moved = renamed(outcome, str(folder), cleaned(place))
    return Outcome({**moved, "written": place.rpartition("/")[2], "files": files})


def renamed(outcome: Outcome, old: str, new: str) -> Outcome:
    """What a job printed, with the folder in which its results are now."""
    told = json.dumps([outcome["result"], outcome["messages"]]).replace(json.dumps(old)[1:-1], json.dumps(new)[1:-1])
    result, messages = json.loads(told)
    return Outcome({**outcome, "result": result, "messages": messages})


def _run(words: list[str]) -> Outcome:
    from ..cli import main
    from ..terminal.output import terminal

    asked = terminal.as_json, terminal.debug  # of this batch, if it works in its own process
    out, err = io.StringIO(), io.StringIO()
    started, code = time.perf_counter(), 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main(words)
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
