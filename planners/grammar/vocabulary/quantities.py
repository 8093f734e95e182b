"""Parses numbers, fractions, lengths, angles, percentages and factors ("three times"), in digits or in words.

Each function takes the words from a position on and returns the amount and how many words it consumed, or None.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ....gaussians.world.lengths import IN_METRES, UNITS

Kind = Literal["LENGTH", "ANGLE", "PERCENT", "TIMES", "FRACTION", "NUMBER", "ORDINAL"]

_ONES = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
    "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen",
)  # fmt: skip
_TENS = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")
_RANKS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
NUMBERS: dict[str, int] = {w: i for i, w in enumerate(_ONES)} | {w: 10 * i for i, w in enumerate(_TENS, 2)}
NUMBERS |= {"hundred": 100, "dozen": 12}
FRACTIONS: dict[str, float] = {
    "half": 0.5, "third": 1 / 3, "thirds": 1 / 3, "quarter": 0.25, "quarters": 0.25, "fifth": 0.2, "fifths": 0.2,
    "tenth": 0.1,
}  # fmt: skip
ORDINALS: dict[str, int] = {w: i for i, w in enumerate(_RANKS, 1)}
_ADVERBS = {"twice": 2.0, "thrice": 3.0}
_DEGREES = {"degree", "degrees", "deg", "degs", "°"}
_TURNS = {"turn", "turns", "rotation", "rotations", "revolution", "revolutions"}
_WHOLE = {"whole", "full", "good", "further", "more", "extra"}
_HEDGES = {
    "about",
    "around",
    "approximately",
    "roughly",
    "exactly",
    "maybe",
    "some",
    "approx",
    "nearly",
    "almost",
    "just",
}


@dataclass(frozen=True)
class Quantity:
    """An amount read from words.

    Attributes:
        kind: what it measures.
        value: a LENGTH in its `unit`, an ANGLE in degrees, 0.2 for 20 %, 3 for "three times", 1/3 for "a third".
        unit: the unit of a LENGTH, else "".
        taken: how many words it consumed.
    """

    kind: Kind
    value: float
    unit: str
    taken: int


def read(words: Sequence[str]) -> Quantity | None:
    """The longest amount at the start of `words`, None if there is none."""
    skip = 1 if len(words) > 1 and words[0] in _HEDGES and (words[1] in ("a", "half") or _whole(words[1:])) else 0
    found = _read(words[skip:])
    return Quantity(found.kind, found.value, found.unit, found.taken + skip) if found else None


def _read(words: Sequence[str]) -> Quantity | None:
    if not words or not words[0]:  # what cleaning leaves of a word may be empty
        return None
    if words[0] in _ADVERBS:
        return Quantity("TIMES", _ADVERBS[words[0]], "", 1)
    if tuple(words[:3]) == ("a", "factor", "of") and (number := _number(words[3:])):
        return Quantity("TIMES", number[0], "", 3 + number[1])
    if number := _number(words):
        return _with_unit(words, *number)
    if words[0] in ("a", "an", "one") and len(words) > 1:
        return _one_unit(words)
    return _ordinal(words)


def _with_unit(words: Sequence[str], value: float, taken: int) -> Quantity | None:
    """A number with the unit behind it, if there is one."""
    rest = words[taken:]
    unit = rest[0] if rest else ""
    digits = words[0][-1].isdigit()
    if unit == "of" and len(rest) > 2 and rest[1] in ("a", "an") and (rest[2] in UNITS or rest[2] in _TURNS):
        rest, unit, taken = rest[2:], rest[2], taken + 2
    elif unit in ("a", "an") and len(rest) > 1 and (rest[1] in UNITS or rest[1] in _TURNS):
        rest, unit, taken = rest[1:], rest[1], taken + 1
    if unit in IN_METRES:
        extra = _and_a_half(rest[1:])
        return Quantity("LENGTH", round((value + extra[0]) * IN_METRES[unit], 9), "m", taken + 1 + extra[1])
    if unit in UNITS and (unit not in "'\"" or digits):
        extra = _and_a_half(rest[1:]) if UNITS[unit] != "ft" else _and_inches(rest[1:])
        return Quantity("LENGTH", value + extra[0], UNITS[unit], taken + 1 + extra[1])
    if unit == "in" and digits and (len(rest) < 2 or rest[1] not in ("the", "a", "an", "front", "my", "its")):
        return Quantity("LENGTH", value, "in", taken + 1)
    if unit in ("rad", "radian", "radians"):
        return Quantity("ANGLE", round(math.degrees(value), 6), "", taken + 1)
    if unit in _DEGREES:
        return Quantity("ANGLE", value, "", taken + 1)
    if unit in _TURNS:
        return Quantity("ANGLE", 360 * value, "", taken + 1)
    if unit in ("full", "complete") and len(rest) > 1 and rest[1] in _TURNS:
        return Quantity("ANGLE", 360 * value, "", taken + 2)
    if unit in ("%", "percent", "pct") or (unit == "per" and tuple(rest[1:2]) == ("cent",)):
        return Quantity("PERCENT", value / 100, "", taken + (2 if unit == "per" else 1))
    if unit in ("times", "time") or (unit == "x" and digits):
        return Quantity("TIMES", value, "", taken + 1)
    if _is_fraction(words[:taken]):
        return Quantity("FRACTION", value, "", taken)
    return Quantity("NUMBER", value, "", taken)


def _one_unit(words: Sequence[str]) -> Quantity | None:
    """One unit: "a metre (and a half)", "a full turn", "a right angle", "a degree"."""
    unit = words[1]
    if unit in _WHOLE and len(words) > 2 and words[2] in (*UNITS, *IN_METRES) and words[2] not in ("m", "'", '"'):
        found = _one_unit((words[0], *words[2:]))  # "a whole metre"
        return found and Quantity(found.kind, found.value, found.unit, found.taken + 1)
    if unit in IN_METRES:
        return _with_unit(("1", *words[1:]), 1.0, 1)
    if unit in UNITS and unit not in ("m", "'", '"'):
        extra = _and_a_half(words[2:])
        return Quantity("LENGTH", 1 + extra[0], UNITS[unit], 2 + extra[1])
    if unit in ("full", "complete", "whole") and len(words) > 2 and words[2] in _TURNS:
        return Quantity("ANGLE", 360, "", 3)
    if unit == "right" and tuple(words[2:3]) == ("angle",):
        return Quantity("ANGLE", 90, "", 3)
    if unit in ("degree", "revolution"):
        return Quantity("ANGLE", 1 if unit == "degree" else 360, "", 2)
    return None


def _and_a_half(words: Sequence[str]) -> tuple[float, int]:
    if len(words) >= 3 and words[0] == "and" and words[1] == "a" and words[2] in ("half", "quarter"):
        return FRACTIONS[words[2]], 3
    return 0.0, 0


def _and_inches(words: Sequence[str]) -> tuple[float, int]:
    """The inches behind feet (5'6", "five feet six inches"), in feet, or "and a half"."""
    number = _whole(words) if words else None
    if number and (unit := " ".join(words[number[1] : number[1] + 1])) and UNITS.get(unit, unit) == "in":
        return number[0] / 12, number[1] + 1
    return _and_a_half(words)


def _number(words: Sequence[str]) -> tuple[float, int] | None:
    """A number or a fraction: "2.5", "3/4", "two and a half", "half", "a third", "three quarters", "a couple of"."""
    if not words:
        return None
    first = words[0]
    if tuple(words[:3]) == ("half", "a", "dozen"):
        return 6.0, 3
    if first == "half":
        return 0.5, 1
    if first == "quarter" and tuple(words[1:2]) in (("turn",), ("rotation",), ("of",)):
        return 0.25, 1
    if first in ("a", "one") and len(words) > 1:
        if words[1] in FRACTIONS and words[1] not in ("thirds", "quarters"):
            return FRACTIONS[words[1]], 2
        if words[1] == "few":
            return 3.0, 2 + (tuple(words[2:3]) == ("of",))
        if words[1] in ("couple", "pair"):
            return 2.0, 2 + (tuple(words[2:3]) == ("of",))
        if words[1] in ("hundred", "dozen"):
            return float(NUMBERS[words[1]]), 2
    if not (whole := _whole(words)):
        return None
    value, taken = whole
    if _is_part(words[taken : taken + 1]) and value == int(value):
        return value + (_digits(words[taken]) or 0.0), taken + 1  # "1 1/2"
    if taken < len(words) and words[taken] in FRACTIONS and words[taken].endswith("s"):
        return value * FRACTIONS[words[taken]], taken + 1
    extra = _and_a_half(words[taken:])
    return value + extra[0], taken + extra[1]


def _whole(words: Sequence[str]) -> tuple[float, int] | None:
    """Digits or number words without a fraction."""
    first = words[0]
    if first in ("minus", "negative") and len(words) > 1 and (positive := _whole(words[1:])):
        return -positive[0], positive[1] + 1
    if (first[:1].isdigit() or (first[:1] == "-" and len(first) > 1)) and not first[-1].isalpha():
        value = _digits(first)
        return None if value is None else (value, 1)
    if first not in NUMBERS or first in ("hundred", "dozen"):
        return None
    value, taken = float(NUMBERS[first]), 1
    if first in _TENS and len(words) > 1 and 0 < NUMBERS.get(words[1], 0) < 10:
        value, taken = value + NUMBERS[words[1]], 2
    if taken < len(words) and words[taken] in ("hundred", "dozen"):
        value, taken = value * NUMBERS[words[taken]], taken + 1
    return value, taken


def _digits(text: str) -> float | None:
    """The value of "1,000", "1,5" (decimal comma) or "3/4"; None if it is not a finite number."""
    above, _, below = text.replace(" ", "").partition("/")
    values = []
    for part in (above, below) if below else (above,):
        grouped = part.count(",") and all(len(p) == 3 for p in part.split(",")[1:])
        plain = part.replace(",", "" if grouped else ".")
        if plain.count(".") > 1 or len(plain) > 12:
            return None
        values.append(float(plain))
    if len(values) == 2 and values[1] == 0:
        return None
    value = values[0] / values[1] if len(values) == 2 else values[0]
    return value if math.isfinite(value) else None


def _is_part(words: Sequence[str]) -> bool:
    """Whether the first word is a fraction below one in digits: "1/2"."""
    value = _digits(words[0]) if words and "/" in words[0] and words[0][0].isdigit() else None
    return value is not None and 0 < value < 1


def _is_fraction(words: Sequence[str]) -> bool:
    return words[-1] in FRACTIONS and "and" not in words


def _ordinal(words: Sequence[str]) -> Quantity | None:
    word = words[0]
    if word == "last" and len(words) > 1:
        return Quantity("ORDINAL", -1, "", 1)
    if tuple(words[1:3]) == ("to", "last") and word in ("second", "next"):
        return Quantity("ORDINAL", -2, "", 3)
    if word in ORDINALS:
        return Quantity("ORDINAL", ORDINALS[word], "", 1)
    if word[0].isdigit() and word[-2:] in ("st", "nd", "rd", "th") and word[:-2].isdecimal() and len(word) < 6:
        return Quantity("ORDINAL", int(word[:-2]), "", 1)
    return None
