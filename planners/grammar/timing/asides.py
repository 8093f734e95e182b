"""What people say beside a wish about time or motion, and that changes nothing: how it is, why, that all else stays.

A whole part of an instruction is an aside only by all of its words. Numbers, colours and orders are never asides.
"""

from __future__ import annotations

from ....gaussians import late_re as re
from ..tagging.words import bag
from .manner import MOTION
from .moments import DURATION
from .verbs import any_of

_NOW = (
    r"(?:(?:right )?now|before|usual(?:ly)?|always|today|currently|normal(?:ly)?|at present|presently|at the moment|so "
    r"far|originally|already|this time|in the original)"
)
_DOES = r"(?:(?:it|he|she|they|that) (?:(?:does|do|is|are|did|was|were|has|had|would|always|starts?|begins?) ?)+)"
_AS_NOW = (
    rf"(?:(?: (?:as|like|that|than|when|where) {_DOES}{_NOW})|(?: (?:as|like|than) {_NOW})|(?: (?:as|than) {_DOES}))"
)
_END = r"(?= ?(?:[,.;]|and\b|but\b)|$)"
_KEPT = r"(?:speed|pace|rate|tempo|velocity|moment|instant|point|start|duration|timing|path|distance|manner)"
_JOINT = (
    r"(?:(?:,|but|and|though|with|starting|beginning|still|only|just|all|leaving|from|at|in|for|on|over|it|he|she|they|"
    r"starts?|begins?|should|must|to|keep|keeping|keeps|everything|else|the|its|his|very|exact) )*"
)
_LOOKS = (  # which are what somebody may ask for
    r"red|blue|green|yellow|white|black|purple|pink|orange|gold|silver|gr[ae]y|brown|open|closed|shut|gone|hidden|"
    r"invisible|"
    r"visible|still|moving|on|in|under|at|up|down|back|to"
)
# "…, starting from the same moment as before", "later than it does now", "where it would stop anyway"
_COMPARED = tuple(
    re.compile(rf"(?: |^){pattern}{_END}")
    for pattern in (
        rf"{_JOINT}same {_KEPT}s?(?: (?:and|,) (?:(?:for|at|in|with|over) )?(?:the )?same (?:{_KEPT}|time|length))*"
        rf"{_AS_NOW}?",
        rf"{_JOINT}same (?:time|way|length|place){_AS_NOW}",
        rf"(?:but |and |, )*(?:it |he |she )?(?:still )?(?:starts?|starting|begins?|beginning) when {_DOES}{_NOW}?",
        rf"(?<=er )than {_DOES}?{_NOW}?(?<!than )",
        r"(?:just |exactly )?where (?:it|he|she|they) (?:would|will|should) (?:normally |usually |otherwise )?[a-z]+"
        r"(?: (?:its|his|her|their|the|to) [a-z]+)?",
        r"(?:, )?(?:as though|as if|like) (?:somebody|someone|anybody|it|they|he|she)(?: (?:had|has|was|"
        r"were|is))*"
        r" [a-z]+(?:ed|ing|s)?(?: [a-z]+){0,5}",
        r"(?:, )?(?:if|when) (?:(?:that|it|this) (?:is|was) (?:at all )?(?:possible|ok|okay|all right|fine|"
        r"feasible|not "
        r"too (?:much|hard|difficult)[a-z ]*)|(?:you|we) (?:can|could|would|will|please|like|do not mind))",
        r"(?:, )?(?:will|would|could|can) you(?= ?[,.;]|$)",
        r"for (?:this|the) (?:scene|clip|shot|film|take|version)",
        rf"(?:, )?(?:so(?: that)?|because|since) (?:he|she|it|they) (?:is|are|was|does|do|feels?|looks?|has|have|gets?)"
        rf"(?: not| never)? (?!(?:{_LOOKS})\b)(?:[a-z]+(?: |(?=[,.;]|$)))+",
        r"(?:, )?please(?= ?[,.;]|$)",
    )
)

_OTHERS = (
    r"(?:everything|all|anything|nothing|the rest|all (?:of )?the rest)(?: else)?(?: about (?:it|him|her|them|"
    r"this|that))?"
    r"|(?:the |its |his )?(?:speed|pace|duration|timing|time|length|direction|path|way)(?: and (?:the |its "
    r")?(?:speed|pace|duration|timing|"
    r"time|length|direction|path|way))*|(?:the|its|his|her|all the|both) (?:two |three )?others?(?: (?:two|three|"
    r"one|ones|\w+s))?|its (?:two )?neighbours?"
)
_ALL_ELSE = re.compile(  # "the other books remain as they are"
    rf"^(?:(?:and|but|while|so|the way) )*(?:{_OTHERS}) (?:(?:can|may|should|must|shall|will|is to|are to|simply|"
    rf"just|all|"
    r"still) )*"
    rf"(?:{any_of((*MOTION, 'stay', 'start'), 'plain', 's')}|do|does|keep|keeps|is|are|be|go|goes|act|behave|"
    rf"happen|leave)"
    r"(?: (?:as|like|the|they|it|is|are|was|were|do|does|did|down|on|the same|same|still|unchanged|untouched|"
    r"alone|before|"
    r"usual|normal|now|fine|ok|and|when|where|how|way|please|may|might|wish|want|put|exactly|to|fall|move|there|tumble|"
    r"happen|happens))*$"
)
_AS_BEFORE = re.compile(  # "after that he does just what he did before"
    rf"^(?:(?:and|but|then|after (?:that|this|which)|afterwards|from (?:then|there) on|later|,) )*(?:it|he|she|"
    rf"they|everything) "
    rf"(?:(?:just|simply|then|should|can|may|will|must) )*(?:does?|acts?|behaves?|goes?(?: on)?|moves?|continues?|"
    rf"carr(?:y|ies) "
    rf"on|keeps? going|{any_of(MOTION, 's', 'plain')})(?: on)? (?:(?:just|exactly|quite) )?(?:what|as|like|the "
    rf"way|everything)"
    rf"(?: that)?(?: {_DOES})?(?: ?{_NOW})?(?: ,)?(?: until (?:the (?:wall|end)|it (?:stops|ends|is done)))?$"
)
_THEN_ON = re.compile(  # "only then drops the rest of the way", "from then on it can be there"
    rf"^(?:(?:and|but|only|then|after (?:that|this)|afterwards|from (?:then|there) on|it|he|she|they|should|can|"
    rf"may|will|is|be|shall) )*"
    rf"(?:(?:continues?|goes|carr(?:y|ies)|{any_of(MOTION, 's', 'plain')}) (?:on )?(?:the rest of (?:the|its) "
    rf"(?:way|path|fall|"
    rf"journey))|(?:there|visible|back|seen|shown|in view|in sight)(?: again)?)$"
)
_WHY = re.compile(  # "they would jump", "we do not want a draught", "nobody wants that"
    r"^(?:(?:and|because|since|as) )*(?:(?:they|people|guests|everyone|everybody|someone|nobody|(?:my|our|the) "
    r"(?:kids|children|"
    r"patients|[a-z]+)) (?:would|could|might|will|may) [a-z]+(?: [a-z]+){0,4}|(?:i|we|you) (?:do not|would not) "
    r"(?:want|like|need) "
    r"(?:a|an|any|that|this)(?: [a-z]+){0,3}|(?:i|we|they|my [a-z]+|he|she) (?:do|does|think|thinks|find|"
    r"finds)(?: [a-z]+)? "
    r"(?:too|so|it too))$"
)
_OWN_LOOK = re.compile(  # "before and after that it keeps its own brown"
    r"^(?:(?:and|but|before|after|afterwards?|that|this|then|otherwise|again|from then on) |, )*(?:it|he|she|"
    r"they) (?:(?:may|can|"
    r"should|must|shall|will|just|simply|then) )*(?:keeps?|has|have|is|are|returns? to|goes back to|gets? back) "
    r"(?:back )?(?:in |to )?"
    r"(?:its|his|her|their|the) (?:own|normal|usual|old|original|former|natural|real|regular)(?: [a-z]+){0,2}$"
)
_ENOUGH = re.compile(
    rf"^(?:(?:and|but|so) )*(?:that|this|it|the \w+)(?: (?:is|are|would be|will be|should be|'s))+ (?:(?:quite|"
    rf"really|just|"
    rf"already|more than|all|perfectly) )*(?:plenty|enough|fine|ok|okay|good|perfect|right|nice|lovely|great|better|"
    rf"sufficient)(?: (?!{DURATION})[a-z]+)*$"
)
_STILL_NOW = re.compile(
    r"^(?P<np>.+?) (?:(?:is|are|'s) )?(?:(?:just|only|simply|always|still|currently|now) )*"
    r"(?:stands?|standing|sits?|sitting|lies?|lying|hangs?|hanging)(?: (?:just|only|still|there|here|around|about|"
    r"idle|idly|"
    r"doing nothing|and|does|nothing|motionless|unused|all the time))*$"
)
_DEGREE = (
    r"(?:too|so|very|much|far|really|quite|rather|hardly|barely|a bit|a little|way|pretty|awfully|terribly|such|"
    r"always|never)"
)
_FOUND_SO = re.compile(  # "my son finds the robot too slow", "I think the door opens much too soon"
    rf"^(?:(?:i|we|he|she|they|my [a-z]+|our [a-z]+|the (?:kids|children|director|client)) (?:(?:also|really|just|"
    rf"do|does) )*"
    rf"(?:find|finds|think|thinks|feel|feels|say|says|believe|believes|guess|reckon|hate|hates)(?: that)? )"
    rf"(?P<np>.+?) (?:(?:is|are|looks?|seems?|{any_of((*MOTION, 'start', 'stop'), 's', 'plain', 'ing')})(?: "
    rf"[a-z]+){{0,2}} )?"
    rf"{_DEGREE} [a-z]+(?: [a-z]+)*$"
)
_IS_SO = re.compile(  # "the drawer is staying open too much time", "that fan makes me quite dizzy"
    rf"^(?P<np>(?:the|this|that|my|our|these|those) (?:[a-z]+ ){{1,3}}?)(?:is|are|looks?|seems?|makes?|gets?|"
    rf"feels?|keeps?|"
    rf"clash|clashes|comes?|goes?|{any_of((*MOTION, 'stay', 'start', 'stop'), 's', 'plain')})"
    rf"(?: [a-z]+){{0,4}}? {_DEGREE} [a-z]+(?: [a-z]+)*$"
)
_ORDERS = bag(
    "let make should must shall want wants need needs please instead have put turn paint hide remove delete freeze "
    "stop only would could can will like supposed ought do not never"
)
_COLORS = bag("red blue green yellow white black purple pink orange gold silver gray grey brown turquoise teal")


def without_comparisons(said: str) -> str:
    """An instruction without what only compares it with how it is now.

    >>> without_comparisons("let the ball start one second later than it does now")
    'let the ball start one second later'
    """
    for pattern in _COMPARED:
        said = pattern.sub("", said)
    return " ".join(said.split()).strip(" ,;")


def asks_nothing(part: str) -> bool:
    """Whether a part of an instruction, a sentence or what stands behind a comma, only says that all else stays, or is
    enough."""
    return any(pattern.match(part) for pattern in (_ALL_ELSE, _AS_BEFORE, _THEN_ON, _WHY, _OWN_LOOK, _ENOUGH))


_MORE_OR_LESS = re.compile(  # "the blue one should wait a bit longer", before it is said how long
    r"^(?P<np>(?:the|this|that|my) [a-z ]+?) (?:should|must|has to|needs to|is to|ought to|could|may) (?:[a-z]+ ){0,3}"
    r"(?:a (?:bit|little)|some(?: time)?|somewhat|much|far) (?:longer|later|more|earlier|sooner|faster|slower|"
    r"quicker|less)$"
)


def topic_of(part: str) -> str | None:
    """What a sentence is about that only tells how things are now; None if it may ask for anything.

    >>> topic_of("the drawer is staying open too long")
    'the drawer'
    """
    if (vague := _MORE_OR_LESS.match(part)) is not None:
        return vague["np"]
    if _ORDERS & set(part.split()) or _COLORS & set(part.split()) or re.search(r"\d", part):
        return None
    for pattern in (_FOUND_SO, _IS_SO, _STILL_NOW):
        if (found := pattern.match(part)) is not None:
            return found["np"].strip()
    return None
