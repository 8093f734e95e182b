"""Masks of pictures behind one protocol, one file a source, chosen by one string.

Knows the protocol and how to find a source. Refuses to know any source's library: they are imported when asked for.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol, runtime_checkable

from ...errors import BackendError
from ...scene import Scene
from .view import NONE, ViewMasks, packed

__all__ = ["NONE", "Masker", "ViewMasks", "load", "packed", "sources"]

Progress = Callable[[str, float], None]
_MODULES = {"embedded": ".sources.embedded", "folder": ".sources.folder", "sam": ".sources.sam"}


@runtime_checkable
class Masker(Protocol):
    """A source of masks. The same scene gives the same masks, in the same order."""

    def masks(self, scene: Scene, progress: Progress = lambda stage, share: None) -> Iterator[ViewMasks]:
        """The masks of one picture after another.

        Raises:
            FileError: a file of masks is missing or broken.
            BackendError: a model is missing or failed.
        """
        ...


def names() -> tuple[str, ...]:
    """Names of the sources in this package, whether or not what they need is installed."""
    return tuple(_MODULES)


def load(spec: str, capture: Path | None = None) -> Masker:
    """A source of masks by its specification.

    Args:
        spec: "embedded" (segments of rendered views by depth, normals and colour), "folder:PATH" (a folder of PNGs with
            `masks.json`, or of `.npz`, or a COCO results `.json`), "sam:PATH-or-NAME" (a SAM of transformers).
        capture: the `transforms.json`, or the folder it lies in, of the photographs that the masks are of; None looks
            in the folder above the masks, and for SAM renders the views instead of reading photographs.

    Raises:
        BackendError: unknown source, missing extra, missing or broken weights; the message says what to do.
        FileError: the folder or the capture is missing or broken.
    """
    name, _, argument = spec.partition(":")
    if name not in _MODULES:
        raise BackendError(f"unknown source of masks {spec!r}; use embedded, folder:PATH or sam:PATH-or-NAME")
    module = importlib.import_module(_MODULES[name], __name__)
    masker: Masker = module.load(argument, capture)
    return masker
