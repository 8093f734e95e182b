"""Load a causal language model of transformers from a folder, or download it by name, without running its code.

Weights are read as safetensors only, since pickles run code when they are read, and Python files in a model folder are
never executed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ....gaussians.errors import BackendError
from ....gaussians.torchvision_fix import import_torchvision

_PICKLED = ("*.bin", "*.pt", "*.pth", "*.ckpt")
_WANTED = ("*.json", "*.safetensors", "*.model", "*.txt", "*.jinja")  # of a published model: no pickles, no Python
_OTHER_FORMATS = ("original/*", "onnx/*", "consolidated*")  # the same weights once more
_AS_SAVED = 4 * 2**30  # bytes of weights above which a CPU keeps their precision rather than computing in float32
_WINDOW = 4096  # tokens, where a model does not say


@dataclass(frozen=True)
class Checkpoint:
    """What was read.

    Attributes:
        model: in evaluation mode, on its device.
        tokenizer: a fast one.
        window: how many tokens the model can hold.
        rows: how many token ids it knows.
    """

    model: Any
    tokenizer: Any
    window: int
    rows: int


def read(argument: str) -> Checkpoint:
    """The model in a folder; or of a name, from transformers' cache or else fetched, which a line on stderr says.

    Raises:
        BackendError: transformers is missing, there is no such model, or it is not one that can be used safely.
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
    """The transformers module, with torchvision, where there is one, cured first."""
    try:
        if find_spec("torchvision") is not None:
            import_torchvision()
        import transformers
    except ImportError as error:
        raise BackendError("transformers is not installed; run: pip install 'scenewright[models]'") from error
    return transformers


def _examine(folder: Path) -> None:
    """Say what is wrong with a folder before anything is read from it."""
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
    """The folder of a published model in the cache; only what is safe to read is ever fetched into it."""
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
    except Exception as error:  # the hub's client raises its own, its HTTP library's, and OSErrors
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
            _check_kind(transformers, config, named)
            tokenizer = transformers.AutoTokenizer.from_pretrained(folder, **safe)
            model, told = transformers.AutoModelForCausalLM.from_pretrained(
                folder, dtype=_dtype(folder), use_safetensors=True, output_loading_info=True, **safe
            )
            _check_parts(model, tokenizer, told, named)
            model = model.eval().to("cuda" if torch.cuda.is_available() else "cpu")
    except BackendError:
        raise
    except MemoryError as error:
        raise BackendError(f"{named} does not fit into memory; use a smaller model") from error
    except Exception as error:  # transformers, tokenizers, safetensors and torch raise what their parts raise
        raise BackendError(_advice(named, error)) from error
    return Checkpoint(model, tokenizer, _window(config, tokenizer), _rows(model))


def _check_kind(transformers: Any, config: Any, named: str) -> None:
    """Refuse what cannot continue a text: encoders and translators would be read with layers missing."""
    known = transformers.models.auto.modeling_auto.MODEL_FOR_CAUSAL_LM_MAPPING_NAMES
    kinds, saved = known.get(config.model_type, ()), tuple(getattr(config, "architectures", None) or ())
    kinds = (kinds,) if isinstance(kinds, str) else tuple(kinds)
    if not kinds or (saved and not set(saved) & set(kinds)):
        what = saved[0] if saved else config.model_type
        raise BackendError(f"{named} is a {what}, not a causal language model (…ForCausalLM); use one that is")


def _check_parts(model: Any, tokenizer: Any, told: dict[str, Any], named: str) -> None:
    """Refuse what would answer at random or cannot be constrained."""
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
    """float32 for a small model on a CPU, which computes in it fastest; else as saved."""
    import torch

    size = sum(path.stat().st_size for path in folder.glob("*.safetensors"))
    return "auto" if torch.cuda.is_available() or size > _AS_SAVED else torch.float32


def _window(config: Any, tokenizer: Any) -> int:
    """What the configuration says, or the tokenizer; transformers writes 1e30 there for "unknown"."""
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
        else "give transformers:FOLDER of a causal language model as save_pretrained writes it, weights as safetensors"
    )


@contextmanager
def _quiet(transformers: Any) -> Iterator[None]:
    """Without transformers' progress bars and warnings, which are for those who program with it."""
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
