"""Laws every operation keeps, on random clouds without a language field and explicit selections."""

from __future__ import annotations

from typing import Any

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import InstructionError
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.rotations import normalize
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

VIEWER = Camera.look_at([0, -6, 2], [0, 0, 0], [0, 0, 1], 64, 48)
IT: dict[str, Any] = {"last": True}
seeds = st.integers(0, 10**6)

OPERATIONS: list[dict[str, Any]] = [
    {"op": "select"},
    {"op": "isolate"},
    {"op": "delete"},
    {"op": "recolor", "color": "teal"},
    {"op": "recolor", "color": "white"},
    {"op": "recolor", "adjust": "darker"},
    {"op": "move", "direction": "left", "distance": {"value": 1.5, "unit": "m"}},
    {"op": "rotate", "degrees": 30},
    {"op": "rotate", "degrees": -75, "axis": "right"},
    {"op": "arrange", "x": 0.7, "y": -0.4, "z": 6.0, "turn": 33},
    {"op": "scale", "factor": 1.7},
    {"op": "scale", "height": {"value": 2.5, "unit": "m"}},
    {"op": "scale", "factor": 0.5, "axis": "width"},
    {"op": "duplicate", "count": 2, "direction": "up"},
    {"op": "opacity", "value": 0.3},
    {"op": "opacity", "value": 0.0},
]


def random_scene(seed: int, n: int = 150, degree: int = 1) -> Scene:
    g = torch.Generator().manual_seed(seed)
    cloud = GaussianCloud.create(
        torch.randn(n, 3, generator=g),
        normalize(torch.randn(n, 4, generator=g)),
        0.01 + 0.05 * torch.rand(n, 3, generator=g),
        0.35 + 0.6 * torch.rand(n, generator=g),
        torch.cat([torch.rand(n, 1, 3, generator=g) - 0.5, 0.02 * torch.randn(n, 3, 3, generator=g)], dim=1),
        ids=torch.randperm(5 * n, generator=g)[:n],
    )
    return Scene(cloud, Frame(metres_per_unit=1.0, floor=-4.0))


def some(scene: Scene, seed: int, share: float = 0.3) -> Selection:
    """A random selection of at least one Gaussian."""
    g = torch.Generator().manual_seed(seed + 1)
    mask = torch.rand(len(scene.cloud), generator=g) < share
    mask[seed % len(scene.cloud)] = True
    return Selection(Query(last=True), "found", scene.cloud.ids[mask].sort().values)


def do(scene: Scene, data: dict[str, Any], selection: Selection) -> Done:
    return carry_out(scene, parse({"target": IT, **data}), Context(VIEWER), selection)


@pytest.mark.parametrize("data", OPERATIONS, ids=str)
@settings(max_examples=12, deadline=None)
@given(seed=seeds)
def test_outside_the_target_nothing_changes_and_the_input_stays(data: dict[str, Any], seed: int) -> None:
    scene = random_scene(seed)
    selection, digest = some(scene, seed), scene.cloud.digest()
    done = do(scene, data, selection)
    assert scene.cloud.digest() == digest
    assert done.receipt.passed and done.receipt.outside_changed == 0
    outside = ~selection.mask(scene.cloud)
    if data["op"] == "isolate":
        assert done.scene.cloud.digest() == scene.cloud[~outside].digest()
        return
    # An independent look: the rows that were outside are found again by id, in order, and are the same bits.
    kept = torch.isin(done.scene.cloud.ids, scene.cloud.ids[outside])
    assert done.scene.cloud[kept].digest() == scene.cloud[outside].digest()


@pytest.mark.parametrize("data", OPERATIONS, ids=str)
def test_the_same_input_gives_the_same_bytes(data: dict[str, Any]) -> None:
    scene = random_scene(7)
    selection = some(scene, 7)
    assert do(scene, data, selection).scene.cloud.digest() == do(scene, data, selection).scene.cloud.digest()


@pytest.mark.parametrize(
    ("data", "columns"),
    [
        ({"op": "recolor", "color": "red"}, ["sh"]),
        ({"op": "move", "direction": "up", "distance": {"value": 1}}, ["means"]),
        ({"op": "opacity", "value": 0.5}, ["opacities"]),
        ({"op": "scale", "factor": 2}, ["means", "scales"]),
        ({"op": "rotate", "degrees": 20}, ["means", "quats", "sh"]),
    ],
    ids=str,
)
def test_unchanged_columns_are_shared(data: dict[str, Any], columns: list[str]) -> None:
    scene = random_scene(1)
    done = do(scene, data, some(scene, 1))
    for name, column in scene.cloud.columns():
        assert (getattr(done.scene.cloud, name) is column) == (name not in columns), name
    assert set(done.receipt.columns) == set(columns)


@settings(max_examples=20, deadline=None)
@given(seeds, st.floats(-300, 300), st.sampled_from(["up", "right", "forward"]))
def test_turning_back_restores(seed: int, degrees: float, axis: str) -> None:
    scene = random_scene(seed)
    selection = some(scene, seed)
    turned = do(scene, {"op": "rotate", "degrees": degrees, "axis": axis}, selection).scene
    back = do(turned, {"op": "rotate", "degrees": -degrees, "axis": axis}, selection).scene
    # Coordinates below ten, four float32 roundings and a centroid: 1e-5 is ten of them.
    assert torch.allclose(back.cloud.means, scene.cloud.means, atol=1e-5)
    assert torch.allclose(back.cloud.sh, scene.cloud.sh, atol=1e-5)


@settings(max_examples=20, deadline=None)
@given(seeds, st.floats(0.01, 100), st.sampled_from([("left", "right"), ("up", "down"), ("forward", "backward")]))
def test_out_and_back_restores(seed: int, metres: float, ways: tuple[str, str]) -> None:
    scene = random_scene(seed)
    selection = some(scene, seed)
    moved = scene
    for way in ways:
        moved = do(moved, {"op": "move", "direction": way, "distance": {"value": metres}}, selection).scene
    # One rounding at the far end of the way, of a number as large as the distance.
    assert torch.allclose(moved.cloud.means, scene.cloud.means, atol=1e-6 * max(10.0, metres))


@settings(max_examples=15, deadline=None)
@given(seeds, st.floats(0.2, 5), st.sampled_from(["all", "height"]))
def test_scaling_back_restores(seed: int, factor: float, axis: str) -> None:
    scene = random_scene(seed)
    selection = some(scene, seed)
    scaled = do(scene, {"op": "scale", "factor": factor, "axis": axis}, selection).scene
    back = do(scaled, {"op": "scale", "factor": 1 / factor, "axis": axis}, selection).scene
    # The foot is measured again after each step; ten float32 roundings of coordinates below twenty.
    assert torch.allclose(back.cloud.means, scene.cloud.means, atol=5e-5)
    # Volumes are the product of three extents, each restored to a few float32 digits.
    assert torch.allclose(back.cloud.scales.prod(dim=1), scene.cloud.scales.prod(dim=1), rtol=1e-3)


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_delete_and_isolate_are_complements(seed: int) -> None:
    scene = random_scene(seed)
    selection = some(scene, seed)
    left = do(scene, {"op": "delete"}, selection).scene.cloud
    kept = do(scene, {"op": "isolate"}, selection).scene.cloud
    assert len(left) + len(kept) == len(scene.cloud)
    assert len(kept) == len(selection)
    assert set(left.ids.tolist()) | set(kept.ids.tolist()) == set(scene.cloud.ids.tolist())


def test_copies_get_new_ids_above_all_and_become_it() -> None:
    scene = random_scene(4)
    selection = some(scene, 4)
    done = do(scene, {"op": "duplicate", "count": 3, "direction": "right"}, selection)
    added = done.scene.cloud.ids[len(scene.cloud) :]
    assert len(added) == 3 * len(selection) == done.receipt.added
    assert int(added.min()) > int(scene.cloud.ids.max()) and len(torch.unique(done.scene.cloud.ids)) == len(
        done.scene.cloud
    )
    assert torch.equal(done.selection.ids, added.sort().values)


def test_an_empty_or_unknown_target_is_refused() -> None:
    scene = random_scene(0)
    nobody = Selection(Query(), "found", torch.tensor([10**9]))
    for data in OPERATIONS[3:]:
        with pytest.raises(InstructionError):
            do(scene, data, nobody)
    with pytest.raises(InstructionError):
        do(scene, {"op": "delete"}, Selection(Query(), "found", torch.zeros(0, dtype=torch.int64)))


def test_fifty_random_edits_undo_to_the_same_bytes() -> None:
    g = torch.Generator().manual_seed(11)
    scene = random_scene(11, n=400)
    history, digests = [scene], [scene.cloud.digest()]
    while len(history) <= 50:
        data = OPERATIONS[int(torch.randint(len(OPERATIONS), (1,), generator=g))]
        if data["op"] == "isolate" or (data["op"] == "delete" and len(history[-1].cloud) < 200):
            continue
        selection = some(history[-1], int(torch.randint(10**6, (1,), generator=g)), share=0.1)
        try:
            history.append(do(history[-1], data, selection).scene)
        except InstructionError:  # a check refused it, which must leave the scene as it was
            assert history[-1].cloud.digest() == digests[-1]
            continue
        digests.append(history[-1].cloud.digest())
    for old, digest in zip(reversed(history), reversed(digests), strict=True):
        assert old.cloud.digest() == digest


@pytest.mark.parametrize("removal", ["delete", "isolate"])
def test_ids_of_what_was_deleted_are_given_to_nothing_else(removal: str) -> None:
    """Else "it", said of a thing that was deleted, would mean the next thing that is made."""
    scene = random_scene(3)
    top = scene.cloud.ids.sort().values[-40:]
    rest = scene.cloud.ids[~torch.isin(scene.cloud.ids, top)].sort().values
    chosen = top if removal == "delete" else rest
    after = do(scene, {"op": removal}, Selection(Query(last=True), "found", chosen)).scene
    copied = do(after, {"op": "duplicate", "direction": "up"}, Selection(Query(last=True), "found", rest[:20])).scene
    made = copied.cloud.ids[~torch.isin(copied.cloud.ids, after.cloud.ids)]
    assert len(made) == 20 and int(made.min()) > int(top.max())
