"""bench fill: its rooms have true holes, its comparisons are right, and a quick run beats deleting alone."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.benchmarks import fill
from scenewright.benchmarks._fill.measure import biharmonic, ssim_map, telea

HOLE = np.zeros((24, 30), bool)
HOLE[8:15, 9:20] = True


def test_pictures_are_filled_where_they_are_empty_and_nowhere_else() -> None:
    y, x = np.mgrid[:24, :30] / 30.0
    picture = np.stack([x, y, 0.5 * x + 0.3 * y], axis=2)
    spoilt = np.where(HOLE[..., None], 0.0, picture)
    smooth, marched = biharmonic(spoilt, HOLE), telea(spoilt, HOLE)
    assert np.abs(smooth - picture).max() < 1e-6, "linear functions are biharmonic"
    assert np.abs(marched - picture)[HOLE].max() < 0.12
    for filled in (smooth, marched):
        assert (filled[~HOLE] == picture[~HOLE]).all()


def test_ssim_is_one_for_the_same_picture_and_less_for_another() -> None:
    a = np.random.default_rng(0).random((24, 30, 3))
    assert np.allclose(ssim_map(a, a), 1)
    assert ssim_map(a, 1 - a).mean() < 0.2


@pytest.mark.slow
def test_a_quick_run_beats_deleting_alone() -> None:
    found = {m.key: m for m in fill.run(quick=True).metrics}
    assert found["deletions"].value == fill.QUICK_DELETIONS
    assert found["all.psnr.over_bare"].value > 1
    assert found["all.open.filled"].value <= found["all.open.bare"].value
