"""Find what was left where a thing stood: Gaussians that the selection missed and that belong to nothing else there.

Three kinds are found near the old place of a thing that was deleted, moved or replaced: Gaussians of no group that were
nearer to the thing than to anything else; Gaussians filed under the floor or a wall that stand out of its plane; and
fragments filed under another object that are not connected to that object.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import NO_GROUP, GaussianCloud
from ...gaussians.color import rgb_to_lab
from ...gaussians.harmonics import dc_to_color
from ...gaussians.language.field.language_field import Group
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.color.fallback import is_reliable
from ...gaussians.rows import rows_where, rows_within
from ...gaussians.world.box import Box
from ..placement.bodies import contact_box
from ..receipt import Check, at_most, report
from .case import Case, weight_of

BOUND = 0.02  # share of the thing's visual weight that may be left: shadows, brackets, the soil of a plant
_VISIBLE = 0.1  # opacity
_SAMPLE = 20_000  # Gaussians whose typical weight is measured
_AROUND = 0.5  # of its largest extent: how far around a thing its missed pieces are looked for
_OFF_PLANE = 4.0  # centimetres from the plane of a floor or wall
_FRAGMENT = 0.35  # largest share of an object that is a fragment
_PART = 0.6  # share of a part from which a patch is that part
_VOXEL = 4.0  # centimetres: parts with a smaller gap are connected
_NEAR = 6.0  # centimetres from the thing, up to which a Gaussian belongs to it
_CONTACTS = 64  # Gaussians of a fragment nearest to the thing, whose colours are compared with it
_SAME_COLOR = 20.0  # Lab distance: one material in light and shadow
_MOST_VOXELS = 4e7
_SPACINGS = (1.6, 2.0, 3.0)  # least of both in spacings of the thing's own Gaussians; of the voxel for other objects

Flags = NDArray[np.bool_]
Points = NDArray[np.float64]


def left_behind(case: Case) -> tuple[Check, Tensor]:
    """The check that nothing of the target is left where it stood, and the ids of what is.

    It only reports, without ids, where most things of the scene have no sure label: what is near a thing in such a
    capture may be anything. Of parts of space and floaters nothing is measured: beside them everything else stays.
    """
    query = case.op.query()
    if query is not None and query.spatial:
        none = torch.zeros(0, dtype=torch.int64)
        return report("nothing left behind", 0.0, "1", "of a part of space everything else stays"), none
    rows = [body.rows for body in case.bodies]
    found = [_left_of(case, one) for one in rows]
    left = torch.unique(torch.cat(found)) if found else torch.zeros(0, dtype=torch.int64)
    cloud = case.before.cloud
    weight = weight_of(cloud, rows_where(case.target))
    most = float(weight[:: max(1, len(weight) // _SAMPLE)].quantile(0.95)) if len(weight) else 0.0
    share = float(weight_of(cloud, left).clamp(max=most).sum()) / max(float(weight.clamp(max=most).sum()), 1e-30)
    said = f"{len(left):,} Gaussians, {share:.1%} of the thing by area, stand where it stood and belong to nothing else"
    field = case.before.language
    if field is None or not is_reliable(field):
        return report("nothing left behind", share, "1", said), left[:0]
    return at_most("nothing left behind", share, BOUND, "1", said), cloud.ids[left]


def _left_of(case: Case, rows: Tensor) -> Tensor:
    """Rows `[K]` of the cloud before that seem to belong to a body and stayed where they were."""
    cloud, field = case.before.cloud, case.before.language
    if field is None or len(rows) < 2:
        return rows[:0]
    own = solid_points(cloud, rows)
    box = contact_box(own, case.before.frame)
    cm, spacing = case.cm(max(box.size)), _spacing(own)
    voxel, near = max(_VOXEL * cm, _SPACINGS[0] * spacing), max(_NEAR * cm, _SPACINGS[1] * spacing)
    here = _stayed_around(case, box, near)
    if not len(here):
        return here
    points, groups = cloud.means[here].to(torch.float64).cpu().numpy(), cloud.group[here].cpu().numpy()
    loose = groups == NO_GROUP
    for owner in {_owner(field.groups, leaf) for leaf in np.unique(groups[groups != NO_GROUP]).tolist()}:
        group, mine = field.groups[owner], np.isin(groups, field.leaves(owner))
        if group.level == "structure":
            loose[mine] = _off_plane(group, points[mine], _OFF_PLANE * cm)
        else:
            loose |= _fragments(case, owner, here, rows, voxel) | _other_colored(case, here, mine, rows, voxel)
    found = np.flatnonzero(loose)
    if not len(found):
        return here[:0]
    kept = points[~loose & (groups != NO_GROUP)]
    return here[torch.from_numpy(found[_touching(points[found], own, kept, voxel, near)])]


def _spacing(points: Points) -> float:
    """Median distance of points `[M, 3]` to their nearest neighbour."""
    sample = points[:: max(1, len(points) // 1000)]
    return float(np.median(scipy.spatial.cKDTree(points, balanced_tree=False).query(sample, k=2)[0][:, 1]))


def _stayed_around(case: Case, box: Box, near: float) -> Tensor:
    """Rows of visible Gaussians in and around a box that were not meant and did not change."""
    cloud = case.before.cloud
    pad = _AROUND * max(box.size) + near
    width, depth, height = (side + 2 * pad for side in box.size)
    around = replace(box, size=(width, depth, height))
    stayed = rows_within(cloud.means, *around.bounds())
    stayed = stayed[~(case.changes.any | case.target)[stayed] & (cloud.opacities[stayed] > _VISIBLE)]
    local = box.local(cloud.means[stayed].to(torch.float64).cpu().numpy())
    inside = (np.abs(local) <= np.array(box.size) / 2 + pad).all(axis=1)
    return stayed[torch.from_numpy(inside)]


def _touching(points: Points, own: Points, kept: Points, voxel: float, near: float) -> Flags:
    """Which loose points `[M, 3]` hang together with a thing's `own` points, and not with what is `kept`.

    A point that is near the thing, and nearer to it than to anything kept, is a seed; its whole cluster follows,
    without what is close to something kept.
    """
    mine = scipy.spatial.cKDTree(own).query(points, distance_upper_bound=4 * near)[0]
    others = scipy.spatial.cKDTree(kept).query(points)[0] if len(kept) else np.full(len(points), np.inf)
    seeds = (mine < near) & (mine < others)
    clusters = _clusters(points, voxel)
    return np.asarray(np.isin(clusters, np.unique(clusters[seeds])) & (others > voxel / 4) | seeds)


def _owner(groups: tuple[Group, ...], leaf: int) -> int:
    return leaf if groups[leaf].parent < 0 else groups[leaf].parent


def _clusters(points: Points, voxel: float) -> NDArray[np.int64]:
    """`[M]` number of the cluster of each point; clusters are voxels that touch, corners included."""
    cells = np.floor((points - points.min(axis=0)) / voxel).astype(np.int64)
    shape = cells.max(axis=0) + 1
    if float(np.prod(shape.astype(np.float64))) > _MOST_VOXELS:  # a few far floaters: no point hangs together
        return np.arange(len(points), dtype=np.int64)
    grid = np.zeros(shape, bool)
    grid[tuple(cells.T)] = True
    numbers, _ = scipy.ndimage.label(grid, structure=np.ones((3, 3, 3)))
    return np.asarray(numbers[tuple(cells.T)], dtype=np.int64)


def _off_plane(group: Group, points: Points, bound: float) -> Flags:
    """Whether points lie farther than `bound` out of the slab of a floor or wall."""
    thin = int(np.argmin(group.box.size))
    return np.asarray(np.abs(group.box.local(points)[:, thin]) > group.box.size[thin] / 2 + bound)


def _fragments(case: Case, owner: int, here: Tensor, thing: Tensor, voxel: float) -> Flags:
    """Which of the rows `here` belong to fragments of another object that are nearer to a thing (rows) and alike.

    A fragment is not connected to its object, and its gap to the rest of it is over twice its gap to the thing.
    """
    cloud, field = case.before.cloud, case.before.language
    assert field is not None
    none = np.zeros(len(here), bool)
    leaves = torch.tensor(field.leaves(owner), dtype=cloud.group.dtype, device=cloud.device)
    rows = rows_where(torch.isin(cloud.group, leaves) & (cloud.opacities > _VISIBLE))
    if len(rows) < 2:
        return none
    points = cloud.means[rows].to(torch.float64).cpu().numpy()
    labels = _clusters(points, max(voxel, _SPACINGS[2] * _spacing(points)))
    count = np.bincount(labels)
    small = (count > 0) & (count <= _FRAGMENT * len(rows)) & (np.arange(len(count)) != int(count.argmax()))
    tree, loose = scipy.spatial.cKDTree(cloud.means[thing].to(torch.float64).cpu().numpy()), np.zeros(len(rows), bool)
    for number in np.intersect1d(np.flatnonzero(small), np.unique(labels[_in(rows, here)])).tolist():
        part = labels == number
        to_thing = float(tree.query(points[part])[0].min())
        to_rest = float(scipy.spatial.cKDTree(points[~part]).query(points[part])[0].min())
        loose[part] = to_rest > 2 * to_thing + voxel / 4 and _alike(cloud, rows[torch.from_numpy(part)], thing)
    return _in(here, rows[torch.from_numpy(loose)])


def _other_colored(case: Case, here: Tensor, mine: Flags, thing: Tensor, voxel: float) -> Flags:
    """Which of the rows `here` of one object (`mine`) have the colour of a thing that they touch, and not the object's.

    A patch of that colour must be small for the object, and end in another colour wherever it meets the object.
    """
    cloud, found = case.before.cloud, np.zeros(len(here), bool)
    rows = here[torch.from_numpy(mine)]
    if len(rows) < 2:
        return found
    means, lab = cloud.means[rows].to(torch.float64).cpu().numpy(), _lab(cloud, rows).cpu().numpy()
    own, own_lab = cloud.means[thing].to(torch.float64).cpu().numpy(), _lab(cloud, thing).cpu().numpy()
    away, nearest = scipy.spatial.cKDTree(own).query(means)
    like = np.linalg.norm(lab - own_lab[nearest], axis=1) < _SAME_COLOR
    if not like.any() or like.all():
        return found
    places = np.flatnonzero(like)
    numbers = _clusters(means[places], voxel)
    rest = scipy.spatial.cKDTree(means[~like])
    for number in np.unique(numbers[away[places] < voxel / 2]).tolist():
        patch = places[numbers == number]
        if len(patch) > _FRAGMENT * len(rows) or _is_part(cloud, rows[torch.from_numpy(patch)]):
            continue
        apart, meets = rest.query(means[patch])
        edge = np.argsort(apart, kind="stable")[:_CONTACTS]
        contrast = np.linalg.norm(lab[patch[edge]] - lab[~like][meets[edge]], axis=1)
        if float(np.median(contrast)) > 1.5 * _SAME_COLOR:
            found[np.flatnonzero(mine)[patch]] = True
    return found


def _is_part(cloud: GaussianCloud, rows: Tensor) -> bool:
    """Whether some rows are most of a part: a patch that is a part of its object is its own."""
    leaf = int(torch.mode(cloud.group[rows]).values)
    return int((cloud.group[rows] == leaf).sum()) > _PART * int((cloud.group == leaf).sum())


def _alike(cloud: GaussianCloud, part: Tensor, thing: Tensor) -> bool:
    """Whether a part (rows) has the colour of a thing (rows) where they meet: a thing ends where its colour does."""
    tree = scipy.spatial.cKDTree(cloud.means[thing].to(torch.float64).cpu().numpy())
    away, nearest = tree.query(cloud.means[part].to(torch.float64).cpu().numpy())
    meet = np.argsort(away, kind="stable")[:_CONTACTS]
    near = thing[torch.from_numpy(nearest[meet])]
    a, b = (_lab(cloud, r) for r in (part[torch.from_numpy(meet)], near))
    return float(torch.linalg.vector_norm(a - b, dim=1).median()) < _SAME_COLOR


def _lab(cloud: GaussianCloud, rows: Tensor) -> Tensor:
    """`[M, 3]` Lab of the constant colour band of some rows."""
    return rgb_to_lab(dc_to_color(cloud.sh[rows, 0].to(torch.float64)).clamp(0, 1))


def _in(rows: Tensor, some: Tensor) -> Flags:
    """`[M]` whether each of `rows` is among `some`."""
    found: Flags = torch.isin(rows, some).cpu().numpy()
    return found
