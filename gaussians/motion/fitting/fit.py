"""Fit a scene with time to posed frames (`fit_film`).

```
first frames ─stereo─► start ─changes─► seeds ─track─► bodies ─train all together─► few keys ─► scene with motion
```

The scene at its start is trained first. Of its Gaussians those may move whose pixels change wherever they are seen;
what touches and goes at one time is one body. A body is kept if a path of it explains the frames. Then all Gaussians
and all poses are trained together on the frames of every time.

Before one moving camera the scene at its start is what all frames agree on, and what those of one end show otherwise
(`agreement`, `resting`); things are followed from that end.
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
from ...fit.densify import MCMCStrategy
from ...fit.fitting import Settings, Status
from ...fit.parameters import Parameters
from ...fit.photographs.photos import Photos
from ...fit.quality import Quality, measure
from ...fit.train import Schedule, Shot
from ...scene import Scene
from ..at import at
from ..motion import Motion, Residual, Track
from .agreement import lasting
from .bodies import Body, Labelled, turn_around
from .carving import Carving, Sight
from .finding import Finder
from .footage import Footage
from .resting import Ends
from .sharing import shown_later
from .simplify import track_of
from .start import trainer
from .training import Joint, Single

F64 = NDArray[np.float64]
Detail = Literal["static", "rigid", "residual"]  # the motion that may be fitted: none, paths, and single Gaussians' too

START = 0.3  # share of the training that goes to the scene at its start
TOLERANCE = 0.004  # of the radius of the cameras: how far the track may be from the poses at the frames
SHOWN = (0.3, 0.6)  # shares of the training of all together, at which bodies get what they show later
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
        UserError: a frame has no time or all have the same; or the frames agree on no depths.
    """
    settings = settings or Settings(seconds=300.0)
    return _Film(photos, settings, detail, on_status).fit()


def stands(photos: Photos) -> bool:
    """Whether the frames of a film are of cameras that stand; else one moves, or several do."""
    return Footage.of(photos.shots, [s.time for s in photos.shots]).stands


class _Film:
    """A fit in progress."""

    def __init__(
        self, photos: Photos, settings: Settings, detail: Detail, on_status: Callable[[Status], None]
    ) -> None:  # fmt: skip
        self._photos, self._settings, self._detail, self._on_status = photos, settings, detail, on_status
        self._footage = Footage.of(photos.shots, [s.time for s in photos.shots])
        self._rng = np.random.default_rng(settings.seed)
        self._sight: Sight | None = None
        self._started, self._told, self._loss = time.perf_counter(), 0.0, math.nan

    def fit(self) -> FittedFilm:
        """All steps."""
        footage, settings = self._footage, self._settings
        labelled, bodies, tried, before = self._before_standing() if footage.stands else self._before_moving()
        budget = min(settings.max_gaussians, int(MORE * len(labelled)))
        joint = Joint(labelled, bodies, footage, Carving(budget, self._rng, sight=self._sight), self._rng)
        left = None if settings.seconds is None else max(0.2 * settings.seconds, settings.seconds - self._seconds)
        more = None if settings.steps is None else settings.steps - before
        turns = list(SHOWN)
        while (share := _share(joint, more, left)) < 1:
            if turns and share >= turns[0]:
                shown_later(labelled, bodies, footage, self._rng)
                turns.pop(0)
            self._tell(joint.step(share), before + joint.steps, START + (1 - START) * share, len(labelled))
        scene, steps = self._scene(labelled, bodies, None), before + joint.steps
        if self._detail == "residual" and scene.motion is not None and self._photos.held_out:
            scene, more = self._with_single(scene, labelled, bodies, round(SINGLE * joint.steps))
            steps += more
        return FittedFilm(scene, measure_film(scene, self._photos.held_out), steps, self._seconds, tried)

    def _before_standing(self) -> tuple[Labelled, list[Body], int, int]:
        """What moves before cameras that stand, its paths, how many were tried, and the steps of the training."""
        settings = self._settings
        steps = settings.steps and max(1, round(START * settings.steps))
        schedule = Schedule(steps, settings.seconds and START * settings.seconds, settings.coarse)
        shots = [self._footage.shots[i] for i in self._footage.first]
        self._sight = Sight.of(shots, self._photos.extent)
        start = trainer(self._footage, self._photos, settings.max_gaussians, schedule, self._sight, self._rng)
        while start.progress < 1:
            self._tell(start.step(), start.steps, START * start.progress, len(start.parameters))
        return *self._bodies(start.parameters, self._footage), start.steps

    def _before_moving(self) -> tuple[Labelled, list[Body], int, int]:
        """The same before a camera that moves: the film is followed from the end at which more rests."""
        told = 0

        def tell(loss: float, gaussians: int) -> None:
            nonlocal told
            told += 1
            share = (
                told / self._settings.steps if self._settings.steps else self._seconds / (self._settings.seconds or 1)
            )
            self._tell(loss, told, min(share, START), gaussians)

        usual = lasting(self._footage.shots, self._photos, self._settings, self._rng, tell)
        still = Labelled.labelled(usual.parameters, np.zeros(len(usual.parameters), np.int32))
        if self._detail == "static":
            return still, [], 0, usual.steps
        ends = Ends(usual, self._footage, self._photos.extent, self._rng, tell)
        resting = ends.best()
        labelled, bodies, tried = self._bodies(deepcopy(resting.parameters), resting.footage)
        if not bodies:
            return still, [], tried, usual.steps
        if resting.backwards:
            turn_around(labelled, bodies)
        return labelled, bodies, tried, usual.steps + ends.steps

    def _bodies(self, start: Parameters, footage: Footage) -> tuple[Labelled, list[Body], int]:
        """What moves, by the number of its label, its paths, and how many were tried."""
        if self._detail == "static":
            return Labelled.labelled(start, np.zeros(len(start), np.int32)), [], 0

        def tell() -> None:
            self._tell(math.nan, 0, START, len(start))

        return Finder(footage, self._settings.seed, self._rng, tell).find(start)

    def _with_single(
        self, scene: Scene, labelled: Labelled, bodies: list[Body], steps: int
    ) -> tuple[Scene, int]:  # fmt: skip
        """The scene with displacements of single Gaussians if held-out frames gain by them, and the steps it took."""
        single = Single.none(np.flatnonzero(labelled.labels > 0), self._footage.times)
        copy = Labelled.labelled(Parameters.load(deepcopy(labelled.state())), labelled.labels.copy())
        joint = Joint(copy, bodies, self._footage, MCMCStrategy(len(copy), self._rng), self._rng, single)
        while joint.steps < steps:
            joint.step(1.0)
        finer = self._scene(copy, bodies, single)
        before, after = (measure_film(s, self._photos.held_out).psnr for s in (self._scene(copy, bodies, None), finer))
        return (finer if after - before >= GAIN else scene), steps

    @property
    def _seconds(self) -> float:
        return time.perf_counter() - self._started

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
