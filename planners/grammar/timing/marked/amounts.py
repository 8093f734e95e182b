"""Amounts that words with a mark name: "by half a metre", "one and a half turns per second", "twice"."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from .....gaussians import late_re as re
from .....gaussians.world.lengths import METRES
from ...vocabulary.quantities import NUMBERS
from ..moments import DURATION, seconds_of

Unit = Literal["s", "m", "m/s", "deg", "turns", "turns/s", "times", "%", ""]  # the last: a number alone

_WORD = "|".join(sorted((word for word in NUMBERS if word.isalpha()), key=len, reverse=True))
_N = (
    r"(?:\d+(?:\.\d+)?|three quarters(?: of an?)?|(?:an? )?quarter(?: of an?)?|(?:an? |one )?half(?: an?)?|"
    rf"(?:an? |one |two )?thirds?(?: of an?)?|(?:an? |one )?fourth(?: of an?)?|"
    rf"(?:{_WORD})(?: (?:{_WORD}))?(?: and a half)?|an?)"
)
_FULL = (
    r"(?: (?:full|whole|complete|entire|quick|slow|little|gentle|lazy|short|small|graceful|single|proper|good|solid|"
    r"mere|more|further|unhurried|leisurely|stately|elegant|calm|smooth|steady|even))*"
)
_ROUNDS = (
    r"(?:turns?|revolutions?|revs?|rotations?|rounds?|spins?|circles?|twirls?|pirouettes?|laps?|times?|cycles?|"
    r"donuts?|doughnuts?|somersaults?|flips?|loops?)"
)
_EACH = (
    r"(?: (?:around|round|about|over))?(?: ?/ ?| (?:per|a|an|each|every|by|in (?:a|one|each|every)|once every|to the) )"
)
_SECOND = r"(?:s|secs?|seconds?)"
_OFTEN = {"once": 1.0, "twice": 2.0, "thrice": 3.0}
_TABLE: tuple[tuple[Unit, str], ...] = (  # tried in their order
    ("turns/s", rf"(?P<n>{_N}){_FULL} {_ROUNDS}{_EACH}(?:(?P<per>{_N}) )?{_SECOND}"),
    ("turns/s", rf"(?:each|every|per) {_SECOND} (?P<n>{_N}){_FULL} {_ROUNDS}"),
    ("turns/s", rf"(?P<often>once|twice|thrice){_EACH}(?:(?P<per>{_N}) )?{_SECOND}"),
    ("turns/s", rf"(?P<n>{_N}) ?(?:hz|hertz|rps)"),
    ("turns/s", rf"(?P<rpm>{_N}) ?(?:rpm|{_ROUNDS} (?:per|a) minute)"),
    ("turns/s", rf"(?P<deg>{_N}) ?(?:degrees?|deg|°){_EACH}{_SECOND}"),
    ("turns/s", rf"(?P<n>{_N}) (?:per|each|every) {_SECOND}"),
    (
        "m/s",
        rf"(?P<n>{_N}) ?(?P<unit>cm|m|(?:centi)?met(?:re|er)s?)(?: ?/ ?| (?:per|a|each|every) )(?:s|secs?|seconds?)",
    ),
    ("deg", rf"(?P<n>{_N})(?: (?:full|whole|more))? ?(?:degrees?|deg|°)"),
    ("deg", r"(?P<right>right angle)"),
    ("deg", rf"(?P<rad>{_N}) ?(?:rad|radians?)"),
    ("m", rf"(?P<n>{_N}){_FULL} ?(?P<unit>mm|cm|m|(?:milli|centi)?met(?:re|er)s?|feet|foot|ft|inch(?:es)?)"),
    ("s", rf"(?P<s>{DURATION})"),
    ("turns", rf"(?P<n>{_N}){_FULL} (?!times){_ROUNDS}(?: (?:around|round))?"),
    ("turns", rf"(?P<often>once|twice|thrice|{_N} times)(?: (?:around|round|about)|(?= its| itself| on its))"),
    ("%", rf"(?P<n>{_N}) ?(?:%|percent|per cent)"),
    ("times", rf"(?P<n>{_N}) ?(?:x|times|fold)"),
    ("times", r"x ?(?P<n>\d+(?:\.\d+)?)"),
    (
        "times",
        r"(?P<factor>twice|double[ds]?|two fold|twofold|triple[ds]?|thrice|quadruple|halve[ds]?|half|"
        r"(?:two|three) (?:thirds|quarters)|quarter|fourth|third)",
    ),
    ("times", rf"factor (?:of )?(?P<n>{_N})"),
)
_PATTERNS = tuple((unit, re.compile(rf"(?<![\w.]){pattern}(?![\w.]*\d|\w)")) for unit, pattern in _TABLE)
_FACTORS = {  # by how the word begins
    "twice": 2.0, "doub": 2.0, "twof": 2.0, "two fold": 2.0, "trip": 3.0, "thri": 3.0, "quad": 4.0, "hal": 0.5,
    "quar": 0.25, "four": 0.25, "third": 1 / 3, "two thirds": 2 / 3, "three quarters": 0.75,
}  # fmt: skip
_MORE = re.compile(r"\b(?:more|extra|further|additional|good|solid|full|whole|mere) (?=(?:seconds?|secs?)\b)")
_ANOTHER = re.compile(r"\banother (?=(?:seconds?|secs?)\b)")
_AGAIN = re.compile(
    r"\b(?:again|once more|anew|newly|afresh|encore|duplicate|repetition|repeat performance)\b|"
    r"\b(?:another|(?:one|a) (?:more|further)|(?:a |the )?(?:second|2nd)) (?!half\b|and\b|or\b)(?:\w+ )?[a-z]+$|"
    r"^(?:once|another)$"
)
_TIMES_MORE = re.compile(
    rf"\b(?P<n>{_WORD}|\d+|twice)(?: times| reps| goes)? more(?: times)?\b|\banother (?P<m>{_WORD}|\d+) times\b"
)
_GOES = re.compile(
    rf"\b(?:[x×n] ?=? ?(?P<x>\d+)|(?P<n>{_WORD}|\d+) (?!seconds?\b|secs?\b|times\b)(?:complete |full |whole )?"
    r"[a-z]+s)\b"
)
_SPINS: tuple[tuple[Unit, re.Pattern[str]], ...] = (
    ("deg", re.compile(r"\b(?P<n>90|180|270|360|450|540|720|1080)\b")),
    (
        "turns",
        re.compile(
            rf"\b(?P<n>once|twice|thrice|{_WORD}|\d+)\b(?: (?:whole|full|single|complete))*"
            r"(?: times?| of them| ones?)?$"
        ),
    ),
    ("turns", re.compile(r"\b(?P<n>once|twice|thrice)\b")),
)
_ALONE = re.compile(
    rf"^(?:(?:by|to|at|of|[a-z] =|=|just|only|barely|through|about|around|like|say|some|exactly|not|more|than|a|mere|"
    rf"maybe|max|maximum|up|down|out|no|further|wider|farther) )*"
    rf"(?P<n>\d+(?:\.\d+)?|(?:{_WORD}) tenths|(?:{_WORD})(?:[ -](?:{_WORD}))?)"
    rf"(?: (?:max|only|or so|tops|at (?:the )?most|instead|and no more|"
    rf"of (?:now|its|the present|what it is)(?: \w+)*))?$"
)
_METRES = {"mm": 0.001, "cm": 0.01, "milli": 0.001, "centi": 0.01, "f": METRES["ft"], "inch": METRES["in"]}


@dataclass(frozen=True)
class Amount:
    """A number with its unit; "times" is a factor."""

    value: float
    unit: Unit
    said: str


def amount(phrase: str) -> Amount | None:
    """The amount that a phrase names; None if it names none, or none that is understood."""
    phrase = _ANOTHER.sub("one ", _MORE.sub("", phrase))
    for unit, pattern in _PATTERNS:
        if (found := pattern.search(phrase)) is not None and (value := _value(unit, found)) is not None:
            return Amount(value, unit, found[0])
    if (alone := _ALONE.match(phrase)) is not None and (value := number(alone["n"])) is not None:
        return Amount(value, "", alone["n"])
    return None


def spins(phrase: str) -> Amount | None:
    """How often something turns, where that is told in a number alone: "one time", "a full 360", "three of them"; None
    if it is not."""
    for unit, pattern in _SPINS:
        if (found := pattern.search(phrase)) is not None:
            value = _OFTEN.get(found["n"]) or number(found["n"])
            return None if value is None else Amount(value, unit, found[0])
    return None


def repeats(phrase: str) -> Amount | None:
    """How often something is done in all: "once more" is twice; None if that is not told."""
    if (more := _TIMES_MORE.search(phrase)) is not None:
        value = 2.0 if more["n"] == "twice" else number(more["n"] or more["m"])
        return None if value is None else Amount(value + 1, "times", more[0])
    if (again := _AGAIN.search(phrase)) is not None:
        return Amount(2.0, "times", again[0])
    if (goes := _GOES.search(phrase)) is not None and (value := number(goes["x"] or goes["n"])) is not None:
        return Amount(value, "times", goes[0])
    return None


def _value(unit: Unit, found: re.Match[str]) -> float | None:
    told = {key: said for key, said in found.groupdict().items() if said}
    if "s" in told:
        return seconds_of(told["s"])
    if "right" in told:
        return 90.0
    if "rad" in told:
        radians = number(told["rad"])
        return None if radians is None else round(math.degrees(radians), 2)
    if "factor" in told:
        return next(value for start, value in _FACTORS.items() if told["factor"].startswith(start))
    if "often" in told:
        value = _OFTEN.get(told["often"]) or number(told["often"].removesuffix(" times"))
    else:
        value = number(told.get("n") or told.get("rpm") or told["deg"])
    if value is None:
        return None
    if unit in ("m", "m/s"):
        return value * next((scale for start, scale in _METRES.items() if told["unit"].startswith(start)), 1.0)
    per = number(told["per"]) if "per" in told else 1.0
    if "rpm" in told or "deg" in told:
        return value / (60 if "rpm" in told else 360)
    return value / per if per else None


def number(said: str) -> float | None:
    """The number that words name: "two", "a half", "one and a half", "a quarter of a"."""
    said = re.sub(r" of an?$|(?<=half) an?$|(?<=third) an?$", "", said.strip())
    if re.fullmatch(r"\d+(?:\.\d+)?", said):
        return float(said)
    if said.endswith(" and a half"):
        whole = number(said.removesuffix(" and a half"))
        return None if whole is None else whole + 0.5
    if said in ("a", "an"):
        return 1.0
    said = re.sub(r"^(?:an?|one) (?=half|quarter|fourth|third)", "", said)
    parts = {"half": 0.5, "quarter": 0.25, "fourth": 0.25, "third": 1 / 3, "two thirds": 2 / 3, "three quarters": 0.75}
    if said in parts:
        return parts[said]
    words = said.split()
    if words and words[-1] == "tenths" and (whole := number(" ".join(words[:-1]))) is not None:
        return whole / 10
    return float(sum(NUMBERS[word] for word in words)) if words and all(word in NUMBERS for word in words) else None
