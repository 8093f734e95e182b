"""Times in numbers: "from 1 to 3 s", "after two seconds", "in half a second", "at t = 2", "for the last second".

A phrase is cut out of the words of a sentence; what it says is kept as a `Moment`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from ....gaussians import late_re as re
from ..vocabulary.quantities import NUMBERS

End = float | Literal["middle", "end"]  # seconds, or a place in the time of the scene

SLOW, BRIEF = 4.0, 0.6  # seconds of a movement that is told to be slow, or quick
LITTLE_BY_LITTLE = 2.0  # seconds of a look that changes slowly


@dataclass(frozen=True)
class Moment:
    """What a sentence says of time in numbers.

    Attributes:
        start, stop: as `When` has them.
        lasting: seconds that it takes or holds.
        taken: whether `lasting` is how long a change takes ("in two seconds") and not how long it holds ("for two").
        slowly: whether it is to change little by little.
        always: whether it says that it holds at all times.
        own: whether it is to be when the thing moves anyway ("instead of to the wall").
        said: the words that were cut.
    """

    start: End | None = None
    stop: End | None = None
    lasting: float | None = None
    taken: bool = False
    slowly: bool = False
    quickly: bool = False
    always: bool = False
    own: bool = False
    said: tuple[str, ...] = ()

    @property
    def told(self) -> bool:
        """Whether it says when, how long, or that it is to be slow."""
        return self.slowly or self.own or not (self.start is None and self.stop is None and self.lasting is None)

    @property
    def empty(self) -> bool:
        return self == Moment(always=self.always, said=self.said)


_UNIT = r"(?:seconds?|secs?|s)\b"
_ONES = "|".join(sorted((w for w in NUMBERS if NUMBERS[w] < 61), key=len, reverse=True))
_WORD = rf"(?:(?:{_ONES})(?: (?:{_ONES}))?|a couple of|couple of|a few|a|an)"
_DIGITS = r"\d+(?:[.,]\d+)?"
_HALVES = r"(?:a half|half|a quarter|three quarters|one and a half|a)"
_HEDGE = (
    r"(?:(?:like|about|around|exactly|precisely|just|roughly|only|approximately|some|the|full|good|whole|first|same|"
    r"say) )*"
)
_NUMBER = rf"(?:{_DIGITS}|{_WORD})"
_DURATION = (
    rf"(?:{_NUMBER} and (?:a |three )?(?:half|quarters?) {_UNIT}|"
    rf"{_NUMBER} {_UNIT} and (?:a |three )?(?:half|quarters?)|(?:{_NUMBER} and )?(?:a )?half (?:a |of a )?{_UNIT}|"
    rf"three quarters (?:of )?a {_UNIT}|(?:a |one )?quarter (?:of )?(?:a |one )?{_UNIT}|"
    rf"(?:a |one )?(?:third|fifth|tenth) (?:of )?a {_UNIT}|(?:a|one) (?:tenth|fifth) (?:of )?{_UNIT}|"
    rf"(?:{_ONES}) (?:thirds|quarters|fifths|tenths|hundredths) of (?:an? |one )?{_UNIT}|"
    rf"{_NUMBER} (?:full |whole )?{_UNIT}|half a {_UNIT})"
)
DURATION = rf"(?:{_HEDGE}{_DURATION})"
_MARK = r"(?: mark| point)?"
_NAMED: dict[str, End] = {
    "start": 0.0,
    "beginning": 0.0,
    "outset": 0.0,
    "end": "end",
    "finish": "end",
    "middle": "middle",
    "halfway": "middle",
}
_CLIP = r"(?:clip|film|video|animation|shot|sequence|movie|time|recording|footage|take|playback|spot|advert|ad)"
_NAME = (
    rf"(?:(?:the )?(?:very )?(?:start|beginning|outset|end|finish)(?: of (?:the |this )?(?:scene|"
    rf"{_CLIP}))?|(?:the )?middle of (?:the |this )?{_CLIP})"
)
_STAMP = rf"(?:the )?(?:t|time|second|sec|seconds) ?=? ?{_NUMBER}(?: {_UNIT})?"
_NUMERIC = rf"(?:(?:{_STAMP}|(?:the )?{_HEDGE}{_DURATION}){_MARK})"
_POINT = rf"(?:{_NUMERIC}|{_NAME})"
_BARE = rf"(?:{_POINT}|{_DIGITS}|(?:{_ONES}))"
_TO = r"(?:to|until|till|til|and|up to|through|thru|-|through to|untill)"
_ALWAYS = (
    rf"(?:(?:(?:for|during|over|through|in|,) (?:(?:the )?(?:whole|entire|full|complete)|all (?:of )?the) (?:scene|"
    rf"thing|{_CLIP})|"
    r"(?:for |during |over |through )?(?:the )?(?:whole|entire|full) time)|"
    rf"all the time|all through|throughout(?: the (?:whole |entire )?(?:scene|{_CLIP}))?|always|permanently|"
    r"forever|for ever|constantly|"
    r"from (?:the )?(?:start|beginning) to (?:the )?(?:end|finish)|at all times|the whole way(?: "
    r"through)?|the entire time)"
)
_SLOWLY = (
    r"(?:slowly|gradually|little by little|bit by bit|step by step|smoothly|gently|steadily|over time|ever so slowly)"
)
_QUICKLY = r"(?:quickly|rapidly|swiftly|in no time)"


_HEDGED = re.compile(rf"^{_HEDGE}")
_UNITED = re.compile(rf" ?(?:full |whole )?{_UNIT}.*$")
_SPAN = re.compile(rf"^{_HEDGE}{_DURATION}$")
_SHARES = {"thirds": 3, "quarters": 4, "fifths": 5, "tenths": 10, "hundredths": 100}
_PARTS = re.compile(rf"^(?P<count>{_ONES}) (?P<share>{'|'.join(_SHARES)}) of\b")
_AT_TIME = re.compile(rf"{_UNIT}|\b(?:t|sec|time|start|beginning|end|middle|halfway)\b")


def _value(text: str) -> float | None:
    """Seconds that a number or a duration names."""
    text = re.sub(r"^second(?= and a half$)", "one second", _HEDGED.sub("", text.strip()))
    text = re.sub(r"^(?:the )?(?:t|time|seconds?|sec)\b(?: ?= ?| )(?=\w)", "", text)
    text = re.sub(r" (?:mark|point)$", "", text)
    if (shares := _PARTS.match(text)) is not None:
        return NUMBERS[shares["count"]] / _SHARES[shares["share"]]
    half = 0.0
    if (quarters := re.search(r" and (?:an? )?(?P<three>three )?quarters?\b", text)) is not None:
        half, text = 0.75 if quarters["three"] else 0.25, text.replace(quarters[0], "")
    elif re.search(r" and (?:a )?half\b", text):
        half, text = 0.5, re.sub(r" and (?:a )?half\b(?: (?:a|of a))?", "", text)
    if re.match(r"^(?:a )?half\b", text):
        return 0.5 + half
    for word, part in (("third", 1 / 3), ("fifth", 0.2), ("tenth", 0.1)):
        if re.match(rf"^(?:(?:a|one) {word}|{word} (?:of )?a)\b", text):
            return part
    if re.match(r"^three quarters", text):
        return 0.75
    if re.match(r"^(?:a |one )?quarter", text):
        return 0.25
    number = _UNITED.sub("", text).strip()
    if re.fullmatch(_DIGITS, number):
        return float(number.replace(",", ".")) + half
    if number in ("a", "an", ""):
        return 1.0 + half
    if number in ("a couple of", "couple of"):
        return 2.0
    if number == "a few":
        return 3.0
    parts = number.split()
    if parts and all(p in NUMBERS for p in parts):
        return float(sum(NUMBERS[p] for p in parts)) + half
    return None


def seconds_of(said: str) -> float | None:
    """Seconds that words name if they name a duration and nothing else."""
    return _value(said) if _SPAN.match(said) else None


def _end(text: str) -> End | None:
    for name, end in _NAMED.items():
        if re.search(rf"\b{name}\b", text):
            return end
    return _value(text)


Made = Callable[[Moment, "re.Match[str]"], Moment | None]


def _range(moment: Moment, found: re.Match[str]) -> Moment | None:
    start, stop = _end(found["a"]), _end(found["b"])
    if moment.start is not None or moment.stop is not None:
        return None  # "hide the shelf from 1 to 2 s and the bed from 2 to 3 s"
    if start is None or stop is None or (isinstance(start, float) and isinstance(stop, float) and stop <= start):
        return None
    return replace(moment, start=None if start == 0.0 else start, stop=None if stop == "end" else stop)


def _start(moment: Moment, found: re.Match[str]) -> Moment | None:
    start = _end(found["a"])
    return None if start is None or moment.start is not None else replace(moment, start=start)


def _at_once(moment: Moment, found: re.Match[str]) -> Moment | None:
    return None if moment.start is not None else replace(moment, start=0.0)


def _stop(moment: Moment, found: re.Match[str]) -> Moment | None:
    stop = _end(found["a"])
    if stop is None or stop == 0.0 or moment.stop is not None:
        return None
    return replace(moment, stop=None if stop == "end" else stop, always=moment.always or stop == "end")


def _holds(moment: Moment, found: re.Match[str]) -> Moment | None:
    value = _value(found["a"])
    return None if not value or moment.lasting is not None else replace(moment, lasting=value)


def _takes(moment: Moment, found: re.Match[str]) -> Moment | None:
    made = _holds(moment, found)
    return None if made is None else replace(made, taken=True)


def _first(moment: Moment, found: re.Match[str]) -> Moment | None:
    value = _value(found["a"])
    return None if not value or moment.stop is not None else replace(moment, stop=value)


def _last(moment: Moment, found: re.Match[str]) -> Moment | None:
    value = _value(found["a"])
    return None if not value or moment.start is not None else replace(moment, start=-value)


_OVER, _OF_CLIP = r"(?:for |during |in |over |within )?(?:the )?", rf"(?: of (?:the |this )?{_CLIP})?"
_PHRASES: tuple[tuple[str, Made], ...] = (
    (rf"{_OVER}(?:first|opening) (?P<a>{_DURATION}|second and a half|second)(?! later){_OF_CLIP}", _first),
    (rf"{_OVER}(?:last|final) (?P<a>{_DURATION}|second){_OF_CLIP}", _last),
    (rf"(?:from|starting (?:at|from)) (?P<a>{_BARE}) ?{_TO} (?P<b>{_BARE})", _range),
    (rf"(?:in )?between (?P<a>{_BARE}) ?{_TO} (?P<b>{_BARE})", _range),
    (rf"(?!an? )(?P<a>{_NUMERIC}|{_DIGITS}) ?{_TO} (?P<b>{_POINT})", _range),
    (rf"(?P<a>t ?=? ?{_DIGITS}) ?{_TO} (?P<b>{_BARE})", _range),
    (
        rf"(?:from|starting(?: at| from)?|beginning(?: at| from)?|as of|since|as from) "
        rf"(?P<a>{_POINT})(?: (?:on|onwards?|and on))?",
        _start,
    ),
    (
        rf"(?:only )?(?:after|past|following) (?P<a>{_POINT})(?: (?:have passed|has passed|is over|are "
        rf"over|are up))?",
        _start,
    ),
    (
        rf"(?P<a>{_DURATION}) (?:into (?:it|the (?:clip|scene|film|video|animation))|in|from the "
        rf"start)\b(?! (?:the|a|to))",
        _start,
    ),
    (
        rf"(?:at|@|on(?= (?:the )?[\w. ]+ mark\b)|when (?:it is|the time is|time is|t is)) (?:around |about |exactly "
        rf")*(?P<a>{_POINT})(?: (?:on|onwards?))?",
        _start,
    ),
    (rf"(?:only )?(?:until|till|til|untill|up to|up until|before|(?<!back )(?<!forward )by) (?P<a>{_POINT})", _stop),
    (rf"(?:at|after) (?P<a>{_DIGITS})", _start),
    (rf"(?:until|till) (?P<a>{_DIGITS})", _stop),
    (rf"(?:for|lasting) (?:the (?:next )?)?(?P<a>{_HEDGE}{_DURATION})(?: long| only)?", _holds),
    (
        rf"(?:so (?:that )?(?:it|this|that|\w+ing) (?:takes|lasts)|which takes|and take|taking|takes) "
        rf"(?P<a>{_HEDGE}{_DURATION})",
        _takes,
    ),
    (
        rf"(?:, )?(?:in|over|within|across|inside|during|in the space of|over the course of|in the "
        rf"course of|within the space of|"
        rf"in the span of|over a (?:span|period) of) (?P<a>{_HEDGE}{_DURATION})(?: time| flat)?"
        r"(?! (?:later|earlier|sooner)\b)",
        _takes,
    ),
    (
        r"(?:at|by) (?P<a>the (?:very )?(?:end|start|beginning)|halfway|half time|the middle)(?: of "
        r"it| through| point)?(?! (?:down|up|there|across|along|to|open)\b)",
        _start,
    ),
    (
        r"(?:(?:from|at|in) the (?P<a>first) (?:moment|frame|instant)|immediately|right away|straight away|"
        r"instantly)",
        _at_once,
    ),
    (
        r"(?P<a>halfway) (?:through|in)(?! (?:its|his|her|their|(?:the )?[a-z]+ing)\b)"
        r"(?: (?:it|the (?:clip|scene|film|video|animation)))?",
        _start,
    ),
)
_COMPILED = tuple((re.compile(rf"(?:^|(?<= )){pattern}(?= |$)"), made) for pattern, made in _PHRASES)
OWN = "in its own time"  # what `restated` makes of "instead of to the wall"
_ADVERBS = (
    (re.compile(rf"(?:^|(?<= )){OWN}(?= |$)"), "own"),
    (re.compile(rf"(?:^|(?<= )){_ALWAYS}(?= |$)"), "always"),
    (re.compile(rf"(?:^|(?<= ))(?<!more )(?<!less )(?<!too )(?<!as )(?<!very ){_SLOWLY}(?= |$)"), "slowly"),
    (re.compile(rf"(?:^|(?<= )){_QUICKLY}(?= |$)"), "quickly"),
)
TIMED = re.compile(rf"\b(?!an? second\b){_DURATION}|\b(?:\d+ ?{_UNIT}|(?:t|second|sec) ?=? ?\d)")


def cut(said: str) -> tuple[str, Moment]:
    """The words of a sentence without those that name times in numbers, and what those say.

    >>> cut("hide the vase from 1 to 3 s")
    ('hide the vase', Moment(start=1.0, stop=3.0, ..., said=('from 1 to 3 s',)))
    """
    moment = Moment()
    for _ in range(4):
        for pattern, made in _COMPILED:
            found = next((m for m in pattern.finditer(said) if _fits(said, m)), None)
            if found is None:
                continue
            changed = made(moment, found)
            if changed is None:
                continue
            moment = replace(changed, said=(*moment.said, found[0]))
            said = _without(said, found)
            break
        else:
            break
    for pattern, name in _ADVERBS:
        if (found := pattern.search(said)) is not None:
            moment = replace(moment, **{name: True}, said=(*moment.said, found[0]))
            said = _without(said, found)
    return said, moment


def _fits(said: str, found: re.Match[str]) -> bool:
    """Whether a phrase names a time: bare numbers do only where a unit, or "from", stands with them."""
    text = found[0]
    after = said[found.end() :].strip().split(" ")[0]
    if after == "of" or (
        re.search(r"\ba second$", text) and after not in ("", ",", ".", "and", "then", "later", "it", "while", "when")
    ):
        return False  # "at the end of the bed", "a second lamp"
    if text in ("immediately", "right away", "straight away", "instantly"):
        return after in ("", ",", ".", "and", "then")
    if "=" in text or _AT_TIME.search(text):
        behind = said[found.end() :].strip().split(" ")[0]
        return behind not in ("chair", "one", "of") or "second" not in text
    behind = said[found.end() :].strip().split(" ")[0]
    begins = text.startswith(("from", "between", "in between", "at ", "until ", "till ", "after "))
    return begins and behind in ("", ",", ".", "then", "and", "instead")


def _without(said: str, found: re.Match[str]) -> str:
    left = said[: found.start()].rstrip(" ,")
    right = said[found.end() :].lstrip()
    right = right.lstrip(", ") if not left else right
    return " ".join(f"{left} {right}".split())
