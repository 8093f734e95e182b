"""bench files on a tiny scene: every format is told, and the scene is what it says."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.benchmarks import files as bench
from scenewright.gaussians import harmonics
from scenewright.gaussians.rotations import to_matrix


@pytest.mark.slow
def test_every_format_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "folder", lambda name: None)
    monkeypatch.setattr(bench, "QUICK_GLOSSY", 600)
    monkeypatch.setattr(bench, "QUICK_LARGE", 1000)
    result = bench.run(quick=True)
    found = {metric.key: metric.value for metric in result.metrics}
    for name in bench._formats():
        assert found[f"glossy.{name}.psnr"] > 25 and found[f"glossy.{name}.bytes"] > 600
        assert found[f"1k.{name}.read"] > 0
    assert found["glossy.ply.psnr"] > 100 > found["glossy.sog.psnr"]
    assert result.cost == "bytes" and any("scenes" in note for note in result.notes)
    assert {(p.method, p.setting) for p in result.points} == {
        (n, s) for n in bench._formats() for s in ("full", "half")
    }
    assert [p.bytes for p in result.front()] == sorted(p.bytes for p in result.front())


def test_the_glossy_scene_shines_where_light_is_mirrored() -> None:
    cloud = bench.glossy(2000)
    light = np.array([0.3, -0.8, 0.5]) / np.linalg.norm([0.3, -0.8, 0.5])
    lit = cloud.sh[:, 1:].norm(dim=(1, 2)) > 0.2
    assert 0.1 < float(lit.float().mean()) < 0.9
    sh = cloud.sh[lit][:1]
    directions = np.random.default_rng(0).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    colors = harmonics.evaluate(sh.repeat(500, 1, 1).double(), torch.from_numpy(directions)).mean(dim=1)
    normal = to_matrix(cloud.quats[lit][:1])[0, :, 2].double().numpy()
    mirrored = 2 * (normal @ light) * normal - light
    assert directions[int(colors.argmax())] @ -mirrored > 0.8  # seen from there, that is: from eye to Gaussian
