"""The path of a body through the frames: searched by the colours of some of its points, then refined by rendering.

From time to time (`track`): candidates around the pose that the last two times predict are scored by how well points
of the body match the pictures where they would be seen, and the best are drawn around again (the cross-entropy method,
Rubinstein 1999). The best of all is refined by the gradient of the rendered difference, in pictures cropped to the
body. A known path is mended from both ends by what the times around a time tell (`mend`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...camera import Camera
from ...fit.loss import BLACK
from ...harmonics import SH_C0
from ...render.cpu import gradient
from .. import keys
from .bodies import Body, Columns, multiplied, pose_gradient, turned
from .footage import Footage, differs, rounded

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

SAMPLES = 160  # points of a body that candidates are scored by
CANDIDATES, ROUNDS, ELITE = 300, 4, 24  # of the search at a time
BLURS = (2.0, 1.2)  # standard deviations of the pictures' blur during the search, pixels: first rounds, last rounds
CLIP = 0.35  # difference of a colour beyond which it does not matter
TURN = 1.4  # radians: the largest turn about one of its own axes that is tried from one time to the next
UNSEEN = CLIP  # the difference of a point outside a picture: as bad as the worst, or bodies would hide there
VIEWS = 6  # cameras that a pose is refined in
STEPS, MEND_STEPS = 14, 8  # of the refinement at each time, while a path is searched and while it is mended
MARGIN = 10  # pixels around a body that are rendered
STILL = 0.004  # share of the pixels around a body that may change while it is taken to be at rest
STILL_DRAWN = 0.05  # of those at which a body is seen, where frames are compared with a render
MATTERS = 0.03  # difference of a colour by which a body is seen
HOPELESS = 4  # times at which it may be lost from the first on, before it is given up
LOST = 0.7  # of the difference without the body, above which it was not found and is searched farther away
SPINS = (0.7,)  # radians: turns about the world's axes that are tried where a body was found
BETTER = 0.98  # of the difference with the present pose, below which another one replaces it
DIFFERENCE = 0.02  # of the body's size: a step of which two renders tell a derivative
APART = 0.02  # of the body's size: poses that are nearer are the same

Pose = tuple[F64, F64]  # quaternion [4] and offset [3]


class Placed(Protocol):
    """What says where Gaussians are at a time of the frames."""

    def placed(self, t: int, means: F32, quats: F32) -> tuple[F32, F32]:
        """Means `[N, 3]` and quaternions `[N, 4]` at a time, from those of the first."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """A body's path, and how well it explains the frames.

    Attributes:
        body: its poses.
        found: `[T]` whether the body explains the pictures at each time better than nothing in its place.
        gain: mean difference of the pictures without the body over that with it, at times when it is not at rest.
    """

    body: Body
    found: NDArray[np.bool_]
    gain: float


class Tracker:
    """Tracks one body.

    Args:
        columns: all Gaussians at the start.
        rows: those of the body.
        still: `[N]` those that stand still.
        footage: its first time is that of the columns.
        seed: of the search.
        moving: the rows of other bodies whose path is known, and their paths.
        check: is called before each search and comparison; it may raise `budget.OutOfTime`.
    """

    def __init__(
        self, columns: Columns, rows: I64, still: NDArray[np.bool_], footage: Footage, seed: int,
        moving: Sequence[tuple[I64, Body]] = (), check: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        self._check = check
        self._footage, self._rng = footage, np.random.default_rng([seed, len(rows)])
        self._own: Columns = tuple(np.ascontiguousarray(c[rows]) for c in columns)  # type: ignore[assignment]
        self._rest: Columns = tuple(np.ascontiguousarray(c[still]) for c in columns)  # type: ignore[assignment]
        self.moving: list[tuple[Columns, Body]] = [
            (tuple(np.ascontiguousarray(c[r]) for c in columns), body)  # type: ignore[misc]
            for r, body in moving
        ]
        means, weight = self._own[0], self._own[3] * self._own[2].max(axis=1) ** 2
        self.pivot = np.average(means, axis=0, weights=weight).astype(np.float64)
        self.size = float(np.sqrt(np.average(((means - self.pivot) ** 2).sum(axis=1), weights=weight)))
        some = self._rng.choice(len(rows), min(SAMPLES, len(rows)), replace=False, p=weight / weight.sum())
        self._points = means[some].astype(np.float64) - self.pivot
        self._colors = (self._own[4][some, 0] * SH_C0 + 0.5).clip(0, 1)
        self._near = [_seen(self._rest, camera) for camera in footage.cameras]
        _, _, axes = np.linalg.svd((means - self.pivot) * np.sqrt(weight)[:, None], full_matrices=False)
        around = np.concatenate([np.outer(np.linspace(-TURN, TURN, 28), axis) for axis in axes])
        self._turns = np.concatenate([np.zeros_like(around), around], axis=1)  # of hinges and fans
        self._axes = axes
        self._bare: dict[tuple[int, int], NDArray[np.bool_]] = {}
        self._blurred: dict[tuple[int, float], F32] = {}
        every = np.concatenate([self._rest[0], means])
        self._low, self._high = np.quantile(every, 0.02, axis=0), np.quantile(every, 0.98, axis=0)

    def track(self) -> Tracked:
        """The path through all times."""
        times = len(self._footage.times)
        body, found, ratios = Body.at_rest(self.pivot, times), np.ones(times, bool), []
        speed, spin = np.zeros(3), np.zeros(3)
        since = 0  # the time at which the body came to rest
        for t in range(1, times):
            step = self._footage.times[t] - self._footage.times[t - 1]
            body.quats[t], body.offsets[t] = body.quats[t - 1], body.offsets[t - 1]
            here = body.placed(t, self._own[0], self._own[1])
            views = self._views(here[0], t, float(np.linalg.norm(speed * step)))
            if not views or self._rests(t, since, views, here):
                speed, spin = np.zeros(3), np.zeros(3)
                continue
            since = t
            if self._rests(t, 0, self._views(self._own[0], t, 0.0), self._own[:2]):  # it is back where it was at first
                body.quats[t], body.offsets[t] = body.quats[0], body.offsets[0]
                speed, spin = np.zeros(3), np.zeros(3)
                continue
            body.offsets[t] += speed * step
            body.quats[t] = turned(body.quats[t], spin * step)
            self._search(body, t, wide=False)
            self._refine(body, t)
            ratio = self.ratio(body, t)
            if ratio > LOST:
                ratio = self._elsewhere(body, t, ratio)
            found[t] = ratio < LOST
            ratios.append(ratio)
            if len(ratios) == HOPELESS and not found[1 : t + 1][-HOPELESS:].any():
                break
            if found[t]:
                speed = (body.offsets[t] - body.offsets[t - 1]) / step
                spin = turn_between(body.quats[t - 1], body.quats[t]) / step
            else:
                body.quats[t], body.offsets[t] = body.quats[t - 1], body.offsets[t - 1]
        gain = float(np.mean(ratios)) if ratios else 1.0
        return Tracked(body, found, gain)

    def mend(self, body: Body) -> None:
        """Improve a known path in place: from the last time to the first and back, a pose is replaced by what the times
        around tell where the pictures agree better, and refined. A body at rest has one pose."""
        runs = body.runs
        for again, order in enumerate((reversed(runs[1:]), runs[1:])):
            for start, stop in order:
                choices = self._around(body, start, stop)
                if len(choices) > 1 and not again:
                    choices += self._spins(choices[0])
                errors, _ = self.errors(start, choices)
                best = int(errors.argmin())
                if best and errors[best] > BETTER * errors[0]:
                    best = 0
                body.quats[start], body.offsets[start] = choices[best]
                if best or again:
                    self._refine(body, start, MEND_STEPS)
                body.quats[start:stop], body.offsets[start:stop] = body.quats[start], body.offsets[start]

    def _around(self, body: Body, start: int, stop: int) -> list[Pose]:
        """Poses to try from one time to before another: the present one, those of the times around, their middle, what
        they lead to; the present one is the first, and no two are the same."""
        last = len(body.offsets) - 1
        seconds = self._footage.times

        def at(t: int) -> Pose:
            return body.quats[t], body.offsets[t]

        found = [at(start), at(start - 1), at(0)]
        if stop <= last:
            share = (seconds[start] - seconds[start - 1]) / (seconds[stop] - seconds[start - 1])
            found += [at(stop), led(at(start - 1), at(stop), share)]
        if start >= 2:
            share = (seconds[start] - seconds[start - 1]) / (seconds[start - 1] - seconds[start - 2])
            found.append(led(at(start - 2), at(start - 1), 1 + share))
        if stop + 1 <= last:
            share = (seconds[stop] - seconds[start]) / (seconds[stop + 1] - seconds[stop])
            found.append(led(at(stop + 1), at(stop), 1 + share))
        kept: list[Pose] = []
        for pose in found:
            if all(self._apart(pose, other) > APART * self.size for other in kept):
                kept.append(pose)
        return kept

    def _spins(self, pose: Pose) -> list[Pose]:
        """A pose turned about each of the world's axes."""
        return [(turned(pose[0], angle * axis), pose[1]) for s in SPINS for angle in (-s, s) for axis in np.eye(3)]

    def _apart(self, a: Pose, b: Pose) -> float:
        """How far two poses are apart, scene units."""
        cosine = min(1.0, abs(float(a[0] @ b[0])))
        return float(np.linalg.norm(a[1] - b[1])) + self.size * 2 * float(np.arccos(cosine))

    def errors(self, t: int, choices: Sequence[Pose]) -> tuple[F64, int]:
        """`[M]` squared difference of the rendered to the taken pictures of a time with the body at poses, all in the
        same parts of the same pictures; and how many pixels these have."""
        return self._compared(t, [Body(self.pivot, q[None], o[None]).placed(0, *self._own[:2]) for q, o in choices])

    def errors_of(self, t: int, bodies: Sequence[Placed]) -> tuple[F64, int]:
        """As `errors`, with the Gaussians where bodies have them at the time."""
        return self._compared(t, [body.placed(t, *self._own[:2]) for body in bodies])

    def _compared(self, t: int, placed: Sequence[tuple[F32, F32]]) -> tuple[F64, int]:
        """As `errors`, with the Gaussians at means and quaternions."""
        self._check()
        found, pixels = np.zeros(len(placed)), 0
        for view in self._views(np.concatenate([means for means, _ in placed]), t, 0.0):
            pixels += view.photo.shape[0] * view.photo.shape[1]
            for k, (means, quats) in enumerate(placed):
                drawn = gradient.draw(_joined(view.rest, (means, quats, *self._own[2:])), view.camera, BLACK)
                found[k] += float((unlike(drawn, view.photo) ** 2).sum())
        return found, pixels

    def without_moving(self, t: int, body: Body) -> float:
        """Squared difference at a time, as in `errors`, with the body at its first pose and without the known ones."""
        kept, self.moving = self.moving, []
        errors, _ = self.errors(t, [(body.quats[0], body.offsets[0])])
        self.moving = kept
        return float(errors[0])

    def pull(self, body: Body, t: int, views: Sequence[View]) -> tuple[float, F64]:
        """Squared difference in some pictures of a time, and its gradient by displacements `[n, 3]` of the body's
        Gaussians before it is placed."""
        self._check()
        means, quats = body.placed(t, *self._own[:2])
        value, slope = 0.0, np.zeros(means.shape)
        for view in views:
            off, found = self._found(view, means, quats)
            value, slope = value + off, slope + found.means[len(view.rest[0]) :]
        return value, slope @ keys.matrices(body.quats[t])

    def views(self, body: Body, t: int) -> list[View]:
        """The pictures around the body at a time, those that show it largest."""
        return self._views(body.placed(t, *self._own[:2])[0], t, 0.0)

    def rests(self, body: Body, t: int, since: int) -> bool:
        """Whether nothing changed around the body since a time at which it was as it is at the other."""
        here = body.placed(t, *self._own[:2])
        views = self._views(here[0], t, 0.0)
        return not views or self._rests(t, since, views, here)

    def area(self, body: Body, t: int) -> int:
        """Pixels at which the body makes a difference at a time, in the pictures that show it largest."""
        placed = body.placed(t, *self._own[:2])
        return sum(int(self._made(view, *placed)[2].sum()) for view in self.views(body, t))

    @property
    def means(self) -> F32:
        """`[n, 3]` of its Gaussians at the first time."""
        return self._own[0]

    def slope(self, body: Body, t: int) -> tuple[F64, F64]:
        """Gradient of the squared difference at a time by a further turn about the body's middle and by a shift."""
        turn, shift = np.zeros(3), np.zeros(3)
        means, quats = body.placed(t, self._own[0], self._own[1])
        for view in self._views(means, t, 0.0):
            _, by_turn, by_shift = self._slope(view, means, quats, body.pivot + body.offsets[t])
            turn, shift = turn + by_turn, shift + by_shift
        return turn, shift

    def known(self, body: Body, t: int) -> tuple[float, F64, F64]:
        """Squared difference at a time, its gradient `[6]` and Gauss-Newton matrix `[6, 6]` by a shift and by a further
        turn times the body's size."""
        self._check()
        value, slope, bend = 0.0, np.zeros(6), np.zeros((6, 6))
        pose, step = (body.quats[t], body.offsets[t]), DIFFERENCE * self.size
        poses = [pose]
        for axis in np.eye(3):
            poses += [(pose[0], pose[1] + sign * step * axis) for sign in (1, -1)]
        for axis in np.eye(3):
            poses += [(turned(pose[0], sign * step / self.size * axis), pose[1]) for sign in (1, -1)]
        placed = [Body(self.pivot, q[None], o[None]).placed(0, self._own[0], self._own[1]) for q, o in poses]
        for view in self._views(placed[0][0], t, 0.0):
            off = [
                unlike(gradient.draw(_joined(view.rest, (*p, *self._own[2:])), view.camera, BLACK), view.photo).reshape(
                    -1
                )
                for p in placed
            ]
            by = np.stack([(a - b) / (2 * step) for a, b in zip(off[1::2], off[2::2], strict=True)]).astype(np.float64)
            here = off[0].astype(np.float64)
            weight = np.minimum(1, CLIP / np.maximum(np.abs(here), 1e-9))
            value += float((weight * here**2).sum())
            slope += 2 * (by * weight) @ here
            bend += 2 * (by * weight) @ by.T
        return value, slope, bend

    def box(self, beyond: float) -> tuple[F64, F64, F64]:
        """The body's own axes `[3, 3]`, and from where to where it reaches along them from its middle; so large a share
        of its Gaussians is beyond at either side."""
        along = (self._own[0] - self.pivot) @ self._axes.T
        return self._axes.astype(np.float64), np.quantile(along, beyond, axis=0), np.quantile(along, 1 - beyond, axis=0)

    @property
    def seconds(self) -> F64:
        """`[T]` the times of the frames."""
        return self._footage.times

    # --- the search ----------------------------------------------------------------------------------------------

    def _elsewhere(self, body: Body, t: int, ratio: float) -> float:
        """Search the whole scene where the prediction was wrong; the better of both poses stays."""
        kept = body.quats[t].copy(), body.offsets[t].copy()
        body.offsets[t], body.quats[t] = body.offsets[t - 1], body.quats[t - 1]
        self._search(body, t, wide=True)
        self._refine(body, t)
        other = self.ratio(body, t)
        if other >= ratio:
            body.quats[t], body.offsets[t] = kept
        return min(ratio, other)

    def _search(self, body: Body, t: int, wide: bool) -> None:
        """Candidates around the predicted pose, drawn ever closer around the best."""
        mean, spread = np.zeros(6), np.r_[np.full(3, 0.6 * self.size), np.full(3, 0.25)]
        offset, quat = body.offsets[t].copy(), body.quats[t].copy()
        for k in range(ROUNDS):
            drawn = mean + spread * self._rng.standard_normal((CANDIDATES, 6))
            if not k:
                drawn[::2] += 2 * (drawn[::2] - mean)  # half of them three times as far away
            drawn[0] = mean
            if wide and k == 0:
                places = self._rng.uniform(self._low, self._high, (8 * CANDIDATES, 3))
                drawn = np.concatenate(
                    [places - self.pivot - offset, 0.5 * self._rng.standard_normal((8 * CANDIDATES, 3))], axis=1
                )
            if not k:
                stay = np.r_[body.offsets[t - 1] - offset, 0, 0, 0]
                drawn = np.concatenate([drawn, stay[None], self._turns])
            turns = np.stack([turned(quat, d[3:]) for d in drawn])
            scores = self.scores(turns, offset + drawn[:, :3], t, BLURS[0 if k < ROUNDS // 2 else 1])
            best = drawn[np.argsort(scores, kind="stable")[:ELITE]]
            mean, spread = best.mean(axis=0), best.std(axis=0) + 1e-6
            if wide and k == 0:  # places may be far apart: go on around the best
                mean, spread = best[0], np.r_[np.full(3, 0.6 * self.size), np.full(3, 0.4)]
        middle = turned(quat, mean[3:]), offset + mean[:3]
        nearest = turned(quat, best[0, 3:]), offset + best[0, :3]
        known = [(body.quats[k], body.offsets[k]) for k in (t - 1, 0)]
        choices = [middle, (quat, offset), nearest, *known]
        body.quats[t], body.offsets[t] = choices[int(self.errors(t, choices)[0].argmin())]

    def scores(self, turns: F64, offsets: F64, t: int, blur: float) -> F64:
        """`[M]` mean difference of colours of the body's points at poses, where cameras see them."""
        self._check()
        matrices = keys.matrices(turns)
        points = np.einsum("mij,nj->mni", matrices, self._points) + self.pivot + offsets[:, None, :]
        total, count = np.zeros(len(turns)), np.zeros(len(turns))
        flat = points.reshape(-1, 3)
        for c, camera in enumerate(self._footage.cameras):
            if (c, t) not in self._footage.frames:
                continue
            pixels, depth = camera.project(flat)
            inside = camera.contains(pixels, depth)
            x = np.clip(pixels[:, 0].astype(np.int64), 0, camera.width - 1)
            y = np.clip(pixels[:, 1].astype(np.int64), 0, camera.height - 1)
            seen = self._picture(self._footage.frames[c, t], blur)[y, x].reshape(len(turns), -1, 3)
            off = np.minimum(np.abs(seen - self._colors).mean(axis=2), CLIP)
            off = np.where(self._unchanged(c, t)[y, x].reshape(len(turns), -1), CLIP, off)
            own = inside.reshape(len(turns), -1)
            total += np.where(own, off, UNSEEN).sum(axis=1)
            count += own.shape[1]
        return np.asarray(total / np.maximum(count, 1))

    def _unchanged(self, c: int, t: int) -> NDArray[np.bool_]:
        """`[H, W]` where the body cannot be seen: pixels as they were at first, away from where it was then."""
        footage = self._footage
        key = (c, t)
        if key not in self._bare:
            if len(self._bare) > 64:
                self._bare.clear()
            camera = footage.cameras[c]
            pixels, depth = camera.project(self._own[0])
            x, y = pixels[camera.contains(pixels, depth)].astype(np.int64).T
            own = np.zeros((camera.height, camera.width), bool)
            own[y, x] = True
            changed = footage.moved(c, t)
            self._bare[key] = ~ndimage.binary_dilation(own, iterations=3) & ~ndimage.binary_dilation(
                changed, iterations=2
            )
        return self._bare[key]

    def _picture(self, frame: int, blur: float) -> F32:
        if (frame, blur) not in self._blurred:
            if len(self._blurred) > 64:
                self._blurred.clear()
            self._blurred[frame, blur] = ndimage.gaussian_filter(self._footage.shots[frame].colors, (blur, blur, 0))
        return self._blurred[frame, blur]

    # --- the refinement ------------------------------------------------------------------------------------------

    def _refine(self, body: Body, t: int, steps: int = STEPS) -> None:
        """Adam on the pose, by the squared difference of the rendered to the taken pictures."""
        self._check()
        views = self._views(body.placed(t, self._own[0], self._own[1])[0], t, 0.0)
        if not views:
            return
        first, second, best = np.zeros(6), np.zeros(6), (np.inf, body.quats[t], body.offsets[t])
        for k in range(1, steps + 1):
            slope, loss = np.zeros(6), 0.0
            means, quats = body.placed(t, self._own[0], self._own[1])
            for view in views:
                value, turn, shift = self._slope(view, means, quats, body.pivot + body.offsets[t])
                slope, loss = slope + np.r_[shift, turn / self.size], loss + value
            if loss < best[0]:
                best = (loss, body.quats[t].copy(), body.offsets[t].copy())
            first, second = 0.7 * first + 0.3 * slope, 0.9 * second + 0.1 * slope**2
            rate = 0.06 * self.size * 0.12 ** ((k - 1) / steps)
            move = rate * first / (1 - 0.7**k) / (np.sqrt(second / (1 - 0.9**k)) + 1e-12)
            body.offsets[t] -= move[:3]
            body.quats[t] = turned(body.quats[t], -move[3:] / self.size)
        _, body.quats[t], body.offsets[t] = best

    def _slope(self, view: View, means: F32, quats: F32, centre: F64) -> tuple[float, F64, F64]:
        """Squared difference in a picture, and its gradient by a further turn and a shift."""
        value, found = self._found(view, means, quats)
        start = len(view.rest[0])
        turn, shift = pose_gradient(means, quats, centre, found.means[start:], found.quats[start:])
        return value, turn, shift

    def _found(self, view: View, means: F32, quats: F32) -> tuple[float, gradient.Gradients]:
        """Squared difference in a picture, and its gradient by what stands still and by the body, in this order."""
        columns = _joined(view.rest, (means, quats, *self._own[2:]))
        drawn = gradient.draw(columns, view.camera, BLACK)
        off = unlike(drawn, view.photo)
        found = gradient.draw_backward(drawn, 2 * off, -2 * (off * view.photo).sum(axis=2))
        return float((off**2).sum()), found

    def _views(self, means: F32, t: int, ahead: float) -> list[View]:
        """The pictures around means at a time, those that show them largest; and what else is in them.

        Args:
            ahead: scene units that the body may have gone from there.
        """
        found: list[tuple[float, int, tuple[int, int, int, int]]] = []
        for c, camera in enumerate(self._footage.cameras):
            if (c, t) not in self._footage.frames:
                continue
            pixels, depth = camera.project(means)
            if not ((depth > 0.05) & camera.contains(pixels, depth)).mean() > 0.3:
                continue
            moves = ahead * camera.fx / max(float(np.median(depth)), 1e-6)
            reach = MARGIN + min(0.5 * moves, 30.0)
            low = np.floor(np.clip(pixels[depth > 0.05].min(axis=0) - reach, 0, None)).astype(np.int64)
            high = np.ceil(pixels[depth > 0.05].max(axis=0) + reach).astype(np.int64)
            high = np.minimum(high, [camera.width, camera.height])
            if (high - low).min() >= 4:
                area = float(np.prod(np.ptp(pixels[depth > 0.05], axis=0)))
                found.append((-area, c, (int(low[0]), int(low[1]), int(high[0]), int(high[1]))))
        return [self._view(c, t, window) for _, c, window in sorted(found)[:VIEWS]]

    def _view(self, c: int, t: int, window: tuple[int, int, int, int]) -> View:
        x0, y0, x1, y1 = (int(v) for v in window)
        camera = self._footage.cameras[c]
        pixels, reach, depth = self._near[c]
        inside = (depth > 0) & (pixels > np.array([x0, y0]) - reach[:, None]).all(axis=1)
        inside &= (pixels < np.array([x1, y1]) + reach[:, None]).all(axis=1)
        part = replace(camera, cx=camera.cx - x0, cy=camera.cy - y0, width=x1 - x0, height=y1 - y0)
        rest: Columns = tuple(np.ascontiguousarray(col[inside]) for col in self._rest)  # type: ignore[assignment]
        for own, body in self.moving:
            rest = _joined(rest, (*body.placed(t, own[0], own[1]), *own[2:]))
        photo = self._footage.shots[self._footage.frames[c, t]].colors[y0:y1, x0:x1]
        return View(c, part, rest, np.ascontiguousarray(photo), (x0, y0, x1, y1))

    def _rests(self, t: int, since: int, views: Sequence[View], here: tuple[F32, F32]) -> bool:
        """Whether nothing changed around a body since a time: to the frames of then, or, of a camera that moves, to
        what it would see with the body `here` (means and quaternions)."""
        changed = area = 0
        if self._footage.at_first:
            for view in views:
                seen, _, matters = self._made(view, *here)
                off = differs(rounded(seen), rounded(view.photo))
                changed, area = changed + int(off.sum()), area + int(matters.sum())
            return area > 0 and changed <= STILL_DRAWN * area
        for view in views:
            before = self._footage.frames.get((view.number, since))
            if before is None:
                return False
            x0, y0, x1, y1 = view.window
            off = self._footage.changed(self._footage.frames[view.number, t], before)[y0:y1, x0:x1]
            changed, area = changed + int(off.sum()), area + off.size
        return changed <= STILL * area

    def _made(self, view: View, means: F32, quats: F32) -> tuple[F32, F32, NDArray[np.bool_]]:
        """A picture `[H, W, 3]` with the body and without it, and where that makes a difference."""
        both = _joined(view.rest, (means, quats, *self._own[2:]))
        seen, bare = (gradient.draw(columns, view.camera, BLACK).rgb for columns in (both, view.rest))
        return seen, bare, np.asarray(np.abs(seen - bare).max(axis=2) > MATTERS)

    def ratio(self, body: Body, t: int) -> float:
        """The difference to the pictures with the body, over that without it, where the body makes a difference."""
        with_it = without = 1e-6
        means, quats = body.placed(t, self._own[0], self._own[1])
        for view in self._views(means, t, 0.0):
            seen, bare, matters = self._made(view, means, quats)
            with_it += float(((seen - view.photo) ** 2)[matters].sum())
            without += float(((bare - view.photo) ** 2)[matters].sum())
        return with_it / without


@dataclass(frozen=True, eq=False)
class View:
    """A picture around a body: which camera took it, the camera of the cropped picture, what stands still in it."""

    number: int
    camera: Camera
    rest: Columns
    photo: F32
    window: tuple[int, int, int, int]


def _joined(a: Columns, b: Columns) -> Columns:
    """The columns of two sets of Gaussians."""
    return tuple(np.concatenate([x, y]) for x, y in zip(a, b, strict=True))  # type: ignore[return-value]


def unlike(drawn: gradient.Drawn, photo: F32) -> F32:
    """`[H, W, 3]` difference of a render to a picture. What shows through where nothing is drawn counts as right: what
    was hidden at the start is not known yet, and a body must not gain by covering it."""
    return np.asarray(drawn.rgb - drawn.alpha[..., None] * photo, dtype=np.float32)


def led(a: Pose, b: Pose, share: float) -> Pose:
    """The pose on the way from one to another: 0 is the first, 1 the second, more is beyond it."""
    step = turn_between(a[0], b[0])
    return turned(a[0], share * step), a[1] + share * (b[1] - a[1])


def _seen(columns: Columns, camera: Camera) -> tuple[F64, F64, F64]:
    """Pixels `[N, 2]` of Gaussians, their reach in pixels `[N]`, and depth `[N]`."""
    pixels, depth = camera.project(columns[0])
    reach = 3 * columns[2].max(axis=1) * camera.fx / np.maximum(depth, 1e-3)
    return pixels, np.minimum(reach, 1e4), depth


def turn_between(a: F64, b: F64) -> F64:
    """The rotation vector `[3]` from one unit quaternion to another, world frame."""
    q = multiplied(b, a * [1, -1, -1, -1])
    w, v = (q[0], q[1:]) if q[0] >= 0 else (-q[0], -q[1:])
    length = float(np.linalg.norm(v))
    return np.asarray(2 * np.arctan2(length, w) / length * v if length > 1e-12 else np.zeros(3))
