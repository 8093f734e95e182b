"""Pipelines of diffusers with random weights: every call is the real one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.gaussians.dream.denoisers import load
from scenewright.gaussians.dream.dreaming import Settings, dream
from scenewright.gaussians.dream.sds import Denoiser, distilled
from scenewright.gaussians.dream.start import sphere
from scenewright.gaussians.dream.views import view
from scenewright.gaussians.errors import BackendError, UserError


@pytest.fixture(scope="module")
def pipelines(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with "noise", "velocity" and "picture"."""
    pytest.importorskip("diffusers", reason="pip install 'scenewright[diffusion]'")
    from tiny_diffusion import save_image_variation, save_stable_diffusion

    from scenewright.gaussians.torchvision_fix import import_torchvision

    import_torchvision()
    folder = tmp_path_factory.mktemp("pipelines")
    save_stable_diffusion(folder / "noise")
    save_stable_diffusion(folder / "velocity", "v_prediction")
    save_stable_diffusion(folder / "sample", "sample")
    save_image_variation(folder / "picture")
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (40, 30, 4), dtype=np.uint8)).save(folder / "chair.png")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["noise", "velocity", "picture"])
def test_a_pipeline_gives_a_gradient(pipelines: Path, kind: str) -> None:
    picture = pipelines / "chair.png" if kind == "picture" else None
    model = load(f"diffusers:{pipelines / kind}", "a red chair", picture, 10.0)
    assert isinstance(model, Denoiser)
    assert model.side == 32 and model.alphas.shape == (1000,)
    shown = np.random.default_rng(1).uniform(0, 1, (24, 24, 3)).astype(np.float32)
    off, found = distilled(model, shown, view(0, 10, 24), 0.3, np.random.default_rng(2))
    again = distilled(model, shown, view(0, 10, 24), 0.3, np.random.default_rng(2))[1]
    behind = distilled(model, shown, view(180, 10, 24), 0.3, np.random.default_rng(2))[1]
    assert off > 0 and np.isfinite(found).all() and np.abs(found).max() > 0
    assert np.array_equal(found, again)
    assert not np.array_equal(found, behind)  # the words, or the weight of the picture, are others


@pytest.mark.slow
def test_the_gradient_of_a_pipeline_agrees_with_differences(pipelines: Path) -> None:
    """Through the VAE: the gradient is that of the latents times a constant residual."""
    model = load(f"diffusers:{pipelines / 'noise'}", "a red chair", None, 1.0)
    rng = np.random.default_rng(4)
    picture = torch.from_numpy(rng.uniform(0.2, 0.8, (1, 3, 32, 32)).astype(np.float32)).requires_grad_()
    residual = torch.from_numpy(rng.standard_normal((1, 4, 16, 16)).astype(np.float32))
    (found,) = torch.autograd.grad((model.encode(picture) * residual).sum(), picture)
    way = torch.from_numpy(rng.standard_normal((1, 3, 32, 32)).astype(np.float32))
    with torch.no_grad():
        ahead, back = (float((model.encode(picture + s * 1e-2 * way).double() * residual).sum()) for s in (1, -1))
    assert float((found * way).sum()) == pytest.approx((ahead - back) / 2e-2, rel=0.02)


@pytest.mark.slow
def test_a_dream_through_a_pipeline(pipelines: Path) -> None:
    model = load(f"diffusers:{pipelines / 'noise'}", "a red chair")
    start = sphere(np.random.default_rng(0), 100)
    done = dream(model, start, Settings(steps=3, size=32, max_gaussians=200))
    assert done.steps == 3 and bool(torch.isfinite(done.cloud.means).all())


@pytest.mark.slow
def test_a_photograph_is_seen_upright(pipelines: Path, tmp_path: Path) -> None:
    shown = Image.fromarray(np.random.default_rng(0).integers(0, 255, (8, 12, 3), dtype=np.uint8))
    shown.save(tmp_path / "upright.png")
    tag = shown.getexif()
    tag[0x0112] = 6  # turned by a quarter, as a phone writes it
    shown.transpose(Image.Transpose.ROTATE_90).save(tmp_path / "turned.png", exif=tag)
    spec = f"diffusers:{pipelines / 'picture'}"
    names = {load(spec, "", tmp_path / f"{name}.png", 3.0).name for name in ("upright", "turned")}
    assert len(names) == 1  # the digest of what is shown is a part of it


def test_pipelines_that_do_not_fit_are_named(pipelines: Path) -> None:
    with pytest.raises(BackendError, match="StableDiffusionPipeline"):
        load(f"diffusers:{pipelines / 'picture'}", "a red chair")
    with pytest.raises(BackendError, match="ImageVariation"):
        load(f"diffusers:{pipelines / 'noise'}", "a red chair", pipelines / "chair.png")
    with pytest.raises(BackendError, match="'sample'"):
        load(f"diffusers:{pipelines / 'sample'}", "a red chair")
    with pytest.raises(UserError, match="cannot read the picture"):
        load(f"diffusers:{pipelines / 'picture'}", "a red chair", pipelines / "nowhere.png")


def test_unknown_models_are_named(tmp_path: Path) -> None:
    with pytest.raises(BackendError, match="use diffusers:FOLDER"):
        load("onnx:here", "a red chair")
    with pytest.raises(BackendError, match="model_index"):
        load(f"diffusers:{tmp_path}", "a red chair")
