"""The operation split: one thing becomes several, along the weakest borders inside it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import torch
from pydantic import Field

from ...gaussians.errors import InstructionError
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..cloud_diff import selection_of
from ..field_update import rows_in
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, at_most

MOST = 8  # pieces of one split


class Split(TargetedOp):
    """Treat one thing as several things from now on ("that is two things"). Nothing looks different.

    The thing is divided where its shape and colours say most clearly that two things touch. `names` are names of
    pieces, in any order; each goes to the piece that looks most like it.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "the plant is two things",
        {"op": "split", "target": {"text": "plant"}, "into": 2},
    )
    op: Literal["split"] = "split"
    into: Annotated[int, Field(ge=2, le=MOST)] = 2
    names: Annotated[tuple[Annotated[str, Field(min_length=1, max_length=60)], ...], Field(max_length=MOST)] = ()

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        field = scene.language
        if field is None:
            raise InstructionError("things can be split in an embedded scene only: embed it first")
        if len(selection.groups) != 1:
            raise InstructionError(
                f"one thing is split at a time; {selection.query.describe()} means {len(selection.groups)}"
            )
        if len(self.names) > self.into:
            raise InstructionError(f"{len(self.names)} names are too many for {self.into} pieces")
        seeing = context.encoder if isinstance(context.encoder, Encoder) else None
        from ...gaussians.language.field.dividing import divided

        after, pieces = divided(scene, selection.groups[0], self.into, self.names, seeing)
        reason = f"{len(pieces)} things now"
        focus = selection_of(selection, selection.ids, tuple(pieces), reason)
        assert after.language is not None
        told = ", ".join(f"{after.language.groups[i].label or 'thing'} {i}" for i in pieces)
        return Outcome(after, touched=selection.ids, focus=focus, notes=(f"the pieces are {told}",))

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        field = outcome.scene.language
        assert field is not None and outcome.focus is not None
        times = torch.zeros(len(before.cloud), dtype=torch.int64)
        for piece in outcome.focus.groups:
            times[rows_in(outcome.scene.cloud, field, piece)] += 1
        off = int((times != selection.mask(before.cloud).long()).sum())
        said = f"each of {len(selection):,} Gaussians belongs to one of {len(outcome.focus.groups)} pieces"
        return (at_most("pieces", off, 0, "Gaussians", said),)
