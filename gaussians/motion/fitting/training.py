"""Training of all Gaussians and all poses together, on frames of every time (`Joint`)."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...fit.densify import Strategy
from ...fit.loss import BLACK, photometric
from ...fit.parameters import parameter_gradients
from ...fit.train import LR_DECAY, MEANS_LR, REFINE_EVERY, morton_order
from ...render.cpu import gradient
from .. import keys
from .bends import Bend
from .bodies import Body, Labelled, left, placed, pose_gradient, put_at, turned
from .footage import Footage

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

SSIM = 0.2
OFFSETS_LR = 8e-4  # of poses, of the radius of the cameras; a turn moves the Gaussians of a body as far
POSES_DECAY = 0.1  # that rate at the end: a pose is trained by the frames of its time alone, in few steps
LINE_LR = 0.3  # of a line's pivot and axis, of those of poses: they step at every frame
SHAPE = 0.004  # of the radius of the cameras: how far the nodes of what bends may be from where they were found
WAYS_LR = 0.3  # of the ways of these nodes, of that of poses: they step at every frame
TOGETHER = 0.002  # how far a node of what bends is drawn towards its neighbours at each step
GROWS_UNTIL = 0.7  # share of the training after which no Gaussians are added
WARM = 0.35  # the learning rate of means at the start, of that of a training from nothing


@dataclass(eq=False)
class _Moments:
    """Adam's moments of rows of numbers: the six of each pose, or the value of each time, and the six of a line as the
    last row; or the displacements of the nodes of each time."""

    first: F64
    second: F64
    steps: NDArray[np.int64]

    @classmethod
    def none(cls, rows: int, width: int) -> _Moments:
        """No steps yet."""
        return cls(np.zeros((rows, width)), np.zeros((rows, width)), np.zeros(rows, np.int64))

    def direction(self, row: int, slope: F64) -> F64:
        """The direction of a step of a row by its gradient."""
        self.steps[row] += 1
        self.first[row] = 0.9 * self.first[row] + 0.1 * slope
        self.second[row] = 0.99 * self.second[row] + 0.01 * slope**2
        n = int(self.steps[row])
        return np.asarray(self.first[row] / (1 - 0.9**n) / (np.sqrt(self.second[row] / (1 - 0.99**n)) + 1e-15))


@dataclass(eq=False)
class _Shapes:
    """Displacements of the nodes of a body that bends, as a product of low rank: what a frame tells of a way counts for
    all times.

    Attributes:
        basis, ways: see `Bend.factors`; the basis is 0 at the first time.
        of_times, of_ways: Adam's moments.
    """

    basis: F64
    ways: F64
    of_times: _Moments
    of_ways: _Moments

    @classmethod
    def of(cls, bend: Bend, tolerance: float) -> _Shapes:
        """The displacements of a bend within a tolerance, scene units."""
        basis, ways = bend.factors(tolerance)
        return cls(basis, ways, _Moments.none(len(basis), basis.shape[1]), _Moments.none(1, ways.size))

    def step(self, bend: Bend, times: slice, slope: F64, far: float) -> None:
        """A step at some times by the gradient of the displacements of the nodes `[K, 3]` then.

        Args:
            bend: whose nodes they are.
            far: of the step, scene units.
        """
        now = self.basis[times.start]
        by_basis = np.einsum("bkc,kc->b", self.ways, slope)
        by_ways = now[:, None, None] * slope
        sizes = np.maximum(np.sqrt((self.ways**2).sum(axis=2).mean(axis=1)), 1e-9)
        self.basis[times] = now - far / sizes * self.of_times.direction(times.start, by_basis)
        ways = self.ways - WAYS_LR * far * self.of_ways.direction(0, by_ways.reshape(-1)).reshape(self.ways.shape)
        self.ways = np.stack([bend.together(way, TOGETHER) for way in ways]) if len(ways) else ways

    @property
    def moves(self) -> F64:
        """`[T, K, 3]` displacements of the nodes."""
        return np.einsum("tb,bkc->tkc", self.basis, self.ways)


class Joint:
    """A training in progress.

    Args:
        parameters: changed in place.
        bodies: changed in place; those of label 1, 2, ...
        footage: frames to train on.
        strategy: densifies and prunes.
        rng: draws the order of frames.
    """

    def __init__(
        self, parameters: Labelled, bodies: list[Body], footage: Footage, strategy: Strategy, rng: np.random.Generator
    ) -> None:  # fmt: skip
        self.parameters, self.bodies, self._footage, self._rng = parameters, bodies, footage, rng
        self._strategy = strategy
        self._moments = [_Moments.none(len(footage.times) + 1, 6) for _ in bodies]
        self._shapes = [None if body.bend is None else _Shapes.of(body.bend, SHAPE * footage.radius) for body in bodies]
        self._poses = [body.bend is None or bool(np.any(body.offsets) or np.any(body.quats[:, 1:])) for body in bodies]
        self._runs = [{t: run for run in body.runs for t in range(*run)} for body in bodies]
        self._order: list[int] = []
        self.steps, self.seconds = 0, 0.0

    def step(self, progress: float) -> float:
        """Train on one frame; returns its loss.

        Args:
            progress: completed share of the training, in [0, 1].
        """
        started = time.perf_counter()
        if not self._order:
            self._order = self._rng.permutation(len(self._footage.shots)).tolist()
        frame = self._order.pop()
        shot, t = self._footage.shots[frame], int(self._footage.when[frame])
        parameters = self.parameters
        columns = placed(parameters.columns(), parameters.labels, self.bodies, t)
        drawn = gradient.draw(columns, shot.camera, BLACK)
        loss, slope = photometric(drawn.rgb, shot.colors, SSIM)
        found = gradient.draw_backward(drawn, slope, np.zeros(slope.shape[:2], np.float32))
        rate = WARM * LR_DECAY**progress
        self._pull_back(columns, found, t, OFFSETS_LR * self._footage.radius * POSES_DECAY**progress)
        gradients = parameter_gradients(found, columns[2], columns[3])
        self._strategy.regularise(gradients, columns[2], columns[3])
        means_lr = MEANS_LR * self._footage.radius * rate
        parameters.step(gradients, means_lr)
        self._strategy.after_step(parameters, found.centers, (shot.camera.width, shot.camera.height), means_lr)
        self.steps += 1
        if self.steps % REFINE_EVERY == 0 and progress < GROWS_UNTIL:
            self._strategy.refine(parameters, self.steps)
            parameters.take(morton_order(parameters.means))
        self.seconds += time.perf_counter() - started
        return loss

    def settle(self) -> None:
        """Let bodies be where they are at the first time, which training shifts as it does any other time."""
        for number, (body, shapes) in enumerate(zip(self.bodies, self._shapes, strict=True), 1):
            put_at(self.parameters, number, body, 0)
            self.bodies[number - 1] = body.started_at(0)
            if shapes is not None:  # displacements turn with the body
                shapes.ways = shapes.ways @ keys.matrices(body.quats[0]).T

    def _pull_back(
        self, columns: tuple[NDArray[np.float32], ...], found: gradient.Gradients, t: int, far: float
    ) -> None:
        """Step the poses of this time by `far` (scene units), and turn the gradients of bodies back to the start."""
        for number, body in enumerate(self.bodies, 1):
            rows = np.flatnonzero(self.parameters.labels == number)
            if not len(rows):
                continue
            d_means, d_quats = found.means[rows], found.quats[rows]
            if np.any(d_means):
                centre = body.pivot + body.offsets[t]
                turn, shift = pose_gradient(columns[0][rows], columns[1][rows], centre, d_means, d_quats)
                reach = float(np.sqrt(((columns[0][rows] - centre) ** 2).sum(axis=1).mean()))
                if self._poses[number - 1]:
                    self._step_pose(number - 1, t, turn, shift, far, far / max(reach, 1e-9))
            matrix = keys.matrices(body.quats[t])
            found.means[rows] = (d_means @ matrix).astype(np.float32)
            if np.any(d_means):
                self._step_shape(number - 1, t, rows, found.means[rows], far)
            found.quats[rows] = (d_quats @ left(body.quats[t])).astype(np.float32)

    def _step_shape(self, number: int, t: int, rows: I64, by_mean: NDArray[np.float32], far: float) -> None:
        """A step of the displacements of a body that bends at a time, by the gradient `[n, 3]` of its displaced means.

        The shape is the same at all times of a rest, and that of the first time stays.
        """
        body, shapes, run = self.bodies[number], self._shapes[number], slice(*self._runs[number][t])
        if body.bend is None or shapes is None or not run.start:
            return
        slope = body.bend.shares(self.parameters.means[rows]).T @ by_mean
        shapes.step(body.bend, run, slope.astype(np.float64), far)
        self.bodies[number] = replace(body, bend=replace(body.bend, moves=shapes.moves))

    def _step_pose(self, number: int, t: int, turn: F64, shift: F64, far: float, wide: float) -> None:
        """A step of the pose of a body at a time by its gradient, or of its place on its line and of the line.

        The pose is the same at all times of a rest.

        Args:
            turn, shift: the gradient by a further turn and a further shift.
            far, wide: of the step, scene units and radians.
        """
        body, moments = self.bodies[number], self._moments[number]
        run = slice(*self._runs[number][t])
        if body.line is None:
            move = moments.direction(run.start, np.r_[shift, turn])
            body.offsets[run] -= far * move[:3]
            body.quats[run] = turned(body.quats[run.start], -wide * move[3:])
            return
        value, pivot, axis = body.line.gradient(t, body.pivot + body.offsets[t], turn, shift)
        unit = wide if body.line.kind == "hinge" else far
        move = unit * moments.direction(run.start, np.r_[value, np.zeros(5)])
        tilt = np.zeros(6)
        if run.start:  # where it is at the first time tells nothing of its line
            tilt = LINE_LR * moments.direction(len(self._footage.times), np.r_[pivot, axis])
        self.bodies[number] = body.on(body.line.stepped(run, -float(move[0]), -far * tilt[:3], -wide * tilt[3:]))
