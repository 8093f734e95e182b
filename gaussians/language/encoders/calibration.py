"""Calibration of an encoder: the parameters that map its similarities to probabilities, and size priors of kinds.

`probability.py` applies them. They are fitted once, on objects that the encoder was not trained on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...errors import BackendError

Array = NDArray[np.float64]
SIZE_CAP = 4.5  # nats: largest penalty of a size, because toy and oversized objects exist


@dataclass(frozen=True)
class SizePrior:
    """Size of a kind: mean and standard deviation of the logarithms of its extents in metres.

    Attributes:
        mean: longer level side, shorter level side, height; natural logarithms of metres.
        std: their standard deviations, already widened for variety beyond our own assets.
    """

    mean: tuple[float, float, float]
    std: tuple[float, float, float]

    def log_likelihood(self, sizes: Array) -> Array:
        """Log-likelihood `[G]` in nats, in [-SIZE_CAP, 0], of extents `[G, 3]` in metres (two level sides, height)."""
        level = np.sort(sizes[:, :2], axis=1)[:, ::-1]
        logs = np.log(np.maximum(np.concatenate([level, sizes[:, 2:]], axis=1), 1e-3))
        z = (logs - np.array(self.mean)) / np.array(self.std)
        nats: Array = np.maximum(-0.5 * (z**2).sum(axis=1), -SIZE_CAP)
        return nats


@dataclass(frozen=True)
class Calibration:
    """Parameters that map similarities of one encoder to probabilities.

    Attributes:
        scale: factor of the cosines before the softmax (inverse temperature).
        threshold: probability from which a group counts as the named kind.
        size_weight: weight of the measured size if metres are known; 0 ignores it.
        sizes: size prior of each kind by its canonical name; kinds without one are neutral.
        rivals: total weight of all rivals of a phrase, shared equally; None for weight 1 each.
        confidence: mean probability of the best name over things like those that the encoder was trained with. The more
            names it has, the lower it is; in scenes that it does not know it falls far below.
        measured: error rates on objects used neither for training nor for fitting.
    """

    scale: float
    threshold: float
    size_weight: float = 0.0
    sizes: Mapping[str, SizePrior] = field(default_factory=dict)
    measured: Mapping[str, float] = field(default_factory=dict)
    rivals: float | None = None
    confidence: float = 0.85

    def __post_init__(self) -> None:
        if not self.scale > 0 or not 0 < self.threshold < 1 or self.size_weight < 0:
            raise BackendError("broken calibration: scale must be > 0, threshold in (0, 1), size_weight >= 0")
        if not 0 < self.confidence < 1:
            raise BackendError("broken calibration: confidence must be in (0, 1)")
        if self.rivals is not None and not self.rivals > 0:
            raise BackendError("broken calibration: rivals must be > 0 or null")

    def to_json(self) -> dict[str, Any]:
        """The calibration as JSON values."""
        return {
            "scale": self.scale,
            "threshold": self.threshold,
            "size_weight": self.size_weight,
            "sizes": {k: {"mean": list(p.mean), "std": list(p.std)} for k, p in self.sizes.items()},
            "measured": dict(self.measured),
            "rivals": self.rivals,
            "confidence": self.confidence,
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `to_json`."""
        sizes = {k: SizePrior(tuple(p["mean"]), tuple(p["std"])) for k, p in data.get("sizes", {}).items()}
        return cls(
            data["scale"], data["threshold"], data.get("size_weight", 0.0), sizes, data.get("measured", {}),
            data.get("rivals"), data.get("confidence", 0.85),
        )  # fmt: skip


# Two parameters for all published CLIPs, fitted on the even half of the LVIS classes with real ViT-B/32 vectors: means
# of five photos are the objects of simulated scenes (14 and 29 objects, some unnamed; 40 to 1,203 names compete).
# `rivals` minimises the log loss, the threshold the sum of both error rates. The rates are those of the odd half in
# scenes of 14 objects; then those of household classes against the names that encoders of photographs propose, and
# against all 1,203 names. `benchmarks/_clip.py` reproduces all of them.
_CLIP_SCALE = 100.0  # the temperature that CLIP training ends at (Radford et al. 2021, section 2.5)
_CLIP_RIVALS = 47.0
_CLIP_THRESHOLD = 0.33
_CLIP_MEASURED: Mapping[str, float] = {
    "absent_refused": 0.948, "present_refused": 0.098, "present_right": 0.97,
    "household_absent_refused": 0.968, "household_present_refused": 0.064, "alike_absent_refused": 0.704,
}  # fmt: skip


def of_clip(scale: float = _CLIP_SCALE) -> Calibration:
    """The calibration of published CLIPs and of vectors made with them; `scale` is the trained logit scale."""
    return Calibration(scale, _CLIP_THRESHOLD, measured=_CLIP_MEASURED, rivals=_CLIP_RIVALS)
