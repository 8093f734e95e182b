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

from ..scene import Scene
from . import attributes
from .field import LanguageField
from .patches import Patch, patches
from .query import Query
from .selection import Candidate, Selection
from .surface import MIN_OPACITY, base_lab

PARTS = frozenset({"part", "piece", "bit", "area", "region", "patch", "spot"})
SURE = 0.6  # a label this probable forbids reading the group as something else because of its colour
PART_TAKEN = 0.25  # of a part: a place that holds this much of it takes it whole if its colour fits
DARK = 28.0  # Lab lightness below which a Gaussian among coloured ones is their shadow
NEIGHBOURS = 16
AMONG = 0.45  # share of its neighbours that must have been chosen
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
    simple = query.size is None and query.count is None and not query.not_colors
    if query.pick not in ("one", "any", "all") or not simple or not query.text:
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
    """A found selection of the places, with the whole parts that they stand for."""
    color = query.colors[0]
    rows = _with_whole_parts(scene, field, query, np.unique(np.concatenate([p.rows for p in places])), barred)
    rows = _with_shadows(scene, rows, barred)
    candidates = tuple(
        Candidate(-1, "region", color, p.center, p.size, p.score, {f"color {color}": p.score}) for p in places[:6]
    )
    return Selection(query, "found", scene.cloud.ids[torch.from_numpy(rows)].sort().values, (), candidates)


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
    return np.union1d(rows, np.flatnonzero(np.isin(column, whole)))
