"""Load a causal or image-text-to-text model of transformers from a folder or by name, without running its code.

Weights are read as safetensors only, since pickles run code when they are read, and Python files in a model folder are
never executed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ....gaussians.errors import BackendError
from ....gaussians.torchvision_fix import import_torchvision

_PICKLED = ("*.bin", "*.pt", "*.pth", "*.ckpt")
_WANTED = (
    "*.json",
    "*.safetensors",
    "*.model",
    "*.txt",
    "*.jinja",
)  # downloaded files: no pickles, no Python
_OTHER_FORMATS = ("original/*", "onnx/*", "consolidated*")  # the same weights in other formats
_PROCESSOR_FILES = ("preprocessor_config.json", "processor_config.json")
_AS_SAVED = 4 * 2**30  # bytes of weights above which a CPU keeps the saved precision instead of float32
_WINDOW = 4096  # tokens, if the model does not state its window


@dataclass(frozen=True)
class Checkpoint:
    """A loaded model.

    Attributes:
        model: in evaluation mode, on its device.
        tokenizer: a fast one.
        window: maximum tokens of prompt and answer.
        rows: number of rows of the embedding table, one per token id.
        processor: turns pictures and text into input tensors; None for a model that reads text only.
    """

    model: Any
    tokenizer: Any
    window: int
    rows: int
    processor: Any = None


def read(argument: str) -> Checkpoint:
    """Load a model from a folder, or by name from transformers' cache; download it if it is not there.

    A download is announced on stderr.

    Raises:
        BackendError: transformers is missing, there is no such model, or it cannot be used safely.
    """
    transformers = _library()
    if not argument:
        raise BackendError("name a model: transformers:FOLDER of a saved one, or transformers:OWNER/NAME to fetch it")
    folder = Path(argument).expanduser()
    if not folder.is_dir():
        if argument.count("/") != 1 or argument.startswith((".", "~", "/")):
            raise BackendError(f"there is no folder {argument}; give that of a model as save_pretrained writes it")
        folder = _fetched(argument)
    _examine(folder)
    return _read(transformers, folder)


def _library() -> Any:
    """Import transformers, after the fix for torchvision if that is installed."""
    try:
        if find_spec("torchvision") is not None:
            import_torchvision()
        import transformers
    except ImportError as error:
        raise BackendError("transformers is not installed; run: pip install 'scenewright[models]'") from error
    return transformers


def _examine(folder: Path) -> None:
    """Check a folder before anything is read from it.

    Raises:
        BackendError: it has no config.json, or no weights as safetensors.
    """
    if not (folder / "config.json").is_file():
        raise BackendError(f"{folder} holds no config.json; give the folder of a model as save_pretrained writes it")
    if not any(folder.glob("*.safetensors")):
        pickled = [path.name for pattern in _PICKLED for path in folder.glob(pattern)]
        if pickled:
            raise BackendError(
                f"{folder} holds its weights as {pickled[0]}, which can run code when it is read; save the model again "
                "as safetensors (save_pretrained does)"
            )
        raise BackendError(f"{folder} holds no weights (*.safetensors)")


def _fetched(name: str) -> Path:
    """The folder of a published model in the cache, downloaded if missing; only file types that are safe to read."""
    import huggingface_hub

    wanted: dict[str, Any] = {"allow_patterns": list(_WANTED), "ignore_patterns": list(_OTHER_FORMATS)}
    try:
        folder = Path(huggingface_hub.snapshot_download(name, local_files_only=True, **wanted))
        if any(folder.glob("*.safetensors")):
            return folder
    except (OSError, ValueError):
        pass  # not in the cache
    print(f"transformers: {name} is not in the cache and is fetched", file=sys.stderr)
    try:
        return Path(huggingface_hub.snapshot_download(name, **wanted))
    except Exception as error:  # the hub's client raises its own errors, those of its HTTP library, and OSErrors
        raise BackendError(
            f"there is no folder {name}, and no model of this name could be fetched ({type(error).__name__}); "
            "check the name, or copy the model here and give transformers:FOLDER"
        ) from error


def _read(transformers: Any, folder: Path) -> Checkpoint:
    import torch

    named, safe = str(folder), {"trust_remote_code": False, "local_files_only": True}
    try:
        with _quiet(transformers):
            config = transformers.AutoConfig.from_pretrained(folder, **safe)
            sees = _check_kind(transformers, config, folder)
            processor: Any = transformers.AutoProcessor.from_pretrained(folder, **safe) if sees else None
            tokenizer = processor.tokenizer if sees else transformers.AutoTokenizer.from_pretrained(folder, **safe)
            kind = transformers.AutoModelForImageTextToText if sees else transformers.AutoModelForCausalLM
            model, told = kind.from_pretrained(
                folder, dtype=_dtype(folder), use_safetensors=True, output_loading_info=True, **safe
            )
            _check_parts(model, tokenizer, told, named)
            model = model.eval().to("cuda" if torch.cuda.is_available() else "cpu")
    except BackendError:
        raise
    except MemoryError as error:
        raise BackendError(f"{named} does not fit into memory; use a smaller model") from error
    except Exception as error:  # transformers, tokenizers, safetensors and torch raise many types
        raise BackendError(_advice(named, error)) from error
    return Checkpoint(model, tokenizer, _window(config, tokenizer), _rows(model), processor)


def _check_kind(transformers: Any, config: Any, folder: Path) -> bool:
    """Whether it is an image-text-to-text model with its processor; else it must be a causal language model.

    Encoders and translators would load with missing layers.

    Raises:
        BackendError: it is neither.
    """
    auto = transformers.models.auto.modeling_auto
    saved = set(getattr(config, "architectures", None) or ())

    def among(known: Mapping[str, str | Sequence[str]]) -> bool:
        named = known.get(config.model_type, ())
        kinds = {named} if isinstance(named, str) else set(named)
        return bool(kinds & saved if saved else kinds)

    reads_pictures = any((folder / name).is_file() for name in _PROCESSOR_FILES)
    if among(auto.MODEL_FOR_IMAGE_TEXT_TO_TEXT_MAPPING_NAMES) and reads_pictures:
        return True
    if among(auto.MODEL_FOR_CAUSAL_LM_MAPPING_NAMES):
        return False
    if among(auto.MODEL_FOR_IMAGE_TEXT_TO_TEXT_MAPPING_NAMES):
        raise BackendError(
            f"{folder} holds no {_PROCESSOR_FILES[0]}, which says how pictures are read; get the whole model"
        )
    what = next(iter(getattr(config, "architectures", None) or ()), config.model_type)
    raise BackendError(
        f"{folder} is a {what}, not a causal language model (…ForCausalLM) and none that answers about pictures "
        "(LLaVA and the like); use one that is"
    )


def _check_parts(model: Any, tokenizer: Any, told: dict[str, Any], named: str) -> None:
    """Refuse models with missing weights and tokenizers that cannot be constrained."""
    if missing := sorted(told["missing_keys"]):
        raise BackendError(f"{named} lacks {len(missing)} of its weights, {missing[0]} first; get the whole model")
    if not getattr(tokenizer, "is_fast", False):
        raise BackendError(f"{named} has no fast tokenizer (tokenizer.json), which constrained decoding needs")
    if len(tokenizer) > _rows(model):
        raise BackendError(
            f"{named} knows {_rows(model)} tokens, its tokenizer {len(tokenizer)}: they do not belong together"
        )


def _rows(model: Any) -> int:
    return int(model.get_input_embeddings().weight.shape[0])


def _dtype(folder: Path) -> Any:
    """float32 for a small model on a CPU, which is fastest there; else the saved precision."""
    import torch

    size = sum(path.stat().st_size for path in folder.glob("*.safetensors"))
    return "auto" if torch.cuda.is_available() or size > _AS_SAVED else torch.float32


def _window(config: Any, tokenizer: Any) -> int:
    """Window from the configuration, or else the tokenizer, where transformers writes 1e30 for "unknown"."""
    text = config.get_text_config()
    for name in ("max_position_embeddings", "n_positions", "max_seq_len"):
        if isinstance(getattr(text, name, None), int):
            return int(getattr(text, name))
    return int(tokenizer.model_max_length) if tokenizer.model_max_length < 1e9 else _WINDOW


def _advice(named: str, error: Exception) -> str:
    told = str(error).strip().splitlines()
    return f"cannot load {named} ({type(error).__name__}: {told[0] if told else 'no reason given'}); " + (
        "it does not fit into memory: use a smaller model"
        if "out of memory" in str(error).lower() or "allocate" in str(error)
        else "give transformers:FOLDER of a language model as save_pretrained writes it, weights as safetensors"
    )


@contextmanager
def _quiet(transformers: Any) -> Iterator[None]:
    """Turn off transformers' progress bars and warnings, which are meant for programmers."""
    logging = transformers.utils.logging
    level, bars = logging.get_verbosity(), logging.is_progress_bar_enabled()
    logging.set_verbosity_error()
    logging.disable_progress_bar()
    try:
        yield
    finally:
        logging.set_verbosity(level)
        if bars:
            logging.enable_progress_bar()
