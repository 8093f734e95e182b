"""Sources of 2D masks behind one protocol, chosen by one string.

The module of a source, and the libraries it needs, are imported when that source is loaded.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol, runtime_checkable

from ...errors import BackendError
from ...scene import Scene
from ..specs import remember
from .view import NONE, ViewMasks, pack_layers

__all__ = ["NONE", "Masker", "ViewMasks", "load", "load_all", "pack_layers"]

Progress = Callable[[str, float], None]
PICTURES = "pictures"
_MODULES = {
    "embedded": ".sources.embedded",
    "folder": ".sources.folder",
    "sam": ".sources.sam",
    PICTURES: ".sources.pictures",
}


@runtime_checkable
class Masker(Protocol):
    """A source of masks. It is deterministic: the same scene gives the same masks in the same order."""

    def masks(self, scene: Scene, progress: Progress = lambda stage, share: None) -> Iterator[ViewMasks]:
        """Yield the masks of one image after another.

        Raises:
            FileError: a file of masks is missing or broken.
            BackendError: a model is missing or fails.
        """
        ...


def names() -> tuple[str, ...]:
    """Names of all sources, whether or not the libraries they need are installed."""
    return tuple(_MODULES)


def load(spec: str, capture: Path | None = None) -> Masker:
    """Load a source of masks by its specification.

    Args:
        spec: "pictures" (regions that contours bound in photographs or rendered views), "embedded" (segments of
            rendered views by depth, normals and colour), "folder:PATH" (a folder of PNGs with `masks.json`, or of
            `.npz`, or a COCO results `.json`), "sam:PATH-or-NAME" (a SAM of transformers).
        capture: the `transforms.json` of the photographs that the masks belong to, or its folder. With None it
            is searched in the folder of the masks and the one above, and the sources that make masks themselves take
            rendered views, not photographs.

    Raises:
        BackendError: unknown source, missing extra, missing or broken weights; the message says what to do.
        FileError: the folder or the capture is missing or broken.
    """
    name, _, argument = spec.partition(":")
    if name not in _MODULES:
        raise BackendError(f"unknown source of masks {spec!r}; use pictures, embedded, folder:PATH or sam:PATH-or-NAME")
    module = importlib.import_module(_MODULES[name], __name__)
    masker: Masker = module.load(argument, capture)
    remember(masker, spec)
    return masker


def load_all(spec: str | None, capture: Path | None = None) -> tuple[tuple[Masker, ...], tuple[str, ...]]:
    """Load the sources of masks that a user means: the one named, and the photographs of a capture.

    Args:
        spec: as `load` takes it; None for the photographs alone, "none" for no masks at all.
        capture: as `load` takes it. Its photographs are a source too ("pictures"); where they are all missing, they
            are one only if no other is named, and views are rendered instead.

    Returns:
        The sources, and sentences that a user should read before they are used.

    Raises:
        BackendError, FileError: as `load` raises them.
    """
    from .sources.pictures import Pictures

    named = () if spec in (None, "none") else (load(str(spec), capture),)
    if capture is not None and spec != "none" and not any(isinstance(one, Pictures) for one in named):
        own = load(PICTURES, capture)
        assert isinstance(own, Pictures)
        if named and not own.has_photographs:
            return named, (f"the photographs of {capture} are missing: only the masks of {spec} are used",)
        named = (*named, own)
    return named, tuple(note for one in named if isinstance(one, Pictures) for note in one.notes)
