"""The selection of Gaussians that were pointed at, not named: by clicks, a box or a brush."""

from __future__ import annotations

import numpy as np
from torch import Tensor

from ...gaussians.cloud import NO_GROUP
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.query.terms import candidate_of
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene


def pointed_at(scene: Scene, ids: Tensor) -> Selection:
    """The selection of ids `[M]`, ascending and each once; those that the scene lacks are left out.

    Its groups are the things of which all Gaussians are selected, and of other things the parts.
    """
    rows = rows_of_ids(scene.cloud.ids, ids)
    groups = whole_groups(scene, rows)
    field = scene.language
    told = tuple(candidate_of(field.groups[g]) for g in groups) if field is not None else ()
    return Selection(Query(last=True), "found", scene.cloud.ids[rows].sort().values, groups, told, "pointed at")


def whole_groups(scene: Scene, rows: Tensor) -> tuple[int, ...]:
    """The things of which all Gaussians are among rows `[M]`, and of other things the parts; none without a field."""
    field = scene.language
    if field is None or not len(rows):
        return ()
    size = len(field.groups) + 1
    held = np.bincount(scene.cloud.group[rows].numpy() - NO_GROUP, minlength=size)
    counts = np.diff(index_groups(scene.cloud).starts)  # of no group, then of each
    missing = np.zeros(len(held), np.int64)
    missing[: len(counts)] = counts
    missing -= held
    whole = [
        g.id
        for g in field.groups
        if any(held[leaf + 1] for leaf in field.leaves(g.id))
        and not any(missing[leaf + 1] for leaf in field.leaves(g.id))
    ]
    things = {g for g in whole if field.groups[g].parent < 0}
    return tuple(g for g in whole if g in things or field.groups[g].parent not in things)
