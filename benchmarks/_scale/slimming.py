"""A scene in tiles made smaller part by part, in less memory than it needs whole: bytes, decibels, memory, names."""

from __future__ import annotations

from pathlib import Path

from ...gaussians.tiles.store import Tiles
from ..harness import Metric
from . import grid as grids
from .measured import command, size_of

PROMISED = 40.0  # dB
PIXELS = 160  # a side of the views
SHARE = 0.8  # of the memory that the scene needs at once is allowed
ASKED = (grids.RECOLORED, grids.DELETED, "sofas", "floor lamps")


def measured(rows: int, needed: float, place: Path) -> list[Metric]:
    """The figures of a grid of rooms of about so many rows; files are written to `place`.

    Args:
        needed: bytes for a row that work on the whole scene takes.
    """
    grid = grids.made(rows)
    source, folder, smaller = place / "grid.ply", place / "grid.tiles", place / "slim.tiles"
    grids.write(grid, source)
    command("tile", source, "-o", folder)
    size = source.stat().st_size
    source.unlink()
    known = Tiles.open(folder).digest()
    memory = f"{SHARE * needed * grid.rows / 1e6:.0f}MB"
    taken = command("slim", folder, "-o", smaller, "--psnr", PROMISED, "--pixels", PIXELS, "--memory", memory)
    told = taken.data
    parts = [part["psnr"] for part in told["parts"] if part]
    same = [_asked(folder, words) == _asked(smaller, words) for words in ASKED]
    return [
        Metric("slim.rows", grid.rows, "count"),
        Metric("slim.parts", len(told["parts"]), "count"),
        Metric("slim.kept", told["gaussians"] / grid.rows, "1", "lower", 0.05),
        Metric("slim.bytes against .ply", size / size_of(smaller), "x", "higher", 0.05),
        Metric("slim.bytes against tiles", told["bytes_before"] / size_of(smaller), "x", "higher", 0.05),
        Metric("slim.held out", told["held_out"]["psnr"], "dB", "higher", goal=PROMISED),
        Metric("slim.held out of the worst part", min(parts), "dB", "higher", goal=PROMISED),
        Metric("slim.parts checked", len(parts) / len(told["parts"]), "1", "higher"),
        Metric("slim.names as before", sum(same) / len(same), "1", "higher", goal=1.0),
        Metric("slim.pixels that show the same thing", told["same_thing"], "1", "higher"),
        Metric("slim.source unchanged", float(Tiles.open(folder).digest() == known), "1", "higher", goal=1.0),
        Metric("slim.memory allowed", SHARE * needed * grid.rows / 2**30, "GiB"),
        Metric("slim.memory", taken.bytes / 2**30, "GiB", "lower", 0.1),
        Metric("slim.processor", taken.processor, "s", "lower", 0.2),
        Metric("slim.seconds", taken.seconds, "s", "lower", 0.3),
    ]


def _asked(scene: Path, words: str) -> list[int]:
    """The groups that some words find."""
    found: list[int] = command("select", scene, f"the {words}").data["groups"]
    return found
