"""Keeping the language field true after an edit, without embedding again.

Knows the table of groups and which rows changed. Refuses to know why. Row `i` of the table keeps id `i` for ever: a
deleted group stays as a row with count 0 (selection passes over it), new objects are appended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.field.measure import box_of, lab_of_cloud
from ..gaussians.language.query.selection import mask_of
from ..gaussians.scene import Frame, Scene
from ..gaussians.world.box import Axes
from .operation import Affine, Encoder
from .placement.bodies import turned_axes


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


def remeasured(scene: Scene, ids: Tensor, axes: Mapping[int, Axes] | None = None) -> LanguageField | None:
    """The table with every group that holds one of the Gaussians `ids` measured anew, as embedding measures it.

    Args:
        axes: of the boxes of groups that turned, by group id. All others keep theirs, which embedding found.
    """
    field = scene.language
    if field is None:
        return None
    changed: dict[int, Group] = {}
    for group, rows in _holders(field, scene.cloud, ids):
        if len(rows):
            box = box_of(scene.cloud, scene.frame, rows, (axes or {}).get(group.id, group.box.axes))
            changed[group.id] = replace(group, box=box, lab=lab_of_cloud(scene.cloud, rows))
    return _with(field, changed)


def recolored(scene: Scene, ids: Tensor) -> LanguageField | None:
    """The table after Gaussians `ids` changed their colour and nothing else: boxes stay, colours are measured."""
    field = scene.language
    if field is None:
        return None
    held = _holders(field, scene.cloud, ids)
    return _with(field, {g.id: replace(g, lab=lab_of_cloud(scene.cloud, rows)) for g, rows in held if len(rows)})


def carried(before: Scene, cloud: GaussianCloud, moved: Sequence[Affine]) -> LanguageField | None:
    """The table after bodies moved: boxes of groups that moved as a whole turn along; all that moved are measured."""
    field = before.language
    if field is None:
        return None
    turned: dict[int, Axes] = {}
    sizes = _counts(before.cloud, len(field.groups))
    for body in moved:
        filed = torch.bincount((before.cloud.group[body.source] + 1).clamp(min=0), minlength=len(sizes) + 1)[1:]
        for group in _touched(field, filed):
            leaves = field.leaves(group.id)
            if sum(int(filed[i]) for i in leaves) == sum(sizes[i] for i in leaves):
                turned[group.id] = turned_axes(group.box.axes, body.matrix, before.frame)
    ids = torch.cat([before.cloud.ids[body.source] for body in moved])
    return remeasured(before.replace(cloud=cloud), ids, turned)


def thinned(before: Scene, cloud: GaussianCloud, removed: Tensor) -> LanguageField | None:
    """The table after Gaussians went: counts anew, and groups that lost only some of theirs measured.

    Args:
        cloud: what is left.
        removed: ids that went.
    """
    field = before.language
    if field is None:
        return None
    lost = before.cloud.group[mask_of(before.cloud, removed)]
    filed = torch.bincount((lost + 1).clamp(min=0), minlength=len(field.groups) + 1)[1:]
    # A part that went leaves none of its own rows to be found by: its object is measured by what the others hold.
    leaves = sorted({leaf for g in _touched(field, filed) for leaf in field.leaves(g.id)})
    hurt = torch.tensor(leaves, dtype=torch.int32, device=cloud.device)
    after = before.replace(cloud=cloud, language=recount(field, cloud))
    return remeasured(after, cloud.ids[torch.isin(cloud.group, hurt)])


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
    # A table of flags, one a group, is ten times faster than looking each Gaussian's group up among the leaves.
    leaf = torch.zeros(len(field.groups) + 1, dtype=torch.bool, device=cloud.device)
    leaf[list(field.leaves(group))] = True
    return leaf[cloud.group].nonzero().squeeze(1)


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
    axes: Axes | None = None
    like: int | None = None


def enter(
    field: LanguageField | None, newcomers: Sequence[Newcomer], frame: Frame, encoder: Encoder | None
) -> tuple[LanguageField | None, list[int]]:
    """Append one object a newcomer; the group id each got (-1 where the scene has no table).

    A copy takes the vector of its original. Other objects get the encoder's vector of their name if it is the
    encoder of the table and knows every word of it, otherwise a zero row, which selection treats as "name known, looks
    not encoded".
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
    box, lab = box_of(new.cloud, frame, axes=new.axes), lab_of_cloud(new.cloud)
    if new.like is not None:
        original = field.groups[new.like]
        return replace(original, id=index, level="object", parent=-1, box=box, lab=lab, count=len(new.cloud))
    return Group(index, "object", -1, new.label, 1.0, box, lab, len(new.cloud), 0, 1.0)


def _vector(field: LanguageField, new: Newcomer, encoder: Encoder | None) -> NDArray[np.float32]:
    if new.like is not None:
        copied: NDArray[np.float32] = field.embeddings[new.like]
        return copied
    if encoder is not None and encoder.fingerprint == field.encoder and encoder.knows(new.label):
        named: NDArray[np.float32] = encoder.encode_text([new.label])[0]
        return named
    return np.zeros(field.embeddings.shape[1], dtype=np.float32)


def _with(field: LanguageField, changed: dict[int, Group]) -> LanguageField:
    """The table with some rows exchanged; itself if there are none."""
    if not changed:
        return field
    return replace(field, groups=tuple(changed.get(g.id, g) for g in field.groups))
