"""Reads a question about a scene with time: what is asked, of which happening, and of what time.

People ask such questions in any order of words, so they are read by their parts: a cue ("how long"), a deed ("to
open"), the things before and behind it, the time. Every word belongs to one of them or says nothing; else
it is not read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from .....gaussians.language.query.query import Query
from .....gaussians.world import kinds
from ....grammar.tagging.words import bag
from .. import noun_phrase, relation_phrases
from ..noun_phrase import is_color_word
from .deeds import Deed, Kind, Phase, as_noun, said_in, verb_words
from .moments import When, clauses, without_time

Asks = Literal[
    "when", "how_long", "between", "how_fast", "how_far", "how_often", "how_many", "where", "which_way", "order",
    "does", "which", "yesno", "faster", "either",
]  # fmt: skip


@dataclass(frozen=True)
class Happening:
    """Something that something does.

    Attributes:
        deed: None where only a thing is named.
        subject: who does it, None if nobody is named.
        object: what it is done to or where; None if nothing is named.
        at: the preposition before the object, "" if there is none.
        nth: of several such happenings "first", "second", "third" or "last"; "" if not said.
    """

    deed: Deed | None
    subject: Query | None = None
    object: Query | None = None
    at: str = ""
    nth: str = ""


@dataclass(frozen=True)
class Frame:
    """A question about a scene with time.

    Attributes:
        asks: what is asked.
        what: of which happening.
        other: of "between", "before" and comparisons the second happening.
        when: of which time, None if nothing is said.
        rank: "first", "last", "second", ..., "fastest", "slowest", "farthest", "longest"; "" if none is said.
        unit: in which unit, as said; "" if none is.
        measure: "average", "top" or "angular" of a speed; of a distance "nearest"; "" if not said.
        options: answers to choose from: ("left", "right").
    """

    asks: Asks
    what: Happening
    other: Happening | None = None
    when: When | None = None
    rank: str = ""
    unit: str = ""
    measure: str = ""
    options: tuple[str, ...] = ()


_UNIT = (
    r"(?:m / s|meters? (?:per|a|/) (?:second|sec|s)|mps|km / h|kmh|kph|km per hour|kilometers? (?:per|an) hour|mph|"
    r"miles (?:per|an) hour|cm / s|(?:cm|centimeters?) (?:per|a|/) (?:second|sec|s)|"
    r"(?:deg|degs|degrees?) (?:per|a|/) (?:second|sec|s)|"
    r"(?:turns?|rotations?|revolutions?|revs?|rounds?|spins?|cycles?|rot) (?:per|a|/|every|each|in one|in a) "
    r"(?:second|sec|s|minute|"
    r"min)|rpm|rps|r p m|hz|hertz|(?:rad|radians?) (?:per|a|/) (?:second|sec|s))"
)
_LENGTH = r"(?:meters?|m|centimeters?|cm|millimeters?|mm|feet|foot|ft|inch|inches|yards?|kilometers?|km)"
_TIME_UNIT = r"(?:seconds?|secs?|s|milliseconds?|ms|minutes?)"
_ANGLE = r"(?:degrees?|deg|degs|radians?|rad)"
_UNIT_TAIL = re.compile(
    rf"(?: ,)? (?:(?:measured |expressed |given )?in )?(?P<u>{_UNIT})$|(?: ,)? (?:measured |expressed |given )?in "
    rf"(?P<v>{_UNIT}|"
    rf"{_LENGTH}|{_TIME_UNIT}|{_ANGLE})(?= |$)| , (?P<w>{_LENGTH}|{_ANGLE}|seconds|secs)$"
)
_KIND = (
    r"(?:(?:avg|average|mean|top|maximum|maximal|max|peak|highest|greatest|angular|rotational|rotation|turning|"
    r"spinning|spin|"
    r"walking|rolling|sliding|falling|opening|linear|overall|typical|ground|travel|moving|movement|current|usual) )*"
)
_SPEED = (
    rf"(?P<kind>{_KIND})(?:speeds?|velocity|velocities|pace|rotation rate|turn rate|turning rate|rate of "
    rf"rotation|rate of turn|tempo)"
)
_IT_TAKES = (
    r"(?: (?:do|does|did|will|would|has|is|was) (?:it|that|this)(?: all)? (?:takes?|needs?|lasts?|requires?|"
    r"taking|take time))?"
)
_CUES: tuple[tuple[Asks, re.Pattern[str]], ...] = tuple(
    (asks, re.compile(pattern))  # type: ignore[misc]
    for asks, pattern in (
        ("between", r"^(?:and )?(?:how (?:much time|long|many seconds|many secs)(?: \w+){0,3}?|what is the (?:time|"
                    r"delay|gap|interval|"
         r"pause)(?: difference)?|(?:the )?(?:time|delay|gap|interval|pause)(?: in seconds)?) between (?P<rest>.+)$"),
        ("between", r"^how (?:much|many seconds|long) (?P<later>later|earlier|after) (?P<rest>.+)$"),
        ("order", r"^(?:(?:give|tell|list|name|say)(?: me)? )?(?:in )?(?:the |(?:what|which) (?:is the )?)(?:order|"
                  r"sequence)"
         r"(?: (?:of|in which|that|do))?(?P<rest>.*)$"),
        ("order", r"^(?:tell me |list |describe |explain )?what (?:all )?(?:happens|happened|is happening|goes on|is "
                  r"going on|"
         r"takes place|will happen|events are there|occurs)(?! (?:to|with))(?: (?:here|there|in here|first and then "
         r"what))?"
         r"(?: ,)?(?: in (?:what |which |the )?(?:order|sequence))?(?P<rest>.*)$"),
        ("order", r"^(?:list|name|give|tell|show)(?: me)? (?:all )?(?:the )?(?:events|movements|motions|happenings)"
         r"(?: (?:here|in order))*(?P<rest>.*)$"),
        ("does", r"^what (?:does|do|did|will) (?P<rest>.+?) do(?:es)?$|^what (?:is|are|was) (?P<doing>.+?) (?:doing|"
                 r"up to)$|"
         r"^what (?:happens|happened|is happening) (?:to|with) (?P<to>.+)$|^what (?P<odd>(?:the|a) .+?) (?:do|does|is "
         r"doing)$|"
         r"^(?:describe|explain) (?:the )?(?:motion|movement|path|way|route) of (?P<of>.+)$|^how (?:does|do) "
         r"(?P<how>.+?) move$"),
        ("order", r"^(?:and )?what (?:is|was) (?P<rest>the (?:very )?(?:first|last|second|third))(?: thing| "
                  r"event)?(?: that happens| to happen| that takes "
         r"place)$"),
        ("how_often", r"^(?:and )?(?:how (?:often|many times|frequently)|(?:how many|(?:what is )?the (?:total "
                      r")?number of|what number of|(?:the )?total(?: number of)?) "
         r"(?:full |complete |whole |total |single )?(?:turns?|rotations?|revolutions?|spins?|rounds?|circles?|laps|"
         r"loops|cycles|"
         r"revs|times|twists))(?! (?:per|a|/|every|each|in one|in a) (?:second|sec|minute|min|s))"
         r"(?: of)?(?P<rest>.*)$"),
        ("when", r"^(?:and )?(?:so )?(?:(?:the )?exact(?:ly)? )?(?:when(?: exactly)?|(?:at|on|by|in|after|around|"
                 r"about|from|since|until)? ?"
         r"(?:what|which) (?:exact |precise )?(?:time|second|seconds|moment|point(?: in time| of time)?|timestamp|"
         r"instant|sec|frame|"
         r"stage)(?: mark| exactly)?(?: is it(?: when| that)?)?|how (?:soon|early|late)|how (?:long|many seconds|much "
         r"time|many "
         r"secs)(?: into it| in)?" + _IT_TAKES + r"(?: is it| will it be| passes| pass| elapses| goes by| go by| do i "
                                                 r"wait| must i wait|"
         r" do we wait)? (?:until|till|before)|after how (?:many seconds|long|much time|many secs)|how many seconds "
         r"(?:in|into it|into the \w+|after the start)|(?:what is |what was |tell |give )?(?:me )?(?:the )?(?:exact "
         r")?(?:time|moment|"
         r"second|timestamp|instant) (?:when|at which|that|of|where|in which|for))(?= )(?P<rest>.*)$"),
        ("how_fast", rf"^(?:and )?(?:how (?:fast|quick|quickly|rapidly|slow|slowly|speedy|swiftly)|(?:at|with|by|in)? "
                     rf"?(?:what|which|how much) "
         rf"{_SPEED}|(?:what is |what was |what are |give |tell |give me )?(?:the |its "
         rf")?{_SPEED.replace('kind', 'kind2')}|"
         rf"(?:how many|(?:what is )?(?:the )?(?:number of )?)? ?(?P<unit>{_UNIT}))(?: of| for| does| is| has)?(?= |"
         rf"$)(?P<rest>.*)$"),
        ("how_long", rf"^(?:and )?(?:for |over |within )?(?:how (?:long|much time|many (?:seconds|secs|sec|s))|"
                     rf"(?:what is |what was )?(?:the )?"
         rf"(?:duration|time span|timespan)|(?:what|which) (?:duration|amount of time)|(?:in|for|over) (?:what|which) "
         rf"time){_IT_TAKES}"
         rf"(?: of| for)?(?= |$)(?P<rest>.*)$"),
        ("which_way", r"^(?:and )?(?:in|to|into|toward|towards|on|from)? ?(?:which|what) (?:way|directions?|side)(?= |"
                      r"$)(?P<rest>.*)$|"
         r"^(?:what is |tell me )?the direction (?:of|in which)(?P<of>.*)$"),
        ("how_far", r"^(?:and )?how (?P<near>close|near) (?:does|do|did|will) (?P<rest>.+ (?:get|come|go|pass|roll|"
                    r"walk|move)s? (?:to|by|near|past) "
         r".+)$"),
        ("how_far", rf"^(?:and )?(?:(?:by |to |through |about |over )?(?:from )?(?:how (?:far(?: out| down| up| in| "
                    rf"along| across)?|much distance|much way|much|long a (?:way|path|distance)|"
         rf"large a distance|wide|high|deep|low)|how many (?P<unit>{_LENGTH}|{_ANGLE})|(?:what|which) (?:is the "
         rf")?(?:total )?"
         rf"(?P<angle>distance|height|path|angle|way length|travel distance|path length)(?: of| that| which| in "
         rf"{_LENGTH})?|"
         rf"(?:what is |give )?(?:the )?(?:total |overall )?(?:distance|path length|length of the (?:path|way|route)|"
         rf"travel|opening angle)"
         rf"(?: of| that| which)?))(?= |$)(?P<rest>.*)$"),
        ("how_many", r"^(?:and )?(?:how many|count|(?:what is )?the number of|what number of)(?: different| of)?(?= |"
                     r"$)(?P<rest>.*)$"),
        ("where", r"^(?:and )?(?:to |from )?(?:where(?:abouts| exactly| to)?|(?:at|in|on|to) (?:what|which) (?:place|"
                  r"spot|location|"
         r"position))(?= )(?P<rest>.*)$"),
        ("faster", r"^(?:and )?(?:which|what|who)(?: one| thing)?(?: is| goes| moves| turns| travels)? (?:the "
                   r")?(?P<more>faster|quicker|slower)"
         r"(?: one)?(?: ,| :)? (?P<rest>.+ or .+)$"),
        ("which", r"^(?:and )?(?:(?:name|list|show|tell)(?: me)? )?(?:which|what|everything|all|the things?|"
                  r"the objects?|"
         r"things|all things|all the things|something)(?: one| ones| of (?:these|them|the things|the objects|all)| "
         r"things?| objects?| items?"
         r"| stuff| else| all)?(?: is it| here)?(?: that| which| who| , that)?(?= )(?P<rest>.*)$|"
         r"^(?:(?:name|list|show|tell)(?: me)? )?(?P<ranked>the (?:first|last|fastest|slowest) .+)$"),
    )
)  # fmt: skip
_DOES = next(pattern for asks, pattern in _CUES if asks == "does")
_SPEED_LAST = re.compile(rf"^(?P<rest>.+?)(?: 's)? (?:(?:its )?{_SPEED}|(?P<unit>{_UNIT}))$")
_CUE_LAST = re.compile(
    rf"^(?P<rest>.+?)(?: ,)? (?P<cue>when(?: exactly)?|at what time|what time|at which second|how far|how long|how "
    rf"fast|"
    rf"how many (?:{_LENGTH}|{_ANGLE}|turns|times|seconds|rotations|revolutions)|where|which way|how often)$"
)
_ANY_MOTION = re.compile(
    r"^(?:is|are) there (?:still )?(?:any |some )?(?:movements?|motion)(?: here| in the room)?(?= |$)"
)
_TWO_QUESTIONS = re.compile(r"\band (?:when|how|where|what|which|why|does|is|are|do)\b")
_LATER = re.compile(
    r"^how (?:long|much time|many seconds|many secs|much later)(?: passes| is it)? after (?P<a>.+?) (?:does|do|did|"
    r"will|is) (?P<b>.+)$"
)
_TOPIC = re.compile(
    r"^(?P<x>the \w+(?: \w+)?) , (?P<rest>(?:when|how|where|what|which|does|is|at)\b.*)\b(?:it|they)\b(?P<end>.*)$"
)
_A_TURN = re.compile(
    r" (?:for|to make|to complete|to do|to finish|makes?|complete|do) (?P<n>one|a|each|a full|a single|one full|"
    r"every) "
    r"(?:turn|rotation|revolution|spin|round)\b"
)
_HERE = re.compile(r" (?:(?:right )?(?:in|up|over|around|out|down) )?(?:here|there)$")  # says nothing of what moves
_SAID = r"(?P<x>the [\w ]+?)"
_SAME = tuple(  # what people say, and the same as it is asked plainly
    (re.compile(pattern), plain)
    for pattern, plain in (
        (r"^(?:is )?anything moving (?:besides|except|apart from|other than|but) (?P<x>.+)$",
         r"does anything besides \g<x> move"),
        (r"^(?:is )?(?:there )?anything (?P<v>moving|turning|spinning|falling)\b", r"is anything \g<v>"),
        (rf"^{_SAID} (?P<v>does|did|is|was|will) (?:it|he|she|they) (?P<rest>.+)$", r"\g<v> \g<x> \g<rest>"),
        (rf"^(?P<t>at [\d.]+(?: s| seconds?)?) ,? ?{_SAID} (?:is|was) (?P<rest>(?:still )?\w+(?:ing|en))$",
         r"is \g<x> \g<rest> \g<t>"),
        (r"\bon the (?P<w>last|final|first) frame\b", r"in the \g<w> frame"),
        (rf"^(?:the )?(?:total |whole )?time {_SAID} is in motion$", r"how long does \g<x> move"),
        (r"^(?:the )?(?:total |whole )?(?:path|travel|way) length of (?P<x>.+)$", r"how far does \g<x> move"),
    )
)  # fmt: skip
_ASKING = re.compile(
    r"(?:and )?(?:how|what|which|when|where|who|why|in what|in which|at what|at which|list|name|count|tell|give|"
    r"show)\b"
)
_RANK = re.compile(
    r"\b(?:(?:is|are|was|be|comes|goes|being) )?(?:as )?(?:the )?(?:very )?(?P<r>first|last|second|third|fourth|"
    r"fastest|quickest|slowest|"
    r"farthest|furthest|longest|shortest|least|earliest|latest|soonest|most)(?: (?:one|thing|object|item|of all|of "
    r"them|time|distance|way|"
    r"book|of the three))?(?: (?:to|that|who|which|in))?(?= |$)"
)
_RANKED = {
    "quickest": "fastest", "furthest": "farthest", "earliest": "first", "soonest": "first", "latest": "last",
    "most": "farthest", "least": "nearest", "shortest": "nearest", "longest": "farthest",
}  # fmt: skip
_OPTIONS = re.compile(
    r"(?: ,| :)? ?(?:is it )?(?:to the |on the |to |its )?(?P<a>left|right|up|down|forward|forwards|backward|"
    r"backwards|in|out|inward|inwards|outward|"
    r"outwards|clockwise|towards me|away from me|toward me|sideways|straight)(?:wards?)? or (?:to the )?(?P<b>left|"
    r"right|up|down|forward|"
    r"forwards|backward|backwards|in|out|inward|inwards|outward|outwards|counter ?clockwise|anti ?clockwise|"
    r"counterclockwise|"
    r"anticlockwise|towards me|away from me|toward me|sideways|away|straight)(?:wards?)?$"
)
_STATE_WORDS = (
    r"(?:opening|closing|falling|sliding|waiting|fall|stay|move|stop|close|start|open|closed|shut|moving|still|"
    r"standing still|at rest|running|on|off|in|out|stopped|turning|"
    r"spinning|rolling|walking)"
)
_STATES_OR = re.compile(
    rf" (?P<a>{_STATE_WORDS}) or (?:is it |already |still |again |not )?(?P<b>{_STATE_WORDS}|not)(?= |$)"
)
_FILL = bag(
    "do does did is are was were will would can could shall has have had be been being make makes made need needs "
    "needed take takes taken "
    "took taking use uses used "
    "there which that to of for in by with then actually exactly immediately really already even also too whole here "
    "itself again "
    "ever just total seconds second i we you and so please , it's its own long way complete completes completed "
    "perform performs performed happen happens spend "
    "spends keep keeps "
    "the a this scene about amount completely fully finally while entire"
)
_PRONOUN = bag("it they them that this he she itself one")
_PLACES = re.compile(
    r"^(?:right |just |directly )?(?P<at>at|on to|onto|on top of|on|in front of|into|inside|in|against|near|next to|"
    r"beside|by|to|toward|"
    r"towards|from|off|of|over|across|past|under|underneath|behind|with|through|between|above|close to|along|"
    r"around)(?= )"
)
_STATE = re.compile(
    r"^(?P<a>.+?) (?:(?:is|are|was|be|stay|stays|staying|remain|remains|spend|spends|lie|lies|stand|stands|sit|sits|"
    r"rest|rests|being) )?"
    r"(?P<r>on top of|on|inside|in front of|in contact with|touching|touch|under|underneath|next to|beside|near|"
    r"behind|above|over|against|"
    r"in|close to|between|left of|right of|to the left of|to the right of) (?P<b>(?:the|a|an|its|my|it) .+|it)$"
)
_STATES: dict[str, Kind] = {"open": "is_open", "opened": "is_open", "closed": "is_closed", "shut": "is_closed"}
_NTH = r"(?:first|second|third|fourth|last)"
_ORDINAL_PAIR = re.compile(rf"^(?:the )?(?P<a>{_NTH}) and (?:the )?(?P<b>{_NTH}) (?P<rest>.+)$")
_STILL_AT = re.compile(r"\bstill (?:on|in|at|next|near|under|beside|behind|by|above|against)\b")
_FROM_TO = re.compile(r"^(?P<x>.*?) ?(?:takes?|needs?|get|to get|to go)? ?from (?P<a>.+) to (?P<b>.+)$")
# What a movement with a place is: "roll off the rug", "walk to the bed"; with another preposition it is not read.
_BY = ("at", "in", "on", "next to", "near", "beside", "by", "in front of", "against", "close to")
_WITH_PLACE: dict[str, Kind] = {
    "to": "reach",
    "into": "reach",
    "against": "reach",
    "toward": "approach",
    "towards": "approach",
    "from": "leave",
    "off": "leave",
    "over": "cross",
    "across": "cross",
    "through": "cross",
    "along": "cross",
    "past": "pass",
    "by": "pass",
    "onto": "enter",
    "on to": "enter",
    "on": "cross",
}
_SIDES = {"under": "under", "underneath": "under", "behind": "behind", "in front of": "in_front_of", "inside": "inside"}
_TAKES = ("reach", "enter", "leave", "cross", "pass", "approach", "recede")


@lru_cache(maxsize=4096)
def frames(words: tuple[str, ...]) -> tuple[Frame, ...]:
    """Every way of reading the words of a question as one about a scene with time, the likeliest first."""
    said = _HERE.sub("", " ".join(words))
    for pattern, plain in _SAME:
        said = pattern.sub(plain, said)
    found = list[Frame]()
    for frame in _frames(said):
        if frame not in found:
            found.append(frame)
    return tuple(found)


def _frames(said: str) -> Iterator[Frame]:
    if _TWO_QUESTIONS.search(said):
        return
    said = _ANY_MOTION.sub("does anything move", said)
    if found := _LATER.match(said):
        for b in happenings(found["b"]):
            a = _short(found["a"], b)
            if a is not None and b.deed is not None:
                yield Frame("between", a, b)
    if found := _TOPIC.match(said):
        said = f"{found['rest']}{found['x']}{found['end']}"
    rest, unit = _without_unit(_A_TURN.sub(" turn", said))
    yield from _speeds(rest, unit)
    if unit:
        yield from _speeds(said, "")
    for time, plain in _timed(rest):
        if time is not None and (found := _DOES.match(plain)) is not None:
            inner = next(group for group in found.groups() if group)
            for what in happenings(inner):
                yield Frame("does", what, when=time)
    for asks, pattern in _CUES:
        if found := pattern.match(rest):
            groups = found.groupdict()
            inner = next(
                (groups[n] for n in ("rest", "doing", "to", "odd", "of", "how", "ranked") if groups.get(n)), ""
            ).strip(" ,")
            kind = groups.get("kind") or groups.get("kind2") or ""
            named = groups.get("unit") or unit or ("degrees" if groups.get("angle") == "angle" else "")
            start = Frame(asks, Happening(None), unit=named, measure=_measure(kind))
            if groups.get("near"):
                start = replace(start, measure="nearest")
            if groups.get("later") or groups.get("more"):
                start = replace(start, rank=groups.get("later") or groups.get("more") or "")
            yield from _filled(start, inner)
    if not _ASKING.match(rest) and (found := _CUE_LAST.match(rest)):
        yield from _frames(f"{found['cue']} {found['rest']}")
    if not unit and not _ASKING.match(said):
        yield from _filled(Frame("yesno", Happening(None)), rest)


def _speeds(said: str, unit: str) -> Iterator[Frame]:
    """A speed that is named last: "the ball 's average speed", "fan rpm"."""
    for when, rest in _timed(said):
        bare = re.sub(r"^(?:and )?(?:what is|what was|tell me|give me|give) ", "", rest)
        last = _SPEED_LAST.match(bare)
        if last is not None and not _ASKING.match(bare) and (thing := _thing(_stripped(last["rest"]))) is not None:
            measure = _measure(last["kind"])
            yield Frame("how_fast", Happening(None, thing), when=when, unit=last["unit"] or unit, measure=measure)


def _filled(start: Frame, said: str) -> Iterator[Frame]:
    """A frame with its time and its happenings, in each way that the words allow."""
    if start.asks in ("which_way", "where", "does", "yesno") and (found := _OPTIONS.search(said)):
        asks: Asks = "which_way" if start.asks == "yesno" else start.asks
        yield from _filled(
            replace(start, asks=asks, options=(found["a"], found["b"])), said[: found.start()].strip(" ,")
        )
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
    asks = start.asks
    if asks == "between" or (asks == "faster"):
        for a, b in _pairs(
            said, " or " if asks == "faster" else " than " if start.rank in ("later", "earlier") else " and "
        ):
            yield replace(start, what=a, other=b)
        return
    if asks == "yesno" and start.when is not None and start.when.conj in ("before", "after"):
        yield from _compared(start, said)
    if asks in ("which", "when", "yesno", "order", "how_fast", "how_far", "how_many", "how_long", "does") and (
        found := _RANK.search(said)
    ):
        word = _RANKED.get(found["r"], found["r"])
        plain = re.sub(r" +", " ", f"{said[: found.start()]} {said[found.end() :]}").strip(" ,")
        for what in happenings(plain):
            yield replace(start, what=what, rank=word)
    for what in happenings(said):
        yield replace(start, what=what)


def _compared(start: Frame, said: str) -> Iterator[Frame]:
    """ "Does the red book fall before the green one": two happenings in order."""
    assert start.when is not None
    for what in happenings(said):
        other = _short(start.when.clause, what)
        if other is not None and what.deed is not None:
            yield replace(start, what=what, other=other, when=None, rank=start.when.conj)


def _pairs(said: str, joint: str) -> Iterator[tuple[Happening, Happening]]:
    """Two happenings on either side of a word; the first may leave out what both say: "the red and the blue drop"."""
    if (m := _ORDINAL_PAIR.match(said)) is not None:
        for what in happenings(m["rest"]):
            yield replace(what, nth=m["a"]), replace(what, nth=m["b"])
    parts = said.split(joint)
    if (
        len(parts) == 2
        and (m := re.match(r"^(?:the )?(?P<c>\w+)(?P<rest>(?: \w+)*)$", parts[0])) is not None
        and not m["rest"]
    ):
        for b in happenings(parts[1]):
            colored = _thing(f"the {m['c']} thing")
            if b.deed is not None and b.subject is not None and colored is not None and is_color_word(m["c"]):
                yield replace(b, subject=colored.model_copy(update={"text": b.subject.text})), b
    for i in range(1, len(parts)):
        first, second = joint.join(parts[:i]).strip(" ,"), joint.join(parts[i:]).strip(" ,")
        for b in happenings(second):
            for a in happenings(first):
                if a.deed is not None and b.deed is not None:
                    yield a, b
                elif a.deed is None and b.deed is not None:
                    yield replace(a, deed=b.deed), b
                elif a.deed is not None and b.deed is None:
                    yield a, replace(b, deed=a.deed)
                else:
                    yield a, b


def _short(said: str, like: Happening) -> Happening | None:
    """The second happening of a comparison: in full, or a thing that does the same: "the green one (does)"."""
    for found in happenings(re.sub(r" (?:does|do|did|is|has)$", "", said)):
        if found.deed is not None or found.subject is not None:
            return found if found.deed is not None else replace(found, deed=like.deed)
    return None


def happenings(said: str) -> Iterator[Happening]:
    """Each way of reading words as a happening; every word must belong to it."""
    said = re.sub(
        r"(?<= )(?:do|does|did|will|would) it (?:take|need|require)s?(?: for| to| until| till)?(?= )", " ", f" {said} "
    )
    said = re.sub(r"(?: ,)* +", " ", said).strip(" ,")
    said = re.sub(r" (?:here )?in (?:the |this )?room$", "", said)
    found = list(said_in(said))
    if len(found) > 1 or _STILL_AT.search(said):  # "is the fan still turning", "is it still on the desk": an adverb
        found = [f for f in found if f[2].verb.split()[-1] != "still"]
        said = re.sub(r"\bstill (?=(?:on|in|at|next|near|under|beside|behind|by|above|against)\b)", "", said)
    for a, b, deed in found if len(found) == 1 else ():
        yield from _around(deed, said[:a].strip(" ,"), said[b:].strip(" ,"))
    if state := _STATE.match(_stripped(said, ends=False)):
        relation = _relation(state["r"])
        subject, other = _thing(_stripped(state["a"])), _thing(state["b"])
        if relation and subject is not None and other is not None:
            yield Happening(Deed("related", relation=relation, verb=state["r"]), subject, other)
    yield from _by_noun(said)
    if said.endswith(
        (" on", " running", " working", " going", " switched on", " turned on", " off", " turned off", " switched off")
    ):
        thing = _thing(
            _stripped(re.sub(r" (?:still )?(?:switched |turned )?(?:on|off|running|working|going)$", "", said))
        )
        if thing is not None:
            yield Happening(Deed("still" if said.endswith("off") else "move", verb="on"), thing)
    if not found and (way := _FROM_TO.match(said)) is not None:
        goal, origin = _thing(way["b"]), _thing(way["a"])
        if goal is not None and origin is not None:
            yield Happening(Deed("reach", verb="reach"), _thing(_stripped(way["x"])), goal)
    bare = _stripped(said)
    if not bare and not found:
        yield Happening(None)
    elif not found and (thing := _thing(bare)) is not None:
        yield Happening(None, thing)


def _by_noun(said: str) -> Iterator[Happening]:
    """A happening that a noun names: "the fall of the red book", "the blue drop", "the turn"."""
    plain = _stripped(said)
    if (deed := as_noun(plain)) is not None:
        yield Happening(deed)
        return
    of = re.match(r"^(?P<d>(?:the |its |a )?(?:first |whole )?\w+)(?: of| by| between) (?P<x>.+)$", plain)
    if of is not None and (deed := as_noun(of["d"])) is not None and (thing := _thing(of["x"])) is not None:
        yield Happening(deed, thing)
    last = re.match(r"^(?P<x>.+?)(?: 's)? (?P<d>\w+)$", plain)
    if last is not None and (deed := as_noun(last["d"])) is not None:
        colored = is_color_word(last["x"].split()[-1])
        thing = _thing(last["x"]) or (_thing(f"{last['x']} thing") if colored else None)
        if thing is not None:
            yield Happening(deed, thing)


def _around(deed: Deed, before: str, after: str) -> Iterator[Happening]:
    """A deed with the things before and behind it."""
    noun = as_noun(_stripped(before))
    if noun is not None and not after and deed.kind in ("start", "stop"):
        phase: Phase = "start" if deed.kind == "start" else "stop"
        yield Happening(Deed(noun.kind, phase, verb=noun.verb))  # "when does the turn end"
        return
    subject = _subject(before)
    if subject is False:
        return
    state = _STATES.get(deed.verb.removesuffix(" again"))
    if state is not None and re.match(r"(?:is|are|was|were|be|stay|stays|remain|remains)\b", before):
        deed = replace(deed, kind=state, way="")
    away = re.match(r"^from (?P<a>.+?) (?:to|until|up to) (?P<b>.+)$", after)
    if away is not None and (goal := _thing(away["b"])) is not None and _thing(away["a"]) is not None:
        yield Happening(deed, subject, goal, "to")
        return
    place = _PLACES.match(after)
    rest = after[place.end() :].strip() if place is not None else after
    rest = _ends(rest)
    at = place["at"] if place is not None and rest else ""
    if not rest:
        if subject is not None or not before or _stripped(before) == "":
            yield Happening(deed, subject)
        return
    other = _thing(rest)
    if other is None and subject is None and not at:
        yield from _two_behind(deed, rest)
    if other is None:
        return
    if subject is None and deed.kind not in _TAKES and not at:
        yield Happening(deed, other)  # "when stops the fan"
        return
    yield from _placed(deed, subject, other, at)


def _two_behind(deed: Deed, rest: str) -> Iterator[Happening]:
    """ "When reaches the robot the bed?": both things behind the verb."""
    for m in re.finditer(r" (?=(?:the|a|an|my|its) )", rest):
        first, second = _thing(rest[: m.start()]), _thing(rest[m.end() :])
        if first is not None and second is not None and deed.kind in _TAKES:
            yield Happening(deed, first, second)


def _placed(deed: Deed, subject: Query | None, other: Query, at: str) -> Iterator[Happening]:
    """A deed with a place or a thing: what it means together with the preposition."""
    if at in ("", "with") or deed.kind in _TAKES or deed.kind in ("land", "nearest", "farthest"):
        yield Happening(deed, subject, other, at)
    elif at == "by" and subject is None:
        yield Happening(deed, other)  # "the way travelled by the drawer"
    elif deed.kind == "move" and not deed.phase and at in _WITH_PLACE:
        yield Happening(replace(deed, kind=_WITH_PLACE[at]), subject, other, at)
    elif deed.kind == "move" and not deed.phase and at in _SIDES:
        yield Happening(Deed("related", relation=_SIDES[at], verb=at), subject, other)
    elif deed.kind == "fall" and at in ("on", "onto", "on to", "to", "into"):
        yield Happening(replace(deed, kind="land"), subject, other, at)
    elif deed.kind == "fall" and at in ("from", "off", "of"):
        yield Happening(deed, subject)
    elif deed.kind == "start" and at in ("from", "at", "next to", "near", "beside"):
        yield Happening(deed, subject, None, at)
    elif deed.kind == "stop" and at in _BY:
        yield Happening(deed, subject, other, at)


def _subject(before: str) -> Query | Literal[False] | None:
    """The thing before a deed, None if there is none; False if the words are no thing."""
    plain = _stripped(before)
    if not plain:
        return None
    thing = _thing(plain)
    if thing is None:
        words = plain.split()
        if words[-1] in _PRONOUN and len(words) > 1 and (thing := _thing(" ".join(words[:-1]))) is not None:
            return thing  # "how many things they move"
        return False
    return thing


@lru_cache(maxsize=4096)
def _thing(said: str) -> Query | None:
    """A noun phrase; "it" is what was spoken of."""
    said = said.strip(" ,")
    if not said:
        return None
    if said in _PRONOUN:
        return Query(last=True)
    if is_color_word(said.removeprefix("the ")):
        said = f"{said} thing"  # "when does red land?"
    if said.split()[-1] in verb_words() and kinds.find(said.removeprefix("the ")) is None:
        return None
    one = re.sub(r" one(s?)$", r" thing\1", said)
    found = noun_phrase.thing(tuple(one.split()))
    if found is None and not said.startswith(("the ", "a ", "an ", "any ", "all ")):
        found = noun_phrase.thing(("the", *one.split()))
    return found


def _ends(said: str) -> str:
    """Words without those at their end that say nothing."""
    words = said.split()
    while words and words[-1] in _FILL:
        words.pop()
    return " ".join(words)


def _stripped(said: str, ends: bool = True) -> str:
    """Words without those at either end that say nothing; articles stay with what follows them."""
    words = said.split()
    while (
        words
        and words[0] in _FILL
        and not (words[0] in ("the", "a", "this", "that", "its", "long", "own") and len(words) > 1)
    ):
        words.pop(0)
    while ends and words and words[-1] in _FILL:
        words.pop()
    return " ".join(words)


def _relation(said: str) -> str:
    if said in ("touching", "touch", "in contact with", "against"):
        return "touches"
    return relation_phrases.relation(tuple(said.split())) or ""


def _without_unit(said: str) -> tuple[str, str]:
    """The words without the unit that an answer is wanted in, and that unit."""
    found = _UNIT_TAIL.search(said)
    if found is None or found.start() == 0:
        return said, ""
    rest = f"{said[: found.start()]} {said[found.end() :]}"
    return re.sub(r" +", " ", rest).strip(" ,"), found["u"] or found["v"] or found["w"] or ""


def _measure(kind: str | None) -> str:
    words = set((kind or "").split())
    if words & {"top", "maximum", "maximal", "max", "peak", "highest", "greatest"}:
        return "top"
    if words & {"angular", "rotational", "rotation", "turning", "spinning", "spin"}:
        return "angular"
    return "average" if words & {"avg", "average", "mean", "overall", "typical"} else ""
