"""Reads questions that are made of others: with names to choose from, of two deeds, or behind another sentence.

"Which of these moves, the bench or the door?" is "which moves" of two things; "does the lamp fall, or at least move?"
is so where either is; "when does it reach the wall and stop?" is when both are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from .deeds import said_in
from .happenings import thing
from .moments import NUMBER, SECONDS

_RANKED = (
    r"(?!.*\b(?:first|earlier|sooner|later|last|next|faster|slower|quicker|longer|shorter|farther|wider|more|less|most|"
    r"fastest|slowest|longest|farthest)\b)"
)
_CHOICE = re.compile(
    rf"^{_RANKED}(?P<q>(?:what|which|who)\b.+?) , (?P<o>(?:(?:the|a|my) )?\w+(?: \w+)*?(?: , (?:(?:the|a|my) "
    rf")?\w+(?: \w+)*?)*(?: ,)? "
    r"or (?:(?:the|a|my) )?\w+(?: \w+)*)(?P<u> in \w+)?$"
)
_OF_THESE = re.compile(
    r"^(what|which|who)(?: one| thing)?s? of (?:these|those|them|the following)(?: things| objects)?\b"
)
_AUX = r"(?:is|are|was|were|does|do|did|has|have|will)"
_OR = re.compile(
    rf"^(?P<aux>{_AUX}) (?P<x>.+?)(?: ,)? or (?:at least |even |perhaps |does it |did it |is it )*(?P<b>.+)$"
)
_AND = re.compile(
    r"^(?P<q>(?:when|at what time|at which (?:time|second|moment)) (?:does|do|did|has|have|is|will)) "
    r"(?P<x>.+?) and "
                  r"(?:then )?(?:also )?(?P<b>\w+(?: \w+){0,4})$")  # fmt: skip
_OPPOSED = re.compile(
    r"\b(?:open|opened|closed|shut|opening|closing|still|moving|stopped|left|right|up|down|in|out|on|off|not|clockwise|"
    r"counterclockwise|before|after|forwards?|backwards?)$"
)
_WHICH_ONE = re.compile(
    r"^(?:so |and )?(?:which|what)(?: one| of them)?(?: is it| was it| exactly)?(?: ,? ?(?:dear|please|then))?$"
)
_SOMETHING = re.compile(r"\b(?:a|an|one|some) (?P<x>\w+(?: \w+)?)$")
_TIMED = re.compile(rf"\b{NUMBER} {SECONDS}\b|\d|\b(?:then|after|before|when|while)\b")
_SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z\"'(a-z])")


def choice(said: str) -> tuple[str, tuple[str, ...]] | None:
    """A question without the names that it offers, and these; None if it offers none."""
    if (found := _CHOICE.match(said)) is None:
        return None
    options = tuple(re.split(r"(?: ,)? or | , ", found["o"]))
    if len(options) < 2 or any(thing(o) is None for o in options):
        return None
    return _OF_THESE.sub(r"\1", found["q"]) + (found["u"] or ""), options


def either(said: str) -> tuple[str, str] | None:
    """Two questions of which one must hold: "does it fall, or at least move a little"; None if it is no such "
    "question."""
    found = _OR.match(said)
    if found is None or _OPPOSED.search(found["x"]) or said.count(" or ") != 1:
        return None
    for start, stop, _ in said_in(found["x"]):
        if stop >= len(found["x"]) - 1 or thing(found["x"][stop:]) is not None:
            subject = found["x"][:start].strip()
            subject = re.sub(r" (?:get|gets|got|ever|be)$", "", subject)
            other = re.sub(r" (?:a little|a bit|slightly|otherwise|at all)\b", "", found["b"])
            begins = next(iter(said_in(other)), None)
            if thing(subject) is not None and begins is not None and begins[0] == 0:
                aux = "does" if found["aux"] in ("did", "do") else found["aux"]
                return f"{found['aux']} {found['x']}", f"{aux} {subject} {other}"
    return None


def both(said: str) -> tuple[str, str] | None:
    """Two questions for one time: "when does it reach the wall and stop"; None if it is no such question."""
    if (found := _AND.match(said)) is None:
        return None
    begins = next((s for s in said_in(found["b"]) if s[0] == 0), None)
    if begins is None:
        return None
    for start, _, _ in sorted(said_in(found["x"]), key=lambda s: s[0]):
        subject = found["x"][:start].strip()
        if subject and thing(subject) is not None:
            return f"{found['q']} {found['x']}", f"{found['q']} {subject} {found['b']}"
    return None


def last_sentence(text: str) -> Iterator[str]:
    """The question in a text of several sentences by itself: "I lost my glasses. Is the door open at 2 s?"."""
    sentences = [s for s in _SENTENCE.split(text.strip()) if s.strip()]
    asked = [s for s in sentences if s.endswith("?")] or sentences[-1:]
    if len(sentences) < 2 or len(asked) != 1 or asked[0] != sentences[-1] or _TIMED.search(" ".join(sentences[:-1])):
        return
    question = asked[0].rstrip("?. ").lower()
    if not _WHICH_ONE.match(question.replace(",", " ,")):
        yield asked[0]
        return
    before = sentences[-2].rstrip("?.! ").lower()
    for start, _, _ in sorted(said_in(before), key=lambda s: s[0]):
        if (named := _SOMETHING.search(before[:start].strip())) is not None:
            yield f"which {named['x']} {before[start:]}?"
            return
