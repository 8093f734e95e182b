"""Real CLIP back ends, with a tiny random model built on the spot; and the cure for torchvision beside CPU torch."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians import torchvision_fix
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language import encoders


@pytest.fixture(scope="module")
def clip(saved_clip: Path) -> encoders.Encoder:
    return encoders.load(f"open_clip:{saved_clip}")


def test_it_reads_any_word(clip: encoders.Encoder) -> None:
    assert clip.image_size == 32 and clip.dim == 16
    assert clip.unknown_words("quixotic zyzzyva") == () and clip.knows("zyzzyva") and not clip.knows("")
    assert "chair" in clip.vocabulary.names


def test_the_saved_preprocessing_is_used_and_in_the_fingerprint(
    saved_clip: Path, clip: encoders.Encoder, tmp_path: Path
) -> None:
    import open_clip

    again = encoders.load(f"open_clip:{saved_clip}")
    assert again.fingerprint == clip.fingerprint
    config = json.loads((saved_clip / "open_clip_config.json").read_text())
    config["preprocess_cfg"]["mean"] = [0.1, 0.1, 0.1]
    (tmp_path / "open_clip_config.json").write_text(json.dumps(config))
    (tmp_path / "open_clip_model.safetensors").write_bytes((saved_clip / "open_clip_model.safetensors").read_bytes())
    other = encoders.load(f"open_clip:{tmp_path}")
    assert other.fingerprint != clip.fingerprint
    # The reference: open_clip's own transform on a picture that needs no resampling.
    picture = np.random.default_rng(1).integers(0, 255, (1, 32, 32, 3)).astype(np.uint8)
    from PIL import Image

    transform = open_clip.image_transform(32, False, mean=(0.4, 0.45, 0.5), std=(0.2, 0.21, 0.22))
    model: Any = clip.model  # type: ignore[attr-defined]
    with torch.inference_mode():
        expected = model.encode_image(transform(Image.fromarray(picture[0]))[None], normalize=True).numpy()
    np.testing.assert_allclose(clip.encode_images(picture), expected, atol=1e-5)  # float32, same operations


@pytest.mark.parametrize("spec", ["open_clip:", "open_clip:No-Such-Model/x", "open_clip:ViT-B-32/no_such_tag"])
def test_what_cannot_be_loaded_is_said(saved_clip: Path, spec: str) -> None:
    with pytest.raises(BackendError, match="open_clip"):
        encoders.load(spec)


def test_a_broken_folder_is_said(saved_clip: Path, tmp_path: Path) -> None:
    with pytest.raises(BackendError, match="not a saved open_clip model"):
        encoders.load(f"open_clip:{tmp_path}")


def test_a_missing_extra_names_the_fix(monkeypatch: pytest.MonkeyPatch, uninstalled: Callable[[str], None]) -> None:
    uninstalled("open_clip")
    monkeypatch.setattr("scenewright.gaussians.language.encoders.backends.open_clip.import_torchvision", lambda: None)
    with pytest.raises(BackendError, match=r"pip install 'scenewright\[models\]'"):
        encoders.load("open_clip:ViT-B-32/openai")


def test_torchvision_imports_beside_cpu_torch() -> None:
    if importlib.util.find_spec("torchvision") is None:
        pytest.skip("torchvision is not installed (pip install 'scenewright[models]')")
    torchvision = torchvision_fix.import_torchvision()
    assert torchvision.transforms.Compose is not None
    assert torchvision_fix.import_torchvision() is torchvision


def _failing_once(monkeypatch: pytest.MonkeyPatch, errors: list[Exception | None]) -> list[str]:
    """Make `import torchvision` raise the given errors in turn (None: succeed); the operators declared meanwhile."""
    declared: list[str] = []
    monkeypatch.setattr(torchvision_fix, "declare_operators", lambda: declared.append("called") or ("nms",))

    def attempt(name: str) -> Any:
        error = errors.pop(0)
        if error is not None:
            raise error
        return torch

    monkeypatch.setattr(torchvision_fix.importlib, "import_module", attempt)
    monkeypatch.setattr(torchvision_fix, "_forget", lambda package: None)
    return declared


def test_the_cure_is_given_only_for_its_illness(monkeypatch: pytest.MonkeyPatch) -> None:
    declared = _failing_once(monkeypatch, [RuntimeError("operator torchvision::nms does not exist"), None])
    torchvision_fix.import_torchvision()
    assert declared == ["called"]
    declared = _failing_once(monkeypatch, [RuntimeError("something else entirely")])
    with pytest.raises(BackendError, match="something else entirely"):
        torchvision_fix.import_torchvision()
    assert declared == []


def test_a_lasting_illness_or_absence_names_the_fix(monkeypatch: pytest.MonkeyPatch) -> None:
    trouble = RuntimeError("operator torchvision::nms does not exist")
    _failing_once(monkeypatch, [trouble, trouble])
    with pytest.raises(BackendError, match="one command"):
        torchvision_fix.import_torchvision()
    _failing_once(monkeypatch, [ModuleNotFoundError("No module named 'torchvision'")])
    with pytest.raises(BackendError, match=r"scenewright\[models\]"):
        torchvision_fix.import_torchvision()
