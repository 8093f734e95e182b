"""Compares groups with one vector per Gaussian, as is usual in the literature, from the same masks.

The alternative is built as in the literature: a Gaussian's vector is the mean of its masks' vectors over all views,
weighted by blending weight and compressed to d numbers by principal components of the scene; a query selects the
Gaussians whose similarity beats all other names, by the same calibrated rule as groups. Size is not used, as a single
Gaussian has no size of an object.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np
from numpy.typing import NDArray

from ...gaussians.language.encoders import Encoder
from ...gaussians.language.encoders.probability import probability
from ...gaussians.language.masks.lifting import Lifted, lift
from .._iou import Mask, iou
from .association import associate
from .cases import Case
from .pictures import Seen

F32 = NDArray[np.float32]
CHUNK = 16_384  # Gaussians asked at a time, so that memory stays flat
STRIDE = 3  # every third Gaussian is judged: the mean over names is the same to three digits
OWN = 0.5  # share of what was seen of a Gaussian that must lie in masks


@dataclass(frozen=True)
class Outcome:
    """A way to hold vectors, on one case.

    Attributes:
        names: that were asked.
        iou: of each, 0 where nothing was selected.
        margin: by how much likelier a thing's own Gaussians are called by its name than all others, mean over names.
        seconds: from the masks with their vectors to the answer to one query.
        query: of which one query.
        bytes: held.
    """

    names: tuple[str, ...]
    iou: list[float]
    margin: float
    seconds: float
    query: float
    bytes: int


@dataclass(frozen=True, eq=False)
class Uplift:
    """The masks of one case lifted, and the true objects they are of.

    Attributes:
        lifted: weights of all masks.
        objects: `[M]` the object each mask is of.
        covered: `[N]` Gaussians of which at least `OWN` was seen within masks.
        seconds: that lifting took.
    """

    lifted: Lifted
    objects: NDArray[np.int64]
    covered: Mask
    seconds: float


def uplift(case: Case, seen: Sequence[Seen]) -> Uplift:
    """Lift all views' masks."""
    start = time.process_time()
    lifted = lift(case.scene.cloud, [view.masks for view in seen])
    within = np.asarray(lifted.weights.sum(axis=1)).ravel()
    total = np.asarray(lifted.seen.sum(axis=1)).ravel()
    objects = np.array([o for view in seen for o in view.objects], dtype=np.int64)
    return Uplift(lifted, objects, (total > 0) & (within >= OWN * total), time.process_time() - start)


def as_groups(case: Case, up: Uplift, encoder: Encoder, names: Sequence[str]) -> Outcome:
    """One number a Gaussian, one vector a group: masks are grouped as users get it."""
    start = time.process_time()
    whole = [track.masks for track in associate(up.lifted).tracks if track.parent < 0]
    return _grouped(case, up, encoder, names, whole, start)


def as_true_groups(case: Case, up: Uplift, encoder: Encoder, names: Sequence[str]) -> Outcome:
    """The same with a flawless association: masks of one object are one group."""
    start = time.process_time()
    whole = [tuple(np.flatnonzero(up.objects == o.id).tolist()) for o in case.objects]
    return _grouped(case, up, encoder, names, whole, start)


def _grouped(
    case: Case, up: Uplift, encoder: Encoder, names: Sequence[str], whole: Sequence[tuple[int, ...]], start: float
) -> Outcome:
    """Each Gaussian in the group whose masks give it most weight; what those groups answer."""
    assert up.lifted.vectors is not None
    member = np.zeros((len(up.objects), len(whole) + 1), np.float32)  # the last is that of masks in no group
    member[:, -1] = 1
    for k, masks in enumerate(whole):
        member[list(masks)] = 0
        member[list(masks), k] = 1
    column = np.where(up.covered, np.asarray(up.lifted.weights @ member).argmax(axis=1), len(whole))
    mass = np.asarray(up.lifted.weights.sum(axis=0)).ravel()
    table = (member[:, :-1] * mass[:, None]).T @ up.lifted.vectors
    built = time.process_time() - start + up.seconds
    start = time.process_time()
    chance = [np.append(probability(encoder, name, table), 0.0) for name in names]
    np.flatnonzero(np.isin(column, np.flatnonzero(chance[0] >= encoder.calibration.threshold)))
    query = (time.process_time() - start) / len(names)
    size = 4 * len(column) + table.nbytes
    return _outcome(case, encoder, names, [c[column] for c in chance], built, query, size)


def as_vectors(case: Case, up: Uplift, encoder: Encoder, names: Sequence[str], width: int) -> Outcome:
    """One vector of `width` numbers a Gaussian, float32."""
    start = time.process_time()
    features = up.lifted.features()
    features[~up.covered] = 0
    full = features.shape[1]
    if width < full:
        mean, axes = principal(features[up.covered], width)
        small = (features - mean) @ axes.T
        features = np.where(up.covered[:, None], small @ axes + mean, 0).astype(np.float32)
    built = time.process_time() - start + up.seconds
    start = time.process_time()
    _chance(features, encoder, names[0])
    query = time.process_time() - start
    chance = [_chance(features[::STRIDE], encoder, name) for name in names]
    return _outcome(case, encoder, names, chance, built, query, 4 * min(width, full) * len(features))


def _chance(features: F32, encoder: Encoder, name: str) -> NDArray[np.float64]:
    """How likely each Gaussian is a `name` rather than anything else, `[N]`."""
    rows = (features[i : i + CHUNK] for i in range(0, len(features), CHUNK))
    return np.concatenate([probability(encoder, name, part) for part in rows])


def _outcome(
    case: Case, encoder: Encoder, names: Sequence[str], chance: Sequence[NDArray[np.float64]], built: float,
    query: float, size: int,
) -> Outcome:  # fmt: skip
    """The answers judged; `chance` of all Gaussians, or of every `STRIDE`-th."""
    meant = {o.kind: o for o in case.alone()}
    ious, margins = [], []
    for name, sure in zip(names, chance, strict=True):
        truth = case.truth(meant[name])
        own = truth if len(sure) == len(truth) else truth[::STRIDE]
        ious.append(iou(own, sure >= encoder.calibration.threshold))
        margins.append(float(sure[own].mean() - sure[~own].mean()) if own.any() else 0.0)
    return Outcome(tuple(names), ious, fmean(margins), built + query, query, size)


def principal(rows: F32, width: int) -> tuple[F32, F32]:
    """Mean `[D]` and the first `width` principal axes `[width, D]` of rows `[M, D]`."""
    mean = rows.mean(axis=0)
    spread = rows - mean
    _, axes = np.linalg.eigh((spread.T @ spread).astype(np.float64))
    first: F32 = axes[:, ::-1][:, :width].T.astype(np.float32)
    return mean, first


def miou(outcomes: Sequence[Outcome]) -> float:
    """Mean IoU over all names of all cases."""
    return fmean(v for outcome in outcomes for v in outcome.iou)
