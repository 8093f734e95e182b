"""Gives groups a name from outside the encoder, and joins the pieces of one thing that embedding left apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import torch

from ...errors import UserError
from ...scene import Scene
from .group_index import index_groups
from .language_field import Group, LanguageField, NamedBy
from .measure import box_of, lab_of_cloud


def with_names(scene: Scene, names: Mapping[int, str], by: NamedBy) -> Scene:
    """The scene with these names for groups, by id. No Gaussian changes.

    Raises:
        UserError: the scene has no language field, or no such group.
    """
    field = _field(scene)
    rows = list(field.groups)
    for group, name in names.items():
        _require(field, [group])
        rows[group] = replace(rows[group], label=name, label_score=1.0, named_by=by)
    return replace(scene, language=replace(field, groups=tuple(rows)))


def joined(scene: Scene, groups: Sequence[int], name: str, by: NamedBy) -> tuple[Scene, int]:
    """The scene in which some objects are one object with this name, and the id of that object.

    The objects become its parts, as do their own parts; the column of groups of the Gaussians stays as it is. One
    object alone keeps its row. Parts are taken out of the objects that they belonged to.

    Raises:
        UserError: the scene has no language field, no group is given, or one is not in the scene.
    """
    field = _field(scene)
    pieces = tuple(dict.fromkeys(groups))
    _require(field, pieces)
    if len(pieces) == 1 and field.groups[pieces[0]].level == "object":
        return with_names(scene, {pieces[0]: name}, by), pieces[0]
    whole = len(field.groups)
    inner = {i for piece in pieces for i in field.leaves(piece)}
    rows = [replace(g, level="part", parent=whole) if g.id in inner else g for g in field.groups]
    members = index_groups(scene.cloud).rows(sorted(inner))
    cloud = scene.cloud[torch.from_numpy(members)]
    own = [field.groups[i] for i in pieces]
    sure = sum(g.confidence * g.count for g in own) / max(sum(g.count for g in own), 1)
    views = max(g.views for g in own)
    box = box_of(cloud, scene.frame)
    rows.append(Group(whole, "object", -1, name, 1.0, box, lab_of_cloud(cloud), len(cloud), views, sure, by))
    for owner in sorted({g.parent for g in own if g.level == "part" and g.parent not in pieces}):
        rows[owner] = _without_pieces(scene, field, owner, inner)
    mean = field.embeddings[list(pieces)].mean(axis=0, keepdims=True)
    vectors = np.concatenate([field.embeddings, mean / max(float(np.linalg.norm(mean)), 1e-8)]).astype(np.float32)
    return replace(scene, language=replace(field, groups=tuple(rows), embeddings=vectors)), whole


def _without_pieces(scene: Scene, field: LanguageField, owner: int, gone: set[int]) -> Group:
    """An object measured without some of its parts."""
    left = index_groups(scene.cloud).rows(sorted(set(field.leaves(owner)) - gone))
    group = replace(field.groups[owner], count=len(left))
    if not len(left):
        return group
    cloud = scene.cloud[torch.from_numpy(left)]
    return replace(group, box=box_of(cloud, scene.frame), lab=lab_of_cloud(cloud))


def _field(scene: Scene) -> LanguageField:
    if scene.language is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    return scene.language


def _require(field: LanguageField, groups: Sequence[int]) -> None:
    missing = [i for i in groups if not 0 <= i < len(field.groups) or not field.groups[i].count]
    if missing or not groups:
        raise UserError(f"group {missing[0]} is not in this scene" if missing else "no group is given")
