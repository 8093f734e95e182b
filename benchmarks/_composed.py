"""Judges composed rooms by what their sentences name: things in number and colour, relations, and things out of place.

The judgement reads the finished scene graph only; `_said_geometry` holds its geometry, so that neither the reader, the
solver nor their measures judge themselves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ..gaussians.world import kinds
from ..gaussians.world.words import normalise
from ..planners.rooms.graph import SceneGraph
from ..planners.rooms.node import Node
from . import _said_geometry as geometry

Case = dict[str, Any]


@dataclass(frozen=True)
class Judged:
    """One room judged.

    Attributes:
        things: for each named thing, whether it is there in the number said.
        colors: for each colour said, whether all things have it.
        relations: for each relation said, whether it holds.
        size: whether the room has the stated size; None where none is stated.
        odd: nouns that nobody would expect there, and how many of them are there.
        strange: labels of things that nobody would expect: listed as odd, or a block that the sentence does not name.
        faults: what is missing or does not hold, a phrase each.
    """

    things: dict[str, bool]
    colors: dict[str, bool]
    relations: dict[str, bool]
    size: bool | None
    odd: tuple[int, int]
    strange: tuple[str, ...]

    @property
    def faults(self) -> list[str]:
        wrong = (
            f"{said}" for part in (self.things, self.colors, self.relations) for said, ok in part.items() if not ok
        )
        return [*wrong, *(["size"] if self.size is False else []), *(f"odd: {label}" for label in self.strange)]


def judge(graph: SceneGraph | None, case: Case) -> Judged:
    """A graph against the sentence it was composed from; None: the sentence was refused, so that nothing is there."""
    nodes = graph.nodes if graph is not None else ()
    wanted = case.get("things", [])
    owned = _assigned(nodes, wanted)
    things, colors = dict[str, bool](), dict[str, bool]()
    for thing, own in zip(wanted, owned, strict=True):
        said = f"{thing['count']} {thing['name'][0]}"
        things[said] = len(own) == thing["count"] or (bool(thing.get("more")) and len(own) > thing["count"])
        if "color" in thing:
            colors[f"{thing['color']} {thing['name'][0]}"] = bool(own) and all(
                _same_color(n.color, thing["color"]) for n in own
            )
    for name in [case["without"]] if isinstance(case.get("without"), str) else case.get("without", []):
        things[f"no {name}"] = graph is not None and not any(named(n.label, [name]) for n in nodes)
    if seats := case.get("seats"):
        things[f"seats for {seats}"] = sum(k.seats for n in nodes if (k := kinds.of(n.label))) >= seats
    relations = {" / ".join(either): graph is not None and any(_holds(graph, s, case) for s in either)
                 for either in case.get("relations", [])}  # fmt: skip
    size = None
    if "size" in case:
        size = graph is not None and math.dist(sorted(graph.room.size[:2]), sorted(case["size"])) < 0.06
    asked = {n.id for own in owned for n in own}
    odd = case.get("odd", [])
    others = [n for n in nodes if n.id not in asked]
    present = [o for o in odd if any(_is_a(n.label, o) for n in others)]
    strange = [n.label for n in others if any(_is_a(n.label, o) for o in odd) or kinds.of(n.label) is None]
    return Judged(things, colors, relations, size, (len(present), len(odd)), tuple(strange))


def _same_color(one: str, other: str) -> bool:
    return one.replace("grey", "gray") == other.replace("grey", "gray")


# ---- names ----------------------------------------------------------------------------------------------------------


def named(label: str, names: Sequence[str]) -> bool:
    """Whether a label is one of these names: other words for its kind, or more or fewer words before it."""
    return any(_alike(label, name) for name in names)


def _alike(label: str, name: str) -> bool:
    return _rank(label, name) > 0


def _is_a(label: str, noun: str) -> bool:
    """Whether a label is this noun, another word for it, or a sort of it: a double bed is a bed."""
    said, meant = normalise(label), normalise(noun)
    return _rank(label, noun) > 1 or (bool(meant) and said[-len(meant) :] == meant)


def _rank(label: str, name: str) -> int:
    """How well a label fits a name: 3 the same words, 2 the same kind, 1 the same head with more or fewer words."""
    said, meant = normalise(label), normalise(name)
    if said == meant:
        return 3
    one, other = kinds.find(label), kinds.find(name)
    if one is not None and other is not None and (one.one or one.name) == (other.one or other.name):
        return 2
    shorter, longer = sorted((said, meant), key=len)
    return int(bool(shorter) and longer[-len(shorter) :] == shorter)


def _assigned(nodes: Sequence[Node], wanted: Sequence[Case]) -> list[list[Node]]:
    """For each wanted thing its nodes; a node that fits several goes to the one that it fits best.

    Where as many nodes as were said fit one of the names closely, those that fit loosely are others: a dining table
    beside the side table that was asked for.
    """
    owned: list[list[Node]] = [[] for _ in wanted]
    for node in nodes:
        ranks = [max((_rank(node.label, name) for name in t["name"]), default=0) for t in wanted]
        if ranks and max(ranks) > 0:
            owned[ranks.index(max(ranks))].append(node)
    return [_closest(found, thing) for found, thing in zip(owned, wanted, strict=True)]


def _closest(found: Sequence[Node], thing: Case) -> list[Node]:
    for least in (3, 2, 1):
        for name in thing["name"]:
            close = [n for n in found if _rank(n.label, name) >= least]
            if len(close) == thing["count"]:
                return close
    return list(found)


# ---- relations ------------------------------------------------------------------------------------------------------


def _holds(graph: SceneGraph, said: str, case: Case) -> bool:
    """Whether "subject relation object" holds for the things that these words name: for all subjects, each with an
    object of its own where there are as many."""
    parts = _parsed(said)
    if parts is None:
        return False
    subject, name, objects = parts
    subjects = _called(graph, subject, case)
    if not subjects:
        return False
    if name in geometry.GROUPS:
        return geometry.GROUPS[name](subjects)
    if name in geometry.ROOM:
        return all(geometry.ROOM[name](n, graph) for n in subjects)
    groups = [_called(graph, o, case) for o in objects]
    if any(not g for g in groups) or not groups:
        return False
    if name == "between":
        ends = (groups[0], groups[-1])
        return all(any(geometry.between(s, a, b) for a in ends[0] for b in ends[1] if len({a.id, b.id, s.id}) == 3)
                   for s in subjects)  # fmt: skip
    holds = geometry.PAIRS[name]
    near = {s.id: [o for o in groups[0] if o.id != s.id and holds(s, o, graph)] for s in subjects}
    if not all(near.values()):
        return False
    return name not in ("on", "around", "inside") or _shared_out(near, len(subjects), groups[0])


def _shared_out(near: dict[Any, list[Node]], count: int, objects: Sequence[Node]) -> bool:
    """Whether subjects are with as many objects as possible: of four lamps on four desks, each has its own."""
    reached = {o.id for found in near.values() for o in found}
    return len(reached) >= min(count, len(objects)) or count < len(objects) // 2


def _parsed(said: str) -> tuple[str, str, list[str]] | None:
    words = said.split()
    for i, word in enumerate(words):
        if i and word in geometry.NAMES:
            rest = " ".join(w for w in words[i + 1 :])
            objects = [o for o in rest.replace(" and ", ",").split(",") if o.strip()]
            return " ".join(words[:i]), word, [o.strip() for o in objects]
    return None


def _called(graph: SceneGraph, name: str, case: Case) -> list[Node]:
    """The nodes that a word of a relation means: those of the named thing with this name, else all with this label."""
    wanted = case.get("things", [])
    owned = _assigned(graph.nodes, wanted)
    fit = [max(_rank(alias, name) for alias in t["name"]) for t in wanted]
    if fit and max(fit) > 0:
        return [n for own, rank in zip(owned, fit, strict=True) if rank == max(fit) for n in own]
    return [n for n in graph.nodes if named(n.label, [name])]


def shares(found: Sequence[Judged], part: str) -> tuple[int, int]:
    """How many of the named things, colours or relations are as said, and how many were named."""
    kept = [ok for j in found for ok in getattr(j, part).values()]
    return sum(kept), len(kept)


def faults(found: Sequence[tuple[Case, Judged]]) -> Iterator[str]:
    """Lines for a reader: each room with what is not as said."""
    for case, judged in found:
        if judged.faults:
            yield f"{case['text'][:70]}: {'; '.join(judged.faults)}"
