"""What the checks of every edit catch: honest edits, and edits that were spoilt or applied to what was not meant.

Half of the furnished rooms and half of the real scenes were used while the checks were written; the others are held
out. Half of the edits are honest. Of the sabotaged ones, `spoiling.SPOILINGS` change the outcome of an operation before
it is checked, and `LIES` damage the language field, so that the words mean the wrong Gaussians. An edit counts as
caught if it is refused by a check, or if the session would ask first.
"""

from __future__ import annotations

import itertools
import os
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ...agent.session.embedding import embedded_by
from ...gaussians.errors import AmbiguousError, CheckFailedError, ScenewrightError, UnconfirmedError
from ...gaussians.language import encoders
from ...gaussians.language.field.store import load_field
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.query.terms import STRUCTURE
from ...gaussians.scene import Scene
from ...gaussians.world import kinds
from ...gaussians.world.core import core_of
from ...tools import execute
from ...tools.field_update import NewObject, append_objects, recount, with_measures
from ...tools.operation import Context, EditOp
from ...tools.ops.replace import Replace
from ...tools.registry import parse
from .. import _ask_judge, _ask_sabotage
from ..harness import Metric
from .color import THINGS, best_camera, rows_within, scene_named
from .spoiling import SPOILINGS, Attempt

SEEDS, HELD_SEEDS = (8301, 8302, 8303, 8304), (8305, 8306, 8307, 8308)
REAL, HELD_REAL = ("bonsai_room", "diorama_table"), ("guitar", "playbot", "desk_laptop")
GOAL_CAUGHT, GOAL_FALSE = 0.95, 0.03
READY = "SCENEWRIGHT_BENCH_SCENES"
_ALIKE = 2.5  # times as large: a thing that may stand in the place of another
_SMALL, _LARGE = ("vase", "basket", "potted plant", "table lamp"), ("chair", "floor lamp", "armchair", "guitar")
_PATIENCE = 120  # edits that are tried until a sabotage applies to one

Json = dict[str, Any]
REFUSED = (CheckFailedError, UnconfirmedError, AmbiguousError)


@dataclass(frozen=True)
class Tried:
    """One edit and what its checks said of it.

    Attributes:
        where: room or scene.
        real, held: whether it is a real scene, and one that the checks were not written on.
        kind: of the sabotage, "honest" for none.
        op: the operation as data.
        refused: the message with which it was refused, "" if it passed.
        seconds: of operation and checks.
    """

    where: str
    real: bool
    held: bool
    kind: str
    op: Json
    refused: str
    seconds: float = 0.0

    @property
    def right(self) -> bool:
        """Whether an honest edit passed, or a sabotaged one was refused."""
        return bool(self.refused) != (self.kind == "honest")


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene to edit.

    Attributes:
        name, real, held: as in `Tried`.
        scene: with its language field.
        edits: endless honest edits: an operation with its context, and what it is applied to; None: its own words.
        others: ids `[M]` of the other things, by the ids of the target's Gaussians.
        truth: the true object of each Gaussian, and of each operation its own; None in real scenes.
    """

    name: str
    real: bool
    held: bool
    scene: Scene
    edits: Iterator[tuple[EditOp, Context, Selection | None]]
    others: Callable[[Tensor], tuple[Tensor, ...]]
    truth: Tensor | None = None
    known: dict[int, Any] = field(default_factory=dict)


def measure(quick: bool) -> tuple[Metric, ...]:
    """The shares of sabotaged edits that are caught and of honest ones that are refused."""
    return figures(list(itertools.chain.from_iterable(tried(stage) for stage in stages(quick))))


def figures(found: Sequence[Tried]) -> tuple[Metric, ...]:
    """The rows of `bench edits`."""
    made = []
    for part, some in (("", found), (".held", [t for t in found if t.held]), (".real", [t for t in found if t.real])):
        honest, bad = [t for t in some if t.kind == "honest"], [t for t in some if t.kind != "honest"]
        if honest and bad:
            made += [
                Metric(f"checks{part}.caught", _share(bad), "1", "higher", 0.02, GOAL_CAUGHT if not part else None),
                Metric(f"checks{part}.false_alarms", 1 - _share(honest), "1", "lower", 0.5,
                       GOAL_FALSE if not part else None),
                Metric(f"checks{part}.sabotaged", len(bad), "count"),
                Metric(f"checks{part}.honest", len(honest), "count"),
            ]  # fmt: skip
    for kind in (*SPOILINGS, *LIES):
        if some := [t for t in found if t.kind == kind]:
            made.append(Metric(f"checks.caught.{kind.replace(' ', '_')}", _share(some), "1", "higher", 0.1))
    return tuple(made)


def _share(found: Sequence[Tried]) -> float:
    return float(np.mean([t.right for t in found])) if found else 0.0


def tried(stage: Stage, rounds: int = 1) -> Iterator[Tried]:
    """Honest and sabotaged edits of one scene, as many of the one as of the other."""
    rng = np.random.default_rng([zlib.crc32(b"sabotage"), zlib.crc32(stage.name.encode())])
    for _ in range(rounds):
        for kind in (*SPOILINGS, *(LIES_IN_CAPTURES if stage.real else LIES)):
            for op, context, selection in itertools.islice(stage.edits, _PATIENCE):
                if (honest := _honest(stage, op, context, selection)) is not None:
                    yield honest
                    break
            for op, context, selection in itertools.islice(stage.edits, _PATIENCE):
                one = (_spoilt if kind in SPOILINGS else _misled)(stage, kind, op, context, selection, rng)
                if one is not None:
                    yield one
                    break


def _honest(stage: Stage, op: EditOp, context: Context, selection: Selection | None) -> Tried | None:
    """An edit as it is; None if it cannot be done at all."""
    started = time.perf_counter()
    try:
        execute.carry_out(stage.scene, op, context, selection)
    except REFUSED as error:
        return _tried(stage, "honest", op, str(error), started)
    except ScenewrightError:
        return None
    return _tried(stage, "honest", op, "", started)


def _tried(stage: Stage, kind: str, op: EditOp, refused: str, started: float) -> Tried:
    took, data = time.perf_counter() - started, op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op}
    return Tried(stage.name, stage.real, stage.held, kind, data, refused, took)


def _spoilt(
    stage: Stage, kind: str, op: EditOp, context: Context, selection: Selection | None, rng: np.random.Generator
) -> Tried | None:
    """An edit whose outcome was spoilt; None if the sabotage does not apply to it, or it fails by itself."""
    try:
        chosen = execute.target_of(stage.scene, op, context, selection)
        op = op.settled(stage.scene, context)
        outcome = op.apply(stage.scene, chosen, context)
        execute.checked(stage.scene, op, chosen, outcome, context, {})
        attempt = Attempt(stage.scene, op, context, chosen, outcome, stage.others(chosen.ids), rng)
        bad = SPOILINGS[kind](attempt)
    except ScenewrightError:
        return None
    if bad is None:
        return None
    started = time.perf_counter()
    try:
        execute.checked(stage.scene, op, chosen, bad, context, {})
    except CheckFailedError as error:
        return _tried(stage, kind, op, str(error), started)
    return _tried(stage, kind, op, "", started)


# -- a field that misleads --------------------------------------------------------------------------------------------


def _misled(
    stage: Stage, kind: str, op: EditOp, context: Context, selection: Selection | None, rng: np.random.Generator
) -> Tried | None:
    """An edit in a scene whose field lies about the target; None if the lie does not apply."""
    query = op.query()
    if stage.truth is None or query is None:
        return None
    started = time.perf_counter()
    try:
        chosen = context.resolve(stage.scene, query).require()
        after = execute.carry_out(stage.scene, op, context).scene
    except ScenewrightError:
        return None
    mine = int(torch.mode(stage.truth[chosen.mask(stage.scene.cloud)]).values)
    attempt = _ask_sabotage.Attempt(stage.scene, op, context, chosen, after, stage.truth, mine, rng)
    try:
        done = LIES[kind](attempt)
    except REFUSED as error:
        return _tried(stage, kind, op, str(error), started)
    except ScenewrightError:
        return None
    return None if done is None else _tried(stage, kind, op, "", started)


def _merged(attempt: _ask_sabotage.Attempt) -> tuple[Scene, Scene] | None:
    """Another object within two metres is filed under the target, as one thing."""
    field_, cloud = attempt.scene.language, attempt.scene.cloud
    if field_ is None or len(attempt.selection.groups) != 1:
        return None
    mine = field_.groups[attempt.selection.groups[0]]
    others = [g for g in field_.objects() if g.id != mine.id and g.count > 400 and _apart(g, mine) < 2.0]
    if mine.level != "object" or not others:
        return None
    other = others[int(attempt.rng.integers(len(others)))]
    group = cloud.group.clone()
    group[torch.isin(group, torch.tensor(field_.leaves(other.id), dtype=torch.int32))] = field_.leaves(mine.id)[0]
    filed = cloud.replace(group=group)
    scene = attempt.scene.replace(cloud=filed)
    scene = scene.replace(language=recount(field_, filed))
    scene = scene.replace(language=with_measures(scene, filed.ids[group == field_.leaves(mine.id)[0]]))
    found = attempt.context.resolve(scene, attempt.op.query())  # type: ignore[arg-type]
    if found.verdict == "found" and found.groups != (mine.id,):
        return None
    return scene, execute.carry_out(scene, attempt.op, attempt.context).scene


def _apart(one: Any, other: Any) -> float:
    return float(np.linalg.norm(np.array(one.box.center) - np.array(other.box.center)))


LIES: dict[str, _ask_sabotage.Damage] = {
    "wrong thing, hidden": _ask_sabotage.hidden_target,
    "residue, hidden": _ask_sabotage.hidden_residue,
    "two things as one": _merged,
}
LIES_IN_CAPTURES = ("two things as one",)  # names are not sure there, so nothing tells another thing from the named one


# -- scenes -----------------------------------------------------------------------------------------------------------


def stages(quick: bool) -> Iterator[Stage]:
    """The scenes of a run; those whose data are missing are left out."""
    for seed in SEEDS[:1] if quick else (*SEEDS, *HELD_SEEDS):
        yield room(seed)
    for name in () if quick else (*REAL, *HELD_REAL):
        if (stage := real(name)) is not None:
            yield stage


def room(seed: int) -> Stage:
    """A furnished room; edits are of things that their name selects rightly."""
    _, (scene, truth) = _ask_judge.room_of(seed)
    rng = np.random.default_rng([zlib.crc32(b"honest"), seed])
    edits = ((a.op, a.context, None) for a, _ in _ask_judge.attempts(scene, truth, rng) if _sensible(a.op))

    def others(ids: Tensor) -> tuple[Tensor, ...]:
        mine = set(torch.unique(truth.ids[torch.isin(scene.cloud.ids, ids)]).tolist())
        every = [t.id for t in truth.objects if t.id not in mine]
        return tuple(scene.cloud.ids[truth.ids == t] for t in every if int((truth.ids == t).sum()) > 200)

    return Stage(f"room {seed}", False, seed in HELD_SEEDS, scene, edits, others, truth.ids)


def _sensible(op: EditOp) -> bool:
    """Whether a thing is replaced by one that may stand in its place: no armchair hangs where a mirror did."""
    if not isinstance(op, Replace):
        return True
    old, new = kinds.find(op.target.text), kinds.find(op.asset)
    if old is None or new is None or old.support != new.support:
        return False
    sizes = [max(high for _, high in kind.size) for kind in (old, new)]
    return max(sizes) <= _ALIKE * min(sizes)


def real(name: str) -> Stage | None:
    """A real scene; its things are taken by boxes and filed as objects, so that no selection by words is measured."""
    scene = _embedded(name)
    if scene is None:
        return None
    rng = np.random.default_rng([zlib.crc32(b"honest"), zlib.crc32(name.encode())])
    scene, things = _filed(
        scene, {thing: rows_within(scene, box) for thing, box in THINGS[name].items() if thing not in STRUCTURE}
    )

    def others(ids: Tensor) -> tuple[Tensor, ...]:
        every = [scene.cloud.ids[scene.cloud.group == group] for group in things.values()]
        return tuple(o for o in every if not bool(torch.isin(o, ids).any()))

    truth = torch.full((len(scene.cloud),), -1, dtype=torch.int32)
    for number, group in enumerate(things.values()):
        truth[scene.cloud.group == group] = number
    return Stage(name, True, name in HELD_REAL, scene, _real_edits(scene, things, rng), others, truth)


def _filed(scene: Scene, things: dict[str, Tensor]) -> tuple[Scene, dict[str, int]]:
    """The scene with each thing (rows of its box) as an object of its own without its strays, and their groups."""
    group = scene.cloud.group.clone()
    entries, owned = [], []
    for thing, rows in things.items():
        core = rows[torch.from_numpy(core_of(scene.cloud, rows).belongs)]
        entries.append(NewObject(scene.cloud[core], thing))
        owned.append(core)
    table, ids = append_objects(scene.language, entries, scene.frame, None)
    for rows, number in zip(owned, ids, strict=True):
        group[rows] = number
    cloud = scene.cloud.replace(group=group)
    filed = scene.replace(cloud=cloud, language=recount(table, cloud))
    left = scene.cloud.ids[torch.cat(list(things.values()))]
    return filed.replace(language=with_measures(filed, left)), dict(zip(things, ids, strict=True))


def _embedded(name: str) -> Scene | None:
    """A real scene with its field: the one that is ready beside the file, or a new one."""
    ready = os.environ.get(READY)
    path = None if ready is None else Path(ready) / f"{name}.ply"
    scene = scene_named(name, path if path is not None and path.is_file() else None)
    if scene is None:
        return None
    found = load_field(scene, path) if path is not None and path.is_file() else None
    return embedded_by(encoders.load(), scene if found is None else found, lambda stage, share: None)


def _real_edits(
    scene: Scene, things: dict[str, int], rng: np.random.Generator
) -> Iterator[tuple[EditOp, Context, Selection | None]]:
    known = {}
    for thing, group in things.items():
        camera = best_camera(scene, (scene.cloud.group == group).nonzero().squeeze(1))
        if camera is not None:
            known[thing] = Context(viewer=camera, encoder=encoders.load())
    for step in itertools.count() if known else ():
        thing = sorted(known)[int(rng.integers(len(known)))]
        query = {"text": thing}
        color, asset = str(rng.choice(_ask_judge.COLORS)), str(rng.choice(_SMALL if len(known) > 1 else _LARGE))
        side = str(rng.choice(["left", "right", "forward", "backward"]))
        makers: list[Json] = [
            {"op": "delete", "target": query},
            {"op": "recolor", "target": query, "color": color},
            {"op": "recolor", "target": query, "adjust": str(rng.choice(["darker", "lighter"]))},
            {"op": "move", "target": query, "direction": side},
            {"op": "rotate", "target": query, "degrees": round(float(rng.uniform(20, 340)))},
            {"op": "scale", "target": query, "factor": round(float(rng.uniform(0.6, 1.6)), 2)},
            {"op": "duplicate", "target": query},
            {"op": "replace", "target": query, "asset": asset, "color": color},
            {"op": "insert", "asset": asset},
        ]
        op = parse(makers[step % len(makers)])
        yield op, known[thing], None
