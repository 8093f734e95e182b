"""Sequences of scene files, one for each time: written from a scene with motion, and read as one."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..gaussians.errors import FileError, UserError
from .pictures.film import PATTERN
from .pictures.times import times_within

if TYPE_CHECKING:
    from ..gaussians.files import Report
    from ..gaussians.motion.sequence import Found
    from ..gaussians.scene import Scene

MOST_RATE = 10_000  # files a second


def is_pattern(path: Path) -> bool:
    """Whether a path means many files: `frames/*.ply` or `frames/%04d.ply`."""
    return not path.exists() and ("*" in path.name or bool(PATTERN.search(path.name)))


def files_of(pattern: Path) -> list[Path]:
    """The files that a pattern means, by the numbers in their names.

    Raises:
        FileError: there are fewer than two.
    """
    name = pattern.name if "*" in pattern.name else PATTERN.sub("*", pattern.name)
    found = sorted(pattern.parent.glob(name), key=lambda path: _numbers(path.name))
    if not PATTERN.search(pattern.name):
        chosen = found
    else:
        number = re.compile(PATTERN.sub("@", re.escape(pattern.name).replace("\\%", "%")).replace("@", r"\d+"))
        chosen = [path for path in found if number.fullmatch(path.name)]
    if len(chosen) < 2:
        raise FileError(f"{pattern} names {len(chosen)} files; a sequence needs two or more")
    return chosen


def _numbers(name: str) -> list[tuple[int, str]]:
    """A key that sorts names by the numbers in them."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def read(pattern: Path, fps: float | None) -> tuple[Scene, Report, int]:
    """The scene of a sequence with the motion found in it and the names of its first file; the report of that file and
    of the motion; and the bytes of all.

    Raises:
        UserError: no usable rate is given, or the files hold different Gaussians.
        FileError: they are fewer than two, or one cannot be read.
    """
    from ..gaussians.files import load, load_with_report
    from ..gaussians.language.field.store import load_field
    from ..gaussians.motion.sequence import motion_of

    rate = _rate(fps, f"{pattern} is a sequence; say how many of its files make a second: --fps 10")
    paths = files_of(pattern)
    first, report = load_with_report(paths[0])
    first = load_field(first, paths[0]) or first
    frames = [lambda: first.cloud, *(lambda path=path: load(path).cloud for path in paths[1:])]
    times, gaps = times_of(paths, rate)
    found = motion_of(frames, times)
    report = replace(report, notes=(*report.notes, *gaps, *told(found, len(paths))))
    return first.replace(motion=found.motion), report, sum(path.stat().st_size for path in paths)


def _rate(fps: float | None, without: str) -> float:
    """Files a second, as given; `without` is the message where nothing is given.

    Raises:
        UserError: it is not given, or no rate.
    """
    if fps is None:
        raise UserError(without)
    if not 0 < fps < MOST_RATE:
        raise UserError(f"--fps is a number of files a second above 0 and below {MOST_RATE:,}, not {fps:g}")
    return fps


def times_of(paths: list[Path], fps: float) -> tuple[list[float], tuple[str, ...]]:
    """The seconds of the files of a sequence, and what is to be said of gaps in it.

    Files are numbered by the first number by which their names differ; the smallest step between two numbers is one
    file, so that a missing file leaves a gap. Names without such numbers follow one another.
    """
    parts = [[int(n) for n in re.findall(r"\d+", path.stem)] for path in paths]
    numbers = next((list(n) for n in zip(*parts, strict=False) if len(set(n)) == len(paths)), list(range(len(paths))))
    if len({len(part) for part in parts}) > 1 or numbers != sorted(numbers):
        numbers = list(range(len(paths)))
    steps = [b - a for a, b in itertools.pairwise(numbers)]
    places = [(n - numbers[0]) / min(steps) for n in numbers]
    pairs = zip(itertools.pairwise(paths), steps, strict=True)
    wide = [f"{a.name} and {b.name}" for (a, b), step in pairs if step >= 1.5 * min(steps)]
    notes = (f"files are missing between {', '.join(wide)}: what moves goes on evenly there",) if wide else ()
    return [place / fps for place in places], notes


def told(found: Found, files: int) -> tuple[str, ...]:
    """What was found in so many files, one sentence each."""
    lines = [f"{files} files: " + (_bodies(found) if found.motion is not None else "nothing moves in them")]
    if found.left:
        lines.append(
            f"{found.left:,} Gaussians follow no body; displacements of rank {found.rank} take them along, "
            f"within {found.worst:.3g} units"
        )
    if found.recolored:
        lines.append(
            f"{found.recolored:,} Gaussians change their colour or opacity, which stays that of the first file"
        )
    return tuple(lines)


def _bodies(found: Found) -> str:
    if not found.bodies:
        return "no rows move alike as a body"
    count = "1 body moves" if len(found.bodies) == 1 else f"{len(found.bodies)} bodies move"
    return f"{count}, of {', '.join(f'{n:,}' for n in found.bodies)} Gaussians, within {found.worst:.3g} units"


def write(scene: Scene, pattern: Path, span: tuple[float, float], fps: float | None, force: bool) -> dict[str, Any]:
    """Write a scene at times from the start of a span to its stop, one file each with the names of its things beside
    it; all of them or none. Every file has all Gaussians, those that are hidden then with opacity 0.

    Raises:
        UserError: no usable rate is given, there would be too many files, or one exists and `force` is not set.
        FileError: they cannot be written.
    """
    from ..gaussians.language.field.saving import save
    from .output_files import refuse_existing, write_whole
    from .terminal.output import terminal

    rate = _rate(fps, f"{pattern.name} is a sequence; say how many files make a second: --fps 10")
    if pattern.name.count("%") != 1 or "*" in pattern.name:
        raise UserError(f"{pattern.name} is not a pattern for files; write for example %04d{pattern.suffix or '.ply'}")
    times = times_within(span, rate)
    paths = [pattern.with_name(pattern.name % i) for i in range(len(times))]
    refuse_existing(paths, force)

    def make(i: int, path: Path) -> None:
        terminal.progress(f"writing {i + 1} of {len(times)}", i / len(times))
        save(_whole(scene, times[i]), path)

    with terminal.interruptible():
        write_whole(paths, make, force)
    terminal.clear()
    size = sum(path.stat().st_size for path in paths)
    return {"path": str(pattern), "files": len(paths), "bytes": size, "time": list(span), "fps": rate}


def _whole(scene: Scene, time: float) -> Scene:
    """The scene at a time with all its Gaussians."""
    from ..gaussians.motion.at import at, rows_at

    found = at(scene, time)
    if scene.motion is None or len(found.cloud) == len(scene.cloud):
        return found
    cloud, gone = rows_at(scene.cloud, scene.motion, time)
    assert gone is not None
    return found.replace(cloud=cloud.replace(opacities=cloud.opacities.masked_fill(gone, 0.0)))
