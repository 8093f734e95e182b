"""A photograph from a file, as eight-bit red, green and blue: whatever kind of picture it is, or why it cannot be used.

Knows picture files. Refuses to know poses and lenses. A picture's size is held against its camera's before it is
unpacked, so that a small file which claims to be a huge picture costs nothing.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

SMALLEST = 8  # px of a side, below which nothing is to be learnt
# What Pillow's readers raise for cut, overwritten and lying files; RuntimeError is AVIF's.
_BROKEN = (OSError, ValueError, SyntaxError, EOFError, RuntimeError, MemoryError)
_TURNING = range(5, 9)  # EXIF orientations that turn a picture by a quarter
_ORIENTATION = 0x0112


def read_photo(path: Path, size: tuple[int, int]) -> NDArray[np.uint8]:
    """`[H, W, 3]`, display space.

    Grey is grey, transparency lies over black (as training draws it), sixteen bits become eight. A quarter turn that
    the file asks for (EXIF) is made only if the picture is of the camera's shape after it and not before: COLMAP reads
    pixels as they are stored, others as they are shown.

    Args:
        size: width and height of its camera; the picture may be smaller or larger, but of that shape.

    Raises:
        FileError: it cannot be read, is no picture, or is of another shape.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    broken = (*_BROKEN, Image.DecompressionBombError)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # some photographs are large, or carry a broken thumbnail
            with Image.open(path) as file:
                turned = not _alike(file.size, size) and file.getexif().get(_ORIENTATION) in _TURNING
                _check_size(path, file.size[::-1] if turned else file.size, size)
                return _colors(ImageOps.exif_transpose(file) if turned else file)
    except UnidentifiedImageError as error:
        raise FileError(f"cannot read the photograph {path}: it is no PNG, JPEG or other picture") from error
    except broken as error:
        raise FileError(f"cannot read the photograph {path}: {error}") from error


def _alike(size: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two pictures are of one shape, but for the rounding of the smaller one's sides."""
    return abs(size[0] * other[1] - size[1] * other[0]) <= max(*size, *other)


def _check_size(path: Path, size: tuple[int, int], wanted: tuple[int, int]) -> None:
    width, height = size
    if not _alike(size, wanted):
        raise FileError(f"{path} is {width}x{height}, its camera says {wanted[0]}x{wanted[1]}; "
                        "correct the intrinsics (w, h and focal lengths in pixels of the photographs)")  # fmt: skip
    if min(size) < SMALLEST:
        raise FileError(f"{path} is {width}x{height} pixels, too few to learn from; put the photograph itself there")


def _colors(file: Picture) -> NDArray[np.uint8]:
    if file.mode == "F":
        raise ValueError("it holds fractions, not colours; save it with 8 bits a colour")
    if file.mode.startswith("I"):
        deep = np.asarray(file)
        if deep.min() < 0 or deep.max() > 65535:
            raise ValueError("it holds more than 16 bits a colour; save it with 8")
        return np.repeat((deep / 257 + 0.5).astype(np.uint8)[..., None], 3, axis=2)
    if "A" in file.getbands() or "transparency" in file.info:
        shown = np.asarray(file.convert("RGBA"))
        return (shown[..., :3] * (shown[..., 3:] / np.float32(255)) + np.float32(0.5)).astype(np.uint8)
    return np.asarray(file.convert("RGB"))
