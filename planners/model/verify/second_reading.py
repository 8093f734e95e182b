"""Compares a model's plan with what the grammar reads in the same instruction, where the scene has what that names.

Both plans are resolved on the scene graph, and each becomes a set of effects: what is done, to which thing, with which
values. Where the words leave an amount open ("a bit bigger"), amounts of the same sense agree.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ....gaussians.color import BASIC, FAMILIES, ciede2000, plain_color, rgb_to_lab, shade_of
from ....gaussians.errors import UserError
from ....gaussians.world import kinds
from ....tools.operation import EditOp
from ...impossible import Step
from ...rooms.graph_scene import Id
from ...rooms.label_encoder import THRESHOLD, agreement

_NEAR_COLOR = 12.0  # ΔE 2000 between two words for what a person would call the same colour
_CLOSE = 0.02  # relative difference of numbers that are said and converted
_OPEN_VALUE = 0.35  # difference of opacities that words such as "see-through" leave open
_ADDING = ("insert", "duplicate")
_AT = frozenset({"on", "next_to", "inside", "against"})  # what "move it to the shelf" leaves open


@dataclass(frozen=True)
class Given:
    """What the words give and leave open.

    Attributes:
        amount: whether a number is said.
        length: whether a length is said.
        open_place: whether nothing says how something is to stand where it goes to.
    """

    amount: bool
    length: bool
    open_place: bool


@dataclass(frozen=True)
class Effect:
    """What one step does to one thing.

    Attributes:
        op: the operation.
        thing: the id of the thing, or the name of what is added.
        step: the step that does it.
    """

    op: str
    thing: Id
    step: Step


def effects(steps: Sequence[Step]) -> tuple[Effect, ...]:
    """The effects of resolved steps. A selection has none beside another step."""
    found: list[Effect] = []
    alone = all(step.op.op == "select" for step in steps)
    for step in steps:
        name = step.op.op
        if name == "insert":
            found.append(Effect("insert", str(getattr(step.op, "asset", "")), step))
        elif name != "select" or alone:
            found += [Effect(name, thing, step) for thing in step.targets]
    return tuple(found)


def unlike(
    planned: Sequence[Step], read: Sequence[Step], given: Given, labels: dict[Id, str]
) -> tuple[list[Effect], list[Effect]]:
    """The effects of a plan that are none of a reading, and those of the reading that the plan lacks."""
    ours, theirs = list(effects(planned)), list(effects(read))
    extra: list[Effect] = []
    for one in ours:
        match = next((other for other in theirs if _same(one, other, given, labels)), None)
        if match is None:
            extra.append(one)
        else:
            theirs.remove(match)
    return extra, theirs


def _same(one: Effect, other: Effect, given: Given, labels: dict[Id, str]) -> bool:
    if one.op != other.op:
        return _both_add(one, other, labels)
    if one.op == "insert":
        return _same_kind(str(one.thing), str(other.thing)) and _same_values(one.step, other.step, given)
    return one.thing == other.thing and _same_values(one.step, other.step, given)


def _both_add(one: Effect, other: Effect, labels: dict[Id, str]) -> bool:
    """Whether one copies a thing and the other adds one of its kind, in the same number."""
    if {one.op, other.op} != set(_ADDING):
        return False
    names = [labels.get(e.thing, str(e.thing)) for e in (one, other)]
    counts = [getattr(e.step.op, "count", 1) for e in (one, other)]
    return _same_kind(*names) and counts[0] == counts[1]


def _same_kind(one: str, other: str) -> bool:
    """Whether two names may mean the same kind of thing."""
    if one.lower() == other.lower() or (kinds.find(one) is not None and kinds.find(one) == kinds.find(other)):
        return True
    return max(*agreement(one, [other]), *agreement(other, [one])) >= THRESHOLD


def _same_values(one: Step, other: Step, given: Given) -> bool:
    return all(agrees for agrees in _compared(one, other, given))


def _compared(one: Step, other: Step, given: Given) -> Iterator[bool]:
    """For each value, whether two steps of the same operation agree on it."""
    for name in ("direction", "adjust", "axis", "on_it", "material"):
        yield getattr(one.op, name, None) == getattr(other.op, name, None)
    yield _same_color(one.op, other.op)
    yield getattr(one.op, "count", 1) == getattr(other.op, "count", 1)
    asset, wanted = getattr(one.op, "asset", None), getattr(other.op, "asset", None)
    yield asset is None or wanted is None or _same_kind(asset, wanted)
    yield _same_angle(getattr(one.op, "degrees", None), getattr(other.op, "degrees", None))
    yield _same_factor(getattr(one.op, "factor", None), getattr(other.op, "factor", None), given.amount)
    value, due = getattr(one.op, "value", None), getattr(other.op, "value", None)
    yield value is None or due is None or abs(value - due) <= (_CLOSE if given.amount else _OPEN_VALUE)
    yield not given.length or _close(one.metres, other.metres)
    yield _same_place(_where(one), _where(other), given.open_place)


def _same_place(one: tuple[str, frozenset[Id]], other: tuple[str, frozenset[Id]], is_open: bool) -> bool:
    return one == other or (is_open and one[1] == other[1] and {one[0], other[0]} <= _AT)


def _where(step: Step) -> tuple[str, frozenset[Id]]:
    """The relation of a place or a direction, and what it is to; going toward a thing ends next to it."""
    place, toward = getattr(step.op, "place", None), getattr(step.op, "toward", None)
    going = "next_to" if step.op.op == "move" else "toward"
    relation = place.relation if place is not None else going if toward is not None else ""
    return relation, frozenset(step.anchors)


def _same_color(one: EditOp, other: EditOp) -> bool:
    said = [getattr(op, "color", None) for op in (one, other)]
    return said[0] == said[1] or (None not in said and alike(str(said[0]), str(said[1])))


def alike(one: str, other: str) -> bool:
    """Whether two colour words may mean the same colour: the same family, or near each other."""
    families = [FAMILIES.get(plain_color(c), plain_color(c)) for c in (one, other)]
    if families[0] == families[1] or families[0].split()[-1] == families[1].split()[-1]:
        return True
    try:
        import torch

        labs = [rgb_to_lab(torch.tensor(shade_of(c), dtype=torch.float64)) for c in (one, other)]
    except UserError:
        return False
    near = float(ciede2000(labs[0], labs[1])) <= _NEAR_COLOR
    basic = [f for f in families if f in BASIC]
    return near and len(set(basic)) < 2  # navy and black are near, and are two basic colours


def _same_angle(one: float | None, other: float | None) -> bool:
    return one == other or (one is not None and other is not None and math.isclose(one % 360, other % 360, abs_tol=1))


def _same_factor(one: float | None, other: float | None, exact: bool) -> bool:
    if one is None or other is None:
        return one == other or not exact
    return _close(one, other) if exact else (one > 1) == (other > 1)


def _close(one: float | None, other: float | None) -> bool:
    return one == other or (one is not None and other is not None and math.isclose(one, other, rel_tol=_CLOSE))
