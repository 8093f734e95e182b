"""The kind of wish that an instruction is of, and which of its words name what.

`training/timed_words.py` learns both from written sentences.
"""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re
from ...learned.marks import Span
from ...learned.network import networks, told
from ...tagging.spelling import is_captioned, is_word
from ...tagging.words import split
from ...vocabulary.nouns import is_known
from ..verbs import SENSES, has_form

TASK = "wishes"
NO_WISH = "none"  # the kind of questions, remarks, and wishes that are about neither time nor motion
COURSES = (  # kinds that are about how what is there moves by itself
    "begin", "speed", "duration", "pause", "halt", "still", "reverse", "stay", "order", "together", "repeat", "return",
    "longer",
)  # fmt: skip
_DONE_BY = {  # the operations by which a wish of a kind is done; the other kinds are about how something moves
    "recolor": ("recolor", "restyle"), "hide": ("opacity", "delete"), "remove": ("delete", "opacity"),
    "move": ("move", "follow", "orbit", "rotate", "pace", "order", "delete"),
    "spin": ("spin", "orbit", "rotate", "pace"),
    "pause": ("pace",), "halt": ("pace", "articulate"),
    "amount": ("articulate", "pace", "move"), "open": ("articulate", "pace"), "close": ("articulate", "pace"),
}  # fmt: skip
_COURSED_BY = ("pace", "articulate", "order", "spin", "move", "follow")
_CHANGED_BY = {  # changes of a motion by which a wish of a kind is done
    "begin": ("begin", "later", "stop"), "speed": ("speed", "begin"), "duration": ("begin", "speed", "later"),
    "pause": ("stop",), "halt": ("stop", "part"), "still": ("stop",), "reverse": ("reverse", "mirror", "return"),
    "repeat": ("repeat", "back_and_forth"), "return": ("return", "reverse", "back_and_forth"),
    "longer": ("go_on", "repeat", "begin", "speed"), "stay": ("stop",), "amount": ("part", "stop"),
    "together": ("begin", "later"), "order": ("begin", "later"),
}  # fmt: skip
STATIC = ("recolor", "hide", "remove", "move")  # kinds that need no time
LEAST = 0.08  # probability of a kind that is told at all
MOST = 4  # kinds that are told
SURE = 0.85  # probability from which a change without a time is supposed, or an unknown verb is left aside
CLEARLY = 0.65  # probability from which a kind is taken without a word that says it
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


_UNSEEN = re.compile(
    r"\b(?:nobody|no one|no-one) (?:\w+ )?(?:saw|sees?|to see)\b|\b(?:invisible|unseen|out of sight)\b|"
    r"\bnot (?:to )?be seen\b",
    re.IGNORECASE,
)
_SO_LONG = re.compile(
    r"\b(?:times|twice) (?:as (?:long|slow|slowly)\b|longer\b|slower\b|the (?:time|duration|length)\b)", re.IGNORECASE
)
_TO_TAKE = re.compile(  # "the cart should take half a second", which is wished
    r"\b(?:should|must|shall|has to|needs to|ought to|is to|are to|have to|let \w+(?: \w+)?) (?:only |just )?take "
    r"(?:\w+ ){0,3}(?:seconds?|secs?|s)\b",
    re.IGNORECASE,
)


def likely(said: str, still: bool = False) -> list[tuple[str, float]]:
    """The kinds of wish that an instruction may be of, with probabilities, the likeliest first; none if it is likelier
    no such wish.

    Args:
        still: whether what it is about does not move by itself: it then asks for no other course of a motion.
    """
    known = list(told(TASK, tuple(word.text for word in split(said))).kinds)
    chances = dict(known)
    if _TO_TAKE.search(said) is not None:
        chances["duration"] += chances.pop(NO_WISH)
    if _UNSEEN.search(said) is not None:  # is asked of no course of a motion
        chances["hide"] += sum(chances.pop(kind, 0.0) for kind in COURSES)
    if _SO_LONG.search(said) is not None:  # and not so often
        chances["speed"] += chances.pop("repeat", 0.0)
    known = sorted(chances.items(), key=lambda own: -own[1])
    if still:
        rest = 1.0 - sum(chance for kind, chance in known if kind in COURSES)
        known = [(kind, chance / rest) for kind, chance in known if kind not in COURSES and chance >= LEAST]
    found = [(kind, chance) for kind, chance in known[:MOST] if chance >= LEAST]
    return [] if found and found[0][0] == NO_WISH else found


def is_clear(kind: str, chance: float, said: str) -> bool:
    """Whether a kind is likely enough, or one of some words says that a wish is of it; that something is not to be seen
    only words for seeing say: "keep the bed still" hides nothing."""
    words = _HIDES if kind == "hide" else _EVIDENCE[kind]
    return chance >= (SURE if kind == "reverse" else CLEARLY) or words.search(said) is not None


def is_done_by(kind: str, op: str) -> bool:
    """Whether an operation may be what a wish of a kind asks for."""
    return op in _DONE_BY.get(kind, _COURSED_BY)


def is_changed_by(kind: str, change: str) -> bool:
    """Whether a change of a motion may be what a wish of a kind asks for."""
    return change in _CHANGED_BY.get(kind, (change,))


def marked(words: Sequence[str]) -> tuple[Span, ...]:
    """Which words of an instruction name a thing (`x`), where that goes (`y`), from when, until when, while and for
    how long something is to be (`from`, `to`, `in`, `for`), by how much (`by`), as which colour (`as`), what is not
    wanted (`not`), and what asks for nothing (`off`)."""
    return told(TASK, tuple(words)).spans


def marked_ways(words: Sequence[str]) -> tuple[tuple[Span, ...], ...]:
    """As `marked`, in likely ways, the likeliest first."""
    return told(TASK, tuple(words)).ways


def is_any_word(word: str) -> bool:
    """Whether a word stands in any of the vocabularies, in captions of pictures, or in the sentences that kinds were
    learned from; what is begun again is one, too: "reschedule"."""
    return (
        is_word(word)
        or is_known(word)
        or word in networks().places
        or has_form(word, tuple(SENSES), "plain", "s", "ing", "past")
        or is_captioned(word)
        or (word.startswith("re") and is_captioned(word[2:]))
    )
