"""scale: make the target larger or smaller."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from ...gaussians.language.selection import Selection
from ...gaussians.scene import Scene
from ..base import Affine, Context, Outcome, TargetedOp
from ..bookkeeping import carried
from ..checks import bumps, carried_as_asked, counted, size_changed
from ..receipt import Check
from ..rows import Draft
from ..shape import stretch, stretch_matrix
from ..space import Array, Body, bodies_of, heading


class Scale(TargetedOp):
    """Make the target larger (factor above 1) or smaller; it stays on its support and on its spot.

    `axis` stretches one dimension only: its width and depth are those of its own box, width the one that runs more
    across the viewer's sight.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the plant twice as tall",
        {"op": "scale", "target": {"text": "potted plant"}, "factor": 2, "axis": "height"},
    )
    op: Literal["scale"] = "scale"
    factor: Annotated[float, Field(ge=0.01, le=100, allow_inf_nan=False)]
    axis: Literal["all", "width", "depth", "height"] = "all"

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        across = heading(context.viewer, scene.frame, "right")
        draft, moved = Draft(scene.cloud), []
        bodies = bodies_of(scene, selection)
        for body in bodies:
            matrix = stretch_matrix(self._axis(body, across), self.factor)
            foot = body.foot(scene.frame.up_vector)
            offset = foot - matrix @ foot
            stretch(draft, body.rows, matrix, offset)
            moved.append(Affine(body.rows, matrix, offset, body.rows))
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=carried(scene, cloud, moved))
        notes = bumps(after, {b.group for b in bodies}) if self.factor > 1 else ()
        return Outcome(after, touched=selection.ids, moved=tuple(moved), notes=notes)

    def _axis(self, body: Body, across: Array) -> Array | None:
        """The box axis that is stretched; None for all."""
        if self.axis == "all":
            return None
        first, second, up = (np.array(a) for a in body.box.axes)
        if self.axis == "height":
            return up
        width_first = abs(float(first @ across)) >= abs(float(second @ across))
        return first if width_first == (self.axis == "width") else second

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [carried_as_asked(before, outcome.scene, outcome.moved), counted(before, outcome.scene, outcome)]
        checks += [size_changed(before, outcome.scene, body) for body in outcome.moved[:4]]
        return tuple(checks)
