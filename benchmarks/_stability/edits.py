"""Rows of edits: what deletions leave, long histories undone, repeated edits, other worlds, hostile geometry."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from statistics import fmean
from typing import Any

import numpy as np
import torch

from ...agent.session.session import Session
from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab
from ...gaussians.errors import AbsentError, ScenewrightError
from ...gaussians.harmonics import dc_to_color
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.resolve import resolve
from ...gaussians.language.query.selection import Selection
from ...gaussians.render import render
from ...gaussians.rotations import axis_rotation, to_matrix
from ...gaussians.scene import Frame, Scene
from ...planners.plan import EditPlan
from ...tools.execute import carry_out
from ...tools.operation import Context
from ...tools.registry import parse
from .._rows import Level, Row
from .._select.cases import Case, ask
from .ground import Ground
from .spoiling import moved

IT: dict[str, Any] = {"last": True}
LENGTHS, QUICK_LENGTHS = (10, 50, 200), (5, 20)  # operations of a history
REPEATS, QUICK_REPEATS = (5, 20, 100), (2, 10)
DELETIONS, QUICK_DELETIONS = 12, 3  # of a room
CAP = 60.0  # dB, of pictures that are the same for the eye
COLORS = ("red", "teal", "black", "white", "yellow", "navy", "pink", "brown")


def rows(ground: Ground) -> Iterator[Row]:
    """All of them."""
    yield from _deletions(ground)
    yield from _history(ground)
    yield from _to_and_fro(ground)
    yield _recoloured(ground)
    yield _order(ground)
    yield from _worlds(ground)
    yield _harmonics(ground)
    yield _degenerate(ground)
    yield _absent(ground)


def _row(name: str, baseline: float, values: Sequence[tuple[str, float]], unit: str, n: int, law: bool = False) -> Row:
    return Row(name, baseline, tuple(Level(label, value) for label, value in values), unit, n, law)


def _context(case: Case, ground: Ground, **more: Any) -> Context:
    return Context(case.scene.cameras[0], encoder=ground.encoder, **more)


def _found(case: Case, ground: Ground, most: int) -> list[tuple[str, Selection, int]]:
    """Things that their names find: the name, the selection and the true object."""
    found = []
    for o in case.alone():
        if ask(case, o.kind, ground.encoder).means(case.truth(o)):
            chosen = resolve(case.scene, Query(text=o.kind), case.scene.cameras[0], ground.encoder)
            found.append((o.kind, chosen, o.id))
    return found[:most]


# -- deletions ------------------------------------------------------------------------------------------------------


def _deletions(ground: Ground) -> Iterator[Row]:
    """Things deleted by their names: what is left of them, and what else is gone."""
    gone, clear, absent, kept = list[float](), list[float](), list[float](), list[float]()
    for case in ground.known:
        for name, _, thing in _found(case, ground, QUICK_DELETIONS if ground.quick else DELETIONS):
            op = parse({"op": "delete", "target": {"text": name}})
            try:
                after = carry_out(case.scene, op, _context(case, ground)).scene
            except ScenewrightError:  # it was taken back, so the thing is still there
                gone.append(0.0)
                clear.append(0.0)
                absent.append(0.0)
                continue
            own = torch.from_numpy(case.ids == thing)
            left = torch.isin(case.scene.cloud.ids, after.cloud.ids)
            gone.append(1 - float(left[own].float().mean()))
            clear.append(1 - _alpha(case, own & left) / max(_alpha(case, own), 1e-9))
            others = torch.from_numpy((case.ids != thing) & (case.ids >= 0))
            kept.append(1 - float((~left[others]).sum()) / float(own.sum()))
            again = resolve(after, Query(text=name), case.scene.cameras[0], ground.encoder)
            absent.append(float(again.verdict == "absent"))
    values = [("Gaussians", fmean(gone)), ("pixels", fmean(clear)), ("asked again: absent", fmean(absent))]
    yield _row("edit.residue", 1.0, values, "share gone", len(gone))
    yield _row("edit.collateral", 1.0, [("deletions", fmean(kept))], "share of others kept", len(kept))


def _alpha(case: Case, rows: torch.Tensor) -> float:
    """How much of the first camera's picture some Gaussians cover, alone."""
    if not bool(rows.any()):
        return 0.0
    return float(render(case.scene.cloud[rows], case.scene.cameras[0].resized(192, 144)).alpha.sum())


# -- histories ------------------------------------------------------------------------------------------------------


def _history(ground: Ground) -> Iterator[Row]:
    """Random operations through a session: undone to the same hashes, outside rows the same bits, deleted rows gone."""
    lengths = QUICK_LENGTHS if ground.quick else LENGTHS
    case = _small(ground.known[0])
    session = Session(
        case.scene, planner="grammar", encoder=ground.encoder, viewer=case.scene.cameras[0], vlm=None, infill=False
    )
    rng = np.random.default_rng(case.seed)
    digests, gone = [session.digest], set[int]()
    returned, outside = [0], [0]
    tries = 0
    while len(digests) <= lengths[-1] and tries < 4 * lengths[-1]:
        tries += 1
        before = session.scene
        plan = EditPlan(instruction="", ops=(_drawn(rng, before),), planner="drawn")
        try:
            result = session.apply(plan)
        except ScenewrightError:
            continue
        there = set(session.scene.cloud.ids.tolist())
        gone |= set(before.cloud.ids.tolist()) - there
        returned.append(returned[-1] + len(gone & there))
        outside.append(outside[-1] + result.receipts[0].outside_changed)
        digests.append(session.digest)
    same = [True] * len(digests)
    for i in range(len(digests) - 2, -1, -1):
        session.undo()
        same[i] = session.digest == digests[i]
    made = len(digests) - 1
    label = [(f"{n} operations", min(n, made)) for n in lengths]
    undone = [(name, float(all(same[made - n : made]))) for name, n in label]
    yield _row("edit.undo_to_identical_hash", 1.0, undone, "hashes", made, law=True)
    stayed = [(name, float(returned[n] == 0)) for name, n in label]
    yield _row("edit.deleted_rows_stay_deleted", 1.0, stayed, "share", made, law=True)
    touched = [(name, float(outside[n] == 0)) for name, n in label]
    yield _row("edit.outside_bit_for_bit", 1.0, touched, "share", made, law=True)


def _small(case: Case) -> Case:
    """The case with every third Gaussian, so that hundreds of operations take seconds."""
    rows = torch.arange(0, len(case.ids), 3)
    cloud = case.scene.cloud[rows]
    return replace(case, scene=case.scene.replace(cloud=cloud), ids=case.ids[rows.numpy()])


def _drawn(rng: np.random.Generator, scene: Scene) -> Any:
    """A random operation on a random thing that is there."""
    assert scene.language is not None
    there = set(scene.cloud.group.tolist())
    things = [g.id for g in scene.language.objects() if there & set(scene.language.leaves(g.id))]
    target = {"groups": [int(rng.choice(things))]}
    color = str(rng.choice(COLORS))
    way = str(rng.choice(["left", "right", "forward", "backward", "up"]))
    length = {"value": round(float(rng.uniform(0.05, 0.8)), 3)}
    operations: list[dict[str, Any]] = [
        {"op": "recolor", "color": color},
        {"op": "recolor", "adjust": "darker"},
        {"op": "move", "direction": way, "distance": length},
        {"op": "rotate", "degrees": round(float(rng.uniform(-180, 180)), 1)},
        {"op": "scale", "factor": round(float(rng.uniform(0.6, 1.6)), 3)},
        {"op": "opacity", "value": round(float(rng.uniform(0.1, 0.9)), 3)},
        {"op": "duplicate", "direction": way},
        {"op": "delete"},
    ]
    weights = np.array([3, 2, 4, 3, 3, 1, 1, 0.5 if len(things) > 6 else 0.0])
    return parse({**operations[int(rng.choice(len(operations), p=weights / weights.sum()))], "target": target})


# -- again and again ------------------------------------------------------------------------------------------------


def _one(ground: Ground) -> tuple[Scene, Selection, Context]:
    """The largest thing of the first room that its name finds, without the field."""
    case = ground.known[0]
    chosen = max((chosen for _, chosen, _ in _found(case, ground, 99)), key=len)
    scene = case.scene.replace(language=None)
    return scene, Selection(Query(last=True), "found", chosen.ids), _context(case, ground, infill=False)


def _done(scene: Scene, data: dict[str, Any], selection: Selection, context: Context) -> Scene:
    return carry_out(scene, parse({"target": IT, **data}), context, selection, seen=False).scene


def _to_and_fro(ground: Ground) -> Iterator[Row]:
    """Edits and their inverses many times over: what is left of the thing's shape, and of its colours from aside."""
    scene, chosen, context = _one(ground)
    rows = chosen.mask(scene.cloud)
    pairs: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
        "edit.moved_to_and_fro": (
            {"op": "move", "direction": "left", "distance": {"value": 0.73}},
            {"op": "move", "direction": "right", "distance": {"value": 0.73}},
        ),
        "edit.turned_to_and_fro": ({"op": "rotate", "degrees": 37}, {"op": "rotate", "degrees": -37}),
        "edit.scaled_to_and_fro": ({"op": "scale", "factor": 1.3}, {"op": "scale", "factor": 1 / 1.3}),
    }
    counts = QUICK_REPEATS if ground.quick else REPEATS
    for name, ways in pairs.items():
        now, values = scene, list[tuple[str, float]]()
        for i in range(counts[-1]):
            for way in ways:
                now = _done(now, way, chosen, context)
            if i + 1 in counts:
                values.append((f"{i + 1} times", _kept_shape(scene.cloud[rows], now.cloud[rows])))
        yield _row(name, 1.0, values, "share of 1 cm", counts[-1])


def _kept_shape(before: GaussianCloud, after: GaussianCloud) -> float:
    """1 less the largest displacement in centimetres, and the largest change of a colour in tenths."""
    drift = float((after.means - before.means).norm(dim=1).max()) * 100
    shade = float((after.sh - before.sh).abs().max()) * 10
    return max(0.0, 1 - max(drift, shade))


def _recoloured(ground: Ground) -> Row:
    """A thing painted in many colours and teal at last, against teal at once: the same colours?"""
    scene, chosen, context = _one(ground)
    at_once = _done(scene, {"op": "recolor", "color": "teal"}, chosen, context)
    counts = QUICK_REPEATS if ground.quick else REPEATS
    now, values = scene, list[tuple[str, float]]()
    for i in range(counts[-1]):
        now = _done(now, {"op": "recolor", "color": COLORS[(i * 3) % len(COLORS)]}, chosen, context)
        if i + 1 in counts:
            last = _done(now, {"op": "recolor", "color": "teal"}, chosen, context)
            rows = chosen.mask(scene.cloud)
            apart = (_lab(last.cloud[rows]) - _lab(at_once.cloud[rows])).norm(dim=1).mean()
            values.append((f"{i + 1} colours", max(0.0, 1 - float(apart) / 20)))
    return _row("edit.recoloured_again", 1.0, values, "share of 20 dE", counts[-1])


def _lab(cloud: GaussianCloud) -> torch.Tensor:
    return rgb_to_lab(dc_to_color(cloud.sh[:, 0]).clamp(0, 1).double())


def _order(ground: Ground) -> Row:
    """Edits of two things in both orders: the same hash."""
    case = ground.known[0]
    found = _found(case, ground, 6)
    edits: list[dict[str, Any]] = [
        {"op": "recolor", "color": "navy"}, {"op": "rotate", "degrees": 30}, {"op": "scale", "factor": 0.8},
        {"op": "move", "direction": "up", "distance": {"value": 0.2}}, {"op": "opacity", "value": 0.5},
    ]  # fmt: skip
    scene, context = case.scene.replace(language=None), _context(case, ground, infill=False)
    same = []
    for i in range(len(found) - 1):
        one, other = found[i][1], found[i + 1][1]
        a, b = edits[i % len(edits)], edits[(i + 1) % len(edits)]
        first = _done(_done(scene, a, one, context), b, other, context)
        second = _done(_done(scene, b, other, context), a, one, context)
        same.append(float(first.cloud.digest() == second.cloud.digest()))
    return _row("edit.order_of_independent_edits", 1.0, [("both orders", fmean(same))], "hashes", len(same), law=True)


# -- other worlds ---------------------------------------------------------------------------------------------------

_MEASURED: tuple[tuple[dict[str, Any], float], ...] = (
    ({"op": "move", "direction": "up", "distance": {"value": 0.5, "unit": "m"}}, 0.5),
    ({"op": "move", "direction": "left", "distance": {"value": 40, "unit": "cm"}}, 0.4),
    ({"op": "move", "direction": "forward", "distance": {"value": 2, "unit": "ft"}}, 0.6096),
)


def _worlds(ground: Ground) -> Iterator[Row]:
    """The same edits in worlds of other units and with another up: does the thing go as far and where it should?"""
    case = ground.known[0]
    chosen = max((chosen for _, chosen, _ in _found(case, ground, 99)), key=len)

    def right(matrix: np.ndarray) -> float:
        """Share of edits whose effect is that in the plain world, moved along."""
        factor = float(np.cbrt(np.linalg.det(matrix)))
        world = moved(case, matrix)
        up = tuple((matrix @ np.array(case.scene.frame.up) / factor).tolist())
        floor = None if case.scene.frame.floor is None else case.scene.frame.floor * factor
        frame = Frame(up=up, floor=floor, metres_per_unit=1 / factor, up_source="given", scale_source="given")
        scene = world.scene.replace(frame=frame)
        selection = Selection(Query(last=True), "found", chosen.ids)
        good = []
        for data in (*(d for d, _ in _MEASURED), {"op": "rotate", "degrees": 40}, {"op": "scale", "factor": 1.4},
                     {"op": "scale", "height": {"value": 1.2, "unit": "m"}}):  # fmt: skip
            plain = _done(case.scene.replace(language=None), data, selection, _context(case, ground, infill=False))
            other = _done(scene, data, selection, Context(scene.cameras[0], encoder=ground.encoder, infill=False))
            wanted = torch.from_numpy(plain.cloud.means.double().numpy() @ matrix.T)
            off = (other.cloud.means.double() - wanted).norm(dim=1).max() / factor
            good.append(float(off < 0.002))
        return fmean(good)

    scales = [(f"x {f:g}", right(np.eye(3) * f)) for f in (0.1, 10, 0.01, 100)]
    yield _row("edit.world_scale", 1.0, scales, "share right", 6)
    turns = {"y up": ((1, 0, 0), -90), "x up": ((0, 1, 0), 90), "z down": ((1, 0, 0), 180), "askew": ((1, 2, 3), 50)}
    ups = [(name, right(axis_rotation(np.array(axis, float), d))) for name, (axis, d) in turns.items()]
    yield _row("edit.world_up", 1.0, ups, "share right", 6)


def _harmonics(ground: Ground) -> Row:
    """A scene with harmonics turned together with its camera: the same picture."""
    case = _small(ground.known[0])
    g = torch.Generator().manual_seed(case.seed)
    values = []
    for degree in (1, 2, 3):
        cloud = case.scene.cloud.with_degree(degree)
        sh = cloud.sh.clone()
        sh[:, 1:] += 0.15 * torch.randn(sh[:, 1:].shape, generator=g)
        own = replace(case, scene=case.scene.replace(cloud=cloud.replace(sh=sh)))
        turned = moved(own, axis_rotation(np.array([1.0, -2.0, 0.5]), 77.0))
        views = [c.scene.cameras[0].resized(256, 192) for c in (own, turned)]
        one, other = (render(c.scene.cloud, v).rgb for c, v in zip((own, turned), views, strict=True))
        values.append((f"degree {degree}", psnr(one, other)))
    return _row("edit.harmonics_turned", CAP, values, "dB", 3)


def psnr(one: torch.Tensor, other: torch.Tensor, cap: float = CAP) -> float:
    """Likeness of two pictures, dB, capped."""
    error = float(((one.clamp(0, 1) - other.clamp(0, 1)) ** 2).mean())
    return cap if error <= 10 ** (-cap / 10) else -10 * float(np.log10(error))


# -- hostile geometry -----------------------------------------------------------------------------------------------

_HOSTILE: dict[str, Callable[[GaussianCloud], GaussianCloud]] = {
    "coincident": lambda c: c.replace(means=c.means[:1].expand(len(c), 3).contiguous()),
    "flat as paper": lambda c: c.replace(scales=c.scales * torch.tensor([1.0, 1.0, 1e-7])),
    "specks": lambda c: c.replace(scales=torch.full_like(c.scales, 1e-9)),
    "giants": lambda c: c.replace(scales=torch.full_like(c.scales, 1e3)),
    "invisible": lambda c: c.replace(opacities=torch.full_like(c.opacities, 1e-7)),
    "opaque": lambda c: c.replace(opacities=torch.full_like(c.opacities, 1 - 1e-7)),
    "far away": lambda c: c.replace(means=c.means + 1e6),
    "glaring": lambda c: c.replace(sh=c.sh + 1e4),
}
_ALL_OPS: tuple[dict[str, Any], ...] = (
    {"op": "recolor", "color": "teal"}, {"op": "recolor", "adjust": "darker"}, {"op": "rotate", "degrees": 30},
    {"op": "move", "direction": "left", "distance": {"value": 0.5}}, {"op": "scale", "factor": 1.5},
    {"op": "scale", "factor": 0.5, "axis": "height"}, {"op": "opacity", "value": 0.4}, {"op": "delete"},
    {"op": "duplicate", "direction": "right"},
)  # fmt: skip


def _degenerate(ground: Ground) -> Row:
    """Operations on things made of Gaussians that no fit should make: done with finite values, or refused in words."""
    scene, chosen, context = _one(ground)
    rows = chosen.mask(scene.cloud)
    values = []
    for name, spoil in _HOSTILE.items():
        bad = spoil(scene.cloud[rows])
        columns = {key: column.clone() for key, column in scene.cloud.columns()}
        for key, column in bad.columns():
            columns[key][rows] = column
        hostile = scene.replace(cloud=scene.cloud.replace(**columns))
        values.append((name, fmean(_holds(hostile, data, chosen, context) for data in _ALL_OPS)))
    return _row("edit.degenerate_gaussians", 1.0, values, "share sound", len(_ALL_OPS) * len(_HOSTILE), law=True)


def _holds(scene: Scene, data: dict[str, Any], chosen: Selection, context: Context) -> float:
    """Whether an operation ends in a sound scene, or in an error of ours."""
    try:
        cloud = _done(scene, data, chosen, context).cloud
    except ScenewrightError:
        return 1.0
    except Exception:  # any other error is the fault that is looked for
        return 0.0
    finite = all(bool(torch.isfinite(column).all()) for _, column in cloud.columns() if column.is_floating_point())
    turned = to_matrix(cloud.quats) if finite else None
    sound = turned is not None and bool((cloud.scales > 0).all())
    return float(finite and sound and bool(((cloud.opacities > 0) & (cloud.opacities < 1)).all()))


def _absent(ground: Ground) -> Row:
    """Edits of things that are not there: refused, and the scene is the same."""
    case = ground.known[0]
    absent = [k for k in ground.encoder.vocabulary.names if k not in case.present][:: 7 if ground.quick else 3]
    good = []
    for name in absent:
        op = parse({"op": "delete", "target": {"text": name}})
        try:
            carry_out(case.scene, op, _context(case, ground))
            good.append(0.0)
        except AbsentError:
            good.append(1.0)
        except ScenewrightError:  # it asks back, which changes nothing either
            good.append(1.0)
    return _row("edit.of_absent_things", 1.0, [("deletions", fmean(good))], "share refused", len(good))
