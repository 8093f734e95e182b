"""What looks different, is not seen or goes somewhere: the commands of such wishes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .....gaussians import late_re as re
from .....tools.when import During, Part
from ...learned.seen import hues
from ..command import Command
from ..happenings import Happening
from ..moments import Moment
from .slots import ALL_MOVING, Slots
from .wanted import Wanted, now, plainly

_UP = re.compile(
    r"\b(?:up(?! (?:next|to|beside|at|against|by|on)\b)|upwards?|lift\w*|rais\w+|ris\w+|levitat\w+|float\w*|"
    r"hover\w*|hoist\w*|higher|ascend\w*|into the air|"
    r"off the ground|soar\w*|elevat\w+|jack|climb\w*)\b"
)

_DOWN = re.compile(
    r"\b(?:(?<!set )(?<!put )(?<!lay )(?<!touch )(?<!touches )down|downwards?|lower\w*|sink\w*|sank|descend\w*)\b"
)

_LEFT = re.compile(r"\bleft(?:wards?)?\b")

_RIGHT = re.compile(r"\bright(?:wards?)?\b(?! (?:away|after|when|at|then|now|up|next|beside|before|as|on|in|from)\b)")

_FOLLOWS = re.compile(
    r"\b(?:follow\w*|chas\w+|tail\w*|trail\w*|pursu\w+|(?:run|go|drive|roll|walk|come|trot|"
    r"rac\w+)\w* (?:right )?(?:after|behind)|tag along)\b"
)

_ROUND = re.compile(r"\b(?:circl\w+|orbit\w*|round|around|laps?|loops?)\b")

_HOPS = re.compile(r"\b(?:hop|hops|hopping|jump\w*|leap\w*)\b")

_OTHERWISE = re.compile(  # moves that marks do not tell apart
    r"\b(?:bounc\w+|bob\w*|wobbl\w+|sway\w*|shak\w+|swing\w*|tip(?!toe)\w*|toppl\w+|fall\w*|knock\w*|"
    r"nod\w*|"
    r"rock\w*|danc\w+|drop\w*|swap\w*|exchang\w+|trad\w+|places|throw\w*|kick\w*(?! off)|sits?|tumbl\w+|crash\w*)\b"
)

_SEEN = re.compile(
    r"\b(?:appears?|appear(?:ed|ing)|shows?|showing|shown|visible|into view|in view|pops? (?:up|in)|comes? in(?:to)?|"
    r"reveals?|revealed|spawns?|turns? up|materiali[sz]es?|to be seen|see|seen|in (?:the )?(?:picture|shot|frame)|"
    r"there)\b"
)

_BACK = re.compile(r"\b(?:back|again)\b")

_ENTERS = re.compile(
    r"\b(?:appears?|spawns?|pops? (?:up|in)|shows? up|enters?|comes? in|reveals?|"
    r"materiali[sz]es?)\b"
)

_GONE = re.compile(
    r"\b(?:hid\w*|invisible|vanish\w*|disappear\w*|gone|gon|out|lose|lost|remov\w+|away|off|blank\w*|conceal\w*|poof|"
    r"cut|drop|delet\w+|eras\w+|without|absent|unseen|unrender\w*|mask\w*|take|despawn\w*|bye|missing|suppress\w*|"
    r"visib\w+ ?(?:=|:|to|is)? ?(?:false|0|off|no|none)|"
    r"make \w+self scarce|dissolv\w*|evaporat\w*|melts?|"
    r"blink\w*|transparent|ghost|rid|exit\w*|leave\w*|kill|cloak\w*)\b"
)

NOT = re.compile(r"\b(?:not|no|never|without|nobody|nothing|neither|nor|stop|hardly)\b")

_DELETE = re.compile(r"\b(?:delete|erase|remove)\b")
_THAN = re.compile(r"\bthan\b")


def recolor(slots: Slots) -> Iterator[Wanted]:
    """Another look for a time, or for good."""
    if _THAN.search(slots.rest):
        return  # "silver would look better than green"
    hue = [word for word in slots.color.split() if word in hues()]
    for color in dict.fromkeys((slots.color, " ".join(hue))) if hue else ():  # "neon green" is green
        slots.pass_goals()
        yield Wanted(Command(kind="look", text=f"make {slots.whom} {color}"), slots.moment, slots.happening)


def hide(slots: Slots) -> Iterator[Wanted]:
    """What is not seen for a time, or only then."""
    if not slots.told:
        yield from remove(slots)
        return
    if _DELETE.search(slots.rest) and slots.happening is not None and slots.happening.during.part == "until":
        return  # "delete the vase before it falls" tells a reason
    seen = _SEEN.search(slots.rest) is not None and _GONE.search(slots.rest) is None
    enters = slots.moment.start is not None and slots.moment.stop is None and _ENTERS.search(slots.rest) is not None
    seen = seen and (enters or NOT.search(slots.rest) is None)
    if seen and _BACK.search(slots.whole):
        return  # "show it for a second, then bring it back" contradicts itself
    slots.pass_goals()
    yield Wanted(f"{'show' if seen else 'hide'} {slots.whom}", slots.moment, slots.happening)


def remove(slots: Slots) -> Iterator[Wanted]:
    """What is gone for good, or not seen at a time."""
    slots.pass_goals()
    if slots.told:
        yield Wanted(f"hide {slots.whom}", slots.moment, slots.happening)
    else:
        yield Wanted(Command(kind="look", text=f"remove {slots.whom}"), slots.moment, None)


def move(slots: Slots) -> Iterator[Wanted]:
    """What goes somewhere: to a place, by a length, after or around another thing, or hops."""
    if slots.tell(_OTHERWISE) or _TO_A_HEIGHT.search(slots.said):
        return
    step, whole = slots.happening, slots.whole
    if step is not None and step.until is not None and step.during.part == "while":  # "as it turns, until it stops"
        begun = step.during.model_copy(update={"part": "from"})
        slots = replace(slots, happening=replace(step, during=begun))
        step = slots.happening
    begins = step is not None and (step.during.state, step.during.part) == ("moving", "from")
    if step is not None and begins and step.during.of not in (None, *slots.queries) and _BOTH_THERE.search(whole):
        slots = replace(slots, happening=replace(step, during=step.during.model_copy(update={"part": "while"})))
    if (beside := _beside_another(slots)) is not None:
        yield beside
        return
    goal, length = slots.goal(), slots.one("m")
    if goal is not None and _FOLLOWS.search(slots.rest):
        yield now(slots, f"let {slots.whom} follow {goal.name}")
        return
    if goal is not None and goal.way not in ("on", "to") and _ROUND.search(slots.rest):
        yield now(slots, f"let {slots.whom} drive around {goal.name}")
        return
    source = [own for own in slots.goals if own.way == "from"]
    away = _UP.search(slots.said) is None and _DOWN.search(slots.said) is None
    if goal is None and length is not None and len(source) == 1 and away:  # "30 cm away from the wall"
        yield now(slots, f"move {slots.whom} {length.value:g} m away from {source[0].name}")
        return
    ways = [way for way, words in _WAYS.items() if words.search(slots.said)]
    if _HOPS.search(slots.rest) and goal is None and set(ways) <= {"up"}:
        yield now(slots, f"let {slots.whom} hop{'' if length is None else f' {length.value:g} m'}")
        return
    if goal is not None and not (len(ways) == 1 and length is not None and goal.way == ""):
        how = f" by {length.value:g} m" if length is not None else ""
        new = any(tag == "x" and slots.words[start] in ("a", "an") for tag, start, _ in slots.spans)  # is put in
        film = slots.moves(ALL_MOVING) and not slots.moves(slots.queries[0])
        if length is None and not slots.told and film and not new:
            text = f"move {slots.whom} {'onto' if goal.way == 'on' else 'next to'} {goal.name}"
            yield Wanted(Command(kind="look", text=text), Moment(), None)
        place = f"towards {goal.name}" if length is not None else f"{'onto' if goal.way == 'on' else 'to'} {goal.name}"
        yield Wanted(f"move {slots.whom}{how} {place}", slots.moment, slots.happening)
    elif len(ways) == 1 and (length is not None or ways == ["up"]):
        how = f" by {length.value:g} m" if length is not None else ""
        yield Wanted(f"move {slots.whom} {ways[0]}{how}", slots.moment, slots.happening)


_BOTH_THERE = re.compile(  # "sets off when the robot does, and they both get there together"
    r"\b(?:both|together)\b.*\b(?:arriv\w+|there|reach\w*)\b|\b(?:arriv\w+|there|reach\w*)\b.*\b(?:both|together)\b"
)

_ARRIVES = re.compile(
    r"\b(?:arriv\w+|there|reach\w*|gets? (?:to|in)|finish\w*|lands?|parks?|ends? (?:up )?together|both|sync\w*|same "
    r"times|side by side|comes? in|pull\w* (?:in|up)|together\b.*\btogether)\b"
)


def _beside_another(slots: Slots) -> Wanted | None:
    """Something that goes to a place as another thing moves, which is named beside that: "the car drives to the bed,
    too, and both arrive together"; None for others."""
    others = [goal for goal in slots.goals if goal.way != "from"]
    movers = [goal for goal in others if slots.moves(goal.query)]
    ends = slots.moment.start is None and slots.happening is None  # "... and arrives at 3 s"
    if len(others) != 2 or len(movers) != 1 or not ends or slots.moves(slots.queries[0]):
        return None
    place = next(goal for goal in others if goal is not movers[0])
    slots.pass_goals()
    lags = slots.moment.lasting is not None and _BEHIND_IT.search(slots.rest) is not None
    if lags:  # "comes in half a second behind the robot"
        happening = Happening(During(state="moving", of=movers[0].query, part="from"), f"after {movers[0].name}")
        return Wanted(f"move {slots.whom} to {place.name}", Moment(start=slots.moment.lasting), happening)
    words = slots.whole
    part: Part = "while" if _ARRIVES.search(words) and not slots.told else "from"
    happening = Happening(During(state="moving", of=movers[0].query, part=part), f"as {movers[0].name} does")
    return Wanted(f"move {slots.whom} to {place.name}", plainly(slots.moment), happening)


_BEHIND_IT = re.compile(r"\b(?:behind|after) \|")

_TO_A_HEIGHT = re.compile(r"\bto (?:\d[\d.]*|half a|one|two|three) ?(?:m|cm|met\w+|centimet\w+)\b")

_WAYS = {
    "up": _UP, "down": _DOWN, "to the left": _LEFT, "to the right": _RIGHT,
    "forward": re.compile(r"\b(?:forwards?|ahead)\b"), "backwards": re.compile(r"\bbackwards?\b"),
    "back": re.compile(r"\bback\b(?! (?:to|in|into|at|by|on)\b)"),
    "towards the viewer": re.compile(
        r"\b(?:to|towards?|nearer|closer)\b (?:to )?(?:the )?(?:viewer|camera|screen|audience|front)\b"
    ),
}  # fmt: skip
