"""Which Gaussians belong to which body (`shared`): each that is near one is put both where it stands and where the body
goes, and the frames tell what share of it goes along.

Poses, colours and shapes stay as they are; only shares are trained. Shares of neighbours are drawn together, so that
those that no picture tells apart (white before white) follow the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...fit.loss import BLACK
from ...harmonics import SH_C0
from ...render.cpu import gradient
from .bodies import Body, Columns, Labelled, placed
from .footage import Footage
from .seeds import gone, weights
from .tracking import unlike

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

NEAR = 4.0  # pixels, at the distance of the cameras' radius: as near to a body is what may belong to it
MEMBER, OTHER = 1.0, -1.0  # logits of the shares at the start: of what was taken for the body's, and of what is near
STEPS = 160
RATE = 0.12
NEIGHBOURS = 6
DRAWN = 0.06  # how far a logit is drawn towards the mean of its neighbours at each step
QUIET = 0.1  # of the typical gradient: smaller ones count less
ALIKE = 0.1  # colours that differ by so much are as unlike as places that are `NEAR` apart
SEEN = 1.0  # pixels: what the first pictures show less of is not told by them
UNCHANGED = 0.3  # share of its pixels up to which something is as at first
AROUND = 16  # neighbours in place and colour that are asked
ROUNDS = 5  # from the edge of what looks alike inwards
DENSEST = 0.98  # opacity beyond which a Gaussian is not divided more finely
MOVED = 1.0  # pixels: frames in which no body has gone so far tell nothing


@dataclass(frozen=True, eq=False)
class _Shares:
    """Gaussians that may be of a body: `rows` of the columns, `body` number of each, `near` rows of their neighbours in
    `rows`, `[n, NEIGHBOURS]`."""

    rows: I64
    body: NDArray[np.int32]
    near: I64


def shared(
    columns: Columns, labels: NDArray[np.int32], bodies: list[Body], footage: Footage, rng: np.random.Generator
) -> NDArray[np.int32]:
    """`[N]` the number of the body of each Gaussian, 0 for what stands still, from labels that are roughly right."""
    told = _telling(columns, labels, bodies, footage)
    candidates = _candidates(columns, labels, footage)
    if not len(candidates.rows) or not len(told):
        return labels
    logits = np.where(labels[candidates.rows] > 0, MEMBER, OTHER)
    first, second = np.zeros(len(logits)), np.zeros(len(logits))
    order: list[int] = []
    for k in range(1, STEPS + 1):
        order = order or rng.permutation(told).tolist()
        share = 1 / (1 + np.exp(-logits))
        slope = _slope(columns, candidates, share, bodies, footage, order.pop()) * share * (1 - share)
        first, second = 0.9 * first + 0.1 * slope, 0.99 * second + 0.01 * slope**2
        size = np.sqrt(second / (1 - 0.99**k))
        logits = logits - RATE * first / (1 - 0.9**k) / (size + QUIET * np.sqrt((size**2).mean()) + 1e-30)
        logits = logits + DRAWN * (logits[candidates.near].mean(axis=1) - logits)
    found = labels.copy()
    found[candidates.rows] = np.where(logits > 0, candidates.body, 0)
    return found


def without_ground(columns: Columns, labels: NDArray[np.int32], footage: Footage) -> NDArray[np.int32]:
    """`[N]` labels without what lies under a body or beside it, and looks the same whether it goes along or stands.

    The even top of the table under a vase that turns: its pixels change at no time, and what is nearest to it, in place
    and colour, stands still.
    """
    flags = ~gone(columns, footage, UNCHANGED).any(axis=1) & (labels > 0)
    rows = np.flatnonzero(flags & (_weight(columns, footage) > SEEN))
    if not len(rows):
        return labels
    alike = np.concatenate([columns[0] / _across(footage, NEAR), columns[4][:, 0] * SH_C0 / ALIKE], axis=1)
    _, near = cKDTree(alike).query(alike[rows], k=min(AROUND + 1, len(alike)))
    found = labels.copy()
    for _ in range(ROUNDS):
        found[rows] = np.where((found[near[:, 1:]] > 0).mean(axis=1) < 0.5, 0, found[rows])
    return found


def _across(footage: Footage, pixels: float) -> float:
    """How far some pixels are across at the distance of the cameras' radius, scene units."""
    return pixels * footage.radius / footage.cameras[0].fx


def _weight(columns: Columns, footage: Footage) -> F64:
    """`[N]` blending weight of each Gaussian in the pictures of the first time, pixels."""
    total = np.zeros(len(columns[0]))
    for camera in footage.cameras:
        total += weights(columns, camera, [np.ones((camera.height, camera.width), bool)])[:, 0]
    return total


def shown_later(labelled: Labelled, bodies: list[Body], footage: Footage, rng: np.random.Generator) -> None:
    """Give to bodies what goes along with them from where they rest later on; in place.

    Sides of a body that no first frame shows have no Gaussians at the start. What stands still where the body comes to
    rest is trained to show them, and is not there when the body goes on. It is put where the body had it at first.
    """
    for number, body in enumerate(bodies, 1):
        if body.bend is not None:  # where it rests, it has another shape
            continue
        t = _rest(labelled.means[labelled.labels == number], body, footage)
        if t is None:
            continue
        columns = placed(labelled.columns(), labelled.labels, bodies, t)
        labels = shared(columns, labelled.labels, [b.started_at(t) for b in bodies], footage, rng)
        new = np.flatnonzero((labelled.labels == 0) & (labels == number))
        back = body.started_at(t)
        labelled.means[new], labelled.quats[new] = back.placed(0, labelled.means[new], labelled.quats[new])
        labelled.labels[new] = number


def _rest(own: F32, body: Body, footage: Footage) -> int | None:
    """The time at which a body begins its longest rest away from where it was at first; None: it rests nowhere."""
    away = _away(own, body, footage)
    rests = [(stop - start, start) for start, stop in body.runs if away[start] and stop - start > 1]
    return max(rests)[1] if rests else None


def _away(own: F32, body: Body, footage: Footage) -> NDArray[np.bool_]:
    """`[T]` whether Gaussians of a body with means `[N, 3]` at first are then elsewhere."""
    least = _across(footage, MOVED)
    away = np.zeros(len(footage.times), bool)
    for t in range(len(away) if len(own) else 0):
        means, _ = body.placed(t, own, np.ones((len(own), 4), np.float32))
        away[t] = float(np.linalg.norm(means - own, axis=1).max()) > least
    return away


def _telling(columns: Columns, labels: NDArray[np.int32], bodies: list[Body], footage: Footage) -> I64:
    """Frames at whose time a body is not where it was at first."""
    away = [_away(columns[0][labels == number], body, footage) for number, body in enumerate(bodies, 1)]
    return np.flatnonzero(np.any([np.zeros(len(footage.times), bool), *away], axis=0)[footage.when])


def _candidates(columns: Columns, labels: NDArray[np.int32], footage: Footage) -> _Shares:
    """What belongs to a body, or is near it at the start."""
    members = np.flatnonzero(labels > 0)
    if not len(members):
        return _Shares(members, np.zeros(0, np.int32), np.zeros((0, 1), np.int64))
    away, nearest = cKDTree(columns[0][members]).query(columns[0])
    rows = np.flatnonzero((labels > 0) | (away < _across(footage, NEAR)))
    body = np.where(labels[rows] > 0, labels[rows], labels[members[nearest[rows]]]).astype(np.int32)
    _, near = cKDTree(columns[0][rows]).query(columns[0][rows], k=min(NEIGHBOURS + 1, len(rows)))
    return _Shares(rows, body, near.reshape(len(rows), -1)[:, 1:] if len(rows) > 1 else near.reshape(1, 1))


def _slope(
    columns: Columns, candidates: _Shares, share: F64, bodies: list[Body], footage: Footage, frame: int
) -> F64:  # fmt: skip
    """Gradient of the absolute difference to a frame by the shares.

    A Gaussian of opacity o is divided into two, of opacities `1 - (1 - o) ** share` and the rest, that look as one
    where they are at one place.
    """
    rows, shot, t = candidates.rows, footage.shots[frame], int(footage.when[frame])
    clear = np.log(1 - np.minimum(columns[3][rows], DENSEST).astype(np.float64))
    goes, stays = np.exp(share * clear), np.exp((1 - share) * clear)  # transmittances of the two
    opacities = columns[3].copy()
    opacities[rows] = 1 - stays
    means, quats = columns[0][rows], columns[1][rows]
    for number, body in enumerate(bodies, 1):
        own = np.flatnonzero(candidates.body == number)
        if len(own):
            means[own], quats[own] = body.placed(t, means[own], quats[own])
    divided = (
        np.concatenate([columns[0], means]), np.concatenate([columns[1], quats]),
        np.concatenate([columns[2], columns[2][rows]]),
        np.concatenate([opacities, (1 - goes).astype(np.float32)]), np.concatenate([columns[4], columns[4][rows]]),
    )  # fmt: skip
    drawn = gradient.draw(divided, shot.camera, BLACK)
    by_pixel = np.sign(unlike(drawn, shot.colors))
    found = gradient.draw_backward(drawn, by_pixel, -(by_pixel * shot.colors).sum(axis=2))
    by_going, by_staying = found.opacities[len(opacities) :], found.opacities[rows]
    return np.asarray(-clear * (goes * by_going - stays * by_staying))
