"""What a description says of the light in a room: taken out of its words before the things are read.

"with warm light", "at night", "candle-lit" become features of the brief, each the words that were said. `mood_of` tells
which named light a feature means.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import get_args

from ....tools.lighting.moods import MoodName
from ...grammar.lighting.vocabulary import longest, meanings
from ...grammar.tagging.words import bag
from .. import knowledge

MOODS = frozenset(get_args(MoodName))
_NOUN = "light|lighting|glow|illumination"
# Words for light that count beside "light" or "lit" only, in the order in which they decide: those of `meanings` first.
_BESIDE: tuple[tuple[frozenset[str], MoodName], ...] = (
    (frozenset({"candle", "candles", "fire"}), "candle light"),
    (frozenset({"lamp", "lamps", "lights", "dim", "dimly", "dimmed", "low", "subdued", "moody"}), "evening"),
    (frozenset({"golden"}), "golden hour"),
    (frozenset({"sun"}), "sunny"),
    (frozenset({"warm", "warmly", "soft", "softly", "amber"}), "cosy"),
    (frozenset({"bright", "brightly", "white", "cool", "clear"}), "daylight"),
    (frozenset({"cold", "gray", "grey", "flat"}), "overcast"),
)
_ALONE = "daylight|sunlight|sunshine|moonlight|candlelight|firelight|lamplight"  # light, with its kind in one word
_WORD = (
    r"(?:very|warm|cold|cool|bright|soft|gentle|mellow|dim|dimmed|low|subdued|golden|amber|early|late|evening|morning|"
    r"afternoon|night|candle|lamp|moon|sun|sunny|day|natural|sunset|sunrise|dusk|dawn|twilight|winter|summer|cosy|cozy|"
    r"romantic|intimate|moody|white|gray|grey|overcast)"
)
_TELLING = rf"{_WORD}(?: and {_WORD}| , {_WORD}| {_WORD}){{0,3}}"
_TIME = (
    r"(?:early |late )?(?:night|midnight|dusk|twilight|sunset|sunrise|dawn|golden hour|evening|morning|afternoon|"
    r"candlelight|moonlight|daylight|sunlight|sunshine|firelight|lamplight|(?:sunny|rainy|cloudy|overcast) day)"
)
_END = r"(?=$| [,.;:!?]| and | with )"
_LIGHT = re.compile(
    rf"(?:^|(?<= ))(?:(?:with|in|under|by|and) )?(?:the )?(?:({_TELLING}) ({_NOUN})|(?:{_TELLING} )?({_ALONE})){_END}"
)
_WHEN = re.compile(rf"(?:^|(?<= ))((?:at|by|in|during|on)(?: the| a)? {_TIME}){_END}")
_LIT = re.compile(r"(?:^|(?<= ))((?:candle|lamp|moon|sun|fire|dimly|warmly|softly|brightly) ?(?:lit|drenched))\b")
_SUNNY = re.compile(r"^(?:(?:a|an|my|the|build|make|me) )*(?:[a-z]+ ){0,2}?(sunny) ")
_ON = re.compile(r"(?<= )(lamps?|lights) (?:(?:are|is|switched|turned) )*on(?=$| [,.;:!?]| and | with | in the | at )")
# A clause with one of these words tells of something else than the light in the room.
_ELSEWHERE = bag(
    "who that which where when while for open opens view painting picture photo photograph poster mural print of like "
    "no not without"
)
_LAMPS = frozenset({"a", "an", "one", "two", "three", "each", "every", "its"})


def lights(texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """The words of a description without what they say of the light, and the phrases that said it."""
    text, found = " ".join(texts), list[str]()
    if told := _SUNNY.match(text):
        found.append(told[1])  # the word stays: it is a style too
    for pattern in (_LIGHT, _WHEN, _LIT):
        for match in list(pattern.finditer(text)):
            phrase = " ".join(part for part in match.groups() if part)
            if mood_of(phrase) and _of_the_room(text, match):
                found.append(phrase)
                text = text.replace(match[0], " ", 1) if pattern is _LIT else text.replace(match[0], " , ", 1)
    if told := _ON.search(text):
        found.append("lamp light")
        text = text.replace(told[0], told[1], 1)
    return (_tidied(text.split()), found) if found else (list(texts), [])


def _of_the_room(text: str, match: re.Match[str]) -> bool:
    """Whether words about light are about the room, not about a lamp, a picture, or what people do in it."""
    clause = re.split(r" [,.;:!?](?: |$)", text[: match.start()])[-1].split()
    words = (match[1] or "").split()
    if match.re is _LIT:
        behind = text[match.end() :].split()[:3]
        room = any(knowledge.lookup(knowledge.room_words(), behind, k) for k in range(len(behind)))
        first = set(clause) <= {"a", "an", "the", "my", "build", "make", "me"}
        return not set(clause) & _ELSEWHERE and (room or first or re.match(_END, text[match.end() :]) is not None)
    if match.re is _LIGHT and match[2]:
        thing = knowledge.lookup(knowledge.thing_words(), [words[-1], match[2]], 0)
        if thing is not None and thing[1] > 1:
            return False  # a "night light"
    lamp = match.re is _LIGHT and match[2] == "light" and bool({*clause[-1:], *words[:1]} & _LAMPS)
    return not lamp and not set(clause) & _ELSEWHERE


def _tidied(words: list[str]) -> list[str]:
    """The words without commas beside other marks or at an end."""
    kept: list[str] = []
    for i, word in enumerate(words):
        behind = words[i + 1] if i + 1 < len(words) else "."
        if word != "," or (kept and kept[-1] != "," and behind not in (",", ".", ";", "and", "with", "!", ":")):
            kept.append(word)
    return kept


def mood_of(phrase: str) -> MoodName | None:
    """The named light that a phrase about light means, None if it tells none."""
    words = tuple(w for w in phrase.lower().replace("-", " ").split() if w not in ("a", "the", ","))
    if {"warm", "bright"} <= set(words):
        return "sunny"
    for size in range(min(longest(), len(words)), 0, -1):
        for i in range(len(words) - size + 1):
            for meaning in meanings().get(words[i : i + size], ()):
                if meaning.slot == "mood" and meaning.value in MOODS:
                    mood: MoodName = meaning.value
                    return mood
    return next((mood for beside, mood in _BESIDE if beside & set(words)), None)


def feature_mood(feature: str) -> MoodName | None:
    """The named light that a feature of a brief means; None for features of another kind."""
    words = feature.lower().replace("-", " ").split()
    about = {*_NOUN.split("|"), *_ALONE.split("|"), "lit", "drenched", "sunny"} & set(words)
    return mood_of(feature) if about or _WHEN.fullmatch(" ".join(words)) else None
