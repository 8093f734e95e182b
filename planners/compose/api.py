"""`compose`: turn a sentence into the scene graph of a room, in one call, with a chosen planner.

If wishes conflict, it raises an error unless `best` is set. `SceneGraph.build` makes the Gaussians.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Literal

from ...gaussians.effort import Dial, Effort
from ...gaussians.errors import InstructionError, UserError
from .. import MODEL_VARIABLE
from ..rooms.graph import SceneGraph

if TYPE_CHECKING:
    from ..model.backend import ModelBackend
    from .compose import Composition

Mode = Literal["auto", "model"]


def compose(
    text: str, *, seed: int = 0, planner: str = "auto", best: bool = False, effort: Effort | None = None
) -> SceneGraph:
    """The graph of the room that `text` describes; the same arguments give the same graph.

    Args:
        text: "a minimalist home office", "a cozy coffee shop with a counter and four small tables".
        seed: different seeds give different rooms of one description.
        planner: what proposes the brief, see `composed`.
        best: if wishes conflict, return the best layout instead of raising an error.
        effort: how long the layout is searched: "fast", "balanced", "accurate" or seconds; with seconds the graph
            depends on the machine's speed.

    Raises:
        UserError: the words describe no room, or no planner has this name.
        InstructionError: not all wishes are possible together; the message names the smallest conflict.
        BackendError: the model cannot be reached.
    """
    dial = None if effort is None else Dial(effort)
    layout = composed(text, seed=seed, planner=planner, dial=dial).layout
    if layout.conflicts and not best:
        smallest = min(layout.conflicts, key=lambda conflict: len(conflict.statements))
        raise InstructionError(f"not all of this is possible together: {'; '.join(smallest.statements)}")
    return layout.graph


def composed(
    text: str, *, seed: int = 0, planner: str = "auto", budget: str | None = None, dial: Dial | None = None
) -> Composition:
    """The room that `text` describes, with its brief, remarks, omissions and conflicts.

    Args:
        planner: "grammar" for the embedded reader; "auto" asks the model that the environment names
            (`SCENEWRIGHT_MODEL`), or the one named after "auto:", where the reader does not understand everything; a
            model alone ("openai:...") is always asked.
        budget: limits of the model, as `Budget.parse` reads them: "20s,0.05usd".
        dial: chooses how long the layout is searched.

    Raises:
        UserError: the words describe no room, no planner has this name, or the budget is none.
        BackendError: the model cannot be reached, or the budget is used up.
    """
    from ..budget import Budget, Ledger
    from .compose import compose as proposed

    ledger = Ledger(Budget.parse(budget)) if budget is not None else None
    backend, mode = _proposer(planner)
    return proposed(text, seed=seed, planner=backend, mode=mode, ledger=ledger, dial=dial)


def _proposer(spec: str) -> tuple[ModelBackend | None, Mode]:
    """The model that a planner's name means, or None, and the mode in which it is asked."""
    from .. import model

    kind, _, named = spec.partition(":")
    if spec == "grammar":
        return None, "auto"
    if spec == "auto":
        named = os.environ.get(MODEL_VARIABLE, "").strip()
    if kind == "auto" and not named:
        return None, "auto"
    if kind == "auto" and model.is_model(named):
        return model.load(named), "auto"
    if model.is_model(spec):
        return model.load(spec), "model"
    raise UserError(
        f"no planner of this name can compose; planners are auto, grammar, {', '.join(model.FORMS)}, and auto: before "
        "one of these"
    )
