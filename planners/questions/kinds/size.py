"""How tall, wide, deep, long or large things are, also against a stated length: "is the table wider than 1 m?"."""

from __future__ import annotations

from ....gaussians.world.person import EYE_HEIGHT
from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import agreed, certainty, in_unit, measure, same, sides, told_each, told_size
from ..reading.measures import Measure, Unit
from ..reading.phrase_templates import templates
from ..resolving import Meant, meant
from ..survey import Survey, Thing, listed
from ..telling import evidence, number, yes_no

ADULT = EYE_HEIGHT + 0.12  # metres: the height of a standing adult; eyes are about 12 cm below the crown
_UNIT = "[in {u:unit}|in {u:unit} and {v:unit}|measured in {u:unit}|expressed in {u:unit}|, {u:unit}]"
_HOLDS = "(is|are|be|was|would be|measures|stands|does|do|has|have)"
_OVER = "(more than|over|greater than|above|upwards of|longer than|larger than|bigger than)"
_UNDER = "(less than|under|below|shorter than|smaller than)"
_PHRASES = f"""
    how {{d:dimension}} BE {{x}} [together|altogether|in total|combined] {_UNIT}
    how {{d:dimension}} in {{u:unit}} BE {{x}}
    how {{d:dimension}} {{x}} {_UNIT}
    how (much|many) {{d:dimension}} (does|do|has) {{x}} (have|measure) {_UNIT}
    (what|which) {{d:dimension}} {_HOLDS} {{x}} [have|of|measure] {_UNIT}
    [what (is|are|was|would be)] [the] [approximate|overall|exact|total|combined|summed|rough|actual|full|\
        physical] {{d:dimension}} of {{x}} {_UNIT}
    the {{d:dimension}} of {{x}} (is|are) (what|how much) {_UNIT}
    [what (is|are)] {{x}} 's [overall|exact|total|approximate] {{d:dimension}} {_UNIT}
    [what is] the {{x}} {{d:dimension}} {_UNIT}
    (what|how many) {{u:unit}} {{d:dimension}} BE {{x}}
    how many {{u:unit}} (is|are) {{x}} {{d:dimension}}
    how many {{u:unit}} (does|do) {{x}} measure [in {{d:dimension}}]
    how many {{u:unit}} (in|of) {{d:dimension}} (is|are|has|does) {{x}} [have|measure]
    {{x}} (is|are) how {{d:dimension}} {_UNIT}
    {{x}} {{d:dimension}} {_UNIT}
    (give|state|measure|tell|list|show|estimate|describe|name) [me] [the] [approximate|overall|exact] {{d:dimension}} \
        of {{x}} {_UNIT}
    measure {{all}} {_UNIT}
    (what|how much) {{d:dimension}} does {{x}} (measure|have|reach|come to) {_UNIT}
    (what|how much) (does|do) {{all}} measure {_UNIT}
    how (much|many) [floor] (space|room|area|floor|ground) (does|do|is) {{floor}} (take up|occupy|need|cover|taking \
        up|use|require|take|fill|occupying) [on the floor]
    (what|how large an|how big an|how much) (area|floor area|footprint) (does|do|is) {{floor}} (cover|occupy|take up|\
        have|need|covered by) [on the floor]
    how much (space|room) is (taken up|occupied) by {{floor}}
    how (high|far) [up] (off|above|from|over) the (floor|ground) BE {{up}} [mounted|hung|hanging|fixed|attached|\
        placed|installed|standing|located|positioned|up] {_UNIT}
    how high [up] BE {{up}} (mounted|hung|hanging|fixed|attached|placed|installed|off the floor|off the ground|above \
        the floor|above the ground|over the floor|from the floor|from the ground|positioned|up|up on the wall|on the \
        wall|located) [off the floor|above the floor|on the wall] {_UNIT}
    how high up BE {{up}} {_UNIT}
    (at what height|what height) BE {{up}} [at|mounted|hung|hanging|fixed|attached|placed|installed|located] {_UNIT}
    (what is|give me) the height of {{up}} (above|off|over|from) the (floor|ground) {_UNIT}
    BE {{x}} [any|at all] {{m:more}} than {{l:length}} [tall|wide|deep|long|high|in height|in width|across]
    BE {{x}} {_OVER} {{l:length}} {{d:dimension}}
    BE {{x}} {_OVER} {{l:length}} in {{d:dimension}}
    BE {{x}} [at least|no less than|a minimum of] {{least:length}} {{d:dimension}} [or more]
    BE {{x}} {_UNDER} {{under:length}} [in] {{d:dimension}}
    BE {{x}} (at most|no more than|up to|not more than) {{most:length}} [in] {{d:dimension}}
    BE {{x}} (exactly|about|around|roughly|approximately) {{about:length}} [in] {{d:dimension}}
    BE the {{d:dimension}} of {{x}} (more than|over|greater than|above|larger than|bigger than) {{l:length}}
    BE the {{d:dimension}} of {{x}} (less than|under|below|smaller than) {{under:length}}
    (does|do) {{x}} measure {_OVER} {{l:length}} [in] {{d:dimension}}
    BE {{x}} {{m:more}} than (me|i am|i|us|you|a person|an adult|a man|a woman|a human|an average person|the average \
        person|a grown up|an average adult|a standing person|a human being|most people) [{{person}}]
    BE {{x}} as {{d:dimension}} as (me|i am|i|a person|an adult|a man|an average person|a human)
"""
_SURE = 0.95
_SUMMED = frozenset({"total", "combined", "summed", "together", "altogether"})
_SUMS: tuple[Measure, ...] = ("width", "depth", "height", "length", "thickness")
_FLAT = 0.15  # of its second longest side: thickness up to which the area of a thing is that of its face
_OF_BOX = "as its box is measured"


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """A measure, or whether it exceeds a length."""
    slots = asked.slots
    if "up" in slots:
        return _above_floor(meant(survey, slots["up"]), slots.get("u"), survey)
    if "floor" in slots:
        return _measured(meant(survey, slots["floor"]), "footprint", None, survey)
    if "all" in slots:
        return _size(meant(survey, slots["all"]), slots.get("u"), survey)
    phrase = meant(survey, slots["x"])
    if all(t.node is None for t in phrase.things):
        return None  # the floor, the walls and the ceiling are measured as the room is
    if any(n in slots for n in ("l", "least", "under", "most", "about")):
        return _against(asked, phrase, survey)
    if {"than", "as"} & set(asked.words) and "u" not in slots:
        return _against_person(asked, phrase, survey)
    if "d" not in slots:
        return _size(phrase, slots.get("u"), survey)
    what: Measure = slots["d"].measure
    if phrase.plural and len(phrase.things) > 1 and _SUMMED & set(asked.words) and what in _SUMS:
        return _summed(phrase, what, slots.get("u"), survey)
    if what == "footprint" and not {"footprint", "floor", "base"} & set(asked.words):
        return _face(phrase, survey)
    pointed = phrase.query.groups or phrase.query.last
    if what == "size" and not phrase.query.text and not pointed and "size" not in asked.words:
        return None  # "how big is everything" asks for the room
    if what == "size":
        return _size(phrase, slots.get("u"), survey)
    hung = phrase.things[0].node is not None and phrase.things[0].node.support in ("wall", "ceiling")
    if what == "height" and "high" in asked.words and hung and "x" in slots:
        return _hung(phrase, slots.get("u"), survey)
    return _measured(phrase, what, slots.get("u"), survey)


def _measured(phrase: Meant, what: Measure, unit: Unit | None, survey: Survey) -> Answer:
    """One measure of what a phrase means; of several things that differ it is told for each."""
    values = [measure(survey, t, what) for t in phrase.things]
    one = agreed(values)
    if one is None and not phrase.plural:
        raise phrase.differ()
    if what in ("footprint", "volume"):
        return _area(phrase, values, what, survey)
    if one is None:
        told = told_each(survey, phrase.things, [in_unit(v, unit)[3] for v in values])
        table = tuple({"id": t.id, "thing": survey.named(t), what: round(v, 3)}
                      for t, v in zip(phrase.things, values, strict=True))  # fmt: skip
        said = tuple(f"{t.name}: {in_unit(v, unit)[3]}" for t, v in zip(phrase.things, values, strict=True))
        return Answer(answer=said, answer_type="list", text=_up(f"{told}."), confidence=_SURE, table=table,
                      evidence=evidence(phrase.things))  # fmt: skip
    value, answer_type, name, told = in_unit(one, unit)
    many = len(phrase.things) > 1 and phrase.plural
    subject = f"Each of the {len(phrase.things)}" if many else survey.named(phrase.things[0])
    adjective = {"width": "wide", "depth": "deep", "height": "high", "length": "long", "thickness": "thick"}[what]
    return Answer(answer=value, answer_type=answer_type, text=_up(f"{subject} is {told} {adjective}."),
                  confidence=_SURE, unit=name, evidence=evidence(phrase.things))  # fmt: skip


def _summed(phrase: Meant, what: Measure, unit: Unit | None, survey: Survey) -> Answer:
    """The sum of one measure of several things: "the total width of both counters"."""
    values = [measure(survey, t, what) for t in phrase.things]
    value, answer_type, name, told = in_unit(sum(values), unit)
    each = told_each(survey, phrase.things[:8], [in_unit(v, unit)[3] for v in values[:8]])
    return Answer(answer=value, answer_type=answer_type, text=_up(f"{told} together: {each}."), confidence=0.9,
                  unit=name, evidence=evidence(phrase.things))  # fmt: skip


def _area(phrase: Meant, values: list[float], what: Measure, survey: Survey) -> Answer:
    total = sum(values) if phrase.plural else values[0]
    unit = "m2" if what == "footprint" else "m3"
    sign = "m²" if what == "footprint" else "m³"
    named = listed([survey.named(t) for t in (phrase.things if phrase.plural else phrase.things[:1])])
    verb = "cover" if what == "footprint" else "fill"
    text = f"{named} {verb}{'' if phrase.plural and len(values) > 1 else 's'} {total:.2f} {sign}, {_OF_BOX}."
    return number(total, _up(text), phrase.things, 0.9, unit)


def _face(phrase: Meant, survey: Survey) -> Answer:
    """The area of a flat thing, as of a board on a wall; of other things that of the floor under it."""
    flat = all(measure(survey, t, "thickness") < _FLAT * sorted(sides(survey, t))[1] for t in phrase.things)
    if not flat:
        return _measured(phrase, "footprint", None, survey)
    areas = [max(a * b, b * c, a * c) for a, b, c in (sides(survey, t) for t in phrase.things)]
    if not phrase.plural and agreed(areas) is None:
        raise phrase.differ()
    total = sum(areas) if phrase.plural else areas[0]
    named = listed([survey.named(t) for t in (phrase.things if phrase.plural else phrase.things[:1])])
    return number(total, _up(f"{named}: {total:.2f} m², its face."), phrase.things, 0.9, "m2")


def _size(phrase: Meant, unit: Unit | None, survey: Survey) -> Answer:
    """The three sides."""
    told = [told_size(survey, t, unit) for t in phrase.things]
    alike = all(agreed([sides(survey, t)[i] for t in phrase.things]) is not None for i in range(3))
    if not alike and not phrase.plural:
        raise phrase.differ()
    if alike:
        name = "Each" if phrase.plural and len(told) > 1 else survey.named(phrase.things[0])
        return Answer(answer=told[0], answer_type="text", text=_up(f"{name} is {told[0]}."), confidence=_SURE,
                      unit=unit.name if unit else "m", evidence=evidence(phrase.things),
                      table=_sizes(phrase.things[:1], survey))  # fmt: skip
    text = told_each(survey, phrase.things, [f"is {t}" for t in told])
    return Answer(answer=text[:4000], answer_type="text", text=_up(f"{text}.")[:4000], confidence=_SURE,
                  unit=unit.name if unit else "m", evidence=evidence(phrase.things),
                  table=_sizes(phrase.things, survey))  # fmt: skip


def _sizes(things: tuple[Thing, ...], survey: Survey) -> tuple[dict[str, object], ...]:
    rows: list[dict[str, object]] = []
    for thing in things:
        width, depth, height = (round(s, 3) for s in sides(survey, thing))
        named = survey.named(thing)
        rows.append({"id": thing.id, "thing": named, "width": width, "depth": depth, "height": height})
    return tuple(rows)


def _above_floor(phrase: Meant, unit: Unit | None, survey: Survey) -> Answer:
    """Height above the floor of the underside; of what hangs on a wall, of its middle."""
    return _hung(phrase, unit, survey)


def _hung(phrase: Meant, unit: Unit | None, survey: Survey) -> Answer:
    lows = [t.group.box.center[2] - measure(survey, t, "height") / 2 for t in phrase.things]
    mids = [t.group.box.center[2] for t in phrase.things]
    thing = phrase.things[0]
    on_wall = thing.node is not None and thing.node.support == "wall"
    values = mids if on_wall else lows
    one = sum(values) / len(values) if max(values) - min(values) < 0.05 else None
    if one is None:
        raise phrase.differ()
    value, answer_type, name, told = in_unit(max(one, 0.0), unit)
    high = in_unit(measure(survey, thing, "height"), unit)[3]
    part = "The middle of" if on_wall else "The underside of"
    text = f"{part} {survey.named(thing)} is {told} above the floor; it is {high} high itself."
    return Answer(answer=value, answer_type=answer_type, text=text, confidence=0.8, unit=name,
                  evidence=evidence(phrase.things))  # fmt: skip


def _against(asked: Asked, phrase: Meant, survey: Survey) -> Answer:
    """A measure against a stated length."""
    slots = asked.slots
    name = next(n for n in ("l", "least", "under", "most", "about") if n in slots)
    limit: float = slots[name]
    what: Measure = slots["m"].measure if "m" in slots else slots["d"].measure
    what = "length" if what == "size" else what
    less = name in ("under", "most") or ("m" in slots and slots["m"].sign < 0)
    values = [measure(survey, t, what) for t in phrase.things]
    near = name == "about" or (name == "least" and not {"least", "minimum", "more", "less"} & set(asked.words))
    fits = [same(v, limit) if near else v < limit if less else v > limit for v in values]
    if not phrase.plural and len(set(fits)) > 1:
        raise phrase.differ()
    told = told_each(survey, phrase.things[:8], [in_unit(v, None)[3] for v in values[:8]])
    sure = min(certainty(v, limit) for v in values) if not near else 0.85
    return yes_no(all(fits), f"{told}, against {in_unit(limit, None)[3]}.", phrase.things, sure)


def _against_person(asked: Asked, phrase: Meant, survey: Survey) -> Answer | None:
    """A height against that of an adult, which is said."""
    degree = asked.slots.get("m")
    what: Measure = degree.measure if degree else asked.slots["d"].measure
    if what not in ("height", "size", "top"):
        return None
    values = [measure(survey, t, "height") for t in phrase.things]
    taller = [v > ADULT if degree else v >= ADULT * 0.95 for v in values]
    if not phrase.plural and len(set(taller)) > 1:
        raise phrase.differ()
    holds = all(taller) if degree is None or degree.sign > 0 else not any(taller)
    told = told_each(survey, phrase.things[:8], [in_unit(v, None)[3] for v in values[:8]])
    sure = min(certainty(v, ADULT, 0.9) for v in values)
    return yes_no(holds, f"{told} high, against a person of {ADULT:.2f} m, which is assumed.", phrase.things, sure)


def _up(text: str) -> str:
    return text[:1].upper() + text[1:]


KIND = Kind("size", templates(_PHRASES), answer)
