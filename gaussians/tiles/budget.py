"""How much memory work on a scene in tiles may take: `--memory`, else an environment variable, else 4 GB."""

from __future__ import annotations

import os
import re

from ..errors import UserError

VARIABLE = "SCENEWRIGHT_MEMORY"
USUAL = "4GB"
_UNITS = {"MB": 10**6, "GB": 10**9, "TB": 10**12, "MIB": 1 << 20, "GIB": 1 << 30, "TIB": 1 << 40}
_LEAST = 100 * 10**6


def parse_memory(text: str) -> int:
    """The bytes of "4GB", "500 MB" or "1.5GiB".

    Raises:
        UserError: it is no amount of memory, or less than anything could be done in.
    """
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([MGT]i?B)", text.strip(), re.IGNORECASE)
    size = int(float(match[1]) * _UNITS[match[2].upper()]) if match else 0
    if size < _LEAST:
        raise UserError(f"{text!r} is not an amount of memory of at least 100 MB; write for example 4GB")
    return size


def memory() -> int:
    """The bytes that work on tiles may take.

    Raises:
        UserError: the environment variable is no amount of memory.
    """
    return parse_memory(os.environ.get(VARIABLE) or USUAL)
