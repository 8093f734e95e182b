"""What stands beside a verb: how far, how fast, how often, which way, where to, in what state.

`read` accounts for every word or returns nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.operation import Length
from ..vocabulary import quantities
from .moments import DURATION, seconds_of
from .verbs import has_form

Thing = Callable[[str], Query | None]  # what a phrase for things means, None if it means none
State = Literal["", "still", "open", "closed", "moving", "gone", "shown", "off", "on"]

MOTION = ("open", "close", "spin", "go", "move", "rise", "sink", "fall", "bob")  # senses of what moves


@dataclass(frozen=True)
class Manner:
    """What is said beside a verb.

    Attributes:
        times: "twice", "three times", "2x", "double"; `percent`: .2 of "20 %"; `share`: of the way.
        compare: "fast" and "slow" ("twice as fast"), "faster" and "slower", or "speed" ("half its speed").
        degree: how much faster: "little", "much" or "".
        later: seconds; negative is earlier.
        rate: turns a second; `turns`: how many in all, with `endless` "round and round".
        degrees, length: how far; `way`: "up", "down", "left", ...
        backwards: in time or space; `other_way`: against its sense; `back`: to where it was.
        state: in which it is to be.
        goal: "toward the bed", as the plain grammar reads it; `at`: the preposition, and `whom` what it is.
        origin: where from.
        doing: the sense of "to swing", "rolling"; `refrains`: "from rolling".
        lasting: seconds that are named without a word for what they are ("delay it by 2 s").
        last: after all others.
        forth: there and back; `looping`: again and again.
        instead: to its other side ("right instead of left").
        clockwise: "clockwise" or "counter-clockwise".
        far: whether a share is of its way ("half as far"), `halfway` where it is told as a place.
        by: whether an amount is a difference ("by a third") or what it comes to ("to a third"), if that is said.
    """

    times: float | None = None
    percent: float | None = None
    share: float | None = None
    compare: str = ""
    degree: str = ""
    later: float | None = None
    rate: float | None = None
    turns: float | None = None
    endless: bool = False
    degrees: float | None = None
    length: Length | None = None
    way: str = ""
    backwards: bool = False
    other_way: bool = False
    back: bool = False
    state: State = ""
    goal: str = ""
    at: str = ""
    whom: Query | None = None
    origin: str = ""
    doing: str = ""
    refrains: bool = False
    lasting: float | None = None
    last: bool = False
    by: Literal["", "by", "to"] = ""
    forth: bool = False
    looping: bool = False
    instead: bool = False
    clockwise: str = ""
    far: bool = False
    halfway: bool = False

    @property
    def fields(self) -> frozenset[str]:
        """The names of what is said."""
        return frozenset(k for k, v in vars(self).items() if k not in ("by", "halfway") and v not in (None, "", False))

    def only(self, *names: str) -> bool:
        """Whether nothing else is said."""
        return self.fields <= set(names)


_AS_FAST = (
    (r"(?:as|so) (?:fast|quick|quickly|rapidly)(?: as (?:now|before|usual|it does))?", "fast"),
    (r"(?:as|so) slow(?:ly)?(?: as (?:now|before|usual|it does))?", "slow"),
    (r"(?:more )?(?:faster|quicker|quickly|rapidly|fast|quick)", "faster"),
    (r"(?:more )?(?:slower|slowly|slow|gently|sluggish(?:ly)?|leisurely|calmer|gentler)", "slower"),
    (r"(?:of )?(?:(?:the|its|their|his|her|a|original|normal|usual|present|current|old|real) )*(?:speed|pace|tempo|"
     r"rate|"
     r"velocity)", "speed"),
)  # fmt: skip
_DEGREES = (
    (r"(?:just |only )?(?:a (?:little|tiny|wee)? ?bit|a little|a touch|slightly|somewhat|a tad)", "little"),
    (r"(?:(?:a lot|much|way|far|crazy|super|really|very|even|too|insanely|considerably|a good deal|ridiculously) ?)+",
     "much"),
)  # fmt: skip
_WAYS = {
    "up": "up(?:wards?)?|higher(?: up)?|into the air|in the air|to the ceiling", "down": "down(?:wards?)?|lower(?: "
        "down)?",
    "to the left": "(?:to (?:the|its|my) )?left(?:wards?)?", "to the right": "(?:to (?:the|its|my) )?right(?:wards?)?",
    "forward": "forwards?|to the front|ahead",
}  # fmt: skip
_STATES: dict[State, str] = {
    "still": r"(?:completely |perfectly |absolutely |totally |dead |stock |quite )?(?:still|put|motionless|"
             r"stationary|frozen|at rest|in "
             r"(?:its )?place|unmoved|fixed|stopped|paused|immobile|where (?:it|he|she|they) (?:is|are|was|were|"
             r"stands?)|"
             r"as (?:it|they) (?:is|are|was|were)|at a standstill|dead|in its tracks|static|idle|parked|halted)",
    "open": r"(?:fully |completely |wide |all the way |right )*(?:open|opened|ajar|out)(?: all the way| fully| wide)?",
    "closed": r"(?:fully |completely |all the way |right |firmly )*(?:closed|shut|in|back in)",
    "gone": r"(?:gone|hidden|invisible|away(?! from)|out of (?:sight|view|shot|(?:the )?(?:room|scene|picture|way|"
            r"frame|view))|"
            r"absent|removed|not there|transparent|unseen|concealed)",
    "shown": r"(?:visible|there|seen|there to see|present|in (?:sight|view)|to be seen|shown)",
    "moving": r"in motion|on the move|going|active|under way|in action|running|at work",
    "off": "off", "on": "on",
}  # fmt: skip
_FIXED: tuple[tuple[str, dict[str, Any]], ...] = (
    (r"in slow ?motion|in slow? ?-? ?mo", {"times": 0.5, "compare": "speed"}),
    (r"(?:at )?double time", {"times": 2.0, "compare": "speed"}),
    (r"(?:the )?(?:other|opposite|wrong) way (?:round )?in time|backwards?(?: in time)?|in reverse(?: order)?|reversed|"
     r"rewound|back to front|from (?:the )?(?:end|finish) to (?:the )?(?:start|beginning)|from back to front",
     {"backwards": True}),
    (r"(?:in |into |to )?(?:the )?(?:other|opposite|reverse|wrong|contrary) (?:way|direction|sense)(?: round| around| "
     r"about)?|(?:the )?opposite|counter ?clockwise instead|anti ?clockwise instead|clockwise instead",
     {"other_way": True}),
    (r"back(?: again| home)*(?: (?:(?:to|from|towards?) )?(?:where|the (?:place|spot) where) (?:it|he|she|they) "
     r"(?:was|were|"
     r"came from|comes from|started|starts|start|stood|began|begins|set off)(?: before| first| from| at first)*| "
     r"(?:by )?"
     r"the (?:same )?way (?:it|he|she|they) came| to (?:the |its |his )?(?:start|beginning|origin|home|(?:starting|old|"
     r"original|first|initial) (?:point|position|place|spot)))?|the way (?:it|he|she|they) came|(?:to )?where (?:it|he|"
     r"she|they) came from", {"back": True}),
    (r"(?:back and forth|forwards? and back(?:wards?)?|to and fro|there and back(?: again)?|forth and back|in and "
     r"out|out and "
     r"in|up and down again)(?: (?:again and again|repeatedly|over and over(?: again)?))?", {"forth": True}),
    (r"(?:again and again|over and over(?: again)?|repeatedly|in a (?:continuous |endless )?loop|on (?:a )?(?:loop|"
     r"repeat)|"
     r"on loop|in loops?)", {"looping": True}),
    (r"to the opposite side", {"instead": True}),
    (r"half as far|half (?:of )?(?:the|its|that) (?:way|distance|length|path)", {"share": 0.5, "far": True}),
    (r"(?:at |by )?(?:halfway|half way|midway)(?: (?:through|along|of it|there|down|up|over|across))?(?: (?:its|"
     r"the) (?:way|path|"
     r"route))?", {"share": 0.5, "halfway": True}),
    (r"in half", {"share": 0.5}),
    (r"in half (?:of )?(?:the|its) time", {"times": 2.0, "compare": "speed"}),
    (r"in (?:twice|double) (?:the|its) time", {"times": 0.5, "compare": "speed"}),
    (r"halfway|half way|half|partway|part way|partly|half open|midway", {"share": 0.5}),
    (r"a crack|slightly ajar", {"share": 0.1}), (r"a little|a bit|slightly|a little bit", {"share": 0.25}),
    (r"ajar", {"share": 0.15, "state": "open"}),
    (r"(?:do |does |make |makes |for )?(?:a |one |the )?(?:full |complete |whole )?(?:circle|pirouette|360|"
     r"lap)s?", {"turns": 1.0}),
    (r"(?:a )?180", {"turns": 0.5}), (r"(?:a )?720", {"turns": 2.0}), (r"once", {"turns": 1.0}),
    (r"(?:on and on|round and round|around and around|continuously|constantly|endlessly|without (?:stopping|end|a "
     r"break)|"
     r"non ?stop|like crazy|in circles|wildly|crazily|freely|ceaselessly|perpetually|incessantly|all around|"
     r"without (?:ever )?(?:stopping|pause|end))", {"endless": True}),
    (r"last|as the last(?: one)?|after (?:all )?(?:of )?the others?|after everything else|at last", {"last": True}),
)  # fmt: skip
_IDLE = (
    r"there|from (?:rest|a standstill)|again|now|please|too|also|just|only|even|then|so|fully|wide|completely|all "
    r"the way|entirely|,|more|further|even "
    r"further|this time|already|abruptly|suddenly|itself|himself|herself|themselves|about itself|around itself|"
    r"round itself|on itself|"
    r"around "
    r"(?:him|her)self|on the spot|on its axis|about its (?:own )?axis|around its (?:own )?axis|in place|around|"
    r"round|at "
    r"(?:all|once)|together|at the same time|simultaneously|all together|any ?more|any longer|long|in total|altogether|"
    r"for good|as usual|as before|straight|directly|smoothly|it is|in one go|instead(?: of (?:the )?[\d.]+(?: "
    r"?(?:degrees?|"
    r"deg|°|cm|m|seconds?|s|rpm|%))?)?|than(?: now| before| usual| it does(?: now)?)?|of the (?:way|distance|"
    r"opening)|at that(?: point)?|in time|away"
)
_HEDGE = (
    r"(?:(?:by|to|at|with|of|about|like|around|roughly|exactly|say|only|just|a|the|full|good|whole|another|some|,|"
    r"doing|"
    r"for|through|it|an angle of|a factor of|a speed of|a rate of|its|up to) )*?"
)
_HEDGED = re.compile(_HEDGE)
_PER = re.compile(r"^(?:full |complete |whole )?(?:turns? |revs? |rotations? |revolutions? |rounds? |spins? |times )?"
                  r"(?:(?:per|a|each|every|in a|in one|an|in) |/ ?)(?:(?P<count>two|three|four|five|six|ten|"
                  r"\d+(?:\.\d+)?) )?(?P<unit>seconds?|secs?|s|minutes?|min|m)(?= |"
                  r"$)")  # fmt: skip
_ROUNDS = re.compile(
    r"^(?:full |complete |whole )?(?:turns?|hops?|jumps?|shakes?|bounces?|cycles?|revs?|rotations?|revolutions?|"
    r"rounds?|times?|spins?|laps?|circles?|twirls?|"
    r"loops?|pirouettes?)(?= |$)"
)
_PREPOSITIONS = (
    "around|round|all around|all round|along with|together with|with|after|toward|towards|in direction of|in the "
    "direction of|into the direction of|to|up to|over to|across to|down to|"
    "out to|back to|along to|"
    "onto|on to|on top of|on|into|in|inside|next to|beside|by|near|close to|behind|in front of|under|underneath|below|"
    "beneath|against|above|over|across|away from|at|in the middle of|in the center of|in the centre of|on the "
    "middle of|"
    "at the middle of|on the center of|before|as far as|off|from under|out from under"
)  # fmt: skip
_GOAL = re.compile(
    rf"^(?:(?:right|exactly|directly|straight|all the way|over|out|up|down|back|along|across|around|nearer|closer) )*?"
    rf"(?P<at>{'|'.join(sorted(_PREPOSITIONS.split('|'), key=len, reverse=True))}) (?=\S)"
)
_BETWEEN = re.compile(r"^between (?P<both>.+ and .+)$")
_FROM = re.compile(r"^(?:away |out |up |, )*from (?=\S)")
_OUT_OF_TOWARD = ("to", "up to", "over to", "across to", "out to", "back to", "along to", "down to", "as far as",
                  "in direction of", "in the direction of", "into the direction of", "towards")  # fmt: skip
_SIDE = re.compile(r"^the (?:left|right|front|back|side|middle|centre|center|other|corner|end)\b")


def _compiled(pattern: str) -> re.Pattern[str]:
    return re.compile(rf"^(?:{pattern})(?= |$)")


_TABLE = (
    *((_compiled(pattern), {"degree": degree}) for pattern, degree in _DEGREES),
    *((_compiled(pattern), fields) for pattern, fields in _FIXED),
    *((_compiled(pattern), {"state": state}) for state, pattern in _STATES.items()),
    *((_compiled(pattern), {"way": way}) for way, pattern in _WAYS.items()),
    *((_compiled(pattern), {"compare": compare}) for pattern, compare in _AS_FAST),
)
_SKIPPED = _compiled(_IDLE)
_RPM = re.compile(rf"^{_HEDGE}(?:(?P<a>[\d.,]+) ?rpm|rpm ?(?:of |to )?(?P<b>[\d.,]+))(?= |$)")
_TIMES_X = re.compile(rf"^{_HEDGE}(?:x|times|by) ?(?P<n>\d+(?:[.,]\d+)?)(?= |$)")
_LATER = re.compile(r"^(?:by )?(?P<by>.+?) (?P<way>later|earlier|sooner)(?= |$)")
_SPAN = re.compile(rf"^(?:by )?(?P<by>{DURATION})(?= |$)")
_MOST = 10_000  # as a length has it
_NAMED_TIMES = {"double": 2.0, "triple": 3.0, "treble": 3.0, "quadruple": 4.0}


def read(words: Sequence[str], thing: Thing) -> Iterator[Manner]:
    """Each way of reading words beside a verb, all of them."""
    yield from _read(" ".join(words), Manner(), thing, 0)


def _read(said: str, so_far: Manner, thing: Thing, depth: int) -> Iterator[Manner]:
    said = said.strip()
    if not said:
        yield so_far
        return
    if depth > 9:
        return
    for fields, rest in starts(said, thing):
        clash = any(
            getattr(so_far, k) not in (None, "", False) and k not in ("compare", "degree", "by") for k in fields
        )
        if not clash:
            yield from _read(rest, replace(so_far, **fields), thing, depth + 1)


def starts(said: str, thing: Thing) -> Iterator[tuple[dict[str, Any], str]]:
    """What the first words say, and the words behind them."""
    if found := _RPM.match(said):
        yield {"rate": float((found["a"] or found["b"]).replace(",", ".")) / 60}, said[found.end() :]
    if found := _TIMES_X.match(said):
        yield {"times": float(found["n"].replace(",", "."))}, said[found.end() :]
    if (found := _LATER.match(said)) and (value := seconds_of(found["by"].strip())) is not None:
        yield {"later": value if found["way"] == "later" else -value}, said[found.end() :]
    if (found := _SPAN.match(said)) and (value := seconds_of(found["by"])) is not None:
        yield {"lasting": value}, said[found.end() :]
    yield from _numbers(said)
    for pattern, fields in _TABLE:
        if found := pattern.match(said):
            yield fields, said[found.end() :]
    yield from _goals(said, thing)
    yield from _doings(said)
    if found := _SKIPPED.match(said):
        yield {}, said[found.end() :]


def _numbers(said: str) -> Iterator[tuple[dict[str, Any], str]]:
    """An amount: its kind is told by its unit, or by what stands behind it."""
    words = said.split(" ")
    for skip in range(min(6, len(words))):
        if skip and _HEDGED.fullmatch(" ".join(words[:skip]) + " ") is None:
            continue
        behind = words[skip:]
        if behind[0] in _NAMED_TIMES:
            yield {"times": _NAMED_TIMES[behind[0]]}, " ".join(behind[1:])
            return
        found = quantities.read(behind) or _digits_with_x(behind)
        if found is None or found.kind == "ORDINAL":
            if behind[0] == "once" and (per := _PER.match(" ".join(behind[1:]))):
                yield {"rate": 1 / _seconds(per)}, " ".join(behind[1:])[per.end() :]
            continue
        rest = " ".join(behind[found.taken :])
        if re.match(r"(?:more|further|less|wider|farther)\b", rest):
            return  # "5 cm more" is no place
        if per := _PER.match(rest):
            turns = found.value / 360 if found.kind == "ANGLE" else found.value
            if found.kind in ("ANGLE", "NUMBER", "TIMES", "FRACTION"):
                yield {"rate": turns / _seconds(per)}, rest[per.end() :]
        if found.kind in ("NUMBER", "FRACTION") and (rounds := _ROUNDS.match(rest)):
            yield {"turns": found.value}, rest[rounds.end() :]
        by = next(({"by": w} for w in ("by", "to") if w in words[:skip]), {})
        yield from (({**f, **by}, rest) for f in _kinds(found, behind[0]))
        return
    if (a := re.match(r"^(?:one|a|an|each|every) (?:full )?(?:turn|rotation|revolution|round|spin)(?= )", said)) and (
        per := _PER.match(said[a.end() :].strip())
    ):
        yield {"rate": 1 / _seconds(per)}, said[a.end() :].strip()[per.end() :]
    elif a := re.match(
        r"^(?:a|an|one|for a|by a) (?:full |whole |complete |single )?(?:turn|rotation|revolution|round|spin)(?= |$)",
        said,
    ):
        yield {"turns": 1.0}, said[a.end() :]


def _digits_with_x(words: Sequence[str]) -> quantities.Quantity | None:
    found = re.fullmatch(r"(\d+(?:\.\d+)?)x", words[0])
    return quantities.Quantity("TIMES", float(found[1]), "", 1) if found else None


def _seconds(per: re.Match[str]) -> float:
    count = quantities.NUMBERS.get(per["count"]) or float(per["count"]) if per["count"] else 1.0
    return (60.0 if per["unit"].startswith("m") else 1.0) * count


def _kinds(found: quantities.Quantity, first: str) -> Iterator[dict[str, Any]]:
    """The fields that an amount may be."""
    if not 0 < found.value <= _MOST:
        return
    if found.kind == "LENGTH":
        yield {"length": Length(value=found.value, unit=found.unit)}  # type: ignore[arg-type]
    elif found.kind == "ANGLE":
        yield {"degrees": found.value}
    elif found.kind == "PERCENT":
        yield {"percent": found.value}
    elif found.kind == "FRACTION":
        yield {"share": found.value}
    elif found.kind == "TIMES":
        yield {"times": found.value}


def _goals(said: str, thing: Thing) -> Iterator[tuple[dict[str, Any], str]]:
    """Where to, or where from."""
    if found := _BETWEEN.match(said):
        yield {"goal": said, "at": "between"}, ""
    for pattern in (_GOAL, _FROM):
        if (found := pattern.match(said)) is None:
            continue
        words = said[found.end() :].split(" ")
        for end in range(len(words), 0, -1):
            noun = " ".join(words[:end]).strip(" ,")
            if not noun or (whom := thing(noun)) is None:
                continue
            rest = " ".join(words[end:])
            if pattern is _FROM:
                yield {"origin": noun}, rest
            else:
                at = re.sub(r"^(?:in|on|at) the (?:middle|center|centre) of$", "on", found["at"])
                plain = "toward" if at in _OUT_OF_TOWARD and not _SIDE.match(noun) else at
                yield {"goal": f"{plain} {noun}", "at": at, "whom": whom}, rest


_DOING = re.compile(
    r"^(?:to |from |with |ever |even )*(?:its |the |his |their )?(?P<verb>[a-z]+)(?: (?:down|up|open|around|"
    r"round|off|over))?(?= |$)"
)
_EVENT_WORDS = ("movement", "motion", "path", "walk", "fall", "move", "work", "roll", "turn", "swing", "ride", "spin")


def _doings(said: str) -> Iterator[tuple[dict[str, Any], str]]:
    """Another verb: "(start) to roll", "(stop) turning", "from falling"."""
    found = _DOING.match(said)
    if found is None:
        return
    for sense in (*MOTION, "stop", "start"):
        plain = said.startswith("to ") or found["verb"] in _EVENT_WORDS
        if has_form(found["verb"], (sense,), "ing") or (plain and has_form(found["verb"], (sense,), "plain")):
            yield {"doing": sense, "refrains": said.startswith("from ")}, said[found.end() :]
            return
    if found["verb"] in _EVENT_WORDS:
        yield {"doing": "go"}, said[found.end() :]
