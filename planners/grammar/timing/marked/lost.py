"""What a plan leaves out of the words of an instruction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set

from pydantic import BaseModel

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ...learned.marks import Span, held_by
from ...learned.seen import hues
from ...tagging.words import bag
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS
from ..command import Fields
from ..moments import TIMED
from .kinds import marked
from .times import TIMES

CONTRAST = re.compile(r"\b(?:not|no|instead|rather|than|never|without|then|back|again|too|now|currently|presently)\b")


_NO_COLOR = re.compile(r"\b(?:no|not|never) (?:be |is |more |longer |any )?([a-z]+)\b")  # "no be brown again"
_DENIED = re.compile(r"\b(?:not|no|instead|than|never|without)\b")


def leaves_out(
    words: Sequence[str],
    ops: Sequence[Fields],
    free: Set[int] = frozenset(),
    spans: Sequence[Span] | None = None,
    timed: bool = True,
    shades: Set[int] = frozenset(),
) -> bool:
    """Whether a number beside a time, or a colour, that an instruction tells stands in no operation.

    What is not wanted, and what comes back, may be left out.

    Args:
        free: where numbers stand that say nothing new.
        spans: the marks in the words; None: the likeliest.
        timed: whether numbers count only in an instruction that has a time with its unit.
        shades: where colours stand that say nothing new.
    """
    spans = marked(words) if spans is None else spans
    if _loses_colors(words, ops, shades, spans):
        return True
    said = " ".join(words)
    counts = not timed or TIMED.search(said) is not None or _A_SECOND.search(said) is not None
    if not counts:  # only numbers of times: "by four and a half"
        free = free | (set(range(len(words))) - held_by(spans, *TIMES))
    return _loses_numbers(words, ops, free, spans)


def _loses_colors(words: Sequence[str], ops: Sequence[Fields], shades: Set[int], spans: Sequence[Span]) -> bool:
    """Whether a look is for a time, or things are put in order, and another colour that is told stands nowhere: "red
    while it rolls, else blue"."""
    denied = (_NO_COLOR.findall(" ".join(words[start:stop])) for tag, start, stop in spans if tag == "not")
    unwanted = {word for found in denied for word in found} - {words[at] for at in held_by(spans, "as")}
    if any(op["op"] == "recolor" and not unwanted.isdisjoint(str(op.get("color")).split()) for op in ops):
        return True  # "black, not brown again"
    held = set(re.findall(r"[a-z]+", str(ops)))
    if any(op["op"] == "order" and op.get("first") for op in ops):  # of things that are named by their colours
        idle = {
            at for tag, start, stop in spans if tag != "not" or _DENIED.search(" ".join(words[start:stop]))
            for at in range(start, stop)
        }  # fmt: skip
        return any(word in hues() and word not in held for at, word in enumerate(words) if at not in idle)
    if not any(op["op"] == "recolor" and op.get("when") is not None for op in ops):
        return False
    idle = {
        at for tag, start, stop in spans if tag == "off" and _DISLIKES.search(" ".join(words[start:stop]))
        for at in range(start, stop)
    }  # fmt: skip
    for at, word in enumerate(words):
        around = {*words[max(0, at - 4) : at], *words[at + 1 : at + 3]}
        beside = held & hues() & {*words[max(0, at - 1) : at], *words[at + 1 : at + 2]}  # "mint green" is one colour
        if word in hues() and at not in idle | shades and word not in held and not beside and not around & _NOT_WANTED:
            return True
    return False


_DISLIKES = re.compile(r"\b(?:hates?|dislikes?|ugly|boring|dreary|dull|sick|tired|enough)\b")  # "I hate brown"
_NOT_WANTED = bag(
    "again back return returns revert reverts not no never instead than rather too from usual normal longer was rest "
    "without ugly"
)


def _loses_numbers(words: Sequence[str], ops: Sequence[Fields], free: Set[int], spans: Sequence[Span]) -> bool:
    """Whether a number stands in no operation, and not among what is not wanted."""
    named = held_by(spans, "x", "y")  # "the red one"
    missing = set(_missing(words, ops)) - free - named
    if missing and "not" in words and "but" in words[words.index("not") :]:  # "not at 1 s but at 3 s"
        missing -= set(range(words.index("not"), words.index("but", words.index("not"))))
    if missing:
        unwanted = [(start, stop) for tag, start, stop in spans if tag == "not"]
        missing -= {
            at for start, stop in unwanted if CONTRAST.search(" ".join(words[start:stop])) for at in range(start, stop)
        }
    return bool(missing)


def _missing(words: Sequence[str], ops: Sequence[Fields]) -> Iterator[int]:
    """Where the numbers stand that are in no operation."""
    exact = {abs(value) for op in ops for value in _numbers(op)}
    shares = [{v and 1 / v, 100 * v, 1 - v, 100 * (1 - v), 100 * (v - 1)} for v in exact]
    units = {scale * v for v in exact for scale in (360, 60, 1000)}  # degrees and minutes of turns, millimetres
    held = exact.union({0.0}, units, *shares)
    for at, word in enumerate(words):
        then, behind = (*words[at + 1 : at + 3], "", "")[:2]
        if is_known(singular(then)) or then in _NO_NUMBER or then in _PARTS_OF_IT or (at and words[at - 1] == "other"):
            continue  # "ahead of the other two"
        told = float(word) if re.fullmatch(r"\d+(?:\.\d+)?", word) else float(NUMBERS.get(word, 1))
        seconds = re.fullmatch("s|secs?|seconds?", behind if then in ("full", "whole") else then) is not None
        alone = word == "one" and at > 0 and words[at - 1] in _AT and not then.isalpha()  # "starting at one"
        seconds |= alone and " ".join(words[max(0, at - 2) : at]) != "one by"
        seconds &= word != "a" or (at > 0 and words[at - 1] in ("for", "over", "within", "in"))
        if told != 1 or (seconds and word in ("1", "one", "a")):
            rate = words[max(0, at - 1)] in ("every", "each", "per")
            among = exact if seconds and not rate else held
            halves = (0.0, 0.5) if "half" in words[at + 1 : at + 5] else (0.0,)
            if not any(abs(told + half - value) < 0.01 for half in halves for value in among):
                yield at


_PARTS_OF_IT = bag("walks legs stretches falls drops runs rolls swings turns movements halves books ones others")
_A_SECOND = re.compile(r"\b(?:every|each|per|a) (?:second|sec)\b")
_AT = ("at", "by", "until", "till", "from", "before", "after")
_NO_NUMBER = (
    "of",
    "ones",
    "quarters",
    "thirds",
    "quarter",
    "third",
    "tenths",
    "fifths",
    "hundredths",
)  # behind a part of something


def _numbers(value: object) -> Iterator[float]:
    """All numbers in the fields of an operation."""
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_defaults=True)
    if isinstance(value, bool):
        return
    if isinstance(value, int | float):
        yield float(value)
    elif isinstance(value, dict):
        for inner in value.values():
            yield from _numbers(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _numbers(inner)
