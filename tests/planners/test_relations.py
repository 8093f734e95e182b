"""One table of relations: every consumer knows every entry, and an entry is all that a new one takes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenewright
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.world import relations
from scenewright.gaussians.world.box import YawBox
from scenewright.planners.compose.brief import Brief
from scenewright.planners.compose.compose import compose
from scenewright.planners.compose.sentence.read import read
from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.layout.measures import measure
from scenewright.planners.layout.problem import Problem
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import Node, RoomShape, SceneGraph
from scenewright.planners.rooms.graph_scene import Stage
from scenewright.tools.operation import Placement

ROOM = (5.0, 4.0, 2.5)
KINDS = relations.KINDS


def enums(schema: Any) -> list[tuple[str, ...]]:
    """Every enumeration of a JSON schema."""
    if isinstance(schema, dict):
        own = [tuple(schema["enum"])] if "enum" in schema else []
        return own + [e for value in schema.values() for e in enums(value)]
    return [e for value in schema for e in enums(value)] if isinstance(schema, list) else []


def node(id: str, x: float, y: float, yaw: float = 0.0) -> Node:
    size = (0.9, 0.1, 2.0) if id == "door" else (0.5, 0.5, 0.9)
    return Node(id=id, label=id.split()[0], size=size, position=(x, y, size[2] / 2), yaw=yaw)


def graph(*nodes: Node, stated: str = "") -> SceneGraph:
    said = ((nodes[0].id, stated, nodes[1].id),) if stated else ()
    return SceneGraph(room=RoomShape(size=ROOM), nodes=nodes, relations=said)


# -- the table -------------------------------------------------------------------------------------------------------


def test_names_aliases_and_phrases_mean_one_relation_each() -> None:
    names = [n for kind in KINDS for n in (kind.name, *kind.aliases)]
    assert len(names) == len(set(names))
    for listed in ("in_commands", "in_descriptions", "in_reverse"):
        for phrases in ("phrases", "alone"):
            said = [p for kind in KINDS for p in getattr(getattr(kind, phrases), listed)()]
            assert len(said) == len(set(said)), listed


def test_entries_are_complete() -> None:
    for kind in KINDS:
        assert set(kind.uses.split()) <= {"query", "placement", "wish", "stated"} and kind.uses, kind.name
        assert ("{}" in kind.words) == bool(kind.anchors), kind.name
        assert not kind.used("stated") or (kind.score is not None and kind.anchors == 1), kind.name
        assert not kind.used("query") or kind.score is not None or kind.orders or kind.name == "part_of", kind.name
        if kind.inverse:
            assert relations.named(kind.inverse).inverse == kind.name
        for other in filter(None, (kind.query_as, kind.placement_as)):
            relations.named(other)


def test_schemas_enumerate_the_table() -> None:
    assert relations.names("query") in enums(Query.model_json_schema())
    assert relations.names("placement") in enums(Placement.model_json_schema())
    assert relations.names("wish") in enums(Problem.model_json_schema())
    assert relations.names("wish") in enums(Brief.model_json_schema())


# -- each consumer ---------------------------------------------------------------------------------------------------

ASKED = [k for k in KINDS if list(k.phrases.in_commands()) and k.anchors == 1 and k.name != "center"]
DESCRIBED = [k for k in KINDS if k.used("wish") and k.anchors == 1]


@pytest.mark.parametrize("kind", ASKED, ids=lambda kind: str(kind.name))
def test_the_grammar_reads_every_phrase_of_commands(kind: relations.RelationKind) -> None:
    for phrase in kind.phrases.in_commands():
        plan = GrammarPlanner().plan(f"select the chair {phrase} the door")
        named = [r.name for op in plan.ops for r in op.target.relations]
        assert named == [kind.query_as or kind.name], phrase


@pytest.mark.parametrize("kind", DESCRIBED, ids=lambda kind: str(kind.name))
def test_descriptions_of_rooms_become_wishes(kind: relations.RelationKind) -> None:
    phrase = next(iter(kind.phrases.in_descriptions()))
    brief = read(f"a room with a bench and a vase {phrase} the bench")
    assert (kind.name, ("bench",)) in [(r.name, r.objects) for r in brief.relations if r.subject == "vase"]


@pytest.mark.parametrize("kind", [k for k in KINDS if k.used("wish")], ids=lambda kind: str(kind.name))
def test_every_wish_is_measured_at_one_place_and_at_many(kind: relations.RelationKind) -> None:
    one, others = YawBox(0.5, 0.2, 0.0, 0.5, 0.5, 0.5), [YawBox(1.0, 1.0, 0.0, 1.0, 0.5, 0.8)] * kind.anchors
    xs, ys = np.linspace(-2, 2, 7), np.linspace(-1.5, 1.5, 7)
    many, costs = measure(kind.name, ROOM, one._replace(x=xs, y=ys), others, [])
    for k in range(7):
        kept, cost = measure(kind.name, ROOM, one._replace(x=xs[k], y=ys[k]), others, [])
        assert bool(np.broadcast_to(many, 7)[k]) == bool(kept)
        assert float(np.broadcast_to(costs, 7)[k]) == pytest.approx(float(cost))


# A score well above where a relation begins: shares are counted by 7 x 7 points, each row a sixth of the width.
CLEARLY = {"above": 0.85, "below": 0.85, "under": 0.85}
MEASURED = [n for n in relations.names("stated") if n not in ("on", "inside")]


def random_box(rng: np.random.Generator) -> YawBox:
    x, y, low = rng.uniform((-2.0, -1.5, 0.0), (2.0, 1.5, 1.2))
    return YawBox(x, y, low, *rng.uniform(0.1, 1.5, 3), float(rng.choice([0.0, 90.0, 180.0, -90.0])))


@pytest.mark.slow
def test_wishes_are_kept_where_the_geometry_says_so_clearly() -> None:
    rng, seen = np.random.default_rng(7), Counter[str]()
    for k in range(1200):
        one, other = random_box(rng), random_box(rng)
        if k % 2:  # one over the other, or nearly
            one = one._replace(x=other.x + rng.normal(0.0, 0.1), y=other.y + rng.normal(0.0, 0.1))
        stage = Stage.of(graph(*(node_of(id, box) for id, box in (("a", one), ("b", other)))))
        for name in MEASURED:
            if name in ("below", "under") and not one.low < other.high - 0.1:
                continue  # the solver wants it lower by more than a box is precise
            if name == "above" and one.low < other.high - 0.01:
                continue  # the solver lets nothing above a thing reach into it
            if relations.score(name, stage.group(0), [stage.group(1)], stage.stand) >= CLEARLY.get(name, 0.56):
                seen[name] += 1
                assert measure(name, ROOM, one, [other], [])[0], (name, one, other)
    assert min(seen[name] for name in MEASURED) >= 10, seen


def node_of(id: str, box: YawBox) -> Node:
    x, y, z = box.box.center
    return Node(id=id, label=id, size=(box.w, box.d, box.h), position=(x, y, z), yaw=box.yaw)


# -- diagonally opposite ---------------------------------------------------------------------------------------------

DOOR, NEAR_CHAIR, FAR_CHAIR = node("door", 2.0, -1.9), node("chair 1", 1.8, 1.5), node("chair 2", -1.9, 1.6)


def test_the_chair_diagonally_opposite_the_door() -> None:
    plan = GrammarPlanner().plan("select the chair diagonally opposite the door")
    found = Stage.of(graph(DOOR, NEAR_CHAIR, FAR_CHAIR)).find(plan.ops[0].target)
    assert found.verdict == "found" and found.groups == (2,)
    assert plan.ops[0].target.describe() == "the chair diagonally opposite the door"


def test_a_stated_diagonal_is_checked() -> None:
    for said in ("diagonally_opposite", "diagonally opposite", "diagonally_across_from"):
        assert check(graph(FAR_CHAIR, DOOR, stated=said)).ok
        wrong = check(graph(NEAR_CHAIR, DOOR, stated=said))
        assert [v.kind for v in wrong.violations] == ["relation"] and not wrong.unchecked


def test_a_composed_lamp_stands_diagonally_opposite_the_sofa() -> None:
    made = compose("a living room with a sofa and a floor lamp diagonally opposite the sofa").layout.graph
    by_label = {n.label: n for n in made.nodes}
    stated = (by_label["floor lamp"].id, "diagonally_opposite", by_label["sofa"].id)
    assert stated in made.relations and check(made).ok


# -- an invented one -------------------------------------------------------------------------------------------------

ENTRY = """
    RelationKind(
        "widdershins_of", "query placement wish stated", "widdershins of {}", geometry.toward((-0.8, 0.6)),
        phrases=Phrases("widdershins of"),
    ),
"""
PROOF = """
from scenewright.planners.compose.compose import compose
from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import Node, RoomShape, SceneGraph
from scenewright.planners.rooms.graph_scene import Stage

def graph(x, y):
    here = {"sofa": (0.0, 0.0), "lamp": (x, y)}
    nodes = tuple(Node(id=k, label=k, size=(0.5, 0.5, 0.5), position=(*p, 0.25)) for k, p in here.items())
    return SceneGraph(room=RoomShape(size=(5, 4, 2.5)), nodes=nodes, relations=(("lamp", "widdershins_of", "sofa"),))

assert check(graph(-1.2, 0.9)).ok and not check(graph(1.2, 0.9)).ok
query = GrammarPlanner().plan("select the lamp widdershins of the sofa").ops[0].target
assert Stage.of(graph(-1.2, 0.9)).find(query).groups == (1,)
assert Stage.of(graph(1.2, 0.9)).find(query).verdict == "absent"
place = GrammarPlanner().plan("move the lamp widdershins of the sofa").ops[0].place
assert place.relation == "widdershins_of" and place.describe() == "widdershins of the sofa"
made = compose("a living room with a sofa and a floor lamp widdershins of the sofa").layout.graph
assert "widdershins_of" in [name for _, name, _ in made.relations] and check(made).ok
"""


@pytest.mark.slow
def test_an_entry_is_all_that_a_relation_takes(tmp_path: Path) -> None:
    """In a copy of the packages: the grammar, queries, placements, compose, its solver and the checker know it."""
    home = Path(scenewright.__file__).parent
    copy = tmp_path / "scenewright"
    # With what is compiled: it is valid for copies, which keep the times of their files.
    shutil.copytree(home, copy, ignore=shutil.ignore_patterns("benchmarks", "training", "agent"))
    table = copy / "gaussians" / "world" / "relations.py"
    text = table.read_text(encoding="utf-8")
    start = "KINDS: tuple[RelationKind, ...] = (\n"
    assert text.count(start) == 1
    table.write_text(text.replace(start, start + ENTRY.lstrip("\n")), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", PROOF], env={**os.environ, "PYTHONPATH": str(tmp_path)}, cwd=tmp_path,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
