"""Portions of groups: their rows of some colours, of one side, and of what lies behind them, and their pieces.

A segmentation of a capture leaves a wall and the wheel before it in one group, or a cloth and the stand on it. What a
person means is then a portion of a group, which colour or place tells.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from ...errors import InstructionError
from ...scene import Scene
from ...world.relation_geometry import Stand
from ..field.dividing import pieces_of
from ..field.group_index import index_groups
from ..field.language_field import LanguageField
from ..field.measure import reach
from ..segmentation.surface import MIN_OPACITY
from .color.patches import fragments_of
from .palette import palette
from .selection import Candidate, mask_of

I64 = NDArray[np.int64]
F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

NEIGHBOURS = 5  # decided Gaussians that decide a faint one by majority
SAME = 14.0  # Lab distance up to which two fragments are of one surface
SIDES = ("left", "right", "front", "back", "top", "bottom")


def rows_of(scene: Scene, groups: Sequence[int]) -> I64:
    """All rows of some groups, ascending."""
    field = _field(scene)
    return index_groups(scene.cloud).rows({leaf for g in groups for leaf in field.leaves(g)})


def rows_of_candidates(scene: Scene, candidates: Sequence[Candidate]) -> I64:
    """All rows of some candidates, ascending: of their groups, or of the patches that they are."""
    found = [rows_of(scene, [c.group]) if c.ids is None else _rows_at(scene, c.ids) for c in candidates]
    return np.unique(np.concatenate([*found, np.zeros(0, np.int64)]))


def _rows_at(scene: Scene, ids: torch.Tensor) -> I64:
    rows: I64 = mask_of(scene.cloud, ids).nonzero().squeeze(1).cpu().numpy()
    return rows


def of_colors(scene: Scene, rows: I64, words: Sequence[str]) -> I64:
    """Those of some rows that have any of some colours, with their folds and shadows; ascending, empty if nothing
    has one of them.

    Raises:
        UserError: a colour word is unknown.
    """
    return palette(scene, rows).of(words)


def of_side(scene: Scene, rows: I64, side: str, stand: Stand) -> I64:
    """Those of some rows in the half of their extent on one of `SIDES`, as a viewer sees it; ascending."""
    way = {"left": -stand.right, "right": stand.right, "front": -stand.forward, "back": stand.forward,
           "top": stand.up, "bottom": -stand.up}[side]  # fmt: skip
    along = scene.cloud.means[rows].double().cpu().numpy() @ way
    solid = (scene.cloud.opacities[rows] > MIN_OPACITY).cpu().numpy()
    low, high = reach(along[solid] if solid.any() else along)
    found: I64 = rows[along >= (low + high) / 2]
    return found


def of_what_is_behind(scene: Scene, rows: I64) -> I64:
    """Those of some rows (ascending) that go on without an edge in floor, walls or ceiling: linked fragments of one
    colour that begin at a fragment of structure; ascending."""
    field, index = _field(scene), fragments_of(scene.cloud)
    own = np.bincount(np.maximum(index.of_row[rows], 0), minlength=len(index)) > 0
    room = {leaf for g in field.groups if g.level == "structure" for leaf in field.leaves(g.id)}
    taken = index.in_groups(room) & ~own
    a, b = index.links
    alike = np.linalg.norm(index.labs[index.bins[a]] - index.labs[index.bins[b]], axis=1) < SAME
    a, b = a[alike], b[alike]
    while True:
        fresh = np.concatenate([b[taken[a] & own[b] & ~taken[b]], a[taken[b] & own[a] & ~taken[a]]])
        if not len(fresh):
            break
        taken[fresh] = True
    within = np.append(taken & own, False)[index.of_row[rows]]
    return rows[_decided(scene, rows, within, index.of_row[rows] >= 0)]


def pieces_of_rows(scene: Scene, rows: I64, most: int) -> list[I64]:
    """Some rows (ascending) in at most so many pieces, the largest first: along the weakest borders of shape and
    colour, or else by colours."""
    cloud = scene.cloud[torch.from_numpy(rows)]
    for into in range(most, 1, -1):
        try:
            piece = pieces_of(cloud, scene.frame, into)
        except InstructionError:
            continue
        return [rows[piece == k] for k in range(into)]
    found = palette(scene, rows)
    return [rows[found.part == k] for k in range(len(found.labs))]


def _decided(scene: Scene, rows: I64, chosen: Flags, decided: Flags) -> Flags:
    """Whether each row `[M]` is chosen; the undecided go with the majority of the decided ones nearest to them."""
    from scipy.spatial import cKDTree

    result = chosen & decided
    if decided.all() or not result.any():
        return result
    points = scene.cloud.means.cpu().numpy()[rows]
    count = min(NEIGHBOURS, int(decided.sum()))
    near = cKDTree(points[decided]).query(points[~decided], k=count)[1].reshape(int((~decided).sum()), count)
    result[~decided] = chosen[decided][near].mean(axis=1) > 0.5
    return result


def _field(scene: Scene) -> LanguageField:
    assert scene.language is not None
    return scene.language
