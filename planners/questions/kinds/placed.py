"""What is on, in, under, above, next to or between things: "what is on the desk?", "is anything under the bed?"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds, relations
from ....gaussians.world.relation_geometry import HOLDS
from ....gaussians.world.support import ALOFT, NO_THINGS, SHELL
from ..answer import Answer, Evidence
from ..candidates import Case, agreed, is_plural, meant, unknown, whole
from ..kind import Asked, Kind
from ..reading.noun_phrase import is_anything, is_unnamed
from ..reading.phrase_templates import templates
from ..reading.room_phrases import named_in
from ..relating import overlaps, related, strength, supporter
from ..room_places import AT_WALL, wall_of
from ..survey import NotResolved, Survey, Thing, be, listed
from ..telling import absent

_WHAT = (
    "(what|what all|what things|what objects|which things|which objects|what stuff|what items|which items|what "
    "kind of things|"
    "what sort of things|what else|which thing|what object|which object|what thing|what item|which item|what furniture)"
)
_IS = (
    "[(is|are|was|stands|stand|sits|sit|lies|lie|hangs|hang|rests|goes|can be found|can be seen|do you see|can i "
    "see|do i see|"
    "can you see|do we have|have we got|has been|have been|would i find|can i find|do you find|will i find|is "
    "there|are there|"
    "is it that is|is that|might be|could be|is being|you see|did i leave|have i got|do i have|belongs)] "
    "[(put|placed|left|set|kept|stored|located|there|mounted|fixed|hung|lying or standing|standing or lying|"
    "sitting or lying)]"
)
_LISTS = "(list|name|describe|show|show me|give me|tell me|count up|identify)"
_ALL = (
    "(everything|all things|all the things|the things|all objects|all the objects|the objects|the items|all items|"
    "all of the things|all the stuff|what is|what you see|what there is|everything that is|things|objects|"
    "all objects that are|the objects that are|the things that are|all that is|all the items|the contents)"
)
_WHAT_THERE = f"""
    {_WHAT} {_IS} {{r:relation}} {{a}}
    {_WHAT} {_IS} {{r:relation}} {{a}} (right now|there)
    {{r:relation}} {{a}} (is|are|stands|there is|you see) what
    {{r:relation}} {{a}} what (is there|do you see|can i see|is standing|is lying|can you see)
    {_LISTS} {_ALL} [that (is|are)] {{r:relation}} {{a}}
    {_ALL} [that (is|are)] {{r:relation}} {{a}}
    (what|which) {{x}} {_IS} {{r:relation}} {{a}}
    {_WHAT} {_IS} between {{a}} and {{b}}
    {_WHAT} {_IS} in between {{a}} and {{b}}
    {_WHAT} {_IS} [in] between {{both}}
    (what|which) {{x}} {_IS} [in] between {{a}} and {{b}}
    {_LISTS} {_ALL} [that (is|are)] [in] between {{a}} and {{b}}
    what separates {{a}} (and|from) {{b}}
    what (is|are) the (thing|things|object|objects|item|items|stuff|furniture) \
        [(standing|sitting|lying|placed|hanging|that is|that are)] {{r:relation}} {{a}}
    (is|are) there {{x}} {{r:relation}} {{a}} [and] [if so] (what|what is it|what are they|which)
    what if anything (is|stands|lies|sits) {{r:relation}} {{a}}
"""
_HAS = f"""
    {_WHAT} (does|do) {{a}} (have|hold|carry|support|contain|store|keep) [on it|on top|on top of it|in \
        it|inside|inside it|on them|on its shelves|on its top|in them|standing on it|sitting on it|lying on it]
    {_WHAT} (does|do) {{a}} (hold|carry|support|contain) up
    {_WHAT} (does|do) {{a}} have {{r:relation}} it
    {_WHAT} (has|have) {{a}} got (on|in|under|on top of|inside|above|next to|beside|underneath|beneath) (it|them)
    what (are|is) the contents of {{a}}
    {_WHAT} {_IS} [the] (stored|kept|held|contained) (in|by|on) {{a}}
    {_WHAT} {_IS} (supported|carried|held up|held) by {{a}}
    {_WHAT} (clutters|decorates|covers|occupies|fills|adorns) {{a}}
"""
_HAS_IT = """
    (does|do) {a} (have|hold|carry|contain|support) {x} [on it|on top|on top of it|in it|inside|inside it|on \
        them|in them|standing on it|sitting on it]
    (does|do) {a} have {x} {r:relation} (it|them)
    (has|have) {a} got {x} (on|in|under|on top of|inside|above|next to|beside|underneath|beneath) (it|them)
    (does|do) {x} hang from {a}
    BE {a} [completely] (empty|bare|clear|free)
    BE {a} (holding|carrying|supporting) {x}
    BE {a} (covered|topped|cluttered|occupied) [(with|by) {x}]

"""
_EITHER = """
    BE {x} [standing|placed|located|hanging|lying|sitting|closer] {r:relation} {a} or [{s:relation}] {b}
    (do|does) {x} (stand|sit|lie|hang|rest) {r:relation} {a} or [{s:relation}] {b}
    (what|which) [one] BE {x} [standing|placed|located|hanging|lying|sitting] {r:relation} {a} or {b}
"""
_IS_REL = """
    BE {x} [(standing|placed|located|partly|directly|right|hanging|lying|sitting|resting|positioned|all|both|be|\
        somewhere)] {r:relation} {a}
    (do|does) {x} [(also|all|both)] (stand|sit|lie|hang|rest|go|reach|extend|stay|belong|stick out|stretch|fit) \
        [(partly|partially|right|directly)] {r:relation} {a}
    (can|could) {x} be found {r:relation} {a}
    (did|have) (i|you|we|someone|they) (put|place|leave|hang|set|left|placed|hung) {x} {r:relation} {a}
    (have|has) (we|i|you|someone|they|anyone|somebody) (got|put|left|placed) {x} {r:relation} {a}
    (is|are) there {x} (separating|dividing) {a} (and|from) {b}
    BE {x} part of {a}
    BE {x} and {a} [standing|placed|located|right] {m:mutual}
    (do|does) {x} and {a} (stand|sit|lie|hang) [right] {m:mutual}
    BE {both} [standing|placed|located|right] {m:mutual}
    (do|does) {both} (stand|sit|lie|hang) [right] {m:mutual}
"""
_BETWEEN = """
    BE {x} [standing|placed|located|hanging|lying|sitting|directly|somewhere|anywhere] [in] between {a} and {b}
    BE {x} [standing|placed|located|somewhere] [in] between {both}
    (do|does) {x} (stand|sit|lie|hang) [somewhere] [in] between {a} and {b}
    (do|does) {x} (stand|sit|lie|hang) [in] between {both}
    (is|are) there {x} [standing|lying|sitting|placed] [in] between {a} and {b}
    (is|are) there {x} [in] between {both}
"""
_SUPPORT = """
    what BE {x} (standing|sitting|lying|resting|placed|put|set|mounted|hanging|hung|leaning|located|stood|\
        supported|kept|attached|fixed|stored|perched) [(up|down)] (on|upon|from|in|on top of)
    what (do|does) {x} (stand|sit|lie|rest|hang|lean|stay) (on|upon|from|in|on top of)
    what (supports|holds|carries|is supporting|is holding|is carrying|holds up|bears) {x}
    (on|from|upon|in) (what|which thing|which object|which piece of furniture) [(is|are|does|do)] {x} \
        [standing|sitting|lying|resting|placed|stand|sit|lie|rest|hang|hanging|located|kept]
    (on|upon|in|from) what (is|are|does|do) {x} [standing|sitting|lying|resting|placed|stand|sit|lie|rest|hang|\
        hanging|located|kept]
    what (kind of|sort of|piece of) (thing|furniture|surface|object) (is|are) {x} (standing|sitting|lying|resting|\
        placed) (on|in)
    what surface (is|are|does|do) {x} (standing|sitting|lying|resting|placed|on|stand|sit) [on]
    (what|which) {y} BE {x} (standing|sitting|lying|resting|placed|kept|located|hanging|stored) (on|in|by|from)
    (what|which) {y} BE {x} (on|in)
    what BE {x} (on|on top of)
    on (what|which) {y} (is|are|does|do) {x} [standing|sitting|lying|resting|placed|stand|sit|lie|rest|hang|\
        hanging|located|kept]
    (what|which) {y} (supports|holds|carries|is supporting|is holding|is carrying) {x}
    (what|which) {y} (has|have|has got|have got|holds) {x} [(on|in|on top of|inside) (it|them)]
"""
_BESIDE = """
    what BE {x} [standing|sitting|lying|placed|located|hanging|right] (next to|beside|by|near|close \
        to|alongside|adjacent to)
    what (do|does) {x} (stand|sit|lie|hang) (next to|beside|by|near|close to|alongside|adjacent to)
    (next to|beside|near) what (is|are|does) {x} [standing|sitting|located|placed|stand|sit]
    (what|which) {y} BE {x} [standing|sitting|lying|placed|located|right] (next to|beside|by|near|close \
        to|alongside|adjacent to)
    what BE {x} [standing|lying|placed|hanging|located|hung|mounted|sitting] (under|underneath|beneath|below)
    what BE {x} [standing|lying|placed|hanging|located|hung|mounted|suspended] (above|over)
    what (do|does) {x} (hang|stand|lie) (above|over)
    (above|over) what (is|does) {x} [hanging|hang|mounted|hung]
    (what|which) {y} BE {x} [hanging|mounted|hung] (above|over)
    what (do|does) {x} (stand|lie) (under|underneath|beneath|below)
    what BE {x} [standing|placed|located] (in|inside)
    (between|in between) (what|which things|which two things|which objects) (is|are|does) {x} \
        [standing|placed|located|stand|hang|hanging]
    what BE {x} [standing|placed|located] between
"""
_HUNG = """
    what [(is|are|do you see|do we have)] [(hanging|mounted|hung|attached|fixed|suspended|that hangs|hangs|hang)] \
        [up] (on|from|to|off|down from|at|against) {w:shell}
    what (hangs|hang|is there|things are there) (on|from|at|off|against|along) {w:shell}
    (which|what) (things|objects|thing|object|items|stuff|furniture|else|pieces of furniture) \
        (is|are|hang|hangs|stand|stands|lie) [hanging|mounted|standing|placed|lying|fixed] \
        (on|from|along|against|at|off|to) {w:shell}
    (list|name|show|describe) (everything|all things|the things|what is|all the things|what hangs|all \
        objects|things|everything that hangs|everything that stands) [hanging|standing|that is|that are] \
        (on|from|against|along|at) {w:shell}
    (what|which) {x} [(is|are|hang|hangs|stand|stands)] [hanging|mounted|standing|placed|fixed] \
        (on|from|along|against|at|off|to) {w:shell}
    what (stands|stand|is standing|lies|is lying|is placed|is) (on|along|against|at|up against) {w:shell}
    [is there] anything [hanging|mounted|standing] (on|from|against|along) {w:shell}
"""


# -- what has a relation ----------------------------------------------------------------------------------------------


def _what(asked: Asked, survey: Survey) -> Answer | None:
    asked, shell = _without_shell(asked)
    name = _relation(asked)
    if name is None:
        return None
    wanted = _wanted(asked, survey)
    asked, left_out = _without_exceptions(asked, survey)
    cases: list[Case] = []
    for anchors in _anchors(asked, survey):
        found = [t for t in related(name, anchors, survey) if wanted is None or t.row in wanted]
        found = [t for t in found if t.row not in left_out and _rests_on(t, shell)]
        if re.search(r"\bhang|\bhung\b", asked.said):
            found = [t for t in found if (kind := kinds.of(t.label)) is None or not kind.opening]
        cases.append((" and ".join(survey.named(a) for a in anchors), _listed(name, found, anchors, asked, survey)))
    if len(cases) > 1 and _is_every(asked):
        return _together(name, [a for _, a in cases], asked, survey)
    filled = [c for c in cases if c[1].answer]
    if len(cases) > 1 and len(filled) == 1:  # "on the desk" is said of the desk that has something on it
        return filled[0][1]
    return agreed(cases)


def _relation(asked: Asked) -> str | None:
    """The relation of a question; sides belong to another kind."""
    if "m" in asked.slots:
        return "next_to"
    if "r" in asked.slots:
        name = str(asked.slots["r"])
        if name == "inside" and re.search(r"\bin (?:the )?(?:room|corner|here)\b", asked.said):
            return None
        return None if relations.named(name).aim else name
    if "b" in asked.slots or "both" in asked.slots:
        return "between"
    said = asked.said
    for phrase, name in (("part of", "inside"), ("under", "under"), ("beneath", "under"), ("above", "above"),
                         ("next to", "next_to"), ("beside", "next_to")):  # fmt: skip
        if re.search(rf"\b{phrase}", said):
            return name
    return "held"


def _anchors(asked: Asked, survey: Survey) -> list[tuple[Thing, ...]]:
    """Every choice of anchors that a question may mean."""
    slots = asked.slots
    if "both" in slots:
        pair = meant(slots["both"], survey)
        return [pair] if len(pair) == 2 else [(a, b) for i, a in enumerate(pair) for b in pair[i + 1 :]]
    firsts = meant(slots["a"], survey)
    if "b" not in slots:
        return _one_shell([(a,) for a in firsts])
    return [(a, b) for a in firsts for b in meant(slots["b"], survey) if a.row != b.row]


def _one_shell(anchors: list[tuple[Thing, ...]]) -> list[tuple[Thing, ...]]:
    """The four walls of a room are one anchor."""
    if len(anchors) == 4 and all(a[0].node is None for a in anchors):
        return [tuple(a[0] for a in anchors)]
    return anchors


def _is_every(asked: Asked) -> bool:
    query = asked.slots.get("a")
    return isinstance(query, Query) and is_plural(query)


def _wanted(asked: Asked, survey: Survey) -> set[int] | None:
    """Rows that a question asks about; None: anything."""
    query = asked.slots.get("x")
    if query is None or is_anything(query):
        return None
    return {t.row for t in survey.all_of(query)}


def _without_exceptions(asked: Asked, survey: Survey) -> tuple[Asked, frozenset[int]]:
    """A question without "besides the laptop", and the rows of what it leaves out.

    The grammar reads an exception as one from the phrase before it. "What is on the desk besides the laptop?" excepts
    nothing from the desks, so the exception is one from what is on the desk.
    """
    query = asked.slots.get("a")
    if not isinstance(query, Query) or not query.exclude:
        return asked, frozenset()
    whole_query = query.model_copy(update={"exclude": ()})
    rows = frozenset(t.row for q in query.exclude for t in survey.all_of(q))
    if rows & {t.row for t in survey.all_of(whole_query)}:
        return asked, frozenset()
    return replace(asked, slots={**asked.slots, "a": whole_query}), rows


def _without_shell(asked: Asked) -> tuple[Asked, str]:
    """A question without the floor, wall or ceiling that only says more exactly where: "on the floor under the desk".

    The second value is what things must then rest on, "" if the question names none.
    """
    query = asked.slots.get("a")
    if not isinstance(query, Query) or query.text not in SHELL or len(query.relations) != 1 or "r" not in asked.slots:
        return asked, ""
    (relation,) = query.relations
    if asked.slots["r"] != "on" or len(relation.anchors) != 1:
        return asked, ""
    return replace(asked, slots={**asked.slots, "r": relation.name, "a": relation.anchors[0]}), query.text


def _rests_on(thing: Thing, shell: str) -> bool:
    return not shell or (thing.node is not None and thing.node.support == shell)


def _listed(name: str, found: Sequence[Thing], anchors: Sequence[Thing], asked: Asked, survey: Survey) -> Answer:
    where = _told(name, anchors, survey)
    one = bool(re.search(r"\b(?:what|which) (?:thing|object|item)\b(?!s)|\bclosest\b", asked.said))
    if re.search(r"\bstand(?:s|ing)?\b|\bstood\b", asked.said) and name == "next_to":
        found = [t for t in found if t.node is None or t.node.support not in ("wall", "ceiling")]
    if one and name == "next_to":
        found = sorted(found, key=lambda t: survey.gap(t, anchors[0]))[:1]
    if not found and name == "inside":
        text = f"What is {where} cannot be told: only the outside of it is known."
        return Answer(answer=None, answer_type="list", text=text, source="none", evidence=Evidence(ids=_ids(anchors)))
    if not found:
        return Answer(answer=(), answer_type="list", text=f"Nothing is {where}.", confidence=0.9,
                      evidence=Evidence(ids=_ids(anchors)))  # fmt: skip
    verb = be(found)
    text = f"{_cap(listed([survey.named(t) for t in found]))} {verb} {where}."
    evidence = Evidence(ids=_ids([*found, *anchors]))
    if one and len(found) == 1:
        return Answer(answer=found[0].name, answer_type="label", text=text, confidence=0.93, evidence=evidence)
    names = tuple(t.name for t in found)
    return Answer(answer=names, answer_type="list", text=text, confidence=0.93, evidence=evidence)


def _together(name: str, answers: Sequence[Answer], asked: Asked, survey: Survey) -> Answer:
    ids = tuple(dict.fromkeys(i for a in answers for i in a.evidence.ids))
    names = tuple(n for a in answers if isinstance(a.answer, tuple) for n in a.answer)
    text = " ".join(a.text for a in answers)
    return answers[0].model_copy(update={"answer": names, "answer_type": "list", "text": text,
                                         "evidence": Evidence(ids=ids)})  # fmt: skip


def _told(name: str, anchors: Sequence[Thing], survey: Survey) -> str:
    names = list(dict.fromkeys(f"the {a.label}" if a.node is None else survey.named(a) for a in anchors))
    if name == "held":
        return f"on or in {names[0]}"
    return relations.named(name).told(*names)


def _has(asked: Asked, survey: Survey) -> Answer | None:
    name = _relation(asked)
    if name is None:
        return None
    cases: list[Case] = []
    for anchor, *_ in _anchors(asked, survey):
        found = _held(anchor, survey) if name == "held" else related(name, (anchor,), survey)
        cases.append((survey.named(anchor), _listed(name, found, (anchor,), asked, survey)))
    if len(cases) > 1 and _is_every(asked):
        return _together(name, [a for _, a in cases], asked, survey)
    return agreed(cases)


def _held(anchor: Thing, survey: Survey) -> list[Thing]:
    on, inside = related("on", (anchor,), survey), related("inside", (anchor,), survey)
    return [*on, *(t for t in inside if t.row not in {o.row for o in on})]


# -- yes or no --------------------------------------------------------------------------------------------------------


def _has_it(asked: Asked, survey: Survey) -> Answer | None:
    name = _relation(asked)
    if name is None:
        return None
    wanted = _wanted(asked, survey)
    empty = bool(re.search(r"\b(?:empty|bare|clear|free)\b", asked.said)) and "x" not in asked.slots
    cases: list[Case] = []
    for anchor, *_ in _anchors(asked, survey):
        found = _held(anchor, survey) if name == "held" else related(name, (anchor,), survey)
        found = [t for t in found if wanted is None or t.row in wanted]
        yes = bool(found) != empty
        what = listed([survey.named(t) for t in found])
        verb = be(found) if found else "is"
        text = f"{'Yes' if yes else 'No'}, {what} {verb} {_told(name, (anchor,), survey)}."
        cases.append((survey.named(anchor), _yes_no(yes, text, [*found, anchor], 0.93)))
    return whole(cases, "all" if _is_every(asked) else "any") if _is_every(asked) else agreed(cases)


def _is_related(asked: Asked, survey: Survey) -> Answer | None:
    asked, shell = _without_shell(asked)
    name = _relation(asked)
    if name is None:
        return None
    if "x" not in asked.slots:
        return _together_yes_no(name, asked, survey)
    query = asked.slots["x"]
    things = _subjects(query, asked, survey)
    anchors = _anchors(asked, survey)
    if things is None:
        return absent(survey, query, survey.find(query), "yesno")
    if shell:
        things = tuple(t for t in things if _rests_on(t, shell)) or things
    cases: list[Case] = []
    for choice in anchors:
        cases.append((" and ".join(survey.named(a) for a in choice), _one_anchor(name, things, choice, asked, survey)))
    said = asked.slots.get("a", asked.slots.get("both"))
    if len(cases) > 1 and ((isinstance(said, Query) and said.pick == "any") or _many_places(asked)):
        return whole(cases, "any")
    return whole(cases, "all") if _is_every(asked) else agreed(cases)


def _together_yes_no(name: str, asked: Asked, survey: Survey) -> Answer | None:
    """Whether things that are named as one are next to each other: each to one of the others."""
    things = meant(asked.slots["both"], survey)
    if len(things) < 2:
        return None
    cases: list[Case] = []
    for t in things:
        near = [o for o in things if o.row != t.row and strength(name, t, (o,), survey) >= HOLDS]
        said = f"next to {survey.named(near[0])}" if near else "next to none of the others"
        text = f"{'Yes' if near else 'No'}, {survey.named(t)} is {said}."
        cases.append((survey.named(t), _yes_no(bool(near), text, [t, *near], 0.9)))
    return whole(cases, "all")


def _either(asked: Asked, survey: Survey) -> Answer | None:
    """On, in or next to which of two things another one is."""
    name, other = _relation(asked), asked.slots.get("s", asked.slots["r"])
    if name is None or relations.named(other).aim:
        return None
    firsts, seconds = meant(asked.slots["a"], survey), meant(asked.slots["b"], survey)

    def one(thing: Thing) -> Answer:
        choices = [(a, name) for a in firsts] + [(b, other) for b in seconds]
        there = [(a, r) for a, r in choices if strength(r, thing, (a,), survey) >= HOLDS]
        labels = {(a.name, r) for a, r in there}
        said = listed([_told(r, (a,), survey) for a, r in there])
        text = f"{_cap(survey.named(thing))} is {said if there else 'neither'}."
        evidence = Evidence(ids=_ids([*(a for a, _ in there), thing]))
        if len(labels) != 1:
            return Answer(answer=None, answer_type="label", text=text, confidence=0.8, evidence=evidence)
        anchor, relation = there[0]
        label = anchor.name if other == name else relations.named(relation).told(anchor.name)
        return Answer(answer=label, answer_type="label", text=text, confidence=0.9, evidence=evidence)

    return agreed([(survey.named(t), one(t)) for t in meant(asked.slots["x"], survey)])


def _many_places(asked: Asked) -> bool:
    """Whether any of the anchors will do: "is there a lamp on the desk" where there are two desks."""
    return asked.slots["x"].pick in ("any", "all") and name_of(asked) != "between"


def name_of(asked: Asked) -> str:
    """The relation that is asked about, "" if none."""
    return _relation(asked) or ""


def _subjects(query: Query, asked: Asked, survey: Survey) -> tuple[Thing, ...] | None:
    """The things that a question asks about; None if a kind that is named is absent."""
    if is_anything(query) and not query.relations:
        return survey.things
    if query.pick == "any" or re.search(r"\bthere\b", asked.said):
        return survey.all_of(query) or None
    return meant(query, survey)


def _one_anchor(name: str, things: Sequence[Thing], anchors: tuple[Thing, ...], asked: Asked, survey: Survey) -> Answer:
    query = asked.slots["x"]
    scores = {t.row: _strength(name, t, anchors, asked, survey) for t in things}
    there = [t for t in things if scores[t.row] >= HOLDS]
    where = _told(name, anchors, survey)
    margin = min(abs(s - HOLDS) for s in scores.values()) if scores else 0.5
    sure = round(0.6 + 0.37 * min(margin / 0.25, 1.0), 3)
    anyone = is_unnamed(query) or query.pick == "any" or bool(re.search(r"\bthere\b", asked.said))
    if anyone or len(things) == 1:
        said = listed([survey.named(t) for t in there]) if there else listed([survey.named(t) for t in things[:1]])
        if there:
            text = f"Yes, {said} {'is' if len(there) == 1 else 'are'} {where}."
            best = max(scores[t.row] for t in there)
            sure = round(0.6 + 0.37 * min((best - HOLDS) / 0.25, 1.0), 3)
        else:
            text = f"No, {said + ' is not' if len(things) == 1 else 'nothing of that kind is'} {where}."
            if anyone and is_anything(query):
                text = f"No, nothing is {where}."
        return _yes_no(bool(there), text, [*there[:20], *anchors], sure)
    each = [
        (
            survey.named(t),
            _yes_no(
                t in there,
                f"{'Yes' if t in there else 'No'}, {survey.named(t)} is {'' if t in there else 'not '}{where}.",
                [t, *anchors],
                sure,
            ),
        )
        for t in things
    ]
    if is_plural(query) or "both" in asked.said or "all" in asked.words:
        return whole(each, "all")
    return agreed(each)


def _strength(name: str, thing: Thing, anchors: tuple[Thing, ...], asked: Asked, survey: Survey) -> float:
    if name == "between":
        turned = (anchors[1], anchors[0])
        return max(strength(name, thing, anchors, survey), strength(name, thing, turned, survey))
    found = strength(name, thing, anchors, survey)
    if name in ("under", "below") and re.search(r"\bpart(?:ly|ially)?\b|\breach|\bextend", asked.said):
        return (
            1.0
            if overlaps(thing, anchors[0]) > 0.02 and thing.group.box.center[2] < anchors[0].group.box.center[2]
            else found
        )
    if name == "inside" and found < HOLDS:  # flowers "in" a vase, a plant "in" a pot, clothes "in" a wardrobe
        return max(
            found, 0.55 if thing.node is not None and thing.node.support == anchors[0].id and _loose(asked) else 0.0
        )
    return found


def _loose(asked: Asked) -> bool:
    return not re.search(r"\binside\b|\bwithin\b", asked.said)


# -- what a thing stands on or next to --------------------------------------------------------------------------------


def _support(asked: Asked, survey: Survey) -> Answer | None:
    things = _subjects(asked.slots["x"], asked, survey)
    if not things:
        raise NotResolved(asked.slots["x"], survey.find(asked.slots["x"]))

    asked_of = asked.slots.get("y")
    wanted = None if asked_of is None or is_anything(asked_of) else {t.row for t in survey.all_of(asked_of)}

    def one(thing: Thing) -> Answer:
        found = supporter(thing, survey)
        name = found if isinstance(found, str) else found.name
        told = f"the {found}" if isinstance(found, str) else survey.named(found)
        verb = {"wall": "hangs on", "ceiling": "hangs from", ALOFT: "is in"}.get(name, "stands on")
        ids = [thing] if isinstance(found, str) else [found, thing]
        if wanted is not None and (name in NO_THINGS if isinstance(found, str) else found.row not in wanted):
            return unknown("label", f"None of those: {survey.named(thing)} {verb} {told}.", ids)
        if "y" in asked.slots and not isinstance(found, str) and sum(t.label == found.label for t in survey.things) > 1:
            name = survey.named(found).removeprefix("the ")
        return Answer(answer=name, answer_type="label", text=f"{_cap(survey.named(thing))} {verb} {told}.",
                      confidence=0.95, evidence=Evidence(ids=_ids(ids)))  # fmt: skip

    cases = [(survey.named(t), one(t)) for t in things if t.node is not None]
    if not cases:
        return unknown("label", f"{_cap(survey.named(things[0]))} is part of the room and stands on nothing.")
    return agreed(cases)


def _next(asked: Asked, survey: Survey) -> Answer | None:
    """What a thing is next to, under, over, in or between."""
    name = _relation_of_rest(asked)
    things = meant(asked.slots["x"], survey)
    wanted = {t.row for t in survey.all_of(asked.slots["y"])} if "y" in asked.slots else None
    inverse = (
        {"next_to": "next_to", "under": "above", "above": "under", "inside": ""}[name] if name != "between" else ""
    )

    def one(thing: Thing) -> Answer:
        if name == "inside":
            found = [t for t in survey.things if strength("inside", thing, (t,), survey) >= HOLDS]
        elif name == "between":
            return unknown("label", "Say between which things; what is next to it can be asked.", (thing,))
        elif name == "next_to":
            found = related(inverse, (thing,), survey)
        else:
            found = [t for t in survey.things if strength(name, thing, (t,), survey) >= HOLDS]
            found.sort(key=lambda t: survey.gap(t, thing))
        found = [t for t in found if wanted is None or t.row in wanted]
        where = {"next_to": "next to", "under": "under", "above": "above", "inside": "in"}[name]
        if not found and name == "next_to" and wanted is None:
            wall, gap = wall_of(thing, survey.room)
            at = f"{wall.name} wall"
            if gap <= AT_WALL:
                return Answer(answer=at, answer_type="label", confidence=0.8, evidence=Evidence(ids=_ids([thing])),
                              frame="viewer", text=f"{_cap(survey.named(thing))} is at the {at}.")  # fmt: skip
        if not found:
            return Answer(answer=None, answer_type="label", confidence=0.8, evidence=Evidence(ids=_ids([thing])),
                          text=f"{_cap(survey.named(thing))} is {where} nothing.")  # fmt: skip
        told = listed([survey.named(t) for t in found[:5]])
        return Answer(answer=found[0].name, answer_type="label", confidence=0.9 if len(found) == 1 else 0.8,
                      text=f"{_cap(survey.named(thing))} is {where} {told}.",
                      evidence=Evidence(ids=_ids([found[0], thing, *found[1:5]])))  # fmt: skip

    return agreed([(survey.named(t), one(t)) for t in things])


def _relation_of_rest(asked: Asked) -> str:
    said = asked.said
    if "between" in said:
        return "between"
    if re.search(r"\b(?:under|underneath|beneath|below)\b", said):
        return "under"
    if re.search(r"\b(?:above|over)\b", said):
        return "above"
    if re.search(r"\b(?:next|beside|by|near|close|alongside|adjacent)\b", said):
        return "next_to"
    return "inside"


# -- walls, floor and ceiling -----------------------------------------------------------------------------------------


def _hung(asked: Asked, survey: Survey) -> Answer | None:
    said = str(asked.slots["w"])
    shell = "ceiling" if "ceiling" in said else "wall" if "wall" in said else "floor"
    name, text = (named_in(said) or ("",))[0] if shell == "wall" else "", asked.said
    stands = bool(re.search(r"\b(?:against|along|at|stands?|standing)\b", text)) and shell == "wall"
    wanted = _wanted(asked, survey)
    hangs_there = bool(re.search(r"\b(?:hang|hangs|hanging|hung|mounted)\b", text))
    found = []
    for t in survey.things:
        if hangs_there and (kind := kinds.of(t.label)) is not None and kind.opening:
            continue
        if t.node is None or (wanted is not None and t.row not in wanted):
            continue
        hangs = t.node.support == shell
        wall, gap = wall_of(t, survey.room)
        if stands and t.node.support == "floor" and gap <= 0.15:
            hangs = True
        if hangs and (not name or wall.name == name):
            found.append(t)
    told = f"the {name + ' ' if name else ''}{shell}"
    answered = [survey.named(t) for t in found]
    sentence = f"{_cap(listed(answered))} {'is' if len(found) <= 1 else 'are'} {'at' if stands else 'on'} {told}."
    evidence = Evidence(ids=_ids(found))
    if re.search(r"\banything\b", text) and not re.match(r"\W*what|list|name", text):
        return _yes_no(bool(found), f"{'Yes' if found else 'No'}, {listed(answered)} on {told}.", found, 0.9)
    return Answer(answer=tuple(t.name for t in found), answer_type="list", text=sentence, evidence=evidence,
                  frame="viewer" if name else "", confidence=0.9)  # fmt: skip


# -- words ------------------------------------------------------------------------------------------------------------


def _yes_no(yes: bool, text: str, things: Sequence[Thing], sure: float) -> Answer:
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, confidence=sure,
                  evidence=Evidence(ids=_ids(things)))  # fmt: skip


def _ids(things: Sequence[Thing]) -> tuple[int | str, ...]:
    return tuple(dict.fromkeys(t.id for t in things if t.node is not None))


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("supported_by", templates(_SUPPORT), _support),
    Kind("related_either", templates(_EITHER), _either),
    Kind("related", templates(_IS_REL), _is_related),
    Kind("related_what", templates(_WHAT_THERE), _what),
    Kind("beside_what", templates(_BESIDE), _next),
    Kind("has_it", templates(_HAS_IT), _has_it),
    Kind("has", templates(_HAS), _has),
)

BETWEEN = Kind("between", templates(_BETWEEN), _is_related)
HUNG = Kind("hung", templates(_HUNG), _hung)
