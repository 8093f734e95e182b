"""The operation isolate: keep the target and remove everything else."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from torch import Tensor

from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.query.keeping import without_strays
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import count_matches, none_left
from ..cloud_diff import without
from ..field_update import after_removal
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check


class Isolate(TargetedOp):
    """Keep only the target and remove everything else from the scene, haze around the target included."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "isolate the guitar",
        {"op": "isolate", "target": {"text": "guitar"}},
    )
    takes_enclosed: ClassVar[bool] = True
    op: Literal["isolate"] = "isolate"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return ~mask_of(scene.cloud, self._kept(scene, selection))

    def _kept(self, scene: Scene, selection: Selection) -> Tensor:
        """Ids of what stays: of things all but their strays, of a part of space all."""
        if self.target.spatial:
            return selection.ids
        return without_strays(scene, index_groups(scene.cloud), selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        keep = mask_of(scene.cloud, self._kept(scene, selection))
        cloud, removed = without(scene.cloud, ~keep), scene.cloud.ids[~keep]
        after = scene.replace(cloud=cloud, language=after_removal(scene, cloud, removed))
        strays = len(selection) - int(keep.sum())
        notes = (f"{strays:,} stray Gaussians of what is kept went too: they float apart from it",) if strays else ()
        return Outcome(after, removed=removed, notes=notes)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        return none_left(outcome.scene, outcome), count_matches(before, outcome.scene, outcome)
