"""How much floor is free or covered, where the most open place is, and whether the room is crowded."""

from __future__ import annotations

from ....gaussians.world.box import YawBox, plan_penetration
from ..answer import Answer, Evidence, Line
from ..candidates import agreed, meant
from ..floor import ends
from ..floor.floor_map import covers_floor
from ..kind import Asked, Kind
from ..reading.phrase_templates import templates
from ..reading.spans import SQUARE, answer_of, told
from ..survey import Survey, Thing, listed

_CORNER = 0.5  # metres along both walls that are free in a free corner
CROWDED, SPACIOUS = 0.45, 0.3  # shares of covered floor from which a room is called crowded, and up to which spacious

_A = "[in {a:area_unit}|measured in {a:area_unit}]"
_FREE = (
    "(free|empty|open|clear|unoccupied|uncovered|available|unused|vacant|bare|usable|walkable|left over|left|"
    "left free|not taken up|not covered|not occupied|still free|spare)"
)
_TAKEN = "(covered|taken|taken up|occupied|used|used up|blocked|full|filled|in use|not free|covered up)"
_BY = (
    "[by (furniture|things|objects|stuff|the furniture|anything|any furniture|all the furniture|the things in "
    "it|something)|with (furniture|things|objects|stuff)]"
)
_ACTUALLY = "[actually|still|really|currently]"
_THAT = (
    "[that is|i e|ie|meaning|so|in other words|that is to say] [not (taken up|covered|occupied|taken|used) by "
    "(furniture|things|anything|objects|any furniture|the furniture|something)|without (furniture|things) on "
    "it|with nothing on it]"
)
_IN = (
    "[on the floor|in the room|in here|here|in total|altogether|overall|left|left over|available|between the furniture|"
    "around the furniture]"
)

_HOW_FREE = f"""
    how much {_FREE} (floor|floor space|floor area|space|ground|area|room|floor surface) (is there|is left|do we \
      have|does the room have|remains|is available|do i have|is there left|are there|has the room|have we got|is in \
      the room|is in here) {_IN} {_A}
    how much {_FREE} (floor|floor space|floor area|space) {_IN} {_A}
    how much (floor|floor space|floor area|of the floor area|of the floor space) (is|remains|stays|does|would be) \
      {_ACTUALLY} {_FREE} {_BY} {_IN} {_THAT} {_A}
    how much (space|room|floor space) is (there|left) (on the floor|to walk around|to walk|for walking|to move \
      around|to move) {_IN} {_A}
    how many {{a:area_unit}} [of] [the] (floor|floor space|floor area|space|room) (is|are|remain|remains|would \
      be) {_ACTUALLY} {_FREE} {_BY} {_IN} {_THAT}
    how many {{a:area_unit}} of {_FREE} (floor|floor space|floor area|space) (is|are) (there|left) {_IN} {_THAT}
    how many {{a:area_unit}} (is|are) {_ACTUALLY} {_FREE} {_BY} {_IN} {_THAT}
    how many {{a:area_unit}} (of|of the) (floor|floor space) have nothing (on them|standing on them|on it)
    (what|how big|how large) BE the {_FREE} (floor area|floor space|floor|area|space) {_IN} {_THAT} {_A}
    (what|how big|how large) BE the (area|size|amount) of [the] {_FREE} (floor|floor space|floor area) {_IN} {_A}
    [the] amount of {_FREE} (floor|floor space|floor area) {_IN} {_A}
    {_FREE} floor (space|area) {_A}
"""
_HOW_TAKEN = f"""
    how much (floor|floor space|floor area|of the floor area|of the floor space|space on the floor) \
      (is|does|do|would be) {_ACTUALLY} {_TAKEN} {_BY} {_IN} {_A}
    how many {{a:area_unit}} [of] [the] (floor|floor space|floor area) (is|are) {_ACTUALLY} {_TAKEN} {_BY} {_IN}
    how much (floor|floor space|floor area|space|room) (do|does) (the furniture|all the furniture|the \
      things|everything|all the things|all the furniture together) (take up|cover|occupy|use|need|take) {_IN} {_A}
    how many {{a:area_unit}} (do|does) (the furniture|all the furniture|everything|all the things) (take \
      up|cover|occupy|use|take) {_IN}
    (what|how big|how large) BE the [total] (covered|occupied) (floor area|floor|floor space|area) {_IN} {_A}
"""
_SHARE_FREE = f"""
    how much of the (floor|room) (can|could) (i|one|you|we|people) {_ACTUALLY} (walk on|walk|step on|use|stand on)
    (what|how big|how large) [is the] (share|percentage|fraction|proportion|percent|part|portion|amount|%) of the \
      (floor|room|floor space|floor area|space) (is|remains|would be|are) {_ACTUALLY} {_FREE} {_BY}
    how much of the (floor|room|space) (is|remains|are|would be) {_ACTUALLY} {_FREE} {_BY} {_THAT} [in percent|as \
      a percentage]
    how much of the (floor|room) (has|have) nothing (on it|standing on it)
    how (free|empty|open|clear) BE the floor [in percent|as a percentage]
    what percentage of the (floor|room) (is|can|could) (one|you|i|be) (walk on|walked on)
    [the] (share|percentage|fraction|proportion) of {_FREE} floor [space|area]
    what is the (share|percentage|fraction|proportion) of {_FREE} floor [space|area]
"""
_SHARE_TAKEN = f"""
    (what|how big|how large) [is the] (share|percentage|fraction|proportion|percent|part|portion|%) of the \
      (floor|room|floor space|floor area|space) (is|are|does|do|has|would be) {_ACTUALLY} {_TAKEN} {_BY}
    (what|which) (share|percentage|fraction|proportion|percent|part|portion|%) of the (floor|room|floor \
      space|floor area) (is|does|do) (the furniture|furniture|everything) (cover|take up|occupy|covering|taking \
      up|occupying)
    how much of the (floor|room|space) (is|are) {_ACTUALLY} {_TAKEN} {_BY} [in percent|as a percentage]
    how much of the (floor|room) (does|do) (the furniture|furniture|things|everything|the things) (cover|take \
      up|occupy|take)
    how (covered|full|crowded|cluttered|packed|busy) BE the (floor|room) [in percent|as a percentage]
"""
_MORE_FREE = f"""
    BE [at least|about] half [of] the floor {_FREE} {_BY}
    BE [there] (more than|over|at least) (half|50 %|50 percent) [of] the floor {_FREE} {_BY}
    BE most of the (floor|floor space|room) {_FREE} {_BY}
    BE the floor (mostly|mainly|largely) {_FREE} {_BY}
    BE the room (mostly|mainly|largely) empty
    BE (more|there more) {_FREE} floor than covered [floor]
    BE the majority of the floor {_FREE}
"""
_MORE_TAKEN = f"""
    BE [at least|about] half [of] the floor {_TAKEN} {_BY}
    BE (more than|over|at least) (half|50 %|50 percent) [of] the floor {_TAKEN} {_BY}
    BE most of the (floor|floor space|room) {_TAKEN} {_BY}
    BE the floor (mostly|mainly|largely) {_TAKEN} {_BY}
    (does|do) (the furniture|furniture|things) (cover|take up|occupy) (more than half|most|over half) of the floor
"""
_AT_LEAST = f"""
    BE there (more than|over|at least) {{q:area}} [of] {_FREE} (floor|floor space|space|floor area) {_IN}
    BE there (more than|over|at least) {{q:area}} of (floor|floor space|space) {_FREE} {_IN}
    BE (more than|over|at least) {{q:area}} [of the floor|of floor|of floor space] {_FREE} {_BY} {_IN}
    do we have (more than|over|at least) {{q:area}} [of] {_FREE} (floor|floor space|space)
"""
_WHERE = f"""
    where (is|would) [there] [be] the most (room|space) [to (move|walk|dance|play|move about|move around|walk \
      around)] {_IN}
    where (do|would|can) (i|you|we|one) have the most (room|space) [to (move|walk|dance|play|move about|move \
      around)] {_IN}
    where (is|can i find|is there|would be|do i find|do we have|are|lies) [the|there] \
      (most|largest|biggest|greatest|widest|more|the most) {_FREE} (space|area|floor|floor space|spot|place|floor \
      area|patch|patch of floor|region|part|room) {_IN} [of the room|on the floor|of floor]
    where (is|are|would be|lies) the {_FREE} (space|area|floor|floor space|spot) {_IN} [on the floor]
    where (is|are) there [any|some|a lot of|still|a] {_FREE} (space|area|floor|floor space|spot|room) {_IN} [on \
      the floor]
    where is the (most|biggest|largest) (space|room|gap) {_IN} [on the floor|to move|to walk|to play|to dance]
    where (is|are) the (emptiest|most open|clearest|least crowded|most spacious|most empty) \
      (part|spot|area|place|corner|bit|region|side) [of the room|on the floor] {_IN}
    (which|what) (part|spot|area|place|region|bit) of the (room|floor) is [the] (emptiest|most \
      open|clearest|least crowded|most spacious|most empty|most free|freest)
    where is the room [the] (emptiest|most open|most spacious|least crowded)
    where on the floor is (there the most space|the most space|the most room|most room)
    (which|what) part of the room has [the] most {_FREE} (space|floor|floor space)
    what is the (largest|biggest) {_FREE} (area|space|spot|patch|floor area|floor space) [of floor|on the \
      floor|in the room]
    how (big|large|wide) is the (largest|biggest|widest) {_FREE} (area|space|spot|patch|floor area|floor space) \
      [of floor|on the floor] {_IN}
"""
_SIDE = """
    (which|what) (side|half) of the room is (emptier|more open|less crowded|less full|more free|freer|the emptier \
      one|less cluttered|more spacious) [(left or right|the left or the right|the left one or the right one)]
    (which|what) (side|half) of the room has more (free space|free floor|space|empty space|floor space|free floor \
      space) [(left or right|the left or the right)]
    is (there more|more) (free|empty|open) (space|floor|floor space) on the left or [on] the right [side] [of the \
      room]
"""
_FULLER = """
    (which|what) (side|half) of the room is (fuller|more crowded|more cluttered|more full|busier|more \
      furnished|the fuller one) [(left or right|the left or the right)]
    (which|what) (side|half) of the room has more (furniture|things|stuff|furniture in it|in it) [(left or \
      right|the left or the right)]
    is (there more|more) (furniture|stuff) on the left or [on] the right [side] [of the room]
"""
_CROWDED = """
    BE (the room|it|this room|it in here) [very|rather|quite|too|really|pretty|a bit|so] \
      (crowded|cluttered|cramped|packed|overfurnished|overcrowded|full|stuffed|tight|crammed|full of \
      furniture|densely furnished|jam packed) [in here|in the room|here] [with (furniture|stuff|things)]
    (does|would) the room [look|seem|appear|feel] [very|rather|quite|too|really|pretty] \
      (crowded|cluttered|cramped|packed|full)
    BE there [too much|a lot of] (furniture|clutter|stuff) [in the room|in here|here]
    BE (the floor|the floor space) [very|rather|quite|too] (crowded|cluttered|packed)
"""
_SPACIOUS = """
    BE it easy to (walk|move|get) (around|about) [in here|in the room|here]
    BE (the room|it|this room|it in here) [very|rather|quite|really|pretty] \
      (spacious|roomy|empty|uncluttered|sparse|sparsely furnished|airy|uncrowded|open) [in here|here]
    BE there [a lot of|lots of|plenty of|much|enough] (free|open|empty) (space|floor|floor space) [in the room|in \
      here|here]
    BE there (a lot of|lots of|plenty of|much|enough) (space|room|floor space) to (walk|walk around|move|move \
      around|move about|walk about) [in the room|in here|here]
    (can|could) (one|you|i|we|people) (walk|move) around (freely|easily|comfortably) [in the room|in here|here]
"""
_FREE_CORNERS = """
    (which|what) (corner|corners) [of the room] (is|are) (empty|free|unoccupied|not used|unused|clear)
    (which|what) (corner|corners) [of the room] (has|have) nothing (in it|in them|standing in it)
    (list|name) the (empty|free) corners
"""
_ANY_CORNER = """
    (is|are) (any|one|some) (corner|corners) [of the room] (empty|free|unoccupied|not used|unused|clear)
    (is|are) there (a|an|any|some) (empty|free|unoccupied|unused|clear) (corner|corners) [in the room|here|in here]
    (is|are) there (a|any) (corner|corners) (without anything in it|that is empty|that is free|with nothing in \
      it) [in the room]
    (do|does) (we|the room) have (a|an|any) (empty|free) (corner|corners)
"""
_ONE = """
    how much (floor|floor space|floor area|space on the floor|ground|of the floor|of the floor \
      space|space|area|room) (does|do|would) {x} (take up|take|cover|occupy|use|need|fill) [in the room|on the \
      floor|of the floor] [in {a:area_unit}]
    how many {a:area_unit} [of floor|of the floor|of floor space] (does|do|would) {x} (take \
      up|take|cover|occupy|use|fill) [in the room|on the floor]
    (what|how big|how large) (is|are) the (footprint|floor area|base area|ground area) of {x} [in {a:area_unit}]
    (what|how big|how large) (is|are) {x} 's (footprint|base area) [in {a:area_unit}]
"""
_ONE_SHARE = """
    (what|which) (share|percentage|fraction|proportion|percent|part) of the (floor|room|floor space|floor area) \
      (does|do) {x} (take up|take|cover|occupy|use|fill)
    (what|which) (share|percentage|fraction|proportion|percent|part) of the (floor|room|floor space|floor area) \
      (is|are) (covered|taken up|occupied|taken) by {x}
    how much of the (floor|room|floor space) is (covered|taken up|occupied|taken) by {x}
"""


def _amount(asked: Asked, survey: Survey, free: bool) -> Answer:
    floor, unit = survey.floor, asked.slots.get("a", SQUARE)
    value = floor.free if free else floor.covered
    text = (
        f"{told(floor.free, unit)} of the {told(floor.area, unit)} of floor are free; "
        f"things stand on the other {told(floor.covered, unit)}. Rugs count as free floor."
    )
    return answer_of(value, unit, text, confidence=0.9, evidence=Evidence(ids=_standing(survey)))


def _share(asked: Asked, survey: Survey, free: bool) -> Answer:
    floor = survey.floor
    value = 100 * (floor.free if free else floor.covered) / max(floor.area, 1e-9)
    text = (
        f"{value:.0f} % of the floor {'is free' if free else 'is covered'}: {floor.free:.1f} of {floor.area:.1f} m2 "
        f"are free. Rugs count as free floor."
    )
    return Answer(answer=round(value, 1), answer_type="number", text=text, confidence=0.9, unit="%",
                  evidence=Evidence(ids=_standing(survey)))  # fmt: skip


def _standing(survey: Survey) -> tuple[int | str, ...]:
    nodes = sorted(filter(covers_floor, survey.graph.nodes), key=lambda n: -n.size[0] * n.size[1])
    return tuple(n.id for n in nodes)


def _mostly(asked: Asked, survey: Survey, free: bool) -> Answer:
    floor = survey.floor
    share = (floor.free if free else floor.covered) / max(floor.area, 1e-9)
    bound = asked.slots["q"] / max(floor.area, 1e-9) if "q" in asked.slots else 0.5
    holds = share >= bound
    part = 100 * floor.free / max(floor.area, 1e-9)
    text = f"{'Yes' if holds else 'No'}: {floor.free:.1f} of {floor.area:.1f} m2 of floor are free ({part:.0f} %)."
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text,
                  confidence=0.95 if abs(share - bound) > 0.05 else 0.6)  # fmt: skip


def _where(asked: Asked, survey: Survey) -> Answer:
    x, y, radius = survey.floor.most_open()
    place = ends.place_words(x, y, survey)
    near = survey.floor.nearest_obstacles(x, y)[:3]
    around = [survey.thing(n.id) for d, n in near if d <= radius + 0.6]
    between = f", near {listed([survey.named(t) for t in around[:2]])}" if around else ""
    text = f"The most open floor is {place}{between}: a circle of {2 * radius:.1f} m across is free there."
    lines = (Line(start=(x - radius, y, 0.02), end=(x + radius, y, 0.02), label=f"{2 * radius:.2f} m"),)
    return Answer(answer=f"{place}{between}", answer_type="text", text=text, confidence=0.8, frame="viewer",
                  evidence=Evidence(ids=tuple(t.id for t in around), lines=lines))  # fmt: skip


def _halves(survey: Survey) -> tuple[float, float]:
    """Floor covered by things on the left and on the right half, m2."""
    right = survey.stand.right
    sides = [0.0, 0.0]
    for node in filter(covers_floor, survey.graph.nodes):
        corners = node.yaw_box.corners() @ right[:2]
        low, high = float(corners.min()), float(corners.max())
        share = min(max(high, 0.0), high - low if low > 0 else high) / max(high - low, 1e-9) if high > 0 else 0.0
        share = 1.0 if low >= 0 else share
        area = node.size[0] * node.size[1]
        sides[0] += (1 - share) * area
        sides[1] += share * area
    return sides[0], sides[1]


def _side(asked: Asked, survey: Survey, fuller: bool) -> Answer:
    left, right = _halves(survey)
    name = "left" if (left > right) == fuller else "right"
    text = f"The {name} half: things cover {left:.1f} m2 on the left and {right:.1f} m2 on the right."
    sure = 0.9 if abs(left - right) > 0.15 * max(left, right, 1e-9) else 0.55
    return Answer(answer=name, answer_type="label", text=text, confidence=sure, frame="viewer")


def _crowded(asked: Asked, survey: Survey, crowded: bool) -> Answer:
    floor = survey.floor
    share = floor.covered / max(floor.area, 1e-9)
    holds = share >= CROWDED if crowded else share <= SPACIOUS
    text = (
        f"{'Yes' if holds else 'No'}, going by the floor: things stand on {100 * share:.0f} % of it, and "
        f"{floor.free:.1f} m2 are free."
    )
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=0.6,
                  evidence=Evidence(ids=_standing(survey)))  # fmt: skip


def _free_corners(survey: Survey) -> list[str]:
    """Names of the corners in which half a metre square of floor is free."""
    width, depth, _ = survey.graph.room.size
    half = min(_CORNER, width / 2, depth / 2) / 2
    found = []
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        box = YawBox(x * (width / 2 - half), y * (depth / 2 - half), 0.0, 2 * half, 2 * half, 0.5)
        taken = any(plan_penetration(box, n.yaw_box) > 0.02 for n in filter(covers_floor, survey.graph.nodes))
        if not taken:
            side = survey.stand.right[:2] @ (x * width, y * depth)
            ahead = survey.stand.forward[:2] @ (x * width, y * depth)
            found.append(f"{'back' if ahead > 0 else 'front'} {'right' if side > 0 else 'left'}")
    return sorted(found)


def _corners(asked: Asked, survey: Survey) -> Answer:
    names = [f"{name} corner" for name in _free_corners(survey)]
    text = f"Nothing stands in {listed([f'the {n}' for n in names])}." if names else "Something stands in every corner."
    if len(names) == 1:
        return Answer(answer=names[0], answer_type="label", text=text, confidence=0.85, frame="viewer")
    return Answer(answer=tuple(names), answer_type="list", text=text, confidence=0.85, frame="viewer")


def _any_corner(asked: Asked, survey: Survey) -> Answer:
    given = _corners(asked, survey)
    value = "yes" if given.answer else "no"
    return Answer(answer=value, answer_type="yesno", text=f"{value.capitalize()}. {given.text}", confidence=0.85,
                  frame="viewer")  # fmt: skip


def _one(asked: Asked, survey: Survey, share: bool) -> Answer:
    """The footprint of a thing, in square metres or as a share of the floor."""
    things = meant(asked.slots["x"], survey)
    if any(t.node is None for t in things):
        return Answer(answer=None, answer_type="number", text="Only things have a footprint.", source="none")
    return agreed([(survey.named(t), _footprint(t, asked, survey, share)) for t in things])


def _footprint(thing: Thing, asked: Asked, survey: Survey, share: bool) -> Answer:
    assert thing.node is not None
    width, depth, _ = thing.node.size
    evidence = Evidence(ids=(thing.id,))
    if share:
        value = 100 * width * depth / max(survey.floor.area, 1e-9)
        text = f"{survey.named(thing).capitalize()} takes up {value:.0f} % of the floor ({width * depth:.2f} m2)."
        return Answer(
            answer=round(value, 1), answer_type="number", text=text, unit="%", confidence=0.9, evidence=evidence
        )
    unit = asked.slots.get("a", SQUARE)
    text = (
        f"{survey.named(thing).capitalize()} is {width:.2f} m by {depth:.2f} m, {told(width * depth, unit)} of floor."
    )
    return answer_of(width * depth, unit, text, confidence=0.9, evidence=evidence)


KINDS = (
    Kind("free floor", templates(_HOW_FREE), lambda asked, survey: _amount(asked, survey, free=True)),
    Kind("covered floor", templates(_HOW_TAKEN), lambda asked, survey: _amount(asked, survey, free=False)),
    Kind("share of free floor", templates(_SHARE_FREE), lambda asked, survey: _share(asked, survey, free=True)),
    Kind("share of covered floor", templates(_SHARE_TAKEN), lambda asked, survey: _share(asked, survey, free=False)),
    Kind(
        "floor is mostly free",
        templates(_MORE_FREE + _AT_LEAST),
        lambda asked, survey: _mostly(asked, survey, free=True),
    ),
    Kind("floor is mostly covered", templates(_MORE_TAKEN), lambda asked, survey: _mostly(asked, survey, free=False)),
    Kind("most open floor", templates(_WHERE), _where),
    Kind("emptier side", templates(_SIDE), lambda asked, survey: _side(asked, survey, fuller=False)),
    Kind("fuller side", templates(_FULLER), lambda asked, survey: _side(asked, survey, fuller=True)),
    Kind("room is crowded", templates(_CROWDED), lambda asked, survey: _crowded(asked, survey, crowded=True)),
    Kind("room is spacious", templates(_SPACIOUS), lambda asked, survey: _crowded(asked, survey, crowded=False)),
    Kind("free corners", templates(_FREE_CORNERS), _corners),
    Kind("is a corner free", templates(_ANY_CORNER), _any_corner),
    Kind("floor under a thing", templates(_ONE), lambda asked, survey: _one(asked, survey, share=False)),
    Kind("share of floor under a thing", templates(_ONE_SHARE), lambda asked, survey: _one(asked, survey, share=True)),
)
