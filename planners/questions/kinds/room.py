"""How large the room is: its width, depth, height, floor area, volume and walls, and comparisons of them."""

from __future__ import annotations

import math

from ..answer import Answer, Evidence, Line
from ..candidates import each, meant
from ..kind import Asked, Kind
from ..placing import is_turned, sides
from ..reading.phrase_templates import templates
from ..reading.spans import CUBE, METRE, SQUARE, Unit, answer_of, told
from ..room_places import wall_of
from ..survey import Survey, Thing

# In templates: U is a unit of length, A of area, V of volume at the end of a question; R is the room.
_U = "[in {u:length_unit}|measured in {u:length_unit}|expressed in {u:length_unit}]"
_A = "[in {a:area_unit}|measured in {a:area_unit}|expressed in {a:area_unit}]"
_V = "[in {v:volume_unit}]"
_R = "{r:room}"
_MORE = "(bigger|larger|more|greater) than"
_LESS = "(smaller|less|under|below|fewer) than"
_AT = "[over|more than|longer than|wider than|higher than|taller than|deeper than|at least|above]"

_AREA = f"""
    (what|how big|how large|how much) BE the (floor area|floor space|floor surface|area|surface \
      area|surface|square footage|footprint|total area|total floor area) [of {_R}|of the floor|in the room] {_A}
    (what|how big|how large|how much) (is|are) {_R} 's (floor area|floor space|area|surface area|square \
      footage|footprint) {_A}
    (what|how big|how large) (is|are) its (floor area|floor space|area|surface area|square footage|footprint) {_A}
    (give|state|calculate|compute) [me] the (floor area|floor space|area|surface area|square footage) [of {_R}|of \
      the floor] {_A}
    what (floor area|area|square footage|floor space) (does|has) {_R} [have|got|cover] {_A}
    how many {{a:area_unit}} (is|are|does|do|has|would) {_R} [have|cover|measure|take up|come to|in total]
    how many {{a:area_unit}} (is|are|of) [the|this] [whole|entire] floor
    how many {{a:area_unit}} (is|are|does|do) the floor [have|cover|measure|cover]
    how many {{a:area_unit}} of floor [area|space] (is there|are there|does {_R} have|do we have|in the room) [in \
      the room|in total|altogether]
    how many {{a:area_unit}} (of carpet|of flooring|of laminate|of parquet|of tiles|of carpeting) (would i \
      need|do i need|would we need|do we need|would be needed|are needed|would it take) [for {_R}|for the floor|to \
      cover the floor|to cover the whole floor|in the room]
    how (big|large) BE {_R} in {{a:area_unit}}
    what size BE {_R} in {{a:area_unit}}
    what is the size of {_R} in {{a:area_unit}}
    how (big|large) BE the [whole|entire] floor {_A}
    how much floor [space|area] (does {_R} have|is there|do we have|is there in the room|in the room) [in \
      total|altogether|overall|in all] {_A}
    [the] (floor area|square footage|area) of {_R} {_A}
    [the] area of the floor {_A}
    floor area {_A}
    square footage
"""
_VOLUME = f"""
    (what|how big|how large|how much) BE the volume [of {_R}|of air in the room] {_V}
    (what is its volume|what is {_R} 's volume) {_V}
    how many {{v:volume_unit}} (is|are|does|do) {_R} [have|hold|contain|measure]
    how many {{v:volume_unit}} of (air|space) (is|are) (there|in the room) [in the room]
    how many {{v:volume_unit}} of (air|space) does {_R} (hold|have|contain)
    how much air (is there in the room|does {_R} (hold|contain)|is in the room) {_V}
    [the] volume of {_R} {_V}
"""
_LENGTHS = {
    "height": f"""
    how (high|tall|low) BE the ceiling [here|in here|in the room|above the floor|above ground] {_U}
    how (high|tall) BE {_R} {_U}
    how (high|far) up BE the ceiling [in the room] {_U}
    how high (does the ceiling go|does {_R} go|do the ceilings go|are the ceilings) [here|in here|in the room] {_U}
    how high up does the ceiling go {_U}
    what BE the [total] height of (the ceiling|{_R}|the ceilings) [here|in the room] {_U}
    what is (the ceiling height|the room height|the ceiling 's height|{_R} 's height|the height from floor to \
      ceiling|the floor to ceiling height) [here|in here|in the room] {_U}
    what ceiling height (does {_R} have|is there|do we have) {_U}
    what height (is the ceiling|is {_R}|are the ceilings|does {_R} have) [at|in the room] {_U}
    how (far|high|much) (is it|is the distance|is there) from [the] floor to [the] ceiling {_U}
    how far (apart are the floor and the ceiling|is the ceiling from the floor|is the floor from the \
      ceiling|above the floor is the ceiling) {_U}
    what is the distance (from the floor to the ceiling|between the floor and the ceiling|between floor and \
      ceiling|from floor to ceiling) {_U}
    [the] (ceiling height|height of the ceiling|height of {_R}) {_U}
    how tall are the walls [in the room] {_U}
    how high are the walls [in the room] {_U}
    how much headroom (is there|do we have|is there in the room) {_U}
""",
    "width": f"""
    how (wide|broad) BE {_R} [from left to right|from side to side|across|at its widest|left to right|side to \
      side] {_U}
    how (wide|broad) BE the floor {_U}
    what BE the (width|breadth) of {_R} {_U}
    what is {_R} 's (width|breadth) {_U}
    what width (is|does|has) {_R} [have] {_U}
    how (far|long|many {{u:length_unit}}) (is it|is {_R}|is the room) (from left to right|from side to side|from the \
      left wall to the right wall|from the left to the right|side to side|left to right|from one side to the other) \
      {_U}
    what is the distance (between the left and right walls|between the left and the right wall|between the side \
      walls|from the left wall to the right wall) {_U}
    how far apart are (the side walls|the left and right walls|the left and the right wall|the left wall and the \
      right wall) {_U}
    how far is the left wall from the right wall {_U}
    how long (is|are) the (front|back|far|rear|near) wall {_U}
    how wide (is|are) the (front|back|far|rear|near) wall {_U}
    what is the length of the (front|back|far|rear) wall {_U}
    how many {{u:length_unit}} wide (is|does) {_R} [measure|get]
    [the] (width of {_R}|room width) {_U}
""",
    "depth": f"""
    how (long|deep|far) BE {_R} (from front to back|from the front to the back|front to back|from back to \
      front|from the back to the front) {_U}
    how deep BE {_R} {_U}
    what BE the depth of {_R} {_U}
    what is {_R} 's depth {_U}
    how (far|long) is it (from front to back|from the front to the back|from the front wall to the back wall|from \
      the near end to the far end|to the back wall) {_U}
    what is the distance (between the front and back walls|between the front and the back wall|from the front \
      wall to the back wall|from front to back|from the front to the back of {_R}) {_U}
    how far apart are (the front and back walls|the front and the back wall|the front wall and the back wall) {_U}
    how far is the (front|back) wall from the (front|back) wall {_U}
    how (long|wide) (is|are) the (left|right|left hand|right hand|side) (wall|walls) {_U}
    what is the length of the (left|right|side) wall {_U}
    how many {{u:length_unit}} deep is {_R}
    [the] depth of {_R} {_U}
""",
    "length": f"""
    how long BE {_R} {_U}
    what BE the length of {_R} {_U}
    what is {_R} 's length {_U}
    how (long|wide) BE the longest (wall|side) [of {_R}|in the room] {_U}
    what is the length of the (longest|longer) (wall|side) [of {_R}|in the room] {_U}
    how far is it from (one end to the other|one end of the room to the other|end to end|one wall to the opposite \
      one) {_U}
    how many {{u:length_unit}} long is {_R}
    [the] length of {_R} {_U}
""",
    "shorter": f"""
    how (long|wide) BE the (shortest|shorter|narrowest) (wall|side) [of {_R}|in the room] {_U}
    what is the length of the (shortest|shorter) (wall|side) [of {_R}|in the room] {_U}
""",
    "diagonal": f"""
    (what|how long) BE the diagonal [of {_R}|of the floor|across the room|across the floor] {_U}
    how (far|long) is it (from corner to corner|diagonally across the room|diagonally|across the room \
      diagonally|from one corner to the opposite corner|from one corner to the opposite one) {_U}
    how far (apart are opposite corners|is it diagonally across the floor) [of {_R}] {_U}
    how long BE {_R} diagonally {_U}
""",
    "perimeter": f"""
    (what|how long) BE the (perimeter|circumference) [of {_R}|of the floor] {_U}
    what is {_R} 's perimeter {_U}
    how long (are|is) (all the walls|all walls|the walls|all four walls) [together|in total|altogether|combined] {_U}
    what is the total length of the walls {_U}
    how (much|many {{u:length_unit}} of|many {{u:length_unit}}) (skirting|skirting board|baseboard|trim) (would \
        i need|do i \
      need|would we need|do we need|is needed|would be needed) [for {_R}|in the room] {_U}
    [the] perimeter of {_R} {_U}
""",
}
_ALL = f"""
    (how big|how large|how spacious|how roomy|how small|what size) BE {_R} {_U}
    what (BE|would be) the \
      (size|dimensions|dimension|measurements|measures|proportions|extent|extents|sizes|overall dimensions|overall \
      size|approximate size|exact dimensions|exact size) of {_R} {_U}
    what is {_R} 's (size|dimensions|measurements|footprint) {_U}
    what are {_R} 's (size|dimensions|measurements) {_U}
    what (size|dimensions|measurements) (is|are|does|do|has|have) {_R} [have|got] {_U}
    what are the (room dimensions|dimensions of the room|room measurements|room 's \
      dimensions|measurements|dimensions) [here|in here] {_U}
    what does {_R} measure {_U}
    (give|state|list|name|show|specify|provide|write down) [me] [the] (dimensions|size|measurements|room \
      dimensions|room size|room 's dimensions|room 's size) [of {_R}] {_U}
    [measure] [the] (dimensions|size|measurements|room dimensions|room size) of {_R} {_U}
    (room size|room dimensions|room measurements|dimensions) {_U}
    measure {_R} {_U}
    how (wide|long) and (long|deep|wide) BE {_R} {_U}
    how (wide|long|deep) , (long|deep|wide) and (high|tall) BE {_R} {_U}
    what (is|are) the (width|length) and [the] (length|depth|width) of {_R} {_U}
    what (is|are) the (length|width) , [the] (width|depth|length) and [the] height of {_R} {_U}
"""
_COMPARE = f"""
    BE {_R} {_MORE} {{q:area}} [in size|in area]
    BE {_R} (at least|no less than|over|above|more than) {{q:area}} [in size|in area|big|large]
    BE the floor [area|space] {_MORE} {{q:area}}
    BE the floor [area|space] (at least|over|above|more than) {{q:area}}
    (does|do) {_R} have (more than|over|at least) {{q:area}} [of floor|of floor space|of floor area]
    BE there (more than|over|at least) {{q:area}} of (floor|floor space|space) [here|in here|in the room]
    BE {_R} {{f:extent}} than {{l:span}}
    BE {_R} (more than|over|at least|above) {{l:span}} {{f:extent}}
    BE the ceiling {{f:extent}} than {{l:span}}
    BE the (ceiling|ceilings) (more than|over|at least|above) {{l:span}} {{f:extent}} [up]
    BE the ceiling (above|over|at least|more than) {{l:span}}
"""
_EQUAL = f"""
    BE {_R} [really|about|around|exactly] {{l:span}} {{f:extent}}
    BE the ceiling [really|about|around|exactly] {{l:span}} {{f:extent}}
    BE {_R} [about|around|exactly] {{q:area}} [in size|large|big]
    BE the floor [area] [about|around|exactly] {{q:area}} [in size|large|big]
    (does|has) {_R} [have] [about|around] {{q:area}} [of floor|of floor space]
"""
_LESSER = f"""
    BE {_R} (smaller|less|under|below) than {{q:area}} [in size|in area]
    BE {_R} (under|below|less than|at most) {{q:area}} [in size|in area|big|large]
    BE the floor [area] (smaller|less) than {{q:area}}
    BE the floor [area] (under|below|less than|at most) {{q:area}}
    BE {_R} (less than|under|below|at most) {{l:span}} {{f:extent}}
    BE the ceiling (less than|under|below|at most) {{l:span}} [high|up|tall|from the floor]
    BE {_R} {{f:lesser_extent}} than {{l:span}}
    BE the ceiling {{f:lesser_extent}} than {{l:span}}
"""
_SHAPE = f"""
    BE {_R} [roughly|nearly|almost|about|more or less|perfectly|approximately] (square|a square|square shaped|as \
      wide as it is long|as long as it is wide|as wide as it is deep|as deep as it is wide|equally long and wide)
    BE the floor [roughly|nearly|almost|about|perfectly|exactly] (square|a square|square shaped)
    (does|has) {_R} [have] a square (floor|floor plan|shape|footprint)
    (is|are) all [four] walls [of {_R}] [equally long|the same length|of the same length|of equal length]
"""
_LONGER = f"""
    BE {_R} (longer|deeper) than (it is wide|wide|it is broad|broad|its width)
    BE {_R} (narrow and deep|deeper than wide|longer than wide)
"""
_WIDER = f"""
    BE {_R} (wider|broader) than (it is long|it is deep|deep|long|its depth)
    BE {_R} wider than (deep|long)
"""
_HIGHER = f"""
    BE {_R} (taller|higher) than (it is wide|wide|it is long|it is deep)
"""
_WALL_WITH = f"""
    how (long|wide) BE the wall (with|that has|having|that holds|behind|holding|where) {{x}} [(on|in) it|is|are|hangs] \
      {_U}
    (what|how much) is the (length|width) of the wall (with|that has|having|that holds|behind) {{x}} {_U}
"""
_FORM = f"""
    what shape (is|has|does) {_R} [have]
    what BE the shape of {_R}
    what is {_R} 's shape
"""


def _line(survey: Survey, name: str) -> tuple[Line, ...]:
    """The measured side as a line through the middle of the floor or along a wall."""
    width, depth, height = survey.graph.room.size
    along_x = ((-width / 2, 0.0, 0.0), (width / 2, 0.0, 0.0))
    along_y = ((0.0, -depth / 2, 0.0), (0.0, depth / 2, 0.0))
    across, along = (along_y, along_x) if is_turned(survey) else (along_x, along_y)
    longer = along_x if width >= depth else along_y
    ends = {
        "width": across, "depth": along, "length": longer, "shorter": along_y if longer is along_x else along_x,
        "height": ((0.0, 0.0, 0.0), (0.0, 0.0, height)),
        "diagonal": ((-width / 2, -depth / 2, 0.0), (width / 2, depth / 2, 0.0)),
    }.get(name)  # fmt: skip
    if ends is None:
        return ()
    return (Line(start=ends[0], end=ends[1], label=f"{math.dist(*ends):.2f} m"),)


def _all_sides(asked: Asked, survey: Survey) -> Answer:
    unit = asked.slots.get("u", METRE)
    width, depth, height = sides(survey)
    area = Unit(f"{unit.name}2", unit.value**2, 2) if unit.name in ("ft", "m") else SQUARE
    said = f"{told(width, unit)} wide, {told(depth, unit)} deep and {told(height, unit)} high"
    text = f"The room is {said}; its floor has {told(width * depth, area)}."
    lines = _line(survey, "width") + _line(survey, "depth") + _line(survey, "height")
    return Answer(answer=said, answer_type="text", text=text, confidence=0.95, evidence=Evidence(lines=lines),
                  unit=unit.name, frame="viewer")  # fmt: skip


def _area(asked: Asked, survey: Survey) -> Answer:
    unit = asked.slots.get("a", SQUARE)
    width, depth, _ = sides(survey)
    text = f"The floor is {width:.2f} m by {depth:.2f} m, which is {told(width * depth, unit)}."
    lines = _line(survey, "width") + _line(survey, "depth")
    return answer_of(width * depth, unit, text, confidence=0.95, evidence=Evidence(lines=lines))


def _volume(asked: Asked, survey: Survey) -> Answer:
    unit = asked.slots.get("v", CUBE)
    width, depth, height = sides(survey)
    text = f"The room is {width:.2f} x {depth:.2f} x {height:.2f} m, which is {told(width * depth * height, unit)}."
    return answer_of(width * depth * height, unit, text, confidence=0.95)


def _length_of(name: str, survey: Survey) -> float:
    width, depth, height = sides(survey)
    return {
        "width": width, "depth": depth, "height": height, "length": max(width, depth), "shorter": min(width, depth),
        "diagonal": math.hypot(width, depth), "perimeter": 2 * (width + depth),
    }[name]  # fmt: skip


_SAID = {"width": "from left to right", "depth": "from front to back", "height": "high",
         "length": "along its longer side",
         "shorter": "along its shorter side", "diagonal": "from corner to corner", "perimeter": "around"}  # fmt: skip


def _side(name: str, asked: Asked, survey: Survey) -> Answer:
    unit, value = asked.slots.get("u", METRE), _length_of(name, survey)
    text = f"The room is {told(value, unit)} {_SAID[name]}."
    if name == "length":
        width, depth, _ = sides(survey)
        text = f"The room is {told(depth, unit)} from front to back and {told(width, unit)} from left to right."
    frame = "viewer" if name in ("width", "depth", "length") else ""
    return answer_of(value, unit, text, confidence=0.95, evidence=Evidence(lines=_line(survey, name)), frame=frame)


def _compared(asked: Asked, survey: Survey, how: str) -> Answer:
    """Whether the room is larger ("more") or smaller ("less") than a measure, or equal to it ("equal") within 5 %."""
    if "q" in asked.slots:
        width, depth, _ = sides(survey)
        value, bound, unit, lines = width * depth, asked.slots["q"], SQUARE, _line(survey, "width")
        said = f"The floor has {told(value, unit)}"
    else:
        name = asked.slots.get("f", "height")
        value, bound, unit, lines = _length_of(name, survey), asked.slots["l"], METRE, _line(survey, name)
        said = f"The room is {told(value, unit)} {_SAID[name]}"
    off = abs(value - bound)
    holds = {"more": value >= bound, "less": value <= bound, "equal": off <= 0.05 * bound}[how]
    sure = 0.95 if abs(off - (0.05 * bound if how == "equal" else 0.0)) > 0.03 * bound else 0.6
    than = f"{told(off, unit)} {'more' if value >= bound else 'less'} than {told(bound, unit)}"
    text = f"{'Yes' if holds else 'No'}: {said[0].lower()}{said[1:]}, {than}."
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text, confidence=sure,
                  evidence=Evidence(lines=lines))  # fmt: skip


def _is_square(asked: Asked, survey: Survey) -> Answer:
    width, depth, _ = sides(survey)
    ratio = max(width, depth) / max(min(width, depth), 1e-9)
    holds = ratio <= 1.05
    text = f"{'Yes' if holds else 'No'}: the room is {width:.2f} m wide and {depth:.2f} m deep."
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=text,
                  confidence=0.9 if not 1.03 < ratio < 1.12 else 0.6,
                  evidence=Evidence(lines=_line(survey, "width") + _line(survey, "depth")))  # fmt: skip


def _order(first: str, second: str, survey: Survey) -> Answer:
    a, b = _length_of(first, survey), _length_of(second, survey)
    text = f"{'Yes' if a > b else 'No'}: it is {a:.2f} m {_SAID[first]} and {b:.2f} m {_SAID[second]}."
    return Answer(answer="yes" if a > b else "no", answer_type="yesno", text=text, confidence=0.9, frame="viewer",
                  evidence=Evidence(lines=_line(survey, first) + _line(survey, second)))  # fmt: skip


def _wall_with(asked: Asked, survey: Survey) -> Answer:
    """The length of the wall at which a thing is: "how long is the wall with the door?"."""
    unit = asked.slots.get("u", METRE)

    def one(thing: Thing) -> Answer:
        wall, _ = wall_of(thing, survey.room)
        length = survey.room.depth if abs(float(wall.out[0])) > 0.5 else survey.room.width
        text = f"The {wall.name} wall, with {survey.named(thing)}, is {told(length, unit)} long."
        return answer_of(length, unit, text, confidence=0.9, evidence=Evidence(ids=(thing.id,)), frame="viewer")

    return each(meant(asked.slots["x"], survey), survey, one)


def _form(asked: Asked, survey: Survey) -> Answer:
    width, depth, _ = sides(survey)
    square = max(width, depth) <= 1.05 * min(width, depth)
    said = "square" if square else "rectangular"
    text = f"The room is measured as a box: {said}, {width:.2f} m wide and {depth:.2f} m deep."
    return Answer(answer=said, answer_type="label", text=text, confidence=0.7)


KINDS = (
    Kind("floor area", templates(_AREA), _area),
    Kind("room volume", templates(_VOLUME), _volume),
    *(
        Kind(f"room {name}", templates(text), lambda asked, survey, name=name: _side(name, asked, survey))  # type: ignore[misc]
        for name, text in _LENGTHS.items()
    ),
    Kind("room size", templates(_ALL), _all_sides),
    Kind("room is larger", templates(_COMPARE), lambda asked, survey: _compared(asked, survey, "more")),
    Kind("room is smaller", templates(_LESSER), lambda asked, survey: _compared(asked, survey, "less")),
    Kind("room measures", templates(_EQUAL), lambda asked, survey: _compared(asked, survey, "equal")),
    Kind("room is square", templates(_SHAPE), _is_square),
    Kind("room is longer", templates(_LONGER), lambda asked, survey: _order("depth", "width", survey)),
    Kind("room is wider", templates(_WIDER), lambda asked, survey: _order("width", "depth", survey)),
    Kind("room is higher", templates(_HIGHER), lambda asked, survey: _order("height", "width", survey)),
    Kind("wall of a thing", templates(_WALL_WITH), _wall_with),
    Kind("room shape", templates(_FORM), _form),
)
