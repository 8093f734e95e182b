"""The background is everything but the subject: of captures what the cameras go around, of rooms every thing."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.query.background import looked_at, subject_of
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
GROUND, POT, PLANT, SHELF = range(4)
UP = (0, 0, 1)


def around(count: int = 12, away: float = 4.0, turn: float = 2 * np.pi) -> tuple[Camera, ...]:
    """Cameras on an arc, looking at a place over the middle of the ground."""
    angles = np.linspace(0, turn, count, endpoint=False)
    eyes = [(away * np.cos(a), away * np.sin(a), 2.0) for a in angles]
    return tuple(Camera.look_at(eye, (0, 0, 0.6), UP, 64, 48) for eye in eyes)


def yard(sure: float = 0.1, cameras: tuple[Camera, ...] = ()) -> Scene:
    """A plant in a pot on the ground and a far larger shelf at the edge; specks beside the plant and over the shelf."""
    g = torch.Generator().manual_seed(0)

    def block(count: int, low: tuple[float, float, float], size: tuple[float, float, float]) -> torch.Tensor:
        return torch.tensor(low) + torch.rand(count, 3, generator=g) * torch.tensor(size)

    parts = {
        GROUND: block(4000, (-4, -4, -0.05), (8, 8, 0.05)),
        POT: block(1500, (-0.3, -0.3, 0.0), (0.6, 0.6, 0.5)),
        PLANT: block(1500, (-0.5, -0.5, 0.5), (1.0, 1.0, 0.9)),
        SHELF: block(3000, (3.0, -2.0, 0.0), (0.8, 4.0, 2.5)),
        -1: torch.cat([block(40, (0.5, -0.2, 0.8), (0.05, 0.3, 0.3)), block(40, (3.2, -1.0, 2.6), (0.3, 0.3, 0.1))]),
    }
    means = torch.cat(list(parts.values()))
    group = torch.cat([torch.full((len(p),), i) for i, p in parts.items()])
    n = len(means)
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4), torch.full((n, 3), 0.03), torch.full((n,), 0.9),
        color_to_dc(0.3 + 0.4 * torch.rand(n, 3, generator=g))[:, None], group.to(torch.int32),
    )  # fmt: skip

    def row(i: int, level: str, label: str) -> Group:
        points = parts[i].double().numpy()
        low, high = points.min(axis=0), points.max(axis=0)
        box = Box(tuple((low + high) / 2), AXES, tuple(high - low))
        return Group(i, level, -1, label, sure, box, (50.0, 0.0, 0.0), len(points), 8, 1.0)  # type: ignore[arg-type]

    names = [
        (GROUND, "structure", "floor"),
        (POT, "object", "pot"),
        (PLANT, "object", "plant"),
        (SHELF, "object", "shelf"),
    ]
    field = LanguageField(tuple(row(*name) for name in names), np.zeros((4, 8), np.float32), "none")
    return Scene(cloud, Frame(floor=0.0, up_source="given"), cameras, field)


def of(scene: Scene, *groups: int) -> np.ndarray:
    return np.isin(scene.cloud.group.numpy(), groups)


def test_the_subject_of_a_capture_is_what_the_cameras_go_around() -> None:
    """The plant with its pot and the specks that are nearest to it; not the heavier shelf and its specks."""
    scene = yard(cameras=around())
    found = subject_of(scene)
    assert found is not None and found.sure and found.groups == (POT, PLANT)
    near_plant = (scene.cloud.group == -1).numpy() & (scene.cloud.means[:, 0] < 2).numpy()
    assert np.array_equal(found.rows, of(scene, POT, PLANT) | near_plant)


def test_in_a_scene_of_sure_names_every_thing_is_the_subject() -> None:
    scene = yard(0.95, around())
    found = subject_of(scene)
    assert found is not None and found.sure
    assert np.array_equal(found.rows, of(scene, POT, PLANT, SHELF))


def test_cameras_on_one_side_do_not_tell_the_subject() -> None:
    """What is chosen is to be confirmed, and then taken."""
    scene = yard(cameras=around(turn=0.4))
    query, viewer = Query(text="background"), scene.cameras[0]
    asked = resolve(scene, query, viewer)
    assert asked.verdict == "unconfirmed" and "one side" in asked.reason and len(asked)
    assert resolve(scene, query.model_copy(update={"confirmed": True}), viewer).verdict == "found"


def test_without_cameras_a_thing_that_is_most_of_what_is_there_is_the_subject() -> None:
    """Plant and pot are in one piece; the shelf is as heavy, so nobody can tell."""
    found = subject_of(yard())
    assert (found is not None and not found.sure) or (found is not None and SHELF in found.groups)
    alone = yard()
    kept = alone.cloud[torch.from_numpy(~of(alone, SHELF))]
    groups = list(alone.language.groups)  # type: ignore[union-attr]
    groups[SHELF] = Group(SHELF, "object", -1, "", 0.0, groups[SHELF].box, (0.0, 0.0, 0.0), 0, 0, 0.0)
    field = LanguageField(tuple(groups), np.zeros((4, 8), np.float32), "none")
    found = subject_of(alone.replace(cloud=kept, language=field))
    assert found is not None and found.sure and set(found.groups) == {POT, PLANT}


def test_a_scene_of_its_subject_alone_has_no_background() -> None:
    scene = yard(cameras=around())
    kept = scene.cloud[torch.from_numpy(of(scene, POT, PLANT))]
    asked = resolve(scene.replace(cloud=kept), Query(text="background"), scene.cameras[0])
    assert asked.verdict == "absent" and "no background" in asked.reason


@pytest.mark.parametrize("word", ["background", "surroundings", "backdrop", "environment"])
def test_words_for_it_mean_the_same(word: str) -> None:
    scene = yard(cameras=around())
    one, other = (resolve(scene, Query(text=w), scene.cameras[0]) for w in ("background", word))
    assert one.verdict == "found" and torch.equal(one.ids, other.ids)
    subject = subject_of(scene)
    assert subject is not None and np.array_equal(one.mask(scene.cloud).numpy(), ~subject.rows)


def test_a_thing_that_is_called_so_is_meant() -> None:
    scene = yard(0.95, around())
    assert scene.language is not None
    groups = list(scene.language.groups)
    shelf = groups[SHELF]
    groups[SHELF] = Group(SHELF, "object", -1, "backdrop", 0.95, shelf.box, shelf.lab, shelf.count, 8, 1.0)
    named = scene.replace(language=LanguageField(tuple(groups), scene.language.embeddings, "none"))
    with pytest.raises(BackendError):  # it is looked up by its name, which takes an encoder
        resolve(named, Query(text="backdrop"), scene.cameras[0])
    assert resolve(named, Query(text="background"), scene.cameras[0]).verdict == "found"


EDITS = [
    {"op": "delete"},
    {"op": "recolor", "adjust": "darker"},
    {"op": "recolor", "color": "blue"},
    {"op": "opacity", "value": 0.3},
]


@pytest.mark.parametrize("edit", EDITS, ids=lambda e: " ".join(map(str, e.values())))
def test_edits_of_the_background_leave_the_subject_as_it_is(edit: dict[str, object]) -> None:
    scene = yard(cameras=around())
    subject = subject_of(scene)
    assert subject is not None
    rows = torch.from_numpy(subject.rows)
    done = carry_out(scene, parse(edit | {"target": {"text": "background"}}), Context(scene.cameras[0]))
    after = done.scene.cloud
    kept = after[torch.isin(after.ids, scene.cloud.ids[rows])]
    assert kept.digest() == scene.cloud[rows].digest()
    if edit["op"] == "delete":
        assert len(done.scene.cloud) == int(rows.sum())


def test_what_cameras_look_at() -> None:
    """The place that all axes pass; nothing where they look outwards; one-sided where they look the same way."""
    focus = looked_at(around(away=3.0))
    assert focus is not None and np.allclose(focus.point, (0, 0, 0.6), atol=1e-6) and not focus.one_sided
    assert focus.away == pytest.approx(np.hypot(3.0, 1.4))
    outwards = [Camera.look_at((0, 0, 1), (np.cos(a), np.sin(a), 1.2), UP, 64, 48) for a in np.linspace(0, 6, 12)]
    assert looked_at(outwards) is None
    sided = looked_at(around(turn=0.3))
    assert sided is not None and sided.one_sided
    assert looked_at(around()[:3]) is None


def test_parallel_cameras_look_at_no_place_that_is_far_away() -> None:
    """A row of cameras: their axes meet nowhere, and the point stays with the cameras."""
    row = [Camera.look_at((x, -3, 1), (x, 0, 1), UP, 64, 48) for x in np.linspace(-1, 1, 6)]
    found = looked_at(row)
    assert found is None or found.one_sided
