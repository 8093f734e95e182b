"""CLIP as ONNX: the export against the model it came from, the layouts in which others publish, and what is refused."""

from __future__ import annotations

import json
import shutil
import sys
import warnings
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders import export
from scenewright.gaussians.language.encoders.backends.embedded import Embedded
from scenewright.gaussians.language.encoders.backends.open_clip import load as load_open_clip
from scenewright.gaussians.language.encoders.calibration import Calibration, of_clip
from scenewright.gaussians.torchvision_fix import import_torchvision

# Both compute in float32 and add in another order; 2e-7 was measured for these towers and 1.4e-7 for ViT-B/32.
_SAME = 1e-5
_SIDE = 32


def _noise(count: int) -> NDArray[np.uint8]:
    return np.random.default_rng(0).integers(0, 255, (count, 40, 30, 3)).astype(np.uint8)


@pytest.fixture
def copy(exported_clip: Path, tmp_path: Path) -> Path:
    """The exported folder, to be changed."""
    return Path(shutil.copytree(exported_clip, tmp_path / "copy"))


def test_the_export_equals_the_model(saved_clip: Path, exported_clip: Path) -> None:
    model, exported = encoders.load(f"open_clip:{saved_clip}"), encoders.load(f"onnx:{exported_clip}")
    pictures = _noise(20)
    np.testing.assert_allclose(exported.encode_images(pictures), model.encode_images(pictures), atol=_SAME)
    phrases = [*model.vocabulary.names, "Two RED sofas", "café déjà-vu", "it's 42nd 3-D!", "日本 ☃", "very " * 50]
    np.testing.assert_allclose(exported.encode_text(phrases), model.encode_text(phrases), atol=_SAME)
    assert exported.calibration == model.calibration and exported.image_size == model.image_size


@lru_cache
def _tokenizers() -> tuple[Any, Any]:
    from open_clip.tokenizer import SimpleTokenizer

    theirs = SimpleTokenizer(context_length=16)
    return theirs, export._tokenizer(theirs)


@given(st.text(st.characters(codec="ascii", exclude_characters="&<>", exclude_categories=["Cc"]), max_size=60))
@settings(max_examples=200)
def test_the_tokenizer_is_the_same_byte_pairs(text: str) -> None:
    """HTML and control characters are left out, which open_clip mends; no name of a thing holds any."""
    theirs, ours = _tokenizers()
    assert ours.encode(text).ids == [theirs.sot_token_id, *theirs.encode(text), theirs.eot_token_id]


@pytest.fixture(scope="module", autouse=True)
def _models(saved_clip: Path) -> None:
    """Everything here needs the models extra; `saved_clip` skips without it."""


@pytest.mark.parametrize(
    ("image", "text"),
    [
        ("onnx/vision_model.onnx", "onnx/text_model.onnx"),  # transformers.js
        ("image.onnx", "text.onnx"),
        ("onnx/vision_model_quantized.onnx", "text_model_fp16.onnx"),  # only variants are there
    ],
)
def test_common_layouts_are_found(exported_clip: Path, copy: Path, image: str, text: str) -> None:
    (copy / "onnx").mkdir()
    (copy / "vision_model.onnx").rename(copy / image)
    (copy / "text_model.onnx").rename(copy / text)
    moved, original = encoders.load(f"onnx:{copy}"), encoders.load(f"onnx:{exported_clip}")
    np.testing.assert_array_equal(moved.encode_images(_noise(2)), original.encode_images(_noise(2)))
    np.testing.assert_array_equal(moved.encode_text(["chair"]), original.encode_text(["chair"]))


def test_the_full_graph_goes_before_its_variants(copy: Path) -> None:
    (copy / "vision_model_quantized.onnx").write_bytes(b"not looked at")
    assert encoders.load(f"onnx:{copy}").encode_images(_noise(1)).shape == (1, 16)


def test_both_towers_in_one_graph_with_a_mask(exported_clip: Path, tmp_path: Path) -> None:
    """As optimum writes transformers models: `model.onnx`, free axes, an attention mask, logits among the outputs."""
    model = _transformers_clip()
    _write_as_one(model, tmp_path / "model.onnx")
    for name in ("tokenizer.json", "preprocessor_config.json"):
        shutil.copy(exported_clip / name, tmp_path / name)
    (tmp_path / "tokenizer_config.json").write_text(
        json.dumps({"model_max_length": 16, "pad_token": {"content": "<end_of_text>"}})
    )
    encoder = encoders.load(f"onnx:{tmp_path}")
    assert encoder.calibration == of_clip()
    tokens = encoder._tokens(["red chair", "sofa"])  # type: ignore[attr-defined]
    ids, mask = (torch.from_numpy(tokens[k]) for k in ("input_ids", "attention_mask"))
    assert ids.shape == (2, 16) and mask.sum() == 8 + 7 and (ids[0, 7:] == 49407).all()
    pixels = encoder._pixels.prepare(_noise(20))  # type: ignore[attr-defined]
    with torch.inference_mode():
        both = model(input_ids=ids, pixel_values=pixels, attention_mask=mask)
    np.testing.assert_allclose(encoder.encode_text(["red chair", "sofa"]), both.text_embeds.numpy(), atol=_SAME)
    np.testing.assert_allclose(encoder.encode_images(_noise(20)), both.image_embeds.numpy(), atol=_SAME)


def _transformers_clip() -> Any:
    import_torchvision()
    from transformers import CLIPConfig, CLIPModel

    shared = {"intermediate_size": 32, "num_hidden_layers": 1, "num_attention_heads": 2, "projection_dim": 16}
    text = shared | {"hidden_size": 16, "max_position_embeddings": 16, "vocab_size": 49408}
    text |= {"bos_token_id": 49406, "eos_token_id": 49407, "pad_token_id": 49407}
    vision = shared | {"hidden_size": 32, "image_size": _SIDE, "patch_size": 16}
    torch.manual_seed(0)
    config = CLIPConfig(text_config=text, vision_config=vision, projection_dim=16)
    return CLIPModel._from_config(config, attn_implementation="eager").eval()


def _write_as_one(model: Any, path: Path) -> None:
    class Both(torch.nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.model = model

        def forward(self, ids: Any, pixels: Any, mask: Any) -> Any:
            out = self.model(input_ids=ids, pixel_values=pixels, attention_mask=mask)
            return out.logits_per_image, out.text_embeds, out.image_embeds

    example = (torch.full((2, 8), 49407), torch.zeros(1, 3, _SIDE, _SIDE), torch.ones(2, 8, dtype=torch.int64))
    axes = {"input_ids": {0: "t", 1: "l"}, "attention_mask": {0: "t", 1: "l"}, "pixel_values": {0: "b"}}
    axes |= {"logits_per_image": {0: "b", 1: "t"}, "text_embeds": {0: "t"}, "image_embeds": {0: "b"}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter announces its successor; the traced branches are fixed here
        torch.onnx.export(
            Both().eval(), example, str(path), input_names=["input_ids", "pixel_values", "attention_mask"],
            output_names=["logits_per_image", "text_embeds", "image_embeds"], dynamic_axes=axes, opset_version=17,
            dynamo=False,
        )  # fmt: skip


@pytest.mark.parametrize(
    "said", [{"size": {"shortest_edge": 32}}, {"size": 32}, {"crop_size": {"height": 32, "width": 32}, "size": 40}]
)
def test_every_spelling_of_the_side_is_read(copy: Path, said: dict[str, Any]) -> None:
    look = {"image_mean": [0.5] * 3, "image_std": [0.5] * 3, "resample": 2}
    (copy / "preprocessor_config.json").write_text(json.dumps(look | said))
    encoder = encoders.load(f"onnx:{copy}")
    assert encoder.image_size == 32
    assert encoder._pixels.resample == "bilinear"  # type: ignore[attr-defined]


def test_what_the_config_says_of_pixels_is_done_and_in_the_fingerprint(exported_clip: Path, copy: Path) -> None:
    (copy / "preprocessor_config.json").write_text(json.dumps({"crop_size": 32, "do_normalize": False}))
    plain, original = encoders.load(f"onnx:{copy}"), encoders.load(f"onnx:{exported_clip}")
    assert plain.fingerprint != original.fingerprint
    white = np.full((1, 32, 32, 3), 255, np.uint8)
    pixels = plain._pixels.prepare(white)  # type: ignore[attr-defined]
    assert (pixels == 1).all()
    expected = (1 - np.array([0.4, 0.45, 0.5])) / np.array([0.2, 0.21, 0.22])
    shown = original._pixels.prepare(white)[0, :, 0, 0]  # type: ignore[attr-defined]
    np.testing.assert_allclose(shown.numpy(), expected, rtol=1e-6)


def test_a_rule_beside_the_model_is_used(copy: Path) -> None:
    (copy / "calibration.json").write_text(json.dumps({"scale": 30.0, "threshold": 0.4}))
    assert encoders.load(f"onnx:{copy}").calibration == Calibration(30.0, 0.4)


def test_a_graph_that_its_files_do_not_fit_says_so(copy: Path) -> None:
    said = json.loads((copy / "preprocessor_config.json").read_text())
    said["size"] = said["crop_size"] = 8  # the tower's patches are laid out for another side
    (copy / "preprocessor_config.json").write_text(json.dumps(said))
    with pytest.raises(BackendError, match="of another model"):
        encoders.load(f"onnx:{copy}").encode_images(_noise(1))


def test_what_cannot_be_loaded_is_said(exported_clip: Path, tmp_path: Path, copy: Path) -> None:
    with pytest.raises(BackendError, match="name the folder"):
        encoders.load("onnx:")
    with pytest.raises(BackendError, match=r"vision_model\.onnx, .*tokenizer\.json.* missing; make such a folder"):
        encoders.load(f"onnx:{tmp_path / 'nowhere'}")
    with pytest.raises(BackendError, match="use embedded:"):
        encoders.load(f"onnx:{encoders.weights_folder()}")
    (copy / "tokenizer.json").write_text("{}")
    with pytest.raises(BackendError, match="not a tokenizer"):
        encoders.load(f"onnx:{copy}").encode_text(["chair"])
    (copy / "preprocessor_config.json").write_text("{}")
    with pytest.raises(BackendError, match="lacks a valid size"):
        encoders.load(f"onnx:{copy}").encode_images(_noise(1))
    (copy / "preprocessor_config.json").write_text("[")
    with pytest.raises(BackendError, match="is not valid JSON"):
        encoders.load(f"onnx:{copy}").encode_images(_noise(1))
    (copy / "vision_model.onnx").write_bytes(b"not a graph")
    shutil.copy(exported_clip / "preprocessor_config.json", copy)
    with pytest.raises(BackendError, match=r"vision_model\.onnx is not a usable ONNX model"):
        encoders.load(f"onnx:{copy}").encode_images(_noise(1))


@pytest.mark.parametrize(
    ("given", "made", "said"),
    [
        ("images", "image_embeds", "needs the input 'images'"),
        ("pixel_values", "last_hidden_state", "with the projection"),
    ],
)
def test_foreign_graphs_are_said(copy: Path, given: str, made: str, said: str) -> None:
    class Patches(torch.nn.Module):
        def forward(self, x: torch.Tensor) -> torch.Tensor:
            return x.mean(dim=1)  # [B, S, S]: no vectors

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            Patches(), (torch.zeros(1, 3, 32, 32),), str(copy / "vision_model.onnx"), input_names=[given],
            output_names=[made], dynamo=False,
        )  # fmt: skip
    with pytest.raises(BackendError, match=said):
        encoders.load(f"onnx:{copy}").encode_images(_noise(1))


def test_the_pooled_output_is_taken_where_it_is_the_only_vector(copy: Path) -> None:
    """As SigLIP's towers are published: hidden states beside one pooled row a picture."""

    class Pooled(torch.nn.Module):
        def forward(self, x: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
            return x[:, 0], x.mean(dim=2).flatten(1)[:, :16]

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            Pooled(), (torch.zeros(2, 3, 32, 32),), str(copy / "vision_model.onnx"), input_names=["pixel_values"],
            output_names=["last_hidden_state", "pooler_output"], dynamic_axes={"pixel_values": {0: "b"}}, dynamo=False,
        )  # fmt: skip
    encoder = encoders.load(f"onnx:{copy}")
    pictures = _noise(3)
    pooled = encoder._pixels.prepare(pictures).mean(dim=2).flatten(1)[:, :16]  # type: ignore[attr-defined]
    expected = torch.nn.functional.normalize(pooled).numpy()
    np.testing.assert_allclose(encoder.encode_images(pictures), expected, atol=_SAME)


def test_a_missing_library_names_the_fix(exported_clip: Path, uninstalled: Callable[[str], None]) -> None:
    uninstalled("tokenizers")
    with pytest.raises(BackendError, match=r"pip install 'scenewright\[models\]'"):
        encoders.load(f"onnx:{exported_clip}").encode_text(["chair"])


def test_the_command_exports_into_empty_folders_only(
    saved_clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(*arguments: str) -> None:
        monkeypatch.setattr(sys, "argv", ["export", *arguments])
        export.main()

    run(f"open_clip:{saved_clip}", str(tmp_path / "new"))
    assert encoders.load(f"onnx:{tmp_path / 'new'}").encode_text(["chair"]).shape == (1, 16)
    with pytest.raises(SystemExit, match="not an empty folder"):
        run(f"open_clip:{saved_clip}", str(tmp_path / "new"))
    with pytest.raises(SystemExit, match="is not an open_clip model"):
        run("embedded", str(tmp_path / "other"))
    assert not (tmp_path / "other").exists()


def test_other_tokenizers_are_refused_before_anything_is_written(saved_clip: Path, tmp_path: Path) -> None:
    encoder = load_open_clip(str(saved_clip))
    vars(encoder)["tokenizer"] = object()
    with pytest.raises(BackendError, match="only models with open_clip's own tokenizer"):
        export.export(encoder, tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_folders_of_our_own_training_stay_loadable() -> None:
    assert isinstance(encoders.load(f"embedded:{encoders.weights_folder()}"), Embedded)
