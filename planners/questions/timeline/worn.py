"""The looks that a group has for a while: those that most of its Gaussians wear, and those that hide or recolour it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....gaussians.language.field.group_index import index_groups
from ....gaussians.motion.motion import Look
from .bodies import Timeline

_MOST = 0.5  # of a group's Gaussians: when more than these look otherwise, it does


def looks_of(timeline: Timeline, group: int) -> list[Look]:
    """The looks that most of a group has at some time, in their order."""
    return [look for look, share, _ in _shares(timeline, group) if share > _MOST]


def recoloring(timeline: Timeline, group: int) -> list[Look]:
    """Those of them that have other colours."""
    return [look for look in looks_of(timeline, group) if look.sh is not None]


def hiding(timeline: Timeline, group: int) -> list[Look]:
    """The looks in which most of a group is left out, in their order."""
    return [look for look, _, gone in _shares(timeline, group) if gone > _MOST]


def ids_of(timeline: Timeline, group: int) -> NDArray[np.int64]:
    """The ids `[M]` of a group's Gaussians."""
    table = timeline.scene.language
    assert table is not None
    return np.asarray(index_groups(timeline.scene.cloud).ids_of(table.leaves(group)).cpu().numpy())


def _shares(timeline: Timeline, group: int) -> list[tuple[Look, float, float]]:
    """Each look with the share of a group's Gaussians that have it, and that are left out by it."""
    motion = timeline.scene.motion
    assert motion is not None
    if not motion.looks or not len(ids := ids_of(timeline, group)):
        return []
    found = []
    for look in motion.looks:
        gone = look.ids[:0] if look.opacities is None else look.ids[(look.opacities == 0).cpu().numpy()]
        found.append((look, float(np.isin(ids, look.ids).mean()), float(np.isin(ids, gone).mean())))
    return found
