"""The measured points of each method: settings, seconds and accuracy, read from `points.json`.

`benchmarks/_effort/measure.py` measures them. Times are processor seconds of one core of the reference machine; a file
of the user's machine (`user_file`) scales them. Accuracies carry over to other machines.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ..errors import UserError

WORDS = ("fast", "balanced", "accurate")
FILE = Path(__file__).with_name("points.json")


@dataclass(frozen=True)
class Point:
    """One measured setting of a method.

    Attributes:
        setting: in words, for people.
        settings: as the method takes them.
        fixed, per: predicted seconds on the reference machine are `fixed + per * size + clock`.
        clock: seconds that the method is given and keeps by itself; 0 for methods without a clock.
        accuracy: measured, in the method's unit; larger is better.
        names: words of the dial that mean this point.
        measured: seconds that the measurement took, at the method's `size`.
    """

    setting: str
    settings: Mapping[str, Any]
    fixed: float
    per: float
    accuracy: float
    clock: float = 0.0
    names: tuple[str, ...] = ()
    measured: float = 0.0

    def overhead(self, size: float) -> float:
        """Predicted seconds on the reference machine beside the clock."""
        return self.fixed + self.per * size

    def seconds(self, size: float) -> float:
        """Predicted seconds on the reference machine."""
        return self.overhead(size) + self.clock


@dataclass(frozen=True)
class Method:
    """The front of one method.

    Attributes:
        name: "embed", "edit", ...
        unit: of the accuracy, for people.
        sized_by: what `size` counts.
        size: of what was measured.
        scene: what was measured.
        revision: of the source that was measured.
        points: on the front, the fastest first.
        default: index of the point that is used without `effort`; None if that is not on the front.
        note: which knobs are left out and why.
    """

    name: str
    unit: str
    sized_by: str
    size: float
    scene: str
    revision: str
    points: tuple[Point, ...]
    default: int | None = 0
    note: str = ""
    by_name: Mapping[str, Point] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, name: str, data: Mapping[str, Any]) -> Method:
        """From the JSON of `points.json`.

        Raises:
            ValueError: a word of the dial means two points, or there is none that means one.
        """
        points = tuple(Point(**{**p, "names": tuple(p.get("names", ()))}) for p in data["points"])
        by_name = {word: p for p in points for word in p.names}
        said = [word for p in points for word in p.names]
        if not said or len(set(said)) < len(said) or not set(said) <= set(WORDS):
            raise ValueError(f"{name}: each of {', '.join(WORDS)} may mean one point, and one of them must")
        return cls(name, **{**data, "points": points}, by_name=by_name)


@cache
def methods() -> dict[str, Method]:
    """All methods by name."""
    data = json.loads(FILE.read_text(encoding="utf-8"))
    return {name: Method.of(name, one) for name, one in data["methods"].items()}


@cache
def machine() -> str:
    """The reference machine, for people."""
    return str(json.loads(FILE.read_text(encoding="utf-8"))["machine"])


@cache
def probes() -> dict[str, float]:
    """Seconds of each job of `scenewright bench calibrate` on the reference machine."""
    return {name: float(s) for name, s in json.loads(FILE.read_text(encoding="utf-8"))["probes"].items()}


def method(name: str) -> Method:
    """A method by its name.

    Raises:
        UserError: nothing was measured of it.
    """
    found = methods().get(name)
    if found is None:
        raise UserError(f"there are no measured points of {name!r}; there are some of {', '.join(methods())}")
    return found
