"""Which of two things is taller, wider or larger, and by how much: "is the bed bigger than the desk?"."""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.language.query.query import Query
from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import certainty, in_unit, measure, same, told_length
from ..reading.measures import Measure, More, more
from ..reading.phrase_templates import templates
from ..resolving import Meant, meant
from ..survey import Survey, Thing, listed
from ..telling import evidence, label, told_apart, yes_no

_ONE = (
    "[one|thing|object|item|piece of furniture|of them|of these|of those|of these two|of the two|"
    "of these two things|one of them|piece|is the one that]"
)
_IS = "(is|are|was|looks|stands|would be|measures|seems|has to be)"
_SPACE = "[floor|more floor] (space|room|area|floor space|of the room|of the floor|place)"
_TAKES = (
    "(takes up|take up|occupies|occupy|needs|covers|cover|uses|fills|fill|take|"
    "takes|has|have|requires|use|need|eats up)"
)
_MEASURE = "(height|width|depth|length|size|footprint|volume|area|thickness)"
_PHRASES = f"""
    (which|what|who) {_ONE} {_IS} [the] {{m:more}} [one|thing|of the two|object|item|off its base|in height|in width|\
        overall] {{a}} or {{b}}
    (which|what) {_ONE} {_IS} [the] {{m:more}} [one|of the two] [of|between|out of|from|among] {{a}} (and|or) {{b}}
    (which|what) [one] (of|between|out of) {{a}} (and|or) {{b}} {_IS} [the] {{m:more}} [one]
    (between|of|out of|comparing|from|among) {{a}} (and|or) {{b}} , (which|what) {_ONE} {_IS} [the] {{m:more}} [one]
    {{a}} (or|and|vs|versus) {{b}} , (which|what) {_ONE} {_IS} [the] {{m:more}} [one]
    (compare|comparing) {{a}} (and|with|to) {{b}} , (which|what) {_ONE} {_IS} [the] {{m:more}} [one]
    {{a}} or {{b}} {_IS} {{m:more}}
    (is|are) {{a}} or {{b}} [the] {{m:more}} [one]
    what {_IS} {{m:more}} {{a}} or {{b}}
    {{m:more}} {{a}} or {{b}}
    (which|what) {_ONE} {_TAKES} [up] more {_SPACE} {{a}} or {{b}}
    (does|do) {{a}} or {{b}} {_TAKES} [up] more {_SPACE}
    (which|what) (of|between) {{a}} (and|or) {{b}} {_TAKES} [up] more {_SPACE}
    (which|what) {_ONE} {_TAKES} [up] less {_SPACE} {{less_a}} or {{less_b}}
    (which|what) {_ONE} has [the|a] (greater|larger|bigger|more|higher) {{d:dimension}} {{a}} or {{b}}
    (which|what) (of|between) {{a}} (and|or) {{b}} has [the|a] (greater|larger|bigger|more|higher) {{d:dimension}}
    (which|what) {_ONE} has [the|a] (smaller|lower|lesser) {{d:dimension}} {{less_a}} or {{less_b}}
    (which|what) {{pair}} {_IS} [the] {{m:more}} [one|of the two]
    (which|what) of {{pair}} {_IS} [the] {{m:more}} [one|of the two]
    (which|what) {_ONE} {_IS} [the] {{m:more}} of {{pair}}
    [by] how much {{m:more}} BE {{by_a}} [compared to|compared with] than {{by_b}}
    how much {{m:more}} is {{by_a}} (compared to|compared with) {{by_b}}
    [by] how (many|much) {{u:unit}} {{m:more}} BE {{by_a}} than {{by_b}}
    [by] how (many|much) {{u:unit}} BE {{by_a}} {{m:more}} than {{by_b}}
    by how much BE {{by_a}} {{m:more}} than {{by_b}}
    how much BE {{by_a}} {{m:more}} than {{by_b}}
    what is the {{d:dimension}} difference between {{by_a}} and {{by_b}} [in {{u:unit}}]
    what is the difference in {{d:dimension}} between {{by_a}} and {{by_b}} [in {{u:unit}}]
    how much (taller|higher) than {{by_b}} is {{by_a}}
    BE {{x}} [all|both|each] {{m:more}} (than|compared to|compared with|then) {{y}} [is|are] [tall|high|wide|deep|\
        long|big|large]
    BE {{x}} [both|each] {{first:more}} and {{m:more}} than {{y}} [is|are]
    BE {{x}} the {{m:more}} of the two [things] [{{pair_b}}]
    (does|do) {{x}} {_TAKES} [up] more {_SPACE} than {{y}} [does|do]
    (does|do) {{less_x}} {_TAKES} [up] less {_SPACE} than {{less_y}} [does|do]
    (does|do|has|have) {{x}} [have] [a] (greater|larger|bigger|higher|more) {{d:dimension}} than {{y}} [does|has]
    is the {{d:dimension}} of {{x}} (greater|larger|bigger|higher|more) than [that of|the {_MEASURE} of] {{y}}
    is the {{d:dimension}} of {{less_x}} (less|smaller|lower|shorter) than [that of|the {_MEASURE} of] {{less_y}}
    BE {{self}} {{m:more}} than (it is|they are|it|they) {{self_d:dimension}}
    BE {{eq_x}} [just|at least|about|nearly|almost|equally] as {{d:dimension}} as {{eq_y}} [is|are]
    BE {{eq_x}} [about|roughly|exactly|nearly] [of] the same {{d:dimension}} as {{eq_y}} [is|are]
    (does|do|has|have) {{eq_x}} [have] the same {{d:dimension}} as {{eq_y}} [has|have|does|do]
    BE {{eq}} [all|both] [about|roughly|exactly|nearly] [of] the same {{d:dimension}} [as each other|as one another]
    BE {{eq}} [all|both] equally {{d:dimension}}
    BE {{eq}} [all|both] (as {{d:dimension}} as each other|as {{d:dimension}} as one another|equal in {{d:dimension}}|\
        identical in {{d:dimension}})
    (does|do|has|have) {{eq}} [all|both] (have|share) the same {{d:dimension}}
    BE {{diff}} [of] (a different|different) {{d:dimension}}
    BE the {{d:dimension}} of {{eq}} [all] (the same|equal|identical)
    BE {{eq}} [all|both] identical in {{d:dimension}}
"""


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """The larger of two, by how much, whether the first is larger, or whether they are the same."""
    slots = asked.slots
    if "eq" in slots or "diff" in slots or "eq_x" in slots:
        return _equal(asked, survey)
    degree = _degree(asked)
    if degree is None:
        return None
    if "first" in slots and slots["first"].measure != degree.measure:
        return None
    if "self" in slots:
        return _of_itself(meant(survey, slots["self"]), degree, slots["self_d"].measure, survey)
    if "by_a" in slots:
        return _difference(asked, degree, survey)
    if "pair" in slots:
        return _of_pair(meant(survey, slots["pair"]), degree, survey)
    if "pair_b" in slots:
        return None
    for x, y in (("x", "y"), ("less_x", "less_y")):
        if x in slots and y in slots:
            return _is_more(*_both(slots[x], slots[y], asked, survey), degree, survey)
    a, b = ("less_a", "less_b") if "less_a" in slots else ("a", "b")
    if a not in slots:
        return None
    return _which(*_both(slots[a], slots[b], asked, survey), degree, survey)


def _both(first: Query, second: Query, asked: Asked, survey: Survey) -> tuple[Meant, Meant]:
    """What two phrases mean; "one" in the second stands for the noun of the first: "the red chair … the white one"."""
    if not second.text and not second.groups and {"one", "ones"} & set(asked.words):
        second = second.model_copy(update={"text": first.text})
    return meant(survey, first), meant(survey, second)


def _degree(asked: Asked) -> More | None:
    """The comparative of a question, also where it is said by a noun ("more space", "a greater height")."""
    slots = asked.slots
    if "m" in slots:
        found: More = slots["m"]
        return found
    sign = -1 if any(n.startswith("less_") for n in slots) else 1
    if "d" in slots:
        what: Measure = slots["d"].measure
        word = slots["d"].adjective
        return More(what, sign, f"more {word}" if sign > 0 else f"less {word}")
    if "by_a" in slots:
        return more(("taller",))
    return More("footprint", sign, "larger on the floor" if sign > 0 else "smaller on the floor")


def _which(a: Meant, b: Meant, degree: More, survey: Survey) -> Answer:
    """The one of two phrases with more of a measure."""
    ones, others = _values(a, degree.measure, survey), _values(b, degree.measure, survey)
    high, low = (a, b), (b, a)
    if min(ones) > max(others):
        winner, loser = high if degree.sign > 0 else low
    elif min(others) > max(ones):
        winner, loser = low if degree.sign > 0 else high
    elif same(max(ones), min(others)) and same(min(ones), max(others)):
        text = f"They are the same: {_told(ones[0], degree.measure)}."
        return Answer(answer="equal", answer_type="label", text=text, confidence=0.8,
                      evidence=evidence([*a.things, *b.things]))  # fmt: skip
    else:
        raise (a if len(ones) > 1 and not a.plural else b).differ()
    own, other = _middle(winner, degree.measure, survey), _middle(loser, degree.measure, survey)
    thing, second = winner.things[0], loser.things[0]
    said = told_apart(survey, thing, [second])
    text = (
        f"{survey.named(thing)} is {degree.word}: {_told(own, degree.measure)} against {_told(other, degree.measure)}."
    )
    things = [*winner.things[1:], *loser.things]
    return label(thing, _up(text), _sure(own, other, degree, thing, second), others=things, said=said)


def _of_itself(phrase: Meant, degree: More, other: Measure, survey: Survey) -> Answer | None:
    """Whether one side of a thing is longer than another side of it: "is the desk wider than it is deep?"."""
    if degree.measure == other or not {degree.measure, other} <= {"width", "depth", "height", "length", "thickness"}:
        return None
    pairs = [(measure(survey, t, degree.measure), measure(survey, t, other)) for t in phrase.things]
    holds = [(own - second) * degree.sign > 0 for own, second in pairs]
    if len(set(holds)) > 1 and not phrase.plural:
        raise phrase.differ()
    told = listed([f"{survey.named(t)}: {degree.measure} {told_length(own)}, {other} {told_length(second)}"
                   for t, (own, second) in list(zip(phrase.things, pairs, strict=True))[:6]])  # fmt: skip
    return yes_no(all(holds), f"{told}.", phrase.things, min(certainty(own, second) for own, second in pairs))


def _is_more(a: Meant, b: Meant, degree: More, survey: Survey) -> Answer:
    """Whether all things of one phrase have more of a measure than all of another."""
    ones, others = _values(a, degree.measure, survey), _values(b, degree.measure, survey)
    if degree.sign > 0:
        holds, fails = min(ones) > max(others), max(ones) <= min(others)
    else:
        holds, fails = max(ones) < min(others), min(ones) >= max(others)
    if not holds and not fails:
        for phrase in (a, b):
            if len(phrase.things) > 1 and not phrase.plural:
                raise phrase.differ()
    told = f"{_named(a, survey)} {_told(_middle(a, degree.measure, survey), degree.measure)}"
    told += f", {_named(b, survey)} {_told(_middle(b, degree.measure, survey), degree.measure)}."
    sure = _sure(
        _middle(a, degree.measure, survey), _middle(b, degree.measure, survey), degree, a.things[0], b.things[0]
    )
    return yes_no(holds, told, [*a.things, *b.things], sure)


def _of_pair(pair: Meant, degree: More, survey: Survey) -> Answer | None:
    """The one of two or more things of a phrase with most of a measure."""
    things = list(pair.things)
    if len(things) < 2:
        return None
    ranked = sorted(things, key=lambda t: -degree.sign * measure(survey, t, degree.measure))
    best, second = (measure(survey, t, degree.measure) for t in ranked[:2])
    if same(best, second) and abs(best - second) < 0.005 * max(best, second, 1e-9):
        text = f"They are the same: {_told(best, degree.measure)}."
        return Answer(answer="equal", answer_type="label", text=text, confidence=0.8, evidence=evidence(things))
    told = listed(
        [f"{survey.named(t)} {_told(measure(survey, t, degree.measure), degree.measure)}" for t in ranked[:6]]
    )
    said = told_apart(survey, ranked[0], ranked[1:])
    return label(ranked[0], _up(f"{told}."), certainty(best, second), others=ranked[1:], said=said)


def _difference(asked: Asked, degree: More, survey: Survey) -> Answer | None:
    """By how much one thing exceeds another, in metres."""
    a, b = meant(survey, asked.slots["by_a"]), meant(survey, asked.slots["by_b"])
    what: Measure = degree.measure
    if what in ("size", "volume", "footprint"):
        return None
    for phrase in (a, b):
        values = _values(phrase, what, survey)
        if not same(min(values), max(values)):
            raise phrase.differ()
    own, other = _middle(a, what, survey), _middle(b, what, survey)
    apart = degree.sign * (own - other) if "m" in asked.slots else abs(own - other)
    value, answer_type, unit, told = in_unit(abs(apart), asked.slots.get("u"))
    text = f"By {told}: {_named(a, survey)} {told_length(own)}, {_named(b, survey)} {told_length(other)}."
    if apart < 0:
        text = f"It is the other way round, by {told}. {text}"
        value = -value
    return Answer(answer=value, answer_type=answer_type, text=_up(text), confidence=0.9, unit=unit,
                  evidence=evidence([*a.things, *b.things]))  # fmt: skip


def _equal(asked: Asked, survey: Survey) -> Answer | None:
    """Whether things have the same measure, within what people call the same."""
    slots = asked.slots
    what: Measure = slots["d"].measure
    phrases = [meant(survey, slots[n]) for n in ("eq", "diff", "eq_x", "eq_y") if n in slots]
    things = [t for p in phrases for t in p.things]
    if len(things) < 2:
        return None
    measures: Sequence[Measure] = ("width", "depth", "height") if what == "size" else (what,)
    values = [[measure(survey, t, m) for t in things] for m in measures]
    holds = all(same(min(v), max(v)) for v in values)
    if "as" in asked.words and "eq_x" in slots and "same" not in asked.words and what != "size":
        own, other = _middle(phrases[0], what, survey), _middle(phrases[1], what, survey)
        holds = own >= other or same(own, other)
    told = listed([f"{survey.named(t)} {_sides(t, what, survey)}" for t in things[:8]])
    return yes_no(holds != ("diff" in slots), f"{told}.", things, 0.85)


def _sides(thing: Thing, what: Measure, survey: Survey) -> str:
    if what != "size":
        return _told(measure(survey, thing, what), what)
    sides: tuple[Measure, ...] = ("width", "depth", "height")
    return " × ".join(f"{measure(survey, thing, m):.2f}" for m in sides) + " m"


def _values(phrase: Meant, what: Measure, survey: Survey) -> list[float]:
    return [measure(survey, t, what) for t in phrase.things]


def _middle(phrase: Meant, what: Measure, survey: Survey) -> float:
    values = sorted(_values(phrase, what, survey))
    return values[len(values) // 2]


def _named(phrase: Meant, survey: Survey) -> str:
    return listed([survey.named(t) for t in phrase.things[:6]])


def _told(value: float, what: Measure) -> str:
    """A measure in words, with its unit."""
    if what in ("size", "volume"):
        return f"{value:.3g} m³"
    return f"{value:.2f} m²" if what == "footprint" else told_length(value)


def _sure(own: float, other: float, degree: More, a: Thing, b: Thing) -> float:
    """Certainty of a comparison; less where two things are larger in different ways."""
    sure = certainty(own, other)
    if degree.measure != "size":
        return sure
    areas = [t.group.box.size[0] * t.group.box.size[1] for t in (a, b)]
    agrees = (areas[0] > areas[1]) == (own > other) == (degree.sign > 0 or own < other)
    return sure if agrees or (areas[0] > areas[1]) == (own > other) else min(sure, 0.75)


def _up(text: str) -> str:
    return text[:1].upper() + text[1:]


KIND = Kind("comparison", templates(_PHRASES), answer)
