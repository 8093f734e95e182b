"""From a cloud to a language field, in a straight line:

up and floor -> skin -> superpoints -> floor and walls -> merge tree -> portraits of its nodes -> the best cut
into objects -> parts by colour -> every Gaussian's group -> the table.

Knows all of this room's pieces. Refuses to know queries.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..cloud import NO_GROUP, GaussianCloud
from ..errors import UserError
from ..scene import Frame, Scene
from . import grouping, structure
from .calibration import labels as name_things
from .calibration import wholeness
from .encoders import Encoder
from .field import Group, LanguageField, Level
from .measure import box_of, lab_of_cloud
from .orient import estimate_frame
from .portraits import mean_vectors, one_thread
from .regions import Graph, Node, build_graph, merge_tree
from .superpoints import Links, links_of, superpoints, touching
from .surface import Surface, surface_of
from .views import Views, choose_views

Progress = Callable[[str, float], None]
F64 = NDArray[np.float64]

MIN_OBJECT = 40  # surface points; smaller things are not asked about and not offered
MOST_ASKED = 700  # nodes whose portraits are taken: bounds the time of a messy scene
ASK_VIEWS = 3
MOST_OF_IT = 0.75  # of the surface: a connected body this large, with nothing around it, is likely one scanned thing
ALONE = 4.0  # nats by which it is
REACH = 6.0  # spacings within which an unassigned Gaussian joins the surface point it is nearest to


@dataclass(frozen=True)
class Thing:
    """One group before it becomes a row: which superpoints, under which name, in which object."""

    members: tuple[int, ...]
    level: Level
    parent: int = -1
    label: str = ""


def embed(
    scene: Scene, encoder: Encoder, progress: Progress = lambda stage, share: None, portraits: int = ASK_VIEWS
) -> Scene:
    """The scene with `cloud.group` filled and a language field over it; nothing else of the cloud changes.

    Args:
        scene: any cloud; `frame.up` is estimated if its source is "unknown", the floor if it is None.
        encoder: makes the vectors that names are compared with.
        progress: called with a stage's name and the share of it that is done.
        portraits: pictures the encoder is shown of each candidate thing, 1 to 4; see `scenewright bench select`.

    Raises:
        UserError: the scene has no Gaussians.
    """
    if not len(scene.cloud):
        raise UserError("the scene has no Gaussians, so there is nothing to embed")
    progress("surface", 0.0)
    surface = surface_of(scene.cloud)
    frame = estimate_frame(surface, scene.cameras, scene.frame)
    scene = scene.replace(frame=frame)
    progress("views", 0.0)
    seen = choose_views(scene)
    progress("segments", 0.0)
    with one_thread():
        labels, things = segment(scene, surface, encoder, progress, portraits)
        column = _assign(scene.cloud, surface, _thing_of_superpoint(things, int(labels.max(initial=-1)) + 1)[labels])
        progress("table", 0.0)
        on_skin = np.zeros(len(scene.cloud), bool)
        on_skin[surface.rows] = True
        return _with_table(scene, things, column, on_skin, seen, encoder)


def segment(
    scene: Scene,
    surface: Surface,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    portraits: int = ASK_VIEWS,
) -> tuple[NDArray[np.int32], list[Thing]]:
    """Superpoint of each surface point, and what they make up: structure first, then objects, then their parts."""
    links = links_of(surface)
    labels, kind_of = superpoints_and_structure(surface, links, scene.frame)
    count = len(kind_of)
    nodes = merge_tree(graph_of(surface, links, labels, kind_of, scene.frame))
    size = np.bincount(labels, minlength=count)
    points = np.array([sum(int(size[s]) for s in n.members) for n in nodes], dtype=np.int64)
    evidence = _evidence(scene, surface, labels, nodes, points, encoder, portraits, progress)
    if nodes and not kind_of.any() and points.max() >= MOST_OF_IT * len(surface):
        alone = int(np.flatnonzero(points == points.max())[-1])  # the root: no node above it holds more
        evidence[alone] = evidence.get(alone, 0.0) + ALONE
    objects = [nodes[i].members for i in grouping.best_cut(nodes, points, evidence)]
    total = np.stack([np.bincount(labels, weights=surface.lab[:, c], minlength=count) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    return labels, _things(objects, kind_of, lab, size, touching(labels, links))


def superpoints_and_structure(
    surface: Surface, links: Links, frame: Frame
) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    """Superpoint of each surface point `[M]`, and what structure each superpoint is `[S]`.

    Superpoints that straddle structure and object become two.
    """
    labels = superpoints(surface, links)
    kinds = structure.structures(surface, labels, frame)
    labels = np.unique(labels.astype(np.int64) * 8 + kinds, return_inverse=True)[1].astype(np.int32)
    kind_of = np.zeros(int(labels.max(initial=-1)) + 1, np.int8)
    kind_of[labels] = kinds
    return labels, kind_of


def graph_of(
    surface: Surface, links: Links, labels: NDArray[np.int32], kind_of: NDArray[np.int8], frame: Frame
) -> Graph:
    """The graph of the superpoints that are no structure, in the level frame."""
    flat = structure.level(surface, frame)
    free = kind_of == structure.NONE
    return build_graph(labels, flat.points, surface.lab.astype(np.float64), flat.normals, links, free)


def _evidence(
    scene: Scene, surface: Surface, labels: NDArray[np.int32], nodes: list[Node], points: NDArray[np.int64],
    encoder: Encoder, portraits: int, progress: Progress,
) -> dict[int, float]:  # fmt: skip
    """Log-odds that a node is one whole thing, by its portraits, for the larger nodes."""
    wanted = [i for i in range(len(nodes)) if points[i] >= MIN_OBJECT]
    same = grouping.alike(nodes, points)
    asked = sorted({int(same[i]) for i in wanted}, key=lambda i: (-points[i], i))[:MOST_ASKED]
    if not asked:
        return {}
    rows = _rows_by_superpoint(surface, labels, int(labels.max(initial=-1)) + 1)
    owned = [np.sort(np.concatenate([rows[s] for s in nodes[i].members])) for i in asked]
    clouds = [scene.cloud[torch.from_numpy(own)] for own in owned]
    middle = np.median(surface.points, axis=0).astype(np.float64)
    vectors = mean_vectors(encoder, clouds, scene.frame, middle, portraits, lambda share: progress("portraits", share))
    whole = np.clip(wholeness(encoder, vectors), 0.001, 0.999)
    odds = {i: float(np.log(w / (1 - w))) for i, w in zip(asked, whole, strict=True)}
    return {i: odds[int(same[i])] for i in wanted if int(same[i]) in odds}


def _rows_by_superpoint(surface: Surface, labels: NDArray[np.int32], count: int) -> list[NDArray[np.int64]]:
    order = np.argsort(labels, kind="stable")
    return np.split(surface.rows[order], np.cumsum(np.bincount(labels, minlength=count))[:-1])


def _things(
    objects: list[tuple[int, ...]], kind_of: NDArray[np.int8], lab: F64, size: NDArray[np.int64],
    near: dict[int, set[int]],
) -> list[Thing]:  # fmt: skip
    things = [
        Thing(tuple(np.flatnonzero(kind_of == kind).tolist()), "structure", label=name)
        for kind, name in structure.NAMES.items()
        if (kind_of == kind).any()
    ]
    large = [m for m in objects if sum(int(size[s]) for s in m) >= MIN_OBJECT]
    for members in sorted(large, key=lambda m: (-sum(int(size[s]) for s in m), m)):
        clusters = grouping.parts_of(members, near, lab, size)
        own = len(things)
        things.append(Thing(members if len(clusters) == 1 else (), "object"))
        if len(clusters) > 1:
            things.extend(Thing(tuple(c), "part", parent=own) for c in clusters)
    return things


def _thing_of_superpoint(things: list[Thing], count: int) -> NDArray[np.int32]:
    owner = np.full(count, NO_GROUP, np.int32)
    for i, thing in enumerate(things):
        owner[list(thing.members)] = i
    return owner


def _assign(cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32]) -> NDArray[np.int32]:
    """Group of every Gaussian `[N]`: its own, or for those off the skin the nearest surface point's within reach."""
    column = np.full(len(cloud), NO_GROUP, np.int32)
    column[surface.rows] = group
    rest = np.ones(len(cloud), bool)
    rest[surface.rows] = False
    rows = np.flatnonzero(rest)
    if len(rows) and len(surface):
        distance, nearest = cKDTree(surface.points).query(cloud.means[rows].numpy(), workers=-1)
        spread = cloud.scales[rows].amax(dim=1).numpy()
        local = surface.gaps.mean(axis=1)[nearest]
        near = distance < REACH * np.maximum(local, surface.spacing) + 0.5 * np.minimum(spread, 4 * surface.spacing)
        column[rows[near]] = group[nearest[near]]
    return column


def _with_table(
    scene: Scene,
    things: list[Thing],
    column: NDArray[np.int32],
    on_skin: NDArray[np.bool_],
    seen: Views,
    encoder: Encoder,
) -> Scene:
    """Measure every group and take the portraits that names are compared with."""
    cloud = scene.cloud.replace(group=torch.from_numpy(column))
    whole = [np.flatnonzero(np.isin(column, _leaves(things, i))) for i in range(len(things))]
    clouds = [cloud[torch.from_numpy(rows)] for rows in whole]
    boxes = [box_of(c, scene.frame) for c in clouds]
    middle = cloud.means[:: max(1, len(cloud) // 50_000)].median(dim=0).values.double().numpy()
    pictured = [c if t.level == "object" else c[:0] for c, t in zip(clouds, things, strict=True)]
    vectors = mean_vectors(encoder, pictured, scene.frame, middle)
    metres = scene.frame.metres_per_unit
    sizes = np.array([b.size for b in boxes]).reshape(-1, 3) * (metres if metres is not None else np.nan)
    named = name_things(encoder, vectors, sizes) if things else []
    rows = tuple(
        Group(
            id=i, level=t.level, parent=t.parent, label=t.label or name, label_score=1.0 if t.label else float(sure),
            box=box, lab=lab_of_cloud(c), count=len(c), views=seen.count_of(np.isin(column, _leaves(things, i))),
            confidence=float(on_skin[own].mean()) if len(own) else 0.0,
        )
        for i, (t, c, box, own, (name, sure)) in enumerate(zip(things, clouds, boxes, whole, named, strict=True))
    )  # fmt: skip
    field = LanguageField(rows, vectors, encoder.fingerprint, _notes(scene, column, seen))
    return replace(scene, cloud=cloud, language=field)


def _leaves(things: list[Thing], i: int) -> list[int]:
    return [i, *(j for j, t in enumerate(things) if t.parent == i)]


def _notes(scene: Scene, column: NDArray[np.int32], seen: Views) -> tuple[str, ...]:
    notes = []
    if scene.frame.up_source == "estimated":
        notes.append("up was estimated from the scene; say --up if it is wrong")
    if seen.unseen > 0.01:
        notes.append(f"{seen.unseen:.0%} of the Gaussians are seen from no view")
    loose = float((column == NO_GROUP).mean())
    if loose > 0.01:
        notes.append(f"{loose:.0%} of the Gaussians belong to no group (floaters and residue)")
    return tuple(notes)
