"""Apply the `grow` and `invert` of a query to its selection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from ...scene import Scene
from ..field.group_index import GroupIndex, difference
from . import morphology
from .query import Query
from .selection import Selection, mask_of, nothing
from .terms import present_groups


def reshaped(scene: Scene, members: GroupIndex, found: Selection, query: Query) -> Selection:
    """The selection grown or shrunk by `query.grow` metres, then inverted if `query.invert`."""
    ids, change = found.ids, ""
    if query.grow:
        by = abs(query.grow) / (scene.frame.metres_per_unit or 1.0)
        ids = (morphology.grown if query.grow > 0 else morphology.shrunk)(scene.cloud, ids, by)
        change = f"{len(ids) - len(found):+,} Gaussians by {'growing' if query.grow > 0 else 'shrinking'}"
    if query.invert:
        ids = difference(members.every_id, ids)
    if not len(ids):
        return nothing(query, f"nothing is left of {query.describe()}", found.candidates)
    told = () if query.invert else found.candidates
    return replace(found, ids=ids, groups=_whole_groups(scene, ids), candidates=told).noting(change)


def _whole_groups(scene: Scene, ids: torch.Tensor) -> tuple[int, ...]:
    """The groups whose Gaussians are all among some ids."""
    field = scene.language
    assert field is not None
    column = scene.cloud.group[mask_of(scene.cloud, ids)].cpu().numpy()
    held = np.bincount(column + 1, minlength=len(field.groups) + 1)[1:]
    return tuple(
        g.id
        for g in present_groups(field, "all")
        if g.parent < 0 and sum(int(held[leaf]) for leaf in field.leaves(g.id)) == g.count
    )
