"""Morton codes against one bit after the other."""

from __future__ import annotations

import numpy as np

from scenewright.gaussians.morton import BITS, codes


def test_codes_take_the_bits_of_the_axes_in_turn() -> None:
    cells = np.random.default_rng(0).integers(0, 1 << BITS, (50, 3))
    slow = [sum(((int(c[a]) >> b) & 1) << (3 * b + a) for b in range(BITS) for a in range(3)) for c in cells]
    assert codes(cells).tolist() == slow
