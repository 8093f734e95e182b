"""Masks of our own: regions of pictures that contours bound, from the whole of an object down to its patches.

The pictures are photographs of a capture if there is one, else renders of views that cover the scene. The regions of
one picture are layers of a hierarchy; they have no labels, and their scores say how sure the contours around them are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ....errors import UserError
from ....files.captures.capture import Capture, read_capture
from ....scene import Scene
from ....viewpoints.pictures import Picture, choose_photographs, present, read_photographs, render_views
from ..contours.channels import channels
from ..contours.detector import NAMES, Detector
from ..contours.detector import load as load_detector
from ..view import ViewMasks

SIDE = 400  # pixels of the longer side of the pictures
COUNT = 32  # pictures


def load(argument: str = "", capture: Path | None = None) -> Pictures:
    """See `masks.load`.

    Raises:
        UserError: the argument is not the name of a detector of contours.
        FileError: the capture does not exist.
        BackendError: the network cannot be loaded.
    """
    if argument and argument not in NAMES:
        raise UserError(f"pictures:{argument} names no detector of contours; use pictures or pictures:classical")
    detector = load_detector(argument or NAMES[0])
    return Pictures(detector, None if capture is None else read_capture(capture))


@dataclass(frozen=True)
class Pictures:
    """Regions of photographs or renders.

    Attributes:
        detector: of the contours.
        capture: the photographs; None, or one whose photographs are all missing, for renders.
        side, count: of the pictures, see SIDE and COUNT.
    """

    detector: Detector
    capture: Capture | None = None
    side: int = SIDE
    count: int = COUNT

    @property
    def has_photographs(self) -> bool:
        """Whether there is a photograph to use."""
        return self.capture is not None and bool(present(self.capture))

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know: photographs that are missing."""
        if self.capture is None:
            return ()
        there, listed = len(present(self.capture)), len(self.capture.photos)
        if there == listed:
            return ()
        lost = self.capture.photos[next(i for i in range(listed) if i not in set(present(self.capture)))]
        if not there:
            return (f"the photographs of {self.capture.path} are missing (such as {lost}): renders are used instead",)
        return (f"{listed - there} of the {listed} photographs of {self.capture.path} are missing (such as {lost})",)

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`. Photographs come in the order of the capture, renders with the best view first.

        Raises:
            FileError: a photograph cannot be read.
            UserError: the photographs do not show the scene.
        """
        total, pictures = self._pictures(scene)
        for i, picture in enumerate(pictures):
            yield self.detector.masks(channels(picture), picture.camera)
            progress("masks", (i + 1) / total)

    def _pictures(self, scene: Scene) -> tuple[int, Iterator[Picture]]:
        """The number of pictures, or what it is at most, and the pictures."""
        if self.capture is None or not self.has_photographs:
            return self.count, render_views(scene, self.side, self.count)
        chosen = choose_photographs(scene, self.capture, self.count)
        return len(chosen), read_photographs(self.capture, chosen, self.side)
