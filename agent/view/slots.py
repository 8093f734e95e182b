"""Which Gaussian is in which slot of the page. A change of the scene moves none of those that stay.

N: Gaussians; S: slots; M: some of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.files.formats.morton import morton_order

I64 = NDArray[np.int64]
EMPTY = -1


@dataclass(frozen=True, eq=False)
class Slots:
    """The slots of one state of the scene.

    Attributes:
        ids: `[N]`, `cloud.ids` of the cloud that they hold.
        slot: `[N]`, the slot of each row of the cloud.
        count: S, how many slots there are, empty ones included.
    """

    ids: Tensor
    slot: I64
    count: int

    @classmethod
    def of(cls, cloud: GaussianCloud) -> Self:
        """The slots of a scene that is shown first: along a Morton curve, so that a thing takes few ranges of slots."""
        slot = np.empty(len(cloud), np.int64)
        slot[morton_order(cloud.means.cpu().numpy())] = np.arange(len(cloud))
        return cls(cloud.ids, slot, len(cloud))

    @cached_property
    def rows(self) -> I64:
        """`[S]`, the row of the cloud in each slot, `EMPTY` for none."""
        rows = np.full(self.count, EMPTY, np.int64)
        rows[self.slot] = np.arange(len(self.slot))
        return rows

    def moved_to(self, cloud: GaussianCloud) -> Self:
        """The slots of another state: who stays keeps its slot; who is new takes empty ones first, the lowest first."""
        if cloud.ids is self.ids:
            return self
        before, after = self.ids.cpu().numpy(), cloud.ids.cpu().numpy()
        if np.array_equal(before, after):
            return type(self)(cloud.ids, self.slot, self.count)
        slot = _found(before, self.slot, after)
        new = np.flatnonzero(slot == EMPTY)
        taken = np.zeros(self.count, bool)
        taken[slot[slot != EMPTY]] = True
        free = np.flatnonzero(~taken)[: len(new)]
        added = len(new) - len(free)
        slot[new] = np.concatenate([free, np.arange(self.count, self.count + added)])
        return type(self)(cloud.ids, slot, self.count + added)


def _found(ids: I64, values: I64, asked: I64) -> I64:
    """`[M]`: the value of each asked id, `EMPTY` where it is not among `ids`."""
    if not len(ids):
        return np.full(len(asked), EMPTY, np.int64)
    if not (ids[1:] > ids[:-1]).all():
        order = np.argsort(ids, kind="stable")
        ids, values = ids[order], values[order]
    place = np.minimum(np.searchsorted(ids, asked), len(ids) - 1)
    return np.where(ids[place] == asked, values[place], EMPTY)


def ranges_of(slots: I64, bridged: int = 0) -> I64:
    """`[R, 2]`: ascending slots as ranges, first and count.

    Args:
        bridged: gaps of at most this many slots are taken along.
    """
    if not len(slots):
        return np.zeros((0, 2), np.int64)
    ends = np.flatnonzero(np.diff(slots) > bridged + 1)
    first = slots[np.concatenate([[0], ends + 1])]
    last = slots[np.concatenate([ends, [len(slots) - 1]])]
    return np.stack([first, last - first + 1], axis=1)


def slots_of(ranges: I64) -> I64:
    """`[M]`: the slots of ranges `[R, 2]`, in their order."""
    counts = ranges[:, 1]
    starts = np.repeat(ranges[:, 0] - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    return np.arange(int(counts.sum())) + starts
