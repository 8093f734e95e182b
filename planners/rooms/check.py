"""The checker of scene graphs: collisions, bounds of the room, support, stated relations and reachability.

It treats every graph alike, whatever made it. Each violation is a sentence with ids and measured numbers. Boxes are
solid: a chair pushed under a table collides with it, unless the graph states that it is under it and it fits there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...gaussians.world import everyday, relations, support
from ...gaussians.world.box import Boxes, overlap
from ...gaussians.world.relation_geometry import HOLDS, degrees_aside
from ...gaussians.world.support import SHELL
from .graph import SceneGraph
from .graph_scene import Stage
from .node import Node
from .reachability import unreached

Kind = Literal["collision", "bounds", "support", "relation", "reach"]
Id = int | str

TOUCHING = 0.01  # metres that boxes may overlap each other or a wall: people round to centimetres when they write


@dataclass(frozen=True)
class Violation:
    """One fault of a graph.

    Attributes:
        kind: what was checked.
        ids: the nodes it is about.
        measured: size of the fault, in `unit`.
        unit: "m", or "1" for a share.
        sentence: for a person, with ids and numbers.
    """

    kind: Kind
    ids: tuple[Id, ...]
    measured: float
    unit: str
    sentence: str


@dataclass(frozen=True)
class Report:
    """The result of a check.

    Attributes:
        violations: in the order of the checks, then of the nodes.
        checked: how many pairs, nodes or stated relations each check covered.
        unchecked: a sentence for each statement that cannot be checked.
    """

    violations: tuple[Violation, ...]
    checked: dict[str, int]
    unchecked: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether nothing is wrong."""
        return not self.violations


def check(graph: SceneGraph) -> Report:
    """Everything that is wrong with a graph: collisions, bounds, support, stated relations, reachability."""
    stated, unchecked = _relations(graph)
    found = [*_collisions(graph), *_out_of_bounds(graph), *_unsupported(graph), *stated, *_out_of_reach(graph)]
    count = len(graph.nodes)
    checked = {
        "collision": count * (count - 1) // 2,
        "bounds": count,
        "support": count,
        "relation": len(graph.relations) - len(unchecked),
        "reach": count,
    }
    return Report(tuple(found), checked, unchecked)


def _called(node: Node) -> str:
    return f"{node.label or 'thing'} ({node.id})"


def _collisions(graph: SceneGraph) -> Iterator[Violation]:
    """Pairs of overlapping boxes, by the separating axes of their footprints and their heights."""
    carried = {n.id: set(_carriers(graph, n)) for n in graph.nodes}
    sheltered = set(_sheltered(graph))
    middles = np.array([n.position for n in graph.nodes]).reshape(-1, 3)
    reach = np.array([np.linalg.norm(n.size) / 2 for n in graph.nodes])
    for i, a in enumerate(graph.nodes):
        near = np.linalg.norm(middles[i + 1 :] - middles[i], axis=1) < reach[i + 1 :] + reach[i]
        for b in (graph.nodes[i + 1 + int(j)] for j in np.flatnonzero(near)):
            if b.id in carried[a.id] or a.id in carried[b.id] or a.is_stepped_on or b.is_stepped_on:
                continue  # a thing on a shelf or a seat is inside its box; things stand on rugs
            if (a.id, b.id) in sheltered or (b.id, a.id) in sheltered:
                continue
            depth = overlap(a.box, b.box)
            if depth > TOUCHING:
                said = f"{_called(a)} and {_called(b)} are {depth:.2f} m in each other"
                yield Violation("collision", (a.id, b.id), depth, "m", said)


def _sheltered(graph: SceneGraph) -> Iterator[tuple[Id, Id]]:
    """Pairs of which the first is stated to be under the second, is there, and fits between its legs or below its
    crown: a box under a table, a bench under a tree."""
    said = [(a, b) for a, name, b in graph.relations if (k := relations.stated(name)) and k.name in ("under", "below")]
    if not said:
        return
    nodes, stage = {n.id: n for n in graph.nodes}, Stage.of(graph)
    for a, b in said:
        one, other = nodes[a], nodes[b]
        fits = one.top <= other.bottom + everyday.free_beneath(other.label, other.size[2]) + TOUCHING
        if fits and _score(stage, "under", one, other) >= HOLDS:
            yield a, b


def _carriers(graph: SceneGraph, node: Node) -> Iterator[Id]:
    """What a node stands on, and what that stands on, up to floor, wall or ceiling or a second visit."""
    nodes, seen = {n.id: n for n in graph.nodes}, set[Id]()
    at = node.support
    while at in nodes and at not in seen:
        seen.add(at)
        yield at
        at = nodes[at].support


def _out_of_bounds(graph: SceneGraph) -> Iterator[Violation]:
    """Boxes that reach out of the room; what is fixed to a wall may be let into it."""
    width, depth, height = graph.room.size
    for node in graph.nodes:
        corners = node.box.corners()
        low, high = corners.min(axis=0), corners.max(axis=0)
        inward = support.FIXED if node.support in ("wall", "ceiling") else TOUCHING
        out = {
            "left of the room": -width / 2 - low[0], "right of the room": high[0] - width / 2,
            "in front of the room": -depth / 2 - low[1], "behind the room": high[1] - depth / 2,
            "below the floor": -low[2],
            "above the ceiling": 0.0 if graph.room.outdoor else high[2] - height,
        }  # fmt: skip
        for side, far in out.items():
            if far > inward:
                said = f"{_called(node)} reaches {far:.2f} m {side}"
                yield Violation("bounds", (node.id,), float(far), "m", said)


def _unsupported(graph: SceneGraph) -> Iterator[Violation]:
    """Nodes that do not stand, lie or hang on their stated support."""
    nodes = {n.id: n for n in graph.nodes}
    ground = max((n.top for n in graph.nodes if n.is_stepped_on), default=0.0)
    for node in graph.nodes:
        if node.support == "floor":
            yield from _standing(node, ground)
        elif node.support in SHELL:
            yield from _hanging(node, graph)
        elif node.id in set(_carriers(graph, node)):
            yield Violation("support", (node.id, node.support), 0.0, "m", f"{_called(node)} ends up standing on itself")
        else:
            yield from _carried(node, nodes[node.support])


def _standing(node: Node, ground: float) -> Iterator[Violation]:
    """On the floor, or on a rug."""
    if node.bottom > max(ground, 0.0) + support.AIR:
        yield Violation(
            "support", (node.id,), node.bottom, "m", f"{_called(node)} floats {node.bottom:.2f} m above the floor"
        )


def _hanging(node: Node, graph: SceneGraph) -> Iterator[Violation]:
    """On a wall or the ceiling."""
    wall = node.support == "wall"
    gap = support.wall_gap(node.yaw_box, graph.room.size) if wall else graph.room.size[2] - node.top
    if gap > support.FIXED:
        said = f"{_called(node)} is {gap:.2f} m away from the {'nearest wall' if wall else 'ceiling'}"
        yield Violation("support", (node.id,), gap, "m", said)


def _carried(node: Node, lower: Node) -> Iterator[Violation]:
    """On top of another thing, or within its box: on a seat, on a shelf, in a box."""
    aside = support.aside(node.yaw_box, lower.yaw_box)
    if aside > 0:
        said = f"the middle of {_called(node)} is {aside:.2f} m off {_called(lower)}, on which it is said to stand"
        yield Violation("support", (node.id, lower.id), aside, "m", said)
    gap = support.air(node.yaw_box, lower.yaw_box)
    if gap > support.AIR:
        where = "above" if node.bottom > lower.top else "below the underside of"
        said = f"{_called(node)} is {gap:.2f} m {where} {_called(lower)}, on which it is said to stand"
        yield Violation("support", (node.id, lower.id), gap, "m", said)


def _relations(graph: SceneGraph) -> tuple[list[Violation], tuple[str, ...]]:
    """Stated relations that do not hold, and those that cannot be checked, as the resolver of queries sees them."""
    nodes, found, unchecked = {n.id: n for n in graph.nodes}, list[Violation](), list[str]()
    stage = Stage.of(graph)
    for a, said, b in graph.relations:
        kind = relations.stated(said)
        one, other = nodes[a], nodes[b]
        if kind is None:
            unchecked.append(f"{_called(one)} {said} {_called(other)}: this relation is not known")
        elif (score := _score(stage, kind.name, one, other)) >= HOLDS:
            continue
        elif kind.name == "facing":
            off = float(degrees_aside(Boxes.of([one.box]), Boxes.of([other.box]))[0])
            sentence = f"{_called(one)} is said to face {_called(other)}, which is {off:.0f} degrees off its front"
            found.append(Violation("relation", (a, b), off, "degrees", sentence))
        else:
            sentence = f"{_called(one)} is said to be {said} {_called(other)}; it scores {score:.2f}, 0.5 is needed"
            found.append(Violation("relation", (a, b), score, "1", sentence))
    return found, tuple(unchecked)


def _score(stage: Stage, name: str, one: Node, other: Node) -> float:
    """Score of a relation, 0 to 1; a node on its stated support counts as "on" if the support check accepts it."""
    if name == "on" and one.support == other.id and not any(_carried(one, other)):
        return 1.0
    anchor = stage.group(stage.ids.index(other.id))
    return float(relations.scores(name, Boxes.of([one.box]), [anchor], stage.stand)[0])


def _out_of_reach(graph: SceneGraph) -> Iterator[Violation]:
    """Things on the floor that nobody can walk up to."""
    for node, distance in unreached(graph):
        told = f"{distance:.2f} m" if math.isfinite(distance) else "any distance"
        said = f"{_called(node)} cannot be walked up to: the nearest place one can get to is {told} away"
        yield Violation("reach", (node.id,), distance if math.isfinite(distance) else -1.0, "m", said)


def sentences(violations: Sequence[Violation]) -> list[str]:
    """The violations as lines of text."""
    return [f"{v.kind}: {v.sentence}" for v in violations]
