"""Cases: scenes with their ground truth, their embedding, and queries on them. No answer depends on the truth."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...gaussians import assets
from ...gaussians.assets import Room, TruthObject
from ...gaussians.camera import Camera
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.field.embed import embed
from ...gaussians.language.field.group_table import with_table
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.resolve import resolve
from ...gaussians.language.query.selection import Verdict
from ...gaussians.language.segmentation.segment import VIEWS_PER_CANDIDATE, Segment
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.coverage import Views
from .._iou import Mask, iou
from ..harness import Metric, Point

RIGHT = 0.5  # intersection over union from which an answer counts as right


@dataclass(frozen=True)
class Part:
    """What one measure found: figures, points of the chart, and sentences for the reader."""

    metrics: tuple[Metric, ...] = ()
    points: tuple[Point, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Case:
    """A scene and the truth about it.

    Attributes:
        seed: of the scene.
        scene: without or with its language field.
        ids: `[N]` int32, the true object of each Gaussian, -1 for floor and walls.
        objects: the true objects; `objects[i].id == i`.
        seconds: of the processor that embedding took; 0 before it.
    """

    seed: int
    scene: Scene
    ids: NDArray[np.int32]
    objects: tuple[TruthObject, ...]
    seconds: float = 0.0

    @cached_property
    def points(self) -> NDArray[np.float32]:
        """`[N, 3]` centres of all Gaussians."""
        points: NDArray[np.float32] = self.scene.cloud.means.numpy()
        return points

    @cached_property
    def present(self) -> Counter[str]:
        """How many of each kind there are."""
        return Counter(o.kind for o in self.objects)

    def truth(self, thing: TruthObject) -> Mask:
        """`[N]`, which Gaussians are its own."""
        mask: Mask = self.ids == thing.id
        return mask

    def alone(self) -> tuple[TruthObject, ...]:
        """Objects whose kind the scene holds once."""
        return tuple(o for o in self.objects if self.present[o.kind] == 1)

    def groups(self) -> list[Mask]:
        """The Gaussians of each group that is an object."""
        assert self.scene.language is not None
        group, field = self.scene.cloud.group.numpy(), self.scene.language
        return [np.isin(group, field.leaves(g.id)) for g in field.objects()]

    def best_union(self, truth: Mask) -> float:
        """IoU with a true object of the best union of leaf groups: what any choice of rows of the table could reach.

        In order of the share of a group inside the object, the best union is a prefix.
        """
        group = self.scene.cloud.group.numpy()
        own = group >= 0
        count = np.bincount(group[own], minlength=1)
        inside = np.bincount(group[own & truth], minlength=len(count))
        order = np.argsort(-inside / np.maximum(count, 1), kind="stable")
        within, outside = np.cumsum(inside[order]), np.cumsum((count - inside)[order])
        return float((within / np.maximum(truth.sum() + outside, 1)).max())

    @property
    def field_bytes(self) -> int:
        """What the field holds: one number a Gaussian, and the table's vectors."""
        assert self.scene.language is not None
        return int(self.scene.cloud.group.numpy().nbytes + self.scene.language.embeddings.nbytes)


@dataclass(frozen=True, eq=False)
class Answer:
    """What a query selected `[N]`, and the verdict."""

    mask: Mask
    verdict: Verdict

    def means(self, truth: Mask) -> bool:
        """Whether this is the object that was meant."""
        return self.verdict == "found" and iou(self.mask, truth) >= RIGHT


def case_of(room: Room, seed: int) -> Case:
    """A room as a case, not embedded."""
    return Case(seed, room.scene, room.truth.ids.numpy(), room.truth.objects)


def furnished(seed: int, detail: float = 1.0) -> Case:
    """A furnished room, not embedded."""
    return case_of(assets.furnish(seed, detail=detail), seed)


def embedded(case: Case, encoder: Encoder, views_per_candidate: int = VIEWS_PER_CANDIDATE) -> Case:
    """The case with the field that users get, and the seconds of the processor it took."""
    start = time.process_time()
    scene = embed(case.scene, encoder, views_per_candidate=views_per_candidate)
    return replace(case, scene=scene, seconds=time.process_time() - start)


def with_true_groups(case: Case, encoder: Encoder) -> Case:
    """The case with a field over the true objects: errors that remain are not due to segmentation."""
    things = [Segment((), "object") for _ in case.objects]
    rows = np.arange(len(case.ids))
    unseen = Views((), rows, np.zeros((0, len(rows)), bool), 0.0)
    scene = with_table(case.scene, things, case.ids.astype(np.int32), case.ids >= 0, unseen, encoder)
    return replace(case, scene=scene)


def ask(case: Case, query: Query | str, encoder: Encoder, viewer: Camera | None = None) -> Answer:
    """What a query, or a bare name, selects for someone at `viewer` (the scene's first camera)."""
    asked = Query(text=query) if isinstance(query, str) else query
    selection = resolve(case.scene, asked, viewer or case.scene.cameras[0], encoder)
    return Answer(selection.mask(case.scene.cloud).numpy(), selection.verdict)
