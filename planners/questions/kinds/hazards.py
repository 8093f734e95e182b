"""What one may trip over, what blocks a door or a window, and how wide the narrowest passage of the room is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ....gaussians.world.person import HEADROOM, SHOULDERS, STEP
from ...rooms.floor_grid import is_obstacle
from ...rooms.node import Node
from ..answer import Answer, Evidence, Line
from ..candidates import agreed, meant
from ..floor import ends
from ..floor.floor_map import GROUNDED
from ..floor.routes import in_the_way, is_open, passage, route, to_node, to_point
from ..kind import Asked, Kind
from ..reading.phrase_templates import templates
from ..reading.spans import METRE, answer_of, told
from ..survey import NotResolved, Survey, Thing, listed

LOW = 0.45  # metres: a thing on the floor that is lower is easily overlooked
SMALL = 0.8  # metres: larger low things, as beds and coffee tables, are seen
BESIDE = 0.3  # metres between a walk and a thing that one may kick
_BEFORE = 0.5  # metres before a door or window that must be free

_TRIP = "(trip|stumble|fall|tumble|trip up|slip)"
_OVER = "(over|on|across|against|upon)"
_WHO = (
    "(i|one|you|someone|somebody|we|people|a person|a child|anyone|anybody|a toddler|a visitor|guests|a blind "
    "person|an elderly person)"
)
_COULD = (
    "(could|might|can|may|would|will|am i likely to|are you likely to|is one likely to|is someone likely to|do i risk)"
)
_DARK = (
    "[easily|possibly|likely|accidentally] [in the dark|at night|when walking around|walking around|when the "
    "lights are off|without the lights on|on the floor|if i am not careful|if the lights are off]"
)
_HAZARD = (
    "(trip hazards|tripping hazards|trip hazard|tripping hazard|stumbling hazards|things to trip over|tripping "
    "dangers|obstacles on the floor|loose obstacles|stumbling blocks|trip risks)"
)
_ON_WAY = (
    "(going|walking|when going|when walking|on the way|coming|if i go|if i walk|if i went|if i walked|when i "
    "go|when i walk|"
    "if you walk|if you go|on my way|heading|if someone walks|if one walks|on the path|on the route|on a walk)"
)
_TO = "(from {a:end} [over|across|straight|directly] to {b:end}|between {a:end} and {b:end})"
_DOOR_TO = (
    "(coming|walking|going|stepping|heading) [in] through {a:end} [and] (heading|walking|going|on|over|making|"
    "crossing) [my way|over|straight] (for|to|toward|towards) {b:end}"
)

_WHAT = f"""
    what {_COULD} {_WHO} {_TRIP} {_OVER} {_DARK} [in the room|in here|here]
    what {_COULD} {_TRIP} {_OVER} {_DARK} [in the room|in here|here]
    (what|which) (things|objects|items|thing|object) [on the floor|in the room|in here] {_COULD} {_WHO} {_TRIP} \
      {_OVER} {_DARK} [in the room|in here]
    what (is there|things are there|on the floor|on the floor is there) {_WHO} {_COULD} {_TRIP} {_OVER} {_DARK}
    what is there to {_TRIP} {_OVER} [in the room|in here|here]
    what on the floor {_COULD} {_WHO} {_TRIP} {_OVER} {_DARK}
    what (is|are|would be) [the|a|any] {_HAZARD} [in the room|in here|here|on the floor]
    (what|which) {_HAZARD} (are there|are|exist|is there) [in the room|in here|here|there|on the floor]
    (which|what) (things|objects|items|thing|of the things) (is|are|could be|might be|would be) [a|the] {_HAZARD} \
      [in the room]
    [name|list|show|show me|point out|find] [all|any|the|all the] {_HAZARD} [in the room|in here|here]
    (what|which) (thing|things|object|objects) {_COULD} (make|cause) {_WHO} [to] {_TRIP}
    what {_COULD} (make|cause) {_WHO} [to] {_TRIP} [in the room|in here]
    where {_COULD} {_WHO} {_TRIP} [in the room|in here] [in the dark|at night]
"""
_WHAT_WAY = f"""
    {_ON_WAY} {_TO} {_DARK} what [little thing|small thing|thing|things|low thing] [on the floor|on the way] \
      {_COULD} {_WHO} {_TRIP} {_OVER}
    {_ON_WAY} {_TO} {_DARK} what [little thing|small thing|thing|things] [on the floor] {_COULD} {_TRIP} {_OVER}
    {_ON_WAY} {_TO} {_DARK} what [little thing|small thing|thing|things] [on the floor] (am i|are you|is one|is \
      someone) likely to ({_TRIP} {_OVER}|kick|kick over|knock over|walk into|bump into|hit)
    {_ON_WAY} {_TO} {_DARK} what [little thing|small thing|thing|things] [on the floor] {_COULD} {_WHO} \
      (kick|kick over|knock over|walk into|bump into|hit)
    {_DOOR_TO} {_DARK} what [little thing|small thing|thing|things] [on the floor] {_COULD} {_WHO} ({_TRIP} \
      {_OVER}|kick|kick over|knock over|walk into|bump into|hit)
    {_DOOR_TO} {_DARK} what [little thing|small thing|thing|things] [on the floor] (am i|are you|is one|is \
      someone) likely to ({_TRIP} {_OVER}|kick|kick over|knock over|walk into|bump into|hit)
    what [things|thing|little thing] [on the floor] {_COULD} {_WHO} ({_TRIP} {_OVER}|kick|kick over|knock \
      over|walk into|bump into) {_DARK} {_ON_WAY} {_TO} {_DARK}
    what {_COULD} {_TRIP} {_OVER} {_ON_WAY} {_TO}
    (is|are) there (anything|something|any things) [on the floor] to {_TRIP} {_OVER} {_ON_WAY} {_TO}
    (is|are) there (anything|something) [on the floor] {_WHO} {_COULD} {_TRIP} {_OVER} {_ON_WAY} {_TO}
"""
_ANY = f"""
    (is|are) there (anything|something|things) [lying] [on the floor|in the room|in here|here] [that] \
      (could|might|can|may|would) trip {_WHO} [up]
    (is|are) there (any|a|some) {_HAZARD} [in the room|in here|here|on the floor]
    [(is|are) there] (anything|something|things|any things) [on the floor|in the room|in here|here] [that] {_WHO} \
      {_COULD} {_TRIP} {_OVER} {_DARK}
    [(is|are) there] (anything|something|any things) [on the floor] to {_TRIP} {_OVER} [in here|here]
    (is|are) there (anything|something|things) [on the floor|in the room|in here|here] to {_TRIP} {_OVER} [in the \
      room|in here|here]
    (could|might|can|would|will) {_WHO} {_TRIP} {_OVER} (anything|something) {_DARK} [in the room|in here|here]
    (do|does|has|have) (the room|we|i) (have|got) any {_HAZARD}
    BE the floor (safe to walk on|safe to walk in the dark|free of {_HAZARD}|free of clutter)
"""
_ONE = f"""
    (could|might|can|would|will) {_WHO} {_TRIP} {_OVER} {{x}} {_DARK}
    BE {{x}} [a|an] {_HAZARD} {_DARK}
    (does|could|might|would|do) {{x}} (pose|be|become) [a|an] {_HAZARD}
"""
_BLOCKED = """
    BE {x} (blocked|obstructed|barred|blocked off|barricaded) [by (anything|something|furniture|any furniture|a \
      thing)]
    (is|are) (there anything|anything|something|any furniture|there any furniture|there something|there \
      furniture) (blocking|obstructing|barring|standing in the way of) {x}
    (does|do|would) (anything|something|any furniture|furniture) (block|obstruct|bar|stand in the way of) {x}
"""
_FREE = """
    (can|could|would) {x} [still] be opened [fully|completely|freely|all the way]
    (can|could|would|does|will) {x} [still] open [fully|completely|freely|all the way] [without (hitting|bumping \
      into|touching) (anything|something)]
    BE {x} (unblocked|unobstructed|free to open|clear of furniture|clear of obstacles|free of obstacles|unhindered)
    BE the (door|doorway|entrance|way in) [kept] (clear|free)
    (can|could) (i|one|you|someone|we) open {x} [fully|completely|freely|all the way]
"""
_WHAT_BLOCKS = """
    what (is|would be|stands) (blocking|obstructing|barring|in the way of) {x}
    what (blocks|obstructs|bars) {x}
"""
_NARROWEST = """
    (what|how wide) is the (narrowest|tightest|smallest) (gap|passage|space) between (furniture|the furniture|things|\
      pieces of furniture|two things|any two things) [in {u:length_unit}]
    how (wide|narrow|tight|broad) (is|are) the (narrowest|tightest|smallest|slimmest) \
      (passage|gap|walkway|path|spot|point|passageway|aisle|place|way|corridor|way through|passage between \
      things|passage between the furniture|gap between the furniture|walking path|bottleneck) [in the room|in \
      here|here|between the furniture|you have to walk through] [in {u:length_unit}]
    (what|how wide) (is|are) the (width|size) of the (narrowest|tightest) \
      (passage|gap|walkway|path|spot|point|passageway|aisle) [in the room|in here|here|between the furniture] [in \
      {u:length_unit}]
    (what|where) (is|are) the (narrowest|tightest) \
      (passage|gap|walkway|path|spot|point|passageway|aisle|place|bottleneck|squeeze) [in the room|in \
      here|here|between the furniture] [in {u:length_unit}]
"""
_ACCESSIBLE = """
    BE the (room|place|space) (accessible|wheelchair accessible|suitable|usable|navigable|passable|wheelchair \
      friendly) [for|by|to|with] [{w:walker}]
    (can|could|would|will) {w:walker} (move|get|drive|roll|travel|go|walk|navigate) (around|about|around \
      freely|around easily|through) [in the room|the room|here|in here|everywhere] [easily|freely|comfortably]
    (can|could|would|will) {w:walker} (reach|get to|access|go to) (everything|all the furniture|every part of the \
      room|everywhere|all things) [in the room|in here]
    BE there (enough|sufficient) (room|space) for {w:walker} to (move|get|turn|go|drive) [around|about] [in the \
      room|in here|here]
"""
_EVERYTHING = """
    (can|could|would) (one|i|you|someone|a person|we|people|everyone) (reach|get to|access|walk up to|walk to) \
      (everything|all the furniture|every piece of furniture|all things|all of the furniture|every thing) [in the \
      room|in here]
    BE (everything|all the furniture|every piece of furniture|all of the furniture) (reachable|accessible) [on \
      foot|from the door]
"""
_UNREACHABLE = """
    (what|which) (things|furniture|pieces of furniture|thing|of the furniture|objects) (can|could) (not|i not|one \
      not|you not|nobody) [be] (reached|reach|accessed|access|get to) [on foot|from the door|in the room]
    (what|which) (things|furniture|pieces of furniture|thing|objects) (is|are) (unreachable|not reachable|not \
      accessible|inaccessible|blocked|hard to reach|out of reach) [from the door|on foot|in the room]
    what (can|could) (i|one|you) not (reach|get to|walk to|walk up to) [from the door|on foot|in the room]
"""
_TURN = """
    (can|could|would) {w:walker} turn (around|round|on the spot) [in the room|in here|here|somewhere|anywhere]
"""
_AROUND = """
    (can|could|may|would) (you|i|one|someone|people|we|a person) [comfortably|easily|still|actually] \
      (walk|get|go|move|pass) [all the way|right|completely|fully|the whole way] around {x} [with the chairs where \
      they are [now]|as it is|without (bumping into|touching|hitting|moving) anything|on all \
      sides|easily|comfortably]
    is it possible to (walk|get|go|move) [all the way|right|completely] around {x}
    (is|are) there (enough|sufficient) (room|space) to (walk|get|go|move) [all the way|right|completely] around {x}
    BE {x} accessible (from|on) (all|both|every|each) (sides|side|four sides)
"""


def hazards(survey: Survey) -> list[Thing]:
    """Low small things and edges of rugs on the floor that people walk on, those farthest out in the open first."""
    floor = survey.floor
    walked = np.isin(floor.areas(), sorted(floor.entered()))
    cells = np.argwhere(walked)
    if not len(cells):
        return []
    x, y = floor.xs[cells[:, 0]], floor.ys[cells[:, 1]]
    found: list[tuple[float, Thing]] = []
    for thing in survey.things:
        node = thing.node
        if node is None or not is_low(node) or _is_tucked(node, survey):
            continue
        near = node.yaw_box.distance_to(x, y) <= SHOULDERS / 2 + BESIDE / 2
        if near.any():
            found.append((-float(near.mean()), thing))
    return [t for _, t in sorted(found, key=lambda f: f[0])]


def is_low(node: Node) -> bool:
    """Whether a thing lies so low and is so small, or so flat, that one may trip over it."""
    if node.bottom > GROUNDED or node.support in ("wall", "ceiling"):
        return False
    return node.top <= STEP or (node.top <= LOW and max(node.size[:2]) <= SMALL)


def _is_tucked(node: Node, survey: Survey) -> bool:
    """Whether a larger thing stands or reaches over it, as a table over a waste basket or a sofa on a rug."""
    corners = node.yaw_box.corners()
    for other in survey.graph.nodes:
        if other.id == node.id or other.top <= node.top or other.bottom >= HEADROOM or node.is_stepped_on:
            continue
        if (other.yaw_box.distance_to(corners[:, 0], corners[:, 1]) <= 0.01).all():
            return True
    return False


def _list(things: Sequence[Thing], text: str, sure: float) -> Answer:
    ids = Evidence(ids=tuple(t.id for t in things))
    if len(things) == 1:
        return Answer(answer=things[0].name, answer_type="label", text=text, confidence=sure, evidence=ids)
    return Answer(answer=tuple(t.name for t in things), answer_type="list", text=text, confidence=sure, evidence=ids)


def _why(thing: Thing) -> str:
    assert thing.node is not None
    return "the edge of " if thing.node.is_stepped_on else ""


def _told(things: Sequence[Thing], survey: Survey) -> str:
    return listed([f"{_why(t)}{survey.named(t)}" for t in things])


def _what(asked: Asked, survey: Survey) -> Answer:
    things = hazards(survey)
    if not things:
        return _list((), "Nothing low lies on the floor where people walk.", 0.8)
    text = f"{_told(things, survey)} on the floor where people walk.".capitalize()
    return _list(things, text[0].upper() + text[1:], 0.7)


def _any(asked: Asked, survey: Survey) -> Answer:
    things = hazards(survey)
    safe = ("floor" in asked.text.lower() and "safe" in asked.text.lower()) or "free of" in asked.text.lower()
    holds = bool(things) != safe
    text = f"{_told(things, survey)} may be tripped over." if things else "Nothing low lies where people walk."
    return Answer(answer="yes" if holds else "no", answer_type="yesno",
                  text=f"{'Yes' if holds else 'No'}: {text[0].lower()}{text[1:]}", confidence=0.7,
                  evidence=Evidence(ids=tuple(t.id for t in things)))  # fmt: skip


def _one(asked: Asked, survey: Survey) -> Answer:
    try:
        things = meant(asked.slots["x"], survey)
    except NotResolved as error:
        return ends.absent(error, survey)
    risky = {t.row for t in hazards(survey)}

    def case(thing: Thing) -> Answer:
        holds = thing.row in risky
        why = "it is low and lies where people walk" if holds else "it is not a low thing where people walk"
        return Answer(answer="yes" if holds else "no", answer_type="yesno", text=f"{'Yes' if holds else 'No'}: {why}.",
                      confidence=0.7, evidence=Evidence(ids=(thing.id,)))  # fmt: skip

    return agreed([(survey.named(t), case(t)) for t in things])


def _on_the_way(asked: Asked, survey: Survey) -> Answer:
    """Low things at the straight line, or else at the walk, between two ends."""
    starts, goals = ends.spots(asked.slots["a"], survey), ends.spots(asked.slots["b"], survey)
    kicked = any(w in asked.text.lower() for w in ("kick", "knock", "little", "small", "bump"))
    yes_no = asked.text.lower().startswith(("is ", "are "))

    def case(a: ends.Spot, b: ends.Spot) -> Answer:
        apart = {t.id for t in (*a.things, *b.things)}
        things = [t for t in _low_near(a, b, survey) if t.id not in apart]
        things = [t for t in things if not kicked or (t.node is not None and not t.node.is_stepped_on)] or things
        told_text = f"{_told(things, survey)} on the way from {a.words} to {b.words}." if things else ""
        text = told_text[0].upper() + told_text[1:] if things else f"Nothing low lies between {a.words} and {b.words}."
        if yes_no:
            return Answer(answer="yes" if things else "no", answer_type="yesno", text=text, confidence=0.75,
                          evidence=Evidence(ids=tuple(t.id for t in things)))  # fmt: skip
        return _list(things, text, 0.75)

    return agreed([(name, case(a, b)) for name, a, b in ends.all_pairs(starts, goals)])


def _low_near(a: ends.Spot, b: ends.Spot, survey: Survey) -> list[Thing]:
    """Low things on the straight line between two ends, else along the walk."""
    low = [t for t in survey.things if t.node is not None and is_low(t.node) and not _is_tucked(t.node, survey)]
    first = [p for p in (_middle(s) for s in (a, b))]
    if all(p is not None for p in first):
        here, there = (np.array(p) for p in first)
        found = _along(low, [(here, there)])
        if found:
            return found
    way = route(survey.floor, a.end, b.end)
    if way is None:
        return []
    points = [np.array(p) for p in way.points]
    return _along(low, list(pairwise(points)))


def _middle(spot: ends.Spot) -> tuple[float, float] | None:
    if not spot.things:
        return None
    x, y, _ = spot.things[0].group.box.center
    return float(x), float(y)


def _along(things: Sequence[Thing], legs: Sequence[tuple[np.ndarray, np.ndarray]]) -> list[Thing]:
    found: list[tuple[float, Thing]] = []
    t = np.linspace(0, 1, 41)
    for k, (here, there) in enumerate(legs):
        x, y = here[0] + t * (there[0] - here[0]), here[1] + t * (there[1] - here[1])
        for thing in things:
            assert thing.node is not None
            gap = thing.node.yaw_box.distance_to(x, y)
            reach = 0.0 if thing.node.is_stepped_on else BESIDE
            if gap.min() <= reach and all(thing is not other for _, other in found):
                found.append((k + float(t[int(gap.argmin())]), thing))
    return [thing for _, thing in sorted(found, key=lambda f: f[0])]


def _blockers(thing: Thing, survey: Survey) -> tuple[list[Thing], bool]:
    """Things right before a door or another thing, and whether they keep people from it."""
    node, floor = thing.node, survey.floor
    if node is None:
        return [], False
    x, y, _ = floor.most_open()
    goal = to_point(floor, x, y)
    reached = is_open(floor, to_node(floor, node), goal, SHOULDERS)
    zone = node.yaw_box._replace(d=node.yaw_box.d + 2 * _BEFORE)
    door = node in floor.doors
    sill = 0.0 if door or node.bottom < GROUNDED else node.bottom
    before = [
        t for t in survey.things
        if t.node is not None and t.row != thing.row and t.node.top > max(STEP, sill + 0.1)
        and t.node.bottom < min(node.top, HEADROOM) and t.node.support not in ("ceiling", thing.id)
        and not _is_hung_flat(t.node) and _covers(t.node, zone) > 0.3
    ]  # fmt: skip
    if not reached and not before:
        before = [survey.thing(n.id) for n in in_the_way(floor, to_node(floor, node), goal)]
        before = [t for t in before if t.row != thing.row]
    return before, bool(before) or (not reached and node.support == "floor")


def _is_hung_flat(node: Node) -> bool:
    """Whether a thing hangs flat at a wall, as a curtain or a picture."""
    return node.support == "wall" and min(node.size[:2]) <= 0.2


def _covers(node: Node, zone: object) -> float:
    """Share of the zone's width that a thing stands before."""
    corners = node.yaw_box.corners()
    u, v = zone.local(corners[:, 0], corners[:, 1])  # type: ignore[attr-defined]
    half_w, half_d = zone.w / 2, zone.d / 2  # type: ignore[attr-defined]
    if v.min() > half_d - 0.05 or v.max() < -half_d + 0.05:
        return 0.0
    shared = min(float(u.max()), half_w) - max(float(u.min()), -half_w)
    return max(shared, 0.0) / max(2 * half_w, 1e-9)


def _blocked(asked: Asked, survey: Survey, wanted: bool) -> Answer:
    if "x" in asked.slots:
        try:
            things = meant(asked.slots["x"], survey)
        except NotResolved as error:
            return ends.absent(error, survey)
    else:
        things = tuple(survey.thing(d.id) for d in survey.floor.doors)
        if not things:
            return Answer(answer=None, answer_type="yesno", text="No door is known here.", source="none")

    def case(thing: Thing) -> Answer:
        before, blocked = _blockers(thing, survey)
        name = survey.named(thing)
        holds = blocked == wanted
        what = f"{listed([survey.named(t) for t in before])} right before {name}" if before else (
            f"nobody can walk up to {name}" if blocked else f"nothing stands right before {name}")  # fmt: skip
        return Answer(answer="yes" if holds else "no", answer_type="yesno", text=f"{'Yes' if holds else 'No'}: {what}.",
                      confidence=0.85, evidence=Evidence(ids=(*(t.id for t in before), thing.id)))  # fmt: skip

    return agreed([(survey.named(t), case(t)) for t in things])


def _what_blocks(asked: Asked, survey: Survey) -> Answer:
    def case(thing: Thing) -> Answer:
        before, _ = _blockers(thing, survey)
        name = survey.named(thing)
        text = (
            f"{listed([survey.named(t) for t in before])} right before {name}." if before else f"Nothing blocks {name}."
        )
        return _list(before, text[0].upper() + text[1:], 0.8)

    things = meant(asked.slots["x"], survey)
    return agreed([(survey.named(t), case(t)) for t in things])


def _narrowest(asked: Asked, survey: Survey) -> Answer:
    """The narrowest place that must be passed on the way from a door to something that stands on the floor."""
    unit = asked.slots.get("u", METRE)
    floor = survey.floor
    door = ends.entrances(survey)[0]
    goals = [n for n in floor.graph.nodes if n.support == "floor" and n.top > STEP and n not in floor.doors]
    found = [(passage(floor, door.end, to_node(floor, n)), n) for n in goals]
    found = [f for f in found if f[0] >= SHOULDERS - floor.cell]
    if not found:
        return Answer(
            answer=None, answer_type="metres", text="There is no way along which one could walk.", source="none"
        )
    width, goal = min(found, key=lambda f: f[0])
    thing = survey.thing(goal.id)
    way = route(floor, door.end, to_node(floor, goal), max(width - floor.cell / 2, 0.05))
    lines: tuple[Line, ...] = ()
    where = ""
    ids: tuple[int | str, ...] = (thing.id,)
    if way is not None:
        spot = _tightest(way.points, survey)
        near = floor.nearest_obstacles(*spot)[:2]
        ids = (*(n.id for _, n in near), thing.id)
        where = f", by {listed([survey.named(survey.thing(n.id)) for _, n in near])}"
        lines = (Line(start=(spot[0], spot[1], 0.02), end=(spot[0], spot[1], 0.02), label=f"{width:.2f} m"),)
    way_words = f"on the way from {door.words} to {survey.named(thing)}{where}"
    text = f"The narrowest passage is about {told(width, unit)} wide: {way_words}."
    return answer_of(width, unit, text, confidence=0.6, evidence=Evidence(ids=tuple(dict.fromkeys(ids)), lines=lines))


def _tightest(points: Sequence[tuple[float, float]], survey: Survey) -> tuple[float, float]:
    """The point of a way with the least clearance."""
    floor, best = survey.floor, (math.inf, points[0])
    for a, b in pairwise(points):
        for t in np.linspace(0, 1, 30):
            x, y = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
            i, j = int(np.abs(floor.xs - x).argmin()), int(np.abs(floor.ys - y).argmin())
            best = min(best, (float(floor.clear[i, j]), (float(x), float(y))))
    return best[1]


def _out_of_reach(survey: Survey, width: float) -> list[Thing]:
    """Things on the floor that a disc of this width cannot get to from any door."""
    doors = ends.entrances(survey)
    goals = [t for t in survey.things if t.node is not None and t.node.support == "floor" and t.node.top > STEP]
    return [t for t in goals if t.node is not None
            and not any(is_open(survey.floor, d.end, to_node(survey.floor, t.node), width) for d in doors)]  # fmt: skip


def _accessible(asked: Asked, survey: Survey) -> Answer:
    walker = asked.slots.get("w")
    width = walker.width if walker is not None else 0.8 if "wheelchair" in asked.text.lower() else SHOULDERS
    lost = _out_of_reach(survey, width)
    holds = not lost
    who = f"a disc of {width:.2f} m"
    text = (
        f"Yes: {who} can get from the door to everything on the floor." if holds
        else f"No: {who} cannot get to {listed([survey.named(t) for t in lost[:6]])}."
    )  # fmt: skip
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=0.75,
                  evidence=Evidence(ids=tuple(t.id for t in lost)))  # fmt: skip


def _unreachable(asked: Asked, survey: Survey) -> Answer:
    lost = _out_of_reach(survey, SHOULDERS)
    text = (
        f"{listed([survey.named(t) for t in lost])} cannot be reached on foot."
        if lost
        else "Everything can be reached."
    )
    return _list(lost, text[0].upper() + text[1:], 0.8)


def _turns(asked: Asked, survey: Survey) -> Answer:
    """Whether a circle of free floor is wide enough to turn in: 1.5 m for a wheelchair (ISO 21542)."""
    width = 1.5 if asked.slots["w"].width >= 0.7 else 2 * asked.slots["w"].width
    x, y, radius = survey.floor.most_open()
    holds = 2 * radius >= width
    needs = f"turning takes {width:.2f} m"
    text = f"{'Yes' if holds else 'No'}: the largest free circle is {2 * radius:.2f} m across, and {needs}."
    lines = (Line(start=(x - radius, y, 0.02), end=(x + radius, y, 0.02), label=f"{2 * radius:.2f} m"),)
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=0.85,
                  evidence=Evidence(lines=lines))  # fmt: skip


def _around(asked: Asked, survey: Survey) -> Answer:
    """Whether a person can walk once around a thing: its surroundings hold a closed walkable loop."""
    try:
        things = meant(asked.slots["x"], survey)
    except NotResolved as error:
        return ends.absent(error, survey)

    def case(thing: Thing) -> Answer:
        holds, stuck = _has_loop(thing, survey)
        name = survey.named(thing)
        if holds:
            text = f"Yes: there is a walkable way all around {name}."
        else:
            near = f": {listed([survey.named(t) for t in stuck])} in the way" if stuck else ": it stands at a wall"
            text = f"No: one cannot walk all around {name}{near}."
        return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=0.85,
                      evidence=Evidence(ids=(thing.id, *(t.id for t in stuck))))  # fmt: skip

    return agreed([(survey.named(t), case(t)) for t in things])


def _has_loop(thing: Thing, survey: Survey) -> tuple[bool, list[Thing]]:
    """Whether the things around a thing form an island apart from all walls; else what links it to a wall."""
    from scipy import ndimage

    floor = survey.floor
    blocked = np.pad(~floor.walkable(), 1, constant_values=True)
    islands, _ = ndimage.label(blocked)  # 4-neighbours, since people walk diagonally between cells
    x, y, _ = thing.group.box.center
    i, j = int(np.abs(floor.xs - x).argmin()) + 1, int(np.abs(floor.ys - y).argmin()) + 1
    island = int(islands[i, j])
    if island != islands[0, 0] and island:
        return True, []
    near = [
        t
        for t in survey.things
        if t.node is not None and t.row != thing.row and is_obstacle(t.node)
        and t.node.support not in (thing.id, "wall") and survey.gap(t, thing) < SHOULDERS
    ]  # fmt: skip
    return False, near[:4]


KINDS = (
    Kind("hazards on the way", templates(_WHAT_WAY), _on_the_way),
    Kind("trip hazards", templates(_WHAT), _what),
    Kind("is there a trip hazard", templates(_ANY), _any),
    Kind("is it a trip hazard", templates(_ONE), _one),
    Kind("is it blocked", templates(_BLOCKED), lambda asked, survey: _blocked(asked, survey, wanted=True)),
    Kind("is it unblocked", templates(_FREE), lambda asked, survey: _blocked(asked, survey, wanted=False)),
    Kind("what blocks it", templates(_WHAT_BLOCKS), _what_blocks),
    Kind("narrowest passage", templates(_NARROWEST), _narrowest),
    Kind("can turn", templates(_TURN), _turns),
    Kind("all can be reached", templates(_ACCESSIBLE + _EVERYTHING), _accessible),
    Kind("what cannot be reached", templates(_UNREACHABLE), _unreachable),
    Kind("way around", templates(_AROUND), _around),
)
