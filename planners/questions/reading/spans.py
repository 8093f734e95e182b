"""Reads units, areas and names for the room itself, and puts measures into the unit that a question asks for."""

from __future__ import annotations

from dataclasses import dataclass

from ....gaussians import late_re as re
from ....gaussians.world.lengths import IN_METRES, METRES, SQUARE_METRES, UNITS, in_metres
from ...grammar.vocabulary import quantities
from ..answer import Answer, AnswerType
from .phrase_templates import Words

_CUBIC = re.compile(r"^(?:cubic|cu) (\w+)$|^(\w+) (?:cubed|3)$")
_ROOM = re.compile(
    r"^(?:(?:the|this|that|our|my|your|a|whole|entire|complete|full) )*(?:room|space|place|area|flat|apartment|"
    r"studio|house|interior|chamber|floor plan|(?:[a-z]+ )?(?:bedroom|kitchen|office|study|lounge|"
    r"bathroom|hallway|library|nursery|"
    r"classroom|workshop|shop|restaurant|gym|closet)|(?:living|dining|sitting|family|kids|guest|game|music|computer|"
    r"meeting|conference|dressing|waiting|laundry|play) room)$"
)


@dataclass(frozen=True)
class Unit:
    """A unit in which a measure is told.

    Attributes:
        name: as in an answer's `unit`: "m", "ft", "m2", "ft2", "m3".
        value: metres, square metres or cubic metres.
        power: 1 for lengths, 2 for areas, 3 for volumes.
    """

    name: str
    value: float
    power: int


METRE, SQUARE, CUBE = Unit("m", 1.0, 1), Unit("m2", 1.0, 2), Unit("m3", 1.0, 3)


def unit(words: Words) -> Unit | None:
    """A unit of length: "feet"."""
    if words == ("feet", "and", "inches"):
        words = ("feet",)
    said = words[0] if len(words) == 1 else ""
    if said == "in" or (said not in UNITS and said not in IN_METRES):
        return None
    if said in IN_METRES:
        return Unit("yd" if said.startswith("y") else "km" if said.startswith("k") else said, IN_METRES[said], 1)
    name = UNITS[said]
    return Unit(name, METRES[name], 1) if name in METRES else None


def area_unit(words: Words) -> Unit | None:
    """A unit of area: "square feet"."""
    said = _one_spelling(words)
    if said not in SQUARE_METRES:
        return None
    value = SQUARE_METRES[said]
    return Unit(next((f"{n}2" for n, m in METRES.items() if abs(m * m - value) < 1e-12), "m2"), value, 2)


def volume_unit(words: Words) -> Unit | None:
    """A unit of volume: "cubic metres"."""
    if words in (("liters",), ("litres",), ("liter",), ("litre",)):
        return Unit("l", 0.001, 3)
    found = _CUBIC.match(_one_spelling(words))
    side = unit(((found[1] or found[2]),)) if found else None
    return Unit(f"{side.name}3", side.value**3, 3) if side else None


def area(words: Words) -> float | None:
    """An area with its unit, in square metres: "20 square metres"."""
    for cut in range(1, len(words)):
        side = area_unit(words[cut:])
        amount = quantities.read(words[:cut])
        if side and amount and amount.kind == "NUMBER" and amount.taken == cut:
            return amount.value * side.value
    return None


def length(words: Words) -> float | None:
    """A length with its unit, in metres, also in the forms "1 m 20", "5 feet 6" and "2 m 50 cm"."""
    found = quantities.read(words)
    if found is None or found.kind != "LENGTH":
        return None
    rest = words[found.taken :]
    rest = rest[1:] if rest[:1] == ("and",) else rest
    more = quantities.read(rest) if rest else None
    if not rest:
        return in_metres(found.value, found.unit)
    if more is None or more.taken != len(rest):
        return None
    if more.kind == "LENGTH":
        return in_metres(found.value, found.unit) + in_metres(more.value, more.unit)
    small = {"m": 0.01, "ft": METRES["in"]}.get(found.unit)
    return in_metres(found.value, found.unit) + more.value * small if more.kind == "NUMBER" and small else None


def room(words: Words) -> bool | None:
    """Whether the words name the room as a whole."""
    return True if words in (("here",), ("in", "here"), ("it", "in", "here")) or _ROOM.match(" ".join(words)) else None


def told(value: float, unit: Unit) -> str:
    """A measure in words: "3.87 m", "17.0 m2", "182 sq ft"."""
    number = value / unit.value
    digits = 0 if unit.name in ("cm", "mm", "in", "l") or number >= 100 else 2 if unit.power == 1 else 1
    return f"{number:.{digits}f} {unit.name}"


def measured(value: float, unit: Unit) -> dict[str, object]:
    """The fields of an answer that hold a measure in a unit."""
    kind: AnswerType = "metres" if unit.name == "m" else "number"
    return {"answer": round(value / unit.value, 4), "answer_type": kind, "unit": unit.name}


def answer_of(value: float, unit: Unit, text: str, **fields: object) -> Answer:
    """An answer that is a measure."""
    return Answer.model_validate({**measured(value, unit), "text": text, **fields})


def _one_spelling(words: Words) -> str:
    """Words of a unit as the table of areas has them."""
    said = " ".join(words).replace("square meter", "square metre").replace("²", " 2").replace("³", " 3")
    return said if said in SQUARE_METRES else said.replace("metre", "meter") if "metre" in said else said


_DIMENSIONS = {
    "wide": "width", "wider": "width", "broad": "width", "broader": "width", "across": "width", "long": "length",
    "longer": "length", "deep": "depth", "deeper": "depth", "high": "height", "higher": "height", "tall": "height",
    "taller": "height", "narrower": "width", "shorter": "length", "shallower": "depth", "lower": "height",
    "up": "height",
}  # fmt: skip
_LESSER = frozenset(("narrower", "shorter", "shallower", "lower"))


def dimension(words: Words) -> str | None:
    """The side of a room that a word of size is about: "wider" to "width"."""
    said = words[0] if len(words) == 1 else ""
    return _DIMENSIONS.get(said) if said not in _LESSER else None


def lesser(words: Words) -> str | None:
    """The same for words that say less: "lower" to "height"."""
    return _DIMENSIONS.get(words[0]) if len(words) == 1 and words[0] in _LESSER else None
