"""The tallest, widest, smallest of things, and the second after it: "what is the largest piece of furniture?"."""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.language.query.query import Query
from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import agreed, certainty, in_unit, measure, told_length
from ..reading.measures import Measure, Superlative
from ..reading.noun_phrase import is_anything
from ..reading.noun_phrase import thing as noun_phrase
from ..reading.phrase_templates import templates
from ..resolving import all_of, meant
from ..survey import NotResolved, Survey, Thing, listed
from ..telling import absent_text, label, things_listed, told_apart, yes_no

_HERE = "[here|in here|in the room|there is|around|there]"
_THING = "[thing|one|object|item|of all|of them all|of them|of all things|thing of all|of everything]"
_MOST = "(greatest|largest|biggest|highest|most|maximum)"
_LEAST = "(smallest|least|lowest|minimum|shortest)"
_TAKES = "(takes up|take up|occupies|covers|uses|needs|fills|takes|has)"
_SPACE = "(space|room|floor space|floor area|floor|area|of the floor|of the room)"
_PHRASES = f"""
    (what|which|who) [one] [of these|of those|of them|of the following|of these things] (is|are|was|would be) [the] \
        [single] {{s:superlative}} {{x}} {_HERE}
    (what|which|who) (is|are|was|would be) [the] [single] {{s:superlative}} {_THING} {_HERE}
    (what|which) is the {{s:superlative}} [one] (of|among|out of|between) {{x}} {_HERE}
    (what|which) {{x}} (is|are|stands|looks|has to be) [the] [very] {{s:superlative}} [one|of them|of all|of them \
        all] {_HERE}
    (what|which) of {{x}} (is|are) [the] [very] {{s:superlative}} [one] {_HERE}
    (what|which) [one] [of them|of these] {_HERE} (is|are) [the] {{s:superlative}} [one|of all|of them all] {_HERE}
    (of|among|out of|from) [all] {{x}} , (what|which) [one] (is|are) [the] {{s:superlative}} [one]
    (name|find|identify|give|show|tell) [me] the {{s:superlative}} {{x}} {_HERE}
    (name|find|identify|give|show|tell) [me] the {{s:superlative}} {_THING} {_HERE}
    {{s:superlative}} {{x}} {_HERE}
    {{s:superlative}} {_THING} {_HERE}
    {{s:superlative}} {{x}} is (what|which|which one)
    {{s:superlative}} {_THING} is (what|which|which one)
    (what|which) {{x}} has [the] {_MOST} {{d:dimension}} {_HERE}
    (what|which) [thing|object|item|one] {_HERE} has [the] {_MOST} {{d:dimension}} {_HERE}
    (what|which) {{less}} has [the] {_LEAST} {{d:dimension}} {_HERE}
    (what|which) [thing|object|item|one] {_HERE} has [the] {_LEAST} {{low:dimension}} {_HERE}
    (what|which) [thing|object|item|one|of the things] {_HERE} {_TAKES} [up] [the] most {_SPACE} {_HERE}
    (what|which) {{space}} {_TAKES} [up] [the] most {_SPACE} {_HERE}
    (what|which) [thing|object|item|one|of the things] {_HERE} {_TAKES} [up] [the] least {_SPACE} {_HERE}
    BE {{a}} [really|also] [the] [single] {{s:superlative}} {{of:noun}} {_HERE}
    BE {{a}} [the] [single] {{s:superlative}} {_THING} {_HERE}
    is the {{s:superlative}} {{of:noun}} {_HERE} {{a}}
    (is|are) (anything|something|any of them|anything else) [here|in the room] {{m:more}} than {{than}}
    (is|are) there (anything|something) [here|in the room] {{m:more}} than {{than}}
    (is|are) there [any|a] {{m:more}} {{rival:noun}} than {{than}}
    (what|which) [thing|things|object|objects|items|else] [here|in the room] (is|are) {{m:more}} than {{than}} [in \
        the room|here]
    (what|which) {{rivals:noun}} (is|are) {{m:more}} than {{than}} [in the room|here]
    (what|which|which ones) are the {{n:number}} {{s:superlative}} {{x}} {_HERE}
    (name|list|show|give|find|tell) [me] the {{n:number}} {{s:superlative}} {{x}} {_HERE}
    [the] {{n:number}} {{s:superlative}} {{x}} {_HERE}
    (sort|rank|order|list|arrange|name) [me] [all] {{x}} [in order] (by|according to) [their|the|decreasing|\
        descending] {{by:dimension}} [, {{s:superlative}} first] [please]
    (sort|rank|order|list|arrange|name) [me] [all] {{x}} [in order] {{s:superlative}} first [by {{by:dimension}}]
    (sort|rank|order|list|arrange|name) [me] [all] {{x}} from {{s:superlative}} to {{end:superlative}}
    how {{high:dimension}} is the {{s:superlative}} {{x}} [in {{u:unit}}]
    what is the {{high:dimension}} of the {{s:superlative}} {{x}} [in {{u:unit}}]
    what color is the {{s:superlative}} {{x}}
    what is the color of the {{s:superlative}} {{x}}
"""


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """The thing with the most or least of a measure."""
    slots = asked.slots
    if "than" in slots:
        return _larger_than(asked, survey)
    most = _superlative(asked)
    if most is None:
        return None
    query = _among(asked)
    if query is None:
        return None
    things, found = all_of(survey, query)
    things = tuple(t for t in things if t.node is not None)
    if not things:
        raise NotResolved(query, found)
    ranked = sorted(things, key=lambda t: -most.sign * measure(survey, t, most.measure))
    if most.rank > len(ranked):
        return None
    if "n" in slots or "by" in slots or "end" in slots:
        count = int(slots["n"]) if "n" in slots else len(ranked)
        return _ranked(ranked[:count], most, survey) if 0 < count <= len(ranked) else None
    if "a" in slots:
        return _is_it(slots["a"], ranked, most, survey)
    if "high" in slots or "color" in asked.words:
        return _of_the_most(asked, ranked[most.rank - 1], survey)
    return _told(ranked, most, survey)


def _superlative(asked: Asked) -> Superlative | None:
    slots = asked.slots
    if "s" in slots and "by" not in slots:
        found: Superlative = slots["s"]
        return found
    if "by" in slots:
        by: Measure = slots["by"].measure
        if "s" in slots and slots["s"].sign < 0:
            return Superlative(by, -1, 1, f"smallest {by}")
        return Superlative(by, 1, 1, f"greatest {by}")
    if "d" in slots or "low" in slots:
        sign = -1 if "less" in slots or "low" in slots else 1
        what: Measure = (slots.get("d") or slots["low"]).measure
        return Superlative(what, sign, 1, f"{'greatest' if sign > 0 else 'smallest'} {what}")
    return Superlative("footprint", -1 if "least" in asked.words else 1, 1, "largest on the floor")


def _among(asked: Asked) -> Query | None:
    """Among what things the superlative is sought."""
    slots = asked.slots
    if "of" in slots:
        found = noun_phrase(slots["of"])
    else:
        found = slots.get("x") or slots.get("less") or slots.get("space") or Query(pick="all")
    if found is None or found.pick not in ("one", "all", "any"):
        return None
    return found


def _told(ranked: Sequence[Thing], most: Superlative, survey: Survey) -> Answer:
    thing = ranked[most.rank - 1]
    if len(ranked) > 1 and _tied(ranked, most, survey):
        values = _measure(measure(survey, thing, most.measure), most.measure)
        text = f"{listed([survey.named(t) for t in ranked[:8]])} are the same: {values}."
        return label(thing, _up(text), 0.7, others=ranked, said="equal")
    rest = [t for t in ranked if t is not thing]
    own = measure(survey, thing, most.measure)
    beside = [measure(survey, t, most.measure) for t in ranked[most.rank : most.rank + 1]]
    beside += [measure(survey, ranked[most.rank - 2], most.measure)] if most.rank > 1 else []
    sure = min((certainty(own, v) for v in beside), default=0.95)
    text = f"{survey.named(thing)}: {_measure(own, most.measure)}"
    if len(ranked) > most.rank:
        after = ranked[most.rank]
        text += f", before {survey.named(after)}, {_measure(measure(survey, after, most.measure), most.measure)}"
    alike = [t for t in ranked if t.label == thing.label]
    said = told_apart(survey, thing, ranked) if len(alike) == len(ranked) else thing.name
    return label(thing, _up(f"{text}."), sure, others=rest[:3], said=said)


def _ranked(ranked: Sequence[Thing], most: Superlative, survey: Survey) -> Answer:
    """Things in the order of a measure."""
    told = [f"{survey.named(t)} ({_measure(measure(survey, t, most.measure), most.measure)})" for t in ranked]
    return things_listed(ranked, _up(f"{listed(told)}."), 0.9)


def _tied(ranked: Sequence[Thing], most: Superlative, survey: Survey) -> bool:
    """Whether all things have the same measure to the millimetre."""
    values = [measure(survey, t, most.measure) for t in ranked]
    return max(values) - min(values) < 1e-3 * max(*values, 1e-9)


def _is_it(query: Query, ranked: Sequence[Thing], most: Superlative, survey: Survey) -> Answer:
    """Whether a thing is the one with the most of a measure."""
    phrase = meant(survey, query)
    best = ranked[most.rank - 1]
    holds = best.id in {t.id for t in phrase.things}
    if holds and not phrase.plural and len(phrase.things) > 1 and best.label != phrase.things[0].label:
        raise phrase.differ()
    own = measure(survey, phrase.things[0], most.measure)
    other = next((t for t in ranked if t.id not in {p.id for p in phrase.things}), None)
    text = f"{survey.named(best)} is {most.word}: {_measure(measure(survey, best, most.measure), most.measure)}"
    if not holds:
        text += f"; {survey.named(phrase.things[0])} {_measure(own, most.measure)}"
    rival = best if not holds else other
    sure = certainty(own, measure(survey, rival, most.measure)) if rival is not None else 0.95
    return yes_no(holds, f"{text}.", [best, *phrase.things], sure)


def _of_the_most(asked: Asked, thing: Thing, survey: Survey) -> Answer | None:
    """A measure or the colour of the thing that the superlative picks."""
    named = survey.named(thing)
    if "color" in asked.words:
        if not thing.color:
            return None
        return label(thing, _up(f"{named} is {thing.color}."), 0.93, said=thing.color)
    what: Measure = asked.slots["high"].measure
    if what in ("size", "footprint", "volume"):
        return None
    value, answer_type, unit, told = in_unit(measure(survey, thing, what), asked.slots.get("u"))
    base = label(thing, _up(f"{named}: {told}."), 0.93)
    return base.model_copy(update={"answer": value, "answer_type": answer_type, "unit": unit})


def _larger_than(asked: Asked, survey: Survey) -> Answer | None:
    """What exceeds a thing in a measure."""
    slots = asked.slots
    degree, than = slots["m"], meant(survey, slots["than"])
    words = slots.get("rival") or slots.get("rivals")
    query = noun_phrase(words) if words else Query(pick="all")
    if query is None or than.plural:
        return None
    marks = [measure(survey, t, degree.measure) for t in than.things]
    if agreed(marks) is None:
        raise than.differ()
    mark = measure(survey, than.things[0], degree.measure)
    things, found = all_of(survey, query)
    rivals = [t for t in things if t.node is not None and t.id not in {m.id for m in than.things}]
    fit = [t for t in rivals if degree.sign * (measure(survey, t, degree.measure) - mark) > 0]
    fit.sort(key=lambda t: -degree.sign * measure(survey, t, degree.measure))
    told = [f"{survey.named(t)} ({_measure(measure(survey, t, degree.measure), degree.measure)})" for t in fit[:12]]
    against = f"{survey.named(than.things[0])} is {_measure(mark, degree.measure)}."
    text = f"{', '.join(told) or 'nothing'} is {degree.word}; {against}"
    if not rivals and not is_anything(query):
        text = absent_text(survey, query, found)
    if asked.words[0] in ("is", "are"):
        return yes_no(bool(fit), text, [*fit, than.things[0]], 0.93)
    return Answer(answer=tuple(t.name for t in fit), answer_type="list", text=_up(text), confidence=0.9,
                  evidence=label(than.things[0], "", others=fit).evidence)  # fmt: skip


def _measure(value: float, what: Measure) -> str:
    if what in ("size", "volume"):
        return f"{value:.3g} m³"
    if what == "top":
        return f"its top at {told_length(value)}"
    return f"{value:.2f} m²" if what == "footprint" else told_length(value)


def _up(text: str) -> str:
    return text[:1].upper() + text[1:]


KIND = Kind("superlative", templates(_PHRASES), answer)
