"""Which Gaussians lie in a `Region`: beyond a plane, near things, or among the things that a crop keeps.

With a distance the border is exact: a Gaussian is in by its centre, and things on the border are cut. Without one a
thing is in with all its Gaussians or not at all, by where most of them lie; floor, walls and what belongs to no thing
are cut.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...scene import Scene
from ...world.box import Box
from ...world.core import core_of, least_opacity
from ...world.lengths import in_metres
from ...world.relation_geometry import Stand
from ..field.measure import box_of
from .query import Region
from .selection import Selection, mask_of

F64 = NDArray[np.float64]
Bool = NDArray[np.bool_]

_SIDES = {"left_of": (-1.0, 0.0), "right_of": (1.0, 0.0), "in_front_of": (0.0, -1.0), "behind": (0.0, 1.0)}
_MOSTLY = 0.5  # share of a thing's Gaussians from which it lies in a region
_EDGE = 0.02  # of the size of what a crop keeps: how far beyond its box loose Gaussians still belong to it
_NAMED = 4  # things named in a note


@dataclass(frozen=True, eq=False)
class Inside:
    """The Gaussians in a region.

    Attributes:
        rows: `[N]` bool.
        told: where its border is, for the receipt.
    """

    rows: Bool
    told: str


def inside(scene: Scene, region: Region, things: Sequence[Selection], stand: Stand | None) -> Inside:
    """The Gaussians of a scene in a region.

    Args:
        things: what `region.of` means; for "around" without a distance also what stands on it.
        stand: the viewer's frame; only sides need it.
    """
    if region.name == "around" and region.distance is None:
        rows, told = _cropped(scene, things)
    else:
        boxes = [_box(scene, found) for found in things]
        rows, told = _measured(scene, region, boxes, stand)
        if region.distance is None:
            rows = _whole(scene, rows, things)
    if region.outside:
        rows = ~rows
    if region.distance is not None:
        told += _cut(scene, rows)
    return Inside(rows, told)


def _measured(scene: Scene, region: Region, boxes: Sequence[Box], stand: Stand | None) -> tuple[Bool, str]:
    """Which Gaussians `[N]` are in a region with exact borders, and where the border is."""
    points = _points(scene)
    far = _units(scene, region)
    scale = f"; {_assumed(region)}" if _is_assumed(scene, region) else ""
    if region.name in ("above", "below"):
        sign = 1.0 if region.name == "above" else -1.0
        heights, up = points @ scene.frame.up_vector, scene.frame.up_vector
        if boxes:
            level = max(b.top(up) for b in boxes) if sign > 0 else min(b.bottom(up) for b in boxes)
            level += sign * far
        else:
            level = _floor(scene, heights) + far
        over = f"{far:.3g} units over the floor" if not boxes else f"at the height {level:.3g} along up"
        return sign * (heights - level) > 0, f"the plane is {over}{scale}"
    if region.name in _SIDES:
        assert stand is not None
        way = stand.side(_SIDES[region.name])
        ends = [float(np.array(b.center) @ way) + b.extent(way) / 2 for b in boxes]
        level = (max(ends) if ends else float(_middle(scene, points) @ way)) + far
        told = ", ".join(f"{c:.2f}" for c in way)
        return (
            points @ way > level,
            f"the plane faces ({told}) as you see the scene, at {level:.3g} units along it{scale}",
        )
    if not boxes:
        near = np.linalg.norm(points - _middle(scene, points), axis=1) <= far
        return near, f"measured from the middle of the scene, {far:.3g} units{scale}"
    near = np.zeros(len(points), dtype=bool)
    for box in boxes:
        beyond = np.maximum(np.abs(box.local(points)) - np.array(box.size) / 2, 0.0)
        near |= (np.linalg.norm(beyond, axis=1) if region.name == "within" else beyond.max(axis=1)) <= far
    return near, f"measured from its box, {far:.3g} units{scale}"


def _cropped(scene: Scene, things: Sequence[Selection]) -> tuple[Bool, str]:
    """The Gaussians `[N]` of things, and those within their boxes that belong to no thing or to fragments in there."""
    points, field = _points(scene), scene.language
    kept = np.zeros(len(points), dtype=bool)
    space = np.zeros(len(points), dtype=bool)
    for found in things:
        own = mask_of(scene.cloud, found.ids).nonzero().squeeze(1)
        kept[own[torch.from_numpy(core_of(scene.cloud, own).belongs).to(own.device)].cpu().numpy()] = True
        box = _box(scene, found)
        edge = _EDGE * max(box.size)
        space |= (np.abs(box.local(points)) <= np.array(box.size) / 2 + edge).all(axis=1)
    strays = np.zeros(len(points), dtype=bool)
    for found in things:
        strays |= mask_of(scene.cloud, found.ids).cpu().numpy() & ~kept
    loose = _whole(scene, space, things) & space & ~strays
    if field is not None:
        shell = of_groups(scene, [g.id for g in field.groups if g.level == "structure"])
        loose &= ~shell
    return kept | loose, "floor, walls and what lies mostly beyond it are left out"


def _whole(scene: Scene, rows: Bool, things: Sequence[Selection]) -> Bool:
    """`rows` `[N]` with things in or out as a whole, by where most of their Gaussians lie; `things` are out."""
    field = scene.language
    if field is None:
        return rows
    counts, held = tally(scene, rows)
    made = rows.copy()
    column = scene.cloud.group.cpu().numpy()
    verdict = np.full(len(counts), -1, dtype=np.int8)
    for group in field.groups:
        if group.level != "object" or group.parent >= 0 or not group.count:
            continue
        leaves = [leaf for leaf in field.leaves(group.id) if leaf < len(counts)]
        share = sum(int(held[i]) for i in leaves) / max(sum(int(counts[i]) for i in leaves), 1)
        verdict[leaves] = int(share >= _MOSTLY)
    known = np.flatnonzero(column >= 0)
    told = verdict[column[known]]
    made[known[told >= 0]] = told[told >= 0] == 1
    for found in things:
        made[mask_of(scene.cloud, found.ids).cpu().numpy()] = False
    return made


def mostly_in(scene: Scene, rows: Bool) -> frozenset[int]:
    """Ids of the groups of which at least half lies in the rows `[N]`."""
    field = scene.language
    assert field is not None
    counts, held = tally(scene, rows)
    found = set()
    for group in field.groups:
        leaves = [leaf for leaf in field.leaves(group.id) if leaf < len(counts)]
        total = sum(int(counts[i]) for i in leaves)
        if total and sum(int(held[i]) for i in leaves) >= _MOSTLY * total:
            found.add(group.id)
    return frozenset(found)


def _cut(scene: Scene, rows: Bool) -> str:
    """Names of things that the border cuts, "" if there are none."""
    field = scene.language
    if field is None:
        return ""
    counts, held = tally(scene, rows)
    cut = []
    for group in field.groups:
        if group.level != "object" or group.parent >= 0 or not group.count:
            continue
        leaves = [leaf for leaf in field.leaves(group.id) if leaf < len(counts)]
        total = sum(int(counts[i]) for i in leaves)
        if 0.1 * total < sum(int(held[i]) for i in leaves) < 0.9 * total:
            cut.append((total, group.label or "something"))
    if not cut:
        return ""
    names = list(dict.fromkeys(label for _, label in sorted(cut, reverse=True)))
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"; it cuts through {', '.join(names[:_NAMED])}{more}"


def tally(scene: Scene, rows: Bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Gaussians of each group of the table, in all and in the rows `[N]`."""
    assert scene.language is not None
    column, size = scene.cloud.group.cpu().numpy() + 1, len(scene.language.groups) + 1
    counts = np.bincount(column, minlength=size)[1:]
    return counts, np.bincount(column[rows], minlength=size)[1:]


def of_groups(scene: Scene, groups: Iterable[int]) -> Bool:
    """The Gaussians `[N]` of some groups and their parts."""
    assert scene.language is not None
    table = np.zeros(len(scene.language.groups) + 1, dtype=bool)
    table[[leaf for group in groups for leaf in scene.language.leaves(group)]] = True
    found: Bool = table[scene.cloud.group.cpu().numpy()]
    return found


def _box(scene: Scene, found: Selection) -> Box:
    """The box of the core of a selection."""
    rows = mask_of(scene.cloud, found.ids).nonzero().squeeze(1)
    solid = torch.from_numpy(core_of(scene.cloud, rows).solid).to(rows.device)
    return box_of(scene.cloud, scene.frame, rows[solid])


def _points(scene: Scene) -> F64:
    points: F64 = scene.cloud.means.to(torch.float64).cpu().numpy()
    return points


def _middle(scene: Scene, points: F64) -> F64:
    """`[3]` the median of the solid Gaussians."""
    solid = (scene.cloud.opacities >= least_opacity(scene.cloud.opacities)).cpu().numpy()
    return np.asarray(np.median(points[solid], axis=0))


def _floor(scene: Scene, heights: F64) -> float:
    """Height of the floor along up, or of the lowest solid Gaussians but the outermost 1 %."""
    if scene.frame.floor is not None:
        return scene.frame.floor
    solid = (scene.cloud.opacities >= least_opacity(scene.cloud.opacities)).cpu().numpy()
    return float(np.quantile(heights[solid], 0.01))


def _units(scene: Scene, region: Region) -> float:
    """The distance in scene units; one unit counts as one metre where the scale is unknown."""
    if region.distance is None:
        return 0.0
    if region.unit == "units":
        return region.distance
    return in_metres(region.distance, region.unit) / (scene.frame.metres_per_unit or 1.0)


def _is_assumed(scene: Scene, region: Region) -> bool:
    known = scene.frame.metres_per_unit is not None or region.unit == "units"
    return region.distance is not None and not known


def _assumed(region: Region) -> str:
    return f"the scene's scale is unknown: {region.distance:g} {region.unit} was read with one scene unit as one metre"
