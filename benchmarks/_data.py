"""Finds the folders of real data, words the note for missing data, and reads sets of written instructions."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from ..gaussians.errors import FileError


def folder(name: str) -> Path | None:
    """A folder of the real data, by `SCENEWRIGHT_DATA` (`../shared/data` beside the repository); None if absent."""
    root = Path(os.environ.get("SCENEWRIGHT_DATA", Path(__file__).resolve().parents[1] / "../shared/data"))
    found = (root / name).resolve()
    return found if found.is_dir() else None


def missing(name: str) -> str:
    """The note of a benchmark whose data are missing."""
    return f"{name}: not measured, the data are not here; set SCENEWRIGHT_DATA to the folder that holds {name}"


def instructions(path: Path) -> list[dict[str, Any]]:
    """A set of written instructions, one JSON object a line.

    Raises:
        FileError: the set is not there (it is in the repository, not in the installed package).
    """
    if not path.is_file():
        raise FileError(f"no instructions at {path}; run this benchmark from a checkout of the repository")
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
