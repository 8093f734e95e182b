"""Times told by what happens: "while it is on the rug", "once the fan stops", "until the ball reaches the wall".

A clause is cut out of the words of a sentence if the whole of it says that something is so, begins or ends.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

from ....gaussians.language.query.query import Query
from ....tools.when import During, Part

Thing = Callable[[str], Query | None]  # what a phrase for things means, None if it means none

IT = Query(last=True)


@dataclass(frozen=True)
class Happening:
    """What is told of, and the words of the clause.

    Attributes:
        during: with `of` as it was said; `IT` for a pronoun.
        said: the clause.
    """

    during: During
    said: str


_WHILE = (
    r"(?:while|whilst|as long as|so long as|whenever|during the time|for as long as|the whole time|all the time|as)"
)
_ONCE = (
    r"(?:once|when|as soon as|the moment|the instant|the second|at the moment when|at the moment|"
    r"immediately when|right when|from when|from the moment|exactly when|directly when)"
)
_AFTER = r"(?:(?:right |just |only |directly |immediately )?after)"
_UNTIL = r"(?:until|till|til|up until|up to when|before|by the time|right before|just before|right until|only until)"
_CONJUNCTION = re.compile(rf"(?:^|(?<= ))(?:only |but only |just )?(?P<word>{_ONCE}|{_WHILE}|{_AFTER}|{_UNTIL})(?= )")

_PRONOUNS = ("it", "he", "she", "they", "that", "this")
_PEOPLE = re.compile(r"^(?:i|we|you|people|guests?|everyone|someone|somebody|my .*|anyone|nobody|there)\b")

_MOVE = (
    "move|roll|walk|drive|slide|turn|spin|rotate|run|swing|fly|glide|travel|go|bounce|rise|climb|revolve|whirl|float|"
    "come|wander|march|swivel|step|act|work|operate|play"
)
_FALL = "fall|drop|tumble|plunge|sink"
_OPEN = "open|close|shut"
_ANY = f"{_MOVE}|{_FALL}|{_OPEN}"
_WALKING = {"run": "running", "spin": "spinning", "swing": "swinging", "drop": "dropping", "drive": "driving",
            "slide": "sliding", "move": "moving", "rotate": "rotating", "rise": "rising", "glide": "gliding",
            "bounce": "bouncing", "close": "closing", "shut": "shutting", "revolve": "revolving", "tumble": "tumbling",
            "come": "coming", "plunge": "plunging", "operate": "operating", "step": "stepping"}  # fmt: skip


def _ing(stems: str) -> str:
    return "|".join(_WALKING.get(w, f"{w}ing") for w in stems.split("|"))


def _third(stems: str) -> str:
    return "|".join(f"{w}{'es' if w in ('go',) else 's'}?" for w in stems.split("|"))


_PAST = (
    "moved|rolled|walked|driven|drove|slid|turned|spun|rotated|swung|flown|flew|gone|went|fallen|"
    "fell|dropped|opened|closed|"
    "shut|landed|arrived|stopped|finished|ended|risen|come|came|bounced"
)
_IS = (
    r"(?:(?:is|are|was|were|has been|have been|s)(?: still| already| now| just| really| actually)*|"
    r"gets?|goes|stays?|remains?)"
)
_TO = r"(?:on to|onto|to|at|into|up to|in|on)"
_TOUCH = (
    r"(?:(?:has |have )?(?:touche[sd]?|touch|hits?|hit|reach(?:e[sd])?|strikes?|struck|meets?|met|"
    r"bumps? (?:into|against)|bumped (?:into|against)|"
    r"crash(?:es|ed)? (?:into|against)|collides? with|collided with|knocks? (?:into|against)|"
    r"(?:arrives?|arrived|gets?|got|gotten|comes?|came|makes it|made it|runs?|rolls?|rolled|walks?|"
    r"walked) (?:at|to|up to|against|over to|as far as)|"
    r"lands? (?:on|in)|landed (?:on|in)|contacts?))"
)
_TOUCHING = r"(?:touching|in contact with|hitting|against|up against|resting against|bumping into|bumping against)"
_LEAVE = (
    r"(?:(?:has |have )?(?:leaves?|left|(?:is |are |gets? |got |rolls? |rolled |moves? |moved |comes? "
    r"|came |goes |falls? |fell |fallen |drives? |walks? |steps? )"
    r"(?:off|off of|away from|out of|down from|clear of))|is no longer (?:on|in|touching)|is off|has left|exits?)"
)
_ENTER = (
    r"(?:(?:gets?|got|goes|rolls?|rolled|moves?|moved|drives?|walks?|comes?|came|slides?|steps?|runs?|"
    r"jumps?|climbs?) (?:on to|onto|into|in)|"
    r"enters?|entered|(?:gets?|rolls?|is) (?:on|in)|steps? on|lands? on)"
)
_START = (
    r"(?:starts?|begins?|started|began|has started|has begun|sets? off|takes? off|gets? going|"
    r"gets? moving|sets? out|start to|begin to)"
)
_STOP = (
    r"(?:(?:has |have )?(?:stops?|stopped|ends?|ended|finishe[sd]|finish|halts?|halted|come(?:s)? to "
    r"(?:a )?(?:rest|stop|halt|standstill)|came to (?:a )?(?:rest|stop|halt|standstill)|"
    r"stands? still|stood still|is done|are done|has arrived|arrives?|arrived|comes? to rest|settles?|"
    r"settled|lands?|landed|freezes?|rests?)"
    r"(?: (?:moving|turning|rolling|walking|spinning|running|falling|opening|swinging|sliding|driving|"
    r"rotating|its \w+|\w+ing))?)"
)
_FULLY = r"(?:fully |completely |all the way |wide |entirely |totally |right )"


@dataclass(frozen=True)
class _Predicate:
    pattern: re.Pattern[str]
    state: str
    once: Part  # behind "when" and "once"
    through: Part  # behind "while"
    before: Part  # behind "until" and "before"
    after: Part = "after"


def _predicates() -> Iterator[_Predicate]:
    def made(pattern: str, state: str, once: Part, through: Part, before: Part, after: Part = "after") -> _Predicate:
        return _Predicate(re.compile(rf"^(?P<who>.+?) (?:then )?{pattern}$"), state, once, through, before, after)

    yield made(rf"{_START}(?: (?:to )?(?:{_FALL}|{_ing(_FALL)}))", "falling", "from", "from", "until", "from")
    yield made(
        rf"{_START}(?: (?:to )?(?:{_ANY}|{_ing(_ANY)}|its \w+))?(?: (?:to )?\w+)?",
        "moving",
        "from",
        "from",
        "until",
        "from",
    )
    yield made(
        rf"(?:{_IS} (?:{_FULLY})(?:open|opened|out)|(?:has|have) (?:{_FULLY})?(?:opened|come out))",
        "moving",
        "after",
        "after",
        "until_end",
    )
    yield made(rf"{_IS} open(?:ed)?(?: (?:all the way|fully|completely|wide))", "moving", "after", "after", "until_end")
    yield made(
        rf"(?:{_IS} (?:not closed|not shut|open|opened|ajar|out|pulled out))", "open", "while", "while", "until", "from"
    )
    yield made(rf"(?:{_IS} (?:not open|closed|shut))", "open", "unless", "unless", "until_end", "after")
    yield made(
        rf"(?:has|have|is|are|s)? ?(?:completely |finally |fully |all )*(?:{_PAST})(?: down| over| "
        rf"away| past| by| off)?",
        "moving",
        "after",
        "after",
        "until_end",
    )
    yield made(rf"{_STOP}", "moving", "after", "after", "until_end")
    yield made(rf"{_IS} (?:{_ing(_FALL)})(?: down| off.*)?", "falling", "while", "while", "until")
    yield made(
        rf"{_IS} (?:{_ing(_ANY)}|in motion|on the move|on its way|under way|in action|active)(?: "
        rf"around| along| about| past| by| across .*| around .*)?",
        "moving",
        "while",
        "while",
        "until",
    )
    yield made(
        rf"{_IS} (?:not (?:moving|in motion|turning|spinning|rolling|walking|rotating|running)|"
        rf"(?:standing |completely |perfectly )*(?:still|stationary|motionless|at rest|resting|stopped|"
        rf"idle|parked))",
        "still",
        "while",
        "while",
        "until",
    )
    yield made(r"(?:stands|stand|sits|lies|rests|stays|keeps) still", "still", "while", "while", "until_end")
    yield made(rf"(?:{_third(_FALL)})(?: down| over| off.*)?", "falling", "from", "while", "until", "after")
    yield made(
        rf"(?:{_third(_ANY)})(?: around| along| about| again| away)?", "moving", "from", "while", "until", "after"
    )


def _touches() -> Iterator[_Predicate]:
    def made(pattern: str, state: str, once: Part, through: Part, before: Part, after: Part = "after") -> _Predicate:
        return _Predicate(
            re.compile(rf"^(?P<who>.+?) (?:then |finally |first |has |have )?{pattern} (?P<whom>.+)$"),
            state,
            once,
            through,
            before,
            after,
        )

    yield made(_LEAVE, "on", "after", "after", "until_end", "after")
    yield made(rf"{_IS} {_TOUCHING}", "touches", "while", "while", "until", "after")
    yield made(_ENTER, "on", "from", "while", "until", "from")
    yield made(_TOUCH, "touches", "from", "while", "until", "from")


_PHRASED = (
    r"(?:(?:is|are|was|s|stands?|sits?|lies|rests?|stays?|remains?|rolls?|moves?|walks?|drives?|goes|"
    r"runs?|passes|travels|slides|"
    r"is (?:rolling|moving|walking|driving|sliding|standing|sitting|lying|going|running|resting|crossing|travelling))"
    r"(?: still| currently| directly| right| just)*)"
)
_ACROSS = {
    "on": "on top of|on|upon|over|across|along|above", "inside": "inside of|inside|within|in",
    "under": "underneath|beneath|under|below",
    "next_to": "next to|beside|close to|near to|near|by|alongside|at|around", "behind": "behind|in back of",
    "in_front_of": "in front of|before", "left_of": "to the left of|left of|on the left of",
    "right_of": "to the right of|right of|on the right of",
}  # fmt: skip


@cache
def _placed() -> tuple[_Predicate, ...]:
    found = []
    for state, phrases in _ACROSS.items():
        pattern = rf"^(?P<who>.+?) {_PHRASED} (?P<no>not )?(?:{phrases}) (?P<whom>.+)$"
        found.append(_Predicate(re.compile(pattern), state, "while", "while", "until", "from"))
    found.append(
        _Predicate(
            re.compile(r"^(?P<who>.+?) (?:crosse?s|is crossing) (?P<whom>.+)$"),
            "on",
            "while",
            "while",
            "until",
            "after",
        )
    )
    return tuple(found)


@cache
def _alone() -> tuple[_Predicate, ...]:
    return tuple(_predicates())


@cache
def _together() -> tuple[_Predicate, ...]:
    return tuple(_touches())


def clause_of(word: str, said: str, thing: Thing) -> During | None:
    """What a clause behind a conjunction tells of; None if the whole of it is not understood."""
    if _PEOPLE.match(said):
        return None
    for predicate in (*_together(), *_placed(), *_alone()):
        found = predicate.pattern.match(said)
        if found is None:
            continue
        who = _who(found["who"], thing)
        if who is None:
            continue
        anchors: tuple[Query, ...] = ()
        if "whom" in found.groupdict():
            whom = _who(_plain(found["whom"]), thing)
            if whom is None:
                continue
            anchors = (whom,)
        part = _part(word, predicate)
        if part is None:
            return None
        if found.groupdict().get("no"):
            part = "unless" if part == "while" else "after"
        if who.pick == "all" and who.moving:
            who = who.model_copy(update={"text": who.text})
        return During(state=predicate.state, anchors=anchors, of=who, part=part)
    return _noun_event(word, said, thing)


_EVENTS = {
    "turn": "turning", "curve": "turning", "bend": "turning", "fall": "falling", "drop": "falling",
    "movement": "moving",
    "motion": "moving", "move": "moving", "walk": "moving", "ride": "moving", "roll": "moving", "opening": "moving",
}  # fmt: skip


def _noun_event(word: str, said: str, thing: Thing) -> During | None:
    """ "after the turn", "before its fall": an event that a noun names."""
    found = re.match(r"^(?:the|its|his|that|this|their) (?P<event>[a-z]+)(?: of (?P<who>.+))?$", said)
    state = _EVENTS.get(found["event"]) if found is not None else None
    if found is None or state is None:
        return None
    who = _who(found["who"] or "it", thing)
    if who is None:
        return None
    part: Part = "after" if re.fullmatch(_AFTER, word) else "until" if re.fullmatch(_UNTIL, word) else "while"
    return During(state=state, of=who, part=part)


def _part(word: str, predicate: _Predicate) -> Part | None:
    if re.fullmatch(_UNTIL, word):
        return predicate.before
    if re.fullmatch(_AFTER, word):
        return predicate.after
    if word == "when":
        return predicate.once
    if re.fullmatch(_ONCE, word):
        return "from" if predicate.once == "while" else predicate.once
    return predicate.through


_DETERMINED = re.compile(r"^(?:the|a|an|this|that|these|those|my|our|all|every|each|any|both|its|his|her|their)\b")


def _plain(said: str) -> str:
    return re.sub(r"(?:^| )(?:again|finally|then|already|there|completely|please)$", "", said).strip()


def _who(said: str, thing: Thing) -> Query | None:
    said = re.sub(r" (?:has|have|is|are|itself|finally|then|just|both|all|also|actually)$", "", said.strip())
    said = re.sub(r"^(?:only|just|exactly|right) ", "", said)
    if said in _PRONOUNS:
        return IT
    if not said or len(said.split()) > 7 or _PEOPLE.match(said):
        return None
    first = re.match(r"^(?:the )?(?:first|last|other) (?=\w)", said)
    if first:
        said = f"all {_plural(said[first.end() :])}"
    return thing(said)


def _plural(noun: str) -> str:
    return noun if noun.endswith("s") else f"{noun}s"


def cut(said: str, thing: Thing) -> Iterator[tuple[str, Happening]]:
    """The words of a sentence without a clause that tells a time, and what it tells; the likeliest first."""
    for found in reversed(list(_CONJUNCTION.finditer(said))):
        word, start = found["word"], found.start()
        behind = said[found.end() :].strip()
        words = behind.split(" ")
        ends = _ends(words, bool(said[:start].strip(" ,")))
        for end in ends:
            clause = " ".join(words[:end]).strip(" ,.")
            during = clause_of(word, clause, thing)
            if during is None:
                continue
            left, right = said[:start].strip(" ,"), " ".join(words[end:]).strip(" ,.")
            right = re.sub(r"^(?:then|,) ", "", right) if not left else right
            rest = f"{left} {right}".strip() if not left or not right else f"{left} , {right}"
            if rest:
                yield rest, Happening(during, f"{word} {clause}")


def _ends(words: list[str], trailing: bool) -> list[int]:
    """Where a clause may end: at the end, at a comma or a joint; without one before any word where it leads."""
    marks = [i for i, w in enumerate(words) if w in (",", "then", ".", "and", "but")]
    if trailing:
        return [len(words), *marks[::-1]]
    first = [i for i in marks if i > 1]
    return [*first, *[i for i in range(len(words) - 1, 1, -1) if i not in marks]]
