"""The operation infill: fill what is missing in, under or behind a thing by continuing the surface around it."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np
import torch
from torch import Tensor

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import count_matches
from ..cloud_diff import joined
from ..field_update import recount
from ..filling.fill import Patch, merged, patches_behind
from ..filling.missing import patches_in
from ..filling.told import filled, notes
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import bodies_of
from ..receipt import Check

_LEVEL = 0.7  # upward part of a normal from which a surface is under a thing


class Infill(TargetedOp):
    """Fill what is missing in a flat surface, or under or behind a thing, from what is around."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "fill the hole in the wall",
        {"op": "infill", "target": {"text": "wall", "pick": "all"}},
    )
    op: Literal["infill"] = "infill"
    where: Literal["in", "under", "behind"] = "in"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        query = self.query()
        if self.where == "in" and query is not None and query.spatial:
            patches = [p for rows in _surfaces(scene) for p in patches_in(scene, rows)]
        else:
            patches = [p for body in bodies_of(scene, selection) for p in self._patches(scene, selection, body.rows)]
        new = merged(scene, patches)
        told = notes(filled(scene, patches))
        if not len(new):
            return Outcome(scene, notes=told or (f"nothing is missing {self.where} it that its surroundings tell",))
        cloud = joined(scene.cloud, None, [new])
        after = scene.replace(cloud=cloud, language=recount(scene.language, cloud))
        return Outcome(after, added=new.ids, notes=told)

    def _patches(self, scene: Scene, selection: Selection, rows: Tensor) -> list[Patch]:
        if self.where == "in":
            return patches_in(scene, rows)
        own = mask_of(scene.cloud, selection.ids)
        found = patches_behind(scene.replace(cloud=scene.cloud[~own]), scene.cloud[rows])
        up = np.array(scene.frame.up)
        found = [p for p in found if p.hole.any()]
        if self.where == "behind":
            return [p for p in found if p.plane is None or p.plane.normal @ up <= _LEVEL]
        return [p for p in found if p.plane is not None and p.plane.normal @ up > _LEVEL]

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        return (count_matches(before, outcome.scene, outcome),)


def _surfaces(scene: Scene) -> list[Tensor]:
    """The Gaussians of each floor and wall; all together where no surfaces are known."""
    groups = () if scene.language is None else scene.language.groups
    found = [(scene.cloud.group == g.id).nonzero().squeeze(1) for g in groups if g.level == "structure"]
    return found or [torch.arange(len(scene.cloud), device=scene.cloud.device)]
