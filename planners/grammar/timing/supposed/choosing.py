"""Which of the kinds of wish that an instruction may be of it is taken for.

The kind that is likely enough, and whose command holds all that the instruction names. A kind that is less likely is
taken where a word says it, and the other kinds that are about as likely make no command: "do the whole walk in 2 s"
repeats nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .....gaussians import late_re as re
from ..command import Fields
from ..moments import TIMED
from .kinds import NO_WISH

CLEARLY = 0.9  # probability from which a kind is taken without a word that says it
UNTIMED = 0.32  # the least probability of any kind that is taken where no time is told
SHARE = 0.5  # of the probability of all rivals, which a word says or which are no wish: from it another one is taken
_FIRST = 2
_BY_WORDS = {  # words of which one at least says that a wish is of a kind
    "recolor": r"colou?r\w*|paint\w*|turn\w*|go(?:es)?|become\w*|be|make|made|in|tint\w*|dye\w*",
    "hide": r"hid\w*|invisible|gone|vanish\w*|disappear\w*|appear\w*|see|seen|saw|sight|visible|show\w*|lose|there|"
    r"view|away|eyes",
    "remove": r"strike|scrap|ditch|bin|chuck|dump|toss|cut|take|"
    r"remov\w*|delet\w*|rid|away|out|without|gone|lose|drop|absent|no|not",
    "move": r"move\w*|push\w*|slid\w*|lift\w*|rais\w*|put|bring|drive|drives|roll\w*|float\w*|carr\w*|drift\w*|go|goes|"
    r"travel\w*|glid\w*|shift\w*|to|over",
    "spin": r"spin\w*|twirl\w*|turn\w*|rotat\w*|whirl\w*|pirouette\w*|revolv\w*|circle\w*",
    "begin": r"start\w*|begin\w*|earlier|later|sooner|delay\w*|wait\w*|leaves?|sets?|off|immediately|early|late|"
    r"instead|already",
    "speed": r"slow\w*|fast\w*|quick\w*|speed\w*|half|double|twice|pace|times|percent|%",
    "duration": r"tak\w+|last\w*|in|over|seconds?|within|spread|stretch\w*",
    "pause": r"paus\w*|wait\w*|stop\w*|hold|freez\w*|rest|still|halt\w*|hang\w*|stand\w*|stay\w*",
    "halt": r"stop\w*|freez\w*|halt\w*|still|end\w*|finish\w*|conclude\w*|motionless|off",
    "still": r"not|never|still|no|budge|stay\w*|leave|keep|put|unmoving|frozen|without",
    "reverse": r"back\w*|revers\w*|rewind|rewound|opposite|other|undo|invert\w*|contrary|wrong|clockwise",
    "stay": r"stay\w*|remain\w*|keep|leave|open|out|not|never",
    "amount": r"degrees?|deg|°|cm|m|met(?:re|er)s?|centimet(?:re|er)s?|half|halfway|third|quarter|further|wider|far",
    "open": r"open\w*|out|swing\w*|ajar",
    "close": r"clos\w*|shut\w*|back|in",
    "order": r"first|last|then|after|before|order|turn|next|sequence|followed",
    "together": r"together|same|once|simultaneous\w*|unison|sync\w*|both|all|time",
    "repeat": r"again|repeat\w*|twice|thrice|times|loop\w*|over|once more|another|second time|keep\w*|non ?stop",
    "return": r"back|return\w*|again|home",
    "longer": r"longer|keep\w*|until|till|whole|entire|full|on|continue\w*|all the|end",
}
_HIDES = re.compile(
    r"\b(?:hid\w*|invisible|gone|vanish\w*|disappear\w*|appear\w*|seen?|saw|sight|visible|show\w*|lose|view|"
    r"(?:leave|keep) (?:it|him|her|the [a-z ]+?) out)\b"
)
_EVIDENCE = {kind: re.compile(rf"(?<!\S)(?:{words})(?!\S)") for kind, words in _BY_WORDS.items()}


@dataclass(frozen=True)
class Offer:
    """A kind, its probability, and the operations that it would make of an instruction; none if it makes none."""

    kind: str
    chance: float
    made: tuple[Fields, ...] = ()


def chosen(offers: Sequence[Offer], said: str, least: float) -> tuple[Fields, ...] | None:
    """The operations of the kind that an instruction is taken for; None if none is likely enough.

    Args:
        offers: the likeliest first.
        said: the words of the instruction.
        least: probability of a kind that no word has to say.
    """
    for offer in offers[:_FIRST]:
        if offer.kind == NO_WISH:
            break
        if offer.made and offer.chance >= max(least, CLEARLY):
            return offer.made
    rivals = [offer for offer in offers if offer.kind == NO_WISH or (offer.made and says(offer.kind, said))]
    best = next(iter(rivals), None)
    if best is None or not best.made or best.chance < SHARE * sum(offer.chance for offer in rivals):
        return None
    return best.made if best.chance >= UNTIMED or _is_timed(best, said) else None


def _is_timed(offer: Offer, said: str) -> bool:
    """Whether an instruction tells a time, in numbers or by what happens."""
    return TIMED.search(said) is not None or all(op.get("when") is not None for op in offer.made)


def says(kind: str, words: str) -> bool:
    """Whether one of some words says that a wish is of a kind."""
    return _EVIDENCE[kind].search(words) is not None


def says_plainly(kind: str, words: str) -> bool:
    """As `says`, and that something is not to be seen only by words for seeing: "keep the bed still" hides nothing."""
    return _HIDES.search(words) is not None if kind == "hide" else says(kind, words)
