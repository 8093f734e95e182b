"""The operation delete: remove the target."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ...gaussians.errors import ScenewrightError
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import count_matches, none_left
from ..field_update import after_removal
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, report


class Delete(TargetedOp):
    """Remove the target from the scene."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "remove the coffee table",
        {"op": "delete", "target": {"text": "coffee table"}},
    )
    op: Literal["delete"] = "delete"

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        go = mask_of(scene.cloud, selection.ids)
        cloud = scene.cloud[~go]
        after = scene.replace(cloud=cloud, language=after_removal(scene, cloud, selection.ids))
        return Outcome(after, removed=scene.cloud.ids[go])

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [none_left(outcome.scene, outcome), count_matches(before, outcome.scene, outcome)]
        if self.target.text or self.target.colors:
            checks.append(self._asked_again(outcome.scene, context))
        return tuple(checks)

    def _asked_again(self, after: Scene, context: Context) -> Check:
        """Reports how many things the same query finds now; there is no bound, as others of the kind may be left."""
        every = self.target.model_copy(update={"pick": "all", "count": None, "ordinal": None})
        try:
            found = context.resolve(after, every)
        except ScenewrightError as error:
            return report("asked again", 0, "things", f"asking again gave: {error}")
        things = len(found.groups) if found.chosen else 0
        return report("asked again", things, "things", f"{every.describe()}: {things} left")
