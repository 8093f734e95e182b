"""Units of length: how they are written, and what they measure in metres."""

from __future__ import annotations

from typing import Literal

Unit = Literal["m", "cm", "mm", "in", "ft", "units"]

# Metres of each unit that a length keeps; "units" are a scene's own and have no fixed length.
METRES: dict[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
# Every spelling of those units. "in" is left out: it is a unit only behind digits.
_SPELT: dict[Unit, str] = {
    "m": "m meter meters metre metres",
    "cm": "cm cms centimeter centimeters centimetre centimetres",
    "mm": "mm millimeter millimeters millimetre millimetres",
    "in": 'inch inches "',
    "ft": "ft foot feet '",
    "units": "unit units",
}
UNITS: dict[str, Unit] = {said: unit for unit, spellings in _SPELT.items() for said in spellings.split()}
# Every spelling of units that are read as metres, and how many.
IN_METRES: dict[str, float] = {
    **dict.fromkeys(["km", "kms", "kilometer", "kilometers", "kilometre", "kilometres"], 1000.0),
    **dict.fromkeys(["dm", "decimeter", "decimeters", "decimetre", "decimetres"], 0.1),
    **dict.fromkeys(["yd", "yds", "yard", "yards"], 0.9144),
    **dict.fromkeys(["mile", "miles"], 1609.344),
}
# Every spelling of a unit of area, as words with one space between them, and its square metres.
SQUARE_METRES: dict[str, float] = {"sqm": 1.0, "m2": 1.0, "sqft": METRES["ft"] ** 2} | {
    form.format(said): METRES[unit] ** 2
    for said, unit in UNITS.items()
    if said.isalpha() and unit in METRES
    for form in ("square {}", "sq {}", "{} squared", "{} 2")
}


def in_metres(value: float, unit: str) -> float:
    """A length in metres; one of a scene's own units counts as a metre."""
    return value * METRES.get(unit, 1.0)
