"""What a command about time or motion means, before its time is added."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from .clauses import Clause

Fields = dict[str, Any]
Kind = Literal["motion", "path", "look"]


@dataclass(frozen=True)
class Command:
    """What a command means.

    Attributes:
        ops: the operations, without their time.
        kind: how its time is read: of motion that is there, of a way, or of a look.
        needs: whether it means this only with a time.
        text: a plain command that the rest of the grammar reads; then `ops` is empty.
        during: a time that the command itself tells, as the fields of `During`.
        inverse: whether the plain command says what is so at all other times.
        fades: whether it changes little by little.
        ends: whether a time "at" which it is said to be is that of its end.
        every: seconds from one time that a look is seen to the next; `blinks`: how many, if that is said.
        always_lasts: whether it goes on to the end where nothing else is said.
        timeless: whether a time that is told goes without saying.
        target: what "it" in `text` is, where the plain grammar has no words for it.
    """

    ops: tuple[Fields, ...] = ()
    kind: Kind = "motion"
    needs: bool = False
    text: str = ""
    during: dict[str, Any] | None = None
    inverse: bool = False
    fades: bool = False
    target: Query | None = None
    ends: bool = False
    timeless: bool = False
    every: float | None = None
    blinks: int = 0
    always_lasts: bool = False


def pace(target: Query, change: str, needs: bool = False, **more: Any) -> Command:
    """A change of when, how fast or which way something moves."""
    return Command(({"op": "pace", "target": target, "change": change, **more},), needs=needs)


def plain(clause: Clause, kind: Kind, text: str, **more: Any) -> Command:
    """A plain command, with `{}` for what it is about."""
    moving = clause.target.moving is not None
    name = "it" if moving else articled(clause.np)
    return Command(kind=kind, text=text.format(name), target=clause.target if moving else None, **more)


def articled(np: str) -> str:
    """A name with an article, as the rest of the grammar wants it."""
    if np in ("him", "her", "he", "she"):
        return "it"
    return np if _DETERMINED.match(np) else f"the {np}"


_DETERMINED = re.compile(
    r"^(?:the|a|an|this|that|these|those|all|every|both|my|our|it|them|each|any|everything|whatever|anything|one|"
    r"two|three)\b"
)
