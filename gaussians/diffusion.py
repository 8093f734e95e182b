"""Pipelines of the diffusers library (Apache-2.0) in local folders."""

from __future__ import annotations

import importlib
import importlib.util
import json
from pathlib import Path
from typing import Any

from .errors import BackendError
from .torchvision_fix import import_torchvision


def pipeline_in(argument: str, kind: str, option: str) -> Any:
    """The pipeline in a folder, on the GPU if there is one.

    Args:
        kind: the class of diffusers that loads it.
        option: of the command line, for messages.

    Raises:
        BackendError: it is no pipeline, brings code of its own, or cannot be loaded; or diffusers is not installed.
    """
    folder = Path(argument).expanduser()
    if not (folder / "model_index.json").is_file():
        raise BackendError(
            f"{folder} is no folder of a diffusers pipeline: it has no model_index.json; download a model into it, or "
            "save one with save_pretrained"
        )
    _refuse_code(folder)
    if importlib.util.find_spec("torchvision") is not None:
        import_torchvision()  # transformers imports it
    try:
        library = importlib.import_module("diffusers")
    except ImportError as error:
        raise BackendError(
            f"{option} diffusers: needs the package diffusers; run: pip install 'scenewright[diffusion]'"
        ) from error
    import torch

    try:
        pipeline = getattr(library, kind).from_pretrained(str(folder), local_files_only=True, use_safetensors=True)
        pipeline = pipeline.to("cuda" if torch.cuda.is_available() else "cpu")
        pipeline.set_progress_bar_config(disable=True)
    except Exception as error:  # missing weights, unknown classes, broken files: each library its own
        raise BackendError(f"cannot load the pipeline in {folder}: {error}; download it again") from error
    return pipeline


def _refuse_code(folder: Path) -> None:
    """A folder from elsewhere must not bring a program along: diffusers runs classes of its own that an index names."""
    try:
        index = json.loads((folder / "model_index.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BackendError(f"cannot read {folder / 'model_index.json'}: {error}; download the model again") from error
    named = index.get("_class_name") if isinstance(index, dict) else None
    if (named is not None and not isinstance(named, str)) or any(folder.rglob("*.py")):
        raise BackendError(f"{folder} brings Python code of its own, which is not run; use a pipeline without any")
