"""A user's folder of assets: find meshes and splats by their file names, and by captions and tags in `index.json`.

The files themselves are read by `gaussians.assets.modeling.imported`.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from ...gaussians.assets.modeling import imported
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.camera import Vec3
from ...gaussians.color import Rgb, shade_of
from ...gaussians.errors import FileError, UserError
from ...gaussians.world import kinds
from .label_encoder import agreement

SUFFIXES = (".glb", ".ply")
SAME_NAME = 0.45  # least agreement (label_encoder.py) of a file's name that equals the label or is a synonym of it
SIMILAR_NAME = 0.25  # least agreement of a substitute: a name with the same head, or a broader word
MOST_FILES = 5000
_OFF = 1.8  # factor by which a thing may be larger or smaller than the usual things of its kind
_SMALLEST, _LARGEST = 0.02, 6.0  # metres, longest side of a thing of unknown kind
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=\d)|[_\-.]+")


class Entry(BaseModel):
    """The entry of a file in the index.

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
class FolderAsset:
    """The folder's asset for a name, or None, and notes for the user."""

    asset: Asset | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class AssetFolder:
    """The assets of a folder.

    Attributes:
        files: by path, sorted.
        index: entries of the index, by the file's path in the folder.
    """

    folder: Path
    files: tuple[Path, ...]
    index: dict[str, Entry]

    @classmethod
    def read(cls, folder: Path) -> Self:
        """The assets in a folder and its subfolders; only the index is opened.

        Raises:
            UserError: there is no such folder, or no asset in it.
            FileError: the index is not valid.
        """
        if not folder.is_dir():
            raise UserError(f"{folder} is no folder; give one that holds .glb or .ply files")
        found = sorted(p for p in folder.rglob("*") if p.suffix.lower() in SUFFIXES and p.is_file())[:MOST_FILES]
        if not found:
            raise UserError(f"there is no .glb or .ply file in {folder}; give another folder, or none")
        return cls(folder, tuple(found), _read_index(folder / "index.json"))

    @cached_property
    def _names(self) -> tuple[tuple[str, Path], ...]:
        """Every name of a file (file name, caption, tags), with the file."""
        out = []
        for path in self.files:
            entry = self._entry(path)
            plain = " ".join(_CAMEL.sub(" ", path.stem).lower().split())
            out += [(name, path) for name in (plain, entry.caption, *entry.tags) if name.strip()]
        return tuple(out)

    def _entry(self, path: Path) -> Entry:
        return self.index.get(path.relative_to(self.folder).as_posix()) or self.index.get(path.name) or Entry()

    def ranked(self, label: str, least: float) -> list[Path]:
        """Files that may be called `label`, the best agreement first, then by path."""
        scores = agreement(label, [name for name, _ in self._names]) if label else []
        best: dict[Path, float] = {}
        for (_, path), score in zip(self._names, scores, strict=False):
            best[path] = max(best.get(path, 0.0), score)
        return sorted((p for p, s in best.items() if s >= least), key=lambda p: (-best[p], p))

    def take(self, label: str, size: Vec3, tint: Rgb | None, exact: bool) -> FolderAsset:
        """The asset with the name `label`, fitted to `size`; if a file cannot be read, the next best is tried.

        Args:
            tint: its new colour; None leaves its own.
            exact: accept only this name or a synonym, because the asset library can make the thing too.
        """
        notes: list[str] = []
        for path in self.ranked(label, SAME_NAME if exact else SIMILAR_NAME)[:3]:
            try:
                return FolderAsset(imported.read(path, size, label, self._entry(path).up, tint), tuple(notes))
            except FileError as error:
                notes.append(f"passed over {path.name}: {error}")
        return FolderAsset(None, tuple(notes))

    def natural(self, name: str, color: str | None) -> tuple[Asset | None, tuple[str, ...]]:
        """The asset called `name` in its own proportions, metres, None if no file is called so; and notes.

        A size that is not plausible for its kind is taken for another unit, and the asset is scaled as a whole.

        Raises:
            UserError: the colour is unknown.
        """
        tint = shade_of(color) if color else None
        notes: list[str] = []
        for path in self.ranked(name, SAME_NAME)[:3]:
            try:
                up = self._entry(path).up
                size, scaled = _plausible(imported.natural_size(path, up), name)
                told = (*notes, f"{name}: {path.name} of your assets{scaled}")
                return imported.read(path, size, name, up, tint), told
            except FileError as error:
                notes.append(f"passed over {path.name}: {error}")
        return None, tuple(notes)


def _plausible(size: Vec3, name: str) -> tuple[Vec3, str]:
    """The size as it is if a thing of this name may have it in metres, else scaled as a whole; and how it was scaled,
    as the end of a sentence."""
    kind = kinds.find(name)
    if kind is None:
        factor = 1.0 if _SMALLEST <= max(size) <= _LARGEST else 1.0 / max(size)
        about = "to 1 m, as its own size is none of a thing in a room"
    else:
        usual = [math.sqrt(max(low, 0.01) * max(high, 0.01)) for low, high in kind.size]
        factor = math.exp(sum(math.log(u / max(s, 0.01 * max(size))) for u, s in zip(usual, size, strict=True)) / 3)
        factor = 1.0 if 1 / _OFF <= factor <= _OFF else factor
        about = f"to the usual size of a {kind.name}"
    if factor == 1.0:
        return size, ""
    w, d, h = (factor * side for side in size)
    return (w, d, h), f", scaled by {factor:.3g} {about}"


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
