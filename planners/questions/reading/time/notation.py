"""A notation for the ways in which people say one thing, as data; a verb in it stands for all its forms.

~come to [a] (rest|halt)      verbs with a tilde in all their forms, optional words, alternatives
GO away | ~leave              a class of verbs, and several ways
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache

from ....grammar.tagging.words import bag

_IRREGULAR = {
    "go": "went gone", "run": "ran", "drive": "drove driven", "slide": "slid", "fly": "flew flown", "swing": "swung",
    "spin": "spun", "fall": "fell fallen", "shut": "", "hit": "", "leave": "left", "meet": "met", "strike": "struck",
    "begin": "began begun", "come": "came", "freeze": "froze frozen", "stand": "stood", "get": "got gotten",
    "make": "made", "creep": "crept", "lose": "lost", "sink": "sank sunk", "keep": "kept", "become": "became",
    "take": "took taken", "rise": "rose risen", "sit": "sat", "lie": "lay lain", "set": "", "give": "gave given",
    "do": "did does done", "have": "has had having", "stick": "stuck", "draw": "drew drawn", "wind": "wound",
    "spend": "spent", "find": "found", "hold": "held", "grind": "ground", "shake": "shook shaken", "quit": "",
    "be": "is are was were been am 's", "undergo": "underwent undergone", "spring": "sprang sprung",
    "burst": "", "put": "", "say": "said", "show": "shown", "see": "saw seen", "grow": "grew grown", "speed": "sped",
}  # fmt: skip
_PAST = bag(" ".join(_IRREGULAR.values())) - bag("does am is are 's having")
_DOUBLED = bag(
    "stop travel drop plop flop run spin hop step get shut hit set sit bob slip pop begin quit skid flip tip jog ram "
    "whir flap"
)

CLASSES = {
    "GO": "move go travel roll walk run drive slide glide fly shift wander march float drift budge advance stroll hop "
    "creep crawl step stride cruise proceed jump head journey trundle race stir jog pace skid wave flutter flap billow "
    "ripple undulate",
    "COME": "come get pull pop stick poke protrude jut",
    "TURN": "turn spin rotate revolve swing whirl twirl swivel pivot circle gyrate wheel veer pirouette",
    "FALL": "fall drop tumble plunge topple plummet sink descend plop flop",
    "BUMP": "bump crash bang knock slam smash run ram collide roll drive walk bounce",
    "START": "start begin commence resume",
    "END": "stop finish end cease quit halt",
    "STAY": "stay remain stand keep rest lie sit get become hold",
    "DO": "make do take perform complete have get give undergo execute finish",
    "UP": "rise ascend climb lift",
}
_FIXED = {
    "BE": "is|are|was|were|be|been|being|am|'s|gets|get|got",
    "ITS": "its|the|their|his|her|a|an",
    "FULL": "fully|completely|all the way|entirely|totally|wide|maximally|quite|the whole way|as far as it goes",
    "SO": "perfectly|completely|totally|absolutely|quite|entirely|fully|dead|stock",
    "GROUND": "ground|floor",
}


def forms(*verbs: str) -> str:
    """All forms of verbs as a group of a pattern: "(?:rolling|rolled|rolls|roll)"."""
    return f"(?:{'|'.join(sorted({f for v in verbs for f in _forms(v)}, key=len, reverse=True))})"


def _forms(verb: str) -> Iterator[str]:
    yield verb
    consonant_y = verb.endswith("y") and verb[-2] not in "aeiou"
    yield verb[:-1] + "ies" if consonant_y else verb + ("es" if verb.endswith(("s", "sh", "ch", "x", "o")) else "s")
    dropped = verb.endswith("e") and not verb.endswith("ee") and verb != "be"
    stem = verb[:-1] if dropped else verb + verb[-1] if verb in _DOUBLED else verb
    yield "lying" if verb == "lie" else stem + "ing"
    yield from _IRREGULAR.get(verb, verb[:-1] + "ied" if consonant_y else stem + "ed").split()


def inflected(verb: str, like: str) -> str:
    """A verb in the form of another verb: "move" like "rolling" is "moving"."""
    found = list(_forms(verb))
    if like.endswith("ing") and like not in ("bring", "cling", "fling", "sling", "spring", "swing"):
        return found[2]
    if like.endswith("s") and not like.endswith("ss"):
        return found[1]
    return found[3] if len(found) > 3 and (like.endswith("ed") or like in _PAST) else verb


@cache
def pattern(notation: str) -> str:
    """A line of the notation as a regular expression, to be matched before a space: every word ends with one."""
    signs = {"[": "(?:", "]": ")?", "(": "(?:", ")": ")", "|": "|"}
    return "".join(signs.get(t) or _word(t) for t in re.findall(r"[\[\]()|]|[^\s\[\]()|]+", notation))


def _word(token: str) -> str:
    if token in CLASSES:
        return f"{forms(*CLASSES[token].split())} "
    if token in _FIXED:
        return f"(?:{pattern(_FIXED[token])})"
    return f"{forms(token[1:])} " if token.startswith("~") else f"{re.escape(token)} "


def verb_forms(notation: str) -> Iterator[str]:
    """All forms of the verbs of `CLASSES` and of those in a notation."""
    for verb in {*" ".join(CLASSES.values()).split(), *re.findall(r"~(\w+)", notation)}:
        yield from _forms(verb)
