"""A folder of other people's assets: meshes and splats, found by their names, captions and tags.

Knows files' names and an optional `index.json` beside them. Refuses to know what is inside a file (assets/imported.py).
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from ...gaussians.assets.modeling import imported
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.camera import Vec3
from ...gaussians.color import Rgb
from ...gaussians.errors import FileError, UserError
from .label_encoder import agreement

SUFFIXES = (".glb", ".ply")
NAMED = 0.45  # agreement (wordwise.py) from which a file's name is the asked one, or a synonym of it
ALIKE = 0.25  # from which it may stand in for what nothing else is called: the head alone, or a wider word
MOST_FILES = 5000
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=\d)|[_\-.]+")


class Entry(BaseModel):
    """What an index says of a file.

    Attributes:
        caption: what it shows, in a few words.
        tags: other names for it.
        up: the axis of the file that points up; of glTF "y" unless this says otherwise, of others "z".
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    caption: Annotated[str, Field(max_length=400)] = ""
    tags: Annotated[tuple[Annotated[str, Field(max_length=80)], ...], Field(max_length=64)] = ()
    up: Literal["y", "z", ""] = ""


_INDEX = TypeAdapter(dict[Annotated[str, Field(max_length=400)], Entry])


@dataclass(frozen=True)
class Taken:
    """What the folder had for a name: an asset or None, and what is to be told."""

    asset: Asset | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Shelf:
    """The assets of a folder.

    Attributes:
        files: by path, sorted.
        index: what is said of files, by their path in the folder.
    """

    folder: Path
    files: tuple[Path, ...]
    index: dict[str, Entry]

    @classmethod
    def read(cls, folder: Path) -> Self:
        """The assets in a folder and its subfolders; no file is opened but the index.

        Raises:
            UserError: there is no such folder, or no asset in it.
            FileError: the index is none.
        """
        if not folder.is_dir():
            raise UserError(f"{folder} is no folder; give one that holds .glb or .ply files")
        found = sorted(p for p in folder.rglob("*") if p.suffix.lower() in SUFFIXES and p.is_file())[:MOST_FILES]
        if not found:
            raise UserError(f"there is no .glb or .ply file in {folder}; give another folder, or none")
        return cls(folder, tuple(found), _read_index(folder / "index.json"))

    @cached_property
    def _names(self) -> tuple[tuple[str, Path], ...]:
        """Every name a file goes by, with the file."""
        out = []
        for path in self.files:
            entry = self._entry(path)
            plain = " ".join(_CAMEL.sub(" ", path.stem).lower().split())
            out += [(name, path) for name in (plain, entry.caption, *entry.tags) if name.strip()]
        return tuple(out)

    def _entry(self, path: Path) -> Entry:
        inside = path.relative_to(self.folder).as_posix()
        return self.index.get(inside) or self.index.get(path.name) or Entry()

    def ranked(self, label: str, least: float) -> list[Path]:
        """Files that may be called `label`, the best agreement first, then by path."""
        scores = agreement(label, [name for name, _ in self._names]) if label else []
        best: dict[Path, float] = {}
        for (_, path), score in zip(self._names, scores, strict=False):
            best[path] = max(best.get(path, 0.0), score)
        return sorted((p for p, s in best.items() if s >= least), key=lambda p: (-best[p], p))

    def take(self, label: str, size: Vec3, tint: Rgb | None, exact: bool) -> Taken:
        """The asset that is called `label`, fitted to `size`; one that cannot be read gives way to the next.

        Args:
            tint: colour to give it; None leaves its own.
            exact: only what has this very name or a synonym, as there is another way to make one.
        """
        notes: list[str] = []
        for path in self.ranked(label, NAMED if exact else ALIKE)[:3]:
            try:
                return Taken(imported.read(path, size, label, self._entry(path).up, tint), tuple(notes))
            except FileError as error:
                notes.append(f"passed over {path.name}: {error}")
        return Taken(None, tuple(notes))


def _read_index(path: Path) -> dict[str, Entry]:
    if not path.exists():
        return {}
    try:
        if path.stat().st_size > 1 << 24:
            raise FileError(f"{path} is larger than 16 MB; an index holds a few words a file")
        return _INDEX.validate_python(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, RecursionError) as error:
        if isinstance(error, ValidationError):
            first = error.errors()[0]
            where = ".".join(str(part) for part in first["loc"])
            raise FileError(f"{path} is no index of assets: {where}: {first['msg']}") from error
        raise FileError(f"cannot read {path}: {error}") from error
