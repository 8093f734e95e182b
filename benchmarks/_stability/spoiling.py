"""Disturbances of a scene: each makes a new case whose truth is still known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.harmonics import SH_C0
from ...gaussians.render import contributions
from ...gaussians.rotations import axis_rotation, normalize, to_matrix
from ...gaussians.scene import Frame
from ...tools.transform import transformed
from .._select.cases import Case
from .._select.pictures import SEEN, eyes

F64 = NDArray[np.float64]
WALL = 0.02  # metres above the floor from which structure is wall


def with_cloud(case: Case, cloud: GaussianCloud) -> Case:
    """The case with other Gaussians in the same rows."""
    return replace(case, scene=case.scene.replace(cloud=cloud, language=None))


def kept(case: Case, rows: NDArray[np.bool_]) -> Case:
    """The case with some of its Gaussians only."""
    cloud = case.scene.cloud[torch.from_numpy(rows)]
    cloud = cloud.replace(ids=torch.arange(len(cloud)))
    return replace(with_cloud(case, cloud), ids=case.ids[rows])


def added(case: Case, more: GaussianCloud) -> Case:
    """The case with Gaussians that belong to nothing."""
    first = int(case.scene.cloud.ids.max()) + 1
    more = more.replace(ids=torch.arange(len(more)) + first)
    ids = np.concatenate([case.ids, np.full(len(more), -1, np.int32)])
    return replace(with_cloud(case, concat([case.scene.cloud, more])), ids=ids)


def _random(case: Case) -> torch.Generator:
    return torch.Generator().manual_seed(case.seed)


# -- shape ----------------------------------------------------------------------------------------------------------


def jittered(case: Case, metres: float) -> Case:
    """Every centre off by a normal error of some metres in each direction."""
    cloud = case.scene.cloud
    return with_cloud(case, cloud.replace(means=cloud.means + metres * _noise(case, 3)))


def inflated(case: Case, factor: float) -> Case:
    """Every Gaussian larger, as blurred photographs make them."""
    cloud = case.scene.cloud
    return with_cloud(case, cloud.replace(scales=cloud.scales * factor))


def thinned(case: Case, dropped: float) -> Case:
    """A random share of the Gaussians left out."""
    return kept(case, np.random.default_rng(case.seed).random(len(case.ids)) >= dropped)


def hazy(case: Case, factor: float) -> Case:
    """Every Gaussian fainter."""
    cloud = case.scene.cloud
    return with_cloud(case, cloud.replace(opacities=cloud.opacities * factor))


def seen_from(case: Case, count: int) -> Case:
    """Only what a few pictures show: other things and back sides were never captured."""
    seen = np.zeros(len(case.ids), bool)
    for eye in eyes(case.scene, count, 256):
        seen |= contributions(case.scene.cloud, eye).numpy() > SEEN
    return kept(case, seen)


def shuffled(case: Case) -> Case:
    """The same Gaussians in another order of rows."""
    order = np.random.default_rng(case.seed).permutation(len(case.ids))
    cloud = case.scene.cloud[torch.from_numpy(order)]
    cloud = cloud.replace(ids=torch.arange(len(cloud)))
    return replace(with_cloud(case, cloud), ids=case.ids[order])


def two_sided(case: Case, thickness: float) -> Case:
    """Walls with a second face outside, some metres behind the first, as scans of houses have them."""
    cloud = case.scene.cloud
    rows = torch.from_numpy((case.ids < 0) & (case.points[:, 2] > WALL))
    wall = cloud[rows]
    thin = wall.scales.argmin(dim=1)
    normal = to_matrix(wall.quats)[torch.arange(len(wall)), :, thin]
    outward = wall.means - cloud.means.mean(dim=0)
    normal = normal * (normal * outward).sum(dim=1, keepdim=True).sign()
    return added(case, wall.replace(means=wall.means + thickness * normal))


def screened(case: Case, share: float) -> Case:
    """Panels that stand between the first camera and a share of the things, 30 cm in front of them."""
    eye = case.scene.cameras[0].position
    things = [o for o in case.objects if o.support == "floor"]
    hidden = np.random.default_rng(case.seed).permutation(len(things))[: round(share * len(things))]
    panels = [_panel(eye, np.array(things[i].position), np.array(things[i].size)) for i in sorted(hidden.tolist())]
    return added(case, _joined(panels)) if panels else case


def _panel(eye: F64, middle: F64, size: F64) -> GaussianCloud:
    """A grid of flat opaque splats, as wide and high as what it hides, upright on the floor."""
    ahead = (eye - middle) * [1, 1, 0]
    ahead /= np.linalg.norm(ahead)
    side = np.array([-ahead[1], ahead[0], 0.0])
    foot = (middle + ahead * (np.linalg.norm(size[:2]) / 2 + 0.3)) * [1, 1, 0]
    u = np.arange(-size[:2].max() / 2, size[:2].max() / 2, 0.04)
    v = np.arange(0.0, middle[2] + size[2] / 2, 0.04)
    means = np.array([foot + a * side + [0, 0, b] for a in u for b in v])
    turn = np.stack([side, [0, 0, 1], np.cross(side, [0, 0, 1])], axis=1)
    from ...gaussians.rotations import from_matrix

    count = len(means)
    return GaussianCloud.create(
        torch.from_numpy(means).float(),
        from_matrix(torch.from_numpy(turn).float()).expand(count, 4).contiguous(),
        torch.tensor([0.025, 0.025, 0.002]).expand(count, 3).contiguous(),
        torch.full((count,), 0.95),
        torch.zeros(count, 1, 3),
    )


def _joined(clouds: Sequence[GaussianCloud]) -> GaussianCloud:
    start, parts = 0, []
    for cloud in clouds:
        parts.append(cloud.replace(ids=torch.arange(len(cloud)) + start))
        start += len(cloud)
    return concat(parts)


def with_outliers(case: Case, count: int) -> Case:
    """A few Gaussians far outside, as every fit of a capture has them."""
    g, cloud = _random(case), case.scene.cloud
    ways = normalize(torch.cat([torch.randn(count, 3, generator=g), torch.zeros(count, 1)], dim=1))[:, :3]
    far = 10 ** (1.5 + 1.5 * torch.rand(count, 1, generator=g))  # 30 m to 1 km
    return added(case, _strays(ways * far, 0.2 + torch.rand(count, 3, generator=g), 0.6, g, cloud.degree))


def with_degenerate(case: Case, share: float) -> Case:
    """Needles, specks of a micrometre, huge faint veils and exact copies in place of nothing, strewn over the room."""
    g, cloud = _random(case), case.scene.cloud
    count = max(round(share * len(cloud) / 4), 1)
    low, high = cloud.means.amin(dim=0), cloud.means.amax(dim=0)

    def at() -> torch.Tensor:
        return low + torch.rand(count, 3, generator=g) * (high - low)

    needles = torch.tensor([1.0, 1e-6, 1e-6]).expand(count, 3)
    specks = torch.full((count, 3), 1e-6)
    veils = 0.5 + 2 * torch.rand(count, 3, generator=g)
    parts = [
        _strays(at(), needles, 0.5, g, cloud.degree),
        _strays(at(), specks, 0.999, g, cloud.degree),
        _strays(at(), veils, 0.004, g, cloud.degree),
        cloud[torch.randint(len(cloud), (count,), generator=g)],
    ]
    return added(case, _joined(parts))


def _strays(
    means: torch.Tensor, scales: torch.Tensor, opacity: float, g: torch.Generator, degree: int
) -> GaussianCloud:
    count = len(means)
    return GaussianCloud.create(
        means,
        normalize(torch.randn(count, 4, generator=g)),
        scales.contiguous(),
        torch.full((count,), opacity),
        torch.randn(count, 1, 3, generator=g) * 0.8,
    ).with_degree(degree)


def _noise(case: Case, width: int) -> torch.Tensor:
    return torch.randn(len(case.ids), width, generator=_random(case))


# -- colour ---------------------------------------------------------------------------------------------------------


def colour_noise(case: Case, deviation: float) -> Case:
    """Every Gaussian's colour off by a normal error, of display values from 0 to 1."""
    sh = case.scene.cloud.sh.clone()
    sh[:, 0] += deviation / SH_C0 * _noise(case, 3)
    return with_cloud(case, case.scene.cloud.replace(sh=sh))


def lit(case: Case, gains: Sequence[float]) -> Case:
    """Red, green and blue times a gain each: dimmed, or lit warmly."""
    cloud, gain = case.scene.cloud, torch.tensor(gains)
    sh = cloud.sh * gain
    sh[:, 0] += (gain - 1) * 0.5 / SH_C0
    return with_cloud(case, cloud.replace(sh=sh))


# -- frame ----------------------------------------------------------------------------------------------------------


def scaled(case: Case, factor: float) -> Case:
    """The world in other units, which nobody states."""
    return moved(case, np.eye(3) * factor)


def turned(case: Case, axis: Sequence[float], degrees: float) -> Case:
    """The world turned about an axis through its origin; up is not stated."""
    return moved(case, axis_rotation(np.array(axis, float), degrees))


def moved(case: Case, matrix: F64) -> Case:
    """The world under a similarity, its cameras with it, and nothing known of its frame."""
    factor = float(np.cbrt(np.linalg.det(matrix)))
    cloud = transformed(case.scene.cloud, matrix, np.zeros(3))
    cameras = tuple(_carried(c, matrix / factor, factor) for c in case.scene.cameras)
    return replace(case, scene=case.scene.replace(cloud=cloud, frame=Frame(), cameras=cameras, language=None))


def _carried(camera: Camera, turn: F64, factor: float) -> Camera:
    pose = np.eye(4)
    pose[:3, :3] = camera.world_to_camera[:3, :3] @ turn.T
    pose[:3, 3] = camera.world_to_camera[:3, 3] * factor
    return replace(camera, world_to_camera=pose)
