"""Rounded values lie on the formats' own steps: writing them changes nothing more and takes fewer bytes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files.formats.morton import morton_sorted
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.slim.encoding import Files
from scenewright.gaussians.slim.rounding import Steps, round_for_sog, round_for_spz, steps_for

COARSE = Steps(means=2e-3, log_scales=0.1, quats=0.03, opacities=0.03, sh=0.05)


def cloud(count: int = 2000) -> GaussianCloud:
    g = torch.Generator().manual_seed(9)
    return GaussianCloud.create(
        torch.randn(count, 3, generator=g), torch.nn.functional.normalize(torch.randn(count, 4, generator=g)),
        torch.exp(torch.randn(count, 3, generator=g) * 0.5 - 4), 0.05 + 0.9 * torch.rand(count, generator=g),
        torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip


def again(cloud: GaussianCloud, folder: Path, suffix: str) -> tuple[GaussianCloud, int]:
    scene, coder = morton_sorted(Scene(cloud)), Files(folder, suffix)
    data = coder.encode(scene)
    return coder.decode(data).cloud[torch.argsort(scene.cloud.ids)], len(data)


def test_sog_keeps_rounded_values(tmp_path: Path) -> None:
    rounded = round_for_sog(cloud(), COARSE)
    back, size = again(rounded, tmp_path, ".sog")
    assert size < 0.8 * again(cloud(), tmp_path, ".sog")[1]
    assert float((back.opacities - rounded.opacities).abs().max()) < 1e-6
    assert float((back.scales.log() - rounded.scales.log()).abs().max()) < 1e-4
    assert float((back.sh - rounded.sh).abs().max()) < 1e-4
    assert float((back.quats * rounded.quats).sum(dim=1).abs().min()) > 1 - 1e-4  # q and -q are the same rotation
    span = float(np.ptp(np.log1p(np.abs(rounded.means.numpy())) * np.sign(rounded.means.numpy())))
    assert float((back.means - rounded.means).abs().max()) < span / 65535 * 4  # a step, times at most 1 + |x|


def test_values_move_by_half_a_step_at_most() -> None:
    given, rounded = cloud(), round_for_sog(cloud(), COARSE)
    logs = [torch.sign(c.means) * torch.log1p(c.means.abs()) for c in (given, rounded)]
    assert float((logs[0] - logs[1]).abs().max()) <= COARSE.means / 2 + 1e-4
    assert float((given.scales.log() - rounded.scales.log()).abs().max()) <= COARSE.log_scales / 2 + 1e-6
    assert float((given.sh - rounded.sh).abs().max()) <= COARSE.sh / 2 + 1e-6
    assert float((given.opacities - rounded.opacities).abs().max()) <= COARSE.opacities / 2 + 1 / 255
    assert torch.allclose(rounded.quats.norm(dim=1), torch.ones(len(rounded)), atol=1e-6)


def test_spz_takes_fewer_bytes(tmp_path: Path) -> None:
    rounded = round_for_spz(cloud(), COARSE)
    assert again(rounded, tmp_path, ".spz")[1] < 0.95 * again(cloud(), tmp_path, ".spz")[1]
    assert float((rounded.means - cloud().means).abs().max()) <= COARSE.means / 2 + 1e-6


def test_no_error_allows_no_step() -> None:
    slopes = dict.fromkeys(("means", "log_means", "log_scales", "quats", "opacities", "sh"), 2.0)
    assert steps_for(slopes, 1000, 10, 0.0, True) == Steps()
    one, four = (steps_for(slopes, 1000, 10, error, True) for error in (1e-4, 4e-4))
    assert four.sh == 2 * one.sh > 0  # the error grows with the square of the step
