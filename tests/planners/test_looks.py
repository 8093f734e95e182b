"""Sentences about light, materials, holes and shadows by a writer who knew neither grammar nor vocabulary."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from scenewright.gaussians.world.finishes import described
from scenewright.gaussians.world.words import singular
from scenewright.planners.grammar.planner import GrammarPlanner

CASES = [json.loads(line) for line in (Path(__file__).parent / "looks.jsonl").read_text().splitlines()]
FLOORS = {"light": 0.9, "material": 0.85, "hole": 0.9, "refuse": 1.0}
WAYS = {
    "brighter": lambda op: (op.exposure or 0) > 1,
    "darker": lambda op: 0 < (op.exposure or 9) < 1,
    "warmer": lambda op: (op.warmth or 0) > 0,
    "cooler": lambda op: (op.warmth or 0) < 0 or (op.kelvin or 0) > 4900,
}
CHANGES = {"remove": "remove", "add": "cast", "softer": "lighter", "stronger": "darker"}


def head(name: str) -> str:
    found = singular(name.split()[-1])
    return {"ground": "floor", "cusion": "cushion"}.get(found, found)


def is_asked(op: Any, wanted: list[Any]) -> bool:
    name, target, fields = wanted
    paint = op.op == "recolor" and name == "relight" and op.adjust is not None  # a thing that is made brighter
    if not paint and (op.op != name or head(op.target.text) != head(target)):
        return False
    if paint:
        return head(op.target.text) == head(target)
    checks = {
        "way": lambda way: WAYS[way](op),
        "exposure": lambda times: abs((op.exposure or 0) / times - 1) < 0.06,
        "color": lambda color: op.color == color,
        "lamps": lambda way: op.lamps == way,
        "like": lambda thing: op.like is not None and head(op.like.text) == head(thing),
        "material": lambda said: (found := described(said)) is None or op.material is not None or found.finish is None,
        "change": lambda way: op.change == CHANGES[way],
    }
    return all(checks[key](value) for key, value in fields.items())


def outcome(case: dict[str, Any]) -> str:
    """ "right"; "wrong" if something would be changed that was not asked for; else "unanswered"."""
    ops = [op for op in GrammarPlanner().plan(case["text"]).ops if op.op != "select"]
    wanted = list(case["ops"])
    for op in ops:
        found = [w for w in wanted if is_asked(op, w)]
        if not found:
            return "wrong"
        for one in found:
            wanted.remove(one)
    deleted = any(op.op == "delete" for op in ops)  # a deletion takes the shadow along
    left = [w for w in wanted if not (deleted and w[0] == "shadow")]
    return "unanswered" if left else "right"


@pytest.mark.slow
def test_words_of_people_for_looks() -> None:
    found = Counter((case["group"], outcome(case)) for case in CASES)
    groups = Counter(case["group"] for case in CASES)
    shares = {group: found[group, "right"] / count for group, count in groups.items()}
    assert all(shares[group] >= floor for group, floor in FLOORS.items()), shares
    assert sum(n for (_, told), n in found.items() if told == "wrong") <= 0.05 * len(CASES)
