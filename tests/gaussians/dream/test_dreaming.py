"""Dreams: they reach what the denoiser knows, the same every time, also after an interruption."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.benchmarks._dream.knowing import Knowing
from scenewright.gaussians.assets import make
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.dream import dreaming
from scenewright.gaussians.dream.dreaming import Settings, dream
from scenewright.gaussians.dream.prior import kind_of, library_thing, standing, start_for
from scenewright.gaussians.dream.start import form, sphere
from scenewright.gaussians.dream.views import Asked, view
from scenewright.gaussians.errors import BackendError, FileError, UserError
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.render import render

SIDE = 32
SETTINGS = Settings(steps=300, size=SIDE, max_gaussians=1500)


def _target() -> GaussianCloud:
    """A red block beside a blue ball."""
    rng = np.random.default_rng(3)
    block = rng.uniform(-0.3, 0.3, (400, 3)) + np.array([-0.4, 0, 0])
    ball = rng.normal(size=(400, 3))
    ball = 0.3 * ball / np.linalg.norm(ball, axis=1, keepdims=True) + np.array([0.4, 0, 0.2])
    rgb = torch.tensor([[0.8, 0.1, 0.1], [0.1, 0.2, 0.8]]).repeat_interleave(400, 0)
    return GaussianCloud.create(
        torch.from_numpy(np.concatenate([block, ball]).astype(np.float32)),
        torch.tensor([[1.0, 0, 0, 0]]).repeat(800, 1), torch.full((800, 3), 0.05), torch.full((800,), 0.9),
        color_to_dc(rgb)[:, None],
    )  # fmt: skip


def _psnr(cloud: GaussianCloud, target: GaussianCloud) -> float:
    off = []
    for azimuth, elevation in ((20, 10), (110, 40), (200, 0), (290, 60)):
        asked = view(azimuth, elevation, SIDE)
        a, b = (render(c, asked.camera, asked.background).rgb.clamp(0, 1) for c in (cloud, target))
        off.append(float((a - b).square().mean()))
    return float(-10 * np.log10(np.mean(off)))


def _same(a: GaussianCloud, b: GaussianCloud) -> bool:
    return all(torch.equal(x, getattr(b, name)) for name, x in a.columns())


@pytest.mark.slow
def test_a_sphere_becomes_what_the_denoiser_knows() -> None:
    target, start = _target(), sphere(np.random.default_rng(0), 800)
    done = dream(Knowing(target, SIDE), start, SETTINGS)
    assert _psnr(start.cloud, target) < 15
    assert _psnr(done.cloud, target) > 24
    assert done.steps == 300
    assert len(done.cloud) <= SETTINGS.max_gaussians


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes_also_after_an_interruption(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, start = _target(), sphere(np.random.default_rng(0), 300)
    settings, kept = replace(SETTINGS, steps=160), tmp_path / "dream.checkpoint"
    whole = dream(Knowing(target, SIDE), start, settings)
    monkeypatch.setattr(dreaming, "CHECKPOINT_EVERY", 0.0)

    class Killed(Knowing):
        asked = 0

        def noise(self, *args: object) -> torch.Tensor:
            self.asked += 1
            if self.asked > 130:
                raise KeyboardInterrupt
            return super().noise(*args)  # type: ignore[arg-type]

    with pytest.raises(KeyboardInterrupt):
        dream(Killed(target, SIDE), start, settings, checkpoint_path=kept)
    resumed = dream(Knowing(target, SIDE), start, settings, checkpoint_path=kept)
    assert _same(whole.cloud, resumed.cloud)
    with pytest.raises(FileError, match="another dream"):
        dream(Knowing(target, SIDE), start, replace(settings, seed=1), checkpoint_path=kept)
    kept.write_bytes(b"torn")
    with pytest.raises(FileError, match="delete it"):
        dream(Knowing(target, SIDE), start, settings, checkpoint_path=kept)


class _Silent(Knowing):
    """A model whose weights are damaged."""

    def noise(self, noisy: torch.Tensor, step: int, asked: Asked) -> torch.Tensor:
        return torch.full_like(noisy, torch.nan)


def test_a_model_without_finite_numbers_ends_the_dream() -> None:
    with pytest.raises(BackendError, match="no finite numbers"):
        dream(_Silent(_target(), SIDE), sphere(np.random.default_rng(0), 100), SETTINGS)


def test_a_form_keeps_its_place_and_becomes_paler() -> None:
    asset = make("armchair", 0, color="red").cloud
    start = form(asset, 2000, np.random.default_rng(0))
    assert len(start.cloud) == 2000
    assert float(start.cloud.means.norm(dim=1).max()) <= 1.0
    back = start.cloud.means * start.size + torch.tensor(start.middle)
    low, high = asset.means.min(dim=0).values, asset.means.max(dim=0).values
    assert bool((back >= low - 1e-4).all()) and bool((back <= high + 1e-4).all())


def test_nothing_to_start_from_is_told() -> None:
    rng = np.random.default_rng(0)
    with pytest.raises(UserError, match="no finite Gaussians"):
        form(GaussianCloud.empty(0), 10, rng)
    point = _target()[torch.tensor([0, 0, 0])]
    with pytest.raises(UserError, match="no extent"):
        form(point, 10, rng)
    with pytest.raises(UserError, match="--from sphere"):
        start_for("procedural", "an astronaut", 10, rng)
    with pytest.raises(FileError):
        start_for("nowhere.glb", "an astronaut", 10, rng)


def test_prompts_name_kinds() -> None:
    prompts = "a red armchair with wooden legs", "an old oak coffee table, carved", "an astronaut on a horse"
    kinds = [kind_of(prompt) for prompt in prompts]
    assert [None if kind is None else kind.name for kind in kinds] == ["armchair", "coffee table", None]
    assert start_for("auto", "an astronaut", 50, np.random.default_rng(0))[1] == "a sphere"
    assert start_for("auto", "a blue armchair", 50, np.random.default_rng(0))[1] == "the library's armchair"


def test_a_dreamt_thing_stands_in_metres() -> None:
    cloud = form(make("armchair", 0).cloud, 3000, np.random.default_rng(0)).cloud
    scene = standing(cloud, "a red armchair")
    assert scene.frame.metres_per_unit == 1.0
    low, high = scene.cloud.means.min(dim=0).values, scene.cloud.means.max(dim=0).values
    assert abs(float(low[2])) < 0.05
    assert 0.6 < float(high[2]) < 1.3
    tall = standing(cloud, "a red armchair", height=2.0)
    assert float(tall.cloud.means[:, 2].max()) == pytest.approx(2.0, abs=0.1)
    odd = standing(cloud, "an astronaut").cloud.means
    assert float((odd.max(dim=0).values - odd.min(dim=0).values).max()) == pytest.approx(1.0, abs=0.05)


def test_the_library_stands_in_where_there_is_no_model() -> None:
    assert len(library_thing("a red armchair").cloud) > 100
    with pytest.raises(UserError, match="nothing like"):
        library_thing("an astronaut")


@pytest.mark.parametrize("wrong", [{}, {"steps": 0}, {"seconds": float("nan")}, {"steps": 1, "seconds": 1.0},
                                   {"steps": 1, "size": 4}, {"steps": 1, "max_gaussians": 0}])  # fmt: skip
def test_settings_that_make_no_sense(wrong: dict[str, float]) -> None:
    with pytest.raises(UserError):
        Settings(**wrong)  # type: ignore[arg-type]
