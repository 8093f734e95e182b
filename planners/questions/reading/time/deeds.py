"""Verbs of motion and states that change: "roll", "come to rest", "hit", "fall off", "half open", "at rest"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal

Kind = Literal[
    "move", "turn", "open", "close", "fall", "land", "reach", "enter", "leave", "cross", "pass", "approach", "recede",
    "bob", "appear", "vanish", "still", "is_open", "is_closed", "related", "start", "stop", "slows",
    "speeds_up", "nearest", "farthest", "recolor",
]  # fmt: skip
Phase = Literal["", "start", "stop", "half", "full"]


@dataclass(frozen=True)
class Deed:
    """What something does, or the state that it is in.

    Attributes:
        kind: "still" is a state, as are "is_open" and "is_closed"; "related": a relation holds; "start" and "stop"
            leave open of what.
        phase: its "start" or "stop"; of a state that it holds by "half" or in "full".
        relation: name of the relation, of "related".
        way: "out", "back", "left", "up", ...: said with the verb; "" if none is.
        verb: as said.
    """

    kind: Kind
    phase: Phase = ""
    relation: str = ""
    way: str = ""
    verb: str = ""


_IRREGULAR = {
    "go": "went gone", "run": "ran", "drive": "drove driven", "slide": "slid", "fly": "flew flown", "swing": "swung",
    "spin": "spun", "fall": "fell fallen", "shut": "", "hit": "", "leave": "left", "meet": "met", "strike": "struck",
    "begin": "began begun", "come": "came", "freeze": "froze frozen", "stand": "stood", "get": "got", "make": "made",
    "creep": "crept", "lose": "lost", "sink": "sank sunk", "keep": "kept", "become": "became", "take": "took",
    "rise": "rose risen", "sit": "sat", "lie": "lay", "set": "", "give": "gave",
}  # fmt: skip

_DOUBLED = frozenset(
    [
        "stop",
        "travel",
        "drop",
        "run",
        "spin",
        "hop",
        "step",
        "get",
        "shut",
        "hit",
        "set",
        "sit",
        "bob",
        "slip",
        "pop",
        "begin",
        "quit",
    ]
)


def forms(*verbs: str) -> str:
    """All forms of verbs as a group of a pattern: "(?:rolling|rolled|rolls|roll)"."""
    return f"(?:{'|'.join(sorted({f for v in verbs for f in _forms(v)}, key=len, reverse=True))})"


def _forms(verb: str) -> Iterator[str]:
    yield verb
    doubled = verb + verb[-1] if verb in _DOUBLED else verb
    stem = verb.removesuffix("e") if verb.endswith("e") and not verb.endswith("ee") else doubled
    yield (
        verb + ("es" if verb.endswith(("s", "sh", "ch", "x", "o")) else "s")
        if not verb.endswith("y")
        else (verb[:-1] + "ies" if verb[-2] not in "aeiou" else verb + "s")
    )
    yield stem + "ing"
    if verb == "lie":
        yield "lying"
    if verb in _IRREGULAR:
        yield from _IRREGULAR[verb].split()
    else:
        yield verb[:-1] + "ied" if verb.endswith("y") and verb[-2] not in "aeiou" else stem + "ed"


_GO = forms(
    "move", "go", "travel", "roll", "walk", "run", "drive", "slide", "glide", "fly", "shift", "wander", "march",
    "float", "drift", "budge", "advance", "stroll", "hop", "creep", "crawl", "step", "stride", "cruise", "proceed",
    "jump",
)  # fmt: skip
_COME = forms("come", "get", "pull", "pop", "stick", "extend")
_TURNS = forms("turn", "spin", "rotate", "revolve", "swing", "whirl", "twirl", "swivel", "pivot", "circle")
_START = forms("start", "begin", "commence")
_STOP = forms("stop", "finish", "end", "cease", "quit", "halt")
_BE = r"(?:is|are|was|were|be|been|being|am|'s)"
_ITS = r"(?:its|the|their|his|her|a|an)"
_BACK = r"(?:back in again|back inside|back in|back again|in again|back|again)"
_NOUNS: dict[Kind, str] = {
    "move": r"(?:movement|motion|moving|roll|ride|walk|trip|journey|run|travel|path|way|slide|action|animation)",
    "turn": r"(?:turn|turning|rotation|spin|spinning|swing|revolution|corner|curve|bend)",
    "open": r"(?:opening)", "close": r"(?:closing|shutting)",
    "fall": r"(?:fall|drop|falling|tumble|plunge|descent)",
    "land": r"(?:landing|impact|touchdown)", "reach": r"(?:contact|collision|hit|impact|arrival|touch|bump|crash)",
    "stop": r"(?:stop|halt|end|standstill)", "start": r"(?:start|beginning)", "cross": r"(?:crossing)",
}  # fmt: skip
_REACH = (
    rf"(?:{forms('reach', 'hit', 'touch', 'contact', 'meet', 'strike')})|"
    rf"(?:{forms('bump', 'run', 'crash', 'bang', 'knock', 'roll', 'slam', 'smash', 'drive', 'walk')}) (?:into|"
    rf"against)|"
    rf"(?:{forms('collide')}) with|(?:{forms('arrive')})(?: (?:at|on|in|by|near|next to|beside|with))?|"
    rf"(?:{forms('get', 'come', 'make it', 'go', 'roll', 'walk', 'move')}|made it) (?:all the way )?(?:up )?to|"
    rf"(?:{forms('make', 'come', 'have', 'get')}|has) (?:first |its first |the first )?(?:in |into )?contact with|"
    rf"(?:{forms('come')}) into contact with|{_BE} (?:at|against) (?=the )|"
    rf"(?:{forms('come')}) up (?:to|against)"
)


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], Deed], ...]:
    """Every way of saying a deed, the longer and the more specific ones first."""
    both = rf"(?:{_GO}|{_TURNS}|{_COME})"
    rows: list[tuple[str, Deed]] = [
        # states that change
        (rf"(?:{_BE} |stands? |stays? |remains? |gets? |becomes? )?(?:half|halfway|partly|half way|50 %|50 percent) "
         r"(?:open|opened|out|closed|shut)", Deed("is_open", "half")),
        (rf"(?:{_BE} |stands? |stays? |remains? |gets? |becomes? |staying )?(?:fully|completely|all the way|wide|"
         rf"totally|"
         r"entirely|as far as it goes|maximally|quite) (?:open|opened|out|extended)|(?:at|reach(?:es)?) (?:its "
         r")?(?:widest|"
         r"maximum opening|full opening)", Deed("is_open", "full")),
        (rf"(?:{_BE} |stands? |stays? |remains? |gets? |becomes? |staying )?(?:fully|completely|all the way|totally|"
         rf"entirely|quite) (?:closed|shut|back in|in|back)(?: again)?", Deed("is_closed", "full")),
        (rf"(?:finish(?:es|ed)?|stops?|done|ends?) (?:opening|sliding out|coming out|moving out)|"
         rf"{_BE} (?:done|finished) opening|open(?:s|ed)? (?:fully|completely|all the way)|(?:fully|completely) opens?",
         Deed("open", "stop")),
        (rf"(?:finish(?:es|ed)?|stops?|done|ends?) (?:closing|shutting|sliding (?:back )?in)|{_BE} (?:done|finished) "
         r"(?:closing|shutting)|(?:close|shut)s? (?:fully|completely|all the way)|(?:fully|completely) (?:close|"
         r"shut)s?",
         Deed("close", "stop")),
        (rf"(?:{_START}) (?:to )?(?:{forms('open')}|(?:{_GO}|{_COME}) (?:out|open))|(?:{_START}) {_ITS} opening",
         Deed("open", "start")),
        (rf"(?:{_START}) (?:to )?(?:{forms('close', 'shut')}|(?:{_GO}|{_COME}) (?:{_BACK}|in|shut))|"
         rf"(?:{_START}) {_ITS} closing", Deed("close", "start")),
        (rf"(?:{_BE} |stands? |stays? |remains? |staying |standing )(?:still )?(?:open|opened|ajar|pulled out|"
         r"extended|out(?=$| at| again))(?: again)?", Deed("is_open")),
        (rf"(?:{_BE} |stands? |stays? |remains? |gets? |staying )(?:still )?(?:closed|shut|back in place|pushed in|"
         r"in(?=$| again))(?: again)?", Deed("is_closed")),
        # stops and starts
        (rf"(?:{forms('come', 'roll', 'slow', 'grind')}) (?:down )?to (?:a |an |its )?(?:full |complete |final "
         rf")?(?:rest|stop|"
         rf"halt|standstill|end)|(?:{_STOP}) (?:to )?(?:{_GO}|{_TURNS}|being in motion)(?: (?:around|round|about))?|"
         rf"(?:{_STOP}) {_ITS} (?:{_NOUNS['move']}|{_NOUNS['turn']})|(?<!the )(?<!very ){_STOP}|"
         rf"{forms('settle', 'freeze', 'pause')}|"
         rf"{_BE} (?:all )?(?:done|finished|over)(?: (?:{_GO}|{_TURNS}))?|(?:{forms('stand')}) still(?= again)|"
         rf"(?:{forms('come')}) to a? ?stillness|no longer {_GO}", Deed("stop")),
        (rf"(?:{_START}) (?:to )?(?:{forms('fall', 'drop', 'tumble', 'plunge')})|(?:{_START}) {_ITS} {_NOUNS['fall']}",
         Deed("fall", "start")),
        (rf"(?:{_START}) (?:to )?(?:turn|turning)(?: left| right)?", Deed("turn", "start")),
        (rf"(?:{_START}|{forms('come', 'set out')}|set off) (?:out )?from", Deed("start", way="from")),
        (rf"(?:{_START}) (?:to |in )?(?:be in )?(?:{both}|motion)(?: (?:around|round|about))?|(?:{_START}) {_ITS} "
         rf"(?:{_NOUNS['move']}|{_NOUNS['turn']})|(?:{forms('set')}) (?:off|out|in motion)|(?:{forms('take')}) off|"
         rf"(?:{forms('get')}) (?:going|moving|rolling)|(?:{forms('go', 'move')}) off(?! )|(?<!the )(?<!very "
         rf"){_START}(?: up)?",
         Deed("start")),
        # falling
        (rf"(?:{forms('fall', 'drop', 'tumble', 'plunge', 'topple')}) (?:down )?(?:off|from|out of)", Deed("fall")),
        (rf"(?:{forms('land')})(?: (?:on|onto|upon))?|(?:{forms('touch')}) down|"
         rf"(?:{forms('fall', 'drop')}) (?:down )?(?:to|on|onto|on to|into) (?=the (?:floor|ground|rug|carpet))|"
         rf"(?:{forms('hit', 'reach', 'touch', 'strike')}) (?:the )?(?:ground|floor)|{_BE} on the (?:ground|floor)",
         Deed("land")),
        (rf"(?:{forms('fall', 'drop', 'tumble', 'plunge', 'topple', 'plummet', 'sink', 'descend')})(?: (?:down|"
         rf"over))?|"
         rf"(?:{forms('come', 'go')}) (?:down|falling)(?! to)|(?:{_GO}) downwards?", Deed("fall", way="down")),
        (rf"(?:{forms('make', 'do', 'take')}) (?:its|a|the) (?:fall|drop|tumble)", Deed("fall")),
        (rf"(?:{_BE} )?(?:in (?:the |mid ?)air|airborne|mid fall|in free fall)", Deed("fall")),
        # up and down, left and right, near and far
        (rf"{forms('bob', 'bounce', 'wobble')}(?: up and down)?|(?:{_GO}) up and down", Deed("bob")),
        (rf"(?:{forms('get', 'come', 'move', 'go', 'roll', 'walk', 'become')}|{_BE}) (?:any )?(?:closer|nearer) (?:to|"
         rf"toward|"
         rf"towards)|(?:{forms('approach')})", Deed("approach")),
        (rf"(?:{forms('get', 'come', 'move', 'go', 'roll', 'walk', 'become')}|{_BE}) (?:farther|further|more distant) "
         rf"(?:away )?(?:from|of)|(?:{forms('get', 'move', 'go', 'roll', 'walk')}) away from|(?:{forms('increase')}) "
         rf"{_ITS} distance (?:to|from)", Deed("recede")),
        (rf"(?:{forms('make', 'do', 'take', 'perform')}) (?:its|a|an|the|this)(?: left| right)? (?:turn|corner|curve|"
         rf"bend|"
         r"rotation)|(?:change|changes|changing|changed) (?:its |the )?direction|(?:turn|turns|turned|turning) "
         r"(?:left|right|around|the corner|to (?:the|its) left|to (?:the|its) right|its direction|direction)",
         Deed("turn")),
        # open and close
        (rf"(?:{_COME}|{_GO}|pulled|is pulled) (?:all the way )?(?:out|open)(?: of(?= ))?|(?:{forms('open')})(?: up)?|"
         rf"(?:{_TURNS}) open", Deed("open", way="out")),
        (rf"(?:{_COME}|{_GO}|{forms('push', 'return')}) (?:all the way )?(?:{_BACK}|back inside|in|inside|shut|closed)"
         rf"(?! to)|(?:{forms('close', 'shut', 'retract', 'return')})(?: again)?|(?:{_TURNS}) (?:shut|closed|back)",
         Deed("close", way="in")),
        (rf"(?:{forms('slow')})(?: down)?|(?:{forms('get', 'become')}|{_BE}) slower|(?:{forms('lose')}) speed|"
         r"(?:decelerate|decelerates|brakes?)", Deed("slows")),
        (rf"(?:{forms('accelerate')})|(?:speed|speeds|speeding) up|(?:{forms('get', 'become')}|{_BE}) (?:faster|"
         rf"quicker)|"
         rf"(?:{forms('gain')}) speed", Deed("speeds_up")),
        # places
        (rf"(?:{forms('leave', 'exit')})|(?:{_GO}|{_COME}|step|steps|comes?) (?:off|out of)(?= )|"
         rf"(?:{forms('depart')})(?: from)?|(?:{forms('lose')}) (?:the )?contact with|(?:{_STOP}) touching|"
         rf"(?:{_STOP}) (?:being )?on|{_BE} (?:off|past the end of)(?= the )|(?:{forms('clear')})", Deed("leave")),
        (rf"(?:{forms('cross', 'traverse')})|(?:{_GO}|{forms('pass')}) (?:across|over|through|along)", Deed("cross")),
        (rf"(?:{_GO}|{forms('come')}) (?:past|by|right past)|(?:{forms('pass')})(?: (?:by|next to|beside|near|in "
         rf"front of))?",
         Deed("pass")),
        (rf"(?:{forms('enter')})|(?:{_GO}|{_COME}) (?:onto|on to|on(?= (?:the|a) (?:\w+ )?(?:rug|carpet|mat)))",
         Deed("enter")),
        (_REACH, Deed("reach")),
        # looks
        (rf"{forms('disappear', 'vanish')}|(?:{forms('go')}) away(?! from)|{_BE} gone", Deed("vanish")),
        (rf"{forms('appear', 'reappear')}|(?:{forms('show')}) up|{forms('become')} visible", Deed("appear")),
        (rf"(?:{_BE} |gets? |comes? |{forms('come')} )?(?:the )?(?:closest|nearest) to", Deed("nearest")),
        (rf"(?:{_BE} |gets? )?(?:the )?(?:farthest|furthest) (?:away )?from", Deed("farthest")),
        (rf"(?:{forms('change')})(?: (?:its|the|their))? (?:colors?|looks?|appearance)|(?:{_TURNS}) (?:another|a "
         rf"different) color",
         Deed("recolor")),
        # still, moving
        (rf"(?:{_BE} |stays? |remains? |stands? |keeps? |sits? |lies |stayed |standing |staying |lying )?(?:in (?:its "
         rf"|the |"
         rf"one )?(?:same )?(?:place|spot|position)|put|where (?:it|they) (?:is|are|was|were)|still|at rest|"
         rf"motionless|"
         rf"stationary|at a standstill|immobile|unmoved|fixed|static|not (?:{_GO}|{_TURNS})|resting|stopped|waiting|"
         rf"wait)|(?:do|does|did) not (?:{_GO}|{_TURNS}|change its place)|never (?:{_GO}|{_TURNS})"
         rf"(?: still)?|{forms('rest', 'wait')}", Deed("still")),
        (rf"(?:{_BE} )?(?:in motion|on the move|active|going round|going around)", Deed("move")),
        (rf"(?:{_TURNS})(?: (?:around|round|about))?|(?:{forms('go')}) (?:round|around)|(?:{forms('make', 'do')}) "
         rf"(?:turns|"
         rf"rotations|revolutions)", Deed("turn")),
        (rf"(?:{_GO}|traveled|traveling)(?: to (?:the|its))? (?:left|right|forwards?|backwards?|up|upwards?)(?= |$)",
         Deed("move")),
        (rf"(?:{_GO})(?: (?:around|about|along|away|there|anywhere|somewhere))?", Deed("move")),
        (r"(?:all )?(?:over|finished|done)$", Deed("stop")),
        (r"(?:switch|switches|turn|turns|go|goes|shut|shuts)(?: itself)? off$", Deed("stop")),
        (r"(?:switch|switches|turn|turns|come|comes|go|goes) on$", Deed("start")),
        (r"(?:cover|covers|covered|covering)$", Deed("move")),
        (r"in$", Deed("is_closed")),
        (r"out$", Deed("is_open")),
    ]  # fmt: skip
    return tuple((re.compile(rf"(?<!\w)(?:{pattern})(?!\w)"), deed) for pattern, deed in rows)


_NOUN_ROWS: tuple[tuple[re.Pattern[str], Deed], ...] = tuple(
    (re.compile(rf"(?:the |its |their |a |this )?(?:first |whole |entire |complete )?{pattern}"), Deed(kind))
    for kind, pattern in _NOUNS.items()
)


_WAY = re.compile(r"\b(left|right|up|forward|backward)s?(?:wards)?$")


def said_in(text: str) -> Iterator[tuple[int, int, Deed]]:
    """The deeds that a text may tell: start, stop and sense; at each place the longest, and earlier rows first."""
    found: list[tuple[int, int, Deed]] = []
    for pattern, deed in _patterns():
        for m in pattern.finditer(text):
            if not any(a <= m.start() < b or a < m.end() <= b for a, b, _ in found):
                way = _WAY.search(m.group()) if deed.kind in ("move", "turn") else None
                said = way.group(1) if way is not None else deed.way
                found.append((m.start(), m.end(), Deed(deed.kind, deed.phase, deed.relation, said, m.group())))
    yield from sorted(found, key=lambda f: f[0])


@cache
def verb_words() -> frozenset[str]:
    """Words that are forms of verbs of motion, which no thing is called by."""
    groups = (
        _GO,
        _COME,
        _TURNS,
        _START,
        _STOP,
        forms("fall", "hit", "reach", "strike", "arrive", "happen", "open", "bob"),
    )
    return frozenset(w for group in groups for w in group.removeprefix("(?:").removesuffix(")").split("|"))


def as_noun(text: str) -> Deed | None:
    """The deed that a noun names: "the turn", "its fall", "impact"; None if it names none."""
    for pattern, deed in _NOUN_ROWS:
        if pattern.fullmatch(text):
            return Deed(deed.kind, verb=text)
    return None
