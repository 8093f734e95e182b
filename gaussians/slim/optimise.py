"""Optimises a cloud with fewer Gaussians against renders of the original: squared error, Adam, no densification."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..fit.parameters import Parameters, parameter_gradients
from ..render.cpu import gradient
from .importance import Progress
from .loss import picture
from .views import View

LEG = 150  # steps between two measurements
# A third of the usual rates for a scene that is nearly right: after 300 steps held-out views of a capture gain 2.7 dB,
# with a ninth of them 1.6 dB, and with the usual rates in short legs they lose.
RATES = {"quats": 6e-4, "log_scales": 1.5e-3, "logit_opacities": 6e-3, "sh": 1.2e-3}
MEANS_RATE = 0.015  # of the median scale
CERTAIN = 1e-5  # opacities are kept so far from 0 and 1, where their logits end
DECAY = 0.1  # of the rates from the start of a leg to its end
SEED = 16


class Course:
    """An optimisation in legs of `LEG` steps until `steps` or `seconds` are over.

    Higher SH bands stay as they are: formats store them gathered.

    Args:
        views: pictures of `original` from these are the truth.
        steps, seconds: length; counted in steps, equal input gives equal results.
    """

    def __init__(
        self, views: Sequence[View], original: GaussianCloud, steps: int | None, seconds: float | None, say: Progress
    ) -> None:
        self._views, self._original, self._most, self._seconds, self._say = views, original, steps, seconds, say
        self._rng, self._order = np.random.default_rng(SEED), list[int]()
        self._truth: dict[int, NDArray[np.float16]] = {}
        self.steps, self.spent = 0, 0.0

    @property
    def over(self) -> bool:
        """Whether no further leg begins."""
        return self.progress >= 1

    @property
    def progress(self) -> float:
        """Completed share."""
        return self.steps / self._most if self._most is not None else self.spent / (self._seconds or 1.0)

    def optimised(self, cloud: GaussianCloud) -> GaussianCloud:
        """The cloud after one more leg; ids and groups stay."""
        started = time.perf_counter()
        parameters = Parameters.of(cloud.replace(opacities=cloud.opacities.clamp(CERTAIN, 1 - CERTAIN)))
        means_rate = MEANS_RATE * float(cloud.scales.median())
        for number in range(LEG):
            self._step(parameters, means_rate, DECAY ** (number / LEG))
        self.steps += LEG
        self.spent += time.perf_counter() - started
        self._say("optimising", min(1.0, self.progress))
        made = parameters.cloud()
        return made.replace(group=cloud.group, ids=cloud.ids)

    def _step(self, parameters: Parameters, means_rate: float, share: float) -> None:
        if not self._order:
            self._order = self._rng.permutation(len(self._views)).tolist()
        index = self._order.pop()
        view, columns = self._views[index], parameters.columns()
        drawn = gradient.draw(columns, view.camera, view.background)
        error = np.clip(drawn.rgb, 0, 1) - self._picture(index)
        slope = np.ascontiguousarray(2 * error / error.size, dtype=np.float32)
        found = gradient.draw_backward(drawn, slope, np.zeros(slope.shape[:2], np.float32))
        slopes = parameter_gradients(found, columns[2], columns[3])
        for name, values in parameters.arrays().items():
            rate = share * (means_rate if name == "means" else RATES[name])
            parameters.optimisers[name].step(values, slopes[name], rate, 0.0 if name == "sh" else None)

    def _picture(self, index: int) -> NDArray[np.float32]:
        """The truth of a view, rendered when first needed and kept in half precision."""
        if index not in self._truth:
            self._truth[index] = picture(self._original, self._views[index]).astype(np.float16)
        return self._truth[index].astype(np.float32)
