"""Verbs of motion and states that change, as data: "roll", "come to rest", "hit", "fall off", "half open", "at rest".

A row is said in a notation (`notation`). What begins, goes on and ends, and what is said with a noun ("make a turn"),
is put together from the rows, so that a new row is known in all of these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Literal

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from .notation import pattern, verb_forms

Kind = Literal[
    "move", "turn", "open", "close", "fall", "rise", "land", "reach", "enter", "leave", "cross", "pass", "approach",
    "recede", "return", "bob", "appear", "vanish", "still", "is_open", "is_closed", "is_back", "related", "slows",
    "speeds_up", "nearest", "farthest", "recolor", "scene",
]  # fmt: skip
Phase = Literal["", "start", "stop", "quarter", "half", "full"]
STATES = ("still", "is_open", "is_closed", "is_back", "related")
AT_ONCE = ("reach", "land", "enter", "leave", "pass", "nearest", "farthest", "vanish", "appear", "recolor")


@dataclass(frozen=True)
class Deed:
    """What something does, or the state that it is in.

    Attributes:
        kind: some are states; "related": a relation holds.
        phase: its "start" or "stop"; of a state that it holds by a "quarter", by "half" or in "full".
        relation: name of the relation, of "related".
        way: "out", "left", "up", ...: said with the verb; "" if none is.
        verb: as said.
    """

    kind: Kind
    phase: Phase = ""
    relation: str = ""
    way: str = ""
    verb: str = field(default="", compare=False)

    @property
    def starts(self) -> bool:
        """Whether its beginning is meant."""
        return self.phase == "start"

    @property
    def stops(self) -> bool:
        """Whether its end is meant."""
        return self.phase == "stop"

    @property
    def at_once(self) -> bool:
        """Whether it is a matter of a moment."""
        return self.phase != "" or self.kind in AT_ONCE


# kind, phase, way: how it is said. Of equally long matches the row above wins. "is": a state that nothing is put to.
_ROWS = """
related - -: touching | [~be|~come|~get] in [direct|physical] (contact|touch) with | up against
is_open quarter -: [STAY] ([a|one] quarter|25 %|25 percent) (open|opened|out|extended)
is_open half -: [STAY] (half|halfway|half way|partly|50 %|50 percent) (open|opened|out|extended|closed|shut) | [STAY] \
    (halfway|half way|midway) through ITS (opening|swing|travel)
is_open full -: [STAY] FULL (open|opened|out|extended|pulled out|ajar) | open FULL | at [its] (widest|maximum \
    opening|full opening|[full|maximum] extension) | ~reach [its] (widest|maximum opening|full (opening|extension))
is_open - -: (sticking|jutting|poking|hanging|standing|still|protruding|staying|left) \
    (out|open) | protruding | [STAY] (open|opened|ajar|pulled out|extended|drawn out|out)
is_closed - -: [STAY] [FULL] [back] (closed|shut|pushed in|in) [again]
return - -: (~return|~go|~come|~get|~move) [back] to ITS (original|old|initial|starting|former|first|usual) \
    (place|position|spot)
is_back - -: [STAY|~come|~go|~move] [FULL] back [in|at|to|into] [its|the] \
    [original|old|initial|starting|former|first|usual] (place|spot|position) | [STAY] back where it \
    (~be|~start|~begin) | (~go|~get|~come) back where it (~be|~start)
still - -: [STAY] [SO] (still|at rest|motionless|stationary|at a \
    standstill|immobile|unmoved|fixed|static|resting|stopped|waiting|idle|inactive|parked|put|switched off|turned \
    off|off|in [ITS|one] [same] (place|spot|position)|where (it|they) (~be)) | ~rest | ~wait | ~pause | ~idle | ~do \
    nothing | ~hold still | STAY (there|put|around)
open - out: ~open [up|out] | (GO|COME|TURN) [FULL] (out|outward|outwards|open|out of) | ~extend | ~pull out | pulled
open stop out: ~open [up] (fully|completely|all the way|entirely|totally|wide) | (fully|completely|entirely) ~open
open stop out: ~arrive [FULL] (out|open) | ~arrive at [its] (full|maximum) (extension|opening)
close start in: (~set off|~head|~start) [back] (in|inside|inward) | START [to|its|the] \
    (~go|~slide|~move|~come) back [in|inside]
close - in: (~close|~shut|~retract) [again|up] | (GO|COME|TURN|~push|~return|~slam|~bang) [FULL] [back] \
    (in|inward|inwards|inside|shut|closed) [again]
close stop in: (~close|~shut) (fully|completely|all the way|entirely|totally) | (fully|completely) (~close|~shut)
return - -: (GO|COME|TURN|~bounce|~spring|~push|~pull) [all the way|right] back [again|home] | ~return \
    [back|home] | ~go home
move stop -: (~come|~roll|~slow|~grind|~slide|~get) [down] to [a|an|its] [full|complete|final|dead] \
    (rest|stop|halt|standstill|end|stillness) | (~end|~wind|~finish) up | (~settle|~freeze) [down] | END | ~be \
    (done|finished|over|through) | ~reach ITS (final|last) (position|place|spot) | (~go|~switch|~turn|~shut|~power) \
    [itself] (off|down) | ~die down | ~conclude | ~arrive
move start -: START [up|out] | ~set (off|out|in motion) | ~take off | ~get (going|moving|rolling) | ~go off | ~kick \
    off | (~switch|~turn|~come|~go) on | ~launch | ~depart | ~wake up
fall - down: FALL
fall - down: FALL [down|over|off|downward|downwards] | (~come|~go|~tip|~crash) (down|over) | (GO) \
    (down|downward|downwards) | in [the|mid] air | airborne | in free fall | ~tip | knocked (over|down|off)
rise - up: UP [up|off|upward|upwards] | (GO|~come) (up|upward|upwards) | ~take off
land - -: ~land [on|onto|upon|down] | ~touch down | (~hit|~reach|~touch|~strike|~meet|~get to) [the] GROUND
bob - -: (~bob|~bounce|~wobble|~wiggle|~twitch|~tremble|~rattle|\
    ~shake|~jiggle|~sway|~vibrate|~rock) [up and down|about|around] | GO up and down
approach - -: ~approach | (GO|COME|~become|~draw) [any] (closer|nearer|near) [to|toward|towards] | GO \
    (toward|towards|in the direction of)
recede - -: (GO|COME|~become|~be) (farther|further|more distant) [away] [from|of] | (GO|COME) away from | ~increase \
    ITS distance (to|from)
nearest - -: [~be|~get|~come|~pass] [the] (closest|nearest) (to)
farthest - -: [~be|~get] [the] (farthest|furthest) [away] from
turn - -: TURN [around|round|about|over] | ~go (round|around) | ~make (turns|rotations|revolutions|a U turn)
turn - course: ~change [ITS] (direction|course|heading)
turn - left: ~turn [to] [the|its] left
turn - right: ~turn [to] [the|its] right
turn - -: ~turn [around] [the|a] corner
slows - -: ~slow [down|up] | (GO|TURN|~get) (slower and slower|slower|more and more slowly) | (~get|~become|~be) \
    slower | (~lose|~drop) speed | ~decelerate | ~brake
speeds_up - -: ~speed up | (GO|TURN|~get) (faster and faster) | ~accelerate | (~get|~become|~be) (faster|quicker) | \
    (~gain|~pick up) speed | ~pick up speed
leave - -: ~leave | ~exit | (GO|COME|TURN|~step) (off|off of) | ~depart from | (END) (being on|being in|touching) | \
    ~lose [ITS] [contact|touch] with | ~clear | off | ~quit
cross - -: ~cross | ~traverse | (GO|~pass) (across|over|through|along)
pass - -: ~pass [by|beside|near|next to|in front of|close to] | (GO|COME) [right|close] (past|by)
enter - -: ~enter | (GO|COME|TURN|~step) (onto|on to)
reach - -: ~reach | ~hit | ~touch | ~contact | ~meet | ~strike | BUMP [up] (into|against|with) | bumped | \
    ~knock over | ~arrive [at|on|in|by|near|next to|beside|with] | \
    (GO|COME) [all the way|back] [up|over] (to|into|against) | \
    (~make|made) it [all the way] [up|over] (to|into) | ~come into (contact|touch) with | (~make|~have) [first|its \
    first|the first] contact with | ~come up (to|against) | ~get as far as
vanish - -: ~disappear | ~vanish | ~go away
appear - -: ~appear | ~reappear | ~show up | ~become visible | ~come into view
recolor - -: ~change [ITS] (color|colors|look|looks|appearance) | TURN (another|a different) color
move - straight: GO [on|along|in] [a] (straight [ahead|line|on])
move - left: GO [from [the] right] [to [the|its]] left
move - right: GO [from [the] left] [to [the|its]] right
move - toward: (GO|COME) (toward|towards) (me|us|the (viewer|camera))
move - away: (GO|COME) away from (me|us|the (viewer|camera))
move - forward: GO (forward|forwards|ahead)
move - backward: GO (backward|backwards)
move - -: GO (from|out of|off) ITS (place|spot|position) | GO [around|about|along|away|on|there|anywhere|somewhere] | \
    animated | in action | in motion | on the move | ~come | under way | \
    active | ~cover | ~happen | ~occur | (~change|~shift) [ITS] (place|position|location) | ~leave ITS (place|spot)
move is -: on | running | working | going | switched on | turned on
"""
_NOUNS: dict[Kind, str] = {
    "move": "movement|motion|moving|roll|ride|walk|trip|journey|run|travel|path|way|slide|action|animation|rolling|"
    "sliding|walking|drive|route|course",
    "turn": "turn|turning|rotation|spin|spinning|swing|swinging|revolution|round|lap|circle|corner|curve|bend|"
    "change of direction",
    "open": "opening|[the] out stroke|outward stroke|opening stroke|outward movement|way out",
    "close": "closing|shutting|return stroke|back stroke|inward stroke|closing stroke|way back in|way in",
    "fall": "fall|drop|falling|tumble|plunge|descent|flight",
    "land": "landing|impact|touchdown", "reach": "contact|collision|hit|impact|arrival|touch|bump|crash",
    "return": "return|return trip|way back|trip back|journey back", "cross": "crossing",
    "still": "pause|rest|wait|break|"
    "stillness|standstill",
    "leave": "departure|leaving",
}  # fmt: skip
_PHASES: dict[Phase, str] = {
    "stop": "stop|halt|end|standstill|finish|stopping", "start": "start|beginning|launch|onset",
}  # fmt: skip
_ASPECTS: dict[Phase, str] = {
    "start": "START [to|in|on|with|by|its|the|out] [be|being]",
    "stop": "(END|[~be] (done|finished|through)|~complete) [to|its|the|with|being]",
    "": "(~keep|~continue|~go on|~carry on|STAY) [on|to|with|its] [be]",
}
_PROCESSES = ("move", "turn", "open", "close", "fall", "rise", "cross", "return", "approach", "recede", "bob")
_LIGHT = "DO (a|an|its|the|this|that|one|another|his|her|their|any) [full|complete|sharp|quick|90 degree|single]"
Row = tuple[re.Pattern[str], Deed]


@cache
def _rows() -> tuple[Row, ...]:
    """Every way of saying a deed: rows, nouns with a verb that says nothing, and beginnings and ends of processes."""
    said: dict[tuple[Kind, str], str] = {}
    rows = list[Row]()

    def add(way: str, deed: Deed) -> None:
        rows.append((re.compile(rf"(?<![^ ])(?:{way})"), deed))

    for line in _ROWS.replace("\\\n    ", "").strip().splitlines():
        key, _, notation = line.partition(":")
        kind, phase, way = (f.strip("-") for f in key.split())
        combines, phase = not phase, "" if phase == "is" else phase
        add(pattern(notation), Deed(kind, phase, "touches" if kind == "related" else "", way))  # type: ignore[arg-type]
        if kind in _PROCESSES and combines:
            whole = [said[kind, way]] if (kind, way) in said else []  # type: ignore[index]
            said[kind, way] = "|".join([*whole, pattern(notation)])  # type: ignore[index]
    for (kind, way), verbs in said.items():
        nouns = pattern(_NOUNS[kind]) if kind in _NOUNS and (not way or kind in ("open", "close")) else ""
        for phase, aspect in _ASPECTS.items():
            add(f"(?:{pattern(aspect)})(?:{verbs}{'|' + nouns if nouns else ''})", Deed(kind, phase, way=way))
    for kind, notation in _NOUNS.items():
        add(pattern(f"{_LIGHT} ({notation})"), Deed(kind))
        for way in ("left", "right") if kind == "turn" else ():
            add(pattern(f"{_LIGHT} {way} ({notation})|{_LIGHT} ({notation}) to [the|its] {way}"), Deed(kind, way=way))
    return tuple(rows)


def said_in(text: str) -> Iterator[tuple[int, int, Deed]]:
    """The deeds that a text may tell: start, stop and sense; the longest first, of equally long ones earlier rows."""
    found = [(m.start(), m.end() - 1, deed) for row, deed in _rows() for m in row.finditer(f"{text} ")]
    for start, stop, deed in dict.fromkeys(sorted(found, key=lambda f: (f[0] - f[1], f[0]))):
        yield start, stop, replace(deed, verb=text[start:stop])


@cache
def verbs() -> frozenset[str]:
    """Words that are forms of verbs of motion, which no thing is called by."""
    return frozenset(verb_forms(_ROWS)) - {"is", "are", "in", "on"}


@cache
def _nouns() -> tuple[Row, ...]:
    lead = (
        "[all|half a] [the|its|their|a|this|that|his|her] [first|whole|entire|complete|very|single|one|full|each|every]"
    )
    rows = [(f"{lead} ({said})", Deed(kind)) for kind, said in _NOUNS.items()]
    rows += [(f"{lead} ({said})", Deed("move", phase)) for phase, said in _PHASES.items()]
    for kind in ("move", "turn", "open", "close", "fall", "cross"):
        for phase, said in _PHASES.items():
            rows.append((f"{lead} ({said}) of {lead} ({_NOUNS[kind]})", Deed(kind, phase)))
    return tuple((re.compile(pattern(said)), deed) for said, deed in rows)


def as_noun(text: str) -> Deed | None:
    """The deed that a noun names: "the turn", "its fall", "the start of the fall"; None if it names none."""
    for row, deed in _nouns():
        if row.fullmatch(f"{text} ") or row.fullmatch(f"{singular(text)} "):
            return Deed(deed.kind, deed.phase, verb=text)
    return None
