"""The table of groups of a folder of tiles: written, read, and made of the tables of several files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ..errors import FileError, ScenewrightError
from ..language.field.language_field import Group, LanguageField
from ..language.field.making import Making
from . import files
from .records import Stored, Table

MOST_TABLE = 1 << 31  # bytes of the JSON of the groups

_GROUPS = TypeAdapter(tuple[Group, ...])
_MAKING = TypeAdapter(Making | None)


def write_table(field: LanguageField, folder: Path, number: int, before: Table | None = None) -> Table:
    """Write a table into the folder for tables; embeddings that are those of `before` are shared with it.

    Args:
        number: of the state, for the names of the files.

    Raises:
        FileError: it cannot be written.
    """
    vectors = np.ascontiguousarray(field.embeddings, "<f4")
    groups = files.write(folder, f"groups.{number}.json", _GROUPS.dump_json(field.groups))
    kept = _same_vectors(before, folder, vectors)
    return Table(
        groups=groups,
        embeddings=kept or files.write(folder, f"embeddings.{number}", vectors),
        count=len(field.groups), width=vectors.shape[1], encoder=field.encoder, notes=field.notes,
        making=None if field.making is None else asdict(field.making),
    )  # fmt: skip


def _same_vectors(before: Table | None, folder: Path, vectors: np.ndarray) -> Stored | None:
    if before is None or (before.count, before.width) != vectors.shape:
        return None
    known = files.mapped(folder, before.embeddings, np.dtype("<f4"), vectors.shape)
    return before.embeddings if known.tobytes() == vectors.tobytes() else None


def read_table(table: Table, folder: Path) -> LanguageField:
    """The language field of a table.

    Raises:
        FileError: a file is missing or damaged, or they contradict each other.
    """
    stored = files.content(folder, table.groups, MOST_TABLE)
    vectors = np.array(files.mapped(folder, table.embeddings, np.dtype("<f4"), (table.count, table.width)), np.float32)
    try:
        groups = _GROUPS.validate_json(stored)
        found = LanguageField(groups, vectors, table.encoder, table.notes, _MAKING.validate_python(table.making))
        fits = bool(np.isfinite(vectors).all()) and all(-1 <= g.parent < len(groups) for g in groups)
    except (ValidationError, ScenewrightError) as error:
        raise FileError(f"{folder / table.groups.file} is no table of groups ({error}): {files.ADVICE}") from error
    if not fits:
        raise FileError(f"{folder / table.groups.file} is no table of groups (its rows do not fit): {files.ADVICE}")
    return found


def joined(fields: Sequence[LanguageField]) -> LanguageField:
    """One table of several that one encoder made; the groups of a field follow those of the fields before it."""
    groups: list[Group] = []
    for field in fields:
        first = len(groups)
        groups += [replace(g, id=g.id + first, parent=g.parent + first if g.parent >= 0 else -1) for g in field.groups]
    vectors = np.concatenate([field.embeddings for field in fields])
    notes = tuple(dict.fromkeys(note for field in fields for note in field.notes))
    return LanguageField(tuple(groups), vectors, fields[0].encoder, notes, fields[0].making)
