"""How many there are, and conditions on numbers: "how many seats?", "are there more than two lamps?"."""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.language.query.query import Query, Relation
from ....gaussians.world import kinds
from ....gaussians.world.words import plural
from ..answer import Answer
from ..kind import Asked, Kind
from ..reading import families
from ..reading.measures import Amount
from ..reading.noun_phrase import is_anything
from ..reading.noun_phrase import thing as noun_phrase
from ..reading.phrase_templates import templates
from ..relating import related
from ..resolving import Meant, all_of, meant
from ..survey import Survey, Thing, be, listed
from ..telling import GRAPH_SURE, absent_text, bare, evidence, label, number, yes_no

_ROOM = "(the room|this room|it|this place|the scene|this scene|this|we|you|i|they|people)"
_HOLD = "(have|contain|hold|include|see|find|spot|count|got|own|make out|get|possess|feature|notice|identify|detect)"
_PHRASES = f"""
    how many (people|persons|guests|visitors|adults|of us|friends|folks|diners) (can|could|may|might|would|will) \
        [comfortably|possibly] (sit|be seated|sit down|find a seat|have a seat|take a seat|get a seat|be able to sit|\
        be sitting) [down] [at once|at the same time|together|for dinner|for a meal|to eat|for lunch|for breakfast] \
        [here|in here|in the room|at the same time]
    how many (people|persons|guests) (does|do|can|could) (the room|this room|it|we|i|you) (seat|accommodate|sit) [at \
        once|at the same time]
    how many (people|persons|guests|of us|friends) (can|could|may|would) [comfortably] (sit|be seated|sit down|find a \
        seat|fit|have a seat|eat|have dinner) [down] (at|around|on|in) {{at}}
    how many (people|persons|guests) (does|do|can|could|would) {{at}} (seat|hold|take|accommodate|have room for)
    how many {{first}} and how many {{second}} [(are|is) there|do we have|can you see|does the room have|do you see] \
        [here|in here|in the room]
    (is|are) there {{n:amount}} {{x}}
    [whether] there (is|are) {{n:amount}} {{x}}
    (does|do|did|has|have|can|could) {_ROOM} {_HOLD} {{n:amount}} {{x}}
    [whether] {_ROOM} (has|have|contains|holds|includes|has got) {{n:amount}} {{x}}
    (is|are) the number of {{x}} {{n:amount}}
    is the number of {{x}} (greater than|more than|bigger than|larger than|higher than) {{more}}
    (are|is) {{n:amount}} {{x}} (here|in here|in the room|there|present)
    (are|is) {{n:amount}} of {{of}} {{c:color}}
    (is|are) there (an odd|an uneven) number of {{odd}}
    (is|are) there an even number of {{even}}
    (is|are) the (number|amount) of {{odd}} (odd|uneven)
    (is|are) the (number|amount) of {{even}} even
    (is|are) the (number|amount) of {{parity}} (odd or even|even or odd|an even or odd number|an odd or even number|\
        uneven or even|even or uneven)
    (is|are) there (an even or odd|an odd or even|even or odd|odd or even) (number|amount) of {{parity}}
    can the (number|amount) of {{x}} be divided by {{by:number}} [without remainder|evenly]
    (is|are) there (more|a greater number of|a larger number of) {{a}} than {{b}}
    [whether] there (is|are) (more) {{a}} than {{b}}
    (does|do|can) {_ROOM} {_HOLD} more {{a}} than {{b}}
    (is|are) there (fewer|less) {{b}} than {{a}}
    (does|do|can) {_ROOM} {_HOLD} (fewer|less) {{b}} than {{a}}
    (is|are) there as many {{same_a}} as [there are] {{same_b}}
    (does|do|can) {_ROOM} {_HOLD} as many {{same_a}} as {{same_b}}
    (is|are) there (the same|an equal) number of {{same_a}} (and|as) [there are] {{same_b}}
    (is|are) the number of {{same_a}} (the same as|equal to) the number of {{same_b}}
    (what|which) (is|are) there more of [here|in here|in the room] {{which_a}} or {{which_b}}
    (is|are) there more {{which_a}} or [more] {{which_b}}
    how many [different|distinct] (kinds|types|sorts|categories) of {{kinds}} [are there|do we have|can you see|does \
        the room have|is there] [here|in the room]
    how many more {{diff_a}} (are there than|than) {{diff_b}} [are there|do we have|does the room have|can you see]
    how many more {{diff_a}} than {{diff_b}} (are there|do we have)
    (how many|what number of) (of the|of these|of those|of all the|of all) {{x}} (are|is|look|looks) {{c:color}}
    (how many|what number of) {{x}} (are|is|look|looks) [there that are|colored] {{c:color}}
    (how many|what number of) {{x}} (are|is) [there that are] not {{not_c:color}}
    (how many|what number of) {{noun:noun}} (is|are|stand|stands|lie|lies|sit|sits|hang|hangs|rest|rests|can be found|\
        can be seen|can i find|can you find|do we have|do you see|can you see|can i see|are there|is there|there are|\
        do i have) [there|standing|sitting|lying|placed|located|positioned|hanging|resting|found|stored|kept|mounted|\
        hung|to be found|stood] {{place:place}}
    (how many|what number of) {{noun:noun}} does {{holder}} (have|hold|carry|contain|support) [on it|on top|in it|\
        inside|on top of it]
    (how many|what number of) {{x}} [in total|in all|altogether|exactly]
    (how many|what number of) {{x}} (is|are|was|were|would be) [there|visible|present|in view|here|in here|in the \
        room|around|shown|standing around|lying around] [in total|in the room|in here|here|altogether|that you can \
        see|that you see|all together]
    (how many|what number of) {{x}} there (is|are) [in the room|in here|here]
    (how many|what number of) {{x}} (do|does|can|could|did|have|has) {_ROOM} [altogether] [{_HOLD}] [in total|in the \
        room|in here|here]
    (how many|what number of) {{x}} (can|could) be (seen|found|counted|spotted) [in the room|in here|here]
    (how many|what number of) {{x}} {_ROOM} (has|have|contains|holds|includes|has got|have got|can see|see) [in total|\
        in the room|in here|here]
    (how many|what number of) (of the things|things|objects|items|of them|of these) [here|in the room|in here] \
      are {{x}}
    [what is|what was] [the] [total|exact|overall] (number|amount|count|quantity) of {{x}} [in total|in the room|in \
        here|here|that you can see|present|visible]
    count [me|up|all|for me] {{x}} [in the room|in here|here]
    count how many {{x}} (there are|are there) [in the room|in here|here]
    (how many|what number of) {{noun:noun}} (have|has|hold|carry|contain) {{had:noun}} [on it|on top|on them|in it|in \
        them|on top of them]
    (how many|what number of) {{noun:noun}} (does|do) {{holder}} (have|hold|carry|contain|seat) [around it|at it|next \
        to it|by it]
    how many times does {{x}} (appear|occur) [here|in the room]
    {{x}} (how many|count|number) [are there|of them]
"""


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """A count, or whether a condition on counts holds."""
    slots = asked.slots
    if "which_a" in slots or "diff_a" in slots or "same_a" in slots or "a" in slots:
        return _compared(asked, survey)
    if not slots:
        return _places_to_sit(survey)
    if "at" in slots:
        return _seated_at(meant(survey, slots["at"]), survey)
    if "first" in slots:
        return _counted_apart([slots["first"], slots["second"]], survey)
    if "odd" in slots or "even" in slots or "parity" in slots or "by" in slots:
        return _parity(asked, survey)
    if "kinds" in slots:
        things, _ = all_of(survey, slots["kinds"])
        labels = list(dict.fromkeys(t.name for t in things))
        return number(len(labels), f"{len(labels)}: {listed(labels)}.", things, 0.85)
    if "more" in slots:
        return None
    if "holder" in slots:
        return _held(asked, survey)
    query = _described(asked)
    if query is None or query.last:
        return None
    if "n" in slots:
        return _condition(slots["n"], query, survey)
    return _count(query, survey)


def _described(asked: Asked) -> Query | None:
    """What is counted: with a colour or a place that the template has apart."""
    slots = asked.slots
    if "noun" in slots:
        if "holder" in slots:
            return None  # counted apart, by what it holds
        place = slots["place"] if "place" in slots else ("with", *slots["had"])
        return noun_phrase((*slots["noun"], *place))
    query: Query = slots["of"] if "of" in slots else slots["x"]
    if "not_c" in slots:
        return None if query.also else query.model_copy(update={"not_colors": (*query.not_colors, slots["not_c"])})
    if "c" in slots:
        if query.also:
            return None
        query = query.model_copy(update={"colors": (*query.colors, slots["c"])})
    return query


def _count(query: Query, survey: Survey) -> Answer:
    things, found = all_of(survey, query)
    if query.text == "corner" and not query.relations:
        return number(4, "The room has 4 corners.", (), 0.8)
    if not things:
        return number(0, absent_text(survey, found.about or query, found), found.near, GRAPH_SURE - 0.03)
    verb = be(things)
    names = (
        f": {listed([survey.named(t) for t in things])}"
        if 1 < len(things) <= 8 and query.text != things[0].label
        else ""
    )
    sure = 0.9 if query.text in families.named() else GRAPH_SURE
    return number(len(things), f"There {verb} {survey.counted(things)}{names}.", things, sure)


def _held(asked: Asked, survey: Survey) -> Answer | None:
    """How many things are on or in a thing; where there are none and the question leaves it open, next to it."""
    noun, holder = asked.slots["noun"], asked.slots["holder"]
    query = noun_phrase(noun)
    if query is None or query.relations or is_anything(holder):
        return None
    anchors = (holder.model_copy(update={"pick": "one"}) if holder.pick == "any" else holder,)
    counted = None
    for name in ("on", "inside", "next_to"):
        held = query.model_copy(update={"relations": (Relation(name=name, anchors=anchors),), "pick": "all"})
        counted = _count(held, survey)
        if counted.answer or (name == "inside" and {"on", "in", "inside"} & set(asked.words)):
            return counted
    return counted


def _condition(amount: Amount, query: Query, survey: Survey) -> Answer | None:
    if query.count is not None:
        return None
    things, found = all_of(survey, query)
    if not things:
        return yes_no(amount.holds(0), _lower(absent_text(survey, found.about or query, found)), found.near)
    verb = be(things)
    return yes_no(amount.holds(len(things)), f"there {verb} {survey.counted(things)}.", things)


def _parity(asked: Asked, survey: Survey) -> Answer:
    slots = asked.slots
    name = next(n for n in ("odd", "even", "parity", "x") if n in slots)
    things, _ = all_of(survey, slots[name])
    n = len(things)
    told = f"there {be(things)} {survey.counted(things) if things else 'none'}."
    if name == "parity":
        said = "odd" if n % 2 else "even"
        return Answer(answer=said, answer_type="label", text=f"{said.capitalize()}: {told}", confidence=GRAPH_SURE,
                      evidence=yes_no(True, told, things).evidence)  # fmt: skip
    if name == "x":
        by = int(slots["by"]) or 1
        return yes_no(n % by == 0, told, things)
    return yes_no((n % 2 == 1) == (name == "odd"), told, things)


def _compared(asked: Asked, survey: Survey) -> Answer | None:
    """Numbers of two kinds of things compared."""
    slots = asked.slots
    form = next(f for f in ("which_", "diff_", "same_", "") if f"{f}a" in slots)
    a, b = slots[f"{form}a"], slots[f"{form}b"]
    if a.also or b.also:
        return None
    (ones, _), (others, _) = all_of(survey, a), all_of(survey, b)
    n, m = len(ones), len(others)
    told = f"{_number(n, a)}, {_number(m, b)}"
    things = [*ones, *others]
    if form == "which_":
        if n == m:
            return Answer(answer="equal", answer_type="label", text=f"As many of each: {told}.", confidence=0.8)
        said = plural(bare(a if n > m else b))
        return label(things[0], f"More {said}: {told}.", others=things[1:], said=said)
    if form == "diff_":
        return number(n - m, f"{told}, that is {n - m} more.", things)
    if form == "same_":
        return yes_no(n == m, f"there are {told}.", things)
    return yes_no(n > m, f"there are {told}.", things)


def _counted_apart(queries: Sequence[Query], survey: Survey) -> Answer | None:
    """The numbers of several kinds of things, each told apart: "how many beds and how many lamps?"."""
    if any(q.also or q.last or q.count is not None for q in queries):
        return None
    each = [all_of(survey, q)[0] for q in queries]
    said = tuple(_number(len(things), q) for q, things in zip(queries, each, strict=True))
    every = [t for things in each for t in things]
    return Answer(answer=said, answer_type="list", text=f"There are {listed(list(said))}.", confidence=GRAPH_SURE,
                  evidence=evidence(every))  # fmt: skip


def _seated_at(phrase: Meant, survey: Survey) -> Answer | None:
    """How many people find a seat on a thing, or next to it where it is none: "at the dining table"."""
    if all(families.holds(families.SEAT, t.label) for t in phrase.things):
        return _places(list(phrase.things), "", survey)
    counts = []
    for thing in phrase.things:
        near = [t for t in related("next_to", (thing,), survey) if families.holds(families.SEAT, t.label)]
        counts.append(_places(near, f" at {survey.named(thing)}", survey))
    if len({a.answer for a in counts}) > 1:
        raise phrase.differ()
    return counts[0]


def _places_to_sit(survey: Survey) -> Answer:
    """How many people find a seat, by the seats that things of each kind have."""
    return _places([t for t in survey.things if families.holds(families.SEAT, t.label)], "", survey)


def _places(seats: Sequence[Thing], where: str, survey: Survey) -> Answer:
    places = {t.id: kind.seats if (kind := kinds.of(t.label)) else 1 for t in seats}
    told = listed([f"{survey.named(t)} ({places[t.id]})" for t in seats])
    total = sum(places.values())
    return number(
        total,
        f"There are seats for about {total}{where}: {told}." if seats else f"There is nothing to sit on{where}.",
        seats,
        0.75,
    )


def _number(n: int, query: Query) -> str:
    return f"{n} {bare(query) if n == 1 else plural(bare(query))}"


def _lower(text: str) -> str:
    return text[0].lower() + text[1:]


KIND = Kind("counting", templates(_PHRASES), answer)
