"""Pictures that were inpainted elsewhere: `folder:FOLDER`.

The first time, the views of an edit and their masks are written: `EDIT/pictures/NAME.png` and `EDIT/masks/NAME.png`
(white is the hole), where EDIT stands for the content of these files. The second time, `EDIT/filled/NAME.png` is read.
These are the folders that batch programs take, for instance IOPaint.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ....gaussians.errors import BackendError, FileError
from ....gaussians.files.captures.image_file import read_photo
from . import F32, Mask, Shot, checked
from .sizes import bytes_of

_GROW = 5  # px
_PICTURES, _MASKS, _FILLED = "pictures", "masks", "filled"


@dataclass(eq=False)
class Folder:
    """Views written and read; `name` is its specification."""

    name: str
    path: Path
    grow: int = _GROW
    _edit: Path | None = field(default=None)

    def prepare(self, shots: Sequence[Shot]) -> None:
        """Write the views of an edit that is not known yet.

        Raises:
            BackendError: some are not inpainted yet.
            FileError: the folder cannot be written.
        """
        self._edit = edit = self.path / _key(shots)
        missing = [shot for shot in shots if not self._filled(edit, shot).is_file()]
        if not missing:
            return
        try:
            for folder in (_PICTURES, _MASKS, _FILLED):
                (edit / folder).mkdir(parents=True, exist_ok=True)
            for shot in shots:
                _save(bytes_of(shot.rgb), edit / _PICTURES / f"{shot.name}.png")
                _save(_bytes(shot.mask), edit / _MASKS / f"{shot.name}.png")
        except OSError as error:
            raise FileError(f"cannot write the views to {edit}: {error.strerror or error}") from error
        raise BackendError(
            f"{len(missing)} of {len(shots)} views wait to be inpainted: {edit / _PICTURES} and {edit / _MASKS} (white "
            f"is the hole); put them under the same names into {edit / _FILLED}, and say the same again"
        )

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        """See `Inpainter`; the picture is the one of that name, whatever is given."""
        assert self._edit is not None, "prepare comes first"
        path = self._filled(self._edit, shot)
        height, width = shot.mask.shape
        try:
            photo = read_photo(path, (width, height))
        except FileError as error:
            raise BackendError(f"{error}; it must be {width}x{height} pixels, like the view") from error
        return checked(photo.astype(np.float32) / np.float32(255), shot, str(path))

    @staticmethod
    def _filled(edit: Path, shot: Shot) -> Path:
        return edit / _FILLED / f"{shot.name}.png"


def load(argument: str) -> Folder:
    """The folder `argument`, which need not exist.

    Raises:
        BackendError: it is a file.
    """
    path = Path(argument).expanduser()
    if path.exists() and not path.is_dir():
        raise BackendError(f"{path} is a file; --infill folder:FOLDER names a folder for views and masks")
    return Folder(f"folder:{argument}", path)


def _key(shots: Sequence[Shot]) -> str:
    """A name for an edit: the same views with the same holes have the same."""
    digest = hashlib.sha256()
    for shot in shots:
        digest.update(shot.name.encode() + repr(shot.mask.shape).encode())
        digest.update(bytes_of(shot.rgb).tobytes() + np.packbits(shot.mask).tobytes())
    return f"edit_{digest.hexdigest()[:12]}"


def _bytes(mask: Mask) -> np.ndarray:
    return np.where(mask, np.uint8(255), np.uint8(0))


def _save(image: np.ndarray, path: Path) -> None:
    from PIL import Image

    Image.fromarray(image).save(path)
