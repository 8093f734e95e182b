"""Questions that are put into a time by a sentence of its own: "it's 1.5 seconds: is the book still up there?"."""

from __future__ import annotations

from .....gaussians import late_re as re

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
_OR = re.compile(r", or\?$", re.IGNORECASE)
_LENGTH = re.compile(r"^by what (?:length|distance)\b(?:, in (?P<unit>\w+),)?", re.IGNORECASE)
_OVER = re.compile(r"^what(?:'s| is)? (?P<who>the [a-z]+) rolling over\b", re.IGNORECASE)


def situated(text: str) -> str:
    """A question with the time that it is put into, without whom it is said to, and with plain words for a length."""
    said = _OR.sub("?", _TO_SOMEBODY.sub("", text.strip()))
    if (at := _AT.match(said) or _BARE.match(said)) is not None:
        rest = _THEN.sub("", said[at.end() :]).rstrip(" ?.!")
        said = f"{rest} at {at['time']}?" if rest else said
    said = _OVER.sub(r"what is \g<who> on", said)
    return _LENGTH.sub(lambda found: f"how far in {found['unit']}" if found["unit"] else "how far", said)
