"""From a path on the command line to a session: load, take the saved language field if it fits, tell of repairs.

Knows files and options. Refuses to know what is done with the session.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.scene import Frame, Scene
    from .session import Session


@dataclass(frozen=True)
class Opening:
    """How a scene is to be opened.

    Attributes:
        path: scene file or folder.
        planner, encoder: names of back ends.
        view, size: the viewer, as `views.choose_view` takes them.
        log: session log to append to, or None.
        seed: what varies between two inserted things of a kind.
        pixel_checks: compare the viewer's pictures before and after each operation.
        budget: what language models may cost, or None.
        picture: let them see the viewer's picture.
        up, metres_per_unit: what the user says of the scene's frame; a saved field made for another is not used.
    """

    path: Path
    planner: str = "auto"
    encoder: str = "auto"
    view: str = "auto"
    size: str | None = None
    log: Path | None = None
    seed: int = 0
    pixel_checks: bool = False
    up: str | None = None
    metres_per_unit: float | None = None
    budget: str | None = None
    picture: bool = False


def open_session(opening: Opening) -> tuple[Session, bool]:
    """A session over the scene, and whether it came with a saved language field.

    Raises:
        FileError: the scene cannot be read.
        UserError: the view or size is none; there is no such planner or budget.
        BackendError: the planner that was named lacks something.
    """
    from ...gaussians.files import load_with_report
    from ..pictures.named_cameras import choose_view, with_frame
    from .session import Session

    loaded, report = load_with_report(opening.path)
    for note in report.notes:
        terminal.say(f"note: {note}")
    scene = with_frame(loaded, opening.up, opening.metres_per_unit)
    scene, encoder = _with_saved_field(loaded, scene, opening)
    session = Session(
        scene,
        planner=opening.planner,
        encoder=encoder,
        log=opening.log,
        progress=terminal.progress,
        seed=opening.seed,
        pixel_checks=opening.pixel_checks,
        budget=opening.budget,
        pictures=opening.picture,
    )
    if opening.view != "auto" or opening.size is not None:
        session.viewer = choose_view(session.scene, opening.view, opening.size)
    return session, scene.language is not None


def _with_saved_field(loaded: Scene, scene: Scene, opening: Opening) -> tuple[Scene, str | Encoder]:
    """The scene with its saved field if there is one of this encoder; and the encoder, loaded if it had to be.

    `scene` is `loaded` in the frame that the user gave; a field that was made in another is not used.
    """
    from ...gaussians.language import encoders
    from ...gaussians.language.field.store import load_field, mismatch

    embedded = load_field(loaded, opening.path)
    if embedded is None or embedded.language is None:
        if (why := mismatch(opening.path)) is not None:
            again = f"embedding again when words need it; `scenewright embed {opening.path}` keeps the new one"
            terminal.say(f"note: the language field beside {opening.path} {why}: {again}")
        return scene, opening.encoder
    encoder = encoders.load(opening.encoder)
    if not _agrees(scene.frame, embedded.frame):
        return scene, encoder
    if embedded.language.encoder == encoder.fingerprint:
        return embedded, encoder
    made_by = embedded.language.encoder
    terminal.say(f"note: the saved language field is of encoder {made_by}; embedding again (--encoder takes that one)")
    return scene, encoder


def _agrees(said: Frame, saved: Frame) -> bool:
    """Whether a field's frame is what the user said of it, as far as anything was said."""
    up = said.up_source != "given" or max(abs(a - b) for a, b in zip(said.up, saved.up, strict=True)) < 1e-6
    return up and (said.scale_source != "given" or said.metres_per_unit == saved.metres_per_unit)
