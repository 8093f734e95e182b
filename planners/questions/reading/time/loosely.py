"""Reads a question about a scene with time as a last resort, whatever the order of its words.

What is asked (its cue), a time, things and one deed are taken out wherever they stand. If what is left says nothing,
the question is put together from them in the order that the strict reader knows:

    "robby the robot, to the bed he gets at which second?"  ──►  "when does the robot get to the bed"

Negations, numbers, comparisons, ranks and names of what is not known are never left out: such a question is not read.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache

from .....gaussians import late_re as re
from .....gaussians.world import kinds
from .....gaussians.world.words import singular
from ....grammar.tagging.words import bag
from ..noun_phrase import is_color_word
from .deeds import STATES, Deed, as_noun, said_in
from .frames import UNIT
from .moments import clauses, without_time

_MOST = 30  # words
_CUES = tuple(
    (asks, re.compile(rf"\b(?:{said})\b"))
    for asks, said in (
        (
            "how_often",
            r"how (?:often|many times|frequently)|number of times|how many (?:full |complete |whole )?(?:turns|"
            r"rotations|"
            r"revolutions|rounds|spins|circles|laps|trips)",
        ),
        ("how_far_in", rf"(?:how many|how much|number of) (?P<u>{UNIT})\b(?! (?:per|a|an|/))"),
        (
            "how_long",
            r"(?:for |over |during )?(?:how (?:long|much time|many (?:seconds|secs))|what (?:length of time|time span)|"
            r"(?:what is )?the (?:duration|time span)(?: of)?|duration(?: of)?)",
        ),
        ("order", r"(?:in )?(?:what|which|the) (?:order|sequence)(?: of)?"),
        (
            "how_fast",
            r"(?:at |with )?(?:how (?:fast|quick|quickly|rapidly|slow|slowly)|(?:what|which) (?:speed|velocity|pace|"
            r"rate)|(?:what is |give me )?(?:the )?(?P<m>average |top |maximum |max |mean |peak |rotation )?(?:speed|"
            r"velocity|pace)(?: of)?)",
        ),
        (
            "how_far",
            r"(?:by |over |through )?(?:how (?:far|wide|great a distance|long a (?:way|distance)|much distance)|"
            r"(?:what|which) (?:distance|angle)|(?:what is )?(?:the )?(?:total )?distance(?: (?:covered|travelled|"
            r"traveled|moved|walked))?(?: (?:of|by))?)",
        ),
        (
            "when",
            r"(?:at |on |in |by |to |from |since )?(?:when|(?:what|which) (?:exact |precise )?(?:time|second|moment|"
            r"point|"
            r"instant|timestamp|timecode|frame|sec)(?: in time)?|how (?:soon|early|late)|the (?:exact |precise "
            r")?(?:time|"
            r"second|moment|instant|timestamp) (?:of|when|at which|that))",
        ),
        ("which_way", r"(?:in |to |into |toward |towards )?(?:which|what) (?:way|direction|side)"),
        ("where", r"(?:to |from )?(?:where|whereabouts|(?:at |in )?(?:what|which) (?:place|spot|location|position))"),
        ("how_many", r"how many|the number of"),
        ("which", r"which|what|who|^(?:list|name|show me|give me|tell me)"),
    )
)
_ASKED = re.compile(r"\b(?:when|what|which|who|whose|where|how|why|whom)\b")
_YES_NO = re.compile(r"^(?:and |so )?(?P<aux>is|are|was|were|does|do|did|has|have|had|will|can|could|would)\b")
_AUX = bag("is are was were be been being does do did has have had will would can could shall should may might")
# Words that say nothing about what is asked.
_SILENT = _AUX | bag(
    "a an the this that these those its his her their my our your of for by with , 's s it he she they them there "
    "here i me "
    "we us you him so well now please tell say know like want wants need needs needed wonder wondering curious asked "
    "ask "
    "exactly precisely actually really simply quite just about roughly approximately around overall altogether total "
    "whole "
    "entire entirely own itself himself all room scene clip video film shot footage recording animation sequence which "
    "who to in at on and then already yet ever happen happens happened take takes taken took use used get gets got "
    "make makes "
    "made manage manages managed begin clearly visibly eventually finally little bit time moment second seconds long "
    "does going seem seems seen see observe observed watch watching question answer give let thing things object "
    "objects "
    "complete completely fully guy something poor dear old nice big small tiny thanks ok okay hey hello hi "
    "mummy mum mom "
    "mommy daddy dad papa grandma grandpa granny grandad teacher miss sir madam professor doctor guys friend folks "
    "kids dude "
    "bro honey darling love mate computer assistant people sorry remind suppose suppose think believe guess look looks "
    "looking right also too as it's"
)
HARD = bag(
    "not no never nothing none nobody neither nor without except besides only than more less fewer faster slower "
    "longer "
    "shorter farther earlier later sooner first last next second third again back same different other another else if "
    "because why half quarter between every each both most least one two three four five six seven eight nine ten "
    "final initial twice"
)
_PLACES = (
    r"(?:on top of|next to|in front of|out of|up to|away from|close to|off of|on|onto|in|into|inside|at|to|toward|"
    r"towards|from|off|over|"
    r"across|through|along|past|by|near|beside|behind|under|underneath|against|with|around)"
)
_ADJECTIVES = bag(
    "big small large little top bottom middle upper lower left right wooden toy front rear coffee dining high potted "
    "round old new"
)


_GOING = {"to": "reach", "up to": "reach", "into": "reach", "onto": "enter", "off": "leave", "off of": "leave"}


@dataclass(frozen=True)
class _Part:
    """A part of a question: the words from `start` to `stop`, what they are, and how they are said plainly."""

    start: int
    stop: int
    kind: str
    said: str
    at: str = ""
    deed: Deed | None = None


@lru_cache(maxsize=1024)
def loosely(said: str, names: frozenset[str]) -> tuple[str, ...]:
    """Plain questions that words may mean; several where it is not told who does what.

    Args:
        names: words of the names of the things of the scene.
    """
    return tuple(dict.fromkeys(_loosely(said, names)))


def _loosely(said: str, names: Collection[str]) -> Iterator[str]:
    if len(said.split()) > _MOST or re.search(r"\b(?:why|who|or)\b", said):
        return
    unit = ""
    if (
        found := re.search(
            rf"(?: ,)? (?:(?:measured |expressed )?in )(?P<u>{UNIT}|rpm)$|(?: ,) (?P<v>{UNIT}|rpm)$", said
        )
    ) is not None:
        unit = found["u"] or found["v"]
        said = said[: found.start()]
    for time, rest in _timed(said):
        for main in _main(rest, unit, names, bool(time)):
            yield f"{main} {time}".strip()


def _timed(said: str) -> Iterator[tuple[str, str]]:
    """The words of a time, and the question without them."""
    for when, rest in clauses(said):
        if when.clause and not _ASKED.search(when.clause):
            yield f"{'by the time' if when.conj == 'by' else when.conj} {when.clause}", rest
    time, rest = without_time(said)
    if time is not None:
        kept = [w for w in said.split() if w != ","]
        for word in rest.split():
            if word in kept:
                kept.remove(word)
        yield " ".join(kept) if time.kind != "ever" else "", rest
    yield "", said


def _main(said: str, unit: str, names: Collection[str], timed: bool) -> Iterator[str]:
    """Plain questions without a time."""
    cued = next(((asks, m) for asks, row in _CUES if (m := row.search(said)) is not None), None)
    yes_no = _YES_NO.match(said)
    if yes_no is not None and cued is not None and cued[0] == "when":
        return  # "was it moving when the clip began" asks for no time
    if cued is None or (yes_no is not None and not _ASKED.search(said)):
        asks, rest = "yesno", said
        if yes_no is None and not re.search(r"\w", said):
            return
    else:
        asks, found = cued
        rest = f"{said[: found.start()]} , {said[found.end() :]}".strip()
        if _ASKED.search(rest):
            return
        unit = (found.groupdict().get("u") or "") or unit
        if asks == "how_far_in":
            asks = "how_long" if re.match(r"(?:milli)?sec|minute", unit) else "how_far"
    parts = _parts(re.sub(r" +", " ", rest).split(), names)
    if parts is None:
        return
    if asks == "yesno" and yes_no is None and (not parts or parts[0].kind != "thing"):
        return  # a fragment states nothing
    things = [p for p in parts if p.kind == "thing"]
    deeds = [p for p in parts if p.kind == "deed"]
    deed = _one_deed(deeds) if len(deeds) < 2 or " and " not in rest else False
    if deed is False or len(things) > 2:
        return
    measure = found["m"] or "" if asks == "how_fast" and cued is not None and "m" in found.groupdict() else ""
    for subject, other in _roles(asks, things, deeds):
        yield from _said(asks, subject, deed, other, unit, measure, timed)


def _parts(words: list[str], names: Collection[str]) -> list[_Part] | None:
    """Things, deeds and prepositions among words; None if one is left over that may mean something."""
    found, at = list[_Part](), 0
    while at < len(words):
        part = _place_at(words, at, names) or _thing_at(words, at, names) or _deed_at(words, at, names)
        if part is not None:
            found.append(part)
            at = part.stop
            continue
        word = words[at]
        if word in HARD or not (word in _SILENT or _is_a_name(words, at, names)):
            return None
        at += 1
    return found


def _place_at(words: list[str], at: int, names: Collection[str]) -> _Part | None:
    """A preposition with a thing."""
    for length in (3, 2, 1):
        place = " ".join(words[at : at + length])
        if re.fullmatch(_PLACES, place) and (other := _thing_at(words, at + length, names)) is not None:
            return _Part(at, other.stop, "thing", other.said, place)
    return None


def _thing_at(words: list[str], at: int, names: Collection[str]) -> _Part | None:
    """The longest noun phrase that begins at a word: determiners, colours and such, and a noun that is known."""
    start, colored = at, False
    while at < len(words) and words[at] in ("the", "a", "an", "that", "this", "my", "our", "your", "those", "these"):
        at += 1
    if at < len(words) and words[at] in ("all", "both"):
        at += 1
    first = at
    while at < len(words) and (is_color_word(words[at]) or words[at] in _ADJECTIVES or _may_begin(words, at, names)):
        colored = colored or is_color_word(words[at])
        at += 1
    if (at < len(words) and _is_noun(words[at], names) and as_noun(words[at]) is None) or (
        at < len(words) and colored and words[at] in ("one", "ones", "thing", "things")
    ):
        at += 1
    elif not colored or at - first > 1:
        return None
    said = " ".join(words[first:at])
    noun = words[at - 1]
    return _Part(start, at, "thing", f"the {said}{' thing' if is_color_word(noun) else ''}")


def _may_begin(words: list[str], at: int, names: Collection[str]) -> bool:
    """Whether a noun is the first word of a name of several: "toy robot", "ceiling fan"."""
    return at + 1 < len(words) and _is_noun(words[at], names) and _is_noun(words[at + 1], names)


def _is_noun(word: str, names: Collection[str]) -> bool:
    return singular(word) in names or word in names or (len(word) > 2 and kinds.find(singular(word)) is not None)


def _deed_at(words: list[str], at: int, names: Collection[str]) -> _Part | None:
    """The longest verb or noun of motion that begins at a word."""
    text = " ".join(words[at:])
    for start, stop, deed in said_in(text):
        if start == 0 and deed.verb not in ("on", "off", "in", "to"):
            return _Part(at, at + len(text[:stop].split()), "deed", deed.verb, deed=deed)
    noun = as_noun(words[at])
    return _Part(at, at + 1, "deed", words[at], deed=noun) if noun is not None else None


def _is_a_name(words: list[str], at: int, names: Collection[str]) -> bool:
    """Whether an unknown word is what somebody calls a thing: "robby the robot"."""
    word = words[at]
    return (
        word.isalpha() and word not in HARD and at + 2 < len(words) and words[at + 1] == "the"
        and (at == 0 or words[at - 1] in _AUX or words[at - 1] == ",") and _thing_at(words, at + 1, names) is not None
    )  # fmt: skip


def _one_deed(deeds: list[_Part]) -> _Part | bool | None:
    """The one deed that is told; None if none is, False if several are."""
    if not deeds:
        return None
    if len(deeds) == 1:
        return deeds[0]
    if len(deeds) == 2:
        first, second = deeds
        assert first.deed is not None and second.deed is not None
        if first.deed.kind == second.deed.kind and first.deed.phase == second.deed.phase:
            return first if len(first.said) >= len(second.said) else second
        for phase, process in ((first, second), (second, first)):
            assert phase.deed is not None and process.deed is not None
            if phase.deed.kind == "move" and phase.deed.phase in ("start", "stop") and not process.deed.phase:
                said = f"{'starts' if phase.deed.starts else 'stops'} to {process.said}"
                return _Part(0, 0, "deed", said, deed=process.deed)
    return False


def _roles(asks: str, things: list[_Part], deeds: list[_Part]) -> Iterator[tuple[str, str]]:
    """Who does it, and what it is done to, with its preposition."""
    if not things:
        yield "it", ""
        return
    placed = [t for t in things if t.at and t.at not in ("by", "with", "of")]
    if len(things) == 1:
        one = things[0]
        if one.at and one.at in ("of", "by", "with", "in", "on") and not placed:
            yield one.said, ""
        elif one.at:
            yield "it", f"{one.at} {one.said}"
        else:
            yield one.said, ""
            if asks != "yesno" and deeds:
                yield "it", one.said
        return
    first, second = things
    if len(placed) == 1:
        other = placed[0]
        yield next(t for t in things if t is not other).said, f"{other.at} {other.said}"
    elif not placed:
        yield first.said, second.said
        if asks not in ("yesno",):
            yield second.said, first.said


def _said(
    asks: str, subject: str, deed: _Part | bool | None, other: str, unit: str, measure: str, timed: bool
) -> Iterator[str]:
    """The question in the order that is read strictly."""
    assert deed is None or isinstance(deed, _Part)
    state = deed is not None and deed.deed is not None and deed.deed.kind in STATES
    clause = f"{'is' if state else 'does'} {subject} {deed.said if deed is not None else ''} {other}"
    tail = f" in {unit}" if unit else ""
    if deed is None:
        plain = {
            "how_fast": f"what is the {measure}speed of {subject}", "where": f"where is {subject}" if timed else "",
            "how_far": f"how far does {subject} move {other}", "how_often": "",
            "how_long": f"how long is {subject} {other}" if other else f"how long does {subject} move",
            "yesno": f"is {subject} {other}" if other else "",
            "when": f"when does {subject} {_GOING[other.split(' the ')[0]]} the {other.partition(' the ')[2]}"
            if other.split(" the ")[0] in _GOING else "",
        }.get(asks, "")  # fmt: skip
        if plain and not (other and asks in ("how_fast", "where")):
            yield re.sub(r" +", " ", f"{plain}{tail}").strip()
        return
    cue = {
        "when": "when", "how_long": "how long", "how_fast": "how fast", "how_far": "how far", "how_often": "how often",
        "where": "where", "which_way": "which way", "yesno": "",
    }.get(asks)  # fmt: skip
    noun = re.sub(r"^the ", "", subject)
    if asks == "order":
        plain = f"in what order do {subject} {deed.said} {other}"
    elif asks == "how_many":
        plain = f"how many {noun if subject != 'it' else 'things'} {deed.said} {other}"
    elif asks == "which":
        plain = f"which {noun if subject != 'it' else 'thing'} {deed.said} {other}"
    elif asks == "how_fast" and measure:
        plain = f"what is the {measure}speed of {subject}"
    else:
        plain = f"{cue} {clause}"
    yield re.sub(r" +", " ", f"{plain}{tail}").strip()
    if state and asks in ("yesno", "how_long"):
        yield re.sub(r" +", " ", f"{cue} does {clause[3:]}{tail}").strip()
