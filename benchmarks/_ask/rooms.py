"""The rooms of the generated questions: true tables of furnished rooms and of composed graphs, and their surveys."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.color import BASIC, name_of, plain_color, rgb_to_lab
from ...gaussians.harmonics import dc_to_color
from ...gaussians.language.encoders import Encoder
from ...gaussians.world import kinds
from ...gaussians.world.person import EYE_HEIGHT
from ...planners.compose.api import compose
from ...planners.compose.knowledge import rooms as room_kinds
from ...planners.questions.survey import Survey
from ...planners.rooms.graph import SceneGraph
from ...planners.rooms.node import Node, RoomShape, Viewpoint
from .._select.cases import Case
from .truth import Table, Thing

FAIR = 0.15  # share of a surface from which a colour term may be said of a thing
MOSTLY = 0.5  # share from which it is its colour
SAMPLED = 400  # Gaussians of a thing whose colours are named
DIVIDER = (0.06, 1.8)  # depth and height of a screen across a room, metres


@dataclass(frozen=True, eq=False)
class Known:
    """A room with its truth, and what the product sees of it.

    Attributes:
        table: the truth.
        survey: what questions are answered from.
        case: the embedded scene, None for a written graph.
    """

    table: Table
    survey: Survey
    case: Case | None = None


def table_of_graph(graph: SceneGraph, name: str, seed: int) -> Table:
    """The table of a written graph: its nodes are the truth. Nodes with names in place of numbers are numbered."""
    number = {n.id: i for i, n in enumerate(graph.nodes)}
    things = tuple(
        Thing(
            i,
            canonical(n.label),
            plain_color(n.color) if n.color else "",
            frozenset({plain_color(n.color)} if n.color else ()),
            n.size,
            n.position,
            n.yaw,
            number.get(n.support, n.support) if n.support not in ("floor", "wall", "ceiling") else n.support,
        )
        for i, n in enumerate(graph.nodes)
    )
    width, depth, height = graph.room.size
    return Table(name, seed, (width, depth, height), things, (0.0, -depth / 2 - 1.0), (0.0, 1.0))


def canonical(label: str) -> str:
    """The name of a label's kind."""
    kind = kinds.find(label)
    return kind.name if kind is not None else label


def table_of_case(case: Case, size: tuple[float, float, float], camera: Camera) -> Table:
    """The table of a furnished room: true boxes and labels, and colours as the paint of the true Gaussians has them."""
    paint = _labs(case)
    things = tuple(
        Thing(o.id, o.kind, *_color(o.color, paint[case.ids == o.id], o.id), o.size, o.position, o.yaw, o.support)
        for o in case.objects
    )
    ahead = np.array(camera.forward[:2])
    ahead /= np.linalg.norm(ahead)
    eye = camera.position
    return Table(
        f"furnished {case.seed}", case.seed, size, things, (float(eye[0]), float(eye[1])), tuple(ahead.tolist())
    )


def graph_of_table(table: Table) -> SceneGraph:
    """A true table as a graph before its viewer: what an embedding without a fault would find."""
    nodes = tuple(
        Node(
            id=t.id, label=t.label, color=t.color or min(t.shades, default=""), size=t.size, position=t.center,
            yaw=t.yaw, support=t.support,
        )
        for t in table.things
    )  # fmt: skip
    eye, ahead = np.array([*table.eye, EYE_HEIGHT]), np.array([*table.forward, 0.0])
    viewer = Viewpoint(position=tuple(eye.tolist()), target=tuple((eye + ahead).tolist()))
    return SceneGraph(room=RoomShape(size=table.size), nodes=nodes, viewer=viewer)


def without_faults(known: Known) -> Known:
    """The same room, known by its true table."""
    return Known(known.table, Survey.of_graph(graph_of_table(known.table)))


def _labs(case: Case) -> NDArray[np.float64]:
    """`[N, 3]` the colour of each Gaussian without its harmonics, CIE Lab."""
    rgb = dc_to_color(case.scene.cloud.sh[:, 0]).clamp(0, 1)
    return np.asarray(rgb_to_lab(rgb.double()).numpy())


def _color(nominal: str, paint: NDArray[np.float64], seed: int) -> tuple[str, frozenset[str]]:
    """The basic term that names most of a thing's surface and its nominal paint, "" if they differ, and all terms
    that name a fair share of it."""
    nominal = plain_color(nominal)
    rows = np.random.default_rng(seed).permutation(len(paint))[:SAMPLED]
    named = Counter(basic(torch.from_numpy(paint[r])) for r in rows)
    shades = frozenset({nominal, *(c for c, n in named.items() if n >= FAIR * max(len(rows), 1))})
    mean = basic(torch.from_numpy(paint.mean(axis=0))) if len(paint) else ""
    clear = named[nominal] >= MOSTLY * len(rows) and mean == nominal
    return (nominal if clear else ""), shades


def basic(lab: torch.Tensor) -> str:
    """The basic colour term of a Lab value, without "dark" and "light"."""
    word = name_of(lab).split()[-1]
    return word if word in BASIC else plain_color(word)


def graphs(count: int, seed: int) -> list[tuple[str, int, SceneGraph]]:
    """Composed rooms of all kinds in turn, each with its name and the seed that it was composed from."""
    names = [k for k in room_kinds() if k != "room"]
    made = []
    for i in range(count):
        kind = names[i % len(names)]
        made.append((f"{kind} {seed + i}", seed + i, compose(kind, seed=seed + i, planner="grammar", best=True)))
    return made


def of_graphs(count: int, seed: int) -> list[Known]:
    """Composed rooms, known by their graphs alone; every third one is divided by a screen where one fits."""
    made = []
    for i, (name, own, graph) in enumerate(graphs(count, seed)):
        shown = divided(graph) if i % 3 == 0 else graph
        made.append(Known(table_of_graph(shown, name, own), Survey.of_graph(shown)))
    return made


def divided(graph: SceneGraph) -> SceneGraph:
    """The graph with a screen from wall to wall at the place nearest the middle that nothing stands at, if any."""
    width, depth, _ = graph.room.size
    table = table_of_graph(graph, "", 0)
    standing = [t for t in table.things if t.low < DIVIDER[1]]
    reach = [(t.corners[:, 1].min() - 0.02, t.corners[:, 1].max() + 0.02) for t in standing]
    for y in sorted(np.arange(-0.3 * depth, 0.3 * depth, 0.05).tolist(), key=abs):
        if not any(low < y + DIVIDER[0] / 2 and y - DIVIDER[0] / 2 < high for low, high in reach):
            screen = Node(
                id=max(int(n.id) for n in graph.nodes) + 1, label="folding screen", color="beige",
                size=(width, *DIVIDER), position=(0.0, y, DIVIDER[1] / 2),
            )  # fmt: skip
            return graph.model_copy(update={"nodes": (*graph.nodes, screen)})
    return graph


def surveyed(case: Case, size: tuple[float, float, float], encoder: Encoder, camera: Camera | None = None) -> Known:
    """An embedded furnished room before a viewer (its overview)."""
    viewer = camera or case.scene.cameras[0]
    return Known(table_of_case(case, size, viewer), Survey.of_scene(case.scene, viewer, encoder), case)


def labels(things: Sequence[Thing]) -> tuple[str, ...]:
    """The labels of things."""
    return tuple(t.label for t in things)
