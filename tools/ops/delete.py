"""The operation delete: remove the target."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

import torch
from torch import Tensor

from ...gaussians.errors import InstructionError, ScenewrightError
from ...gaussians.language.query.query import FLOATERS, STRONGEST, WEAKEST
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..carried_objects import MAX_NAMED, Stack, stacks_on
from ..checks import count_matches, none_left, supported
from ..cloud_diff import without
from ..field_update import after_removal
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import bodies_of
from ..receipt import Check, report
from ..settling import settle


class Delete(TargetedOp):
    """Remove the target from the scene.

    What stood on it comes down on what is below it; with `on_it` it is removed too, or stays where it is. What is left
    of the whole scene ("everything but the sofa") always stays where it is.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "remove the coffee table",
        {"op": "delete", "target": {"text": "coffee table"}},
    )
    takes_enclosed: ClassVar[bool] = True
    reveals: ClassVar[bool] = True
    op: Literal["delete"] = "delete"
    on_it: Literal["settles", "goes", "stays"] = "settles"
    infill: bool = True  # whether the surfaces that it hid are filled, see `completing`

    def stronger(self, times: float) -> Self | None:
        if self.target.text not in FLOATERS:
            return None
        reach = min(max(self.target.strength * times, WEAKEST), STRONGEST)
        if reach == self.target.strength:
            return None
        return self.model_copy(update={"target": self.target.model_copy(update={"strength": reach})})

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        asked = super().may_change(scene, selection)
        if self._leaves_all():
            return asked
        for stack in _stacks(scene, selection):
            asked |= mask_of(scene.cloud, stack.ids)
        return asked

    def _leaves_all(self) -> bool:
        """Whether everything that is not selected stays where it is."""
        return self.on_it == "stays" or self.target.spatial

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        stacks = [] if self._leaves_all() else _stacks(scene, selection)
        go = mask_of(scene.cloud, selection.ids)
        notes: tuple[str, ...] = ()
        if self.on_it == "goes":
            for stack in stacks:
                go |= mask_of(scene.cloud, stack.ids)
            names = ", ".join(stack.label or "something" for stack in stacks[:MAX_NAMED])
            notes = (f"what stood on it was removed too: {names}",) if stacks else ()
        removed = scene.cloud.ids[go]
        if len(removed) == len(scene.cloud):
            raise InstructionError(
                "that would leave no Gaussian: say what to keep, or delete all objects to keep the room"
            )
        cloud = without(scene.cloud, go)
        after = scene.replace(cloud=cloud, language=after_removal(scene, cloud, removed.sort().values))
        if self.on_it != "settles" or not stacks:
            return Outcome(after, removed=removed, notes=notes)
        after, moved, note = settle(after, stacks)
        touched = [after.cloud.ids[m.rows] for m in moved]
        ids = torch.cat(touched).sort().values if touched else removed[:0]
        return Outcome(after, removed=removed, touched=ids, moved=moved, notes=(note,) if note else ())

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [none_left(outcome.scene, outcome), count_matches(before, outcome.scene, outcome)]
        if (stands := supported(outcome.scene, outcome.moved)) is not None:
            checks.append(stands)
        if (self.target.text or self.target.colors) and not self.target.spatial:
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


def _stacks(scene: Scene, selection: Selection) -> list[Stack]:
    """What stands on the target and is not part of it."""
    found = [stack for body in bodies_of(scene, selection) for stack in stacks_on(scene, body)]
    go = mask_of(scene.cloud, selection.ids)
    return [stack for stack in found if not bool((go & mask_of(scene.cloud, stack.foot)).any())]
