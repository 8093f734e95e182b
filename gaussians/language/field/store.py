"""The language field on disk: one safetensors file with the table as JSON in its header, no pickle.

It is bound to the scene *file* by content: `fingerprint(scene file)` stands in the header, and a field whose scene
was changed elsewhere is not loaded. It lies beside the scene, or in the user's cache where that folder is read-only.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from pydantic import TypeAdapter

from ...errors import FileError, ScenewrightError, UserError
from ...files.atomic import writing
from ...scene import Frame, Scene
from .language_field import Group, LanguageField

SUFFIX = ".field.safetensors"
VERSION = "5"
_ENTRY = "scenewright.field"
_GROUPS = TypeAdapter(tuple[Group, ...])
_NOTES = TypeAdapter(tuple[str, ...])
_FRAME = TypeAdapter(Frame)


def fingerprint(path: Path) -> str:
    """Hex SHA-256 of a scene file's bytes; of names and bytes of all files where the scene is a folder (SOG)."""
    h = hashlib.sha256()
    try:
        files = sorted(p for p in path.iterdir() if p.is_file()) if path.is_dir() else [path]
        for file in files:
            h.update(f"{file.name};".encode() if path.is_dir() else b"")
            with file.open("rb") as stream:
                while block := stream.read(1 << 22):
                    h.update(block)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    return h.hexdigest()


def beside(scene_path: Path) -> Path:
    """Where the field of a scene file lies when its folder can be written."""
    return scene_path.with_name(scene_path.name + SUFFIX)


def cached(scene_fingerprint: str) -> Path:
    """Where it lies otherwise."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "scenewright" / "fields" / (scene_fingerprint + SUFFIX)


def save_field(scene: Scene, scene_path: Path) -> Path:
    """Write the field of `scene`, whose cloud stands row for row in the file `scene_path`; returns where it went.

    Raises:
        FileError: neither the scene's folder nor the cache can be written.
    """
    if scene.language is None:
        raise FileError("this scene has no language field to save; embed it first")
    mark = fingerprint(scene_path)
    header = {
        "version": VERSION,
        "scene": mark,
        "encoder": scene.language.encoder,
        "groups": [asdict(g) for g in scene.language.groups],
        "notes": scene.language.notes,
        "frame": asdict(scene.frame),
    }
    tensors = {
        "group": scene.cloud.group.cpu().contiguous(),
        "embeddings": torch.from_numpy(np.ascontiguousarray(scene.language.embeddings, dtype=np.float32)),
    }
    problem: Exception | None = None
    for target in (beside(scene_path), cached(mark)):
        try:
            return _write(target, tensors, header)
        except (OSError, FileError, UserError) as error:
            problem = error
    raise FileError(f"cannot save the language field of {scene_path}: {problem}") from problem


def load_field(scene: Scene, scene_path: Path, encoder: str | None = None) -> Scene | None:
    """`scene`, freshly loaded from `scene_path`, with its saved field; None if there is none that fits.

    A field fits when the scene file's bytes are those it was made for and, if given, its encoder is `encoder`. Of two
    that fit the one written last is meant: where the scene's folder cannot be written any more, that is the cache's.

    Raises:
        FileError: a field file is there and bound to this scene, but broken.
    """
    mark = fingerprint(scene_path)
    there = [target for target in (beside(scene_path), cached(mark)) if target.is_file()]
    for target in sorted(there, key=lambda path: -path.stat().st_mtime_ns):
        tensors, header = _read(target)
        fits = header.get("version") == VERSION and header.get("scene") == mark
        if fits and (encoder is None or header.get("encoder") == encoder):
            return _attach(scene, tensors, header, target)
    return None


def misfit(scene_path: Path, encoder: str | None = None) -> str | None:
    """Why the field that lies beside a scene file cannot be used, as the end of a sentence about it; None if it can be
    or if there is none.

    Raises:
        FileError: the scene or the field cannot be read.
    """
    target = beside(scene_path)
    if not target.is_file():
        return None
    header = _header(target)
    if header.get("scene") != fingerprint(scene_path):
        return "was made for another version of this file"
    if header.get("version") != VERSION:
        return "was written by another version of scenewright"
    if encoder is not None and header.get("encoder") != encoder:
        return f"is of encoder {header.get('encoder')}"
    return None


def _header(path: Path) -> dict[str, Any]:
    """The table alone, without the Gaussians' column."""
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="pt") as stream:
            return dict(json.loads((stream.metadata() or {}).get(_ENTRY, "{}")))
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise FileError(f"{path} is not a language field ({error}); delete it and embed the scene again") from error


def _write(target: Path, tensors: dict[str, torch.Tensor], header: dict[str, Any]) -> Path:
    """One entry of metadata only: safetensors writes several in no fixed order."""
    from safetensors.torch import save

    target.parent.mkdir(parents=True, exist_ok=True)
    with writing(target, force=True) as stream:
        stream.write(save(tensors, {_ENTRY: json.dumps(header)}))
    return target


def _read(path: Path) -> tuple[dict[str, torch.Tensor], dict[str, Any]]:
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="pt") as stream:
            header = json.loads((stream.metadata() or {}).get(_ENTRY, "{}"))
            return {name: stream.get_tensor(name) for name in stream.keys()}, dict(header)  # noqa: SIM118
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise FileError(f"{path} is not a language field ({error}); delete it and embed the scene again") from error


def _attach(scene: Scene, tensors: dict[str, torch.Tensor], header: dict[str, Any], source: Path) -> Scene:
    try:
        groups = _GROUPS.validate_python(header["groups"])
        notes = _NOTES.validate_python(header["notes"])
        frame = _FRAME.validate_python(header["frame"])
        column, embeddings = tensors["group"], tensors["embeddings"]
        table = LanguageField(groups, embeddings.numpy(), str(header["encoder"]), notes)
        fits = (
            (column.shape, column.dtype) == ((len(scene.cloud),), torch.int32)
            and (embeddings.ndim, embeddings.dtype) == (2, torch.float32)
            and bool(embeddings.isfinite().all())
            and (not len(column) or -1 <= int(column.min()) <= int(column.max()) < len(groups))
            and all(-1 <= g.parent < len(groups) for g in groups)
        )
    except (KeyError, TypeError, ValueError, ScenewrightError) as error:
        raise FileError(f"{source} is damaged ({error}); delete it and embed the scene again") from error
    if not fits:
        raise FileError(f"{source} is damaged (its columns do not fit); delete it and embed the scene again")
    if scene.frame.up_source == "given":  # what the user says now outweighs what was estimated then
        frame = scene.frame
    return scene.replace(cloud=scene.cloud.replace(group=column), language=table, frame=frame)
