"""The scene at a time, as a static value (`at`): rows that move are moved, what does not move is shared.

What rows each track holds is found once for a cloud and a motion; a frame then touches moving rows only.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..cloud import GaussianCloud
from ..errors import UserError
from ..kept import Kept
from ..language.field.language_field import Group, LanguageField
from ..language.field.measure import lab_of_cloud
from ..rows import rows_of_ids, rows_where
from ..scene import Scene
from .boxes import boxes_over
from .carrying import carry, shift_means
from .motion import Look, Motion, chained, combinations
from .runs import ids_of
from .spare import Rows, like

F64 = NDArray[np.float64]
_BLOCK = 1 << 13  # rows changed at a time: intermediates stay in a core's cache
_TURN = 1e-12  # a rotation this near to the identity turns nothing


@dataclass(frozen=True, eq=False)
class _Body:
    """Rows of a cloud that the same tracks move.

    Attributes:
        rows: `[M]` int64, ascending.
        tracks: numbers of the tracks, in their order.
    """

    rows: Tensor
    tracks: tuple[int, ...]


_bodies: Kept[tuple[_Body, ...]] = Kept(4)
_looks: Kept[tuple[tuple[Tensor, Tensor], ...]] = Kept(4)
_residuals: Kept[tuple[tuple[Tensor, Tensor], ...]] = Kept(4)


def at(scene: Scene, time: float) -> Scene:
    """The scene at a time (seconds) as a static scene: `motion` is None, ids and groups stay.

    Moved are means, rotations, harmonics, and the boxes of the groups; looks are applied and their groups' colours
    measured; Gaussians of opacity 0 are left out. Columns in which nothing changes are shared. A scene without motion
    is returned itself.

    Raises:
        UserError: the time is no finite number.
    """
    time = _finite(time)
    motion = scene.motion
    if motion is None:
        return scene
    cloud, seen = _moved(scene.cloud, motion, time)
    moved = replace(scene, cloud=cloud, motion=None)
    return replace(moved, language=_language_at(scene, moved, seen, time))


def cloud_at(scene: Scene, time: float) -> GaussianCloud:
    """The cloud of `at` alone, as a picture needs it.

    Raises:
        UserError: the time is no finite number.
    """
    time = _finite(time)
    return scene.cloud if scene.motion is None else _moved(scene.cloud, scene.motion, time)[0]


def _moved(cloud: GaussianCloud, motion: Motion, time: float) -> tuple[GaussianCloud, tuple[Look, ...]]:
    """The cloud at a time, and the looks that hold then. Raises UserError if the time is not finite."""
    whole, gone = rows_at(cloud, motion, time)
    seen = tuple(look for look in motion.looks if look.lasts_at(time))
    if gone is None:
        return whole, seen
    free = max(whole.first_free, int(whole.ids.max()) + 1)  # what is hidden keeps its ids
    return whole[~gone].replace(first_free=free), seen


def rows_at(cloud: GaussianCloud, motion: Motion, time: float) -> tuple[GaussianCloud, Tensor | None]:
    """The cloud at a time with all its rows, and `[N]` bool: which of them are left out then (None: none is).

    Raises:
        UserError: the time is not finite.
    """
    time = _finite(time)
    draft = _Draft(cloud)
    _displace(draft, cloud, motion, time)
    seen = tuple(look for look in motion.looks if look.lasts_at(time))
    gone = _wear(draft, cloud, motion, seen)
    for body in bodies(cloud, motion):
        turns, shifts = chained([motion.tracks[i] for i in body.tracks], (time,))
        draft.carry(body.rows, turns[0], shifts[0])
    return draft.done(), gone


def _finite(time: Any) -> float:
    """A time in seconds, given as a number of any kind. Raises UserError if it is no finite one."""
    try:
        found = math.nan if isinstance(time, (str, bytes)) else float(time)
    except (TypeError, ValueError):
        found = math.nan
    if not math.isfinite(found):
        raise UserError(f"a time must be a finite number of seconds, as in 2.5, not {time!r}")
    return found


def bodies(cloud: GaussianCloud, motion: Motion) -> tuple[_Body, ...]:
    """Rows that the same tracks move, with these tracks."""

    def find() -> tuple[_Body, ...]:
        found = [
            _Body(rows_of_ids(cloud.ids, torch.from_numpy(ids_of(runs))), tracks)
            for runs, tracks in combinations(motion)
        ]
        return tuple(body for body in found if len(body.rows))

    return _bodies.get((cloud.ids, motion), find)


def _placed(cloud: GaussianCloud, lists: Sequence[NDArray[np.int64]]) -> tuple[tuple[Tensor, Tensor], ...]:
    """For each list of ascending ids the rows `[m]` that have one of them, and the place of each row's id in it."""
    found = []
    for ids in lists:
        names = torch.from_numpy(np.ascontiguousarray(ids))
        rows = rows_of_ids(cloud.ids, names)
        found.append((rows, torch.searchsorted(names, cloud.ids[rows].cpu())))
    return tuple(found)


def _displace(draft: _Draft, cloud: GaussianCloud, motion: Motion, time: float) -> None:
    places = _residuals.get((cloud.ids, motion), lambda: _placed(cloud, [r.ids for r in motion.residuals]))
    for residual, (rows, place) in zip(motion.residuals, places, strict=True):
        away = torch.from_numpy(residual.displacements(time))[place]
        draft.change("means", rows, lambda means, away=away: means + away.to(means))  # type: ignore[misc]


def _wear(draft: _Draft, cloud: GaussianCloud, motion: Motion, seen: Sequence[Look]) -> Tensor | None:
    """Apply looks; `[N]` bool: which rows are left out, None: none."""
    gone: Tensor | None = None
    places = _looks.get((cloud.ids, motion), lambda: _placed(cloud, [look.ids for look in motion.looks]))
    for look, (rows, place) in zip(motion.looks, places, strict=True):
        if look not in seen:
            continue
        if look.sh is not None:
            harmonics = look.sh[place].to(cloud.device)
            draft.set("sh", rows, _of_bands(harmonics, int(cloud.sh.shape[1])))
        if look.opacities is not None:
            opacities = look.opacities[place].to(cloud.device)
            gone = torch.zeros(len(cloud), dtype=torch.bool, device=cloud.device) if gone is None else gone
            gone[rows] = opacities == 0
            draft.set("opacities", rows, torch.where(opacities == 0, cloud.opacities[rows], opacities))
    return gone if gone is not None and bool(gone.any()) else None


def _of_bands(sh: Tensor, bands: int) -> Tensor:
    """Harmonics `[n, K, 3]` with as many coefficients as the cloud's."""
    if sh.shape[1] >= bands:
        return sh[:, :bands]
    return torch.cat([sh, sh.new_zeros(len(sh), bands - sh.shape[1], 3)], dim=1)


class _Draft:
    """A cloud of which some rows change: a column is copied the first time it is written and shared otherwise."""

    def __init__(self, cloud: GaussianCloud) -> None:
        self._cloud = cloud
        self._written: dict[str, Tensor] = {}
        self._rows: dict[str, list[Rows]] = {}  # of each written column, those that were written

    def done(self) -> GaussianCloud:
        return self._cloud.replace(**self._written) if self._written else self._cloud

    def set(self, name: str, rows: Tensor, values: Tensor) -> None:
        self._own(name, rows).index_copy_(0, rows, values)

    def change(self, name: str, rows: Tensor, to: Callable[[Tensor], Tensor]) -> None:
        """Replace rows `[M]`, ascending, of a column by `to` of them, a block at a time."""
        span, source = _side_by_side(rows), self._written.get(name, getattr(self._cloud, name))
        column = self._own(name, rows if span is None else span, all_written=True)
        if span is None:
            for block in torch.split(rows, _BLOCK):
                column.index_copy_(0, block, to(source.index_select(0, block)).to(column.dtype))
            return
        for start in range(span.start, span.stop, _BLOCK):
            part = slice(start, min(start + _BLOCK, span.stop))
            column[part] = to(source[part])

    def carry(self, rows: Tensor, turn: F64, shift: F64) -> None:
        """Map rows by `x -> turn @ x + shift`, with their rotations and harmonics."""
        turns = bool(np.abs(turn - np.eye(3)).max() > _TURN)
        if not turns and not shift.any():
            return
        if not turns:
            shift_means(rows, self._from_to("means", rows), shift)
            return
        means, quats = self._from_to("means", rows), self._from_to("quats", rows)
        # Without view-dependent colours none is written: the column stays shared.
        sh = self._from_to("sh", rows) if self._cloud.sh.shape[1] > 1 else None
        carry(rows, means, quats, sh, turn, shift)

    def _from_to(self, name: str, rows: Tensor) -> tuple[Tensor, Tensor]:
        """A column as it is, and the one to write `rows` of it to."""
        span, source = _side_by_side(rows), self._written.get(name, getattr(self._cloud, name))
        return source, self._own(name, rows if span is None else span, all_written=True)

    def _own(self, name: str, rows: Rows, all_written: bool = False) -> Tensor:
        """The column, to write to `rows` of it."""
        if name not in self._written:
            self._written[name], self._rows[name] = like(getattr(self._cloud, name), rows if all_written else None)
        self._rows[name].append(rows)
        return self._written[name]


def _side_by_side(rows: Tensor) -> slice | None:
    """The slice that ascending rows are, None if there are gaps."""
    if not len(rows):
        return None
    first, last = int(rows[0]), int(rows[-1])
    return slice(first, last + 1) if last - first == len(rows) - 1 else None


def _language_at(scene: Scene, moved: Scene, seen: Sequence[Look], time: float) -> LanguageField | None:
    """The table of groups at a time: boxes moved, counts and colours of groups whose look differs taken again."""
    field = scene.language
    if field is None:
        return None
    changed: dict[int, Group] = {}
    for group, boxes in boxes_over(scene, (time,)).items():
        changed[group] = replace(field.groups[group], box=boxes[0])
    if seen:
        worn = torch.from_numpy(np.unique(np.concatenate([look.ids for look in seen])))
        touched = set(scene.cloud.group[rows_of_ids(scene.cloud.ids, worn)].tolist())
        touched |= {field.groups[i].parent for i in touched if 0 <= i < len(field.groups)}
        for number in sorted(i for i in touched if 0 <= i < len(field.groups)):
            leaves = torch.tensor(field.leaves(number), dtype=torch.int32, device=moved.cloud.device)
            rows = rows_where(torch.isin(moved.cloud.group, leaves))
            group = changed.get(number, field.groups[number])
            lab = lab_of_cloud(moved.cloud, rows) if len(rows) else group.lab
            changed[number] = replace(group, lab=lab, count=len(rows))
    if not changed:
        return field
    return replace(field, groups=tuple(changed.get(g.id, g) for g in field.groups))
