"""One edit to judge: the scenes before and after it, the operation, and what its words mean, asked again."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.kept import Kept
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ...gaussians.world.box import Box
from ..cloud_diff import Difference
from ..enclosed import with_enclosed
from ..operation import Context, EditOp
from ..placement.bodies import Body, bodies_of, centimetre, contact_box
from .changes import Changes, changes_between, changes_of

_NO_IDS = torch.zeros(0, dtype=torch.int64)


@dataclass(frozen=True, eq=False)
class Case:
    """An edit to judge.

    Attributes:
        before, after: the scenes. The language field of `after` is not read.
        op: the operation.
        context: viewer, encoder and "it" as the operation had them.
        chosen: what a repair took the words to mean; None: they are asked again.
        crowded: whether the operation told that a new thing touches what stands around it.
        known: how the clouds differ row by row; None: they are compared by ids.
        motions: by rows, see `standing.rigid_motion`.
    """

    before: Scene
    after: Scene
    op: EditOp
    context: Context
    chosen: Selection | None = None
    crowded: bool = False
    known: Difference | None = None
    motions: Kept[Any] = field(default_factory=lambda: Kept(8), repr=False)
    _now: Kept[Tensor] = field(default_factory=lambda: Kept(8), repr=False)
    _boxes: Kept[Box] = field(default_factory=lambda: Kept(8), repr=False)

    @cached_property
    def changes(self) -> Changes:
        before, after = self.before.cloud, self.after.cloud
        return changes_between(before, after) if self.known is None else changes_of(before, after, self.known)

    @cached_property
    def asked(self) -> Selection | None:
        """What the words of the target mean in the scene before, resolved anew; None for operations without one."""
        query = self.op.query()
        return None if query is None else self.context.resolve(self.before, query)

    @cached_property
    def meant(self) -> Selection:
        """What a repair chose, else `asked`, with what it encloses; empty where nothing was found."""
        found = self.chosen if self.chosen is not None else self.asked
        if found is None or not found.chosen:
            return Selection(Query(), "found", _NO_IDS)
        whole = found.shows is not None or not self.op.takes_enclosed or not len(found)
        return found if whole else with_enclosed(self.before, found)

    @cached_property
    def target(self) -> Tensor:
        """`[N]` bool over the cloud before: the Gaussians that the words mean."""
        return mask_of(self.before.cloud, self.meant.ids)

    @cached_property
    def free(self) -> Tensor:
        """`[N]` bool over the cloud before: the Gaussians that may change, with what stands on the target."""
        return self.op.may_change(self.before, self.meant)

    @cached_property
    def bodies(self) -> list[Body]:
        """The things that the words mean, in the scene before."""
        return bodies_of(self.before, self.meant) if len(self.meant) else []

    @cached_property
    def added(self) -> list[Tensor]:
        """Rows of the cloud after of each new thing, `[K]` int64."""
        rows = self.changes.added
        owner = self.after.cloud.group[rows]
        return [rows[owner == g] for g in torch.unique(owner)]

    def now(self, rows: Tensor) -> Tensor:
        """Rows of the cloud after of those rows of the cloud before that are still there."""
        if self.changes.all_stayed:
            return rows
        return self._now.get((rows,), lambda: self._stayed(rows))

    def _stayed(self, rows: Tensor) -> Tensor:
        there = self.changes.row[rows]
        return there[there >= 0]

    def box_after(self, rows: Tensor) -> Box:
        """Upright box of the solid Gaussians of some rows of the cloud after."""
        after = self.after
        return self._boxes.get((rows,), lambda: contact_box(solid_points(after.cloud, rows), after.frame))

    def cm(self, extent: float) -> float:
        """A centimetre in scene units, see `placement.bodies.centimetre`."""
        return centimetre(self.before.frame, extent)


def weight_of(cloud: GaussianCloud, rows: Tensor | None = None) -> Tensor:
    """`[M]` float64 visual weight of Gaussians: opacity times the area of their two largest extents."""
    scales, opacities = (cloud.scales, cloud.opacities) if rows is None else (cloud.scales[rows], cloud.opacities[rows])
    a, b, c = scales.to(torch.float64).unbind(dim=1)
    return torch.maximum(torch.maximum(a * b, b * c), a * c) * opacities.to(torch.float64)
