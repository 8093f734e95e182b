"""The scene that a session works on: how it stands, who looks at it, what lies behind and ahead, and its log.

Knows states, the viewer and the encoder, each made when it is first needed. Refuses to know words: what becomes of an
instruction is the session's, which hands in the state that it leads to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.camera import Camera
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from .clarify import Question
from .history import History, State
from .log_records import Journal
from .result import Result

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder
    from ...tools.operation import Context

Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]


class Workspace:
    """One scene and its past; see `Session` for the arguments.

    Attributes:
        question: which of several things is meant, or what is nearest to one that is not there; None if nothing is
            open.
        pixel_checks: also compare the viewer's picture before and after each operation.

    Raises:
        FileError: the log cannot be opened.
    """

    def __init__(
        self,
        scene: Scene,
        encoder: str | Encoder,
        log: str | Path | None,
        viewer: Camera | None,
        *,
        progress: Progress,
        seed: int,
        pixel_checks: bool,
    ) -> None:
        self._encoder = encoder
        self._viewer = viewer
        self._progress = progress
        self._seed = seed
        self.pixel_checks = pixel_checks
        self._history = History(State(scene))
        self._journal = Journal(log)
        self.question: Question | None = None
        self._journal.opened(self._history.present)

    # -- what it is now ---------------------------------------------------------------------------------------------

    @property
    def scene(self) -> Scene:
        """The scene as it stands."""
        return self._history.present.scene

    @property
    def last(self) -> Selection | None:
        """What "it" means."""
        return self._history.present.last

    @property
    def done(self) -> tuple[str, ...]:
        """The instructions that led to the present scene, oldest first."""
        states = [*self._history.past, self._history.present]
        return tuple(s.text for s in states if s.text)

    @property
    def viewer(self) -> Camera:
        """Whose left and right are meant."""
        if self._viewer is None:
            from ..pictures.named_cameras import default_view

            self._viewer = default_view(self.scene)
        return self._viewer

    @viewer.setter
    def viewer(self, camera: Camera) -> None:
        self._viewer = camera

    @property
    def encoder(self) -> Encoder:
        """The encoder, loaded when first needed."""
        if isinstance(self._encoder, str):
            from ...gaussians.language import encoders

            self._encoder = encoders.load(self._encoder)
        return self._encoder

    def embed(self) -> Scene:
        """The scene with its language field, made now if it has none."""
        if self.scene.language is None:
            from ...gaussians.language.field.embed import embed

            present = self._history.present
            state = replace(present, scene=embed(present.scene, self.encoder, progress=self._progress))
            self._journal.embedded(present, state)
            self._history.amend(state)
        return self.scene

    def _context(self, last: Selection | None) -> Context:
        """What an operation is given besides the scene, where "it" means `last`."""
        from ...tools.operation import Context

        encoder = self.encoder if self.scene.language is not None else None
        return Context(viewer=self.viewer, last=last, encoder=encoder, seed=self._seed, pixel_checks=self.pixel_checks)

    # -- back and forth ---------------------------------------------------------------------------------------------

    def undo(self) -> Result:
        """Take the last instruction back: the scene is again the very value it was.

        Raises:
            UserError: there is nothing to undo.
        """
        return self._step("undo", self._history.behind(), self._history.present.text, self._history.back)

    def redo(self) -> Result:
        """Do again what was taken back.

        Raises:
            UserError: there is nothing to redo.
        """
        ahead = self._history.ahead()
        return self._step("redo", ahead, ahead.text, self._history.forth)

    def _step(self, kind: str, to: State, text: str, move: Callable[[], State]) -> Result:
        before = self._history.present
        self._journal.moved(kind, text, before, to)
        move()
        self.question = None
        return Result(f"{kind}: {text}", None, (), before.scene, to.scene, self.viewer, to.last)

    # -- files ------------------------------------------------------------------------------------------------------

    def save(self, path: str | Path, force: bool = False) -> None:
        """Write the scene to a file; an existing one only with `force`.

        Raises:
            UserError: the file exists, or no format is written under its name.
            FileError: it cannot be written.
        """
        from ...gaussians.files import save

        save(self.scene, path, force=force)
        self._journal.saved(path, self._history.present)

    def close(self) -> None:
        """Close the log."""
        self._journal.close()
