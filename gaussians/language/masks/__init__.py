"""Sources of 2D masks behind one protocol, chosen by one string.

The module of a source, and the libraries it needs, are imported when that source is loaded.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from ...errors import BackendError
from ...scene import Scene
from ..specs import remember
from .view import NONE, ViewMasks, pack_layers

__all__ = ["NONE", "Joined", "Masker", "ViewMasks", "load", "pack_layers", "sources"]

Progress = Callable[[str, float], None]
_MODULES = {
    "embedded": ".sources.embedded",
    "folder": ".sources.folder",
    "sam": ".sources.sam",
    "pictures": ".sources.pictures",
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


@dataclass(frozen=True)
class Joined:
    """Several sources of masks as one: the masks of one after those of another.

    Where only some sources give vectors, the masks of the others have zero vectors.
    """

    sources: tuple[Masker, ...]

    def masks(self, scene: Scene, progress: Progress = lambda stage, share: None) -> Iterator[ViewMasks]:
        """See `Masker`."""
        views = [view for source in self.sources for view in source.masks(scene, progress)]
        width = next((view.vectors.shape[1] for view in views if view.vectors is not None), None)
        for view in views:
            missing = width is not None and view.vectors is None
            yield replace(view, vectors=np.zeros((len(view), width or 0), np.float32)) if missing else view


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
