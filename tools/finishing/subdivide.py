"""Split flat Gaussians into grids of smaller ones that look the same, so that a finer texture can be shown.

A Gaussian with standard deviations s1 >= s2 >= s3 becomes n1 x n2 children in the plane of its first two axes, spread
over some standard deviations to each side; over fewer if it is dense, as its neighbours on a surface then cover its
rim. The opacities of the children are chosen so that light that passes through all of them at a child's centre loses as
much as it lost in the parent there (optical depths add; a fixed-point iteration finds them). Children that no renderer
would draw are left out.
"""

from __future__ import annotations

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.rotations import to_matrix

_COUNTS = (1, 2, 3, 4, 6, 8, 11, 14)  # of children along an axis: few, so that many are split alike
_REACH, _DENSE_REACH = 2.0, 1.8  # standard deviations to each side over which children are spread; of dense Gaussians
_DENSE = 0.7  # opacity from which a Gaussian is dense
_UNSEEN = 1 / 255  # opacity below which renderers leave a Gaussian out
_OVERLAP = 0.9  # standard deviation of a child in steps from one to the next
_ROUNDS = 12  # of the iteration for opacities
_CLEAREST, _DENSEST = 1e-3, 0.995
_LEVELS = 24  # of opacity, between which the opacities of children are interpolated


def reduction(count: Tensor, reach: float) -> Tensor:
    """Standard deviation of a child relative to its parent's, for so many children along an axis; 1 for one child."""
    step = 2 * reach / count.clamp(min=1)
    return torch.where(count > 1, (_OVERLAP * step).clamp(max=0.9), torch.ones_like(step))


def counts_for(scales: Tensor, opacities: Tensor, wanted: float) -> Tensor:
    """`[M]` int64: how many children along an axis bring standard deviations `[M]` of Gaussians with opacities `[M]`
    down to `wanted`, or as near to it as can be."""
    reach = torch.where(opacities >= _DENSE, _DENSE_REACH, _REACH)
    needed = 2 * reach * _OVERLAP * scales / max(wanted, 1e-12)
    possible = torch.tensor(_COUNTS)
    counts = possible[torch.searchsorted(possible.to(needed), needed.contiguous()).clamp(max=len(_COUNTS) - 1)]
    return torch.where(scales > wanted, counts, 1)


def subdivided(cloud: GaussianCloud, counts: Tensor) -> tuple[GaussianCloud, Tensor]:
    """The children of a cloud's Gaussians.

    Args:
        cloud: M Gaussians.
        counts: `[M, 2]` int64 children along the longest and along the second axis.

    Returns:
        The children, with the ids of their parents, and `[C]` int64 the row of each child's parent.
    """
    order = cloud.scales.argsort(dim=1, descending=True)
    made: list[GaussianCloud] = []
    parents: list[Tensor] = []
    kinds = torch.cat([counts, (cloud.opacities >= _DENSE).to(counts)[:, None]], dim=1)
    for kind in torch.unique(kinds, dim=0).tolist():
        rows = (kinds == torch.tensor(kind)).all(dim=1).nonzero().squeeze(1)
        first, second, dense = kind
        children = _children(cloud[rows], order[rows], (first, second), _DENSE_REACH if dense else _REACH)
        seen = (children.opacities >= _UNSEEN) | (first * second == 1)
        made.append(children[seen])
        parents.append(rows.repeat_interleave(first * second)[seen])
    if not made:
        return cloud, torch.arange(len(cloud))
    parent = torch.cat(parents)
    columns = {name: torch.cat([getattr(c, name) for c in made]) for name, _ in cloud.columns()}
    by_parent = parent.argsort(stable=True)
    return cloud.replace(**columns)[by_parent], parent[by_parent]


def _children(cloud: GaussianCloud, order: Tensor, counts: tuple[int, int], reach: float) -> GaussianCloud:
    """The children of Gaussians that are all split alike, parent by parent."""
    m, each = len(cloud), counts[0] * counts[1]
    offsets = torch.cartesian_prod(*(_places(n, reach) for n in counts)).reshape(each, 2)  # standard deviations
    shrunk = reduction(torch.tensor([float(n) for n in counts]), reach)
    axes = to_matrix(cloud.quats)
    plane = [axes.gather(2, order[:, k, None, None].expand(-1, 3, 1)).squeeze(2) for k in (0, 1)]
    sides = cloud.scales.gather(1, order[:, :2])
    shift = sum(offsets[:, k, None] * (sides[:, k, None] * plane[k])[:, None, :] for k in (0, 1))
    scales = cloud.scales.scatter(1, order[:, :2], sides * shrunk)
    repeated = cloud[torch.arange(m).repeat_interleave(each)]
    return repeated.replace(
        means=(cloud.means[:, None, :] + shift).reshape(-1, 3),
        scales=scales.repeat_interleave(each, dim=0),
        opacities=_opacities(cloud.opacities, offsets, shrunk).reshape(-1),
    )


def _places(count: int, reach: float) -> Tensor:
    """`[count]` places of children along an axis, in standard deviations of their parent."""
    return ((torch.arange(count) + 0.5) / count - 0.5) * (2 * reach) if count > 1 else torch.zeros(1)


def _opacities(parents: Tensor, offsets: Tensor, shrunk: Tensor) -> Tensor:
    """`[M, C]` opacities of children at the same offsets `[C, 2]` of parents with opacities `[M]`: looked up in a table
    over opacities."""
    if len(offsets) == 1:
        return parents[:, None]
    levels = torch.linspace(_CLEAREST, _DENSEST, _LEVELS)
    wanted = -torch.log1p(-levels[:, None] * torch.exp(-0.5 * (offsets**2).sum(dim=1)))
    apart = (offsets[:, None] - offsets[None]) / shrunk
    reach = torch.exp(-0.5 * (apart**2).sum(dim=2))  # [C, C]
    found = 1 - torch.exp(-wanted)
    for _ in range(_ROUNDS):
        depth = -torch.log1p(-found[:, None, :] * reach[None]).sum(dim=2)
        found = (found * wanted / depth.clamp(min=1e-9)).clamp(_CLEAREST, _DENSEST)
    place = (parents.clamp(_CLEAREST, _DENSEST) - _CLEAREST) / (_DENSEST - _CLEAREST) * (_LEVELS - 1)
    below = place.floor().clamp(max=_LEVELS - 2)
    share = (place - below)[:, None]
    low = found[below.long()]
    return low + share * (found[below.long() + 1] - low)
