"""Recipes of rooms: which kinds of furniture a room gets and how they are arranged; `layout` tests if they fit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...world.box import YawBox
from ...world.person import EYE_HEIGHT
from ..modeling.make import Asset, make
from ..modeling.parts import chance
from ..registry import KINDS
from .layout import GAP, Layout

Rng = np.random.Generator
SMALL = {
    "coffee table": ("books", "mug", "bowl", "candle", "flowers", "vase", "apple", "telephone", "plate", "toy car"),
    "table": ("plate", "bowl", "bottle", "candle", "flowers", "cake", "mug", "wine glass", "banana", "apple", "vase"),
    "side table": ("table lamp", "flowers", "mug", "books", "vase", "telephone", "candle", "lantern"),
    "nightstand": ("table lamp", "books", "mug", "candle", "wine glass", "telephone"),
    "desk": ("laptop", "monitor", "keyboard", "desk lamp", "mug", "books", "globe", "speaker", "table lamp", "radio"),
    "cabinet": ("vase", "record player", "radio", "sculpture", "globe", "table lamp", "speaker", "lantern", "flowers"),
    "dresser": ("table lamp", "sculpture", "vase", "books", "radio", "candle", "teddy bear", "flowers"),
    "counter": ("kettle", "toaster", "microwave", "cooking pot", "banana", "bottle", "bowl", "plate", "mug", "apple"),
    "bench": ("cushion", "books", "teddy bear"),
    "ottoman": ("cushion", "books", "plate"),
    "stove": ("cooking pot", "kettle"),
}  # fmt: skip
LOOSE = (
    "ball", "basket", "box", "bin", "backpack", "suitcase", "shoe", "umbrella", "drum",
    "fan", "ottoman", "flower pot", "guitar", "teddy bear",
)  # fmt: skip
ODD_COLORS = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "pink", "brown", "white", "black")


class Supplier:
    """Makes assets for one room, each with its own seed, at one level of detail."""

    def __init__(self, rng: Rng, detail: float) -> None:
        self.rng, self.detail = rng, detail

    def __call__(self, kind: str, like: Asset | None = None, color: str | None = None) -> Asset:
        """A new asset, or a copy of the design of `like`."""
        seed = like.seed if like is not None else int(self.rng.integers(1 << 30))
        return make(kind, seed, color=color, detail=self.detail)

    def odd_color(self) -> str:
        """A random colour word for the one asset that differs from others of its design."""
        return str(self.rng.choice(ODD_COLORS))


def dress(room: Layout, get: Supplier, anchor: int | None, like: str, count: int) -> None:
    """Put small things on top of a piece of furniture; one of them may occur twice."""
    if anchor is None:
        return
    names = list(room.rng.permutation(SMALL[like])[:count])
    if names and chance(room.rng, 0.25):
        names.append(names[-1])
    for name in names:
        room.on_top(get(str(name)), anchor, turn=float(room.rng.choice([0, 0, 12, -15, 25])))


def openings(room: Layout, get: Supplier) -> None:
    """Add a door, and one or two windows."""
    rng = room.rng
    walls = list(rng.permutation(room.walls))
    door = get("door")
    wall = str(walls[-1])
    length = room.w if wall in ("north", "south") else room.d
    along = float(rng.choice([-1, 1])) * (length / 2 - door.size[0] / 2 - 0.15)
    if room.hang(door, wall, along, 0.0, flush=True) is not None:
        x, y, yaw = room.spot(wall, along, 0.5)
        room.kept_free.append(YawBox(x, y, 0.0, 0.9, 0.95, 2.0, yaw))
    for wall in walls[: int(rng.integers(1, 3))]:
        length = room.w if wall in ("north", "south") else room.d
        pane = get("window")
        sill = float(rng.uniform(0.85, 1.0))
        along = float(rng.uniform(-0.22, 0.22) * length)
        if pane.size[2] + sill > room.h - 0.15:
            continue
        room.hang(pane, str(wall), along, sill, flush=True)


def pictures(room: Layout, get: Supplier, count: int) -> None:
    """Hang paintings, mirrors and clocks at eye height, where the wall is free."""
    for _ in range(count):
        thing = get(str(room.rng.choice(["painting", "painting", "painting", "mirror", "clock"])))
        lowest = 0.55 if thing.kind == "mirror" else 0.95
        low = 1.65 if thing.kind == "clock" else max(lowest, EYE_HEIGHT - thing.size[2] / 2)
        for _ in range(8):
            wall = str(room.rng.choice(room.walls))
            length = room.w if wall in ("north", "south") else room.d
            if room.hang(thing, wall, float(room.rng.uniform(-0.42, 0.42) * length), low) is not None:
                break


def around_table(room: Layout, get: Supplier, table: int, kind: str, count: int) -> None:
    """Put chairs of one design around a table, at a distance from its edge; sometimes one of another colour."""
    box = room.things[table].box
    first = get(kind)
    odd = int(room.rng.integers(count)) if chance(room.rng, 0.35) else -1
    chair_w, chair_d, _ = first.size
    long = max(int((box.w - 0.1) // (chair_w + 0.12)), 1)
    seats = [(k, -1) for k in range(long)] + [(k, 1) for k in range(long)]
    places = [
        ((k - (long - 1) / 2) * (box.w / long) * 0.95, s * (box.d / 2 + chair_d / 2 + 0.04), 180.0 if s < 0 else 0.0)
        for k, s in seats
    ]
    places += [(-(box.w / 2 + chair_d / 2 + 0.04), 0.0, 90.0), (box.w / 2 + chair_d / 2 + 0.04, 0.0, -90.0)]
    order = list(room.rng.permutation(len(places)))
    done = 0
    for i in order:
        if done == count:
            return
        right, back, turn = places[int(i)]
        same = first if done != odd else get(kind, first, get.odd_color())
        if room.near(same, table, right, back, turn) is not None:
            done += 1


def seating_group(room: Layout, get: Supplier) -> None:
    """Sofa, rug, coffee table, armchairs, side table and lamp."""
    rng = room.rng
    sofa = room.against(get("sofa"), at=float(rng.uniform(0.35, 0.65)), front=1.3)
    if sofa is None:
        return
    box = room.things[sofa].box
    table = get("coffee table")
    if chance(rng, 0.7):
        rug = get("rug")
        room.near(rug, sofa, 0.0, -(box.d / 2 + rug.size[1] / 2 + 0.06))
    forward = -(box.d / 2 + table.size[1] / 2 + float(rng.uniform(0.38, 0.5)))
    low = room.near(table, sofa, 0.0, forward)
    dress(room, get, low, "coffee table", int(rng.integers(1, 4)))
    side = float(rng.choice([-1, 1]))
    stand = get("side table")
    room_side = room.near(stand, sofa, side * (box.w / 2 + stand.size[0] / 2 + 0.06), 0.1)
    dress(room, get, room_side, "side table", 1)
    lamp = get("floor lamp")
    room.near(lamp, sofa, -side * (box.w / 2 + lamp.size[0] / 2 + 0.06), 0.1)
    chair = get("armchair")
    for k in (-1, 1)[: int(rng.integers(1, 3))]:
        turn = float(k * rng.uniform(55, 80))
        other = chair if chance(rng, 0.6) else get("armchair")
        room.near(other, sofa, -k * (box.w / 2 + 0.35), forward - 0.45, 180.0 - turn)


def living_room(room: Layout, get: Supplier) -> None:
    """Seating, a television or fireplace, shelves, plants."""
    rng = room.rng
    seating_group(room, get)
    if chance(rng, 0.75):
        low = room.against(get("cabinet"), front=0.6)
        if low is not None:
            if room.on_top(get("television"), low, 0.0, 0.0) is None:
                dress(room, get, low, "cabinet", 2)
            dress(room, get, low, "cabinet", int(rng.integers(0, 2)))
    else:
        room.against(get("fireplace"), front=0.8)
    for kind, p in (("bookshelf", 0.8), ("bookshelf", 0.3), ("piano", 0.25), ("radiator", 0.2)):
        if chance(rng, p):
            room.against(get(kind))
    _extras(room, get)


def bedroom(room: Layout, get: Supplier) -> None:
    """Bed with nightstands, wardrobe, dresser."""
    rng = room.rng
    bed = room.against(get("bed"), at=float(rng.uniform(0.4, 0.6)), front=0.6)
    if bed is not None:
        box, stand = room.things[bed].box, get("nightstand")
        for k in (-1, 1):
            index = room.near(stand, bed, k * (box.w / 2 + stand.size[0] / 2 + 0.05), box.d / 2 - stand.size[1] / 2)
            dress(room, get, index, "nightstand", int(rng.integers(1, 3)))
        if chance(rng, 0.4):
            bench = get("bench")
            room.near(bench, bed, 0.0, -(box.d / 2 + bench.size[1] / 2 + 0.08))
        if chance(rng, 0.6):
            rug = get("rug")
            room.near(rug, bed, float(rng.choice([-1, 1])) * (box.w / 2 + rug.size[1] / 2 + 0.1), -0.2, 90.0)
    room.against(get("wardrobe"), front=0.6)
    if chance(rng, 0.7):
        dress(room, get, room.against(get("dresser"), front=0.5), "dresser", int(rng.integers(1, 4)))
    for kind, p in (("armchair", 0.4), ("bookshelf", 0.35), ("coat rack", 0.2), ("folding screen", 0.15)):
        if chance(rng, p):
            room.against(get(kind))
    _extras(room, get)


def office(room: Layout, get: Supplier) -> None:
    """Desks with chairs and computers, shelves, cabinets."""
    rng = room.rng
    for _ in range(int(rng.integers(1, 3))):
        desk = room.against(get("desk"), front=0.75)
        if desk is None:
            continue
        box, chair = room.things[desk].box, get("office chair" if chance(rng, 0.75) else "chair")
        room.near(chair, desk, float(rng.uniform(-0.15, 0.15)), -(box.d / 2 + chair.size[1] / 2 + 0.06), 180.0)
        _computer(room, get, desk)
        dress(room, get, desk, "desk", int(rng.integers(1, 3)))
    for kind, p in (("bookshelf", 0.9), ("bookshelf", 0.4), ("sofa", 0.3), ("coat rack", 0.3)):
        if chance(rng, p):
            room.against(get(kind))
    if chance(rng, 0.7):
        dress(room, get, room.against(get("cabinet")), "cabinet", 2)
    room.corner(get("bin"))
    if chance(rng, 0.4):
        rug = get("rug")
        room.try_put(rug, 0.0, 0.0, float(rng.choice([0, 90])))
    _extras(room, get)


def _computer(room: Layout, get: Supplier, desk: int) -> None:
    """Monitor, keyboard and mouse in their places, or a laptop."""
    if chance(room.rng, 0.4):
        room.on_top(get("laptop"), desk, 0.0, -0.05)
        return
    room.on_top(get("monitor"), desk, 0.0, 0.14)
    room.on_top(get("keyboard"), desk, 0.0, -0.14)
    room.on_top(get("computer mouse"), desk, 0.33, -0.14)


def kitchen(room: Layout, get: Supplier) -> None:
    """A row of fridge, cabinets, sink and stove along one wall, and a table with chairs."""
    rng = room.rng
    wall = str(rng.choice(room.walls))
    row = [str(k) for k in rng.permutation(["cabinet", "sink", "stove", "cabinet", "fridge"])]
    things = [get(k) for k in row]
    length = room.w if wall in ("north", "south") else room.d
    t = -length / 2 + GAP + float(rng.uniform(0, 0.2))
    for kind, thing in zip(row, things, strict=True):
        w, d, _ = thing.size
        x, y, yaw = room.spot(wall, t + w / 2, d / 2 + GAP)
        index = room.try_put(thing, x, y, yaw)
        t += w + 0.015
        if index is not None and kind in ("cabinet", "stove"):
            dress(
                room,
                get,
                index,
                "counter" if kind == "cabinet" else "stove",
                int(rng.integers(1, 4)) if kind == "cabinet" else 1,
            )
    _dining(room, get, int(rng.integers(2, 5)))
    room.corner(get("bin"))
    _extras(room, get, rugs=False)


def _dining(room: Layout, get: Supplier, chairs: int) -> None:
    """A table with things on it and chairs, near the middle of the room."""
    rng, table = room.rng, get("table")
    for _ in range(20):
        x, y = float(rng.uniform(-0.2, 0.2) * room.w), float(rng.uniform(-0.2, 0.2) * room.d)
        index = room.try_put(table, x, y, float(rng.choice([0, 90])), margin=0.55)
        if index is None:
            continue
        around_table(room, get, index, str(rng.choice(["chair", "chair", "chair", "stool"])), chairs)
        dress(room, get, index, "table", int(rng.integers(2, 5)))
        return


def dining_room(room: Layout, get: Supplier) -> None:
    """A table with chairs, cabinets, perhaps a floor lamp and other furniture."""
    rng = room.rng
    _dining(room, get, int(rng.integers(3, 7)))
    dress(room, get, room.against(get("cabinet")), "cabinet", int(rng.integers(2, 4)))
    for kind, p in (
        ("cabinet", 0.5),
        ("bookshelf", 0.4),
        ("fireplace", 0.35),
        ("piano", 0.3),
        ("floor lamp", 0.5),
        ("armchair", 0.3),
    ):
        if chance(rng, p):
            room.against(get(kind))
    _extras(room, get)


def studio(room: Layout, get: Supplier) -> None:
    """A studio: instruments, folding screens, a bicycle, a desk."""
    rng = room.rng
    for kind, p in (
        ("piano", 0.6),
        ("desk", 0.7),
        ("bookshelf", 0.6),
        ("sofa", 0.6),
        ("bench", 0.4),
        ("armchair", 0.5),
        ("bicycle", 0.7),
    ):
        if not chance(rng, p):
            continue
        index = room.against(get(kind), front=0.5)
        if index is not None and kind == "desk":
            _computer(room, get, index)
            dress(room, get, index, "desk", 1)
        if index is not None and kind == "piano":
            box, stool = room.things[index].box, get("stool")
            room.near(stool, index, 0.0, -(box.d / 2 + stool.size[1] / 2 + 0.08))
    for kind in ("guitar", "drum", "speaker", "folding screen"):
        if chance(rng, 0.6):
            room.anywhere(get(kind), 0.15)
    if chance(rng, 0.6):
        rug = get("rug")
        room.try_put(rug, float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)), 0.0)
    _extras(room, get)


def _extras(room: Layout, get: Supplier, rugs: bool = True) -> None:
    """Plants, pictures and loose things."""
    rng = room.rng
    pictures(room, get, int(rng.integers(1, 4)))
    for _ in range(int(rng.integers(1, 3))):
        plant = get("potted plant")
        if room.corner(plant) is None:
            room.anywhere(plant, 0.12)
    if chance(rng, 0.4):
        room.against(get("floor lamp"), front=0.0)
    if chance(rng, 0.2):
        drape = get("curtain")
        wall = str(rng.choice(room.walls))
        room.hang(drape, wall, float(rng.uniform(-0.8, 0.8)), min(0.25, room.h - drape.size[2] - 0.05))
    for _ in range(int(rng.integers(1, 4))):
        room.anywhere(get(str(rng.choice(LOOSE))), 0.15)
    for index, thing in enumerate(tuple(room.things)):
        if thing.asset.kind in ("bench", "ottoman") and chance(rng, 0.7):
            dress(room, get, index, thing.asset.kind, 1)


RECIPES: dict[str, tuple[Callable[[Layout, Supplier], None], tuple[float, float], tuple[float, float]]] = {
    "living room": (living_room, (4.4, 5.8), (4.2, 5.4)),
    "bedroom": (bedroom, (3.8, 5.0), (3.8, 4.8)),
    "office": (office, (3.6, 5.0), (3.4, 4.6)),
    "kitchen": (kitchen, (4.0, 5.2), (3.8, 4.8)),
    "dining room": (dining_room, (4.2, 5.4), (4.0, 5.0)),
    "studio": (studio, (4.0, 5.4), (3.8, 5.0)),
}


def fill_up(room: Layout, get: Supplier, least: int) -> None:
    """Add loose things until there are `least` objects, at most 40 attempts."""
    for _ in range(40):
        if len(room.things) >= least:
            return
        kind = str(room.rng.choice([*LOOSE, "potted plant", "stool", "chair", "side table", "bookshelf", "cabinet"]))
        thing = get(kind)
        _ = room.against(thing) if KINDS[kind].known.backed else room.anywhere(thing, 0.2)
