"""What marks ask for: commands with their times."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from .....gaussians.language.query.query import Query
from ..command import Command, pace
from ..happenings import Happening
from ..moments import Moment
from .slots import Slots


@dataclass(frozen=True)
class Wanted:
    """A command, in words or as it is, its time, and the commands that go with it."""

    command: str | Command
    moment: Moment
    happening: Happening | None
    also: tuple[Wanted, ...] = ()


def now(slots: Slots, command: str | Command, **moment: Any) -> Wanted:
    """A command at the time that marks tell, with parts of that changed."""
    return Wanted(command, replace(plainly(slots.moment), **moment), slots.happening)


def paced(slots: Slots, change: str, moment: Moment | None = None, **more: Any) -> Wanted:
    """A change of a motion at the time that marks tell, or at another one."""
    command = pace(whose_of(slots), change, **more)
    return Wanted(command, plainly(slots.moment) if moment is None else moment, slots.happening)


def plainly(moment: Moment) -> Moment:
    """A time without how slowly or quickly something is to go."""
    return replace(moment, slowly=False, quickly=False)


def whose_of(slots: Slots) -> Query:
    """What is changed, as one query."""
    first, *others = slots.queries
    also = tuple(other for query in others for other in (query.model_copy(update={"also": ()}), *query.also))
    return first.model_copy(update={"also": (*first.also, *also)}) if also else first
