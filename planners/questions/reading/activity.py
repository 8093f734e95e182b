"""Reads what somebody would like to do on the floor, with the space that it takes: "do yoga (2 x 1 m)", "dance"."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from ....gaussians import late_re as re
from ....gaussians.world.person import ACTIVITIES
from .item import Item, read_item
from .phrase_templates import Words

_DOING = re.compile(
    r"^(?:do|doing|practice|practise|practicing|make|have|perform|go) (?:some |a few |my |a bit of |a )?"
)
_SAID = {
    "work out": "a workout", "working out": "a workout", "workout": "a workout", "exercising": "exercise",
    "pushups": "push ups", "press ups": "push ups", "situps": "sit ups",
    "stretch": "stretching", "stretches": "stretching",
    "stretch out": "lie", "lie down": "lie", "lying down": "lie", "lying": "lie", "lie on the floor": "lie",
    "lie down on the floor": "lie", "sit down": "sit", "sit on the floor": "sit", "sitting": "sit", "standing": "stand",
    "stand up": "stand", "playing": "play", "play games": "play", "sleeping": "sleep",
    "sleep on the floor": "sleep",
    "meditate": "meditation", "my yoga": "yoga", "dance around": "dance", "a yoga session": "yoga",
    "yoga session": "yoga",
    "yoga exercises": "yoga", "some yoga": "yoga", "workouts": "a workout", "some dancing": "dance", "a dance": "dance",
}  # fmt: skip


@lru_cache(maxsize=1024)
def activity(words: Words) -> Item | None:
    """An activity as an item of the floor that it takes, None if the words name none."""
    said = [w for w in words if w != ","]
    for cut in range(len(said), 0, -1):
        name = _name(" ".join(said[:cut]))
        if name is None:
            continue
        width, depth = ACTIVITIES[name]
        if cut == len(said):
            return Item(name, width, depth)
        sized = read_item(tuple(["something", *said[cut:]]))
        if sized is not None and sized.width is not None and not sized.name:
            return replace(Item(name), width=sized.width, depth=sized.depth or sized.width)
    return None


def _name(said: str) -> str | None:
    done = _DOING.sub("", said)
    for form in (said, done):
        if form in ACTIVITIES:
            return form
        if form in _SAID:
            return _SAID[form]
    return None
