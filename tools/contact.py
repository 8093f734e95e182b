"""Things that are held by nothing but a given thing, told by where their points touch others.

Boxes tell what stands on a flat top. The crown of a tree is held by its trunk, and a lamp's shade by its foot, although
neither stands on a top: they are above, and what they touch is what goes.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.language.field.language_field import Group
from ..gaussians.language.query.color.fallback import is_reliable
from ..gaussians.rows import rows_where
from ..gaussians.scene import Scene
from ..gaussians.world import kinds
from ..gaussians.world.core import least_opacity
from .placement.bodies import Body

_ASIDE = 1.1  # of the footprint of what holds: within which the middle of a held thing lies
_TOUCH = 0.03  # of the holder's size: distance at which points touch
_HELD = 0.75  # share of the contacts of a thing that must be with what holds it
_MOSTLY = 0.5  # share of the contacts of a thing over another that must be with what carries it, else it leans there
_FEW = 4  # contacts that do not count
_SAMPLE = 3000  # points of a thing that are compared


def held_by(scene: Scene, body: Body, but: Iterable[int]) -> tuple[int, ...]:
    """Ids of objects above a body that touch hardly anything but it, the objects `but`, and one another.

    Args:
        but: ids of its own object, and of those known to stand on it.
    """
    field, holding = scene.language, set(but)
    open_ = [] if field is None else [g for g in field.objects() if g.id not in holding and _is_above(scene, body, g)]
    if field is None or not open_:
        return ()
    cloud = scene.cloud
    near = _near(scene, body, open_)
    points, owner = cloud.means[near].cpu().numpy(), cloud.group[near].cpu().numpy()
    leaves = {g.id: set(field.leaves(g.id)) for g in open_}
    carrying = np.isin(owner, [leaf for g in holding for leaf in field.leaves(g)])
    own = torch.zeros(len(cloud), dtype=torch.bool, device=cloud.device)
    own[body.rows] = True
    carrying |= own[near].cpu().numpy()
    found: list[int] = []
    touch = _TOUCH * max(body.box.size)
    while True:
        fresh = [g for g in open_ if _is_held(points, owner, carrying, leaves[g.id], touch)]
        if not fresh:
            return tuple(sorted(found))
        found += [g.id for g in fresh]
        open_ = [g for g in open_ if g.id not in found]
        carrying |= np.isin(owner, [leaf for g in fresh for leaf in leaves[g.id]])


def touching(scene: Scene, body: Body, groups: tuple[int, ...], own: Iterable[int]) -> tuple[int, ...]:
    """Those of some objects over a body that touch mostly it, or another of them. A patch of the wall that meets the
    body touches mostly its own like. What touches nothing counts where things are told apart reliably.

    Args:
        own: ids of the objects that the body is of.
    """
    field = scene.language
    if field is None or not groups:
        return groups
    cloud = scene.cloud
    near = _near(scene, body, [field.groups[g] for g in groups])
    points, owner = cloud.means[near].cpu().numpy(), cloud.group[near].cpu().numpy()
    carrying = torch.zeros(len(cloud), dtype=torch.bool, device=cloud.device)
    carrying[body.rows] = True
    held = carrying[near].cpu().numpy() | np.isin(owner, [leaf for g in own for leaf in field.leaves(g)])
    kept, apart = list[int](), is_reliable(field)
    touch = _TOUCH * max(body.box.size)
    for group in sorted(groups, key=lambda g: field.groups[g].box.bottom(scene.frame.up_vector)):
        leaves = set(field.leaves(group))
        met = _contacts(points, owner, leaves, touch)
        if apart if len(met) <= _FEW else held[met].mean() >= _MOSTLY:
            kept.append(group)
            held |= np.isin(owner, list(leaves))
    return tuple(g for g in groups if g in kept)


def _contacts(
    points: NDArray[np.float32], owner: NDArray[np.int32], leaves: set[int], touch: float
) -> NDArray[np.intp]:
    """Indices of the points nearest to those of a thing, within the distance `touch`; one for each that has any."""
    from scipy.spatial import cKDTree

    mine = np.isin(owner, list(leaves))
    if mine.all() or not mine.any():
        return np.zeros(0, dtype=np.intp)
    own = points[mine][:: max(1, int(mine.sum()) // _SAMPLE)]
    gap, at = cKDTree(points[~mine]).query(own, distance_upper_bound=touch)
    return np.flatnonzero(~mine)[at[np.isfinite(gap)]]


def _is_above(scene: Scene, body: Body, group: Group) -> bool:
    """Whether an object that needs something under it is over a body's footprint, and not beside it."""
    if not group.count or group.id == body.group or max(group.box.size) > 2 * max(body.box.size):
        return False
    kind = kinds.find(group.label) if group.label_score >= 0.5 else None
    if kind is not None and kind.support in ("wall", "ceiling"):
        return False
    up, box = scene.frame.up_vector, body.box
    place = np.abs(box.local(np.array([group.box.center]))[0][:2])
    over = bool((place <= _ASIDE * np.array(box.size[:2]) / 2).all())
    return (
        over and group.box.bottom(up) > float(body.center @ up) and float(np.array(group.box.center) @ up) > box.top(up)
    )


def _near(scene: Scene, body: Body, groups: Iterable[Group]) -> Tensor:
    """Rows of the solid Gaussians around a body and some objects."""
    corners = np.concatenate([body.box.corners(), *(g.box.corners() for g in groups)])
    pad = _TOUCH * max(body.box.size)
    low, high = (torch.from_numpy(c.astype(np.float32)) for c in (corners.min(axis=0) - pad, corners.max(axis=0) + pad))
    cloud = scene.cloud
    inside = ((cloud.means >= low.to(cloud.device)) & (cloud.means <= high.to(cloud.device))).all(dim=1)
    return rows_where(inside & (cloud.opacities >= least_opacity(cloud.opacities)))


def _is_held(
    points: NDArray[np.float32], owner: NDArray[np.int32], carrying: NDArray[np.bool_], leaves: set[int], touch: float
) -> bool:
    """Whether nearly all points that a thing touches are of what carries it.

    Args:
        points: `[M, 3]` solid points around.
        owner: `[M]` group of each.
        carrying: `[M]` whether it is of what carries.
        leaves: groups of the thing.
    """
    met = _contacts(points, owner, leaves, touch)
    return len(met) > _FEW and float(carrying[met].mean()) >= _HELD
