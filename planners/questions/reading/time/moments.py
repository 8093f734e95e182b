"""Reads of which time a question asks: "at 2 s", "in the first two seconds", "at the end", "while the door opens"."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from .....gaussians import late_re as re

Kind = Literal["at", "span", "in", "after", "last", "start", "end", "middle", "always", "ever", "clause"]

_NUMBERS = "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen"
_ONES = {word: float(i) for i, word in enumerate(_NUMBERS.split())}
_HALVES = {"half a": 0.5, "a half": 0.5, "half": 0.5, "a quarter of a": 0.25, "a": 1.0, "three quarters of a": 0.75}
_WORD = "|".join(sorted((*_ONES, *_HALVES), key=len, reverse=True))
NUMBER = rf"(?:\d+(?:\.\d+)?|\.\d+|(?:{'|'.join(_ONES)})(?: and a half| point (?:{'|'.join(_ONES)}))?|{_WORD})"
SECONDS = r"(?:seconds?|secs?|s|sec\.)"
_CLIP = (
    r"(?:(?:the|this|that) )?(?:\w+ second )?(?:clip|video|film|movie|scene|shot|recording|animation|sequence|take|"
    r"footage|simulation|timeline|play|whole thing|run)"
)
_OF_CLIP = rf"(?: (?:of|in|into) {_CLIP})?"
_CONJ = (
    r"when|while|whilst|as soon as|as|once|(?:right |just |shortly |directly |immediately )?after|"
    r"(?:right |just |shortly |directly |immediately )?before|until|till|during|by the time|the moment|"
    r"at the moment(?: when)?|at the time(?: when)?|prior to|following|upon"
)


@dataclass(frozen=True)
class When:
    """A time or a span of time, as said.

    Attributes:
        kind: "at" `start`; a "span" from `start` to `stop`; "in" `start` seconds; "after" `start`; the "last" `start`
            seconds; the "start", "middle" or "end" of the scene; "always" or "ever" in it; a "clause".
        start, stop: seconds.
        conj: of a clause: "when", "once", "while", "before", "after" or "until"; "by" of a span up to a time.
        clause: its words behind the conjunction.
    """

    kind: Kind
    start: float = 0.0
    stop: float = 0.0
    conj: str = ""
    clause: str = ""


def seconds(said: str) -> float:
    """A number in digits or words: "1.5", "two and a half", "half a"."""
    if re.fullmatch(r"\d*\.?\d+", said):
        return float(said)
    if said in _HALVES:
        return _HALVES[said]
    whole, _, rest = said.partition(" ")
    more = 0.5 if rest == "and a half" else _ONES[rest.removeprefix("point ")] / 10 if rest else 0.0
    return _ONES[whole] + more


CLIP_EDGE = re.compile(
    rf"(?:the )?(?:very )?(?:(?P<end>end|finish)|start|beginning)(?: of {_CLIP})?|{_CLIP} "
    r"(?:(?P<ends>ends?|is over|stops?)|starts?|begins?)"
)
Make = Callable[[re.Match[str]], When]


def _at(m: re.Match[str]) -> When:
    return When("at", seconds(m["a"]))


def _span(m: re.Match[str]) -> When:
    return When("span", seconds(m["a"]), seconds(m["b"]))


def _until(m: re.Match[str]) -> When:
    return When("span", 0.0, seconds(m["a"]))


def _plain(kind: Kind) -> Make:
    return lambda _: When(kind)


_A, _B = rf"(?P<a>{NUMBER})", rf"(?P<b>{NUMBER})"
_TIMES: tuple[tuple[re.Pattern[str], Make], ...] = tuple(
    (re.compile(pattern), make)
    for pattern, make in (
        (rf"\b(?:from|between)(?: second| t =)? {_A}(?: {SECONDS})? (?:to|and|until|till)(?: second)? {_B}(?: "
         rf"{SECONDS})?"
         rf"(?= |$)", _span),
        (rf"\b(?:in|during|for|over|within|throughout) (?:the |its |their )?(?:first|initial) {_A} {SECONDS}(?= |$)",
         _until),
        (r"\b(?:in|during|for|over|within) (?:the |its |their )?(?:first|initial) (?:second|sec)(?= |$)",
         lambda _: When("span", 0.0, 1.0)),
        (rf"\b(?:in|during|for|over|within) (?:the |its )?(?:last|final) {_A} {SECONDS}{_OF_CLIP}(?= |$)",
         lambda m: When("last", seconds(m["a"]))),
        (rf"\b(?:in|during|for|over|within) (?:the |its )?(?:last|final) (?:second|sec){_OF_CLIP}(?= |$)",
         lambda _: When("last", 1.0)),
        (rf"\bby(?: the)?(?: {_A} {SECONDS}| second {_B})(?: mark)?(?= |$)",
         lambda m: When("span", 0.0, seconds(m["a"] or m["b"]), conj="by")),
        (rf"\b(?:before|until|till|up to|within)(?: the)?(?: {_A} {SECONDS}| second {_B})(?: mark)?"
         rf"(?: (?:had|has|have|is|are) (?:passed|elapsed|over|up|gone))?(?= |$)",
         lambda m: When("span", 0.0, seconds(m["a"] or m["b"]))),
        (rf"\b(?:after|from|since|past)(?: the)?(?: {_A} {SECONDS}| second {_B})(?: mark| on| onwards?)?{_OF_CLIP}(?= "
         rf"|$)",
         lambda m: When("after", seconds(m["a"] or m["b"]))),
        (rf"\b(?:at|on|around|about|@)(?: exactly| about| around| roughly| the| time| t =| t| =)* {_A}"
         rf"(?: {SECONDS})(?: mark)?(?: in)?{_OF_CLIP}(?= |$)", _at),
        (rf"\b(?:at|on|in)(?: exactly| about| around| the| time)* (?:second|t =|t|sec) {_A}{_OF_CLIP}(?= |$)", _at),
        (rf"\b(?:at|@)(?: exactly| about| around| time)* {_A}(?= ?,|$)", _at),
        (rf"\bin {_A} {SECONDS}(?= |$)", lambda m: When("in", seconds(m["a"]))),
        (rf"\bt = {_A}(?: {SECONDS})?(?= |$)", _at),
        (rf"\b{_A} {SECONDS} (?:in|into it|into {_CLIP}|after the (?:start|beginning){_OF_CLIP}|later)(?= |$)", _at),
        (rf"\bby (?:the )?(?:half ?way(?: point| mark)?|midpoint|middle){_OF_CLIP}(?= |$)",
         lambda m: When("middle", conj="by")),
        (rf"\bat (?:the )?(?:half ?way(?: point| mark)?|midpoint|middle){_OF_CLIP}(?= |$)|"
         rf"\bhalf ?way through(?: {_CLIP})?(?= (?!its |the |his |her )|$)|"
         rf"\bin the middle of {_CLIP}(?= |$)", _plain("middle")),
        (rf"\b(?:right |just )?(?:at|in|from|on) (?:the )?(?:very )?(?:start|beginning|outset){_OF_CLIP}(?= (?!to )|$)|"
         r"\b(?:initially|originally|to begin with|to start with|at first|in the first frame|immediately|right away|"
         r"straight away|(?<!all )at once|instantly)(?= |$)", _plain("start")),
        (rf"\b(?:when|once|by the time|as|until) {_CLIP} (?:ends?|finishes|is over|stops|is done)(?= |$)",
         _plain("end")),
        (rf"\b(?:right |just )?(?:at|in|by|until|till|to) (?:the|its) (?:very )?(?:end|finish|close){_OF_CLIP}(?= |$)|"
         rf"\b(?:finally|eventually|ultimately|afterwards|afterward|at last|in the last frame|in the final frame|"
         rf"when (?:it|everything|all) is over|after everything|after it all)(?= |$)", _plain("end")),
        (rf"\b(?:(?:for |during )?(?:the|this) (?:whole|entire|full) (?:time|clip|video|film|scene|shot|recording|"
         rf"duration|{NUMBER} {SECONDS})|all the time|all the way through|throughout(?: {_CLIP})?|always|at all times|"
         rf"from (?:the )?(?:start|begin) to (?:the )?(?:end|finish)|from (?:the )?beginning to (?:the )?end|"
         rf"constantly|all "
         rf"along|"
         rf"for all {NUMBER} {SECONDS}|the (?:whole|entire|full) way through)(?= |$)", _plain("always")),
        (rf"\b(?:at any (?:time|point|moment|stage)|at some (?:time|point|moment|stage)|sometimes?|ever|at one point|"
         rf"over (?:the )?time|(?:during|in|over|within) {_CLIP}|along the way|in total|altogether|overall|"
         rf"at all|(?:on|along) (?:the|its|their) way(?: (?:to|towards) the \w+)?|as time (?:goes (?:by|on)|"
         rf"passes))(?= |$)", _plain("ever")),
    )
)  # fmt: skip
_CONJUNCTION = re.compile(rf"(?<= )(?P<conj>{_CONJ})(?= )")
_CLAUSE_FIRST = re.compile(rf"^(?P<conj>{_CONJ}) (?P<clause>.+?) , (?P<main>.+)$")


def without_time(said: str) -> tuple[When | None, str]:
    """What words say of the time, and the words without it; None if they say nothing of it."""
    for pattern, make in _TIMES:
        if found := pattern.search(said):
            rest = f"{said[: found.start()]} {said[found.end() :]}"
            return make(found), re.sub(r"(?: ?,)* +", " ", rest.replace(" , ,", " ,")).strip(" ,")
    return None, said


_MAIN = re.compile(r"(?:do|does|did|is|are|was|were|has|have|had|will|would|can|the)\b")


_AT_FIRST = re.compile(rf"at {NUMBER}(?: {SECONDS})?(?= )")


def is_main(said: str) -> bool:
    """Whether words begin as a clause does: "does the door ...", "is it ..."."""
    return _MAIN.match(said) is not None and not said.startswith("the ")


def time_first(said: str, asking: re.Pattern[str]) -> str:
    """A question that begins with its time ("at 3 s , is it open") with the time behind the rest."""
    for pattern in (_AT_FIRST, *(row for row, _ in _TIMES)):
        if (found := pattern.match(said)) is not None:
            rest = said[found.end() :].strip(" ,")
            if rest and (asking.match(rest) or _MAIN.match(rest)):
                return f"{rest} {found.group()}"
    if (clause := _CLAUSE_FIRST.match(said)) is not None:
        return f"{clause['main']} {clause['conj']} {clause['clause']}".strip(" ,")
    return said


def clauses(said: str) -> Iterator[tuple[When, str]]:
    """Each way of dividing words into a clause of time and the rest: "where is it , when the ball stops"."""
    if found := _CLAUSE_FIRST.match(said):
        yield When("clause", conj=conjunction(found["conj"]), clause=found["clause"].strip(" ,")), found["main"]
    for found in _CONJUNCTION.finditer(said):
        main, clause = said[: found.start()].strip(" ,"), said[found.end() :].strip(" ,")
        if (
            main
            and clause
            and not said[: found.start()].endswith(" at")
            and without_time(said[found.start() :].strip())[1]
        ):
            yield When("clause", conj=conjunction(found["conj"]), clause=clause), main


def conjunction(said: str) -> str:
    """A conjunction by its sense: "when", "while", "before", "after" or "until"."""
    last = said.split()[-1]
    if said == "by the time":
        return "by"
    if said in ("prior to",) or last == "before":
        return "before"
    if last in ("after", "following"):
        return "after"
    if last == "once":
        return "once"
    if last in ("until", "till"):
        return "until"
    return "while" if last in ("while", "whilst", "during", "as") and said != "as soon as" else "when"
