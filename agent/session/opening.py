"""Opens a session on a scene file: loads the scene, reuses its saved language field if it matches, reports repairs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from .. import startup
from ..terminal.output import terminal
from .embedding import embedded_by, told_anew

if TYPE_CHECKING:
    from ...gaussians.effort import Dial
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.scene import Frame, Scene
    from ...gaussians.tiles.store import Tiles
    from .session import Progress, Session


@dataclass(frozen=True)
class SessionOptions:
    """Options of a session on a scene file.

    Attributes:
        path: scene file or folder.
        planner, encoder: names of back ends.
        view, size: the viewer, as `pictures.named_cameras.choose_view` takes them.
        log: session log to append to, or None.
        seed: varies the assets that are inserted.
        pixel_checks: compare the viewer's pictures before and after each operation.
        budget: what language models may cost, or None.
        picture: send the viewer's picture to language models.
        judge: who judges edits, or None.
        vlm: a vision model, as `Session` takes it.
        accept_unconfirmed: edit without asking what was chosen although its name is not confirmed.
        assets: folder of the user's own assets, or None.
        infill: what fills the surfaces that an edit reveals: "scene", "none", or a model that inpaints pictures.
        capture: photographs that the scene was fitted from, or None.
        restyle: a model that paints views of what is restyled, or None.
        references: photographs of materials that instructions name.
        reference_width: metres that each of them shows from left to right, or None.
        harmony: fit what is put into the scene to its light, and let it cast shadows.
        dial: chooses settings of the session, or None.
        tiled: read a scene in tiles by windows and edit it where it lies; else it is read whole.
        outline: Gaussians that are seen of a scene in tiles between instructions; None: few.
        up, metres_per_unit: the scene's frame as the user gives it; a saved field made in another frame is not used,
            unless `saved_names`.
        saved_names: take a saved field in whatever frame it was made; only a scale that is given replaces its own.
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
    judge: str | None = None
    vlm: str = "auto"
    accept_unconfirmed: bool = False
    assets: str | None = None
    infill: str = "scene"
    capture: Path | None = None
    restyle: str | None = None
    references: Sequence[Path] = ()
    reference_width: float | None = None
    harmony: bool = True
    dial: Dial | None = None
    tiled: bool = False
    outline: int | None = None
    saved_names: bool = False


def open_session(options: SessionOptions, progress: Progress | None = None) -> tuple[Session, bool]:
    """A session on the scene, and whether it has a saved language field.

    Args:
        progress: called during long work; by default it is drawn on the terminal.

    Raises:
        FileError: the scene or the capture cannot be read.
        UserError: the view, size, planner or budget is not valid.
        BackendError: a package, key or file that the planner needs is missing.
    """
    from ...gaussians.tiles.store import Tiles, is_tiles
    from ..pictures.named_cameras import choose_view
    from .own_references import own_references

    photographs = own_references(options.references, options.reference_width)  # a bad file is told first
    make, encoder, had_field = (
        _on_tiles(Tiles.open(options.path), options) if options.tiled and is_tiles(options.path) else _on_file(options)
    )
    session = make(
        planner=options.planner,
        encoder=encoder,
        log=options.log,
        progress=progress or terminal.progress,
        seed=options.seed,
        pixel_checks=options.pixel_checks,
        budget=options.budget,
        pictures=options.picture,
        judge=options.judge,
        vlm=options.vlm,
        accept_unconfirmed=options.accept_unconfirmed,
        assets=options.assets,
        infill=options.infill,
        capture=options.capture,
        restyle=options.restyle,
        references=photographs,
        harmony=options.harmony,
        effort=options.dial,
    )
    for note in session.log_notes:
        terminal.say(f"note: {note}")
    if options.view != "auto" or options.size is not None:
        session.viewer = choose_view(session.scene, options.view, options.size)
    startup.end()
    return session, had_field


Made = tuple[Callable[..., "Session"], "str | Encoder", bool]  # makes the session; its encoder; whether it has a field


def _on_file(options: SessionOptions) -> Made:
    """How to make a session on a scene file."""
    from ...gaussians.files import load_with_report
    from ..pictures.named_cameras import with_frame
    from .session import Session

    loaded, report = load_with_report(options.path)
    for note in report.notes:
        terminal.say(f"note: {note}")
    scene = with_frame(loaded, options.up, options.metres_per_unit)
    scene, encoder = _with_saved_field(loaded, scene, options)
    return partial(Session, scene), encoder, scene.language is not None


def _on_tiles(tiles: Tiles, options: SessionOptions) -> Made:
    """How to make a session on a scene in tiles.

    Raises:
        UserError: the options are for scenes that fit into memory.
    """
    from ...gaussians.errors import UserError
    from ...gaussians.tiles.budget import memory
    from .tiled import SAMPLE, TiledSession

    given = {"--up": options.up, "--metres-per-unit": options.metres_per_unit, "--capture": options.capture}
    if said := [name for name, value in given.items() if value is not None]:
        raise UserError(
            f"{said[0]} is for scenes that are read whole: give it when the files are embedded, then tile them"
        )
    return (
        partial(TiledSession, tiles, memory(), options.outline or SAMPLE),
        options.encoder,
        tiles.state.table is not None,
    )


def _with_saved_field(loaded: Scene, scene: Scene, options: SessionOptions) -> tuple[Scene, str | Encoder]:
    """The scene with its saved field, named anew if that was made with another encoder; and the encoder, loaded only if
    needed. `scene` is `loaded` in the frame that the user gave; a field that was made in another frame is not used, but
    with `saved_names`."""
    from ...gaussians.language import encoders
    from ...gaussians.language.field.store import load_field, mismatch

    embedded = load_field(loaded, options.path)
    if embedded is None or embedded.language is None:
        if (why := mismatch(options.path)) is not None:
            again = f"embedding again when words need it; `scenewright embed {options.path}` saves the new one"
            terminal.say(f"note: the language field beside {options.path} {why}: {again}")
        return scene, options.encoder
    encoder, table = encoders.load(options.encoder), embedded.language
    if options.saved_names:
        embedded = embedded.replace(frame=_scaled(embedded.frame, scene.frame))
    elif not _agrees(scene.frame, embedded.frame):
        again = (
            f"embedding again when words need it; `scenewright embed {options.path}` with the same options saves that"
        )
        terminal.say(f"note: the language field beside {options.path} was made with another up or scale: {again}")
        return scene, encoder
    if table.encoder == encoder.fingerprint:
        return embedded, encoder
    again = "(--encoder chooses that one, `scenewright embed` saves the new names)"
    terminal.say(f"note: {told_anew(table)} {again}")
    startup.end()  # this renders, and may take long
    return embedded_by(encoder, embedded, terminal.progress), encoder


def _scaled(frame: Frame, said: Frame) -> Frame:
    """A frame with the scale of another one, if the user gave that."""
    if said.scale_source != "given":
        return frame
    return replace(frame, metres_per_unit=said.metres_per_unit, scale_source="given")


def _agrees(said: Frame, saved: Frame) -> bool:
    """Whether the frame of a saved field matches what the user gave of the frame."""
    up = said.up_source != "given" or max(abs(a - b) for a, b in zip(said.up, saved.up, strict=True)) < 1e-6
    return up and (said.scale_source != "given" or said.metres_per_unit == saved.metres_per_unit)
