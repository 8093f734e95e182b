"""Fixtures for tests of scenes.

Hand-made worlds for tests of segmentation. The smallest real CLIP: random weights in two one-layer towers, saved as
open_clip saves models and exported as ONNX. And gsplat replaced by its stand-in.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import gsplat_standin
import pytest
import torch
from painted_world import World

from scenewright.gaussians.render.cuda import splatting


@pytest.fixture
def world() -> type[World]:
    """The builder of hand-made clouds."""
    return World


CLIP = {
    "embed_dim": 16,
    "vision_cfg": {"image_size": 32, "layers": 1, "width": 32, "patch_size": 16, "head_width": 16},
    "text_cfg": {"context_length": 16, "vocab_size": 49408, "width": 16, "heads": 2, "layers": 1},
}


@pytest.fixture(scope="session")
def saved_clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a random CLIP, as open_clip saves them."""
    if importlib.util.find_spec("open_clip") is None:
        pytest.skip("open_clip is not installed (pip install 'scenewright[models]')")
    from scenewright.gaussians.torchvision_fix import import_torchvision

    import_torchvision()
    import open_clip
    from safetensors.torch import save_file

    torch.manual_seed(3)
    model = open_clip.CLIP(**CLIP)
    folder = tmp_path_factory.mktemp("clip")
    preprocess = {"mean": [0.4, 0.45, 0.5], "std": [0.2, 0.21, 0.22]}
    (folder / "open_clip_config.json").write_text(json.dumps({"model_cfg": CLIP, "preprocess_cfg": preprocess}))
    save_file({k: v.contiguous() for k, v in model.state_dict().items()}, folder / "open_clip_model.safetensors")
    return folder


@pytest.fixture(scope="session")
def exported_clip(saved_clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same model as ONNX."""
    from scenewright.gaussians.language.encoders.backends.open_clip import load
    from scenewright.gaussians.language.encoders.export import export

    folder = tmp_path_factory.mktemp("exported")
    export(load(str(saved_clip)), folder)
    return folder


@pytest.fixture
def gsplat(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The stand-in where gsplat would be, and the CPU where the GPU would be."""
    module = ModuleType("gsplat")
    module.__spec__ = importlib.machinery.ModuleSpec("gsplat", None)
    module.rasterization = gsplat_standin.rasterization  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "gsplat", module)
    monkeypatch.setattr(splatting, "DEVICE", "cpu")
    splatting._kernels.cache_clear()
    yield module
    splatting._kernels.cache_clear()
