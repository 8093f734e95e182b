"""Undo and redo: a line of frozen states and a place on it.

Knows that a state is a value that shares what did not change, so that going back is taking the old reference. Refuses
to know how one state came from another.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from functools import cached_property

from ...gaussians.errors import UserError
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene

DEPTH = 200  # states kept; each holds only the columns that its edit changed


@dataclass(frozen=True, eq=False)
class State:
    """What the session is in between two instructions.

    Attributes:
        scene: the scene.
        last: what "it" means, None at first.
        text: the instruction that led here, "" for the first state.
        spoken: the instruction before, for "a bit more" and "the red one".
    """

    scene: Scene
    last: Selection | None = None
    text: str = ""
    spoken: str = ""

    @cached_property
    def digest(self) -> str:
        """Of the cloud; computed once, when a log asks for it."""
        return self.scene.cloud.digest()


@dataclass
class History:
    """The states behind, the present one, and those taken back."""

    present: State
    past: deque[State] = field(default_factory=lambda: deque(maxlen=DEPTH))
    future: list[State] = field(default_factory=list)

    def advance(self, state: State) -> None:
        """A new present; what had been taken back is forgotten."""
        self.past.append(self.present)
        self.present = state
        self.future.clear()

    def amend(self, state: State) -> None:
        """Another present that is no step of its own (the same Gaussians, now embedded)."""
        self.present = state

    def behind(self) -> State:
        """The state an undo leads to.

        Raises:
            UserError: there is none.
        """
        if not self.past:
            raise UserError("there is nothing to undo")
        return self.past[-1]

    def ahead(self) -> State:
        """The state a redo leads to.

        Raises:
            UserError: there is none.
        """
        if not self.future:
            raise UserError("there is nothing to redo")
        return self.future[-1]

    def back(self) -> State:
        """Go one step back; returns the new present."""
        state = self.behind()
        self.future.append(self.present)
        self.past.pop()
        self.present = state
        return state

    def forth(self) -> State:
        """Go one step forward again; returns the new present."""
        state = self.ahead()
        self.past.append(self.present)
        self.future.pop()
        self.present = state
        return state
