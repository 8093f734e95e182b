"""The operation opacity: make the target more transparent, or hide it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import torch
from pydantic import Field

from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..checks import count_matches
from ..cloud_diff import Draft, rows_of
from ..field_update import with_measures
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, at_most

HIDDEN = 1e-6  # opacity lies in (0, 1); this is invisible on any display and can be stored as a logit in a file


class Opacity(TargetedOp):
    """Make the target more transparent: `value` multiplies its opacity; 0.5 is half as opaque as now, 0 hides it."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the curtain half transparent",
        {"op": "opacity", "target": {"text": "curtain"}, "value": 0.5},
    )
    op: Literal["opacity"] = "opacity"
    value: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]

    def stronger(self, times: float) -> Self | None:
        return self.model_copy(update={"value": self.value**times}) if 0 < self.value < 1 else None

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        draft = Draft(scene.cloud)
        draft.map("opacities", rows_of(scene.cloud, selection.ids), lambda o: (o * self.value).clamp(min=HIDDEN))
        after = scene.replace(cloud=draft.done())
        return Outcome(after.replace(language=with_measures(after, selection.ids)), touched=selection.ids)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        was = before.cloud.opacities[rows_of(before.cloud, selection.ids)].to(torch.float64)
        now = outcome.scene.cloud.opacities[rows_of(outcome.scene.cloud, selection.ids)].to(torch.float64)
        off = float((now - (was * self.value).clamp(min=HIDDEN)).abs().max()) if len(was) else 0.0
        said = f"mean opacity went from {float(was.mean()):.3f} to {float(now.mean()):.3f}"
        # The bound is one float32 rounding of a number below one.
        return at_most("opacity", off, 1e-7, "1", said), count_matches(before, outcome.scene, outcome)
