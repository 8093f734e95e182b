"""Select by colour where the noun cannot be resolved: "the purple cloth" for an encoder that does not know cloth.

It also selects "the orange parts". The text encoder is not used. What stands for a named thing is "unconfirmed", and
the reason tells what was chosen. Floor, walls and ceiling are never chosen, nor pieces of them
that the segmentation left as things of their own (`remnants.py`). Whole groups take precedence over loose patches.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ....camera import Camera, Vec3
from ....cloud import NO_GROUP
from ....scene import Scene
from ....world import kinds
from ...field.group_index import index_groups
from ...field.language_field import Group, LanguageField
from .. import attributes
from ..query import Query
from ..selection import Candidate, Selection, nothing
from .patches import DARK, Fragments, Patch, everywhere, fragments_of, patches, vec
from .remnants import Shell, shell_of

PARTS = frozenset({"part", "piece", "bit", "area", "region", "patch", "spot"})
SURE_LABEL = 0.6  # probability from which a label rules out that the group is something else of that colour
RELIABLE = 0.42  # mean probability of the labels of a reliable scene: 0.52 to 0.95 in rooms of ours, below 0.32 in fits
PART_TAKEN = 0.25  # share of a part inside a patch from which all of the part is taken if its colour matches
OWNER_SHARE = 0.7  # share of a patch inside an object from which the patch belongs to the object
RIVAL = 0.4  # share of the first place's weight from which another place is a rival
COMPACT = 0.1  # share of the faces of its box that the voxels of a compact thing cover: a third of what a cube shows
LEAST_COMPACT = 0.2  # share of `COMPACT` below which a place is scattered
NEIGHBOURS = 16
MOST_POINTS = 5000
SEEN_SHARE = 3.0  # factor by which what is seen of a thing may fall short of the smallest size as sold

Stands = Callable[[Tensor], bool]


@dataclass(frozen=True, eq=False)
class Place:
    """What may be meant by a colour: an object, or a patch that is none.

    Attributes:
        rows: `[M]` int64, ascending.
        group: id of the object; -1 for a loose patch.
        weight: see `Patch`, times how plausible its size and compactness are.
        score: of its colour, in [0, 1].
        center, size: `[3]` scene units; the size as two level sides and the height for an object.
    """

    rows: NDArray[np.int64]
    group: int
    weight: float
    score: float
    center: Vec3
    size: Vec3

    def candidate(self, color: str, label: str) -> Candidate:
        return Candidate(self.group, label, color, self.center, self.size, self.score, {f"color {color}": self.score})


def by_color(scene: Scene, field: LanguageField, query: Query, viewer: Camera, stands: Stands) -> Selection | None:
    """The one place (or all, with pick "all") of the query's colours; None if colour cannot resolve the query.

    Objects with a sure label are excluded (a red armchair is not a red bicycle), unless the query asks for "parts".

    Args:
        viewer: the camera from which the reason tells where the place is.
        stands: whether some rows satisfy the query's relations.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _is_simple(query):
        return None
    search = _Search(scene, field, query)
    places = [p for p in search.places() if stands(torch.from_numpy(p.rows))]
    if not places:
        return None
    rivals = [p for p in places if p.weight > RIVAL * places[0].weight]
    doubtful = "" if search.generic else f"{query.text!r} could not be confirmed"
    if len(rivals) > 1 and query.pick == "one":
        members = index_groups(scene.cloud)
        told = tuple(
            replace(p.candidate(query.colors[0], search.label(p)), ids=members.ids_at(p.rows)) for p in rivals[:6]
        )
        reason = f"{doubtful or query.describe()}: {len(rivals)} places have that colour; say where it is, or 'all'"
        return replace(nothing(query, reason, told), verdict="ambiguous")
    chosen = places if query.pick == "all" else places[:1]
    told = tuple(p.candidate(query.colors[0], search.label(p)) for p in chosen[:6])
    rows = chosen[0].rows if len(chosen) == 1 else np.unique(np.concatenate([p.rows for p in chosen]))
    groups = tuple(dict.fromkeys(p.group for p in chosen if p.group >= 0 and search.is_whole(p)))
    seen = f"{doubtful}; chosen by its colour: {_told(scene, chosen, query, viewer)}" if doubtful else ""
    ids = index_groups(scene.cloud).ids_at(rows)
    return Selection(query, "found" if search.generic else "unconfirmed", ids, groups, told, seen)


def by_hue(scene: Scene, field: LanguageField, query: Query, stands: Stands, named: frozenset[int]) -> Selection | None:
    """The `named` objects whose hue is the query's colour, as whole objects; None if there are none.

    "The red bicycle" is found by its frame, although tyres and saddle make most of it black.

    Raises:
        UserError: a colour word is unknown.
    """
    if not _is_simple(query) or not named:
        return None
    hued = _hued(field, query, named)
    if not hued:
        return None
    members = index_groups(scene.cloud)
    index = fragments_of(scene.cloud)
    own = index.in_groups(leaf for g in hued for leaf in field.leaves(g))
    first: dict[int, Patch] = {}
    places = [p for p in patches(scene.cloud, query.colors, own) if stands(torch.from_numpy(p.rows))]
    for place in places:
        owner = _owner_of(field, index, place)
        if owner in hued and place.weight > RIVAL * places[0].weight:
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


def is_reliable(field: LanguageField) -> bool:
    """Whether the objects of the scene are named surely on the whole; larger ones weigh more.

    Otherwise (a capture unlike the training data of the encoder) single sure labels are not reliable either. Names that
    were given to things later say nothing about the encoder.
    """
    objects = [g for g in field.objects() if g.count and g.named_by != "user"]
    if not objects:
        return False
    weights = [math.sqrt(g.count) for g in objects]
    sure = sum(w * g.label_score for w, g in zip(weights, objects, strict=True))
    return sure >= RELIABLE * sum(weights)


def _is_simple(query: Query) -> bool:
    """Whether a query has no size, count, excluded colour or order, so that colour can resolve it."""
    simple = query.size is None and query.count is None and not query.not_colors
    return query.pick in ("one", "any", "all") and simple and bool(query.text)


def _hued(field: LanguageField, query: Query, among: frozenset[int]) -> frozenset[int]:
    """The objects `among` some whose hue is every colour of the query."""
    shares = np.min([attributes.hue_shares(field, word) for word in query.colors], axis=0)
    return frozenset(g for g in among if shares[g] >= attributes.HUE_SHARE and field.groups[g].level == "object")


class _Search:
    """The places of a query's colours in a scene."""

    def __init__(self, scene: Scene, field: LanguageField, query: Query) -> None:
        self.scene, self.field, self.query = scene, field, query
        self.generic = query.text in PARTS
        self.kind = None if self.generic else kinds.find(query.text)
        self.shell: Shell = shell_of(scene, field)
        self.index = fragments_of(scene.cloud)
        self.barred = self._excluded()

    def places(self) -> list[Place]:
        """What may be meant, the most probable first: objects, and where none is plausible, loose patches."""
        if self.generic and self.query.pick == "all" and not self.query.relations:
            return self._everywhere()
        return ([] if self.generic else self._objects()) or self._loose()

    def label(self, place: Place) -> str:
        """The name that a place is told by: that of its object only if it is sure."""
        return "object" if place.group >= 0 else "region"

    def is_whole(self, place: Place) -> bool:
        """Whether a place is all of its group."""
        return len(place.rows) == self.field.groups[place.group].count

    def _excluded(self) -> frozenset[int]:
        """Leaves that are not selected: structure and what is left of it, and objects with a sure label of another."""
        named = not self.generic and is_reliable(self.field)
        remnants = frozenset() if self.generic else self.shell.remnants(self.kind)
        return frozenset(
            leaf
            for g in self.field.groups
            if g.level == "structure"
            or g.id in remnants
            or (named and g.level == "object" and g.label_score >= SURE_LABEL)
            for leaf in self.field.leaves(g.id)
        )

    def _objects(self) -> list[Place]:
        """The objects that have the colours as a whole, or as their hue."""
        field, words = self.field, self.query.colors
        whole = np.min([attributes.color_scores(w, field.labs) for w in words], axis=0)
        hue = np.min([attributes.hue_shares(field, w) for w in words], axis=0)
        found = []
        for group in field.objects():
            score = max(float(whole[group.id]), attributes.PART_DISCOUNT * float(hue[group.id] >= attributes.HUE_SHARE))
            if not group.count or score < attributes.COLOR_HOLDS or self.barred.intersection(field.leaves(group.id)):
                continue
            if (place := self._object(group, score)) is not None:
                found.append(place)
        return sorted(found, key=lambda p: (-p.weight, p.group))

    def _object(self, group: Group, score: float) -> Place | None:
        """An object as a place, without other things in it (the stand on the cloth); None if it is not plausible."""
        leaves = self.field.leaves(group.id)
        fits = self._fits(group.box.size, self.index.in_groups(leaves))
        if fits <= 0:
            return None
        rows = _rows_of_hue(self.scene, self.field, group.id, self.query.colors)
        wide = float(self.index.footprint[rows].sum()) / self.index.total
        weight = float(np.sqrt(wide * len(rows) / len(self.scene.cloud))) * score * fits
        center = np.median(self.scene.cloud.means.numpy()[rows[:: max(1, len(rows) // MOST_POINTS)]], axis=0)
        return Place(rows, group.id, weight, score, vec(center), group.box.size)

    def _everywhere(self) -> list[Place]:
        """All patches of the colours as one place."""
        free = ~self.index.in_groups(self.barred)
        rows, fragments = everywhere(self.scene.cloud, self.query.colors, free)
        if not len(rows):
            return []
        points = self.scene.cloud.means.numpy()[rows[:: max(1, len(rows) // MOST_POINTS)]]
        score = float(self.index.bin_scores(self.query.colors)[self.index.bins[fragments]].mean())
        whole = self._completed(rows, fragments, free)
        return [Place(whole, -1, score, score, vec(np.median(points, axis=0)), vec(np.ptp(points, axis=0)))]

    def _loose(self) -> list[Place]:
        """The patches of the colours in what is left, completed by parts and shadows."""
        free = ~self.index.in_groups(self.barred)
        found = []
        for patch in patches(self.scene.cloud, self.query.colors, free):
            fits = 1.0 if self.generic else self._fits(patch.size, patch.fragments)
            if fits <= 0 or (not self.generic and self._is_remnant(patch)):
                continue
            rows = self._completed(patch.rows, patch.fragments, free)
            found.append(Place(rows, -1, patch.weight * fits, patch.score, patch.center, patch.size))
        return sorted(found, key=lambda p: (-p.weight, int(p.rows[0])))

    def _is_remnant(self, patch: Patch) -> bool:
        points = self.scene.cloud.means.numpy()[patch.rows].astype(np.float64)
        lab = self.index.labs[self.index.bin_of_row[patch.rows]].mean(axis=0)
        return self.shell.is_remnant(points, (float(lab[0]), float(lab[1]), float(lab[2])), self.kind)

    def _fits(self, size: Vec3, fragments: NDArray[np.int64] | NDArray[np.bool_]) -> float:
        """How plausible the size and compactness of a place are, in [0, 1]; 0 if it cannot be a thing."""
        if self.shell.is_room_sized(size):
            return 0.0
        x, y, z = (max(s, self.index.side) for s in size)
        faces = 2 * (x * y + y * z + z * x)
        compact = min(1.0, float(self.index.cells[fragments].sum()) * self.index.side**2 / (COMPACT * faces))
        if compact < LEAST_COMPACT:
            return 0.0
        return compact * self._size_fits(size)

    def _size_fits(self, size: Vec3) -> float:
        """1 for a size that the noun's kind has, or where kind or scale is unknown; 0 for another."""
        scale = self.scene.frame.metres_per_unit
        if self.kind is None or scale is None:
            return 1.0
        known = kinds.extent(self.kind.name)
        sides = np.array([*sorted(size[:2]), size[2]]) * scale
        low = np.array([*sorted(r[0] for r in known[:2]), known[2][0]]) / SEEN_SHARE
        high = np.array([*sorted(r[1] for r in known[:2]), known[2][1]])
        return float(bool((sides >= low).all() and (sides <= high).all()))

    def _completed(
        self, rows: NDArray[np.int64], fragments: NDArray[np.int64], free: NDArray[np.bool_]
    ) -> NDArray[np.int64]:
        """Rows of fragments, with each part of the colours of which they contain at least `PART_TAKEN`, and with their
        shadows. Single threads of a cloth may be too dark for its colour; the parts hold them."""
        field, column = self.field, index_groups(self.scene.cloud).column
        held = np.bincount(column[rows], minlength=len(field.groups) + 1)[1 : len(field.groups) + 1]
        counts = np.array([g.count for g in field.groups])
        fits = np.min([attributes.color_scores(w, field.labs) for w in self.query.colors], axis=0)
        parts = np.flatnonzero((held >= PART_TAKEN * np.maximum(counts, 1)) & (fits >= attributes.COLOR_HOLDS))
        dark = np.setdiff1d(self.index.with_shadows(fragments, free), fragments, assume_unique=True)
        flags = np.zeros(len(column), bool)
        flags[rows] = True
        flags[index_groups(self.scene.cloud).rows(set(parts.tolist()) - self.barred)] = True
        flags[self.index.rows(dark)] = True
        return np.flatnonzero(flags)


@dataclass(frozen=True, eq=False)
class _Folds:
    """The rows of an object in dark parts, each with its nearest rows in parts that are not dark.

    Attributes:
        rows: `[M]` int64 of the object, ascending.
        leaf: `[M]` leaf of each row.
        dark: `[D]` positions in `rows` of those in dark parts.
        near: `[D, K]` leaves of the nearest rows in parts that are not dark; K is 0 if there are none.
    """

    rows: NDArray[np.int64]
    leaf: NDArray[np.int64]
    dark: NDArray[np.int64]
    near: NDArray[np.int64]


_folds: weakref.WeakKeyDictionary[Fragments, dict[int, _Folds]] = weakref.WeakKeyDictionary()


def _folds_of(scene: Scene, field: LanguageField, owner: int) -> _Folds:
    """The folds of an object, kept with the fragments of the cloud."""
    from scipy.spatial import cKDTree

    known = _folds.setdefault(fragments_of(scene.cloud), {})
    if owner not in known:
        rows = index_groups(scene.cloud).rows(field.leaves(owner))
        leaf = scene.cloud.group.numpy()[rows].astype(np.int64)
        light = field.labs[leaf, 0] >= DARK
        dark, told = np.flatnonzero(~light), np.flatnonzero(light)
        near = np.zeros((len(dark), 0), np.int64)
        if len(dark) and len(told):
            points = scene.cloud.means.numpy()[rows]
            _, around = cKDTree(points[told]).query(points[dark], k=min(NEIGHBOURS, len(told)), workers=-1)
            near = leaf[told][around.reshape(len(dark), -1)]
        known[owner] = _Folds(rows, leaf, dark, near)
    return known[owner]


def _rows_of_hue(scene: Scene, field: LanguageField, owner: int, words: Sequence[str]) -> NDArray[np.int64]:
    """The rows of an object that have the colours, without other things in it (the stand on the cloth).

    Trained scenes represent folds and threads by nearly black Gaussians between coloured ones, which have no hue of
    their own. So rows of dark parts are decided by the majority of their nearest neighbours in the others.
    """
    folds = _folds_of(scene, field, owner)
    leaves = np.array(field.leaves(owner))
    fits = np.zeros(len(field.groups), bool)
    fits[leaves] = np.min([attributes.color_scores(w, field.labs[leaves]) for w in words], axis=0) >= (
        attributes.COLOR_HOLDS
    )
    kept = fits[folds.leaf]
    if not folds.near.shape[1] or not kept[field.labs[folds.leaf, 0] >= DARK].any():
        return folds.rows
    kept[folds.dark] = fits[folds.near].mean(axis=1) >= 0.5
    return folds.rows[kept]


def _owner_of(field: LanguageField, index: Fragments, place: Patch) -> int | None:
    """The object that contains most of a patch."""
    of = np.array([g.parent if g.parent >= 0 else g.id for g in field.groups] + [NO_GROUP])
    counts = np.diff(index.starts)[place.fragments]
    homes, where = np.unique(of[index.groups[place.fragments]], return_inverse=True)
    held = np.bincount(where, weights=counts)
    best = int(held.argmax())
    return int(homes[best]) if homes[best] >= 0 and held[best] >= OWNER_SHARE * held.sum() else None


def _told(scene: Scene, chosen: Sequence[Place], query: Query, viewer: Camera) -> str:
    """What was chosen, in words: "one brown thing, 0.4 x 0.3 x 0.2 m, on the left of the view"."""
    first = chosen[0].candidate(query.colors[0], "")
    scale, unit = (scene.frame.metres_per_unit, "m") if scene.frame.metres_per_unit else (1.0, "units")
    size = " x ".join(f"{s * scale:.2g}" for s in first.size)
    what = "thing" if first.group >= 0 else "patch"
    if len(chosen) == 1:
        return f"a {' '.join(query.colors)} {what}, {size} {unit}, {first.seen_from(viewer)}"
    several = {"thing": "things", "patch": "patches"}[what]
    return f"{len(chosen)} {' '.join(query.colors)} {several}, the largest {size} {unit}, {first.seen_from(viewer)}"
