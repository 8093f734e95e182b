"""What `scenewright bench calibrate` measured on the user's machine: for each method, times as multiples of the shipped
ones. A JSON file in the platform's folder for settings; without it, the reference machine's times are used."""

from __future__ import annotations

import json
import math
import os
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

VERSION = 1


@dataclass(frozen=True)
class Calibration:
    """Times of one machine.

    Attributes:
        factors: for each method, its seconds on this machine divided by the predicted ones of the reference machine.
        machine: in words.
        measured: date, YYYY-MM-DD.
        revision: of the points that the factors belong to.
    """

    factors: dict[str, float] = field(default_factory=dict)
    machine: str = ""
    measured: str = ""
    revision: str = ""
    version: int = VERSION


def path() -> Path:
    """Where the file lies: `SCENEWRIGHT_EFFORT`, else `effort.json` in the user's folder for settings."""
    if named := os.environ.get("SCENEWRIGHT_EFFORT", "").strip():
        return Path(named)
    if sys.platform == "win32":
        root = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Application Support"
    else:
        root = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return root / "scenewright" / "effort.json"


def read() -> tuple[Calibration | None, str]:
    """The calibration of this machine, None if there is none; and what is wrong with the file, "" for nothing."""
    place = path()
    try:
        data = json.loads(place.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None, ""
    except (OSError, ValueError) as error:
        return None, _told(place, str(error))
    factors = data.get("factors") if isinstance(data, dict) else None
    if not isinstance(factors, dict) or data.get("version") != VERSION:
        return None, _told(place, "it has another layout")
    known = {name: float(f) for name, f in factors.items() if isinstance(f, int | float) and _sound(float(f))}
    if len(known) < len(factors):
        return None, _told(place, "a factor in it is no positive number")
    machine, measured, revision = (str(data.get(key, "")) for key in ("machine", "measured", "revision"))
    return Calibration(known, machine, measured, revision), ""


def _sound(factor: float) -> bool:
    return math.isfinite(factor) and 1e-3 <= factor <= 1e3


def _told(place: Path, why: str) -> str:
    return f"{place} is not used ({why}); `scenewright bench calibrate` writes it anew"


def write(calibration: Calibration) -> Path:
    """Write the file, replacing an earlier one; returns its path.

    Raises:
        FileError: it cannot be written.
    """
    from ..errors import FileError
    from ..files import writing

    place = path()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(
            f"cannot make {place.parent}: {error.strerror}; SCENEWRIGHT_EFFORT names another file"
        ) from error
    with writing(place, force=True) as file:
        file.write((json.dumps(asdict(calibration), indent=1) + "\n").encode())
    return place
