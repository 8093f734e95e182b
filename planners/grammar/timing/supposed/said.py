"""What an instruction says beside its time, without what asks for nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from ...vocabulary.quantities import NUMBERS
from ..manner import Thing
from ..moments import Moment
from .names import MOVING, named, with_moving

_PRONOUN = re.compile(r"\b(?:it|he|she|him|her|they|them)\b")
BEFORE_IT = re.compile(  # "it waits until 2 s before it sets off"
    r"\bbefore (?:it |he |she |they |\| )?(?:to )?(?:sets?|starts?|begins?|commences?|goes|going|go|rolls?|rolling|"
    r"gets? (?:going|moving|started|rolling|under way)|moves?|moving|leaves?|leaving|walks?|walking|falls?|falling|"
    r"drops?|dropping|opens?|opening|setting|starting|sliding|slides?)"
    r"(?: off| moving| rolling| going| walking| falling| to \w+| out)*"
)
_STILL_THERE = re.compile(r"\b(?:put|move|place|set|keep|leave|stay|bring|slide|push|roll)(?: \w+){0,2} $")
_AS_BEFORE = re.compile(  # ", then red again afterwards"
    r"(?: ,)? (?:and |then |but |after (?:this|that|which) |afterwards )*"
    r"(?:(?:it |make it |let it |turn it |go |goes |back |should |is |to )*)(?:[a-z]+ )?"
    r"(?:again|back|afterwards?|after that|as before|like before|as it was|as (?:usual|normal|ever)|normal(?: again)?)"
    r"(?: (?:afterwards?|then))?$"
)
_IDLE = tuple(
    re.compile(pattern)
    for pattern in (
        rf" , (?:and |but )?(?:not|instead of|rather than) (?:at |to |by )?(?:\d[\d.]*|{'|'.join(NUMBERS)})"
        r"(?: [a-z]+)?$",
        r" , (?:and |but )?not (?:before|earlier|sooner|later|any (?:earlier|sooner|later))(?: (?:that|then))?$",
        r" , (?:and |with )?(?:no|not|without) [a-z]+ing\b(?: [a-z0-9.]+){0,3}$",
        r" , (?:so )?(?:i|we) (?:just )?(?:want|like|love|need|would like|would love) to (?:see|watch|look at) "
        r"(?:it|that|this|him|her|them)(?: (?:in|on|from|at|up|properly|clearly|better) ?(?:the |my )?[a-z]*)?$",
        r"(?<= )(?:say|well|like) ,|(?: ,)? say (?=(?:from|at|for|until|between)\b)",
    )
)


@dataclass(frozen=True)
class Said:
    """What an instruction says beside its time.

    Attributes:
        text: its words.
        things: the names in it, as they stand.
        moment: its time in numbers.
        event: whether a time is told by what happens.
        thing: reads a name.
        idle: words that ask for nothing, where marks tell.
        goals: those of the names to which something goes, or beside which it is, where marks tell.
        listed: things in the order in which they are to begin, where marks tell; none if no order is told.
        unmarked: the words without a mark.
    """

    text: str
    things: tuple[str, ...]
    moment: Moment
    event: bool
    thing: Thing
    goals: tuple[str, ...] = ()
    idle: str = ""
    listed: tuple[Query, ...] = ()
    unmarked: str = ""

    @property
    def told(self) -> bool:
        """Whether any time is told."""
        return self.event or self.moment.told

    @cached_property
    def whose(self) -> Query:
        """What the first name means; "everything that moves" is not the whole scene."""
        name = self.things[0]
        moves = re.search(
            rf"\b{re.escape(name)} (?:(?:that|which|what) )?(?:(?:is|are) )?(?:moves?|moving)\b", self.text
        )
        return self.thing(MOVING if moves is not None and name == "everything" else name) or Query(last=True)

    def joined(self) -> Said:
        """The same, with the first two names as one if "and" joins them: "the table and the vase"."""
        if len(self.things) < 2:
            return self
        both = f"{self.things[0]} and {self.things[1]}"
        if not re.search(rf"(?<!\S){re.escape(both)}(?!\S)", self.text) or self.thing(both) is None:
            return self
        return replace(self, things=(both, *self.things[2:]))

    def placed(self) -> Said:
        """The same, with the first two names as one if the second only tells where the first is: "the fan on the
        ceiling"."""
        if len(self.things) < 2:
            return self
        one, other = (re.escape(name) for name in self.things[:2])
        between = "on|in|at|by|near|under|behind|beside|next to"
        found = re.search(rf"(?<!\S){one} (?:{between}) {other}(?!\S)", self.text)
        if found is None or self.thing(found[0]) is None or _STILL_THERE.search(self.text[: found.start()]):
            return self
        goals = tuple(name for name in self.goals if name != self.things[1])
        return replace(self, things=(found[0], *self.things[2:]), goals=goals)

    def until_then(self) -> Said:
        """The same, if a time is told, without words that things are as before afterwards: ", then red again"."""
        return replace(self, text=_AS_BEFORE.sub("", self.text)) if self.told else self

    @cached_property
    def beside(self) -> str:
        """The words, with a bar for each name."""
        text = self.text
        for name in self.things:
            text = re.sub(rf"(?<!\S){re.escape(name)}(?!\S)", "|", text)
        return text


def said_of(text: str, thing: Thing, moment: Moment, clause: str) -> Said:
    """What words say beside their time.

    Args:
        thing: reads a name.
        moment: the time in numbers.
        clause: the words that tell what happens then, if there are any; "it" may be what they are about.
    """
    text = with_moving(text)
    for idle in _IDLE:
        text = " ".join(idle.sub(" ", text).split())
    things = named(text, thing)
    if not things and _PRONOUN.search(text):
        things = named(clause, thing)[:1]
    return Said(text, things, moment, clause != "", thing)
