"""Export an open_clip model to the folder layout that `onnx:FOLDER` loads:

    python -m scenewright.gaussians.language.encoders.export open_clip:MODEL/PRETRAINED FOLDER

The exported model needs neither open_clip nor torch, only onnxruntime and tokenizers.
"""

from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path
from typing import Any

from ...errors import BackendError, ScenewrightError, UserError
from . import load
from .backends.open_clip import OpenClip

_OPSET = 17
_WORDS = r"'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+"  # CLIP's pre-tokenization before byte pairs


def export(encoder: OpenClip, folder: Path) -> None:
    """Write `vision_model.onnx`, `text_model.onnx`, `tokenizer.json` and the configuration files to an empty folder.

    Raises:
        UserError: the folder is not empty.
        BackendError: the model does not use open_clip's own tokenizer, or has a layer that ONNX does not support.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError(f"{folder} is not an empty folder; name another")
    tokenizer = _tokenizer(encoder.tokenizer)
    length = int(encoder.tokenizer.context_length)
    folder.mkdir(parents=True, exist_ok=True)
    _towers(encoder, folder, length)
    tokenizer.save(str(folder / "tokenizer.json"))
    _write(folder / "tokenizer_config.json", {"model_max_length": length, "pad_token": "!"})
    side = {"height": encoder.image_size, "width": encoder.image_size}
    look = {"crop_size": side, "image_mean": encoder.mean, "image_std": encoder.std, "resample": 3}
    _write(folder / "preprocessor_config.json", look)
    _write(folder / "calibration.json", encoder.calibration.to_json())


def _towers(encoder: OpenClip, folder: Path, length: int) -> None:
    import torch

    class Tower(torch.nn.Module):
        """The image tower or the text tower of the model."""

        def __init__(self, method: str) -> None:
            super().__init__()
            self.model, self.method = encoder.model, method

        def forward(self, x: Any) -> Any:
            return getattr(self.model, self.method)(x)

    pictures = torch.zeros(2, 3, encoder.image_size, encoder.image_size)
    ids = encoder.tokenizer(["a", "a b"]).long()
    assert ids.shape[1] == length
    fast = torch.backends.mha.get_fastpath_enabled()
    torch.backends.mha.set_fastpath_enabled(False)  # its fused attention has no ONNX counterpart
    try:
        for method, example, given, made, name in (
            ("encode_image", pictures, "pixel_values", "image_embeds", "vision_model.onnx"),
            ("encode_text", ids, "input_ids", "text_embeds", "text_model.onnx"),
        ):
            with warnings.catch_warnings(), torch.inference_mode():
                warnings.simplefilter("ignore")  # the exporter recommends its successor, which needs one more package
                torch.onnx.export(
                    Tower(method).eval(), (example,), str(folder / name), input_names=[given], output_names=[made],
                    dynamic_axes={given: {0: "batch"}, made: {0: "batch"}}, opset_version=_OPSET, dynamo=False,
                )  # fmt: skip
    except (RuntimeError, torch.onnx.errors.OnnxExporterError) as error:
        raise BackendError(f"{encoder.name} cannot be written as ONNX: {error}") from error
    finally:
        torch.backends.mha.set_fastpath_enabled(fast)


def _tokenizer(clip: Any) -> Any:
    """open_clip's byte-pair tokenizer in the file format of the `tokenizers` library.

    It lower-cases and normalises white space. The other steps of open_clip (repair of broken Unicode, HTML entities) do
    not matter for names of things and are left out.
    """
    from tokenizers import Regex, Tokenizer, models, normalizers, pre_tokenizers, processors

    if not hasattr(clip, "bpe_ranks"):
        raise BackendError(
            f"only models with open_clip's own tokenizer can be exported, not {type(clip).__name__}; "
            "such models are published with their tokenizer.json, which optimum exports"
        )
    merges = sorted(clip.bpe_ranks, key=lambda pair: clip.bpe_ranks[pair])
    tokenizer = Tokenizer(models.BPE(clip.encoder, merges, end_of_word_suffix="</w>", unk_token="<end_of_text>"))
    tokenizer.normalizer = normalizers.Sequence(
        [normalizers.NFC(), normalizers.Replace(Regex(r"\s+"), " "), normalizers.Strip(), normalizers.Lowercase()]
    )
    tokenizer.pre_tokenizer = pre_tokenizers.Sequence(
        [
            pre_tokenizers.Split(Regex(_WORDS), behavior="removed", invert=True),
            pre_tokenizers.ByteLevel(add_prefix_space=False, use_regex=False),
        ]
    )
    start, end = "<start_of_text>", "<end_of_text>"
    tokenizer.post_processor = processors.TemplateProcessing(
        single=f"{start} $A {end}", special_tokens=[(t, clip.encoder[t]) for t in (start, end)]
    )
    return tokenizer


def _write(path: Path, content: dict[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Write an open_clip model as ONNX.")
    parser.add_argument("model", help="open_clip:MODEL/PRETRAINED or open_clip:DIR")
    parser.add_argument("folder", type=Path, help="a new folder; then use onnx:FOLDER as the encoder")
    options = parser.parse_args()
    try:
        encoder = load(options.model)
        if not isinstance(encoder, OpenClip):
            raise UserError(
                f"{options.model} is not an open_clip model; use open_clip:MODEL/PRETRAINED or open_clip:DIR"
            )
        export(encoder, options.folder)
    except ScenewrightError as error:
        raise SystemExit(f"export: {error}") from error


if __name__ == "__main__":
    main()
