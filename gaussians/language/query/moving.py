"""Which groups of a scene move at some time, and when each begins."""

from __future__ import annotations

import math

import torch

from ...motion import events
from ...motion.motion import moving_ids
from ...rows import mask_of_ids
from ...scene import Scene
from ..field.group_index import GroupIndex

_MOST = 0.5  # of a group's Gaussians: a group moves if more than these do


def moving_groups(scene: Scene, members: GroupIndex) -> frozenset[int]:
    """Ids of the groups that move at some time of a scene; none in one without motion."""
    ids = moving_ids(scene.motion)
    if not len(ids) or scene.language is None:
        return frozenset()
    moves = mask_of_ids(scene.cloud.ids, torch.from_numpy(ids)).cpu().numpy()
    found = set[int]()
    for group in scene.language.groups:
        rows = members.rows(scene.language.leaves(group.id))
        if len(rows) and float(moves[rows].mean()) > _MOST:
            found.add(group.id)
    return frozenset(found)


def begins(scene: Scene, group: int) -> float:
    """The time at which a group of an embedded scene begins to move, in seconds; infinite if it never does."""
    spans = events.intervals(scene, group, "moving")
    return spans[0][0] if spans else math.inf
