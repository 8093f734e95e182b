"""A colour where the noun fails: "the purple cloth" to an encoder that does not know cloth, "the orange parts".

Knows measured colours, Gaussian by Gaussian, and the table of groups. Refuses to know the text encoder; every answer
says that the name was not confirmed.
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
SURE = 0.6  # a label this probable forbids reading the group as something else because of its colour
PART_TAKEN = 0.25  # of a part: a place that holds this much of it takes it whole if its colour fits
DARK = 28.0  # Lab lightness below which a Gaussian among coloured ones is their shadow
NEIGHBOURS = 16
AMONG = 0.45  # share of its neighbours that must have been chosen
HOME = 0.7  # of a place: an object that holds this much of it is what the place belongs to
RIVAL = 0.4  # a second place of the colour with at least this share of the first's weight is a rival


def by_color(scene: Scene, field: LanguageField, query: Query, stands: Callable[[Tensor], bool]) -> Selection | None:
    """The one place (or all, if asked) that has the query's colours; None where colour cannot answer.

    Objects whose own name the encoder is sure of are left out (a red armchair is not a red bicycle), and so are floor
    and walls. "Parts" may belong to anything but those.

    Args:
        stands: whether some rows stand in the query's relations.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _simple(query):
        return None
    generic = query.text in PARTS
    barred = _barred(field, named=not generic and at_home(field))
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
    """Those of the `named` objects, whole, that have a place of the query's colours which is their hue: "the red
    bicycle" by its frame, though tyres and saddle make most of it black. None where there is none.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _simple(query) or not named:
        return None
    members = index_groups(scene.cloud)
    own = np.zeros(len(scene.cloud), bool)
    own[members.rows(leaf for g in named for leaf in field.leaves(g))] = True
    places = [p for p in patches(scene.cloud, query.colors, own) if stands(torch.from_numpy(p.rows))]
    first: dict[int, Patch] = {}
    for place in places:
        home = _home(scene, field, query, place.rows, frozenset())
        if home in named and place.weight > RIVAL * places[0].weight:
            first.setdefault(home, place)
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


def _simple(query: Query) -> bool:
    """Whether colour can answer at all: no sizes, counts and orders."""
    simple = query.size is None and query.count is None and not query.not_colors
    return query.pick in ("one", "any", "all") and simple and bool(query.text)


def at_home(field: LanguageField) -> bool:
    """Whether the encoder is sure of the names of most of the scene's objects, counted by Gaussians.

    Where it is not (a capture unlike what it was trained on), a sure name is as likely a look-alike's.
    """
    objects = [g for g in field.objects() if g.count]
    sure = sum(g.count for g in objects if g.label_score >= SURE)
    return sure >= 0.5 * sum(g.count for g in objects)


def _barred(field: LanguageField, named: bool) -> frozenset[int]:
    """Leaves that may not be taken by colour: structure, and if `named` objects with a sure name."""
    return frozenset(
        leaf
        for g in field.groups
        if g.level == "structure" or (named and g.level == "object" and g.label_score >= SURE)
        for leaf in field.leaves(g.id)
    )


def _taken(
    scene: Scene, field: LanguageField, query: Query, places: Sequence[Patch], barred: frozenset[int]
) -> Selection:
    """A found selection of the places: of each the thing that has the colour by it, or what else it stands for."""
    color = query.colors[0]
    candidates = tuple(
        Candidate(-1, "region", color, p.center, p.size, p.score, {f"color {color}": p.score}) for p in places[:6]
    )
    whole, loose = [], []
    for place in places:
        home = None if query.text in PARTS else _home(scene, field, query, place.rows, barred)
        if home is None:
            loose.append(place.rows)
        else:
            whole.append(_of_color(scene, field, query, home))
    if loose:
        rows = _with_whole_parts(scene, field, query, np.unique(np.concatenate(loose)), barred)
        whole.append(_with_shadows(scene, rows, barred))
    rows = np.unique(np.concatenate(whole))
    return Selection(query, "found", scene.cloud.ids[torch.from_numpy(rows)].sort().values, (), candidates)


def _home(
    scene: Scene, field: LanguageField, query: Query, rows: NDArray[np.int64], barred: frozenset[int]
) -> int | None:
    """The object that most of a place lies in, if the object's hue is the colour asked for."""
    column = scene.cloud.group.numpy()[rows]
    of = np.array([g.parent if g.parent >= 0 else g.id for g in field.groups] + [NO_GROUP])[column]
    homes, counts = np.unique(of[of >= 0], return_counts=True)
    if not len(homes) or counts.max() < HOME * len(rows):
        return None
    home = int(homes[counts.argmax()])
    if field.groups[home].level != "object" or barred & set(field.leaves(home)):
        return None
    hue = min(float(attributes.hue_shares(field, word)[home]) for word in query.colors)
    return home if hue >= attributes.HUE_SHARE else None


def _of_color(scene: Scene, field: LanguageField, query: Query, home: int) -> NDArray[np.int64]:
    """The rows of an object that have its hue, without what else it holds (the stand on the cloth).

    Trained scenes paint folds and threads with nearly black Gaussians between coloured ones, so that no hue of their
    own tells whose they are: every row goes with most of its nearest neighbours in parts that are not dark.
    """
    leaves = np.array(field.leaves(home))
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
    """The rows, and the dark Gaussians among them: trained scenes paint folds with coloured over nearly black ones,
    which have no hue of their own to be found by."""
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
    for _ in range(2):  # the second time reaches those behind the first
        _, around = cKDTree(points[near]).query(points[dark], k=min(NEIGHBOURS, len(near)), workers=-1)
        share = chosen[near][around.reshape(len(dark), -1)].mean(axis=1)
        chosen[dark[share > AMONG]] = True
    return np.flatnonzero(chosen)


def _with_whole_parts(
    scene: Scene, field: LanguageField, query: Query, rows: NDArray[np.int64], barred: frozenset[int]
) -> NDArray[np.int64]:
    """The rows, and all of each part that they hold a good share of and that has the colour as a whole.

    Threads and folds of one cloth may be too dark to have its colour one by one; the segmentation knows better.
    """
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
