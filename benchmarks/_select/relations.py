"""Queries by relation in rooms: clear cases computed from the true boxes, from several cameras and mirrored.

Each query is resolved on the default field, and on a field over the true objects, which shows the loss by segmentation.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal

import numpy as np

from ...gaussians import assets
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.camera import Camera
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.query.query import Query
from ..harness import Metric
from . import spatial, staged
from .cases import Case, Part, ask
from .mirror import mirrored
from .spatial import Solid

MAX_FOUND, MAX_ABSENT = 3, 1  # queries for each relation, room and camera: with an answer, and without
EYES = 3  # cameras of each room
GOAL = 0.95
NAMES = (*spatial.SIDES, "on", "under", "above", "inside", "next_to", "between", "nearest_to", "farthest_from")
# Things whose front is beyond doubt, so that "to the left of the sofa" in its own frame is too.
FRONTED = frozenset({"armchair", "chair", "sofa", "office chair", "piano", "television", "fridge", "stove", "wardrobe"})
Frame = Literal["viewer", "object"]


@dataclass(frozen=True)
class Asked:
    """A relation query of one eye, and the id of the object that it means; None where nothing stands so."""

    name: str
    query: Query
    eye: int
    object: int | None
    frame: Frame = "viewer"


def generate(case: Case, eyes: Sequence[int]) -> list[Asked]:
    """Queries of a room with one clear answer: at most `MAX_FOUND` for each relation and camera, drawn by its seed.

    An anchor is a kind that the room has once. The target is a kind of which exactly one clearly has the relation and
    every other clearly does not; or none has it, and the right answer is "absent".
    """
    rng = np.random.default_rng([zlib.crc32(b"relations"), case.seed])
    solids = [Solid(o) for o in case.objects]
    chosen: list[Asked] = []
    for eye in eyes:
        every = list(_all(case, solids, eye))
        taken: Counter[tuple[str, Frame, bool]] = Counter()
        for one in (every[i] for i in rng.permutation(len(every))):
            key = one.name, one.frame, one.object is None
            if taken[key] < (MAX_ABSENT if one.object is None else MAX_FOUND):
                taken[key] += 1
                chosen.append(one)
    return chosen


def _all(case: Case, solids: list[Solid], eye: int) -> Iterator[Asked]:
    viewer = case.scene.cameras[eye]
    kinds = {k: [s for s in solids if s.thing.kind == k] for k in sorted(case.present)}
    anchors = [of[0] for of in kinds.values() if len(of) == 1]
    for name in NAMES:
        beside = name in spatial.SIDES
        if eye and not beside:  # what does not depend on the eye is asked once
            continue
        groups = list(combinations(anchors, 2)) if name == "between" else [(a,) for a in anchors]
        for around in groups:
            for kind, things in kinds.items():
                if any(a.thing.kind == kind for a in around):
                    continue
                if beside and not all(_in_view(s, viewer) for s in (*things, *around)):
                    continue
                yield from _one(name, things, around, viewer, eye)


def _one(name: str, things: list[Solid], around: tuple[Solid, ...], viewer: Camera, eye: int) -> Iterator[Asked]:
    if name in ("nearest_to", "farthest_from"):
        first = spatial.extreme(name, things, around[0])
        if first is not None:
            yield _asked(name, things, around, eye, first.thing.id)
        return
    verdicts = [spatial.stands(name, t, around, viewer) for t in things]
    yield from _if_clear(name, things, around, eye, verdicts, "viewer")
    if name in spatial.SIDES and eye == 0 and around[0].thing.kind in FRONTED:
        verdicts = [spatial.stands_by_object(name, t, around[0]) for t in things]
        yield from _if_clear(name, things, around, eye, verdicts, "object")


def _if_clear(
    name: str, things: list[Solid], around: tuple[Solid, ...], eye: int, verdicts: list[bool | None], frame: Frame
) -> Iterator[Asked]:
    if None not in verdicts and sum(map(bool, verdicts)) <= 1:
        meant = next((t.thing.id for t, v in zip(things, verdicts, strict=True) if v), None)
        yield _asked(name, things, around, eye, meant, frame)


def _asked(
    name: str, things: list[Solid], around: tuple[Solid, ...], eye: int, meant: int | None, frame: Frame = "viewer"
) -> Asked:
    relation = {"name": name, "anchors": [{"text": a.thing.kind} for a in around], "frame": frame}
    return Asked(name, Query.model_validate({"text": things[0].thing.kind, "relations": [relation]}), eye, meant, frame)


def _in_view(solid: Solid, viewer: Camera) -> bool:
    pixels, depth = viewer.project(solid.center[None])
    inside = (pixels[0] >= 0).all() and (pixels[0] <= [viewer.width, viewer.height]).all()
    return bool(depth[0] > 0.3 and inside)


def staged_room(seed: int) -> Case:
    """A room with one thing under, one inside, one on and one above another, and their likes elsewhere."""
    layout = staged.bare("relations", seed)
    rng = layout.rng

    def get(kind: str, **how: Any) -> assets.Asset:
        return assets.make(kind, int(rng.integers(1 << 20)), **how)

    table, basket = get("table"), get("basket", size=(0.5, 0.5, 0.36))
    table_at, cabinet_at, basket_at = staged.stand(layout, [table, get("cabinet"), basket])
    hollow = get("apple", size=(0.14, 0.14, 0.14))
    _pair(layout, hollow, None if basket_at is None else staged.within(layout, hollow, basket_at))
    low = get("ball", size=(0.24, 0.24, 0.24))
    _pair(layout, low, None if table_at is None else staged.beneath(layout, low, table_at))
    vase = get("vase")
    _pair(layout, vase, None if cabinet_at is None else layout.on_top(vase, cabinet_at))
    lamp = get("pendant lamp")
    if table_at is not None:
        box = layout.things[table_at].box
        staged.over(layout, lamp, box.x, box.y)
        away = [(sx * 1.8, sy * 1.6) for sx in (-1, 1) for sy in (-1, 1)]
        staged.over(layout, lamp, *max(away, key=lambda p: (p[0] - box.x) ** 2 + (p[1] - box.y) ** 2))
    staged.stand(layout, [get("chair"), get("stool"), get("suitcase")])
    return staged.built(layout, seed)


def _pair(layout: Layout, thing: assets.Asset, first: int | None) -> None:
    """Another of the same design on the floor, if the first found its place."""
    if first is not None:
        layout.anywhere(thing, 0.4, edge=False)


def right(case: Case, asked: Asked, encoder: Encoder) -> bool:
    """Whether the answer is the object meant, or that nothing stands so."""
    answer = ask(case, asked.query, encoder, case.scene.cameras[asked.eye])
    if asked.object is None:
        return answer.verdict == "absent"
    return answer.means(case.truth(case.objects[asked.object]))


def measure(
    rooms: Sequence[Case], encoder: Encoder, grouped: Callable[[Case], Case], with_truth: Callable[[Case], Case]
) -> Part:
    """All queries of all rooms as they are and in the mirror, end to end and over true groups."""
    table: dict[str, list[bool]] = {}
    for room in rooms:
        eyes = range(min(EYES, len(room.scene.cameras)))
        for way, case in (("", room), ("mirrored.", mirrored(room))):
            asked = generate(case, eyes)
            for field, known in (("", grouped(case)), ("true_groups.", with_truth(case))):
                for one in asked:
                    answer = right(known, one, encoder)
                    which = "object_frame" if one.frame == "object" else one.name
                    table.setdefault(f"{field}{which}", []).append(answer)
                    if one.frame == "viewer":
                        table.setdefault(f"{field}{way or 'as_built.'}all", []).append(answer)
                        table.setdefault(f"{field}all", []).append(answer)
    metrics = []
    for key, values in sorted(table.items()):
        goal = GOAL if key in ("all", "mirrored.all") else None
        metrics.append(Metric(f"relation.{key}.right", sum(values) / len(values), "share", "higher", 0.03, goal))
        if not key.startswith("true_groups"):
            metrics.append(Metric(f"relation.{key}.asked", len(values), "count"))
    note = (
        "relations: the benchmark's own definition over the true boxes, clear cases only; in one of four no object "
        f"satisfies the relation. {EYES} viewpoints a room, each room also mirrored. true_groups: with the true "
        "objects as groups"
    )
    return Part(tuple(metrics), notes=(note,))
