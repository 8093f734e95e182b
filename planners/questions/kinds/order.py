"""Order from left to right and from near to far: "what is the second thing from the left?", "the leftmost lamp"."""

from __future__ import annotations

import re
from itertools import pairwise

from ..answer import Answer, Evidence
from ..candidates import unknown
from ..kind import Asked, Kind
from ..reading.noun_phrase import is_anything
from ..reading.phrase_templates import templates
from ..survey import NotResolved, Survey, Thing, listed
from ..views import view_of

_ORDINALS = (
    "(first|second|third|fourth|fifth|sixth|seventh|eighth|ninth|tenth|1st|2nd|3rd|4th|5th|6th|7th|8th|9th|"
    "10th|last|next)"
)
_END = "(left|right|front|back|door|far left|far right|left side|right side|left hand side|right hand side)"
_SEEN = "[(as seen|as i see it|seen|in the room|here|for me|for the viewer)]"
_NTH = f"""
    (what|which thing|which object|which one|what thing|what object) (is|comes|stands|would be) [the] {_ORDINALS} \
        [thing|object|one|item] [(counting|counted|going|starting)] from [the] {_END} {_SEEN}
    [(what|which)] [is] [the] {_ORDINALS} (thing|object|item) [(counting|counted)] from [the] {_END} {_SEEN}
    which {{x}} is [the] {_ORDINALS} [one] [(counting|counted)] from [the] {_END} {_SEEN}
"""
_FARTHEST = """
    (what|which thing|which object|what thing|what object|which item) (is|stands|hangs|sits|lies) \
        [located|placed] [the] (farthest|most|nearest|closest|leftmost|rightmost) [thing] [(to|on|toward|towards) \
        the] [left|right|far left|far right] [side] [of the room|in the room|of all]
    (what|which thing|which object|what thing) (is|stands) (on|at|to) the (far|extreme|very) (left|right) [of the \
        room|side|side of the room|end]
    (what|which) (is|thing is|object is) the (leftmost|rightmost) [thing|object|item|one] [in the room]
    [the] (leftmost|rightmost) (thing|object|item) [in the room]
    which {x} (is|stands|hangs) [the] (leftmost|rightmost)
    which {x} (is|stands|hangs) [the] farthest (to|on) the (left|right)
    which {x} (is|stands) (on|at) the (far|extreme|very) (left|right)
"""
_DEEPEST = """
    (what|which thing|which object|what thing|what object) (is|stands|lies) [the] (farthest|most) \
        (back|forward|to the back|to the front|toward the back|toward the front) [in the room|of all]
    which {x} (is|stands|lies) [the] (farthest|most) (back|forward|to the back|to the front) [in the room]
"""
_FURTHER = """
    (which|what) [(one|thing|of them|of the two)] (is|are|stands|hangs) (farther|more) [to the|toward the|on the] \
        (left|right) {a} or {b}
    (is|are) {a} or {b} (farther|more) [to the|toward the] (left|right)
"""
_IS_FURTHER = """
    BE {a} (farther|more) [to the|toward the|on the] (left|right) than {b} [is]
    (does|do) {a} (stand|hang|sit|lie) (farther|more) [to the|toward the] (left|right) than {b}
"""
_PICKED = """
    (what|which) (is|are) {x}
    (what|which) (thing|object|item|one) is {x}
    (name|identify) {x}
"""
_LIST = """
    (list|name|order|sort|rank|arrange|show|give me|tell me|read out|enumerate) {x} [in order] from \
        (left|right|front|back|near|nearest|closest) to (left|right|front|back|far|farthest)
    (list|name|order|sort|rank|arrange|show|give me|tell me|read out|enumerate) {x} [in order] (left to \
        right|right to left)
    (what|which) is the order of {x} from (left|right|front|back) to (left|right|front|back)
    from (left|right|front|back) to (left|right|front|back) (what|which) (are|is) {x}
    from (left|right|front|back) to (left|right|front|back) (list|name|what do you see|what is there) [{x}]
    in what order do {x} (stand|come|hang|sit) from (left|right|front|back) to (left|right|front|back)
    what is the order of {x} (left to right|right to left)
"""
_NUMBERS = {word: i % 10 + 1 for i, word in enumerate(
    "first second third fourth fifth sixth seventh eighth ninth tenth 1st 2nd 3rd 4th 5th 6th 7th 8th 9th 10th".split()  # noqa: SIM905
)}  # fmt: skip
_ALIGNED = 0.1  # metres between two places in an order below which it is told as unsure


def _ordered(things: tuple[Thing, ...], way: str, asked: Asked, survey: Survey) -> list[tuple[float, Thing]]:
    """Things from the left, right, front (near) or back, with their place along that way, metres."""
    view = view_of(asked.situation, survey)[0]
    sign = -1.0 if way in ("right", "back") else 1.0
    along = view.along if way in ("front", "back") else view.across
    return sorted(((sign * along(t), t) for t in things), key=lambda pair: (pair[0], pair[1].row))


def _things(asked: Asked, survey: Survey) -> tuple[Thing, ...]:
    query = asked.slots.get("x")
    if query is None or is_anything(query):
        return survey.things
    found = survey.all_of(query)
    if not found:
        raise NotResolved(query, survey.find(query))
    return found


def _nth(asked: Asked, survey: Survey) -> Answer | None:
    said = asked.said
    things = _things(asked, survey)
    number = next((n for w, n in _NUMBERS.items() if re.search(rf"\b{w}\b", said)), 1)
    ends = re.findall(r"\b(left|right|front|back)\b", said)
    if not ends:
        return None
    ranked = _ordered(things, ends[-1], asked, survey)
    if re.search(r"\blast\b", said):
        ranked, number = ranked[::-1], 1
    if number > len(ranked):
        return unknown("label", f"There are only {len(ranked)}.", things)
    return _at(ranked, number - 1, f"number {number} from the {ends[-1]}", asked, survey)


def _extreme(asked: Asked, survey: Survey) -> Answer | None:
    found = re.search(r"(left|right)(?:most)?\b", asked.said)
    if found is None:
        return None
    ranked = _ordered(_things(asked, survey), found[1], asked, survey)
    return _at(ranked, 0, f"farthest to the {found[1]}", asked, survey) if ranked else None


def _compared(asked: Asked, survey: Survey) -> Answer | None:
    """Which of two things is farther to one side, or whether the first one is."""
    way = "left" if "left" in asked.words else "right"
    a, b = survey.one(asked.slots["a"]), survey.one(asked.slots["b"])
    ranked = _ordered((a, b), way, asked, survey)
    best = ranked[0][1]
    sure = 0.93 if abs(ranked[0][0] - ranked[1][0]) > _ALIGNED else 0.65
    text = f"{_cap(survey.named(best))} is farther to the {way}."
    evidence = Evidence(ids=(best.id, ranked[1][1].id))
    if "than" in asked.words:
        yes = best.row == a.row
        text = f"{'Yes' if yes else 'No'}, {text[:1].lower()}{text[1:]}"
        return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, frame="viewer", confidence=sure,
                      evidence=evidence)  # fmt: skip
    label = best.name if a.label != b.label else survey.named(best).removeprefix("the ")
    return Answer(answer=label, answer_type="label", text=text, frame="viewer", confidence=sure, evidence=evidence)


def _deepest(asked: Asked, survey: Survey) -> Answer | None:
    way = "back" if "back" in asked.words else "front"
    ranked = _ordered(_things(asked, survey), way, asked, survey)
    return _at(ranked, 0, f"farthest to the {way}", asked, survey) if ranked else None


def _picked(asked: Asked, survey: Survey) -> Answer | None:
    """A thing that is named by its place in an order: "what is the leftmost piece of furniture?"."""
    query = asked.slots["x"]
    if query.pick not in ("leftmost", "rightmost", "nth", "middle"):
        return None
    thing = survey.one(query)
    return Answer(answer=thing.name, answer_type="label", text=f"That is {survey.named(thing)}.", frame="viewer",
                  confidence=0.9, evidence=Evidence(ids=(thing.id,)))  # fmt: skip


def _at(ranked: list[tuple[float, Thing]], index: int, told: str, asked: Asked, survey: Survey) -> Answer:
    thing = ranked[index][1]
    near = [abs(ranked[i][0] - ranked[index][0]) for i in (index - 1, index + 1) if 0 <= i < len(ranked)]
    sure = 0.93 if min(near, default=1.0) > _ALIGNED else 0.7
    name = survey.named(thing).removeprefix("the ") if "x" in asked.slots else thing.name
    return Answer(answer=name, answer_type="label", text=f"{_cap(survey.named(thing))} is {told}.", frame="viewer",
                  confidence=sure, evidence=Evidence(ids=(thing.id,)))  # fmt: skip


def _listed(asked: Asked, survey: Survey) -> Answer | None:
    ways = re.findall(r"\b(left|right|front|back|near|nearest|closest|far|farthest|furthest)\b", asked.said)
    if not ways:
        return None
    first = {"near": "front", "nearest": "front", "closest": "front", "far": "back", "farthest": "back",
             "furthest": "back"}.get(ways[0], ways[0])  # fmt: skip
    ranked = _ordered(_things(asked, survey), first, asked, survey)
    things = [t for _, t in ranked]
    close = any(abs(a[0] - b[0]) < _ALIGNED for a, b in pairwise(ranked))
    text = f"{_cap(listed([survey.named(t) for t in things]))}."
    return Answer(answer=tuple(t.name for t in things), answer_type="list", text=text, frame="viewer",
                  confidence=0.75 if close else 0.92, evidence=Evidence(ids=tuple(t.id for t in things)))  # fmt: skip


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("order_list", templates(_LIST), _listed),
    Kind("order_nth", templates(_NTH), _nth),
    Kind("order_extreme", templates(_FARTHEST), _extreme),
    Kind("order_compared", templates(_FURTHER), _compared),
    Kind("order_compared", templates(_IS_FURTHER), _compared),
    Kind("order_deepest", templates(_DEEPEST), _deepest),
    Kind("order_picked", templates(_PICKED), _picked),
)
