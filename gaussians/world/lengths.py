"""Units of length and area: their spellings, and their values in metres and square metres."""

from __future__ import annotations

from typing import Literal

Unit = Literal["m", "cm", "mm", "in", "ft", "units"]

# Metres of each unit in which a length may be stored; "units" are those of a scene and have no fixed length.
METRES: dict[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
# Every spelling of those units, except "in", which is a unit only after digits.
_SPELT: dict[Unit, str] = {
    "m": "m meter meters metre metres",
    "cm": "cm cms centimeter centimeters centimetre centimetres",
    "mm": "mm millimeter millimeters millimetre millimetres",
    "in": 'inch inches "',
    "ft": "ft foot feet '",
    "units": "unit units",
}
UNITS: dict[str, Unit] = {said: unit for unit, spellings in _SPELT.items() for said in spellings.split()}
# Every spelling of units that are converted to metres when read, and their metres.
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
    """A length in metres; a scene unit counts as one metre."""
    return value * METRES.get(unit, 1.0)
