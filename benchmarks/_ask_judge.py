"""Judge edits in furnished rooms: half are clean, half were sabotaged behind the judge's back.

Rooms come from seeds that nothing was fitted on; the judge's bounds were set on other rooms.
"""

from __future__ import annotations

import itertools
import time
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch

from ..agent.session.judge import Judge
from ..gaussians import assets
from ..gaussians.assets import Truth
from ..gaussians.errors import ScenewrightError
from ..gaussians.language import encoders
from ..gaussians.language.field.embed import embed
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..tools.execute import carry_out
from ..tools.judging.case import Case
from ..tools.judging.changes import changes_between
from ..tools.judging.examine import Findings, examine
from ..tools.operation import Context, EditOp
from ..tools.registry import parse
from ._ask_sabotage import HIDDEN, SABOTAGES, Attempt, Damage
from ._iou import iou
from .harness import Metric

SEEDS = tuple(range(7401, 7409))
QUICK_SEEDS = SEEDS[:1]
QUICK_DETAIL = 0.4  # factor on the number of Gaussians of a room
EDITS, QUICK_EDITS = 25, 6  # a room, half of them sabotaged
CLEAN = 0.9  # intersection over union with the true object from which a selection is right
COLORS = ("teal", "red", "blue", "green", "purple", "orange", "yellow", "pink", "brown", "white", "black")
ASSETS = ("armchair", "potted plant", "floor lamp", "vase", "stool", "chair", "suitcase", "basket", "guitar", "table")
WHOLE = 0.97  # share of a thing that a repair must reach; as much again of other things may change
_REPAIRABLE = "residue, hidden"
GOAL_CAUGHT, GOAL_FALSE = 0.95, 0.03
_PATIENCE = 200  # edits that are tried until a sabotage applies to one


@dataclass(frozen=True, eq=False)
class Judged:
    """One judged edit.

    Attributes:
        op: the operation.
        kind: of the sabotage; "clean" for none.
        findings: of the judge.
        seconds, edit_seconds: of the judge and of the edit.
        case: the scenes.
        repaired: of a hidden residue, whether the judge loop ends with the whole thing changed and little else.
    """

    op: EditOp
    kind: str
    findings: Findings
    seconds: float
    edit_seconds: float
    case: Case
    repaired: bool | None = None

    @property
    def right(self) -> bool:
        return self.findings.passed == (self.kind == "clean")


def measure(quick: bool) -> list[Metric]:
    """The share of sabotaged edits that are caught, by kind, and of clean ones that are refused."""
    rooms = (room_of(seed, QUICK_DETAIL if quick else 1.0) for seed in (QUICK_SEEDS if quick else SEEDS))
    if quick:
        return figures([one for seed, room in rooms for one in judged(*room, seed, QUICK_EDITS, hidden=False)])
    return figures([one for seed, room in rooms for one in judged(*room, seed)])


def room_of(seed: int, detail: float = 1.0) -> tuple[int, tuple[Scene, Truth]]:
    """An embedded room and its truth."""
    room = assets.furnish(seed, detail=detail)
    return seed, (embed(room.scene, encoders.load()), room.truth)


def figures(found: Sequence[Judged]) -> list[Metric]:
    """The figures of judged edits."""
    kinds = [*SABOTAGES, *HIDDEN]
    clean = [j for j in found if j.kind == "clean"]
    bad = [j for j in found if j.kind in SABOTAGES]
    hidden = [j for j in found if j.kind in HIDDEN]
    made = [
        Metric("judge.caught", _share(bad), "1", "higher", 0.02, GOAL_CAUGHT),
        Metric("judge.false_alarms", 1 - _share(clean), "1", "lower", 0.5, GOAL_FALSE),
        Metric("judge.hidden.caught", _share(hidden), "1", "higher", 0.1),
        Metric("judge.edits", len(clean) + len(bad), "count"),
        Metric("judge.seconds", float(np.median([j.seconds for j in found] or [0.0])), "s", "lower", 0.5),
        Metric("judge.edit_seconds", float(np.median([j.edit_seconds for j in found] or [0.0])), "s", "lower", 0.5),
    ]
    if tried := [j for j in found if j.repaired is not None]:
        share = float(np.mean([bool(j.repaired) for j in tried]))
        made.append(Metric("judge.repaired.residue.hidden", share, "1", "higher", 0.15))
    for kind in kinds:
        if some := [j for j in found if j.kind == kind]:
            key = kind.replace(", ", ".").replace(" ", "_")
            made.append(Metric(f"judge.caught.{key}", _share(some), "1", "higher", 0.1))
            made.append(Metric(f"judge.count.{key}", len(some), "count"))
    return made


def _share(found: Sequence[Judged]) -> float:
    return float(np.mean([j.right for j in found])) if found else 0.0


def judged(scene: Scene, truth: Truth, seed: int, edits: int = EDITS, hidden: bool = True) -> list[Judged]:
    """Judged edits of one room, half of them sabotaged, and a fifth as many of each hidden sabotage as apply."""
    rng = np.random.default_rng([zlib.crc32(b"judge"), seed])
    tries = attempts(scene, truth, rng)
    kinds, found = list(SABOTAGES), list[Judged]()
    for k in range(edits):
        if k % 2 == 0:
            attempt, seconds = next(tries)
            found.append(_judge(attempt, attempt.scene, attempt.after, "clean", seconds))
        else:
            kind = kinds[k // 2 % len(kinds)]
            found += _sabotaged(tries, kind, SABOTAGES[kind])
    for kind, damage in HIDDEN.items() if hidden else ():
        for _ in range(edits // 5):
            found += _sabotaged(tries, kind, damage)
    return found


def _sabotaged(attempts: Iterator[tuple[Attempt, float]], kind: str, damage: Damage) -> list[Judged]:
    """The next edit that this sabotage applies to, judged; none if it applies to nothing in the room."""
    for attempt, seconds in itertools.islice(attempts, _PATIENCE):
        try:
            done = damage(attempt)
        except ScenewrightError:
            continue  # the operation cannot be done to another thing
        if done is not None:
            found = _judge(attempt, *done, kind, seconds)
            return [replace(found, repaired=_repaired(attempt, done[0])) if kind == _REPAIRABLE else found]
    return []


def _repaired(attempt: Attempt, before: Scene) -> bool:
    """Whether the judge loop, on a scene whose field lacks a piece of the thing, changes what the thing really is."""
    try:
        after = Judge().carry_out(before, attempt.op, attempt.context).scene
    except ScenewrightError:
        return False
    changed = changes_between(before.cloud, after.cloud).any
    meant = mask_of(before.cloud, attempt.selection.ids)
    carried = attempt.op.may_change(attempt.scene, attempt.selection)  # what stands on it goes along
    missed, other = int((meant & ~changed).sum()), int((changed & ~carried).sum())
    return missed <= (1 - WHOLE) * int(meant.sum()) and other <= (1 - WHOLE) * int(meant.sum())


def _judge(attempt: Attempt, before: Scene, after: Scene, kind: str, edit_seconds: float) -> Judged:
    case = Case(before, after, attempt.op, attempt.context)
    started = time.perf_counter()
    findings = examine(case)
    return Judged(attempt.op, kind, findings, time.perf_counter() - started, edit_seconds, case)


def attempts(scene: Scene, truth: Truth, rng: np.random.Generator) -> Iterator[tuple[Attempt, float]]:
    """Clean edits without end, and their seconds: of things whose selection is right by the truth."""
    context = Context(viewer=scene.cameras[0], encoder=encoders.load())
    found = _selections(scene, truth, context)
    assert found, "no thing of this room is selected as it should be"
    for step in range(10_000):
        thing, query, selection = found[int(rng.integers(len(found)))]
        op = _operation(step, query, found, rng)
        try:
            started = time.perf_counter()
            done = carry_out(scene, op, context, seen=False)
        except ScenewrightError:
            continue
        targeted = op.query() is not None
        none = Selection(Query(), "found", torch.zeros(0, dtype=torch.int64))
        own = np.random.default_rng(int(rng.integers(2**31)))
        attempt = Attempt(
            scene, op, context, selection if targeted else none, done.scene, truth.ids, thing if targeted else -1, own
        )
        yield attempt, time.perf_counter() - started


def _selections(scene: Scene, truth: Truth, context: Context) -> list[tuple[int, dict[str, Any], Selection]]:
    """Things that their name, or name and colour, selects rightly: number, query and selection."""
    found = []
    for thing in truth.objects:
        alone = sum(o.kind == thing.kind for o in truth.objects) == 1
        query: dict[str, Any] = {"text": thing.kind} if alone else {"text": thing.kind, "colors": [thing.color]}
        selection = context.resolve(scene, Query.model_validate(query))
        if selection.verdict == "found":
            mine = mask_of(scene.cloud, selection.ids).numpy()
            if iou(mine, (truth.ids == thing.id).numpy()) >= CLEAN:
                found.append((thing.id, query, selection))
    return found


def _operation(step: int, query: dict[str, Any], found: Any, rng: np.random.Generator) -> EditOp:
    """The next operation; the kinds take turns."""
    color, asset = str(rng.choice(COLORS)), str(rng.choice(ASSETS))
    others = [q for _, q, _ in found if q != query] or [query]
    other = others[int(rng.integers(len(others)))]
    away = float(rng.uniform(0.15, 0.8))
    place = {"relation": str(rng.choice(["next_to", "on", "left_of", "right_of", "in_front_of"])), "anchors": [other]}
    makers: list[dict[str, Any]] = [
        {"op": "delete", "target": query},
        {"op": "recolor", "target": query, "color": color},
        {"op": "insert", "asset": asset, **({"color": color} if rng.random() < 0.5 else {})},
        {
            "op": "move", "target": query, "direction": str(rng.choice(["left", "right", "forward", "backward"])),
            "distance": {"value": round(away, 2), "unit": "m"},
        },
        {"op": "insert", "asset": asset, "place": place},
        {"op": "recolor", "target": query, "adjust": str(rng.choice(["darker", "lighter", "more_saturated"]))},
        {"op": "replace", "target": query, "asset": asset, "color": color},
        {"op": "recolor", "target": query, "color": str(rng.choice(COLORS))},
        {"op": "move", "target": query, "place": place},
        {"op": "delete", "target": query},
        {"op": "scale", "target": query, "factor": round(float(rng.uniform(0.6, 1.6)), 2)},
        {"op": "duplicate", "target": query},
        {"op": "rotate", "target": query, "degrees": round(float(rng.uniform(20, 340)))},
    ]  # fmt: skip
    return parse(makers[step % len(makers)])
