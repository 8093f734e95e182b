"""What a session writes into its log: one function for each kind of record, which gives its fields (see `log.py`).

A session without a log calls none of them, as digests of large clouds take time.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import ScenewrightError
from .history import State
from .result import Result

if TYPE_CHECKING:
    from ...planners.plan import EditPlan


def opened(state: State) -> dict[str, Any]:
    """`open`: a session begins."""
    from ... import __version__

    scene = state.scene
    return {
        "scenewright": __version__,
        "scene": str(scene.path) if scene.path else None,
        "gaussians": len(scene.cloud),
        "digest": state.digest,
    }


def embedded(before: State, after: State) -> dict[str, Any]:
    """`embed`: the scene got a language field."""
    language = after.scene.language
    assert language is not None
    things = len(language.objects())
    return {"encoder": language.encoder, "things": things, "before": before.digest, "after": after.digest}


def done(result: Result, before: State, after: State) -> dict[str, Any]:
    """`do`: an instruction was carried out. The plan tells who planned it, by which prompt, and what that cost."""
    return {
        "text": result.text,
        "plan": result.plan.model_dump(mode="json") if result.plan is not None else None,
        "receipts": [r.model_dump(mode="json") for r in result.receipts],
        "before": before.digest,
        "after": after.digest,
        "seconds": dict(result.seconds),
    }


def refused(text: str, plan: EditPlan | None, error: ScenewrightError, state: State) -> dict[str, Any]:
    """`failed`: an instruction was refused."""
    return {
        "text": text,
        "plan": plan.model_dump(mode="json") if plan else None,
        "error": type(error).__name__,
        "message": str(error),
        "before": state.digest,
    }


def moved(text: str, before: State, after: State) -> dict[str, Any]:
    """`undo` or `redo` of an instruction."""
    return {"text": text, "before": before.digest, "after": after.digest}


def saved(path: str | Path, state: State) -> dict[str, Any]:
    """`save`: the scene was written to a file."""
    return {"path": str(path), "digest": state.digest}
