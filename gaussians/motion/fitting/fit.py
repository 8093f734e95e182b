"""Fit a scene with time to posed frames (`fit_film`).

```
first frames ─stereo─► start ─changes─► seeds ─track─► bodies ─train all together─► few keys ─► scene with motion
```

The scene at its start is trained first. Of its Gaussians those may move whose pixels change wherever they are seen;
what touches and goes at one time is one body. A body is kept if a path of it explains the frames. Then all Gaussians
and all poses are trained together on the frames of every time.

Before one moving camera the scene at its start is what all frames agree on, and what those of one end show otherwise
(`agreement`, `resting`); things are followed from that end. Where nothing moves, the film is left to a fit of
photographs (`fit_what_moves`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import NO_GROUP, GaussianCloud
from ...files.captures.colmap import Points
from ...fit.fitting import SECONDS, Settings, Status
from ...fit.initialize import MIN_POINTS
from ...fit.parameters import Parameters
from ...fit.photographs.photos import Photos
from ...fit.quality import Quality, measure
from ...fit.train import Shot
from ...harmonics import dc_to_color
from ...scene import Scene
from ..at import at
from ..motion import Motion, Residual, Track
from .agreement import lasting
from .bodies import Body, Labelled, turn_around
from .budget import ENDS_UNTIL, Budget, OutOfTime
from .carving import Carving, Sight
from .finding import Finder
from .footage import Footage
from .resting import Ends
from .sharing import shown_later
from .simplify import track_of
from .sketch import MOST_PIXELS, STEREO_FRAMES, at_all_times, covering, reduced, sketched, stereo_pixels
from .start import PIXELS, changing, start_cloud, trainer
from .stillness import nothing_moves
from .training import Joint

F64 = NDArray[np.float64]
Detail = Literal["static", "rigid", "residual"]  # the motion that may be fitted: none, paths, and bodies that bend, too

START = 0.3  # share of the fit that is told as completed when all together are trained, at least
TOLERANCE = 0.004  # of the radius of the cameras: how far the track may be from the poses at the frames
LEAST_TOGETHER = 0.2  # share of the time that the training of all together has at least
SHOWN = (0.3, 0.6)  # shares of the training of all together, at which bodies get what they show later
MORE = 1.2  # times the Gaussians of the start: greatest number at the end, for what was hidden at the start
GAIN = 0.05  # dB on held-out frames, for which bodies bend
REPORT_EVERY = 0.5  # seconds


@dataclass(frozen=True, eq=False)
class FittedFilm:
    """A fitted scene with time.

    Attributes:
        scene: with `motion` if something moves; the group of a Gaussian is the number of its thing, from 0 on.
        quality: on held-out frames, each at its time.
        steps, seconds: of the training.
        tried: how many bodies were tracked; those that no path explained stand still.
        cut: whether the search for what moves ended early, as its share of the time was gone.
    """

    scene: Scene
    quality: Quality
    steps: int
    seconds: float
    tried: int
    cut: bool


@dataclass(frozen=True, eq=False)
class Still:
    """A film in which nothing was found that moves: frames to fit as photographs are.

    Attributes:
        photos: the same, with points of the film's own stereo where the capture has too few.
        seconds: that the search took.
        tried: how many bodies were tracked; none explained the frames.
        cut: whether the search ended early, as its share of the time was gone.
    """

    photos: Photos
    seconds: float
    tried: int
    cut: bool


def fit_film(
    photos: Photos,
    settings: Settings | None = None,
    *,
    detail: Detail = "residual",
    on_status: Callable[[Status], None] = lambda status: None,
) -> FittedFilm:
    """Fit a scene with time to frames whose `Shot.time` differ.

    What moves is searched in reduced frames of some of the times (`sketch`), and each phase keeps to its share of
    `settings.seconds` (`budget`); then all is trained on all frames. Before cameras that stand, a film begins when most
    of them have a frame; those that have none then are trained on alone.

    Args:
        settings: of the length, the greatest number of Gaussians and the seed; degree 0 only. Default: five minutes.
        detail: the motion that is fitted at most; residuals only where they improve held-out frames.

    Raises:
        UserError: a frame has no time or all have the same; or the frames agree on no depths.
    """
    film = _Film(photos, settings or Settings(seconds=SECONDS), detail, on_status)
    return film.trained(film.searched())


def fit_what_moves(
    photos: Photos, settings: Settings | None = None, *, on_status: Callable[[Status], None] = lambda status: None
) -> FittedFilm | Still:
    """As `fit_film` if something moves; else what a fit of photographs starts with, before anything else is trained.

    Frames of one moving camera are looked at first (`stillness`): where they show nothing that moves, none is searched.
    """
    film = _Film(photos, settings or Settings(seconds=SECONDS), "residual", on_status)
    if film.stands_still():
        return film.left(0)
    found = film.searched()
    return film.trained(found) if found.bodies else film.left(found.tried)


def stands(photos: Photos) -> bool:
    """Whether the frames of a film are of cameras that stand; else one moves, or several do."""
    return Footage.of(photos.shots, [s.time for s in photos.shots]).stands


@dataclass(frozen=True, eq=False)
class _Found:
    """Gaussians with the number of their body, paths of these at the times of all frames, how many were tried, and the
    steps of the training so far."""

    labelled: Labelled
    bodies: list[Body]
    tried: int
    steps: int


class _Film:
    """A fit in progress."""

    def __init__(
        self, photos: Photos, settings: Settings, detail: Detail, on_status: Callable[[Status], None],
    ) -> None:  # fmt: skip
        self._photos, self._settings, self._detail, self._on_status = photos, settings, detail, on_status
        self._footage = Footage.of(photos.shots, [s.time for s in photos.shots])
        if self._footage.stands:
            self._footage = self._footage.since(self._footage.begins or 0)
            begins = float(self._footage.times[0])
            held_out = tuple(shot for shot in photos.held_out if shot.time is None or shot.time >= begins)
            self._photos = photos = replace(photos, held_out=held_out)
        self._steady = self._footage.steady if self._footage.stands else self._footage
        self._rng, self._budget = np.random.default_rng(settings.seed), Budget(settings.seconds)
        self._pixels = MOST_PIXELS
        if not self._footage.stands:
            self._pixels = min(MOST_PIXELS, stereo_pixels(settings.seconds, len(photos.shots)))
        small = sketched(self._steady.shots, self._pixels)
        self._sketch = Footage.of(small, [s.time for s in small])
        self._sight: Sight | None = None
        self._told, self._loss, self._cut = 0.0, math.nan, False

    def stands_still(self) -> bool:
        """Whether frames of one moving camera show that nothing moves; cameras that stand are not asked."""
        photos = self._photos
        return not self._footage.stands and nothing_moves(
            self._sketch.shots, self._start, photos.extent, self._settings.seed
        )

    def left(self, tried: int) -> Still:
        """The film for a fit of photographs."""
        photos = self._photos
        if len(photos.points.means) < MIN_POINTS:
            colors = dc_to_color(self._start.sh[:, 0]).clamp(0, 1)
            photos = replace(photos, points=Points(self._start.means.double().numpy(), colors.double().numpy()))
        return Still(photos, self._budget.gone, tried, self._cut)

    def searched(self) -> _Found:
        """What moves."""
        return self._before_standing() if self._footage.stands else self._before_moving()

    def trained(self, found: _Found) -> FittedFilm:
        """All together, and few keys."""
        settings, labelled, bodies = self._settings, found.labelled, found.bodies
        most = min(settings.max_gaussians, int(MORE * len(labelled)))
        joint = Joint(labelled, bodies, self._footage, Carving(most, self._rng, sight=self._sight), self._rng)
        left = self._budget.left(least=LEAST_TOGETHER)
        more = None if settings.steps is None else settings.steps - found.steps
        turns = list(SHOWN) if bodies else []
        while (share := _share(joint, more, left)) < 1:
            if turns and share >= turns[0]:
                joint.settle()
                shown_later(labelled, bodies, self._reduced, self._rng)
                turns.pop(0)
            self._tell(joint.step(share), found.steps + joint.steps, START + (1 - START) * share, len(labelled))
        joint.settle()
        scene = self._gaining(labelled, bodies)
        quality = measure_film(scene, self._photos.held_out)
        return FittedFilm(scene, quality, found.steps + joint.steps, self._budget.gone, found.tried, self._cut)

    @cached_property
    def _start(self) -> GaussianCloud:
        """Gaussians to start from, at points of the first frames of cameras that stand, or of all of one that moves."""
        sketch, photos, settings = self._sketch, self._photos, self._settings
        if self._footage.stands:
            whole = [shot for shot in self._steady.shots if shot.time in sketch.times]
            pixels = stereo_pixels(settings.seconds, len(sketch.first))
            first = [whole[i] for i in sketch.first]
            return start_cloud(first, photos, settings.max_gaussians, self._rng, pixels, changing(sketch))
        small = sketch.shots[:STEREO_FRAMES]
        most = sum(shot.photo.shape[0] * shot.photo.shape[1] for shot in small) // PIXELS
        return start_cloud(photos.shots, photos, min(settings.max_gaussians, most), self._rng, self._pixels)

    @cached_property
    def _reduced(self) -> Footage:
        """All frames, reduced as those of the search are."""
        shots = [reduced(shot, self._pixels) for shot in self._footage.shots]
        return Footage.of(shots, [shot.time for shot in shots])

    def _before_standing(self) -> _Found:
        """What moves before cameras that stand."""
        photos, first = self._photos, [self._sketch.shots[i] for i in self._sketch.first]
        first = [first[i] for i in covering([shot.camera for shot in first])]
        pixels = stereo_pixels(self._settings.seconds, len(first))
        self._sight = Sight.of([reduced(shot, pixels) for shot in first], photos.extent)
        start = trainer(
            self._steady, self._start, photos.extent, self._settings, self._sight, self._rng, self._budget
        )  # fmt: skip
        while start.progress < 1:
            self._tell(start.step(), start.steps, START * start.progress, len(start.parameters))
        labelled, bodies, tried = self._bodies(start.parameters, self._sketch)
        return _Found(labelled, self._at_all_times(bodies), tried, start.steps)

    def _before_moving(self) -> _Found:
        """The same before a camera that moves: the film is followed from the end at which more rests."""
        told, budget, sketch, start = 0, self._budget, self._sketch, self._start

        def tell(loss: float, gaussians: int) -> None:
            nonlocal told
            told += 1
            share = told / self._settings.steps if self._settings.steps else budget.gone / (budget.seconds or 1)
            self._tell(loss, told, min(share, START), gaussians)

        def tell_end(loss: float, gaussians: int) -> None:
            budget.check(ENDS_UNTIL)
            tell(loss, gaussians)

        usual = lasting(sketch.shots, start, self._photos.extent, self._settings.steps, self._rng, budget, tell)
        still = Labelled.labelled(usual.parameters, np.zeros(len(usual.parameters), np.int32))
        if self._detail == "static":
            return _Found(still, [], 0, usual.steps)
        ends = Ends(usual, sketch, self._photos.extent, self._rng, tell_end)
        try:
            resting = ends.best()
        except OutOfTime:
            self._cut = True
            return _Found(still, [], 0, usual.steps)
        labelled, bodies, tried = self._bodies(deepcopy(resting.parameters), resting.footage)
        if not bodies:
            return _Found(still, [], tried, usual.steps)
        if resting.backwards:
            turn_around(labelled, bodies)
        return _Found(labelled, self._at_all_times(bodies), tried, usual.steps + ends.steps)

    def _bodies(self, start: Parameters, footage: Footage) -> tuple[Labelled, list[Body], int]:
        """What moves, by the number of its label, its paths, and how many were tried."""
        if self._detail == "static":
            return Labelled.labelled(start, np.zeros(len(start), np.int32)), [], 0

        def tell() -> None:
            self._tell(math.nan, 0, START, len(start))

        finder = Finder(footage, self._settings.seed, self._rng, self._budget, tell, self._detail == "residual")
        found = finder.find(start)
        self._cut = finder.cut
        return found

    def _at_all_times(self, bodies: Sequence[Body]) -> list[Body]:
        """Paths that were found in the sketch, at the times of all frames."""
        return [at_all_times(body, self._sketch.times, self._footage.times) for body in bodies]

    def _gaining(self, labelled: Labelled, bodies: Sequence[Body]) -> Scene:
        """The scene; bodies bend in it only if held-out frames, where there are some, gain by that."""
        scene = self._scene(labelled, bodies)
        if not self._photos.held_out or not any(body.bend for body in bodies):
            return scene
        rigid = self._scene(labelled, [replace(body, bend=None) for body in bodies])
        before, after = (measure_film(s, self._photos.held_out).psnr for s in (rigid, scene))
        return scene if after - before >= GAIN else rigid

    def _scene(self, labelled: Labelled, bodies: Sequence[Body]) -> Scene:
        """The scene, rows by body, with tracks of few keys."""
        footage = self._footage
        order = np.argsort(labelled.labels, kind="stable")
        labels = labelled.labels[order]
        cloud = labelled.cloud()[torch.from_numpy(order)]
        cloud = cloud.replace(ids=torch.arange(len(cloud)))
        group = np.full(len(cloud), NO_GROUP, np.int32)
        tracks, residuals = list[Track](), list[Residual]()
        things, tolerance = 0, TOLERANCE * footage.radius
        for number, body in enumerate(bodies, 1):
            rows = np.flatnonzero(labels == number)
            if not len(rows):
                continue
            track = track_of(body, rows, footage.times, _size(cloud, rows), tolerance, f"thing {number}")
            residual = _residual(body, rows, cloud.means.numpy()[rows], footage.times, tolerance)
            if track is None and residual is not None:  # what it bends with may stand
                rows = residual.ids
            if track is not None or residual is not None:
                group[rows] = things
                things += 1
            tracks += [track] if track is not None else []
            residuals += [residual] if residual is not None else []
        cameras = tuple(sorted(footage.cameras, key=lambda camera: camera.name))
        scene = Scene(cloud.replace(group=torch.from_numpy(group)), cameras=cameras)
        if not things:
            return scene
        first, last = float(footage.times[0]), float(footage.times[-1])
        return scene.replace(motion=Motion(tuple(tracks), (), tuple(residuals), first, last))

    def _tell(self, loss: float, steps: int, share: float, gaussians: int) -> None:
        """Report progress now and then."""
        if not math.isnan(loss):
            self._loss = loss if math.isnan(self._loss) else 0.95 * self._loss + 0.05 * loss
        now = self._budget.gone
        if now - self._told >= REPORT_EVERY:
            self._told = now
            left = now * (1 / max(share, 1e-9) - 1)
            self._on_status(Status(steps, min(share, 1.0), self._loss, math.nan, gaussians, left))


def _share(joint: Joint, steps: int | None, seconds: float | None) -> float:
    """Completed share of the training of all together."""
    return min(1.0, joint.steps / max(steps, 1) if steps is not None else joint.seconds / max(seconds or 0.0, 1e-6))


def _residual(
    body: Body, ids: NDArray[np.int64], means: NDArray[np.float32], times: F64, tolerance: float
) -> Residual | None:  # fmt: skip
    """The displacements of a body that bends, of as low a rank as keeps them within a tolerance (scene units)."""
    if body.bend is None:
        return None
    basis, weights = body.bend.low_rank(means, tolerance)
    moves = np.linalg.norm(np.einsum("tb,nbc->tnc", basis, weights), axis=2).max(axis=0, initial=0.0) > tolerance
    return Residual(ids[moves], times, basis, weights[moves]) if moves.any() else None


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
