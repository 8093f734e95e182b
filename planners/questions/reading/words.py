"""Puts a question into a plain form: lower-case words without politeness, hedges and quotation marks.

"Could you tell me, roughly, how far the sofa is from the window, please?" becomes "how far the sofa is from the
window".
"""

from __future__ import annotations

import re

from ....gaussians.errors import UserError
from ...grammar.tagging.words import bag, clean, split

MAX_CHARS = 1000

_OPENERS = re.compile(
    r"^(?:(?:hi|hey|hello|ok|okay|so|well|um+|uh+|hmm+|please|quick question|just (?:curious|wondering|checking)|"
    r"out of curiosity|one more thing|by the way|btw|and|but|also|then|now|oh|right|sorry|excuse me|actually) ?)+"
)
_ASKING = re.compile(
    r"^(?:can|could|would|will) (?:you|u|someone|anyone|anybody) (?:please |kindly |maybe |possibly |quickly )?"
    r"(?:tell me|say|check|work out|figure out|find out|let me know|give me|show me|name me|measure|describe|list|"
    r"name|count|see)"
    r"|^(?:please )?(?:tell me|let me know|say|check|work out|figure out|find out|measure)\b"
    r"|^(?:do|would|might) you (?:happen to )?(?:know|have any idea(?: of)?|reckon|think|say|guess)\b"
    r"|^(?:have you|you have|got|have) any (?:idea|clue)(?: of| about)?"
    r"|^any (?:idea|clue|chance|guess)(?: of| about| that)?(?: (?:you|i|we) (?:can|could) (?:tell me|say|know))?"
    r"|^(?:i am|i was|we are|we were) (?:just )?(?:wondering|curious)(?: about)?"
    r"|^(?:i am|i was|we are|we were) trying to (?:find out|figure out|work out)"
    r"|^i (?:just )?(?:wonder|want to know|need to know|would like to know|would love to know|want to ask|"
    r"can not tell|do not know|forgot|need to find out)"
    r"|^(?:what i want to know is|the question is|my question is)"
    r"|^(?:is it (?:true|right|correct)|am i (?:right|correct))(?: in (?:thinking|saying|assuming))?(?: that)?"
)
_FIRST_WORDS = bag(
    "what which where who whose when why how is are was were does do did can could has have will would should whether "
    "list name count describe measure any"
)
_KEPT = {"list", "name", "count", "describe", "measure", "show me", "give me", "name me", "see"}
_CLOSERS = re.compile(
    r"(?: (?:please|thanks|thank you|cheers|for me|mate|exactly|roughly|approximately|then|though|anyway|by any chance|"
    r"at all|right now|at the moment|currently|would you say|do you (?:think|reckon|know)|or not|or so|i wonder|"
    r"can you tell|if you had to guess|in your opinion))+$"
)
_TAGS = re.compile(
    r" (?:(?:is|are|was|does|do|has|have|can) not (?:it|there|they|he|she|that|we|i)|right|yes|no|correct)$"
)
_HEDGES = re.compile(
    r"\b(?:roughly|approximately|approx|exactly|precisely|actually|currently|basically|really|just|kind of|sort of|"
    r"by any chance|perhaps|maybe|possibly)\b "
)
_WHETHER = re.compile(r"^(?:whether or not|whether|if)\b ?")


def plain_words(text: str) -> tuple[str, ...]:
    """The words of a question in lower case, without politeness and punctuation; commas are words.

    Raises:
        UserError: it is longer than `MAX_CHARS`.
    """
    if len(text) > MAX_CHARS:
        raise UserError(f"the question has {len(text)} characters, at most {MAX_CHARS} are read; ask it in parts")
    said = " ".join(w.text for w in split(clean(text)) if w.text not in (".", "?", "!", ";", ":"))
    said = f" {said} ".replace(" , ", " , ").strip(" ,")
    return tuple(_stripped(said).split())


def asks(text: str) -> bool:
    """Whether a text that is no edit is a question: by its first word or its question mark."""
    words = plain_words(text)
    return bool(words) and (text.rstrip().endswith("?") or words[0] in _FIRST_WORDS)


def _stripped(said: str) -> str:
    """The words without openers, closers, question tags and hedges, until nothing more can be taken away.

    A clause behind "tell me whether" keeps the word "whether", by which templates tell statements from questions.
    """
    before = ""
    while said != before:
        before = said
        said = _OPENERS.sub("", said).strip(" ,")
        said = _CLOSERS.sub("", said).strip(" ,")
        said = _TAGS.sub("", said).strip(" ,")
        said = _HEDGES.sub("", said)
        asked = _ASKING.match(said)
        if asked and asked.end() < len(said):
            verb = next((k for k in sorted(_KEPT, key=len, reverse=True) if asked.group().endswith(k)), "")
            rest = said[asked.end() :].strip(" ,")
            said = f"{verb} {rest}" if verb else _WHETHER.sub("whether ", rest)
    return said
