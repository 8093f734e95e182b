"""The operation shadow: take the contact shadow of a thing away, cast one, or make it darker or lighter."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import torch
from torch import Tensor

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import count_matches
from ..field_update import after_recolor
from ..harmony.carrier import carried
from ..harmony.shadows import Changed, changed_shadow
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import bodies_of
from ..receipt import Check, at_most

_SAID = {"remove": "lighter", "lighter": "lighter", "cast": "darker", "darker": "darker"}


class Shadow(TargetedOp):
    """Change the contact shadow that the target casts on what carries it; the target itself stays as it is.

    `change`: "remove" takes the shadow away, "cast" gives it one, "darker" and "lighter" change the one that it has.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "remove the shadow under the sofa",
        {"op": "shadow", "target": {"text": "sofa"}, "change": "remove"},
    )
    op: Literal["shadow"] = "shadow"
    change: Literal["remove", "cast", "darker", "lighter"] = "remove"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        own = mask_of(scene.cloud, selection.ids)
        may = torch.zeros_like(own)
        for body in bodies_of(scene, selection):
            if (place := carried(scene, body.rows, own)) is not None:
                may[place.rows] = True
        return may

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        things = [body.rows for body in bodies_of(scene, selection)]
        cloud, told = changed_shadow(scene, things, self.change)
        if cloud is scene.cloud:
            return Outcome(scene, notes=(self._nothing(told),))
        ids = scene.cloud.ids[told.rows]
        after = scene.replace(cloud=cloud)
        after = after.replace(language=after_recolor(after, ids))
        said = f"{len(ids):,} Gaussians of what carries it are {_SAID[self.change]} now"
        return Outcome(after, touched=ids.sort().values, notes=(said,), focus=selection)

    def _nothing(self, told: Changed) -> str:
        if not told.carried:
            return "it has no contact shadow: no surface is seen that carries it"
        if self.change == "cast":
            return "it casts a shadow already: say darker to have more of it"
        return "no shadow of it can be told from the pattern of what carries it"

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        own = mask_of(before.cloud, selection.ids)
        changed = int((outcome.scene.cloud.sh[own] != before.cloud.sh[own]).flatten(1).any(dim=1).sum())
        kept = at_most("target unchanged", changed, 0, "Gaussians", f"{changed} Gaussians of the target changed")
        return kept, count_matches(before, outcome.scene, outcome)
