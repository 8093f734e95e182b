"""Pictures of answers: an answer is told at once, and its picture is drawn when nothing else waits."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future

_log = logging.getLogger(__name__)
KEPT = 64  # pictures; older ones are no longer served


class Gallery:
    """The last pictures of one session. Only the hub's worker adds and draws; any thread may ask."""

    def __init__(self) -> None:
        self._pictures: dict[str, Future[bytes]] = {}
        self._waiting: deque[tuple[Future[bytes], Callable[[], bytes]]] = deque()
        self._count = 0

    def add(self, draw: Callable[[], bytes]) -> str:
        """The path of a picture, which `draw` makes later as the bytes of a PNG."""
        self._count += 1
        path, picture = f"/pictures/{self._count}.png", Future[bytes]()
        self._waiting.append((picture, draw))
        self._pictures = dict([*self._pictures.items(), (path, picture)][-KEPT:])  # replaced as a whole
        return path

    def draw_next(self) -> bool:
        """Draw a picture that waits; whether there was one. One that cannot be drawn is not there."""
        if not self._waiting:
            return False
        picture, draw = self._waiting.popleft()
        try:
            picture.set_result(draw())
        except Exception as error:  # the answer stands without its picture
            _log.exception("a picture could not be drawn")
            picture.set_exception(error)
        return True

    def at(self, path: str) -> Future[bytes] | None:
        """The picture of a path, perhaps not drawn yet; None: there is none."""
        return self._pictures.get(path)
