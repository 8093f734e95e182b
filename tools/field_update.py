"""Update the language field after an edit, without embedding the scene again.

Row `i` of the group table always has id `i`: a deleted group stays as a row with count 0, which selection skips, and
new objects are appended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.field.group_index import index_groups
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.field.measure import box_of, lab_of_cloud
from ..gaussians.language.query.selection import mask_of
from ..gaussians.rows import rows_where
from ..gaussians.scene import Frame, Scene
from ..gaussians.world.box import Axes
from .operation import Affine, Encoder
from .placement.bodies import turned_axes

_MANY = 8  # groups from which sorting all rows by group takes less time than a scan for each


def recount(field: LanguageField | None, cloud: GaussianCloud) -> LanguageField | None:
    """The table with the counts of `cloud`; an object's count includes its parts."""
    if field is None:
        return None
    counts = _counts(cloud.group, field)[: len(field.groups)]
    own = (counts if cloud.rest is None else counts + cloud.rest.owned(len(field.groups))).tolist()
    total = list(own)
    for group in field.groups:
        if group.parent >= 0:
            total[group.parent] += own[group.id]
    return _with_groups(field, {g.id: replace(g, count=total[g.id]) for g in field.groups if g.count != total[g.id]})


def _counts(rows: Tensor, field: LanguageField) -> Tensor:
    """How many of `rows`, the groups of some Gaussians, are each group of the table; those of no group are left out."""
    return torch.bincount((rows + 1).clamp(min=0), minlength=len(field.groups) + 1)[1:]


def with_measures(scene: Scene, ids: Tensor, axes: Mapping[int, Axes] | None = None) -> LanguageField | None:
    """The table with every group that holds one of the Gaussians `ids` measured again, as embedding measures it.

    Args:
        axes: of the boxes of rotated groups, by group id. All others keep the axes that embedding found.
    """
    field = scene.language
    if field is None:
        return None
    changed: dict[int, Group] = {}
    for group, rows in _holders(field, scene.cloud, ids):
        if len(rows):
            box = box_of(scene.cloud, scene.frame, rows, (axes or {}).get(group.id, group.box.axes))
            changed[group.id] = replace(group, box=box, lab=lab_of_cloud(scene.cloud, rows))
    return _with_groups(field, changed)


def after_recolor(scene: Scene, ids: Tensor) -> LanguageField | None:
    """The table after only the colours of Gaussians `ids` changed: boxes stay, group colours are measured again."""
    field = scene.language
    if field is None:
        return None
    held = _holders(field, scene.cloud, ids)
    return _with_groups(field, {g.id: replace(g, lab=lab_of_cloud(scene.cloud, rows)) for g, rows in held if len(rows)})


def after_move(before: Scene, cloud: GaussianCloud, moved: Sequence[Affine]) -> LanguageField | None:
    """The table after bodies moved: their groups are measured again, with turned axes where a whole group moved."""
    field = before.language
    if field is None:
        return None
    turned: dict[int, Axes] = {}
    sizes = _counts(before.cloud.group, field).tolist()
    for body in moved:
        counts = _counts(before.cloud.group[body.source], field)
        for group in _holding(field, counts):
            leaves = field.leaves(group.id)
            if sum(int(counts[i]) for i in leaves) == sum(sizes[i] for i in leaves):
                turned[group.id] = turned_axes(group.box.axes, body.matrix, before.frame)
    ids = torch.cat([before.cloud.ids[body.source] for body in moved])
    return with_measures(before.replace(cloud=cloud), ids, turned)


def after_removal(before: Scene, cloud: GaussianCloud, removed: Tensor) -> LanguageField | None:
    """The table after Gaussians were removed: new counts; groups that lost only a part of theirs are measured again.

    Args:
        cloud: the remaining Gaussians.
        removed: ids of the removed Gaussians.
    """
    field = before.language
    if field is None:
        return None
    counts = _counts(before.cloud.group[mask_of(before.cloud, removed)], field)
    # A removed part has no rows left, so its object is found through the object's other parts.
    leaves = sorted({leaf for g in _holding(field, counts) for leaf in field.leaves(g.id)})
    affected = torch.tensor(leaves, dtype=torch.int32, device=cloud.device)
    after = before.replace(cloud=cloud, language=recount(field, cloud))
    return with_measures(after, cloud.ids[torch.isin(cloud.group, affected)])


def _holding(field: LanguageField, counts: Tensor) -> list[Group]:
    """Groups whose entry in `counts` `[G]` is not 0, and their parent objects."""
    leaves = {int(i) for i in counts.nonzero().squeeze(1)}
    ids = leaves | {field.groups[i].parent for i in leaves} - {-1}
    return [field.groups[i] for i in sorted(ids) if i < len(field.groups)]


def _holders(field: LanguageField, cloud: GaussianCloud, ids: Tensor) -> list[tuple[Group, Tensor]]:
    """Groups that hold one of the Gaussians `ids`, each with all its rows."""
    held = _holding(field, _counts(cloud.group[mask_of(cloud, ids)], field))
    if len(held) < _MANY:
        return [(group, rows_in(cloud, field, group.id)) for group in held]
    index = index_groups(cloud)
    return [(group, torch.from_numpy(index.rows(field.leaves(group.id))).to(cloud.device)) for group in held]


def rows_in(cloud: GaussianCloud, field: LanguageField, group: int) -> Tensor:
    """Rows of a group and its parts."""
    # A table with one flag for each group is ten times faster than searching each Gaussian's group among the leaves.
    leaf = torch.zeros(len(field.groups) + 1, dtype=torch.bool, device=cloud.device)
    leaf[list(field.leaves(group))] = True
    return rows_where(leaf[cloud.group])


@dataclass(frozen=True, eq=False)
class NewObject:
    """A new object for the group table.

    Attributes:
        cloud: its Gaussians, in their final place.
        label: its name.
        axes: of its box, its front along -y; None finds the smallest box.
        like: id of the group that it is a copy of, or None.
    """

    cloud: GaussianCloud
    label: str
    axes: Axes | None = None
    like: int | None = None


def append_objects(
    field: LanguageField | None, objects: Sequence[NewObject], frame: Frame, encoder: Encoder | None
) -> tuple[LanguageField | None, list[int]]:
    """Append new objects; return the table and the group id of each object (-1 where the scene has no table).

    A copy gets the vector of its original. Other objects get the encoder's vector of their name if the encoder is that
    of the table and knows every word of the name, otherwise a zero row, which selection treats as "name known, looks
    not encoded".
    """
    if field is None:
        return None, [-1] * len(objects)
    groups, rows = list(field.groups), [field.embeddings]
    ids = []
    for new in objects:
        ids.append(len(groups))
        groups.append(_new_group(field, new, len(groups), frame))
        rows.append(_embedding_of(field, new, encoder)[None])
    return replace(field, groups=tuple(groups), embeddings=np.concatenate(rows).astype(np.float32)), ids


def _new_group(field: LanguageField, new: NewObject, index: int, frame: Frame) -> Group:
    box, lab = box_of(new.cloud, frame, axes=new.axes), lab_of_cloud(new.cloud)
    if new.like is not None:
        original = field.groups[new.like]
        return replace(original, id=index, level="object", parent=-1, box=box, lab=lab, count=len(new.cloud))
    return Group(index, "object", -1, new.label, 1.0, box, lab, len(new.cloud), 0, 1.0)


def _embedding_of(field: LanguageField, new: NewObject, encoder: Encoder | None) -> NDArray[np.float32]:
    if new.like is not None:
        copied: NDArray[np.float32] = field.embeddings[new.like]
        return copied
    if encoder is not None and encoder.fingerprint == field.encoder and encoder.knows(new.label):
        named: NDArray[np.float32] = encoder.encode_text([new.label])[0]
        return named
    return np.zeros(field.embeddings.shape[1], dtype=np.float32)


def _with_groups(field: LanguageField, changed: dict[int, Group]) -> LanguageField:
    """The table with some rows replaced; the same object if there are none."""
    if not changed:
        return field
    return replace(field, groups=tuple(changed.get(g.id, g) for g in field.groups))
