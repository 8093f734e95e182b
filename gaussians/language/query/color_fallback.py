"""Select by colour where the noun cannot be resolved: "the purple cloth" for an encoder that does not know cloth.

It also selects "the orange parts". The text encoder is not used; every selection of a named thing says that the name
was not confirmed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from torch import Tensor

from ...cloud import NO_GROUP
from ...scene import Scene
from ..field.group_index import index_groups
from ..field.language_field import LanguageField
from ..segmentation.surface import MIN_OPACITY, base_lab
from . import attributes
from .color_patches import Patch, patches
from .query import Query
from .selection import Candidate, Selection, nothing

PARTS = frozenset({"part", "piece", "bit", "area", "region", "patch", "spot"})
SURE_LABEL = 0.6  # probability from which a label rules out that the group is something else of that colour
PART_TAKEN = 0.25  # share of a part inside a patch from which all of the part is taken if its colour matches
DARK = 28.0  # Lab lightness below which a Gaussian among coloured ones counts as shadow
NEIGHBOURS = 16
SHADOW_SHARE = 0.45  # share of the neighbours of a dark Gaussian that must be selected
OWNER_SHARE = 0.7  # share of a patch inside an object from which the patch belongs to the object
RIVAL = 0.4  # share of the first patch's weight from which another patch is a rival


def by_color(scene: Scene, field: LanguageField, query: Query, stands: Callable[[Tensor], bool]) -> Selection | None:
    """The one patch (or all, with pick "all") of the query's colours; None if colour cannot resolve the query.

    Floor and walls are excluded, and so are objects with a sure label (a red armchair is not a red bicycle), unless the
    query asks for "parts".

    Args:
        stands: whether some rows satisfy the query's relations.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _is_simple(query):
        return None
    generic = query.text in PARTS
    barred = _excluded(field, named=not generic and is_reliable(field))
    free = ~torch.isin(scene.cloud.group, torch.tensor(sorted(barred), dtype=torch.int32)).numpy()
    places = [p for p in patches(scene.cloud, query.colors, free) if stands(torch.from_numpy(p.rows))]
    if not places:
        return None
    doubtful = "" if generic else f"{query.text!r} could not be confirmed by the encoder"
    rivals = [p for p in places if p.weight > RIVAL * places[0].weight]
    if len(rivals) > 1 and query.pick == "one":
        reason = f"{doubtful or query.describe()}: {len(rivals)} places have that colour; say where it is, or 'all'"
        unclear = _taken(scene, field, query, rivals, barred)
        return replace(unclear, verdict="ambiguous", reason=reason, ids=unclear.ids[:0])
    chosen = places if query.pick == "all" else places[:1]
    reason = f"{doubtful}; chosen by its colour alone" if doubtful else ""
    return replace(_taken(scene, field, query, chosen, barred), reason=reason)


def by_hue(
    scene: Scene, field: LanguageField, query: Query, stands: Callable[[Tensor], bool], named: frozenset[int]
) -> Selection | None:
    """The `named` objects whose hue is the query's colour, as whole objects; None if there are none.

    "The red bicycle" is found by its frame, although tyres and saddle make most of it black.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _is_simple(query) or not named:
        return None
    members = index_groups(scene.cloud)
    own = np.zeros(len(scene.cloud), bool)
    own[members.rows(leaf for g in named for leaf in field.leaves(g))] = True
    places = [p for p in patches(scene.cloud, query.colors, own) if stands(torch.from_numpy(p.rows))]
    first: dict[int, Patch] = {}
    for place in places:
        owner = _owner_of(scene, field, query, place.rows, frozenset())
        if owner in named and place.weight > RIVAL * places[0].weight:
            first.setdefault(owner, place)
    color = query.colors[0]
    told = tuple(
        Candidate(g, field.groups[g].label, color, p.center, p.size, p.score, {f"color {color}": p.score})
        for g, p in first.items()
    )
    if not told or (query.pick == "one" and len(told) > 1):
        reason = f"{query.describe()}: {len(told)} things match; say which one, or 'all'"
        return replace(nothing(query, reason, told), verdict="ambiguous") if told else None
    chosen = told if query.pick == "all" else told[:1]
    ids = members.ids_of(leaf for c in chosen for leaf in field.leaves(c.group))
    return Selection(query, "found", ids, tuple(c.group for c in chosen), chosen, f"{color} in hue, not as a whole")


def _is_simple(query: Query) -> bool:
    """Whether a query has no size, count, excluded colour or order, so that colour can resolve it."""
    simple = query.size is None and query.count is None and not query.not_colors
    return query.pick in ("one", "any", "all") and simple and bool(query.text)


def is_reliable(field: LanguageField) -> bool:
    """Whether most objects of the scene, counted by Gaussians, have a sure label.

    Otherwise (a capture unlike the training data of the encoder) single sure labels are not reliable either.
    """
    objects = [g for g in field.objects() if g.count]
    sure = sum(g.count for g in objects if g.label_score >= SURE_LABEL)
    return sure >= 0.5 * sum(g.count for g in objects)


def _excluded(field: LanguageField, named: bool) -> frozenset[int]:
    """Leaves that are not selected by colour: structure, and if `named` objects with a sure label."""
    return frozenset(
        leaf
        for g in field.groups
        if g.level == "structure" or (named and g.level == "object" and g.label_score >= SURE_LABEL)
        for leaf in field.leaves(g.id)
    )


def _taken(
    scene: Scene, field: LanguageField, query: Query, places: Sequence[Patch], barred: frozenset[int]
) -> Selection:
    """The selection of some patches: for each the object whose hue it is, else the patch with its parts and shadows."""
    color = query.colors[0]
    candidates = tuple(
        Candidate(-1, "region", color, p.center, p.size, p.score, {f"color {color}": p.score}) for p in places[:6]
    )
    whole, loose = [], []
    for place in places:
        owner = None if query.text in PARTS else _owner_of(scene, field, query, place.rows, barred)
        if owner is None:
            loose.append(place.rows)
        else:
            whole.append(_rows_of_hue(scene, field, query, owner))
    if loose:
        rows = _with_whole_parts(scene, field, query, np.unique(np.concatenate(loose)), barred)
        whole.append(_with_shadows(scene, rows, barred))
    rows = np.unique(np.concatenate(whole))
    return Selection(query, "found", scene.cloud.ids[torch.from_numpy(rows)].sort().values, (), candidates)


def _owner_of(
    scene: Scene, field: LanguageField, query: Query, rows: NDArray[np.int64], barred: frozenset[int]
) -> int | None:
    """The object that contains most of a patch, if its hue is the colour of the query."""
    column = scene.cloud.group.numpy()[rows]
    of = np.array([g.parent if g.parent >= 0 else g.id for g in field.groups] + [NO_GROUP])[column]
    homes, counts = np.unique(of[of >= 0], return_counts=True)
    if not len(homes) or counts.max() < OWNER_SHARE * len(rows):
        return None
    owner = int(homes[counts.argmax()])
    if field.groups[owner].level != "object" or barred & set(field.leaves(owner)):
        return None
    hue = min(float(attributes.hue_shares(field, word)[owner]) for word in query.colors)
    return owner if hue >= attributes.HUE_SHARE else None


def _rows_of_hue(scene: Scene, field: LanguageField, query: Query, owner: int) -> NDArray[np.int64]:
    """The rows of an object that have its hue, without other things in it (the stand on the cloth).

    Trained scenes represent folds and threads by nearly black Gaussians between coloured ones, which have no hue of
    their own. So each row is decided by the majority of its nearest neighbours in parts that are not dark.
    """
    leaves = np.array(field.leaves(owner))
    lab = np.array([field.groups[leaf].lab for leaf in leaves])
    fits = np.min([attributes.color_scores(w, lab) for w in query.colors], axis=0) >= attributes.COLOR_HOLDS
    column = scene.cloud.group.numpy()
    rows = index_groups(scene.cloud).rows(leaves.tolist())
    place = np.searchsorted(leaves, column[rows])  # leaves ascend: the object, then its parts
    told = np.flatnonzero((lab[:, 0] >= DARK)[place])
    if not len(told) or not fits[place[told]].any():
        return rows
    points = scene.cloud.means[torch.from_numpy(rows)].numpy()
    _, around = cKDTree(points[told]).query(points, k=min(NEIGHBOURS, len(told)), workers=-1)
    share = fits[place[told]][around.reshape(len(rows), -1)].mean(axis=1)
    return rows[share >= 0.5]


def _with_shadows(scene: Scene, rows: NDArray[np.int64], barred: frozenset[int]) -> NDArray[np.int64]:
    """The rows and the dark Gaussians among them. Trained scenes represent folds by coloured Gaussians over nearly
    black ones, which have no hue of their own."""
    cloud = scene.cloud
    chosen = np.zeros(len(cloud), bool)
    chosen[rows] = True
    free = ~np.isin(cloud.group.numpy(), sorted(barred))
    points = cloud.means.numpy()
    low, high = points[rows].min(axis=0), points[rows].max(axis=0)
    near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1) & (cloud.opacities > MIN_OPACITY).numpy())
    dark = near[(base_lab(cloud[torch.from_numpy(near)])[:, 0] < DARK).numpy() & free[near] & ~chosen[near]]
    if not len(dark):
        return rows
    for _ in range(2):  # the second pass reaches those behind the first
        _, around = cKDTree(points[near]).query(points[dark], k=min(NEIGHBOURS, len(near)), workers=-1)
        share = chosen[near][around.reshape(len(dark), -1)].mean(axis=1)
        chosen[dark[share > SHADOW_SHARE]] = True
    return np.flatnonzero(chosen)


def _with_whole_parts(
    scene: Scene, field: LanguageField, query: Query, rows: NDArray[np.int64], barred: frozenset[int]
) -> NDArray[np.int64]:
    """The rows, and each part of the query's colour of which they contain at least PART_TAKEN. Single threads and folds
    of a cloth may be too dark to have its colour; the segmentation has them in its parts."""
    column = scene.cloud.group.numpy()
    held = np.bincount(column[rows] + 1, minlength=len(field.groups) + 1)[1:]
    total = np.bincount(column + 1, minlength=len(field.groups) + 1)[1:]
    whole = [
        g.id
        for g in field.groups
        if g.id not in barred
        and held[g.id] >= PART_TAKEN * max(total[g.id], 1)
        and min(float(attributes.color_scores(w, np.array(g.lab))) for w in query.colors) >= attributes.COLOR_HOLDS
    ]
    return np.union1d(rows, index_groups(scene.cloud).rows(whole))
