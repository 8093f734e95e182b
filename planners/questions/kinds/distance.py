"""How far things are from each other: "how far is the sofa from the window?", "is the lamp within 2 m of the bed?".

Words decide what is measured: a gap, space or clearance lies between surfaces, a distance runs from centre to centre.
To walls, the floor and the ceiling it runs to their surface, to a person as seen from above. The text tells both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from ....gaussians import late_re as re
from ..answer import Answer, Evidence
from ..candidates import Case, agreed, joined, meant, unknown
from ..kind import Asked, Kind
from ..reading.measures import Unit
from ..reading.phrase_templates import templates
from ..reading.spots import Spot
from ..spans import End, Span, end_of, ends, evidence, nearest_of, span, told
from ..survey import Survey

_APART = (
    "(apart|apart from each other|apart from one another|away from each other|from each other|from one another|"
    "to each other|to one another|together|between them)"
)
_IN = "[(in|as) {u:unit}]"
_LENGTH = (
    "(distance|gap|space|wall space|free wall|empty wall|"
    "clearance|room|separation|free space|empty space|floor space|open space|length|interval|"
    "stretch|spacing|straight line distance|straight line|shortest distance|minimum distance|smallest distance|"
    "smallest gap|narrowest gap|centre to centre distance|center to center distance|distance in a straight line)"
)
_BY = (
    "[(measured|as measured|going|counted)] "
    "[(centre to centre|center to center|from centre to centre|from center to center|edge to edge|from edge to edge|"
    "between (their|the) (edges|surfaces|sides|centres|centers)|middle to middle|between centres|between centers|"
    "at the closest point|at their closest point|at their closest|at the nearest point|in a straight line|"
    "as the crow flies|straight across|on the floor|across the floor|by air|from middle to middle)] "
)
_END = f"{_BY} {_IN}"
_HOW_FAR = f"""
    (measured|measuring|taken|counted|going) [from] (center to center|edge to edge|middle to middle|between \
        centers) how far \
        (apart|away) (is|are) {{a:spot}} and {{b:spot}}
    (measured|measuring|taken|counted|going) [from] (center to center|edge to edge|middle to middle|between \
        centers) how far \
        [away] (is|are) {{a:spot}} from {{b:spot}}
    [from] (center to center|edge to edge|middle to middle) how far [(apart|away)] (is|are) {{a:spot}} (and|from) \
        {{b:spot}} [apart]
    [in {{u:unit}}] how (far|close|near|distant|far away|far off) [away|apart] BE {{a:spot}} \
        [away|located|standing] (from|to|of) {{b:spot}} {_END}
    [in {{u:unit}}] how (far|close|near) [away|apart] BE {{a:spot}} and {{b:spot}} [{_APART}] {_END}
    [in {{u:unit}}] how (far|close|near) {_APART} BE {{a:spot}} and {{b:spot}} {_END}
    [in {{u:unit}}] how (far|close) {_APART} (do|does) {{a:spot}} and {{b:spot}} (stand|sit|lie|hang) {_END}
    how far (apart|away) (do|does) {{a:spot}} (stand|sit|lie|hang) from {{b:spot}} {_END}
    how far (do|does) {{a:spot}} and {{b:spot}} (stand|sit|lie|hang) {_APART} {_END}
    how far (do|does) {{a:spot}} (stand|sit|lie|hang) [away] from {{b:spot}} {_END}
    how (far|close|near) {_APART} BE {{both:spot}} {_END}
    how (far|close|near) BE {{both:spot}} {_APART} {_END}
    [in {{u:unit}}] how (far|long) is it [straight across|across|in a straight line] (from|between) {{a:spot}} \
        (to|and|over to|across to) {{b:spot}} {_END}
    how far (from|between) {{a:spot}} (to|and|is) {{b:spot}} {_END}
    how far (away|off) (from|to) {{b:spot}} (is|are) {{a:spot}} {_END}
    how far from {{b:spot}} (is|are|do|does|would) {{a:spot}} [be|stand|sit|hang|lie] {_END}
    how far away BE {{a:spot}} {_END}
    how far [away] (am|would|do|will) i [be|stand|sit] [away] from {{a:spot}} {_END}
    what is my distance (to|from) {{a:spot}} {_END}
    how far (off|away|is it) (is|are|to) {{a:spot}} {_END}
    what [(is|would be|was)] [the] {_LENGTH} [there] [is|in {{u:unit}}|left] (between|from|separating|of) \
        {{a:spot}} (and|to|from) {{b:spot}} {_END}
    what [(is|would be)] [the] {_LENGTH} [there] [is] between {{both:spot}} {_END}
    [the] {_LENGTH} (between|from|of) {{a:spot}} (and|to|from) {{b:spot}} {_END}
    [the] {_LENGTH} between {{both:spot}} {_END}
    (give me|measure|show me|estimate|compute|calculate|state|find) [the] {_LENGTH} (between|from) {{a:spot}} \
        (and|to) {{b:spot}} {_END}
    how (much|big|wide|large|long|many) [of a] [a|the|is|an|are] [the|of a] [actual|clear|free|empty] {_LENGTH} \
        [is|lies|are] [there] [is] [left|free|available] (between|from|separating) {{a:spot}} (and|to|from) \
        {{b:spot}} {_END}
    how (much|big|wide|large|long) [of a] [a|the|is] [the] {_LENGTH} [is] [there] [is] [left|free] between \
        {{both:spot}} {_END}
    how many {{u:unit}} [(is|are)] [there|is it|is there] [are there] (between|from|separate|separates) \
        {{a:spot}} (and|to|from) {{b:spot}} {_BY}
    how many {{u:unit}} [away|apart] BE {{a:spot}} [away|apart] (from|to) {{b:spot}} {_BY}
    how many {{u:unit}} [away|apart] BE {{a:spot}} and {{b:spot}} [{_APART}] {_BY}
    (at|by) what distance BE {{a:spot}} from {{b:spot}} {_END}
    (at|by) what distance (from|to) {{b:spot}} (is|are|stands) {{a:spot}} {_END}
    what separates {{a:spot}} (from|and) {{b:spot}} in {{u:unit}}
    how wide is the (passage|opening|aisle|walkway|corridor) between {{a:spot}} and {{b:spot}} {_END}
"""
_LESS = (
    "(within|less than|smaller than|shorter than|closer than|nearer than|under|at most|no more than|not more than|"
    "no further than|"
    "no farther than|not further than|inside of|below|in a radius of|within a radius of|within reach of)"
)
_MORE = (
    "(more than|bigger than|larger than|longer than|wider than|further than|farther than|over|at least|beyond|no "
    "less than|not less than|no closer than|greater than|"
    "further away than|farther away than|in excess of)"
)
_WITHIN = f"""
    BE {{a:spot}} [standing|located|placed] {_LESS} {{n:length}} [away|apart] (of|from|to|away from) {{b:spot}}
    BE {{a:spot}} and {{b:spot}} {_LESS} {{n:length}} [of each other|apart|from each other|of one another|away \
        from each other]
    BE {{both:spot}} {_LESS} {{n:length}} [of each other|apart|from each other|of one another|away from each other]
    [is|are] there {_LESS} {{n:length}} [of space|of room|of clearance] between {{a:spot}} and {{b:spot}}
    [is|are] there {_LESS} {{n:length}} [of space|of room|of clearance] between {{both:spot}}
    [is|are] the {_LENGTH} (between|from) {{a:spot}} (and|to) {{b:spot}} {_LESS} {{n:length}}
    (does|do) the {_LENGTH} (between|from) {{a:spot}} (and|to) {{b:spot}} (measure|come to|amount to) {_LESS} \
        {{n:length}}
"""
_BEYOND = _WITHIN.replace(_LESS, _MORE)
_TOUCH = """
    (do|does) {a:spot} and {b:spot} touch [each other|one another]
    (do|does) {a:spot} (touch|reach|meet) {b:spot}
    BE {a:spot} (touching|in contact with) {b:spot}
    BE {a:spot} and {b:spot} (touching|in contact) [each other|one another]
"""
_NEARER = "(closer|nearer|closest|nearest)"
_FURTHER = "(farther|further|more distant|farther away|further away|further off)"
_TO = "[to|towards|from|away from]"
_COMPARE_NEAR = f"""
    BE {{a:spot}} [any] {_NEARER} {_TO} {{b:spot}} than (to|from) {{c:spot}} [is]
    BE {{a:spot}} [any] {_NEARER} {_TO} {{b:spot}} than {{other:spot}} [is]
    (do|does) {{a:spot}} (stand|sit|lie|hang) {_NEARER} {_TO} {{b:spot}} than (to|from) {{c:spot}}
    (do|does) {{a:spot}} (stand|sit|lie|hang) {_NEARER} {_TO} {{b:spot}} than {{other:spot}} [does|do|is]
"""
_WHICH = "[(which|what) [(one|thing|object|item|of these|of the two|of them)]|who]"
_WHICH_NEAR = f"""
    {_WHICH} [(is|are|stands|sits|lies)] {_NEARER} {_TO} {{b:spot}} [is it|is that] {{a:spot}} or {{other:spot}}
    (is|are|does|do) {{a:spot}} or {{other:spot}} [stand|sit|lie|the one] {_NEARER} {_TO} {{b:spot}}
    (is|are|stand|stands) {{b:spot}} {_NEARER} (to|from) {{a:spot}} or [to|from] {{other:spot}}
    (is|are|stand|stands) {{b:spot}} {_NEARER} {{a:spot}} or {{other:spot}}
    (do|does) {{b:spot}} (stand|sit|hang|lie) {_NEARER} [to] {{a:spot}} or [to] {{other:spot}}
    {_WHICH} (is|are) {{b:spot}} {_NEARER} to [is it] {{a:spot}} or [to] {{other:spot}}
    {_WHICH} (is|are) {_NEARER} {{a:spot}} or {{other:spot}} {_TO} {{b:spot}}
    [out] (of|between) {{a:spot}} and {{other:spot}} (which|what) [one] (is|stands) {_NEARER} {_TO} {{b:spot}}
"""
_APART_COMPARED = """
    BE {a:spot} and {b:spot} (farther apart|closer together|closer to each other|nearer to each other|farther \
        from each other) \
        than {c:spot} and {d:spot} [are]
"""
_COMPARE_FAR, _WHICH_FAR = (t.replace(_NEARER, _FURTHER) for t in (_COMPARE_NEAR, _WHICH_NEAR))
_GAP = re.compile(
    r"\b(?:gap|space|clearance|room|edges?|surfaces?|close|near|free|closest|nearest|aisle|passage|walkway|corridor|"
    r"opening|spacing|narrowest|shortest|minimum|smallest)\b"
)
_NO_GAP = re.compile(r"\b(?:the|this|same|living|dining|meeting) room\b|\b(?:closest|nearest) (?!point|edge)")
_CENTRE = re.compile(r"\b(?:centre|center|middle|centres|centers|midpoints?)\b")
_TOUCHING = 0.03  # metres of gap that still count as touching


def _how_far(asked: Asked, survey: Survey) -> Answer | None:
    unit = asked.slots.get("u")
    gap = _is_gap(asked)

    def one(a: End, b: End) -> Answer:
        return _measured(a, b, gap, unit, survey)

    return _over_pairs(asked, survey, one)


def _within(asked: Asked, survey: Survey) -> Answer | None:
    return _over_pairs(asked, survey, lambda a, b: _limit(a, b, asked, survey, False))


def _beyond(asked: Asked, survey: Survey) -> Answer | None:
    return _over_pairs(asked, survey, lambda a, b: _limit(a, b, asked, survey, True))


def _touch(asked: Asked, survey: Survey) -> Answer | None:
    def one(a: End, b: End) -> Answer:
        s = span(a, b)
        yes = s.gap <= _TOUCHING
        text = f"{'Yes' if yes else 'No'}, {_gap_told(a, b, s)}."
        return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, evidence=evidence(a, b, True),
                      confidence=_sure(abs(s.gap - _TOUCHING), 0.03))  # fmt: skip

    return _over_pairs(asked, survey, one)


def _compare_near(asked: Asked, survey: Survey) -> Answer | None:
    return _compared(asked, survey, True)


def _compare_far(asked: Asked, survey: Survey) -> Answer | None:
    return _compared(asked, survey, False)


def _which_near(asked: Asked, survey: Survey) -> Answer | None:
    return _either(asked, survey, True)


def _apart_compared(asked: Asked, survey: Survey) -> Answer | None:
    """Whether two things are farther apart, or closer together, than two others."""
    one, two, three, four = (ends(asked.slots[k], survey, asked.situation) for k in ("a", "b", "c", "d"))
    if max(map(len, (one, two, three, four))) > 1:
        return None
    first, second = (one[0], two[0]), (three[0], four[0])
    near = bool(re.search(r"\b(?:closer|nearer)\b", asked.text.lower()))
    closer, sure = _closer(span(*first), span(*second))
    yes = closer == near
    told_ = [f"{a.name} and {b.name} are {told(_shown(span(a, b)))} apart" for a, b in (first, second)]
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=f"{'Yes' if yes else 'No'}: {told_[0]}, "
                  f"{told_[1]}.", confidence=sure, evidence=joined_spans(first, second))  # fmt: skip


def _which_far(asked: Asked, survey: Survey) -> Answer | None:
    return _either(asked, survey, False)


def _is_gap(asked: Asked) -> bool:
    said = asked.text.lower()
    parts = {asked.slots[k].part for k in ("a", "b", "both") if k in asked.slots}
    if "centre" in parts or (
        _CENTRE.search(said) and not any(asked.slots[k].who for k in ("a", "b") if k in asked.slots)
    ):
        return False
    return "edge" in parts or bool(_GAP.search(_NO_GAP.sub("", said)))


def _both(asked: Asked, survey: Survey) -> tuple[tuple[End, ...], tuple[End, ...]] | None:
    """The two ends of a question; of two things named as one ("the two chairs") each is an end."""
    if "both" in asked.slots:
        query = asked.slots["both"].query
        things = meant(query, survey) if query is not None else ()
        return ((end_of(things[0], survey),), (end_of(things[1], survey),)) if len(things) == 2 else None
    one: Spot = asked.slots["a"]
    other: Spot = asked.slots.get("b", Spot(who="me"))
    first = ends(_any_of(one), survey, asked.situation)
    second = ends(_any_of(other), survey, asked.situation)
    return _picked(first, one, second), _picked(second, other, first)


def _any_of(place: Spot) -> Spot:
    """A place that is picked by its distance to the other end ("the nearest desk") as everything that it may be."""
    query = place.query
    if query is None or query.pick not in ("nearest", "farthest"):
        return place
    return replace(place, query=query.model_copy(update={"pick": "all", "count": None}))


def _picked(found: tuple[End, ...], place: Spot, other: Sequence[End]) -> tuple[End, ...]:
    """The ends that "nearest" or "farthest" picks, measured from the other end and without the end itself."""
    if place.query is None or place.query.pick not in ("nearest", "farthest"):
        return found
    rows = {e.thing.row for e in other if e.thing is not None}
    rest = [e for e in found if e.thing is None or e.thing.row not in rows] or list(found)
    pick = min if place.query.pick == "nearest" else max
    return (pick(rest, key=lambda e: min(span(e, o).gap for o in other)),)


def _over_pairs(asked: Asked, survey: Survey, fn: Callable[[End, End], Answer]) -> Answer | None:
    found = _both(asked, survey)
    if found is None:
        return None
    return agreed([case for case in _cases(*found, fn)])


def _cases(first: Sequence[End], second: Sequence[End], fn: Callable[[End, End], Answer]) -> list[Case]:
    """One answer for each pair of different ends; among walls the nearest counts."""
    if all(e.is_surface for e in first) or all(e.is_surface for e in second):
        first, second = _nearest_walls(first, second)
    cases = []
    for a in first:
        for b in second:
            if (
                a.thing is not None
                and b.thing is not None
                and a.thing.row == b.thing.row
                and len(first) * len(second) > 1
            ):
                continue
            name = " and ".join([a.name] * (len(first) > 1) + [b.name] * (len(second) > 1))
            cases.append((name, fn(a, b)))
    return cases


def _nearest_walls(first: Sequence[End], second: Sequence[End]) -> tuple[Sequence[End], Sequence[End]]:
    if len(first) > 1 and len(second) == 1:
        return (nearest_of(first, second)[0],), second
    if len(second) > 1 and len(first) == 1:
        return first, (nearest_of(first, second)[1],)
    return first, second


def _measured(a: End, b: End, gap: bool, unit: Unit | None, survey: Survey) -> Answer:
    s = span(a, b)
    value = s.gap if gap else s.centres
    surface = a.is_surface or b.is_surface
    if surface:
        value = s.gap
    if surface:
        text = f"{_cap(a.name)} is {told(s.gap, unit)} from {b.name}."
        if b.thing is not None and a.is_surface:
            text = f"{_cap(b.name)} is {told(s.gap, unit)} from {a.name}."
    elif a.thing is None or b.thing is None:
        one, other = (a, b) if b.thing is None else (b, a)
        text = f"{_cap(one.name)} is {told(value, unit)} from {other.name}, seen from above."
        if not gap and s.gap < s.centres - 0.01:
            text = (f"The centre of {one.name} is {told(s.centres, unit)} from {other.name}, seen from above; "
                    f"its nearest edge is {told(s.gap, unit)} away.")  # fmt: skip
    elif gap:
        text = f"{_cap(_gap_told(a, b, s, unit))}; their centres are {told(s.centres, unit)} apart."
    else:
        text = (f"From centre to centre {a.name} and {b.name} are {told(s.centres, unit)} apart; "
                f"{'they touch' if s.gap < 1e-3 else f'the gap between them is {told(s.gap, unit)}'}.")  # fmt: skip
    return Answer(
        answer=float(value), answer_type="metres", text=text, unit="m", confidence=0.95,
        evidence=evidence(a, b, gap, f"{value:.2f} m"),
    )  # fmt: skip


def _limit(a: End, b: End, asked: Asked, survey: Survey, beyond: bool) -> Answer:
    s, limit = span(a, b), float(asked.slots["n"])
    centre = bool(_CENTRE.search(asked.text.lower()))
    value = s.centres if centre and not (a.is_surface or b.is_surface) else s.gap
    yes = (value > limit) if beyond else (value <= limit)
    said = f"their centres are {told(value)} apart" if centre else _gap_told(a, b, s)
    other = s.gap if centre else s.centres
    agrees = ((other > limit) if beyond else (other <= limit)) == yes
    note = "" if agrees or centre else f" (from centre to centre {told(s.centres)})"
    return Answer(
        answer="yes" if yes else "no", answer_type="yesno", text=f"{'Yes' if yes else 'No'}, {said}{note}.",
        confidence=0.95 if agrees else 0.7, evidence=evidence(a, b, not centre, told(value)),
    )  # fmt: skip


def _gap_told(a: End, b: End, s: Span, unit: Unit | None = None) -> str:
    if s.gap < 1e-3:
        return f"{a.name} and {b.name} touch"
    return f"the gap between {a.name} and {b.name} is {told(s.gap, unit)}"


def _compared(asked: Asked, survey: Survey, near: bool) -> Answer | None:
    """Whether A is nearer to B than to C, or nearer to B than D is."""
    firsts = ends(asked.slots["a"], survey, asked.situation)
    seconds = ends(asked.slots["b"], survey, asked.situation)
    to = "c" in asked.slots
    thirds = ends(asked.slots["c" if to else "other"], survey, asked.situation)

    def one(a: End, b: End, c: End) -> Answer:
        pair = (c, a) if to else (c, b)
        here, there = span(a, b), span(*pair)
        closer, sure = _closer(here, there)
        yes = closer == near
        text = (f"{'Yes' if yes else 'No'}: {a.name} is {told(_shown(here))} from {b.name}, and "
                f"{pair[0].name} is {told(_shown(there))} from {pair[1].name}.")  # fmt: skip
        return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, confidence=sure,
                      evidence=joined_spans((a, b), pair))  # fmt: skip

    return agreed(_triples(firsts, seconds, thirds, one))


def _either(asked: Asked, survey: Survey, near: bool) -> Answer | None:
    """Which of two things is nearer to a third."""
    firsts = ends(asked.slots["a"], survey, asked.situation)
    seconds = ends(asked.slots["b"], survey, asked.situation)
    others = ends(asked.slots["other"], survey, asked.situation)

    def one(a: End, b: End, c: End) -> Answer:
        here, there = span(a, b), span(c, b)
        closer, sure = _closer(here, there)
        best, rest = (a, c) if closer == near else (c, a)
        text = (f"{_cap(best.name)} is {'nearer to' if near else 'farther from'} {b.name}: "
                f"{told(_shown(span(best, b)))} against {told(_shown(span(rest, b)))} for {rest.name}.")  # fmt: skip
        label = best.thing.label if best.thing is not None else best.name
        if best.thing is not None and rest.thing is not None and best.thing.label == rest.thing.label:
            label = best.name.removeprefix("the ")
        return Answer(answer=label, answer_type="label", text=text, confidence=sure,
                      evidence=joined_spans((best, b), (rest, b)))  # fmt: skip

    return agreed(_triples(firsts, seconds, others, one))


def _triples(
    firsts: Sequence[End], seconds: Sequence[End], thirds: Sequence[End], fn: Callable[[End, End, End], Answer]
) -> list[Case]:
    many = [len(e) > 1 for e in (firsts, seconds, thirds)]
    cases: list[Case] = []
    for a in firsts:
        for b in seconds:
            for c in thirds:
                rows = [e.thing.row for e in (a, b, c) if e.thing is not None]
                if len(set(rows)) < len(rows) and any(many):
                    continue
                names = [e.name for e, told_ in zip((a, b, c), many, strict=True) if told_]
                cases.append((", ".join(names), fn(a, b, c)))
    if not cases:
        return [("", unknown("yesno", "That compares a thing with itself."))]
    return cases


def _closer(here: Span, there: Span) -> tuple[bool, float]:
    """Whether the first span is the shorter one, and how sure that is: gaps decide, or centres if gaps are equal."""
    by_gap, by_centre = here.gap - there.gap, here.centres - there.centres
    if abs(by_gap) < 0.02:
        return by_centre < 0, _sure(abs(by_centre), 0.3)
    agrees = (by_gap < 0) == (by_centre < 0)
    return by_gap < 0, _sure(abs(by_gap), 0.3) if agrees else 0.65


def _shown(s: Span) -> float:
    return s.gap


def joined_spans(*spans: tuple[End, End]) -> Evidence:
    """The evidence of several gaps."""
    return joined(
        Answer(answer=None, answer_type="text", text="", evidence=evidence(a, b, True, told(span(a, b).gap)))
        for a, b in spans
    )


def _sure(margin: float, clear: float) -> float:
    """Confidence of a comparison: 0.6 at a tie, 0.97 from a margin of `clear` on."""
    return round(0.6 + 0.37 * min(margin / clear, 1.0), 3)


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("distance_compared", templates(_APART_COMPARED), _apart_compared),
    Kind("distance_compared", templates(_COMPARE_NEAR), _compare_near),
    Kind("distance_compared", templates(_COMPARE_FAR), _compare_far),
    Kind("distance_which", templates(_WHICH_NEAR), _which_near),
    Kind("distance_which", templates(_WHICH_FAR), _which_far),
    Kind("distance_limit", templates(_WITHIN), _within),
    Kind("distance_limit", templates(_BEYOND), _beyond),
    Kind("touching", templates(_TOUCH), _touch),
    Kind("distance", templates(_HOW_FAR), _how_far),
)
