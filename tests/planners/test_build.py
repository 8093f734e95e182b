"""From a graph to a scene and back: the round-trip law, resting on what carries, folders of assets, hostile input."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import trimesh
from amounts import some
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.agent.session.session import Session
from scenewright.gaussians import assets, files
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.language.field.store import load_field, save_field
from scenewright.planners.rooms.asset_folder import AssetFolder
from scenewright.planners.rooms.build import Built, build, construct
from scenewright.planners.rooms.designs import kind_of
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node
from scenewright.planners.rooms.rest_heights import face_under, loads

DRAFT = 0.2  # detail: laws do not depend on it


def graph_of(*rows: dict[str, Any], size: tuple[float, float, float] = (5.0, 4.0, 2.6)) -> SceneGraph:
    nodes = [{"id": i, "color": "", "yaw": 0.0, "support": "floor", **row} for i, row in enumerate(rows)]
    for node in nodes:
        x, y, *z = node["position"]
        node["position"] = [x, y, z[0] if z else node["size"][2] / 2]
    return SceneGraph.model_validate({"room": {"size": size}, "nodes": nodes})


def study() -> SceneGraph:
    """Every kind of support, a colour, a turn, a thing without an asset."""
    return graph_of(
        {"label": "desk", "size": [1.4, 0.7, 0.75], "position": [0, 1.6]},
        {"label": "office chair", "size": [0.6, 0.6, 1.0], "position": [0.1, 0.8], "yaw": 180.0},
        {"label": "laptop", "size": [0.35, 0.25, 0.24], "position": [0, 1.55, 0.87], "support": 0},
        {"label": "armchair", "size": [0.85, 0.85, 0.9], "position": [-1.7, -0.4], "yaw": 60.0, "color": "red"},
        {"label": "rug", "size": [1.8, 1.2, 0.02], "position": [0.6, -0.8], "color": "blue"},
        {"label": "painting", "size": [0.8, 0.04, 0.6], "position": [1.6, 1.96, 1.6], "support": "wall"},
        {"label": "pendant lamp", "size": [0.4, 0.4, 0.7], "position": [0, 0, 2.25], "support": "ceiling"},
        {"label": "door", "size": [0.9, 0.1, 2.05], "position": [-2.45, 0.9], "yaw": 90.0, "support": "wall"},
        {"label": "zorblatt", "size": [0.5, 0.4, 0.6], "position": [2.1, 0.4], "color": "purple"},
    )


@cache
def built() -> Built:
    return construct(study(), seed=3)


def test_the_graph_comes_back_from_its_scene() -> None:
    """Ids, labels, supports, sizes and facing exactly (but for float32 rounding); places to 3 cm: what is fixed to a
    wall is drawn to its face, and what stands on something to the face that carries it."""
    there, back = study(), SceneGraph.from_scene(built().scene)
    assert back.room.size == pytest.approx(there.room.size, abs=1e-6)
    assert [(n.id, n.label, n.support) for n in back.nodes] == [(n.id, n.label, n.support) for n in there.nodes]
    for was, now in zip(there.nodes, back.nodes, strict=True):
        assert now.size == pytest.approx(was.size, abs=1e-6)
        assert math.remainder(now.yaw - was.yaw, 360) == pytest.approx(0, abs=1e-6)
        assert np.abs(np.subtract(now.position, was.position)).max() < 0.03, was.label


def test_colours_that_were_asked_for_are_measured() -> None:
    found = {n.label: n.color for n in SceneGraph.from_scene(built().scene).nodes}
    assert "red" in found["armchair"] and "blue" in found["rug"] and "purple" in found["zorblatt"]


def test_what_has_no_asset_is_a_block_and_told() -> None:
    made = built()
    assert made.blocks == (8,)
    assert any("zorblatt" in note and "block" in note for note in made.notes)
    assert made.scene.language is not None and made.scene.language.notes == made.notes


def test_every_gaussian_belongs_to_a_node_or_a_face_of_the_room() -> None:
    field = built().scene.language
    assert field is not None
    counts = torch.bincount(built().scene.cloud.group.long(), minlength=len(field.groups)).tolist()
    assert counts == [g.count for g in field.groups] and min(counts) > 0
    assert {g.label for g in field.groups if g.level == "structure"} == {"floor", "wall", "ceiling"}
    assert all(g.label_score == 1.0 for g in field.objects())


def test_things_stay_in_their_boxes() -> None:
    """Centres lie on surfaces, so none leaves the box that the graph gave (settled boxes are what the table holds)."""
    scene = built().scene
    assert scene.language is not None
    for group in scene.language.objects():
        local = group.box.local(scene.cloud.means[scene.cloud.group == group.id].numpy())
        assert (np.abs(local) <= np.array(group.box.size) / 2 + 2e-3).all(), group.label  # float32 and millimetres


@pytest.mark.slow
def test_the_same_arguments_give_the_same_bytes() -> None:
    first, again = (build(study(), seed=5, detail=DRAFT) for _ in range(2))
    assert first.cloud.digest() == again.cloud.digest()
    assert first.cloud.digest() != build(study(), seed=6, detail=DRAFT).cloud.digest()


def test_cameras_see_the_room_from_above_or_below_its_ceiling() -> None:
    closed = built().scene.cameras
    assert closed[0].name == "overview" and closed[0].position[2] < 2.6
    open_above = build(study(), detail=DRAFT, ceiling=False)
    assert open_above.cameras[0].position[2] > 2.6
    assert {c.name for c in open_above.cameras[1:]} >= {"view 1"}


@pytest.mark.parametrize("color", ["", "red"])
def test_a_cup_stands_on_the_plate_of_whatever_table_was_chosen(color: str) -> None:
    graph = graph_of(
        {"label": "desk", "size": [1.5, 0.7, 0.74], "position": [0, 0], "yaw": 30.0, "color": color},
        {"label": "mug", "size": [0.1, 0.09, 0.1], "position": [0.2, 0.1, 0.79], "support": 0},
    )
    for seed in range(4):
        scene = build(graph, seed=seed, detail=0.5)
        cup = scene.cloud.means[scene.cloud.group == 1]
        desk = scene.cloud.means[scene.cloud.group == 0]
        near = desk[(desk[:, :2] - cup[:, :2].mean(dim=0)).norm(dim=1) < 0.1]
        # The lowest cells of a cup lie within half a cell (1 cm) of its underside, which touches the plate.
        assert abs(float(cup[:, 2].min() - near[:, 2].max())) < 0.015


def test_a_cushion_rests_on_the_seat_and_a_book_within_the_shelf() -> None:
    graph = graph_of(
        {"label": "sofa", "size": [2.0, 0.9, 0.85], "position": [0, 1.4]},
        {"label": "cushion", "size": [0.4, 0.4, 0.15], "position": [0.3, 1.25, 0.55], "support": 0},
        {"label": "bookshelf", "size": [0.9, 0.35, 1.9], "position": [-1.9, 1.7]},
        {"label": "vase", "size": [0.12, 0.12, 0.2], "position": [-1.9, 1.65, 1.0], "support": 2},
    )
    back = {n.label: n for n in SceneGraph.from_scene(build(graph, detail=0.5)).nodes}
    assert 0.25 < back["cushion"].bottom < 0.7 and back["cushion"].support == 0
    assert back["vase"].support == 2


def test_a_design_is_chosen_by_its_proportions() -> None:
    """A long low table is not a stretched high one: the stretch that is left is small where designs reach."""
    graph = graph_of({"label": "table", "size": [0.9, 0.9, 0.75], "position": [0, 0]})
    assert not construct(graph, detail=DRAFT).notes
    odd = graph_of({"label": "floor lamp", "size": [1.6, 0.3, 0.6], "position": [0, 0]})
    assert any("stretched" in note for note in construct(odd, detail=DRAFT).notes)


def test_names_and_large_numbers_get_rows_and_small_numbers_stay() -> None:
    named = graph_of({"label": "chair", "size": [0.5, 0.5, 0.9], "position": [0, 0], "id": "mine"})
    assert construct(named, detail=DRAFT).ids == {"mine": 0}
    sparse = graph_of(
        {"label": "chair", "size": [0.5, 0.5, 0.9], "position": [0, 0], "id": 7},
        {"label": "stool", "size": [0.4, 0.4, 0.5], "position": [1, 0], "id": 2},
    )
    made = construct(sparse, detail=DRAFT)
    assert made.ids == {7: 7, 2: 2}
    assert {n.id for n in SceneGraph.from_scene(made.scene).nodes} == {7, 2}


_LABELS = st.sampled_from(
    ["chair", "couch", "wooden table", "fridge", "streamers", "", "floor", "wall", "ещё", "a" * 80]
)
_SIDE = st.floats(0.0, 3.0)


@settings(max_examples=some(12), deadline=None)
@given(
    st.lists(st.tuples(_LABELS, st.tuples(_SIDE, _SIDE, _SIDE), st.floats(-359, 360), st.integers(0, 6)), max_size=4)
)
def test_any_graph_is_built(rows: list[tuple[str, tuple[float, float, float], float, int]]) -> None:
    """Whatever boxes, names, turns and rings of supports a graph has, every node but floors gets Gaussians."""
    supports: list[Any] = ["floor", "wall", "ceiling"]
    nodes = []
    for i, (label, size, yaw, pick) in enumerate(rows):
        on = supports[pick] if pick < 3 else (pick - 3) % len(rows)
        support = on if on != i else "floor"
        nodes.append(
            {"label": label, "size": size, "yaw": yaw, "support": support, "position": [i - 1.5, 0.3 * i, 0.7]}
        )
    made = construct(graph_of(*nodes), detail=0.1)
    cloud, field = made.scene.cloud, made.scene.language
    assert field is not None and torch.isfinite(cloud.means).all() and (cloud.scales > 0).all()
    assert len(made.ids) == sum(label != "floor" for label, *_ in rows)
    assert all((cloud.group == row).any() for row in made.ids.values())


@pytest.mark.parametrize(("size", "why"), [((0.2, 3, 3), "room"), ((90, 3, 3), "room")])
def test_rooms_that_cannot_be_built_are_refused(size: tuple[float, float, float], why: str) -> None:
    with pytest.raises(UserError, match=why):
        build(graph_of(size=size))
    with pytest.raises(UserError, match="detail"):
        build(graph_of(), detail=0.0)


@pytest.mark.parametrize(
    ("label", "kind"),
    [
        ("couch", "sofa"), ("small round café table", "table"), ("exposed wooden beams", "ceiling beams"),
        ("pastry display", "display case"), ("Bar Stools", "bar stool"), ("grand piano", "piano"), ("tv", "television"),
        ("sleeping bag", None), ("zorblatt", None), ("", None), ("banquette", "sofa"),
    ],
)  # fmt: skip
def test_labels_name_kinds(label: str, kind: str | None) -> None:
    found = kind_of(label)
    assert (found.name if found else None) == kind


def test_a_face_is_found_by_its_height() -> None:
    folder_assets = assets.make("bookshelf", 1, size=(0.9, 0.35, 1.8))
    node = Node(id=1, label="vase", size=(0.1, 0.1, 0.2), position=(0, 0, 0.9), support=0)
    lower = Node(id=0, label="bookshelf", size=(0.9, 0.35, 1.8), position=(0, 0, 0.9))
    room = SceneGraph.model_validate({"room": {"size": [3, 3, 3]}, "nodes": [lower.model_dump(), node.model_dump()]})
    load = loads(room)[0][0]
    assert load.height == pytest.approx(0.8)
    level = face_under(folder_assets, load)
    assert level is not None and 0.3 < level < 1.4  # a board of the shelf, not its top
    assert face_under(folder_assets, type(load)(5.0, 5.0, 0.1, 0.1, 0.0, 0.8)) is None


# --- edits -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_edits_work_on_a_built_scene_at_once() -> None:
    session = Session(built().scene, planner="grammar")
    assert session.do("make the armchair teal").receipts
    assert session.do("put a plant on the desk").receipts
    assert session.do("delete the rug").receipts
    assert session.do("make the zorblatt yellow").receipts
    nodes = {n.label: n for n in SceneGraph.from_scene(session.scene).nodes}
    assert "rug" not in nodes and nodes["armchair"].color.endswith(("teal", "green"))
    plant = next(n for label, n in nodes.items() if "plant" in label)
    assert plant.support == 0


def test_the_scene_keeps_its_names_on_disk(tmp_path: Path) -> None:
    path = tmp_path / "study.ply"
    files.save(built().scene, path)
    save_field(built().scene, path)
    loaded = load_field(files.load(path), path)
    assert loaded is not None
    assert [n.label for n in SceneGraph.from_scene(loaded).nodes] == [n.label for n in study().nodes]


# --- folders of assets -----------------------------------------------------------------------------------------------


def _folder(path: Path) -> Path:
    """A red mesh by its name, a green one by its caption, a splat, and things that are none."""
    red = trimesh.creation.box((1, 2, 1))
    red.visual = trimesh.visual.ColorVisuals(red, face_colors=[220, 20, 20, 255])
    red.export(path / "garden_gnome.glb")
    green = trimesh.creation.icosphere(subdivisions=2)
    green.visual = trimesh.visual.ColorVisuals(green, vertex_colors=[20, 180, 30, 255])
    green.export(path / "asset_0017.ply")
    files.save(build(graph_of(), detail=DRAFT).replace(cloud=assets.make("teddy bear", 1).cloud), path / "sloth.ply")
    (path / "weather vane.glb").write_bytes(b"glTF" + b"\xff" * 64)
    (path / "notes.txt").write_text("no asset")
    (path / "index.json").write_text(json.dumps({"asset_0017.ply": {"caption": "topiary sphere", "tags": ["boxwood"]}}))
    return path


@pytest.mark.slow
def test_a_folder_gives_what_its_files_captions_and_tags_name(tmp_path: Path) -> None:
    size = [0.4, 0.3, 0.6]
    rows = [
        {"label": label, "size": size, "position": [i - 2, 0]}
        for i, label in enumerate(["garden gnome", "boxwood", "sloth", "weather vane", "chair"])
    ]
    made = construct(graph_of(*rows), assets=_folder(tmp_path), detail=0.5)
    nodes = SceneGraph.from_scene(made.scene).nodes
    assert nodes[0].color.endswith("red") and nodes[1].color.endswith("green")
    assert made.blocks == (3,) and any("weather vane.glb" in note for note in made.notes)
    for node, group in zip(nodes[:3], range(3), strict=False):
        means = made.scene.cloud.means[made.scene.cloud.group == group].numpy()
        reach = np.ptp(means, axis=0)
        # Random samples come within 5 % of a side of their box's faces; splats lose their outermost half per cent.
        assert (reach > 0.85 * np.array(size)).all() and (reach < 1.05 * np.array(size)).all(), node.label
        assert abs(float(means[:, 2].min())) < 0.03


def test_a_mesh_stands_upright_and_faces_the_viewer(tmp_path: Path) -> None:
    """glTF: y up, front +z. A wedge whose slope looks to +z must slope towards -y and keep its top up."""
    corners = [[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1], [0, 1, 0], [1, 1, 0]]
    back, base, slope = [[0, 5, 1], [0, 4, 5]], [[0, 1, 3], [0, 3, 2]], [[2, 3, 5], [2, 5, 4]]
    wedge = trimesh.Trimesh(corners, [*back, *base, *slope, [0, 2, 4], [1, 5, 3]])
    wedge.export(tmp_path / "wedge.glb")
    scene = build(graph_of({"label": "wedge", "size": [1, 1, 1], "position": [0, 0]}), assets=tmp_path)
    means = scene.cloud.means[scene.cloud.group == 0]
    high = means[means[:, 2] > 0.8]
    assert float(high[:, 1].mean()) > 0.3  # the ridge is at the back


@pytest.mark.parametrize(
    "content",
    [b"", b"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", b"glTF\x02\x00\x00\x00", b"\0" * 500],
)
def test_hostile_files_become_blocks_with_a_word(tmp_path: Path, content: bytes) -> None:
    for name in ("zorb.glb", "zorb.ply"):
        (tmp_path / name).write_bytes(content)
    made = construct(graph_of({"label": "zorb", "size": [1, 1, 1], "position": [0, 0]}), assets=tmp_path, detail=DRAFT)
    assert made.blocks == (0,) and sum("passed over" in note for note in made.notes) == 2


def test_folders_and_indices_that_are_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no folder"):
        AssetFolder.read(tmp_path / "nowhere")
    with pytest.raises(UserError, match=r"no \.glb"):
        AssetFolder.read(tmp_path)
    trimesh.creation.box().export(tmp_path / "a.glb")
    for wrong in ("[]", "{", '{"a.glb": {"caption": 3}}', '{"a.glb": {"run": "rm"}}'):
        (tmp_path / "index.json").write_text(wrong)
        with pytest.raises(FileError, match="index"):
            AssetFolder.read(tmp_path)
