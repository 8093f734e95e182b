"""The operation order: in which order several things move, or that they begin together."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.motion.motion import moving_ids
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..checks import count_matches
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import rows_by_thing
from ..receipt import Check, at_most
from ..timing.retiming import Warp, divided, movement, parted, playing, waving, with_tracks
from ..timing.spans import spans_of

I64 = NDArray[np.int64]
_SAME = 1e-3  # seconds


_UNLISTED = {"first": NOT_GIVEN, "last": NOT_GIVEN}


class Order(TargetedOp):
    """Change the order in which the things that the target means begin to move; how each moves stays.

    "reversed": the last becomes the first ("swap the two", "in the opposite order"); the times at which one of them
    begins stay. "listed": first what `first` names first, and last what `last` names, which begins last of all.
    "together": all begin with the earliest, or at `when`. `gap`:
    seconds from one to the next. What the target means and does not move is left out.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"order": given(enum=["listed"]), "first": given()},
            {"order": given(enum=["listed"]), "last": given()},
            {"order": {"enum": ["reversed"]}, **_UNLISTED},
            {"order": given(enum=["together"]), "gap": NOT_GIVEN, **_UNLISTED},
            {"order": given(enum=["kept"]), "gap": given(), **_UNLISTED},
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "let the books fall in the opposite order",
        {"op": "order", "target": {"text": "book", "pick": "all"}, "order": "reversed"},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["order"] = "order"
    order: Literal["reversed", "listed", "together", "kept"] = "reversed"
    first: Annotated[tuple[Query, ...], Field(min_length=1, max_length=8)] | None = None
    last: Query | None = None
    gap: Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)] | None = None

    @model_validator(mode="after")
    def _listed(self) -> Self:
        if (self.order == "listed") != bool(self.first or self.last):
            raise ValueError('"first" and "last" go with the order "listed", and that needs one of them')
        if (self.order == "together" and self.gap is not None) or (self.order == "kept" and self.gap is None):
            raise ValueError("what begins together has no gap, and what keeps its order needs one")
        return self

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        moving = moving_ids(scene.motion)
        own = moving[np.isin(moving, selection.ids.cpu().numpy())]
        return mask_of(scene.cloud, torch.from_numpy(own))

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        motion = scene.motion
        moving = moving_ids(motion)
        things: list[tuple[int, I64, float]] = []  # group, its moving ids, when it begins
        tracks, _ = divided(motion, moving) if motion is not None else ([], [])
        for group, rows in rows_by_thing(scene, selection):
            ids = np.intersect1d(scene.cloud.ids[rows].cpu().numpy(), moving)
            if motion is None or not len(ids):
                continue
            own = [t for t in tracks if np.isin(t.ids, ids).any()]
            span = movement(own, motion.start, motion.stop, parted(motion.residuals, ids)[0])
            if span is not None:
                things.append((group, ids, span[0]))
        if motion is None or len(things) < 2:
            raise InstructionError(f"an order needs several things that move, and {self.target.describe()} is not that")
        things.sort(key=lambda t: t[2])
        begins = self._begins([t[2] for t in things], scene, selection, context)
        placed = self._placed(things, scene, context)
        end, residuals = motion.stop, list(motion.residuals)
        for (_, ids, was), begin in zip(placed, begins, strict=True):
            tracks, inside = divided(motion.replace(tracks=tuple(tracks)), ids)
            warp = Warp((begin,), (was,), 0.0, 1.0)
            tracks = [playing(t, warp) if own and begin != was else t for t, own in zip(tracks, inside, strict=True)]
            shapes, residuals = parted(residuals, ids)
            shapes = [waving(shape, warp) if begin != was else shape for shape in shapes]
            residuals += shapes
            span = movement([t for t, own in zip(tracks, inside, strict=True) if own], motion.start, 1e4, shapes)
            end = max(end, min(span[1], 1e4) if span is not None else end)
        stop = end if end < 1e4 else motion.stop
        touched = torch.from_numpy(np.unique(np.concatenate([ids for _, ids, _ in placed])))
        notes = (f"the scene lasts {stop:g} s now",) if stop > motion.stop + _SAME else ()
        return Outcome(with_tracks(scene, tracks, stop, tuple(residuals)), touched=touched, notes=notes)

    def _begins(self, was: list[float], scene: Scene, selection: Selection, context: Context) -> list[float]:
        """When the first, second, ... of them begins, seconds."""
        first = was[0]
        if self.when is not None:
            first = max(spans_of(self.when, scene, selection, context, onward=True)[0][0], 0.0)
        if self.order == "together":
            return [first] * len(was)
        if self.gap is not None:
            return [first + i * self.gap for i in range(len(was))]
        return [t + first - was[0] for t in was]

    def _placed(
        self, things: list[tuple[int, I64, float]], scene: Scene, context: Context
    ) -> list[tuple[int, I64, float]]:
        """The things in their new order."""
        if self.order != "listed":
            return things[::-1] if self.order == "reversed" else things
        left, placed = list(things), list[tuple[int, I64, float]]()
        last = () if self.last is None else (self.last,)
        for query in (*(self.first or ()), *last):
            ids = context.resolve(scene, query).require().ids.cpu().numpy()
            found = [t for t in left if np.isin(t[1], ids).any()]
            if len(found) != 1:
                raise InstructionError(f"{query.describe()} is not one of the things whose order changes")
            placed.append(found[0])
            left = [t for t in left if t is not found[0]]
        return [*placed[: len(placed) - len(last)], *left, *placed[len(placed) - len(last) :]]

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        lost = len(moving_ids(before.motion)) - len(moving_ids(outcome.scene.motion))
        said = f"{max(lost, 0)} Gaussians that moved before do not move any more"
        return count_matches(before, outcome.scene, outcome), at_most("still moves", max(lost, 0), 0, "Gaussians", said)
