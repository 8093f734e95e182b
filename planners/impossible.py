"""Refuses steps of a plan that sizes or supports make impossible: a sofa in a vase, a table on the mug it carries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ..gaussians.errors import InstructionError
from ..gaussians.language.query.selection import Selection
from ..gaussians.world import kinds
from ..gaussians.world.lengths import in_metres
from ..tools.operation import EditOp, Length
from ..tools.ops.scale import Scale
from ..tools.timing.hinges import opens_as, owner_of_part
from .plan import Verdict
from .rooms.graph_scene import Id, Stage

# Operations that floor, walls and ceiling do not take.
NOT_FOR_STRUCTURE = frozenset({"delete", "move", "rotate", "scale", "duplicate", "replace", "exchange", "arrange"})


class StepRefused(InstructionError):
    """A step of a plan cannot be done; `verdict` says why, `candidates` are ids of things that could be meant."""

    def __init__(self, verdict: Verdict, reason: str, candidates: Sequence[Id] = ()) -> None:
        super().__init__(reason)
        self.verdict: Verdict = verdict
        self.candidates = tuple(candidates)


@dataclass(frozen=True)
class Step:
    """One operation and the nodes it affects.

    Attributes:
        op: the operation as planned.
        targets: ids of the nodes it changes; things that an earlier step adds are "new 1", "new 2", …
        anchors: ids of the nodes that its place or direction refers to.
        metres: its distance or length in metres, None if it gives none.
    """

    op: EditOp
    targets: tuple[Id, ...] = ()
    anchors: tuple[Id, ...] = ()
    metres: float | None = None


def metres(op: EditOp) -> float | None:
    """The distance or length that an operation gives, in metres, the unit of a graph; None if it gives none."""
    said = (getattr(op, name, None) for name in ("distance", "height", "width", "depth"))
    length: Length | None = next((found for found in said if found is not None), None)
    return None if length is None else round(in_metres(length.value, length.unit), 9)


def refuse_impossible(stage: Stage, step: Step, chosen: Selection, anchors: Sequence[Selection]) -> None:
    """Raise if sizes or supports make a step impossible.

    Args:
        stage: the scene before the step.
        step: the step.
        chosen: the things it changes.
        anchors: the things its place or direction refers to.

    Raises:
        StepRefused: they do.
    """
    shell = [g for g in chosen.groups if stage.group(g).level == "structure"]
    if shell and step.op.op in NOT_FOR_STRUCTURE:
        raise StepRefused(
            "impossible", f"the {stage.group(shell[0]).label} stays: {step.op.op} is for things in the room"
        )
    room = stage.graph.room.size
    if step.metres is not None and step.op.op == "move" and step.metres > sum(s * s for s in room) ** 0.5:
        raise StepRefused("impossible", f"{step.metres:g} m leads out of a room of {room[0]:g} x {room[1]:g} m")
    if step.op.op == "scale":
        _refuse_size(stage, step, chosen)
    if step.op.op == "exchange":
        _refuse_exchange(stage, chosen.groups)
    if step.op.op == "articulate":
        _refuse_opening(stage, chosen.groups)
    relation = getattr(getattr(step.op, "place", None), "relation", "")
    check = {"inside": _too_large_inside, "on": _too_large_on}.get(relation)
    for anchor in (g for a in anchors for g in a.groups):
        for target in chosen.groups:
            _refuse_place(stage, target, anchor, check)


def refuse_above(stage: Stage, step: Step, chosen: Selection | None) -> None:
    """Raise if a thing that neither hangs nor is mounted on a wall is to be placed above another."""
    if getattr(getattr(step.op, "place", None), "relation", "") != "above":
        return
    groups = () if chosen is None else chosen.groups
    supports = {n.id: n.support for n in stage.graph.nodes}
    named = [(stage.group(g).label, supports.get(stage.ids[g])) for g in groups] or [(step.op.subject(), None)]
    for label, support in named:
        if support not in ("wall", "ceiling") and _usual_support(label) not in ("wall", "ceiling"):
            raise StepRefused("impossible", f"{label} stands and does not hang: say on something, or next to it")


def _usual_support(label: str) -> str:
    """The usual support of things of this name, "" if it is unknown."""
    kind = kinds.of(label)
    return "" if kind is None else kind.support


def _refuse_exchange(stage: Stage, groups: Sequence[int]) -> None:
    """Raise unless there are exactly two things and neither stands on the other."""
    if len(groups) != 2:
        raise StepRefused("impossible", f"exactly two things can change places; this means {len(groups)}")
    for one, other in (groups, groups[::-1]):
        if _stands_on(stage, one, other):
            told = f"{stage.group(one).label} stands on {stage.group(other).label}"
            raise StepRefused("impossible", f"{told}: they cannot change places")


def refuse_part(stage: Stage, step: Step, last: Selection | None) -> None:
    """Raise if what is to open is a part of a thing that is whole in this scene: the door of a refrigerator.

    Args:
        step: a step whose target was not found.
        last: what "it" means.
    """
    query = step.op.query()
    if step.op.op != "articulate" or query is None:
        return
    wholes = [anchor for r in query.relations if r.name == "part_of" for anchor in r.anchors]
    if whole := owner_of_part(query.text):
        wholes.append(query.model_copy(update={"text": whole}))
    for whole_query in wholes:
        found = stage.find(whole_query, last)
        if found.verdict == "found":
            raise _one_piece(stage.group(found.groups[0]).label, stage.names(found.groups))


def _refuse_opening(stage: Stage, groups: Sequence[int]) -> None:
    """Raise if a thing is neither called nor shaped like something that opens."""
    for group in map(stage.group, groups):
        if opens_as(group.label, group.box.size) is None:
            raise _one_piece(group.label, stage.names([group.id]))


def _one_piece(label: str, candidates: Sequence[Id]) -> StepRefused:
    return StepRefused("impossible", f"the {label} is in one piece here: no part of it can be opened", candidates)


def _refuse_size(stage: Stage, step: Step, chosen: Selection) -> None:
    """Raise if a thing would become larger than the room."""
    assert isinstance(step.op, Scale)
    axis, length = step.op.axis, step.op.length
    for group in (stage.group(g) for g in chosen.groups):
        sides = {"height": group.box.size[2:], "width": group.box.size[:2], "depth": group.box.size[:2]}
        factor = step.op.factor or 1.0
        if length is not None:
            factor = in_metres(length[1].value, length[1].unit) / max(sides[length[0]])
        most = max(sides.get(axis, group.box.size)) * factor
        if factor > 1 and most > 2 * max(stage.graph.room.size):
            raise StepRefused(
                "impossible", f"{group.label} would be {most:.3g} m large, and no room of this size holds that"
            )


def _refuse_place(stage: Stage, target: int, anchor: int, check: Callable[[Stage, int, int], bool] | None) -> None:
    name, other = stage.group(target).label, stage.group(anchor).label
    if target == anchor:
        raise StepRefused("impossible", f"{name} cannot be put relative to itself")
    if check is None or stage.group(anchor).level == "structure":
        return
    if _stands_on(stage, anchor, target):
        raise StepRefused("impossible", f"{other} stands on {name}, so {name} cannot go on it")
    if check(stage, target, anchor):
        raise StepRefused("impossible", f"{name} is too large to go on or into {other}")


def _too_large_inside(stage: Stage, target: int, anchor: int) -> bool:
    """Whether a thing's two smaller extents exceed its container's two larger ones; its length may stick out."""
    thing, holder = (sorted(stage.group(g).box.size) for g in (target, anchor))
    return thing[0] > holder[1] or thing[1] > holder[2]


def _too_large_on(stage: Stage, target: int, anchor: int) -> bool:
    """Whether the shorter side of a thing's footprint exceeds twice the longer side of its support's."""
    return min(stage.group(target).box.size[:2]) > 2 * max(stage.group(anchor).box.size[:2])


def _stands_on(stage: Stage, upper: int, lower: int) -> bool:
    """Whether `upper` stands on `lower`, directly or on something that does."""
    supports: dict[Any, Id] = {n.id: n.support for n in stage.graph.nodes}
    at, seen = stage.ids[upper], set[Id]()
    while at in supports and at not in seen:
        seen.add(at)
        at = supports[at]
        if at == stage.ids[lower]:
            return True
    return False
