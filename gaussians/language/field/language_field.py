"""`LanguageField`: a table of groups with one embedding per group instead of one per Gaussian.

A group is a node of a two-level tree. Leaves ("part") own Gaussians through `GaussianCloud.group`; an "object" is the
union of its parts (an object of one part is its own leaf). "structure" is floor, ground, wall or ceiling.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from ...camera import Vec3
from ...errors import BackendError
from ...world.box import Box, Boxes
from .making import Making

Level = Literal["object", "part", "structure"]
NamedBy = Literal["", "sight", "caption", "user"]
Rest = Literal["", "floor", "surface", "wall", "ceiling"]
Names = tuple[tuple[str, float], ...]

MAX_NAMES = 5  # names that a group keeps


@dataclass(frozen=True)
class Group:
    """One group: a row of the table.

    Attributes:
        id: index into the field's embeddings; leaves appear in `GaussianCloud.group`.
        level: "object", "part" or "structure".
        parent: id of the object a part belongs to, or -1.
        label: the most probable name from all sources, "" if there is none.
        label_score: its calibrated probability, in [0, 1].
        box: robust extent of its Gaussians.
        lab: colour of its lit faces in CIE Lab, see `measure.lit_lab`.
        count: number of its Gaussians.
        views: number of the views that see it.
        confidence: share of its Gaussians that are surface points, in [0, 1]; the others joined it by distance.
        named_by: who gave it its name later: "sight" (a vision model that was asked which thing a phrase means) or
            "caption" (one that named all things), or "user"; "" for names by the encoder or the masks.
        names: the most probable names with their probabilities, highest first; the first is the label and its score.
            Left out, or where the label is replaced alone, they are just the label.
        votes: what detectors called it, highest first: each label with the number of views that gave it, weighted by
            their scores. The label "" counts the views that saw it and gave it no name.
        rests: what it rests on or hangs from, "" where that is not known.
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
    named_by: NamedBy = ""
    names: Names = ()
    votes: Names = ()
    rests: Rest = ""

    def __post_init__(self) -> None:
        first = (self.label, self.label_score)
        if self.names[:1] != (first,):
            object.__setattr__(self, "names", (first,) if self.label else ())

    @property
    def inserted(self) -> bool:
        """Whether it was put into the scene under its name: it is named surely, though no view has shown it."""
        return self.level == "object" and self.views == 0 and self.label_score == 1.0 and bool(self.label)


@dataclass(frozen=True, eq=False)
class LanguageField:
    """The table of groups and what queries need.

    Attributes:
        groups: rows, `groups[i].id == i`.
        embeddings: `[G, D]` float32, unit rows; zero rows for groups that were not encoded.
        encoder: fingerprint of the encoder of the embeddings; a query with another encoder raises.
        notes: remarks on the result of `embed` ("3 % of the Gaussians are seen from no view").
        making: what the field was made with; None for tables that `embed` did not make.
    """

    groups: tuple[Group, ...]
    embeddings: NDArray[np.float32]
    encoder: str
    notes: tuple[str, ...] = field(default=())
    making: Making | None = None

    def __post_init__(self) -> None:
        if [g.id for g in self.groups] != list(range(len(self.groups))) or len(self.embeddings) != len(self.groups):
            raise BackendError("the language field's table is inconsistent; embed the scene again")

    def objects(self) -> tuple[Group, ...]:
        """The rows of level "object"."""
        return tuple(g for g in self.groups if g.level == "object")

    def leaves(self, group: int) -> tuple[int, ...]:
        """Ids of `GaussianCloud.group` that belong to a group: its own and those of its parts."""
        return (group, *self.parts.get(group, ()))

    @cached_property
    def parts(self) -> dict[int, tuple[int, ...]]:
        """Ids of the parts of each object that has parts."""
        found: dict[int, list[int]] = {}
        for g in self.groups:
            if g.parent >= 0:
                found.setdefault(g.parent, []).append(g.id)
        return {owner: tuple(ids) for owner, ids in found.items()}

    @cached_property
    def boxes(self) -> Boxes:
        """The boxes of all groups, by id."""
        return Boxes.of([g.box for g in self.groups])

    @cached_property
    def labs(self) -> NDArray[np.float64]:
        """Colours `[G, 3]` of all groups, CIE Lab."""
        return np.array([g.lab for g in self.groups], dtype=np.float64).reshape(-1, 3)

    @cached_property
    def typical_size(self) -> float:
        """Median of the largest extents of the objects, scene units; 1 if there are none."""
        sizes = [max(g.box.size) for g in self.objects() if g.count]
        return float(np.median(sizes)) if sizes else 1.0

    @cached_property
    def middle(self) -> NDArray[np.float64]:
        """Centre `[3]` of the largest floor, else of the bounds of all groups; the origin if there are none."""
        there = [g for g in self.groups if g.count]
        if not there:
            return np.zeros(3)
        if floors := [g for g in there if g.level == "structure" and g.label == "floor"]:
            return np.array(max(floors, key=lambda g: g.box.size[0] * g.box.size[1]).box.center)
        corners = np.concatenate([g.box.corners() for g in there])
        return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)

    @cached_property
    def answers(self) -> dict[tuple[str, ...], NDArray[np.float64]]:
        """A cache of query scores `[G]` that do not depend on the viewer; each new field starts with an empty one."""
        return {}

    @cached_property
    def readings(self) -> dict[tuple[str, ...], tuple[Any, ...]]:
        """A cache of the readings of nouns, see `query/terms.py`; each new field starts with an empty one."""
        return {}

    @cached_property
    def beliefs(self) -> dict[tuple[str, float | None], Any]:
        """A cache of the evidence about names, see `posterior.belief_of`; each new field starts with an empty one."""
        return {}

    def require_encoder(self, fingerprint: str) -> Self:
        """This field, if it was made with the given encoder.

        Raises:
            BackendError: the embeddings are of another encoder and cannot be compared.
        """
        if fingerprint != self.encoder:
            raise BackendError(
                f"this scene was embedded with encoder {self.encoder}, the query uses {fingerprint}; "
                "run `scenewright embed` again or choose the encoder it was made with"
            )
        return self
