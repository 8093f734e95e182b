"""Tell the main material of a thing from parts of other hues: a cushion on a chair, a handle on a drawer, a scarf.

Colours are averaged in the cells of a grid over the thing, so that neither noise nor a fine pattern (stripes, a weave)
counts. Light scales a and b of CIE Lab with lightness (about as L + 16), so hues are compared at one lightness. The
hues of the cells are clustered; the cluster with most area is the main material. Other clusters are parts where their
cells touch each other and are large enough; what is left in between belongs to the main material.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import name_of, rgb_to_lab
from ...gaussians.harmonics import dc_to_color
from ...gaussians.language.field.measure import lit_of
from .areas import areas
from .grid import Grid

_CELLS = 28  # along the longest axis
_SAMPLE = 1 << 14  # Gaussians that hues are measured on
_FEWEST = 64  # Gaussians below which a thing counts as one material
_DARK = 9.0  # lightness below which a cell has no hue
_FAR = 24.0  # Lab distance in a and b, at the lightness of the main material, from which a hue is another one
_TURN = 36.0  # and degrees of hue; or, for greys beside colours, a chroma of less than
_GREY = 9.0
_WARM = (20.0, 85.0)  # hues of wood, clay, leather and skin, which vary within one material: they count half
_BLACK = 18.0  # lightness up to which a cell beside a light main material is black and not in shadow
_LIGHT = 45.0  # and the least lightness of that main material
_SHARE = 0.015  # share of the thing's area that the parts of one hue have at least together
_PIECE = 0.006  # and each of them alone
_MOST = 0.4  # share up to which another hue is a part; above it the thing has two main colours
_MOST_BLACK = 0.6  # the same of black, which keeps its look beside any colour
_LEVEL = 40.0  # least lightness at which hues are compared
_SOLID = 0.4  # share of the occupied cells around a part's cells that belong to it, on average
_CLUSTERS = 6
_BIN = 4.0  # Lab units, of the histogram of hues


Parts = tuple[tuple[str, float], ...]


@dataclass(frozen=True, eq=False)
class Materials:
    """The main material of a thing and its parts of other hues.

    Attributes:
        part: `[M]` int64 over the rows of the thing: 0 for the main material, else the number of a hue.
        shares: of the hues 1, 2, ...: colour in words, and share of the thing by area.
    """

    part: Tensor
    shares: Parts = ()

    @property
    def main(self) -> Tensor:
        """`[M]` bool: whether a Gaussian is of the main material."""
        return self.part == 0


def materials(cloud: GaussianCloud, rows: Tensor) -> Materials:
    """Split some rows `[M]` of a cloud into the main material and parts of other hues."""
    whole = Materials(torch.zeros(len(rows), dtype=torch.int64, device=rows.device))
    if len(rows) < _FEWEST:
        return whole
    cells = _Cells.of(cloud, rows)
    cluster, hues = _clusters(cells)
    cluster, centers = _with_black(cells, cluster, hues)
    if len(centers) < 2:
        return whole
    black = len(centers) > len(hues)
    foreign = _parts(cells, cluster, centers, black=black)
    if not bool((foreign > 0).any()):
        return whole
    return _assigned(cloud, rows, cells, foreign, centers, black=black)


@dataclass(frozen=True, eq=False)
class _Cells:
    """Occupied cells of a grid over a thing.

    Attributes:
        grid: the grid.
        index: `[V]` int64 flat indices of the occupied cells.
        area: `[V]` share of the thing's area; sums to one.
        lab: `[V, 3]` mean colour.
        hue: `[V, 2]` a and b at the lightness `level`.
        level: lightness at which hues are compared, that of the thing or `_LEVEL`.
    """

    grid: Grid
    index: Tensor
    area: Tensor
    lab: Tensor
    hue: Tensor
    level: float

    @classmethod
    def of(cls, cloud: GaussianCloud, rows: Tensor) -> _Cells:
        points, area, rgb = areas(cloud, rows, _SAMPLE)
        grid = Grid.over(points, _CELLS)
        sums = grid.sums(points, torch.cat([area[:, None] * rgb, area[:, None]], dim=1)).double()
        index = (sums[:, 3] > 1e-3 * sums[:, 3].max()).nonzero().squeeze(1)
        total = sums[index, 3]
        lab = rgb_to_lab(sums[index, :3] / total[:, None])
        share = total / total.sum()
        level = max(float((share * lab[:, 0]).sum()), _LEVEL)
        return cls(grid, index, share, lab, hue_at(lab, level), level)


def hue_at(lab: Tensor, level: float) -> Tensor:
    """a and b `[..., 2]` that colours `[..., 3]` have under a light that shows them at lightness `level`."""
    return lab[..., 1:] * ((level + 16) / (lab[..., :1] + 16))


def _clusters(cells: _Cells) -> tuple[Tensor, Tensor]:
    """Cluster of each cell `[V]` (0: the main one, -1: too dark to have a hue) and their centres `[C, 2]`."""
    told = cells.lab[:, 0] >= _DARK
    left = torch.where(told, cells.area, 0.0)
    centers: list[Tensor] = []
    while len(centers) < _CLUSTERS and float(left.sum()) > _SHARE:
        center = _densest(cells.hue, left)
        near = torch.linalg.vector_norm(cells.hue - center, dim=1) < _FAR / 2
        center = (left[near, None] * cells.hue[near]).sum(dim=0) / left[near].sum().clamp(min=1e-12)
        if all(_differ(center, other) for other in centers):
            centers.append(center)
        left = torch.where(torch.linalg.vector_norm(cells.hue - center, dim=1) < _FAR / 2 + 1, 0.0, left)
    if len(centers) < 2:
        return torch.zeros_like(cells.index), torch.stack(centers) if centers else cells.hue.new_zeros(0, 2)
    found = torch.stack(centers)
    cluster = torch.cdist(cells.hue, found).argmin(dim=1)
    areas = torch.zeros(len(found), dtype=torch.float64).index_add_(0, cluster[told], cells.area[told])
    order = areas.argsort(descending=True)
    rank = order.argsort()
    main = found[order[0]]
    keep = torch.tensor([True, *(_differ(c, main) for c in found[order[1:]])])
    cluster = torch.where(keep[rank[cluster]], rank[cluster], 0)
    return torch.where(told, cluster, -1), found[order]


def _with_black(cells: _Cells, cluster: Tensor, centers: Tensor) -> tuple[Tensor, Tensor]:
    """The clusters, with one more of black cells if the main material is light: black is a pigment there."""
    main = (cluster == 0) & (cells.lab[:, 0] > _BLACK)
    dark = (cells.lab[:, 0] < _BLACK) & (torch.linalg.vector_norm(cells.lab[:, 1:], dim=1) < _GREY)
    if not bool(main.any()) or not bool(dark.any()):
        return cluster, centers
    if float(lit_of(cells.area[main] / cells.area[main].sum(), cells.lab[main])[0]) < _LIGHT:
        return cluster, centers
    return torch.where(dark, len(centers), cluster), torch.cat([centers, centers.new_zeros(1, 2)])


def _densest(hue: Tensor, area: Tensor) -> Tensor:
    """The hue `[2]` around which most area lies."""
    bins = (hue / _BIN).round()
    keys, inverse = torch.unique(bins, dim=0, return_inverse=True)
    mass = torch.zeros(len(keys), dtype=area.dtype).index_add_(0, inverse, area)
    near = (torch.cdist(keys, keys) < 1.6).to(area.dtype)
    return keys[int((near @ mass).argmax())] * _BIN


def _differ(a: Tensor, b: Tensor) -> bool:
    """Whether two hues (a and b at one lightness) are of different materials."""
    if float(torch.linalg.vector_norm(a - b)) < _FAR:
        return False
    if min(float(a.norm()), float(b.norm())) < _GREY:
        return True
    apart = abs(_hue(a) - _hue(b))
    return min(apart, 360 - (_WARM[1] - _WARM[0]) / 2 - apart) > _TURN


def _hue(ab: Tensor) -> float:
    """Hue in degrees from 0, the warm hues pressed to half their range."""
    degrees = math.degrees(math.atan2(float(ab[1]), float(ab[0]))) % 360
    return degrees - 0.5 * min(max(degrees - _WARM[0], 0.0), _WARM[1] - _WARM[0])


def _parts(cells: _Cells, cluster: Tensor, centers: Tensor, *, black: bool) -> Tensor:
    """Cluster of each cell `[V]` of a part, 0 for the main material; `black`: the last cluster is black."""
    foreign = torch.zeros_like(cluster)
    occupied = torch.zeros(cells.grid.size, 1, dtype=torch.float32)
    occupied[cells.index] = 1
    around = cells.grid.smoothed(occupied)[cells.index, 0] * 27 - 1
    for number in range(1, len(centers)):
        own = cluster == number
        for cell in _components(cells, own):
            mine = torch.zeros_like(occupied)
            mine[cells.index[cell]] = 1
            beside = cells.grid.smoothed(mine)[cells.index[cell], 0] * 27 - 1
            area = cells.area[cell]
            solid = float((area * beside / around[cell].clamp(min=1)).sum() / area.sum())
            if float(area.sum()) >= _PIECE and solid >= _SOLID:
                foreign[cell] = number
        most = _MOST_BLACK if black and number == len(centers) - 1 else _MOST
        if not _SHARE <= float(cells.area[foreign == number].sum()) <= most:
            foreign[foreign == number] = 0
    return foreign


def _components(cells: _Cells, member: Tensor) -> list[Tensor]:
    """Positions `[K]` of the member cells of each set of cells that touch, also by corners."""
    import numpy as np
    from scipy.ndimage import label

    block = np.zeros(cells.grid.size, dtype=bool)
    where = member.nonzero().squeeze(1)
    block[cells.index[where].numpy()] = True
    named, count = label(block.reshape(cells.grid.shape), np.ones((3, 3, 3)))
    of = torch.from_numpy(named.reshape(-1)[cells.index[where].numpy()])
    return [where[of == n] for n in range(1, count + 1)]


def _assigned(
    cloud: GaussianCloud, rows: Tensor, cells: _Cells, foreign: Tensor, centers: Tensor, *, black: bool
) -> Materials:
    """A Gaussian in the cells of a part belongs to it unless its own hue is plainly the main one, one beside them only
    if its hue is plainly the part's; those of a black part have to be dark themselves."""
    numbers = sorted({int(n) for n in foreign.tolist() if n > 0})
    of_cell = torch.zeros(cells.grid.size, dtype=torch.int64)
    beside_cell = torch.zeros_like(of_cell)
    for new, old in enumerate(numbers, start=1):
        of_cell[cells.index[foreign == old]] = new
        beside_cell[cells.grid.smoothed((of_cell == new).float()[:, None])[:, 0] > 1e-6] = new
    where = cells.grid.cell_of(cloud.means[rows])
    inside = of_cell[where]
    part = torch.where(inside > 0, inside, beside_cell[where])
    asked = part.nonzero().squeeze(1)
    lab = rgb_to_lab(dc_to_color(cloud.sh[rows[asked], 0]).clamp(0, 1)).double()
    hue = hue_at(lab, cells.level)
    own = torch.stack([centers[0], *(centers[n] for n in numbers)])[part[asked]]
    to_main, to_part = (torch.linalg.vector_norm(hue - center, dim=1) for center in (centers[0], own))
    unclear = (lab[:, 0] < _DARK) & (inside[asked] > 0)
    plain = torch.where(inside[asked] > 0, (to_part < to_main) | (to_main > _FAR / 2), to_part < 0.7 * to_main)
    if black and numbers[-1] == len(centers) - 1:
        dark = (lab[:, 0] < _BLACK + 8) & (inside[asked] > 0)
        plain = torch.where(part[asked] == len(numbers), dark, plain)
    part[asked] = torch.where(unclear | plain, part[asked], 0)
    shares = tuple((_name(cells, foreign == n), float(cells.area[foreign == n].sum())) for n in numbers)
    return Materials(part, shares)


def _name(cells: _Cells, part: Tensor) -> str:
    """The colour of the lit cells of a part in words."""
    return name_of(lit_of(cells.area[part] / cells.area[part].sum(), cells.lab[part]))
