"""A `Looker` over pictures of noise: every view is recorded, and each shows the marks that it is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from loopback import png

from scenewright.planners.vision.looker import Shown


class ScriptedLooker:
    """Renders nothing.

    Args:
        marks: number to group; every overview shows all of them.
        views: how many different overviews there are.
        size: of the pictures, pixels.

    Attributes:
        made: names of all pictures so far, in order.
        requests: what `look` was asked for.
    """

    def __init__(
        self, marks: Mapping[int, int] | None = None, views: int = 12, size: tuple[int, int] = (32, 24)
    ) -> None:
        self.marks = dict(marks if marks is not None else {1: 10, 2: 20, 3: 30})
        self.made: list[str] = []
        self.requests: list[str] = []
        self._left, self._size = views, size

    def overview(self, groups: Sequence[int], count: int, marks: bool = True) -> tuple[Shown, ...]:
        wanted = {m: g for m, g in self.marks.items() if not groups or g in groups} if marks else {}
        shown = []
        while self._left > 0 and len(shown) < count:
            shown.append(self._shown(f"overview {len(self.made) + 1}", wanted))
        return tuple(shown)

    def look(self, request: str) -> Shown | None:
        self.requests.append(request)
        kind, _, rest = request.partition(":")
        if kind == "overview" and self._left > 0:
            return self._shown(f"overview {len(self.made) + 1}", self.marks)
        if kind == "plan":
            return self._shown("plan", self.marks, counted=False)
        numbers = {f"#{m}": m for m in self.marks} | {str(g): m for m, g in self.marks.items()}
        if kind in ("close", "behind") and rest in numbers:
            return self._shown(f"{kind}:{self.marks[numbers[rest]]}", {numbers[rest]: self.marks[numbers[rest]]}, False)
        return None

    def _shown(self, name: str, marks: Mapping[int, int], counted: bool = True) -> Shown:
        self._left -= counted
        self.made.append(name)
        data = png(*self._size, seed=len(self.made))
        return Shown(
            name, data, self._size, dict(marks), f"A view of the room ({name}).", dict.fromkeys(marks.values(), 0.1)
        )
