"""How much time is between two events: who does what in the words for each."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ......gaussians import late_re as re
from ......gaussians.world import kinds as kinds_of_things
from ......gaussians.world.words import singular
from ...noun_phrase import is_color_word
from .phrases import deed_of
from .said import Said
from .times import from_one_to_another

_OUTWARD = re.compile(r"\b(?:out|outward|outwards|opening|extension)\b")
_INWARD = re.compile(r"\b(?:back|return|inward|inwards|closing|retraction|in)\b")
_RESTS = re.compile(r"\b(?:pause|break|rest|hold|wait|stay|dwell)\b")


_EVENT_OF = re.compile(  # "the onset of the red book 's fall", "the red book 's landing", "that of the blue one 's"
    r"^(?:from |until |till |to |when |once |and )*"
    r"(?:(?:the |its )?(?P<first>[a-z]+(?: point)?|that) of )?(?P<who>(?:the )?[a-z ]+?)(?: 's)?"
    r"(?: (?:starting|beginning|begins|starts) to)?"
    r"(?: (?P<deed>starting (?:down|off|out)|dropping(?: off| down)?|following(?: \w+){0,3}|coming (?:down|off)|"
    r"letting go|going|leaving(?: \w+){0,3}|tipping(?: \w+)?|starting|falling|landing|stopping|fall up|fall|drop|"
    r"impact|start|onset|departure|release|trigger|drop trigger|stop|end|opening|closing|"
    r"(?:has |have )?(?:landed|lands?|fallen|falls?|dropped|drops?|started|starts?|stopped|stops?|left)"
    r"(?: \w+){0,3}))?$"
)
_PAUSE = re.compile(r"\b(?:pause|break|rest)\b")
_BEGINS = re.compile(
    r"\b(?:start\w*|onset|departure|release|trigger|beginning|leaving|left|letting go|tipping|going)\b"
)
_ENDS = re.compile(r"\b(?:stopping|stopped|stops?|end|landing|landed|lands?|impact|touchdown)\b")


def _is_there(word: str, names: Collection[str]) -> bool:
    """Whether a noun is that of a thing of the scene, or another word for it: "volume"."""
    kind = kinds_of_things.find(singular(word))
    return singular(word) in names or (kind is not None and any(own in names for own in kind.name.split()))


def _names_one(said: str, names: Collection[str]) -> bool:
    """Whether words name a thing of the scene."""
    return said != "" and (_is_there(said.split()[-1], names) or said.endswith(" one"))


def _event_in(said: str, names: Collection[str], noun: str) -> tuple[str, str] | None:
    """Who does what in the words for an event, and "" for what is said of another one; None if nobody is named."""
    found = _EVENT_OF.match(said)
    if found is None:
        return None
    who, told = found["who"].removeprefix("the ").split(), f"{found['first'] or ''} {found['deed'] or ''}"
    if who[-1] in ("one", "fall", "drop"):
        who[-1] = noun
    if is_color_word(who[-1]):
        who.append(noun)
    if (not _is_there(who[-1], names) and who[-1] != "one") or who in (["one"], ["next", "one"]):
        return None
    falls = deed_of(f"{told} {said}", "") in ("fall", "land")
    if _ENDS.search(told):
        deed = "landing" if falls else "stopping"
    elif falls:
        deed = "falling"
    else:
        deed = "starting" if _BEGINS.search(told) else ""
    return f"the {' '.join(who)}", deed


def gap(said: Said) -> Iterator[str]:
    parts = (*said.times, said.x, said.y)
    nouns = (word for part in parts for word in part.split() if _is_there(word, said.names) and not is_color_word(word))
    noun = next(nouns, "one")
    told = [event for part in parts if part and (event := _event_in(part, said.names, noun))]
    if len(told) == 2 and told[0][0] != told[1][0]:
        if _PAUSE.search(said.rest):
            return  # from the end of one to the beginning of the other
        (one, deed), (other, then) = told
        deed = deed or then or {"fall": "falling", "land": "landing"}.get(deed_of(said.rest, ""), "starting")
        yield f"how much time is there between {one} {deed} and {other} {then or deed}"
        return
    rests = len(said.times) == 2 and _RESTS.search(said.rest) is not None
    if rests and _OUTWARD.search(said.times[0]) and _INWARD.search(said.times[1]):
        yield f"how long does {said.x or 'it'} stay fully open"
    elif rests:
        yield f"how long is the pause between {said.times[0]} and {said.times[1]}"
    elif len(said.times) == 2:
        yield f"how much time is there between {said.times[0]} and {said.times[1]}"
    if (between := from_one_to_another(said.times, said.x, lambda name: _names_one(name, said.names))) is not None:
        yield between
    deed = {"fall": "falling", "land": "landing", "stop": "stopping", "open": "opening", "close": "closing"}.get(
        deed_of(said.rest, ""), "starting"
    )
    if said.x and said.y:
        yield f"how much time is there between {said.x} {deed} and {said.y} {deed}"
