"""What an instruction says of holes: "fill the hole in the wall", "there is a gap behind the sofa, close it", "and
leave the hole". Such words are taken out before the rest is read. What names the surface is read as a selected thing.
"""

from __future__ import annotations

from typing import NamedTuple

from .....gaussians import late_re as re

_POLITE = r"(?:(?:please|pls|now|then|also|just|and|can you|could you|would you|can we|could we|i want you to) )*"
_FILL = (
    r"(?:fill(?: (?:in|up|out))?|patch(?: (?:up|over))?|infill|inpaint|in-paint|close(?: (?:up|off))?|"
    r"repair|mend|fix(?: up)?|complete|plug(?: up)?|seal(?: up)?|make good)"
)
_FILLED = r"(?:filled(?: (?:in|up))?|patched(?: up)?|infilled|inpainted|closed(?: up)?|repaired|mended|fixed|completed)"
_RID = r"(?:get rid of|remove|delete|clear|erase|take away|take out)"
_KIND = (
    r"(?:(?:black|empty|blank|bare|missing|see-through|transparent|unfilled|unscanned)[ -]"
    r"(?:bits?|spots?|areas?|patch(?:es)?|parts?|pieces?|blobs?|regions?|places?|spaces?|stains?)|"
    r"(?:black |dark |empty |big |small |ugly |huge |little |nasty |open |\w+[ -]shaped )*(?:\w+ )?"
    r"(?:holes?|gaps?|voids?|cavity|cavities))"
)
_HOLE = (
    r"(?:(?:the|this|that|any|all|every|a|an|those|these|some|my|remaining)(?: (?:of the|the|remaining|other))? )?"
    rf"{_KIND}(?: (?:that is|that are|that's|left(?: over| behind)?|which is|which are|still|there))*"
)
_EMPTY = (
    r"(?:everything|anything|all) (?:that is|that's|which is)? ?(?:missing|empty)|"
    r"what(?:ever|'s| is| was)?(?: is| was|'s)? (?:missing|not there|empty|gone)|the empty (?:space|place)"
)
_HIDDEN = r"what(?:ever|'s| is| was|s)?(?: is| was|'s)? (?:hidden|revealed|uncovered|left)"
_MISSING = rf"(?:{_EMPTY}|{_HIDDEN})"
_IT = r"(?:it|that|them|this|anything|the \w+)"
_WHERE = {
    "in": "in", "on": "in", "of": "in", "inside": "in", "within": "in", "into": "in",
    "under": "under", "below": "under", "beneath": "under", "underneath": "under", "behind": "behind",
}  # fmt: skip
_AT = rf"(?:{'|'.join(_WHERE)})"
_SURFACES = r"(?:floor(?:boards?| boards?)?|ground|walls?|wallpaper|carpet|ceiling|table ?top|pavement|grass|lawn)"
# What follows a hole and does not name its surface.
_ONCE = (
    r"(?: (?:left (?:over )?by [\w ]+?|(?:left )?where|that|which|after) "
    r"(?:[\w ]+? (?:was|were|used to be|stood|had been|hung|lay|left|sat)"
    r"(?: (?:before|once|standing))?|i removed [\w ]+|[\w ]+ (?:is|was) (?:gone|removed|deleted)))?"
)
_WITH = r"(?: (?:with|by|using|from) (?:the (?:same )?|more of the |more |some |what is |its )*(?P<with>[\w' ]+?))?"
_LAST = r"(?: (?:too|again|now|please|pls|as well|for me|properly|up|in|over|there))*[ .!?]*$"
_REQUEST = re.compile(
    rf"^{_POLITE}(?:{_FILL}|{_RID}) {_HOLE}{_ONCE} (?P<where>{_AT}) (?P<what>.+?){_ONCE}{_LAST}", re.I
)
_LACK = re.compile(rf"^{_POLITE}{_FILL} {_MISSING}(?: in| up)? (?P<where>{_AT}) (?P<what>.+?){_LAST}", re.I)
_BESIDE = r"(?P<where>under|below|beneath|underneath|behind)"
_PLACE = rf"(?:the |this |that )?(?:{_SURFACES}|area|space|place|part|bit|background|surface|nothing)"
_SURFACE = re.compile(rf"^{_POLITE}{_FILL}(?: in)? {_PLACE}(?: in| up)? {_BESIDE} (?P<what>.+?){_WITH}{_LAST}", re.I)
_SURFACE_ONCE = re.compile(rf"^{_POLITE}{_FILL}(?: in)? (?P<what>(?:the |this |that )?{_SURFACES}){_ONCE}{_LAST}", re.I)
_GONE = r"(?:is|are|seems|looks) (?:still )?(?:missing|gone|empty|black|see-through|full of holes|not there)"
_WITH_SURFACE = re.compile(rf"^{_POLITE}{_FILL} (?:{_HOLE}|{_MISSING}){_ONCE}{_WITH}{_LAST}", re.I)
_FILL_IT = (
    rf"(?:{_POLITE}{_FILL} (?:it|that|them|this|those)(?: (?:in|up|over))?|"
    rf"(?:can|could|should|must|may|needs? to) (?:it|that|this|they)? ?be {_FILLED}|"
    rf"(?:it |that |this |they |please )*(?:should be|must be|needs? to be|has to be) {_FILLED}|"
    rf"needs? {_FILL}ing|{_POLITE}{_FILL})"
)
_REMARK = r"(?: (?:is|are|looks?|bothers?|annoys?|shows?|needs?|should|must|has|have|can|could)\b[^,.;]*?)?"
_TOLD = re.compile(
    r"^(?:(?:so|hey|hi|well|oh|look|unfortunately|sadly|now|but) )*"
    r"(?:there(?: is|'s|s| are|'re)?(?: still| now)?|i (?:can )?(?:still )?see|you left|it left|we have|i have) "
    rf"{_HOLE} (?P<where>{_AT}) (?P<what>.+?){_ONCE}\s*[,.;:-]+ ?{_FILL_IT}{_WITH}{_LAST}",
    re.I,
)
_STATED = re.compile(
    rf"^{_HOLE} (?P<where>{_AT}) (?P<what>.+?){_ONCE}{_REMARK}\s*[,.;:-]* ?{_FILL_IT}{_WITH}{_LAST}", re.I
)
_HAS = re.compile(
    rf"^(?P<what>(?:the |my |our )?{_SURFACES}) (?:has|have|got)(?: got)? {_HOLE}{_ONCE}\s*[,.;:-]+ ?"
    rf"{_FILL_IT}{_WITH}{_LAST}",
    re.I,
)
_LACKS = re.compile(
    rf"^(?:there is |there's |theres )?{_PLACE} {_BESIDE} (?P<what>.+?)(?: (?:{_GONE}|has {_HOLE}))?"
    rf"\s*[,.;:-]+ ?{_FILL_IT}{_WITH}{_LAST}",
    re.I,
)
_VANISH = re.compile(
    rf"^{_POLITE}make {_HOLE} (?P<where>{_AT}) (?P<what>.+?){_ONCE} (?:disappear|vanish|go(?: away)?|invisible){_LAST}",
    re.I,
)
_ANYWHERE = re.compile(
    r"^(?:(?:so|hey|well|oh|look|but) )*(?:there(?: is|'s|s| are)?(?: still| now)?|"
    r"i (?:can )?(?:still )?see|you left|it left) "
    rf"{_HOLE}(?:{_ONCE}|(?: here| there)?)\s*[,.;:-]+ ?{_FILL_IT}{_WITH}{_LAST}",
    re.I,
)
_LEAVE = re.compile(
    r"(?:,|;|\.|\band\b|\bbut\b)?\s*(?:"
    r"without (?:filling|infilling|inpainting|patching|closing)"
    rf"(?: (?:{_HOLE}|{_IT}|what (?:it|that) (?:hid|leaves|reveals)))?(?: (?:in|up))?|"
    r"(?:please )?(?:do not|don't|dont|never) (?:fill|infill|inpaint|patch|close|mend|repair)"
    rf"(?: (?:in|up))?(?: (?:{_HOLE}|{_IT}))?(?: (?:in|up))?|"
    r"with(?:out| no) (?:an? |any )?(?:infill|filling|patching|inpainting)|"
    r"no (?:infill|filling|patching|inpainting)(?: (?:please|pls))?|"
    r"(?:and |but |just )?(?:leave|leaving|keep|keeping) (?:the|a|that) (?:black |empty )?"
    r"(?:hole|gap|void|space|spot|place)"
    r"(?: (?:open|there|as it is|as is|empty|behind|black|unfilled|visible|where it (?:was|stood)))?|"
    r"(?:and |but )?(?:leave|leaving|keep|keeping) (?:it|that|the place|the spot|the space|what is behind) "
    r"(?:open|empty|unfilled|black|blank|bare)"
    r")(?=\s*(?:[,.;!]|$))",
    re.I,
)
_TO_SEE = re.compile(
    r"[,.;]? *(?:because |as |since |so (?:that )?)?i (?:just )?(?:want|need|like|would like|'d like|wanna|can)"
    r"(?: to)? (?:see|have|keep|look at) (?:the |a |what )?[\w ]+[.!]*$",
    re.I,
)
_THEN = re.compile(rf"\s*(?:,|;|\.)?\s*\b(?:and then|and also|and|then|,|;|\.)\s*(?={_POLITE}{_FILL}\b)", re.I)
_LEAVE_FIRST = re.compile(
    r"^(?P<polite>(?:please |now |then )*)(?:"
    rf"(?:without (?:filling|infilling|inpainting|patching)(?: (?:{_HOLE}|{_IT}))?(?: (?:in|up))?|"
    r"with(?:out| no) (?:an )?infill)[ ,]+|"
    rf"(?:do not|don't|dont|never) (?:fill|infill|inpaint|patch)(?: (?:{_HOLE}|{_IT}))?(?: (?:in|up))?"
    r" (?:when|while|if|after|once) (?:you |we |i )?)(?=\S)",
    re.I,
)
# What every deletion does, said with it: "and fill in what is underneath", "and mend the wall and floor there".
_OF_IT = (
    r"(?: (?:under|below|beneath|underneath|behind)(?: (?:it|them|that))?| there"
    r"| where (?:it|they|that) (?:was|were|stood|is|hung)"
    r"| (?:that )?it (?:leaves|left|reveals)(?: behind)?| left(?: behind)?| afterwards?| after it)*"
)
_ANYWAY = re.compile(
    rf"^{_POLITE}{_FILL} (?:(?:the |that |any |up |in )*"
    rf"(?:{_KIND}|{_SURFACES}(?: and (?:the )?{_SURFACES})?|background|spot|place|space)|"
    r"what(?:ever|'s|s)?(?: is| was| lies| it)? ?"
    r"(?:hid(?:den)?|underneath|behind|beneath|under|below|missing|revealed|left|there)|"
    rf"it|that){_OF_IT}{_WITH}{_LAST}",
    re.I,
)


# With what a hole may be filled: more of what surrounds it. Things that are put there are no filling.
_MORE = re.compile(
    rf"\b(?:{_SURFACES}|surface|surroundings?|around(?: it)?|background|rest|texture|pattern|material|colou?r|wood|"
    r"tiles?|boards?|planks|bricks?|plaster|paint|stone|gravel|rug|same|matching)\b",
    re.I,
)


class Request(NamedTuple):
    """A hole to fill: the words of the thing that it is in, under or behind; "" means anywhere."""

    what: str
    where: str


class Heard(NamedTuple):
    """An instruction without its words about holes.

    Attributes:
        rest: the other words, "" if there are none.
        requests: the holes to fill, behind the rest.
        leave: whether what is revealed is not to be filled.
        anyway: whether it says of the rest that what it reveals is to be filled.
    """

    rest: str
    requests: tuple[Request, ...] = ()
    leave: bool = False
    anyway: bool = False


def heard(text: str) -> Heard:
    """The instruction split into what it says of holes and the rest; all of it is the rest if it says nothing."""
    if (request := _told(text.strip(" ,;"))) is not None and not request.what.startswith("where "):
        return Heard("", (request,))
    rest = _LEAVE_FIRST.sub(r"\g<polite>", _LEAVE.sub("", text)).strip(" ,;")
    leave = rest != text.strip(" ,;")
    rest = _TO_SEE.sub("", rest) if leave else text
    first, *others = _THEN.split(rest)
    parts = [first, *others]
    requests, anyway = list[Request](), False
    while parts:
        if len(parts) > 1 and _ANYWAY.match(parts[-1].strip(" ,;")):
            anyway = True
        elif (request := _request(parts[-1])) is not None:
            requests.insert(0, request)
        else:
            break
        parts.pop()
    unread = not leave and (not requests or requests[0].what.startswith("where "))
    if unread and (loose := _loosely(text)):
        return Heard("", loose)
    if len(parts) > 1:  # something between the requests is no request: nothing is taken out
        return Heard(rest, (), leave)
    return Heard(parts[0] if parts else "", tuple(requests), leave, anyway and bool(parts))


_PART = (
    r"(?:things?|blobs?|stuff|marks?|bits?|spots?|areas?|patch(?:es)?|parts?|pieces?|sections?|chunks?|"
    r"corners?|strips?|places?)"
)
_FLAWED = re.compile(
    rf"\b(?:{_KIND}|(?:black|blank|empty|missing|bare|dark|see-through|transparent|white|grey|gray|void) {_PART}|"
    rf"{_PART} (?:of [a-z ]+? )?(?:that is |that are |which is |is |are )?(?:missing|gone|not there|empty|black|blank)|"
    r"(?:is|are|looks?|seems?) (?:still |partly |partially |half |a bit |completely )*(?:missing|gone|incomplete|empty|"
    r"see-through|transparent|full of holes|holey|torn|not there)|has gone missing|something (?:is )?missing|"
    r"(?:see|look) (?:right |straight )?through|nothing (?:is )?there|(?:left|still) (?:open|empty|black|blank|"
    r"missing))\b",
    re.I,
)
_OF_FLAW = re.compile(
    r"(?:\b(?:in|on|of|from|inside|into|within|across|through|at)) (?P<what>(?:(?:the|this|that|my|our) )"
    r"(?:[a-z-]+ ){0,2}?[a-z-]+?)(?= (?:that|which|where|when|near|next|by|beside|under|behind|below|after|left|is|"
    r"are|was|"
    r"has|it|please|there|now|above|over|opposite|between|in|on|from|of|and|so)\b|[,.;!?]|$)",
    re.I,
)
_SUBJECT = re.compile(
    r"^(?:(?:and|but|so|now|then|oh|look|hey|the scan has|it seems) )*(?P<what>(?:(?:the|this|that|my|our) "
    r")?(?:[a-z-]+ ){0,2}?"
    r"[a-z-]+?) (?:(?:under|behind|below|next to|near|where|beneath)\b[^,.;]*? )?"
    r"(?:has|have|is|are|looks?|seems?|got|shows?|there is)\b",
    re.I,
)
_ONLY_WHERE = re.compile(r"^(?:right )?(?:in|on|of|at) (?P<what>(?:the|this|that|my|our) (?:[a-z-]+ )?[a-z-]+)$", re.I)
_BIT_OF = re.compile(rf"\b{_PART} of (?:the |this |that )?(?P<what>[a-z-]+)(?= (?:that|which|is|are)\b)", re.I)
_MEND = re.compile(rf"\b(?:{_FILL}|restore|reconstruct|rebuild|cover(?: up)?|finish|heal|stitch|retouch|cure)\b", re.I)
_MENDING = re.compile(
    rf"^{_POLITE}(?:(?:i|we) (?:want|need|would like) )?(?:to )?(?:{_FILL}|restore|reconstruct|rebuild|cover(?: "
    rf"up)?|heal|retouch|sort|correct|do something about|get "
    r"rid of)(?: (?:it|that|them|this|those|these|the (?:hole|gap|spot|patch)s?|up|in|over|out|nicely|neatly|"
    r"properly|please|for me|"
    r"again|now|cleanly|well|too|with the same|seamlessly|as well|completely))*$",
    re.I,
)
_PAST = re.compile(
    r"^(?:(?:and|so|but|after|when|since|because|now that) )*(?:i|we|you|it|they|someone|somebody)(?: (?:have|just|"
    r"has|already))* "
    r"(?:moved|removed|deleted|took|taken|dragged|pushed|shifted|put|got rid|threw|lifted|replaced|edited|scanned|"
    r"cleared)\b[^,.;]*$",
    re.I,
)
_CLAUSES = re.compile(r"\s*(?:[,.;:!?]+|\b(?:and|but|so|then)\b)\s*", re.I)
_ASKED = re.compile(
    r"^(?:why|what|who|how|where|which|when|is|are|was|were|does|do|did|has|have|should|if|never|don't)\b", re.I
)
_PEOPLE = ("i", "we", "you", "there", "something", "nothing", "it", "that", "this", "they", "what", "he", "she")


def _loosely(text: str) -> tuple[Request, ...]:
    """Holes that are told of in any words, each with the surface that it is in; nothing if a clause says anything else.

    Every clause must name a flaw and a surface ("the ceiling has a missing bit"), ask to mend it ("close it up"), or
    tell what was done before ("I moved the vase").
    """
    plain = " ".join(text.lower().split()).rstrip(".!? ")
    if not _FLAWED.search(plain) or _ASKED.match(plain) or (text.rstrip().endswith("?") and not _MEND.search(plain)):
        return ()
    requests = list[Request]()
    for clause in filter(None, _CLAUSES.split(plain)):
        clause = clause.strip()
        if _MENDING.match(clause) or _PAST.match(clause) or clause in ("please", "now", "thanks", "thank you"):
            continue
        if (only := _ONLY_WHERE.match(clause)) is not None and requests:
            requests[-1] = Request(only["what"], "in")
            continue
        if (flaw := _FLAWED.search(clause)) is None:
            return ()
        where = _surface_of(clause, flaw) or ""
        requests.append(Request(where, "in"))
    return tuple(requests[:1]) if len({r.what for r in requests}) == 1 and requests[0].what else ()


def _surface_of(clause: str, flaw: re.Match[str]) -> str | None:
    """The surface of which a clause says that a bit of it is missing."""
    if (found := _BIT_OF.search(clause)) is not None:
        return f"the {found['what']}"
    if (found := _OF_FLAW.search(clause, max(flaw.start() - 1, 0))) is not None:
        return found["what"]
    subject = _SUBJECT.match(clause)
    if subject is None or subject["what"].split()[0] in _PEOPLE:
        return None
    named = subject["what"]
    return named if named.split()[0] in ("the", "this", "that", "my", "our") else f"the {named}"


# Each form of a request says a word to mend by, or what a hole is called.
_NAMES = re.compile(rf"{_FILL}|{_FILLED}|{_KIND}", re.I)


def _told(text: str) -> Request | None:
    """A hole that is told of, and then to be filled: "there is a hole in the floor, fill it"."""
    if _NAMES.search(text) is None:
        return None
    for pattern in (_TOLD, _STATED, _HAS, _LACKS, _VANISH):
        if found := pattern.match(text):
            return _of(found)
    return Request("", "in") if _ANYWHERE.match(text) else None


def _request(clause: str) -> Request | None:
    clause = clause.strip(" ,;")
    named = _NAMES.search(clause) is not None
    for pattern in (_SURFACE, _REQUEST, _LACK, _SURFACE_ONCE) if named else ():
        if found := pattern.match(clause):
            return _of(found)
    if loose := _loosely(clause):
        return loose[0]
    if named and (found := _WITH_SURFACE.match(clause)):
        if found["with"] and not _MORE.search(found["with"]):
            return None
        surface = re.search(_SURFACES, found["with"] or "", re.I)
        return Request(surface[0] if surface else "", "in")
    return None


def _of(found: re.Match[str]) -> Request | None:
    """The request that a pattern found; None if something else is to be put there."""
    said = found.groupdict()
    if (said.get("with") and not _MORE.search(said["with"])) or re.search(r" (?:with|using) ", said["what"]):
        return None
    return Request(said["what"], _WHERE[said["where"].lower()] if said.get("where") else "in")
