"""The words of sentences about light, by what they mean (`vocabulary.json`). Phrases are matched before single words.

A meaning is a slot and a value. Slots: "noun" (what names light), "air" (what has a mood), "place" (the scene or a
room), "it", "brighter" and "warmer" (a change, 1 or -1), "raise" and "weak" (a change of what is named), "level" (how
bright something is), "flaw" (what is wrong with it, by the change that mends it), "color" (of light, 1 for warm),
"mood", "kelvin", "side", "contrast", "shadow", "hard", "harder", "more" (1 or -1), "too", "lack", "enough", "not",
"degree", "stop", "is", "thing" (a thing with a word
for light in its name), and "filler", which says nothing.
"""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

from ..tagging.words import bag


class Meaning(NamedTuple):
    """What a word or phrase means."""

    slot: str
    value: Any = None


# Moods that need no other word for light beside them, and words for moods that do.
_STRONG = frozenset(
    {"evening", "dusk", "night", "moonlight", "golden hour", "sunrise", "overcast", "daylight", "sunny", "candle light"}
)
_BESIDE_LIGHT = bag("natural bleak wintry calm even flat candles clouds campfire")


@cache
def meanings() -> dict[tuple[str, ...], tuple[Meaning, ...]]:
    """All meanings of each phrase."""
    text = resources.files(__package__ or "").joinpath("vocabulary.json").read_text(encoding="utf-8")
    found: dict[tuple[str, ...], list[Meaning]] = {}
    for entry in json.loads(text):
        for phrase in entry["phrases"].split(", "):
            found.setdefault(tuple(phrase.split()), []).append(Meaning(entry["slot"], entry.get("value")))
    return {phrase: tuple(values) for phrase, values in found.items()}


@cache
def longest() -> int:
    """Words of the longest phrase."""
    return max(len(phrase) for phrase in meanings())


def needs_light(mood: str, words: tuple[str, ...]) -> bool:
    """Whether a word for a mood means light only beside another word for light."""
    return mood not in _STRONG or (len(words) == 1 and words[0] in _BESIDE_LIGHT)
