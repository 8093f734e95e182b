"""New movements on top of those that are there: a body and its ids at the time at which it begins, and its tracks."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.at import at
from ...gaussians.motion.motion import Motion, Track, composed
from ...gaussians.scene import Scene
from ..carried_objects import with_carried
from ..operation import Context, Outcome
from ..placement.bodies import Body, bodies_of
from ..when import When
from .spans import Span, length_of, longer_notes, spans_of

I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Start:
    """What begins to move, as it is then.

    Attributes:
        scene: static, at the time at which it begins.
        body: in that scene, with what stands on it.
        ids: of the body, ascending.
        span: seconds; the end may be infinite.
        whole: the time of the scene, seconds.
    """

    scene: Scene
    body: Body
    ids: I64
    span: Span
    whole: Span


def with_movement(
    scene: Scene,
    selection: Selection,
    when: When | None,
    context: Context,
    move: Callable[[Start], Track | tuple[Track, ...]],
) -> Outcome:
    """The scene in which each body of a selection moves in addition to how it moves already.

    Args:
        move: the track of one body, in the world of the time at which it begins; or several, in their order.
    """
    whole = length_of(scene)
    spans = spans_of(when, scene, selection, context, onward=True) if when is not None else [(-math.inf, math.inf)]
    first = whole.start if context.time is None else context.time
    span = (spans[0][0] if math.isfinite(spans[0][0]) else first, spans[0][1])
    still = at(scene, span[0])
    tracks, touched = list[Track](), list[torch.Tensor]()
    for body in with_carried(still, bodies_of(still, selection)):
        ids = still.cloud.ids[body.rows]
        touched.append(ids)
        start = Start(still, body, np.sort(ids.cpu().numpy()), span, (whole.start, whole.stop))
        made = move(start)
        tracks += made if isinstance(made, tuple) else (made,)
    stop = max([whole.stop, *(_end(t, span[1]) for t in tracks)])
    motion = composed(scene.motion, Motion(tuple(tracks), (), (), whole.start, stop))
    notes = longer_notes(whole, stop, anyway=True)
    return Outcome(scene.replace(motion=motion), touched=torch.cat(touched).sort().values, notes=notes)


def _end(track: Track, until: float) -> float:
    return float(track.times[-1]) if track.kind != "spin" or not math.isfinite(until) else until
