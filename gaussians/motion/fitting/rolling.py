"""What rolls (`Ball`): it turns about the axis across its way, by its way over its radius.

A ball of a few pixels that turns by a third of a turn from one frame to the next shows any of many poses: pictures of
single times do not tell its turns, and cameras at the start see half of it. All frames together tell its radius: the
one for which each point of the ball has the same colour in all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...harmonics import SH_C0
from .. import keys
from .bodies import Body, Labelled, turned
from .footage import Footage

F64 = NDArray[np.float64]

RADII = np.geomspace(0.74, 1.2, 49)  # of the ball's radius, each one per cent more: haze makes it too large
LEAST_WAY = 3.0  # of the ball's radius: what goes less far does not roll
ROUND = 0.25  # of the radius: how far from the surface a Gaussian may be that is taken to be on it
SHARE = 0.75  # of the Gaussians of a body that are on the surface of a ball
PATCH = 0.65  # length of the mean of unit vectors to its Gaussians, 0.5 for half a ball: more is a patch of no ball
TRUER = 0.97  # of the variance of colours with its own turns, below which a body rolls
FACING = 0.3  # cosine between normal and sight from which a point of the surface is seen
FRAMES = 200  # in which they are looked at
POINTS = 300  # of the surface, whose colours are compared
BESIDE = 1.2  # spacings: what is nearer to a Gaussian of the start is covered by it
OPACITY = 0.9


@dataclass(frozen=True, eq=False)
class Ball:
    """A sphere.

    Attributes:
        centre: `[3]` world.
        radius: scene units.
    """

    centre: F64
    radius: float

    @classmethod
    def of(cls, means: F64, weights: F64) -> Ball | None:
        """The sphere on which means `[N, 3]` lie; None if too few of them do.

        Least squares of `|x|^2 = 2 x . c + (r^2 - |c|^2)`, again and again without those that are far off.
        """
        rows, own, off = np.c_[2 * means, np.ones(len(means))], weights, np.zeros(len(means))
        centre, radius = means.mean(axis=0), 1.0
        for _ in range(12):
            root = np.sqrt(own)
            found = np.linalg.lstsq(rows * root[:, None], (means**2).sum(axis=1) * root, rcond=None)[0]
            centre, radius = found[:3], float(np.sqrt(max(found[3] + found[:3] @ found[:3], 1e-12)))
            off = np.linalg.norm(means - centre, axis=1) / radius - 1
            own = weights / (1 + (off / (0.2 * ROUND)) ** 2)
        out = (means - centre) / np.maximum(np.linalg.norm(means - centre, axis=1, keepdims=True), 1e-12)
        around = float(np.linalg.norm(np.average(out, axis=0, weights=weights)))
        on = np.average(np.abs(off) < ROUND, weights=weights)
        return cls(centre, radius) if on >= SHARE and around <= PATCH else None

    def rolled(self, body: Body, footage: Footage) -> tuple[Ball, Body] | None:
        """The ball and a body rolling along its path, if the colours of its surface are steadier so than with its own
        turns.

        The normal of the plane on which it rolls is one of the world's axes.

        Args:
            body: its places are kept.
        """
        body = body.seen_from(self.centre)
        if np.linalg.norm(np.diff(body.offsets, axis=0), axis=1).sum() < LEAST_WAY * self.radius:
            return None
        tried = [
            (radius, Body(self.centre, rolling(body.offsets, up, radius), body.offsets))
            for up in np.concatenate([np.eye(3), -np.eye(3)])
            for radius in RADII * self.radius
        ]
        normals, frames = sphere(POINTS), np.random.default_rng(0).permutation(len(footage.shots))[:FRAMES]
        radius, best = min(tried, key=lambda each: self._colors(each[1], footage, normals, frames)[1])
        if not 1.001 * RADII[0] < radius / self.radius < 0.999 * RADII[-1]:
            return None  # none that was tried is the best
        ball = Ball(self.centre, radius)  # what lies around it hides how steady its surface is
        own, rolled = (ball._colors(b, footage, normals, frames)[1] for b in (body, best))
        return (ball, best) if rolled < TRUER * own else None

    def filled(self, labelled: Labelled, number: int, body: Body, footage: Footage) -> None:
        """Add Gaussians where the ball has none, of the mean colours that its frames show there; in place."""
        spacing = footage.radius / footage.cameras[0].fx
        normals = sphere(max(60, round(4 * np.pi * (self.radius / spacing) ** 2)))
        spacing = self.radius * np.sqrt(4 * np.pi / len(normals))
        rows = np.flatnonzero(labelled.labels == number)
        out = labelled.means[rows] - self.centre
        out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)
        colors, _ = self._colors(body, footage, normals, np.arange(len(footage.shots)))
        bare = (normals @ out.T).max(axis=1) < np.cos(BESIDE * spacing / self.radius)
        bare &= np.isfinite(colors).all(axis=1)
        count, start = int(bare.sum()), len(labelled)
        labelled.append(np.repeat(rows[:1], count))
        labelled.means[start:] = self.centre + self.radius * normals[bare]
        labelled.quats[start:] = [1.0, 0.0, 0.0, 0.0]
        labelled.log_scales[start:] = np.log(0.5 * spacing)
        labelled.logit_opacities[start:] = np.log(OPACITY / (1 - OPACITY))
        labelled.sh[start:] = 0.0
        labelled.sh[start:, 0] = (colors[bare] - 0.5) / SH_C0

    def _colors(
        self, body: Body, footage: Footage, normals: F64, frames: NDArray[np.int64]
    ) -> tuple[F64, float]:  # fmt: skip
        """Mean colours `[M, 3]` that some frames show at points of the surface, NaN where none does, and their
        variance."""
        seen, first, second = np.zeros((len(normals), 1)), np.zeros((len(normals), 3)), 0.0
        turns = keys.matrices(body.quats)
        for frame in frames:
            shot, t = footage.shots[frame], int(footage.when[frame])
            camera = shot.camera
            out = normals @ turns[t].T
            points = self.centre + body.offsets[t] + self.radius * out
            sight = camera.position - points
            sight /= np.linalg.norm(sight, axis=1, keepdims=True)
            pixels, depth = camera.project(points)
            facing = np.clip((out * sight).sum(axis=1) - FACING, 0, None) * camera.contains(pixels, depth)
            weight = (facing * (camera.fx / np.maximum(depth, 1e-6)) ** 2)[:, None]  # by its pixels
            x, y = np.clip(pixels.astype(np.int64).T, 0, [[camera.width - 1], [camera.height - 1]])
            colors = shot.colors[y, x].astype(np.float64)
            seen, first, second = seen + weight, first + weight * colors, second + float((weight * colors**2).sum())
        with np.errstate(invalid="ignore", divide="ignore"):
            means = first / seen
        within = second - float(np.nansum(first * means))
        return means, within / max(float(seen.sum()), 1e-12)


def rolling(offsets: F64, up: F64, radius: float) -> F64:
    """`[T, 4]` turns of a ball of a radius that rolls along offsets `[T, 3]` on a plane with a normal."""
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(offsets), 1))
    for t in range(1, len(offsets)):
        quats[t] = turned(quats[t - 1], np.cross(up, offsets[t] - offsets[t - 1]) / radius)
    return quats


def sphere(count: int) -> F64:
    """`[count, 3]` unit vectors, spread evenly (a Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    height, around = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    flat = np.sqrt(1 - height**2)
    return np.stack([flat * np.cos(around), flat * np.sin(around), height], axis=1)
