"""What frames of one moving camera agree on: a training in which pixels that show something else do not count
(`Agreement`), and the scene that is there for most of the time (`lasting`).

Absolute differences are minimised at first, so that the most frequent colours prevail. Then pixels that the render does
not explain are left out, as transient objects are in other work (RobustNeRF, Sabour et al. 2023).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...cloud import GaussianCloud
from ...fit.densify import MCMCStrategy
from ...fit.engine import CpuEngine
from ...fit.loss import BLACK, photometric
from ...fit.parameters import Parameters
from ...fit.train import LR_DECAY, MEANS_LR, REFINE_EVERY, REFINE_START_ITER, REFINE_STOP, Shot, morton_order
from ...render.cpu import gradient
from .budget import LASTING_UNTIL, Budget
from .footage import DIFFERS, U8, differs, rounded
from .start import ROOM

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
Tell = Callable[[float, int], None]

SSIM = 0.2
MARKS = (
    (0.35, 0.2),
    (0.55, 0.12),
    (0.75, DIFFERS),
)  # share of the training, and difference from which pixels are left out
LASTING = 0.3  # share of the steps of a film that go to what is there for most of the time
GROWN = 2  # pixels around these that are left out too


class Agreement:
    """A training in progress on what frames agree on.

    Args:
        shots: the frames.
        start: changed in place.
        budget: greatest number of Gaussians.
        extent: radius of the cameras, scene units.
        rng: draws the order of frames, and copies and noise of Gaussians.
        often: `[F]` how often each frame is drawn in a round; None: once.
    """

    def __init__(
        self, shots: Sequence[Shot], start: Parameters, budget: int, extent: float, rng: np.random.Generator,
        often: NDArray[np.int64] | None = None,
    ) -> None:  # fmt: skip
        self.parameters, self._shots, self._extent, self._rng = start, shots, extent, rng
        self._strategy = MCMCStrategy(budget, rng)
        self._engine = CpuEngine(start, self._strategy, SSIM)
        self._often = np.ones(len(shots), np.int64) if often is None else often
        self._out: dict[int, Mask] = {}
        self._order: list[int] = []
        self.steps = 0

    def leave_out(self, frames: Iterable[int], least: float = DIFFERS) -> None:
        """Leave out what some frames show otherwise than the present render, and nothing else of them."""
        for k in frames:
            off = differs(self.drawn(k), self._shots[k].photo, least)
            self._out[k] = np.asarray(ndimage.binary_dilation(off, iterations=GROWN), dtype=bool)

    def drawn(self, frame: int) -> U8:
        """The render `[H, W, 3]` by the camera of a frame."""
        return rounded(gradient.draw(self.parameters.columns(), self._shots[frame].camera, BLACK).rgb)

    def step(self, progress: float, ssim: float = SSIM) -> float:
        """Train on one frame; returns its loss.

        Args:
            progress: completed share of the training, in [0, 1].
            ssim: weight of D-SSIM.
        """
        if not self._order:
            self._order = self._rng.permutation(np.repeat(np.arange(len(self._shots)), self._often)).tolist()
        frame = self._order.pop()
        shot, out = self._shots[frame], self._out.get(frame)
        photo = shot.colors

        def loss(rgb: F32) -> tuple[float, F32]:
            return photometric(rgb, photo if out is None else np.where(out[..., None], rgb, photo), ssim)

        means_lr = MEANS_LR * self._extent * LR_DECAY**progress
        found = self._engine.learn(shot.camera, BLACK, loss, means_lr)
        self.steps += 1
        if self.steps % REFINE_EVERY == 0 and self.steps >= REFINE_START_ITER and progress < REFINE_STOP:
            self._strategy.refine(self.parameters, self.steps)
            self.parameters.take(morton_order(self.parameters.means))
        return found


def lasting(
    shots: Sequence[Shot], start: GaussianCloud, extent: float, steps: int | None, rng: np.random.Generator,
    budget: Budget, tell: Tell,
) -> Agreement:  # fmt: skip
    """The completed training of the scene that is there for most of the time.

    Args:
        start: Gaussians.
        extent: radius of the cameras, scene units.
        steps: of the whole fit; None: it is measured in seconds.
        budget: of the fit, of which it takes its share if it is measured in seconds.
        tell: is told the loss of each step, and the number of Gaussians.
    """
    training = Agreement(shots, Parameters.of(start), int(ROOM * len(start)) + 1, extent, rng)
    most = steps and max(1, round(LASTING * steps))
    started, seconds, share, marks = budget.gone, budget.left(LASTING_UNTIL), 0.0, list(MARKS)
    while share < 1:
        if marks and share >= marks[0][0]:
            training.leave_out(range(len(shots)), marks.pop(0)[1])
        tell(training.step(share, SSIM if len(marks) < len(MARKS) else 0.0), len(start))
        share = training.steps / most if most else (budget.gone - started) / (seconds or 1.0)
    return training
