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
    r"(?:(?:right )?now|before|usual(?:ly)?|always|today|currently|normal(?:ly)?|at present|presently|at the moment|"
    r"so far|originally|already|this time|in the original)"
)
_DOES = r"(?:(?:it|he|she|they|that) (?:(?:does|do|is|are|did|was|were|has|had|would|always|starts?|begins?) ?)+)"
_AS_NOW = (
    rf"(?:(?: (?:as|like|that|than|when|where) {_DOES}{_NOW})|(?: (?:as|like|than) {_NOW})|(?: (?:as|than) {_DOES}))"
)
_END = r"(?= ?(?:[,.;]|and\b|but\b)|$)"
_KEPT = r"(?:speed|pace|rate|tempo|velocity|moment|instant|point|start|duration|timing|path|distance|manner)"
_JOINT = (
    r"(?:(?:,|but|and|though|with|starting|beginning|still|only|just|all|leaving|from|at|in|for|on|over|it|he|she|"
    r"they|starts?|begins?|should|must|to|keep|keeping|keeps|everything|else|the|its|his|very|exact) )*"
)
HUES = r"red|blue|green|yellow|white|black|purple|pink|orange|gold|silver|gr[ae]y|brown"
_LOOKS = (  # which are what somebody may ask for
    rf"{HUES}|open|closed|shut|gone|hidden|invisible|visible|still|moving|on|in|under|at|up|down|back|to"
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
        r"(?<=er )than (?:is )?(?:shown|seen|here|in the (?:film|video|clip))(?: here| now| there)?",
        r"(?:just |exactly )?where (?:it|he|she|they) (?:would|will|should) (?:normally |usually |otherwise )?[a-z]+"
        r"(?: (?:its|his|her|their|the|to) [a-z]+)?",
        r"(?:, )?(?:as though|as if|like) (?:somebody|someone|anybody|it|they|he|she)(?: (?:had|has|was|were|is))*"
        r" [a-z]+(?:ed|ing|s)?(?: [a-z]+){0,5}",
        r"(?:, )?(?:if|when) (?:(?:that|it|this) (?:is|was) (?:at all )?(?:possible|ok|okay|all right|fine|feasible|"
        r"not "
        r"too (?:much|hard|difficult)[a-z ]*)|(?:you|we) (?:can|could|would|will|please|like|do not mind))",
        r"(?:, )?(?:will|would|could|can) you(?= ?[,.;]|$)",
        r"for (?:this|the) (?:scene|clip|shot|film|take|version)",
        rf"(?:, )?(?:so(?: that)?|because|since) (?:he|she|it|they) (?:is|are|was|does|do|feels?|looks?|has|have|gets?)"
        rf"(?: not| never)? (?!(?:{_LOOKS})\b)(?:[a-z]+(?: |(?=[,.;]|$)))+",
        r"(?:, )?please(?= ?[,.;]|$)",
    )
)

_OTHERS = (
    r"(?:everything|all|anything|nothing|the rest|all (?:of )?the rest)(?: else)?(?: about (?:it|him|her|them|this|"
    r"that))?|(?:the |its |his )?(?:speed|pace|duration|timing|time|length|direction|path|way)(?: and (?:the |its "
    r")?(?:speed|pace|duration|timing|time|length|direction|path|way))*|(?:the|its|his|her|all the|both) (?:two |"
    r"three )?others?(?: (?:two|three|one|ones|\w+s))?|its (?:two )?neighbours?"
)
_ALL_ELSE = re.compile(  # "the other books remain as they are"
    rf"^(?:(?:and|but|while|so|the way) )*(?:{_OTHERS}) (?:(?:can|may|should|must|shall|will|is to|are to|simply|just|"
    rf"all|still) )*(?:{any_of((*MOTION, 'stay', 'start'), 'plain', 's')}|do|does|keep|keeps|is|are|be|go|goes|act|"
    r"behave|happen|leave)(?: (?:as|like|the|they|it|is|are|was|were|do|does|did|down|on|the same|same|still|"
    r"unchanged|untouched|alone|before|usual|normal|now|fine|ok|and|when|where|how|way|please|may|might|wish|want|"
    r"put|exactly|to|fall|move|there|tumble|happen|happens))*$"
)
_AS_BEFORE = re.compile(  # "after that he does just what he did before"
    r"^(?:(?:and|but|then|after (?:that|this|which)|afterwards|from (?:then|there) on|later|,) )*(?:it|he|she|they|"
    r"everything) (?:(?:just|simply|then|should|can|may|will|must) )*(?:does?|acts?|behaves?|goes?(?: on)?|moves?|"
    rf"continues?|carr(?:y|ies) on|keeps? going|{any_of(MOTION, 's', 'plain')})(?: on)? (?:(?:just|exactly|quite) "
    rf")?(?:what|as|like|the way|everything)(?: that)?(?: {_DOES})?(?: ?{_NOW})?(?: ,)?(?: until (?:the (?:wall|end)|"
    r"it (?:stops|ends|is done)))?$"
)
_THEN_ON = re.compile(  # "only then drops the rest of the way", "from then on it can be there"
    r"^(?:(?:and|but|only|then|after (?:that|this)|afterwards|from (?:then|there) on|it|he|she|they|should|can|may|"
    rf"will|is|be|shall) )*(?:(?:continues?|goes|carr(?:y|ies)|{any_of(MOTION, 's', 'plain')}) (?:on )?(?:the rest of "
    r"(?:the|its) (?:way|path|fall|journey))|(?:there|visible|back|seen|shown|in view|in sight)(?: again)?)$"
)
_WHY = re.compile(  # "they would jump", "we do not want a draught", "nobody wants that"
    r"^(?:(?:and|because|since|as) )*(?:(?:they|people|guests|everyone|everybody|someone|nobody|(?:my|our|the) "
    r"(?:kids|children|patients|[a-z]+)) (?:would|could|might|will|may) [a-z]+(?: [a-z]+){0,4}|(?:i|we|you) (?:do "
    r"not|would not) (?:want|like|need) (?:a|an|any|that|this)(?: [a-z]+){0,3}|(?:i|we|they|my [a-z]+|he|she) "
    r"(?:do|does|think|thinks|find|finds)(?: [a-z]+)? (?:too|so|it too))$"
)
_OWN_LOOK = re.compile(  # "before and after that it keeps its own brown"
    r"^(?:(?:and|but|before|after|afterwards?|that|this|then|otherwise|again|from then on) |, )*(?:it|he|she|they) "
    r"(?:(?:may|can|should|must|shall|will|just|simply|then) )*(?:keeps?|has|have|is|are|returns? to|goes back to|"
    r"gets? back) (?:back )?(?:in |to )?(?:its|his|her|their|the) (?:own|normal|usual|old|original|former|natural|"
    r"real|regular)(?: [a-z]+){0,2}$"
)
_ENOUGH = re.compile(
    r"^(?:(?:and|but|so) )*(?:that|this|it|the \w+)(?: (?:is|are|would be|will be|should be|'s))+ (?:(?:quite|really|"
    r"just|already|more than|all|perfectly) )*(?:plenty|enough|fine|ok|okay|good|perfect|right|nice|lovely|great|"
    rf"better|sufficient)(?: (?!{DURATION})[a-z]+)*$"
)
_STILL_NOW = re.compile(
    r"^(?P<np>.+?) (?:(?:is|are|'s) )?(?:(?:just|only|simply|always|still|currently|now) )*(?:stands?|standing|sits?|"
    r"sitting|lies?|lying|hangs?|hanging)(?: (?:just|only|still|there|here|around|about|idle|idly|doing nothing|and|"
    r"does|nothing|motionless|unused|all the time))*$"
)
_DEGREE = (
    r"(?:too|so|very|much|far|really|quite|rather|hardly|barely|a bit|a little|way|pretty|awfully|terribly|such|"
    r"always|never)"
)
_FOUND_SO = re.compile(  # "my son finds the robot too slow", "I think the door opens much too soon"
    r"^(?:(?:i|we|he|she|they|my [a-z]+|our [a-z]+|the (?:kids|children|director|client)) (?:(?:also|really|just|do|"
    r"does) )*(?:find|finds|think|thinks|feel|feels|say|says|believe|believes|guess|reckon|hate|hates)(?: that)? "
    rf")(?P<np>.+?) (?:(?:is|are|looks?|seems?|{any_of((*MOTION, 'start', 'stop'), 's', 'plain', 'ing')})(?: "
    rf"[a-z]+){{0,2}} )?{_DEGREE} [a-z]+(?: [a-z]+)*$"
)
_IS_SO = re.compile(  # "the drawer is staying open too much time", "that fan makes me quite dizzy"
    r"^(?P<np>(?:everything|it all|(?:the|this|that|my|our|these|those) (?:[a-z]+ ){0,2}?[a-z]+) )"
    r"(?:(?:is|are|keeps?) (?:making|driving|giving|hurting|bothering|annoying) (?:me|us|everyone|my)\b.*$|"
    r"(?:is|are|looks?|seems?|makes?|gets?|feels?|keeps?|clash|clashes|comes?|goes?|"
    rf"{any_of((*MOTION, 'stay', 'start', 'stop'), 's', 'plain')})(?: [a-z]+){{0,4}}? {_DEGREE} [a-z]+(?: [a-z]+)*$)"
)
_ORDERS = bag(
    "let make should must shall want wants need needs please instead have put turn paint hide remove delete freeze "
    "stop only would could can will like supposed ought do not never"
)
_COLORED = re.compile(rf"(?<!\S)(?:{HUES}|turquoise|teal)(?!\S)")


def without_comparisons(said: str) -> str:
    """An instruction without what only compares it with how it is now.

    >>> without_comparisons("let the ball start one second later than it does now")
    'let the ball start one second later'
    """
    for pattern in _COMPARED:
        said = pattern.sub("", said)
    return " ".join(said.split()).strip(" ,;")


def changes_nothing(part: str) -> bool:
    """Whether a part of an instruction, a sentence or what stands behind a comma, only says that all else stays, or is
    enough."""
    return any(pattern.match(part) for pattern in (_ALL_ELSE, _AS_BEFORE, _THEN_ON, _WHY, _OWN_LOOK, _ENOUGH))


_MORE_OR_LESS = re.compile(  # "the blue one should wait a bit longer", before it is said how long
    r"^(?P<np>(?:the|this|that|my) [a-z ]+?) (?:should|must|has to|needs to|is to|ought to|could|may) (?:[a-z]+ "
    r"){0,3}(?:a (?:bit|little)|some(?: time)?|somewhat|much|far) (?:longer|later|more|earlier|sooner|faster|"
    r"slower|quicker|less)$"
)


def told_of(part: str) -> str | None:
    """What a sentence is about that only tells how things are now; None if it may ask for anything.

    >>> told_of("the drawer is staying open too long")
    'the drawer'
    """
    if (vague := _MORE_OR_LESS.match(part)) is not None:
        return vague["np"]
    if _ORDERS & set(part.split()) or _COLORED.search(part) or re.search(r"\d", part):
        return None
    for pattern in (_FOUND_SO, _IS_SO, _STILL_NOW):
        if (found := pattern.match(part)) is not None:
            return found["np"].strip()
    return None
