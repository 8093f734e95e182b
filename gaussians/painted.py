"""What painted Gaussians looked like before, so that painting them again starts from there.

A new pigment compresses the shading of a surface where the display's range asks for it. Painted again and again, a
thing would lose a little shading each time; painted from its first colours, only the last paint counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from .cloud import GaussianCloud
from .kept import Kept
from .rows import copied, rows_of_ids

# The harmonics before any paint, by those after it: a column of a million Gaussians has 192 MB and is there already.
_bare: Kept[Tensor] = Kept(2)


@dataclass(frozen=True, eq=False)
class Painted:
    """Gaussians that were painted, with their harmonics before the first paint and after the last.

    A Gaussian whose harmonics are no longer those of the last paint was changed by something else (turned, relit, given
    a material); it counts as never painted.

    Attributes:
        ids: `[M]` int64, ascending.
        before: `[M, K, 3]` harmonics before the first paint.
        after: `[M, K, 3]` harmonics after the last.
    """

    ids: Tensor
    before: Tensor
    after: Tensor


def unpainted(cloud: GaussianCloud, painted: Painted | None) -> GaussianCloud:
    """The cloud with the harmonics before the first paint, where nothing but paint changed them; the cloud itself where
    nothing is known to be painted."""
    if painted is None or painted.after.shape[1:] != cloud.sh.shape[1:]:  # bands were dropped
        return cloud
    return cloud.replace(sh=_bare.get((cloud.sh, cloud.ids, painted), lambda: _before(cloud, painted)))


def _before(cloud: GaussianCloud, painted: Painted) -> Tensor:
    """The harmonics before the first paint: a column of their own, even where nothing is as it was painted."""
    rows = rows_of_ids(cloud.ids, painted.ids)
    places = torch.searchsorted(painted.ids, cloud.ids[rows])
    still = (cloud.sh[rows] == painted.after[places]).flatten(1).all(dim=1)
    return copied(cloud.sh).index_copy_(0, rows[still], painted.before[places[still]])


def painted_again(painted: Painted | None, bare: GaussianCloud, now: GaussianCloud, rows: Tensor) -> Painted:
    """The record after rows `[P]` of a cloud were painted.

    Args:
        painted: the record before.
        bare: the cloud before the paint, `unpainted`.
        now: the cloud after the paint, with the same rows.
    """
    if painted is not None:
        rows = torch.unique(torch.cat([rows, rows_of_ids(now.ids, painted.ids)]))
    order = now.ids[rows].argsort()
    rows = rows[order]
    record = Painted(now.ids[rows], bare.sh[rows], now.sh[rows])
    _bare.get((now.sh, now.ids, record), lambda: bare.sh)
    return record
