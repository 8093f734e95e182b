"""The operation select: select something without changing the scene."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import torch
from torch import Tensor

from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, at_most


class Select(TargetedOp):
    """Select things without changing the scene, so that the next instruction can say "it" or "them"."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "select all the chairs",
        {"op": "select", "target": {"text": "chair", "pick": "all"}},
    )
    op: Literal["select"] = "select"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        return Outcome(scene)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        same = outcome.scene is before
        return (at_most("scene unchanged", float(not same), 0, "1", "selecting leaves the scene as it is"),)
