"""Questions that are put into a time by a sentence of its own: "it's 1.5 seconds: is the book still up there?"."""

from __future__ import annotations

from .....gaussians import late_re as re
from ....grammar.vocabulary.nouns import is_known

_AT = re.compile(  # "say I'm at 1.7 seconds.", "cut to 0.7 s.", "looking at the frame at 4.5 s,"
    r"^(?:(?:say|suppose|imagine|assume|ok|okay|so|now|right)[, ]+)*"
    r"(?:it(?: is|'s)|(?:i|we)(?: am|'m| are|'re) (?:now )?at|(?:cut|jump|skip|go|scrub|spool|wind) to|"
    r"(?:pause|freeze|stop) (?:it )?at|(?:looking at |in |at )?the (?:frame|picture|moment|point|image) at)\s+"
    r"(?P<time>(?:t ?= ?)?\d+(?:\.\d+)? ?(?:s|secs?|seconds?))\b[ .,:;!-]*(?:and )?",
    re.IGNORECASE,
)
_BARE = re.compile(r"^(?P<time>\d+(?:\.\d+)? ?(?:s|secs?|seconds?))(?: in)?,? and (?=the\b|is\b|are\b)", re.IGNORECASE)
_TO_SOMEBODY = re.compile(
    r",? (?:hun|hon|honey|love|mate|darling|dear|pal|buddy|sweetheart|luv|dude)(?=[ .?!]*$)", re.IGNORECASE
)
_THEN = re.compile(r"\b(?:right )?then(?=[ .?!]*$)", re.IGNORECASE)
_NAMED = re.compile(  # "Yellow car. Does it shift at any point?"
    r"^(?:(?:the|that|this|my|our) )?(?P<name>(?:[a-z]+ )?[a-z]+)[.:!] "
    r"(?P<rest>(?:does|is|has|did|was|can|when|where|how)\b.+)$",
    re.IGNORECASE,
)
_IT = re.compile(r"\b(?:it|he|she)\b", re.IGNORECASE)
_HOW_FAR = re.compile(r"^(?:by )?(?:what angle|how far|how wide|how many degrees)\b", re.IGNORECASE)
_WHEN_OPEN = re.compile(
    r",? (?:once|when|after) (?:it|the [a-z]+) (?:is|has) (?:been )?(?:(?:fully|all the way|completely) )?"
    r"(?:open(?:ed)?|stopped)\b"
)
_OR = re.compile(r", or\?$", re.IGNORECASE)
_LENGTH = re.compile(r"^by what (?:length|distance)\b(?:, in (?P<unit>\w+),)?", re.IGNORECASE)
_OVER = re.compile(
    r"^(?:[a-z]+, )?what(?:'s| is)? (?P<who>(?:the|that|this|my) [a-z]+) rolling over(?: right)?\b", re.IGNORECASE
)


def situated(text: str) -> str:
    """A question with the time that it is put into, without whom it is said to, and with plain words for a length."""
    said = _OR.sub("?", _TO_SOMEBODY.sub("", text.strip()))
    if (at := _AT.match(said) or _BARE.match(said)) is not None:
        rest = _THEN.sub("", said[at.end() :]).rstrip(" ?.!")
        said = f"{rest} at {at['time']}?" if rest else said
    if (named := _NAMED.match(said)) is not None and is_known(named["name"].split()[-1].lower()):
        said = _IT.sub(f"the {named['name'].lower()}", named["rest"], count=1)
    if _HOW_FAR.match(said):
        said = _WHEN_OPEN.sub("", said)
    said = _OVER.sub(r"what is \g<who> on", said)
    return _LENGTH.sub(lambda found: f"how far in {found['unit']}" if found["unit"] else "how far", said)
