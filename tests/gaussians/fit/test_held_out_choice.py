"""SH bands and Gaussians that gain too little on held-out photographs are dropped, with the measured figures."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings, fit
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.render import render

from .test_fit import around, world


def shown(cloud: GaussianCloud, points: int | None = None) -> Photos:
    """Photographs of a cloud, two of them held out; surveyed are its means, or as many of a ball."""
    shots = [Shot(c, render(cloud, c).to_uint8()) for c in around(16)]
    rng = np.random.default_rng(0)
    means = cloud.means.double().numpy() if points is None else rng.normal(0, 0.4, (points, 3))
    surveyed = Points(means, rng.random((len(means), 3)))
    return Photos(tuple(s for i, s in enumerate(shots) if i % 8), tuple(shots[::8]), surveyed, 3.3)


def shiny(strength: float) -> GaussianCloud:
    """Blobs whose colour changes linearly with the view."""
    cloud = world()
    band = torch.randn(len(cloud), 3, 3, generator=torch.Generator().manual_seed(2)) * strength
    return replace(cloud, sh=torch.cat([cloud.sh, band], dim=1))


@pytest.mark.slow
def test_a_band_stays_where_colours_change_with_the_view_and_not_where_they_do_not() -> None:
    # The last band costs 0.24 to 0.36 dB where no colour changes, and 0.75 to 1.2 dB where all do, whatever the seed.
    gain = 0.5
    settings = Settings(steps=1000, max_gaussians=300, gain=gain)
    dull, bright = (fit(shown(shiny(strength)), settings) for strength in (0.0, 0.9))
    assert dull.scene.cloud.degree == 0 < bright.scene.cloud.degree
    for done in (dull, bright):
        bands = [c for c in done.choices if c.what == "degree"]
        assert [c.taken for c in bands] == [c.psnr[0] - c.psnr[1] < gain for c in bands]
        assert all(c.taken for c in bands[:-1])  # a band below one that is worth its place is not asked
        assert done.scene.cloud.degree == 3 - sum(c.taken for c in bands)


@pytest.mark.slow
def test_gaussians_are_dropped_while_that_costs_less_than_the_gain() -> None:
    photos, gain = shown(world(40), points=600), 0.2
    done = fit(photos, Settings(steps=600, max_gaussians=600, degree=0, gain=gain))
    tenths = done.choices
    assert len(done.scene.cloud) < 500 and len(tenths) > 2
    assert [c.taken for c in tenths] == [c.psnr[0] - c.psnr[1] < gain for c in tenths]
    assert all(c.taken for c in tenths[:-1]) and not tenths[-1].taken
    assert all(a.after == b.before and a.psnr[1] == b.psnr[0] for a, b in pairwise(tenths))
    assert len(done.scene.cloud) == tenths[-1].before
    kept_all = fit(photos, Settings(steps=600, max_gaussians=600, degree=0, gain=None))
    assert len(kept_all.scene.cloud) == 600 and not kept_all.choices
    assert done.quality.psnr > kept_all.quality.psnr - 2 * gain


@pytest.mark.parametrize("wrong", [{"gain": -0.1}, {"gain": float("nan")}, {"gain": None, "degree": "auto"}])
def test_invalid_gains_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(UserError, match="gain of at least 0 dB"):
        Settings(**{"steps": 10, **wrong})  # type: ignore[arg-type]
