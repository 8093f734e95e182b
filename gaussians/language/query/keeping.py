"""What stays of things that are kept while everything around them goes: all but their strays.

A segmentation gives some haze of the surroundings to a thing. Beside the thing itself it is not seen; alone in empty
space it is a veil.
"""

from __future__ import annotations

import torch
from torch import Tensor

from ...kept import Kept
from ...rows import rows_where
from ...scene import Scene
from ...world.core import core_of
from ..field.group_index import GroupIndex, union
from .selection import Selection, mask_of


def without_strays(scene: Scene, members: GroupIndex, kept: Selection) -> Tensor:
    """Ascending ids of the Gaussians of a selection that belong to its things, each thing taken by itself.

    Gaussians that belong to no selected group are taken as one thing.
    """
    return _known.get((scene, members, kept), lambda: _without_strays(scene, members, kept))


_known: Kept[Tensor] = Kept(2)  # an operation and its checks ask for the same


def _without_strays(scene: Scene, members: GroupIndex, kept: Selection) -> Tensor:
    """See `without_strays`."""
    field, ids = scene.language, kept.ids
    left = mask_of(scene.cloud, ids)
    stay = torch.zeros_like(left)
    for group in kept.groups if field is not None else ():
        assert field is not None
        rows = torch.from_numpy(members.rows(field.leaves(group))).to(left.device)
        rows = rows[left[rows]]
        left[rows] = False
        _mark(scene, rows, stay)
    _mark(scene, rows_where(left), stay)
    found = scene.cloud.ids[stay].sort().values
    return found if len(found) else union(ids, found)


def _mark(scene: Scene, rows: Tensor, stay: Tensor) -> None:
    """Set `stay` `[N]` where the rows of a thing belong to it."""
    if len(rows):
        stay[rows[torch.from_numpy(core_of(scene.cloud, rows).belongs).to(rows.device)]] = True
