"""Read names and their text vectors from files that other programs write.

Supported layouts:

- a folder with `text.npy` `[T, D]` and `names.json` or `names.txt`, optionally `calibration.json`;
- `TEXT.npy,NAMES.json` or `TEXT.npy,NAMES.txt`: the same as two files of any name;
- one `.npz` with the arrays `names` `[T]` (strings) and `text` `[T, D]`;
- one `.safetensors` with the tensor `text` and the names as a JSON list under `names` in its metadata.

A list of names is a text file with one name per line, synonyms after commas, or a JSON list in the order of the rows.
Its entries are strings, lists `["sofa", "couch"]` of a name and its synonyms, or objects with `name` and `synonyms`; if
all objects have an `id`, their order is that of the ids (the category files of COCO and LVIS are such lists).
Underscores are read as spaces. Text in brackets only disambiguates ("mouse_(computer_equipment)" is "mouse").
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError, FileError
from ...files.foreign import read_archive, read_array, read_json
from .calibration import Calibration

Name = tuple[str, ...]  # a name and its synonyms

_BRACKETS = re.compile(r"\([^)]*\)")
_AFTER = re.compile(r"(?<=\))\s+")  # text after brackets is another name: "monitor_(computer) computer_monitor"


def read(argument: str) -> tuple[list[Name], NDArray[np.floating]]:
    """Names with their synonyms, and their vectors `[T, D]` as stored.

    Raises:
        BackendError: a file is missing or not in one of the layouts above.
    """
    first, _, second = argument.partition(",")
    path = Path(first).expanduser()
    if second:
        return _names(Path(second).expanduser()), _array(path)
    if path.is_dir():
        listed = [path / n for n in ("names.json", "names.txt") if (path / n).is_file()]
        if not listed:
            raise BackendError(f"{path} has no names.json or names.txt; list the names of the rows of text.npy there")
        return _names(listed[0]), _array(path / "text.npy")
    if path.suffix == ".npz":
        return _npz(path)
    if path.suffix == ".safetensors":
        return _safetensors(path)
    raise BackendError(
        f"{path} holds no vectors; use vectors:FOLDER, vectors:FILE.npz, FILE.safetensors or TEXT.npy,NAMES.json"
    )


def calibration_beside(path: Path) -> Calibration | None:
    """The calibration in `calibration.json` of a folder of vectors, None if there is no such file.

    Raises:
        BackendError: the file is damaged.
    """
    file = path / "calibration.json"
    if not file.is_file():
        return None
    try:
        return Calibration.from_json(read_json(file))
    except (FileError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise BackendError(f"{file} is not a calibration ({error!r}); it needs at least scale and threshold") from error


def spoken_names(names: Sequence[Name]) -> list[Name]:
    """Names with spaces for underscores, and without brackets unless two names would then be equal.

    Names that differ only in brackets keep them and get the word without brackets as a synonym: "bow" means either bow.
    """
    names = [tuple(part for name in row for part in _AFTER.split(name)) for row in names]
    bare = [tuple(dict.fromkeys(_spoken(_BRACKETS.sub(" ", n)) or _spoken(n) for n in row)) for row in names]
    count = Counter(name[0] for name in bare)
    return [
        b if count[b[0]] == 1 else tuple(dict.fromkeys((_spoken(n[0]), *b))) for n, b in zip(names, bare, strict=True)
    ]


def _spoken(name: str) -> str:
    return " ".join(name.replace("_", " ").split())


def _names(path: Path) -> list[Name]:
    try:
        if path.suffix == ".json":
            return _listed(read_json(path), path)
        content = path.read_text(encoding="utf-8")
    except (FileError, OSError, ValueError) as error:
        raise BackendError(f"{path} cannot be read as a list of names: {error}") from error
    lines = ([part.strip() for part in line.split(",")] for line in content.splitlines() if line.strip())
    return _listed([[part for part in line if part] for line in lines], path)


def _listed(entries: Any, path: Path) -> list[Name]:
    """Names from a JSON list in one of the forms in the module docstring."""
    problem = BackendError(f"{path} must be a list of names, of [name, synonym, ...] or of objects with a name")
    if not isinstance(entries, list):
        raise problem
    if all(isinstance(e, dict) and isinstance(e.get("id"), int) for e in entries):
        entries = sorted(entries, key=lambda e: e["id"])
    names: list[Name] = []
    for entry in entries:
        if isinstance(entry, dict):
            synonyms = entry.get("synonyms", [])
            entry = [entry.get("name"), *synonyms] if isinstance(synonyms, list) else []
        words = [entry] if isinstance(entry, str) else entry
        if not isinstance(words, list) or not words or not all(isinstance(w, str) and w.strip() for w in words):
            raise problem
        names.append(tuple(words))
    return spoken_names(names)


def _array(path: Path) -> NDArray[np.floating]:
    try:
        return _numbers(read_array(path), path)
    except FileError as error:
        raise BackendError(f"{path} cannot be read as an array of text vectors: {error}") from error


def _npz(path: Path) -> tuple[list[Name], NDArray[np.floating]]:
    try:
        held = read_archive(path)
        return _listed(np.atleast_1d(held["names"]).astype(str).tolist(), path), _numbers(held["text"], path)
    except (FileError, KeyError) as error:
        raise BackendError(f"{path} needs the arrays names (strings) and text [T, D]: {error}") from error


def _numbers(array: NDArray[Any], path: Path) -> NDArray[np.floating]:
    if array.dtype.kind not in "fiu":
        raise BackendError(f"{path} must hold text vectors of numbers, not of {array.dtype}")
    return array


def _safetensors(path: Path) -> tuple[list[Name], NDArray[np.floating]]:
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(str(path), framework="numpy") as held:
            return _listed(json.loads((held.metadata() or {})["names"]), path), held.get_tensor("text")
    except (OSError, ValueError, KeyError, TypeError, RecursionError, SafetensorError) as error:
        raise BackendError(f"{path} needs a tensor text [T, D] and names in its metadata: {error!r}") from error
