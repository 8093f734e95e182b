"""Find what was left where a thing stood: Gaussians that the selection missed and that belong to nothing else there.

Three kinds are found near the old place of a thing that was deleted, moved or replaced: Gaussians of no group that were
nearer to the thing than to anything else; Gaussians filed under the floor or a wall that stand out of its plane; and
fragments filed under another object that are not connected to that object.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import label as connected
from scipy.spatial import cKDTree
from torch import Tensor

from ...gaussians.cloud import NO_GROUP
from ...gaussians.language.field.language_field import Group
from ...gaussians.language.field.measure import solid_points
from ...gaussians.world.box import Box
from ..placement.bodies import contact_box
from ..receipt import Check, at_most
from .case import Case, weight_of

BOUND = 0.04  # share of the thing's visual weight that may be left: shadows, brackets, the soil of a plant
_VISIBLE = 0.1  # opacity
_PAD = 3.0  # centimetres around the thing's box
_OFF_PLANE = 4.0  # centimetres from the plane of a floor or wall
_WHOLE = 0.6  # share of an object within the box from which it is a thing of its own
_FRAGMENT = 0.35  # largest share of an object that is a fragment
_WITHIN = 0.9  # share of a fragment that lies within the box
_VOXEL = 4.0  # centimetres: parts with a smaller gap are connected
_NEAR = 6.0  # centimetres from the thing, up to which a Gaussian of no group is its own

Flags = NDArray[np.bool_]


def left_behind(case: Case) -> tuple[Check, Tensor]:
    """The check that nothing of the target is left where it stood, and the ids of what is."""
    rows = [body.rows for body in case.bodies]
    found = [_left_of(case, one) for one in rows]
    left = torch.unique(torch.cat(found)) if found else torch.zeros(0, dtype=torch.int64)
    cloud = case.before.cloud
    total = float(weight_of(cloud, case.target.nonzero().squeeze(1)).sum())
    share = float(weight_of(cloud, left).sum()) / max(total, 1e-30)
    said = f"{len(left):,} Gaussians, {share:.1%} of the thing by area, stand where it stood and belong to nothing else"
    return at_most("nothing left behind", share, BOUND, "1", said), cloud.ids[left]


def _left_of(case: Case, rows: Tensor) -> Tensor:
    """Rows `[K]` of the cloud before that seem to belong to a body and stayed where they were."""
    cloud, field = case.before.cloud, case.before.language
    if field is None or not len(rows):
        return rows[:0]
    own = solid_points(cloud, rows)
    box = contact_box(own, case.before.frame)
    cm = case.cm(max(box.size))
    stayed = ~case.changes.any & ~case.target & (cloud.opacities > _VISIBLE)
    stayed[rows] = False
    here = stayed.nonzero().squeeze(1)
    points = cloud.means[here].to(torch.float64).cpu().numpy()
    inside = _within(box, points, _PAD * cm)
    here, points = here[torch.from_numpy(inside)], points[inside]
    if not len(here):
        return here
    groups = cloud.group[here].cpu().numpy()
    left = _haze(case, own, points, groups, cm)
    for leaf in np.unique(groups[groups != NO_GROUP]).tolist():
        group = field.groups[leaf]
        owner = group if group.parent < 0 else field.groups[group.parent]
        mine = np.flatnonzero(groups == leaf)
        if owner.level == "structure":
            left[mine] = _off_plane(owner, points[mine], _OFF_PLANE * cm)
    for owner in {_owner(field.groups, g) for g in np.unique(groups[groups != NO_GROUP]).tolist()}:
        if field.groups[owner].level != "structure":
            left |= _fragments(case, owner, here, box, cm)
    return here[torch.from_numpy(left)]


def _owner(groups: tuple[Group, ...], leaf: int) -> int:
    return leaf if groups[leaf].parent < 0 else groups[leaf].parent


def _within(box: Box, points: NDArray[np.float64], pad: float) -> Flags:
    """Whether world points `[M, 3]` lie in a box grown by `pad`."""
    return np.asarray((np.abs(box.local(points)) <= np.array(box.size) / 2 + pad).all(axis=1))


def _haze(
    case: Case, own: NDArray[np.float64], points: NDArray[np.float64], groups: NDArray[np.int32], cm: float
) -> Flags:
    """Gaussians of no group that are near the thing and nearer to it than to anything else that stayed."""
    free = groups == NO_GROUP
    if not free.any():
        return np.zeros(len(points), bool)
    cloud = case.before.cloud
    kept = (~case.target & (cloud.group != NO_GROUP) & (cloud.opacities > _VISIBLE)).nonzero().squeeze(1)
    others = cloud.means[kept].to(torch.float64).cpu().numpy()
    low, high = points.min(axis=0) - _NEAR * cm, points.max(axis=0) + _NEAR * cm
    others = others[((others >= low) & (others <= high)).all(axis=1)]
    found = np.zeros(len(points), bool)
    near = cKDTree(own).query(points[free])[0]
    far = cKDTree(others).query(points[free])[0] if len(others) else np.full(int(free.sum()), np.inf)
    found[free] = (near < _NEAR * cm) & (near < far)
    # What is connected to such Gaussians only is left as well: a whole leg may be without a group.
    return found | (free & _joined_to(points, found, free, _VOXEL * cm, far, free))


def _joined_to(
    points: NDArray[np.float64], seeds: Flags, free: Flags, voxel: float, far: NDArray[np.float64], index: Flags
) -> Flags:
    """Points of no group in the same connected cluster as a seed, and not closer to other things than `voxel` / 2."""
    result = np.zeros(len(points), bool)
    if not seeds.any():
        return result
    labels = _clusters(points[free], voxel)
    marked = np.unique(labels[seeds[free]])
    result[index] = np.isin(labels, marked) & (far > voxel / 2)
    return result


def _clusters(points: NDArray[np.float64], voxel: float) -> NDArray[np.int64]:
    """`[M]` number of the cluster of each point; clusters are voxels that touch, corners included."""
    cells = np.floor((points - points.min(axis=0)) / voxel).astype(np.int64)
    shape = cells.max(axis=0) + 1
    if float(np.prod(shape.astype(np.float64))) > 4e7:  # a few far floaters: one cluster is the careful answer
        return np.zeros(len(points), np.int64)
    grid = np.zeros(shape, bool)
    grid[tuple(cells.T)] = True
    numbers, _ = connected(grid, structure=np.ones((3, 3, 3)))
    return np.asarray(numbers[tuple(cells.T)], dtype=np.int64)


def _off_plane(group: Group, points: NDArray[np.float64], bound: float) -> Flags:
    """Whether points lie farther than `bound` out of the slab of a floor or wall."""
    thin = int(np.argmin(group.box.size))
    return np.asarray(np.abs(group.box.local(points)[:, thin]) > group.box.size[thin] / 2 + bound)


def _fragments(case: Case, owner: int, here: Tensor, box: Box, cm: float) -> Flags:
    """Which of the rows `here` belong to fragments of another object that are not connected to it."""
    cloud, field = case.before.cloud, case.before.language
    assert field is not None
    leaves = torch.tensor(field.leaves(owner), dtype=cloud.group.dtype, device=cloud.device)
    rows = (torch.isin(cloud.group, leaves) & (cloud.opacities > _VISIBLE)).nonzero().squeeze(1)
    points = cloud.means[rows].to(torch.float64).cpu().numpy()
    inside = _within(box, points, _PAD * cm)
    if inside.mean() > _WHOLE:
        return np.zeros(len(here), bool)
    labels = _clusters(points, _VOXEL * cm)
    count = np.bincount(labels)
    within = np.bincount(labels, weights=inside) / np.maximum(count, 1)
    loose = (within >= _WITHIN) & (count <= _FRAGMENT * len(points))
    strays = rows[torch.from_numpy(loose[labels])]
    return torch.isin(here, strays).cpu().numpy()
