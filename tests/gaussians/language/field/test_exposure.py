"""A dim scene is segmented and pictured as if it were lit; a lit one is left alone."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from three_balls import balls

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.language.field.exposure import LIT, MOST, exposed, gain_of
from scenewright.gaussians.language.field.group_table import vectors_of
from scenewright.gaussians.scene import Frame

NUMBERS = count()


class Recorder:
    """Keeps the pictures that it is shown."""

    dim = 2
    image_size = 16

    def __init__(self) -> None:
        self.fingerprint = f"recorder:{next(NUMBERS)}"  # pictures that an encoder saw before are not shown to it again
        self.shown: list[NDArray[np.uint8]] = []

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        self.shown.append(images)
        return np.tile(np.array([[0.6, 0.8]], np.float32), (len(images), 1))


def dimmed(cloud: GaussianCloud, factor: float) -> GaussianCloud:
    return exposed(cloud, factor)


def pictures(cloud: GaussianCloud) -> NDArray[np.int64]:
    encoder = Recorder()
    vectors_of(encoder, [cloud[cloud.group == i] for i in range(3)], Frame(), cloud)  # type: ignore[arg-type]
    return np.concatenate(encoder.shown).astype(np.int64)


def test_a_lit_scene_is_left_alone() -> None:
    cloud = balls(degree=1).cloud
    assert gain_of(cloud) == 1.0 and exposed(cloud, 1.0) is cloud
    assert gain_of(cloud[:0]) == 1.0


@pytest.mark.parametrize("factor", [0.25, 0.1])
def test_a_dim_one_is_shown_as_bright_as_another(factor: float) -> None:
    cloud = balls(degree=1).cloud
    dim = dimmed(cloud, factor)
    lit = exposed(dim, gain_of(dim))
    assert gain_of(lit) == 1.0
    luma = (lit.sh[lit.opacities > 0.08][:, 0] * SH_C0 + 0.5).clamp(0, 1) @ torch.tensor([0.2126, 0.7152, 0.0722])
    assert float(luma.quantile(0.95)) == pytest.approx(LIT, abs=0.02)
    # The pictures are those of the lit scene at that exposure, to a few steps of 255: the same shapes and shades.
    same = exposed(cloud, gain_of(dim) * factor)
    assert np.abs(pictures(dim) - pictures(same)).max() <= 2


def test_a_black_scene_gets_a_finite_gain() -> None:
    cloud = dimmed(balls().cloud, 0.0)
    assert gain_of(cloud) == MOST
    assert gain_of(cloud.replace(sh=torch.full_like(cloud.sh, float("nan")))) == 1.0
