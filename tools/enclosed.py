"""What a thing of a capture encloses goes where it goes: it was never seen, and is of no thing of its own. A plant goes
with what holds it.

A trained scene fills a closed body with Gaussians that show through its surface, and a segmentation leaves patches of a
thing to what is behind it. Both come to light when the surface is taken away.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.language.field.measure import reach
from ..gaussians.language.query.color.fallback import is_reliable
from ..gaussians.language.query.selection import Selection
from ..gaussians.language.query.wholes import names_plant, rooted
from ..gaussians.rows import rows_where
from ..gaussians.scene import Scene
from ..gaussians.world.core import core_of
from .cloud_diff import rows_of
from .field_update import rows_in
from .placement.bodies import body_of
from .showing_through import showing_through

Bool = NDArray[np.bool_]
F64 = NDArray[np.float64]

_CELLS = 28  # voxels along the longest side of a thing, at most
_PER_CELL = 20  # solid Gaussians for each voxel of a side, squared: so that a surface has no gaps
_SIDES, _ALL_SIDES = 5, 6  # directions along which the thing lies beyond an enclosed point: of all, and of structure
_MOST = 0.6  # share of a patch or a thing that must be enclosed if it is to go along
_SURE = 0.5  # probability of a name from which a thing is one of its own
_FEWEST = 200  # solid Gaussians below which a thing has no inside


def with_enclosed(scene: Scene, selection: Selection) -> Selection:
    """The selection with what it encloses and what would show it after it is gone; `shows` is what shows it even so.

    Only of whole things of scenes whose names are not reliable: elsewhere what lies inside a thing is known.
    """
    field = scene.language
    if field is None or not selection.groups or selection.query.spatial or is_reliable(field):
        return selection
    if any(field.groups[g].level != "object" for g in selection.groups):
        return selection
    own = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    own[rows_of(scene.cloud, selection.ids)] = True
    found = torch.zeros_like(own)
    for piece in _rooted(scene, selection):
        found[rows_in(scene.cloud, field, piece)] = True
    inside = _enclosed(scene, own | found)
    found = (found if inside is None else found | inside) & ~own
    whole = own | found
    box = body_of(scene, whole.nonzero().squeeze(1), -1).box
    more, shows = showing_through(scene, whole, box, _of_sure_things(scene))
    found |= more
    if not bool(found.any()):
        return replace(selection, shows=shows)
    ids = scene.cloud.ids
    return replace(selection, ids=ids[own | found].sort().values, enclosed=ids[found].sort().values, shows=shows)


def _of_sure_things(scene: Scene) -> Tensor:
    """`[N]` bool: Gaussians of objects whose names are sure."""
    field = scene.language
    assert field is not None
    sure = [g.level == "object" and (g.label_score >= _SURE or bool(g.named_by)) for g in field.groups]
    flags = torch.tensor([*(sure[g.parent] if g.parent >= 0 else sure[g.id] for g in field.groups), False])
    return flags.to(scene.cloud.device)[scene.cloud.group]


def _rooted(scene: Scene, selection: Selection) -> list[int]:
    """The pieces that hold the plants that a selection names, as plants of captures are found without trunk and pot."""
    field, up = scene.language, scene.frame.up_vector
    if field is None or not names_plant(selection.query.text) or selection.query.pick in ("all", "rest"):
        return []
    return [piece for g in selection.groups for piece in rooted(field, g, up) if piece not in selection.groups]


def _enclosed(scene: Scene, own: Tensor) -> Tensor | None:
    """`[N]` bool: Gaussians that a thing (`own` `[N]`) encloses and that are no part of another thing; None if it has
    no inside."""
    cloud, field = scene.cloud, scene.language
    assert field is not None
    rows = rows_where(own)
    solid = core_of(cloud, rows).solid
    if solid.sum() < _FEWEST:
        return None
    basis = scene.frame.basis()
    points = cloud.means[rows[torch.from_numpy(solid).to(rows.device)]].double().cpu().numpy() @ basis.T
    grid = _sides_of(points)
    if grid is None:
        return None
    low, cell, sides = grid
    place = cloud.means.double().cpu().numpy() @ basis.T
    index = np.floor((place - low) / cell).astype(np.int64)
    within = ((index >= 0) & (index < np.array(sides.shape))).all(axis=1)
    count = np.zeros(len(cloud), dtype=np.int8)
    count[within] = sides[tuple(index[within].T)]
    count[own.cpu().numpy() | (place[:, 2] < reach(points[:, 2])[0])] = 0  # what is lower is what it stands on
    return torch.from_numpy(_going(scene, count)).to(cloud.device)


def _sides_of(points: F64) -> tuple[F64, float, NDArray[np.int8]] | None:
    """Voxels over solid points `[M, 3]`: their corner, their side, and along how many of the six directions `[X, Y, Z]`
    points lie beyond each; None if the points have no extent."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = float((high - low).max())
    if not side > 0:
        return None
    cell = side / float(np.clip(np.sqrt(len(points) / _PER_CELL), 3, _CELLS))
    shape = np.floor((high - low) / cell).astype(np.int64) + 3  # with an empty voxel at each end
    low = low - cell
    filled = np.zeros(tuple(shape), dtype=bool)
    filled[tuple(np.minimum(((points - low) / cell).astype(np.int64), shape - 2).T)] = True
    filled = scipy.ndimage.binary_closing(filled)  # a gap of one voxel in a surface lets nothing out
    sides = np.zeros(filled.shape, dtype=np.int8)
    for axis in range(3):
        for turned in (False, True):
            ordered = np.flip(filled, axis) if turned else filled
            beyond = np.roll(np.logical_or.accumulate(ordered, axis=axis), 1, axis=axis)  # the last voxel is empty
            beyond[(slice(None),) * axis + (0,)] = False
            sides += np.flip(beyond, axis) if turned else beyond
    sides[scipy.ndimage.binary_closing(sides >= _SIDES) & (sides < _SIDES)] = _SIDES  # a line that slips through a gap
    return low, cell, sides


def _going(scene: Scene, sides: NDArray[np.int8]) -> Bool:
    """`[N]`: Gaussians that go with what encloses them, by the sides from which it does (`sides` `[N]`): those of no
    group, of patches and unnamed things that lie inside for the most part, and of structure that is wholly inside."""
    field = scene.language
    assert field is not None
    held = sides >= _SIDES
    groups = scene.cloud.group.cpu().numpy()
    count = len(field.groups)
    all_of = np.bincount(groups[groups >= 0], minlength=count).astype(np.float64)
    inner = np.bincount(groups[(groups >= 0) & held], minlength=count).astype(np.float64)
    parent = np.array([g.parent if g.parent >= 0 else i for i, g in enumerate(field.groups)])
    whole, whole_in = (np.bincount(parent, weights=w, minlength=count) for w in (all_of, inner))
    sure = np.array([g.label_score >= _SURE or bool(g.named_by) for g in field.groups])
    structure = np.array([g.level == "structure" for g in field.groups])[parent]
    goes = (inner >= _MOST * np.maximum(all_of, 1)) | (whole_in[parent] >= _MOST * np.maximum(whole[parent], 1))
    goes &= ~sure[parent] & ~structure
    free = np.concatenate([goes, [True]])[groups]
    return (held & free) | ((sides >= _ALL_SIDES) & np.concatenate([structure, [False]])[groups])
