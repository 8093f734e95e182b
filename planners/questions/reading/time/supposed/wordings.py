"""The plain question of each kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from ......gaussians import late_re as re
from ......gaussians.world.words import singular
from .....grammar.tagging.words import bag
from .gaps import gap
from .phrases import (
    ALL_OF,
    DENIED,
    PRONOUNS,
    SUMMED,
    deed_of,
    is_kind,
    of_one,
    one_of,
    several,
    third_person,
    uncounted,
)
from .said import Said
from .times import BEFORE_BACK, STROKES, plain_time

_OFTEN = (
    (re.compile(r"\b(?:com(?:es?|ing)|slid(?:es?|ing)|pops?|pulled) (?:\w+ )?out\b"), "how often does {x} open"),
    (re.compile(r"\bsteps?\b|\bpaces?\b"), "how many steps does {x} take"),
    (re.compile(r"\bhops?\b|\bbounc\w+|\bbobs?\b|\bjumps?\b"), "how often does {x} bob"),
)

Plain = Callable[[Said], Iterator[str]]


def _about(text: str, unit: bool = False) -> Plain:
    """A plain question with the things in it; none if it needs one that is not named."""

    def made(said: Said) -> Iterator[str]:
        if "{y}" in text and not said.y and said.x.count(" and ") == 1:
            one, other = said.x.split(" and ")  # which is on which is told by the scene
            yield from (text.format(x=one, y=other), text.format(x=other, y=one))
            return
        if ("{y}" in text and not said.y) or ("{x}" in text and not said.x):
            return
        asked = text.format(x=said.x, y=said.y)
        yield f"{asked} in {said.unit}" if unit and said.unit else asked

    return made


def _either(*ways: Plain) -> Plain:
    """The first of the ways that gives a question."""

    def made(said: Said) -> Iterator[str]:
        for way in ways:
            found = tuple(way(said))
            if found:
                yield from found
                return

    return made


def _moves(said: Said) -> Iterator[str]:
    yield f"does {said.x or 'anything'} move"


_PLACE = re.compile(
    r"^(?P<place>.*\b(?P<noun>corner|wall|side|middle|centre|center)s?)(?: (?:of|in) (?:the |this )?\w+)?$"
)


def _at_place(said: Said) -> Iterator[str]:
    """What stands in a corner, or at a wall."""
    found = _PLACE.match(said.x) or _PLACE.match(said.y)
    if found is not None:
        yield f"what stands {'at' if found['noun'] == 'wall' else 'in'} {found['place']}"


_RANKED_AS = {
    "first": re.compile(r"\b(?:first|earliest|soonest|begins?|starts?|leads?|before|opens)\b"),
    "last": re.compile(r"\b(?:last|latest|final\w*|longest|longer|after|closes|ends?(?! up\b))\b"),
}


def _ordered(said: Said, rank: str) -> Iterator[str]:
    if _RANKED_AS[rank].search(f"{said.x} {said.rest}") is None:
        return
    deed = deed_of(said.rest, "move")
    noun = "thing" if not said.x or " and " in said.x or said.x in PRONOUNS else one_of(said.x)
    yield f"which {noun} {third_person(deed)} {rank}"


def _in_order(said: Said) -> Iterator[str]:
    if said.x and " and " not in said.x and said.x not in PRONOUNS and not said.x.endswith("s"):
        yield f"what does {said.x} do"
        return
    deed = deed_of(said.rest, "move")
    yield f"in what order do {said.x if said.x and said.x not in PRONOUNS else 'things'} {deed}"


_MOVING = re.compile(
    r"\b(?:mov\w*|motion|go|goes|roll\w*|walk\w*|spin\w*|slid\w*|shift\w*|budg\w+|stir\w*|travel\w*|wobbl\w+|"
    r"action|animat\w+|active|dynamic|still|act|do|does|com\w+|run\w*|driv\w+|chang\w+|leav\w+)\b"
)


_SEEN = re.compile(r"\b(?:do|did|can|could) (?:i|you|we|they|one) (?:have|see|find|count)\b")
_LEFT_UP = re.compile(
    r"\b(?:left|still|remain\w*|stay\w*) (?:(?:sitting|standing|resting|lying|perched|there|upright) )*"
    r"(?:up|on the (?:\w+ )?(?:shelf|board|high))\b"
)


_BESIDE = re.compile(r" (?:at|by|around|round|near|beside|in|on|under) ")
_NOT_DONE = {"open": "stay closed", "fall": "do not fall", "land": "do not fall"}


_SIDE = re.compile(
    r"\b(?P<side>left|right)\b(?:(?!.*\b(?:or|left|right)\b)| (?:, )?(?:and )?not (?:to )?(?:its |the )?(?:left|right))"
)
_QUESTION_WORDS = bag("which what where how when whither tell name say state")


def _to_a_side(said: Said) -> Iterator[str]:
    """Whether something turns to a side: "does it pivot to the left?"."""
    side = _SIDE.search(said.rest)
    if side is not None and said.x and _QUESTION_WORDS.isdisjoint(said.rest.split()):
        yield f"does {said.x} turn to the {side['side']}"


def _if_still(said: Said) -> Iterator[str]:
    if said.x:  # "the ball comes to rest at 3 s, does it not?"
        yield f"does {said.x} {'stop' if _COMES_TO_REST.search(said.rest) else 'stand still'}"


_COMES_TO_REST = re.compile(r"\b(?:comes? to rest|stops|settles)\b")


def _if_turns(said: Said) -> Iterator[str]:
    side = _SIDE.search(said.rest)
    if said.x and (side is None or " not " in side[0] or " not " not in said.rest):
        yield f"does {said.x} turn" + (f" to the {side['side']}" if side else "")


def _counted(said: Said) -> Iterator[str]:
    deed = deed_of(said.rest, "move")
    if _LEFT_UP.search(said.rest) and said.x and said.x not in PRONOUNS:
        yield f"how many {several(said.x)} " + (f"are on {said.y}" if said.y else "have not fallen")
        return
    if (
        deed == "fall"
        and _BY_THEN.match(said.time)
        and re.search(r"\b(?:down|fallen|dropped|landed|crashed|off|lost)\b", said.rest)
    ):
        deed = "have fallen"
    x, *others = said.x.split(" and ")
    if not (others and x.endswith("s") and not any(other.endswith("s") for other in others)):
        x = said.x  # "the chairs round the table" are chairs
    noun = _BESIDE.split(several(x))[0] if x and x not in PRONOUNS else "things"
    if not DENIED.isdisjoint(said.rest.split()):
        fallen = re.search(r"\b(?:fallen|dropped|landed|come down)\b", said.rest)
        yield f"how many {noun} {'have not fallen' if fallen else _NOT_DONE.get(deed, 'do not move')}"
        return
    if deed == "open" and re.search(r"\b(?:is|are|stands?|lies?|stays?) (?:still |fully |wide )?open\b", said.rest):
        yield f"how many {noun} are open"
        return
    if said.y and not deed_of(said.rest, "") and (at := re.search(r"\b(?:on|in|under)\b", said.rest)) is not None:
        yield f"how many {noun} are {at[0]} {said.y}"
        return
    if deed == "move" and not said.time and not _MOVING.search(_SEEN.sub(" ", said.rest)):
        yield f"how many {noun} are there"
        return
    yield f"how many {noun} {deed}"


_BY_THEN = re.compile(
    r"^(?:(?:at|by|after|with|when|once|as|come|some) )?(?:\d|(?:the )?(?:clock|count|end of the)\b|half ?way|mid ?way|"
    r"(?:one|two|three|four|five)\b)"
)


def _compared(said: Said, word: str) -> Iterator[str]:
    if said.x and said.y:
        deed = deed_of(said.rest, "start to move")
        deed = "stop moving" if deed == "stop" else deed
        yield f"does {said.x} {deed} {word} {said.y}"


def _often(said: Said) -> Iterator[str]:
    if said.x:
        own = next((text for words, text in _OFTEN if words.search(said.rest)), "")
        yield (own or f"how often does {{x}} {deed_of(said.rest, 'move')}").format(x=said.x)


def _turns(said: Said) -> Iterator[str]:
    if said.x:
        degrees = "degree" in f"{said.unit} {said.rest}" or "angle" in said.rest
        yield f"how many degrees does {said.x} turn" if degrees else f"how many turns does {said.x} make"


_HOW_LONG = re.compile(
    r"\b(?:how long|how many seconds|how much time|what (?:length|amount) of time|period|takes? (?:\w+ )*?what time|"
    r"what time (?:\w+ )*?takes?)\b"
)


def _one_turn(said: Said) -> Iterator[str]:
    """How long one turn takes, where a time is wanted of how fast, or how often, something turns."""
    timed = said.unit in ("seconds", "second", "s", "sec") or _HOW_LONG.search(f"{said.rest} {said.unit}")
    if said.x and timed:
        yield f"how long does {said.x} take for one turn"


def _fast(said: Said) -> Iterator[str]:
    if said.x:
        yield f"how fast does {said.x} move in {said.unit}" if said.unit else f"what is the average speed of {said.x}"


def _long(said: Said) -> Iterator[str]:
    if said.x:
        deed = deed_of(said.rest, "move")
        yield f"how long does {said.x} {deed if deed in ('turn', 'fall') else 'move'}"


_FULLY = re.compile(
    r"\b(?:right out|(?:its|the) furthest|full extension|fully|full|completely|wholly|"
    r"all the way|entirely|maximum|widest|furthest|"
    r"(?:extended|open|pulled out|drawn out|out) (?:state|pose|position))\b"
)


_HALFWAY = re.compile(r"\b(?:half|half ?way|mid ?point|middle)\b")


def _when_open(said: Said) -> Iterator[str]:
    if said.x:
        yield f"when is {said.x} {'half' if _HALFWAY.search(said.rest) else 'fully'} open"


_WHICH = re.compile(r"\b(?:which|name|list|what)\b")


def _if_open(said: Said) -> Iterator[str]:
    if said.x:
        yield f"is {said.x} {'fully ' if _FULLY.search(said.rest) else ''}open"


def _those_shut(said: Said) -> Iterator[str]:
    if is_kind(said.x) and _WHICH.search(f"{said.rest} {said.off}") and not re.search(r"\d", said.time):
        yield f"which {uncounted(said.x)} stay closed"


def _of_those(asked: str, always: str) -> Plain:
    """Which things of a kind do something at a time, or all the time."""

    def made(said: Said) -> Iterator[str]:
        noun = uncounted(said.x) if is_kind(said.x) else ""
        if "fallen" in asked and _IN_THE_AIR.search(said.rest):  # neither before its fall nor behind it
            yield f"which {singular(noun) or 'thing'} is falling"
            return
        form = asked if said.time or not always else always
        if _HOW_MANY.search(said.rest):
            yield f"how many {noun or 'things'} {form}"
            return
        yield f"which {noun} {form}" if noun else f"what {of_one(form)}"

    return made


def _offered(does: str, otherwise: Plain) -> Plain:
    """Which of several things that are named do something."""

    def made(said: Said) -> Iterator[str]:
        if " and " in said.x:
            *names, last = said.x.split(" and ")
            yield f"what {does} {{when}}, {', '.join(names)} or {last}"
        else:
            yield from otherwise(said)

    return made


_IN_THE_AIR = re.compile(
    r"\b(?:on (?:its|their|the) way (?:down|to the (?:floor|ground))|falling|mid ?(?:air|flight|fall|drop)|"
    r"in flight|in the air|airborne)\b"
)
_HOW_MANY = re.compile(r"\b(?:how many|(?:what|the) number of|count)\b")


def _what_on(said: Said) -> Iterator[str]:
    if re.search(r"\b(?:inside|within)\b", said.rest):
        return
    if said.y:
        yield f"which {several(said.x)} are on {said.y}" if is_kind(said.x) else f"what is on {said.y}"
    elif said.x:
        yield f"what is on {said.x}"


_OUT = re.compile(r"\b(?:pulled|slid|hang\w*|extended|wide|all the way|fully|completely|right) (?:out|open)\b")


def _long_still(said: Said) -> Iterator[str]:
    back = not said.time or BEFORE_BACK.search(said.time) is not None
    pose = f"{said.rest} {said.off} {said.time}"
    out = (back and _OUT.search(pose)) or STROKES.match(said.time)  # "sits there pulled all the way out"
    if said.x and out:
        yield f"how long does {said.x} stay fully open"
    elif said.x:
        yield f"how long does {said.x} stand still"


_EVENTS = re.compile(r"\b(?:leav|reach|set|start|stop|depart|arriv|roll|com)(?:e?s|ing)\b")  # that are put in order


def _visits(said: Said) -> Iterator[str]:
    places = [place for place in said.places if place != said.x]
    if said.x and len(places) > 1 and len(_EVENTS.findall(said.rest)) < 2:
        yield f"in what order does {said.x} pass {' and '.join(places)}"
    elif said.x and not places:
        yield f"what does {said.x} touch"


def _long_open(said: Said) -> Iterator[str]:
    if said.x:
        pose = f"{said.rest} {said.time} {said.off}"
        fully = STROKES.match(said.time) or _FULLY.search(pose) or _IN_POSE.search(pose)
        yield f"how long does {said.x} stay {'fully ' if fully else ''}open"


_IN_POSE = re.compile(  # as far out as it comes: "just stands there pulled out", "lingers before it goes back"
    r"\b(?:pose|outermost|stretch\w*|extended|pulled out|wide|flung|(?:stands?|sits?|hangs?) there|rests?|linger\w*|"
    r"motionless|not moving)\b"
)


def _in_total(said: Said) -> Iterator[str]:
    if said.x and SUMMED.search(f"{said.rest} {said.off}"):
        yield f"how far does {said.x} move in total" + (f" in {said.unit}" if said.unit else "")


def _which(said: Said) -> Iterator[str]:
    if " and " in said.x:
        yield f"which of {said.x} is the fastest"
        nouns = {name.split()[-1] for name in said.x.split(" and ")}
        if len(nouns) == 1:
            yield f"which {singular(nouns.pop())} is the fastest"
    elif said.x:
        yield f"which {one_of(said.x)} is the fastest"


def _over(said: Said) -> Iterator[str]:
    if said.x and said.y:
        passes = re.search(r"\b(?:past|pass|passes|passed|by)\b", said.rest) is not None
        yield f"does {said.x} {'pass' if passes else 'cross'} {said.y}"


def _if_on(said: Said) -> Iterator[str]:
    if (every := ALL_OF.match(said.x)) is not None and said.y:
        yield f"are all{every['count'] or ''} {said.x[every.end() :]} on {said.y}"
    else:
        yield from _about("is {x} on {y}")(said)


_CLAUSE = re.compile(r"^(?:after|once|when) (?P<what>.+)$")
_ITS_SPOT = re.compile(
    r"\b(?:its|his|her|the) (?:spot|place|post|position|perch|starting (?:point|place))\b|\bstirs?\b"
)


def _leaves_its_spot(said: Said) -> Iterator[str]:
    if said.x and _ITS_SPOT.search(said.rest):
        yield f"when does {said.x} start to move"


def _long_reach(said: Said) -> Iterator[str]:
    if _AFTER_TURN.match(said.time):  # "after the turn, the walk to the bed takes how long?"
        yield f"how long does {said.x} move"
    elif said.x and said.y and (clause := _CLAUSE.match(plain_time(said.time) or "")) is not None:
        yield f"how long is it from when {clause['what']} to when {said.x} reaches {said.y}"
    elif not said.time.startswith(("after ", "once ")):
        yield from _about("how long does {x} take to reach {y}")(said)


_AFTER_TURN = re.compile(r"^(?:after|once|from) (?:the|its|his|her|it has) turn\w*$")
PLAIN: Mapping[str, Plain] = {
    "when_starts": _about("when does {x} start to move"),
    "when_stops": _about("when does {x} stop moving"),
    "when_opens": _about("when does {x} start to open"),
    "when_open": _when_open,
    "when_closes": _about("when does {x} start to close"),
    "when_shut": _about("when is {x} closed"),
    "when_falls": _about("when does {x} fall"),
    "when_lands": _either(_about("when does {x} reach {y}"), _about("when does {x} land")),
    "when_turns": _about("when does {x} turn"),
    "when_reaches": _about("when does {x} reach {y}"),
    "when_leaves": _either(_leaves_its_spot, _about("when does {x} leave {y}"), _about("when does {x} start to move")),
    "when_closest": _about("when is {x} closest to {y}"),
    "long_moves": _long,
    "long_opens": _about("how long does {x} take to open"),
    "long_closes": _about("how long does {x} take to close"),
    "long_open": _long_open,
    "long_still": _long_still,
    "long_on": _about("how long is {x} on {y}"),
    "long_falls": _about("how long does {x} fall"),
    "long_reach": _long_reach,
    "gap": gap,
    "film_long": lambda said: iter(("how long is the film",)),
    "far": _either(_in_total, _about("how far does {x} move", unit=True)),
    "far_opens": _either(_in_total, _about("how far does {x} open", unit=True)),
    "far_turns": _about("by how many degrees does {x} turn"),
    "fast": _either(_one_turn, _fast),
    "fast_most": _about("what is the maximum speed of {x}", unit=True),
    "turns": _either(_one_turn, _turns),
    "often": _often,
    "where_ends": _about("where does {x} stop"),
    "where_starts": _about("where does {x} start"),
    "where_at": _about("where is {x}"),
    "way": _about("which way does {x} move"),
    "turn_way": _either(_to_a_side, _about("which way does {x} turn")),
    "if_moves": _moves,
    "if_still": _if_still,
    "if_opens": _about("does {x} open"),
    "if_closes": _about("does {x} close"),
    "if_open": _if_open,
    "if_shut": _either(_those_shut, _about("is {x} closed")),
    "if_falls": _about("does {x} fall"),
    "if_reaches": _about("does {x} touch {y}"),
    "if_on": _if_on,
    "if_crosses": _over,
    "if_returns": _about("does {x} come back"),
    "if_to_end": _about("does {x} move until the end"),
    "if_stops": _about("does {x} stop"),
    "if_turns": _if_turns,
    "if_before": lambda said: _compared(said, "before"),
    "if_after": lambda said: _compared(said, "after"),
    "if_together": lambda said: _compared(said, "at the same time as"),
    "what_moves": _offered(
        "moves", lambda said: iter((f"which {several(said.x)} move" if is_kind(said.x) else "what moves",))
    ),
    "what_still": _offered(
        "does not move",
        lambda said: iter((f"which {several(said.x)} do not move" if is_kind(said.x) else "what does not move",)),
    ),
    "what_open": _offered("is open", _of_those("are open", "are open")),
    "what_shut": _offered("is closed", _of_those("are closed", "stay closed")),
    "what_on": _what_on,
    "what_fell": _offered("has fallen", _of_those("have fallen", "fall")),
    "what_up": _offered("has not fallen", _of_those("have not fallen", "do not fall")),
    "visits": _visits,
    "apart": _about("how far does {x} move as the crow flies", unit=True),
    "far_falls": _about("how far does {x} fall", unit=True),
    "how_many": _counted,
    "first": lambda said: _ordered(said, "first"),
    "last": lambda said: _ordered(said, "last"),
    "order": _in_order,
    "fastest": _which,
    "happens": lambda said: iter(("what happens",)),
    "does": _about("what does {x} do"),
    "near": _either(_at_place, _about("what is {x} next to")),
    "on_way": _about("what does {x} touch"),
}
