"""Read a photograph file of any format that Pillow supports as 8-bit RGB.

The size in the header is compared with the camera's before decoding, so that a small file that claims a huge image
costs nothing (decompression bomb).
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

MIN_SIDE = 8  # px, shortest side of a usable photograph
# Errors of Pillow's readers for truncated, corrupt and inconsistent files; RuntimeError is AVIF's.
_BROKEN = (OSError, ValueError, SyntaxError, EOFError, RuntimeError, MemoryError)
_TURNING = range(5, 9)  # EXIF orientations with a rotation by 90 degrees
_ORIENTATION = 0x0112


def read_photo(path: Path, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Read a photograph as `[H, W, 3]` uint8, display space.

    Grey images become RGB, transparent ones are composited over black (as in training), 16 bits become 8. An EXIF
    rotation by 90 degrees is applied only if the image has the camera's aspect ratio with it and not without: COLMAP
    reads pixels as they are stored, other tools as they are displayed.

    Args:
        size: width and height of its camera; the image may be smaller or larger, but must have that aspect ratio.

    Raises:
        FileError: the file cannot be read, is not an image, or has another aspect ratio.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    broken = (*_BROKEN, Image.DecompressionBombError)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # some photographs are large, or carry a broken thumbnail
            with Image.open(path) as file:
                turned = not _same_aspect(file.size, size) and file.getexif().get(_ORIENTATION) in _TURNING
                _check_size(path, file.size[::-1] if turned else file.size, size)
                return _colors(ImageOps.exif_transpose(file) if turned else file)
    except UnidentifiedImageError as error:
        raise FileError(f"cannot read the photograph {path}: it is not a PNG, JPEG or other known image") from error
    except broken as error:
        raise FileError(f"cannot read the photograph {path}: {error}") from error


def _same_aspect(size: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two images have the same aspect ratio up to rounding of the smaller one's sides."""
    return abs(size[0] * other[1] - size[1] * other[0]) <= max(*size, *other)


def _check_size(path: Path, size: tuple[int, int], wanted: tuple[int, int]) -> None:
    width, height = size
    if not _same_aspect(size, wanted):
        raise FileError(f"{path} is {width}x{height}, its camera says {wanted[0]}x{wanted[1]}; "
                        "correct the intrinsics (w, h and focal lengths in pixels of the photographs)")  # fmt: skip
    if min(size) < MIN_SIDE:
        raise FileError(f"{path} is {width}x{height} pixels, too few to train on; replace it by the full photograph")


def _colors(file: Picture) -> NDArray[np.uint8]:
    if file.mode == "F":
        raise ValueError("it has floating-point pixels; save it with 8 bits per channel")
    if file.mode.startswith("I"):
        deep = np.asarray(file)
        if deep.min() < 0 or deep.max() > 65535:
            raise ValueError("it has more than 16 bits per channel; save it with 8")
        return np.repeat((deep / 257 + 0.5).astype(np.uint8)[..., None], 3, axis=2)
    if "A" in file.getbands() or "transparency" in file.info:
        shown = np.asarray(file.convert("RGBA"))
        return (shown[..., :3] * (shown[..., 3:] / np.float32(255)) + np.float32(0.5)).astype(np.uint8)
    return np.asarray(file.convert("RGB"))
