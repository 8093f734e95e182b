"""The `Looker` protocol: how the question loop gets rendered pictures of a scene without knowing how they are made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True)
class Shown:
    """A picture of the scene as a model is shown it.

    Attributes:
        name: "overview 1", "plan", "close:12", or a camera's name; unique among the views of one question, and what
            `Evidence.views` cites.
        png: the encoded picture, RGB.
        size: its width and height, pixels.
        numbers: the marks drawn in it: number to group id. A number means the same group in all views of one looker.
            Groups that are hidden in this view are not in it.
        caption: one sentence that says where the picture is taken from and what its marks and scale mean.
        visible: group id to the share of the picture's pixels that the group covers, for every group asked for.
    """

    name: str
    png: bytes
    size: tuple[int, int]
    numbers: Mapping[int, int] = field(default_factory=dict)
    caption: str = ""
    visible: Mapping[int, float] = field(default_factory=dict)


class Looker(Protocol):
    """Renders views of one scene for one question; marks keep their numbers over all its views."""

    def overview(self, groups: Sequence[int], count: int, marks: bool = True) -> tuple[Shown, ...]:
        """At most `count` pictures that together show `groups`, best first; the whole scene if `groups` is empty.

        With `marks`, each of `groups` (with none given: each of the most visible objects) carries its number where it
        is seen.
        """
        ...

    def look(self, request: str) -> Shown | None:
        """The picture that a model asked for, or None if the request cannot be met.

        Requests, with ids or marks' numbers prefixed by "#" ("close:#3" is the thing marked 3, "close:12" group 12):
        "plan" (from above, with a metre grid), "overview" (the next best view of the whole), "close:ID" (near ID),
        "from:ID" (standing or sitting at ID, looking ahead), "behind:ID", "left:ID", "right:ID", "above:ID" (ID from
        that side), "view:NAME" (a camera of the scene by name or number). Unknown words give None, never an error.
        """
        ...
