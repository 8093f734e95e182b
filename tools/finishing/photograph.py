"""Read a photograph of a material that a user gives as a reference: any size and orientation, with or without alpha.

Only formats whose readers Pillow keeps safe are opened, and the size in the header is looked at before decoding.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...gaussians.errors import FileError, UserError

FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF")
_LARGEST = 512  # pixels along the longer side that are kept
_SMALLEST = 24  # pixels along the shorter side of a usable photograph
_MOST = 160_000_000  # pixels that are decoded; of a JPEG more, as it is reduced while it is read
_OPAQUE = 0.5  # alpha from which a pixel shows the material
_SHOWN = 0.05  # share of the pixels that must
_BROKEN = (OSError, ValueError, SyntaxError, EOFError, RuntimeError, MemoryError)
ANY = frozenset({"photo", "picture", "image", "photograph", "reference", "sample", "pic", "swatch", "file", "upload"})


@dataclass(frozen=True, eq=False)
class Photograph:
    """A photograph of a material.

    Attributes:
        name: of its file.
        rgb: `[H, W, 3]` float32 display colours, rows upward.
        known: `[H, W]` bool, pixels that are not transparent.
        width: metres that it shows from left to right; None: unknown.
    """

    name: str
    rgb: NDArray[np.float32]
    known: NDArray[np.bool_]
    width: float | None = None


def read_photograph(path: Path, width: float | None = None) -> Photograph:
    """Read a photograph, upright as its EXIF data say and reduced to at most 512 pixels.

    Args:
        width: metres that it shows from left to right, if that is known.

    Raises:
        UserError: the width is no length of things.
        FileError: the file cannot be read, is no picture of a known format, is too small or too large, or is
            transparent; the message says what to do.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    if width is not None and not 0.001 <= width <= 1000:
        raise UserError(f"a photograph shows 0.001 to 1000 m from left to right, not {width:g}")
    known = ", ".join(FORMATS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the limit on the size is our own
            with Image.open(path, formats=FORMATS) as file:
                _check_size(path, file.size, file.format in ("JPEG", "MPO"))
                file.draft("RGB", (2 * _LARGEST, 2 * _LARGEST))
                upright = ImageOps.exif_transpose(file)
                rgba = _rgba(upright)
    except UnidentifiedImageError as error:
        raise FileError(f"cannot read the photograph {path}: it is no picture; give one of {known}") from error
    except FileError:
        raise
    except (*_BROKEN, Image.DecompressionBombError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or str(error) or type(error).__name__
        raise FileError(f"cannot read the photograph {path}: {why}") from error
    shown = rgba[..., 3] >= _OPAQUE
    if shown.mean() < _SHOWN:
        raise FileError(f"the photograph {path} is transparent nearly everywhere: give one that shows the material")
    return Photograph(path.name, rgba[::-1, :, :3].copy(), shown[::-1].copy(), width)


def _check_size(path: Path, size: tuple[int, int], reducible: bool) -> None:
    width, height = size
    if min(size) < _SMALLEST:
        raise FileError(
            f"the photograph {path} is {width}x{height} pixels: give one of at least {_SMALLEST} to each side"
        )
    if width * height > _MOST * (16 if reducible else 1):
        raise FileError(f"the photograph {path} is {width}x{height} pixels, too large to decode: give a smaller one")


def _rgba(picture: object) -> NDArray[np.float32]:
    """`[h, w, 4]` float32 of a picture reduced to what is kept; colours are not mixed with what is transparent."""
    from PIL import Image

    assert isinstance(picture, Image.Image)
    if picture.mode.startswith("I") or picture.mode == "F":
        deep = np.asarray(picture, dtype=np.float64)
        top = max(float(deep.max()), 1.0)
        scale = 1.0 if top <= 1 else 255.0 if top <= 255 else 65535.0
        picture = Image.fromarray((np.clip(deep / scale, 0, 1) * 255 + 0.5).astype(np.uint8))
    rgba = picture.convert("RGBA")
    factor = max(1, -(-max(rgba.size) // (4 * _LARGEST)))
    rgba = rgba.reduce(factor) if factor > 1 else rgba
    rgba.thumbnail((_LARGEST, _LARGEST), Image.Resampling.LANCZOS)
    return np.asarray(rgba, dtype=np.float32) / np.float32(255)


def named(name: str, given: Mapping[str, Photograph]) -> Photograph:
    """The photograph that a plan names: by the name of its file, without the ending too, or "photo" for the only one.

    Raises:
        UserError: the user gave no such photograph.
    """
    if not given:
        raise UserError("no photograph was given: give one with --reference FILE, or /reference FILE in chat")
    asked = name.lower().strip()
    for key, photograph in given.items():
        if asked in (key.lower(), Path(key).stem.lower()):
            return photograph
    words = asked.split()
    known = ", ".join(given)
    if words and words[0] in ANY:
        if len(words) == 1 and len(given) == 1:
            return next(iter(given.values()))
        if len(words) == 2 and words[1].isdigit() and 1 <= int(words[1]) <= len(given):
            return list(given.values())[int(words[1]) - 1]
        raise UserError(f"{len(given)} photographs were given: say which one ({known})")
    raise UserError(f"no photograph called {name} was given; there is {known}")
