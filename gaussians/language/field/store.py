"""Save and load a language field: one safetensors file with the table as JSON in its header, no pickle.

A field is bound to the content of its scene file: the header holds `fingerprint(scene file)`, and a field whose scene
file has changed is not loaded. It is stored beside the scene, or in the user's cache if that folder is read-only.

A packed field holds the same in a fraction of the bytes: vectors of the groups that have one, and the table and the
group of every Gaussian compressed without loss.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import TypeAdapter

from ...errors import FileError, ScenewrightError, UserError
from ...files.atomic import writing
from ...files.fingerprint import fingerprint
from ...files.formats.streamed_sog import scene_folder
from ...scene import Frame, Scene
from ...user_cache import user_cache
from .language_field import Group, LanguageField
from .making import Making

SUFFIX = ".field.safetensors"
VERSION = "6"
PACKED_VERSION = "7"  # of packed fields, which readers of the other one do not know
PACKED = ("groups", "notes", "making", "frame")  # of the header, compressed in a packed field
MOST_TABLE = 1 << 28  # bytes of an unpacked table
Tensors = dict[str, torch.Tensor]
Header = dict[str, Any]
_ENTRY = "scenewright.field"
_GROUPS = TypeAdapter(tuple[Group, ...])
_NOTES = TypeAdapter(tuple[str, ...])
_MAKING = TypeAdapter(Making | None)
_FRAME = TypeAdapter(Frame)


def field_path(scene_path: Path) -> Path:
    """Path of the field beside a scene file or folder."""
    scene_path = scene_folder(scene_path)
    return scene_path.with_name(scene_path.name + SUFFIX)


def cached_field_path(scene_fingerprint: str) -> Path:
    """Path of the field in the user's cache."""
    return user_cache("fields", scene_fingerprint + SUFFIX)


def save_field(scene: Scene, scene_path: Path, packed: bool = False) -> Path:
    """Write the field of `scene`, whose cloud equals that of the file `scene_path` row for row; returns its path.

    Args:
        packed: compressed without loss.

    Raises:
        FileError: the scene has no field, or neither its folder nor the cache can be written.
    """
    if scene.language is None:
        raise FileError("this scene has no language field to save; embed it first")
    return save_table(scene.language, scene.cloud.group.cpu().contiguous(), scene.frame, scene_path, packed)


def save_table(table: LanguageField, group: torch.Tensor, frame: Frame, scene_path: Path, packed: bool = False) -> Path:
    """Write a field without the scene that it is of; see `save_field`.

    Args:
        group: `[N]` int32, of each row of the file `scene_path`.
    """
    mark = fingerprint(scene_path)
    header = {
        "version": VERSION,
        "scene": mark,
        "encoder": table.encoder,
        "groups": [asdict(g) for g in table.groups],
        "notes": table.notes,
        "making": None if table.making is None else asdict(table.making),
        "frame": asdict(frame),
    }
    tensors = {
        "group": group,
        "embeddings": torch.from_numpy(np.ascontiguousarray(table.embeddings, dtype=np.float32)),
    }
    if packed:
        tensors, header = _packed(tensors, header)
    problem: Exception | None = None
    for target in (field_path(scene_path), cached_field_path(mark)):
        try:
            return _write(target, tensors, header)
        except (OSError, FileError, UserError) as error:
            problem = error
    raise FileError(f"cannot save the language field of {scene_path}: {problem}") from problem


def load_field(scene: Scene, scene_path: Path, encoder: str | None = None) -> Scene | None:
    """`scene`, just loaded from `scene_path`, with its saved field; None if no field matches. A scene that is stored
    with its field (tiles) has it already.

    A field matches if it was made for these bytes of the scene file and, if `encoder` is given, with that encoder. Of
    two that match the newer is loaded: if the folder of the scene has become read-only, that is the one in the cache.

    Raises:
        FileError: a field file exists but is damaged.
    """
    if scene.language is not None:
        return scene
    mark = fingerprint(scene_path)
    existing = [target for target in (field_path(scene_path), cached_field_path(mark)) if target.is_file()]
    for target in sorted(existing, key=lambda path: -path.stat().st_mtime_ns):
        tensors, header = _read(target)
        fits = header.get("version") in (VERSION, PACKED_VERSION) and header.get("scene") == mark
        if fits and (encoder is None or header.get("encoder") == encoder):
            if header["version"] == PACKED_VERSION:
                tensors, header = _unpacked(tensors, header, len(scene.cloud), target)
            return _attach(scene, tensors, header, target)
    return None


def mismatch(scene_path: Path, encoder: str | None = None) -> str | None:
    """Why the field beside a scene file cannot be used, as the predicate of a sentence; None if it can, or if there is
    none.

    Raises:
        FileError: the scene or the field cannot be read.
    """
    target = field_path(scene_path)
    if not target.is_file():
        return None
    header = _header(target)
    if header.get("scene") != fingerprint(scene_path):
        return "was made for another version of this file"
    if header.get("version") not in (VERSION, PACKED_VERSION):
        return "was written by another version of scenewright"
    if encoder is not None and header.get("encoder") != encoder:
        return f"is of encoder {header.get('encoder')}"
    return None


def _header(path: Path) -> dict[str, Any]:
    """The metadata of a field file, without its tensors."""
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="pt") as stream:
            return dict(json.loads((stream.metadata() or {}).get(_ENTRY, "{}")))
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise FileError(f"{path} is not a language field ({error}); delete it and embed the scene again") from error


def _write(target: Path, tensors: dict[str, torch.Tensor], header: dict[str, Any]) -> Path:
    """Write a field file. It has one metadata entry, because safetensors writes several in no fixed order."""
    from safetensors.torch import save

    target.parent.mkdir(parents=True, exist_ok=True)
    with writing(target, force=True) as stream:
        stream.write(save(tensors, {_ENTRY: json.dumps(header)}))
    return target


def _packed(tensors: Tensors, header: Header) -> tuple[Tensors, Header]:
    """The tensors and the header of a packed field; `_unpacked` is the inverse."""
    vectors = tensors["embeddings"]
    encoded = torch.nonzero((vectors != 0).any(dim=1)).squeeze(1).to(torch.int32)
    table = json.dumps({name: header[name] for name in PACKED}).encode()
    planes = np.ascontiguousarray(tensors["group"].numpy().astype("<i4")).view(np.uint8).reshape(-1, 4).T
    small: Tensors = {
        "table": _deflated(table),
        "planes": _deflated(planes.tobytes()),
        "encoded": encoded,
        "vectors": vectors[encoded.long()].contiguous(),
    }
    rest = {name: value for name, value in header.items() if name not in PACKED}
    return small, rest | {"version": PACKED_VERSION, "groups_listed": len(vectors)}


def _unpacked(tensors: Tensors, header: Header, count: int, source: Path) -> tuple[Tensors, Header]:
    """The tensors and the header of a field of `count` Gaussians.

    Raises:
        FileError: the field is damaged.
    """
    try:
        planes = np.frombuffer(_inflated(tensors["planes"], 4 * count), np.uint8).reshape(4, count)
        group = np.ascontiguousarray(planes.T).view("<i4")[:, 0].astype(np.int32)
        table = json.loads(_inflated(tensors["table"], MOST_TABLE))
        listed, vectors, encoded = int(header["groups_listed"]), tensors["vectors"], tensors["encoded"].long()
        if listed != len(table["groups"]) or vectors.ndim != 2 or vectors.dtype != torch.float32:
            raise ValueError("its vectors do not fit its table")
        embeddings = torch.zeros(listed, vectors.shape[1])
        embeddings[encoded] = vectors
        return {"group": torch.from_numpy(group), "embeddings": embeddings}, header | {n: table[n] for n in PACKED}
    except (KeyError, TypeError, ValueError, IndexError, RuntimeError, RecursionError, zlib.error) as error:
        raise FileError(f"{source} is damaged ({error}); delete it and embed the scene again") from error


def _deflated(data: bytes) -> torch.Tensor:
    return torch.from_numpy(np.frombuffer(zlib.compress(data, 9), np.uint8).copy())


def _inflated(data: torch.Tensor, most: int) -> bytes:
    """The bytes that were deflated, at most `most`; raises zlib.error or ValueError if they are others or more."""
    inflater = zlib.decompressobj()
    out = inflater.decompress(data.numpy().tobytes(), most)
    if not inflater.eof:
        raise ValueError("a part of it is cut off or larger than this scene needs")
    return out


def _read(path: Path) -> tuple[dict[str, torch.Tensor], dict[str, Any]]:
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="pt") as stream:
            header = json.loads((stream.metadata() or {}).get(_ENTRY, "{}"))
            return {name: stream.get_tensor(name) for name in stream.keys()}, dict(header)  # noqa: SIM118
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise FileError(f"{path} is not a language field ({error}); delete it and embed the scene again") from error


def _attach(scene: Scene, tensors: dict[str, torch.Tensor], header: dict[str, Any], source: Path) -> Scene:
    if "group" not in tensors:
        raise FileError(f"{source} is damaged (it has no groups); delete it and embed the scene again")
    table, frame = _table(tensors, header, source)
    column = tensors["group"]
    fits = (column.shape, column.dtype) == ((len(scene.cloud),), torch.int32) and column_fits(column.numpy(), table)
    if not fits:
        raise FileError(f"{source} is damaged (its columns do not fit); delete it and embed the scene again")
    if scene.frame.up_source == "given":  # a direction given now takes precedence over the saved estimate
        frame = scene.frame
    return scene.replace(cloud=scene.cloud.replace(group=column), language=table, frame=frame)


def column_fits(column: NDArray[np.int32], table: LanguageField) -> bool:
    """Whether all numbers in a column of groups are of a table, or `NO_GROUP`."""
    return not len(column) or -1 <= int(column.min()) <= int(column.max()) < len(table.groups)


def _table(tensors: Tensors, header: Header, source: Path) -> tuple[LanguageField, Frame]:
    """The table in a field file, and its frame."""
    try:
        groups = _GROUPS.validate_python(header["groups"])
        notes = _NOTES.validate_python(header["notes"])
        making = _MAKING.validate_python(header["making"])
        frame = _FRAME.validate_python(header["frame"])
        embeddings = tensors["embeddings"]
        table = LanguageField(groups, embeddings.numpy(), str(header["encoder"]), notes, making)
        fits = (
            (embeddings.ndim, embeddings.dtype) == (2, torch.float32)
            and bool(embeddings.isfinite().all())
            and all(-1 <= g.parent < len(groups) for g in groups)
        )
    except (KeyError, TypeError, ValueError, ScenewrightError) as error:
        raise FileError(f"{source} is damaged ({error}); delete it and embed the scene again") from error
    if not fits:
        raise FileError(f"{source} is damaged (its columns do not fit); delete it and embed the scene again")
    return table, frame


@dataclass(frozen=True, eq=False)
class SlicedField:
    """A saved field whose column of groups is read a piece at a time, for scenes that do not fit into memory.

    Attributes:
        table: without the column.
        frame: that it was made in.
        rows: length of the column.
        column: its entries from one row to another, `[M]` int32.
    """

    table: LanguageField
    frame: Frame
    rows: int
    column: Callable[[int, int], NDArray[np.int32]]


def sliced_field(scene_path: Path, rows: int) -> SlicedField | None:
    """The field that was saved for a scene file of so many Gaussians, None if there is none.

    Raises:
        FileError: it exists but is damaged.
    """
    from safetensors import SafetensorError, safe_open

    mark = fingerprint(scene_path)
    targets = [t for t in (field_path(scene_path), cached_field_path(mark)) if t.is_file()]
    for target in targets:
        header = _header(target)
        if header.get("scene") != mark or header.get("version") not in (VERSION, PACKED_VERSION):
            continue
        if header["version"] == PACKED_VERSION:
            tensors, header = _unpacked(*_read(target), rows, target)
            whole: NDArray[np.int32] = tensors["group"].numpy()
            return SlicedField(*_table(tensors, header, target), len(whole), partial(_slice, whole))
        try:
            stream: Any = safe_open(target, framework="numpy")
            vectors = {"embeddings": torch.from_numpy(stream.get_tensor("embeddings"))}
            column = stream.get_slice("group")
            return SlicedField(*_table(vectors, header, target), column.get_shape()[0], partial(_slice, column))
        except SafetensorError as error:
            raise FileError(f"{target} is damaged ({error}); delete it and embed the scene again") from error
    return None


def _slice(column: Any, start: int, end: int) -> NDArray[np.int32]:
    found: NDArray[np.int32] = np.asarray(column[start:end], np.int32)
    return found
