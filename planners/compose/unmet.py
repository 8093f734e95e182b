"""List what a sentence asks for and the composed room does not have as asked for, a line each."""

from __future__ import annotations

from collections.abc import Iterator

from ..layout.problem import Item, Layout
from ..layout.sentences import describe_wish
from ..rooms.node import NodeId
from .brief import Brief
from .problems import Posed

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
    lost = [w for w in layout.broken if w in posed.stated and {w.subject, *w.objects} <= there]
    for wish in lost[:_MOST]:
        yield f"does not hold: {describe_wish(wish, items.__getitem__)}"
    if len(lost) > _MOST:
        yield f"{len(lost) - _MOST} more relations do not hold"
