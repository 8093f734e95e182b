"""Grades by eye: 0 to 3 for each instruction in each setting, valid only for the pictures that were looked at.

3: a professional would accept it; 2: small flaws; 1: partly; 0: wrong, or nothing done. A right refusal of a thing that
is not there is a 3, a refusal of a possible edit a 0. An edit that needed an answer counts at most 2, and so does a
question that is open.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from ...harness import Metric
from .carrying import HERE, Carried, Instruction

GOAL = 2.2
_ASKED = 2  # the best grade of what needed an answer


@dataclass(frozen=True)
class Grade:
    """What somebody saw: 0 to 3, whether it is wrong without saying so, and why."""

    grade: int
    silent: bool
    why: str


@dataclass(frozen=True)
class Row:
    """One line of the table; `grade` is None where nobody looked at these pictures."""

    instruction: Instruction
    carried: Carried
    grade: Grade | None

    @property
    def counts(self) -> int | None:
        """The grade as it counts."""
        if self.grade is None:
            return None
        best = _ASKED if self.carried.outcome == "asked" or self.carried.questions else 3
        return min(self.grade.grade, best)


def read_grades() -> dict[str, dict[str, Any]]:
    """The committed grades, by key of the instruction: look, grade, silent, why."""
    path = HERE / "grades.json"
    return dict(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else {}


def graded(instruction: Instruction, carried: Carried, grades: Mapping[str, Mapping[str, Any]]) -> Row:
    """A row with its grade, if that was given for these pictures or these words."""
    found = grades.get(carried.key)
    if found is None or found["look"] != carried.look:
        return Row(instruction, carried, None)
    return Row(instruction, carried, Grade(int(found["grade"]), bool(found.get("silent", False)), str(found["why"])))


def metrics(rows: Sequence[Row]) -> tuple[Metric, ...]:
    """The mean grade, how many are wrong without saying so, and how instructions ended."""
    counted = [row.counts for row in rows if row.counts is not None]
    found = [
        Metric("graded.instructions", len(rows), "count"),
        Metric("graded.ungraded", len(rows) - len(counted), "count", "lower", 0.0, 0),
        *(
            Metric(f"graded.{end}", sum(row.carried.outcome == end for row in rows), "count")
            for end in ("done", "asked", "refused")
        ),
    ]
    if not counted:
        return tuple(found)
    silent = sum(row.grade is not None and row.grade.silent for row in rows)
    found += [Metric("graded.mean", fmean(counted), "of 3", "higher", 0.02, GOAL)]
    found += [Metric("graded.wrong_and_silent", silent, "count", "lower", 0.0, 0)]
    found += [Metric(f"graded.grade_{n}", counted.count(n), "count") for n in range(4)]
    for setting in dict.fromkeys(_setting(row) for row in rows):
        of = [row.counts for row in rows if _setting(row) == setting and row.counts is not None]
        if of:
            found.append(Metric(f"graded.{setting.replace(' ', '_')}", fmean(of), "of 3", "higher", 0.05))
    return tuple(found)


def table(rows: Sequence[Row]) -> str:
    """A Markdown table of all rows."""
    lines = ["| | scene | instruction | outcome | grade | seen |", "| --- | --- | --- | --- | ---: | --- |"]
    for row in rows:
        outcome = row.carried.outcome + (" after a question" if row.carried.questions else "")
        grade = "ungraded" if row.counts is None else str(row.counts)
        why = "" if row.grade is None else row.grade.why + (" **Not told.**" if row.grade.silent else "")
        lines.append(
            f"| {row.instruction.id} | {_setting(row)} | {row.instruction.text} | {outcome} | {grade} | {why} |"
        )
    return "\n".join(lines) + "\n"


def _setting(row: Row) -> str:
    return row.carried.key.split(" ", 1)[1]
