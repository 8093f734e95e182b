"""The operation orbit: let the target go round another thing."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.motion import Track
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, nonzero
from ..carried_objects import rows_with_carried
from ..checks import count_matches
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import Body, bodies_of, told_length
from ..receipt import Check, at_most
from ..timing.added import Start, with_movement
from ..timing.circling import Circling
from ..timing.spans import Span, length_of

_MOST = 100.0  # rounds
_ROUND = 4.0  # seconds of one round, where nothing is said
_LEAST = 0.05  # metres from the middle of what it goes round


class Orbit(TargetedOp):
    """Let the target go round another thing in a circle, as far from it as it is, and turn with its way. Where that
    goes through other things, it first goes straight to a circle that fits between them.

    `turns` is how many rounds, positive counter-clockwise seen from above; they take the time of `when`, else 4 s each.
    Without `turns` it goes round until the end of the scene. It stays on its level.
    """

    model_config = ConfigDict(json_schema_extra=either({"turns": NOT_GIVEN}, {"turns": nonzero(_MOST)}))
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "let the toy car drive around the bed once from 1 to 4 s",
        {"op": "orbit", "target": {"text": "toy car"}, "around": {"text": "bed"}, "turns": 1,
         "when": {"start": 1, "stop": 4}},
    )  # fmt: skip
    makes_motion: ClassVar[bool] = True
    op: Literal["orbit"] = "orbit"
    around: Query
    turns: Annotated[float, Field(ge=-_MOST, le=_MOST, allow_inf_nan=False)] | None = None

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.turns == 0:
            raise ValueError("no turn is no orbit")
        return self

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        whole, notes = length_of(scene), list[str]()

        def round_it(start: Start) -> tuple[Track, ...]:
            goal = self._goal(start, context)
            (begin, stop), end = start.span, whole.stop if whole.known else start.span[0] + _ROUND
            turns = self.turns
            if turns is None:
                stop = stop if math.isfinite(stop) else max(end, begin + _ROUND)
                turns = max(round((stop - begin) / _ROUND), 1)
            elif not math.isfinite(stop):
                stop = begin + _ROUND * abs(turns)
            circling = Circling.of(start.scene, start.body, goal, 2 * math.pi * turns)
            tracks, told = _tracks(circling, start, (begin, stop))
            notes.extend(told)
            return tracks

        made = with_movement(scene, selection, self.when, context, round_it)
        return replace(made, notes=(*made.notes, *notes))

    def _goal(self, start: Start, context: Context) -> Body:
        """What it goes round, where that is when it begins."""
        goals = bodies_of(start.scene, context.resolve(start.scene, self.around).require())
        if len(goals) != 1:
            raise InstructionError(f"it can go round one thing only, and {self.around.describe()} is {len(goals)}")
        up = start.scene.frame.up_vector
        way = start.body.center - goals[0].center
        way = way - up * (way @ up)
        if float(np.linalg.norm(way)) * (start.scene.frame.metres_per_unit or 1.0) < _LEAST:
            raise InstructionError(f"it stands in the middle of {self.around.describe()}: let it spin")
        return goals[0]

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        motion = outcome.scene.motion
        assert motion is not None
        own = [t for t in motion.tracks if np.isin(t.ids, outcome.touched.cpu().numpy()).all()]
        rising = max((abs(abs(float(t.axis @ before.frame.up_vector)) - 1) for t in own[-1:] if t.axis is not None),
                     default=0.0)  # fmt: skip
        return count_matches(before, outcome.scene, outcome), at_most(
            "keeps its level", rising, 1e-6, "", f"its circle is tilted by {rising:.2g}"
        )


def _tracks(circling: Circling, start: Start, span: Span) -> tuple[tuple[Track, ...], tuple[str, ...]]:
    """The circle of what goes round in a time, as far from its middle as it is; where that goes through something, a
    straight way to a circle that goes through less, and that. And notes."""
    begin, stop = span
    radius, left = circling.best()
    way, circle = radius - circling.radius, radius * abs(circling.angle)
    tracks, notes = tuple[Track, ...](), list[str]()
    if way:
        there = begin + (stop - begin) * abs(way) / (abs(way) + circle)
        tracks = (Track.slide(start.ids, (begin, there), (0.0, way), circling.out, smooth=False),)
        begin, far = there, told_length(start.scene.frame, radius)
        notes.append(
            f"it goes round at {far} from the middle: where it is, it would go through {_listed(circling.hit())}"
        )
    if left:
        notes.append(f"it goes through {_listed(left)}: no circle fits between what stands around")
    angles = (0.0, circling.angle)
    round_it = Track.hinge(start.ids, (begin, stop), angles, circling.up, circling.middle, smooth=False)
    return (*tracks, round_it), tuple(notes)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(name if name.startswith("the ") else f"the {name}" for name in names)
