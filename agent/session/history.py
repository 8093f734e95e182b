"""Undo and redo: the past, present and future states of a session.

A state is frozen and shares its unchanged columns with its neighbours, so undo only restores an old reference.
"""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import UserError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ...planners.plan import EditPlan
    from ...tools.receipt import Receipt

DEPTH = 200  # states kept for undo; each holds only the columns that its edit changed


@dataclass(frozen=True, eq=False)
class State:
    """The state of a session between two instructions.

    Attributes:
        scene: the scene.
        last: the selection that "it" refers to; None at first.
        text: the instruction that led here, "" for the first state.
        context: the previous instruction, for "a bit more" and "the red one".
        plan: the plan that was carried out to get here; None for the first state, and where it is not known.
        receipts: of its operations.
        pointed: what a vision model pointed at in this scene, by phrase.
    """

    scene: Scene
    last: Selection | None = None
    text: str = ""
    context: str = ""
    pointed: Mapping[str, Query] = field(default_factory=dict)
    plan: EditPlan | None = None
    receipts: tuple[Receipt, ...] = ()

    @property
    def digest(self) -> str:
        """SHA-256 digest of the cloud; computed once for each cloud, when a log needs it."""
        cloud = self.scene.cloud
        if cloud not in _digests:
            _digests[cloud] = cloud.digest()
        return _digests[cloud]


_digests: weakref.WeakKeyDictionary[GaussianCloud, str] = weakref.WeakKeyDictionary()


def looks_alike(a: GaussianCloud, b: GaussianCloud) -> bool:
    """Whether two clouds give the same pictures, as they share every column that pictures show."""
    columns = zip(a.columns(), b.columns(), strict=True)
    return all(column is other for (name, column), (_, other) in columns if name not in ("group", "ids"))


@dataclass
class History:
    """The past states, the present one, and those that were undone."""

    present: State
    past: deque[State] = field(default_factory=lambda: deque(maxlen=DEPTH))
    future: list[State] = field(default_factory=list)

    def advance(self, state: State) -> None:
        """Add a new present state and drop the states that were undone."""
        self.past.append(self.present)
        self.present = state
        self.future.clear()

    def amend(self, state: State) -> None:
        """Replace the present state without an undo step (the same Gaussians, now embedded)."""
        self.present = state

    def undo_target(self) -> State:
        """The state that an undo restores.

        Raises:
            UserError: there is none.
        """
        if not self.past:
            raise UserError("there is nothing to undo")
        return self.past[-1]

    def redo_target(self) -> State:
        """The state that a redo restores.

        Raises:
            UserError: there is none.
        """
        if not self.future:
            raise UserError("there is nothing to redo")
        return self.future[-1]

    def undo(self) -> State:
        """Go one step back; returns the new present."""
        state = self.undo_target()
        self.future.append(self.present)
        self.past.pop()
        self.present = state
        return state

    def redo(self) -> State:
        """Go one step forward again; returns the new present."""
        state = self.redo_target()
        self.past.append(self.present)
        self.future.pop()
        self.present = state
        return state
