"""`SceneLooker`: renders marked views of a scene for the question loop, with the same numbers in all of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ...gaussians.errors import InstructionError, UserError
from ...planners.vision.looker import Shown

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.scene import Scene
    from ...gaussians.viewpoints.for_groups import ChosenView
    from ...gaussians.viewpoints.from_side import Side
    from ..pictures.marks import Mark

WIDTH, HEIGHT = 768, 576  # pixels, by default; vision models scale down much larger pictures
MOST_MARKS = 40  # marks in one picture where no groups are named; more could not be read

_KINDS = {
    "camera": "A photograph's view of the scene.",
    "overview": "An overview from outside; ceiling and near walls are left out.",
    "walk-in": "A view from inside, at the height of a person's eyes.",
    "close-up": "A close-up.",
}
_SIDES: Mapping[str, Side | None] = {
    "close": None, "front": "front", "behind": "behind", "left": "left", "right": "right", "above": "above",
    "below": "below",
}  # fmt: skip
_REQUEST = re.compile(r"\s*(?P<verb>[a-z]+)(?:\s*:\s*(?P<what>\S.{0,199}))?\s*", re.IGNORECASE)
_THING = re.compile(r"(?P<mark>#?)(?P<number>[0-9]{1,9})")


class SceneLooker:
    """Implements `planners.vision.looker.Looker` for one question about a scene.

    Args:
        scene: with its language field.
        viewer: whose left and right are meant, and whose position the plan shows; None leaves both out of account.
        size: width and height of the pictures, pixels.
        outlines: draw each marked thing's border in its colour.

    Raises:
        UserError: the scene has no language field.
    """

    def __init__(
        self, scene: Scene, viewer: Camera | None = None, size: tuple[int, int] = (WIDTH, HEIGHT), *,
        outlines: bool = True,
    ) -> None:  # fmt: skip
        from ...gaussians.viewpoints.for_groups import Sights

        self._sights = Sights.of(scene)
        self._viewer, self._size, self._outlines = viewer, size, outlines
        self._numbers: dict[int, int] = {}
        self._groups: tuple[int, ...] = ()
        self._overviews = 0
        self._marks = True

    @property
    def numbers(self) -> Mapping[int, int]:
        """Group of each number given so far, whether or not a picture shows it."""
        return {number: group for group, number in self._numbers.items()}

    def overview(self, groups: Sequence[int], count: int, marks: bool = True) -> tuple[Shown, ...]:
        """At most `count` pictures that together show `groups`, best first; the whole scene if `groups` is empty.

        Raises:
            UserError: the scene has no such group.
        """
        from ...gaussians.viewpoints.for_groups import choose

        asked = self._sights.asked(groups)
        self._groups, self._marks = tuple(groups), marks
        chosen = choose(self._sights, groups, count, self._size)
        if groups:
            self._number(asked)
        else:
            seen = {g: max((c.shares[g] for c in chosen), default=0.0) for g in asked}
            self._number(sorted(sorted(asked, key=lambda g: -seen[g])[:MOST_MARKS]))
        self._overviews = len(chosen)
        return tuple(self._draw(c, c.view.name) for c in chosen)

    def look(self, request: str) -> Shown | None:
        """The picture that is asked for (see `Looker.look`), or None if the request cannot be met."""
        match = _REQUEST.fullmatch(request)
        if match is None:
            return None
        verb, what = match["verb"].lower(), (match["what"] or "").strip()
        try:
            if verb == "plan" and not what:
                return self._plan()
            if verb == "overview" and not what:
                return self._next_overview()
            if verb == "view" and what:
                return self._named(what)
            group = self._thing(what)
            if group is None:
                return None
            if verb == "from":
                return self._from(group)
            return self._side(verb, group) if verb in _SIDES else None
        except (UserError, InstructionError):
            return None

    def _next_overview(self) -> Shown | None:
        from ...gaussians.viewpoints.for_groups import choose

        # The choice is greedy, so that the views chosen before come first again.
        chosen = choose(self._sights, self._groups, self._overviews + 1, self._size)
        if len(chosen) <= self._overviews:
            return None
        self._overviews += 1
        return self._draw(chosen[-1], chosen[-1].view.name)

    def _side(self, verb: str, group: int) -> Shown:
        from ...gaussians.viewpoints.from_side import view_from_side

        self._number([group])
        viewer = self._viewer or self._any_viewer()
        found = view_from_side(self._sights, [group], _SIDES[verb], viewer, size=self._size)
        if verb == "close" and (better := self._larger(group, found.chosen)) is not None:
            return self._draw(better, better.view.name)
        where = "" if _SIDES[verb] is None else f" from {_side_words(verb)}"
        whose = " by the viewer's left and right" if found.whose == "viewer" and where else ""
        said = f"A close-up of {self._told(group)}{where}{whose}."
        return self._draw(found.chosen, f"{verb}:{group}", said)

    def _larger(self, group: int, close: ChosenView) -> ChosenView | None:
        """A view of the whole in which a thing is larger than in its close-up, as where its box is not its shape."""
        from ...gaussians.viewpoints.for_groups import choose

        chosen = choose(self._sights, [group], 1, self._size)
        return chosen[0] if chosen and chosen[0].shares[group] > close.shares[group] else None

    def _from(self, group: int) -> Shown:
        from ...gaussians.viewpoints.from_side import view_from_thing

        self._number([group])
        found = view_from_thing(self._sights, group, size=self._size)
        said = f"What a person sees from {self._told(group)}, which itself may be out of sight."
        return self._draw(found.chosen, f"from:{group}", said)

    def _named(self, name: str) -> Shown:
        from ...gaussians.viewpoints.for_groups import measured
        from ...gaussians.viewpoints.view_candidates import View, own_views
        from ..pictures.named_cameras import camera_index

        index = camera_index(self._sights.scene, name.removeprefix("camera ").strip())
        view: View = own_views(self._sights.scene, self._size)[index]
        return self._draw(measured(self._sights, view, self._groups), view.name)

    def _plan(self) -> Shown:
        from ..pictures.image_files import encoded_png
        from ..pictures.plan_view import draw_plan

        self._number(self._sights.asked(self._groups) if self._groups else ())
        groups = tuple(self._numbers)
        plan = draw_plan(self._sights, groups, self._drawn_marks(groups), self._size, self._viewer)
        numbers = {self._numbers[groups[i]]: groups[i] for i in plan.numbers} if self._marks else {}
        unit = "m" if self._sights.scene.frame.metres_per_unit else "units of unknown length"
        said = f"A plan from above, ceiling left out; grid lines are {plan.step:g} {unit} apart."
        if self._viewer is not None:
            said += " The blue dot with an arrow is the viewer and the way they look."
        shares = dict(zip(groups, plan.shares, strict=True))
        return Shown("plan", encoded_png(plan.image), self._size, numbers, said, shares)

    def _draw(self, chosen: ChosenView, name: str, said: str = "") -> Shown:
        from ..pictures.image_files import encoded_png
        from ..pictures.marked_views import draw_view
        from ..pictures.marks import draw_marks

        groups = tuple(self._numbers)
        drawing = draw_view(self._sights.scene, chosen.view.camera, groups, chosen.view.cut)
        image, numbers = drawing.image, dict[int, int]()
        if self._marks:
            image, placed = draw_marks(image, drawing.labels, self._drawn_marks(groups), outlines=self._outlines)
            numbers = {self._numbers[groups[p.index]]: groups[p.index] for p in placed}
        caption = said or _KINDS[chosen.view.kind]
        shares = dict(zip(groups, drawing.shares(len(groups)), strict=True))
        return Shown(name, encoded_png(image), self._size, dict(sorted(numbers.items())), caption, shares)

    def _drawn_marks(self, groups: Sequence[int]) -> tuple[Mark, ...]:
        from ..pictures.marks import Mark, color_of

        if not self._marks:
            return ()
        return tuple(Mark(str(self._numbers[g]), color_of(self._numbers[g])) for g in groups)

    def _number(self, groups: Sequence[int]) -> None:
        """Give each group the next free number, if it has none yet."""
        for group in groups:
            self._numbers.setdefault(group, len(self._numbers) + 1)

    def _told(self, group: int) -> str:
        return f"the thing marked {self._numbers[group]}" if self._marks else "the thing asked for"

    def _thing(self, what: str) -> int | None:
        """The group that "#3" (a mark) or "12" (a group) means."""
        match = _THING.fullmatch(what)
        if match is None:
            return None
        number = int(match["number"])
        return self.numbers.get(number) if match["mark"] else self._sights.asked([number])[0]

    def _any_viewer(self) -> Camera:
        from ..pictures.named_cameras import default_view

        return default_view(self._sights.scene)


def _side_words(verb: str) -> str:
    return {"front": "the front", "left": "its left", "right": "its right"}.get(verb, verb)
