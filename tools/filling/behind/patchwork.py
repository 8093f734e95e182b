"""Fill a hole in a picture with patches of the picture itself, from coarse to fine.

Every patch that overlaps the hole looks for the known patch that it resembles most; the hole takes the mean of what
these patches show, and both steps repeat (Wexler, Shechtman and Irani, "Space-Time Completion of Video", 2007). The
search is that of Barnes et al., "PatchMatch", 2009. The same input gives the same picture.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..smooth import F64, Mask, averaged
from .patch_search import I32, REACH, aggregate, searched

F32 = NDArray[np.float32]
_ROUNDS = (8, 5, 3, 2, 2, 2)  # of search and mean, at each size from the coarsest
_COARSEST = 4.0  # pixels: depth of the hole at the coarsest size
_LEAST = 24  # pixels along the shorter side of the coarsest picture
_INWARD = 1.1  # by how much a patch counts less for each pixel that its middle lies deeper in the hole
_MOST_INWARD = 12  # pixels
_SHARP = 8.0  # exponent of the trust in patches in the last mean of each size: it keeps texture crisp
_GUIDE, _GUIDE_NEAR = 1.5, 6.0  # weight of mean colours against colours, and pixels over which they are taken
_NEAR = 0.0001  # squared difference of colours for which a patch as far away as the hole is deep must be better
_BUSY, _BUSY_NEAR = (
    10.0,
    4.0,
)  # weight of a picture's changes against its colours, and pixels over which they are averaged
_MARCH = 2.5  # pixels: standard deviation of the means by which a hole is first filled


def patched(picture: F64, known: Mask, hole: Mask) -> F64:
    """`[H, W, C]` the picture with its hole filled.

    Args:
        picture: `[H, W, C]`, valid where known.
        known: `[H, W]`, what may be copied.
        hole: `[H, W]`, disjoint from `known`.
    """
    if not hole.any() or not known.any():
        return picture.copy()
    channels = picture.shape[2]
    first = _marched(picture, known, hole)
    guide = _GUIDE * averaged(first, (known | hole).astype(np.float64), _GUIDE_NEAR)
    sizes = [(np.concatenate([first, guide, _busy(picture, known, hole)], axis=2), known, hole)]
    patch = (2 * channels + 2) * (2 * REACH + 1) ** 2
    while _deep(sizes[-1][2]) > _COARSEST and min(sizes[-1][1].shape) >= 2 * _LEAST:
        sizes.append(_halved(*sizes[-1]))
    match: I32 | None = None
    for k, (image, source, place) in enumerate(reversed(sizes)):
        local = _NEAR * patch / _deep(place) ** 2
        size = _Size(_ROUNDS[min(k, len(_ROUNDS) - 1)], local, channels)
        now, match = _solved(image.astype(np.float32), source, place, match, size)
    return np.where(hole[..., None], now[..., :channels].astype(np.float64), picture)


def _busy(picture: F64, known: Mask, hole: Mask) -> F64:
    """`[H, W, 2]` how much the picture changes along rows and columns around each pixel: without it smooth surfaces
    would grow into the hole, as smooth patches resemble each other most (Newson et al., "Video Inpainting of Complex
    Scenes", 2014)."""
    at = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    grey = picture.mean(axis=2)[tuple(at)]
    inner = ndimage.binary_erosion(known).astype(np.float64)
    changes = np.stack([np.abs(g) for g in np.gradient(grey)], axis=2)
    return _BUSY * _marched(averaged(changes, inner, _BUSY_NEAR), known, hole)


def _marched(picture: F64, known: Mask, hole: Mask) -> F64:
    """The picture with the hole filled from its border inward, each ring of pixels by the mean of what is near it and
    known: colours of different surfaces keep apart, unlike in a smooth solve."""
    out = np.where(known[..., None], picture, 0.0)
    done, left = known.copy(), hole.copy()
    while left.any():
        ring = left & ndimage.binary_dilation(done, np.ones((3, 3)))
        if not ring.any():
            break
        weight = ndimage.gaussian_filter(done.astype(np.float64), _MARCH)
        mean = ndimage.gaussian_filter(out, (_MARCH, _MARCH, 0))
        out[ring] = mean[ring] / weight[ring][:, None]
        done |= ring
        left &= ~ring
    return np.where(hole[..., None], out, picture)


class _Size(NamedTuple):
    """How one size of a picture is solved: rounds, the price of a squared pixel of distance, channels to be filled."""

    rounds: int
    local: float
    channels: int


class _Places(NamedTuple):
    """Middles of known patches `[H, W]` and `[K, 2]`, and of the patches that overlap a hole `[M, 2]`."""

    whole: Mask
    known: I32
    targets: I32

    @classmethod
    def of(cls, known: Mask, hole: Mask) -> _Places | None:
        """None if no patch is known, or none overlaps the hole."""
        whole = ndimage.binary_erosion(known, np.ones((2 * REACH + 1,) * 2), border_value=0)
        near = ndimage.binary_dilation(hole, np.ones((3, 3)), iterations=REACH)
        near[:REACH] = near[-REACH:] = near[:, :REACH] = near[:, -REACH:] = False
        targets = np.argwhere(near).astype(np.int32)
        # Nothing as large as a patch is known: the start stays.
        return (
            cls(np.asarray(whole), np.argwhere(whole).astype(np.int32), targets)
            if whole.sum() > 15 and len(targets)
            else None
        )


def _solved(start: F32, known: Mask, hole: Mask, match: I32 | None, size: _Size) -> tuple[F32, I32 | None]:
    """One size: the picture after some rounds, and the match of each pixel `[H, W, 2]`."""
    places = _Places.of(known, hole)
    if places is None:
        return start, match
    rounds, local, channels = size
    targets = places.targets
    now, valid = np.ascontiguousarray(start), known | hole
    found = _start(match, known.shape, places)
    if match is not None:  # what the matches of the coarser size show at this one is crisper than its picture
        now = aggregate(now, channels, hole, targets, found, _central(hole, targets))
    weight = _INWARD ** -np.minimum(ndimage.distance_transform_edt(~known), _MOST_INWARD)
    for step in range(rounds):
        found, cost = searched(now, valid, places.whole, targets, found, local, step + 1)
        sharp = _SHARP if step == rounds - 1 else 1.0
        now = aggregate(
            now, channels, hole, targets, found, _trust(cost) ** sharp * weight[targets[:, 0], targets[:, 1]]
        )
    return now, found


def _start(match: I32 | None, shape: tuple[int, ...], places: _Places) -> I32:
    """`[H, W, 2]` where each target's patch is first compared with: twice the match of the coarser size, else spread
    over the known patches."""
    found = np.zeros((*shape, 2), np.int32)
    targets = places.targets
    rng = np.random.default_rng(0)
    found[targets[:, 0], targets[:, 1]] = places.known[rng.integers(len(places.known), size=len(targets))]
    if match is not None:
        coarse = np.minimum(targets // 2, np.array(match.shape[:2]) - 1)
        guess = 2 * match[coarse[:, 0], coarse[:, 1]] + targets % 2
        guess = np.clip(guess, 0, np.array(shape[:2]) - 1).astype(np.int32)
        good = places.whole[guess[:, 0], guess[:, 1]]
        found[targets[good, 0], targets[good, 1]] = guess[good]
    return found


def _central(hole: Mask, targets: I32) -> F64:
    """`[M]` weights under which the patch of a pixel of the hole decides on it, and others where there is none."""
    return np.where(hole[targets[:, 0], targets[:, 1]], 1.0, 1e-3)


def _trust(cost: F32) -> F64:
    """`[M]` how much patches count, by how well they match."""
    usual = max(float(np.quantile(cost, 0.75)), 1e-6)
    return np.exp(-cost.astype(np.float64) / (2 * usual))


def _deep(hole: Mask) -> float:
    return float(ndimage.distance_transform_edt(np.pad(hole, 1)).max())


def _halved(picture: F64, known: Mask, hole: Mask) -> tuple[F64, Mask, Mask]:
    """The same at half the size; a pixel is of the hole if a part of it is, and known if most of it is."""
    h, w = (n // 2 * 2 for n in known.shape)

    def blocks(values: F64) -> F64:
        return np.asarray(values[:h, :w].reshape(h // 2, 2, w // 2, 2, -1).mean(axis=(1, 3)))

    place = blocks(hole.astype(np.float64)[..., None])[..., 0] > 0
    return blocks(picture), np.asarray((blocks(known.astype(np.float64)[..., None])[..., 0] > 0.7) & ~place), place
