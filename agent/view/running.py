"""Opens the session of `scenewright view`, with its log and what was not saved the last time, and serves it."""

from __future__ import annotations

import hashlib
import os
from dataclasses import replace
from pathlib import Path

from ...gaussians.errors import FileError
from ..output_files import folder_of
from ..session.opening import SessionOptions, open_session
from ..session.restoring import restore, unfinished
from ..session.session import Progress
from ..terminal.output import terminal
from ..toolbox.folder import Folder
from .hub import Hub
from .preview import coarse_level
from .serving import serve


def run(options: SessionOptions, *, port: int, open_page: bool, anew: bool) -> None:
    """Serve a scene until the process is stopped.

    Args:
        anew: do not make the edits again that the log holds and that were not saved.

    Raises:
        UserError, FileError, BackendError: as `open_session`; or the port cannot be used.
    """
    relay = Relay()
    log = options.log or default_log(options.path)
    session, embedded = open_session(replace(options, log=log), relay)
    earlier = None if log is None else unfinished(log)
    if anew and earlier is not None:
        session.point(None)  # the log then holds something that is later than those edits
        earlier = None
    begin = None if earlier is None else lambda: restore(session, earlier, lambda note: terminal.say(f"note: {note}"))
    try:
        coarse = coarse_level(options.path)
    except FileError as error:  # the scene itself is there
        terminal.say(f"note: no coarse picture comes first: {error}")
        coarse = None
    hub = Hub(
        session, options.path.name, Folder(folder_of(options.path)), keep_field=embedded, coarse=coarse, begin=begin
    )
    relay.to = hub.progress
    serve(hub, port, open_page=open_page)
    if log is not None and session.done and any(s.scene.cloud is not session.scene.cloud for s in session.states):
        terminal.say(f"what was not saved is in {log}; `scenewright view {options.path}` makes it again")


class Relay:
    """Passes the progress of a session on to the hub, which is made after it.

    Attributes:
        to: who is told; by default the terminal.
    """

    def __init__(self) -> None:
        self.to: Progress = terminal.progress

    def __call__(self, stage: str, share: float) -> None:
        self.to(stage, share)


def default_log(scene: Path) -> Path | None:
    """The log of a scene in the user's folder for state; None if that cannot be made or written."""
    root = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "scenewright" / "view"
    try:
        root.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError:
        return None
    place = os.path.realpath(scene)
    return (
        root / f"{scene.stem[:60]}-{hashlib.sha256(place.encode()).hexdigest()[:10]}.jsonl"
        if os.access(root, os.W_OK)
        else None
    )
