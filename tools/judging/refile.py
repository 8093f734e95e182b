"""File Gaussians that were left behind under the thing that they belong to, so that its words mean them too."""

from __future__ import annotations

import scipy
import torch
from torch import Tensor

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.rows import rows_where
from ...gaussians.scene import Scene
from ..field_update import recount, with_measures


def refiled(scene: Scene, selection: Selection, residue: Tensor) -> Scene | None:
    """The scene with the Gaussians `residue` (ids) in the groups of the nearest Gaussians of a selection.

    Nothing that is drawn changes. None if the selection has no groups.
    """
    cloud = scene.cloud
    own = rows_where(mask_of(cloud, selection.ids) & (cloud.group >= 0))
    rows = rows_where(mask_of(cloud, residue))
    if scene.language is None or not selection.groups or not len(own) or not len(rows):
        return None
    tree = scipy.spatial.cKDTree(cloud.means[own].to(torch.float64).cpu().numpy())
    nearest = torch.from_numpy(tree.query(cloud.means[rows].to(torch.float64).cpu().numpy())[1])
    group = cloud.group.clone()
    touched = torch.cat([cloud.ids[rows], cloud.ids[own]])
    losers = torch.unique(cloud.group[rows])
    group[rows] = cloud.group[own[nearest]]
    filed = cloud.replace(group=group)
    after = scene.replace(cloud=filed, language=recount(scene.language, filed))
    ids = torch.cat([touched, filed.ids[torch.isin(filed.group, losers[losers >= 0])]])
    return after.replace(language=with_measures(after, torch.unique(ids)))
