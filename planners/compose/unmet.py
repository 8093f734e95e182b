"""List what a sentence asks for and the composed room does not have as asked for, a line each."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...gaussians.world.box import to_world
from ..layout.problem import Item, Layout
from ..layout.sentences import describe_wish
from ..rooms.node import Node, NodeId
from .brief import Brief
from .problems import Posed

_TURNED = 48.0  # degrees, largest angle between the front of one of a row and what the row faces
_MOST = 12  # lines about relations; further ones are counted


def unmet_wishes(brief: Brief, posed: Posed, layout: Layout) -> tuple[str, ...]:
    """A sentence for each thing that is missing and each stated relation that does not hold."""
    return tuple((*_missing(brief, posed, layout), *_broken(posed, layout)))


def _missing(brief: Brief, posed: Posed, layout: Layout) -> Iterator[str]:
    """Things of which fewer are there than were asked for."""
    there = {n.id for n in layout.graph.nodes}
    counts: dict[str, int] = {}
    for id, key in posed.names.items():
        counts[key] = counts.get(key, 0) + (id in there)
    labels = [n.label for n in layout.graph.nodes]
    for thing in brief.things:
        found = counts.get(thing.id, 0)
        if thing.name in ("door", "window"):
            found = labels.count(thing.name)
        if thing.name != "beam" and not thing.optional and found < thing.count:
            name = thing.called or thing.name
            yield f"only {found} of {thing.count} “{name}” are there" if found else f"there is no {name}"


def _broken(posed: Posed, layout: Layout) -> Iterator[str]:
    """Stated relations that do not hold, those of formations included, of which only the middle one must."""
    items: dict[NodeId, Item] = {i.id: i for i in posed.problem.items}
    there = {n.id for n in layout.graph.nodes}
    nodes = {n.id: n for n in layout.graph.nodes}
    lost = [w for w in layout.broken if w in posed.stated and {w.subject, *w.objects} <= there]
    lost = [w for w in lost if w.hard or w.name != "facing" or not _looks_at(nodes[w.subject], nodes[w.objects[0]])]
    for wish in lost[:_MOST]:
        yield f"does not hold: {describe_wish(wish, items.__getitem__)}"
    if len(lost) > _MOST:
        yield f"{len(lost) - _MOST} more relations do not hold"


def _looks_at(one: Node, other: Node) -> bool:
    """Whether one is turned to any part of the other: of a row before a wide stage, the ends are as well."""
    box, (x, y, _) = other.yaw_box, one.position
    u, v = box.local(x, y)
    half_w, half_d = box.w / 2, box.d / 2
    tx, ty = to_world(box.x, box.y, box.yaw, max(-half_w, min(half_w, u)), max(-half_d, min(half_d, v)))
    fx, fy = one.yaw_box.front
    reach = math.hypot(tx - x, ty - y)
    return fx * (tx - x) + fy * (ty - y) >= math.cos(math.radians(_TURNED)) * reach
