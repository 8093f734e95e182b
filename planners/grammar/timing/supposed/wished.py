"""Whether a sentence wishes for something, and does not tell how things are or ask about them."""

from __future__ import annotations

from .....gaussians import late_re as re

_ORDERS = (
    r"paint|make|turn|colou?r|recolou?r|change|dye|tint|take|get rid|remove|delete|strike|lose|ditch|bin|scrap|clear|"
    r"drop|cut|chuck|dump|toss|throw|erase|kill|give|have|let|put|withdraw|banish|do away with"
)
_WISHES = re.compile(
    r"(?:^|[,.;:!] |\b(?:please|just|and|so|then|now|kindly|maybe|go ahead and|help me) )(?:please |just )?"
    rf"(?:{_ORDERS})\b|"
    r"\b(?:can|could|would|will|might|may|shall) (?:you|we|i|the|that|this|my|our|all|it)\b|"
    r"\b(?:i|we) (?:would|should|will|'d|had) (?:\w+ ){0,2}?(?:like|love|prefer|want|rather|go for|appreciate|see)\b|"
    r"\b(?:i|we) (?:\w+ )?(?:want|wish|need|prefer)\b|\bi am wanting\b|^would (?:love|like|prefer)\b|"
    r"\b(?:should|must|ought to|needs? to|has to|have to|wants to|is to|are to|had better) (?:\w+ )?"
    r"(?:be|go|become|turn|disappear|vanish|leave|come off)\b|\b(?:needs?|wants) (?:painting|removing|recolou?ring)\b|"
    r"\bwould (?:\w+ )?(?:look|be|read|suit|do|work|go|feel|seem) (?:\w+ )?(?:better|nicer|nice|great|good|lovely|"
    r"well|prettier|best|fine|perfect|in)\b|"
    r"\b(?:better|nicer?|great|lovely|preferable|happy|grateful|delighted|happier) (?:\w+ )?(?:if|that|to have)\b|"
    r"\b(?:how|what) about\b|\blet(?:'s| us)\b|\bplease\b"
)
_ASKS = re.compile(
    r"^(?:what|which|who|whose|where|why|when|how (?!about)|is|are|was|were|does|do you|did|has|am)\b|"
    r"\b(?:know|wonder|wondering|tell me|ask|explain|whether|think|guess|suppose|remember|imagine|describe)\b"
)
_DENIES = re.compile(r"\b(?:not|never|nothing|no one|nobody|if|unless|except|without)\b")


def is_wished(said: str) -> bool:
    """Whether words ask for something: "I would love the bed in pink", and not "the bed is pink"."""
    return _WISHES.search(said) is not None and _ASKS.search(said) is None


def is_denied(text: str) -> bool:
    """Whether the words of a wish say what is not to be, or on what it depends."""
    return _DENIES.search(text) is not None
