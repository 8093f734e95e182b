"""The background of a scene: everything but its subject.

Floor, walls, ceiling and what belongs to no thing are always background. Which things are the subject depends on what
is known of the scene:

- Where most things have a sure name, as in rooms and in captures of one thing: every thing.
- Where they have not, and the photographs were taken from around something: the things that lie for the most part
  within half the distance of the cameras from the point they look at, so the plant on its table, and not the room.
- Else: the things that are in one piece with the heaviest one, or too heavy to be strays beside it.

Remains of the subject that belong to no thing go with it: Gaussians apart from every thing of the scene are of the
subject if they are nearer to it than to anything in the background.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...camera import Camera
from ...scene import Scene
from ...world.core import core_of, coverage, least_opacity
from ..field.group_index import GroupIndex
from ..field.language_field import Group
from .color.fallback import is_reliable
from .query import Query
from .selection import Selection, nothing
from .space import of_groups, tally
from .terms import candidate_of

F64 = NDArray[np.float64]
Bool = NDArray[np.bool_]

_NEAR = 0.5  # of the distance of the cameras: the largest distance of the subject from what they look at
_MOSTLY = 0.5  # share of a thing, by area, that lies so near
_SIDED = 0.9  # length of the mean direction of view from which the cameras look from one side only
_AHEAD = 0.8  # cosine between the direction of view and that to what is looked at, in the median
_BESIDE = 0.1  # of the extent of the cameras' places: a point that is as near to them is among them
_FEW = 4  # cameras that do not tell what they look at
_SPECKS = 0.005  # share of all opacity below which what is not of the subject is no background
_SAMPLE = 100_000  # solid Gaussians of the subject, and of the background, to which loose ones are compared


@dataclass(frozen=True, eq=False)
class Subject:
    """What a scene shows.

    Attributes:
        rows: `[N]` bool, its Gaussians; all others are background.
        groups: ids of its things.
        told: how it was found, for the receipt.
        sure: whether nobody need be asked.
    """

    rows: Bool
    groups: tuple[int, ...]
    told: str
    sure: bool = True


def subject_of(scene: Scene) -> Subject | None:
    """The subject of an embedded scene; None if it shows no thing."""
    field = scene.language
    assert field is not None
    things = [g for g in field.groups if g.level == "object" and g.parent < 0 and g.count]
    weight = coverage(scene.cloud.scales, scene.cloud.opacities).astype(np.float64)
    sure, told = True, "every thing is the subject"
    within = np.ones(len(weight), dtype=bool)
    focus = looked_at(scene.cameras)
    if not is_reliable(field):
        sure = focus is None or not focus.one_sided
        told = "the subject is what is in one piece with the heaviest thing"
        if focus is not None:
            points = scene.cloud.means.to(torch.float64).cpu().numpy()
            within = np.linalg.norm(points - focus.point, axis=1) <= _NEAR * focus.away
            things = _mostly_within(scene, things, weight, within)
            told = "the subject is what the photographs were taken around"
            if focus.one_sided:
                told = "the photographs were taken from one side, which does not tell the subject from what is near it"
    if not things:
        return None
    rows = of_groups(scene, (g.id for g in things))
    if is_reliable(field):
        return Subject(rows, tuple(g.id for g in things), told)
    chosen = torch.from_numpy(np.flatnonzero(rows)).to(scene.cloud.device)
    rows[chosen.cpu().numpy()[~core_of(scene.cloud, chosen).belongs]] = False
    if focus is None:
        held = np.bincount(scene.cloud.group.cpu().numpy() + 1, weights=weight, minlength=len(field.groups) + 1)[1:]
        heaviest = max(float(held[list(field.leaves(g.id))].sum()) for g in things)
        sure = heaviest >= _MOSTLY * float(weight[rows].sum())
    kept = tuple(g.id for g in _mostly_within(scene, things, weight, rows))
    return Subject(_with_remains(scene, rows, within), kept, told, sure)


def background(scene: Scene, members: GroupIndex, query: Query) -> Selection:
    """The selection of everything but the subject; absent where the scene shows nothing else, unconfirmed where the
    subject is not sure."""
    subject = subject_of(scene)
    if subject is None:
        return nothing(query, "no thing is known here that could be the subject: say what to keep, or 'everything'")
    cloud, field = scene.cloud, scene.language
    assert field is not None
    ids = members.ids_at(np.flatnonzero(~subject.rows))
    behind = torch.from_numpy(~subject.rows).to(cloud.device)
    if float(cloud.opacities[behind].sum()) < _SPECKS * float(cloud.opacities.sum()):
        return nothing(query, f"this scene has no background: only {len(ids):,} Gaussians are not of what it shows")
    others = [g for g in field.groups if g.level == "object" and g.parent < 0 and g.count]
    whole = tuple(g for g in others if g.id not in subject.groups)
    told = f"{len(ids):,} Gaussians, all but {int(subject.rows.sum()):,} of the subject: {subject.told}"
    made = Selection(query, "found", ids, tuple(g.id for g in whole), tuple(map(candidate_of, whole)), told)
    if subject.sure:
        return made
    return replace(made, verdict="unconfirmed").noting("to be sure, say 'everything but' and what to keep")


@dataclass(frozen=True, eq=False)
class Focus:
    """What cameras look at: the nearest point to their axes `[3]`, their median distance from it, and whether all look
    in nearly the same direction."""

    point: F64
    away: float
    one_sided: bool


def looked_at(cameras: Iterable[Camera]) -> Focus | None:
    """What cameras look at; None if they are few, or look outwards, as from the middle of a room."""
    cameras = tuple(cameras)
    if len(cameras) < _FEW:
        return None
    eyes, ways = np.array([c.position for c in cameras]), np.array([c.forward for c in cameras])
    across = np.eye(3) - ways[:, :, None] * ways[:, None, :]  # projections onto the planes that the axes stand on
    # Parallel axes meet nowhere: of all points that are as near to them the one nearest to the cameras is taken.
    total, wanted = across.sum(axis=0), (across @ eyes[:, :, None]).sum(axis=0)[:, 0]
    middle = eyes.mean(axis=0)
    point = middle + np.linalg.pinv(total, rcond=1e-6) @ (wanted - total @ middle)
    apart = np.linalg.norm(point - eyes, axis=1)
    away, spread = float(np.median(apart)), float(np.ptp(eyes, axis=0).max())
    ahead = ((point - eyes) * ways).sum(axis=1) / np.maximum(apart, 1e-12)
    if away <= _BESIDE * spread or np.median(ahead) < _AHEAD:
        return None
    return Focus(point, away, bool(np.linalg.norm(ways.mean(axis=0)) > _SIDED))


def _mostly_within(scene: Scene, things: list[Group], weight: F64, rows: Bool) -> list[Group]:
    """The things of which most, by area (`weight` `[N]`), is in `rows` `[N]`."""
    field = scene.language
    assert field is not None
    column, size = scene.cloud.group.cpu().numpy() + 1, len(field.groups) + 1
    total = np.bincount(column, weights=weight, minlength=size)[1:]
    held = np.bincount(column, weights=weight * rows, minlength=size)[1:]
    found = []
    for thing in things:
        leaves = list(field.leaves(thing.id))
        if held[leaves].sum() > _MOSTLY * total[leaves].sum():
            found.append(thing)
    return found


def _with_remains(scene: Scene, subject: Bool, within: Bool) -> Bool:
    """The subject `[N]` with the Gaussians around it (`within` `[N]`) that are nearer to it than to the background and
    that belong to no thing, or to a thing from which it was found apart."""
    from scipy.spatial import cKDTree

    cloud = scene.cloud
    field = scene.language
    assert field is not None
    structure = of_groups(scene, (g.id for g in field.groups if g.level == "structure"))
    points = cloud.means.to(torch.float64).cpu().numpy()
    solid: Bool = (cloud.opacities >= least_opacity(cloud.opacities)).cpu().numpy()
    loose = within & ~subject & ~structure & (_ungrouped(scene) | _nearby_pieces(scene, within, subject, structure))
    open_ = np.flatnonzero(loose)
    behind = np.flatnonzero(solid & ~subject & ~loose)
    front = np.flatnonzero(solid & subject)
    if not len(open_) or not len(front) or not len(behind):
        return subject
    gaps = [
        cKDTree(points[some[:: max(1, len(some) // _SAMPLE)]], balanced_tree=False).query(points[open_])[0]
        for some in (front, behind)
    ]
    found = subject.copy()
    found[open_[gaps[0] < gaps[1]]] = True
    return found


def _ungrouped(scene: Scene) -> Bool:
    found: Bool = scene.cloud.group.cpu().numpy() < 0
    return found


def _nearby_pieces(scene: Scene, within: Bool, subject: Bool, structure: Bool) -> Bool:
    """`[N]` bool: Gaussians of things that lie for the most part around the subject and were left out as strays."""
    field = scene.language
    assert field is not None
    total, held = tally(scene, within)
    inside = np.append(held > _MOSTLY * np.maximum(total, 1), False)
    found: Bool = inside[scene.cloud.group.cpu().numpy()] & ~subject & ~structure
    return found
