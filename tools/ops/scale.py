"""The operation scale: make the target larger or smaller."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import reach, solid_points
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, Given, Keywords, either, given
from ..carried_objects import MAX_NAMED, rows_with_carried, stacks_on
from ..checks import count_matches, moved_as_asked, overlap_notes, size_changed, stays_put
from ..cloud_diff import Draft, rows_of
from ..field_update import after_move
from ..operation import Affine, Context, Length, Outcome, TargetedOp
from ..placement.bodies import Array, Body, bodies_of, contact_box, heading, strays_note
from ..receipt import Check, at_most
from ..transform import shift, stretch, stretch_matrix

Side = Literal["height", "width", "depth"]
_SIDES: tuple[Side, ...] = ("height", "width", "depth")


def _alone(name: str, **more: Given | Keywords) -> dict[str, Given | Keywords]:
    """The schema alternative in which `name` is given and the other ways to state a size are not."""
    return {**dict.fromkeys(("factor", *_SIDES), NOT_GIVEN), name: given(), **more}


class Scale(TargetedOp):
    """Make the target larger (factor above 1) or smaller, or give it a `height`, `width` or `depth`; one of the four.

    It stays on its support and on its spot. `axis` stretches one dimension only; without it a length keeps the
    proportions. Width and depth are those of its own box, width the one that runs more across the viewer's sight.
    """

    model_config = ConfigDict(
        json_schema_extra=either(_alone("factor"), *(_alone(s, axis={"enum": ["all", s]}) for s in _SIDES))
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the plant twice as tall",
        {"op": "scale", "target": {"text": "potted plant"}, "factor": 2, "axis": "height"},
    )
    takes_enclosed: ClassVar[bool] = True
    op: Literal["scale"] = "scale"
    factor: Annotated[float, Field(ge=0.01, le=100, allow_inf_nan=False)] | None = None
    axis: Literal["all", "width", "depth", "height"] = "all"
    height: Length | None = None
    width: Length | None = None
    depth: Length | None = None

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        said = [n for n in ("factor", *_SIDES) if getattr(self, n) is not None]
        if len(said) != 1:
            raise ValueError(f"scale needs exactly one of factor, height, width and depth, got {said or 'none'}")
        if said[0] != "factor" and self.axis not in ("all", said[0]):
            raise ValueError(f"a {said[0]} cannot be reached by stretching the {self.axis}")
        return self

    @property
    def length(self) -> tuple[Side, Length] | None:
        """The dimension and its requested length; None if a factor was given."""
        return next(((side, size) for side in _SIDES if (size := getattr(self, side)) is not None), None)

    def stronger(self, times: float) -> Self | None:
        if self.factor is None:
            return None
        return self.model_copy(update={"factor": min(max(self.factor**times, 0.01), 100.0)})

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        across = heading(context.viewer, scene.frame, "right")
        draft, moved = Draft(scene.cloud), []
        bodies, riders = bodies_of(scene, selection), list[Affine]()
        names = list[str]()
        for body in bodies:
            matrix = stretch_matrix(self._axis(body, across), self._factor(scene, body, across))
            foot = body.foot(scene.frame.up_vector)
            offset = foot - matrix @ foot
            stretch(draft, body.rows, matrix, offset)
            moved.append(Affine(body.rows, matrix, offset, body.rows))
            above = _raised(scene, body, moved[-1], selection)
            riders += [asked for asked, _ in above]
            names += [name for _, name in above]
        for rider in riders:
            shift(draft, rider.rows, rider.offset)
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, [*moved, *riders]))
        larger = any(float(np.linalg.det(m.matrix)) > 1 for m in moved)
        notes = overlap_notes(after, {b.group for b in bodies}) if larger else ()
        if self.length is not None:
            notes = (*self.length[1].assumption(scene.frame), *notes)
        touched = torch.unique(cloud.ids[torch.cat([asked.rows for asked in (*moved, *riders)])])
        notes += (f"what stands on it went along: {', '.join(names[:MAX_NAMED])}",) if names else ()
        return Outcome(after, touched=touched, moved=tuple(moved), notes=(*notes, *strays_note(bodies)))

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def _axis(self, body: Body, across: Array) -> Array | None:
        """The box axis along which the body is stretched; None for all."""
        return None if self.axis == "all" else np.array(body.box.axes[_side(body, self.axis, across)])

    def _factor(self, scene: Scene, body: Body, across: Array) -> float:
        """The factor by which this body is scaled. Raises InstructionError if its length would change by more than a
        factor of a hundred."""
        if self.length is None:
            return self.factor or 1.0
        side, length = self.length
        now = body.box.size[_side(body, side, across)]
        factor = length.in_units(scene.frame) / now
        if not 0.01 <= factor <= 100:
            unit = "m" if scene.frame.metres_per_unit is not None else "units"
            told = now * (scene.frame.metres_per_unit or 1.0)
            raise InstructionError(
                f"the {body.label or 'thing'} has a {side} of {told:.3g} {unit}; "
                f"{length.describe()} is more than a hundred times off"
            )
        return factor

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [moved_as_asked(before, outcome.scene, outcome.moved), count_matches(before, outcome.scene, outcome)]
        checks.append(stays_put(before, outcome.scene, outcome.moved))
        checks += [size_changed(before, outcome.scene, body) for body in outcome.moved[:4]]
        if self.length is not None:
            checks.append(self._length_reached(before, outcome, selection, context, *self.length))
        return tuple(checks)

    def _length_reached(
        self, before: Scene, outcome: Outcome, selection: Selection, context: Context, side: str, length: Length
    ) -> Check:
        """The largest difference between the measured and the requested length over all bodies."""
        across = heading(context.viewer, before.frame, "right")
        asked, off = length.in_units(before.frame), 0.0
        for body, moved in zip(bodies_of(before, selection), outcome.moved, strict=True):
            axis = np.array(body.box.axes[_side(body, side, across)])
            low, high = reach(solid_points(outcome.scene.cloud, moved.rows) @ axis)
            off = max(off, abs(high - low - asked))
        # float32 centres: rounding is a few millionths of the coordinates, which may be far larger than the thing.
        bound = 1e-5 * max(1.0, asked, float(outcome.scene.cloud.means.abs().max()))
        return at_most("length", off, bound, "units", f"its {side} is within {off:.2g} units of {asked:.4g}")


def _raised(scene: Scene, body: Body, asked: Affine, selection: Selection) -> list[tuple[Affine, str]]:
    """The map and the name of each thing on a body that is scaled: it keeps its size and stands on the same spot."""
    found, up = list[tuple[Affine, str]](), scene.frame.up_vector
    own = mask_of(scene.cloud, selection.ids)
    for stack in stacks_on(scene, body):
        rows = rows_of(scene.cloud, stack.ids)
        if bool(own[rows].any()):
            continue
        foot = contact_box(solid_points(scene.cloud, rows_of(scene.cloud, stack.foot)), scene.frame)
        stands = np.array(foot.center) - up * (foot.size[2] / 2)
        way = asked.matrix @ stands + asked.offset - stands
        found.append((Affine(rows, np.eye(3), way, rows), stack.label or "something"))
    return found


def _side(body: Body, side: str, across: Array) -> int:
    """Index of the axis of a body's box that is its height, width or depth as the viewer sees it."""
    if side == "height":
        return 2
    first, second = (abs(float(np.array(a) @ across)) for a in body.box.axes[:2])
    return 0 if (first >= second) == (side == "width") else 1
