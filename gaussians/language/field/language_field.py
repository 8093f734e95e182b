"""The language field: a table of groups, never a vector per Gaussian.

A group is a node of a two-level tree. Leaves ("part") own Gaussians through `GaussianCloud.group`; an "object" is the
union of its parts (an object of one part is its own leaf). "structure" is floor, ground, wall or ceiling.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from ...camera import Vec3
from ...errors import BackendError
from ...world.box import Box, Boxes

Level = Literal["object", "part", "structure"]


@dataclass(frozen=True)
class Group:
    """One row of the table.

    Attributes:
        id: index into the field's embeddings; leaves appear in `GaussianCloud.group`.
        level: "object", "part" or "structure".
        parent: id of the object a part belongs to, or -1.
        label: the name the encoder gives it, "" if it has none it is sure of.
        label_score: calibrated probability of that name, in [0, 1].
        box: robust extent of its Gaussians.
        lab: measured colour of its lit faces in CIE Lab, see `measure.lit_lab`.
        count: Gaussians in it.
        views: how many of the embedding views saw it.
        confidence: share of its Gaussians that lie on its skin; the others joined it by being near, in [0, 1].
    """

    id: int
    level: Level
    parent: int
    label: str
    label_score: float
    box: Box
    lab: Vec3
    count: int
    views: int
    confidence: float


@dataclass(frozen=True, eq=False)
class LanguageField:
    """The table and what is needed to ask it.

    Attributes:
        groups: rows, `groups[i].id == i`.
        embeddings: `[G, D]` float32, unit rows (zero rows for groups that were never encoded).
        encoder: fingerprint of the encoder that made the embeddings; a query with another one raises.
        notes: what the embedding left out, in sentences ("3 % of the Gaussians are seen from no view").
    """

    groups: tuple[Group, ...]
    embeddings: NDArray[np.float32]
    encoder: str
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        if [g.id for g in self.groups] != list(range(len(self.groups))) or len(self.embeddings) != len(self.groups):
            raise BackendError("the language field's table is inconsistent; embed the scene again")

    def objects(self) -> tuple[Group, ...]:
        """The rows that a person would count as things."""
        return tuple(g for g in self.groups if g.level == "object")

    def leaves(self, group: int) -> tuple[int, ...]:
        """Ids under which the Gaussians of a group are filed in the cloud: itself and its parts."""
        return (group, *self.parts.get(group, ()))

    @cached_property
    def parts(self) -> dict[int, tuple[int, ...]]:
        """Ids of the parts of each object that has some."""
        found: dict[int, list[int]] = {}
        for g in self.groups:
            if g.parent >= 0:
                found.setdefault(g.parent, []).append(g.id)
        return {owner: tuple(ids) for owner, ids in found.items()}

    @cached_property
    def boxes(self) -> Boxes:
        """Every group's box, by id."""
        return Boxes.of([g.box for g in self.groups])

    @cached_property
    def labs(self) -> NDArray[np.float64]:
        """`[G, 3]` every group's measured colour, CIE Lab."""
        return np.array([g.lab for g in self.groups], dtype=np.float64).reshape(-1, 3)

    @cached_property
    def typical_size(self) -> float:
        """Median of the objects' largest extents, scene units; 1 where there are none."""
        sizes = [max(g.box.size) for g in self.objects() if g.count]
        return float(np.median(sizes)) if sizes else 1.0

    @cached_property
    def middle(self) -> NDArray[np.float64]:
        """`[3]` centre of the largest floor, else of the extent of all groups; the origin where there are none."""
        there = [g for g in self.groups if g.count]
        if not there:
            return np.zeros(3)
        if floors := [g for g in there if g.level == "structure" and g.label == "floor"]:
            return np.array(max(floors, key=lambda g: g.box.size[0] * g.box.size[1]).box.center)
        corners = np.concatenate([g.box.corners() for g in there])
        return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)

    @cached_property
    def answers(self) -> dict[tuple[str, ...], NDArray[np.float64]]:
        """Where a query may keep what does not depend on the viewer, `[G]` values a key; an edit starts a new table."""
        return {}

    def require_encoder(self, fingerprint: str) -> Self:
        """Itself, if it was made with this encoder.

        Raises:
            BackendError: the vectors come from another encoder and cannot be compared.
        """
        if fingerprint != self.encoder:
            raise BackendError(
                f"this scene was embedded with encoder {self.encoder}, the query uses {fingerprint}; "
                "run `scenewright embed` again or choose the encoder it was made with"
            )
        return self
