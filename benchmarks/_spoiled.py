"""Plans of a sloppy or hostile model: right plans, and the same spoiled in one respect each.

A stand-in insists on one plan, whatever it is told. A spoiled plan passes if it is carried out as it stands; a right
one is refused if it is not. The plans come from the written instructions, whose right steps are known.
"""

from __future__ import annotations

import json
import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from ..agent.session.observation import GraphObservation
from ..gaussians.errors import BackendError, ScenewrightError
from ..planners.model.backend import Answer, Message, OnText
from ..planners.model.planner import ModelPlanner
from ..planners.plan import EditPlan, Planner, Usage
from ..planners.rooms.graph_scene import Stage
from ..planners.rooms.plan_on_graph import recalled, resolve_plan
from ..tools.registry import parse
from . import _scripted, _written
from .harness import Metric

SEED = 1407
A_CLASS = 40  # spoiled plans of each class
_OPPOSITE = {
    "left": "right", "right": "left", "forward": "backward", "backward": "forward", "up": "down", "down": "up",
    "left_of": "right_of", "right_of": "left_of", "in_front_of": "behind", "behind": "in_front_of", "on": "under",
    "under": "on", "above": "under",
}  # fmt: skip
_COLORS = ("red", "blue", "green", "yellow", "black", "white", "purple", "orange")
Steps = list[dict[str, Any]]


@dataclass(frozen=True)
class Spoiled:
    """A plan that a stand-in insists on.

    Attributes:
        case: the written instruction.
        how: the class of the fault; "" if the plan is right.
        steps: operations as JSON, with ids of the rows of the room's stage.
    """

    case: dict[str, Any]
    how: str
    steps: Steps


class Insisting:
    """A `ModelBackend` that gives the same plan as often as it is asked."""

    name = "insisting stand-in, not a real model"
    sees = False
    window = 32_768

    def __init__(self, steps: Steps) -> None:
        self._text = json.dumps({"verdict": "ok", "ops": steps})

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        return Answer(self._text, Usage(model=self.name, requests=1))


def right_plans() -> list[Spoiled]:
    """The right plan of every written instruction that is an edit."""
    cases = [c for c in (*_written.cases(), *_written.strangers()) if c["verdict"] == "ok"]
    found = [Spoiled(case, "", steps) for case in cases if (steps := _right(case)) is not None]
    return [one for one in found if carried_out(one, None) == "right"]


def _right(case: dict[str, Any]) -> Steps | None:
    stage = _written.stage(case["room"])
    told = _scripted._said(case, stage).get("ops")
    if not told:
        return None
    return [_named(op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op}, stage) for op in told]


def _named(node: Any, stage: Stage) -> Any:
    """A step whose queries also say the name that the room gives to their first thing, as models do."""
    if isinstance(node, list):
        return [_named(item, stage) for item in node]
    if not isinstance(node, dict):
        return node
    made = {key: _named(value, stage) for key, value in node.items()}
    rows = made.get("groups")
    if rows and rows[0] >= len(stage.graph.nodes):  # floor and walls have no ids that a model sees
        return {**{k: v for k, v in made.items() if k != "groups"}, "text": stage.ids[rows[0]], "pick": "all"}
    if rows:
        labels = {stage.graph.nodes[r].label for r in rows if r < len(stage.graph.nodes)}
        made |= {"text": labels.pop()} if len(labels) == 1 else {}
    return made


def carried_out(plan: Spoiled, planner: Callable[[Spoiled], Planner] | None) -> str:
    """What comes of a plan in its room, as `_written.judge` says; "right" or "wrong_edit" if it is carried out.

    Args:
        planner: makes the planner that gets it from the stand-in; None takes the plan as it is.
    """
    case, stage = plan.case, _written.stage(plan.case["room"])
    context = case.get("context")
    last = recalled(stage, _grammar().plan(context)) if context else None
    if planner is None:
        try:
            made = EditPlan(instruction=case["text"], ops=tuple(parse(s) for s in plan.steps), planner="stand-in")
        except ScenewrightError:
            return "unanswered"
    else:
        try:
            made = planner(plan).plan(case["text"], previous=context, observation=GraphObservation(stage))
        except BackendError:
            return "unanswered"
    return _written.judge(resolve_plan(stage, made, last), case)


@cache
def _grammar() -> Planner:
    from ..planners import load

    return load("grammar")


def guarded(plan: Spoiled) -> Planner:
    """The model planner with the stand-in that insists on a plan."""
    return ModelPlanner(Insisting(plan.steps))


# -- faults ---------------------------------------------------------------------------------------------------------


def spoiled_plans(right: Sequence[Spoiled], count: int = A_CLASS, seed: int = SEED) -> list[Spoiled]:
    """`count` plans of each class, each spoiled once, and all of them wrong if they are carried out."""
    found: list[Spoiled] = []
    for name, spoil in _FAULTS.items():
        chance = random.Random(f"{seed} {name}")
        order = list(right)
        chance.shuffle(order)
        made = (Spoiled(one.case, name, steps) for one in order if (steps := spoil(one, chance)) is not None)
        wrong = (one for one in made if carried_out(one, None) == "wrong_edit")
        found += [one for one, _ in zip(wrong, range(count), strict=False)]
    return found


def _stage(plan: Spoiled) -> Stage:
    return _written.stage(plan.case["room"])


def _touched(steps: Steps) -> set[int]:
    return {row for step in steps for row in _rows(step)}


def _rows(node: Any) -> Iterator[int]:
    if isinstance(node, dict):
        yield from node.get("groups", ())
        for value in node.values():
            yield from _rows(value)
    elif isinstance(node, list):
        for item in node:
            yield from _rows(item)


def _other(plan: Spoiled, chance: random.Random, alike: int | None = None) -> int | None:
    """A thing that the plan does not touch; one with the name of `alike` if there is one."""
    nodes, used = _stage(plan).graph.nodes, _touched(plan.steps)
    free = [i for i in range(len(nodes)) if i not in used and nodes[i].label]
    twins = [i for i in free if alike is not None and nodes[i].label == nodes[alike].label]
    return chance.choice(twins or free) if free else None


def _query(plan: Spoiled, row: int) -> dict[str, Any]:
    return {"text": _stage(plan).graph.nodes[row].label, "groups": [row]}


def _step_on(plan: Spoiled, row: int, chance: random.Random, not_of: str = "") -> dict[str, Any]:
    """Some step on one thing."""
    target = _query(plan, row)
    steps: Steps = [
        {"op": "delete", "target": target},
        {"op": "recolor", "target": target, "color": chance.choice(_COLORS)},
        {"op": "move", "target": target, "direction": chance.choice(("left", "right", "forward"))},
        {"op": "scale", "target": target, "factor": chance.choice((0.5, 1.5, 2.0))},
        {"op": "rotate", "target": target, "degrees": chance.choice((45, 90, 180))},
        {"op": "opacity", "target": target, "value": 0.0},
        {"op": "duplicate", "target": target},
    ]
    return chance.choice([s for s in steps if s["op"] != not_of])


def _extra(plan: Spoiled, chance: random.Random) -> Steps | None:
    row = _other(plan, chance)
    return None if row is None else [*plan.steps, _step_on(plan, row, chance)]


def _extra_on_it(plan: Spoiled, chance: random.Random) -> Steps | None:
    rows = plan.steps[0].get("target", {}).get("groups")
    return None if not rows else [*plan.steps, _step_on(plan, rows[0], chance, plan.steps[0]["op"])]


def _missing(plan: Spoiled, chance: random.Random) -> Steps | None:
    if len(plan.steps) < 2:
        return None
    gone = chance.randrange(len(plan.steps))
    return [s for i, s in enumerate(plan.steps) if i != gone]


def _wrong_target(plan: Spoiled, chance: random.Random) -> Steps | None:
    rows = plan.steps[0].get("target", {}).get("groups")
    row = _other(plan, chance, rows[0] if chance.random() < 0.5 else None) if rows else None
    return None if row is None else [{**plan.steps[0], "target": _query(plan, row)}, *plan.steps[1:]]


def _wrong_kind(plan: Spoiled, chance: random.Random) -> Steps | None:
    rows = plan.steps[0].get("target", {}).get("groups")
    if not rows:
        return None
    step = _step_on(plan, rows[0], chance, plan.steps[0]["op"])
    return [{**step, "target": plan.steps[0]["target"]}, *plan.steps[1:]]


def _wrong_count(plan: Spoiled, chance: random.Random) -> Steps | None:
    first = plan.steps[0]
    if first["op"] in ("insert", "duplicate"):
        return [{**first, "count": first.get("count", 1) + chance.choice((1, 2, 4))}, *plan.steps[1:]]
    rows = first.get("target", {}).get("groups", [])
    if len(rows) > 2:
        return [{**first, "target": {**first["target"], "groups": rows[:-1]}}, *plan.steps[1:]]
    row = _other(plan, chance, rows[0]) if rows else None
    if row is None or _stage(plan).graph.nodes[row].label != _stage(plan).graph.nodes[rows[0]].label:
        return None
    return [{**first, "target": {**first["target"], "groups": [*rows, row], "pick": "all"}}, *plan.steps[1:]]


def _wrong_color(plan: Spoiled, chance: random.Random) -> Steps | None:
    colored = [i for i, s in enumerate(plan.steps) if s.get("color") and not s.get("adjust")]
    if not colored:
        return None
    at = chance.choice(colored)
    other = chance.choice([c for c in _COLORS if c not in plan.steps[at]["color"]])
    return [{**s, "color": other} if i == at else s for i, s in enumerate(plan.steps)]


def _wrong_direction(plan: Spoiled, chance: random.Random) -> Steps | None:
    for i, step in enumerate(plan.steps):
        if step.get("direction") in _OPPOSITE:
            changed = {**step, "direction": _OPPOSITE[step["direction"]]}
        elif step["op"] == "rotate" and step.get("degrees") and abs(step["degrees"]) % 180:
            changed = {**step, "degrees": -step["degrees"]}
        elif step.get("place", {}).get("relation") in _OPPOSITE and step["place"].get("anchors"):
            place = {**step["place"], "relation": _OPPOSITE[step["place"]["relation"]]}
            changed = {**step, "place": place}
        else:
            continue
        return [*plan.steps[:i], changed, *plan.steps[i + 1 :]]
    return None


def _wrong_amount(plan: Spoiled, chance: random.Random) -> Steps | None:
    for i, step in enumerate(plan.steps):
        if isinstance(step.get("distance"), dict):
            changed = {**step, "distance": {**step["distance"], "value": step["distance"]["value"] * 3}}
        elif step.get("degrees"):
            changed = {**step, "degrees": step["degrees"] / 2}
        elif step["op"] == "scale" and step.get("factor"):
            changed = {**step, "factor": round(1 / step["factor"], 3)}
        else:
            continue
        return [*plan.steps[:i], changed, *plan.steps[i + 1 :]]
    return None


def _wrong_place(plan: Spoiled, chance: random.Random) -> Steps | None:
    for i, step in enumerate(plan.steps):
        anchors = step.get("place", {}).get("anchors")
        row = _other(plan, chance) if anchors and anchors[0].get("groups") else None
        if row is not None:
            place = {**step["place"], "anchors": [_query(plan, row), *anchors[1:]]}
            return [*plan.steps[:i], {**step, "place": place}, *plan.steps[i + 1 :]]
    return None


_FAULTS: dict[str, Callable[[Spoiled, random.Random], Steps | None]] = {
    "extra": _extra, "extra_on_it": _extra_on_it, "missing": _missing, "wrong_target": _wrong_target,
    "wrong_kind": _wrong_kind, "wrong_count": _wrong_count, "wrong_color": _wrong_color,
    "wrong_direction": _wrong_direction, "wrong_amount": _wrong_amount, "wrong_place": _wrong_place,
}  # fmt: skip


def measure(quick: bool) -> tuple[tuple[Metric, ...], tuple[str, ...]]:
    """Shares of spoiled plans that are carried out, by class, and of right ones that are refused; and a note."""
    right = right_plans()
    wrong = spoiled_plans(right, A_CLASS // 4 if quick else A_CLASS)
    passed = Counter(one.how for one in wrong if carried_out(one, guarded) == "wrong_edit")
    of = Counter(one.how for one in wrong)
    todo = right[::8] if quick else right
    refused = sum(carried_out(one, guarded) != "right" for one in todo)
    found = [
        Metric("spoiled.passed", passed.total() / max(len(wrong), 1), "share", "lower"),
        *(Metric(f"spoiled.passed.{how}", passed[how] / of[how], "share", "lower") for how in _FAULTS if of[how]),
        Metric("spoiled.right_refused", refused / max(len(todo), 1), "share", "lower"),
    ]
    note = (
        f"spoiled: a stand-in insists on one of {len(wrong)} plans that are wrong in one respect ({', '.join(of)}), "
        f"or on one of {len(todo)} right plans with ids. passed: the wrong plan would have been carried out."
    )
    return tuple(found), (note,)
