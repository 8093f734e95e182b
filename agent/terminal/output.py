"""Output of commands: results on stdout (as JSON on request), messages and progress on stderr; batch input files."""

from __future__ import annotations

import json
import shutil
import signal
import sys
import threading
import time
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn, TextIO

import typer

from ...gaussians.errors import AbsentError, ScenewrightError, UserError


def time_left(seconds: float) -> str:
    """An estimate in words: "2.5 min left", "40 s left"."""
    return f"{seconds / 60:.1f} min left" if seconds >= 60 else f"{seconds:.0f} s left"


class Terminal:
    """One command's output.

    Attributes:
        as_json: print the result as one JSON object instead of text.
        debug: show errors with their traceback.
    """

    def __init__(self, out: TextIO | None = None, err: TextIO | None = None) -> None:
        self._out, self._err = out, err
        self.as_json = False
        self.debug = False
        self._line_open = False
        self._last_progress = 0.0
        self._interrupted = False

    @property
    def out(self) -> TextIO:
        return self._out or sys.stdout

    @property
    def err(self) -> TextIO:
        return self._err or sys.stderr

    def result(self, text: str, data: Mapping[str, Any]) -> None:
        """Print the command's result: `data` if JSON was requested, else `text`."""
        self.row(data) if self.as_json else self._write(self.out, text)

    def row(self, data: Mapping[str, Any]) -> None:
        """Print one JSON object on one line of stdout."""
        self._write(self.out, json.dumps(data, ensure_ascii=False, default=str))

    def line(self, text: str) -> None:
        """Print a line of a result on stdout while the work goes on."""
        self._write(self.out, text)

    def say(self, text: str) -> None:
        """Print a message on stderr, without control characters, which names in a scene file might contain."""
        self._write(self.err, "".join(c for c in text if c in "\n\t" or unicodedata.category(c) != "Cc"))

    def confirms(self, question: str) -> bool | None:
        """The user's answer to a yes-or-no question; None if nobody can be asked: no terminal, or JSON output."""
        if self.as_json or not sys.stdin.isatty() or not self.err.isatty():
            return None
        self.clear()
        return bool(typer.confirm(question, default=False, err=True))

    def picture(self, drawn: str) -> None:
        """Print a picture drawn as text; nothing if the output is JSON."""
        if not self.as_json:
            self._write(self.out, drawn)

    def progress(self, stage: str, fraction: float) -> None:
        """Draw the progress of long work, `fraction` in [0, 1]; on a terminal only, at most ten times a second.

        Raises:
            KeyboardInterrupt: the user interrupted, and Python lost the interrupt (see `interruptible`).
        """
        if self._interrupted:
            raise KeyboardInterrupt
        if not self.err.isatty():
            return
        now = time.monotonic()
        if fraction < 1 and now - self._last_progress < 0.1:
            return
        self._last_progress = now
        filled = round(24 * min(max(fraction, 0.0), 1.0))
        line = f"{'━' * filled}{'╌' * (24 - filled)} {stage}"
        # The line is cut to the width of the terminal: a wrapped line could not be erased.
        self.err.write(f"\r\x1b[K{line[: shutil.get_terminal_size((80, 24)).columns - 1]}")
        self._line_open = True
        if fraction >= 1:
            self.clear()
        self.err.flush()

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """A context for long work that one Ctrl-C ends.

        Python drops an interrupt that arrives in the callback of a dying weak reference, and many die while the
        libraries of language models are imported. The next call of `progress` then raises it.
        """
        if threading.current_thread() is not threading.main_thread():
            yield  # only the main thread receives signals
            return

        def note(number: int, frame: FrameType | None) -> None:
            self._interrupted = True
            raise KeyboardInterrupt

        self._interrupted = False
        before = signal.signal(signal.SIGINT, note)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before or signal.SIG_DFL)
            self._interrupted = False

    def clear(self) -> None:
        """Remove an unfinished progress line."""
        if self._line_open:
            self.err.write("\r\x1b[K")
            self._line_open = False

    def _write(self, stream: TextIO, text: str) -> None:
        self.clear()
        stream.write(text + "\n")
        stream.flush()

    def refuse(self, error: ScenewrightError, data: Mapping[str, Any], choices: Sequence[str] = ()) -> NoReturn:
        """Report an instruction that was not carried out, with its candidates, and exit with the error's code."""
        if self.as_json:
            self.row(data)
        self.say(f"scenewright: {error}")
        if isinstance(error, AbsentError) and choices:
            self.say("the nearest things that are there:")
        for number, choice in enumerate(choices, start=1):
            self.say(f"  {number}. {choice}")
        raise typer.Exit(error.exit_code)


terminal = Terminal()  # one for the process; options set its flags, commands write to it


def error_json(error: ScenewrightError) -> dict[str, Any]:
    """An error as data: verdict, reason, exit code, and the usage of a model that gave no plan."""
    name = type(error).__name__.removesuffix("Error")
    verdict = "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
    data = {"verdict": verdict, "reason": str(error), "exit_code": error.exit_code}
    usage = getattr(error, "usage", None)
    return data if usage is None else {**data, "usage": usage.model_dump(mode="json")}


def read_batch(path: str) -> list[dict[str, Any]]:
    """The rows of a batch file: one JSON object a line with `id`, `text` and optionally `context`; "-" is stdin.

    Raises:
        UserError: a line is not such an object; the message names it.
    """
    try:
        if path == "-":
            lines = sys.stdin.read().splitlines()
        else:
            with open(path, encoding="utf-8") as file:
                lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"cannot read the batch file {path}: {error}") from error
    rows = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
        except ValueError as error:
            raise UserError(f"{path}, line {number}: not JSON ({error})") from error
        if not isinstance(row, dict) or "id" not in row or not isinstance(row.get("text"), str):
            raise UserError(f'{path}, line {number}: expected {{"id": …, "text": "…"}}')
        if not isinstance(row.get("context", ""), str | None):
            raise UserError(f"{path}, line {number}: context must be the instruction before, as text")
        rows.append(row)
    return rows
