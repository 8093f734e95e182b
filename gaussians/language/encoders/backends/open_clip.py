"""Published CLIP models through open_clip: `open_clip:MODEL/PRETRAINED`, or `open_clip:DIR` for a saved model.

A folder holds `open_clip_config.json` (`{"model_cfg": {...}, "preprocess_cfg": {...}}`) and
`open_clip_model.safetensors`, as open_clip's `push_to_hub` writes them. Before open_clip may download weights, a line
on stderr says so.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import BackendError
from ....torchvision_fix import import_torchvision
from ....world.words import PROMPT, normalise
from .. import checked_images, checked_texts
from ..calibration import Calibration, of_clip
from ..pixels import Pixels
from ..vocabulary import Vocabulary

_CONFIG, _WEIGHTS = "open_clip_config.json", "open_clip_model.safetensors"
_BATCH = 16


def load(argument: str) -> OpenClip:
    """The model named by `MODEL/PRETRAINED`, or the one saved in a folder.

    Raises:
        BackendError: open_clip is not installed, or the model, its weights or its folder are missing or damaged.
    """
    open_clip = _library()
    if not argument:
        raise BackendError("name a model: open_clip:ViT-B-32/laion2b_s34b_b79k, or open_clip:DIR of a saved one")
    folder = Path(argument).expanduser()
    if folder.is_dir():
        return _from_folder(open_clip, folder)
    return _from_name(open_clip, argument)


@dataclass(frozen=True, eq=False)
class OpenClip:
    """An open_clip model as an `Encoder`.

    Attributes:
        model: the open_clip model, in evaluation mode.
        tokenizer: maps texts to token ids.
        mean, std: of the pixels in training.
    """

    model: Any
    tokenizer: Any
    mean: tuple[float, float, float]
    std: tuple[float, float, float]
    name: str
    on_background: bool = True  # trained on photographs, see `group_renders.mean_vectors`

    @cached_property
    def fingerprint(self) -> str:
        digest = hashlib.sha256(json.dumps([self.mean, self.std, self.image_size, PROMPT]).encode())
        for key, value in sorted(self.model.state_dict().items()):
            digest.update(f"{key}{tuple(value.shape)}{value.dtype};".encode())
            digest.update(value.detach().cpu().float().contiguous().numpy().tobytes())
        return f"open_clip-{digest.hexdigest()[:16]}"

    @cached_property
    def dim(self) -> int:
        return int(self.encode_text(["thing"]).shape[1])

    @cached_property
    def image_size(self) -> int:
        size = self.model.visual.image_size
        return int(size[0] if isinstance(size, (tuple, list)) else size)

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """Household kinds with synonyms, other everyday names, and captions of non-objects."""
        return Vocabulary.everyday()

    @cached_property
    def calibration(self) -> Calibration:
        scale = getattr(self.model, "logit_scale", None)
        return of_clip() if scale is None else of_clip(float(scale.detach().exp()))

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        import torch

        rows = [PROMPT.format(" ".join(t.split())) for t in checked_texts(texts)]
        if not rows:
            return np.zeros((0, self.dim), dtype=np.float32)
        with torch.inference_mode():
            return _unit(self.model.encode_text(self.tokenizer(rows)))

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        import torch

        pictures = checked_images(images)
        if not len(pictures):
            return np.zeros((0, self.dim), dtype=np.float32)
        look = Pixels(self.image_size, self.mean, self.std)
        parts = []
        with torch.inference_mode():
            for i in range(0, len(pictures), _BATCH):
                parts.append(_unit(self.model.encode_image(look.prepare(pictures[i : i + _BATCH]))))
        return np.concatenate(parts)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()  # byte-pair encoding spells any word

    def knows(self, text: str) -> bool:
        return bool(normalise(text))


def wrap(model: Any, tokenizer: Any, name: str) -> OpenClip:
    """An encoder around an open_clip model that is already in memory."""
    mean = tuple(float(v) for v in model.visual.image_mean)
    std = tuple(float(v) for v in model.visual.image_std)
    return OpenClip(model.eval(), tokenizer, (mean[0], mean[1], mean[2]), (std[0], std[1], std[2]), name)


def _from_folder(open_clip: Any, folder: Path) -> OpenClip:
    """A saved model with its tokenizer, by open_clip's loader of local folders."""
    name = f"local-dir:{folder.resolve()}"
    try:
        return wrap(open_clip.create_model(name, require_pretrained=True), open_clip.get_tokenizer(name), str(folder))
    except Exception as error:  # open_clip passes on the errors of its dependencies
        raise BackendError(
            f"{folder} is not a saved open_clip model ({type(error).__name__}: {error}); "
            f"it needs {_CONFIG} and {_WEIGHTS} as open_clip's push_to_hub writes them"
        ) from error


def _from_name(open_clip: Any, argument: str) -> OpenClip:
    """A published model from the list of open_clip; announces a possible download of its weights."""
    model_name, _, tag = argument.partition("/")
    if model_name not in open_clip.list_models():
        raise BackendError(
            f"open_clip knows no model {model_name!r} and there is no folder {argument!r}; "
            "list the models with: python -c 'import open_clip; print(open_clip.list_models())'"
        )
    tags = open_clip.list_pretrained_tags_by_model(model_name)
    if tag not in tags and not Path(tag).is_file():
        raise BackendError(f"open_clip:{model_name} needs one of these after a slash: {', '.join(tags)}")
    if tag in tags:
        print(f"open_clip: weights {tag} of {model_name} are downloaded unless they are in its cache", file=sys.stderr)
    try:
        model = open_clip.create_model(model_name, pretrained=tag)
    except Exception as error:  # the download client raises many types
        raise BackendError(
            f"open_clip:{argument} could not be loaded ({error}); without a network, copy the weights here and use "
            f"open_clip:{model_name}/FILE or open_clip:DIR"
        ) from error
    return wrap(model, open_clip.get_tokenizer(model_name), argument)


def _library() -> Any:
    """The open_clip module, imported after the fix for torchvision."""
    try:
        import_torchvision()
        import open_clip
    except ImportError as error:
        raise BackendError("open_clip is not installed; run: pip install 'scenewright[models]'") from error
    return open_clip


def _unit(rows: Any) -> NDArray[np.float32]:
    import torch

    result: NDArray[np.float32] = torch.nn.functional.normalize(rows.float(), dim=1).cpu().numpy()
    return result
