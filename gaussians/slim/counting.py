"""The next number of Gaussians to try in the search for the fewest that keep a PSNR."""

from __future__ import annotations

import math
from dataclasses import dataclass

FINE = 1.005  # ratio of two numbers of Gaussians between which no further one is tried
LEAST_SHARE = 0.02  # of the Gaussians, below which no number is tried
SLOPE = 18.0  # dB gained by e times as many Gaussians, as far as nothing is known: 13 to 23 on captures


@dataclass(frozen=True)
class Tried:
    """A number of Gaussians and the PSNR that it keeps, dB."""

    count: int
    psnr: float


def next_count(above: Tried | None, below: Tried | None, target: float, count: int, least: int) -> int | None:
    """The next number to try; None if there is none between those that were tried.

    The PSNR is about linear in the logarithm of the number, so that it is interpolated there.

    Args:
        above, below: the nearest numbers that keep the target and that do not; one of them is there.
        target: dB.
        count: all Gaussians.
        least: those that are kept in any case.
    """
    least = min(count, max(least, round(LEAST_SHARE * count)))
    if above is None:
        assert below is not None
        if below.count >= count:
            return None
        more = math.exp(max((target - below.psnr) / SLOPE, 0.01))
        return min(count, math.ceil(below.count * min(more * 1.02, 2.0)))
    if below is None:
        fewer = math.exp(-(above.psnr - target) / SLOPE)
        return None if above.count <= least else max(least, round(above.count * min(max(fewer, 0.4), 0.98)))
    if above.count <= below.count * FINE + 1:
        return None
    share = (above.psnr - target) / max(above.psnr - below.psnr, 1e-9)
    share = min(max(share * 0.98, 0.05), 0.95)
    wanted = round(math.exp((1 - share) * math.log(above.count) + share * math.log(below.count)))
    return wanted if below.count < wanted < above.count else None
