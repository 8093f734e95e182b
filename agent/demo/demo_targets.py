"""Finds the things that the demo can name in a room, and checks instructions and results against the ground truth.

The ground truth is the builder's list of things; the selection never sees it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.errors import AbsentError, AmbiguousError, ScenewrightError
from ..session.result import Result
from ..session.session import Session
from .script import Targets, Thing, Turn

if TYPE_CHECKING:
    from ...gaussians.assets import Room

VISIBLE = 0.002  # share of the picture that a thing must cover to be named

Ids = NDArray[np.int32]


def find_targets(room: Room, viewer: Camera) -> Targets:
    """The visible things of a room, by the pixels that they cover, and kinds of things that it does not contain."""
    import torch

    from ...gaussians.assets import kinds
    from ...gaussians.render import render

    ids = torch.as_tensor(np.asarray(room.truth.ids), dtype=torch.int32)
    seen = render(room.scene.cloud.replace(group=ids), viewer).group
    table = room.truth.objects
    things = [Thing(o.id, o.kind, o.color, *_seen(seen.numpy() == o.id)) for o in table]
    visible = [t for t in things if t.pixels >= VISIBLE * viewer.width * viewer.height]
    there = {t.kind for t in things}
    # A "lamp" is not absent from a room with a floor lamp.
    words = {word for kind in there for word in kind.split()}
    absent = [k for k in kinds(shown=True) if k not in there and not set(k.split()) & words]
    return Targets(sorted(visible, key=lambda t: -t.pixels), absent, set())


def _seen(mask: NDArray[np.bool_]) -> tuple[int, float]:
    """The number of pixels of a mask, and their mean horizontal position from 0 (left) to 1 (right)."""
    columns = mask.nonzero()[1]
    return len(columns), float(columns.mean() / mask.shape[1]) if len(columns) else 0.5


def try_turn(session: Session, turn: Turn) -> tuple[bool, Result | None]:
    """Whether an instruction has its expected outcome, and its result, in a dry run."""
    if turn.outcome == "undo":
        return len(session.done) > 0, None
    try:
        result = session.preview(turn.text)
        return turn.outcome == "edit", result
    except AmbiguousError:
        return turn.outcome == "ambiguous" and _answer_helps(session, turn.answer), None
    except AbsentError:
        return turn.outcome == "absent", None
    except ScenewrightError:
        return False, None


def _answer_helps(session: Session, answer: str) -> bool:
    try:
        session.preview(session.answered(answer))
    except ScenewrightError:
        return False
    return True


def agreement(result: Result, turn: Turn, truth: Ids) -> float | None:
    """Intersection over union of the selection with the ground truth, over the Gaussians of the unedited room.

    None if the turn names no thing or the scene has no language field.
    """
    language = result.before.language
    if not turn.about or language is None:
        return None
    cloud = result.before.cloud
    ids, column = cloud.ids.numpy(), cloud.group.numpy()
    groups = {g for r in result.receipts for g in r.selection.groups}
    leaves = [leaf for g in groups for leaf in language.leaves(g)]
    original = ids < len(truth)
    chosen = np.isin(column[original], leaves)
    meant = np.isin(truth[ids[original]], [t.id for t in turn.about])
    union = int((chosen | meant).sum())
    return float((chosen & meant).sum() / union) if union else None
