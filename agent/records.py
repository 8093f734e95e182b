"""What a session writes into its log: the fields of each kind of record (see `log.py`).

Knows scenes, plans and results as plain data. Refuses to know files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..gaussians.errors import ScenewrightError
from .history import State
from .result import Result

if TYPE_CHECKING:
    from ..planners.plan import EditPlan


def opening(state: State) -> dict[str, Any]:
    """`open`: a session begins."""
    from .. import __version__

    scene = state.scene
    return {
        "scenewright": __version__,
        "scene": str(scene.path) if scene.path else None,
        "gaussians": len(scene.cloud),
        "digest": state.digest,
    }


def embedding(before: State, after: State) -> dict[str, Any]:
    """`embed`: language was laid over the scene."""
    language = after.scene.language
    assert language is not None
    things = len(language.objects())
    return {"encoder": language.encoder, "things": things, "before": before.digest, "after": after.digest}


def deed(result: Result, before: State, after: State) -> dict[str, Any]:
    """`do`: an instruction was carried out; the plan tells who planned it, by which prompt, and what that cost."""
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
