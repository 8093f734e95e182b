"""Fixtures for tests of language models: models of random weights, built on the spot."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path

import pytest
import tiny_models

from scenewright.gaussians.torchvision_fix import import_torchvision


@pytest.fixture(scope="session")
def tiny_llama(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as save_pretrained writes it: two layers of a Llama, 400 tokens, a chat template."""
    for package in ("transformers", "tokenizers", "llguidance"):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed (pip install 'scenewright[models]')")
    if importlib.util.find_spec("torchvision") is not None:
        import_torchvision()
    folder = tmp_path_factory.mktemp("llama")
    tiny_models.save_llama(folder)
    return folder


@pytest.fixture(scope="session")
def tiny_llava(tiny_llama: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a LLaVA that reads pictures of 28 x 28 pixels."""
    if importlib.util.find_spec("torchvision") is None:
        pytest.skip("torchvision is not installed (pip install 'scenewright[models]')")
    folder = tmp_path_factory.mktemp("llava")
    tiny_models.save_llava(folder, tiny_llama)
    return folder


@pytest.fixture
def copied(tiny_llama: Path, tmp_path: Path) -> Path:
    """A folder of one's own to break."""
    return Path(shutil.copytree(tiny_llama, tmp_path / "model"))
