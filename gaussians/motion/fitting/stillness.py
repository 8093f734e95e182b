"""Whether anything moves before one camera (`nothing_moves`), told before any search by a short training.

What moves is in one place for a while and not before or after. So places count that most frames explain, and some that
follow one another do not. Frames are compared after their exposure is matched, without their finest detail, which a
blurred frame or a short training lacks, and without what changes evenly over many pixels, as a gloss does; a colour
that is right beside a pixel is right, as poses err. A place that most frames explain badly tells nothing, nor do frames
that are explained badly all over.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...cloud import GaussianCloud
from ...fit.parameters import Parameters
from ...fit.train import Shot
from .agreement import Agreement
from .footage import U8
from .seeds import SEEN, weights

F32 = NDArray[np.float32]
Flags = NDArray[np.bool_]

STEPS = 400  # of the training: a number of steps, so that the answer does not depend on the machine
FINE, EVEN = 1.0, 4.0  # pixels, standard deviations: of detail that is left out, and of what changes evenly
OFF = 0.08  # difference of a colour from which a place looks otherwise
UNUSUAL = 3.0  # times the place's usual difference and the frame's, from which it counts
USUAL = 0.75  # quantile of a frame's differences
VIEWS, RUN = 6, 3  # frames that must show a place, and that must follow one another to tell that it looks otherwise
FAINT = 0.02  # pixels of a Gaussian's weight below which a frame does not show it
MOVES = 0.001  # share of what frames show that looks otherwise, from which something may move
CAUCHY = 0.05  # difference of a colour from which it counts less when the exposure is matched
DAMPED = 0.01  # variance of a picture's colours up to which its contrast is not matched


def nothing_moves(shots: Sequence[Shot], start: GaussianCloud, extent: float, seed: int) -> bool:
    """Whether frames of one moving camera show nothing that moves and could be told from what they explain badly.

    Args:
        shots: frames with times; reduced ones do.
        start: the Gaussians of a training.
        extent: radius of the cameras, scene units.
        seed: of the training.
    """
    training = Agreement(shots, Parameters.of(start), len(start), extent, np.random.default_rng(seed))
    for k in range(STEPS):
        training.step(k / STEPS, ssim=0.0)
    return moved_share(shots, training) < MOVES


def moved_share(shots: Sequence[Shot], training: Agreement) -> float:
    """Share of what frames show, by the weights of its Gaussians, that looks otherwise for a while."""
    columns, order = (
        training.parameters.columns(),
        np.argsort(np.array([shot.time for shot in shots], np.float64), kind="stable"),
    )
    shown, off = np.zeros((2, len(columns[0]), len(shots)), np.float32)
    level = np.zeros(len(shots), np.float32)
    for t, k in enumerate(order):
        difference = difference_of(training.drawn(int(k)), shots[k].photo)
        level[t] = np.quantile(difference, USUAL)
        found = weights(columns, shots[k].camera, [np.ones(difference.shape, np.float32), difference])
        shown[:, t], off[:, t] = found[:, 0], found[:, 1] / np.maximum(found[:, 0], 1e-6)
    seen = shown >= np.maximum(SEEN * shown.max(axis=1, keepdims=True), FAINT)
    return float((shown * otherwise(seen, off, level)).sum() / max(float((shown * seen).sum()), 1e-9))


def otherwise(seen: Flags, off: F32, level: F32) -> Flags:
    """`[N, T]` whether a place looks otherwise at a time than it mostly does, in a run of frames that show it.

    Args:
        seen: `[N, T]` whether the frame of a time shows a place.
        off: `[N, T]` the difference of colour there.
        level: `[T]` the usual difference of a frame.
    """
    known = seen.sum(axis=1) >= VIEWS
    usual = np.zeros(len(off), np.float32)
    usual[known] = np.nanmedian(np.where(seen[known], off[known], np.nan), axis=1)
    least = np.maximum(OFF, UNUSUAL * np.maximum(usual[:, None], level))
    flags = seen & known[:, None] & (off > least)
    order = np.argsort(~seen, axis=1, kind="stable")  # the frames that show a place follow one another
    found = ndimage.binary_opening(np.take_along_axis(flags, order, axis=1), np.ones((1, RUN)))
    kept = np.zeros_like(flags)
    np.put_along_axis(kept, order, found, axis=1)
    return kept


def difference_of(drawn: U8, photo: U8) -> F32:
    """`[H, W]` difference of colour of a frame to those of a render at the pixel and beside it, in [0, 2], once their
    exposure is matched: of neither fine detail nor what changes evenly."""
    taken = photo.astype(np.float32) / np.float32(255)
    seen, taken = _between(exposed(drawn.astype(np.float32) / np.float32(255), taken)), _between(taken)
    (height, width, _), around = seen.shape, np.pad(seen, ((1, 1), (1, 1), (0, 0)), mode="edge")
    off = np.full((height, width), np.inf, np.float32)
    for y, x in np.ndindex(3, 3):
        off = np.minimum(off, np.abs(around[y : y + height, x : x + width] - taken).max(axis=2))
    return off


def exposed(drawn: F32, photo: F32) -> F32:
    """A render with the brightness and contrast of each channel of a photo, by what most pixels tell."""
    found = np.empty_like(drawn)
    for c in range(3):
        x, y = drawn[..., c].reshape(-1).astype(np.float64), photo[..., c].reshape(-1).astype(np.float64)
        weight, gain, more = np.ones_like(x), 1.0, 0.0
        for _ in range(5):
            total = weight.sum()
            middle, level = (weight * x).sum() / total, (weight * y).sum() / total
            spread = (weight * (x - middle) ** 2).sum() / total
            gain = ((weight * (x - middle) * (y - level)).sum() / total + DAMPED) / (spread + DAMPED)
            more = level - gain * middle
            weight = 1 / (1 + ((y - gain * x - more) / CAUCHY) ** 2)
        found[..., c] = gain * drawn[..., c] + more
    return found


def _between(picture: F32) -> F32:
    """What changes over more than `FINE` and less than `EVEN` pixels."""
    fine, even = (ndimage.gaussian_filter(picture, (sigma, sigma, 0)) for sigma in (FINE, EVEN))
    return np.asarray(fine - even, dtype=np.float32)
