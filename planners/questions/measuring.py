"""Measures of things from their boxes, with words for them and the certainty of comparisons."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .answer import AnswerType
from .reading.measures import Measure, Unit
from .survey import Survey, Thing, listed

EQUAL = 0.05  # of the larger: two measures that differ by less are the same to people
_SURE = 0.1  # of the larger: from this difference on a comparison is certain


def measure(survey: Survey, thing: Thing, what: Measure) -> float:
    """One measure, in metres, square metres ("footprint") or cubic metres ("size", "volume").

    Width and depth are those of its own box, seen from its front; of a thing whose front was looked for and not found,
    the longer side is its width.
    """
    width, depth, height = sides(survey, thing)
    return {
        "width": width,
        "depth": depth,
        "height": height,
        "length": height if height > 2 * max(width, depth) and thing.node and thing.node.support == "wall"
        else max(width, depth),
        "thickness": min(width, depth, height),
        "footprint": width * depth,
        "top": thing.group.box.center[2] + height / 2,
        "size": width * depth * height,
        "volume": width * depth * height,
    }[what]  # fmt: skip


def sides(survey: Survey, thing: Thing) -> tuple[float, float, float]:
    """Width, depth and height, metres."""
    width, depth, height = (float(s) for s in (thing.node.size if thing.node else thing.group.box.size))
    if survey.faces is not None and not survey.has_front(thing):
        width, depth = max(width, depth), min(width, depth)
    return width, depth, height


def same(a: float, b: float) -> bool:
    """Whether two measures are the same to people."""
    return abs(a - b) <= EQUAL * max(a, b, 1e-9)


def certainty(a: float, b: float, most: float = 0.98) -> float:
    """Probability that the larger of two measures is the larger one in truth; a half where they are equal."""
    apart = abs(a - b) / max(abs(a), abs(b), 1e-9)
    return 0.5 + (most - 0.5) * min(apart / _SURE, 1.0)


def in_unit(metres: float, unit: Unit | None) -> tuple[float, AnswerType, str, str]:
    """A length as answer, its type, its unit, and in words: metres unless a unit was asked for."""
    if unit is None or unit.name == "m":
        return metres, "metres", "m", told_length(metres)
    value = metres / unit.metres
    return value, "number", unit.name, f"{_short(value)} {unit.name}"


def told_length(metres: float) -> str:
    """A length in words: "1.24 m", "35 cm"."""
    return f"{metres:.2f} m" if metres >= 0.995 else f"{metres * 100:.3g} cm"


def told_size(survey: Survey, thing: Thing, unit: Unit | None = None) -> str:
    """Its three sides in words: "2.08 m wide, 0.85 m deep and 0.89 m high"."""
    name, per = (unit.name, unit.metres) if unit else ("m", 1.0)
    said = [f"{side / per:.2f}" if per == 1 else _short(side / per) for side in sides(survey, thing)]
    return f"{said[0]} {name} wide, {said[1]} {name} deep and {said[2]} {name} high"


def agreed(values: Sequence[float]) -> float | None:
    """The mean of measures that are the same, None if they differ."""
    return math.fsum(values) / len(values) if values and same(min(values), max(values)) else None


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def told_each(survey: Survey, things: Sequence[Thing], told: Sequence[str]) -> str:
    """What holds of each thing: "the red chair 0.88 m, the white chair 0.91 m"."""
    return listed([f"{survey.named(t)} {said}" for t, said in zip(things, told, strict=True)])
