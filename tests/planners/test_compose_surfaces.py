"""Materials of composed rooms: read from the description, kept in the graph, and shown as pixels."""

from __future__ import annotations

import pytest
import torch

from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.harmonics import dc_to_color
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.world.finishes import Described, described
from scenewright.gaussians.world.styles import material_for, materials_of, named
from scenewright.planners.compose import knowledge
from scenewright.planners.compose.compose import compose
from scenewright.planners.compose.sentence.read import read
from scenewright.planners.compose.surfaces import with_surfaces
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("exposed brick", Described("brick")),
        ("white metro tiles", Described("tiles", "white")),
        ("red and white striped wallpaper", Described("stripes", "red", "white")),
        ("dark walnut", Described("wood", "#422e1f")),
        ("dark blue panelling", Described("planks", "dark blue")),
        ("pale pink", Described(None, "pale pink")),
        ("checkerboard marble", Described("checks", "#ece9e4")),
        ("big", None),
    ],
)
def test_surfaces_in_words(text: str, found: Described | None) -> None:
    assert described(text) == found


@pytest.mark.parametrize(
    ("text", "features"),
    [
        ("a living room with exposed brick walls", ["exposed brick walls"]),
        ("a bedroom with an oak floor and striped wallpaper", ["oak floor", "striped walls"]),
        ("a bathroom with blue tiles on the walls and a slate floor", ["blue tiles walls", "slate floor"]),
        ("living room concrete floor white walls grey sofa", ["concrete floor", "white walls"]),
        ("an office with terrazzo on the ground and two chairs", ["terrazzo floor"]),
        ("a dining room with a table, herringbone parquet", ["herringbone parquet floor"]),
        ("hallway. panelled walls in dark blue. a mirror.", ["dark blue panelled walls"]),
        ("a kitchen with a table, the floor grey tile", ["grey tile floor"]),
        ("a concrete loft", ["concrete floor", "concrete walls"]),
    ],
)
def test_floor_and_walls_become_features(text: str, features: list[str]) -> None:
    brief = read(text)
    assert list(brief.features) == features
    assert not brief.unknown


@pytest.mark.parametrize("text", ["a bedroom with a floor lamp and a wall clock", "a brown table and a white sofa"])
def test_names_of_things_stay(text: str) -> None:
    assert not read(text).features
    assert len(read(text).things) == 2


@pytest.mark.slow
def test_things_and_styles_have_materials() -> None:
    brief = read("a rustic kitchen with an oak table and a workbench of plywood")
    graph = compose(brief, seed=1).layout.graph
    told = {node.label: node.material for node in graph.nodes}
    style = knowledge.styles()["rustic"].materials
    assert (told["table"], told["workbench"]) == ("oak", "plywood")
    assert (graph.room.floor, graph.room.walls) == (style["floor"], style["walls"])
    assert SceneGraph.model_validate_json(graph.model_dump_json()) == graph
    plain = with_surfaces(graph, read("a kitchen"), {})
    assert plain.room.floor == ""


def test_every_style_names_known_materials_and_roles() -> None:
    assert len(materials_of()) >= 10  # which checks the phrases itself
    assert {style.name for style in knowledge.styles().values() if style.materials} == set(materials_of())
    assert named("Mid-Century Modern") == "vintage"
    assert material_for("couch", materials_of()["industrial"]) == "brown leather"


def lightness_and_hue(scene: Scene, label: str) -> torch.Tensor:
    field = scene.language
    assert field is not None
    rows = torch.isin(scene.cloud.group, torch.tensor([g.id for g in field.groups if g.label == label and g.count]))
    return rgb_to_lab(dc_to_color(scene.cloud.sh[rows, 0]).clamp(0, 1).double()).mean(dim=0)


@pytest.mark.slow
def test_materials_become_pixels_and_the_room_stays_the_same() -> None:
    graph = SceneGraph.model_validate(
        {"room": {"size": [4, 3, 2.5]}, "nodes": [
            {"id": 0, "label": "sofa", "size": [1.9, 0.9, 0.8], "position": [0, 1.0, 0.4], "yaw": 180}]}
    )  # fmt: skip
    dressed = graph.model_copy(update={
        "room": graph.room.model_copy(update={"floor": "black slate", "walls": "exposed brick"}),
        "nodes": tuple(n.model_copy(update={"material": "green velvet"}) for n in graph.nodes),
    })  # fmt: skip
    plain, shown = construct(graph, seed=1), construct(dressed, seed=1)
    wall, floor, sofa = (lightness_and_hue(shown.scene, name) for name in ("wall", "floor", "sofa"))
    assert float(wall[1]) > 15  # red
    assert float(floor[0]) < 35
    assert float(sofa[1]) < -15  # green
    assert shown.scene.cloud.ids.tolist() == list(range(len(shown.scene.cloud)))
    assert len(shown.scene.cloud) < len(plain.scene.cloud) + 260_000
    again = construct(dressed, seed=1).scene.cloud
    assert all(torch.equal(a, b) for (_, a), (_, b) in zip(shown.scene.cloud.columns(), again.columns(), strict=True))
    before, after = plain.scene.language, shown.scene.language
    assert before is not None and after is not None
    assert [(g.id, g.label, g.box) for g in before.groups] == [(g.id, g.label, g.box) for g in after.groups]


def test_words_that_name_no_material_are_told() -> None:
    graph = SceneGraph.model_validate({"room": {"size": [4, 3, 2.5], "floor": "something nice"}})
    assert "“something nice” is no material or colour" in " ".join(construct(graph, seed=1).notes)


@pytest.mark.slow
def test_a_style_dresses_what_it_has_materials_for_and_says_so() -> None:
    graph = SceneGraph.model_validate(
        {"room": {"size": [3, 3, 2.5]}, "nodes": [
            {"id": 0, "label": "armchair", "size": [0.9, 0.9, 0.9], "position": [0, 0.9, 0.45]}]}
    )  # fmt: skip
    scene = construct(graph, seed=1).scene
    context = Context(scene.cameras[0])
    everything = {"text": "everything", "pick": "all"}
    done = carry_out(scene, parse({"op": "restyle", "target": everything, "style": "industrial"}), context)
    assert done.receipt.passed
    assert "armchair: brown leather" in done.receipt.notes[0] and "wall: exposed brick" in done.receipt.notes[0]
    assert float(lightness_and_hue(done.scene, "wall")[1]) > 15
    with pytest.raises(UserError):
        parse({"op": "restyle", "target": everything, "style": "zorblax"})
    with pytest.raises(UserError, match="stands alone"):
        parse({"op": "restyle", "target": everything, "style": "rustic", "material": "wood"})
