"""The motion of a scene after an edit: what moved through time goes on doing so where the edit put it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.cloud import GaussianCloud
from ..gaussians.motion.motion import Motion, carried, moving_ids, without_ids
from ..gaussians.motion.runs import held_by, ids_of, runs_of
from ..gaussians.scene import Scene
from .cloud_diff import rows_of
from .operation import Outcome

STATIC_COPY = "the copy does not move"


def with_motion_kept(before: Scene, outcome: Outcome) -> Outcome:
    """The outcome of an operation with the motion of its scene as the edit leaves it.

    Paths of bodies that were moved, turned or scaled are mapped with them, removed Gaussians leave them, and Gaussians
    that were split hand theirs to their parts. Other new Gaussians do not move. An operation that changed the motion
    itself is left alone.

    Args:
        before: the scene to which the operation was applied.
    """
    motion = before.motion
    if motion is None or outcome.scene.motion is not motion:
        return outcome
    cloud = outcome.scene.cloud
    copied = False
    kept: Motion | None = motion
    for body in outcome.moved:
        if len(body.source) != len(body.rows) or not len(body.rows):
            continue
        ids = before.cloud.ids[body.source]
        if torch.equal(ids, cloud.ids[body.rows]):
            kept = carried(kept, ids.cpu().numpy(), body.matrix, body.offset)
        else:
            copied = copied or bool(np.isin(ids.cpu().numpy(), moving_ids(motion)).any())
    if len(outcome.removed):
        parts = _handed_on(before.cloud, cloud, kept, outcome)
        kept = without_ids(parts, outcome.removed.cpu().numpy())
    notes = (*outcome.notes, STATIC_COPY) if copied else outcome.notes
    if kept is motion and not copied:
        return outcome
    return replace(outcome, scene=outcome.scene.replace(motion=kept), notes=notes)


def _handed_on(before: GaussianCloud, after: GaussianCloud, motion: Motion | None, outcome: Outcome) -> Motion | None:
    """The motion in which added Gaussians of a group are on each track that holds all Gaussians that the group had.

    A finish splits Gaussians of a thing into finer ones of the same group; new things have groups of their own.
    """
    if motion is None or not len(outcome.added) or not motion.tracks:
        return motion
    rows = rows_of(after, outcome.added)
    groups, names = after.group[rows].cpu().numpy(), after.ids[rows].cpu().numpy()
    held, owners = before.ids.cpu().numpy(), before.group.cpu().numpy()
    removed = set(np.unique(before.group[rows_of(before, outcome.removed)].cpu().numpy()).tolist()) - {-1}
    tracks = list(motion.tracks)
    for group in sorted(removed & set(groups.tolist())):
        had, new = held[owners == group], names[groups == group]
        for number, track in enumerate(tracks):
            if held_by(track.runs, had).all():
                tracks[number] = replace(track, runs=_joined(track.runs, new))
    return motion.replace(tracks=tuple(tracks))


def _joined(runs: NDArray[np.int64], ids: NDArray[np.int64]) -> NDArray[np.int64]:
    return runs_of(np.concatenate([ids_of(runs), ids]))
