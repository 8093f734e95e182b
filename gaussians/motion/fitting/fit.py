"""Fit a scene with time to posed frames (`fit_film`).

```
first frames ─stereo─► start ─changes─► seeds ─track─► bodies ─train all together─► few keys ─► scene with motion
```

The scene at its start is trained first. Of its Gaussians those may move whose pixels change wherever they are seen;
what touches and goes at one time is one body. A body is kept if a path of it explains the frames. Then all Gaussians
and all poses are trained together on the frames of every time.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import NO_GROUP, GaussianCloud
from ...fit.fitting import Settings, Status
from ...fit.parameters import Parameters
from ...fit.photographs.photos import Photos
from ...fit.quality import Quality, measure
from ...fit.train import Schedule, Shot
from ...scene import Scene
from ..at import at
from ..motion import Motion, Residual, Track
from .axes import line_of, _judged as judged
from .bodies import Body, Columns, Labelled
from .agreement import MARKS, SSIM, Agreement
from .footage import Footage
from .resting import Ends
from .rolling import rolled
from .seeds import LEAST, Flags, gone, halves, seeds
from .sharing import shared
from .simplify import track_of
from .smoothing import smoothed
from .start import ROOM, start_cloud, trainer
from .supposing import supposed
from .tracking import Tracker
from .training import Joint, Single

F64 = NDArray[np.float64]
Detail = Literal["static", "rigid", "residual"]  # the motion that may be fitted: none, paths, and single Gaussians' too

START = 0.3  # share of the training that goes to the scene at its start
LASTING = 0.3  # share of the training that goes to what a moving camera sees for most of the time
ROUND = 0.35  # of that, the length of each training of what rests at an end
EXPLAINS = 0.7  # of the difference without a body, to which its path must bring the pictures
MOST_BODIES = 12
ALIKE = 0.01  # of the radius of the cameras: bodies whose paths differ by less, on average, are one
TOLERANCE = 0.004  # of the radius of the cameras: how far the track may be from the poses at the frames
AS_WELL = 1.05  # times the difference with its own path, up to which a body follows another, or stands still
AS_WELL_ALONE = 1.5  # the same of one camera, before which a free path explains much that it should not
TOGETHER = 0.6  # of the difference standing still, below which a body follows another without a search of its own
RIGHT = 0.05  # root mean square difference of colours up to which what stands still is taken to be covered meanwhile
SORTED = 10  # times at which that is measured
SETTLED = 1  # rounds in which paths are mended and Gaussians assigned to bodies
MORE = 1.2  # times the Gaussians of the start: greatest number at the end, for what was hidden at the start
SINGLE = 0.15  # of the steps of all together, that displacements of single Gaussians are trained for
GAIN = 0.05  # dB on held-out frames, for which displacements of single Gaussians are kept
REPORT_EVERY = 0.5  # seconds


@dataclass(frozen=True, eq=False)
class FittedFilm:
    """A fitted scene with time.

    Attributes:
        scene: with `motion` if something moves; the group of a Gaussian is the number of its track, from 0 on.
        quality: on held-out frames, each at its time.
        steps, seconds: of the training.
        tried: how many bodies were tracked; those that no path explained stand still.
    """

    scene: Scene
    quality: Quality
    steps: int
    seconds: float
    tried: int


def fit_film(
    photos: Photos,
    settings: Settings | None = None,
    *,
    detail: Detail = "residual",
    on_status: Callable[[Status], None] = lambda status: None,
) -> FittedFilm:
    """Fit a scene with time to frames whose `Shot.time` differ.

    Args:
        settings: of the length, the greatest number of Gaussians and the seed; degree 0 only. Default: five minutes.
        detail: the motion that is fitted at most; residuals only where they improve held-out frames.

    Raises:
        UserError: a frame has no time or all have one; or the cameras do not stand.
    """
    settings = settings or Settings(seconds=300.0)
    return _Film(photos, settings, detail, on_status).fit()


def stands(photos: Photos) -> bool:
    """Whether the frames of a film are of cameras that stand, so that what moves can be fitted."""
    return Footage.of(photos.shots, [s.time for s in photos.shots]).stands


class _Film:
    """A fit in progress."""

    def __init__(
        self, photos: Photos, settings: Settings, detail: Detail, on_status: Callable[[Status], None]
    ) -> None:  # fmt: skip
        self._photos, self._settings, self._detail, self._on_status = photos, settings, detail, on_status
        self._footage = Footage.of(photos.shots, [s.time for s in photos.shots])
        self._rng = np.random.default_rng(settings.seed)
        self._started, self._told, self._loss, self._before = time.perf_counter(), 0.0, math.nan, 0

    def fit(self) -> FittedFilm:
        """All steps."""
        footage, settings = self._footage, self._settings
        labelled, bodies, tried, before = self._of_standing() if footage.stands else self._of_moving()
        budget = min(settings.max_gaussians, int(MORE * len(labelled)))
        joint = Joint(labelled, bodies, footage, budget, self._rng)
        left = None if settings.seconds is None else max(0.2 * settings.seconds, settings.seconds - self._seconds)
        more = None if settings.steps is None else settings.steps - before
        while (share := _share(joint, more, left)) < 1:
            self._tell(joint.step(share), before + joint.steps, START + (1 - START) * share, len(labelled))
        scene, steps = self._scene(labelled, bodies, None), before + joint.steps
        if self._detail == "residual" and scene.motion is not None and self._photos.held_out:
            scene, more = self._with_single(scene, labelled, bodies, round(SINGLE * joint.steps))
            steps += more
        return FittedFilm(scene, measure_film(scene, self._photos.held_out), steps, self._seconds, tried)

    def _of_standing(self) -> tuple[Labelled, list[Body], int, int]:
        """What moves before cameras that stand, its paths, how many were tried, and the steps of the training."""
        settings = self._settings
        steps = settings.steps and max(1, round(START * settings.steps))
        schedule = Schedule(steps, settings.seconds and START * settings.seconds, settings.coarse)
        start = trainer(self._footage, self._photos, settings.max_gaussians, schedule, self._rng)
        while start.progress < 1:
            self._tell(start.step(), start.steps, START * start.progress, len(start.parameters))
        return *self._bodies(start.parameters), start.steps

    def _of_moving(self) -> tuple[Labelled, list[Body], int, int]:
        """The same before a camera that moves: the film is followed from the end at which more rests."""
        whole, footage = self._lasting(), self._footage
        lasting, round_ = whole.parameters, max(1, round(ROUND * whole.steps))
        still = Labelled.labelled(lasting, np.zeros(len(lasting), np.int32))
        if self._detail == "static":
            return still, [], 0, whole.steps
        ends = Ends(lasting, footage, self._photos.extent, round_, self._rng, self._tell_start)
        resting = ends.best()
        steps = whole.steps + ends.steps
        self._footage = resting.footage
        labelled, bodies, tried = self._bodies(resting.parameters)
        self._footage = footage
        if not bodies:
            return still, [], tried, steps
        if resting.backwards:
            _turn_around(labelled, bodies)
        return labelled, bodies, tried, steps

    def _lasting(self) -> Agreement:
        """A training on what is there for most of the time, completed."""
        settings, shots, photos = self._settings, self._footage.shots, self._photos
        cloud = start_cloud(shots, photos, settings.max_gaussians, self._rng)
        training = Agreement(shots, Parameters.of(cloud), int(ROOM * len(cloud)) + 1, photos.extent, self._rng)
        steps = settings.steps and max(1, round(LASTING * settings.steps))
        started, share, marks = time.perf_counter(), 0.0, list(MARKS)
        while share < 1:
            if marks and share >= marks[0][0]:
                training.leave_out(range(len(shots)), marks.pop(0)[1])
            self._tell_start(training.step(share, SSIM if len(marks) < len(MARKS) else 0.0), len(cloud))
            gone = time.perf_counter() - started
            share = training.steps / steps if steps else gone / (LASTING * (settings.seconds or 1.0))
        return training

    def _tell_start(self, loss: float, gaussians: int) -> None:
        """Report progress of a training before that of all together."""
        self._before += 1
        settings = self._settings
        share = self._before / settings.steps if settings.steps else self._seconds / (settings.seconds or 1.0)
        self._tell(loss, self._before, min(share, START), gaussians)

    def _with_single(
        self, scene: Scene, labelled: Labelled, bodies: list[Body], steps: int
    ) -> tuple[Scene, int]:  # fmt: skip
        """The scene with displacements of single Gaussians if held-out frames gain by them, and the steps it took."""
        single = Single.none(np.flatnonzero(labelled.labels > 0), self._footage.times)
        copy = Labelled.labelled(Parameters.load(deepcopy(labelled.state())), labelled.labels.copy())
        joint = Joint(copy, bodies, self._footage, len(copy), self._rng, single)
        while joint.steps < steps:
            joint.step(1.0)
        finer = self._scene(copy, bodies, single)
        before, after = (measure_film(s, self._photos.held_out).psnr for s in (self._scene(copy, bodies, None), finer))
        return (finer if after - before >= GAIN else scene), steps

    @property
    def _seconds(self) -> float:
        return time.perf_counter() - self._started

    def _bodies(self, start: Parameters) -> tuple[Labelled, list[Body], int]:
        """What moves, by the number of its label, and its path."""
        columns, footage = start.columns(), self._footage
        if self._detail == "static":
            return Labelled.labelled(start, np.zeros(len(start), np.int32)), [], 0
        labels, bodies, tried = self._found(columns, gone(columns, footage))
        labelled = Labelled.labelled(start, labels)
        if not bodies:
            return labelled, bodies, tried
        self._sort_out(labelled, bodies)
        for _ in range(SETTLED):
            self._follow(labelled, bodies)
            self._settle(labelled, bodies)
        self._sort_out(labelled, bodies)
        self._follow(labelled, bodies)
        return labelled, bodies, tried

    def _found(self, columns: Columns, flags: Flags) -> tuple[NDArray[np.int32], list[Body], int]:
        """Labels `[N]` of the seeds that a path explains, the paths, and how many were tried."""
        footage, found = self._footage, list[tuple[NDArray[np.int64], Body]]()
        queue = seeds(columns, footage, flags)[:MOST_BODIES]
        still, tried = np.ones(len(flags), bool), 0
        for rows in queue:
            still[rows] = False
        while queue:
            rows = queue.pop(0)
            self._tell(math.nan, 0, START, len(flags))
            tracker = Tracker(columns, rows, still, footage, self._settings.seed + tried, found)
            if _covered(tracker, np.flatnonzero(flags[rows].any(axis=0))):
                continue
            if (path := _goes_with(tracker, [body for _, body in found])) is not None:
                found.append((rows, path))
                continue
            path = self._path(tracker)
            tried += 1
            if path is not None:
                found.append((rows, path))
            elif tried < 2 * MOST_BODIES and not footage.at_first:
                queue = [*queue, *halves(rows, flags)]
        labels, bodies = np.zeros(len(flags), np.int32), list[Body]()
        for rows, body in found:
            same = next((k for k, b in enumerate(bodies) if _alike(b, body, columns[0][rows], footage.radius)), None)
            if same is None:
                same = len(bodies)
                bodies.append(body)
            labels[rows] = same + 1
        return labels, bodies, tried

    def _path(self, tracker: Tracker) -> Body | None:
        """A path that explains a body, if there is one."""
        tracked, footage = tracker.track(), self._footage
        if not footage.at_first:
            return tracked.body if tracked.gain < EXPLAINS else None
        still = Body.at_rest(tracker.pivot, len(footage.times))
        free, on = smoothed(tracker, tracked.body, footage.radius), supposed(tracker, len(footage.times))
        e=[tracker.errors(t,[(b.quats[t],b.offsets[t]) for b in (tracked.body,free,on,still)])[0] for t in range(1,len(footage.times))]
        assert on.line is not None
        bound, enough = judged(tracker, free, on.line, free.runs[1:])
        print("tracked", len(tracker._own[0]), tracked.gain, on.line.kind, on.line.axis.round(2),on.line.pivot.round(2), on.line.values.round(2).tolist(), "errors", np.sum(e,axis=0).round(1), enough)
        best = on if enough else free
        errors = np.sum([tracker.errors(t, [(b.quats[t], b.offsets[t]) for b in (best, still)])[0] for t in range(1, len(footage.times))], axis=0)
        return best if errors[0] * AS_WELL_ALONE < errors[1] else None

    def _follow(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Mend the path of each body, put it on one axis where the frames tell no more, or let it roll; in place."""
        for k in range(len(bodies)):
            tracker = self._tracker(labelled, bodies, k + 1)
            body = bodies[k].seen_from(tracker.pivot)
            if not self._footage.stands and body.line is None:
                body = smoothed(tracker, body, self._footage.radius)
            line = line_of(tracker, body)
            if line is None:
                tracker.mend(body)
                body = rolled(tracker, body) or body
            bodies[k] = body if line is None else body.on(line)

    def _sort_out(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Let a body stand still, or join another, where that explains the frames about as well as its own path while
        the others go theirs: what something passed before stands, and fragments of a thing are one; in place."""
        for number in sorted(range(1, len(bodies) + 1), key=lambda k: int((labelled.labels == k).sum())):
            tracker = self._tracker(labelled, bodies, number)
            own = bodies[number - 1].seen_from(tracker.pivot)
            others = [k for k in range(1, len(bodies) + 1) if k != number and (labelled.labels == k).any()]
            paths = [
                own,
                Body.at_rest(own.pivot, len(own.offsets)),
                *(bodies[k - 1].seen_from(own.pivot) for k in others),
            ]
            some = _some(sorted({t for path in paths for t, _ in path.runs[1:]}))
            errors = np.sum([tracker.errors(t, [(p.quats[t], p.offsets[t]) for p in paths])[0] for t in some], axis=0)
            best = int(errors[1:].argmin())
            print("sort", number, (labelled.labels == number).sum(), np.round(errors, 1))
            if errors[1 + best] <= (AS_WELL_ALONE if self._footage.at_first else AS_WELL) * errors[0]:
                labelled.labels[labelled.labels == number] = others[best - 1] if best else 0
        self._renumber(labelled, bodies, labelled.labels)

    def _settle(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Assign Gaussians to bodies by the frames, in place; a body that keeps too few is dropped."""
        labels = shared(labelled.columns(), labelled.labels, bodies, self._footage, self._rng)
        self._renumber(labelled, bodies, labels)

    def _renumber(self, labelled: Labelled, bodies: list[Body], labels: NDArray[np.int32]) -> None:
        """Take over labels, without bodies that have too few Gaussians; in place."""
        kept = [k for k in range(1, len(bodies) + 1) if (labels == k).sum() >= LEAST]
        number = np.zeros(len(bodies) + 1, np.int32)
        number[kept] = np.arange(1, len(kept) + 1)
        labelled.labels, bodies[:] = number[labels], [bodies[k - 1] for k in kept]

    def _tracker(self, labelled: Labelled, bodies: list[Body], number: int) -> Tracker:
        """For the path of a body while the paths of the others are known."""
        labels = labelled.labels
        others = [(np.flatnonzero(labels == k), b) for k, b in enumerate(bodies, 1) if k != number]
        rows = np.flatnonzero(labels == number)
        return Tracker(labelled.columns(), rows, labels == 0, self._footage, self._settings.seed, others)

    def _scene(self, labelled: Labelled, bodies: Sequence[Body], single: Single | None) -> Scene:
        """The scene, rows by body, with tracks of few keys."""
        footage = self._footage
        order = np.argsort(labelled.labels, kind="stable")
        labels = labelled.labels[order]
        cloud = labelled.cloud()[torch.from_numpy(order)]
        cloud = cloud.replace(ids=torch.arange(len(cloud)))
        group = np.full(len(cloud), NO_GROUP, np.int32)
        tracks = list[Track]()
        for number, body in enumerate(bodies, 1):
            rows = np.flatnonzero(labels == number)
            if not len(rows):
                continue
            track = track_of(
                body, rows, footage.times, _size(cloud, rows), TOLERANCE * footage.radius, f"thing {number}"
            )  # fmt: skip
            if track is not None:
                group[rows] = len(tracks)
                tracks.append(track)
        cameras = tuple(sorted(footage.cameras, key=lambda camera: camera.name))
        scene = Scene(cloud.replace(group=torch.from_numpy(group)), cameras=cameras)
        if not tracks:
            return scene
        residuals: tuple[Residual, ...] = ()
        if single is not None:
            ids = np.argsort(order)[single.rows]  # where each row went
            by = np.argsort(ids)
            residuals = (Residual(ids[by], footage.times, single.basis, single.weights[by]),)
        first, last = float(footage.times[0]), float(footage.times[-1])
        return scene.replace(motion=Motion(tuple(tracks), (), residuals, first, last))

    def _tell(self, loss: float, steps: int, share: float, gaussians: int) -> None:
        """Report progress now and then."""
        if not math.isnan(loss):
            self._loss = loss if math.isnan(self._loss) else 0.95 * self._loss + 0.05 * loss
        now = self._seconds
        if now - self._told >= REPORT_EVERY:
            self._told = now
            left = now * (1 / max(share, 1e-9) - 1)
            self._on_status(Status(steps, min(share, 1.0), self._loss, math.nan, gaussians, left))


def _turn_around(labelled: Labelled, bodies: list[Body]) -> None:
    """Put bodies that were followed backwards where they are at the first time, and their paths the right way round; in
    place."""
    for number, body in enumerate(bodies, 1):
        rows, last = np.flatnonzero(labelled.labels == number), len(body.offsets) - 1
        labelled.means[rows], labelled.quats[rows] = body.placed(last, labelled.means[rows], labelled.quats[rows])
        bodies[number - 1] = body.started_at(last).backwards()


def _covered(tracker: Tracker, times: NDArray[np.int64]) -> bool:
    """Whether what stands still looks right at times at which it is gone, since known bodies pass before it."""
    if not tracker.moving:
        return False
    rest, some = Body.at_rest(tracker.pivot, 1), _some(times.tolist())
    each = [tracker.errors(t, [(rest.quats[0], rest.offsets[0])]) for t in some]
    known = sum(float(e[0]) for e, _ in each)
    return known < 3 * RIGHT**2 * sum(pixels for _, pixels in each)


def _goes_with(tracker: Tracker, paths: Sequence[Body]) -> Body | None:
    """The path of those that are known by which a body is explained much better than by standing still."""
    best: tuple[float, Body | None] = (TOGETHER, None)
    for path in paths:
        body = path.seen_from(tracker.pivot)
        rest = body.quats[0], body.offsets[0]
        some = _some([t for t, _ in body.runs[1:]])
        each = [tracker.errors(t, [(body.quats[t], body.offsets[t]), rest])[0] for t in some]
        with_it, without = np.sum(each, axis=0) if each else (1.0, 1.0)
        if with_it / max(without, 1e-9) < best[0]:
            best = with_it / max(without, 1e-9), body
    return best[1]


def _some(times: Sequence[int]) -> list[int]:
    """At most `SORTED` of some times, evenly chosen."""
    chosen = np.unique(np.linspace(0, len(times) - 1, min(SORTED, len(times))).astype(int))
    return [int(times[k]) for k in chosen]


def _alike(a: Body, b: Body, means: NDArray[np.float32], radius: float) -> bool:
    """Whether the path of one body moves the means of another as its own path does, so that both are one."""
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(means), 1)).astype(np.float32)
    away = [
        float(np.linalg.norm(a.placed(t, means, quats)[0] - b.placed(t, means, quats)[0], axis=1).mean())
        for t in range(len(a.offsets))
    ]
    return float(np.mean(away)) < ALIKE * radius


def _share(joint: Joint, steps: int | None, seconds: float | None) -> float:
    """Completed share of the training of all together."""
    return min(1.0, joint.steps / max(steps, 1) if steps is not None else joint.seconds / max(seconds or 0.0, 1e-6))


def _size(cloud: GaussianCloud, rows: NDArray[np.int64]) -> float:
    """How far the Gaussians of a body reach from its middle, scene units."""
    means = cloud.means.numpy()[rows]
    return float(np.sqrt(((means - means.mean(axis=0)) ** 2).sum(axis=1).mean()))


def measure_film(scene: Scene, shots: Sequence[Shot]) -> Quality:
    """PSNR and SSIM of a scene against frames, each at its time; means over frames."""
    each: dict[str, tuple[float, float]] = {}
    for shot in shots:
        cloud = scene.cloud if shot.time is None else at(scene, shot.time).cloud
        for name, found in measure(cloud, [shot]).each.items():
            each[name if name not in each else f"{name} at {shot.time:g} s"] = found
    means = np.mean(list(each.values()), axis=0).tolist() if each else (math.nan, math.nan)
    return Quality(means[0], means[1], each)
