"""What an instruction says of holes: "fill the hole in the wall", "without filling it".

Such words are taken out before the rest is read. What names the surface is read as a thing that is selected.
"""

from __future__ import annotations

import re
from typing import NamedTuple

_FILL = r"(?:fill(?: (?:in|up|out))?|patch(?: up)?|infill|inpaint|close(?: up)?|repair|mend|complete)"
_HOLE = (
    r"(?:(?:the|this|that|any|all|every|a|an|those|these)(?: (?:of the|the))? )?(?:\w+ )?"
    r"(?:holes?|gaps?|voids?|black (?:spots?|areas?|patch(?:es)?)|missing (?:parts?|pieces?|bits?|areas?|spots?))"
    r"(?: (?:that is|that are|left|which is))?"
)
_MISSING = r"(?:what(?:ever)?(?: is|'s|s)? (?:missing|hidden|not there|empty)|the empty (?:space|place))"
_IT = r"(?:it|that|them|anything|the \w+)"
_WHERE = {
    "in": "in", "on": "in", "of": "in", "inside": "in", "within": "in",
    "under": "under", "below": "under", "beneath": "under", "underneath": "under", "behind": "behind",
}  # fmt: skip
_REQUEST = re.compile(
    rf"^(?:please |now |then |also )*{_FILL} (?:{_HOLE}|{_MISSING})(?: in| up)? "
    rf"(?P<where>{'|'.join(_WHERE)}) (?P<what>.+?)[.!]*$",
    re.IGNORECASE,
)
_SURFACE = re.compile(
    rf"^(?:please |now |then |also )*{_FILL}(?: in)? (?:the |this |that )?(?:floor|ground|wall|carpet|table ?top)"
    r"(?: in| up)? (?P<where>under|below|beneath|underneath|behind) (?P<thing>.+?)[.!]*$",
    re.IGNORECASE,
)
_LEAVE = re.compile(
    r"(?:,|;|\band\b|\bbut\b)?\s*(?:"
    r"without (?:filling|infilling|inpainting|patching)"
    rf"(?: (?:{_IT}|what (?:it|that) (?:hid|leaves|reveals)))?(?: (?:in|up))?|"
    rf"(?:do not|don't|dont|never) (?:fill|infill|inpaint|patch)(?: {_IT})?(?: (?:in|up))?|"
    r"with(?:out| no) (?:an )?infill|no (?:infill|filling)|"
    r"(?:and |but )?leave (?:the|a) (?:hole|gap)(?: (?:open|there|as it is|empty))?"
    r")(?=\s*(?:[,.;!]|$))",
    re.IGNORECASE,
)
_THEN = re.compile(rf"\s*(?:,|;|\.)?\s*\b(?:and then|and|then|,)\s+(?={_FILL}\b)", re.IGNORECASE)
_LEAVE_FIRST = re.compile(
    r"^(?P<polite>(?:please |now |then )*)(?:without (?:filling|infilling|inpainting|patching)"
    rf"(?: (?:{_HOLE}|it|anything))?(?: (?:in|up))?|with(?:out| no) (?:an )?infill)[ ,]+(?=\S)",
    re.IGNORECASE,
)


class Request(NamedTuple):
    """A hole to fill: the words of the thing that it is in, under or behind."""

    what: str
    where: str


class Heard(NamedTuple):
    """An instruction without its words about holes.

    Attributes:
        rest: the other words, "" if there are none.
        requests: the holes to fill, behind the rest.
        leave: whether what is revealed is not to be filled.
    """

    rest: str
    requests: tuple[Request, ...] = ()
    leave: bool = False


def heard(text: str) -> Heard:
    """The instruction split into what it says of holes and the rest; all of it is the rest if it says nothing."""
    rest = _LEAVE_FIRST.sub(r"\g<polite>", _LEAVE.sub("", text)).strip(" ,;")
    leave = rest != text.strip(" ,;")
    if not leave:
        rest = text
    first, *others = _THEN.split(rest)
    parts = [first, *others]
    requests = list[Request]()
    while parts and (request := _request(parts[-1])) is not None:
        requests.insert(0, request)
        parts.pop()
    if len(parts) > 1:  # something between the requests is no request: nothing is taken out
        return Heard(rest, (), leave)
    return Heard(parts[0] if parts else "", tuple(requests), leave)


def _request(clause: str) -> Request | None:
    clause = clause.strip(" ,;")
    if (found := _SURFACE.match(clause)) is not None:
        return Request(found["thing"], _WHERE[found["where"].lower()])
    if (found := _REQUEST.match(clause)) is not None:
        return Request(found["what"], _WHERE[found["where"].lower()])
    return None
