"""bench mesh: how near meshes of Gaussians are to the surfaces these were made of, and how alike they look.

Things whose true mesh is known, procedural ones and foreign meshes, are made into Gaussians and back into meshes.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..gaussians.assets import make, registry
from ..gaussians.assets.modeling import imported
from ..gaussians.assets.modeling import make as modeling
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.meshing import Mesh, mesh
from ..gaussians.meshing.making import TEXTURE
from ..gaussians.meshing.raster import draw
from ..gaussians.meshing.shaping import sphere_cameras
from ..gaussians.meshing.texturing import installed
from ..gaussians.render import render
from ..gaussians.scene import Frame, Scene
from ..gaussians.world import kinds as world
from ._data import folder, missing
from .harness import Metric, Point, Result

F64 = NDArray[np.float64]

KINDS = (
    "armchair", "sofa", "bookcase", "floor lamp", "potted plant", "bicycle", "dining chair", "desk", "bed", "vase",
)  # fmt: skip
FOREIGN = (
    "bear", "chairRounded", "radio", "toaster", "loungeChair", "kitchenStove", "bookcaseOpenLow", "plant", "stoolBar",
    "lampRoundTable",
)  # fmt: skip
QUICK = 1  # things of each kind
GRIDS, QUICK_GRIDS = (32, 64, 128), (32,)  # cells along the longest side, for the chart
CHARTED = 3  # things that the chart's points are means over
POINTS = 60_000  # samples of a surface
CHAMFER_GOAL, PSNR_GOAL, SECONDS_GOAL = 1.0, 26.0, 60.0  # percent of the longest side, dB, s
VIEWS, SIZE, FINE = 8, 320, 3  # held-out pictures, their pixels a side, and samples a side of a pixel of the mesh
WITNESSES = 160  # cameras from which the true mesh is seen
SEED = 7


@dataclass(frozen=True, eq=False)
class Thing:
    """Gaussians and the triangles `[T, 3, 3]` that they were made of, in one frame, metres."""

    name: str
    cloud: GaussianCloud
    triangles: F64


@dataclass(frozen=True)
class Outcome:
    """`chamfer`: percent of the longest side; `psnr`: dB over whole pictures, `inside`: where either shows the thing;
    `seconds`: of the clock, `cpu`: of the processor; and the mesh's faces, cells and bytes."""

    chamfer: float
    psnr: float
    inside: float
    seconds: float
    cpu: float
    faces: int
    cells: int
    bytes: int


def run(quick: bool) -> Result:
    """Every thing with the defaults, watertight; then some of them on grids of several sizes."""
    notes: list[str] = []
    things = list(_things(quick, notes))
    texture = TEXTURE if installed() else 0
    mesh(things[0].cloud, texture=texture, cells=16)  # compiles
    metrics: list[Metric] = []
    found = {thing.name: measured(thing, texture, None) for thing in things}
    for name, outcome in found.items():
        metrics += _metrics(name, outcome)
    metrics += _summary(list(found.values()))
    points = []
    for cells in (*(QUICK_GRIDS if quick else GRIDS), None):
        some = things[:: max(1, len(things) // CHARTED)]
        points.append(_point(cells, [measured(t, texture, cells) if cells else found[t.name] for t in some]))
    if not texture:
        notes.append("xatlas is not installed: colours of vertices were measured, not textures")
    notes += [
        "Chamfer: the mean of the mean distances from the mesh to the truth and from what can be seen of the truth to "
        f"the mesh, {POINTS:,} points each, in percent of the longest side; what no camera around the thing sees of "
        "the truth, such as faces inside others, does not count",
        f"PSNR: {VIEWS} held-out pictures of {SIZE} px that the thing fills, over black and over white; the mesh is "
        f"drawn by the project's own rasteriser with {FINE}x{FINE} samples a pixel; 'inside' counts only pixels that "
        "show the thing",
        "seconds: of the clock, of the whole call, without compilation; cpu: of the processor",
    ]
    return Result(
        "meshes of Gaussians", "size over Chamfer distance, dB", tuple(metrics), tuple(points), tuple(notes), (SEED,)
    )


def _things(quick: bool, notes: list[str]) -> Iterator[Thing]:
    for kind in KINDS[: QUICK if quick else None]:
        yield procedural(kind)
    place = folder("meshes")
    if place is None:
        notes.append(missing("meshes"))
        return
    for name in FOREIGN[: QUICK if quick else None]:
        yield foreign(place / f"{name}.glb")


def procedural(kind: str, seed: int = 1) -> Thing:
    """A thing of a procedural kind."""
    known, meant = registry.find(kind), world.find(kind)
    assert meant is not None
    asset = make(kind, seed)
    pieces = modeling.fit_to_size(modeling.design(known, seed)[0], asset.size)
    parts = []
    for sheets in (s for piece in pieces for s in piece.sheets):
        p = np.concatenate([sheets.points, sheets.points[:, :, :1]], axis=2) if sheets.closed else sheets.points
        a, b, c, d = p[:, :-1, :-1], p[:, 1:, :-1], p[:, 1:, 1:], p[:, :-1, 1:]
        parts += [np.stack(corners, axis=-2).reshape(-1, 3, 3) for corners in ((a, b, c), (a, c, d))]
    return Thing(kind, asset.cloud, np.concatenate(parts))


def foreign(path: Path) -> Thing:
    """A mesh of others, in its own proportions, one metre long."""
    size = np.array(imported.natural_size(path))
    w, d, h = (size / size.max()).tolist()
    asset = imported.read(path, (w, d, h), path.stem)
    loaded: Any = trimesh.load(path, force="mesh", process=False)
    corners = np.asarray(loaded.triangles, dtype=np.float64) @ imported.FROM_Y_UP.T
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    foot = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    return Thing(path.stem, asset.cloud, (corners - foot) * (np.array([w, d, h]) / (high - low)))


def measured(thing: Thing, texture: int, cells: int | None) -> Outcome:
    """A thing made into a mesh and compared."""
    scene = Scene(thing.cloud, Frame(metres_per_unit=1.0))
    clock, processor = time.perf_counter(), time.process_time()
    made = mesh(scene, thing.cloud.ids, texture=texture, watertight=True, cells=cells)
    seconds, cpu = time.perf_counter() - clock, time.process_time() - processor
    psnr, inside = likeness(thing.cloud, made)
    longest = float(np.ptp(made.vertices, axis=0).max())
    return Outcome(
        chamfer(made, thing.triangles), psnr, inside, seconds, cpu, len(made.faces), round(longest / made.cell),
        len(made.encode()),
    )  # fmt: skip


def chamfer(made: Mesh, triangles: F64) -> float:
    """Chamfer distance to true triangles `[T, 3, 3]`, percent of their longest side; see the notes of `run`."""
    side = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    ours = _sampled(made.vertices[made.faces])
    truth = _sampled(triangles)
    to_truth = cKDTree(truth).query(ours)[0].mean()
    to_ours = cKDTree(ours).query(truth[visible(truth, triangles)])[0].mean()
    return 50.0 * float(to_truth + to_ours) / side


def _sampled(triangles: F64) -> F64:
    """Points `[POINTS, 3]`, evenly on triangles."""
    rng = np.random.default_rng(SEED)
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    rows = rng.choice(len(area), POINTS, p=area / area.sum())
    u, v = np.sqrt(rng.random((POINTS, 1))), rng.random((POINTS, 1))
    return (1 - u) * a[rows] + u * (1 - v) * b[rows] + u * v * c[rows]


def visible(points: F64, triangles: F64) -> NDArray[np.bool_]:
    """`[M]`, which points on triangles some camera around them sees."""
    corners, faces = triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    radius = float(np.linalg.norm(high - low)) / 2
    seen = np.zeros(len(points), bool)
    for camera in sphere_cameras((low + high) / 2, radius, WITNESSES, 400):
        depth = draw(corners, faces, camera).depth
        pixels, far = camera.project(points)
        column, row = np.clip(pixels.astype(int), 0, 399).T
        seen |= far <= depth[row, column] + 0.004 * radius
    return seen


def likeness(cloud: GaussianCloud, made: Mesh) -> tuple[float, float]:
    """PSNR of pictures of a mesh to those of its Gaussians, dB: over whole pictures, and where either shows it."""
    low, high = made.vertices.min(axis=0), made.vertices.max(axis=0)
    wrong, inside, pixels, shown = 0.0, 0.0, 0, 0
    for camera in held_out((low + high) / 2, float(np.linalg.norm(high - low)) / 2):
        picture, cover = picture_of(made, camera)
        splats = render(cloud, camera)
        alpha = splats.alpha.numpy()
        either = (cover > 0.05) | (alpha > 0.05)
        for background in (0.0, 1.0):
            ours = picture + background * (1 - cover[..., None])
            theirs = splats.rgb.numpy() + background * (1 - alpha[..., None])
            error = ((ours - np.clip(theirs, 0, 1)) ** 2).mean(axis=2)
            wrong, inside = wrong + float(error.sum()), inside + float(error[either].sum())
            pixels, shown = pixels + error.size, shown + int(either.sum())
    return -10 * math.log10(max(wrong / pixels, 1e-10)), -10 * math.log10(max(inside / shown, 1e-10))


def held_out(center: F64, radius: float) -> list[Camera]:
    """Cameras on a wave around a thing that fills their pictures."""
    found = []
    for i in range(VIEWS):
        turn, rise = 2 * math.pi * (i + 0.37) / VIEWS, math.radians((25, -15, 50)[i % 3])
        way = np.array([math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise)])
        eye = center + 1.03 * radius / math.sin(math.radians(20)) * way
        found.append(Camera.look_at(eye, center, (0, 0, 1), SIZE, SIZE, 40.0, f"held out {i}"))
    return found


def picture_of(made: Mesh, camera: Camera) -> tuple[F64, F64]:
    """A mesh drawn over black: colours `[H, W, 3]` times its cover `[H, W]`, which is 0 to 1."""
    large = camera.resized(camera.width * FINE, camera.height * FINE)
    seen = draw(made.vertices, made.faces, large)
    rows, columns = np.nonzero(seen.face >= 0)
    corners, weights = made.faces[seen.face[rows, columns]], seen.weights[rows, columns]
    picture = np.zeros((large.height, large.width, 3))
    picture[rows, columns] = _colors(made, corners, weights)
    cells = camera.height, FINE, camera.width, FINE
    return picture.reshape(*cells, 3).mean(axis=(1, 3)), (seen.face >= 0).reshape(cells).mean(axis=(1, 3))


def _colors(made: Mesh, corners: NDArray[np.int64], weights: NDArray[np.float32]) -> F64:
    """Colours `[R, 3]` at barycentric weights `[R, 3]` of triangles."""
    if made.texture is None or made.uv is None:
        assert made.colors is not None
        return np.einsum("rk,rkc->rc", weights, made.colors[corners])
    side = len(made.texture)
    place = np.einsum("rk,rkc->rc", weights, made.uv[corners]) * side - 0.5
    low = np.clip(np.floor(place), 0, side - 2)
    (x, y), (u, v) = low.astype(int).T, np.clip(place - low, 0, 1).T[..., None]
    t = made.texture
    return (t[y, x] * (1 - u) + t[y, x + 1] * u) * (1 - v) + (t[y + 1, x] * (1 - u) + t[y + 1, x + 1] * u) * v


def _metrics(name: str, o: Outcome) -> list[Metric]:
    key = name.replace(" ", "_")
    return [
        Metric(f"{key}.chamfer", o.chamfer, "%", "lower", 0.05, CHAMFER_GOAL),
        Metric(f"{key}.psnr", o.psnr, "dB", "higher", 0.02, PSNR_GOAL),
        Metric(f"{key}.psnr_inside", o.inside, "dB", "higher", 0.02),
        Metric(f"{key}.seconds", o.seconds, "s", "lower", 1.0, SECONDS_GOAL),
        Metric(f"{key}.cpu", o.cpu, "s", "lower", 0.5),
        Metric(f"{key}.faces", o.faces, "count"),
        Metric(f"{key}.cells", o.cells, "count"),
        Metric(f"{key}.bytes", o.bytes, "bytes"),
    ]


def _summary(all_: list[Outcome]) -> list[Metric]:
    def over(of: Callable[[Outcome], float], pick: Callable[[list[float]], float]) -> float:
        return pick([of(o) for o in all_])

    return [
        Metric("all.chamfer_median", over(lambda o: o.chamfer, statistics.median), "%", "lower", 0.05, CHAMFER_GOAL),
        Metric("all.chamfer_worst", over(lambda o: o.chamfer, max), "%", "lower", 0.05, CHAMFER_GOAL),
        Metric("all.psnr_median", over(lambda o: o.psnr, statistics.median), "dB", "higher", 0.02, PSNR_GOAL),
        Metric("all.psnr_worst", over(lambda o: o.psnr, min), "dB", "higher", 0.02, PSNR_GOAL),
        Metric("all.psnr_inside_median", over(lambda o: o.inside, statistics.median), "dB", "higher", 0.02),
        Metric("all.seconds_worst", over(lambda o: o.seconds, max), "s", "lower", 1.0, SECONDS_GOAL),
        Metric("all.cpu_median", over(lambda o: o.cpu, statistics.median), "s", "lower", 0.5),
    ]


def _point(cells: int | None, outcomes: list[Outcome]) -> Point:
    """Mean time and accuracy on one grid."""
    near = statistics.mean(o.chamfer for o in outcomes) / 100
    setting = "by the Gaussians' size" if cells is None else f"{cells} cells"
    size = round(statistics.mean(o.bytes for o in outcomes))
    return Point("mesh", setting, statistics.mean(o.cpu for o in outcomes), -20 * math.log10(near), size, cells is None)
