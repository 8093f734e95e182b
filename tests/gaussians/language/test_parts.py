"""Parts by shape: furniture with labelled parts, and shapes without the part."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import as_axes, box_of, lab_of_cloud
from scenewright.gaussians.language.query import parts
from scenewright.gaussians.language.query.part_query import shape_in
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene

F64 = NDArray[np.float64]
FRAME = Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given")
EYE = Camera.look_at((0, -5, 1.5), (0, 0, 0.4), (0, 0, 1))
FRONT = np.array([0.0, -1.0, 0.0])


def scene_of(cloud: GaussianCloud) -> Scene:
    """One thing, group 0, as an embedded scene; it is asked for as "thing", which needs no encoder."""
    cloud = cloud.replace(group=torch.zeros(len(cloud), dtype=torch.int32), ids=torch.arange(len(cloud)))
    box = box_of(cloud, FRAME, axes=as_axes(np.eye(3)))
    group = Group(0, "object", -1, "thing", 1.0, box, lab_of_cloud(cloud), len(cloud), 1, 1.0)
    return Scene(cloud, FRAME, language=LanguageField((group,), np.zeros((1, 2), np.float32), "none"))


def ask(scene: Scene, name: str, **more: object) -> Selection:
    relation = {"name": "part_of", "anchors": [{"text": "thing"}]}
    return resolve(scene, Query.model_validate({"text": name, "relations": [relation], "pick": "all", **more}), EYE)


def overlap(found: Selection, truth: NDArray[np.bool_]) -> float:
    mine = np.zeros(len(truth), bool)
    mine[found.ids.numpy()] = True
    return float((mine & truth).sum() / max((mine | truth).sum(), 1))


@pytest.mark.parametrize(
    ("name", "kind", "truly", "least"),
    [
        # what builders call by that name; the least is what seeds 101 to 110 reach on average, less about a tenth
        ("leg", "table", {"leg", "pedestal"}, 0.85), ("leg", "chair", {"leg"}, 0.75), ("leg", "stool", {"leg"}, 0.7),
        ("leg", "cabinet", {"leg"}, 0.5), ("top", "table", {"top"}, 0.85), ("top", "desk", {"top"}, 0.6),
        ("seat", "chair", {"seat", "cushion"}, 0.7), ("seat", "stool", {"seat"}, 0.75),
        ("back", "chair", {"back"}, 0.8),
        ("shade", "floor lamp", {"shade", "inside", "trim", "rib"}, 0.8),
        ("shade", "pendant lamp", {"shade", "inside", "trim", "rib"}, 0.8), ("base", "desk lamp", {"base"}, 0.8),
    ],
)  # fmt: skip
def test_parts_are_those_that_builders_named(name: str, kind: str, truly: set[str], least: float) -> None:
    shares = []
    for seed in range(101, 105):
        made = assets.make(kind, seed, detail=0.5)
        named = [i for i, part in enumerate(made.parts.names) if part in truly]
        truth = np.isin(made.parts.labels.numpy(), named)
        if truth.any():
            scene = scene_of(made.cloud)
            assert scene.language is not None
            shape = shape_in(scene, np.arange(len(truth)), scene.language.groups[0], FRONT)
            found = parts.part_of(name, shape)
            mine = np.zeros(len(truth), bool) if isinstance(found, str) else found
            shares.append(float((mine & truth).sum() / (mine | truth).sum()))
    assert shares and float(np.mean(shares)) >= least


def table() -> tuple[GaussianCloud, NDArray[np.bool_]]:
    """A plate on four posts, and which rows are posts."""
    rng = np.random.default_rng(0)
    plate = rng.uniform((-0.6, -0.4, 0.7), (0.6, 0.4, 0.75), (1500, 3))
    posts = [
        rng.uniform((-0.03, -0.03, 0), (0.03, 0.03, 0.7), (200, 3)) + np.array([x, y, 0])
        for x in (-0.5, 0.5)
        for y in (-0.3, 0.3)
    ]
    points = np.concatenate([plate, *posts])
    n = len(points)
    color = torch.where(torch.arange(n)[:, None] < 1500, torch.tensor([[1.5, -1.2, -1.2]]), torch.zeros(1, 3))
    cloud = GaussianCloud.create(
        torch.from_numpy(points).float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1),
        torch.tensor([[0.03, 0.03, 0.003]]).repeat(n, 1), torch.full((n,), 0.9), color[:, None, :].contiguous(),
    )  # fmt: skip
    return cloud, np.arange(n) >= 1500


def test_legs_are_counted_and_each_can_be_meant() -> None:
    cloud, posts = table()
    scene = scene_of(cloud)
    every = ask(scene, "leg")
    assert overlap(every, posts) > 0.9 and "shape" in every.reason
    which = ask(scene, "leg", pick="one")
    assert which.verdict == "ambiguous" and len(which.candidates) == 4 and "group" not in which.reason
    tied = ask(scene, "leg", pick="leftmost")  # the front and the back leg on the left: equals are told
    assert tied.verdict == "ambiguous" and len(tied.candidates) == 2
    left = ask(scene, "leg", pick="nth", ordinal=1)
    x = cloud.means[left.ids, 0]
    assert left.verdict == "found" and bool((x < -0.4).all()) and 150 < len(left) < 250
    assert ask(scene, "leg", count=4).verdict == "found" and ask(scene, "leg", count=3).verdict == "ambiguous"


def test_a_part_has_its_own_colour() -> None:
    cloud, posts = table()
    scene = scene_of(cloud)
    assert overlap(ask(scene, "top", colors=["red"]), ~posts) > 0.9
    assert (
        ask(scene, "leg", colors=["red"]).verdict == "absent" and ask(scene, "leg", colors=["gray"]).verdict == "found"
    )


def test_top_and_legs_share_nothing_and_make_up_the_table() -> None:
    scene = scene_of(table()[0])
    legs, top = set(ask(scene, "leg").ids.tolist()), set(ask(scene, "top").ids.tolist())
    assert not legs & top and len(legs | top) > 0.95 * len(scene.cloud)


@pytest.mark.parametrize(
    ("low", "high", "name", "why"),
    [
        ((-0.3, -0.3, 0), (0.3, 0.3, 0.6), "leg", "no legs"),
        ((-1, -1, 0), (1, 1, 0.02), "leg", "too flat"),
        ((-0.3, -0.3, 0), (0.3, 0.3, 0.6), "shade", "without a shade"),
        ((-0.3, -0.3, 0), (0.3, 0.3, 0.6), "back", "cannot be told"),
        ((-0.3, -0.3, 0), (0.3, 0.3, 0.6), "gearbox", "cannot be told by shape"),
    ],
)
def test_what_a_shape_does_not_have_is_refused_in_a_sentence(
    low: tuple[float, float, float], high: tuple[float, float, float], name: str, why: str
) -> None:
    n = 4000
    points = np.random.default_rng(1).uniform(low, high, (n, 3))
    cloud = GaussianCloud.create(
        torch.from_numpy(points).float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), 0.01),
        torch.full((n,), 0.9), torch.zeros(n, 1, 3),
    )  # fmt: skip
    answer = ask(scene_of(cloud), name)
    assert answer.verdict == "absent" and why in answer.reason
