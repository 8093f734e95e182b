"""A moment of a scene with motion for the page: the rows of all that changes with time, as one message."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.errors import UserError
from ...gaussians.kept import Kept
from ...gaussians.motion.at import rows_at
from ...gaussians.motion.boxes import boxes_over
from ...gaussians.motion.motion import Motion
from ...gaussians.rows import rows_of_ids
from . import wire
from .changes import Shown
from .columns import encode, width
from .slots import EMPTY, I64, ranges_of, slots_of
from .state import box_json

_BRIDGED = 12  # bytes of a range in the header, about: gaps whose rows take fewer bytes are sent along

_RATE, _LEAST_RATE = 20.0, 2.0  # moments a second in a page of its own; below the least it shows the start alone
_MOST_BYTES = 24 << 20  # of all its moments, before they are packed

_ranges: Kept[dict[str, I64]] = Kept(4)


def frame(shown: Shown, time: float, number: int) -> bytes:
    """The message that turns what a page shows of a revision, at any time, into the same at a time (seconds).

    It holds every row that changes at some time, in every column in which it does.

    Args:
        number: of the message that asked for it.

    Raises:
        UserError: nothing changes with time.
    """
    motion = shown.scene.motion
    if motion is None:
        raise UserError("nothing moves in this scene any more")
    where = _ranges.get((shown.slots, motion), lambda: _changing(shown, motion))
    cloud, gone = rows_at(shown.scene.cloud, motion, time)
    left_out = None if gone is None else gone.cpu().numpy()
    parts = []
    for column, ranges in where.items():
        rows = shown.slots.rows[slots_of(ranges)]
        if column == "color" and left_out is not None:
            rows = np.where((rows >= 0) & left_out[rows], EMPTY, rows)
        parts.append(wire.Part(column, ranges, encode(cloud, shown.owner, column, rows)))
    boxes = {group: box_json(boxes[0]) for group, boxes in boxes_over(shown.scene, (time,)).items()}
    more = {"time": time, "id": number, "boxes": boxes}
    return wire.message(shown, shown.revision, parts, (0, 1), "frame", more)


def moments(shown: Shown) -> list[tuple[float, bytes]]:
    """Times, seconds, and the messages of a scene at these times, evenly from its start to its stop, for a page without
    a server; none if nothing moves, or so much of it that the page would be too large."""
    motion = shown.scene.motion
    if motion is None or motion.stop <= motion.start:
        return []
    lasts = motion.stop - motion.start
    rate = min(_RATE, _MOST_BYTES / (lasts * len(frame(shown, motion.start, 0))))
    if rate < _LEAST_RATE:
        return []
    count = max(1, round(lasts * rate))
    times = [motion.start + lasts * i / count for i in range(count + 1)]
    return [(time, frame(shown, time, number)) for number, time in enumerate(times)]


def _changing(shown: Shown, motion: Motion) -> dict[str, I64]:
    """By column, the ranges of slots that change at some time."""
    moved = _slots(shown, [track.ids for track in motion.tracks] + [r.ids for r in motion.residuals])
    worn = _slots(shown, [look.ids for look in motion.looks])
    found = {"position": moved, "shape": moved, "color": worn}
    if shown.degree:
        found["harmonics"] = np.union1d(moved, worn)
    return {
        column: ranges_of(slots, _BRIDGED // width(column, shown.degree))
        for column, slots in found.items()
        if len(slots)
    }


def _slots(shown: Shown, ids: list[NDArray[np.int64]]) -> I64:
    if not ids:
        return np.zeros(0, np.int64)
    rows = rows_of_ids(shown.scene.cloud.ids, torch.from_numpy(np.unique(np.concatenate(ids))))
    return np.sort(shown.slots.slot[rows.cpu().numpy()])
