"""Where this program keeps what it can make again."""

from __future__ import annotations

import os
from pathlib import Path


def user_cache(*parts: str) -> Path:
    """A folder or file of the program in the user's cache (`XDG_CACHE_HOME`, `~/.cache`); it may not exist yet."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root.joinpath("scenewright", *parts)
