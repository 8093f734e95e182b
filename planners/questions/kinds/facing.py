"""Which way things face: "what does the sofa face?", "is the armchair turned to the TV?"."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ....gaussians.world.relation_geometry import FACES
from ....gaussians.world.support import is_stepped_on
from ..answer import Answer, AnswerType, Evidence
from ..candidates import agreed, is_plural, meant, pairs, unknown, whole
from ..kind import Asked, Kind
from ..reading.phrase_templates import templates
from ..room_places import middle, walls
from ..survey import Survey, Thing, listed
from ..views import View, front

_FACING = (
    "(facing|turned to|turned toward|turned towards|pointing at|pointing to|pointing toward|pointing towards|"
    "looking at|"
    "looking toward|looking towards|oriented to|oriented toward|oriented towards|directed at|directed to|directed "
    "toward|"
    "directed towards|aimed at|angled toward|angled towards|pointed at|pointed to|pointed toward|pointed towards|"
    "facing toward|facing towards|facing to|rotated to|rotated towards|opposite to|turned at)"
)
_WHAT = f"""
    (what|which thing|which object|what thing|what object) (do|does) {{x}} (face|look at|point at|point to|point \
        toward|point towards|look toward|look towards|look out on|face toward|face towards|overlook)
    (what|which thing|which object) BE {{x}} {_FACING}
    (what|which thing|which object) BE {{x}} turned
    (what|which) {{y}} (do|does) {{x}} (face|look at|point at|point to)
    (what|which) {{y}} BE {{x}} {_FACING}
    (toward|towards|at) what (is|are|does) {{x}} (facing|turned|pointing|oriented|face|point|look)
"""
_WAY = """
    (which|what) (way|direction) BE {x} (facing|turned|pointing|oriented|looking|turned to|turned \
        towards|pointing to|directed|pointed|angled)
    (which|what) (way|direction) (do|does) {x} (face|point|look|open|front)
    (in|to|towards|toward) (which|what) (way|direction) BE {x} (facing|turned|pointing|oriented|looking|directed|\
        pointed)
    (in|to|towards|toward) (which|what) (way|direction) (do|does) {x} (face|point|look)
    (which|what) wall (do|does) {x} (face|point to|look at)
    (which|what) wall BE {x} (facing|turned to|pointing at|pointing to)
    what is the orientation of {x}
    how BE {x} oriented
    where (do|does) {x} (face|point|look) [to|towards|toward]
    where BE {x} (facing|pointing|turned to|looking)
"""
_IS = f"""
    BE {{x}} [all|both] {_FACING} {{a}}
    (do|does) {{x}} [all|both] (face|point at|point to|point toward|point towards|look at|look toward|look \
        towards|look out of) {{a}}
    BE {{x}} (turned|facing|pointing) away from {{away}}
    (do|does) {{x}} face away from {{away}}
    BE {{x}} (facing|turned to|turned toward|turned towards) (each other|one another)
    BE {{x}} and {{a}} (facing|turned to|turned toward|turned towards) (each other|one another)
    (do|does) {{x}} and {{a}} face (each other|one another)
    (do|does) {{x}} have [its|their] (back|backs) (to|toward|towards|turned to) {{away}}
    would (someone|i|somebody|you|one|a person) [sitting|seated|sat] (in|on) {{x}} (face|look at|be facing|be \
        looking at|see) {{a}}
    (can|could|would) (i|you|one|someone|somebody) (see|watch|face|look at|look out of) {{a}} (from|when sitting \
        on|while sitting on|when sitting in|sitting on|sitting in) {{x}}
"""
_WHICH = f"""
    (what|which) {{x}} (is|are) {_FACING} {{a}}
    (what|which) {{x}} (faces|face|points at|points to|looks at) {{a}}
    (what|which things|what things|which objects|which thing|what thing) (is|are) {_FACING} {{a}}
    (what|which things|what things|which objects|which thing|what thing) (faces|face|points at|points to) {{a}}
    how many {{x}} (face|are facing|point at|point to|are pointing at|are turned to|are turned towards) {{a}}
"""
_LOW = 0.6  # metres: a thing whose top is lower is looked over, as a coffee table before a sofa


def _what(asked: Asked, survey: Survey) -> Answer | None:
    things = meant(asked.slots["x"], survey)
    wanted = {t.row for t in survey.all_of(asked.slots["y"])} if "y" in asked.slots else None
    return agreed([(survey.named(t), _faced(t, wanted, survey)) for t in things])


def _faced(thing: Thing, wanted: set[int] | None, survey: Survey) -> Answer:
    way = front(thing, survey)
    if way is None:
        return _no_front(thing, "label", survey)
    view = View(middle(thing), way, "")
    ahead = [t for t in _before(thing, view, survey) if wanted is None or t.row in wanted]
    wall = max(walls(survey.room), key=lambda w: float(w.out @ way))
    if not ahead:
        text = f"{_cap(survey.named(thing))} faces the {wall.name} wall."
        return Answer(answer=f"{wall.name} wall", answer_type="label", text=text, confidence=0.8, frame="viewer",
                      evidence=Evidence(ids=(thing.id,)))  # fmt: skip
    main = next((t for t in ahead if _top(t) >= min(_LOW, 0.9 * _top(thing))), ahead[0])
    others = [survey.named(t) for t in ahead if t.row != main.row][:4]
    also = f"; also before it: {listed(others)}" if others else ""
    text = f"{_cap(survey.named(thing))} faces {survey.named(main)}{also}."
    return Answer(answer=main.name, answer_type="label", text=text, confidence=0.9 if not others else 0.75,
                  evidence=Evidence(ids=(main.id, thing.id, *(t.id for t in ahead if t.row != main.row))))  # fmt: skip


def _before(thing: Thing, view: View, survey: Survey) -> list[Thing]:
    """What lies in the strip before a thing's front, as wide as the thing, the nearest first."""
    width = thing.group.box.extent(np.array([view.forward[1], -view.forward[0], 0.0])) / 2
    found = []
    for t in survey.things:
        if t.row == thing.row or t.node is None or t.node.support == "ceiling":
            continue
        if is_stepped_on(t.node.support, t.node.size[2]) or t.node.support == thing.id or (
            thing.node is not None and thing.node.support == t.id
        ):  # fmt: skip
            continue
        ahead, aside = view.along(t), abs(view.across(t))
        half = t.group.box.extent(np.array([view.forward[1], -view.forward[0], 0.0])) / 2
        if ahead > 0 and aside < max(half, width) and math.degrees(math.atan2(aside, ahead)) < FACES:
            found.append((ahead, t.row))
    carried = {
        t.row for t in survey.things if t.node is not None and t.node.support in {survey.at(r).id for _, r in found}
    }
    return [survey.at(r) for _, r in sorted(found) if r not in carried or len(found) == 1]


def _top(thing: Thing) -> float:
    return thing.node.top if thing.node is not None else 0.0


def _way_faced(asked: Asked, survey: Survey) -> Answer | None:
    things = meant(asked.slots["x"], survey)

    def one(thing: Thing) -> Answer:
        way = front(thing, survey)
        if way is None:
            return _no_front(thing, "label", survey)
        wall = max(walls(survey.room), key=lambda w: float(w.out @ way))
        told = {"back": "away from you, to the back wall", "front": "toward you, to the front wall",
                "left": "to the left wall", "right": "to the right wall"}[wall.name]  # fmt: skip
        label = {"back": "back", "front": "front"}.get(wall.name, wall.name)
        sure = 0.9 if float(wall.out @ way) > 0.9 else 0.7
        return Answer(answer=label, answer_type="label", text=f"{_cap(survey.named(thing))} faces {told}.",
                      frame="viewer", confidence=sure, evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    return agreed([(survey.named(t), one(t)) for t in things])


def _is_facing(asked: Asked, survey: Survey) -> Answer | None:
    away = "away" in asked.slots
    firsts = meant(asked.slots["x"], survey)
    if "a" not in asked.slots and not away:
        return whole([("", _faces(a, b, False, survey)) for a in firsts for b in firsts if a.row != b.row], "all")
    seconds = meant(asked.slots["away" if away else "a"], survey)
    if all(t.node is None for t in seconds):
        return agreed([(survey.named(t), _faces_wall(t, seconds, away, survey)) for t in firsts])
    mutual = "each other" in asked.said or "one another" in asked.said
    if mutual:
        both = [("", _faces(a, b, False, survey)) for a in firsts for b in seconds]
        return whole([*both, *(("", _faces(b, a, False, survey)) for a in firsts for b in seconds)], "all")
    if is_plural(asked.slots["x"]):
        return whole([(survey.named(a), _any_faced(a, seconds, away, survey)) for a in firsts], "all")
    if is_plural(asked.slots["a"] if not away else asked.slots["away"]):
        return agreed([(survey.named(a), whole([(survey.named(b), _faces(a, b, away, survey)) for b in seconds], "all"))
                       for a in firsts])  # fmt: skip
    return pairs(firsts, seconds, survey, lambda p, q: _faces(p, q, away, survey))


def _faces_wall(thing: Thing, targets: Sequence[Thing], away: bool, survey: Survey) -> Answer:
    """Whether a thing faces a wall, with nothing between where no wall is named."""
    way = front(thing, survey)
    if way is None:
        return _no_front(thing, "yesno", survey)
    if len(targets) == 1:
        return _faces(thing, targets[0], away, survey)
    faced = _faced(thing, None, survey)
    yes = str(faced.answer).endswith(" wall") != away
    text = f"{'Yes' if yes else 'No'}: {faced.text[:1].lower()}{faced.text[1:]}"
    return faced.model_copy(update={"answer": "yes" if yes else "no", "answer_type": "yesno", "text": text})


def _any_faced(thing: Thing, targets: Sequence[Thing], away: bool, survey: Survey) -> Answer:
    """Whether one of several things faces one of the others, as each chair its desk."""
    return whole([(survey.named(t), _faces(thing, t, away, survey)) for t in targets if t.row != thing.row], "any")


def _faces(thing: Thing, target: Thing, away: bool, survey: Survey) -> Answer:
    way = front(thing, survey)
    if way is None:
        return _no_front(thing, "yesno", survey)
    off = abs(View(middle(thing), way, "").to(target))
    off = 180.0 - off if away else off
    yes = off <= FACES
    verb = "faces away from" if away else "faces"
    off_told = f"; its front is {off:.0f}° off" if not yes and not away else ""
    told = f"{survey.named(thing)} {verb if yes else 'does not face'} {_the(target, survey)}"
    text = f"{'Yes' if yes else 'No'}, {told}{off_told}."
    if not yes and away:
        text = f"No, {survey.named(thing)} does not face away from {_the(target, survey)}."
    ids = tuple(t.id for t in (thing, target) if t.node is not None)
    return Answer(answer="yes" if yes else "no", answer_type="yesno", text=text, evidence=Evidence(ids=ids),
                  confidence=round(0.6 + 0.35 * min(abs(off - FACES) / 20.0, 1.0), 3))  # fmt: skip


def _which(asked: Asked, survey: Survey) -> Answer | None:
    candidates = survey.all_of(asked.slots["x"]) if "x" in asked.slots else survey.things
    targets = meant(asked.slots["a"], survey)

    def one(target: Thing) -> Answer:
        found = [t for t in candidates if t.row != target.row and front(t, survey) is not None
                 and _faces(t, target, False, survey).answer == "yes" and _free_standing(t)]  # fmt: skip
        names = [survey.named(t) for t in found]
        evidence = Evidence(ids=(*(t.id for t in found), *((target.id,) if target.node is not None else ())))
        if asked.said.startswith("how many"):
            return Answer(answer=float(len(found)), answer_type="number", text=f"{len(found)}: {listed(names)}.",
                          confidence=0.85, evidence=evidence)  # fmt: skip
        labels = tuple(
            n.removeprefix("the ") if "x" in asked.slots else t.name for n, t in zip(names, found, strict=True)
        )
        said = f"{_cap(listed(names))} {'faces' if len(found) <= 1 else 'face'} {_the(target, survey)}."
        return Answer(answer=labels, answer_type="list", text=said, confidence=0.85, evidence=evidence)

    return agreed([(survey.named(t), one(t)) for t in targets])


def _free_standing(thing: Thing) -> bool:
    return thing.node is not None and thing.node.support not in ("wall", "ceiling")


def _no_front(thing: Thing, kind: AnswerType, survey: Survey) -> Answer:
    return unknown(kind, f"Nothing tells which side of {survey.named(thing)} is its front.", (thing,))


def _the(thing: Thing, survey: Survey) -> str:
    return f"the {thing.label}" if thing.node is None else survey.named(thing)


def _cap(said: str) -> str:
    return said[:1].upper() + said[1:]


KINDS = (
    Kind("faces_what", templates(_WHAT), _what),
    Kind("faces_way", templates(_WAY), _way_faced),
    Kind("faces", templates(_IS), _is_facing),
    Kind("which_faces", templates(_WHICH), _which),
)
