"""A scripted stand-in for a language model: gives the written answers with a given error rate and simulated latency.

Its name says that it is not a real model. The latency is only stated in the plan's usage; nothing sleeps.
"""

from __future__ import annotations

import hashlib
import math
import random
from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any

from ..agent.session.observation import GraphObservation
from ..gaussians.errors import UserError
from ..planners import load
from ..planners.plan import EditPlan, Observation, Usage
from ..planners.rooms.graph import SceneGraph
from ..planners.rooms.graph_scene import Stage
from ..tools.operation import EditOp
from ..tools.registry import parse
from . import _written

NAME = "scripted stand-in, not a real model"
MEDIAN, SPREAD = 1.5, 0.4  # seconds, and sigma of its logarithm: a hosted model that answers with some hundred tokens
_PLAIN = ("color", "adjust", "degrees", "axis", "direction", "count", "asset", "value", "lamps")
_MORE, _LESS = 1.25, 0.8  # factors for "bigger than one" and "smaller", where the set asks for no more
_SOME = 0.5  # metres for "any amount"
_GREY, _RED = {"color": "gray"}, {"color": "red"}


class Scripted:
    """Answers the instructions of the written set in their rooms; all others (such as the previous instruction, which
    only defines "it") are planned by the grammar.

    Args:
        errors: share of instructions that it gets wrong: half of them not understood, half done to the wrong thing.
        seed: of errors and latencies; they depend on the instruction's id alone, not on what was asked before.
    """

    name = NAME

    def __init__(self, errors: float, seed: int) -> None:
        self._errors, self._seed = errors, seed
        self._grammar = load("grammar")
        self._cases = {(c["room"], c["text"], c.get("context")): c for c in _every_case()}

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan that was written down, or a wrong one; see `Planner.plan`."""
        room = _room_of(observation.graph()) if observation is not None else None
        case = self._cases.get((room or "", text, previous))
        if case is None:
            return self._grammar.plan(text, previous=previous)
        chance = random.Random(hashlib.sha256(f"{self._seed} {case['id']}".encode()).digest())
        usage = Usage(model=NAME, requests=1, seconds=math.exp(chance.gauss(math.log(MEDIAN), SPREAD)))
        drawn = chance.random()
        stage = _written.stage(case["room"])
        told = _said(case, stage)
        if drawn < self._errors:
            told = {"verdict": "not_understood"} if drawn < self._errors / 2 else {"ops": _wrong(told, stage)}
        return EditPlan(instruction=text, planner=NAME, usage=usage, **told)


def _every_case() -> list[dict[str, Any]]:
    return [*_written.cases(), *_written.strangers()]


def _room_of(graph: SceneGraph) -> str | None:
    """The name of the written room that a planner sees, though the instruction before may have taken things away."""
    seen = _places(graph)
    return next((name for name, places in _rooms() if seen <= places), None)


@cache
def _rooms() -> tuple[tuple[str, frozenset[Any]], ...]:
    """The written rooms, and where what stands in each."""
    names = sorted({case["room"] for case in _every_case()})
    return tuple((name, _places(GraphObservation(_written.stage(name)).graph())) for name in names)


def _places(graph: SceneGraph) -> frozenset[Any]:
    return frozenset((n.id, n.label, n.position, n.size) for n in graph.nodes)


def _said(case: dict[str, Any], stage: Stage) -> dict[str, Any]:
    """Operations, or a verdict, as they were written down."""
    if case["verdict"] != "ok":
        return {"verdict": case["verdict"]}
    try:
        return {"ops": tuple(parse(_fields(step, stage)) for step in case["steps"])}
    except UserError:  # the set says something that this script has no words for
        return {"verdict": "not_understood"}


def _fields(step: dict[str, Any], stage: Stage) -> dict[str, Any]:
    """A step of the set as an operation."""
    told: dict[str, Any] = {"op": step["op"], **{name: step[name] for name in _PLAIN if name in step}}
    if step["op"] != "insert":
        told["target"] = _all_of(stage, step["targets"])
    if (factor := step.get("factor")) is not None:
        told["factor"] = {">": _MORE, "<": _LESS}.get(factor, factor)
    if (metres := step.get("metres")) is not None:
        value = _SOME if metres == "*" else metres
        told["distance" if step["op"] in ("move", "duplicate") else "height"] = {"value": value, "unit": "m"}
    if (place := step.get("place")) is not None:
        pair = place["relation"] == "between" and len(place["anchors"]) == 2
        parts = [[a] for a in place["anchors"]] if pair else [place["anchors"]] if place["anchors"] else []
        told["place"] = {"relation": place["relation"], "anchors": [_all_of(stage, part) for part in parts]}
    if "toward" in step:
        told["toward"] = _all_of(stage, step["toward"])
    return told


def _rows(stage: Stage, ids: Iterable[Any]) -> list[int]:
    wanted = set(ids)
    return [row for row, id in enumerate(stage.ids) if id in wanted]


def _all_of(stage: Stage, ids: Sequence[Any]) -> dict[str, Any]:
    """A query for nodes; for what an earlier step adds, "it"."""
    if any(str(i).startswith("new ") for i in ids):
        return {"last": True}
    return {"groups": _rows(stage, ids), "pick": "all"}


def _wrong(told: dict[str, Any], stage: Stage) -> tuple[EditOp, ...]:
    """A wrong plan: the next thing in place of the right one, or another colour for an inserted thing."""
    ops: tuple[EditOp, ...] = told.get("ops", ())
    first: dict[str, Any] = ops[0].model_dump(exclude_none=True) if ops else {"op": "delete"}
    if first["op"] == "insert":
        changed: dict[str, Any] = _GREY if first.get("color") == "red" else _RED
    else:
        meant = first.get("target", {}).get("groups") or (0,)
        changed = {"target": {"groups": [(meant[0] + 1) % len(stage.graph.nodes)]}}
    return (parse({**first, **changed}), *ops[1:])
