"""The eleven LayoutVLM room tasks as layout problems.

The boundaries come from the tasks. The tasks name their assets by hash and do not include the geometry, so the tables
of things are ours: labels from the tasks' own lists where they have one, counts from how often a hash occurs, typical
sizes; hard wishes from the written criteria. Walls are 2.5 m high (the tasks' are lower than their shelves), and there
is no door, as the tasks have none.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ..planners.layout import Item, Problem, Wish
from . import _data

_HEIGHT = 2.5


class Row(NamedTuple):
    """A kind of thing: how many, width, depth and height in metres, what carries it, whether its back wants a wall."""

    label: str
    number: int
    size: tuple[float, float, float]
    support: str = "floor"
    backed: bool = False


class Task(NamedTuple):
    """Things, and hard wishes "subject name object": every subject has one object in turn, "*" pairs with the first."""

    rows: tuple[Row, ...]
    wishes: tuple[tuple[str, str, str], ...]


_SHELF = (0.9, 0.3, 1.8)
_CHAIR = (0.45, 0.5, 0.9)
TASKS = {
    "bedroom_0": Task(
        (
            Row("bed", 1, (1.6, 2.05, 0.55), backed=True), Row("rattan chair", 1, (0.7, 0.7, 0.85)),
            Row("nightstand", 2, (0.45, 0.4, 0.5), backed=True), Row("table lamp", 2, (0.2, 0.2, 0.4), "nightstand"),
            Row("rug", 1, (2.2, 1.5, 0.02)), Row("pillow", 2, (0.6, 0.4, 0.15), "bed"),
            Row("dresser", 1, (1.0, 0.45, 0.8), backed=True),
        ),
        (("nightstand", "next_to", "bed"), ("rug", "next_to", "bed"), ("dresser", "against_wall", "")),
    ),
    "bookstore_0": Task(
        (
            Row("bookshelf", 6, _SHELF, backed=True), Row("counter", 1, (1.6, 0.6, 1.0)),
            Row("cash register", 1, (0.35, 0.35, 0.3), "counter"), Row("reading chair", 2, (0.75, 0.75, 0.9)),
            Row("book", 16, (0.2, 0.15, 0.04), "bookshelf"), Row("magazine", 8, (0.22, 0.28, 0.02), "coffee table"),
            Row("coffee table", 1, (0.9, 0.6, 0.42)), Row("reading lamp", 2, (0.3, 0.3, 1.5)),
            Row("plant", 2, (0.4, 0.4, 0.9)), Row("signage", 1, (0.8, 0.05, 0.4), "wall"),
            Row("rug", 1, (2.0, 1.4, 0.02)), Row("basket", 2, (0.35, 0.35, 0.3)),
        ),
        (
            ("bookshelf", "against_wall", ""), ("reading chair", "around", "coffee table"),
            ("reading lamp", "next_to", "reading chair"), ("rug", "under", "coffee table"),
        ),
    ),
    "buffet_restaurant_0": Task(
        (
            Row("buffet table", 2, (1.8, 0.8, 0.9)), Row("dessert station", 1, (1.4, 0.7, 1.0), backed=True),
            Row("food warmer", 1, (0.6, 0.4, 0.35), "buffet table"), Row("chair", 4, _CHAIR),
            Row("dining table", 1, (1.2, 1.2, 0.75)), Row("drink dispenser", 1, (0.3, 0.3, 0.5), "dessert station"),
            Row("plate", 15, (0.25, 0.25, 0.02), "buffet table"), Row("fork", 15, (0.03, 0.2, 0.01), "buffet table"),
            Row("knife", 15, (0.03, 0.22, 0.01), "buffet table"), Row("spoon", 15, (0.04, 0.18, 0.01), "buffet table"),
            Row("napkin", 10, (0.12, 0.12, 0.01), "dining table"),
            Row("bowl", 4, (0.18, 0.18, 0.08), "dessert station"),
        ),
        (
            ("chair", "around", "dining table"),
            ("buffet table", "aligned_with", "*"),
            ("dessert station", "against_wall", ""),
        ),
    ),
    "children_room_0": Task(
        (
            Row("bed", 1, (0.95, 2.0, 0.5), backed=True), Row("nightstand", 1, (0.45, 0.4, 0.5), backed=True),
            Row("stuffed animal", 2, (0.2, 0.2, 0.25), "bed"), Row("toy chest", 1, (0.8, 0.45, 0.5), backed=True),
            Row("bookshelf", 1, _SHELF, backed=True), Row("desk", 1, (1.0, 0.55, 0.65), backed=True),
            Row("chair", 1, (0.4, 0.4, 0.7)), Row("play mat", 1, (1.4, 1.4, 0.02)), Row("toy box", 1, (0.5, 0.4, 0.4)),
            Row("wall art", 3, (0.5, 0.03, 0.4), "wall"), Row("ball", 1, (0.2, 0.2, 0.2)),
        ),
        (("bed", "in_corner", ""), ("nightstand", "next_to", "bed"), ("chair", "around", "desk")),
    ),
    "classroom_0": Task(
        (
            Row("colorful mat", 8, (1.0, 1.0, 0.02)), Row("small table", 6, (0.7, 0.7, 0.5)),
            Row("chair", 6, (0.35, 0.35, 0.6)), Row("toy box", 2, (0.6, 0.4, 0.4)),
            Row("bookshelf", 1, (0.9, 0.3, 1.2), backed=True), Row("whiteboard", 1, (1.8, 0.05, 1.1), "wall"),
            Row("educational poster", 3, (0.6, 0.03, 0.8), "wall"), Row("clock", 1, (0.3, 0.05, 0.3), "wall"),
            Row("pencil holder", 1, (0.1, 0.1, 0.12), "small table"), Row("toy basket", 2, (0.4, 0.4, 0.35)),
        ),
        (("chair", "around", "small table"), ("bookshelf", "against_wall", "")),
    ),
    "computer_room_0": Task(
        (
            Row("desk", 2, (1.4, 0.7, 0.75), backed=True), Row("gaming chair", 2, (0.65, 0.65, 1.2)),
            Row("speaker", 4, (0.3, 0.3, 1.0)), Row("computer monitor", 4, (0.5, 0.2, 0.4), "desk"),
            Row("headset", 2, (0.18, 0.2, 0.1), "desk"), Row("keyboard", 2, (0.42, 0.14, 0.03), "desk"),
            Row("mouse", 2, (0.07, 0.11, 0.04), "desk"), Row("stool", 2, (0.4, 0.4, 0.5)),
            Row("gaming console", 1, (0.35, 0.25, 0.08), "desk"), Row("cable box", 2, (0.4, 0.16, 0.14)),
        ),
        (("gaming chair", "around", "desk"), ("speaker", "in_corner", "")),
    ),
    "deli_0": Task(
        (
            Row("wooden shelf", 5, _SHELF, backed=True), Row("deli counter", 1, (1.5, 0.6, 1.0)),
            Row("cash register", 1, (0.35, 0.35, 0.3), "deli counter"),
            Row("scale", 1, (0.3, 0.3, 0.15), "deli counter"),
            Row("meat slicer", 1, (0.4, 0.35, 0.35), "deli counter"), Row("shopping basket", 3, (0.4, 0.3, 0.25)),
            Row("wine bottle", 1, (0.08, 0.08, 0.3), "wooden shelf"),
            Row("bread basket", 1, (0.3, 0.2, 0.15), "wooden shelf"),
        ),
        (("wooden shelf", "against_wall", ""),),
    ),
    "dining_room_0": Task(
        (
            Row("table", 1, (1.9, 1.0, 0.75)), Row("head chair", 2, _CHAIR), Row("chair", 4, _CHAIR),
            Row("candleholder", 2, (0.1, 0.1, 0.25), "table"), Row("flower vase", 1, (0.18, 0.18, 0.3), "table"),
            Row("wine glass", 6, (0.08, 0.08, 0.2), "table"), Row("dinner plate", 6, (0.26, 0.26, 0.02), "table"),
            Row("napkin", 5, (0.12, 0.12, 0.02), "table"), Row("chandelier", 1, (0.8, 0.8, 0.6), "ceiling"),
            Row("cabinet", 1, (1.2, 0.45, 1.0), backed=True),
        ),
        (
            ("head chair", "around", "table"), ("chair", "around", "table"), ("table", "in_center", ""),
            ("chandelier", "above", "table"),
        ),
    ),
    "florist_shop_0": Task(
        (
            Row("large table", 1, (2.2, 1.1, 0.8)), Row("terrarium", 3, (0.5, 0.5, 0.9)),
            Row("potting station", 2, (1.2, 0.6, 0.9), backed=True),
            Row("succulent", 15, (0.15, 0.15, 0.2), "large table"),
            Row("pruning shears", 2, (0.2, 0.06, 0.02), "potting station"),
            Row("gloves", 2, (0.2, 0.15, 0.03), "potting station"),
            Row("watering can", 2, (0.35, 0.2, 0.3), "potting station"), Row("fertilizer", 2, (0.4, 0.25, 0.5)),
            Row("plant markers", 1, (0.1, 0.1, 0.1), "potting station"), Row("apron", 1, (0.5, 0.05, 0.8), "wall"),
            Row("bucket", 4, (0.3, 0.3, 0.35)), Row("shelf", 2, _SHELF, backed=True),
        ),
        (
            ("large table", "in_center", ""),
            ("terrarium", "next_to", "large table"),
            ("potting station", "facing", "large table"),
        ),
    ),
    "game_room_0": Task(
        (
            Row("ping pong table", 1, (2.74, 1.53, 0.76)), Row("foosball table", 1, (1.4, 0.75, 0.9)),
            Row("bar stool", 4, (0.4, 0.4, 0.75)), Row("bar table", 1, (1.0, 1.0, 1.05)),
            Row("arcade machine", 2, (0.75, 0.85, 1.75), backed=True), Row("dart board", 1, (0.45, 0.05, 0.45), "wall"),
            Row("popcorn machine", 1, (0.5, 0.5, 1.5)), Row("vending machine", 1, (0.9, 0.8, 1.85), backed=True),
            Row("air hockey table", 1, (2.1, 1.2, 0.8)),
        ),
        (
            ("ping pong table", "in_center", ""),
            ("foosball table", "aligned_with", "ping pong table"),
            ("bar stool", "around", "bar table"),
        ),
    ),
    "living_room_0": Task(
        (
            Row("loveseat", 1, (1.5, 0.85, 0.8)), Row("coffee table", 1, (0.9, 0.5, 0.42)),
            Row("tv stand", 1, (1.3, 0.4, 0.5), backed=True), Row("rug", 1, (2.0, 1.4, 0.02)),
            Row("floor lamp", 1, (0.3, 0.3, 1.6)), Row("throw pillow", 4, (0.35, 0.15, 0.3), "loveseat"),
            Row("coaster", 4, (0.1, 0.1, 0.01), "coffee table"),
            Row("remote control", 1, (0.05, 0.18, 0.02), "coffee table"),
            Row("blanket", 1, (0.4, 0.3, 0.05), "loveseat"), Row("plant", 1, (0.4, 0.4, 1.0)),
        ),
        (
            ("loveseat", "in_center", ""), ("loveseat", "facing", "tv stand"), ("loveseat", "facing", "coffee table"),
            ("coffee table", "next_to", "loveseat"), ("tv stand", "against_wall", ""), ("rug", "under", "coffee table"),
        ),
    ),
}  # fmt: skip


def tasks() -> Iterator[tuple[str, Problem]]:
    """Name and problem of each task; none where the data is absent."""
    folder: Path | None = _data.folder("layout_tasks")
    for name, task in TASKS.items() if folder is not None else ():
        assert folder is not None
        written = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        corners = written["boundary"]["floor_vertices"]  # rectangles, all of them
        width, depth = (max(c[k] for c in corners) - min(c[k] for c in corners) for k in (0, 1))
        yield name, _problem(task, (float(width), float(depth), _HEIGHT))


def _problem(task: Task, size: tuple[float, float, float]) -> Problem:
    counts = {r.label: r.number for r in task.rows}
    items = [
        Item(
            id=f"{r.label} {k + 1}",
            label=r.label,
            size=r.size,
            support=f"{r.support} {k % counts[r.support] + 1}" if r.support in counts else r.support,
            backed=r.backed,
        )
        for r in task.rows
        for k in range(r.number)
    ]
    return Problem(size=size, items=tuple(items), wishes=tuple(_wishes(task, counts)))


def _wishes(task: Task, counts: dict[str, int]) -> Iterator[Wish]:
    for subject, name, other in task.wishes:
        for k in range(counts[subject]):
            if other == "*":
                objects: tuple[str, ...] = (f"{subject} 1",)
            else:
                objects = (f"{other} {k % counts[other] + 1}",) if other else ()
            if objects != (f"{subject} {k + 1}",):
                yield Wish.model_validate({"subject": f"{subject} {k + 1}", "name": name, "objects": objects})
    for subject, side in (("head chair 1", "left_of"), ("head chair 2", "right_of")) if "head chair" in counts else ():
        yield Wish.model_validate({"subject": subject, "name": side, "objects": ("table 1",)})
