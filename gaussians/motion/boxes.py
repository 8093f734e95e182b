"""Boxes of groups over time, without measuring them again: the poses move what a group's outline is made of.

A group's outline is some points of its Gaussians that lie farthest out in many directions. Its upright box at a time
goes around the moved points; what the stored box has more (the extent of single Gaussians) or less (strays that it
leaves out) than the points at the start is kept on each side. A box at the start is therefore the stored one exactly,
and so is its size while the group turns about the vertical.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from ..kept import Kept
from ..language.field.language_field import LanguageField
from ..rows import rows_where
from ..scene import Scene
from ..world.box import Box
from . import keys
from .motion import Motion, chained, combinations
from .runs import held_by

F64 = NDArray[np.float64]
_DIRECTIONS = 96  # of an outline; a ball's radius is then found to 2 %
_SAMPLE = 20_000  # rows of a group that an outline is made of
_VISIBLE = 0.05  # opacity from which a Gaussian counts, as for the boxes that embedding measures


@dataclass(frozen=True, eq=False)
class _Outline:
    """What is needed of a group that moves, or a part of which does.

    Attributes:
        parts: for each set of tracks that moves a part of it (the empty set for what stays): the numbers of the tracks,
            and the outermost points `[P, 3]` of that part.
        leader: number of the largest part, with which the axes of the box turn.
    """

    parts: tuple[tuple[tuple[int, ...], F64], ...]
    leader: int


_outlines: Kept[dict[int, _Outline]] = Kept(4)


def boxes_over(scene: Scene, times: ArrayLike) -> dict[int, list[Box]]:
    """For each group of the scene of which something moves, by id: its box at each of some times, seconds.

    Groups that are not in it keep their box. Looks and residuals change no box.
    """
    motion, field = scene.motion, scene.language
    if motion is None or field is None or not motion.tracks:
        return {}
    now = np.asarray(times, dtype=np.float64).reshape(-1)
    cloud = scene.cloud
    made_of = (cloud.means, cloud.group, cloud.ids, motion, field)
    outlines = _outlines.get(made_of, lambda: _outlines_of(scene, motion))
    chains = {chain for outline in outlines.values() for chain, _ in outline.parts}
    maps = {chain: chained([motion.tracks[i] for i in chain], now) for chain in chains}
    up = scene.frame.up_vector
    return {
        group: _boxes_of(field.groups[group].box, outline, maps, up, len(now)) for group, outline in outlines.items()
    }


def _outlines_of(scene: Scene, motion: Motion) -> dict[int, _Outline]:
    field, cloud = scene.language, scene.cloud
    assert field is not None
    ids, column = cloud.ids.cpu().numpy(), cloud.group.cpu().numpy()
    together = combinations(motion)
    part = np.full(len(ids), -1)  # which set of tracks moves each row
    for number, (runs, _) in enumerate(together):
        part[held_by(runs, ids)] = number
    visible = (cloud.opacities > _VISIBLE).cpu().numpy()
    found = {}
    for group in sorted(groups_of(field, column[part >= 0])):
        leaves = torch.tensor(field.leaves(group), dtype=cloud.group.dtype, device=cloud.device)
        rows = rows_where(torch.isin(cloud.group, leaves)).cpu().numpy()
        rows = rows[visible[rows]] if visible[rows].any() else rows
        parts, sizes = [], []
        for number in np.unique(part[rows]).tolist():
            own = rows[part[rows] == number]
            points = cloud.means[torch.from_numpy(own[:: -(-len(own) // _SAMPLE)]).to(cloud.device)].double().cpu()
            parts.append((() if number < 0 else together[number][1], _outermost(points.numpy())))
            sizes.append(len(own))
        found[group] = _Outline(tuple(parts), int(np.argmax(sizes)))
    return found


def groups_of(field: LanguageField, numbers: NDArray[np.integer]) -> set[int]:
    """The groups that some Gaussians are of, by the numbers that these have, and what such groups are parts of."""
    own = {int(g) for g in np.unique(numbers) if 0 <= g < len(field.groups)}
    return own | ({field.groups[g].parent for g in own} - {-1})


def _outermost(points: F64) -> F64:
    """The points `[P, 3]` of a set `[M, 3]` that lie farthest out in evenly spread directions and along the axes."""
    index = np.arange(_DIRECTIONS)
    z = 1 - (2 * index + 1) / _DIRECTIONS
    turn = index * (math.pi * (3 - math.sqrt(5)))
    ring = np.sqrt(1 - z * z)
    ways = np.concatenate([np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1), np.eye(3), -np.eye(3)])
    return np.asarray(points[np.unique(np.argmax(points @ ways.T, axis=0))])


def _boxes_of(
    box: Box, outline: _Outline, maps: dict[tuple[int, ...], tuple[F64, F64]], up: F64, count: int
) -> list[Box]:
    turns = maps[outline.parts[outline.leader][0]][0]  # [T, 3, 3] of the part that its axes follow
    stored, middle = np.array(box.axes), np.array(box.center)
    axes = stored @ _about_up(turns, up).transpose(0, 2, 1)  # [T, 3, 3] rows
    low = np.full((count, 3), np.inf)
    high = np.full((count, 3), -np.inf)
    for chain, points in outline.parts:
        turn, shift = maps[chain]
        world = points @ turn.transpose(0, 2, 1) + shift[:, None]  # [T, P, 3]
        along = world @ axes.transpose(0, 2, 1)
        low, high = np.minimum(low, along.min(axis=1)), np.maximum(high, along.max(axis=1))
    # What the stored box has beyond the points, on each side of its axes at the start.
    at_start = np.concatenate([points for _, points in outline.parts]) @ stored.T
    half = np.array(box.size) / 2
    above = middle @ stored.T + half - at_start.max(axis=0)
    below = at_start.min(axis=0) - (middle @ stored.T - half)
    body = axes @ turns  # [T, 3, 3]: each axis in the frame of the body at the start
    share = (body @ stored.T) ** 2  # of each stored axis in each axis now; rows sum to one
    facing = body @ stored.T >= 0
    high += (share * np.where(facing, above, below)).sum(axis=2)
    low -= (share * np.where(facing, below, above)).sum(axis=2)
    size = np.maximum(high - low, 0.0)
    center = ((low + high) / 2)[:, None] @ axes  # [T, 1, 3]
    return [
        Box(
            (float(c[0]), float(c[1]), float(c[2])),
            tuple((float(a[0]), float(a[1]), float(a[2])) for a in frame),  # type: ignore[arg-type]
            (float(s[0]), float(s[1]), float(s[2])),
        )
        for c, frame, s in zip(center[:, 0], axes, size, strict=True)
    ]


def _about_up(turns: F64, up: F64) -> F64:
    """The part of rotations `[T, 3, 3]` that turns about `up` `[3]` (the twist of a swing and a twist)."""
    quats = keys.quaternions(turns)
    along = quats[:, 1:] @ up
    return keys.matrices(keys.about(up, 2 * np.arctan2(along, quats[:, 0])))
