"""Verbs of time and motion by their sense, as data; all their forms are made by code.

To teach the program a verb, add it to the line of its sense in `SENSES`, in its plain form; words that belong to it
stand behind it ("slow down"), and may be parted from it by an object ("slow the door down").
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from ..tagging.words import bag

Form = Literal["plain", "s", "ing", "past"]

SENSES: dict[str, str] = {
    # what moves how
    "open": "open, open up, unlatch, crack open, swing open, slide open, slide out, come out, pull open, pull "
        "out, push open, fling open, throw open, go open, roll out, extend, draw open, draw out, crack, shoot out, "
        "pop out, glide out, glide open, creep open, burst open, roll open, "
        "shoot open, spring open, ease open, peek out",
    "close": "close, close up, shut, swing shut, swing closed, slide shut, slide closed, slide in, slide back "
        "in, go back in, push in, push shut, pull shut, slam, slam shut, fall shut, push closed, pull "
        "closed, retract",
    "spin": "spin, rotate, revolve, twirl, whirl, turn, swivel, twist, gyrate, pirouette, pivot, go round, go "
        "around, spin round, spin around, turn round, turn around, rotate around, twirl around, go round "
        "and round",
    "go": "roll, walk, drive, fly, glide, run, hop, crawl, march, wander, stroll, travel, jump, hover, scoot, "
        "trundle, dance, creep, rush, race, sail, slither, cruise, zoom, drift, trot, bounce, swing, float, "
        "ride, sway, shuffle, step, proceed, coast, saunter, wave, flutter, flap, billow, ripple, undulate",
    "move": "move, go, come, slide, shift, return, head, get, push, pull, carry, send, bring, take, drag, "
        "shove, haul, translate, relocate, transfer, put, lead, steer, pass",
    "rise": "rise, ascend, climb, levitate, lift, lift off, lift up, raise, hoist, elevate, float up, rise up, "
        "soar",
    "sink": "sink, descend, lower, sink down",
    "fall": "fall, drop, tumble, plunge, fall down, fall off, drop down, drop off, come "
        "down, plummet",
    "bob": "bob, wobble, shake, tremble, bob up and down, hover up and down, move up and down, "
        "go up and down, jump up and down, hop up and down, float up and down, bounce up and down, vibrate, jiggle, "
        "rattle, quiver, shiver, rock, totter, teeter, "
        "leap",
    "tip": "tip over, topple over, knock over, keel over, tumble over, tip, overturn, push over, turn over, fall over, "
        "topple, fall flat, knock down",
    "orbit": "orbit, circle, circle around, circle round, orbit around",
    "follow": "follow, chase, pursue, trail, run after, go after, drive after, walk after, follow behind, drive "
    "behind, "
        "walk behind, follow along behind, tag along with, tag along behind, trail behind, follow after",
    "repeat": "repeat, loop, ping pong, cycle",
    "blink": "blink, flicker, strobe, flash",
    "do": "do, make, perform, complete",
    # its time
    "stop": "stop, halt, freeze, pause, die, arrest, immobilize, immobilise, block, interrupt, stop moving, wait, "
        "hold still, hold, hold on, cease, come to a stop, come to a halt, come to rest, come to a rest, "
        "come to a standstill, come to an end, settle, take a break, hang back, hold off, hang on, stand by, bring "
        "to a halt, bring to a stop, bring to a standstill, bring to rest, come to a complete stop, "
        "stop dead, come to a dead stop, come to a sudden stop, get stuck, end, finish, park, be done, "
        "rest, have a rest, take a rest, have a break, take a breather, have a breather, have a pause, take a pause, "
        "make a pause, make a stop, make a halt, pull up, draw to a halt, grind to a halt",
    "prevent": "prevent, hinder, stop, keep, block, hold",
    "stay": "stay, remain, stand, keep, sit, lie, stay up",
    "start": "start, begin, commence, set off, set out, get going, get moving, kick off, launch, trigger, "
        "activate, take off, depart, start up, initiate, happen, start off, kick in, set in, get started, come on, "
        "spring into action, get under way, make its entrance, make his entrance, make its move, make a start, "
        "get off, swing into action",
    "continue": "continue, go on, carry on, keep, keep on, continue on, resume",
    "faster": "speed up, step up, rush, accelerate, step on it, rev up, hurry, hurry up, quicken, hasten, speed, "
    "get faster, pick up speed, become "
        "faster",
    "slower": "slow, slow down, decelerate, brake, get slower, become slower, slow up",
    "change": "change, set, adjust, alter, take, bring, take down, bring down, dial down, take up, bring up, dial up",
    "increase": "increase, bump up, crank up, turn up",
    "reduce": "reduce, decrease, cut, drop, turn down, lower",
    "double": "double",
    "triple": "triple, treble",
    "halve": "halve",
    "reverse": "reverse, rewind, invert, flip, mirror, switch, swap",
    "delay": "delay, postpone, hold back, shift back, set back, hold up, retard, put off, defer, push back, move "
    "back, put back",
    "advance": "advance, bring forward, shift forward, hasten, move forward, pull forward, prepone",
    "play": "play, run, show, render, replay, do",
    # how it looks
    "hide": "disappear, vanish, go away, hide, despawn, conceal, remove, kill, lose, take out, take away, get "
        "rid of, delete, erase, blank out, cut, poof, leave the room, leave the scene, be gone, cut out, "
        "drop out, make away with, turn invisible, go invisible, become invisible, get out, clear away, "
        "whisk away, go missing",
    "show": "appear, show up, pop up, pop in, show, reveal, spawn, unhide, display, materialize, materialise, "
        "come into view, come into sight, become visible, reappear, turn visible",
    "fade": "fade, fade out, fade away, dissolve, melt away, dissolve away",
    "look": "turn, become, go, get, flash, glow, shine, look, change to, change into, change color to, change "
        "colour to, turn to, turn into, light up",
    "paint": "mark, paint, color, colour, dye, tint, stain, recolor, recolour, turn, make, repaint, flash, spray, "
        "change, light up",
    "off": "turn off, switch off, shut off, shut down, go off, turns off, power off, power down",
    "on": "turn on, switch on, power up, power on",
    # only of what happens, in a clause that tells a time
    "reach": "reach, touch, hit, strike, meet, contact, bump into, bump against, crash into, crash against, "
        "collide with, knock into, knock against, arrive at, arrive in, arrive by, get to, come to, make it "
        "to, run into, roll to, roll into, roll against, roll up to, walk to, walk up to, drive to, go to, "
        "move to, land on, land in, come up to, arrive on, slam into, bang into, get near, approach, be at, "
        "be against, bump on, knock on, bang on, bump, knock, smack, slam, bang, nudge, make contact with, "
        "come into contact with, hit against, "
        "bounce off",
    "arrive": "arrive, land, touch down",
    "leave": "leave, exit, get off, roll off, go off, move off, come off, fall off, drive off, walk off, step "
        "off, get away from, roll away from, move away from, be off, be past, come out from, lose contact "
        "with, depart from",
    "enter": "enter, get on, get onto, get into, roll on, roll onto, go onto, go into, move onto, drive onto, "
        "walk onto, come onto, slide onto, step on, step onto, jump on, climb on, walk into, roll into, go "
        "on, run onto",
    "cross": "cross, pass, pass over, roll over, roll across, go over, go across, traverse, drive over, walk "
        "over",
}  # fmt: skip

_IRREGULAR = {
    "go": "went gone", "run": "ran run", "drive": "drove driven", "slide": "slid", "fly": "flew flown",
    "swing": "swung", "spin": "spun", "fall": "fell fallen", "shut": "shut", "hit": "hit", "leave": "left",
    "meet": "met", "put": "put", "strike": "struck", "begin": "began begun", "come": "came come", "sink": "sank sunk",
    "freeze": "froze frozen", "stand": "stood", "get": "got gotten", "make": "made", "creep": "crept", "lose": "lost",
    "keep": "kept", "become": "became become", "take": "took taken", "rise": "rose risen", "sit": "sat",
    "lie": "lay lain", "set": "set", "hide": "hid hidden", "do": "did done", "hold": "held", "send": "sent",
    "bring": "brought", "lead": "led", "cut": "cut", "show": "showed shown", "light": "lit", "shine": "shone",
    "throw": "threw thrown", "draw": "drew drawn", "ride": "rode ridden", "fling": "flung", "be": "was were been",
    "speed": "sped speeded", "shake": "shook shaken",
}  # fmt: skip
_OTHER_S = {"be": "is are", "do": "does", "have": "has"}
_DOUBLED = bag("stop drop run spin hop step get shut hit set sit bob slip pop begin cut put trot slam flip swap tip")


@dataclass(frozen=True)
class Verb:
    """A verb as it was found.

    Attributes:
        sense: a key of `SENSES`.
        form: of its first word.
        taken: how many words it is.
        said: its plain form.
    """

    sense: str
    form: Form
    taken: int
    said: str

    @property
    def first(self) -> str:
        """The plain form of its first word."""
        return self.said.split(" ")[0]


def forms(verb: str) -> Iterator[tuple[str, Form]]:
    """The forms of a verb, and which they are.

    >>> list(forms("stop"))
    [('stop', 'plain'), ('stops', 's'), ('stopping', 'ing'), ('stopped', 'past')]
    """
    yield verb, "plain"
    for form in _OTHER_S.get(verb, _with_s(verb)).split():
        yield form, "s"
    doubled = verb + verb[-1] if verb in _DOUBLED else verb
    stem = verb[:-1] if verb.endswith("e") and not verb.endswith(("ee", "be")) else doubled
    yield ("lying" if verb == "lie" else f"{stem}ing"), "ing"
    regular = verb[:-1] + "ied" if verb.endswith("y") and verb[-2] not in "aeiou" else f"{stem}ed"
    for form in _IRREGULAR.get(verb, regular).split():
        yield form, "past"


def _with_s(verb: str) -> str:
    if verb.endswith("y") and verb[-2] not in "aeiou":
        return verb[:-1] + "ies"
    return verb + ("es" if verb.endswith(("s", "sh", "ch", "x", "o")) else "s")


@dataclass(frozen=True)
class _Entry:
    sense: str
    form: Form
    rest: tuple[str, ...]  # the words behind the first
    said: str


@cache
def _entries() -> dict[str, tuple[_Entry, ...]]:
    """By the first word in any form, the longest first."""
    found: dict[str, list[_Entry]] = {}
    for sense, verbs in SENSES.items():
        for said in verbs.split(", "):
            first, *rest = said.split(" ")
            for form, kind in forms(first):
                found.setdefault(form, []).append(_Entry(sense, kind, tuple(rest), said))
    return {w: tuple(sorted(es, key=lambda e: -len(e.rest))) for w, es in found.items()}


def verbs_at(words: Sequence[str], place: int) -> Iterator[Verb]:
    """The verbs that stand at a place, the longest first."""
    for entry in _entries().get(words[place], ()):
        end = place + 1 + len(entry.rest)
        if tuple(words[place + 1 : end]) == entry.rest:
            yield Verb(entry.sense, entry.form, end - place, entry.said)


def parted_verbs(words: Sequence[str]) -> Iterator[tuple[Verb, int]]:
    """Verbs at the start whose other words stand behind an object ("slow the door down"), and where these begin."""
    for entry in _entries().get(words[0], ()):
        width = len(entry.rest)
        for start in range(2, len(words) - width + 1) if width else ():
            if tuple(words[start : start + width]) == entry.rest:
                yield Verb(entry.sense, entry.form, 1, entry.said), start


def has_form(word: str, senses: Sequence[str], *wanted: Form, whole: bool = True) -> bool:
    """Whether a word is a verb of some senses in one of the forms, and if `whole` all of it: "rolling" of "go"."""
    return any(e.sense in senses and e.form in wanted and not (whole and e.rest) for e in _entries().get(word, ()))


def any_of(senses: Sequence[str], *wanted: Form) -> str:
    """All verbs of one word of some senses in some forms, as a group of a pattern."""
    found = [
        w for w, es in _entries().items() if any(e.sense in senses and e.form in wanted and not e.rest for e in es)
    ]
    return f"(?:{'|'.join(sorted(found, key=len, reverse=True))})"
