"""Selecting a named part: "the legs of the table", "the left armrest", "the cushions of the sofa".

Knows what a part's owner is and how its shape is taken from a scene. Refuses to know how a part is told by shape
(`parts.py`); where it cannot be, things of that name that lie on the owner are meant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import torch
from numpy.typing import NDArray

from ...rotations import to_matrix
from ...scene import Scene
from ..encoders.calibration import doubt
from ..field.language_field import Group
from ..field.measure import box_of, lab_of_cloud
from . import parts
from .attributes import COLOR_HOLDS, color_scores
from .picking import pick
from .query import Query, Relation
from .selection import Selection, nothing
from .terms import ORDERING, Scored

if TYPE_CHECKING:
    from .resolve import Resolver

F64 = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a thing: its rows in the cloud, and what relations and superlatives can be asked of."""

    rows: NDArray[np.int64]
    group: Group


def select_part(resolver: Resolver, query: Query, owner: Relation) -> Selection:
    """What a query with a "part of" relation and a noun of its own means."""
    made: list[Piece] = []
    refusals: list[str] = []
    for anchor in resolver.anchors(owner):
        found = _pieces(resolver, anchor.group, query.text)
        if isinstance(found, str):
            refusals.append(found)
        else:
            made.extend(found)
    if not made:
        lying = _lying_on(resolver, query, owner)
        why = refusals[0] if refusals else "its shape is not known"
        return lying or nothing(query, f"{query.describe()}: {why}")
    kept = [p for p in made if _fits(resolver, query, p.group)]
    if not kept:
        return nothing(query, f"{query.describe()} is not there; the {query.text} is otherwise")
    rank = Scored(tuple(p.group for p in kept), {}, {}, np.ones(len(kept), bool))
    choice = pick(query, rank, resolver.stand)
    if choice.refusal is not None:
        return choice.refusal
    rows = np.unique(np.concatenate([kept[i].rows for i in choice.chosen]))
    told = tuple(rank.candidate(i) for i in choice.chosen)
    return Selection(query, "found", resolver.members.ids_at(rows), (), told, "told by its shape")


def _pieces(resolver: Resolver, owner: Group, name: str) -> list[Piece] | str:
    """The pieces of an owner that are its part of this name; a sentence where that cannot be told."""
    rows = resolver.members.rows(resolver.field.leaves(owner.id)) if owner.id >= 0 else np.zeros(0, np.int64)
    if not len(rows):
        return "it is known by its colour only, and a colour has no parts"
    shape = shape_in(resolver.scene, rows, owner, resolver.facing(owner).front)
    flags = parts.part_of(name, shape)
    if isinstance(flags, str):
        return flags
    whole = np.flatnonzero(flags)
    split = parts.pieces(shape, flags) if name in parts.SEVERAL else []
    return [_piece(resolver.scene, rows[k], owner, name) for k in (split if len(split) > 1 else [whole])]


def shape_in(scene: Scene, rows: NDArray[np.int64], group: Group, front: F64 | None) -> parts.Shape:
    """The shape of a group that owns some rows of a scene, facing `front` (`[3]`, world) or nowhere."""
    cloud = scene.cloud[torch.from_numpy(rows)]
    axes = to_matrix(cloud.quats)
    thin = axes[torch.arange(len(cloud)), :, cloud.scales.argmin(dim=1)]
    return parts.shape_of(cloud.means.double().cpu().numpy(), thin.double().cpu().numpy(), group.box, front)


def _piece(scene: Scene, rows: NDArray[np.int64], owner: Group, name: str) -> Piece:
    cloud = scene.cloud[torch.from_numpy(rows)]
    box = box_of(cloud, scene.frame, axes=owner.box.axes)
    return Piece(rows, Group(-1, "part", owner.id, name, 1.0, box, lab_of_cloud(cloud), len(rows), 0, 1.0))


def _fits(resolver: Resolver, query: Query, piece: Group) -> bool:
    """Whether a piece has the asked colours and stands in every other relation."""
    lab = np.array(piece.lab)
    painted = all(float(color_scores(w, lab)) >= COLOR_HOLDS for w in query.colors)
    barred = any(float(color_scores(w, lab)) > COLOR_HOLDS for w in query.not_colors)
    others = tuple(r for r in query.relations if r.name != "part_of" and r.name not in ORDERING)
    return painted and not barred and resolver.stands(query.model_copy(update={"relations": others}), piece)


def _lying_on(resolver: Resolver, query: Query, owner: Relation) -> Selection | None:
    """Things of the part's name that stand or lie on the owner; None if the encoder knows none or none is there."""
    if resolver.encoder is None or doubt(resolver.encoder, query.text) is not None:
        return None
    on = tuple(r.model_copy(update={"name": "on"}) if r is owner else r for r in query.relations)
    found = resolver.described(query.model_copy(update={"relations": on}))
    return replace(found, query=query) if found.verdict != "absent" else None
