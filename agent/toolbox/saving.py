"""The tool that writes the scene to a file in the folder of the scene."""

from __future__ import annotations

import hashlib
from typing import Annotated

from pydantic import Field

from ...gaussians.errors import UserError
from .limits import Arguments
from .reply import Reply
from .tool import Desk, Hints, Tool, tool


class SaveArguments(Arguments):
    """Arguments of `save`."""

    file: Annotated[str, Field(min_length=1, max_length=400)]
    """Name of the file in the scene's folder; its suffix chooses the format (.ply, .compressed.ply, .spz, .sog)."""
    force: Annotated[bool, Field(strict=True)] = False
    """Overwrite a file that exists."""


def save_scene(desk: Desk, said: SaveArguments) -> Reply:
    """Write the scene to a file in its own folder, completely or not at all; an existing file only with `force`."""
    from ...gaussians.language.field.store import field_path

    if desk.folder is None:
        raise UserError("there is no folder to save to here")
    path = desk.folder.file(said.file)
    if path.exists() and not said.force:
        raise UserError(f"{said.file} exists; choose another name, or overwrite it with force")
    keep = desk.keep_field and desk.session.scene.language is not None
    if keep:
        desk.folder.file(str(field_path(path).relative_to(desk.folder.root)))  # a link must not lead out of the folder
    field = desk.session.save(path, force=said.force, names=keep)
    with open(path, "rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    data = {"verdict": "ok", "file": said.file, "bytes": path.stat().st_size, "sha256": digest}
    if field is not None:
        data["field"] = field.name
    return Reply(f"saved as {said.file} ({data['bytes']:,} bytes)", data)


def saving_tools() -> list[Tool]:
    """The tools of this module."""
    return [tool("save", SaveArguments, Hints(destructive=True, idempotent=True), save_scene, needs_field=False)]
