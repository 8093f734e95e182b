"""Makes some Gaussians of a scene a group of their own, such as the red part of a group that a person pointed out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...errors import UserError
from ...scene import Scene
from .group_index import index_groups
from .language_field import Group, LanguageField, NamedBy
from .measure import box_of, lab_of_cloud


def set_apart(
    scene: Scene, rows: NDArray[np.int64], name: str = "", by: NamedBy = "", *, part: bool = False
) -> tuple[Scene, int]:
    """The scene in which some rows are one group, and the id of that group.

    Only the column of groups changes. Groups that lose Gaussians are measured again. Rows that are all of one object
    are that object, which only gets the name.

    Args:
        rows: `[M]` int64, ascending, each once.
        name: of the new group; "" leaves it without a name.
        part: the new group is a part of the object that holds all of its rows, if there is one; otherwise it is an
            object of its own.

    Raises:
        UserError: the scene has no language field, or no row is given.
    """
    field = scene.language
    if field is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    if not len(rows):
        raise UserError("there is nothing to set apart")
    owners = _owners(scene, field, rows)
    alone = len(owners) == 1 and owners[0].count == len(rows)
    if alone:
        return (scene if not name else _renamed(scene, field, owners[0].id, name, by)), owners[0].id
    column = scene.cloud.group.clone()
    new = len(field.groups)
    column[torch.from_numpy(rows)] = new
    after = scene.replace(cloud=scene.cloud.replace(group=column))
    inside = part and len(owners) == 1 and owners[0].level == "object"
    made = _group(after, new, rows, owners, inside=inside)
    made = replace(made, label=name, label_score=1.0 if name else 0.0, named_by=by if name else "")
    home = max(owners, key=lambda g: (g.count, -g.id)).id if owners else None
    vector = np.zeros_like(field.embeddings[:1]) if home is None else field.embeddings[[home]]
    table = replace(field, groups=(*field.groups, made), embeddings=np.concatenate([field.embeddings, vector]))
    touched = {int(g) for g in np.unique(index_groups(scene.cloud).column[rows].astype(np.int64)) - 1 if g >= 0}
    touched |= {field.groups[g].parent for g in touched} - {-1}
    groups = tuple(_measured(after, table, g) if g.id in touched else g for g in table.groups)
    return after.replace(language=replace(table, groups=groups)), new


def _owners(scene: Scene, field: LanguageField, rows: NDArray[np.int64]) -> list[Group]:
    """The objects and structures that hold some rows; rows of no group count as of none."""
    leaves = np.unique(index_groups(scene.cloud).column[rows].astype(np.int64)) - 1
    ids = {field.groups[g].parent if field.groups[g].parent >= 0 else int(g) for g in leaves if g >= 0}
    return [field.groups[g] for g in sorted(ids)]


def _renamed(scene: Scene, field: LanguageField, group: int, name: str, by: NamedBy) -> Scene:
    groups = list(field.groups)
    groups[group] = replace(groups[group], label=name, label_score=1.0, named_by=by)
    return scene.replace(language=replace(field, groups=tuple(groups)))


def _group(scene: Scene, new: int, rows: NDArray[np.int64], owners: list[Group], *, inside: bool) -> Group:
    """The row of the table for the new group."""
    cloud = scene.cloud[torch.from_numpy(rows)]
    views = max((g.views for g in owners), default=0)
    sure = max((g.confidence for g in owners), default=0.0)
    return Group(
        new, "part" if inside else "object", owners[0].id if inside else -1, "", 0.0, box_of(cloud, scene.frame),
        lab_of_cloud(cloud), len(rows), max(views, 1), sure,
    )  # fmt: skip


def _measured(scene: Scene, table: LanguageField, group: Group) -> Group:
    """A group measured again on what it holds now."""
    left = index_groups(scene.cloud).rows(table.leaves(group.id))
    made = replace(group, count=len(left))
    if not len(left):
        return made
    cloud = scene.cloud[torch.from_numpy(left)]
    return replace(made, box=box_of(cloud, scene.frame, axes=group.box.axes), lab=lab_of_cloud(cloud))
