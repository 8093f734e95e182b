"""Where real data lies, and what to say where it does not."""

from __future__ import annotations

import os
from pathlib import Path


def folder(name: str) -> Path | None:
    """A folder of the real data, by `SCENEWRIGHT_DATA` (`../shared/data` beside the repository); None if absent."""
    root = Path(os.environ.get("SCENEWRIGHT_DATA", Path(__file__).resolve().parents[1] / "../shared/data"))
    found = (root / name).resolve()
    return found if found.is_dir() else None


def missing(name: str) -> str:
    """The note of a benchmark that had to do without."""
    return f"{name}: not measured, the data are not here; set SCENEWRIGHT_DATA to the folder that holds {name}"
