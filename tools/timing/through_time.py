"""Carry out an operation in a scene that has a time, or for a time: edits become motion and looks.

An operation knows one static scene. It is applied to the scene at a time, and what it did there is carried over: to all
times for an operation without `when`; for one with it, colours and opacities become looks, what is removed is hidden,
and what moves gets a path. The cloud as stored stays the scene at its start.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import InstructionError
from ...gaussians.harmonics import rotate
from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.at import at, bodies
from ...gaussians.motion.motion import Look, Motion, Track, chained, composed, moving_ids
from ...gaussians.rotations import from_matrix, multiply, normalize
from ...gaussians.rows import mask_of_ids, rows_of_ids, rows_where
from ...gaussians.scene import Scene
from ..cloud_diff import Draft, joined
from ..completing import completed, revealed, unshadowed, with_shadows
from ..execute import Done, target_of
from ..field_update import recount, with_measures
from ..judging.changes import Changes, changes_between
from ..operation import Context, EditOp
from ..ops.move import Move
from ..ops.opacity import HIDDEN, Opacity
from ..ops.pace import Pace
from ..receipt import Receipt
from ..when import When
from .measured import measured_through_time
from .retiming import Warp, divided, movement, playing
from .spans import SHORTEST, Length, Span, comes_to, length_of, longer_notes, moving_one, require_within, spans_of
from .ways import path_of

CarryOut = Callable[..., Done]  # carry_out(scene, op, context, selection=None)

_STEPS = 10  # looks of one that changes little by little
_LINGER = 1.0  # seconds that a scene that stood still goes on after the last change of a look
_UNTIMED = frozenset({"select", "merge", "split", "reframe", "infill", "shadow"})  # which no time makes sense for


def carry_through_time(
    scene: Scene, op: EditOp, context: Context, selection: Selection | None, carry_out: CarryOut
) -> Done:
    """The result of an operation, completed (see `completing`), in a scene with or without a time.

    Args:
        carry_out: as `execute.carry_out`: resolves, applies and checks in a static scene.

    Raises:
        As `execute.carry_out`, and:
        InstructionError: the operation cannot be done for a while, or there is no such time.
    """
    when = op.time()
    if scene.motion is None and when is None:
        return completed(scene, op, context, carry_out(scene, op, context, selection))
    now = _now(scene, context)
    chosen = target_of(now, op, context, _spoken_of(now, op, context, selection))
    if op.makes_motion:
        done = carry_out(scene, op, context, chosen)
        return measured_through_time(scene, done, chosen.ids, ())
    if when is not None and (own := _own_way(scene, op, chosen, context)) is not None:
        done = carry_out(scene, own, context, chosen)
        return measured_through_time(scene, done, chosen.ids, ())
    if when is not None:
        op = _in_its_time(scene, op, chosen)
    if when is None:
        return _for_all_times(scene, now, op, context, chosen, carry_out)
    if op.op in _UNTIMED:
        raise InstructionError(f"{op.op} is done once and for all: leave out the time")
    return _for_a_while(scene, op, context, chosen, carry_out)


def _now(scene: Scene, context: Context) -> Scene:
    """The scene as it is when the words are said; it keeps its motion, so that they may name what moves."""
    if scene.motion is None or context.time is None or context.time <= scene.motion.start:
        return scene
    return at(scene, context.time).replace(motion=scene.motion)


def _spoken_of(now: Scene, op: EditOp, context: Context, selection: Selection | None) -> Selection | None:
    """What is meant by the target of an operation about time, where its words may mean several things."""
    query, when = op.query(), op.time()
    if (
        selection is not None
        or query is None
        or not (op.makes_motion or (when is not None and when.during is not None))
    ):
        return selection
    return moving_one(now, query, context, moves=op.of_what_moves)


# -- for all times ---------------------------------------------------------------------------------------------------


def _for_all_times(
    scene: Scene, now: Scene, op: EditOp, context: Context, chosen: Selection, carry_out: CarryOut
) -> Done:
    """The result of an operation that holds at all times; its places are those of the time at which it is said."""
    done = carry_out(now, op, context, chosen)
    done = completed(now, op, context, done)
    if done.scene is now:
        return done._replace(scene=scene)
    changes = changes_between(now.cloud, done.scene.cloud)
    motion = _overriding(done.scene.motion, now.cloud.ids, changes)
    after = done.scene.replace(motion=motion)
    if now is not scene:
        assert context.time is not None
        after = _as_stored(scene, after, changes, motion, context.time)
    return done._replace(scene=after)


def _overriding(motion: Motion | None, ids: Tensor, changes: Changes) -> Motion | None:
    """The motion in which looks of Gaussians that were painted or faded at all times do not hold any more."""
    if motion is None or not motion.looks:
        return motion
    still = ~changes.placed
    painted = ids[changes.shaded & still].cpu().numpy()
    faded = ids[changes.faded].cpu().numpy()
    looks = list[Look]()
    for look in motion.looks:
        for kind, over in (("sh", painted), ("opacities", faded)):
            value = getattr(look, kind)
            if value is None:
                continue
            kept = torch.from_numpy(np.flatnonzero(~np.isin(look.ids, over)))
            if len(kept):
                plain = replace(look, ids=look.ids[kept.numpy()], sh=None, opacities=None)
                looks.append(replace(plain, **{kind: value[kept.to(value.device)]}))
    left = motion.replace(looks=tuple(looks))
    return left or None


def _as_stored(scene: Scene, after: Scene, changes: Changes, motion: Motion | None, time: float) -> Scene:
    """The scene at its start that is `after` at a time: what changed is carried back along its paths."""
    stored = scene.cloud
    gone = mask_of_ids(stored.ids, changes.before.ids[changes.gone])
    touched = changes.before.ids[changes.any & ~changes.gone]
    draft = Draft(stored)
    rows = rows_of_ids(stored.ids, touched)
    new, old = rows_of_ids(after.cloud.ids, touched), rows_of_ids(changes.before.ids, touched)
    values = {
        name: getattr(after.cloud, name)[new] for name in ("means", "quats", "scales", "opacities", "sh", "group")
    }
    back = after.cloud[new]
    if motion is not None:
        back = _carried_back(back, motion, time)
    for name in values:
        if name in ("means", "quats", "sh"):
            values[name] = getattr(back, name)
        was = getattr(changes.before, name)[old]
        kept = (was == getattr(after.cloud, name)[new]).reshape(len(rows), -1).all(dim=1)
        if not bool(kept.all()):  # what looks otherwise at that time only is not written for all times
            draft.write(name, rows[~kept], values[name][~kept])
    added = after.cloud[changes.added] if len(changes.added) else None
    cloud = draft.done()
    if bool(gone.any()) or added is not None:
        cloud = joined(cloud, gone if bool(gone.any()) else None, [] if added is None else [added])
    language = after.language
    if language is not None and scene.language is not None:
        groups = tuple(scene.language.groups[g.id] if g.id < len(scene.language.groups) else g for g in language.groups)
        plain = after.replace(cloud=cloud, language=recount(replace(language, groups=groups), cloud))
        language = with_measures(plain, torch.cat([touched, *([] if added is None else [added.ids])]))
    return after.replace(cloud=cloud, language=language)


def _carried_back(cloud: GaussianCloud, motion: Motion, time: float) -> GaussianCloud:
    """A cloud at a time as it is at the start of a motion."""
    draft = Draft(cloud)
    for body in bodies(cloud, motion):
        turns, shifts = chained([motion.tracks[i] for i in body.tracks], (time,))
        turn = torch.from_numpy(turns[0].T.copy())
        away = torch.from_numpy(shifts[0])
        quat = from_matrix(turn)
        draft.map("means", body.rows, lambda means, m=turn, a=away: ((means.double() - a) @ m.T).to(means))  # type: ignore[misc]
        draft.map("quats", body.rows, lambda quats, q=quat: normalize(multiply(q.to(quats), quats)))  # type: ignore[misc]
        if cloud.sh.shape[1] > 1:
            draft.map("sh", body.rows, lambda sh, m=turn: rotate(sh, m))  # type: ignore[misc]
    return draft.done()


# -- for a while -----------------------------------------------------------------------------------------------------


def _for_a_while(scene: Scene, op: EditOp, context: Context, chosen: Selection, carry_out: CarryOut) -> Done:
    """The result of an operation that holds for a while, or of a movement that takes a time."""
    when = op.time()
    assert when is not None
    spans = spans_of(when, scene, chosen, context, onward=True)
    whole = length_of(scene)
    begin = max(spans[0][0], whole.start) if math.isfinite(spans[0][0]) else whole.start
    still = at(scene, begin)
    plain = op.model_copy(update={"when": None})
    given = _still_there(still, chosen)
    done = carry_out(still, plain, context, given)
    asked = mask_of_ids(done.scene.cloud.ids, still.cloud.ids)
    new = done.scene.cloud.ids[~asked]  # what the operation itself makes; what fills holes is there at all times
    moved = [(done.scene.cloud.ids[m.rows].cpu().numpy(), m) for m in done.moved if len(m.source)]
    left = revealed(still, plain, context, done)
    if isinstance(op, Opacity) and op.value == 0:
        left = unshadowed(still, plain, context, left, given.ids)
    done = with_shadows(still, plain, context, done.scene, left)
    changes = changes_between(still.cloud, left.scene.cloud if moved else done.scene.cloud)
    unlike = changes.placed.clone()
    placed = np.concatenate([ids for ids, _ in moved]) if moved else np.zeros(0, dtype=np.int64)
    unlike &= ~mask_of_ids(still.cloud.ids, torch.from_numpy(placed))
    if bool(unlike.any()):
        raise InstructionError(
            "a size or shape cannot change for a while: give the change no time, or show another thing"
        )
    tracks, notes, stop = list[Track](), list[str](), whole.stop
    if moved:
        track_of = path_of(op, when, spans[0], still, context)
        for ids, body in moved:
            track, note = track_of(ids, body)
            tracks.append(track)
            stop = max(stop, float(track.times[-1]))
            notes += [note] if note and note not in notes else []
        look_spans: Sequence[Span] = [(float(min(t.times[0] for t in tracks)), math.inf)]
    else:
        require_within(spans, scene)
        look_spans = spans
    shown = left.scene if moved else done.scene
    looks = _looks(scene, still, shown, changes, placed, begin, look_spans, when.gradual and not moved)
    cast = still.cloud.ids[:0]
    if moved:  # what it leaves where it was changes when it sets out, what it casts where it goes when it arrives
        cast = _cast_ids(left.scene.cloud, done.scene.cloud)
        looks += _cast(scene, done.scene, cast, begin, max(float(t.times[-1]) for t in tracks))
    if looks and not tracks:
        stop = max(stop, _last_seen(looks, whole))
    notes += longer_notes(whole, stop)
    added = shown.cloud[changes.added] if len(changes.added) else None
    cloud, language = scene.cloud, scene.language
    if added is not None:
        made_now = mask_of_ids(added.ids, new)
        looks += _shown(added[made_now], look_spans) if bool(made_now.any()) else []
        opacities = torch.where(made_now, torch.full_like(added.opacities, HIDDEN), added.opacities)
        cloud = joined(cloud, None, [added.replace(opacities=opacities)])
        if language is not None and done.scene.language is not None:
            more = done.scene.language
            groups = (*language.groups, *more.groups[len(language.groups) :])
            language = recount(replace(more, groups=groups), cloud)
    edit = Motion(tuple(tracks), tuple(looks), (), whole.start, stop)
    earlier, since = scene.motion, None
    if earlier is not None and tracks and _goes_elsewhere(op):
        since = float(min(t.times[0] for t in tracks))
        earlier = _arrested(earlier, placed, since)
    after = scene.replace(cloud=cloud, language=language, motion=composed(earlier, edit))
    receipt = _receipt(op, done.receipt, after, notes)
    selection = done.selection if done.selection is not given else chosen
    made = Done(after, receipt, selection)
    touched = torch.cat([still.cloud.ids[changes.any], cast])
    seen = [(a, math.inf) if when.gradual and _is_finite((a, b)) else (a, b) for a, b in look_spans]  # it stays faded
    return measured_through_time(scene, made, torch.cat([chosen.ids, touched]), () if moved else seen, moved, since)


def _goes_elsewhere(op: EditOp) -> bool:
    """Whether an operation says where something goes, so that it does not go where it would have gone."""
    return isinstance(op, Move) and (op.toward is not None or op.place is not None)


def _arrested(motion: Motion, ids: np.ndarray, time: float) -> Motion:
    """A motion in which some Gaussians stay from a time on where they are then."""
    tracks, inside = divided(motion, ids)
    warp = Warp((time,), (time,), 1.0, 0.0)
    made = [playing(t, warp) if own else t for t, own in zip(tracks, inside, strict=True)]
    return motion.replace(tracks=tuple(t for t in made if not t.still))


def _own_way(scene: Scene, op: EditOp, chosen: Selection, context: Context) -> EditOp | None:
    """The change of pace that is meant where something is sent to where it goes by itself; None if it is not."""
    when = op.time()
    if not isinstance(op, Move) or op.distance is not None or op.away or scene.motion is None or when is None:
        return None
    goal = op.toward or (op.place.anchors[0] if op.place is not None and len(op.place.anchors) == 1 else None)
    ids = np.intersect1d(chosen.ids.cpu().numpy(), moving_ids(scene.motion))
    if goal is None or len(chosen.groups) != 1 or not len(ids):
        return None
    if not comes_to(scene, chosen.groups[0], goal, context):
        return None
    return Pace(target=op.target, change="begin", when=when)


def _in_its_time(scene: Scene, op: EditOp, chosen: Selection) -> EditOp:
    """Where something that moves by itself is sent elsewhere, and nobody says when: it sets out when it does now."""
    when, motion = op.time(), scene.motion
    timeless = when is None or (when.start is None and when.stop is None and when.during is None)
    if motion is None or not timeless or not _goes_elsewhere(op):
        return op
    tracks, inside = divided(motion, chosen.ids.cpu().numpy())
    span = movement([t for t, own in zip(tracks, inside, strict=True) if own], motion.start, motion.stop)
    if span is None:
        return op
    lasting = when.lasting if when is not None and when.lasting is not None else span[1] - span[0]
    return op.model_copy(update={"when": When(start=span[0], lasting=lasting)})


def _still_there(still: Scene, chosen: Selection) -> Selection:
    """What was chosen, as far as it is seen at a time."""
    return replace(chosen, enclosed=None) if chosen.enclosed is not None else chosen


def _looks(
    scene: Scene,
    still: Scene,
    after: Scene,
    changes: Changes,
    placed: np.ndarray,
    time: float,
    spans: Sequence[Span],
    gradual: bool,
) -> list[Look]:
    """The looks that make the difference of two static scenes, in the spans."""
    ids = still.cloud.ids
    moved = mask_of_ids(ids, torch.from_numpy(placed))
    gone = changes.gone & ~moved
    shaded = changes.shaded & ~changes.gone & ~moved
    faded = changes.faded & ~changes.gone
    looks: list[Look] = []
    for mask, kinds in (
        (shaded & ~faded, ("sh",)),
        (faded & ~shaded, ("opacities",)),
        (shaded & faded, ("sh", "opacities")),
        (gone, ("gone",)),
    ):
        rows = rows_where(mask)
        if not len(rows):
            continue
        own = ids[rows].sort().values
        base = scene.cloud[rows_of_ids(scene.cloud.ids, own)]
        target = after.cloud[rows_of_ids(after.cloud.ids, own)] if kinds != ("gone",) else None
        was = still.cloud[rows_of_ids(still.cloud.ids, own)]
        goal: dict[str, Tensor] = {}
        start: dict[str, Tensor] = {}
        if "sh" in kinds and target is not None:
            goal["sh"], start["sh"] = (_unturned(cloud, scene.motion, time) for cloud in (target, was))
        if "opacities" in kinds and target is not None:
            low = target.opacities <= 2 * HIDDEN
            goal["opacities"], start["opacities"] = target.opacities.masked_fill(low, 0.0), was.opacities
        if target is None:
            goal["opacities"], start["opacities"] = torch.zeros_like(was.opacities), was.opacities
        names = base.ids.cpu().numpy()
        for span in spans:
            looks += _worn(names, start, goal, span, gradual)
    return looks


def _cast_ids(before: GaussianCloud, after: GaussianCloud) -> Tensor:
    """Ids `[m]`, ascending, of the Gaussians whose colours differ between two clouds of the same ids."""
    ids = before.ids[changes_between(before, after).shaded]
    return ids.sort().values


def _cast(scene: Scene, after: Scene, ids: Tensor, begin: float, arrives: float) -> list[Look]:
    """The look of what lies in the shadow of a thing that has arrived.

    Args:
        after: static, with that shadow.
        ids: `[m]` ascending, of what lies in it.
        begin: the time of `after`, seconds.
        arrives: seconds.
    """
    if not len(ids):
        return []
    colors = _unturned(after.cloud[rows_of_ids(after.cloud.ids, ids)], scene.motion, begin)
    return [Look(ids.cpu().numpy(), arrives, math.inf, sh=colors)]


def _worn(ids: np.ndarray, start: dict[str, Tensor], goal: dict[str, Tensor], span: Span, gradual: bool) -> list[Look]:
    """The looks of one span; little by little, in steps that then stay."""
    if not (gradual and _is_finite(span)):
        return [Look(ids, *span, goal.get("sh"), goal.get("opacities"))]
    edges = np.linspace(span[0], span[1], _STEPS + 1)
    made = []
    for step in range(1, _STEPS + 1):
        share = step / _STEPS
        mixed = {n: goal[n] if step == _STEPS else torch.lerp(start[n], goal[n], share) for n in goal}
        until = math.inf if step == _STEPS else float(edges[step + 1])
        made.append(Look(ids, float(edges[step]), until, mixed.get("sh"), mixed.get("opacities")))
    return made


def _last_seen(looks: Sequence[Look], whole: Length) -> float:
    """Until when a scene lasts at least, seconds, so that all looks are seen: what begins as it ends, for a while."""
    ends = [t for look in looks for t in (look.start, look.stop) if math.isfinite(t)]
    last = max(ends, default=0.0)
    begins_last = last >= whole.stop - SHORTEST and not any(look.stop == last for look in looks)
    return last + (_LINGER if begins_last or not whole.known else 0.0)


def _is_finite(span: Span) -> bool:
    return math.isfinite(span[0]) and math.isfinite(span[1])


def _unturned(cloud: GaussianCloud, motion: Motion | None, time: float) -> Tensor:
    """The harmonics of a cloud at a time as they are in the stored cloud."""
    return cloud.sh if motion is None or cloud.sh.shape[1] == 1 else _carried_back(cloud, motion, time).sh


def _shown(added: GaussianCloud, spans: Sequence[Span]) -> list[Look]:
    """The looks by which new Gaussians are seen in the spans alone."""
    order = added.ids.argsort()
    ids, opacities = added.ids[order].cpu().numpy(), added.opacities[order]
    return [Look(ids, *span, opacities=opacities) for span in spans]


def _receipt(op: EditOp, receipt: Receipt, after: Scene, notes: Sequence[str]) -> Receipt:
    return receipt.model_copy(
        update={
            "op": op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op},
            "changed": receipt.changed + receipt.removed,
            "removed": 0,
            "total": len(after.cloud),
            "notes": (*receipt.notes, *notes),
        }
    )
