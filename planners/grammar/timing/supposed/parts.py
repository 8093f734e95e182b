"""An instruction divided by marks: what it is about, where that goes, when, and what asks for nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....tools.when import During
from ...tagging.spelling import is_word
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import ORDINALS
from ..happenings import CONJUNCTION, IT, Happening, clause_of
from ..manner import Thing
from ..moments import DURATION, TIMED, End, Moment, cut, seconds_of
from .names import named as names_in
from .said import Said

Span = tuple[str, int, int]  # a tag, and the words from one to another
_TIMES = {"from": "when", "to": "until", "in": "while", "for": "for"}  # tags of times, and how such a time is begun
_IDLE = ("not", "off")  # tags of words that ask for nothing
_LEADING = re.compile(
    r"^(?:(?:,|and|then|but|just|only|right|exactly|about|around|starting|beginning|start|begin|finish(?:ed|ing)?|done|"
    r"ending|end|arriving|being|be|there|taking|takes?|lasting|lasts?) (?=\w))*"
)
_BARE = re.compile(
    r"^(?:(?:by|at|on|from|in|to|till|until|after|before|up|for|over|within|during|the|only|just|about|around|exactly|"
    r"say|like|mark|starting|beginning|finished|done|,) )*(?P<value>.+?)(?: (?:mark|on|onwards?|already|sharp|flat|in|"
    r"long))*$"
)
_AS = re.compile(r"^(?:all the while|the whole time(?: that)?|for the time(?: that)?) (?=\w)")
_WHERE = re.compile(r"^(?:at )?(?:the (?:point|place|spot|corner) )?(?:where|upon) (?=\w)")
_ALL = re.compile(r"\b(?:whole|entire|throughout|all the time|always|(?:beginning|start) to (?:the )?(?:end|finish))\b")
_NAMED: tuple[tuple[re.Pattern[str], End], ...] = (
    (re.compile(r"\b(?:middle|half ?way|half time|midway|half the)\b"), "middle"),
    (re.compile(r"\b(?:end|finish|close|last frame|over|finale)\b"), "end"),
    (re.compile(r"\b(?:beginning|start|outset|first (?:frame|moment|second)|at once|immediately|straight away)\b"), 0.0),
)
_HALF = re.compile(r"\b(first|second|last|latter|other) half\b")
_UNTIL = re.compile(r"^(?:arriv|finish|ending|done|there |be there|complet|reach|all |over )")  # what it is until then
_HALFWAY = re.compile(
    r"^(?:when |once |at |as soon as )?(?:(?P<who>.+?) (?:is|has (?:gone|got)|gets) )?(?:half ?way|midway|half the way|in the middle of)"
    r"(?P<way>(?: (?:down|up|through|there|across|along|over|to|into|out|open|of))* ?(?P<what>.*))$"
)
_ALONE = re.compile(r"^(?:at |from )?(?:half ?way|midway|half time)(?: through| in| point)*$")
_FILM = re.compile(r"\b(?:film|clip|video|movie|scene|shot|time|animation|footage|sequence)\b")
_CONTRAST = re.compile(r"^(?:,|\.|and|but|so|then|only|just|so that)* ?(?:not|no|instead|rather|than|never|without|and then|then|back|as|like)\b")
_DELAY = re.compile(rf"^(?P<delay>{DURATION}|a (?:moment|bit)) (?=(?:after|once|when) )")


def divided(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> tuple[Said, Happening | None] | None:
    """What an instruction says, and what happens at its time; None if a time in it is not understood.

    Args:
        words: those of the instruction.
        spans: the marks in them.
        thing: reads a name.
    """
    moment, happening = Moment(), None
    for tag, start, stop in spans:
        if tag not in _TIMES:
            continue
        phrase = " ".join(words[start:stop]).strip(" ,.;:")
        if tag == "from" and _UNTIL.match(phrase):
            tag = "to"
        phrase = _LEADING.sub("", phrase)
        if (delay := _DELAY.match(phrase)) is not None and (seconds := seconds_of(delay["delay"])) is not None:
            phrase, moment = phrase[delay.end() :], replace(moment, start=seconds)
        if (found := _moment(tag, phrase)) is not None:
            if (both := _joined(moment, found)) is None:
                return None
            moment = both
        elif happening is None and (event := _event(tag, phrase, thing)) is not None:
            happening = event
        else:
            return None
    if happening is not None and happening.during.part in ("until", "until_end") and moment.start is not None:
        return None  # a time that starts in numbers and stops with what happens
    if any(tag in _IDLE and _loses(tag, words[start:stop]) for tag, start, stop in spans):
        return None
    left = {at for tag, start, stop in spans if tag in _TIMES or tag in _IDLE for at in range(start, stop)}
    text = " ".join(word for at, word in enumerate(words) if at not in left).strip(" ,.;:!")
    text = re.sub(r"(?: [,.;:!])+(?= [,.;:!])", "", text)
    named = [
        (tag, " ".join(words[start:stop]).strip(" ,.")) for tag, start, stop in sorted(spans, key=lambda s: s[1])
    ]
    things = _things(named, "x", thing)
    if not things and happening is not None:  # "once the door has opened, shut it"
        things = names_in(happening.said, thing)[:1]
    goals = _things(named, "y", thing)
    return Said(text, (*things, *(g for g in goals if g not in things)), moment, happening is not None, thing), happening


def _loses(tag: str, words: Sequence[str]) -> bool:
    """Whether words that seem to ask for nothing tell a time."""
    said = " ".join(words).strip(" ,.;")
    if tag == "not" and _CONTRAST.match(" ".join(words)):
        return False
    return TIMED.search(said) is not None or any(found["word"] != "as" for found in CONJUNCTION.finditer(said))


def _things(named: Sequence[tuple[str, str]], tag: str, thing: Thing) -> tuple[str, ...]:
    """The names with a tag, each once; pronouns only where no name is there."""
    found = list[tuple[str, Query]]()
    for own, name in named:
        if own == tag and (query := thing(name)) is not None and not query.last:
            if not any(query == other for _, other in found):
                found.append((name, query))
    return tuple(name for name, _ in found)


def _joined(one: Moment, other: Moment) -> Moment | None:
    """Both times as one; None if they differ in what they say."""
    for key in ("start", "stop", "lasting"):
        if getattr(one, key) is not None and getattr(other, key) is not None:
            return None
    return Moment(
        start=other.start if one.start is None else one.start,
        stop=other.stop if one.stop is None else one.stop,
        lasting=other.lasting if one.lasting is None else one.lasting,
        taken=one.taken or other.taken, always=one.always or other.always, said=(*one.said, *other.said),
    )  # fmt: skip


def _moment(tag: str, phrase: str) -> Moment | None:
    """A time in numbers."""
    if _HALFWAY.match(phrase) and not _FILM.search(phrase) and not _ALONE.match(phrase):
        return None
    if tag == "to" and re.match(r"by (?:the )?(?:very )?end\b", phrase):
        return Moment(stop="end", said=(phrase,))
    rest, moment = cut(phrase)
    if moment != Moment() and not any(is_word(word) or is_known(word) for word in rest.strip(" ,.").split()):
        return moment
    if (half := _HALF.search(phrase)) is not None:
        return Moment(start=None if half[1] == "first" else "middle", stop="middle" if half[1] == "first" else None, said=(phrase,))
    if _ALL.search(phrase):
        return Moment(always=True, said=(phrase,))
    bare = _BARE.match(phrase)
    value = None if bare is None else _seconds(bare["value"])
    if value is None and tag in ("from", "to") and not CONJUNCTION.match(phrase) or phrase.split()[0] in _EVEN_SO:
        value = next((end for pattern, end in _NAMED if pattern.search(phrase)), None)
    if value is None:
        return None
    if tag == "for":
        return Moment(lasting=value, taken=True, said=(phrase,)) if isinstance(value, float) else None
    if tag == "from":
        return Moment(start=value, said=(phrase,))
    if tag == "to":
        return Moment(stop=None if value == "end" else value, always=value == "end", said=(phrase,))
    return None


_EVEN_SO = ("until", "till", "after", "by", "before")


def _seconds(said: str) -> float | None:
    """Seconds that a number names, with or without its unit."""
    said = re.sub(r"^(?:second|sec|t|time)\b ?=? ?(?=\w)", "", re.sub(r"\b(?:more|another|extra|further) ", "", said))
    found = seconds_of(said)
    if found is None:
        found = seconds_of(f"{said} seconds")
    if found is None and (rank := re.fullmatch(r"(\w+) second", said)) is not None and rank[1] in ORDINALS:
        found = float(ORDINALS[rank[1]])
    return found


def _event(tag: str, phrase: str, thing: Thing) -> Happening | None:
    """A time told by what happens."""
    if (half := _HALFWAY.match(phrase)) is not None:
        of = names_in(half["who"] or half["what"], thing)[:1]
        whose = thing(of[0]) if of and (half["who"] or half["way"].startswith((" through", " of"))) else None
        return Happening(During(state="halfway", of=whose or IT, part="until" if tag == "to" else "from"), phrase)
    phrase = _WHERE.sub("when ", _AS.sub("while ", phrase))
    for said in (phrase, f"{_TIMES[tag]} {phrase}"):
        for found in CONJUNCTION.finditer(said):
            if found.start() == 0 and (during := clause_of(found["word"], said[found.end() :].strip(" ,."), thing)):
                return Happening(during, said)
    return None
