"""Writes films: a folder of PNGs, a GIF, or an MP4 made by ffmpeg; a film is written completely or not at all.

PNG and GIF have the same bytes for the same pictures.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import select
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import IO, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...gaussians.errors import BackendError, UserError
from ...gaussians.files import writing
from ..output_files import refuse_existing, write_whole
from .image_files import Picture, save_png

Draw = Callable[[int], Picture]  # the i-th picture, [H, W, 3] or, for PNGs, [H, W, 4] or 16-bit [H, W]

PATTERN = re.compile(r"%(0\d{1,2})?d")
_GIF_MAX_FPS = 50.0  # browsers slow a GIF with delays below two hundredths of a second down to ten pictures a second
_GIF_MAX_PIXELS = 400_000_000  # of all pictures of a GIF together: they are held in memory until it is written
_PALETTE_PICTURES = 16  # pictures that a GIF's palette is computed from
_PALETTE_PIXELS = 40_000  # of each of them
_FFMPEG_TIMEOUT = 60.0  # seconds in which ffmpeg reads no byte, after which it counts as hanging


def is_film(output: Path) -> bool:
    """Whether a path means more than one picture.

    Raises:
        UserError: its suffix is of no format that can be written.
    """
    suffix = output.suffix.lower()
    if suffix == ".png":
        return bool(PATTERN.search(output.name))
    if output.is_dir() or suffix in ("", ".gif", ".mp4"):
        return True
    raise UserError(f"cannot write {output}: pictures are written as .png, films as .gif, .mp4 or a folder of pictures")


def picture_paths(output: Path, names: Sequence[str]) -> list[Path]:
    """The files of a film that is a folder or a pattern such as `frames/%04d.png`; an empty list for other films.

    Raises:
        UserError: the pattern is not valid.
    """
    if output.suffix.lower() in (".gif", ".mp4") and not output.is_dir():
        return []
    if output.suffix.lower() != ".png":
        return [output / f"{name}.png" for name in names]
    if output.name.count("%") != 1:  # any other "%" would be replaced too
        raise UserError(f"{output.name} is not a pattern for pictures; write for example %04d.png")
    return [output.with_name(output.name % i) for i in range(len(names))]


def check(output: Path, names: Sequence[str], sizes: set[tuple[int, int]], fps: float, force: bool) -> None:
    """Check a film before its first picture is rendered.

    Raises:
        UserError: a file would be overwritten, or the pictures do not suit the format.
        BackendError: there is no ffmpeg for an .mp4.
    """
    pictures = picture_paths(output, names)
    refuse_existing(pictures or [output], force)
    if pictures:
        return
    if len(sizes) > 1:
        raise UserError(f"the pictures of {output.name} must be of one size; give --size")
    width, height = next(iter(sizes))
    if output.suffix.lower() == ".mp4":
        _ffmpeg()
        if width % 2 or height % 2:
            raise UserError(
                f"an .mp4 needs even sides, not {width}x{height}; give --size {width + width % 2}x{height + height % 2}"
            )
        return
    if fps > _GIF_MAX_FPS:
        raise UserError(
            f"a .gif shows at most {_GIF_MAX_FPS:g} pictures a second, not {fps:g}; write .mp4 or lower --fps"
        )
    if width * height * len(names) > _GIF_MAX_PIXELS:
        raise UserError(
            f"{len(names)} pictures of {width}x{height} are too much for a .gif; write .mp4 or lower --size"
        )


def write(output: Path, names: Sequence[str], draw: Draw, fps: float, force: bool) -> int:
    """Render and write a film that passed `check`; returns the bytes written.

    Raises:
        UserError, FileError: the file was made by others in the meantime, or cannot be written.
        BackendError: ffmpeg failed or hangs.
    """
    pictures = picture_paths(output, names)
    if pictures:
        write_whole(pictures, lambda i, path: save_png(draw(i), path), force)
        return sum(path.stat().st_size for path in pictures)
    with writing(output, force) as file:
        if output.suffix.lower() == ".gif":
            _write_gif(file, len(names), draw, fps)
        else:
            _write_mp4(file, len(names), draw, fps)
    return output.stat().st_size


def _write_gif(file: BinaryIO, count: int, draw: Draw, fps: float) -> None:
    """Write a looping GIF with one palette for all pictures, which avoids flicker."""
    early = {int(i): draw(int(i)) for i in np.unique(np.linspace(0, count - 1, _PALETTE_PICTURES).round())}
    palette = _palette(list(early.values()))
    drawn = (_reduced(early.pop(i) if i in early else draw(i), palette) for i in range(count))
    ends = [round(100 * i / fps) for i in range(count + 1)]  # 1/100 s; rounded ends keep errors from adding up
    delays = [10 * (b - a) for a, b in itertools.pairwise(ends)]
    first = next(drawn)
    if count == 1:
        first.save(file, format="GIF")
        return
    first.save(file, format="GIF", save_all=True, append_images=drawn, duration=delays, loop=0, optimize=False)


def _palette(pictures: Sequence[Picture]) -> Image.Image:
    """An image whose palette of 255 colours suits all pictures; one of 256 is left for unchanged pixels."""
    points = [p.reshape(-1, 3)[:: max(1, p.shape[0] * p.shape[1] // _PALETTE_PIXELS)] for p in pictures]
    column = np.concatenate(points)[:, None]
    return Image.fromarray(column).quantize(255, method=Image.Quantize.MEDIANCUT, kmeans=2)


def _reduced(picture: Picture, palette: Image.Image) -> Image.Image:
    return Image.fromarray(np.ascontiguousarray(picture)).quantize(palette=palette, dither=Image.Dither.NONE)


def _write_mp4(file: BinaryIO, count: int, draw: Draw, fps: float) -> None:
    """Send raw pictures through a pipe to ffmpeg, which overwrites the file that `writing` made."""
    first = draw(0)
    height, width = first.shape[:2]
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "pipe:0"]
    target = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", file.name]
    with (
        tempfile.TemporaryFile() as messages,
        _running([_ffmpeg(), "-y", "-v", "error", *source, *target], messages) as process,
    ):
        try:
            for i in range(count):
                _feed(process, first if i == 0 else draw(i))
            assert process.stdin is not None
            process.stdin.close()
            failed = process.wait(timeout=_FFMPEG_TIMEOUT) != 0
        except BrokenPipeError:
            failed = True
        except subprocess.TimeoutExpired as error:
            raise BackendError(
                f"ffmpeg took nothing for {_FFMPEG_TIMEOUT:g} s and was ended; write .gif instead"
            ) from error
        if failed or os.fstat(file.fileno()).st_size == 0:
            messages.seek(0)
            last = messages.read(4000).decode(errors="replace").strip().splitlines()[-1:] or ["it gave no reason"]
            raise BackendError(f"ffmpeg failed: {last[0]}; write .gif instead")


def _ffmpeg() -> str:
    """The path of ffmpeg; raises BackendError if it is not installed."""
    found = shutil.which("ffmpeg")
    if found is None:
        raise BackendError(
            "an .mp4 needs ffmpeg, which is not installed; install it (apt install ffmpeg) or write .gif"
        )
    return found


@contextlib.contextmanager
def _running(command: Sequence[str], messages: IO[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is killed at the end of the context; its own session keeps Ctrl-C from reaching it directly."""
    try:
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=messages, stderr=messages, bufsize=0, start_new_session=True
        )
    except OSError as error:
        raise BackendError(f"ffmpeg cannot be started: {error.strerror or error}; write .gif instead") from error
    assert process.stdin is not None
    os.set_blocking(process.stdin.fileno(), False)
    try:
        yield process
    finally:
        with contextlib.suppress(OSError):
            process.stdin.close()
        process.kill()
        process.wait()


def _feed(process: subprocess.Popen[bytes], picture: NDArray[np.uint8]) -> None:
    """Write a picture to the process.

    Raises:
        BrokenPipeError: the process has ended.
        subprocess.TimeoutExpired: it reads nothing for `_FFMPEG_TIMEOUT`.
    """
    assert process.stdin is not None
    left = memoryview(np.ascontiguousarray(picture).tobytes())
    while left:
        if not select.select([], [process.stdin], [], _FFMPEG_TIMEOUT)[1]:
            raise subprocess.TimeoutExpired(process.args, _FFMPEG_TIMEOUT)
        left = left[os.write(process.stdin.fileno(), left) :]
