"""Reads a question about a scene with time: what is asked, of which happening, and of what time.

A question has a cue that says what is asked ("how long", at its start or its end), a time, a rank ("first"), a unit,
and a happening. Each is taken out in turn; what is left must be read as a happening to the last word.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Literal

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ..noun_phrase import is_color_word
from .deeds import STATES, Deed, Kind, Phase, as_noun
from .happenings import PARTICLES, Happening, by_noun, happenings, thing
from .moments import CLIP_EDGE, When, clauses, is_main, time_first, without_time
from .notation import pattern
from .plainly import plainly

Asks = Literal[
    "when", "how_long", "between", "how_fast", "how_far", "how_often", "how_many", "where", "which_way", "order",
    "does", "which", "yesno", "faster", "either",
]  # fmt: skip


@dataclass(frozen=True)
class Frame:
    """A question about a scene with time.

    Attributes:
        asks: what is asked.
        what: of which happening.
        other: of "between", "before" and comparisons the second happening.
        when: of which time, None if nothing is said.
        rank: "first", "last", "second", ..., "again", "fastest", "slowest", "farthest", "longest"; "" if none is said.
        unit: in which unit, as said; "" if none is.
        measure: "average", "top" or "angular" of a speed; of a distance "nearest"; of a time "end"; "" if not said.
        options: answers to choose from: ("left", "right").
        than: of a comparison of one thing at two times the second time.
    """

    asks: Asks
    what: Happening
    other: Happening | None = None
    when: When | None = None
    rank: str = ""
    unit: str = ""
    measure: str = ""
    options: tuple[str, ...] = ()
    than: When | None = None


# -- what is asked ---------------------------------------------------------------------------------------------------

_POINT = "([exact|precise|very|first|earliest] (time|second|seconds|moment|point|timestamp|timecode|instant|sec|\
frame|stage) [in time|of time|mark|exactly|on])"
_SPAN = "(duration|interval|time gap|delay|time span|timespan|period [of time]|length of time|amount of \
time|stretch of time)"
_TOLD = "[~be|tell|give|name|state] [me]"
_TAKES = "[(do|does|did|will|would|has|is|was) (it|that|this) [all] (~take|~need|~last|~require|be) [time|for]]"
_ROUNDS = "([full|complete|whole|total|single] (turn|turns|rotation|rotations|revolution|revolutions|spins|rounds|\
circles|laps|loops|cycles|revs|times|twists) [in all|in total|altogether|overall])"
_MEASURES = (
    "avg|average|mean|top|maximum|maximal|max|peak|highest|greatest|angular|rotational|rotation|turning|spinning|\
spin|walking|rolling|sliding|falling|opening|linear|overall|typical|ground|travel|moving|movement|current|usual"
)
_SPEED = f"[{_MEASURES}] [{_MEASURES}] (speed|speeds|velocity|velocities|pace|tempo|rate of (rotation|turn)|rate|rpm)"
_THINGS = "[thing|things|object|objects|item|items|stuff|one|ones|else|all]"
_CUES = f"""
when end: (until|till|up to|up until) (when|(what|which) {_POINT})
when: when [exactly] | (since|by) when | [by|at|on|in|after|around|about|from|since|through] (what|which) {_POINT} [is \
    it] [that|when]
when: how (soon|early|late) | how (long|many seconds|much time|many secs) [into it|in] {_TAKES} [is it|will it \
    be|passes|pass|elapses|goes by|go by|[do|must|does|will|should] (i|you|we|one) [have to|need to|must] wait|to \
    wait] (until|till|before) | (after|by) how (many seconds|long|much time|many secs) [in|into it]
when: how many (seconds|secs) (in|into it|after the start|from the start) | [what] {_TOLD} the {_POINT} (when|at \
    which|that|of|where|in which|for|on which)
how_fast: [and] how (fast|quick|quickly|rapidly|slow|slowly|speedy|swiftly) | [at|with|by] (what|which|how much) \
    {_SPEED} [does|is|has]
how_fast: [what] {_TOLD} [the|its] {_SPEED} [of|for]
how_long: [for|over|within|in|during] how (long|much time|many (seconds|secs|sec|s)) {_TAKES} [of|for]
how_long: [what] {_TOLD} [the] {_SPAN} [of|for|that] | [in|for|over|during|within] (what|which) ({_SPAN}|time) \
    {_TAKES}
how_often: how (often|many times|frequently) | (how many|[what ~be] the [total] number of|what number of|[the] \
    total) {_ROUNDS} [of]
which_way: [in|to|into|toward|towards|on|from] (which|what) (way|direction|directions|side) | [what] {_TOLD} the \
    direction (of|in which)
how_far nearest: how (close|near) (does|do|did|will)
how_far: [by|to|through|about|over|from] how (far [out|down|up|in|along|across|away]|much \
    [distance|way|farther]|long a (way|path|distance)|large a distance|wide|high [up]|deep|low) | [by|through] \
    (what|which) [total] (distance|height|path|travel distance|path length|length of path) [that]
how_far: [what] {_TOLD} [the] [total|overall|whole] (distance|path length|length of the (path|way|route)|travel) \
    [of|that|which]
how_far degrees: [by|through] (what|which) [the] angle [of|that] | [what] {_TOLD} [the] [opening|turn|turning] \
    angle [of|that]
how_many: how many [different|of] | count | [what ~be] [the] number of | what number of
where: [and] [to|from] (where|whereabouts|where exactly|where to) | (at|in|on|to) (what|which) \
    (place|spot|location|position)
order: [give|tell|list|name|say] [me] [in] (the|what|which) [is the] (order|sequence) [of|in which|that|do|does]
order: [tell|list|describe|explain] [me] what [all] (happens|happened|is happening|goes on|is going on|takes \
    place|will happen|events are there|occurs) [here|there|in here] [in] [what|which|the] [order|sequence]
order: (list|name|give|tell|show) [me] [all] [the] (events|movements|motions|happenings) [here] [in order]
order: (order|sequence) of
faster faster: [and] (which|what|who) [one|thing] [is|goes|moves|turns|travels] [the] (faster|quicker) [one]
faster slower: [and] (which|what|who) [one|thing] [is|goes|moves|turns|travels] [the] slower [one]
which: [name|list|show|tell] [me] (which|what|who|everything|all|the things|the thing|the objects|the \
    object|things|something) [one|ones|thing|things|object|objects|item|items|stuff|else|all] [of (these|them|the \
    things|the objects|all|the three|the two)] [is it] [here] [that|which|who]
which: (name|list|show|tell) [me]
"""
_DOES = re.compile(
    r"^what (?:does|do|did|will) (?P<a>.+?) do(?:es)?$|^what (?:is|are|was) (?P<b>.+?) (?:doing|up to)$|"
    r"^what (?:happens|happened|is happening) (?:to|with) (?P<c>.+)$|^what (?P<d>(?:the|a) .+?) (?:do|does|is doing)$|"
    r"^(?:describe|explain) (?:the )?(?:motion|movement|path|way|route) of (?P<e>.+)$|^how (?:does|do) (?P<f>.+?) move$"
)
_TIMES_ONLY = re.compile(
    r"^what (?:is|was) the (?P<r>first|last|second|third)(?: thing| event)?(?: that happens| to happen| that takes "
    r"place)?$"
)
_FIRST_OF = re.compile(
    r"^(?:what|which)(?: one| event)? (?:comes|happens|is|occurs) (?:first|earlier)(?: ,| :)? (?P<a>.+?)(?: ,)? or "
    r"(?P<b>.+)$"
)
_VISITS = re.compile(
    r"^in (?:what|which) (?:order|sequence) (?:does|do|did|will) (?P<x>.+?) "
    r"(?:pass|reach|visit|meet|come by|come to|touch|cross|get to|go past|go by|go over) (?P<y>.+)$"
)
_RANKED_THING = re.compile(r"^(?:(?:name|list|show|tell)(?: me)? )?(?P<x>(?:the )?(?:first|last|fastest|slowest) .+)$")
_AT_TWO_TIMES = re.compile(
    r"^(?:is|does|was|did) (?P<x>.+?) (?P<r>faster|quicker|slower) (?P<a>(?:at|in|on|before|after|during|when|"
    r"while) .+?) "
    r"than (?P<b>(?:at|in|on|before|after|during|when|while) .+)$"
)
_OF_TWO = re.compile(
    r"^(?:which|what|who)(?: one| of them| of the two)? (?P<v>.+?) (?P<r>first|earlier|sooner|later|last)(?: ,| :)? "
    r"(?P<a>.+?)(?: ,)? or (?P<b>.+)$"
)
_ASKING = re.compile(
    r"(?:and )?(?:how|what|which|when|where|who|why|in what|in which|at what|at which|by what|by how|list|name|count|"
    r"tell|give|show)\b"
)
_COMPARED = ("fall", "turn", "open", "close", "rise")
_ASKED_LAST = re.compile(r" , (?:which|what|when|where|who|how)(?: one| thing)?$")
# From the start of one to the start of the next, of what takes hardly any time.
_LAGS = ("gap", "delay", "interval", "lag", "lapse")
_BEGINS_WITH_TIME = re.compile(
    r"(?:(?:right|just|shortly|directly|immediately) )?(?:after|before|when|while|as|once|until)\b"
)
_TWO_QUESTIONS = re.compile(r"\b(?:and|,) (?:when|how|where|what|which|why|does|is|are|do)\b")


@cache
def _cues() -> tuple[tuple[Asks, str, str], ...]:
    rows = []
    for line in _CUES.replace("\\\n    ", "").replace("\\\n", "").strip().splitlines():
        key, _, notation = line.partition(":")
        asks, _, more = key.partition(" ")
        rows.append((asks, more, pattern(notation)))
    return tuple(rows)  # type: ignore[arg-type]


@cache
def _first() -> tuple[tuple[Asks, str, re.Pattern[str]], ...]:
    return tuple((asks, more, re.compile(rf"(?:and |so )?(?:{row})")) for asks, more, row in _cues())


@cache
def _last() -> tuple[tuple[Asks, str, re.Pattern[str]], ...]:
    asked_last = ("when", "how_long", "how_fast", "how_far", "how_often", "where", "which_way")
    return tuple((a, more, re.compile(rf"(?<= )(?:{row})$")) for a, more, row in _cues() if a in asked_last)


def _cued(said: str) -> Iterator[tuple[Frame, str]]:
    """What a question asks, and its words without the cue; cues at the start first, the longest first."""
    text, found = f"{said} ", []
    for asks, more, row in _first():
        if (m := row.match(text)) is not None:
            found.append((-m.end(), asks, more, m.group(), text[m.end() :].strip(" ,")))
    if not found and not _ASKING.match(said):
        for asks, more, row in _last():
            if (m := row.search(text)) is not None:
                found.append((m.start() - m.end(), asks, more, m.group(), text[: m.start()].strip(" ,")))
    for _, asks, more, cue, rest in sorted(found, key=lambda f: f[0]):
        start = Frame(asks, Happening(None))
        if asks == "how_fast":
            start = replace(start, measure=_measure(cue), unit="rpm" if "rpm" in cue.split() else "")
        elif asks == "faster":
            start = replace(start, rank=more)
        else:
            start = replace(start, measure=more if more != "degrees" else "", unit=more if more == "degrees" else "")
        yield start, rest


def _measure(said: str) -> str:
    words = set(said.split())
    if words & {"top", "maximum", "maximal", "max", "peak", "highest", "greatest"}:
        return "top"
    if words & {"angular", "rotational", "rotation", "turning", "spinning", "spin", "turn"}:
        return "angular"
    return "average" if words & {"avg", "average", "mean", "overall", "typical"} else ""


# -- units -----------------------------------------------------------------------------------------------------------

_EACH = r"(?:per|a|an|/|every|each|in one|in a)"
_SECOND = r"(?:second|sec|s|minute|min|hour|h)"
_LENGTH = r"(?:meters?|m|centimeters?|cm|millimeters?|mm|feet|foot|ft|inch|inches|yards?|kilometers?|km|miles?)"
_ANGLE = r"(?:degrees?|deg|degs|radians?|rad)"
_COUNTED = rf"(?:{_LENGTH}|{_ANGLE}|turns?|rotations?|revolutions?|revs?|rounds?|spins?|cycles?|rot)"
_RATE = rf"(?:{_COUNTED} {_EACH} {_SECOND}|mps|kmh|kph|mph|rpm|rps|r p m|hz|hertz)"
_IN_UNIT = re.compile(
    rf"(?: ,)? (?:(?:measured |expressed |given )?in )?(?P<u>{_RATE})$|(?: ,)? (?:measured |expressed |given )?in "
    rf"(?P<v>{_RATE}|{_LENGTH}|(?:milli)?seconds?|secs?|minutes?|{_ANGLE})(?= |$)|"
    rf" , (?P<w>{_LENGTH}|{_ANGLE}|seconds|secs)$"
)
UNIT = rf"(?:{_RATE}|{_LENGTH}|(?:milli)?seconds?|secs?|minutes?|{_ANGLE})"
_SAYS_IN = re.compile(rf" (?:in|,) (?:{_RATE}|{_LENGTH}|(?:milli)?seconds?|secs?|minutes?|{_ANGLE})$")
_COUNT = r"(?:and )?(?:(?:by|through|for|with|at) )?(?:how many|what number of|(?:what is )?the number of)"
_SPREAD = re.compile(
    rf"^(?:{_COUNT} (?P<n>{_COUNTED})|how (?:often|many times)) (?P<rest>.+) (?P<per>{_EACH} {_SECOND})$"
)
_HOW_MANY = re.compile(rf"^{_COUNT} (?:(?P<rate>{_RATE})|(?P<far>{_LENGTH}|{_ANGLE}))(?: of)?(?= |$)(?P<rest>.*)$")
_HOW_MANY_EVENTS = re.compile(rf"^{_COUNT} (?P<n>\w+) (?P<rest>(?:does|do|did|are|is|has|have) .+)$")
_QUANTITIES: dict[str, tuple[Asks, Kind]] = {
    "time": ("when", "move"), "moment": ("when", "move"), "timestamp": ("when", "move"),
    "duration": ("how_long", "move"), "distance": ("how_far", "move"), "way": ("how_far", "move"),
    "path length": ("how_far", "move"), "travel": ("how_far", "move"), "extension": ("how_far", "open"),
    "displacement": ("how_far", "move"), "angle": ("how_far", "open"), "height": ("how_far", "fall"),
    "drop": ("how_far", "fall"),
}  # fmt: skip
_QUESTION_WORD = re.compile(r"\b(?:when|what|which|how|where|who|why)\b")
_NOMINAL = re.compile(rf"^(?:the )?(?P<x>.*?) ?\b(?P<q>{'|'.join(_QUANTITIES)})(?: (?:of|for) (?P<y>.+))?$")
_EDGE_OF = re.compile(r"(?P<start>start(?:ing)?|begin(?:ning)?|onset)|end(?:ing)?|stop(?:ping)?|finish(?:ing)?")
_MOST = re.compile(r"\b(?:total|overall|max|maximum|full|whole|greatest|travel|net|dwell|contact|final|'s)(?= |$)")
_RATE_FIRST = re.compile(rf"^(?P<u>{_RATE}) (?:of|for)? ?(?P<rest>.+)$")
_SPEED_LAST = re.compile(rf"^(?P<rest>.+?)(?: 's)? (?:(?:its )?(?P<kind>{pattern(_SPEED)})|(?P<unit>{_RATE}) )$")


def _in_unit(said: str) -> tuple[str, str]:
    """The words without the unit that an answer is wanted in, and that unit."""
    found = _IN_UNIT.search(said)
    if found is None or found.start() == 0:
        return said, ""
    rest = f"{said[: found.start()]} {said[found.end() :]}"
    return re.sub(r" +", " ", rest).strip(" ,"), found["u"] or found["v"] or found["w"] or ""


def _measured(said: str) -> Iterator[tuple[Frame, str]]:
    """Questions that name what is measured by its unit: "how many cm", "fan rpm", "the ball 's average speed"."""
    if (found := _SPREAD.match(said)) is not None:
        yield Frame("how_fast", Happening(None), unit=f"{found['n'] or 'turns'} {found['per']}"), found["rest"]
        return
    if (found := _HOW_MANY.match(said)) is not None:
        asks: Asks = "how_fast" if found["rate"] else "how_far"
        yield Frame(asks, Happening(None), unit=found["rate"] or found["far"]), found["rest"].strip(" ,")
    if (found := _RATE_FIRST.match(said)) is not None:
        yield Frame("how_fast", Happening(None), unit=found["u"]), found["rest"]


def _named(said: str, unit: str) -> Iterator[Frame]:
    """A quantity of a happening by its name: "ball stop time", "maximum opening angle of the door"."""
    for when, rest in _timed(said):
        for what in by_noun(rest):  # "onset of motion of the ball?"
            if what.deed is not None and what.deed.at_once and what.subject is not None:
                yield Frame("when", what, when=when, unit=unit)
        if (found := _HOW_MANY_EVENTS.match(rest)) is not None and (deed := as_noun(singular(found["n"]))) is not None:
            for what in happenings(found["rest"]):
                if what.deed is None:
                    yield Frame("how_often", replace(what, deed=deed), when=when)
        if (found := _NOMINAL.match(rest)) is None or _ASKING.match(said) or is_main(rest):
            continue
        if found["q"] == "time" and found["y"] is None and re.search(r"\bthe (?:whole|entire|full)$", found["x"]):
            continue  # "it stays there the whole time"
        if _QUESTION_WORD.search(found["x"]) or found["x"].endswith(" all the"):
            continue
        asks, kind = _QUANTITIES[found["q"]]
        x, y = _MOST.sub("", found["x"]).strip(), found["y"]
        edge: Phase = ""
        if found["q"] == "time" and y and (of := _EDGE_OF.fullmatch(x)) is not None:  # "start time of its going back"
            x, edge = "", "start" if of["start"] else "stop"
        for what in happenings(f"{x} of {y}" if x and y else y or x):
            if what.subject is None or (what.deed is None and asks != "how_far"):
                continue
            deed = what.deed or Deed(kind)
            deed = replace(deed, phase=edge) if edge and not deed.at_once else deed
            told = "how_long" if asks == "when" and not deed.at_once else asks
            own = unit or ("degrees" if found["q"] == "angle" else "")
            last = When("end") if found["x"].startswith("final") else when
            yield Frame(told, replace(what, deed=deed), when=last, unit=own)


def _speed_last(said: str, unit: str) -> Iterator[Frame]:
    for when, rest in _timed(said):
        bare = re.sub(r"^(?:and )?(?:what is|what was|tell me|give me|give) ", "", rest)
        last = _SPEED_LAST.match(f"{bare} ")
        if last is not None and not _ASKING.match(bare):
            for what in happenings(last["rest"]):
                said_so = last["kind"] or ""
                own = (last["unit"] or unit or ("rpm" if "rpm" in said_so else "")).strip()
                if what.deed is None and what.subject is not None:
                    yield Frame("how_fast", what, when=when, unit=own, measure=_measure(said_so))


# -- the whole question ----------------------------------------------------------------------------------------------

_DONE = re.compile(r"(?:has|have|had) ")
_PLAIN_SIDES = tuple(
    re.compile(p)
    for p in (r"^(?:when|the (?:moment|time|point)) (?:when |that |at which )?(?=\w)", r" (?:does|do|did|is|has)$")
)
_RANK = re.compile(
    r"\b(?:(?:is|are|was|were|be|comes|goes|being) )?(?:as |for )?(?:the )?(?:very )?(?P<r>first|last|second|"
    r"third|fourth|"
    r"fastest|quickest|slowest|farthest|furthest|longest|shortest|least|earliest|latest|soonest|most)(?: (?:one|thing|"
    r"object|item|of all|of them|time|distance|way|book|of the three))?(?P<to>(?: (?:to|that|who|which|in))?)(?= |$)"
)
_RANKS = {
    "quickest": "fastest", "furthest": "farthest", "earliest": "first", "soonest": "first", "latest": "last",
    "most": "farthest", "least": "nearest", "shortest": "nearest", "longest": "farthest",
}  # fmt: skip
_WAYS = (
    "left|right|up|down|forwards?|backwards?|in|out|inwards?|outwards?|clockwise|counter ?clockwise|anti ?clockwise|\
towards? (?:me|us|the viewer)|away from (?:me|us|the viewer)|sideways|straight|away"
)
_OPTIONS = re.compile(
    rf"(?: ,| :)? ?(?:is it )?(?:to the |on the |to |its )?(?P<a>{_WAYS})(?:wards?)? or (?:to the "
    rf")?(?P<b>{_WAYS})(?:wards?)?$"
)
_CLOCK = re.compile(r" (?P<a>counter ?clockwise|anti ?clockwise|clockwise)$")
_STATE_WORDS = (
    r"(?:opening|closing|falling|sliding|waiting|fall|stay|move|stop|close|start|open|closed|shut|moving|still|"
    r"standing "
    r"still|at rest|running|on|off|in|out|stopped|turning|spinning|rolling|walking)"
)
_STATES_OR = re.compile(
    rf" (?P<a>{_STATE_WORDS}) or (?:is it |already |still |again |not )?(?P<b>{_STATE_WORDS}|not)(?= |$)"
)
_TOGETHER = re.compile(r" (?:at the same time|simultaneously|at once|together|in parallel)(?= |$)")
_SOME = re.compile(r"\b(?:any two|two|several|some|any) (?:of the )?(?=\w+s\b)")
_WHAT_ON = re.compile(r"^(?:is|was|are|were) (.+) on$")
_RANKED_AS = re.compile(r"\b(?:first|last|second|third|earliest|latest)(?: one| book| thing)?(?: to| that| who|$)")
_BEFORE_OR_AFTER = re.compile(r"^(.+) before or after (.+)$")
_SIDES_OF = tuple(  # of two happenings that a time lies between
    re.compile(said)
    for said in (
        r"^(?:\w+ ){0,4}?between (?P<a>.+) and (?P<b>.+)$",
        r"^(?:\w+ ){0,4}?from (?P<a>.+) (?:until|till) (?P<b>.+)$",
        r"^(?:\w+ ){0,4}?from (?P<a>.+) (?:to|until|till) (?P<b>.+)$",
        r"^(?:separates?|divides?|lies? between|are between) (?P<a>.+) (?:from|and) (?P<b>.+)$",
        r"^(?:passe?s? |is it |goes by |go by |elapses? )?after (?P<a>.+?) (?:does|do|did|will|is|until|till|"
        r"before) (?P<b>.+)$",
        r"^before (?P<a>.+?) (?:does|do|did|will|is) (?P<b>.+)$",
        r"^(?:later|earlier|after|before|sooner) (?:does |do |did |is |will )?(?P<a>.+) than (?P<b>.+)$",
    )
)  # fmt: skip
_GAP = re.compile(
    r"^(?:and )?(?:what is )?(?:the )?(?:time|seconds|secs|delay|gap|interval|pause|hold|lag|lapse|time lag|"
    r"time gap)(?: difference)?"
    r"(?: in seconds)? "
    r"(?=between |from )"
)
_SOON = re.compile(r"^how (?:soon|much later) (?:is it )?(?=after )")
_MUCH_LATER = re.compile(
    r"^how (?:much|many seconds|many secs|long) (?=(?:later|earlier|sooner|after|before) .+ than )"
)


@lru_cache(maxsize=4096)
def frames(words: tuple[str, ...]) -> tuple[Frame, ...]:
    """Every way of reading the words of a question as one about a scene with time, the likeliest first."""
    return tuple(dict.fromkeys(_frames(plain(words))))


def plain(words: tuple[str, ...]) -> str:
    """The words of a question in the order in which it is asked plainly: its time behind it, its unit last."""
    said = " ".join(words)
    rest, unit = _in_unit(said) if _SPREAD.match(said) is None and _SAYS_IN.search(said) else (said, "")
    rest = plainly(time_first(plainly(rest), _ASKING))
    return f"{rest} in {unit}" if unit else rest


def _frames(said: str) -> Iterator[Frame]:
    if _TWO_QUESTIONS.search(said):
        return
    rest, unit = _in_unit(said) if _SPREAD.match(said) is None else (said, "")
    if (found := _VISITS.match(rest)) is not None:
        stops = tuple(re.split(r"(?: ,)? and | , ", found["y"]))
        for what in happenings(found["x"]) if len(stops) > 1 else ():
            if what.deed is None and what.subject is not None:
                yield Frame("order", replace(what, deed=Deed("pass", verb="pass")), options=stops)
    yield from _between(rest, unit)
    yield from _named(rest, unit)
    yield from _speed_last(rest, unit)
    if unit:
        yield from _speed_last(said, "")
    for time, plain in _timed(rest):
        if (found := _DOES.match(plain)) is not None:
            for what in happenings(next(group for group in found.groups() if group)):
                yield Frame("does", what, when=time)
        if (found := _TIMES_ONLY.match(plain)) is not None:
            yield Frame("order", Happening(None), when=time, rank=found["r"])
    for start, inner in _measured(said):
        yield from _filled(start, inner)
    if _SPREAD.match(said) is not None:
        return
    for start, inner in _cued(re.sub(r" on average$", "", rest)):
        if start.asks == "order" and _BEGINS_WITH_TIME.match(inner):
            inner = f"happens {inner}"
        yield from _filled(replace(start, unit=unit or start.unit), inner)
    if (found := _FIRST_OF.match(rest)) is not None:
        for a, b in _pairs(found["a"], found["b"]):
            yield Frame("order", a, b)
    if (found := _AT_TWO_TIMES.match(said)) is not None:
        times = [without_time(found[n]) for n in ("a", "b")]
        first, second = (
            t if t is not None and not more else _clause_of(found[n]) for n, (t, more) in zip("ab", times, strict=True)
        )
        for what in happenings(found["x"]) if first is not None and second is not None else ():
            if what.subject is not None:
                yield Frame("faster", what, when=first, than=second, rank=found["r"])
    if (found := _OF_TWO.match(rest)) is not None:
        rank = "last" if found["r"] in ("later", "last") else "first"
        for a, b in _pairs(found["a"], f"{found['b']} {found['v']}"):
            yield Frame("faster", a, b, rank=rank)
    if (found := _RANKED_THING.match(rest)) is not None:
        yield from _filled(Frame("which", Happening(None)), found["x"])
    if not unit and not _ASKING.match(said) and not _ASKED_LAST.search(said):
        yield from _filled(Frame("yesno", Happening(None)), rest)


def _clause_of(said: str) -> When | None:
    found = next((when for when, rest in clauses(f"it {said}") if rest == "it"), None)
    return found if found is not None and found.clause else None


def _filled(start: Frame, said: str) -> Iterator[Frame]:
    """A frame with its time and its happenings, in each way that the words allow."""
    if start.asks == "yesno" and (found := _BEFORE_OR_AFTER.match(said)) is not None:
        for frame in _filled(start, f"{found[1]} before {found[2]}"):
            yield replace(frame, asks="either", options=("before", "after"))
        return
    for when, rest in _timed(said) if start.asks in ("which_way", "where", "does", "yesno") else ():
        if (found := _OPTIONS.search(rest)) is not None:
            asks: Asks = "which_way" if start.asks == "yesno" else start.asks
            chosen = replace(start, asks=asks, options=(found["a"], found["b"]), when=when)
            for what in happenings(rest[: found.start()].strip(" ,")):
                yield replace(chosen, what=what)
            return
    if start.asks == "yesno" and (found := _STATES_OR.search(said)):
        yield from _either(start, said, found)
        return
    read = False
    for when, rest in _timed(said):
        if when is None and read:
            return  # the words of the time belong to nothing else
        for frame in _told(replace(start, when=when), rest):
            read = True
            yield frame


def _either(start: Frame, said: str, found: re.Match[str]) -> Iterator[Frame]:
    """A choice between two states or deeds: "is the door open or closed at 2 s"."""
    a, b = found["a"], found["b"]
    before, after = said[: found.start()], said[found.end() :]
    second = list(_filled(start, f"{before} {b}{after}")) if b != "not" else []
    for frame in _filled(replace(start, options=(a, b)), f"{before} {a}{after}"):
        other = next((f.what for f in second if f.when == frame.when and f.what.deed is not None), None)
        yield replace(frame, asks="either", other=other)


def _timed(said: str) -> Iterator[tuple[When | None, str]]:
    """Each way of dividing words into a time and the rest; the last way leaves them whole."""
    for when, rest in clauses(said):
        if when.clause and rest:
            inner, bare = without_time(rest)
            yield (when, rest) if inner is None or inner.kind not in ("ever", "always") else (when, bare)
    time, rest = without_time(said)
    if time is not None:
        again, less = without_time(rest)
        if again is not None and "ever" in (again.kind, time.kind):
            yield (time if again.kind == "ever" else again), less
        yield time, rest
    yield None, said


def _told(start: Frame, said: str) -> Iterator[Frame]:
    if start.asks == "faster":
        for a, b in _pairs(*(said.split(" or ") if said.count(" or ") == 1 else ("", ""))):
            yield replace(start, what=a, other=b)
        return
    if start.asks == "yesno" and start.when is not None and start.when.conj in ("before", "after"):
        for what, other in _pairs(said, start.when.clause):
            if what.deed is not None and (what.deed.at_once or what.deed.kind in _COMPARED or what.deed == other.deed):
                yield replace(start, what=what, other=other, when=None, rank=start.when.conj)
    if start.asks == "yesno" and (found := _CLOCK.search(said)) is not None:
        for what in happenings(said[: found.start()]):
            if what.deed is not None and what.deed.kind == "turn":  # as seen from above
                way = "right" if found["a"] == "clockwise" else "left"
                yield replace(start, what=replace(what, deed=replace(what.deed, way=way)))
    if start.asks == "which" and (found := _WHAT_ON.match(said)) is not None and (named := thing(found[1])) is not None:
        yield replace(start, what=Happening(Deed("related", relation="on", verb="on"), named))
    if start.asks == "yesno" and (found := _TOGETHER.search(said)) is not None:
        rest = _SOME.sub("the ", f"{said[: found.start()]}{said[found.end() :]}")
        for what in happenings(rest):
            yield replace(start, what=what, rank="together")
        return
    lasts = start.asks == "how_long" and re.search(r"(?<!the) last$", said)
    several = start.asks == "which" and re.match(r"(?:two|three|four)\b", said)
    if (
        start.asks not in ("where", "which_way", "faster")
        and not lasts
        and not several
        and (ranked := _ranked(said)) is not None
    ):
        rank, plain = ranked
        if start.asks == "how_often":
            return  # "how many turns by the third second"
        for what in happenings(plain) if start.asks != "yesno" or _RANKED_AS.search(said) else ():
            if _belongs(what, start.asks, plain):
                yield replace(start, what=what, rank=rank)
    again = "again" if start.asks in ("when", "yesno") and "again" in said.split() else ""
    for what in happenings(said):
        telic = start.asks in ("how_many", "which", "yesno") and what.deed is not None and what.deed.kind in _TELIC
        if telic and what.deed is not None and not what.deed.phase and (by := _by_then(start.when, said)) is not None:
            yield replace(start, what=replace(what, deed=replace(what.deed, phase="stop")), when=by)
            continue  # "how many have fallen by 2 s"
        gone = start.asks in ("how_many", "which") and what.deed is not None and what.deed.kind in _AT_A_STROKE
        if gone and (by := _by_then(start.when, said)) is not None:
            yield replace(start, what=what, when=by)
            continue  # "which have come off the board at 2 s"
        if start.asks == "when" and _DONE.match(said) and what.deed is not None and not _is_whole(what.deed):
            what = replace(what, deed=replace(what.deed, phase="stop"))  # "when has it crossed the rug"
        if _belongs(what, start.asks, said):
            yield replace(start, what=what, rank=start.rank or again)


_TELIC = ("fall", "open", "close", "cross")
_AT_A_STROKE = ("leave", "land", "reach", "enter", "pass")
_HAS_DONE = re.compile(r"\b(?:has|have|had) ")


def _by_then(when: When | None, said: str) -> When | None:
    """The time up to which something has been done; None if nothing says that it has."""
    if _HAS_DONE.search(said) is None or when is None:
        return None
    if when.kind == "at":
        return When("span", 0.0, when.start, conj="by")
    if when.kind == "clause" and when.conj in ("when", "once", "as"):
        return replace(when, conj="by")
    return when if when.conj == "by" else None


def _is_whole(deed: Deed) -> bool:
    return deed.at_once or deed.kind in STATES


def _belongs(what: Happening, asks: Asks, said: str) -> bool:
    """Whether what is asked may be asked of a happening as it is read."""
    if what.denied and asks != "yesno" and (asks not in ("which", "how_many") or what.object is not None):
        return False
    if asks != "which" or what.deed is None or what.subject is None:
        return True
    if what.object is not None:  # "what does the ball roll over to the wall"
        return re.match(r"(?:does|do|did|will) ", said) is None
    return (
        not said.startswith(what.deed.verb) and what.deed.verb not in PARTICLES
    )  # "who opens the door", "what is it on"


def _ranked(said: str) -> tuple[str, str] | None:
    """A rank and the words without it: "which book is the first to fall"."""
    found = _RANK.search(said)
    if found is None:
        return None
    rest = f"{said[: found.start()]} {said[found.end() :]}"
    return _RANKS.get(found["r"], found["r"]), re.sub(r" +", " ", rest).strip(" ,")


# -- two happenings --------------------------------------------------------------------------------------------------


def _between(said: str, unit: str) -> Iterator[Frame]:
    """Times between two happenings: "how long after the green one does the blue one fall"."""
    start = Frame("between", Happening(None), unit=unit)
    rests = [(start, said[m.end() :]) for m in (_GAP.match(said), _MUCH_LATER.match(said)) if m is not None]
    rests += [(start, said[m.end() :]) for m in (_SOON.match(said),) if m is not None]
    rests += [(start, rest) for found, rest in _cued(said) if found.asks == "how_long"]
    gap = re.search(r"\b(?:pause|gap|delay|break|wait|rest|interval|hold|lag|lapse)\b.* (?:between|from) ", said)
    for frame, rest in rests:
        for row in _SIDES_OF:
            if (found := row.match(rest)) is not None:
                for a, b in _pairs(found["a"], found["b"]):
                    if a.deed is None or b.deed is None:
                        continue
                    lags = gap is not None and gap[0].startswith(_LAGS) and a.deed.kind == "fall"
                    if gap and not a.deed.at_once and not lags:  # from the end of the first to the start of the second
                        a = replace(a, deed=replace(a.deed, phase="stop"))
                    yield replace(frame, what=a, other=b)


def _pairs(first: str, second: str) -> Iterator[tuple[Happening, Happening]]:
    """Two happenings; either may leave out what both say: "the red and the blue drop"."""
    ordinals = re.match(r"^(?:the )?(first|second|third|fourth|last)$", first)
    for b in _side(re.sub(r"^that\b", _noun_of(first), second)):
        if ordinals is not None:
            yield replace(b, nth=ordinals[1]), b
            continue
        colored = re.match(r"^(?:the )?(\w+)$", first)
        named = thing(f"the {colored[1]} thing") if colored is not None and is_color_word(colored[1]) else None
        if named is not None and b.subject is not None and b.deed is not None:
            yield replace(b, subject=named.model_copy(update={"text": b.subject.text})), b
        for a in _side(first):
            if a.deed is None and a.subject is None:
                continue
            it = b.object is not None and b.object.last and a.object is not None  # "enters the rug" and "leaves it"
            other = a.object if it else b.object
            yield (
                replace(a, deed=a.deed or b.deed, subject=a.subject or b.subject),
                replace(b, deed=b.deed or a.deed, subject=b.subject or a.subject, object=other),
            )


def _noun_of(said: str) -> str:
    return re.sub(r" of .*$", "", said)


def _side(said: str) -> Iterator[Happening]:
    """One of two happenings, with its place among several."""
    for row in _PLAIN_SIDES:
        said = row.sub("", said)
    if (edge := CLIP_EDGE.fullmatch(said)) is not None:
        yield Happening(Deed("scene", "stop" if edge["end"] or edge["ends"] else "start", verb=said))
        return
    done = re.search(r"\b(?:has|have|had)\b", said)
    if (ranked := _ranked(said)) is not None and ranked[0] in ("first", "second", "third", "fourth", "last"):
        for what in happenings(re.sub(r" of$", "", ranked[1])):
            yield replace(what, nth=ranked[0])
    for what in happenings(said):
        if done and what.deed is not None and not what.deed.at_once:
            what = replace(what, deed=replace(what.deed, phase="stop"))  # "after it has opened"
        yield what
