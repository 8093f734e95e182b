"""Whether a sentence wishes for something, and does not tell how things are or ask about them."""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re
from ...learned.marks import Span, held_by
from ...tagging.words import bag
from ..asides import HUES
from .kinds import SURE

_ORDERS = (
    r"paint|make|turn|colou?r|recolou?r|change|dye|tint|take|get rid|remove|delete|strike|lose|ditch|bin|scrap|clear|"
    r"drop|cut|chuck|dump|toss|throw|erase|give|have|withdraw"
)
_WISHES = re.compile(
    r"(?:^|[,.;:!] |\b(?:please|just|and|so|then|now|kindly|maybe) )(?:please |just |kindly )?"
    rf"(?:{_ORDERS})\b|"
    r"\b(?:can|could|would|will) (?:you|we|somebody|someone|anybody|anyone)\b|^(?:,|so|and)? ?(?:can|could|may|might) |"
    r"\b(?:could|can) (?:really )?(?:do with|use)\b|\bdeserves?\b|"
    r"\b(?:i|we) (?:would|should) (?:\w+ ){0,2}?(?:like|love|prefer|want|go for|rather have)\b|"
    r"\b(?:i|we) (?:\w+ )?(?:want|wish|need|prefer)\b|^would (?:love|like|prefer)\b|"
    r"\b(?:should|must|ought to|needs? to|has to|have to|wants to|is to|are to) "
    r"(?:be|go|become|turn|disappear|vanish)\b|\b(?:can|could) (?:\w+ )?(?:be|go|become|turn)\b|"
    r"\bwould (?:\w+ )?(?:look|read|suit|do|work|go|show|be|stand|sit) (?:\w+ )?(?:better|nicer|nice|great|good|"
    r"lovely|well|prettier|best|[a-z]+er)\b|^please\b|\bhad better be\b|\bsuits? (?:it|him|her|them) better\b|"
    r"\b(?:coat|lick|touch) of\b|\b(?:you )?may (?:carry|take|throw|cart)\b|\bgo away\b|\bnever see\b|"
    r"\bhave (?:it|him|her|them) (?:torn|taken|ripped|carried)\b"
)
_RID_OF_IT = re.compile(
    r"(?:[,.;:!] |\b(?:please|and|so|just|you|we|i|to|rather) )"
    r"(?:get rid of (?:it|them)|(?:take|throw) (?:it|them) (?:away|out)|"
    r"(?:remove|delete|bin|ditch|scrap|lose) (?:it|them))\b"
)
_RID = re.compile(
    r"\b(?:do|does|done|away|out|off|down|dispense) with\b|\b(?:without|minus|superfluous)\b|"
    r"\b(?:delet\w+|remov\w+|eras\w+|omit\w*|leav\w+ (?:\w+ )?out|left out|be missing|go missing)\b|"
    r"\bthere (?:should|ought|must|shall|were|be|is to|are to)\b.{0,12}\b(?:no|not|never)\b|"
    r"\b(?:not|no longer|hardly) (?:\w+ )?(?:want\w*|need\w*|required|necessary|welcome)\b|\bnot have\b|^no \w|"
    r"\bwith no\b|\bnot (?:contain|seen)\b|\bpack\b.{0,8}\bbags\b|\bone does not need\b"
)
_NOT_RID = re.compile(
    r"\b(?:not|never|nobody|no one)\b.*\b(?:gone|removed|deleted|away|taken|thrown|erased|disappear)\b"
)
_ANY_AT_ALL = re.compile(r"^no\b.*\?$")  # "no black chairs?"
_UNSEEN = re.compile(  # that something is not to be seen is a wish, too
    r"\b(?:must|should|may|can|need|shall|to) (?:not|never) (?:appear|show|exist|be (?:seen|shown|there|visible|in))\b"
)
_ELSEWHERE = re.compile(
    r"\b(?:should|must|ought to|needs? to|has to|have to|wants? to|is to|are to|can|could|might|may|would|shall) "
    r"[a-z]+|"
    r"\b(?:ends?|end|finish\w*) up\b"
)
_DENIED = re.compile(r"\b(?:not|never|no one|nobody|if|unless|or|but)\b")
CERTAINLY = 0.93  # probability of a wish of its kind that no word has to say
_IS = re.compile(r"\b(?:is|are|was|were|has|have|had|looks?|seems?|used|should|if)\b|\?")
SURELY = 0.95  # probability of a wish of its kind from which any other words may stand in it
_ASKS = re.compile(  # or tells
    r"\b(?:know|knows|whether|wonder|wondering|remember|recall|what|which|who|whose|why|when|where|how|said|says?|told|"
    r"tells?|thought|heard|believed?|agree|calls?|called|imagine|think|(?<!the )picture|treated|seen|for all|"
    r"i (?:want|need) is|"
    r"yesterday|ago|used to|tomorrow|earlier|last (?:week|month|year|time|night))\b"
)
_FOR_GOOD = re.compile(
    r"\b(?:always|throughout|definitive(?:ly)?|"
    r"(?:for|over|in|during) (?:all of )?the (?:whole|entire|full) (?:film|clip|video|movie|time|scene)|"
    r"from (?:the )?(?:first|start|beginning)(?: \w+)? to (?:the )?(?:last|end|finish)|"
    r"for ?ever|permanent(?:ly)?|for good|once and for all|from now on|for keeps|remain so|stay(?:s|ing)? "
    r"(?:so|that way|like that)|(?:keep|leave) (?:it|them) (?:that way|like that|so))\b"
)
_CHOICE = re.compile(rf"\b(?:{HUES}) or (?:\w+ )?(?:{HUES})\b")
_THAT_I_WANT = re.compile(
    r"\b(?:the|a|that|this) \w+ (?:that )?(?:i|we) (?:want|need|wanted|like|love) (?:is|are|was|were)\b"
)
_CONTRARY = re.compile(r"(?:how|what) about not\b")
_BESIDE = bag(  # that may stand in a wish beside what is marked
    "i we you would could can may might like love want wish prefer rather need needs to have make turn paint "
    "painted painting change changed give get rid of be become go going take away out off down remove removed "
    "gone disappear vanish lose ditch bin scrap strike drop delete dump toss chuck throw cut clear erase withdraw "
    "completely altogether entirely permanently permanent please just now really so kindly maybe and then all "
    "both in into as with for me us the a an it him her them that this one lick coat colour color look nicer "
    "better nice good great lovely well suit read do done has must should ought there here wants seen from scene "
    "picture"
)


def is_wished(words: Sequence[str], spans: Sequence[Span], chance: float, kind: str = "") -> bool:
    """Whether a sentence asks for something: "I would love the bed in pink", and not "the bed is pink already".

    Args:
        words: those of the sentence.
        spans: the marks in them.
        chance: the probability that it is a wish of its kind.
        kind: that kind.
    """
    idle, held = held_by(spans, "off", "not"), held_by(spans)
    left = [word for at, word in enumerate(words) if at not in held and word.isalpha()]
    asked = " ".join(word for at, word in enumerate(words) if at not in idle).strip(" ,.")
    said = " ".join(words)
    if kind in ("hide", "remove"):
        asked = _UNSEEN.sub("goes away", asked)
    if _CONTRARY.match(said) or _CHOICE.search(said) or _THAT_I_WANT.search(said):
        return False
    if chance >= SURE and _FOR_GOOD.search(said) is not None:
        return True  # "my car is red, and not for a bit: always"
    if _RID_OF_IT.search(f"{asked} . {said}") and _DENIED.search(asked) is None:
        return True  # "the lamp is ugly, get rid of it"
    plainly = _DENIED.search(asked) is None and _ASKS.search(said) is None
    asks = any(pattern.search(said) is not None for pattern in (_ASKS, _NOT_RID, _ANY_AT_ALL))
    if kind == "remove" and chance >= SURELY and not asks and _RID.search(asked):
        return True  # "I would rather have the room without the lamp"
    if kind == "move" and chance >= SURE and plainly and _ELSEWHERE.search(asked):
        return True  # "the ball should roll to the lamp instead"
    if chance >= CERTAINLY and plainly and not _IS.search(asked):
        return True  # "rug: purple, permanent"
    surely = chance >= SURELY and _DENIED.search(asked) is None and _ASKS.search(asked) is None
    return (surely or all(word in _BESIDE for word in left)) and _WISHES.search(asked) is not None
