"""`Selection`, the result of a query: ids of Gaussians, their groups, the score of every term, and a verdict.

"found" and "unconfirmed" select Gaussians. "unconfirmed" says that the name was not confirmed: the selection was chosen
by its colour, or its name is only likely. It must be confirmed before it is edited, see `Query.confirmed`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import torch
from torch import Tensor

from ...camera import Camera, Vec3
from ...cloud import GaussianCloud
from ...errors import AbsentError, AmbiguousError, UnconfirmedError
from ...rows import mask_of_ids
from .query import Query

Verdict = Literal["found", "unconfirmed", "ambiguous", "absent"]


@dataclass(frozen=True)
class Candidate:
    """One possible referent of a query.

    Attributes:
        group: id of its group; -1 for a colour patch or a part that is not in the table.
        label: its label, e.g. "armchair".
        color: nearest basic colour name of its measured colour.
        center: `[3]` of its box, world frame, scene units.
        size: `[3]` extents of its oriented box, scene units: two level sides, then height.
        score: product of the terms, in [0, 1].
        terms: score of each term in [0, 1]: "text", each colour, the size word, each relation.
        ids: `[M]` int64 sorted ids of its Gaussians where they are not just those of its group: of a colour patch.
    """

    group: int
    label: str
    color: str
    center: Vec3
    size: Vec3
    score: float
    terms: dict[str, float] = field(default_factory=dict)
    ids: Tensor | None = field(default=None, compare=False, repr=False)

    def seen_from(self, viewer: Camera) -> str:
        """Where a viewer sees it: "on the left of the view", "outside the view"."""
        ((x, y),), (depth,) = viewer.project(np.array([self.center], dtype=np.float64))
        if depth <= 0 or not (0 <= x < viewer.width and 0 <= y < viewer.height):
            return "outside the view"
        side = ("on the left", "in the middle", "on the right")[min(int(3 * x / viewer.width), 2)]
        return f"{side} of the view"

    @property
    def name(self) -> str:
        """Its colour and label: "white chair"."""
        return f"{self.color} {self.label}"

    def describe(self) -> str:
        """Its name, and the number of its group: "white chair (group 6)"."""
        return self.name if self.group < 0 else f"{self.name} (group {self.group})"


@dataclass(frozen=True, eq=False)
class Selection:
    """The result of a query.

    Attributes:
        query: the resolved query.
        verdict: "found"; "unconfirmed": chosen, but not by a confirmed name; "ambiguous" (see `candidates`); or
            "absent" (`candidates` holds the nearest).
        ids: `[M]` int64 sorted stable ids of the selected Gaussians; empty if ambiguous or absent.
        groups: ids of the selected groups.
        candidates: best first; those selected, those that are ambiguous, or the nearest ones.
        reason: one sentence for the user.
        enclosed: `[K]` int64 sorted, those of `ids` that lie inside what was found; None if there are none.
        shows: share of its picture that would stay as it is without it, as other things of the same colours are there;
            None if nobody looked.
    """

    query: Query
    verdict: Verdict
    ids: Tensor
    groups: tuple[int, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    reason: str = ""
    enclosed: Tensor | None = None
    shows: float | None = None

    def __len__(self) -> int:
        return int(self.ids.shape[0])

    @property
    def chosen(self) -> bool:
        """Whether it selects Gaussians: it is found, or chosen without confirmation."""
        return self.verdict in ("found", "unconfirmed")

    def mask(self, cloud: GaussianCloud) -> Tensor:
        """Whether each row `[N]` of `cloud` is selected; ids that it no longer contains are ignored."""
        return mask_of(cloud, self.ids)

    def noting(self, note: str) -> Selection:
        """The same selection with a further remark in its reason; "" adds nothing."""
        return replace(self, reason="; ".join(r for r in (self.reason, note) if r))

    def require(self) -> Selection:
        """This selection, if the verdict is "found".

        Raises:
            AbsentError: nothing matches; the message names the nearest candidates.
            AmbiguousError: several match; the message lists them.
            UnconfirmedError: something was chosen, but not by a confirmed name; the message says what.
        """
        if self.verdict == "absent":
            raise AbsentError(self.reason or f"{self.query.describe()} is not in this scene")
        if self.verdict == "ambiguous":
            raise AmbiguousError(self.reason or f"{self.query.describe()}: several things match")
        if self.verdict == "unconfirmed":
            raise UnconfirmedError(self.reason or f"{self.query.describe()}: its name is not confirmed")
        return self


def nothing(query: Query, reason: str, candidates: tuple[Candidate, ...] = ()) -> Selection:
    """An empty selection with the verdict "absent"."""
    return Selection(query, "absent", torch.zeros(0, dtype=torch.int64), (), candidates, reason)


def mask_of(cloud: GaussianCloud, ids: Tensor) -> Tensor:
    """Whether each row `[N]` of `cloud` has one of these ids."""
    return mask_of_ids(cloud.ids, ids)
