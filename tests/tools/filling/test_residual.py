"""What a shadow leaves is corrected; what differs by more than that may is another surface, and stays."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.tools.filling.shadow import Shadow, _levelled

Y, X = np.mgrid[0:60, 0:60]
INSIDE = (Y - 30) ** 2 + (X - 30) ** 2 < 100


@pytest.mark.parametrize(("left", "corrected"), [(0.9, True), (0.6, False)])
def test_only_a_residual_is_corrected(left: float, corrected: bool) -> None:
    told = np.where(INSIDE, 0.8, 1.0)
    light = 0.5 * told * np.where(INSIDE, left, 1.0)
    rgb, every = np.repeat(light[..., None], 3, axis=2), np.ones(X.shape, bool)
    found = _levelled(rgb, every, every, Shadow(told, 0.2)).ratio
    middle = (Y - 30) ** 2 + (X - 30) ** 2 < 36
    assert np.allclose(found[middle], 0.8 * left if corrected else 0.8, atol=0.02)
