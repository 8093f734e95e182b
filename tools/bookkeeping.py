"""Keeping the language field true after an edit, without embedding again.

Knows the table of groups and which rows changed. Refuses to know why. Row `i` of the table keeps id `i` for ever: a
deleted group stays as a row with count 0 (selection passes over it), new objects are appended.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.camera import Vec3
from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.field import Group, LanguageField
from ..gaussians.scene import Frame, Scene
from .base import Affine, Encoder
from .measure import median_lab, sample, solid_points
from .rows import mask_of
from .space import box_of, moved_box


def recount(field: LanguageField | None, cloud: GaussianCloud) -> LanguageField | None:
    """The table with the counts of `cloud`; objects count their parts too."""
    if field is None:
        return None
    own = _counts(cloud, len(field.groups))
    total = list(own)
    for group in field.groups:
        if group.parent >= 0:
            total[group.parent] += own[group.id]
    return _with(field, {g.id: replace(g, count=total[g.id]) for g in field.groups if g.count != total[g.id]})


def _counts(cloud: GaussianCloud, groups: int) -> list[int]:
    # Row 0 collects the Gaussians of no group.
    filed = torch.bincount((cloud.group + 1).clamp(min=0), minlength=groups + 1)
    return [int(n) for n in filed[1 : groups + 1]]


def remeasured(scene: Scene, ids: Tensor, *, box: bool = False, lab: bool = False) -> LanguageField | None:
    """The table with box or colour measured anew for every group that holds one of the Gaussians `ids`."""
    field = scene.language
    if field is None:
        return None
    changed: dict[int, Group] = {}
    for group, rows in _holders(field, scene.cloud, ids):
        if not len(rows):
            continue
        measured = group
        if box:
            points = solid_points(scene.cloud, rows)
            measured = replace(measured, box=box_of(points, scene.frame, group.box.axes))
        if lab:
            measured = replace(measured, lab=median_lab(sample(scene.cloud, rows)))
        changed[group.id] = measured
    return _with(field, changed)


def carried(before: Scene, cloud: GaussianCloud, moved: Sequence[Affine]) -> LanguageField | None:
    """The table after bodies moved: boxes of groups that moved as a whole move along, those of others are measured."""
    field = before.language
    if field is None:
        return None
    changed: dict[int, Group] = {}
    sizes = _counts(before.cloud, len(field.groups))
    broken = []
    for body in moved:
        filed = torch.bincount((before.cloud.group[body.source] + 1).clamp(min=0), minlength=len(sizes) + 1)[1:]
        for group in _touched(field, filed):
            leaves = field.leaves(group.id)
            if sum(int(filed[i]) for i in leaves) == sum(sizes[i] for i in leaves):
                changed[group.id] = replace(group, box=moved_box(group.box, body.matrix, body.offset, before.frame))
            else:
                broken.append(before.cloud.ids[body.source])
                break
    whole = _with(field, changed)
    after = before.replace(cloud=cloud, language=whole)
    if not broken:
        return whole
    redone = remeasured(after, torch.cat(broken), box=True)
    assert redone is not None
    # Groups that moved as a whole keep the exact box, whatever part of their object stayed behind.
    return _with(redone, changed)


def thinned(before: Scene, cloud: GaussianCloud, removed: Tensor) -> LanguageField | None:
    """The table after Gaussians went: counts anew, and boxes and colours of groups that lost only some of theirs.

    Args:
        cloud: what is left.
        removed: ids that went.
    """
    field = before.language
    if field is None:
        return None
    lost = before.cloud.group[mask_of(before.cloud, removed)]
    filed = torch.bincount((lost + 1).clamp(min=0), minlength=len(field.groups) + 1)[1:]
    hurt = torch.tensor([g.id for g in _touched(field, filed)], dtype=torch.int32, device=cloud.device)
    after = before.replace(cloud=cloud, language=recount(field, cloud))
    return remeasured(after, cloud.ids[torch.isin(cloud.group, hurt)], box=True, lab=True)


def _touched(field: LanguageField, filed: Tensor) -> list[Group]:
    """Groups with a Gaussian among those counted in `filed` `[G]`, and the objects above them."""
    leaves = {int(i) for i in filed.nonzero().squeeze(1)}
    ids = leaves | {field.groups[i].parent for i in leaves} - {-1}
    return [field.groups[i] for i in sorted(ids) if i < len(field.groups)]


def _holders(field: LanguageField, cloud: GaussianCloud, ids: Tensor) -> list[tuple[Group, Tensor]]:
    """Groups that hold one of the Gaussians, each with all its rows."""
    filed = torch.bincount((cloud.group[mask_of(cloud, ids)] + 1).clamp(min=0), minlength=len(field.groups) + 1)[1:]
    return [(group, rows_in(cloud, field, group.id)) for group in _touched(field, filed)]


def rows_in(cloud: GaussianCloud, field: LanguageField, group: int) -> Tensor:
    """Rows of a group and its parts."""
    leaves = torch.tensor(field.leaves(group), dtype=torch.int32, device=cloud.device)
    return torch.isin(cloud.group, leaves).nonzero().squeeze(1)


@dataclass(frozen=True, eq=False)
class Newcomer:
    """A new object to be entered in the table.

    Attributes:
        cloud: its Gaussians, in place.
        label: what it is.
        axes: of its box, its front along -y; None finds the smallest box.
        like: the group it is a copy of, or None.
    """

    cloud: GaussianCloud
    label: str
    axes: tuple[Vec3, Vec3, Vec3] | None = None
    like: int | None = None


def enter(
    field: LanguageField | None, newcomers: Sequence[Newcomer], frame: Frame, encoder: Encoder | None
) -> tuple[LanguageField | None, list[int]]:
    """Append one object a newcomer; the group id each got (-1 where the scene has no table).

    A copy takes the vector of its original. Other objects get the encoder's vector of their name if it is the
    encoder of the table, otherwise a zero row, which selection treats as "name known, looks not encoded".
    """
    if field is None:
        return None, [-1] * len(newcomers)
    groups, rows = list(field.groups), [field.embeddings]
    ids = []
    for new in newcomers:
        ids.append(len(groups))
        groups.append(_row(field, new, len(groups), frame))
        rows.append(_vector(field, new, encoder)[None])
    return replace(field, groups=tuple(groups), embeddings=np.concatenate(rows).astype(np.float32)), ids


def _row(field: LanguageField, new: Newcomer, index: int, frame: Frame) -> Group:
    every = torch.arange(len(new.cloud), device=new.cloud.device)
    box = box_of(solid_points(new.cloud, every), frame, new.axes)
    lab = median_lab(sample(new.cloud, every))
    if new.like is not None:
        original = field.groups[new.like]
        return replace(original, id=index, level="object", parent=-1, box=box, lab=lab, count=len(new.cloud))
    return Group(index, "object", -1, new.label, 1.0, box, lab, len(new.cloud), 0, 1.0)


def _vector(field: LanguageField, new: Newcomer, encoder: Encoder | None) -> NDArray[np.float32]:
    if new.like is not None:
        copied: NDArray[np.float32] = field.embeddings[new.like]
        return copied
    if encoder is not None and encoder.fingerprint == field.encoder and new.label:
        named: NDArray[np.float32] = encoder.encode_text([new.label])[0]
        return named
    return np.zeros(field.embeddings.shape[1], dtype=np.float32)


def _with(field: LanguageField, changed: dict[int, Group]) -> LanguageField:
    """The table with some rows exchanged; itself if there are none."""
    if not changed:
        return field
    return replace(field, groups=tuple(changed.get(g.id, g) for g in field.groups))
