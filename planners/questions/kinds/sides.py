"""Left, right, in front and behind: of the viewer, of a thing's own front, or of a person whose place is stated.

"Is the lamp left of the sofa?" is told as the viewer sees it, "to the sofa's left" in the sofa's own frame, and "if I
sat on the sofa, would the lamp be on my right?" from there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ....gaussians import late_re as re
from ....gaussians.world import relations
from ....gaussians.world.support import is_stepped_on
from ..answer import Answer, AnswerType, Evidence
from ..candidates import Case, agreed, is_plural, meant, unknown, whole
from ..kind import Asked, Kind
from ..reading.noun_phrase import is_anything
from ..reading.phrase_templates import templates
from ..reading.side_phrases import SIDES, Side
from ..room_places import middle
from ..survey import Survey, Thing, listed
from ..views import F64, View, is_inside, of_object, off, side_of, view_of, viewer

_HAND = "[hand] [hand side|side|side of the bed|end|arm]"
_OWN = "(to|on|at|by|next to|beside) [the]"
_STANDS = "(do|does|would|will|can|did) {x} [also] (stand|sit|lie|hang|be|appear|come|rest|go|have its place)"


def _each_verb(notation: str) -> str:
    """The lines with "BE {x}", and the same with a verb of place: "does the lamp stand left of the sofa"."""
    lines = [line for line in notation.splitlines() if line.strip()]
    return "\n".join([*lines, *(line.replace("BE {x}", _STANDS) for line in lines if "BE {x}" in line)])


_IS_SIDE = """
    BE {x} [standing|located|placed|off|over|somewhere|directly|be] {d:side}
    BE {x} (found|seen) {d:side}
    (do|does|would) {x} (stand|sit|lie|hang|be|appear) {d:side}
    (will|would|should) {x} be [off|over|somewhere|directly] {d:side}
    [whether] {x} (will|would) be [off|over] {d:side}
    (do|would|will|can|could|did) i (have|see|find) {x} {d:side}
    [whether] (is|are) there {x} {d:side}
    [whether] there (is|are|would be) {x} {d:side}
    (would|will) there be {x} {d:side}
    have i got {x} {d:side}
"""
_EITHER = _each_verb("""
    (do|would|will|can|did|could|should) i (have|see|find|get|notice) {x} [standing|located] {d:side} or {e:either}
    (do|would|will) (my|the) (left|right) [hand|side] or [my] (left|right) [hand|side] (point|face) \
        [to|toward|towards] {x}
    BE {x} [standing|located|off|over|more|rather|be] {d:side} or {e:either}
    (will|would|should) {x} be [off|over] {d:side} or {e:either}
    (do|does) {x} (stand|sit|lie|hang) {d:side} or {e:either}
    BE {x} [standing|located|off|over|more|rather|be] [(to the|on the|to|on|at the|at|in)] (left|right) or \
        [(to the|on the|to|on|at the|the|at|in)] (left|right) of (me|us|the viewer|you)
    BE {x} (in front of|behind|ahead of) or (in front of|behind|ahead of) (me|us|you)
    BE {x} (in front of|ahead of|behind) (me|us|you) or (in front of|behind|ahead of) (me|us|you)
    (which|what) side [of me|of mine] BE {x} [on] [left or right] [of me]
    is it [to|on] (my|the) (left|right) or [to|on] [my|the] (left|right) [side] that (i have|i see|i find) {x}
    on (which|what) side [of me|of mine] BE {x} [left or right]
    (which|what) side would {x} be [on]
    on (which|what) side would {x} be
    on (which|what) (hand|side) (do|would|will) i (have|find|see) {x}
    (which|what) hand BE {x} [on|closer to|nearer|nearest] [left or right]
    (which|what) hand BE (closer|nearer|closest|nearest) [to] {x} [left or right]
    on which hand BE {x}
    which [of my] (hand|arm|shoulder|side) BE (closer|nearer|closest|nearest) [to] {x} [left or right]
""")
_WHERE = """
    (which|what) (direction|way) BE {x} [from me|from here|in|located]
    in (which|what) direction BE {x} [from me|located|from here]
    in (which|what) direction (would|will) {x} be
    (which|what) (direction|way) (should|do|would|must|shall|can) i (go|turn|move|walk|head|look|face|need to \
        go|have to go|have to turn|need to turn|reach) [if i want] (to|towards|toward|for|at|to reach|to get \
        to|to see|to find|to face|to use|to open|to go to|to look at|to walk to|to leave through|to get|to \
        take|to touch|to turn on|to water|to sit on|to look out of|to approach|to move to|to exit through|in \
        order to reach|to sit at|to lie on) {x}
    (should|do|would|must) i (turn|go|look|move|walk) [to the] left or [to the] right (to|to see|to face|to \
        reach|towards|to get to|to look at|to find|to use|to open) {x}
    (where|which way) BE {x} (from me|relative to me|from my position|as seen from there|in relation to me)
    where (would|will|should) {x} be [from me|relative to me]
    where BE {x} [then|now|located]
    where BE {x} relative to me
    (at|in) (what|which) clock (direction|position) BE {x}
    at (what|which) (angle|bearing) BE {x}
    (how|by how much|by how many degrees|how many degrees|how far) (do|must|should) i [have to|need to] turn \
        (to|to face|to see|to look at) {x}
"""
_WHAT = """
    (what|which thing|what thing|what object|which object|what things|what objects|what item|which item) \
        [(is|are|stands|sits|lies|hangs|would be|do i have|do i see|can i see|would i see|will i see|would i \
        have|would i find|do i find|can be found|can be seen|is there|are there|will be|could i see|is located|is \
        standing|is the one|is right)] [located|directly|immediately|right|something|standing|straight|there] \
        {d:side}
    (what|which) {x} [(is|are|stands|sits|would be|do i have|do i see|can i see|would i see)] \
        [located|directly|immediately|right] {d:side}
    {d:side} (is|are|stands|sits) what
    {d:side} what (do|can|would|will) i see
    (list|name|tell me|describe) (everything|all things|all the things|the things|the objects|what is|all \
        objects) {d:side}
    (what|who) (do|would|will|can) i have {d:side}
    (what|which thing) (is|would be|is it) [the] (closest|nearest|first) [thing|object] {d:side}
    what is the (closest|nearest|first) (thing|object|item) {d:side}
    what is the (closest|nearest|first) (thing|object|item) [that] (i see|i run into|you run into) {d:side}
"""
_COUNT = """
    how many {x} (are|is) [there] {d:side}
    how many {x} (do|can|would|will) i (have|see|find|count) {d:side}
    how many {x} (stand|sit|lie|hang|would be|are standing|will be) {d:side}
"""
_IN_VIEW = """
    (can|could|would|will|do|am) i [be] [able to] [still] (see|look at|watch|spot|able to see) {x} [from \
        there|from here|from that \
        spot|ahead|before me|at where i am standing|from my position|from my seat|directly|then]
    BE {x} [with]in (my|the) (view|sight|field of view|line of sight) [of me]
    BE {x} visible [to me|from there|from my position|from my seat]
"""
_FACED = """
    what (am|would) i [be] (facing|looking at|seeing|see|look at|face)
    what (would|do|can|will|could) i (face|see|look at) [first|ahead] [from there]
    what is it that i (face|see)
"""
# Relations to a thing.
_OF = "(to|on|at|off to|over to|over on|in|from)"
_POV = (
    "[(from|in|by|for) (its|their|the thing 's) own (point of view|perspective|viewpoint|frame|frame of reference|"
    "orientation|view|side)|(going|judging|judged|judge) by the (way|direction) {f} (faces|face|is facing|looks|is "
    "turned)|"
    "(going|judging|judged) by [(its|their)] [own] (front|orientation)|by its own front|(as|when) seen from it|"
    "with respect to its own front|in its own frame|from its [own] (point of view|perspective)|from its front|"
    "the way it faces|as it faces|given the way (it|{f}) faces]"
)


_RELATED = _each_verb(f"""
    BE {{x}} [(standing|placed|located|directly|right|somewhere|positioned|be)] {{d:relation}} {{a}} {_POV}
""")
_OWN_SIDE = _each_verb(f"""
    BE {{x}} [(standing|placed|located|directly|right|somewhere)] {_OF} {{a}} 's [own] {{o:way}} {_HAND}
    BE {{x}} at {{a}} 's [own] {{o:way}} {_HAND}
""")
_OWN_EITHER = _each_verb(f"""
    BE {{x}} {_OF} {{a}} 's [own] (left|right) or [(to|on|at)] [its] [own] (left|right) {_HAND}
    BE {{x}} on the (left|right) or [on] [the] (left|right) [(hand side|side)] of {{a}} {_POV}
    (does|do) {{a}} have {{x}} (before|in front of|behind) (it|them) or (before|in front of|behind) (it|them) {_POV}
    (does|do) {{a}} have {{x}} on (its|their) [own] (left|right) or [(on|to)] [its|their] [own] (left|right) \
        {_HAND} {_POV}
    (taking|using|going by|in terms of|by|with) {{a}} 's own (left and right|front and \
        back|sides|frame|orientation|front) \
        [as|for] [the] [reference] [on|to] (which|what) side of it (is|are|does|do) {{x}} [stand|lie|sit|hang|on|be]
    on (which|what) of {{a}} 's [own] sides (is|are|does|do) {{x}} [stand|lie|sit|on]
    (which|what) of {{a}} 's [own] sides (is|are) {{x}} on
    on (which|what) side of {{a}} BE {{x}} (from|in) its own (point of view|perspective|frame)
""")
_OWN_WHAT = f"""
    (what|which thing|what object|what thing) [(is|are|stands|sits|lies|is standing)] \
        [located|placed|standing|found|right] {_OF} {{a}} 's [own] {{o:way}} {_HAND}
    {_OF} {{a}} 's [own] {{o:way}} {_HAND} what (is|stands) [there]
    [on|to|at] {{a}} 's [own] {{o:way}} {_HAND} [as you would sit on it|as you sit on it] what (is|stands) \
        [standing] [just] [beside it|there|next to it]
    what is (beside|next to) {{a}} on (its|their) [own] {{o:way}} {_HAND}
"""
_WHAT_OF = """
    (what|which thing|what thing|what object|which object|what things|which things|which objects|what \
        objects|what else) \
        [(is|are|stands|sits|lies|hangs|do i see|can i see|can be found|do you see|is there|are there)] \
        [located|directly|immediately|right|standing|placed|just|straight] {d:relation} {a}
    (what|which) {x} [(is|are|stands|sits|lies|hangs)] [located|directly|immediately|right|standing|placed] \
        {d:relation} {a}
    (list|name|describe) (everything|all things|the things|all the things|what is|all objects|the objects) \
        [that is|that are|standing] {d:relation} {a}
    {d:relation} {a} (what|which thing) (is|stands) [there]
"""
_EITHER_OF = _each_verb(f"""
    BE {{x}} [standing|located|placed|more] [(to the|on the|to|on|at the)] (left|right) or \
        [(to the|on the|to|on|at the|the)] (left|right) [hand side|side] of {{a}}
    BE {{x}} (in front of|behind) or (in front of|behind) {{a}} {_POV}
    BE {{x}} (in front of|behind|before) {{a}} or (in front of|behind|before) (it|them) {_POV}
    BE {{x}} (to the left of|left of|on the left of|to the right of|right of|on the right of) {{a}} or \
        [(on|to)] [(the|its)] (left|right) [of] [it] {_POV}
    (which|what) side of {{a}} BE {{x}} [on|located on|standing on] [left or right|the left or the right] {_POV}
    on (which|what) side of {{a}} BE {{x}} [located|standing] [left or right|the left or the right] {_POV}
    (which|what) (direction|way) BE {{x}} from {{a}} {_POV}
    in (which|what) direction from {{a}} BE {{x}}
    in (which|what) direction BE {{x}} from {{a}}
    to (which|what) side of {{a}} BE {{x}}
    where BE {{x}} (in relation to|relative to|with respect to|in respect to|as seen from|seen from) {{a}}
    where (in relation to|relative to|with respect to) {{a}} BE {{x}}
""")
_OWN_FRAME = re.compile(
    r"\b(?:its|their|own) own\b|'s own\b|\bown (?:left|right|front|sides|point of view|perspective|frame)|"
    r"\bthe way [\w ']+ (?:faces?|is facing|looks|is turned)\b|\b(?:its|their) (?:front|point of view|perspective)\b"
)
_VIEW = 75.0  # degrees to either side of straight ahead that are in view
_ASIDE = 75.0  # degrees off a person's left or right that still count as that side where it is asked by yes or no
_NARROW = 15.0  # degrees between a direction and the limit of its sector below which an answer is told as borderline


# -- a person's sides -------------------------------------------------------------------------------------------------


def _is_side(asked: Asked, survey: Survey) -> Answer | None:
    side: Side = asked.slots["d"]
    if asked.situation is None and not side.personal and side.at not in (90.0, -90.0):
        return None
    things, query = _things(asked, survey), asked.slots["x"]
    if not things:
        return _nothing_there(asked, survey)

    def one(view: View) -> Answer:
        cases = [(survey.named(t), _side_holds(t, side, view, survey)) for t in things]
        plain = len(things) == 1 or not (query.pick == "any" or is_plural(query))
        return agreed(cases) if plain else whole(cases, "any" if query.pick == "any" or _exists(asked) else "all")

    return _over_views(asked, survey, one)


def _in_view(asked: Asked, survey: Survey) -> Answer | None:
    """Whether a person whose place is stated has a thing in view, at whatever distance; boxes hide nothing."""
    if asked.situation is None:
        return None
    things = survey.all_of(asked.slots["x"])
    if not things:
        return _nothing_there(asked, survey)
    ahead = Side("in front", 0.0, _VIEW)
    return _over_views(
        asked, survey, lambda v: whole([(survey.named(t), _side_holds(t, ahead, v, survey)) for t in things], "any")
    )


def _exists(asked: Asked) -> bool:
    return bool(re.search(r"\bthere\b|\b(?:have|see|find|got)\b", asked.said))


def _things(asked: Asked, survey: Survey) -> tuple[Thing, ...]:
    """What the question asks of: everything that is described if it asks whether there is one."""
    query = asked.slots["x"]
    if query.pick in ("any", "all") or _exists(asked):
        return survey.all_of(query)
    return meant(query, survey)


def _nothing_there(asked: Asked, survey: Survey) -> Answer:
    query = asked.slots["x"]
    near = survey.find(query).near
    told = f" The nearest to that: {listed([survey.named(t) for t in near])}." if near else ""
    said = query.describe().removeprefix("any ").removeprefix("every ").removeprefix("the ")
    return Answer(answer="no", answer_type="yesno", text=f"No, there is no {said} here.{told}",
                  evidence=Evidence(ids=tuple(t.id for t in near)))  # fmt: skip


def _side_holds(thing: Thing, side: Side, view: View, survey: Survey) -> Answer:
    """Whether a thing lies on a side of a view."""
    if not view.stated and not is_inside(view, survey):
        return _screen_side(thing, side, view, survey)
    bearing = view.to(thing)
    margin = (_ASIDE if abs(side.at) == 90.0 else side.reach) - off(bearing, side)
    yes = margin >= 0
    text = f"{'Yes' if yes else 'No'}, {survey.named(thing)} is {_bearing_told(bearing)}{_borderline(margin)}."
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, frame=view.words,
                  confidence=_sure(abs(margin), _NARROW), evidence=_ids(thing))  # fmt: skip


def _screen_side(thing: Thing, side: Side, view: View, survey: Survey) -> Answer:
    """Whether a viewer who looks into the room from outside has a thing on the left or right half, or ahead."""
    share = view.across(thing) / max(_half_width(view, survey), 1e-6)
    if side.at in (90.0, -90.0):
        yes, margin = share * side.at > 0, abs(share)
    else:
        yes, margin = side.at == 0.0, 1.0
    where = "on the right" if share > 0 else "on the left"
    text = f"{'Yes' if yes else 'No'}, {survey.named(thing)} is {where} as you look into the room."
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, frame=view.words,
                  confidence=_sure(margin, 0.2), evidence=_ids(thing))  # fmt: skip


def _half_width(view: View, survey: Survey) -> float:
    width, depth, _ = survey.graph.room.size
    right = (abs(view.forward[1]), abs(view.forward[0]))
    return float(right[0] * width + right[1] * depth) / 2


def _either_side(asked: Asked, survey: Survey) -> Answer | None:
    """Which of two sides a thing is on; left or right by its sign."""
    pair = {asked.slots[k].at for k in ("d", "e") if k in asked.slots} or {90.0, -90.0}
    things = meant(asked.slots["x"], survey)

    def one(view: View) -> Answer:
        return agreed([(survey.named(t), _which_of(t, pair, view, survey)) for t in things])

    return _over_views(asked, survey, one)


def _which_of(thing: Thing, pair: set[float], view: View, survey: Survey) -> Answer:
    bearing = view.to(thing)
    outside = not view.stated and not is_inside(view, survey)
    if outside:
        bearing = 90.0 if view.across(thing) > 0 else -90.0
    at = min(sorted(pair), key=lambda a: abs((bearing - a + 180.0) % 360.0 - 180.0))
    label = next((name for name, degrees in SIDES.items() if degrees == at), "")
    gap = abs(abs((bearing - min(pair) + 180) % 360 - 180) - abs((bearing - max(pair) + 180) % 360 - 180)) / 2
    if outside:
        text = f"{_cap(survey.named(thing))} is on the {label} as you look into the room."
        gap = 90.0 * min(1.0, abs(view.across(thing)) / max(_half_width(view, survey), 1e-6) * 3)
    else:
        text = f"{_cap(survey.named(thing))} is {_bearing_told(view.to(thing))}."
    return Answer(answer=label, answer_type="label", text=text, frame=view.words, confidence=_sure(gap, _NARROW),
                  evidence=_ids(thing))  # fmt: skip


def _direction(asked: Asked, survey: Survey) -> Answer | None:
    """The side on which a thing lies, or the way to turn to it."""
    query = asked.slots["x"]
    if asked.situation is None and asked.words[:1] == ("where",) and "me" not in asked.words:
        return None
    things = survey.all_of(query) if query.pick == "any" else meant(query, survey)
    things = things or meant(query, survey)
    said = asked.said
    if re.search(r"\bangle|degrees|bearing|how far|how much", said):
        return _over_views(asked, survey, lambda v: agreed([(survey.named(t), _angle(t, v, survey)) for t in things]))
    clock = "clock" in said

    def one(view: View) -> Answer:
        if query.pick == "any":
            nearest = min(things, key=lambda t: float(((middle(t) - view.eye) ** 2).sum()))
            return _told_direction(nearest, view, survey, clock)
        return agreed([(survey.named(t), _told_direction(t, view, survey, clock)) for t in things])

    return _over_views(asked, survey, one)


def _told_direction(thing: Thing, view: View, survey: Survey, clock: bool) -> Answer:
    bearing = view.to(thing)
    label = side_of(bearing)
    if not view.stated and not is_inside(view, survey):
        share = view.across(thing) / max(_half_width(view, survey), 1e-6)
        label = "left" if share < -0.1 else "right" if share > 0.1 else "in front"
    if clock:
        label = f"{round(bearing / 30.0) % 12 or 12} o'clock"
    rest = (bearing + 45.0) % 90.0
    text = f"{_cap(survey.named(thing))} is {_bearing_told(bearing)}."
    return Answer(answer=label, answer_type="label", text=text, frame=view.words, evidence=_ids(thing),
                  confidence=_sure(min(rest, 90.0 - rest), _NARROW))  # fmt: skip


def _angle(thing: Thing, view: View, survey: Survey) -> Answer:
    bearing = view.to(thing)
    text = f"{_cap(survey.named(thing))} is {_bearing_told(bearing)}."
    return Answer(answer=float(round(abs(bearing), 1)), answer_type="number", text=text, frame=view.words, unit="deg",
                  evidence=_ids(thing), confidence=0.9)  # fmt: skip


def _what_is_there(asked: Asked, survey: Survey) -> Answer | None:
    """What lies on a side: the nearest thing, with the others in the text."""
    side: Side = asked.slots["d"]
    if asked.situation is None and not side.personal:
        return None
    query = asked.slots.get("x")
    if query is not None and is_anything(query):
        query = None
    wanted = {t.row for t in survey.all_of(query)} if query is not None else None
    many = bool(re.search(r"\b(?:list|everything|things|objects|all|are)\b", asked.said))

    def one(view: View) -> Answer:
        found = [t for t in _on_side(side, view, survey) if wanted is None or t.row in wanted]
        return _listed_side(found, side, view, survey, many)

    return _over_views(asked, survey, one)


def _on_side(side: Side, view: View, survey: Survey) -> list[Thing]:
    """Things within 45 degrees of a side, by how near and how central they are; what the person is on is left out."""
    reach = min(side.reach, 45.0)
    outside = not view.stated and not is_inside(view, survey)

    eye = np.array([*view.eye, 0.0])

    def cost(t: Thing) -> float:
        local = np.abs(t.group.box.local(eye[None])[0, :2]) - np.array(t.group.box.size[:2]) / 2
        return (float(np.linalg.norm(np.maximum(local, 0.0))) + 0.05) * (1.0 + (off(view.to(t), side) / 45.0) ** 2)

    def there(t: Thing) -> bool:
        if outside and side.at in (90.0, -90.0):
            return view.across(t) * side.at > 0
        box = t.group.box
        if box.covers(_flat(view))[0]:
            return False
        return off(view.to(t), side) <= reach

    things = [t for t in survey.things if t.node is not None and there(t) and not _is_out_of_the_way(t)]
    ids = {t.id for t in things}
    things = [t for t in things if t.node is not None and t.node.support not in ids]
    return sorted(things, key=cost)


def _flat(view: View) -> F64:
    return np.array([[view.eye[0], view.eye[1], 0.0]])


def _is_out_of_the_way(thing: Thing) -> bool:
    node = thing.node
    return node is not None and (node.support == "ceiling" or is_stepped_on(node.support, node.size[2]))


def _listed_side(found: Sequence[Thing], side: Side, view: View, survey: Survey, many: bool) -> Answer:
    if not found:
        return Answer(answer=() if many else None, answer_type="list" if many else "label", frame=view.words,
                      text=f"There is nothing {_where(side, view)} but the wall.", confidence=0.7)  # fmt: skip
    names = [survey.named(t) for t in found]
    more = f"; farther {_where(side, view)}: {listed(names[1:6])}" if len(names) > 1 else ""
    text = f"{_cap(names[0])} is {_where(side, view)}{more}."
    evidence = Evidence(ids=tuple(t.id for t in found))
    if many:
        return Answer(answer=tuple(t.name for t in found), answer_type="list", text=text, frame=view.words,
                      confidence=0.8, evidence=evidence)  # fmt: skip
    return Answer(answer=found[0].name, answer_type="label", text=text, frame=view.words, confidence=0.8,
                  evidence=evidence)  # fmt: skip


def _where(side: Side, view: View) -> str:
    if side.at == 180.0:
        return "behind you"
    if side.at == 0.0:
        return "in front of you"
    return side.words.replace("on the", "on your") if side.words.startswith("on the") else f"{side.words} from you"


def _counted(asked: Asked, survey: Survey) -> Answer | None:
    side: Side = asked.slots["d"]
    if asked.situation is None and not side.personal:
        return None
    things = survey.all_of(asked.slots["x"])

    def one(view: View) -> Answer:
        answers = [_side_holds(t, side, view, survey) for t in things]
        there = [t for t, a in zip(things, answers, strict=True) if a.answer == "yes"]
        text = f"{len(there)}: {listed([survey.named(t) for t in there])}."
        return Answer(answer=float(len(there)), answer_type="number", text=text, frame=view.words,
                      confidence=min((a.confidence for a in answers), default=0.9),
                      evidence=Evidence(ids=tuple(t.id for t in there)))  # fmt: skip

    return _over_views(asked, survey, one)


def _faced(asked: Asked, survey: Survey) -> Answer | None:
    if asked.situation is None:
        return None
    ahead = Side("in front", 0.0)
    return _over_views(asked, survey, lambda v: _listed_side(_on_side(ahead, v, survey), ahead, v, survey, False))


def _over_views(asked: Asked, survey: Survey, fn: Callable[[View], Answer]) -> Answer:
    """The answer of every view that fits what is said; where they differ, that of a clear majority."""
    found = view_of(asked.situation, survey)
    if not found:
        assert asked.situation is not None
        return unknown("text", f"No place fits “{asked.situation.words}”.", frame=asked.situation.words)
    cases: list[Case] = [(v.name, fn(v)) for v in found]
    if len({v.name for v in found}) > 1:
        named = [(n, _majority([a for m, a in cases if m == n])) for n in dict.fromkeys(v.name for v in found)]
        return agreed(named)
    return _majority([a for _, a in cases])


def _majority(answers: Sequence[Answer]) -> Answer:
    """The answer that at least 70 % share; otherwise none."""
    votes: dict[object, list[Answer]] = {}
    for a in answers:
        votes.setdefault(a.answer, []).append(a)
    best = max(votes.values(), key=len)
    share = len(best) / len(answers)
    chosen = max(best, key=lambda a: a.confidence)
    if share >= 0.7:
        return chosen.model_copy(update={"confidence": round(chosen.confidence * share, 3)})
    said = ", ".join(f"{'nothing' if v in (None, ()) else v}" for v in votes)
    return chosen.model_copy(update={
        "answer": None, "confidence": 0.6,
        "text": f"That depends on where exactly you are: {said}. Say what you stand at or look at.",
    })  # fmt: skip


# -- sides of a thing -------------------------------------------------------------------------------------------------


def _related(asked: Asked, survey: Survey) -> Answer | None:
    """Whether a thing is left of, right of, in front of or behind another one."""
    kind = relations.named(asked.slots["d"])
    if kind.aim is None:
        return None
    firsts, seconds = meant(asked.slots["x"], survey), meant(asked.slots["a"], survey)
    cases = [
        (_pair_name(x, a, firsts, seconds, survey), _side_of_thing(x, a, kind.name, asked, survey))
        for x in firsts for a in seconds if x.row != a.row
    ]  # fmt: skip
    if not cases:
        return None
    if asked.slots["x"].pick in ("any", "all") and len(cases) > 1:
        return whole(cases, asked.slots["x"].pick)
    return agreed(cases)


def _pair_name(x: Thing, a: Thing, firsts: Sequence[Thing], seconds: Sequence[Thing], survey: Survey) -> str:
    return " and ".join([survey.named(x)] * (len(firsts) > 1) + [survey.named(a)] * (len(seconds) > 1))


_OFFSETS = {"opposite": 0.0, "left_of": -90.0, "right_of": 90.0, "in_front_of": 0.0, "behind": 180.0}


def _frame_of(anchor: Thing, asked: Asked, survey: Survey, name: str = "") -> tuple[View | None, bool]:
    """The frame in which a side of a thing is told, centred at the thing, and whether "in front" is ahead of it.

    A situation gives the person's own line of sight; a situation that takes the thing's frame gives that.
    """
    if _OWN_FRAME.search(asked.said) or (name and relations.named(name).own_frame):
        return of_object(anchor, survey), True
    if asked.situation is None:
        seen = viewer(survey)
        return View(middle(anchor), seen.forward, seen.words), False
    if asked.situation.pose == "own":
        found = view_of(asked.situation, survey)
        own = any(float(((v.eye - middle(anchor)) ** 2).sum()) < 1e-9 for v in found)
        return (View(middle(anchor), found[0].forward, found[0].words), own) if found else (None, False)
    found = view_of(asked.situation, survey)
    if not found:
        return None, False
    return View(middle(anchor), found[0].forward, found[0].words), False


def _side_of_thing(x: Thing, anchor: Thing, name: str, asked: Asked, survey: Survey) -> Answer:
    view, own = _frame_of(anchor, asked, survey, name)
    if view is None:
        return _no_frame(anchor, own, survey, "yesno")
    return _holds_beside(x, anchor, name, view, own, survey)


def _holds_beside(x: Thing, anchor: Thing, name: str, view: View, own: bool, survey: Survey) -> Answer:
    """Whether a thing is on a side of an anchor; the view's eye is the anchor's centre."""
    at = _OFFSETS[name]
    if not own and name in ("in_front_of", "behind"):  # the near side is in front
        at = 180.0 - at
    bearing = view.to(x)
    margin = 60.0 - abs((bearing - at + 180.0) % 360.0 - 180.0)
    yes = margin >= 0
    where = _beside_told(bearing, own)
    text = (f"{'Yes' if yes else 'No'}, {survey.named(x)} is {where} {survey.named(anchor)}"
            f"{_frame_told(view)}{_borderline(margin)}.")  # fmt: skip
    frame = "object" if own else view.words
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, frame=frame,
                  confidence=_sure(abs(margin), _NARROW), evidence=_ids(x, anchor))  # fmt: skip


def _frame_told(view: View) -> str:
    return " as you see it" if view.words == "viewer" else ""


def _beside_told(bearing: float, own: bool) -> str:
    label = side_of(bearing)
    if label in ("left", "right"):
        return f"{label} of"
    return "in front of" if (label == "in front") == own else "behind"


def _own_side(asked: Asked, survey: Survey) -> Answer | None:
    firsts, seconds = meant(asked.slots["x"], survey), meant(asked.slots["a"], survey)
    name = asked.slots["o"]

    def one(x: Thing, anchor: Thing) -> Answer:
        view = of_object(anchor, survey)
        if view is None:
            return _no_front(anchor, survey, "yesno")
        return _holds_beside(x, anchor, name, view, True, survey)

    cases = [(_pair_name(x, a, firsts, seconds, survey), one(x, a)) for x in firsts for a in seconds if x.row != a.row]
    return agreed(cases) if cases else None


def _own_what(asked: Asked, survey: Survey) -> Answer | None:
    name = asked.slots["o"]
    side = Side(name, _OFFSETS[name])

    def one(anchor: Thing) -> Answer:
        view = of_object(anchor, survey)
        if view is None:
            return _no_front(anchor, survey, "label")
        found = [t for t in _on_side(side, view, survey) if t.row != anchor.row]
        given = _listed_side(found, side, view, survey, False)
        if not found:
            return given
        text = f"{_cap(survey.named(found[0]))} is nearest on that side of {survey.named(anchor)}, by its own front."
        return given.model_copy(update={"text": text, "frame": "object"})

    things = meant(asked.slots["a"], survey)
    return agreed([(survey.named(t), one(t)) for t in things])


def _what_of(asked: Asked, survey: Survey) -> Answer | None:
    """What is left of, right of, in front of or behind a thing: the nearest, with the others in the text."""
    name = asked.slots["d"]
    if relations.named(name).aim is None:
        return None
    query = asked.slots.get("x")
    wanted = None if query is None or is_anything(query) else {t.row for t in survey.all_of(query)}
    many = bool(re.search(r"\b(?:list|everything|things|objects|all|are)\b", asked.said))
    anchors = meant(asked.slots["a"], survey)

    def one(anchor: Thing) -> Answer:
        view, own = _frame_of(anchor, asked, survey, name)
        if view is None:
            return _no_frame(anchor, own, survey, "label")
        found = [t for t in survey.things if t.row != anchor.row and (wanted is None or t.row in wanted)
                 and not _is_out_of_the_way(t) and t.node is not None and t.node.support != anchor.id
                 and _holds_beside(t, anchor, name, view, own, survey).answer == "yes"]  # fmt: skip
        ids = {t.id for t in found}
        found = [t for t in found if t.node is not None and t.node.support not in ids]
        hung = anchor.node is not None and anchor.node.support == "wall"
        found.sort(key=lambda t: (t.node is not None and t.node.support == "wall" and not hung, survey.gap(t, anchor)))
        return _told_of(found, anchor, name, view, own, many, survey)

    return agreed([(survey.named(a), one(a)) for a in anchors])


def _told_of(
    found: Sequence[Thing], anchor: Thing, name: str, view: View, own: bool, many: bool, survey: Survey
) -> Answer:
    where = f"{relations.named(name).told(survey.named(anchor))}{_frame_told(view)}"
    frame = "object" if own else view.words
    if not found:
        return Answer(answer=() if many else None, answer_type="list" if many else "label", frame=frame,
                      text=f"Nothing is {where}.", confidence=0.8, evidence=_ids(anchor))  # fmt: skip
    names = [survey.named(t) for t in found]
    more = f"; farther that way: {listed(names[1:6])}" if len(names) > 1 else ""
    evidence = _ids(*found, anchor)
    if many:
        text = f"{_cap(listed(names))} {'is' if len(names) == 1 else 'are'} {where}."
        return Answer(answer=tuple(t.name for t in found), answer_type="list", text=text, frame=frame, confidence=0.85,
                      evidence=evidence)  # fmt: skip
    return Answer(answer=found[0].name, answer_type="label", text=f"{_cap(names[0])} is {where}{more}.", frame=frame,
                  confidence=0.8, evidence=evidence)  # fmt: skip


def _no_frame(anchor: Thing, own: bool, survey: Survey, kind: AnswerType) -> Answer:
    """Why there is no frame of reference."""
    if own:
        return _no_front(anchor, survey, kind)
    return unknown(kind, "No place fits what is said of the person.")


def _no_front(anchor: Thing, survey: Survey, kind: AnswerType) -> Answer:
    text = f"Nothing tells which side of {survey.named(anchor)} is its front, so it has no left and right of its own."
    return unknown(kind, text, (anchor,), "object")


def _own_either(asked: Asked, survey: Survey) -> Answer | None:
    """On which of its own sides a thing has another one."""
    return _which_side_of(asked, survey, own=True)


def _which_side_of(asked: Asked, survey: Survey, own: bool = False) -> Answer | None:
    """On which side of a thing another one is."""
    said = asked.said
    firsts, seconds = meant(asked.slots["x"], survey), meant(asked.slots["a"], survey)
    lateral = "left and right" in said or "left or" in said or "right or" in said or "or right" in said
    depth = bool(re.search(r"\bor (?:behind|in front|before)\b|\b(?:behind|front of) or\b|front and back", said))
    lateral = lateral and not depth

    def one(x: Thing, anchor: Thing) -> Answer:
        view, its_own = (of_object(anchor, survey), True) if own else _frame_of(anchor, asked, survey)
        if view is None:
            return _no_frame(anchor, its_own, survey, "label")
        bearing = view.to(x)
        if lateral:
            label, gap = ("right" if bearing > 0 else "left"), min(abs(bearing), 180 - abs(bearing))
        elif depth:
            ahead = abs(bearing) < 90.0
            label, gap = ("in front" if ahead == its_own else "behind"), abs(90.0 - abs(bearing))
        else:
            label = {"left of": "left", "right of": "right", "in front of": "in front", "behind": "behind"}[
                _beside_told(bearing, its_own)
            ]
            rest = (bearing + 45.0) % 90.0
            gap = min(rest, 90.0 - rest)
        words = {"left": "left of", "right": "right of", "in front": "in front of", "behind": "behind"}[label]
        text = f"{_cap(survey.named(x))} is {words} {survey.named(anchor)}{_frame_told(view)}."
        return Answer(answer=label, answer_type="label", text=text, frame="object" if its_own else view.words,
                      confidence=_sure(gap, _NARROW), evidence=_ids(x, anchor))  # fmt: skip

    cases = [(_pair_name(x, a, firsts, seconds, survey), one(x, a)) for x in firsts for a in seconds if x.row != a.row]
    return agreed(cases) if cases else None


# -- words ------------------------------------------------------------------------------------------------------------


def _bearing_told(bearing: float) -> str:
    """A bearing in words: "on your right, 95° from straight ahead"."""
    degrees = abs(bearing)
    if degrees < 10:
        return "straight ahead of you"
    if degrees > 170:
        return "right behind you"
    hand = "right" if bearing > 0 else "left"
    name = {"in front": "in front of you", "behind": "behind you", "left": "on your left", "right": "on your right"}[
        side_of(bearing)
    ]
    way = f", {degrees:.0f}° to the {hand}" if side_of(bearing) in ("in front", "behind") else f", {degrees:.0f}° round"
    return name + way


def _borderline(margin: float) -> str:
    return " (borderline)" if abs(margin) < _NARROW else ""


def _sure(margin: float, clear: float) -> float:
    return round(0.6 + 0.37 * min(margin / clear, 1.0), 3)


def _ids(*things: Thing) -> Evidence:
    return Evidence(ids=tuple(t.id for t in things if t.node is not None))


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("own_side", templates(_OWN_SIDE), _own_side),
    Kind("own_side_what", templates(_OWN_WHAT), _own_what),
    Kind("own_side_either", templates(_OWN_EITHER), _own_either),
    Kind("side_either", templates(_EITHER), _either_side),
    Kind("side_either_of", templates(_EITHER_OF), _which_side_of),
    Kind("side", templates(_IS_SIDE), _is_side),
    Kind("side_in_view", templates(_IN_VIEW), _in_view),
    Kind("side_of", templates(_RELATED), _related),
    Kind("side_of_what", templates(_WHAT_OF), _what_of),
    Kind("side_count", templates(_COUNT), _counted),
    Kind("side_direction", templates(_WHERE), _direction),
    Kind("side_what", templates(_WHAT), _what_is_there),
    Kind("side_faced", templates(_FACED), _faced),
)
