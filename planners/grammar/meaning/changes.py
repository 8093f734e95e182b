"""Rules for property changes: colour, size, opacity ("redder", "twice as tall", "half transparent").

Each function returns the fields of an operation without its target. The constants say how much "a bit" and "much" are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ....gaussians.language.query.query import Query
from ..parsing import Node, Refusal, tokens, trees
from ..vocabulary.materials import meant

Fields = dict[str, Any]

# Words for a thing with all of its parts, by which a new colour means those of other hues too.
WHOLE = frozenset({"the whole", "the entire", "the whole thing", "all of it", "it all"})
# recolor.amount without a degree, for "a bit", for "much".
AMOUNT: dict[str, float] = {"": 0.5, "little": 0.25, "much": 0.8}
# scale.factor for bigger and smaller: without a degree, for "a bit", for "much".
BIGGER: dict[str, float] = {"": 1.25, "little": 1.1, "much": 1.75}
SMALLER: dict[str, float] = {"": 0.8, "little": 0.9, "much": 0.6}
# Remaining opacity after "more transparent": without a degree, for "a bit", for "much".
CLEARER: dict[str, float] = {"": 0.5, "little": 0.75, "much": 0.25}
TO_A_LENGTH = "say how large it should be, or by which share: 1.2 m tall, 20 % taller"
MEASURED = {"tall": "height", "short": "height", "wide": "width", "narrow": "width", "deep": "depth"}
SIZE_AXES = {"large": "all", "small": "all", "tall": "height", "wide": "width"}


def share_of(node: Node) -> float | None:
    """The percentage or fraction below a node as a number, None if there is none."""
    for inner in trees(node, "share"):
        return float(tokens(inner, "PERCENT", "FRACTION")[0].value)
    return None


def degree_of(node: Node) -> str:
    """The degree below a node: "", "little" or "much"."""
    found = tokens(node, "DEGREE")
    return str(found[0].value) if found else ""


def with_parts(ops: Sequence[Fields], said: Sequence[str]) -> list[Fields]:
    """The operations of a clause, new colours for parts of other hues too if it says so: "paint the whole chair".

    Args:
        said: the words of each tag of the clause.
    """
    if not any(words.lower() in WHOLE for words in said):
        return list(ops)
    return [{**op, "whole": True} if op.get("op") == "recolor" and op.get("color") else op for op in ops]


def hue_of(node: Node) -> str:
    """The colour of a `hue` node."""
    return str(tokens(node, "HUE")[0].value)


def change(node: Node) -> Fields:
    """The operation that a `change` node asks for.

    Raises:
        Refusal: no operation does it.
    """
    return _CHANGES[str(node.data)](node)


def _hue(node: Node) -> Fields:
    return meant(hue_of(trees(node, "hue")[0]))


def _shade(node: Node) -> Fields:
    """A shade of a named colour: "a darker blue" is dark blue."""
    way, color = tokens(node, "LIGHT")[0], tokens(node, "HUE")[0].value
    if way.value not in ("darker", "lighter"):
        raise Refusal("say the colour it should become", way.text)
    return {"op": "recolor", "color": f"{'dark' if way.value == 'darker' else 'light'} {color}"}


def _toward(node: Node) -> Fields:
    if tokens(node, "LESS"):
        raise Refusal("a colour can be added, not taken away; name the colour it should become", "less")
    color = tokens(node, "HUE", "TOWARDHUE")[0].value
    return {"op": "recolor", "adjust": "toward", "color": color, "amount": AMOUNT[degree_of(node)]}


def adjusted(kind: str, degree: str, share: float | None) -> Fields:
    """A relative change of colour."""
    amount = AMOUNT[degree] if share is None else share
    if not 0 < amount <= 1:
        raise Refusal("a colour changes by more than 0 and at most 100 %", f"{amount:.0%}", verdict="impossible")
    return {"op": "recolor", "adjust": kind, "amount": amount}


def _light(node: Node) -> Fields:
    return adjusted(tokens(node, "LIGHT")[0].value, degree_of(node), share_of(node))


def grown(axis: str, up: bool, share: float | None = None, times: float | None = None, degree: str = "") -> Fields:
    """A relative change of size: "taller", "20 % smaller", "three times wider"."""
    if times is not None:
        factor = times if up else 1 / times if times else 0.0
    elif share is not None:
        factor = (1 + share if up else 1 - share) if share > 0 else 0.0
    else:
        factor = (BIGGER if up else SMALLER)[degree]
    return scaled(factor, axis)


def scaled(factor: float, axis: str = "all") -> Fields:
    """A scale operation.

    Raises:
        Refusal: the factor is not from 0.01 to 100.
    """
    if not 0.01 <= factor <= 100:
        raise Refusal("things are scaled by 0.01 to 100 times", f"{factor:g}", verdict="impossible")
    return {"op": "scale", "factor": round(factor, 9), **({} if axis == "all" else {"axis": axis})}


def _size(node: Node) -> Fields:
    axis, up = tokens(node, "GROWN")[0].value
    times = tokens(node, "TIMES")
    return grown(axis, up, share_of(node), times[0].value if times else None, degree_of(node))


def _relative(node: Node) -> Fields:
    said = " ".join(t.text for t in tokens(node, "LENGTH", "GROWN"))
    raise Refusal(TO_A_LENGTH, said, verdict="impossible")


def measured(node: Node, stretched: bool = False) -> Fields:
    """An absolute size: "80 cm tall", "2 m in width". Proportions are kept unless `stretched`."""
    (inner,) = trees(node, "measured")
    said = tokens(inner, "SIZEWORD", "PROP")[0]
    return sized(tokens(inner, "LENGTH")[0].value, MEASURED.get(said.value, said.value), said.text, stretched)


def sized(value: tuple[float, str], side: str, said: str, stretched: bool = False) -> Fields:
    """A scale operation to a length.

    Raises:
        Refusal: the word names no side, or the length is out of range.
    """
    if side not in ("height", "width", "depth"):
        raise Refusal("say tall, wide or deep", said)
    if not 0 < value[0] <= 10_000:
        raise Refusal("that is not a length for things in a room", f"{value[0]:g}", verdict="impossible")
    length = {"value": value[0], "unit": value[1]}
    return {"op": "scale", side: length, **({"axis": side} if stretched else {})}


def _ratio(node: Node) -> Fields:
    times = tokens(node, "TIMES")
    share = share_of(node)
    factor = float(times[0].value) if times else float(share or 0.0)
    if prop := tokens(node, "PROP"):
        return scaled(factor, prop[0].value)
    word = tokens(node, "SIZEWORD")[0]
    if word.value not in SIZE_AXES:
        raise Refusal("say tall, wide or big", word.text)
    if word.value == "small":
        return scaled(1 / factor if factor else 0.0)
    return scaled(factor, SIZE_AXES[word.value])


def opacity(value: float) -> Fields:
    """An opacity operation.

    Raises:
        Refusal: the value is not from 0 to 1.
    """
    if not 0 <= value <= 1:
        raise Refusal("opacity goes from 0 to 100 %", f"{value:.0%}", verdict="impossible")
    return {"op": "opacity", "value": round(value, 9)}


def _clear(node: Node) -> Fields:
    left = float(tokens(node, "CLEARLY")[0].value)
    share = share_of(node)
    if share is not None:
        return opacity(1 - share)
    if tokens(node, "MORE"):
        return opacity(CLEARER[degree_of(node)])
    return opacity(left if not degree_of(node) or left == 0 else CLEARER[degree_of(node)])


def _opaque(node: Node) -> Fields:
    share = share_of(node)
    if share is None:
        raise Refusal("what was made transparent comes back with undo", "opaque", verdict="impossible")
    return opacity(share)


def _less_clear(node: Node) -> Fields:
    if tokens(node, "CLEARLY"):
        raise Refusal("what was made transparent comes back with undo", "less transparent", verdict="impossible")
    share = share_of(node)
    return opacity(CLEARER[degree_of(node)] if share is None else 1 - share)


def _more_opaque(_node: Node) -> Fields:
    raise Refusal("what was made transparent comes back with undo", "more opaque", verdict="impossible")


def _upside(_node: Node) -> Fields:
    return {"op": "rotate", "degrees": 180.0, "axis": "forward"}


# How far "a bit more" and "much more" move.
FURTHER: dict[str, Fields] = {"little": {"value": 20, "unit": "cm"}, "much": {"value": 1, "unit": "m"}}


def repeated(op: Fields, degree: str) -> Fields:
    """An operation that goes further in the way of one before, by `degree`.

    Raises:
        Refusal: it has no "more": a colour by name, a place, a removal.
    """
    again = {**op, "target": Query(last=True)}
    kind = op.get("op")
    if kind == "move" and op.get("direction"):
        amount = FURTHER.get(degree) or op.get("distance")
        return {**again, **({"distance": amount} if amount else {})}
    if kind == "scale" and op.get("factor"):
        grows = float(op["factor"]) > 1
        return {**again, "factor": (BIGGER if grows else SMALLER)[degree] if degree else op["factor"]}
    if kind == "recolor" and op.get("adjust"):
        return {**again, "amount": AMOUNT[degree]}
    if kind == "rotate" and op.get("degrees") is not None and op.get("axis", "up") == "up" and not op.get("toward"):
        turn = 15.0 if degree == "little" else abs(float(op["degrees"]))
        return {**again, "degrees": turn if float(op["degrees"]) > 0 else -turn}
    raise Refusal("say what more: which way, or how it should become", "more")


def repeated_by(op: Fields, kind: str, amount: Any) -> Fields:
    """An operation that goes further in the way of one before, by a stated amount; a bare number is in its unit.

    Raises:
        Refusal: it has no such amount.
    """
    again = {**op, "target": Query(last=True)}
    if op.get("op") == "move" and op.get("direction") and kind in ("LENGTH", "NUMBER"):
        before = op.get("distance") or {}
        value, unit = amount if kind == "LENGTH" else (amount, before.get("unit"))
        if unit is not None:
            return {**again, "distance": {"value": value, "unit": unit}}
    turns = op.get("op") == "rotate" and op.get("degrees") is not None and not op.get("toward")
    if turns and kind in ("ANGLE", "NUMBER"):
        return {**again, "degrees": abs(float(amount)) * (1 if float(op["degrees"]) > 0 else -1)}
    if op.get("op") == "scale" and op.get("factor") and kind == "FRACTION":
        factor = 1 + float(amount) if float(op["factor"]) > 1 else 1 - float(amount)
        return {**again, **scaled(factor, op.get("axis", "all"))}
    if op.get("op") == "recolor" and op.get("adjust") and kind == "FRACTION":
        return {**again, "amount": float(amount)}
    raise Refusal("say what more: which way, or how it should become", "more")


_CHANGES: dict[str, Callable[[Node], Fields]] = {
    "become_hue": _hue,
    "toward_hue": _toward,
    "become_shade": _shade,
    "become_light": _light,
    "become_size": _size,
    "relative_size": _relative,
    "absolute_size": measured,
    "ratio_size": _ratio,
    "become_clear": _clear,
    "become_opaque": _opaque,
    "become_less_clear": _less_clear,
    "become_more_opaque": _more_opaque,
    "become_upside": _upside,
}
