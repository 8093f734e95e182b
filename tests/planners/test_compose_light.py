"""Light of composed rooms: read from the description, kept in the graph, and shown as pixels."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch

from scenewright.gaussians.scene import Scene
from scenewright.planners.compose import knowledge
from scenewright.planners.compose.brief import Brief
from scenewright.planners.compose.compose import compose
from scenewright.planners.compose.sentence.lights import feature_mood
from scenewright.planners.compose.sentence.read import read
from scenewright.planners.compose.surfaces import with_surfaces
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.tools.lighting.light import colors_of, mean_luminance

ROOM = {"size": [4.0, 4.0, 2.5]}
TABLE = {"id": 1, "label": "table", "size": [1.2, 0.8, 0.75], "position": [0.0, 0.0, 0.375], "support": "floor"}


def graph(light: str | None = None) -> SceneGraph:
    room = ROOM if light is None else {**ROOM, "light": light}
    return SceneGraph.model_validate({"room": room, "nodes": [TABLE]})


def light_of(brief: Brief) -> str:
    return with_surfaces(graph(), brief, {}).room.light


def luminance(scene: Scene) -> float:
    colors = colors_of(scene.cloud)
    return mean_luminance(colors.rgb, colors.weight)


@pytest.mark.parametrize(
    ("text", "light"),
    [
        ("a rustic kitchen with an oak floor and a brick wall, warm evening light", "evening"),
        ("a bedroom with a bed, with warm light", "cosy"),
        ("a living room at night with a sofa", "night"),
        ("a sunny kitchen with a table", "sunny"),
        ("a candle-lit dining room with a table and four chairs", "candle light"),
        ("an office with cold bright light", "daylight"),
        ("a living room with a sofa and a lamp on in the evening", "evening"),
        ("a dimly lit bar with five stools", "evening"),
        ("a bedroom by moonlight", "moonlight"),
        ("a studio with natural light, two easels", "daylight"),
        ("a cozy cafe", "cosy"),
        ("an airy office", "daylight"),
        ("a dark bedroom", "evening"),
        ("a cozy bedroom at night", "night"),
    ],
)
def test_light_is_read(text: str, light: str) -> None:
    brief = read(text)
    assert light_of(brief) == light
    assert not brief.unknown
    assert not [r for r in brief.remarks if "light" in r]


@pytest.mark.parametrize(
    "text",
    [
        "an office with a desk and a chair",
        "a bedroom with a night stand and a night light",
        "a nursery with a bear between the rabbit and the night light",
        "a library with two reading lights and a desk",
        "a kitchen with a light oak floor, white walls",
        "a bedroom for someone who reads at night",
        "a living room with a painting of the sea at sunset",
        "a room without natural light",
        "a living room with a sunny yellow sofa",
        "a bedroom with a candle lit table",
    ],
)
def test_other_words_of_light_change_nothing(text: str) -> None:
    assert light_of(read(text)) == ""


def test_words_of_light_leave_surfaces_and_things_as_they_are() -> None:
    plain = read("a rustic kitchen with an oak floor and a brick wall, two stools")
    lit = read("a rustic kitchen with an oak floor and a brick wall, warm evening light, two stools")
    assert lit.features == ("warm evening light", *plain.features)
    assert lit.model_copy(update={"features": plain.features}) == plain


def test_light_of_a_style_is_no_longer_told_as_missing() -> None:
    assert feature_mood(knowledge.styles()["cozy"].unshown) == "cosy"
    assert any("bare pipes" in r for r in read("an industrial cafe").remarks)
    assert not read("a cozy cafe").remarks


@pytest.mark.parametrize("feature", ["light oak floor", "exposed beams", "white walls", "dance floor", "sunset mural"])
def test_other_features_are_no_light(feature: str) -> None:
    assert feature_mood(feature) is None


def test_a_graph_keeps_its_light(tmp_path: Path) -> None:
    (tmp_path / "graph.json").write_text(graph("evening").model_dump_json(), encoding="utf-8")
    assert SceneGraph.read(tmp_path / "graph.json") == graph("evening")


def test_a_graph_without_the_field_still_loads(tmp_path: Path) -> None:
    data = json.loads(graph().model_dump_json())
    del data["room"]["light"]
    (tmp_path / "old.json").write_text(json.dumps(data), encoding="utf-8")
    assert SceneGraph.read(tmp_path / "old.json").room.light == ""


def test_without_light_nothing_is_relit(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> Scene:
        raise AssertionError("relit")

    monkeypatch.setattr("scenewright.tools.lighting.made_rooms.in_mood", never)
    construct(graph(), detail=0.2)
    with pytest.raises(AssertionError, match="relit"):
        construct(graph("night"), detail=0.2)


def test_light_changes_colours_only_and_always_alike() -> None:
    plain = construct(graph(), detail=0.2).scene
    night, again = (construct(graph("night"), detail=0.2).scene for _ in range(2))
    assert torch.equal(night.cloud.sh, again.cloud.sh)
    for field in ("means", "scales", "quats", "opacities", "group", "ids"):
        assert torch.equal(getattr(night.cloud, field), getattr(plain.cloud, field))
    assert luminance(night) < 0.2 * luminance(plain)
    assert night.language is not None and plain.language is not None
    assert [g.lab for g in night.language.groups] == [g.lab for g in plain.language.groups]


def test_an_unknown_light_is_left_out_with_a_note() -> None:
    built = construct(graph("disco"), detail=0.2)
    assert torch.equal(built.scene.cloud.sh, construct(graph(), detail=0.2).scene.cloud.sh)
    assert any("disco" in note and "evening" in note for note in built.notes)


@pytest.mark.slow
def test_the_same_sentence_gives_the_same_bytes() -> None:
    text = "a small study with a desk, a chair and a table lamp, warm evening light"
    one, two = (compose(text).layout.graph for _ in range(2))
    assert one.room.light == "evening"
    assert one == two
    assert torch.equal(one.build(detail=0.2).cloud.sh, two.build(detail=0.2).cloud.sh)
