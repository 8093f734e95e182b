"""The operation merge: several things become one thing, whose parts they are."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import torch
from pydantic import Field
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.field.language_field import LanguageField
from ...gaussians.language.field.naming import joined
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..cloud_diff import selection_of
from ..field_update import rows_in
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, at_most


class Merge(TargetedOp):
    """Treat several things as one thing from now on ("the pot and the plant are one thing"). No Gaussian changes.

    The things become parts of the new one. `name` is its name; without it, the name of the largest of them.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "the pot and the plant are one thing",
        {"op": "merge", "target": {"text": "pot", "also": [{"text": "plant"}]}},
    )
    op: Literal["merge"] = "merge"
    name: Annotated[str, Field(min_length=1, max_length=60)] | None = None

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        field = scene.language
        if field is None:
            raise InstructionError("things can be merged in an embedded scene only: embed it first")
        pieces = self._pieces(field, selection)
        largest = max(pieces, key=lambda i: (field.groups[i].count, -i))
        after, whole = joined(scene, pieces, self.name or field.groups[largest].label, "user")
        assert after.language is not None
        ids = scene.cloud.ids[rows_in(scene.cloud, after.language, whole)]
        reason = f"{len(pieces)} things are one now"
        return Outcome(after, focus=selection_of(selection, ids, (whole,), reason))

    def _pieces(self, field: LanguageField, selection: Selection) -> list[int]:
        """The groups to merge. Raises InstructionError for one thing, floor, walls or loose Gaussians."""
        pieces = list(dict.fromkeys(selection.groups))
        if any(field.groups[i].level == "structure" for i in pieces):
            raise InstructionError("floor, walls and ceiling cannot be merged with things")
        if len(pieces) < 2:
            raise InstructionError(
                f"merging takes two things or more; {selection.query.describe()} means one. Name each of them"
            )
        return pieces

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        field = outcome.scene.language
        assert field is not None and outcome.focus is not None
        held = rows_in(outcome.scene.cloud, field, outcome.focus.groups[0])
        asked = selection.mask(before.cloud)
        got = torch.zeros_like(asked)
        got[held] = True
        off = int((asked != got).sum())
        return (at_most("one thing", off, 0, "Gaussians", f"the new thing has {len(held):,} Gaussians, all of both"),)
