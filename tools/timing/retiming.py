"""Play motion at other times: tracks as functions of a time that is mapped, and the cloud as it is at the new start."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from ...gaussians.errors import InstructionError
from ...gaussians.motion.motion import Look, Motion, Residual, Track, carried, poses
from ...gaussians.motion.runs import runs_of
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene
from ..cloud_diff import Draft
from ..field_update import after_move, with_measures
from ..operation import Affine
from ..transform import turn
from .bending import upright_turns

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_STEP = 1 / 30  # seconds between keys where a path is not played at one rate
_SAMPLES = 100  # times a second at which a way is looked at
_STILL = 2e-3  # units and radians between keys: less is no movement
_SAME = 1e-9  # seconds
_FLASH = 2e-3  # seconds: a look is not seen for less, as where what is played again jumps to its beginning


@dataclass(frozen=True)
class Warp:
    """Which old time is shown at a new one: straight lines between knots, at the outer rates beyond them.

    Attributes:
        new, old: `[M]` seconds, M > 0; `new` ascends.
        before, after: rates before the first and after the last knot, old seconds a new second.

    Raises:
        InstructionError: its new times do not ascend, or a time is not finite: the words leave no time for it.
    """

    new: tuple[float, ...]
    old: tuple[float, ...]
    before: float = 1.0
    after: float = 1.0

    def __post_init__(self) -> None:
        new, old = np.array(self.new), np.array(self.old)
        if not (np.isfinite(new).all() and np.isfinite(old).all() and (np.diff(new) > 0).all()):
            raise InstructionError("no time is left for how it moves: say another time, or how long it is to take")

    def __call__(self, times: ArrayLike) -> F64:
        now = np.asarray(times, dtype=np.float64)
        new, old = np.array(self.new), np.array(self.old)
        inner = np.interp(now, new, old)
        early, late = np.minimum(now - new[0], 0.0), np.maximum(now - new[-1], 0.0)
        return np.asarray(inner + self.before * early + self.after * late)

    def when(self, old: F64) -> F64:
        """The new times `[L]`, ascending, at which any of some old times is shown."""
        knots, values = np.array(self.new), np.array(self.old)
        found = list[float]()
        pieces = [(-np.inf, knots[0], self.before, values[0], knots[0])]
        for a, b, u, v in zip(knots[:-1], knots[1:], values[:-1], values[1:], strict=True):
            pieces.append((a, b, (v - u) / (b - a), u, a))
        pieces.append((knots[-1], np.inf, self.after, values[-1], knots[-1]))
        for low, high, rate, value, at in pieces:
            if abs(rate) > _SAME:
                times = at + (old - value) / rate
                found += [float(t) for t in times if low <= t <= high]
        return np.unique(np.round(found, 9))

    @property
    def rate(self) -> float | None:
        """Its one rate, None if it has several."""
        new, old = np.array(self.new), np.array(self.old)
        inner = np.diff(old) / np.diff(new)
        rates = np.array([self.before, *inner, self.after])
        return float(rates[0]) if np.ptp(rates) < 1e-9 and abs(rates[0]) > _SAME else None


def moved(part: tuple[float, float], to: tuple[float, float], before: float, behind: float) -> Warp:
    """One of several movements at another time: it waits where it begins, and what comes behind keeps its time if it
    can.

    Args:
        part, to: when it begins and ends, and when it is to, seconds.
        before: when the movement before it ends; negative infinity: there is none.
        behind: when the one behind it begins; infinity: there is none.
    """
    knots = [(to[0], part[0]), (to[1], part[1])]
    if to[0] > part[0]:
        knots.insert(0, (part[0], part[0]))
    elif to[0] < part[0] and np.isfinite(before):
        knots.insert(0, (before, before))
    if to[1] < behind < np.inf:
        knots.append((behind, behind))
    new, old = zip(*knots, strict=True)
    return Warp(new, old)


def playing(track: Track, warp: Warp) -> Track:
    """A track that shows at each time what it showed at the mapped time; its start may not be at rest."""
    times, values = _keys(track.times, warp, track.kind == "spin")
    if track.axis is not None and track.angles is not None:
        spins = track.kind == "spin" and abs(warp.after) > _SAME
        angles = angles_at(track, values)
        if track.kind == "spin" and not spins:
            return replace(track, times=times, angles=angles, kind="hinge", smooth=False)
        if spins:
            times = np.append(times, times[-1] + 1.0)
            angles = angles_at(track, warp(times))
        return replace(track, times=times, angles=angles, smooth=track.smooth and not spins)
    turns, shifts = poses(track, values)
    return Track.poses_at(track.ids, times, turns, shifts, track.pivot, track.smooth, track.name)


def waving(residual: Residual, warp: Warp) -> Residual:
    """Displacements that are at each time what they were at the mapped time; at its start they may not be 0."""
    times, values = _keys(residual.times, warp, False)
    return replace(residual, times=times, basis=residual.at(values))


def shown(looks: Iterable[Look], warp: Warp) -> tuple[Look, ...]:
    """Looks at the times at which those are shown at which they were there: one of each time that they come."""
    return tuple(replace(look, start=a, stop=b) for look in looks for a, b in _shown_in((look.start, look.stop), warp))


def _shown_in(span: tuple[float, float], warp: Warp) -> list[tuple[float, float]]:
    """The spans of new time, which may be open, in which old times of a span are shown."""
    ends = np.array([t for t in span if np.isfinite(t)])
    edges = np.unique(np.concatenate([np.array(warp.new), warp.when(ends)]))
    bounds = [-np.inf, *(float(t) for t in edges), np.inf]
    within = [edges[0] - 1.0, *((edges[1:] + edges[:-1]) / 2), edges[-1] + 1.0]
    found = list[tuple[float, float]]()
    for (a, b), old in zip(itertools.pairwise(bounds), warp(within), strict=True):
        if span[0] <= old < span[1]:
            if found and found[-1][1] == a:
                a = found.pop()[0]
            found.append((a, b))
    return [(a, b) for a, b in found if b - a > _FLASH]


def _keys(old: F64, warp: Warp, spins: bool) -> tuple[F64, F64]:
    """The times of the keys of what is played in other time, and the old times that they show.

    Args:
        old: the times of its keys.
        spins: whether it goes on behind the last one.
    """
    times = warp.when(old)
    complete = len(warp.new) == 1 and len(times) == len(old)
    single = complete and (times[0] >= warp.new[0] or times[-1] <= warp.new[0])  # all of it is played at one rate
    if single and spins and times[-1] < warp.new[0]:  # it goes on until then
        times = np.append(times, warp.new[0])
    if not single and warp.rate is None:
        times = np.unique(np.concatenate([times, np.array(warp.new)]))
        between = [np.arange(a, b, _STEP) for a, b in itertools.pairwise(times) if warp(b) != warp(a)]
        times = np.unique(np.round(np.concatenate([times, *between]), 9))
    if len(times) > 1:
        times = times[np.concatenate([[True], np.diff(times) > 1e-7])]
    return times, warp(times)


def angles_at(track: Track, times: F64) -> F64:
    """`[T]` angles, or distances, of a track on an axis; whole turns are kept."""
    assert track.axis is not None and track.angles is not None
    if track.kind == "slide":
        return np.asarray(poses(track, times)[1] @ track.axis)
    # A turn is read from a slide along an axis of the same keys: poses know an angle only up to whole turns.
    along = replace(track, kind="slide", pivot=np.zeros(3)) if track.kind == "hinge" else None
    if along is not None:
        return np.asarray(poses(along, times)[1] @ track.axis)
    rate = (track.angles[-1] - track.angles[-2]) / (track.times[-1] - track.times[-2]) if len(track.times) > 1 else 0.0
    return np.asarray(np.interp(times, track.times, track.angles) + rate * np.maximum(0.0, times - track.times[-1]))


def spells(tracks: Iterable[Track], start: float, stop: float) -> list[tuple[float, float]]:
    """From when to when what the tracks move does so, each time and each way, seconds: where it turns back, another
    spell begins."""
    found = list[tuple[float, float]]()
    for track in tracks:
        times = np.unique(
            np.clip(np.concatenate([track.times, [start, stop]]), start, max(stop, float(track.times[-1])))
        )
        turns, shifts = poses(track, times)
        places = turns @ track.pivot + shifts
        if track.kind in ("spin", "hinge") and track.angles is not None:  # whole turns between keys
            steps = np.diff(angles_at(track, times))[:, None]
            far = np.abs(steps[:, 0])
        else:
            reach = np.eye(3) * 0.5  # points half a unit from the pivot tell turns
            corners = np.einsum("tij,kj->tki", turns, reach) + places[:, None]
            far = np.abs(np.diff(corners, axis=0)).max(axis=(1, 2), initial=0.0)
            steps = np.diff(places, axis=0)
        own = list[tuple[float, float]]()
        for at in np.flatnonzero(far > _STILL):
            begin, end = float(times[at]), float(times[at + 1])
            if own and own[-1][1] == begin and float(steps[at - 1] @ steps[at]) >= 0:
                own[-1] = (own[-1][0], end)
            else:
                own.append((begin, end))
        found += own
    return _united(found)


def _united(found: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Spells of several tracks as those of one thing: what overlaps is one, what only meets is not."""
    made = list[tuple[float, float]]()
    for begin, end in sorted(found):
        if made and begin < made[-1][1] - _SAME:
            made[-1] = (made[-1][0], max(made[-1][1], end))
        else:
            made.append((begin, end))
    return made


def movement(
    tracks: Iterable[Track], start: float, stop: float, residuals: Iterable[Residual] = ()
) -> tuple[float, float] | None:  # fmt: skip
    """When what the tracks and residuals move begins and ends to move, seconds; None if it never does."""
    own = [(float(r.times[a]), float(r.times[a + 1])) for r in residuals for a in _waves(r)]
    return whole(sorted([*spells(tracks, start, stop), *own]))


def _waves(residual: Residual) -> I64:
    """The keys from which to the next something is displaced: those since it was last as it is, together, farther than
    what is no movement."""
    reach = np.linalg.norm(residual.weights, axis=2).max(axis=0, initial=0.0)
    found, since = list[int](), 0
    for key in range(1, len(residual.basis)):
        if (np.abs(residual.basis[key] - residual.basis[since]) * reach).sum() > _STILL:
            found += range(since, key)
            since = key
        elif not (residual.basis[key] != residual.basis[key - 1]).any():  # it rests
            since = key
    return np.array(found, np.int64)


def whole(found: list[tuple[float, float]]) -> tuple[float, float] | None:
    """From the beginning of the first to the last end of spells, seconds; None if there are none."""
    return (found[0][0], max(end for _, end in found)) if found else None


def extent(tracks: list[Track], span: tuple[float, float], up: F64) -> tuple[float, float]:
    """How far tracks turn and go in a time: the widest angle from its start, radians, and the length of their way, of
    what slides the farthest from its start, scene units.

    Args:
        span: seconds from when to when they move.
        up: `[3]` unit; what is on no axis turns about it.
    """
    times = np.linspace(*span, max(int((span[1] - span[0]) * _SAMPLES), 2))
    angle, way = 0.0, 0.0
    for track in tracks:
        if track.kind in ("hinge", "spin", "slide"):
            gone = angles_at(track, times)
            far = float(np.abs(gone - gone[0]).max())
            angle, way = (angle, max(way, far)) if track.kind == "slide" else (max(angle, far), way)
            continue
        turns, shifts = poses(track, times)
        angle = max(angle, float(np.abs(upright_turns(track, times, up)).max()))
        way = max(way, float(np.linalg.norm(np.diff(turns @ track.pivot + shifts, axis=0), axis=1).sum()))
    return angle, way


def divided(motion: Motion, ids: I64) -> tuple[list[Track], list[bool]]:
    """The tracks of a motion, those that hold only some of the ids in two, and for each whether it holds them."""
    tracks, inside = list[Track](), list[bool]()
    for track in motion.tracks:
        own = np.isin(track.ids, ids)
        for part, flag in ((~own, False), (own, True)):
            if part.all():
                tracks.append(track)
                inside.append(flag)
                break
            if part.any():
                tracks.append(replace(track, runs=runs_of(track.ids[part])))
                inside.append(flag)
    return tracks, inside


def parted(residuals: Iterable[Residual], ids: I64) -> tuple[list[Residual], list[Residual]]:
    """What residuals say of some ids, and of all others."""
    inside, outside = list[Residual](), list[Residual]()
    for residual in residuals:
        own = np.isin(residual.ids, ids)
        for part, found in ((own, inside), (~own, outside)):
            if part.any():
                found.append(replace(residual, ids=residual.ids[part], weights=residual.weights[part]))
    return inside, outside


def with_tracks(scene: Scene, tracks: list[Track], stop: float, residuals: tuple[Residual, ...] | None = None) -> Scene:
    """The scene with other tracks, and residuals, which need not be at rest at its start: the cloud becomes what they
    show there.

    Raises:
        UserError: as `Motion`.
    """
    old = scene.motion
    start = 0.0 if old is None else old.start
    looks = () if old is None else old.looks
    kept = (() if old is None else old.residuals) if residuals is None else residuals
    after, done = scene, list[Track]()
    if residuals is not None:
        after, kept = _displaced(scene, residuals, start)
    for track in tracks:
        turns, shifts = poses(track, (start,))
        begin, away = turns[0], shifts[0]
        if np.abs(begin - np.eye(3)).max() < 1e-9 and np.abs(away).max() < 1e-9:
            done.append(track)
            continue
        ids = track.ids
        motion = carried(Motion(tuple(done), looks, kept, start, max(stop, start)), ids, begin, away)
        if motion is not None:
            done, looks, kept = list(motion.tracks), motion.looks, motion.residuals
        rows = rows_of_ids(after.cloud.ids, torch.from_numpy(ids))
        draft = Draft(after.cloud)
        turn(draft, rows, begin, away)
        cloud = draft.done()
        body = Affine(rows, begin, away, rows)
        after = after.replace(cloud=cloud, language=after_move(after, cloud, (body,)))
        done.append(_from_start(track, begin, away, start))
    kept = tuple(residual for residual in kept if not residual.still)
    made = Motion(tuple(t for t in done if not t.still), looks, kept, start, max(stop, start))
    return after.replace(motion=made or None)


def _displaced(scene: Scene, residuals: tuple[Residual, ...], start: float) -> tuple[Scene, tuple[Residual, ...]]:
    """The scene with its Gaussians where residuals have them at its start, and the residuals from there on."""
    draft, kept, moved = Draft(scene.cloud), list[Residual](), False
    for residual in residuals:
        begin = residual.at(np.array([start]))[0]
        if not begin.any():
            kept.append(residual)
            continue
        rows = rows_of_ids(scene.cloud.ids, torch.from_numpy(residual.ids))
        place = np.searchsorted(residual.ids, scene.cloud.ids[rows].cpu().numpy())
        away = torch.from_numpy(np.einsum("b,nbc->nc", begin, residual.weights)[place])
        draft.map("means", rows, lambda means, away=away: means + away.to(means))  # type: ignore[misc]
        kept.append(replace(residual, basis=residual.basis - begin))
        moved = True
    if moved:
        after = scene.replace(cloud=draft.done())
        ids = torch.from_numpy(np.unique(np.concatenate([residual.ids for residual in residuals])))
        scene = after.replace(language=with_measures(after, ids))
    return scene, tuple(kept)


def _from_start(track: Track, begin: F64, away: F64, start: float) -> Track:
    """A track as seen from its pose at the start, which becomes the identity."""
    if track.axis is not None and track.angles is not None:
        first = float(angles_at(track, np.array([start]))[0])
        return replace(track, angles=track.angles - first)
    turns, shifts = poses(track, track.times)
    back = turns @ begin.T
    return Track.poses_at(
        track.ids, track.times, back, shifts - (back @ away), begin @ track.pivot + away, track.smooth, track.name
    )
