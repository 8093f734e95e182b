"""Takes the frame of a wish off its words: "could we maybe have X, that would be nice" is X; and asides behind it.

Light, materials, holes and shadows are asked for in the same frames, so they are told here once. What is left is read
by the part that knows the words of the wish.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.words import bag

_COURTESY = (
    r"please|pls|kindly|hey|hi|hello|ok|okay|well|so|now|then|next|also|and|but|just|simply|maybe|perhaps|possibly|"
    r"actually|really|honestly|hmm|oh|yes|yeah|right|alright|finally|ideally|let us see|i know|you know|"
    r"quickly|for me|for us|as well|too|dear|mate|love"
)
_SPEAKER = r"(?:i|we)"
_REALLY = r"(?:(?:really|just|also|still|actually|much|rather|kind of|sort of|definitely|probably|quite|please) )*"
_TO_HAVE = (
    r"(?: (?:to (?:have|see|get|try|go (?:for|with)|make|be able to (?:have|see))|you to|if (?:you|we) (?:could|would)|"
    r"seeing|having|trying|for|if|that|it if)(?= ))*"
)
_OPENINGS = (
    rf"(?:{_COURTESY})",
    rf"(?:can|could|would|will|may|might|shall|should) (?:you|{_SPEAKER}|someone|somebody|it be possible to) {_REALLY}"
    r"(?:(?:be so kind as to|be able to|mind|help me|help me to|manage to|try to|perhaps|maybe|get|have|see|try|go for|"
    r"go with|want|like|love|prefer) )*",
    rf"{_SPEAKER} {_REALLY}(?:would|could|might|will)? ?{_REALLY}(?:like|love|prefer|want|need|fancy|wish|wanted|"
    rf"appreciate|enjoy|do with|use|be happier with|be happy with|rather have|rather){_TO_HAVE}",
    rf"{_SPEAKER} (?:am|are|was|were) (?:after|thinking(?: of| about)?|hoping(?: for| to have| to get)?|"
    rf"looking for|wondering if (?:you|we) (?:could|can)|going for|imagining|picturing){_TO_HAVE}",
    rf"{_SPEAKER} (?:think|thought|feel|reckon|guess|suppose|believe|say)(?: that)?(?= (?:the|it|this|that|we|my|a|"
    rf"an) )",
    r"(?:how|what) about|(?:any chance of|is there (?:a|any) way (?:to|of)|is it possible to|"
    r"do you think (?:you|we) (?:could|can)|would it be possible to|would you be able to|why do not (?:you|we)|why "
    r"not)",
    r"let us (?:try|have|go (?:for|with)|do|make|see|get)|let us|go (?:for|with)|give (?:me|us)|show (?:me|us)|"
    r"get (?:me|us)|try|picture|imagine|time (?:for|to)|i would say|we (?:should|could) (?:have|get|try|go for)",
    r"it (?:would|might) be (?:nice|great|good|lovely|cool|better|best) (?:to have|to see|if (?:we|you) (?:had|could)|"
    r"to|if|with)",
)
_OPENING = re.compile(rf"^(?:{'|'.join(_OPENINGS)})(?: ,)* (?=\S)")
_PRAISE = (
    r"nice|nicer|lovely|lovelier|great|good|better|best|cool|perfect|amazing|beautiful|fine|ideal|fantastic|gorgeous|"
    r"awesome|wonderful|brilliant|fab|stunning|super|sweet|fitting|more like it|right|prettier|neat|pretty|handsome"
)
_CLOSINGS = (
    rf"(?:{_COURTESY}|thanks|thank you|cheers|ta|if possible|if you can|if you could|if you like|overall|in general|"
    r"instead|for now|again|this time|or so|i think|i guess|do you think|darling|honey|guys|everyone|for a change|"
    r"if you please|"
    r"if you do not mind|when you can|nicely|properly|neatly)",
    rf"(?:that |it |which )?(?:would|will|might|could) (?:be|look|feel|work|suit|fit|do)(?: (?:so|really|much|very|"
    rf"even|a "
    rf"lot|far|way|just|quite|the))*(?: (?:{_PRAISE}))?(?: (?:here|there|in here|in this room|for this room|with "
    rf"it|now))?",
)
_CLOSING = re.compile(rf"(?: ,)*(?<=\S) (?:{'|'.join(_CLOSINGS)})$")
_MOST = 6
_ASIDES = bag(
    "so because since as like when while until whereas for to that which where though although unless before after "
    "i we they it he she people my everyone you"
)
_NEVER_FIRST = bag("to for and or but with in on of at the a an by")
_TELLING = bag("i we he she they it my our people guests everyone nobody you because since as so that there this")
_ASKING = bag(
    "want need please make turn put should must would could can add remove delete paint move change give like love "
    "prefer "
    "let set get take rather swap replace use have bring hide lose also red blue green white black"
)
_REPORTED = re.compile(
    r"^(?:(?:he|she|they|someone|somebody|everyone|everybody|people|my \w+|the (?:client|boss|neighbou?rs?)) "
    r"(?:said|says|told|thinks?|thought|had|has|have|used|was|were|likes?|loves?|wanted|bought|painted|turned|asked)\b|"
    r"(?:yesterday|last (?:night|week|month|year|time)|once|back then|in the past|years ago|earlier)\b|"
    r"(?:i|we) (?:had|have|bought|saw|made|painted|used to|once|already|was|were|did|like|love|hate|adore|enjoy|know|"
    r"think that|see|own|remember|turned|moved|put)\b|(?:if|unless|when|whenever|suppose|even if) )"
)


def unframed(said: str) -> str:
    """A sentence without what asks for it: "could we have X please" to "X"; words parted by spaces."""
    for _ in range(_MOST):
        before = said
        said = _CLOSING.sub("", _OPENING.sub("", said)).strip(" ,")
        if said == before:
            break
    return said


def without_asides(words: Sequence[str]) -> Iterator[list[str]]:
    """The words without what stands behind a word that begins a reason, an aim, a comparison or another clause, the
    shortest cut first."""
    for at in range(len(words) - 1, 0, -1):
        if words[at] in _ASIDES and words[at - 1] not in _NEVER_FIRST:
            yield list(words[:at])


def asks_nothing(said: str) -> bool:
    """Whether a clause beside a request only gives a reason: it begins with who or what, and no word of it asks."""
    words = said.lower().replace("'", " ").split()
    return bool(words) and words[0] in _TELLING and not _ASKING & set(words)


def is_reported(said: str) -> bool:
    """Whether a sentence tells what was, what others say, or what would be: it asks for nothing."""
    return _REPORTED.match(said) is not None
