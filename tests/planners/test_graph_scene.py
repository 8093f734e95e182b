"""A graph as something that words find things in: names, colours, places, and what stands where."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.color import BASIC
from scenewright.gaussians.errors import BackendError, FileError
from scenewright.gaussians.language.query.attributes import COLOR_HOLDS, color_scores
from scenewright.gaussians.language.query.picking import NAME_LEAD
from scenewright.gaussians.language.query.query import Query, Relation
from scenewright.planners.rooms.color_words import color_of
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.graph_scene import Stage
from scenewright.planners.rooms.label_encoder import ALIKE, BESIDE, BROADER, EXACT, NOT, WordEncoder, agreement
from scenewright.planners.rooms.node import Node, RoomShape, Viewpoint

LIVING = Stage.of(SceneGraph.read(Path(__file__).parent / "written" / "living_room.json"))


# ---- words -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "label", "how"),
    [
        ("sofa", "sofa", EXACT),
        ("Sofas", "sofa", EXACT),
        ("couch", "sofa", ALIKE),
        ("chair", "office chair", ALIKE),
        ("lamp", "floor lamp", ALIKE),
        ("floor light", "floor lamp", ALIKE),
        ("telly", "television", ALIKE),
        ("bin", "trash can", ALIKE),
        ("book", "stack of books", ALIKE),
        ("stack", "stack of books", ALIKE),
        ("table", "table with drawers", ALIKE),
        ("wooden table", "table", ALIKE),
        ("cushon", "cushion", EXACT),
        ("chair", "armchair", BROADER),
        ("appliance", "toaster", BROADER),
        ("seat", "sofa", BROADER),
        ("round table", "square table", NOT),
        ("coffee table", "dining table", NOT),
        ("rocking chair", "office chair", NOT),
        ("tv", "tv stand", NOT),
        ("horse", "painting with a horse", NOT),
        ("piano", "sofa", NOT),
        ("", "sofa", NOT),
        ("椅子", "椅子", EXACT),
        ("snorlax", "big snorlax", ALIKE),
    ],
)
def test_agreement(asked: str, label: str, how: float) -> None:
    assert agreement(asked, [label]) == [how]


def test_a_broader_word_gives_way_to_a_head() -> None:
    assert agreement("chair", ["armchair", "office chair"]) == [NOT, ALIKE]
    assert agreement("chair", ["chair", "office chair"]) == [EXACT, ALIKE]


def test_a_very_name_leaves_no_rival_to_its_synonym() -> None:
    """Where both a pillow and a cushion are there, "the cushion" is the one that is called so."""
    assert agreement("cushion", ["pillow", "cushion"]) == [BESIDE, EXACT]
    assert agreement("cushion", ["pillow", "throw pillow"]) == [ALIKE, ALIKE]
    assert BESIDE < NAME_LEAD * EXACT


def test_a_slip_is_corrected_only_for_a_word_that_nobody_knows() -> None:
    assert agreement("coach", ["couch"]) == [NOT]  # a coach is a thing of its own
    assert agreement("coich", ["couch"]) == [EXACT]


def test_the_word_encoder_has_no_eyes() -> None:
    encoder = WordEncoder(("sofa",))
    with pytest.raises(BackendError, match="no pictures"):
        encoder.encode_images(np.zeros((1, 8, 8, 3), dtype=np.uint8))
    assert encoder.fingerprint != WordEncoder(("chair",)).fingerprint


# ---- colours ---------------------------------------------------------------------------------------------------------


def fits(word: str, written: str) -> bool:
    return float(color_scores(word, np.array(color_of(written)))) >= COLOR_HOLDS


@pytest.mark.parametrize("word", BASIC)
def test_a_basic_colour_is_itself_and_no_other(word: str) -> None:
    assert [other for other in BASIC if fits(other, word)] == [word]


@pytest.mark.parametrize(
    ("written", "word"),
    [
        ("light blue", "blue"), ("dark brown", "brown"), ("oak", "brown"), ("walnut", "brown"), ("navy", "blue"),
        ("light gray", "gray"), ("light grey", "gray"), ("burgundy", "red"), ("gold", "yellow"), ("chrome", "gray"),
        ("dark green", "green"), ("terracotta", "orange"), ("#2050d0", "blue"),
    ],
)  # fmt: skip
def test_a_shade_answers_to_its_family_alone(written: str, word: str) -> None:
    assert [other for other in BASIC if fits(other, written)] == [word]


def room(*nodes: tuple[int | str, str, str], viewer: Viewpoint | None = None) -> Stage:
    """Things in a row from left to right, one metre apart."""
    return Stage.of(
        SceneGraph(
            room=RoomShape(size=(8, 4, 2.5)),
            nodes=tuple(
                Node(id=id, label=label, color=color, size=(0.5, 0.5, 0.5), position=(i - 2.0, 0.0, 0.25))
                for i, (id, label, color) in enumerate(nodes)
            ),
            viewer=viewer,
        )
    )


def ids(stage: Stage, query: Query) -> tuple[int | str, ...]:
    return stage.names(stage.find(query).groups)


@pytest.mark.parametrize("written", ["dark brown", "pale yellow", "light brown", "navy", "oak", "cream"])
def test_a_colour_finds_what_is_written_so(written: str) -> None:
    stage = room((1, "chair", written), (2, "chair", "purple"))
    assert ids(stage, Query(text="chair", colors=(written,))) == (1,)


def test_a_colour_that_nobody_knows_is_a_word() -> None:
    stage = room((1, "blanket", "tartan"), (2, "blanket", "red"))
    assert ids(stage, Query(text="tartan blanket")) == (1,)
    assert stage.find(Query(text="chequered blanket")).verdict == "absent"


def test_a_node_without_colour_has_none() -> None:
    stage = room((1, "vase", ""), (2, "cup", "red"))
    assert all(stage.find(Query(text="vase", colors=(word,))).verdict == "absent" for word in BASIC)


# ---- finding ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("query", "found"),
    [
        (Query(text="couch"), (1,)),
        (Query(text="plant", pick="all"), (12, 13)),
        (Query(text="plant", pick="leftmost"), (12,)),
        (Query(text="cushion", pick="nth", ordinal=-1), (15,)),
        (Query(text="wall"), ("wall",)),
        (Query(text="picture", relations=(Relation(name="on", anchors=(Query(text="wall"),)),)), (19,)),
        (Query(text="lamp", relations=(Relation(name="on", anchors=(Query(text="floor"),)),)), (6,)),
        (Query(text="cushion", relations=(Relation(name="on", anchors=(Query(text="armchair"),)),)), (16,)),
        (Query(text="picture", relations=(Relation(name="above", anchors=(Query(text="sofa"),)),)), (19,)),
        (Query(text="lamp", relations=(Relation(name="above", anchors=(Query(text="side table"),)),)), (7,)),
        (Query(text="furniture", pick="all"), (1, 2, 3, 4, 8, 10, 11)),
    ],
)
def test_find(query: Query, found: tuple[int | str, ...]) -> None:
    assert set(ids(LIVING, query)) == set(found)


@pytest.mark.parametrize(
    ("query", "verdict"),
    [
        (Query(text="plant"), "ambiguous"),
        (Query(text="piano"), "absent"),
        (Query(text="sofa", colors=("red",)), "absent"),
        (Query(text="cushion", relations=(Relation(name="on", anchors=(Query(text="sofa"),)),)), "ambiguous"),
        (Query(text="cushion", relations=(Relation(name="on", anchors=(Query(text="rug"),)),)), "absent"),
        (Query(text="clock", relations=(Relation(name="above", anchors=(Query(text="sofa"),)),)), "absent"),
    ],
)
def test_verdicts(query: Query, verdict: str) -> None:
    assert LIVING.find(query).verdict == verdict


def test_ids_come_back_as_they_were_written() -> None:
    stage = room(("left one", "chair", "red"), (7, "chair", "red"), ("7", "stool", "red"))
    assert ids(stage, Query(text="chair", pick="all")) == ("left one", 7)
    assert ids(stage, Query(text="stool")) == ("7",)


def test_what_is_gone_or_painted_is_so_for_the_next_step() -> None:
    stage = room((1, "chair", "red"), (2, "chair", "blue"))
    assert ids(stage.without([0]), Query(text="chair")) == (2,)
    painted = stage.painted([0], "blue")
    assert painted.find(Query(text="chair", colors=("red",))).verdict == "absent"
    assert ids(painted, Query(text="chair", colors=("blue",), pick="all")) == (1, 2)
    assert ids(stage, Query(text="chair", colors=("red",))) == (1,)  # the stage before is what it was


@given(st.floats(-math.pi, math.pi))
def test_left_is_the_viewers(turn: float) -> None:
    eye = (9 * math.sin(turn), -9 * math.cos(turn), 1.6)
    stage = room((1, "cup", "red"), (2, "cup", "red"), viewer=Viewpoint(position=eye, target=(0.0, 0.0, 1.0)))
    if abs(math.cos(turn)) > 0.01:  # from the side neither is left
        assert ids(stage, Query(text="cup", pick="leftmost")) == ((1,) if math.cos(turn) > 0 else (2,))


# ---- files -----------------------------------------------------------------------------------------------------------


def test_a_graph_without_a_room_gets_one_around_its_nodes(tmp_path: Path) -> None:
    path = tmp_path / "room.json"
    path.write_text(json.dumps({"nodes": [{"id": "a", "label": "x", "size": [1, 1, 1], "position": [2, 0, 0.5]}]}))
    assert SceneGraph.read(path).room.size == (5.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("not json", "cannot read"),
        ("[]", "no scene graph"),
        ('{"nodes": [{"id": 1}]}', "nodes.0.label"),
        ('{"nodes": [{"id": 1, "label": "x", "size": [1, 1], "position": [0, 0, 0]}]}', "nodes.0.size"),
        ('{"room": {"size": [1, 1, 1], "up": [0, 1, 0]}}', "z axis points up"),
        ('{"nodes": [{"id": 1, "label": "x", "size": [1, 1, 1], "position": [0, 0, 0], "support": "roof"}]}', "roof"),
    ],
)
def test_a_broken_graph_is_refused_with_the_place(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "room.json"
    path.write_text(text)
    with pytest.raises(FileError, match=told):
        SceneGraph.read(path)
