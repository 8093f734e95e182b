"""The time of an operation, from what a sentence says of it in numbers and by what happens."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.when import During, Part, When
from ..vocabulary.nouns import is_opened
from .command import Fields
from .happenings import IT, Happening
from .moments import BRIEF, LITTLE_BY_LITTLE, SLOW, End, Moment


def settled(target: Query | None, during: During) -> tuple[Query | None, During]:
    """The target and the time, with "it" in each read as what the other names."""
    of = during.of
    if target is not None and of is not None:
        if target == IT and of != IT and not of.moving:
            target, of = of, None
        elif (of == IT and target != IT) or of in (target, IT):
            of = None
    anchors = tuple(target if q == IT and target is not None else q for q in during.anchors)
    return target, during.model_copy(update={"of": of, "anchors": anchors})


def when_of(moment: Moment, during: During | None, kind: str, op: Fields) -> When | None:
    """The time of an operation; None if it holds at all times.

    Args:
        kind: as `Command` has it.
    """
    lasting, gradual = moment.lasting, False
    if kind == "look" and lasting is not None and during is not None and during.part == "while":
        during = during.model_copy(update={"part": "from"})  # "for one second, when all books are down"
    start: End | None = moment.start
    goes = kind == "path" or op.get("turns") is not None
    last = isinstance(start, float) and (start < 0 or any(map(_TO_THE_END.search, moment.said)))
    if kind == "look":
        if moment.taken or moment.slowly or op.get("gradual"):
            gradual = True
            if moment.stop is None or moment.start is None:
                lasting = lasting or LITTLE_BY_LITTLE
        if op["op"] in ("insert", "delete", "replace", "isolate", "duplicate") and moment.taken:
            gradual = False
    elif lasting is None and moment.stop is None and not (moment.always and during is not None):
        if moment.slowly and not (goes and (last or moment.always)):  # "gently, over the last two seconds"
            lasting = SLOW
        elif moment.quickly and kind == "path":
            lasting = BRIEF
    stop: End | None = None if lasting is not None else moment.stop
    if goes and last and lasting is None and stop is None:
        stop = "end"  # "in the last two seconds", "from 3 s to the end" is there at the end
    ends = during is not None and during.part in ("from", "after") and moment.always
    if kind == "path" and ends and stop is None and lasting is None:
        stop = "end"  # "by the end of the film"
    if goes and start is None and stop is None and lasting is None and during is None and moment.slowly:
        return When(stop="end")  # "slowly, over the whole film"
    if kind == "path" and start is None and stop is None and lasting is None and during is None:
        return When(stop="end" if moment.always else None)
    if start is None and stop is None and lasting is None and during is None:
        return None
    return When(start=start, stop=stop, lasting=lasting, during=during, gradual=gradual)


def closes_later(ops: Sequence[Fields], moment: Moment, happening: Happening) -> bool:
    """Whether seconds beside what happens are how long something is open before it is to close."""
    opened = happening.during.state in ("open", "opening", "fully_open") and happening.during.part != "until"
    if not opened or moment.lasting is None or moment.start is not None or moment.stop is not None:
        return False
    taken = any(re.match(r"(?:in|over|within|during|taking) ", said) for said in moment.said)
    return not taken and all(op["op"] == "articulate" and op.get("change") == "close" for op in ops)


def closes_when_open(ops: Sequence[Fields], happening: Happening) -> bool:
    """Whether something is to close, or to stay, once it is open: as far as it opens, and not when it begins to."""
    during = happening.during
    once = during.part in ("from", "after") and during.state == "open" and during.of in (None, IT)
    return once and all(op.get("change") == ("close" if op["op"] == "articulate" else "stop") for op in ops)


def of_one_movement(said: str, ops: Sequence[Fields], aside: str = "") -> tuple[Fields, ...]:
    """Operations with the movement of which words tell how long it takes, or how much later it is: "let the drawer
    close slower" says nothing of how it opens.

    Args:
        said: the words that ask for something.
        aside: those about how it is now, which count where these tell of neither movement.
    """
    if _OPENS.search(said) is None and _CLOSES.search(said) is None:
        said = aside
    if _BOTH.search(said):
        return tuple(ops)
    said = HELD_BACK.sub(" ", said)
    opens, closes = _OPENS.search(said) is not None, _CLOSES.search(said) is not None
    if opens and closes:  # "it hangs open for too long, it has to slide shut a second earlier"
        opens, closes = _OPENS_LATER.search(said) is not None, _CLOSES_LATER.search(said) is not None
    if len(ops) != 1 or opens == closes or not _is_paced(ops[0]):
        return tuple(ops)
    when = ops[0].get("when") or When()
    during = During(state="opening" if opens else "closing")
    return ({**ops[0], "when": When(during=during, lasting=when.lasting)},)


def _is_paced(op: Fields) -> bool:
    """Whether an operation changes how long a door or a drawer takes, or how much later it moves."""
    when = op.get("when")
    if op["op"] != "pace" or not is_opened(op["target"].text):
        return False
    if op["change"] == "begin":
        return isinstance(when, When) and when.lasting is not None and when.start is None and when.during is None
    return op["change"] in ("speed", "later") and when is None


_TO_THE_END = re.compile(r"\b(?:to|until|till) the (?:very )?end\b")
_BOTH = re.compile(r"\b(?:in and out|out and in|both|opening and closing|open and close)\b")
HELD_BACK = re.compile(
    r"\b(?:hold|held|keep|kept|push|move|shift)(?: (?:the|that|this|my|our)(?: [a-z]+){1,3}| it| \|)?(?: [a-z]+)? "
    r"back\b(?! in\b| to\b)"
)
_OPENS = re.compile(r"\b(?:open(?:s|ing)?|(?<!be drawn )(?<!being drawn )out|emerg\w+|extension)\b")
_CLOSES = re.compile(
    r"\b(?:clos(?:e|es|ing)|shut(?:s|ting)?|back(?: in)?|(?:go|goes|slides?|comes?|going|sliding) in|"
    r"way home|return|retreat|retraction|homecoming)\b"
)
_THEN_LATER = r"(?: (?!and\b|,|\.)\S+){0,6}? (?:earlier|sooner|later)\b"
_OPENS_LATER = re.compile(rf"{_OPENS.pattern}{_THEN_LATER}")
_CLOSES_LATER = re.compile(
    rf"{_CLOSES.pattern}{_THEN_LATER}|"
    r"\b(?:hold|keep|stay|stays|leave|remain|remains|hang|hangs)(?: \S+){0,4}? (?:open|out)(?: \S+){0,6}? longer\b"
)
_FLIPPED: dict[Part, Part] = {
    "from": "until", "after": "until_end", "until": "from", "until_end": "after", "while": "unless", "unless": "while",
}  # fmt: skip


def inverse(moment: Moment, happening: Happening | None) -> list[tuple[Moment, Happening | None]]:
    """The times in which something is not to be seen that is to be seen in another; none if nobody can say."""
    if happening is not None:
        during = happening.during.model_copy(update={"part": _FLIPPED[happening.during.part]})
        return [(moment, replace(happening, during=during))] if moment.empty and happening.until is None else []
    start, stop = moment.start, moment.stop
    if moment.lasting is not None:
        stop = start + moment.lasting if isinstance(start, float) and start >= 0 and stop is None else None
        start = None if stop is None else start
    ends = [replace(moment, start=None, stop=start, lasting=None)] if start not in (None, 0.0) else []
    ends += [replace(moment, start=stop, stop=None, lasting=None)] if stop is not None else []
    return [(end, None) for end in ends]
