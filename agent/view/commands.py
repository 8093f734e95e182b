"""Slash commands that are typed into the page: those of the chat, what they show told as the answer to one message."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from ...gaussians.errors import UserError
from ..session.dialogue import Said
from ..toolbox.saving import SaveArguments, save_scene
from .gallery import Gallery

if TYPE_CHECKING:
    from pathlib import Path

    from ...gaussians.camera import Camera
    from ..pictures.scene_pictures import Picture
    from ..session.dialogue import Dialogue
    from ..session.result import Result
    from ..toolbox.tool import Desk

LONGEST = 200  # characters of the name of a file
_CLOSE = (
    "close the tab to leave; Ctrl-C where `scenewright view` was started ends the server, and its log keeps all steps"
)


@dataclass
class Told:
    """What a command shows.

    Attributes:
        texts: paragraphs, in order.
        results: of the edits that it made.
        pictures: paths of pictures.
        camera: where it looks now; None: where it looked before.
    """

    texts: list[str] = field(default_factory=list)
    results: list[Result] = field(default_factory=list)
    pictures: list[str] = field(default_factory=list)
    camera: Camera | None = None


class PageCommands:
    """A page as slash commands see it (`slash_commands.Conversation`): files are in the folder of the scene."""

    elsewhere: ClassVar[Mapping[str, str]] = {"/quit": _CLOSE}

    def __init__(self, desk: Desk, dialogue: Dialogue, gallery: Gallery) -> None:
        self.session = desk.session
        self.dialogue = dialogue
        self._desk = desk
        self._gallery = gallery
        self._told = Told()

    def run(self, line: str) -> Told:
        """Run a line that begins with a slash; raises as `run_command`."""
        from ..terminal.slash_commands import run_command

        self._told = Told()
        run_command(self, line)
        return self._told

    # -- what commands use -------------------------------------------------------------------------------------------

    def tell(self, text: str, data: dict[str, Any]) -> None:
        """Answer with a text."""
        self._told.texts.append(text)

    def note(self, text: str) -> None:
        """Add a remark."""
        self._told.texts.append(f"note: {text}")

    def table(self, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
        """A line for each row; the page is too narrow for columns."""
        return "\n".join(" · ".join(str(cell) for cell in row) for row in rows)

    def show_result(self, result: Result) -> None:
        """Answer with a result."""
        said: Said = self.dialogue.edited(result)
        self._told.texts.append(said.text)
        self._told.results.append(result)

    def show_picture(self) -> None:
        """Look from the session's viewer."""
        from ..pictures.named_cameras import view_text

        self._told.camera = self.session.viewer
        self._told.texts.append(f"this view is {view_text(self.session.viewer)}")

    def show_image(self, image: Picture) -> None:
        """Answer with a picture."""
        from ..pictures.image_files import encoded_png

        self._told.pictures.append(self._gallery.add(lambda: encoded_png(image)))

    def file(self, name: str) -> Path:
        """A file in the folder of the scene. Raises UserError if the name leads out of it, or is too long."""
        if len(name) > LONGEST:
            raise UserError(f"the name of a file has at most {LONGEST} characters")
        if self._desk.folder is None:
            raise UserError("there is no folder for files here")
        return self._desk.folder.file(name)

    def save(self, name: str, force: bool) -> str:
        """Write the scene into its folder; returns what is told of it."""
        self.file(name)
        return save_scene(self._desk, SaveArguments(file=name, force=force)).text

    def end(self) -> None:
        """Pages are closed by who looks at them (`elsewhere`)."""
        raise UserError(_CLOSE)
