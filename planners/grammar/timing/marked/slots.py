"""What the marks of an instruction hold: things, goals, a time, an amount, a colour; and the words between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, islice, pairwise

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from ...learned.marks import Span, held_by
from ...learned.seen import hues
from ...tagging.words import bag
from ...vocabulary.nouns import is_known, is_opened
from ...vocabulary.quantities import NUMBERS
from ..ending import MovementOf
from ..happenings import IT, Happening
from ..manner import Thing
from ..moments import Moment, seconds_of
from .amounts import Amount, amount, repeats, spins
from .kinds import COURSES
from .names import MOVING, PARTS, with_colors, with_moving
from .names import named as names_in
from .orders import PLACES
from .times import TIMES, TRIM
from .when import BY_SO_MUCH, KEEPING, LOOKS, NEAR, PLACES_IN_TURN, is_a_time, tells_number, time_of, with_both_ends

_EVENTS = (
    r"(?:falls?|falling|drops?|movements?|motions?|rolls?|rolling|walks?|walking|turns?|turning|rotations?|spins?|"
    r"spinning|swings?|swinging|slides?|sliding|openings?|closings?|opening|closing|return|run|way|path|trip|journey|"
    r"route|ride|speed|pace|rate|start|stop|descent|animation|sequence|order|action|travel|stroke|course|routine|cycle|"
    r"business|performance|act|extension|retraction|departure|arrival|march|journeys?|rotation|plunge)"
)
_OF_EVENT = re.compile(rf"^(?:the |its |his |her |a )?(?:\w+ )?{_EVENTS} (?:of|by|for) ")
_WHOLE_OF = re.compile(r"(?<=\w) (?:leaf|blades?|front|panel)$")  # a part of it that moves as it does
_BESIDE_IT = re.compile(r" (?:of|over|above|on|in|at|by|near|beside|behind|under|from) ")
_GROUP_OF = re.compile(
    r"^(?:the |that |this )?(?:whole |entire )?(?:row|lot|trio|set|shelf|stack|group|bunch|line|gang|series|"
    r"collection) of (?:the )?(?=(?:\w+ )?\w+s$)"
)
_ALL_IT_DOES = re.compile(r"^(?:everything|all|whatever)(?: that)? (?P<who>the (?:[a-z]+ )?[a-z]+) does$")
_ANY_OF = re.compile(r"^any of (?:the|my|our|those|these) (?=(?:\w+ )*\w+s$)")  # which is not wanted
_IN_A_ROOM = re.compile(r"\b(?:dining|living|sitting|drawing|guest|bath)(?: room|room) (?=\w)")  # where it hangs
_ITS_EVENT = re.compile(rf"(?: 's?)?(?: (?:whole|entire|full|complete|outward|return|own|\w+ward))? {_EVENTS}$")
_STATE = re.compile(r"\b(?:open|opened|closed|shut|opening|closing) (?=[a-z])")  # before the name of what opens
_JUST_EVENT = re.compile(rf"^(?:the |its |his |her |their |this |that |whole |entire |\w+ing )*{_EVENTS}$")
_PLACES = re.compile(
    r"(?P<source>(?:off|from|out of|away from)(?: of)?)$|(?P<on>(?:on ?to|on top of|on|upon))$|"
    r"(?P<to>(?:to|towards?|next to|beside|by|near|close to|alongside|against|at|until|up to|into|in|under|behind|"
    r"in front of|meets?|reach(?:es)?|hits?|joins?|visits?|for|of|before|over to|across to))$"
)
_RANKS = re.compile(
    r"(?: (?:next|first|last|then|second|third|afterwards|finally|in turn|on|off|one by one|itself|himself|"
    r"herself|too|as well|again|instead|there|here))+$"
)
_A_THING = re.compile(r"\b(?:the|that|this|my|our) (?:[a-z]+ ){1,3}things?\b")  # "the left red thing"
_IDLE = ("not", "off", "keep")


ALL_MOVING = Query(text="", moving=True, pick="all")


@dataclass(frozen=True)
class Goal:
    """Where something goes, or beside what: the name, what it means, and whether that is on, to or away from it."""

    name: str
    query: Query
    way: str


@dataclass
class Slots:
    """What the marks of an instruction hold.

    Attributes:
        names: those of the things that are changed, each once and as said, with an article.
        goals: other things.
        moment, happening: the time in numbers, and by what happens.
        amounts: how much.
        color: as which colour; "" if none is told.
        rest: the words without a mark, with a bar for each mark that names a thing.
        said: all words that ask for something: those without a mark, and of things, goals and amounts.
        spans: the marks.
        thing: reads a name.
        moves, movement: tell whether what is named moves in the scene, and how.
        used: what of this a command holds.
        repeated: amounts that a time tells, too.
        redundant: words of times that tell nothing beside the others: "from 2 s, for 1 s, until 3 s".
        known: amounts that only tell how it is now.
    """

    names: tuple[str, ...]
    queries: tuple[Query, ...]
    goals: tuple[Goal, ...]
    moment: Moment
    happening: Happening | None
    amounts: tuple[Amount, ...]
    color: str
    rest: str
    said: str
    words: Sequence[str]
    spans: Sequence[Span]
    thing: Thing
    moves: Callable[[Query], bool]
    movement: MovementOf
    used: set[str] = field(default_factory=set)
    repeated: set[str] = field(default_factory=set)
    redundant: tuple[str, ...] = ()
    known: set[str] = field(default_factory=set)

    @property
    def told(self) -> bool:
        """Whether any time is told."""
        return self.happening is not None or self.moment.told

    @property
    def noun(self) -> str:
        """The noun of the first thing that is changed."""
        return self.queries[0].text

    @property
    def whom(self) -> str:
        """The names of all things that are changed."""
        return " and ".join(self.names)

    def one(self, *units: str) -> Amount | None:
        """The amount with one of some units, which a command then holds; None if there is none, or several."""
        fits = [own for own in self.amounts if own.unit in units]
        if len(fits) != 1:
            return None
        self.used.add(fits[0].said)
        return fits[0]

    def goal(self) -> Goal | None:
        """The one goal that is no source, which a command then holds."""
        fits = [goal for goal in self.goals if goal.way != "from"]
        if len(fits) != 1:
            return None
        self.pass_goals()
        return fits[0]

    def pass_goals(self) -> None:
        """Let a command hold all other things, also those that only tell where something is."""
        self.used |= {goal.name for goal in self.goals}

    def tell(self, pattern: re.Pattern[str]) -> bool:
        """Whether words that ask for something are among some."""
        return pattern.search(self.said) is not None

    @property
    def things(self) -> tuple[str, ...]:
        """The names of all things."""
        return (*self.names, *(goal.name for goal in self.goals))

    @cached_property
    def whole(self) -> str:
        """All words."""
        return " ".join(self.words)

    @cached_property
    def asked(self) -> str:
        """The words that are about no time, and not about what is not wanted, what stays, or nothing."""
        return self._without(*TIMES, *_IDLE).strip(TRIM)

    @cached_property
    def meant(self) -> str:
        """All words but those about what is not wanted, what stays, or nothing."""
        return self._without(*_IDLE)

    @cached_property
    def aside(self) -> str:
        """The words about how something is now and is not wanted."""
        return " ".join(" ".join(self.words[a:b]) for tag, a, b in self.spans if tag == "not")

    def _without(self, *tags: str) -> str:
        """The words that stand in no mark with one of some tags."""
        left_out = held_by(self.spans, *tags)
        return " ".join(word for at, word in enumerate(self.words) if at not in left_out)

    @cached_property
    def idle(self) -> str:
        """The words about what is not wanted, what stays, or nothing."""
        return " ".join(" ".join(self.words[a:b]) for tag, a, b in self.spans if tag in _IDLE)

    @property
    def beside(self) -> tuple[Query, ...]:
        """The things that words about what is not wanted, what stays, or nothing name."""
        shades = [word for word in self.idle.split() if word in hues()]
        named = map(self.thing, (*names_in(self.idle, self.thing), *shades))
        return tuple(query for query in named if query is not None and not query.last)

    def said_twice(self, facts: Sequence[float], end: float = math.inf) -> set[int]:
        """Where numbers stand that say nothing new: those of amounts that a time tells, too, and in words about what
        stays or is not wanted those that are how it is now.

        Args:
            facts: seconds of how it is now.
            end: seconds of the end of the scene: what goes on until then may be told in numbers.
        """
        lasts = isinstance(self.moment.stop, float) and abs(self.moment.stop - end) < NEAR
        marked = held_by(self.spans)
        found = {at for at, word in enumerate(self.words) if word in PLACES and at not in marked}  # "1. blue, 2. red"
        for tag, start, stop in self.spans:
            said = " ".join(self.words[start:stop])
            if tag in ("by", *TIMES) and any(own in said for own in self.repeated | self.known):
                found |= set(range(start, stop))
            if tag in TIMES and any(own in said for own in self.redundant):
                found |= set(range(start, stop))
            if tag == "keep" and not facts:
                found |= set(range(start, stop))
            if tag in TIMES and lasts:
                found |= {at for at in range(start, stop) if abs(self._number(at) - end) < NEAR}
            if tag in TIMES and _ITS_TURN.search(said):
                found |= {
                    at for at in range(start, stop - 1) if self.words[at + 1] in ("degree", "degrees", "deg", "°")
                }
            if tag in TIMES and (self.moment.always or _THROUGHOUT.search(said)):
                found |= set(range(start, stop))  # "for all five seconds"
            if (
                tag in _IDLE
                or (tag in TIMES and KEEPING.match(said))
                or (tag == "by" and sum(map(tells_number, self.words[start:stop])) > 1)
            ):
                found |= {at for at in range(start, stop) if any(abs(self._number(at) - now) < NEAR for now in facts)}
            if tag in _IDLE:
                found |= {at for at in range(start, stop - 1) if tag == "off" and _counts(self.words[at + 1])}
                found |= {at for at in range(start + 1, stop) if tag == "off" and self.words[at - 1] in _NUMBERED}
                found |= {at for at in range(start, stop - 1) if tag == "off" and self.words[at + 1] in _NO_SECONDS}
                found |= {at + 1 for at in range(start, stop - 1) if tag == "keep" and self.words[at] == "the"}
        return found

    def told_of(self, tag: str, seconds: float) -> bool:
        """Whether a mark with a tag holds a number of seconds."""
        return any(
            abs(self._number(at) - seconds) < NEAR for own, a, b in self.spans if own == tag for at in range(a, b)
        )

    def _number(self, at: int) -> float:
        """The number at a word, with "and a half" behind it; infinity if there is none."""
        value = seconds_of(f"{self.words[at]} seconds") if tells_number(self.words[at]) else None
        half = " ".join(self.words[at + 1 : at + 4]).startswith(("and a half", "and half"))
        return math.inf if value is None else value + 0.5 * half

    def unused(self) -> bool:
        """Whether an amount, or a goal, stands in no command."""
        return any(own.said not in self.used for own in self.amounts) or any(
            goal.name not in self.used for goal in self.goals if goal.way != "from"
        )


_ITS_TURN = re.compile(r"\bturn(?:s|ed|ing)?\b")
_THROUGHOUT = re.compile(
    r"\b(?:all|whole|entire|full|these) (?:(?!first|last|opening|closing|final|middle)\w+ )*?(?:seconds|secs)\b"
)
_UNLESS = re.compile(
    r"\b(?:except|unless|apart from|only if)\b|"
    r"(?<!wonder )(?<!see )(?<!know )(?<!ask )(?<!check )(?<!as )\bif (?:it|he|she|they|the)\b"
    r"(?! (?:is|are|was|would be|be|makes?|'s)? ?(?:no|not|all|any|okay|ok|fine|possible|too|animation|suits)\b)"
)
_ASKED_OF = re.compile(
    r"\b(?:the|a|an) \w+ (?:should|must|shall|has to|have to|needs? to|ought to|is to|are to)\b(?! not\b)|"
    r"\b(?:i|we) (?:want|would like|need) (?:it|him|her|them) to\b"
)
_AS_FAST = re.compile(r"\b(?:twice|double|half|times) (?:as|the) (?:fast|quick|slow|speed)\b")
_REVISED = re.compile(r"\b(?:revise|change|raise|adjust|reduce|increase|lower|set|bring) (?:it |that )?to \d")
_NOT_UNTIL = re.compile(r"\bnot (?:before|until|till) (?:the|my|a) \w+ \w+")


def _with_another(span: Span, words: Sequence[str]) -> tuple[Span, ...]:
    """The marks of a thing and of the one that it is to be like, of which one mark tells: "the middle drawer with the
    top drawer"."""
    tag, start, stop = span
    said = list(words[start:stop])
    at = start + said.index("with") if tag == "x" and "with" in said[1:-1] else None
    if at is None or not is_opened(words[at - 1]) or not is_opened(words[stop - 1]):
        return (span,)
    return (tag, start, at), ("y", at + 1, stop)


def asks_more(words: Sequence[str], tag: str) -> bool:
    """Whether words that seem to ask for nothing ask for more: "and the lamp should sing", "except in the mirror"."""
    said = " ".join(words)
    if tag == "not":
        return _UNLESS.search(said) is not None or _NOT_UNTIL.search(said) is not None
    if tag == "keep" and (_AS_FAST.search(said) is not None or _REVISED.search(said) is not None):
        return True  # "and going twice as fast as it is"
    if tag == "keep" and " but " in said and amount(said.split(" but ")[1]) is not None:
        return True  # "same roll but twice as fast"
    return tag == "off" and (_ASKED_OF.search(said) is not None or _UNLESS.search(said) is not None)


def slots(
    words: Sequence[str],
    spans: Sequence[Span],
    thing: Thing,
    kind: str,
    moves: Callable[[Query], bool],
    movement: MovementOf,
) -> Slots | None:
    """What the marks in words hold; None if one of them is not understood, or a number stands in none.

    Args:
        thing: reads a name.
        kind: that of the wish.
        moves, movement: tell whether what is named moves in the scene, and how; where nothing is named, what moves
            is meant.
    """

    def text(span: Span) -> str:
        return " ".join(words[span[1] : span[2]]).strip(TRIM)

    spans = [_joined(span, words, kind) for span in sorted(spans, key=lambda span: span[1])]
    spans = list(_merged([_retagged(span, words, text(span)) for span in spans], text, kind))
    if kind in ("open", "close", "together"):
        spans = [own for span in spans for own in _with_another(span, words)]
    thing = with_colors(thing, words, spans)
    if kind == "amount":
        spans = [_as_amount(span, text(span)) for span in spans]
    time = time_of(words, spans, text, thing, kind)
    if time is None:
        return None
    time, redundant = with_both_ends(*time)
    amounts = list[Amount]()
    for span in spans:
        if span[0] == "by" and not is_a_time(text(span), kind):
            found = repeats(text(span)) if kind == "repeat" else None
            found = found or amount(f"{text(span)} around" if kind == "spin" else text(span))
            if kind == "spin" and (found is None or found.unit in ("", "s")):
                found = spins(text(span)) or found
            if found is None:
                vague = not any(map(tells_number, text(span).split()))
                beside = any(own[0] == "by" and own != span and amount(text(own)) is not None for own in spans)
                if vague and (beside or kind in ("speed", "return", "begin", "open", "close", "remove")):
                    continue  # "right down"; "a crack, twenty degrees"
                if kind in ("pause", "halt", "amount") and _HALFWAY.search(text(span)) is not None:
                    continue  # "halfway" is told by words
                return None
            amounts += [] if any(_is_same(found, own) for own in amounts) else [found]
    named = [span for span in spans if span[0] == "x"]
    if any(_EVERYTHING.search(text(span)) for span in named) or _is_divided(words, named, thing, kind):
        return None
    goals = tuple(_goals(words, spans, text, thing))
    of = None if time[1] is None else time[1].during.of
    if kind == "move" and of is not None and of.text:  # "when the robot is there, the car joins it"
        goals = tuple(
            Goal(f"the {of.text}", of, own.way) if own.query.last and own.name in _IT else own for own in goals
        )
    unknown = any(goal.query.last and not _is_own(goal.name, kind) for goal in goals)
    if unknown and kind not in (*LOOKS, "order", "still", "stay"):
        return None
    names, queries = _things(map(text, named), thing, kind in COURSES and moves(ALL_MOVING))
    painted = None if names else _painted(map(text, (span for span in spans if span[0] == "as")), thing)
    if painted is not None:
        names, queries = (painted[0],), (painted[1],)  # "I would like a pink bed"
    if kind == "recolor" and (same := _looks_the_same(words, spans, thing)):
        more = _things(iter(same), thing)
        names, queries = (*names, *more[0]), (*queries, *more[1])
    if not names and any(
        ((query := thing(text(span))) is None and text(span) not in _PRONOUNS)
        or (query is not None and query.last and " " in text(span))
        for span in named
    ):
        return None  # what it is about is not understood
    if not names:
        names, queries = _things(iter(_named_elsewhere(words, spans, thing, time[1])), thing)
    of = None if time[1] is None else time[1].during.of
    if not names and of is not None and of.text and kind not in LOOKS:  # "once the blue volume falls, its fall ..."
        own = re.search(rf"\bthe (?:[a-z]+ )?{re.escape(of.text)}\b", time[1].said if time[1] is not None else "")
        names, queries = ((own[0],), (of,)) if own is not None else ((), ())
    if not names and kind in (*COURSES, "open", "close") and moves(ALL_MOVING):
        names, queries = (MOVING,), (ALL_MOVING,)
    if not names and len(goals) == 1 and kind in LOOKS:  # "a coat of paint on the bed"
        names, queries = (goals[0].name,), (goals[0].query,)
    goals = tuple(
        goal for goal in goals if not goal.query.last and goal.query not in queries and not _is_own(goal.name, kind)
    )
    shades = [span for span in spans if span[0] == "as"]
    wanted = [span for span in shades if len(shades) == 1 or not _is_former(words[: span[1]])]
    colors = dict.fromkeys(_color(text(span)) for span in wanted)
    marked = held_by(spans)
    left = [word for at, word in enumerate(words) if at not in marked]
    numbers = any(_is_number(word, then) for word, then in pairwise([*left, ""]) if word not in _SAYS_SO.get(kind, ()))
    if len(colors) > (kind == "recolor") or numbers:
        return None
    asking = held_by(spans, "x", "y", "by")
    said = " ".join(word for at, word in enumerate(words) if at not in marked or at in asking)
    return Slots(
        names, queries, goals, *time, tuple(amounts), next(iter(colors), ""), _rest(words, spans), said,
        words, spans, thing, moves, movement, redundant=redundant,
    )  # fmt: skip


def _is_same(one: Amount, other: Amount) -> bool:
    """Whether two amounts are the same: "at half its speed, at 50 percent"."""
    first, second = (own.value / 100 if own.unit == "%" else own.value for own in (one, other))
    return first == second and {one.unit, other.unit} in ({one.unit}, {"%", "times"})


def _looks_the_same(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> tuple[str, ...]:
    """What is to look like the thing that is named first: "the sofa green, and the coffee table the same green"."""
    kept = (" ".join(words[a:b]) for tag, a, b in spans if tag == "keep")
    return next((names_in(said, thing)[:1] for said in kept if _THE_SAME.search(said)), ())


_THE_SAME = re.compile(r"^(?:, )?and (?:the|my|our|that) .*\bthe same\b")


def _named_elsewhere(
    words: Sequence[str], spans: Sequence[Span], thing: Thing, happening: Happening | None
) -> tuple[str, ...]:
    """What an instruction is about where no mark names that: what its other words name, or else that which its time is
    told by: "once the door has been open for a second, shut it"."""
    if not any(tag in ("x", "y") for tag, _, _ in spans):
        taken = held_by(spans)
        bare = " ".join("," if at in taken else word for at, word in enumerate(words))
        if found := names_in(bare, thing)[:1] or tuple(m[0] for m in islice(_A_THING.finditer(bare), 1)):
            return found
    elif named := [
        name for tag, a, b in spans if tag in ("off", "not") for name in names_in(" ".join(words[a:b]), thing)
    ]:
        return tuple(dict.fromkeys(named)) if len(set(named)) == 1 else ()  # "reroute the ball, it should ..."
    if happening is not None:
        return names_in(happening.said, thing)[:1]
    when = [names_in(" ".join(words[a:b]), thing)[:1] for tag, a, b in spans if tag in TIMES]
    return next(filter(None, when), ())


def _joined(span: Span, words: Sequence[str], kind: str) -> Span:
    """A mark; of a look the other thing that is joined with "and" has that look, too: "bed and shelf, both in blue".
    "The left red" before "thing" goes on to that."""
    tag, start, stop = span
    if tag == "x" and stop < len(words) and words[stop] in ("thing", "things"):
        return tag, start, stop + 1
    joined = tag == "y" and kind in LOOKS and start > 1 and words[start - 1] in ("and", "nor")
    return ("x", start, stop) if joined else span


def _as_amount(span: Span, said: str) -> Span:
    """A mark of how far something is to go: also what "is enough", and "to 10"."""
    tag, start, stop = span
    enough = tag in ("not", "off") and _ENOUGH.search(said) is not None and amount(_ENOUGH.sub("", said)) is not None
    return ("by", start, stop) if enough or (tag == "to" and _TO_A_NUMBER.match(said)) else span


def _retagged(span: Span, words: Sequence[str], said: str) -> Span:
    """A mark with the tag that its words have: "which may take [by another second]" tells for how long, "[for in half
    the time]" by how much."""
    tag, start, stop = span
    if tag == "to" and BY_SO_MUCH.match(said) is not None and not _SHIFTED.isdisjoint(words):
        return "by", start, stop  # "it is to be brought forward by one second"
    if tag == "for" and _SHARE_OF_TIME.match(said) is not None:
        return "by", start, stop
    takes = tag == "by" and start and words[start - 1] in _TAKE
    return ("for", start, stop) if takes and (far := amount(said)) is not None and far.unit == "s" else span


_SHIFTED = bag(
    "earlier sooner later anticipate anticipated advance advanced bring brought forward postpone postponed delay "
    "delayed shift shifted move moved push pushed defer deferred"
)
_SHARE_OF_TIME = re.compile(
    r"^(?:in |within )?(?:only |just )?(?:half|twice|double|a third|a quarter)(?: of)? (?:the|its|that) time$"
)
_TAKE = bag("take takes taking last lasts lasting")


def _merged(spans: Sequence[Span], text: Callable[[Span], str], kind: str) -> Iterator[Span]:
    """The marks, turns and the time in which they are made as one: "[by one turn] [for in two seconds]"."""
    left = list(spans)
    while left:
        (tag, start, stop), *left = left
        rate = kind == "speed" and tag == "by" and left and left[0][:2] == ("for", stop)
        if rate and _TURNS.search(text((tag, start, stop))) and _IN_A_TIME.match(text(left[0])):
            stop = left.pop(0)[2]
        yield tag, start, stop


_TURNS = re.compile(r"\b(?:turns?|rounds?|revolutions?|rotations?|circles?)$")
_IN_A_TIME = re.compile(r"^(?:in|every|per|each) ")
_ENOUGH = re.compile(
    r"\b(?:(?:is|are|will be|would be|ought to be|should be|'s) )?(?:quite |more than |just )?(?:plenty|enough|ample|"
    r"suffic\w+|(?:the )?(?:limit|max|maximum)|as far as (?:it|we) (?:go|goes|want)|will do|would do|does it)\b"
)
_TO_A_NUMBER = re.compile(r"^(?:down |up |only |just )*to (?:only |just )?\d+(?:\.\d+)?(?: (?:cm|m|degrees?|deg|°))?$")


def _is_divided(words: Sequence[str], named: Sequence[Span], thing: Thing, kind: str) -> bool:
    """Whether other words stand between the names of several things: "stop the fan, and the lamp should sing"."""
    if kind in ("order", "together"):
        return False
    names = [(" ".join(words[start:stop]).strip(TRIM), start, stop) for _, start, stop in named]
    meant = [(thing(name), start, stop) for name, start, stop in names]
    ranks = {stop for name, _, stop in names if set(name.split()) <= PLACES_IN_TURN}  # "first bottom, then top"
    told = [
        (query, start, stop)
        for query, start, stop in meant
        if query is not None and not query.last and not (stop in ranks and kind == "open")
    ]
    if kind == "open" and _IN_ORDER & set(words) and all(is_opened(query.text) for query, _, _ in told):
        return False
    joints = _JOINTS | _AGAIN if kind in LOOKS else _JOINTS
    return any(
        one != other and not set(words[stop:start]) <= joints for (one, _, stop), (other, start, _) in pairwise(told)
    )


_IN_ORDER = bag("first then next last finally lastly followed")
_ZERO = ("zero", "0")
_SAYS_SO = {  # numbers that say nothing but the kind of a wish: "at speed 0", "visible = 0", "1. blue, 2. red"
    "still": _ZERO, "halt": _ZERO, "pause": _ZERO, "stay": _ZERO, "hide": (*_ZERO, "1"), "order": tuple(PLACES),
}  # fmt: skip
_JOINTS = bag("and , or nor neither plus + / & both the as well with along")
_AGAIN = bag("lose remove delete hide take get rid of away out too also then drop bin scrap ditch to see can go may .")
_BEHIND_NAMES = bag(
    "on in at under beside behind below above from near by to next of with and , ' 's that which who there here over "
    "along round left right up down now too as"
)
_FORMER = bag("than of 's from not that")  # before the colour that something had: "swap its brown for green"
_EVERYTHING = re.compile(r"^(?:everything|all) (?:else|but)\b|\b(?:the rest|the others?)$")


def _rest(words: Sequence[str], spans: Sequence[Span]) -> str:
    found, at = list[str](), 0
    for tag, start, stop in spans:
        found += [*words[at:start], *(["|"] if tag in ("x", "y") else [])]
        at = stop
    return " ".join([*found, *words[at:]])


def _is_number(word: str, then: str) -> bool:
    if word[0].isdigit():
        return True
    return word in NUMBERS and word not in ("one", "a", "an", "half") and not is_known(then)


def _painted(shades: Iterator[str], thing: Thing) -> tuple[str, Query] | None:
    """What a colour is said of, behind it in one mark, and its name; None if nothing is."""
    for said in shades:
        noun = said.split()[-1]
        if is_known(noun) and noun not in hues() and set(said.split()[:-1]) & hues():
            query = thing(f"the {noun}")
            return None if query is None else (f"the {noun}", query)
    return None


def _is_former(before: Sequence[str]) -> bool:
    """Whether words before a colour tell that something has it now: "swap its brown for", "and reverts to"."""
    return (
        not _FORMER.isdisjoint(before[-1:])
        or re.search(r"\b(?:back|reverts?|returns?) (?:in)?to$", " ".join(before)) is not None
    )


def _counts(then: str) -> bool:
    """Whether the word behind a number is of things that are counted, and no unit: "a canon for three voices"."""
    return then.isalpha() and then not in _UNITS and then not in NUMBERS


_NO_SECONDS = bag(
    "m cm mm meter meters metre metres km kg degree degrees deg percent % am pm minutes hours years days hz rpm"
)
_NUMBERED = bag(
    "requirement tc cue note p no number version scene shot reel bar chapter page line step rule item point class year "
    "room grade level part day week take slide figure table question exercise - #"
)
_UNITS = bag(
    "hz hertz rps fps s sec secs second seconds m cm mm meter meters metre metres degree degrees deg percent turn "
    "turns time times rpm and or to until till from at by in half"
)


def _color(said: str) -> str:
    """A colour without the words around it."""
    said = re.sub(
        r"^(?:(?:as|in|to|into|a|an|the|of|nice|bright|lovely|soft|warm|cool|rich|painted|coloured|colored|turned|it) "
        r")*(?=\w)",
        "",
        said,
    )
    return re.sub(
        r"(?: (?:colou?r|one|ones|instead|again|paint|shade|coat|all over|please|hue|tone|tint|finish))+$", "", said
    )


def _divided(name: str) -> tuple[str, ...]:
    """The names that a name for several stands for: "the two lower drawers"."""
    if (drawer := _NUMBERED_DRAWER.match(name)) is not None:
        return (f"the {_DRAWERS[str(NUMBERS.get(drawer['at'], drawer['at']))]} drawer",)
    return ("the middle drawer", "the bottom drawer") if _LOWER.match(name) else (name,)


_LOWER = re.compile(r"^(?:both (?:of )?)?(?:the )?(?:(?:two )?(?:lower|bottom)|lower two|bottom two) (?:two )?drawers$")
_NUMBERED_DRAWER = re.compile(r"^(?:the )?drawer (?:number |no ?\.? ?|# ?)?(?P<at>one|two|three|1|2|3)$")
_DRAWERS = {"1": "top", "2": "middle", "3": "bottom"}
_PRONOUNS = ("its", "his", "her", "this one", "that one", "same", "the same", "this", "that")
_IT = ("it", "him", "her", "them", "that one", "this one")
_CRIES = bag("boom bang poof bam wham pow presto abracadabra voila tada hey")


def _things(said: Iterator[str], thing: Thing, grouped: bool = False) -> tuple[tuple[str, ...], tuple[Query, ...]]:
    """Names of things and what they mean, each once, without pronouns and what they do: "the ball 's roll".

    Args:
        grouped: whether "all three" are all that moves.
    """
    found = dict[str, Query]()
    for name in chain.from_iterable(map(_divided, said)):
        if _JUST_EVENT.match(name) or name in _CRIES:
            continue
        bare = _ITS_EVENT.sub("", _OF_EVENT.sub("", re.sub(r" 's?$", "", name))).strip(TRIM)
        bare = _ALL_IT_DOES.sub(r"\g<who>", bare)
        bare = _GROUP_OF.sub("all the ", _ANY_OF.sub("all the ", bare))
        bare = _IN_A_ROOM.sub("", re.sub(r" 's?$", "", bare))
        bare = _STATE.sub("", with_moving(bare)) if is_opened(bare) else with_moving(bare)
        head = _BESIDE_IT.split(bare)[0].split()
        if head and (part := singular(head[-1])) in PARTS:
            bare = f"the {PARTS[part]}" if len(head) < 3 else _WHOLE_OF.sub("", bare)
        query = ALL_MOVING if grouped and _GROUP.match(bare) else thing(bare)
        if query is None and (shorter := _RANKS.sub("", bare)) != bare:
            bare = shorter
            query = thing(bare)
        if query is None:
            inner = names_in(bare, thing)
            whole = (
                bool(inner) and (bare.partition(inner[0])[2].split() or ["on"])[0] in _BEHIND_NAMES
            )  # no "toy train"
            bare = inner[0] if whole else bare
            query = thing(bare) if whole else None
        if query is None or query.last or query in found.values():
            continue
        found[re.sub(r"^(?:this|that|a|an|our|my|your) ", "the ", bare)] = query
    return tuple(found), tuple(found.values())


def _goals(words: Sequence[str], spans: Sequence[Span], text: Callable[[Span], str], thing: Thing) -> Iterator[Goal]:
    seen = list[Query]()
    for span in spans:
        name = text(span)
        if span[0] != "y" or _JUST_EVENT.match(name):
            continue
        inside = re.match(
            r"^(?:(?:over|all the way|right|straight) )?(?:to|next to|towards?|beside|by|near|on ?to|on|against|"
            r"off|from) (?=the |its |my |our )",
            name,
        )
        before = " ".join(words[max(0, span[1] - 3) : span[1]]) if inside is None else inside[0].strip()
        name = name if inside is None else name[inside.end() :]
        query = thing(name) or IT
        if query in seen:
            continue
        seen.append(query)
        way = _PLACES.search(before)
        yield Goal(
            re.sub(r"^(?:this|that|a|an|our|my|your) ", "the ", name), query,
            "" if way is None else "from" if way["source"] else "on" if way["on"] else "to",
        )  # fmt: skip


_HALFWAY = re.compile(r"\b(?:half ?way|mid ?way|mid(?: |-)?point|mid [a-z]+|middle of (?:the |its |his )?way)\b")


_OWN = re.compile(  # where something is anyway: "back into its frame", "to where it lay"
    r"^(?:its|his|her|their|where) .+$|^the (?:original|initial|starting|old|first|start|former|same|very) .+$|"
    r"^(?:the )?start(?:ing)? (?:position|point|spot|place)$|^(?:the )?(?:frame|origin|housing|carcass|slot|jamb)$"
)
_GROUP = re.compile(  # "the three of them", "all three", "the whole lot"
    r"^(?:all |both |every |each |the )*(?:(?:whole )?(?:lot|bunch|trio|row|set|gang|cast)|"
    r"(?:one|two|three|four|five|all|both)(?: of (?:them|those|these))?)$"
)
_STAYS_THERE = ("open", "close", "begin", "stay", "still", "pause", "halt", "return", "amount", "speed", "reverse")


def _is_own(name: str, kind: str) -> bool:
    """Whether a place is where something of a kind of wish is, or comes back to, anyway."""
    return kind in _STAYS_THERE and _OWN.match(name) is not None
