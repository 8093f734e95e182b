"""Whether something of a given size would fit somewhere: between things, at a wall, on a table, through the door."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....gaussians.world.box import YawBox
from ....gaussians.world.person import SHOULDERS, STEP
from ....gaussians.world.words import singular
from ..answer import Answer, Evidence, Line
from ..candidates import agreed, meant
from ..floor import ends
from ..floor.regions import Region, Undecidable, alternatives
from ..floor.spaces import SLACK, largest, place
from ..kind import Asked, Kind
from ..reading.ends import WIDTHS, Walker
from ..reading.item import Item
from ..reading.phrase_templates import templates
from ..reading.spans import METRE, answer_of, told
from ..reading.where_to import Where
from ..survey import NotResolved, Survey, Thing, listed

_DOOR_ZONE = 0.5  # metres before a door that stay free
_UNKNOWN = (0.6, 0.4, 0.75)  # width, depth and height that are assumed of a thing of no known kind
_MOST_READINGS = 12
_LONG = {"wheelchair": 1.2, "pram": 1.0, "stroller": 1.0, "buggy": 1.0, "pushchair": 1.0}  # metres from front to back

_STILL = "[still|also|even|actually|possibly|comfortably|easily|theoretically|physically|properly|nicely|perhaps|all]"
_MODAL = "(would|will|could|can|does|do|should|might|may|did)"
_WHO = "(i|we|you|one|someone|somebody|they|people|anyone)"
_FIT = (
    "(fit|fit in|go|go in|stand|sit|be placed|be put|be squeezed|be squeezed in|have room|have space|have enough room|"
    "have enough space|find room|find space|find a place|squeeze|squeeze in|slot|slot in|slide|be positioned|"
    "be set|be set up|"
    "be stood|be fitted|be fitted in|be accommodated|lie|be added|be laid|be laid out|be installed|be parked|"
    "be moved|be slid|"
    "be hung|hang|be pushed|be rolled out|be unrolled)"
)
_PUT = (
    "(fit|fit in|put|place|squeeze|squeeze in|get|get in|add|park|set|set up|stand|slot|slot in|slide|"
    "install|roll out|lay|"
    "lay out|lay down|position|wedge|wedge in|shove|hang|store|accommodate|stick|tuck|move|unroll|"
    "insert|keep|push|"
    "make room for|find room for|find space for|find a place for|find a spot for|find a space for|fit "
    "another|use|arrange)"
)
_END = (
    "[without (moving|shifting|rearranging|touching|removing|having to move|having to shift|changing|blocking) "
    "(anything|any furniture|any of the furniture|the furniture|things|other things|anything else|something|"
    "the door|any door|"
    "everything|stuff|any of it|anything away)|if i (do not|did not) (move|shift) (anything|any furniture|"
    "the furniture|furniture|"
    "things)|as (it is|things are|it stands)|with everything where it is|if nothing is moved|as well|too|"
    "somehow|standing up|"
    "lengthwise|upright|if i wanted|for example|without problems|comfortably|easily]"
)
_ENOUGH = (
    "[still|also] [enough|sufficient|any|some|still] [free|floor|empty|spare|open] (room|space|place|a spot|a "
    "place|a space|spot|spots|places|floor|a gap) [left|left over|available|free]"
)
_FOR = (
    "(for|to put|to fit|to place|to stand|to lay|to lay down|to add|to have|to set up|to park|to squeeze in|"
    "to roll out|to unroll|"
    "to install|to fit in|to store|to position|to put in|to spread out|to hang|to get)"
)
_GAP = "the (gap|space|room|distance|spot|place|opening|area|niche|stretch)"

_FITS = f"""
    {_MODAL} {{i:item}} {_STILL} {_FIT} {_END}
    {_MODAL} {{i:item}} {_STILL} {_FIT} {{p:where_to}} {_END}
    {_MODAL} {_WHO} {_STILL} {_PUT} {{i:item}} {_END}
    {_MODAL} {_WHO} {_STILL} {_PUT} {{i:item}} {{p:where_to}} {_END}
    (would|will|could|can|should|might|may) {_WHO} {_STILL} have {{i:item}} [{{p:where_to}}] {_END}
    {_MODAL} {{p:where_to}} {_STILL} (fit|hold|take|accommodate|have room for) {{i:item}} {_END}
    (is|are|was|would|will) there [be] {_ENOUGH} {_FOR} {{i:item}} {_END}
    (is|are|was|would|will) there [be] {_ENOUGH} {_FOR} {{i:item}} {{p:where_to}} {_END}
    (is|are|was|would|will) there [be] {_ENOUGH} {{p:where_to}} {_FOR} {{i:item}} {_END}
    (do|would|will) {_WHO} have {_ENOUGH} {_FOR} {{i:item}} {_END}
    (do|would|will) {_WHO} have {_ENOUGH} {_FOR} {{i:item}} {{p:where_to}} {_END}
    (do|would|will) {_WHO} have {_ENOUGH} {{p:where_to}} {_FOR} {{i:item}} {_END}
    (does|do|would|will|has) (the room|it|this place) have {_ENOUGH} {_FOR} {{i:item}} [{{p:where_to}}] {_END}
    [whether] {{i:item}} (would|will|could|can|might|does|do|fits|goes) {_STILL} [{_FIT}] {{p:where_to}} {_END}
    [whether] {{i:item}} (would|will|could|can|might) {_STILL} {_FIT} {_END}
    BE {_GAP} {{p:where_to}} (big|wide|large|deep|long|spacious|tall|high|sufficient|roomy) [enough] for \
      {{i:item}} {_END}
    BE (the room|it|this room) (big|wide|large|spacious|roomy) enough for {{i:item}} {_END}
    BE it possible [for {_WHO}] to {_STILL} {_PUT} {{i:item}} {_END}
    BE it possible [for {_WHO}] to {_STILL} {_PUT} {{i:item}} {{p:where_to}} {_END}
    (would|will) it be possible [for {_WHO}] to {_STILL} {_PUT} {{i:item}} [{{p:where_to}}] {_END}
    i (would like|want|plan|am planning|am hoping|hope|need|intend) to {_PUT} {{i:item}} [{{p:where_to}}] \
    [is there|would there be|do i have] (any|a|enough|some) [suitable|free|good] (spot|place|room|space|corner) \
      (for that|for it|for this|to do that|there) {_END}
    i (would like|want|plan|am planning|am hoping|hope|need|intend) to {_PUT} {{i:item}} [{{p:where_to}}] \
    (is|would) there [be] (any|a|enough|some) [suitable|free|good] (spot|place|room|space) (for that|for it|for \
      this|to do that) {_END}
    i (would like|want|plan|am planning|am hoping|hope|need|intend) to {_PUT} {{i:item}} {{p:where_to}} \
        (would|will|does|could) (it|that|this) {_STILL} (fit|work|go|go there|fit there|be possible) {_END}
    i (have|have got|own|bought|am buying|am thinking of buying|am getting) {{i:item}} \
        (would|will|does|could|can) (it|that|this|one) {_STILL} {_FIT} [{{p:where_to}}] {_END}
"""
_DOES = f"""
    (is|are|was|would|will) there [be] {_ENOUGH} (to|for {_WHO} to|for me to) {{t:activity}} [{{p:where_to}}] {_END}
    (is|are|was|would|will) there [be] {_ENOUGH} {{p:where_to}} (to|for {_WHO} to|for me to|for) {{t:activity}} {_END}
    (is|are|was|would|will) there [be] {_ENOUGH} for {{t:activity}} [{{p:where_to}}] {_END}
    (do|would|will) {_WHO} have {_ENOUGH} (to|for) {{t:activity}} [{{p:where_to}}] {_END}
    (do|would|will) {_WHO} have {_ENOUGH} {{p:where_to}} (to|for) {{t:activity}} {_END}
    (can|could) {_WHO} {_STILL} {{t:activity}} {{p:where_to}} {_END}
    BE {_GAP} {{p:where_to}} (big|wide|large|long) enough (to|for) {{t:activity}} {_END}
    BE (the room|it|this room) (big|large|spacious) enough (to|for) {{t:activity}} {_END}
    BE it possible [for {_WHO}] to {{t:activity}} {{p:where_to}} {_END}
"""
_TALL = f"""
    BE the (ceiling|room|ceilings) (high|tall) enough (for|to fit|to have|to stand|to put up|to set up) \
      {{i:item}} [in] {_END}
    BE the (ceiling|room|ceilings) (high|tall) enough (for|to fit) (someone|somebody|a person|a man|a woman) \
      [who is|of] \
      {{l:span}} [tall|high] {_END}
    (would|will|could|can) (someone|somebody|a person|a man) [who is|of] {{l:span}} [tall] (stand|stand \
      up|stand upright|\
      fit) [in here|in the room|here]
"""
_BETWEEN = f"""
    {_MODAL} {{w:walker}} {_STILL} (walk|squeeze|pass|get|go|fit|squeeze through|pass through|step|slip|walk \
      through) [in] \
      between {{a}} and {{b}} {_END}
    BE {_GAP} between {{a}} and {{b}} (wide|big|large) enough (to walk|to walk through|to pass|to pass \
      through|to squeeze \
    through|to get through|for {{w:walker}}|for {{w:walker}} to (walk|walk through|pass|pass through|get \
      through)) {_END}
    BE there {_ENOUGH} (to|for {{w:walker}} to) (walk|pass|squeeze|get|go|walk through|pass through) [through] \
      between {{a}} and {{b}}
    BE there {_ENOUGH} between {{a}} and {{b}} (to|for {{w:walker}} to) (walk|pass|squeeze|get|go) [through]
    BE there {_ENOUGH} between {{a}} and {{b}} for {{w:walker}}
    {_MODAL} two people {_STILL} (walk|pass|go) [side by side|next to each other|abreast] between {{a}} and {{b}}
"""
_GAP_OF = """
    (is|would) there [be] (a gap|a space|space|room|a distance|a passage) of (at least|more than|over|about) {l:span} \
      between {a} and {b}
    (is|would) there [be] (at least|more than|over) {l:span} [of (space|room|floor)] between {a} and {b}
"""
_THROUGH = f"""
    {_MODAL} {{i:item}} {_STILL} (fit|go|get|pass|come|squeeze|slide|be carried|be moved|be brought|be \
      taken|make it) [in|out|right|straight] through {{x}} {_END}
    {_MODAL} {_WHO} {_STILL} (get|carry|bring|move|fit|take|push|squeeze|roll|pass|slide) {{i:item}} \
      [in|out|right|straight] through {{x}} {_END}
    BE {{x}} (wide|big|large|high|tall) enough (for|to get|to carry|to bring|to move|to fit|to take) {{i:item}} \
      [through|in|out|through it|to pass|to pass through|to go through|to get through|to fit through] {_END}
    BE it possible [for {_WHO}] to (get|carry|bring|move|fit|take|push) {{i:item}} [in|out] through {{x}}
"""
_WHERE = f"""
    where (could|can|would|should|might) {_WHO} {_STILL} {_PUT} {{i:item}} {_END}
    where (could|can|would|should|might) {_WHO} {_STILL} {_PUT} {{i:item}} {{p:where_to}} {_END}
    where (could|can|would|will|should|does|might) {{i:item}} {_STILL} {_FIT} {_END}
    where (is|would|are) there [be] {_ENOUGH} {_FOR} {{i:item}} {_END}
"""
_HOW_WIDE = f"""
    how (wide|long|big|large) (a|of a|an|may a|can a|could a) {{k:item}} (could|would|can|will|might|may) [{_WHO}] \
      {_STILL} [{_PUT}|{_FIT}] {{p:where_to}} [in {{u:length_unit}}]
    how (wide|long) (can|could|may) {{i:item}} be to {_FIT} {{p:where_to}} [in {{u:length_unit}}]
    (what|how wide) is the (widest|longest|largest|biggest) {{k:item}} (that|which|i|we|one) \
      (could|would|can|will|might) [i|we|one] {_STILL} ({_PUT}|{_FIT}) {{p:where_to}} [in {{u:length_unit}}]
"""


@dataclass(frozen=True)
class _Size:
    """The size of what is to be placed.

    Attributes:
        width, depth, height: metres.
        low, high: factors of the smallest and largest width and depth as sold, where none is stated; else 1.
        words: as told: "a table of 2.00 x 1.00 m".
        facing: whether its width runs along a wall.
        own: the thing itself if it is there already.
        backed: whether its back belongs against a wall.
    """

    width: float
    depth: float
    height: float
    low: float
    high: float
    words: str
    facing: bool = False
    own: Thing | None = None
    backed: bool = False

    def scaled(self, factor: float) -> tuple[float, float, float]:
        return self.width * factor, self.depth * factor, self.height


# -- sizes -------------------------------------------------------------------------------------------------------------


def _sizes(item: Item, survey: Survey) -> list[_Size]:
    """The size of an item: stated, of the thing itself, or of its kind as sold; one for each thing that may be meant.

    Raises:
        Undecidable: nothing tells its size, or it is a part of the room.
        NotResolved: "it" refers to nothing.
    """
    if item.definite and not item.stated:
        query = Query(text=item.name) if item.name else Query(last=True)
        found = survey.find(query)
        if found.verdict != "absent" and found.things:
            sizes = [_of_thing(t, survey) for t in found.things if t.node is not None]
            if not sizes:
                raise Undecidable("The floor, the walls and the ceiling are not put anywhere.")
            return sizes
        if not item.name:
            raise NotResolved(query, found)
    return [_of_item(item)]


def _of_thing(thing: Thing, survey: Survey) -> _Size:
    assert thing.node is not None
    width, depth, height = thing.node.size
    return _Size(
        width,
        depth,
        height,
        1.0,
        1.0,
        f"{survey.named(thing)} ({width:.2f} x {depth:.2f} m)",
        own=thing,
        backed=(kind := kinds.of(thing.label)) is not None and kind.backed,
    )


def _of_item(item: Item) -> _Size:
    kind = item.kind or kinds.find(item.name) if item.name else None
    name = (singular_name(item.name) if item.count > 1 else item.name) or "something"
    if kind is None and item.width is None and item.name in WIDTHS:
        across = WIDTHS[item.name]
        along = _LONG.get(item.name, across)
        return _Size(across, along, 1.2, 1.0, 1.0, f"{_a(name)} of about {across:.2f} x {along:.2f} m")
    if kind is None and item.width is None:
        raise Undecidable(f"Nothing tells how large {_a(name)} is; say how wide and deep it is.")
    ranges = kind.size if kind is not None else None
    usual = tuple((r[0] + r[1]) / 2 for r in ranges) if ranges is not None else _UNKNOWN
    width, depth, height = item.width, item.depth, item.height
    if width is not None and depth is None and kind is not None and usual[1] > usual[0] and not item.facing_wall:
        width, depth = None, width  # "a 2 m bed" is 2 m long, which is its depth
    stated_plan = item.width is not None
    if width is None:
        width = usual[0]
    if depth is None:
        depth = usual[1] if kind is not None else min(_UNKNOWN[1], width)
    round_or_square = (kind is not None and kind.round) or item.name.split()[:1] in (
        ["round"],
        ["square"],
        ["circular"],
    )
    if round_or_square and item.width is not None and item.depth is None:
        depth = width
    given = height
    height = usual[2] if height is None else height
    if kind is not None and kind.is_rug:
        height = min(height, 0.02)
    low = high = 1.0
    if not stated_plan and ranges is not None:
        middle = math.sqrt(usual[0] * usual[1])
        low = math.sqrt(ranges[0][0] * ranges[1][0]) / middle
        high = math.sqrt(ranges[0][1] * ranges[1][1]) / middle
    side = f" and {given:.2f} m high" if given is not None else ""
    sold = (
        ""
        if stated_plan and item.depth is not None
        else " (as usually sold)"
        if kind is not None
        else " (its depth assumed)"
    )
    words = f"{_a(name)} of {width:.2f} x {depth:.2f} m{side}{sold}"
    backed = kind is not None and kind.backed
    return _Size(width, depth, height, low, high, words, item.facing_wall, backed=backed)


def singular_name(name: str) -> str:
    """A name with its last word in the singular."""
    head, _, last = name.rpartition(" ")
    return f"{head} {singular(last)}".strip() if last else name


def _a(name: str) -> str:
    return name if name == "something" else f"{'an' if name[:1] in 'aeiou' else 'a'} {name}"


# -- places ------------------------------------------------------------------------------------------------------------


def _obstacles(survey: Survey, region: Region, size: _Size, door_zones: bool) -> list[YawBox]:
    """What a thing must not meet in a region: everything but rugs, windows and itself; doors with the floor before."""
    found = []
    for node in survey.graph.nodes:
        own = size.own is not None and (node.id == size.own.id or node.support == size.own.id)
        opening = kinds.is_opening(node.label)
        if own or node.is_stepped_on or node.top <= STEP or (opening and node not in survey.floor.doors):
            continue
        if region.on is not None and node.id == region.on.id:
            continue
        box = node.yaw_box
        if node in survey.floor.doors:
            if not door_zones:
                continue
            box = box._replace(d=box.d + 2 * _DOOR_ZONE)
        found.append(box)
    return found


def _fit(
    size: _Size, scaled: tuple[float, float, float], region: Region, obstacles: Sequence[YawBox], count: int = 1
) -> YawBox | None:
    """A place for a box in a region, or for the last of several; None if there is none."""
    if scaled[2] > region.most + SLACK:
        return None
    yaws = region.yaws
    if (size.facing or (size.backed and region.backs)) and region.along is not None:
        yaws = (region.along % 180.0,)
    taken = list(obstacles)
    found = None
    for _ in range(count):
        found = place(scaled, region.surface, taken, yaws, region.allows if region.allowed else None)
        if found is None:
            return None
        taken.append(found)
    return found


def _case(item: Item, size: _Size, regions: Sequence[Region], survey: Survey) -> Answer:
    """Whether a thing of a size fits in any of the regions."""

    def fits(scaled: tuple[float, float, float], zones: bool = True) -> tuple[Region, YawBox] | None:
        for region in regions:
            found = _fit(size, scaled, region, _obstacles(survey, region, size, zones), item.count)
            if found is not None:
                return region, found
        return None

    found = fits(size.scaled(1.0))
    where = f" {regions[0].words}" if regions[0].words else " in the room"
    what = size.words if item.count == 1 else f"{item.count} times {size.words}"
    things = tuple(dict.fromkeys((*([size.own] if size.own else []), *(t for r in regions for t in r.things))))
    ids = tuple(t.id for t in things)
    gaps = [r.gap for r in regions if r.gap is not None]
    if found is not None:
        region, box = found
        sure = 0.92 if fits(size.scaled(max(size.high, 1.04))) is not None else 0.7
        where = f" {region.words}" if region.words else " in the room"
        spare = f"; the gap is {region.gap[0]:.2f} m" if region.gap is not None else ""
        lines = (*_outline(box), *([region.gap[1]] if region.gap is not None else []))
        text = f"Yes: {what} fits{where}{spare}{_at(box, region, survey)}."
        return Answer(
            answer="yes", answer_type="yesno", text=text, confidence=sure, evidence=Evidence(ids=ids, lines=lines)
        )
    sure = 0.92 if fits(size.scaled(min(size.low, 0.96))) is None else 0.65
    why = ""
    if gaps:
        widest = max(gaps, key=lambda g: g[0])
        why = f"; the gap is {widest[0]:.2f} m"
    elif size.height > min(r.most for r in regions):
        why = f"; only {min(r.most for r in regions):.2f} m of height are free there"
    else:
        best = largest(size.scaled(1.0), lambda s: fits(s) is not None, (True, True))
        why = (
            f"; at most about {best * size.width:.2f} x {best * size.depth:.2f} m does"
            if best > 0.1
            else "; that place is taken"
        )
    if fits(size.scaled(1.0), zones=False) is not None:
        why, sure = "; it would only fit before the door", 0.6
    lines = tuple(g[1] for g in gaps[:1])
    text = f"No: {what} does not fit{where}{why}."
    return Answer(answer="no", answer_type="yesno", text=text, confidence=sure, evidence=Evidence(ids=ids, lines=lines))


def _at(box: YawBox, region: Region, survey: Survey) -> str:
    """Where a found place is, for places that the words left open."""
    return "" if region.words or region.on else f", for example {ends.place_words(float(box.x), float(box.y), survey)}"


def _outline(box: YawBox) -> tuple[Line, ...]:
    """The two middle lines of a place."""
    lines = []
    for length, sides in (
        (box.w, ((-box.w / 2, 0.0), (box.w / 2, 0.0))),
        (box.d, ((0.0, -box.d / 2), (0.0, box.d / 2))),
    ):
        (ax, ay), (bx, by) = (box.world(*e) for e in sides)
        z = float(box.low) + 0.02
        lines.append(Line(start=(float(ax), float(ay), z), end=(float(bx), float(by), z), label=f"{length:.2f} m"))
    return tuple(lines)


def _undecided(text: str) -> Answer:
    return Answer(answer=None, answer_type="yesno", text=text, source="none", confidence=0.85)


def _fits(asked: Asked, survey: Survey) -> Answer | None:
    item: Item = asked.slots["i"]
    wheres: tuple[Where, ...] = asked.slots.get("p", ())
    if any(w.relation == "through" for w in wheres):
        return None
    if any(w.relation in ("inside", "above") for w in wheres):
        return _inside(item, wheres, survey)
    if any(w.relation == "under" for w in wheres) and (given := _under_standing(item, wheres, survey)) is not None:
        return given
    try:
        sizes = _sizes(item, survey)
        cases = []
        for name, regions in list(alternatives(wheres, survey))[:_MOST_READINGS]:
            for size in sizes:
                own = survey.named(size.own) if size.own is not None and len(sizes) > 1 else ""
                cases.append((" and ".join(w for w in (own, name) if w), _case(item, size, regions, survey)))
    except NotResolved as error:
        return ends.absent(error, survey)
    except Undecidable as error:
        return _undecided(str(error))
    return agreed(cases) if cases else _undecided("That place is between a thing and itself.")


def _under_standing(item: Item, wheres: Sequence[Where], survey: Survey) -> Answer | None:
    """Under what stands on the floor: certain only where the thing is larger than the outside; None for what hangs."""
    anchor = next(w.anchors[0] for w in wheres if w.relation == "under")
    if not isinstance(anchor, Query):
        return None
    found = _sizes_and_things(item, anchor, survey)
    if isinstance(found, Answer):
        return found
    sizes, things = found
    if any(t.node is None or t.node.support in ("wall", "ceiling") for t in things):
        return None
    return _compared(sizes, things, "under", survey)


def _inside(item: Item, wheres: Sequence[Where], survey: Survey) -> Answer | None:
    """Inside a thing: certain only where it is larger than the outside of that thing."""
    where = next(w for w in wheres if w.relation in ("inside", "above"))
    anchor = where.anchors[0]
    if where.relation == "above" or not isinstance(anchor, Query) or len(wheres) > 1:
        return None
    found = _sizes_and_things(item, anchor, survey)
    if isinstance(found, Answer):
        return found
    sizes, things = found
    if any(t.node is None for t in things):
        return _undecided("Nothing fits inside the floor, a wall or the ceiling.")
    return _compared(sizes, things, "inside", survey)


def _sizes_and_things(item: Item, anchor: Query, survey: Survey) -> tuple[Sequence[_Size], tuple[Thing, ...]] | Answer:
    """The sizes that an item may have and the things that its place may mean, or the answer that one is unknown."""
    try:
        things = meant(anchor, survey)
        return _sizes(item, survey), things
    except NotResolved as error:
        return ends.absent(error, survey)
    except Undecidable as error:
        return _undecided(str(error))


def _compared(sizes: Sequence[_Size], things: Sequence[Thing], relation: str, survey: Survey) -> Answer:
    """The answer for each thing whose outside is compared, and each size."""
    return agreed([(survey.named(t), _outside(s, t, relation, survey)) for t in things for s in sizes])


def _outside(size: _Size, thing: Thing, relation: str, survey: Survey) -> Answer:
    """No if a thing is larger than the outside of another one, undecided otherwise."""
    assert thing.node is not None
    name, evidence = survey.named(thing), Evidence(ids=(thing.id,))
    outer = sorted(thing.node.size[:2])
    plan = sorted((size.width, size.depth))
    height = thing.node.top if relation == "under" else thing.node.size[2]
    thin = plan[0] if relation == "inside" else 0.0
    if (
        size.height > height + SLACK
        or plan[0] > outer[0] + SLACK
        or (relation == "inside" and plan[1] > max(outer[1], height))
    ):
        outside = f"{outer[1]:.2f} x {outer[0]:.2f} m and {height:.2f} m high"
        text = f"No: {size.words} is larger than {name}, which is {outside}."
        return Answer(
            answer="no", answer_type="yesno", text=text, confidence=0.9 if thin >= 0 else 0.5, evidence=evidence
        )
    text = (
        f"The box of {name} tells its outside ({outer[1]:.2f} x {outer[0]:.2f} m, {height:.2f} m high), not how much "
        f"room is {relation} it."
    )
    return Answer(answer=None, answer_type="yesno", text=text, source="none", confidence=0.85, evidence=evidence)


def _does(asked: Asked, survey: Survey) -> Answer | None:
    """Whether there is free floor for an activity."""
    item: Item = asked.slots["t"]
    wheres: tuple[Where, ...] = asked.slots.get("p", ())
    width, depth = item.width or 1.0, item.depth or item.width or 1.0
    size = _Size(width, depth, 1.8, 1.0, 1.0, f"{item.name} on {width:.2f} x {depth:.2f} m of floor")
    if any(w.relation in ("through", "inside", "above", "under") for w in wheres):
        return None
    try:
        cases = [(n, _case(item, size, r, survey)) for n, r in list(alternatives(wheres, survey))[:_MOST_READINGS]]
    except NotResolved as error:
        return ends.absent(error, survey)
    except Undecidable as error:
        return _undecided(str(error))
    return agreed(cases) if cases else None


def _through(asked: Asked, survey: Survey) -> Answer | None:
    """Whether a thing goes through a door: upright, straight or turned sideways."""
    item: Item = asked.slots["i"]
    try:
        doors = meant(asked.slots["x"], survey)
        sizes = _sizes(item, survey)
    except NotResolved as error:
        return ends.absent(error, survey)
    except Undecidable as error:
        return _undecided(str(error))
    if any(d.node is None or not kinds.is_opening(d.label) for d in doors):
        return None
    return agreed([(survey.named(d), _passes(item, s, d, survey)) for d in doors for s in sizes])


def _high_enough(asked: Asked, survey: Survey) -> Answer | None:
    """Whether something as tall as said stands upright under the ceiling."""
    item: Item | None = asked.slots.get("i")
    tall = asked.slots.get("l") if item is None else item.height or item.width
    if tall is None:
        return None
    height = survey.graph.room.size[2]
    holds = tall <= height
    text = f"{'Yes' if holds else 'No'}: the ceiling is {height:.2f} m high, and that is {tall:.2f} m tall."
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text,
                  confidence=0.95 if abs(height - tall) > 0.03 else 0.6)  # fmt: skip


def _gaps(asked: Asked, survey: Survey) -> list[tuple[str, Region]]:
    """The strip between two things, for each reading of their names."""
    where = Where("between", (asked.slots["a"], asked.slots["b"]))
    return [(name, regions[0]) for name, regions in alternatives((where,), survey)]


def _wide_enough(asked: Asked, survey: Survey, width: float, who: str) -> Answer:
    def case(region: Region) -> Answer:
        assert region.gap is not None
        gap, line = region.gap
        holds = gap >= width - SLACK
        text = f"{'Yes' if holds else 'No'}: there are {gap:.2f} m {region.words}, and {who} {width:.2f} m."
        return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text,
                      confidence=0.9 if abs(gap - width) > 0.05 else 0.65,
                      evidence=Evidence(ids=tuple(t.id for t in region.things), lines=(line,)))  # fmt: skip

    cases = [(name, case(region)) for name, region in _gaps(asked, survey)]
    return agreed(cases) if cases else _undecided("That is between a thing and itself.")


def _walk_between(asked: Asked, survey: Survey) -> Answer:
    """Whether the gap between two things is wide enough for somebody."""
    walker = asked.slots.get("w", Walker())
    width = 2 * SHOULDERS + 0.1 if "two people" in asked.text.lower() else walker.width
    return _wide_enough(asked, survey, width, "that takes")


def _gap_of(asked: Asked, survey: Survey) -> Answer:
    return _wide_enough(asked, survey, asked.slots["l"], "asked are")


def _passes(item: Item, size: _Size, door: Thing, survey: Survey) -> Answer:
    assert door.node is not None
    wide, _, high = door.node.size
    sides = (
        [size.width] if item.width is not None and item.depth is None and size.own is None else [size.width, size.depth]
    )
    holds = min(sides) <= wide and size.height <= high
    turned = min(size.width, size.depth) <= wide and size.height <= high
    plain = item.width is None and item.height is None  # a size as it is or as sold: it may be tilted
    if not holds and plain:
        least, middle, _ = sorted((size.width, size.depth, size.height))
        holds = least <= wide and middle <= high
    name = survey.named(door)
    note = f" Turned sideways it would, being {size.depth:.2f} m deep as usually sold." if turned and not holds else ""
    opening = f"{name} is {wide:.2f} m wide and {high:.2f} m high"
    text = f"{'Yes' if holds else 'No'}: {opening}, and that is {size.words}.{note}"
    margin = min(abs(wide - min(sides)), abs(high - size.height))
    sure = 0.6 if note else 0.9 if margin > 0.04 else 0.65
    line = _outline(door.node.yaw_box._replace(low=high))[0]
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=sure,
                  evidence=Evidence(ids=(door.id,), lines=(line,)))  # fmt: skip


def _where(asked: Asked, survey: Survey) -> Answer | None:
    """A place for a thing, in words."""
    item: Item = asked.slots["i"]
    wheres: tuple[Where, ...] = asked.slots.get("p", ())
    try:
        size = _sizes(item, survey)[0]
        if size.own is not None:
            return None
        _, regions = next(iter(alternatives(wheres, survey)))
    except Undecidable as error:
        return replace_type(_undecided(str(error)))
    kind = item.kind
    if kind is not None and kind.backed and not wheres:
        against = next(alternatives((Where("wall"),), survey))[1]
        regions = [*against, *regions]
    for region in regions:
        found = _fit(size, size.scaled(1.0), region,
                     _obstacles(survey, region, size, True), item.count)  # fmt: skip
        if found is None:
            continue
        around = survey.floor.nearest_obstacles(float(found.x), float(found.y))
        near = [survey.named(survey.thing(n.id)) for d, n in around
                if d <= 1.5 and n.label][:2]  # fmt: skip
        told_place = ends.place_words(float(found.x), float(found.y), survey)
        words = ", ".join(w for w in (region.words or told_place, f"near {listed(near)}" if near else "") if w)
        text = f"{size.words[0].upper()}{size.words[1:]} fits {words}."
        return Answer(answer=words, answer_type="text", text=text, confidence=0.8, frame="viewer",
                      evidence=Evidence(ids=tuple(t.id for t in region.things), lines=_outline(found)))  # fmt: skip
    text = f"There is no free place for {size.words}."
    return Answer(answer="nowhere", answer_type="text", text=text, confidence=0.75)


def replace_type(given: Answer) -> Answer:
    """The same answer to a question that asks for a text."""
    return given.model_copy(update={"answer_type": "text"})


def _how_wide(asked: Asked, survey: Survey) -> Answer | None:
    """The greatest width that fits in a place, the other sides as usual."""
    unit = asked.slots.get("u", METRE)
    item: Item = asked.slots.get("k") or asked.slots["i"]
    wheres: tuple[Where, ...] = asked.slots["p"]
    if any(w.relation in ("through", "inside", "above") for w in wheres):
        return None
    try:
        size = replace(_sizes(replace(item, definite=False), survey)[0], facing=True)
        readings = list(alternatives(wheres, survey))[:_MOST_READINGS]
    except Undecidable as error:
        return _undecided(str(error)).model_copy(update={"answer_type": "metres"})

    def case(regions: Sequence[Region]) -> Answer:
        def fits(s: tuple[float, float, float]) -> bool:
            return any(_fit(size, s, r, _obstacles(survey, r, size, True)) is not None for r in regions)

        best = size.width * largest(size.scaled(1.0), fits, (True, False), 4.0)
        text = f"At most about {told(best, unit)} wide, with a depth of {size.depth:.2f} m, {regions[0].words}."
        ids = tuple(t.id for r in regions for t in r.things)
        return answer_of(best, unit, text, confidence=0.75, evidence=Evidence(ids=tuple(dict.fromkeys(ids))))

    return agreed([(name, case(regions)) for name, regions in readings])


KINDS = (
    Kind("ceiling is high enough", templates(_TALL), _high_enough),
    Kind("walk between", templates(_BETWEEN), _walk_between),
    Kind("gap of a width", templates(_GAP_OF), _gap_of),
    Kind("fits through", templates(_THROUGH), _through),
    Kind("how wide would fit", templates(_HOW_WIDE), _how_wide),
    Kind("where would it fit", templates(_WHERE), _where),
    Kind("would it fit", templates(_FITS), _fits),
    Kind("space for an activity", templates(_DOES), _does),
)
