"""`scenewright compose`: what is written and told, conflicts, and that nothing is overwritten or half written."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.files import load
from scenewright.gaussians.language.field.store import load_field
from scenewright.planners.compose import api
from scenewright.planners.layout.problem import Conflict, Item, Layout, Problem
from scenewright.planners.rooms.graph import SceneGraph

CHAIR = {"id": 1, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.9], "position": [0.0, 0.0, 0.45]}
GIZMO = {"id": 2, "label": "gizmo", "size": [0.4, 0.4, 0.4], "position": [1.0, 0.0, 0.2]}
ROOM = {"room": {"size": [3.0, 3.0, 2.5]}, "nodes": [CHAIR, GIZMO]}
HARP = Problem(size=(3, 3, 2.5), items=(Item(id=9, label="harp", size=(1, 1, 2), optional=True),))


@dataclass(frozen=True)
class Composed:
    """As much of a composition as the command looks at."""

    layout: Layout
    problem: Problem = HARP
    remarks: tuple[str, ...] = ("cozy also means warm light, which boxes do not show",)
    unmet: tuple[str, ...] = ("there is no trombone",)


@pytest.fixture
def compose(call: Any) -> Any:
    """Runs `scenewright compose` with further arguments."""
    return partial(call, "compose")


@pytest.fixture
def given(tmp_path: Path) -> Path:
    path = tmp_path / "room.json"
    path.write_text(json.dumps(ROOM))
    return path


def _composer(monkeypatch: pytest.MonkeyPatch, *conflicts: Conflict) -> list[dict[str, Any]]:
    """Words are read as `ROOM`, with these conflicts; how it was called."""
    asked: list[dict[str, Any]] = []

    def composed(text: str, **options: Any) -> Composed:
        asked.append({"text": text, **options})
        return Composed(Layout(graph=SceneGraph.model_validate(ROOM), conflicts=conflicts, left_out=(9,)))

    monkeypatch.setattr(api, "composed", composed)
    return asked


def test_a_graph_becomes_a_scene_that_knows_its_things(compose: Any, given: Path, tmp_path: Path) -> None:
    scene, picture, graph = tmp_path / "a.ply", tmp_path / "a.png", tmp_path / "a.json"
    arguments = (given, "--scene", scene, "--picture", picture, "--size", "96x64", "-o", graph, "--detail", "0.2")
    code, out, err = compose(*arguments)
    assert code == 0, err
    assert "red chair" in out and "gizmo" in err and "plain block" in err and "nothing is wrong" in err
    assert all(stage in err for stage in ("check", "assets", "room", "total"))
    assert SceneGraph.read(graph) == SceneGraph.model_validate(ROOM) and picture.stat().st_size > 500
    loaded = load_field(load(scene), scene)
    assert loaded is not None
    assert [(n.id, n.label) for n in SceneGraph.from_scene(loaded).nodes] == [(1, "chair"), (2, "gizmo")]


def test_json_is_the_graph_and_nothing_else(compose: Any, given: Path) -> None:
    code, out, err = compose(given, "--json")
    assert code == 0 and SceneGraph.model_validate_json(out) == SceneGraph.model_validate(ROOM)
    assert "check" in err


def test_words_are_composed_with_seed_and_planner(compose: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = _composer(monkeypatch)
    code, out, err = compose("a small room", "--seed", "7", "--planner", "grammar", "--json")
    assert code == 0 and SceneGraph.model_validate_json(out).nodes
    assert asked == [{"text": "a small room", "seed": 7, "planner": "grammar", "budget": None, "dial": None}]
    assert "warm light" in err and "harp (9)" in err


def test_the_budget_is_passed_on_and_what_is_not_as_said_is_listed(
    compose: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = _composer(monkeypatch)
    code, _, err = compose("a small room", "--budget", "5s,0.01usd")
    assert code == 0 and asked[0]["budget"] == "5s,0.01usd"
    assert "not as said: there is no trombone" in err and "nothing is wrong" not in err


def test_a_budget_that_is_none_is_refused(compose: Any) -> None:
    code, _, err = compose("a small room", "--budget", "much")
    assert code == 2 and "is not a budget" in err


def test_a_conflict_writes_nothing_unless_the_best_is_wanted(
    compose: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    wide = Conflict(statements=("a", "b", "c"))
    tight = Conflict(statements=("the piano is 1.5 m wide", "the room is 1 m wide"), subjects=(1,))
    _composer(monkeypatch, wide, tight)
    target = tmp_path / "g.json"
    code, out, err = compose("a piano in a closet", "-o", target)
    assert code == 3 and not target.exists() and out == ""
    assert "the room is 1 m wide" in err and "--best" in err
    code, out, _ = compose("a piano in a closet", "-o", target, "--json")
    told = json.loads(out)
    assert code == 3 and told["verdict"] == "impossible" and len(told["conflicts"]) == 2
    assert SceneGraph.model_validate(told["best"]).nodes and not target.exists()
    code, _, err = compose("a piano in a closet", "-o", target, "--best")
    assert code == 0 and target.exists() and "not possible together" in err


def test_faults_of_a_given_graph_are_told_and_it_is_built(compose: Any, tmp_path: Path) -> None:
    path = tmp_path / "crossed.json"
    path.write_text(json.dumps({**ROOM, "nodes": [CHAIR, {**CHAIR, "id": 2}]}))
    code, _, err = compose(path, "--scene", tmp_path / "x.ply", "--detail", "0.1")
    assert code == 0 and "collision" in err and (tmp_path / "x.ply").exists()


def test_nothing_is_overwritten_unasked(compose: Any, given: Path, tmp_path: Path) -> None:
    there = tmp_path / "there.json"
    there.write_text("mine")
    code, _, err = compose(given, "-o", there)
    assert code == 2 and "--force" in err and there.read_text() == "mine"
    code, _, err = compose(given, "-o", there, "--force")
    assert code == 0 and SceneGraph.read(there).nodes


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["--picture", "a.jpg"], ".png"),
        (["--scene", "nowhere/a.ply"], "no folder"),
        (["--assets", "nowhere"], "is not a folder"),
        (["--scene", "a.ply", "--detail", "0"], "detail"),
    ],
)
def test_what_cannot_be_is_said_before_the_work(compose: Any, given: Path, arguments: list[str], why: str) -> None:
    code, _, err = compose(given, *arguments)
    assert code == 2 and why in err and len(err.strip().splitlines()[-1]) < 300
    assert sorted(p.name for p in given.parent.iterdir()) == ["room.json"]


@pytest.mark.parametrize(
    "content", ["", "[]", '{"nodes": [{"id": 1}]}', '{"room": {"size": [1, 1, 1], "up": [0, 1, 0]}}']
)
def test_files_that_hold_no_graph_are_refused(compose: Any, tmp_path: Path, content: str) -> None:
    path = tmp_path / "bad.json"
    path.write_text(content)
    code, _, err = compose(path, "--json")
    assert code == 4 and "scene graph" in err


def test_python_composes_a_graph_or_names_the_conflict(monkeypatch: pytest.MonkeyPatch) -> None:
    import scenewright as sw

    _composer(monkeypatch)
    assert sw.compose("a small room").nodes[0].label == "chair"
    _composer(monkeypatch, Conflict(statements=("too much",)))
    with pytest.raises(InstructionError, match="too much"):
        sw.compose("a small room")
    assert sw.compose("a small room", best=True).nodes


def test_a_scene_is_not_written_where_the_graph_goes(compose: Any, tmp_path: Path) -> None:
    code, _, err = compose("a small bathroom", "-o", tmp_path / "room.ply")
    assert code == 2 and "a scene is written with --scene" in err
    assert not list(tmp_path.iterdir())


def test_planners_that_cannot_compose_are_refused(compose: Any) -> None:
    code, _, err = compose("a bedroom", "--planner", "nonsense")
    assert code == 2 and "grammar" in err


@pytest.mark.slow
def test_a_coffee_shop_from_words(compose: Any, tmp_path: Path) -> None:
    """The whole way: every thing that was named stands in the scene, and the checker has nothing to say."""
    text = "a cozy coffee shop with exposed beams, a counter with a pastry display, and four small tables"
    code, out, err = compose(text, "--planner", "grammar", "--scene", tmp_path / "shop.ply", "--json")
    assert code == 0 and "nothing is wrong" in err and "block" not in err
    labels = " ".join(n.label for n in SceneGraph.model_validate_json(out).nodes)
    assert "beam" in labels and "counter" in labels and "pastry display" in labels
    loaded = load_field(load(tmp_path / "shop.ply"), tmp_path / "shop.ply")
    assert loaded is not None
    assert sum("table" in n.label for n in SceneGraph.from_scene(loaded).nodes) >= 4
