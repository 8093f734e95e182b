"""Questions about the room and its floor: its size, free floor, what fits, hazards and ways."""

from __future__ import annotations

import itertools

import numpy as np

from ....gaussians.world import kinds
from .. import sentences as say
from ..naming import Made, Room, asked, named, yes_no
from ..question import Question
from ..truth import FLAT, Thing, along_way, connected, fits_turned, largest_fit, outside, plan_gap, regions

FIT = 0.15  # metres by which something fits, or does not, on each of its sides
BODY = (0.2, 0.35)  # metres, radius: no way for the first, a way for the second
LOW = 0.4  # metres: what one trips over is no higher
ALONG = 0.9  # cosine from which a viewer looks along a wall
HEADROOM = 2.0  # metres: what begins above it is in nobody's way
TRIED = 24  # pairs of things between which a way is looked for


def room_size(room: Room) -> Made:
    """Height and floor area; width and depth where the viewer looks along one of the walls."""
    width, depth, height = room.table.size
    yield asked(room, "room_size", "metres", room.word(say.ROOM_HEIGHT), height)
    yield asked(room, "room_size", "number", room.word(say.ROOM_AREA), width * depth)
    along_x, along_y = np.abs(room.table.forward)
    if max(along_x, along_y) >= ALONG:
        across, ahead = (width, depth) if along_y > along_x else (depth, width)
        yield asked(room, "room_size", "metres", room.word(say.ROOM_WIDTH), across, side=True)
        yield asked(room, "room_size", "metres", room.word(say.ROOM_DEPTH), ahead, side=True)


def free_floor(room: Room) -> Made:
    """Square metres of floor under no thing that stands on it, with rugs taken as free or as covered."""
    standing = [t for t in room.table.things if room.table.on_floor(t)]
    cell = room.table.size[0] * room.table.size[1] / room.table.grid[..., 0].size
    free = [
        float((~room.table.taken(t for t in standing if rugs or t.size[2] > FLAT)).sum()) * cell
        for rugs in (False, True)
    ]
    if free[1] > 2.0:
        yield asked(room, "free_floor", "number", room.word(say.FREE), *free)


def fits(room: Room) -> Made:
    """Whether a rectangle fits on the free floor, or between two things."""
    low = [t for t in room.table.things if t.low < HEADROOM]
    floor = [t for t in room.table.things if room.table.on_floor(t) and t.size[2] > FLAT]
    before_doors = [_before(t) for t in room.table.things if kinds.is_door(t.label)]
    free = ~room.table.taken([*low, *before_doors])
    for _ in range(40):
        w, d = (round(float(v), 1) for v in room.rng.uniform(0.5, 3.2, 2))
        if max(w, d) > max(room.table.size[:2]) or w < d:
            continue
        text = room.word(say.FITS, w=f"{w:g}", d=f"{d:g}")
        if largest_fit(free, w + FIT, d + FIT):
            yield asked(room, "fits", "yesno", text, "yes")
        elif min(w, d) > 0.6 and not fits_turned(room.table, floor, w - FIT, d - FIT):
            yield asked(room, "fits", "yesno", text, "no")


def _before(door: Thing) -> Thing:
    """The floor that a door and those who come in need, as a thing."""
    reach = (door.size[0], door.size[2] / 2, 0.1)
    x, y = door.xy + door.front * door.size[0] / 2
    size = (reach[0], door.size[0] + 0.2, 0.1)
    return Thing(-1, "", "", frozenset(), size, (float(x), float(y), 0.05), door.yaw, "floor")


def fits_between(room: Room) -> Made:
    """Whether something of a width goes between two things that stand side by side."""
    for a, b in room.pairs(room.standing):
        free = plan_gap(a, b)
        others = [t for t in room.table.things if t.id not in (a.id, b.id) and t.low < HEADROOM and t.size[2] > FLAT]
        if not 0.4 <= free <= 2.5 or any(along_way(t, a.xy, b.xy, 0.4) for t in others):
            continue
        yes = room.rng.random() < 0.5
        said = round(100 * (free * 0.7 if yes else free * 1.4), -1)
        text = room.word(say.FITS_BETWEEN, a=a, b=b, w=f"{said:.0f}")
        yield asked(room, "fits_between", "yesno", text, yes_no(yes), **named(a, b))


def hazards(room: Room) -> Made:
    """What low thing lies on the straight way between two others, and whether anything does."""
    ground = [t for t in room.table.things if room.table.on_floor(t)]
    for a, b in itertools.islice(room.pairs(room.standing), 50):
        start, end = outside(a, b), outside(b, a)
        if float(np.linalg.norm(end - start)) < 1.2:
            continue
        others = [t for t in ground if t.id not in (a.id, b.id)]
        hit = [t for t in others if along_way(t, start, end, 0.05) > 0.1]
        near = [t for t in others if along_way(t, start, end, 0.5) > 0]
        flat = [t for t in near if t.size[2] <= FLAT]
        solid_hit, solid_near = ([t for t in found if t.size[2] > FLAT] for found in (hit, near))
        if len(solid_hit) != len(solid_near):
            continue
        if len(solid_hit) == 1 and solid_hit[0].size[2] <= LOW:
            low = solid_hit[0]
            truths = [(low.label,), (low.label, *(t.label for t in flat))]
            about = (a.id, b.id, low.id)
            yield asked(room, "hazard", "list", room.word(say.TRIP, a=a, b=b), *truths, about=about, names=about[:2])
        if not flat and (solid_hit or room.rng.random() < 0.3):
            ids = (a.id, b.id, *[t.id for t in solid_hit])
            text = room.word(say.WAY_CLEAR, a=a, b=b)
            yield asked(room, "hazard", "yesno", text, yes_no(bool(solid_hit)), about=ids, names=ids[:2])


def routes(room: Room) -> Made:
    """Whether one can walk from one thing to another; few rooms are blocked, and those come first."""
    low = [t for t in room.table.things if t.low < HEADROOM and t.high > FLAT and t.support != "ceiling"]
    tall = [t for t in low if room.table.on_floor(t) and t.size[2] > LOW]
    ends = [t for t in room.named if (room.table.on_floor(t) or kinds.is_door(t.label)) and t.size[2] > FLAT]
    wide = regions(room.table, low, BODY[1])
    found: list[Question] = []
    for a, b in itertools.islice(room.pairs(ends), TRIED):
        if plan_gap(a, b) < 1.0:
            continue
        text = room.word(say.ROUTE, a=a, b=b)
        if connected(room.table, wide, a, b, BODY[1] + 0.25):
            found.append(asked(room, "route", "yesno", text, "yes", **named(a, b)))
            continue
        narrow = regions(room.table, [t for t in tall if t.id not in (a.id, b.id)], BODY[0])
        if not connected(room.table, narrow, a, b, BODY[0] + 0.5):
            found.insert(0, asked(room, "route", "yesno", text, "no", **named(a, b)))
    yield from found
