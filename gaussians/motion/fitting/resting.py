"""The scene at one end of a film of one moving camera (`resting`): what is there for most of the time, and, where the
frames of the end show something else, what these agree on.

Most things rest for a while before they move, or after. The camera moves meanwhile, so that these frames tell how they
look. A film whose end rests longer is fitted backwards.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...camera import Camera
from ...cloud import concat
from ...fit.loss import BLACK
from ...fit.parameters import Parameters
from ...render.cpu import gradient
from .agreement import Agreement, Tell
from .budget import OutOfTime
from .footage import U8, Footage, differs, rounded
from .sketch import covering
from .start import at_points
from .stereo import BEHIND, Points, points_of

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Mask = NDArray[np.bool_]

FEWEST = 4  # frames of an end that are taken to show it at rest
ASIDE = 0.15  # of the cameras' radius: as far the camera must go during these
OFTEN = 4  # how often these frames are drawn for each time that others are
SPACING = 1.0  # pixels, at the distance of the cameras' radius, between two points
DENIED = 0.5  # share of the pictures of the end that show it which look through a Gaussian: it is not there yet
RESTS = 0.35  # share of what is only there at the end that a frame must show, while something rests
TOLD = 0.5  # share of the frames of the end that must tell that it is at rest; others do not show it
LEAST = 20  # pixels at which the end looks otherwise than usual, of a frame that tells whether it shows it
ROUND = 0.35  # of the training of what is there for most of the time: the length of that of an end
ROUNDS = 2  # in which more frames are found to show the end
COMPARE = (0.3, 0.5, 0.7, 0.85)  # shares of a round after which what frames show otherwise is left out


@dataclass(frozen=True, eq=False)
class Resting:
    """The scene at the first time of a footage.

    Attributes:
        footage: with what each camera would see at the first time.
        backwards: whether it goes from the last time of the film to the first.
        parameters: of the Gaussians.
        frames: how many frames, from the first on, show something at rest that leaves later.
        beyond: how many of these were not taken to do so.
    """

    footage: Footage
    backwards: bool
    parameters: Parameters
    frames: int
    beyond: int


class Ends:
    """Finds the end of a film at which more rests.

    Args:
        lasting: the training of the scene that is there for most of the time; kept as it is.
        footage: of one moving camera.
        extent: radius of the cameras, scene units.
        rng: draws the order of frames, and copies and noise of Gaussians.
        tell: is told the loss of each step, and the number of Gaussians; raises OutOfTime if there is no time for more.
    """

    def __init__(
        self, lasting: Agreement, footage: Footage, extent: float, rng: np.random.Generator, tell: Tell
    ) -> None:  # fmt: skip
        self._lasting, self._footage, self._extent, self._rng = lasting.parameters, footage, extent, rng
        self._count, self._tell = max(1, round(ROUND * lasting.steps)), tell
        self._usual = {id(shot): _picture(self._lasting, shot.camera) for shot in footage.shots}
        self.steps = 0

    def best(self) -> Resting:
        """The scene at the end at which more rests, as the first time of a footage that may be backwards; the lasting
        scene if neither is another one for long enough.

        Raises:
            OutOfTime: the time is gone before both ends are known.
        """
        forward, backward = self._footage, self._footage.backwards()
        sides = [self._rested(forward, False, 0), self._rested(backward, True, 0)]
        found = max(sides, key=lambda side: side.beyond)
        if not found.beyond:
            usual = [self._usual[id(self._footage.shots[i])] for i in self._footage.first]
            return Resting(self._footage.beginning(usual), False, self._lasting, 0, 0)
        for _ in range(ROUNDS):
            try:
                longer = self._rested(found.footage, found.backwards, found.frames)
            except OutOfTime:
                return found
            if longer.frames <= found.frames:
                return longer
            found = longer
        return found

    def _rested(self, footage: Footage, backwards: bool, count: int) -> Resting:
        """The scene at the first time of a footage, by so many of its frames or, for 0, by as few as possible."""
        order = np.argsort(footage.when, kind="stable")
        core = _core(footage, order, self._extent)
        count = max(count, core)
        start = self._start(footage, order[:count][covering([footage.shots[i].camera for i in order[:count]])])
        often = np.ones(len(order), np.int64)
        often[order[:count]] = OFTEN
        training = Agreement(footage.shots, start, int(1.1 * len(start)) + 1, self._extent, self._rng, often)
        training.leave_out(order[count:])
        compare = [round(share * self._count) for share in COMPARE]
        for step in range(self._count):
            if step in compare:
                training.leave_out(order[core:])
            self._tell(training.step(step / self._count), len(start))
        self.steps += self._count
        shown = self._shown(training, footage, order)
        last = until(shown, core)
        at_first = [_picture(training.parameters, camera) for camera in footage.cameras]
        beginning = footage.beginning(at_first)
        return Resting(beginning, backwards, training.parameters, max(last, count), last - core)

    def _start(self, footage: Footage, chosen: I64) -> Parameters:
        """The lasting scene without what is not there at the end, and with points where it looks otherwise there."""
        shots = [footage.shots[i] for i in chosen]
        other = [differs(self._usual[id(shot)], shot.photo) for shot in shots]
        found = points_of([s.camera for s in shots], [s.colors for s in shots], self._extent)
        cloud = self._lasting.cloud()
        keep = torch.from_numpy(~_denied(cloud.means.numpy(), footage, chosen, found, other))
        within = np.concatenate([mask.reshape(-1) for mask in other])
        rows = np.flatnonzero(within & (found.agreed >= np.maximum(found.denied, 1)))
        rows = self._rng.permutation(rows)
        rows = rows[np.argsort(-found.agreed[rows], kind="stable")]
        spacing = SPACING * self._extent / shots[0].camera.fx
        _, first = np.unique(np.floor(found.means[rows] / spacing).astype(np.int64), axis=0, return_index=True)
        rows = rows[np.sort(first)]
        kept = cloud[keep]
        if len(rows) < 2:  # no distance to another one tells their size
            return Parameters.of(kept)
        added = at_points(found, rows, 4 * found.sizes[rows], self._extent)
        first_id = int(cloud.ids.max()) + 1
        return Parameters.of(concat([kept, added.replace(ids=torch.arange(first_id, first_id + len(added)))]))

    def _shown(self, training: Agreement, footage: Footage, order: I64) -> F64:
        """`[F]` share of the pixels at which the end looks otherwise than usual at which each frame shows it, in the
        order of time; NaN where there are hardly any."""
        found = np.full(len(order), np.nan)
        for k, i in enumerate(order):
            shot, drawn = footage.shots[i], training.drawn(int(i))
            other = differs(drawn, self._usual[id(shot)])
            if other.sum() >= LEAST:
                found[k] = 1 - differs(drawn, shot.photo)[other].mean()
        return found


def _picture(parameters: Parameters, camera: Camera) -> U8:
    """The render `[H, W, 3]` of a scene in training."""
    return rounded(gradient.draw(parameters.columns(), camera, BLACK).rgb)


def until(shown: F64, core: int) -> int:
    """How many frames, from the first on, show what rests at the end: only those of the core if it is always there."""
    gone = np.flatnonzero(shown[core:] < RESTS)
    if not len(gone):
        return core
    there = np.flatnonzero(shown[core : core + gone[0]] >= RESTS)
    more = int(there[-1]) + 1 if len(there) else 0
    return core + (more if len(there) >= TOLD * more else 0)


def _core(footage: Footage, order: I64, extent: float) -> int:
    """How many of the first frames the camera needs to see what rests from two sides."""
    eyes = np.stack([footage.shots[i].camera.position for i in order])
    far = np.linalg.norm(eyes - eyes[0], axis=1) >= ASIDE * extent
    return min(max(FEWEST, int(far.argmax()) + 1), len(order)) if far.any() else len(order)


def _denied(means: F32, footage: Footage, chosen: I64, found: Points, other: list[Mask]) -> Mask:
    """`[N]` Gaussians that some frames look through where they look otherwise than usual."""
    seen, through, start = np.zeros(len(means)), np.zeros(len(means)), 0
    for i, mask in zip(chosen, other, strict=True):
        camera = footage.shots[i].camera
        pixels = slice(start, start + mask.size)
        depth = found.depths[pixels].reshape(mask.shape)
        sure = (found.agreed[pixels] >= np.maximum(found.denied[pixels], 1)).reshape(mask.shape)
        start = pixels.stop
        at, z = camera.project(means.astype(np.float64))
        inside = camera.contains(at, z)
        x, y = np.clip(at.astype(np.int64).T, 0, [[camera.width - 1], [camera.height - 1]])
        seen += inside & (z <= depth[y, x] * (1 + BEHIND))
        through += inside & mask[y, x] & sure[y, x] & (z < depth[y, x] * (1 - BEHIND))
    return np.asarray(through > DENIED * np.maximum(seen, 1))
