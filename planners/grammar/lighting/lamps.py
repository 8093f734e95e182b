"""Reads clauses that turn lights on and off or dim them: "turn the lamp on", "lights out", "light the candles"."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....gaussians.world.words import singular
from ..tagging.words import bag
from ..vocabulary import quantities

_SWITCH = (
    r"(?:turn|switch|put|flick|flip|click|power|toggle|leave|keep|have|get|set|make|bring|want|need|snap|pop|"
    r"stick|with)"
)
_POLITE = (
    r"(?:(?:please|now|then|ok|okay|hey|so|and|also|can you|could you|would you|will you|can we|could we|can i|could i|"
    r"i want you to|i would like you to|i need you to|let us|let me|go and|just|kindly|would you mind|i want to|"
    r"i would like to|you can|we need to|we should|you should|time to|do|mind|i would like|i want|i would love|we want|"
    r"i need|we need|maybe|perhaps|may i have|can i have|could we have|can we have|could i have) )*"
)
_AFTER = (
    r"(?: (?:please|now|then|for me|for us|thanks|thank you|too|as well|again|would you|will you|could you|"
    r"can you|ok))*"
)
_ON, _OFF = "on", "off"
_FORMS: tuple[tuple[str, str], ...] = (
    (rf"{_SWITCH}(?:ing)? (?:back )?on (?P<what>.+?)", _ON),
    (rf"{_SWITCH}(?:ing)? (?:off|out) (?P<what>.+?)", _OFF),
    (rf"{_SWITCH}(?:ing)? (?P<what>.+?) (?:back )?on", _ON),
    (rf"{_SWITCH}(?:ing)? (?P<what>.+?) (?:off|out)", _OFF),
    (rf"(?:can|could|should|must|may|shall) (?P<what>.+?) be (?:{_SWITCH}(?:ed|ped|n)? |lit |switched |turned "
    rf")?on", _ON),
    (rf"(?:can|could|should|must|may|shall) (?P<what>.+?) be (?:{_SWITCH}(?:ed|ped|n)? |switched |turned )?(?:off|"
    rf"out)", _OFF),
    (r"(?:i|we) do not (?:want|need|like) (?P<what>(?:the|that|this|my|any|those) .+?) (?:to be )?(?:turned |"
    r"switched )?on", _OFF),
    (r"(?:light up|light|ignite|activate|start|enable|fire up|power up) (?P<what>.+?)", _ON),
    (
        r"(?:kill|hit|extinguish|blow out|snuff out|snuff|deactivate|disable|douse|cut|shut off|shut down|put out|"
        r"kill off|power down) (?P<what>.+?)",
        _OFF,
    ),
    (rf"(?P<what>.+?) (?:(?:should|must|needs? to|has to|have to|to) be |to be |shall be )?(?:{_SWITCH}ed )?on", _ON),
    (
        rf"(?P<what>.+?) (?:(?:should|must|needs? to|has to|have to|to) be |to be |shall be )?(?:{_SWITCH}ed )?"
        r"(?:off|out)",
        _OFF,
    ),
    (r"(?P<what>.+?) (?:should|must) (?:be lit|be burning|burn|shine|glow|be glowing|be shining)", _ON),
    (rf"{_SWITCH} (?P<what>.+?) (?:shine|glow|burn|light up|lit|glowing|burning|shining)", _ON),
    (r"dim (?:down )?(?P<what>.+?)(?: down)?(?: a bit| a little| slightly)?", "dim"),
    (r"turn down (?P<what>.+?)", "dim"), (r"turn (?P<what>.+?) down", "dim"),
)  # fmt: skip
_READ = tuple((re.compile(rf"{_POLITE}{form}{_AFTER}"), way) for form, way in _FORMS)
_ALL_LIGHTS = re.compile(
    r"(?:(?:the|all|all the|all of the|every|my|our|any|some|those|these|both|both the|each|just the) )*"
    r"(?:(?:main|overhead|house|room|big|ceiling|electric|indoor|interior|whole|kitchen|bedroom|living room|bathroom|"
    r"hall|hallway|office) )*(?:lights?|lighting|illumination)"
    r"(?: (?:in here|in the room|in this room|in the house|of the room|everywhere|in the \w+|all|here|up here|"
    r"around here))*"
)
_LAMPS = bag(
    "lamp light chandelier lantern candle sconce spotlight bulb lampshade uplighter downlight torchiere nightlight "
    "tealight fireplace lightbulb strip pendant downlighter luminaire"
)
_SIDED = re.compile(r"^(?:just |only )?(?:the |that |my )?(?:left|right)(?: hand)? (?=\w)")
_AMOUNT = re.compile(
    rf"{_POLITE}(?P<way>dim|brighten|turn|bring|take)(?: (?:down|up))? (?P<what>.+?)(?: (?:down|up))? "
    rf"(?P<to>by|to)(?: (?:about|around|like|roughly))? (?P<amount>[^ ].*?){_AFTER}"
)
_AGAIN = bag("turn switch kill off everything")
_BEHIND = re.compile(
    r" (?:on|in|by|next|near|at|behind|beside|under|over|above|to|of|between|left|right|that|which|with) "
)


class Switched(NamedTuple):
    """A clause that turns lights on or off: its fields, and what it means, None for all lights of the scene."""

    fields: dict[str, Any]
    target: Query | None


def switched(said: str, thing: Callable[[str], Query | None]) -> Switched | None:
    """What a clause turns on, off or down, None if it turns no lamp.

    Args:
        said: words in lower case, without marks.
        thing: reads a phrase for things.
    """
    if (changed := _by_amount(said, thing)) is not None:
        return changed
    for pattern, way in _READ:
        if (found := pattern.fullmatch(said)) is None:
            continue
        what = found["what"]
        if _AGAIN & set(what.split()):  # two clauses: "the lamp on, everything else off"
            continue
        if _ALL_LIGHTS.fullmatch(what):
            return None if way == "dim" else Switched({"lamps": way}, None)
        if is_lamp(what) and (query := thing(what)) is not None:
            fields = {"lamps": "off", "amount": 0.5} if way == "dim" else {"lamps": way}
            return Switched(fields, query)
    return None


def _by_amount(said: str, thing: Callable[[str], Query | None]) -> Switched | None:
    """A lamp that is dimmed or raised by an amount: "dim the floor lamp by 20 %", "the lamp down to half"."""
    if (found := _AMOUNT.fullmatch(said)) is None or not is_lamp(found["what"]):
        return None
    if _ALL_LIGHTS.fullmatch(found["what"]):
        return None
    words = found["amount"].split()
    share = quantities.read(words)
    if share is None or share.taken != len(words) or share.kind not in ("PERCENT", "FRACTION"):
        return None
    sign = -1 if found["way"] == "dim" or "down" in said.split() else 1
    factor = share.value if found["to"] == "to" else 1 + sign * share.value
    query = thing(found["what"]) if 0.02 <= factor <= 20 else None
    return Switched({"exposure": round(factor, 4)}, query) if query is not None else None


def is_lamp(what: str) -> bool:
    """Whether the first noun of a phrase names a lamp: "the lamp on the desk", "both floor lamps"."""
    head = _BEHIND.split(_SIDED.sub("", what))[0]
    words = head.split()
    if not words:
        return False
    if singular(words[-1]) in _LAMPS:
        return True
    kind = next((k for i in range(len(words)) if (k := kinds.find(" ".join(words[i:]))) is not None), None)
    return kind is not None and (kind.name.endswith(("lamp", "lights", "lantern")) or kind.name in _LAMPS)
