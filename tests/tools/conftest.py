"""A furnished corner with a true language field: floor, table, two chairs, a vase on the table; SH degree 2."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection, nothing
from scenewright.gaussians.rotations import axis_rotation
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.operation import Context
from scenewright.tools.transform import transformed

FRAME = Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given")
TABLE, CHAIR, RED_CHAIR, VASE, FLOOR = range(5)
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Thing:
    """What stands where: kind, colour, position of its foot, degrees about up."""

    kind: str
    color: str
    foot: Vec3
    degrees: float = 0.0


class Names:
    """The part of an encoder that operations use: a vector for a name."""

    fingerprint = "names:1"

    def knows(self, text: str) -> bool:
        return bool(text)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        vectors = [np.random.default_rng(len(t)).normal(size=4) for t in texts]
        return np.stack([v / np.linalg.norm(v) for v in vectors]).astype(np.float32)


def by_name(
    scene: Scene, query: Query, viewer: Camera, encoder: object = None, last: Selection | None = None
) -> Selection:
    """Finds groups by exact label (or explicit ids): the smallest thing that has the resolver's signature."""
    assert scene.language is not None
    if query.last:
        return last if last is not None else nothing(query, "nothing was selected before")
    living = [g for g in scene.language.groups if g.count]
    found = [g for g in living if (g.id in query.groups if query.groups else g.label == query.text)]
    if not found:
        return nothing(query, f"{query.describe()} is not here")
    if len(found) > 1 and query.pick == "one":
        return Selection(query, "ambiguous", torch.zeros(0, dtype=torch.int64), reason=f"{len(found)} match")
    leaves = torch.tensor([i for g in found for i in scene.language.leaves(g.id)], dtype=torch.int32)
    ids = scene.cloud.ids[torch.isin(scene.cloud.group, leaves)]
    return Selection(query, "found", ids.sort().values, tuple(g.id for g in found))


def _floor(side: float) -> GaussianCloud:
    steps = torch.linspace(-side / 2, side / 2, 80)
    means = torch.cartesian_prod(steps, steps, torch.zeros(1))
    n = len(means)
    scales = torch.tensor([side / 100, side / 100, 0.002]).expand(n, 3).contiguous()
    shade = 0.55 + 0.1 * torch.rand(n, 1, 1, generator=torch.Generator().manual_seed(1)).expand(n, 1, 3)
    quats = torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous()
    return GaussianCloud.create(means, quats, scales, torch.full((n,), 0.95), ((shade - 0.5) / 0.2820948).contiguous())


def build(things: list[Thing], degree: int = 2, detail: float = 0.4) -> Scene:
    """A scene of library objects on a 6 m floor with a field that is right by construction."""
    clouds = []
    for seed, thing in enumerate(things):
        cloud = assets.make(thing.kind, seed, color=thing.color, detail=detail).cloud
        clouds.append(transformed(cloud, axis_rotation(_UP, thing.degrees), np.array(thing.foot)))
    clouds.append(_floor(6.0))
    labels = [*(t.kind for t in things), "floor"]
    first, filed, groups = 0, [], []
    for i, cloud in enumerate(clouds):
        ids = torch.arange(first, first + len(cloud))
        filed.append(cloud.replace(ids=ids, group=torch.full((len(cloud),), i, dtype=torch.int32)))
        first += len(cloud)
        angle = math.radians(things[i].degrees) if i < len(things) else 0.0
        x, y = (math.cos(angle), math.sin(angle), 0.0), (-math.sin(angle), math.cos(angle), 0.0)
        box = box_of(cloud, FRAME, axes=(x, y, (0.0, 0.0, 1.0)))
        level = "structure" if labels[i] == "floor" else "object"
        lab = lab_of_cloud(cloud)
        groups.append(Group(i, level, -1, labels[i], 0.9, box, lab, len(cloud), 8, 1.0))  # type: ignore[arg-type]
    cloud = concat(filed).with_degree(degree)
    noise = torch.randn(cloud.sh[:, 1:].shape, generator=torch.Generator().manual_seed(2)) * 0.03
    cloud = cloud.replace(sh=torch.cat([cloud.sh[:, :1], noise], dim=1))
    field = LanguageField(tuple(groups), Names().encode_text(labels), Names.fingerprint)
    return Scene(cloud, FRAME, (), field)


@pytest.fixture(scope="session")
def corner() -> Scene:
    """Frozen, so one for all tests."""
    return build(
        [
            Thing("table", "brown", (0.0, 0.6, 0.0)),
            Thing("chair", "green", (-1.6, 0.0, 0.0), 25.0),
            Thing("armchair", "red", (1.8, 0.5, 0.0), -10.0),
            Thing("vase", "white", (0.25, 0.6, _table_top())),
        ]
    )


def _table_top() -> float:
    return assets.make("table", 0, color="brown", detail=0.4).size[2]


@pytest.fixture(scope="session")
def viewer() -> Camera:
    """Stands at the near side and looks along +y: the viewer's right is +x, forward is +y."""
    return Camera.look_at([0, -5, 2], [0, 0.5, 0.5], [0, 0, 1], 96, 64, 55, "door")


@pytest.fixture
def context(viewer: Camera) -> Context:
    return Context(viewer=viewer, encoder=Names(), resolver=by_name)  # type: ignore[arg-type]
