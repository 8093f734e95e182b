"""Counts what a source of masks gives while it is read, so that a field can say what it was made with."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..field.making import MaskSource
from ..specs import spec_of
from . import Masker, ViewMasks


class Tally:
    """Counts the images and masks of a source while they are read."""

    def __init__(self, masker: Masker) -> None:
        self.masker = masker
        self._spec, self._views, self._masks = spec_of(masker), 0, 0

    def counting(self, views: Iterable[ViewMasks]) -> Iterator[ViewMasks]:
        """The same images one after another."""
        for view in views:
            self._views += 1
            self._masks += len(view)
            yield view

    def source(self, agreement: float | None = None) -> MaskSource:
        """What was counted so far, and how far the views agree with each other."""
        told = None if agreement is None else round(agreement, 4)
        return MaskSource(self._spec, self._views, self._masks, told)
