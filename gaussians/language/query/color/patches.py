"""Find patches of one colour in a cloud: connected Gaussians whose colour a word names, whatever group they are in.

A cloud is divided once into fragments: adjacent voxels of one group and nearly one colour. A query scores the few
hundred colours that occur, and joins the linked fragments that match; it passes over no single Gaussian but those that
it selects.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray

from ....camera import Vec3
from ....cloud import GaussianCloud
from ....color import naming_space, rgb_to_lab
from ....harmonics import dc_to_color
from ...segmentation.surface import MIN_OPACITY
from ..attributes import color_scores
from .numbering import dense, numbered, stable_order

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
I32 = NDArray[np.int32]
Flags = NDArray[np.bool_]

CELLS = 260  # voxels along the robust diagonal of the scene, in which colour is averaged
BLOCK = 3  # voxels along the side of a block: fragments in the same or adjacent blocks are linked
BIN = 8.0  # side of a bin of colours in naming space, below the width of the transition between two colour words
SEED_SCORE = 0.5  # colour score of seeds: no other basic term is nearer
GROW_SCORE = 0.08  # score down to which a patch grows into adjacent fragments: folds and shadows of one material
MIN_SCORE = 0.03  # of a Gaussian: below it the Gaussian only shares the voxel
DARK = 28.0  # Lab lightness below which a fragment among coloured ones counts as shadow
SHADOW_SHARE = 0.45  # share of the links of a dark fragment that must lead to what is selected
_SPAN = 1 << 13  # voxels along a side of the grid; the scene without outliers takes at most 260
MOST_POINTS = 2000  # rows by which centre and size of a patch are measured
LEAST = 0.05  # share of the largest patch's weight below which a patch is left out
_SCAN_SHARE = 1 / 8
_KEPT = 2  # clouds whose fragments are cached
_LINKED = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) >= (0, 0, 0)])


@dataclass(frozen=True)
class Patch:
    """One connected region of a colour.

    Attributes:
        rows: `[M]` int64, ascending.
        fragments: `[F]` int64, those that it consists of.
        weight: geometric mean of its shares of the scene's Gaussians and of their footprint, times its score. Captures
            have many small Gaussians in the centre of attention and a few very large ones in the background.
        score: mean colour score, weighted by footprint.
        center, size: `[3]` median and robust extent of its Gaussians, world axes, scene units.
    """

    rows: I64
    fragments: I64
    weight: float
    score: float
    center: Vec3
    size: Vec3


@dataclass(frozen=True, eq=False)
class Fragments:
    """The fragments of a cloud, F of them, in B bins of colour.

    Attributes:
        of_row: `[N]` int32, fragment of each row; -1 for rows that are not solid.
        bin_of_row: `[N]` int32, bin of each row's own colour.
        order, starts: rows sorted by fragment, and the start `[F + 1]` of each fragment in `order`.
        bins: `[F]` bin of each fragment.
        labs: `[B, 3]` mean CIE Lab of each bin.
        groups: `[F]` leaf in `GaussianCloud.group`.
        links: two arrays `[L]` int32, pairs of fragments in the same block or blocks that share a face.
        footprint: `[N]` float32 footprint of each row, scene units squared, times opacity, capped; 0 if not solid.
        cells: `[F]` voxels of each fragment.
        side: side of a voxel, scene units.
    """

    of_row: NDArray[np.int32]
    bin_of_row: NDArray[np.int32]
    order: NDArray[np.int32]
    starts: I64
    bins: I64
    labs: F64
    groups: I64
    links: tuple[I32, I32]
    footprint: NDArray[np.float32]
    cells: I64
    side: float

    def __len__(self) -> int:
        return len(self.bins)

    @cached_property
    def total(self) -> float:
        """Footprint of the whole cloud."""
        return float(self.footprint.sum(dtype=np.float64)) + 1e-20

    @cached_property
    def counts(self) -> I64:
        """Rows `[F]` of each fragment."""
        return np.diff(self.starts)

    @cached_property
    def share(self) -> F64:
        """Footprint `[F]` of each fragment."""
        solid = self.of_row >= 0
        total = np.bincount(self.of_row[solid], weights=self.footprint[solid], minlength=len(self))
        return total.astype(np.float64)

    def rows(self, fragments: I64) -> I64:
        """Rows `[M]` int64 of some fragments, ascending."""
        counts = self.starts[fragments + 1] - self.starts[fragments]
        total = int(counts.sum())
        if total >= _SCAN_SHARE * len(self.of_row):  # then a scan of all rows is faster than sorting
            flags = np.zeros(len(self) + 1, bool)
            flags[fragments] = True
            return np.flatnonzero(flags[self.of_row])
        first = np.repeat(self.starts[fragments] - np.cumsum(counts) + counts, counts)
        return np.sort(self.order[first + np.arange(total)]).astype(np.int64)

    def in_groups(self, groups: Iterable[int]) -> Flags:
        """`[F]`, whether each fragment belongs to one of some leaves."""
        wanted = np.fromiter(groups, dtype=np.int64)
        return np.isin(self.groups, wanted)

    def bin_scores(self, words: tuple[str, ...]) -> F64:
        """Score `[B]` of the colour words, the least of them, for each bin.

        Raises:
            UserError: a colour word is unknown.
        """
        return np.asarray(np.min([color_scores(w, self.labs) for w in words], axis=0))

    def with_shadows(self, chosen: I64, free: Flags) -> I64:
        """Some fragments and the dark ones among them. Trained scenes represent folds by coloured Gaussians over nearly
        black ones, which have no hue of their own."""
        flags = np.zeros(len(self), bool)
        flags[chosen] = True
        dark = (self.labs[self.bins, 0] < DARK) & free
        a, b = self.links
        met = dark[a] | dark[b]
        a, b = a[met], b[met]
        for _ in range(2):  # the second pass reaches those behind the first
            held = np.bincount(a[flags[b]], minlength=len(self)) + np.bincount(b[flags[a]], minlength=len(self))
            flags |= dark & (held > SHADOW_SHARE * np.maximum(self._degree, 1))
        return np.flatnonzero(flags)

    @cached_property
    def _degree(self) -> I64:
        """Links `[F]` of each fragment."""
        return sum((np.bincount(end, minlength=len(self)) for end in self.links), np.zeros(len(self), np.int64))


def patches(cloud: GaussianCloud, words: tuple[str, ...], free: Flags | None = None, most: int = 12) -> list[Patch]:
    """The patches that match all colour words, largest weight first.

    Args:
        words: colour words; the minimum of their scores counts.
        free: `[F]` bool, fragments that may be selected (see `fragments_of`); None: all.
        most: how many are returned; those of less than `LEAST` of the largest are left out.

    Raises:
        UserError: a colour word is unknown.
    """
    index = fragments_of(cloud)
    by_bin = index.bin_scores(words)
    score = by_bin[index.bins] if free is None else np.where(free, by_bin[index.bins], 0.0)
    place = _places(index, score)
    known = np.flatnonzero(place >= 0)
    if not len(known):
        return []
    count = np.bincount(place[known], weights=index.counts[known])
    wide = np.bincount(place[known], weights=index.share[known])
    rough = np.sqrt(wide / index.total * count / len(cloud)) * (
        np.bincount(place[known], weights=index.share[known] * score[known]) / (wide + 1e-20)
    )
    first = np.argsort(-rough, kind="stable")[:most]
    kept = first[rough[first] >= LEAST * rough[first[0]]]
    made = [_patch(index, cloud, known[place[known] == p], by_bin) for p in kept.tolist()]
    return sorted((p for p in made if p is not None), key=lambda p: (-p.weight, int(p.rows[0])))


def everywhere(cloud: GaussianCloud, words: tuple[str, ...], free: Flags) -> tuple[I64, I64]:
    """The rows of all patches that match all colour words, and their fragments, both ascending; as `patches`."""
    index = fragments_of(cloud)
    by_bin = index.bin_scores(words)
    fragments = np.flatnonzero(_places(index, np.where(free, by_bin[index.bins], 0.0)) >= 0)
    rows = index.rows(fragments)
    return rows[(by_bin >= MIN_SCORE)[index.bin_of_row[rows]]], fragments


def _patch(index: Fragments, cloud: GaussianCloud, fragments: I64, by_bin: F64) -> Patch | None:
    """The patch of some fragments, without the Gaussians in them of another colour; None if none is left."""
    rows = index.rows(fragments)
    own = by_bin[index.bin_of_row[rows]]
    rows, own = rows[own >= MIN_SCORE], own[own >= MIN_SCORE]
    if not len(rows):
        return None
    footprint = index.footprint[rows].astype(np.float64)
    mean = float(np.average(own, weights=footprint + 1e-20))
    share = float(np.sqrt(footprint.sum() / index.total * len(rows) / len(cloud)))
    points = np.sort(cloud.means.numpy()[rows[:: max(1, len(rows) // MOST_POINTS)]], axis=0)
    low, middle, high = (points[round(q * (len(points) - 1))] for q in (0.02, 0.5, 0.98))
    return Patch(rows, fragments, share * mean, mean, vec(middle), vec(high - low))


def vec(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def _places(index: Fragments, score: F64) -> I64:
    """Patch of each fragment `[F]`, -1 for none: linked seeds, then grown into linked fragments."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    place = np.full(len(index), -1, dtype=np.int64)
    seeds = np.flatnonzero(score >= SEED_SCORE)
    if not len(seeds):
        return place
    a, b = index.links
    strong = score >= SEED_SCORE
    both = strong[a] & strong[b]
    number = np.zeros(len(index), dtype=np.int32)
    number[seeds] = np.arange(len(seeds))
    graph = coo_matrix((np.ones(int(both.sum()), np.int8), (number[a[both]], number[b[both]])), shape=(len(seeds),) * 2)
    place[seeds] = connected_components(graph, directed=False)[1]
    weak = (score >= GROW_SCORE) & ~strong
    met = (weak[a] & (place[b] >= 0)) | (weak[b] & (place[a] >= 0)) | (weak[a] & weak[b])
    a, b = a[met], b[met]
    while len(a):
        forth, back = (place[a] >= 0) & (place[b] < 0), (place[b] >= 0) & (place[a] < 0)
        inner = np.concatenate([a[forth], b[back]])
        outer = np.concatenate([b[forth], a[back]])
        if not len(outer):
            break
        best = np.lexsort((-place[inner], score[inner]))  # the best neighbour is written last
        place[outer[best]] = place[inner[best]]
        left = (place[a] < 0) | (place[b] < 0)
        a, b = a[left], b[left]
    return place


# -- the fragments of a cloud ------------------------------------------------------------------------------------------

_Known = tuple[weakref.ref[torch.Tensor], ...]
_known: OrderedDict[tuple[int, ...], tuple[_Known, Fragments]] = OrderedDict()


def fragments_of(cloud: GaussianCloud) -> Fragments:
    """The fragments of a cloud, made on the first call for its columns (about 2 s for a million Gaussians)."""
    columns = (cloud.means, cloud.scales, cloud.opacities, cloud.sh, cloud.group)
    key = tuple(id(c) for c in columns)
    if (known := _known.get(key)) is not None and all(r() is c for r, c in zip(known[0], columns, strict=True)):
        _known.move_to_end(key)
        return known[1]
    made = _fragments(cloud)
    _known[key] = (tuple(weakref.ref(c) for c in columns), made)
    while len(_known) > _KEPT:
        _known.popitem(last=False)
    return made


def _grid(cloud: GaussianCloud) -> tuple[F64, float]:
    """A corner `[3]` of the scene and the side of a voxel: of its bounds without the outermost 2 % on each side."""
    sample = cloud.means[:: max(1, len(cloud) // 50_000)].double().cpu().numpy()
    low, high = np.quantile(sample, [0.02, 0.98], axis=0)
    return low, float(np.linalg.norm(high - low)) / CELLS + 1e-12


def _fragments(cloud: GaussianCloud) -> Fragments:
    rows = np.flatnonzero((cloud.opacities > MIN_OPACITY).cpu().numpy())
    if not len(rows):
        none, wide = np.zeros(0, np.int64), np.zeros(len(cloud), np.float32)
        nowhere, unbinned = np.full(len(cloud), -1, np.int32), np.zeros(len(cloud), np.int32)
        return Fragments(nowhere, unbinned, none.astype(np.int32), np.zeros(1, np.int64), none, np.zeros((0, 3)), none,
                         (none.astype(np.int32),) * 2, wide, none, 1.0)  # fmt: skip
    at = torch.from_numpy(rows)
    lab = rgb_to_lab(dc_to_color(cloud.sh[:, 0][at]).clamp(0, 1)).cpu().numpy()
    x, y, z = cloud.scales[at].unbind(dim=1)
    less, more = torch.minimum(x, y), torch.maximum(x, y)
    most, middle = torch.maximum(more, z), torch.maximum(less, torch.minimum(more, z))
    footprint = (most * middle * cloud.opacities[at]).cpu().numpy()
    footprint = np.minimum(footprint, np.quantile(footprint, 0.98))
    group = cloud.group[at].cpu().numpy().astype(np.int64)
    low, side = _grid(cloud)
    cell_key = np.floor((cloud.means[at].cpu().numpy().astype(np.float64) - low) / side).astype(np.int64)
    cell_key = np.clip(cell_key + _SPAN // 2, 0, _SPAN - 1)  # outliers far from the scene share its last voxels
    voxel, kinds = dense(cell_key), int(group.max()) + 2
    cell, first = numbered(voxel * kinds + group + 1)
    weight = np.bincount(cell, weights=footprint, minlength=len(first)) + 1e-20
    total = np.stack([np.bincount(cell, weights=lab[:, c] * footprint, minlength=len(first)) for c in range(3)], axis=1)
    mean = total / weight[:, None]
    bins, labs = _binned(np.concatenate([mean, lab.astype(np.float64)]))
    of_cell, a, b = _linked(cell_key[first] // BLOCK, bins[: len(first)], group[first])
    count = int(of_cell.max()) + 1
    of_row = np.full(len(cloud), -1, np.int32)
    of_row[rows] = of_cell[cell]
    own_bin = np.zeros(len(cloud), np.int32)
    own_bin[rows] = bins[len(first) :]
    wide = np.zeros(len(cloud), np.float32)
    wide[rows] = footprint
    own = of_row[rows]
    order = stable_order(own, count)
    starts = np.append(0, np.cumsum(np.bincount(own, minlength=count)))
    pick = np.zeros(count, np.int64)
    pick[of_cell] = np.arange(len(of_cell))
    return Fragments(of_row, own_bin, rows[order].astype(np.int32), starts, bins[: len(first)][pick], labs,
                     group[first][pick], (a, b), wide, np.bincount(of_cell, minlength=count), side)  # fmt: skip


def _binned(lab: F64) -> tuple[I64, F64]:
    """The bin `[M]` of each colour `[M, 3]` CIE Lab, and the mean colour `[B, 3]` of each bin."""
    key = np.floor(naming_space(torch.from_numpy(lab)).numpy() / BIN).astype(np.int64)
    bins = dense(key)
    count = np.bincount(bins)
    total = np.stack([np.bincount(bins, weights=lab[:, c], minlength=len(count)) for c in range(3)], axis=1)
    return bins, total / count[:, None]


def _code(key: I64) -> I64:
    """Three coordinates below `_SPAN` as one number."""
    return (key[:, 0] << 26) + (key[:, 1] << 13) + key[:, 2]


def _linked(block: I64, bins: I64, group: I64) -> tuple[I64, I32, I32]:
    """The fragment of each voxel, those of one bin and group in the same or adjacent blocks; and the ends of the links.

    Args:
        block: `[C, 3]` coordinates of the block of each voxel.
        bins, group: `[C]` of each voxel.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    code = _code(block + 1)
    blocks, at = np.unique(code, return_inverse=True)
    kind = at.astype(np.int64) << 34 | bins << 17 | (group + 1)  # one node for each block, bin and group
    nodes, node = np.unique(kind, return_inverse=True)
    home, sort = nodes >> 34, nodes & ((1 << 34) - 1)
    starts = np.searchsorted(home, np.arange(len(blocks) + 1))
    pairs, faces = [], []
    for step in _LINKED:
        other = blocks + int(_code(step[None])[0])
        place = np.minimum(np.searchsorted(blocks, other), len(blocks) - 1)
        met = np.flatnonzero(blocks[place] == other)
        pairs.append(_products(starts, met, place[met]))
        faces += [pairs[-1]] if np.abs(step).sum() < 2 else []
    both = np.concatenate(pairs)
    same = both[sort[both[:, 0]] == sort[both[:, 1]]]
    graph = coo_matrix((np.ones(len(same), np.int8), (same[:, 0], same[:, 1])), shape=(len(nodes), len(nodes)))
    fragment = connected_components(graph, directed=False)[1].astype(np.int64)
    links = np.sort(fragment[np.concatenate(faces)], axis=1)
    links = links[links[:, 0] != links[:, 1]]
    unique = np.unique(links[:, 0] * len(nodes) + links[:, 1])
    return fragment[node], (unique // len(nodes)).astype(np.int32), (unique % len(nodes)).astype(np.int32)


def _products(starts: I64, a: I64, b: I64) -> I64:
    """All pairs `[P, 2]` of a node of block `a[i]` and a node of block `b[i]`, each block being a range of nodes."""
    many = (starts[a + 1] - starts[a]) * (starts[b + 1] - starts[b])
    pair = np.repeat(np.arange(len(a)), many)
    inner = np.arange(int(many.sum())) - np.repeat(np.cumsum(many) - many, many)
    width = (starts[b + 1] - starts[b])[pair]
    return np.stack([starts[a][pair] + inner // width, starts[b][pair] + inner % width], axis=1)
