"""The set of hand-written instructions on hand-written rooms, and the judgement of answers.

Half of the set is held back: only its totals are reported, so that nobody fits the planners to single instructions.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from ..agent.session.observation import GraphObservation
from ..planners.impossible import Step
from ..planners.plan import Planner
from ..planners.rooms.graph import SceneGraph
from ..planners.rooms.graph_scene import Stage
from ..planners.rooms.plan_on_graph import Resolved, resolve_text
from . import _data

FOLDER = Path(__file__).resolve().parent.parent / "tests" / "planners" / "written"
Outcome = Literal["right", "wrong_edit", "wrong_answer", "unanswered"]
# Fields of a step that are compared; `amount` is not, as nobody says how much "a bit" is.
_FIELDS = ("color", "adjust", "degrees", "axis", "direction", "factor", "count", "asset", "value", "lamps")
_DEFAULTS = {"count": 1, "axis": {"rotate": "up", "scale": "all"}}


@dataclass(frozen=True)
class Judged:
    """One instruction answered.

    Attributes:
        case: as written.
        outcome: "right": the same steps on the same nodes, or the same verdict; "wrong_edit": something would have been
            done to the wrong thing, or the wrong thing done; "wrong_answer": nothing would have been done, for a reason
            that is not the right one; "unanswered": not understood.
        seconds: from words to targets.
        told: what came, for a reader.
        asked: whether a language model was asked.
    """

    case: dict[str, Any]
    outcome: Outcome
    seconds: float
    told: str
    asked: bool = False


def cases(folder: Path = FOLDER) -> list[dict[str, Any]]:
    """The written instructions, each with `steps` and their targets or a `verdict`; raises as `_data.instructions`."""
    return _data.instructions(folder / "instructions.jsonl")


def strangers(folder: Path = FOLDER) -> list[dict[str, Any]]:
    """Instructions by writers who knew neither grammar nor lexicon, over rooms of their own; raises as `cases`."""
    return _data.instructions(folder / "strangers.jsonl")


def is_held(case: dict[str, Any]) -> bool:
    """Whether a case belongs to the held-back half, by the hash of its id."""
    return hashlib.sha256(case["id"].encode()).digest()[0] % 2 == 1


@cache
def stage(room: str, folder: Path = FOLDER) -> Stage:
    """A written room, ready to be asked."""
    return Stage.of(SceneGraph.read(folder / f"{room}.json"))


def judge(found: Resolved, case: dict[str, Any]) -> Outcome:
    """Whether an answer is the one that was written down."""
    expected = case["verdict"]
    if found.verdict == "ok":
        wanted = case.get("steps", ())
        same = len(found.steps) == len(wanted) and all(map(_same, found.steps, wanted))
        return "right" if same else "wrong_edit"
    if found.verdict == expected:
        # Where the planner itself says so, its plan has no place for candidates.
        candidates = set(case.get("candidates", found.candidates) if found.plan.ops else found.candidates)
        return "right" if candidates == set(found.candidates) else "wrong_answer"
    return "unanswered" if found.verdict == "not_understood" else "wrong_answer"


def _same(step: Step, wanted: dict[str, Any]) -> bool:
    """Whether a step does what was written: the same operation, on the same nodes, with the same fields."""
    got = described(step)
    if got["op"] != wanted["op"] or set(got["targets"]) != set(wanted["targets"]):
        return False
    keys = (got.keys() | wanted.keys()) - {"op", "targets"}
    return all(_agree(got.get(key), wanted.get(key)) for key in keys)


def _agree(got: Any, wanted: Any) -> bool:
    if wanted == "*":
        return got is not None
    if wanted in (">", "<"):
        return isinstance(got, int | float) and (got > 1 if wanted == ">" else got < 1)
    if isinstance(got, dict) and isinstance(wanted, dict):
        return got["relation"] == wanted["relation"] and set(got["anchors"]) == set(wanted["anchors"])
    if isinstance(got, list) and isinstance(wanted, list):
        return set(got) == set(wanted)
    if isinstance(got, int | float) and isinstance(wanted, int | float):
        return math.isclose(got, wanted, rel_tol=1e-4)
    if isinstance(got, str) and isinstance(wanted, str):
        return got.replace("grey", "gray") == wanted.replace("grey", "gray")
    return bool(got == wanted)


def described(step: Step) -> dict[str, Any]:
    """A step in the words of the set: what is left at its default is not there."""
    told: dict[str, Any] = {"op": step.op.op, "targets": list(step.targets)}
    for name in _FIELDS:
        default = _DEFAULTS.get(name)
        default = default.get(step.op.op) if isinstance(default, dict) else default
        if (value := getattr(step.op, name, None)) not in (None, default):
            told[name] = value
    if (place := getattr(step.op, "place", None)) is not None:
        told["place"] = {"relation": place.relation, "anchors": list(step.anchors)}
    if getattr(step.op, "toward", None) is not None:
        told["toward"] = list(step.anchors)
    if step.metres is not None:
        told["metres"] = step.metres
    return told


def measure(planner: Planner, todo: Iterable[dict[str, Any]], accounted: bool = False) -> list[Judged]:
    """Every instruction planned and resolved on its room; with `accounted`, seconds that a stand-in for a model states
    in its usage and did not sleep are added."""
    judged = []
    for case in todo:
        room = stage(case["room"])
        started = time.perf_counter()
        found = resolve_text(room, planner, case["text"], case.get("context"), GraphObservation(room))
        seconds = time.perf_counter() - started
        usage = found.plan.usage
        seconds += usage.seconds if accounted and usage is not None else 0.0
        steps = "; ".join(json.dumps(described(s)) for s in found.steps)
        told = f"{found.verdict} {list(found.candidates) or ''} {found.reason} {steps}"
        judged.append(Judged(case, judge(found, case), seconds, told, usage is not None))
    return judged


def share(judged: Sequence[Judged], outcome: Outcome) -> float:
    """Share of answers with this outcome, 0 for none."""
    return sum(j.outcome == outcome for j in judged) / len(judged) if judged else 0.0


def right_of_answered(judged: Sequence[Judged]) -> float:
    """Share of right ones among those that were answered at all."""
    answered = [j for j in judged if j.outcome != "unanswered"]
    return share(answered, "right")
