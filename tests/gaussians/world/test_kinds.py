"""The table of kinds: closed and without clashes; and adding a kind is one entry, which every package then knows."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from scenewright.gaussians import assets
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.world import kinds
from scenewright.gaussians.world.words import is_plural, normalise, plural, singular
from scenewright.planners.compose import knowledge

EVERY = tuple(kinds.table().kinds.values())
ROOT = Path(__file__).parents[3]


def test_no_word_names_two_kinds() -> None:
    said = Counter(n for k in EVERY for n in k.names)
    assert [n for n, count in said.items() if count > 1] == []
    # Of a plural that is one name of several things ("exposed beams"), the singular names each of them.
    forms = {(k.name, normalise(n)) for k in EVERY if k.one is None for n in k.names if n != "drums"}
    single = Counter(form for _, form in forms)
    assert [n for n, count in single.items() if count > 1] == []


@pytest.mark.parametrize("kind", EVERY, ids=lambda k: k.name)
def test_every_entry_is_sound(kind: kinds.Kind) -> None:
    assert all(0 < low <= high < 8 for low, high in kind.size)
    assert kind.support in ("floor", "surface", "wall", "ceiling")
    assert kind.asset == "" or kind.asset in assets.KINDS
    assert (kind.support == "surface") >= bool(kind.on)
    assert all(set(n) <= set("abcdefghijklmnopqrstuvwxyz ") and n == n.strip() for n in kind.names)
    assert all(kinds.find(n) is kind for n in kind.names)
    assert all(0 <= c <= 3 for c in (*kind.clear, kind.aisle)) and 0 <= kind.seats <= 12


@pytest.mark.parametrize("kind", EVERY, ids=lambda k: k.name)
def test_the_plural_of_a_name_is_known(kind: kinds.Kind) -> None:
    if not is_plural(kind.name):
        assert singular(plural(kind.name)) == kind.name


def test_every_builder_has_an_entry_of_its_own_name() -> None:
    assert [n for n in assets.KINDS if n not in kinds.table().kinds or kinds.table().kinds[n].asset != n] == []


def test_the_encoder_was_shown_what_the_table_says() -> None:
    named = set(Vocabulary.household().names)  # it also names things that are no furnishings: food, tools, vehicles
    by_others = {"bucket", "stairs", "wall shelf"}  # shown by objects of other artists
    assert {k.name for k in EVERY if k.shown} | by_others == named & {k.name for k in EVERY}


def test_rooms_and_styles_refer_to_the_table() -> None:
    assert knowledge.rooms() and knowledge.styles()  # they refuse to load what nobody described


def test_a_loose_word_means_its_kind_only_alone() -> None:
    alone, ending = kinds.of("bag"), kinds.of("sleeping bag")
    assert alone is not None and alone.name == "backpack" and ending is None


def test_a_file_that_refers_to_nothing_is_refused(tmp_path: Path) -> None:
    entry = {"name": "hookah", "size": [[0.2, 0.3], [0.2, 0.3], [0.5, 0.8]], "on": ["coffee table"]}
    (tmp_path / "kinds.json").write_text(json.dumps({"kinds": [entry], "families": {}, "others": []}))
    with pytest.raises(AssertionError, match="coffee table"):
        kinds.table(tmp_path / "kinds.json")


_HOOKAH = {
    "name": "hookah", "also": ["shisha", "water pipe"], "size": [[0.2, 0.3], [0.2, 0.3], [0.5, 0.8]],
    "support": "surface", "asset": "vase", "on": ["coffee table"], "round": True, "colors": ["blue"],
}  # fmt: skip
_ASK = """
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.world import kinds
from scenewright.planners import load
from scenewright.planners.compose import compose, read
from scenewright.planners.impossible import _usual_support
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.graph_scene import Stage
from scenewright.planners.rooms.plan_on_graph import resolve_text

thing, = read("a lounge with a hookah").things
assert thing.name == "hookah", thing
made = compose("a lounge with a hookah", seed=1)
node = next(n for n in made.layout.graph.nodes if n.label == "hookah")
lower = next(n for n in made.layout.graph.nodes if n.id == node.support)
assert kinds.of(lower.label).top and check(made.layout.graph).ok
grammar = load("grammar")
assert grammar.plan("delete the hookah").ok and grammar.plan("add a hookah").ops[0].asset == "hookah"
assert grammar.plan("add a tall hookah").ops[0].height.value == 0.8
nodes = [
    {"id": 1, "label": "coffee table", "position": [0, 0, 0.2], "size": [1, 0.6, 0.4], "support": "floor"},
    {"id": 2, "label": "shisha", "position": [0, 0, 0.7], "size": [0.2, 0.2, 0.6], "support": 1},
]
room = SceneGraph.model_validate({"room": {"size": [4, 4, 2.5]}, "nodes": nodes})
steps = resolve_text(Stage.of(room), grammar, "delete the hookah").steps
assert [t for step in steps for t in step.targets] == [2]
assert _usual_support("blue hookah") == "surface"
assert Vocabulary.everyday().covered("a blue shisha") == {"hookah"}
"""


@pytest.mark.slow
def test_adding_a_kind_is_one_entry(tmp_path: Path) -> None:
    """In a copy of the packages with a "hookah" in the table, all that reads kinds knows it."""
    # With what is compiled: it is valid for copies, which keep the times of their files.
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("benchmarks", "training", "agent"))
    table = tmp_path / "src/scenewright/gaussians/world/kinds.json"
    data = json.loads(table.read_text("utf-8"))
    table.write_text(json.dumps({**data, "kinds": [*data["kinds"], _HOOKAH]}), "utf-8")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "src")}
    run = subprocess.run([sys.executable, "-c", _ASK], env=environment, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
