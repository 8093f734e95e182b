"""What a session writes into its log: the fields of each kind of record (see `log.py`).

Knows scenes, plans and results as plain data. Refuses to know files, and works nothing out where there is no log:
digests of large clouds take their time.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import ScenewrightError
from .history import State
from .log import SessionLog
from .result import Result

if TYPE_CHECKING:
    from ...planners.plan import EditPlan


class Journal:
    """The records of one session, each on the disk when its method returns.

    Args:
        path: of the log to append to; None writes nothing.

    Raises:
        FileError: the log cannot be opened; of its methods, it cannot be written.
    """

    def __init__(self, path: str | Path | None) -> None:
        self._log = SessionLog(path) if path is not None else None

    def opened(self, state: State) -> None:
        """`open`: a session begins."""
        self._write("open", lambda: _opening(state))

    def embedded(self, before: State, after: State) -> None:
        """`embed`: language was laid over the scene."""
        self._write("embed", lambda: _embedding(before, after))

    def done(self, result: Result, before: State, after: State) -> None:
        """`do`: an instruction was carried out."""
        self._write("do", lambda: _deed(result, before, after))

    def refused(self, text: str, plan: EditPlan | None, error: ScenewrightError, state: State) -> None:
        """`failed`: an instruction was refused."""
        self._write("failed", lambda: _refusal(text, plan, error, state))

    def moved(self, kind: str, text: str, before: State, after: State) -> None:
        """`undo` or `redo`."""
        self._write(kind, lambda: {"text": text, "before": before.digest, "after": after.digest})

    def saved(self, path: str | Path, state: State) -> None:
        """`save`: the scene was written to a file."""
        self._write("save", lambda: {"path": str(path), "digest": state.digest})

    def close(self) -> None:
        """Close the log; closing twice is harmless."""
        if self._log is not None:
            self._log.close()

    def _write(self, kind: str, fields: Callable[[], dict[str, Any]]) -> None:
        if self._log is not None:
            self._log.append(kind, fields())


def _opening(state: State) -> dict[str, Any]:
    from ... import __version__

    scene = state.scene
    return {
        "scenewright": __version__,
        "scene": str(scene.path) if scene.path else None,
        "gaussians": len(scene.cloud),
        "digest": state.digest,
    }


def _embedding(before: State, after: State) -> dict[str, Any]:
    language = after.scene.language
    assert language is not None
    things = len(language.objects())
    return {"encoder": language.encoder, "things": things, "before": before.digest, "after": after.digest}


def _deed(result: Result, before: State, after: State) -> dict[str, Any]:
    """The plan in it tells who planned it, by which prompt, and what that cost."""
    return {
        "text": result.text,
        "plan": result.plan.model_dump(mode="json") if result.plan is not None else None,
        "receipts": [r.model_dump(mode="json") for r in result.receipts],
        "before": before.digest,
        "after": after.digest,
        "seconds": dict(result.seconds),
    }


def _refusal(text: str, plan: EditPlan | None, error: ScenewrightError, state: State) -> dict[str, Any]:
    return {
        "text": text,
        "plan": plan.model_dump(mode="json") if plan else None,
        "error": type(error).__name__,
        "message": str(error),
        "before": state.digest,
    }
