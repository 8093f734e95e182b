"""The session behind the page: carries messages out one after the other on one thread, and tells all tabs what changed.

    message -> queue -> worker: session -> what is shown -> binary change, state -> every tab; the answer -> its tab

Only the worker touches the session. What tabs read (`shown`, `state`) are values that it replaces as a whole.
"""

from __future__ import annotations

import json
import logging
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import PurePath
from typing import Any, Protocol

import numpy as np

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import ScenewrightError, UserError
from ..session.dialogue import Dialogue
from ..session.history import looks_alike
from ..session.session import Session
from ..toolbox.folder import Folder
from . import state, wire
from .actions import Actions
from .changes import Changes, Shown, changes
from .gallery import Gallery
from .messages import Asked, Frame
from .preview import Preview
from .standalone import page

_log = logging.getLogger(__name__)
RING = 256  # changes that are kept for tabs that come back
RING_SLOTS = 8_000_000  # slots in all of them
WAITING = 256  # messages that wait for the worker; more are refused
MADE = "/made.html"  # where the last page that was made is
BUSY_AFTER = 0.15  # seconds after which work is told
PROGRESS_EVERY = 0.05  # seconds


class Tab(Protocol):
    """What the hub needs of a tab; both may be called from any thread."""

    def tell(self, message: dict[str, Any] | bytes) -> None:
        """Send a message after what is shown: a text message, or a binary one."""

    def wake(self) -> None:
        """Look at what is shown, and send what is missing."""


class Hub:
    """One session and its tabs.

    Args:
        session: the session; from now on only this hub uses it.
        title: of the page.
        folder: where scenes are saved; None: nowhere.
        keep_field: write the language field beside a saved scene.
        coarse: a coarse level of the scene, which tabs show until it has come.
        begin: done on the worker before anything else, such as the edits of a session that was cut off.

    Attributes:
        shown: what the tabs should show.
        state: the text of the present `state` message.
        made: the name and the bytes of the last page that was made of the scene; None: none was.
        gallery: the pictures of answers.
    """

    def __init__(
        self,
        session: Session,
        title: str,
        folder: Folder | None,
        *,
        keep_field: bool = False,
        coarse: GaussianCloud | None = None,
        begin: Callable[[], None] | None = None,
    ) -> None:
        self.session = session
        self.title = title
        self._dialogue = Dialogue(session)
        self.gallery = Gallery()
        self._actions = Actions(self, self._dialogue, folder, keep_field)
        # Revisions of another run of the server are never those of this one.
        self.shown = Shown.first(session.scene, int(time.time() * 1000))
        self._first = self.shown
        large = self.shown.slots.count > wire.CHUNK  # what comes in one message needs no preview
        self._preview = None if coarse is None or not large else Preview.of(coarse, self.shown)
        self.made: tuple[str, bytes] | None = None
        self._state = state.of(session, self.shown)
        self.state = self._told(False)
        self._welcome = state.welcome(session, self.title)
        self._ring: deque[tuple[int, Changes | None]] = deque(maxlen=RING)
        self._delta: tuple[int, int, bytes] = (-1, -1, b"")
        self._tabs: set[Tab] = set()
        self._queue: queue.Queue[tuple[Tab, Asked] | Callable[[], None] | None] = queue.Queue(WAITING)
        self._running: tuple[Tab, int, float] | None = None
        self._told_progress = 0.0
        self._lock = threading.Lock()
        self._worker = threading.Thread(target=self._work, name="scenewright session", daemon=True)
        if begin is not None:
            self._queue.put(begin)

    # -- tabs, from any thread ---------------------------------------------------------------------------------------

    def start(self) -> None:
        """Start the worker."""
        self._worker.start()

    def stop(self, seconds: float = 3.0) -> None:
        """Let the worker end after what it is doing, and close the session; waits at most some seconds."""
        with suppress(queue.Full):
            self._queue.put_nowait(None)
        if self._worker.is_alive():
            self._worker.join(seconds)
        self.session.close()

    def join(self, tab: Tab) -> None:
        """A tab is there."""
        with self._lock:
            self._tabs.add(tab)

    def leave(self, tab: Tab) -> None:
        """A tab is gone; what it asked for is done all the same."""
        with self._lock:
            self._tabs.discard(tab)

    def ask(self, tab: Tab, message: Asked) -> None:
        """Queue a message; its answer goes to the tab."""
        try:
            self._queue.put_nowait((tab, message))
        except queue.Full:
            tab.tell({"type": "error", "id": message.id, "text": "too many messages are waiting; say it again later"})

    def knows(self, revision: int) -> bool:
        """Whether a change from a revision to what is shown is kept."""
        now = self.shown.revision
        kept = list(self._ring)
        return revision == now or any(base == revision for base, _ in kept)

    def welcome(self) -> dict[str, Any]:
        """The `welcome` message."""
        shown = self.shown
        run = self._first.revision  # a tab's conversation belongs to one run of the server
        told = {
            "type": "welcome",
            "run": run,
            "revision": shown.revision,
            "slots": shown.slots.count,
            "degree": shown.degree,
        }
        return {**told, **self._welcome, "digest": self._state["digest"]}

    def load(self, shown: Shown) -> Iterator[bytes]:
        """The messages that tell a tab everything; before any edit a preview comes first."""
        return wire.load(shown, self._preview if shown is self._first else None)

    def change_from(self, revision: int) -> tuple[bytes, Shown] | None:
        """The message that brings a tab at a revision up to date, and what it then shows; None: it needs everything.

        The last one is kept, as all tabs ask for the same.
        """
        shown, ring = self.shown, list(self._ring)
        begin, end, made = self._delta
        if (begin, end) == (revision, shown.revision):
            return made, shown
        missing = [changed for base, changed in ring if revision <= base < shown.revision]
        if len(missing) != shown.revision - revision or any(changed is None for changed in missing):
            return None
        merged: Changes = {}
        for changed in missing:
            for column, slots in (changed or {}).items():
                merged[column] = np.union1d(merged[column], slots) if column in merged else slots
        made = wire.change(shown, revision, merged)
        self._delta = (revision, shown.revision, made)
        return made, shown

    # -- the worker --------------------------------------------------------------------------------------------------

    def progress(self, stage: str, share: float) -> None:
        """Tell all tabs how far the present work is; the session calls it."""
        now = time.monotonic()
        if now - self._told_progress < PROGRESS_EVERY and share < 1:
            return
        self._told_progress = now
        running = self._running
        told = {
            "type": "progress",
            "id": running[1] if running else None,
            "stage": stage,
            "share": min(max(share, 0.0), 1.0),
        }
        for tab in self._everyone():
            tab.tell(told)

    def settle(self) -> None:
        """Show the session's present scene and state to all tabs."""
        scene, before = self.session.scene, self.shown
        if any(getattr(scene, part) is not getattr(before.scene, part) for part in ("cloud", "language", "motion")):
            shown = before.then(scene)
            changed = changes(before, shown)
            if changed or changed is None:
                self._keep(before.revision, changed)
                if changed is not None:
                    self._delta = (before.revision, shown.revision, wire.change(shown, before.revision, changed))
                self.shown = shown
            else:
                self.shown = Shown(before.revision, scene, shown.slots)
        self._wake()
        self._state = state.of(self.session, self.shown)
        self.state = self._told(False)
        self._wake()

    def _work(self) -> None:
        while (job := self._queue.get()) is not None:
            if callable(job):
                self._alone(job)
            else:
                self._answer(*job)
            while self._queue.empty() and self.gallery.draw_next():
                pass

    def _alone(self, job: Callable[[], None]) -> None:
        """Do work that no tab asked for."""
        try:
            job()
        except Exception:  # the page must open all the same
            _log.exception("beginning failed")
        self.settle()

    def _answer(self, tab: Tab, message: Asked) -> None:
        """Carry a message out, and answer it. A fault of ours leaves the scene as it was."""
        self._running = (tab, message.id, time.monotonic())
        timer = threading.Timer(BUSY_AFTER, self._tell_busy)
        timer.daemon = True
        timer.start()
        try:
            answer: dict[str, Any] | bytes = self._actions.do(message)
        except ScenewrightError as error:
            answer = {"type": "error", "text": str(error)}
        except Exception as error:
            _log.exception("message %r failed", type(message).__name__)
            answer = {
                "type": "error",
                "text": f"internal error ({type(error).__name__}); the scene is as it was. Please report it",
            }
        finally:
            timer.cancel()
            self._running = None
        if isinstance(message, Frame) and isinstance(answer, bytes):  # nothing changed that a state tells
            tab.tell(answer)
            return
        try:
            self.settle()
        except Exception:
            _log.exception("the change could not be told; tabs load everything")
            self.shown = Shown.first(self.session.scene, self.shown.revision + 1)
            self._ring.clear()
            self._wake()
        tab.tell(answer if isinstance(answer, bytes) else {**answer, "id": message.id})

    def _tell_busy(self) -> None:
        if self._running is not None:
            self.state = self._told(True)
            self._wake()

    def _told(self, busy: bool) -> str:
        return json.dumps({"type": "state", **self._state, "busy": busy}, ensure_ascii=False, allow_nan=False)

    def _keep(self, base: int, changed: Changes | None) -> None:
        """Keep a change for tabs that come back, and let the oldest go when they are too many."""
        self._ring.append((base, changed))
        while len(self._ring) > 1 and sum(len(s) for _, c in self._ring for s in (c or {}).values()) > RING_SLOTS:
            self._ring.popleft()

    def _everyone(self) -> list[Tab]:
        with self._lock:
            return list(self._tabs)

    def _wake(self) -> None:
        for tab in self._everyone():
            tab.wake()

    def export(self) -> str:
        """Make the scene a page of its own; returns its path on this server, where the last one made is."""
        name = f"{PurePath(self.title).stem}.html"
        self.made = (name, page(self.session.scene, self.session.viewer, self.title))
        return MADE

    def before(self) -> bytes:
        """The `before` message: what turns the present state into the one before the last edit.

        Raises:
            UserError: nothing was edited.
        """
        now = self.session.scene.cloud
        *earlier, _ = self.session.states
        was = next((s.scene for s in reversed(earlier) if not looks_alike(s.scene.cloud, now)), None)
        if was is None:
            raise UserError("nothing was changed yet, so there is nothing to compare with")
        past = self.shown.then(was)
        changed = changes(self.shown, past)
        if changed is None:  # harmonics of another degree: told at the present one
            past = self.shown.then(was.replace(cloud=was.cloud.with_degree(self.shown.degree)))
            changed = changes(self.shown, past)
        told = Shown(self.shown.revision, past.scene, past.slots)
        return wire.change(told, self.shown.revision, changed or {}, "before")
