"""Rules for commands that rotate or resize things, with defaults for turns and sizes without a number.

Factors and shares are parsed in changes.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..parsing import Node, Refusal, tokens, trees
from . import changes, places
from .changes import Fields
from .described import EVERYTHING
from .phrases import Phrases

# ---- turning -------------------------------------------------------------------------------------------------


def rotate(phrases: Phrases, node: Node) -> list[Fields]:
    turns = trees(node, "turning")
    angle, clock, direction = (_only(turns, *kind) for kind in (("ANGLE", "NUMBER"), ("CLOCK",), ("DIR",)))
    about = _only(turns, "AXIS") or "up"
    if about != "up":
        return _about(phrases, node, about, angle, clock)
    if angle is None and (share := _only(turns, "FRACTION")) is not None:
        angle = 360 * share
    if any(tokens(t, "UPSIDE") for t in turns):
        if len(turns) > 1:
            raise Refusal("turning upside down is half a turn; leave the rest out")
        return phrases.targeted(node, "rotate", degrees=180.0, axis="forward")
    if direction is not None and direction not in ("left", "right"):
        raise Refusal("things turn to the left or right, clockwise or counterclockwise")
    if clock is not None and direction is not None:
        raise Refusal("say either clockwise or a side")
    around = any(tokens(t, "AROUND") for t in turns) or bool(tokens(node, "TURNROUND"))
    sign = clock or {"left": 1, "right": -1}.get(direction or "", 1)
    if angle is None and not around and clock is None and direction is None:
        raise Refusal("say by how many degrees, or to the left, or around")
    if _only(turns, "DEGREE") is not None and angle is None:
        angle = _slight(turns)
    # Without a number "turn it to the left" is a quarter turn and "around" half a turn.
    degrees = float(angle) if angle is not None else 180.0 if around else 90.0
    return phrases.targeted(node, "rotate", degrees=sign * degrees)


def _about(phrases: Phrases, node: Node, axis: str, angle: float | None, clock: int | None) -> list[Fields]:
    """A turn about an axis of the file, which only the whole scene takes."""
    if phrases.query(node) != EVERYTHING:
        raise Refusal("things turn about up, or tilt to a side; the whole scene turns about x, y or z", axis)
    degrees = (90.0 if angle is None else float(angle)) * (clock or 1)
    return [{"op": "reframe", "degrees": degrees, "axis": axis}]


def flip(phrases: Phrases, node: Node) -> list[Fields]:
    if tokens(node, "AROUND"):
        return phrases.targeted(node, "rotate", degrees=180.0)
    return phrases.targeted(node, "rotate", degrees=180.0, axis="forward")


def tilt(phrases: Phrases, node: Node) -> list[Fields]:
    turns = trees(node, "turning")
    angle, clock, direction = (_only(turns, *kind) for kind in (("ANGLE",), ("CLOCK",), ("DIR",)))
    if angle is None or (clock is None) == (direction is None):
        raise Refusal("say by how many degrees and which way: tilt it 10 degrees to the left")
    # Clockwise as the viewer sees it is counter-clockwise from the tip of "forward", which points away.
    signs = {"left": ("forward", -1), "right": ("forward", 1), "forward": ("right", -1), "backward": ("right", 1)}
    axis, sign = ("forward", -clock) if clock is not None else signs.get(direction or "", ("", 0))
    if not sign:
        raise Refusal("things tilt left, right, forward or backward")
    return phrases.targeted(node, "rotate", degrees=sign * float(angle), axis=axis)


def turn_to(phrases: Phrases, node: Node) -> list[Fields]:
    """Turn to face something: "turn the armchair toward the window", "make the chairs face away from the table"."""
    goal = places.goal_of(phrases, trees(node, "np")[0]).full()
    away = {"degrees": 180.0} if tokens(node, "FACEAWAY") else {}
    return phrases.targeted(node, "rotate", toward=goal, **away)


# ---- sizing --------------------------------------------------------------------------------------------------


def _factor(node: Node) -> tuple[float | None, float | None, bool, str]:
    """Share, factor, whether "to" precedes it, and degree of a clause's `factor` node."""
    for inner in trees(node, "factor", "degree_factor"):
        times = tokens(inner, "TIMES", "NUMBER")
        value = float(times[0].value) if times else None
        return changes.share_of(inner), value, bool(tokens(inner, "TO")), changes.degree_of(inner)
    return None, None, False, ""


def _side_of(node: Node, axis: str) -> str:
    """The side that a clause's `factor` names behind an amount, else `axis`: "to two thirds of its height"."""
    named = [t.value for inner in trees(node, "factor") for t in tokens(inner, "PROP")]
    return str(named[0]) if named and axis == "all" else axis


def scale(phrases: Phrases, node: Node) -> list[Fields]:
    share, times, to, degree = _factor(node)
    way = [t.value for t in tokens(node, "DIR")]
    if way and way[0] in ("up", "down"):
        return _sized(phrases, node, "all", way[0] == "up", (share, times, to, degree))
    if way or (share is None and times is None):
        raise Refusal("say by how much: by 1.5, to 50 %, up by 20 %")
    factor = times if times is not None else share or 0.0
    return phrases.targeted(node, **changes.scaled(factor, _side_of(node, "all")))


def _sized(
    phrases: Phrases, node: Node, axis: str, up: bool, factor: tuple[float | None, float | None, bool, str]
) -> list[Fields]:
    share, times, to, degree = factor
    if to and (share is not None or times is not None):
        return phrases.targeted(node, **changes.scaled(share if share is not None else times or 0.0, axis))
    return phrases.targeted(node, **changes.grown(axis, up, share, times, degree))


def grow(phrases: Phrases, node: Node) -> list[Fields]:
    axis, up = tokens(node, "GROW")[0].value
    if axis == "prop" and trees(node, "factor"):
        axis = "all"
    if axis == "prop":
        raise Refusal("say what of it: its size, its height, its width", tokens(node, "GROW")[0].text)
    return _sized(phrases, node, _side_of(node, axis), up, _factor(node))


def grow_prop(phrases: Phrases, node: Node) -> list[Fields]:
    _, up = tokens(node, "GROW")[0].value
    return _sized(phrases, node, tokens(node, "PROP")[0].value, up, _factor(node))


def measure(phrases: Phrases, node: Node) -> list[Fields]:
    return phrases.targeted(node, **changes.measured(node))


def measure_prop(phrases: Phrases, node: Node) -> list[Fields]:
    side = tokens(node, "PROP")[0]
    return phrases.targeted(node, **changes.sized(tokens(node, "LENGTH")[0].value, side.value, side.text))


def stretch(phrases: Phrases, node: Node) -> list[Fields]:
    """Change one side only, the width by default: "stretch the table to 2 m wide", "stretch it by 20 %"."""
    if trees(node, "measured"):
        return phrases.targeted(node, **changes.measured(node, stretched=True))
    share, times, to, degree = _factor(node)
    return _sized(phrases, node, "width", True, (share, times, to, degree))


def multiply(phrases: Phrases, node: Node) -> list[Fields]:
    prop = tokens(node, "PROP")
    return phrases.targeted(node, **changes.scaled(tokens(node, "MULTIPLY")[0].value, prop[0].value if prop else "all"))


def _only(nodes: Sequence[Node], *types: str) -> Any:
    """The value of the only token of these types below the nodes, None if there is none."""
    found = [t for n in nodes for t in tokens(n, *types)]
    if len(found) > 1:
        raise Refusal("this is given twice in one clause", *(t.text for t in found))
    return found[0].value if found else None


def _slight(turns: Sequence[Node]) -> float:
    """Degrees for "turn it slightly to the left"."""
    if _only(turns, "DEGREE") != "little":
        raise Refusal("say by how many degrees", "much")
    return 15.0


# ---- the whole scene -------------------------------------------------------------------------------------------


def up_axis(phrases: Phrases, node: Node) -> list[Fields]:
    return [{"op": "reframe", "up": tokens(node, "UPAXIS")[0].value}]


def origin(phrases: Phrases, node: Node) -> list[Fields]:
    """ "put the origin on the floor", "put the origin at the table"."""
    where = tokens(node, "ORIGIN")[0].value
    if not trees(node, "np"):
        if where is None:
            raise Refusal("say where to: on the floor, in the middle, at the table", "origin")
        return [{"op": "reframe", "origin": where}]
    if where is not None:
        raise Refusal("say one place for the origin", "origin")
    return [{"op": "reframe", "origin": "floor", "at": places.goal_of(phrases, trees(node, "np")[0]).full()}]


def unit_is(phrases: Phrases, node: Node) -> list[Fields]:
    return [{"op": "reframe", "unit": places.length(tokens(node, "LENGTH")[0].value)}]


def scale_so(phrases: Phrases, node: Node) -> list[Fields]:
    """ "scale the scene so that the table is 75 cm high": its unit is stated by a known length."""
    known = changes.measured(node)
    if "height" not in known:
        raise Refusal("say how tall it is")
    return [{"op": "reframe", "unit": known["height"], "at": phrases.query(node)}]


RULES = (
    up_axis,
    origin,
    unit_is,
    scale_so,
    rotate,
    flip,
    tilt,
    turn_to,
    scale,
    grow,
    grow_prop,
    measure,
    measure_prop,
    stretch,
    multiply,
)
