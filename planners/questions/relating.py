"""Whether things are on, in, under, above, next to or between others, from what supports them and from their boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...gaussians.world import kinds, relations
from ...gaussians.world.relation_geometry import HOLDS
from ...gaussians.world.support import ALOFT, NO_THINGS, SHELL, is_stepped_on
from .room_places import AT_WALL, wall_of
from .survey import Survey, Thing

_UPRIGHT = ("under", "below", "above")
_CLOSE = 0.5  # metres: of several neighbours those that are told
_NEXT = 1.0  # metres: things farther apart than this are not next to each other, however large they are


def strength(name: str, thing: Thing, anchors: Sequence[Thing], survey: Survey) -> float:
    """How well a relation holds in [0, 1]; it holds from `HOLDS` on.

    A thing is on what supports it and in a shelf or cabinet that supports it; what hangs on a wall is over what stands
    before that wall.
    """
    anchor = anchors[0]
    if thing.row in {a.row for a in anchors}:
        return 0.0
    if anchor.label in SHELL and anchor.node is None:
        return max(_on_shell(name, thing, a, survey) for a in anchors)
    if name in ("on", "inside"):
        return _held(name, thing, anchor, survey)
    if name in _UPRIGHT:
        return _upright(name, thing, anchor, survey)
    if name == "next_to":
        return _beside(thing, anchor, survey)
    if name == "between":
        return _between(thing, anchors, survey)
    return relations.score(name, thing.group, [a.group for a in anchors], survey.stand)


def related(name: str, anchors: Sequence[Thing], survey: Survey) -> list[Thing]:
    """Everything that has a relation to the anchors, the clearest first."""
    scored = [(strength(name, t, anchors, survey), t) for t in survey.things]
    if name == "next_to":
        scored = [(s, t) for s, t in scored if not _is_flat(t)]
        kept = [t for s, t in scored if s >= HOLDS]
        ids = {t.id for t in kept}
        kept = [t for t in kept if t.node is not None and t.node.support not in ids]
        if any(survey.gap(t, anchors[0]) <= _CLOSE for t in kept):  # what is farther is not said to be next to it
            kept = [t for t in kept if survey.gap(t, anchors[0]) <= _CLOSE]
        return sorted(kept, key=lambda t: (round(survey.gap(t, anchors[0]), 2), survey.between_centers(t, anchors[0])))
    kept = [t for s, t in sorted(scored, key=lambda pair: -pair[0]) if s >= HOLDS]
    if name == "between":  # what stands on one of them is told with it
        ids = {t.id for t in kept}
        kept = [t for t in kept if not _is_flat(t) and t.node is not None and t.node.support not in ids]
    return kept


def supporter(thing: Thing, survey: Survey) -> Thing | str:
    """What a thing stands on or hangs from: a thing, or "floor", "wall", "ceiling" or, of what rests on nothing,
    `ALOFT`."""
    assert thing.node is not None
    if thing.node.support in NO_THINGS:
        return str(thing.node.support)
    return survey.thing(thing.node.support)


def _between(thing: Thing, anchors: Sequence[Thing], survey: Survey) -> float:
    """The table's score within the strip that joins both anchors, which is as wide as the wider one; 0 outside it."""
    first, last = (np.array(a.group.box.center[:2]) for a in (anchors[0], anchors[-1]))
    way = last - first
    length = float(np.linalg.norm(way))
    if length < 1e-6:
        return 0.0
    across = np.array([way[1], -way[0], 0.0]) / length
    aside = abs(float((np.array(thing.group.box.center[:2]) - first) @ across[:2])) - thing.group.box.extent(across) / 2
    if aside > max(a.group.box.extent(across) for a in anchors) / 2:
        return 0.0
    return relations.score("between", thing.group, [a.group for a in anchors], survey.stand)


def _on_shell(name: str, thing: Thing, anchor: Thing, survey: Survey) -> float:
    if thing.node is None:
        return 0.0
    if anchor.label == "wall" and name in ("on", "inside", "next_to"):
        wall, gap = wall_of(thing, survey.room)
        there = float(wall.out @ np.array(anchor.group.box.center[:2])) > wall.reach / 2
        held = gap <= AT_WALL if name == "next_to" else thing.node.support == "wall"
        return 1.0 if there and held else 0.0
    if name in ("on", "inside") or (name == "next_to" and anchor.label == "floor"):
        return 1.0 if thing.node.support == anchor.label else 0.0
    return relations.score(name, thing.group, [anchor.group], survey.stand)


def _held(name: str, thing: Thing, anchor: Thing, survey: Survey) -> float:
    if thing.node is None:
        return 0.0
    supported = thing.node.support == anchor.id
    kind = kinds.of(anchor.label)
    box, held = anchor.group.box, thing.group.box
    within = held.center[2] < box.center[2] + box.size[2] / 2
    if name == "inside":
        if supported:
            stores = kind is not None and (kind.stores or kind.holds)
            return 1.0 if within or (stores and kind is not None and not kind.top) else 0.3
        return relations.score("inside", thing.group, [anchor.group], survey.stand)
    if supported:
        return 1.0
    if thing.node.support in ("wall", "ceiling", ALOFT):
        return 0.0
    if thing.node.support not in SHELL and not _is_flat(anchor):
        return 0.0  # it stands on something else
    return relations.score("on", thing.group, [anchor.group], survey.stand) * 0.9


def _upright(name: str, thing: Thing, anchor: Thing, survey: Survey) -> float:
    if thing.node is not None and anchor.node is not None:
        if name == "above" and thing.node.support == anchor.id:
            return 0.3  # it is on it
        if name in ("under", "below") and anchor.node.support == thing.id:
            return 0.6 if not _is_flat(thing) else 0.9
    first, second = thing.group, anchor.group
    hung = [t.node is not None and t.node.support == "wall" for t in (thing, anchor)]
    plain = relations.score(name, first, [second], survey.stand)
    if hung[0] == hung[1]:
        return plain
    if hung[0]:
        first = replace(first, box=survey.stage.inward(first.box))
    else:
        second = replace(second, box=survey.stage.inward(second.box))
    return max(plain, relations.score(name, first, [second], survey.stand))


def _beside(thing: Thing, anchor: Thing, survey: Survey) -> float:
    """Next to each other at about the same height, and neither on the other."""
    for one, other in ((thing, anchor), (anchor, thing)):
        if one.node is not None and one.node.support == other.id:
            return 0.0
        if one.node is not None and one.node.support == "ceiling":
            return 0.0
    up = np.array([0.0, 0.0, 1.0])
    low = max(thing.group.box.bottom(up), anchor.group.box.bottom(up))
    high = min(thing.group.box.top(up), anchor.group.box.top(up))
    if low > high + 0.1 or survey.gap(thing, anchor) > _NEXT:
        return 0.0
    scored = relations.score("next_to", thing.group, [anchor.group], survey.stand)
    return max(scored, 0.6 if survey.gap(thing, anchor) <= 0.3 else 0.0)


def overlaps(thing: Thing, anchor: Thing) -> float:
    """Share of a thing's footprint that lies under or over another."""
    half = np.array(thing.group.box.size[:2]) / 2
    t = np.linspace(-1.0, 1.0, 15)
    grid = np.stack(np.meshgrid(t, t), axis=-1).reshape(-1, 2) * half
    points = np.array(thing.group.box.center) + grid @ np.array(thing.group.box.axes)[:2]
    return float(anchor.group.box.covers(points).mean())


def _is_flat(thing: Thing) -> bool:
    return thing.node is not None and is_stepped_on(thing.node.support, thing.node.size[2])
