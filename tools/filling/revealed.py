"""What an edit reveals and where its things come to stand: which Gaussians left their place, and in which things."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import torch
from torch import Tensor

from ...gaussians.language.field.language_field import LanguageField
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene

MOST_THINGS = 12  # things behind which is looked after one edit, the largest
_FEWEST = 20  # Gaussians of a thing
_TOUCH = 0.1  # of the smaller one's extent: how near two things are that are filled together
_MOST = 0.5  # of the scene: what takes away more leaves no place to fill


def left_their_place(before: Scene, after: Scene, moved: Sequence[Tensor]) -> list[Tensor]:
    """Rows `[M]` of the cloud before that are gone or were moved, by the thing they are of, the largest first.

    Empty if an edit took away most of the scene, or a surface such as a floor.

    Args:
        moved: rows of the cloud before that were moved.
    """
    gone = _gone(before, after)
    for rows in moved:
        gone[rows] = True
    rows = gone.nonzero().squeeze(1)
    if not len(rows) or len(rows) > _MOST * len(before.cloud):
        return []
    owner = before.cloud.group[rows]
    if before.language is not None:
        owner = objects(before.language, owner)
        if any(before.language.groups[g].level == "structure" for g in torch.unique(owner).tolist() if g >= 0):
            structure = [g.id for g in before.language.groups if g.level == "structure"]
            whole = torch.isin(owner, torch.tensor(structure, dtype=owner.dtype, device=owner.device))
            if float(whole.float().mean()) > _MOST:
                return []
    things = [rows[owner == g] for g in torch.unique(owner)]
    things = sorted((t for t in things if len(t) >= _FEWEST), key=len, reverse=True)
    return _together(before, things[:MOST_THINGS])


def _together(before: Scene, things: list[Tensor]) -> list[Tensor]:
    """Things that touch taken as one: what lies behind both is continued once, without a seam between them."""
    boxes = [_box(before.cloud.means[t]) for t in things]
    owner = list(range(len(things)))
    for i, j in itertools.combinations(range(len(things)), 2):
        (a, b), (c, d) = boxes[i], boxes[j]
        gap = float(torch.maximum(torch.maximum(a - d, c - b), torch.zeros(3, device=a.device)).max())
        if gap <= _TOUCH * min(float((b - a).max()), float((d - c).max())) and owner[i] != owner[j]:
            old, new = max(owner[i], owner[j]), min(owner[i], owner[j])
            owner = [new if k == old else k for k in owner]
    joined = [torch.cat([t for t, k in zip(things, owner, strict=True) if k == n]) for n in sorted(set(owner))]
    return [t.sort().values for t in joined]


def _box(points: Tensor) -> tuple[Tensor, Tensor]:
    """Corners of points `[M, 3]` without strays."""
    finite = points[torch.isfinite(points).all(dim=1)]
    if not len(finite):
        nowhere = torch.full((3,), float("nan"), device=points.device)
        return nowhere, nowhere
    order = finite.sort(dim=0).values
    last = len(order) - 1
    return order[round(0.02 * last)], order[round(0.98 * last)]


def _gone(before: Scene, after: Scene) -> Tensor:
    """`[N]` bool: rows of the cloud before whose ids the cloud after does not have."""
    return ~mask_of_ids(before.cloud.ids, after.cloud.ids)


def objects(field: LanguageField, groups: Tensor) -> Tensor:
    """The object that each group is of; -1 stays."""
    table = torch.tensor([g.parent if g.parent >= 0 else g.id for g in field.groups] + [-1], device=groups.device)
    return table[groups.long()]
