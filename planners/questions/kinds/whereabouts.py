"""Where a thing is, at which wall or corner, and what is there: "where is the lamp?", "what is in the corner?"."""

from __future__ import annotations

import re

from ..answer import Answer, Evidence
from ..candidates import agreed, is_plural, meant, whole
from ..kind import Asked, Kind
from ..placing import place_of
from ..reading.noun_phrase import is_anything
from ..reading.phrase_templates import templates
from ..relating import supporter
from ..room_places import AT_WALL, IN_CORNER, corner_of, is_in, middle, wall_of, walls
from ..survey import Survey, Thing, listed

_ROOM = "(the room|this room|the place|here)"
_WHERE = f"""
    (where|whereabouts) [exactly] BE {{x}} [located|placed|standing|hanging|hung|mounted|fixed|kept|stored|lying|\
        at|to be \
        found|found|situated|positioned|in {_ROOM}]
    (where|whereabouts) (can|could|would|do|will|might|should) (i|we|you|one) (find|see|look for|get|spot|put my \
        hands on) {{x}} [in {_ROOM}]
    (where|whereabouts) (do|does|did) {{x}} (stand|sit|hang|lie|go|live|belong)
    [what is|give me|tell me] [the] (location|position|whereabouts|place) of {{x}} [in {_ROOM}]
    (where|whereabouts) in {_ROOM} (is|are) {{x}} [located|placed|standing]
    (where|whereabouts) (have|did) (i|you|we|they) (put|leave|left|place|hang|keep) {{x}}
    (in|at) (what|which) (part|area|place|spot|location|end|region) of {_ROOM} BE {{x}} [located|standing|found]
    (what|which) (part|area|end|region) of {_ROOM} BE {{x}} [in|at|located in]
    how (do|can|would) i find {{x}}
    (find|locate|show me where) {{x}}
    (list|name|show|find|tell me) [me] {{x}} and (where|whereabouts) (they|it) (are|is|stand|hang) [in {_ROOM}]
    describe (where|the location of|the position of) {{x}} [is|are]
    i can not find {{x}} [where is it|where are they]
    i am looking for {{x}} [where is it|where are they]
"""
_WHICH_WALL = """
    (what|which) wall BE {x} [standing|hanging|up|mounted|placed|leaning|located|attached|fixed|hung|right] \
        [against|on|at|along|near|nearest|closest|nearest to|closest to|by|up against|next to|to|in]
    (on|against|at|along|by|in|to) (what|which) wall (is|are|does|do) {x} [standing|hanging|mounted|placed|hang|\
        stand|hung|located|lean|leaning|attached|fixed]
    (what|which) wall (do|does) {x} (stand|hang|lean|sit|lie) (against|on|at|along|by|in)
    (what|which) wall (has|have|holds|carries) {x} [on it|against it|in it]
    (what|which) wall BE [the] (closest|nearest) [one] to {x}
    (what|which) of the [four] walls (is|are) {x} [on|against|at|near]
"""
_WHICH_CORNER = """
    (what|which) corner [of the room] BE {x} [standing|located|placed|in|at|nearest to|closest to|near|by]
    in (what|which) corner [of the room] (is|are|does|do) {x} [standing|located|placed|stand|sit|lie]
    (what|which) corner (has|holds|contains) {x} [in it]
"""
_ZONE = f"""
    (which|what) side of {_ROOM} BE {{x}} [standing|located|placed|hanging] [on|in|at] [left or [the] right|is it \
        left or right|the left or the right]
    on (which|what) side of {_ROOM} BE {{x}} [standing|located|placed|hanging] [left or [the] right|the left or \
        the right]
    on (which|what) side of {_ROOM} (do|does) {{x}} (stand|hang|lie|sit)
    BE {{x}} (on|in|at|to) the left or [(on|in|at|to)] [the] right [side|half|hand side] [of {_ROOM}]
    BE {{x}} (at|in|near|toward|towards) the (front|back) or [(at|in|near)] [the] (back|front) [of {_ROOM}]
"""
_IN_ZONE = """
    BE {x} [both|all|standing|located|placed|hanging|more|somewhere] (in|at|on|to|near|towards|toward|along|\
        against|up against|by) {z:zone}
    (do|does) {x} [both|all] (stand|sit|lie|hang|lean) (in|at|on|near|along|against|up against|by) {z:zone}
    (is|are) there {x} [standing|hanging|lying] (in|at|on|near|along|against|by) {z:zone}
    (do|can) (we|you|i) (have|see) {x} (in|at|on|near|along|against|by) {z:zone}
"""
_WHAT_ZONE = """
    (what|which things|what things|what objects|which objects|what furniture|which thing|which object|what \
        thing|what object) [(is|are|stands|stand|sits|hangs|lies|is there|are there|can i see|do i see|do you \
        see)] [standing|located|placed|hanging|there|to be found] (in|at|on|near|along|against|to|by) {z:zone}
    (what|which) {x} (is|are|stands|stand|hangs) [standing|located|placed|hanging] \
        (in|at|on|near|along|against|to) {z:zone}
    (list|name|describe) (everything|all things|the things|what is|all the things|all objects|the furniture|all \
        the furniture) [that is|that are|standing] (in|at|on|near|along|against) {z:zone}
    (which|what) {x} (is|are) in the corner
    how many {x} (are|is|stand|hang) [there] [standing|hanging] (in|at|on|near|along|against) {z:zone}
"""


def _where(asked: Asked, survey: Survey) -> Answer | None:
    query = asked.slots["x"]
    if asked.situation is not None or (is_anything(query) and not query.relations):
        return None
    things = survey.some(query) if is_plural(query) else meant(query, survey)
    if query.pick == "any":
        things = survey.all_of(query) or things
    if len(things) == 1:
        return _located(things[0], survey)
    told = [(t, *place_of(t, survey)) for t in things]
    text = " ".join(f"{_cap(survey.named(t))} is {place}{', ' + rest if rest else ''}." for t, place, rest in told[:8])
    same = len({place for _, place, _ in told}) == 1
    answer = told[0][1] if same else "; ".join(f"{survey.named(t)} {place}" for t, place, _ in told[:8])
    return Answer(answer=answer, answer_type="text", text=text[:4000], frame="viewer", confidence=0.85,
                  evidence=Evidence(ids=tuple(t.id for t in things)))  # fmt: skip


def _located(thing: Thing, survey: Survey) -> Answer:
    place, rest = place_of(thing, survey)
    on = supporter(thing, survey) if thing.node is not None else "floor"
    ids = (thing.id,) if isinstance(on, str) else (thing.id, on.id)
    text = f"{_cap(survey.named(thing))} is {place}{', ' + rest if rest else ''}."
    return Answer(
        answer=place, answer_type="text", text=text, frame="viewer", confidence=0.9, evidence=Evidence(ids=ids)
    )


def _which_wall(asked: Asked, survey: Survey) -> Answer | None:
    things = meant(asked.slots["x"], survey)

    def one(thing: Thing) -> Answer:
        wall, gap = wall_of(thing, survey.room)
        near = "at" if gap <= AT_WALL else f"{gap:.2f} m from"
        text = f"{_cap(survey.named(thing))} is {near} the {wall.name} wall as you look into the room."
        return Answer(answer=f"{wall.name} wall", answer_type="label", text=text, frame="viewer",
                      confidence=0.93 if gap <= AT_WALL else 0.8, evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    return agreed([(survey.named(t), one(t)) for t in things])


def _which_corner(asked: Asked, survey: Survey) -> Answer | None:
    things = meant(asked.slots["x"], survey)

    def one(thing: Thing) -> Answer:
        deep, wide, gap = corner_of(thing, survey.room)
        place = f"{deep.name} {wide.name} corner"
        near = "in" if gap <= IN_CORNER else "in no corner; it is nearest to"
        return Answer(answer=place, answer_type="label", text=f"{_cap(survey.named(thing))} is {near} the {place}.",
                      frame="viewer", confidence=0.9 if gap <= IN_CORNER else 0.6,
                      evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    return agreed([(survey.named(t), one(t)) for t in things])


def _which_zone(asked: Asked, survey: Survey) -> Answer | None:
    if asked.situation is not None and "room" not in asked.words:
        return None
    deep = bool(re.search(r"\b(?:front|back)\b", asked.said.replace("from the front", "")))
    lateral = bool(re.search(r"\b(?:left|right)\b", asked.said))
    things = meant(asked.slots["x"], survey)
    back, _, _, right = walls(survey.room)

    def one(thing: Thing) -> Answer:
        wide, far = float(middle(thing) @ right.out) / right.reach, float(middle(thing) @ back.out) / back.reach
        along = far if deep and not lateral else wide
        if not deep and not lateral and abs(far) > abs(wide):
            along, names = far, ("back", "front")
        else:
            names = ("back", "front") if deep and not lateral else ("right", "left")
        label = names[0] if along > 0 else names[1]
        text = f"{_cap(survey.named(thing))} is on the {label} side of the room as you look into it."
        return Answer(answer=label, answer_type="label", text=text, frame="viewer",
                      confidence=round(0.6 + 0.37 * min(abs(along) / 0.2, 1.0), 3),
                      evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    return agreed([(survey.named(t), one(t)) for t in things])


def _is_personal(asked: Asked) -> bool:
    """Whether a side is that of a person whose place is stated."""
    return asked.situation is not None and not {"room", "wall", "corner"} & set(asked.words)


def _in_zone(asked: Asked, survey: Survey) -> Answer | None:
    query, said = asked.slots["x"], str(asked.slots["z"])
    if _is_personal(asked):
        return None
    exists = query.pick == "any" or bool(re.search(r"\b(?:there|have|see|anything|something)\b", asked.said))
    things = survey.things if is_anything(query) else survey.all_of(query) if exists else meant(query, survey)
    things = tuple(t for t in things if t.node is not None)  # floor, walls and ceiling are not in a place of the room
    if not things:
        return None

    on_wall = bool(re.search(r"\bon (?:the|a) (?:[\w-]+ ){0,2}walls?\b", asked.said))

    def one(thing: Thing) -> Answer:
        yes, sure = is_in(thing, said, survey.room)
        if on_wall:
            yes = yes and thing.node is not None and thing.node.support == "wall"
        if "z2" in asked.slots:
            also, other = is_in(thing, str(asked.slots["z2"]), survey.room)
            yes, sure = yes and also, min(sure, other)
        place, rest = place_of(thing, survey)
        text = f"{'Yes' if yes else 'No'}, {survey.named(thing)} is {place}{', ' + rest if rest else ''}."
        return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, frame="viewer", confidence=sure,
                      evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    cases = [(survey.named(t), one(t)) for t in things]
    if exists or is_anything(query):
        return whole(cases, "any")
    return whole(cases, "all") if is_plural(query) else agreed(cases)


def _what_in_zone(asked: Asked, survey: Survey) -> Answer | None:
    query, text = asked.slots.get("x"), asked.said
    if _is_personal(asked):
        return None
    said = str(asked.slots.get("z", "the corner"))
    wanted = None if query is None or is_anything(query) else {t.row for t in survey.all_of(query)}
    found = [t for t in survey.things if (wanted is None or t.row in wanted) and is_in(t, said, survey.room)[0]]
    found = [t for t in found if (t.node is not None and t.node.support != "ceiling") or "ceiling" in said]
    if not found and re.search(r"\b(?:middle|center)\b", said):
        central = [t for t in survey.things if (wanted is None or t.row in wanted) and t.node is not None
                   and t.node.support == "floor"]  # fmt: skip
        found = sorted(central, key=lambda t: float((middle(t) ** 2).sum()))[:1]
    if "corner" in said:
        found.sort(key=lambda t: corner_of(t, survey.room)[2])
    names = [survey.named(t) for t in found]
    where = "at" if "wall" in said else "on" if "side" in said else "in"
    sentence = f"{_cap(listed(names))} {'is' if len(found) <= 1 else 'are'} {where} {said}."
    evidence = Evidence(ids=tuple(t.id for t in found))
    if re.match(r"\W*how many", text):
        return Answer(answer=float(len(found)), answer_type="number", text=f"{len(found)}: {listed(names)}.",
                      frame="viewer", confidence=0.85, evidence=evidence)  # fmt: skip
    return Answer(answer=tuple(t.name for t in found), answer_type="list", text=sentence, frame="viewer",
                  confidence=0.85, evidence=evidence)  # fmt: skip


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("which_wall", templates(_WHICH_WALL), _which_wall),
    Kind("which_corner", templates(_WHICH_CORNER), _which_corner),
    Kind("room_side", templates(_ZONE), _which_zone),
    Kind("what_in_place", templates(_WHAT_ZONE), _what_in_zone),
    Kind("where", templates(_WHERE), _where),
)

IN_PLACE = Kind("in_place", templates(_IN_ZONE), _in_zone)
