"""How many things there are and how they stand together: "x2", "three rows of four", "in a circle", "back to back"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ...grammar.vocabulary import quantities
from ..brief import Arrangement
from . import vocabulary

_TIMES = re.compile(r"[x×](\d{1,2})|(\d{1,2})[x×]")
_GRID = re.compile(r"([1-9]\d?)[x×]([1-9]\d?)")
_OPENERS = ("in", "into", "as", "forming")
_MOST = 60


@dataclass(frozen=True)
class Standing:
    """A phrase for how things stand together.

    Attributes:
        arrangement: the form.
        count: of the things, where the phrase states or suggests it.
        behind: whether it follows its noun ("in a row"); otherwise a noun follows ("a row of").
        taken: how many words it has.
    """

    arrangement: Arrangement
    count: int | None
    behind: bool
    taken: int


def standing(texts: Sequence[str], i: int) -> Standing | None:
    """The phrase at position `i` for how things stand together; None if there is none."""
    if tuple(texts[i : i + 3]) == ("back", "to", "back"):
        return Standing(Arrangement(form="back_to_back"), None, True, 3)
    behind = texts[i] in _OPENERS
    j = i + behind
    j += texts[j : j + 1] in (["a"], ["an"], ["the"])
    if behind and texts[j : j + 1] and (said := _GRID.fullmatch(texts[j])) and texts[j + 1 : j + 2] == ["grid"]:
        made = Arrangement(form="grid", rows=int(said[1]), columns=int(said[2]))
        return Standing(made, min(int(said[1]) * int(said[2]), _MOST), True, j + 2 - i)
    rows, taken = _number(texts, j)
    at = j + taken
    if behind and rows and texts[at : at + 1] in (["by"], ["x"], ["×"]):  # "in a 2 by 3 grid"
        columns, digits = _number(texts, at + 1)
        if columns and texts[at + 1 + digits : at + 2 + digits] in (["grid"], ["block"], ["array"]):
            made = Arrangement(form="grid", rows=rows, columns=columns)
            return Standing(made, rows * columns, True, at + 2 + digits - i)
    at += texts[at : at + 1] in (["neat"], ["long"], ["single"], ["straight"], ["big"], ["small"], ["wide"])
    form = vocabulary.FORMS.get(texts[at]) if at < len(texts) else None
    plural = form is not None and texts[at].endswith("s")
    if form is None or (texts[at] == "round" and j == i) or (j == i and not rows and not plural):
        return None
    many = rows if rows > 1 else 0
    if form == "row" and (many or plural):
        form = "grid"
    of = texts[at + 1 : at + 2] == ["of"]
    in_each, digits = _number(texts, at + 2) if of else (0, 0)
    across = texts[at].startswith("column")
    made = Arrangement(form=form, rows=None if across else many or None, columns=many or None if across else None)
    count = min((many or 1) * in_each, _MOST) or None
    if behind:
        return Standing(made, count, True, at + 1 + (1 + digits if in_each else 0) - i)
    if not of:
        return None
    return Standing(made, count or (2 * (many or 2) if form == "grid" else 4), False, at + 2 + digits - i)


def _number(texts: Sequence[str], i: int) -> tuple[int, int]:
    """A whole number at position `i` and how many words it has; zeros if there is none."""
    number = quantities.read(texts[i:]) if i < len(texts) else None
    if number is None or number.kind != "NUMBER" or not 1 <= number.value <= _MOST:
        return 0, 0
    return int(number.value), number.taken


def times(texts: Sequence[str], i: int) -> tuple[int, int] | None:
    """The number that "x2", "2x" or "2 x" at position `i` states, and how many words it has; None if it is none."""
    if said := _TIMES.fullmatch(texts[i]):
        count, taken = int(said[1] or said[2]), 1
    elif texts[i] in "x×" and texts[i + 1 : i + 2] and texts[i + 1].isdigit():
        count, taken = int(texts[i + 1]), 2
    elif (
        texts[i].isdigit()
        and texts[i + 1 : i + 2] in (["x"], ["×"])
        and not "".join(texts[i + 2 : i + 3])[:1].isdigit()
    ):
        count, taken = int(texts[i]), 2
    else:
        return None
    return (count, taken) if 1 <= count <= 200 else None
