"""CLIP models as two ONNX graphs and a tokenizer, without torch: `onnx:FOLDER`.

The folder has the layout in which models are published (transformers.js, Hugging Face optimum), or that of `export.py`:

- `vision_model.onnx` and `text_model.onnx` (or `image.onnx` and `text.onnx`), in the folder or in `onnx/` below it; of
  `_fp16` and `_quantized` variants the first that exists; or one `model.onnx` that holds both towers, as
  `optimum-cli export onnx` writes it;
- inputs `pixel_values` `[B, 3, S, S]` and `input_ids` `[B, L]`, `attention_mask` if the graph has it;
- outputs `image_embeds` and `text_embeds`; without them `pooler_output` (SigLIP), or the only one of rank two;
- `tokenizer.json`, read by the `tokenizers` library; `tokenizer_config.json` for its length and padding, if present;
- `preprocessor_config.json`: size, mean, standard deviation and resampling of the images;
- `calibration.json`, if present, instead of the calibration of published CLIPs (`calibration.of_clip`).

A folder that `scenewright.training` wrote is loaded with `embedded:DIR` instead.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import BackendError
from ....world.words import PROMPT, normalise
from .. import checked_images, checked_texts
from ..calibration import Calibration, of_clip
from ..pixels import Pixels
from ..sessions import open_session, read_object
from ..vector_files import calibration_beside
from ..vocabulary import Vocabulary

_IMAGE, _TEXT, _BOTH = ("vision_model", "image"), ("text_model", "text"), ("model",)
_VARIANTS = ("", "_fp16", "_quantized", "_int8", "_uint8")
_ADVICE = "export the model again or download the file again"
_CONTEXT_LENGTH = 77  # of CLIP, unless graph or tokenizer gives another
_BATCH = 16
_KINDS = {
    "tensor(float)": np.float32,
    "tensor(float16)": np.float16,
    "tensor(int64)": np.int64,
    "tensor(int32)": np.int32,
}


def load(argument: str) -> Onnx:
    """The model in folder `argument`.

    Raises:
        BackendError: a file is missing, or `scenewright.training` wrote the folder.
    """
    if not argument:
        raise BackendError("name the folder: onnx:FOLDER with vision_model.onnx, text_model.onnx and tokenizer.json")
    folder = Path(argument).expanduser()
    if (folder / "words.json").is_file():
        raise BackendError(f"{folder} holds an encoder of scenewright.training; use embedded:{folder}")
    both = _graph(folder, _BOTH)
    image, text = _graph(folder, _IMAGE) or both, _graph(folder, _TEXT) or both
    wanted = {"vision_model.onnx": image, "text_model.onnx": text}
    wanted |= {n: _present(folder / n) for n in ("tokenizer.json", "preprocessor_config.json")}
    missing = [name for name, path in wanted.items() if path is None]
    if image is None or text is None or missing:
        raise BackendError(
            f"no ONNX model in {folder}: {', '.join(missing)} missing; make such a folder with "
            "`python -m scenewright.gaussians.language.encoders.export open_clip:MODEL/PRETRAINED FOLDER`"
        )
    return Onnx(folder, image, text)


@dataclass(frozen=True, eq=False)
class Onnx:
    """An ONNX model as an `Encoder`; files are read on first use.

    Attributes:
        image, text: the files of the graphs; the same file if it holds both towers.
    """

    folder: Path
    image: Path
    text: Path
    on_background: bool = True  # trained on photographs, see `group_renders.mean_vectors`

    @cached_property
    def fingerprint(self) -> str:
        digest = hashlib.sha256(json.dumps([str(self._pixels), PROMPT]).encode())
        beside = {p for graph in {self.image, self.text} for p in graph.parent.glob(f"{graph.name}*data")}
        for path in sorted({self.image, self.text, *beside, self.folder / "tokenizer.json"}):
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        return f"onnx-{digest.hexdigest()[:16]}"

    @cached_property
    def dim(self) -> int:
        return int(self.encode_text(["thing"]).shape[1])

    @property
    def image_size(self) -> int:
        return self._pixels.size

    @cached_property
    def vocabulary(self) -> Vocabulary:
        return Vocabulary.everyday()

    @cached_property
    def calibration(self) -> Calibration:
        return calibration_beside(self.folder) or of_clip()

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        rows = checked_texts(texts)
        if not rows:
            return np.zeros((0, self.dim), dtype=np.float32)
        feeds = self._tokens(rows)
        if self.image == self.text:  # a graph of both towers needs an image with the texts
            feeds["pixel_values"] = np.zeros((1, 3, self.image_size, self.image_size), dtype=np.float32)
        return _unit(_run(self._text_session, feeds, ("text_embeds", "pooler_output")))

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        pictures = checked_images(images)
        if not len(pictures):
            return np.zeros((0, self.dim), dtype=np.float32)
        feeds = self._tokens(["thing"]) if self.image == self.text else {}
        parts = []
        for i in range(0, len(pictures), _BATCH):
            feeds["pixel_values"] = self._pixels.prepare(pictures[i : i + _BATCH]).numpy()
            parts.append(_unit(_run(self._image_session, feeds, ("image_embeds", "pooler_output"))))
        return np.concatenate(parts)

    def _tokens(self, texts: list[str]) -> dict[str, NDArray[Any]]:
        encoded = self._tokenizer.encode_batch([PROMPT.format(" ".join(t.split())) for t in texts])
        return {
            "input_ids": np.array([e.ids for e in encoded], dtype=np.int64),
            "attention_mask": np.array([e.attention_mask for e in encoded], dtype=np.int64),
        }

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()  # byte-pair encoding spells any word

    def knows(self, text: str) -> bool:
        return bool(normalise(text))

    @cached_property
    def _image_session(self) -> Any:
        return open_session(self.image, _ADVICE)

    @cached_property
    def _text_session(self) -> Any:
        return self._image_session if self.text == self.image else open_session(self.text, _ADVICE)

    @cached_property
    def _pixels(self) -> Pixels:
        path = self.folder / "preprocessor_config.json"
        said = read_object(path, _ADVICE)
        try:
            size = said["crop_size"] if "crop_size" in said else said["size"]
            if isinstance(size, dict):
                size = size["height"] if "height" in size else size["shortest_edge"]
            plain = said.get("do_normalize") is False
            mean = (0.0, 0.0, 0.0) if plain else tuple(map(float, said["image_mean"]))
            std = (1.0, 1.0, 1.0) if plain else tuple(map(float, said["image_std"]))
            # PIL's resampling numbers: 2 is bilinear, 3 bicubic; such models use no others.
            return Pixels(int(size), _three(mean), _three(std), "bilinear" if said.get("resample") == 2 else "bicubic")
        except (KeyError, TypeError, ValueError) as error:
            raise BackendError(f"{path} lacks a valid size, image_mean or image_std ({error!r})") from error

    @cached_property
    def _tokenizer(self) -> Any:
        """The tokenizer, which pads and truncates texts to the length of the graph's input."""
        try:
            from tokenizers import Tokenizer
        except ImportError as error:
            raise BackendError("onnx:FOLDER needs tokenizers; run: pip install 'scenewright[models]'") from error
        path = self.folder / "tokenizer.json"
        try:
            tokenizer = Tokenizer.from_file(str(path))
        except Exception as error:  # the library raises bare exceptions
            raise BackendError(f"{path} is not a tokenizer: {error}; {_ADVICE}") from error
        beside = self.folder / "tokenizer_config.json"
        said = read_object(beside, _ADVICE) if beside.is_file() else {}
        shape = next(i.shape for i in self._text_session.get_inputs() if i.name == "input_ids")
        length = (
            shape[1] if isinstance(shape[1], int) else int(min(said.get("model_max_length", _CONTEXT_LENGTH), 1024))
        )
        pad = said.get("pad_token", "")
        pad = pad.get("content", "") if isinstance(pad, dict) else pad or ""
        number = tokenizer.token_to_id(pad)
        tokenizer.enable_truncation(length)
        tokenizer.enable_padding(length=length, pad_id=number or 0, pad_token=pad if number is not None else "!")
        return tokenizer


def _run(session: Any, feeds: dict[str, NDArray[Any]], outputs: Sequence[str]) -> NDArray[np.float32]:
    """The first of `outputs` that the graph has, `[B, D]`. Raises BackendError if the graph needs another input, has no
    such output, or fails."""
    given = {}
    for wanted in session.get_inputs():
        if wanted.name not in feeds:
            raise BackendError(
                f"the ONNX graph needs the input {wanted.name!r}; export it with pixel_values and input_ids"
            )
        given[wanted.name] = feeds[wanted.name].astype(_KINDS.get(wanted.type, np.float32), copy=False)
    named = {o.name: o for o in session.get_outputs()}
    flat = [name for name, o in named.items() if len(o.shape or ()) == 2]
    chosen = next((name for name in outputs if name in named), flat[0] if len(flat) == 1 else None)
    if chosen is None:
        raise BackendError(f"the ONNX graph gives {', '.join(named)}; export it with the projection, as {outputs[0]}")
    try:
        result: NDArray[np.float32] = session.run([chosen], given)[0]
    except Exception as error:  # onnxruntime raises its own classes, which share no public base
        raise BackendError(
            f"the ONNX graph failed: {error}; its tokenizer or image size may be of another model"
        ) from error
    return result


def _graph(folder: Path, names: Sequence[str]) -> Path | None:
    places = (place / f"{name}{v}.onnx" for v in _VARIANTS for name in names for place in (folder, folder / "onnx"))
    return next((path for path in places if path.is_file()), None)


def _present(path: Path) -> Path | None:
    return path if path.is_file() else None


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    red, green, blue = values
    return red, green, blue


def _unit(rows: NDArray[Any]) -> NDArray[np.float32]:
    wide = rows.astype(np.float32)
    result: NDArray[np.float32] = wide / np.maximum(np.linalg.norm(wide, axis=1, keepdims=True), 1e-12)
    return result
