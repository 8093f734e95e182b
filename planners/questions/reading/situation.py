"""Reads where the person who asks says to be: "if I sat on the sofa facing the window, ...", "..., seen from the door".

The statement may come before the question, behind it, or as sentences before it: "I am standing by the table with a
chair on my left. What is behind me?".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ...grammar.tagging.words import bag
from . import noun_phrase
from .phrase_templates import HoleReader, Template, Words, templates
from .side_phrases import Side, side

Pose = Literal["on", "at", "front", "behind", "enter", "middle", "own", "somewhere"]
Gaze = Literal["", "at", "away", "in", "out"]


@dataclass(frozen=True)
class Situation:
    """A stated place and direction of gaze.

    Attributes:
        words: as said, for the answer's frame: "sitting on the sofa facing the window".
        at: what the person is on, at or before; None: not said.
        facing: what the person looks at; None: not said.
        pose: "on" or "at" `at`, in "front" of it or "behind" it; "enter": comes in through it; "middle" of the room;
            "own": takes its frame; "somewhere": only the gaze is said.
        seated: whether the person sits or lies.
        gaze: "at" `facing`, "away" from it, "in" to the room, "out" of the window or door; "": not said.
        beside: what lies on which side of the person.
    """

    words: str
    at: Query | None = None
    facing: Query | None = None
    pose: Pose = "on"
    seated: bool = False
    gaze: Gaze = ""
    beside: tuple[tuple[Query, Side], ...] = ()


_INTRO = (
    "[(if|when|whenever|while|suppose|supposing|imagine|imagining|assuming|assume|say|pretend|as|once|after|given|let|"
    "picture|provided)] [that|me|myself|we say|us say]"
)
_WHO = (
    "[(i|we|you|someone|somebody|one|he|she|they|a person|the person|people)] "
    "[(am|are|is|was|were|would be|had been|will be|have|had|take|took|went|could|would|should)] "
    "[(now|currently|just|still|busy|here|to|to be|about to|going to|like to|love to|like|love|on their back|on my "
    "back)]"
)
_SIT = (
    "(watching telly|watching television|sat|sit|sits|sitting|seated|lie|lay|lying|lies|perched|perching|curled|"
    "relaxing|resting|lounging|sleeping|napping|"
    "sat down|working|eating|reading|writing|typing|watching tv|playing|dining|sunk) [down|back|up|straight|"
    "quietly|alone|on my back|on their back|on your back|on his back|on her back]"
)
_STAND = (
    "(stood|stand|stands|standing|wait|waiting|positioned|walk up|walked up|leaning|stop|stopped|parked|staying|am|be|"
    "go|walk|walked|pause|look) [up|still|over|upright|right|directly|just|back|straight]"
)
_AT = "(at|by|beside|next to|near|close to|against|to|alongside|with|outside|over at|up against)"
_GAZES = (
    "[and|while|,|and then] [i am|i|am|was|we are|you are] "
    "(facing|looking|face|faces|faced|look|looked|gazing|watching|turned|turn|staring|pointing|peering|seeing|see) "
    "[straight|directly|right|out|back|over|up|down|toward|towards|to|at|on|of|in|the direction of|ahead at]"
    " [to|toward|towards|at|of|on|over|the direction of]"
)
_LOOKS = "[and|while|,] [i am|i|am] (facing|looking|look|face|gazing|turned|turn|pointing|peering|stare|staring)"
_ROOM = "(the room|the middle of the room|the centre of the room|the center of the room|this room)"
_SIDED = (
    "[and|with|while|having|,] [with|there (is|are)|that|i have|having|have|has|its|the] {b:bare} [is|are|"
    "being|placed|right|located] {s:side} [(within reach|within arms reach|within arm 's reach|within my reach|"
    "directly|close by|far away|across the room|across the table|next to me|against the wall)]"
)
_SIDED2 = (
    "[and|with|while|having|,|there (is|are)] {b2:bare} [is|are] {s2:side} [(within reach|within arms reach|"
    "within arm 's reach|within my reach|directly|close by|far away|across the room|across the table|next to "
    "me|against the wall)]"
)
_EYES = (
    "[and|with|while|having] [with] my (eyes|gaze|face|head|nose|body) [fixed|turned|directed] (on|to|toward|"
    "towards|at) {g:bare}"
)
_TAIL = (
    "[[(with|and)] [(my|their|his|her|your|the)] head (on|at|against) the (wall|wall side|headboard)] "
    "[and (stop|stopped|pause|stay|wait|stand still|stand there)] [(leaning|leant|leaned|lying) back] [[(is|that "
    "is|which is)] {s0:side}] "
    f"[{_LOOKS} {{way:gaze}}|{_GAZES} [that|this] {{g:bare}}|{_EYES}|(and|with) my back (to|against|towards|toward) "
    f"{{back:bare}}] "
    f"[{_SIDED}] [{_SIDED2}]"
)
_CLAUSES = (
    f"on: {_INTRO} {_WHO} {_SIT} (on|in|upon|inside|on top of|onto|into) {{at:bare}} {_TAIL}",
    f"on: {_INTRO} (i|you|we|someone|somebody) (am|are|is|was|were) (on|in) {{at:bare}} {_TAIL}",
    f"sit: {_INTRO} {_WHO} {_SIT} {_AT} {{at:bare}} [(on|in) {{seat:bare}}] {_TAIL}",
    f"sit: {_INTRO} {_WHO} {_SIT} (in front of|before) {{at:bare}} {_TAIL}",
    f"take: {_INTRO} [(i|we|you|someone)] (take|took|use|used|occupy|choose) {{at:bare}} {_TAIL}",
    f"middle: {_INTRO} {_WHO} [{_STAND}] (in|at) (the middle|the centre|the center) [of the room] {_TAIL}",
    f"front: {_INTRO} {_WHO} [{_STAND}] (in front of|before|opposite) {{at:bare}} {_TAIL}",
    f"behind: {_INTRO} {_WHO} [{_STAND}] behind {{at:bare}} {_TAIL}",
    f"enter: {_INTRO} {_WHO} {{entering:entering}} [[(through|by|via|from|at|in through|in by)] {{at:bare}}] {_TAIL}",
    f"at: {_INTRO} {_WHO} [{_STAND}] {_AT} {{at:bare}} {_TAIL}",
    f"at: {_INTRO} {_WHO} {_STAND} (on|in|inside|under) {{at:bare}} {_TAIL}",
    f"use: {_INTRO} {_WHO} {{using:using}} {{at:bare}} {_TAIL}",
    f"back: {_INTRO} {_WHO} [{_STAND}] (with|my|and) [my] back [is] (to|against|towards|toward) {{back:bare}} "
    f"[{_SIDED}] [{_SIDED2}]",
    f"gaze: {_INTRO} {_WHO} [{_STAND}] {_GAZES} {{g:bare}} [{_SIDED}] [{_SIDED2}]",
    f"lead: (in|on|at|from) {{at:bare}} {_TAIL}",
    f"own: (seen|viewed|looking|looked at|as seen|as viewed|when seen|when viewed|when looking|judged|taken|imagined) "
    f"from [the (point of view|perspective|viewpoint|position|side) of] {{at:bare}} {_TAIL}",
    "own: (from|in) [the (point of view|perspective|viewpoint|frame|orientation) of] {at:bare} 's "
    "[own] (point of view|perspective|viewpoint|view|side|frame|frame of reference|pov|orientation)",
    "own: (from|in) the (point of view|perspective|viewpoint|frame|frame of reference|orientation) of {at:bare}",
)
_USING = tuple(
    [
        "using",
        "opening",
        "closing",
        "washing my hands (?:at",
        "in)",
        "washing my face (?:at",
        "in)",
        "washing (?:my )?(?:hands",
        "dishes) (?:at",
        "in)",
        "picking (?:up )?(?:a",
        "some",
        "my)? ?\\w+ (?:from",
        "off)",
        "throwing (?:\\w+ ){1,2}(?:into",
        "in",
        "to)",
        "cleaning",
        "wiping",
        "playing",
        "writing (?:\\w+ )?on",
        "drawing on",
        "pushing",
        "pulling",
        "reaching for",
        "reaching into",
        "loading",
        "emptying",
        "cooking (?:at",
        "on)",
        "admiring",
        "checking",
        "making",
        "watching",
        "typing on",
        "working on",
        "brushing my teeth at",
        "watering",
        "dusting",
        "adjusting",
    ]
)
_USED = re.compile("|".join(_USING))
_ENTERING = re.compile(
    r"(?:enter|entering|entered|come in|comes in|came in|coming in|walk in|walks in|walked in|walking in|step in|"
    r"steps in|stepped in|stepping in|go in|going in|get in|arrive|arriving|step inside|come|coming|walk|walking|step|"
    r"stepping|enter (?:the|this) room|entering (?:the|this) room|walk into (?:the|this) room|come into (?:the|"
    r"this) room|"
    r"walking into (?:the|this) room|coming into (?:the|this) room|step into (?:the|this) room|stepping into "
    r"(?:the|this) "
    r"room|on entering|on entering the room|upon entering|upon entering the room)"
)
_WAYS = {
    "in": re.compile(
        r"(?:straight |directly |out |right |back )*(?:in|inside|inward|inwards|into (?:the|this) room|across "
        r"(?:the|this) "
        r"room|at (?:the|this) room|to (?:the|this) room|towards? (?:the|this) room|(?:the|this) room|"
        r"straight ahead|ahead|forwards?|around the room|into the middle of the room|to the middle of the room|"
        r"towards? the (?:middle|centre|center)(?: of the room)?)"
    ),
    "out": re.compile(r"(?:straight )?(?:out|outside|outward|outwards|out of it)"),
}
_STOPS = bag(
    "is are was were be am i me my facing looking face faces look while if when which what where who how would "
    "will could can do does did should straight sit sitting standing stand seated lying working"
)
_STARTS = bag(
    "is are was were would will could can do does did should what whats which where who how on in to at "
    "whether am must may has have name list tell count roughly show might behind whose"
)
_SUFFIXES = bag(
    "if when whenever while from as seen viewed looking sitting standing seated facing lying with given "
    "assuming once on upon after supposing suppose imagine stood sat entering coming walking in for"
)
_ANY = re.compile(
    r"\b(?:if|suppose|imagine|assume|assuming|supposing|say|sat|sit|sits|sitting|seated|stood|stand|stands|"
    r"standing|lie|lay|lying|lies|facing|face|faces|looking|look|"
    r"working|enter|entering|entered|coming|come|walk|walking|walked|step|steps|stepping|perspective|view|"
    r"viewpoint|frame|"
    r"seen|viewed|back|take|took|am|were|using|opening|watching|reading|playing|perched|leaning|pov|"
    r"orientation|lounging|"
    r"resting|sleeping|dining|typing|eating|writing|on entering|relaxing|curled)\b"
)
_VIEWER = re.compile(
    r"^(?:(?:as )?(?:seen|viewed|looking) )?from (?:the front|where i am(?: standing| sitting| looking| now)?|"
    r"where i stand|"
    r"where the viewer (?:is|stands)|my (?:position|point of view|perspective|viewpoint|view)|the viewer|the viewer 's "
    r"(?:position|point of view|perspective|viewpoint|side)|(?:this|the) camera|the camera 's (?:view|perspective|"
    r"point of "
    r"view)|here|your point of view)$|^(?:as|when) (?:i|you|we) (?:look|are looking|am looking|see) (?:at|into) "
    r"(?:it|the room|this room)(?: from (?:the front|here))?$|^for (?:someone|somebody|a person) looking (?:in|at "
    r"it|into the "
    r"room)(?: from the front)?$|^(?:to|for) the viewer$|^in (?:the|this) (?:picture|image|view|photo)$|"
    r"^as (?:i|you|we) face (?:it|the room)$|^from the viewer$"
)
_SIDE_WORDS = bag("left right behind front ahead clock oclock o'clock nearer closer side")


def read_situation(words: Words) -> tuple[Situation | None, Words]:
    """The situation that a question states, and the other words; None and all words if it states none."""
    said = " ".join(words)
    if not _ANY.search(said) and words[:1] not in (("in",), ("on",), ("from",), ("at",)) and " from " not in said:
        return None, words
    before, rest = _leading(words)
    behind, rest = _trailing(rest)
    if before is not None and behind is not None and before.facing is None and not before.gaze:
        before = replace(before, facing=behind.facing, gaze=behind.gaze)
    return (before or behind), rest


def _leading(words: Words) -> tuple[Situation | None, Words]:
    """A situation before the question, in the longest reading."""
    for at in range(len(words) - 1, 1, -1):
        if words[at] in _STARTS:
            head, rest = _trimmed(words[:at]), _trimmed(words[at:])
            if _VIEWER.match(" ".join(head)) and rest:
                return None, rest
            loose = head[0] in ("in", "on", "at", "from") and bool(_SIDE_WORDS & set(rest)) if head else False
            found = _clause(head, () if loose else ("lead",)) if loose or _ANY.search(" ".join(head)) else None
            if found is not None and rest:
                return found, rest
    return None, words


def _trailing(words: Words) -> tuple[Situation | None, Words]:
    """A situation behind the question."""
    personal = bool({"i", "me", "my", "you", "your"} & set(words))
    for at in range(2, len(words)):
        if words[at] not in _SUFFIXES or len(words) - at < 2:
            continue
        tail, rest = _trimmed(words[at:]), _trimmed(words[:at])
        if _VIEWER.match(" ".join(tail)):
            if _SIDE_WORDS & set(rest) and tail[-1] != "here":
                return None, rest
            continue
        stated = words[at] in (
            "if",
            "when",
            "whenever",
            "while",
            "as",
            "seen",
            "viewed",
            "from",
            "in",
            "assuming",
            "once",
        )
        if not (stated or personal or words[at - 1] == ","):
            continue
        if not (_SIDE_WORDS & set(words)) and not personal:
            continue
        found = _clause(tail, ("lead",), ("own",) if words[at] in ("in", "from", "for") else ())
        if found is not None:
            return found, rest
    return None, words


def _trimmed(words: Words) -> Words:
    return tuple(" ".join(words).strip(" ,()").split())


def _clause(words: Words, without: tuple[str, ...] = (), only: tuple[str, ...] = ()) -> Situation | None:
    """The situation that all the words state, by clauses of some kinds."""
    if not 2 <= len(words) <= 45:
        return None
    for kind, template in _templates():
        if kind in without or (only and kind not in only):
            continue
        for slots in template.match(words, _READERS):
            return _made(kind, words, slots)
    return None


def _made(kind: str, words: Words, slots: Mapping[str, Any]) -> Situation:
    poses: dict[str, Pose] = {
        "on": "on", "take": "on", "sit": "at", "at": "at", "use": "front", "front": "front", "behind": "behind",
        "lead": "on", "enter": "enter", "middle": "middle", "own": "own", "gaze": "somewhere", "back": "somewhere",
    }  # fmt: skip
    pose = poses[kind]
    at, facing = slots.get("at"), slots.get("g")
    gaze: Gaze = "at" if facing is not None else slots.get("way", "")
    if facing is not None and at is not None:
        facing = _same_thing(at, facing)
    if "back" in slots:
        facing, gaze = (slots["back"] if at is None else _same_thing(at, slots["back"])), "away"
    if "seat" in slots:
        facing, gaze = (facing or at), gaze or "at"
        at, pose = slots["seat"], "on"
    if "entering" in slots and at is None:
        at = Query(text="door")
    beside = tuple(
        (slots[b], slots[s]) for b, s in (("at", "s0"), ("b", "s"), ("b2", "s2")) if b in slots and s in slots
    )
    seated = kind in ("on", "sit", "take")
    return Situation(_told(words), at, facing, pose, seated, gaze, beside)


def _same_thing(at: Query, facing: Query) -> Query:
    """What "it" and "that desk" mean beside a place: "in the chair at the far desk, facing that desk"."""
    anchors = [a for r in at.relations for a in r.anchors]
    if facing.last:
        return anchors[0] if anchors else at
    plain = facing == Query(text=facing.text)
    return next((a for a in (*anchors, at) if plain and a.text == facing.text), facing)


def _told(words: Words) -> str:
    said = " ".join(words)
    said = re.sub(r"^(?:if|when|while|suppose|supposing|imagine|assuming|say|pretend|as) ", "", said)
    return said.replace(" ,", ",").replace(" 's", "'s")[:390]


def _holds_clause(words: Words) -> bool:
    return not _STOPS.isdisjoint(words) and not _STOPS.isdisjoint(
        noun_phrase.without_verb_names(" ".join(words)).split()
    )


def _bare(words: Words) -> Query | None:
    """A noun phrase without a person, a gaze or a clause in it."""
    if (
        len(words) > 12
        or _holds_clause(words)
        or words[-1] in ("on", "in", "at", "to", "of", "with", "and", "left", "the")
    ):
        return None
    if words[0] in ("and", "with", "to", "at", "on", "in", ","):
        return None
    if words[:3] == ("a", "couple", "of"):
        words = words[3:]
    return noun_phrase.thing(words)


def _gaze(words: Words) -> str | None:
    said = " ".join(words)
    return next((way for way, pattern in _WAYS.items() if pattern.fullmatch(said)), None)


def _matching(pattern: re.Pattern[str]) -> HoleReader:
    return lambda words: " ".join(words) if pattern.fullmatch(" ".join(words)) else None


_READERS: Mapping[str, HoleReader] = {
    "bare": _bare,
    "side": side,
    "gaze": _gaze,
    "entering": _matching(_ENTERING),
    "using": _matching(_USED),
}


@cache
def _templates() -> tuple[tuple[str, Template], ...]:
    return tuple(_each_template())


def _each_template() -> Iterator[tuple[str, Template]]:
    for line in _CLAUSES:
        kind, _, notation = line.partition(": ")
        for template in templates(notation):
            yield kind, template
