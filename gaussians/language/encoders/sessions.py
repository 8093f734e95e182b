"""Open ONNX models and the JSON files beside them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...errors import BackendError, FileError
from ...files.foreign import read_json


def open_session(path: Path, advice: str, threads: int = 0) -> Any:
    """An onnxruntime session on the CPU that runs deterministically: the same input gives the same bytes.

    Args:
        advice: what the user can do if the model is not usable.
        threads: 0 for one per core; small models are faster on one.

    Raises:
        BackendError: the file is missing or broken.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime raises its own classes, which share no public base
        raise BackendError(f"{path} is not a usable ONNX model: {error}; {advice}") from error


def read_object(path: Path, advice: str) -> dict[str, Any]:
    """The JSON object in a file beside a model.

    Args:
        advice: what the user can do if the file is broken.

    Raises:
        BackendError: the file cannot be read or holds no JSON object.
    """
    try:
        data = read_json(path)
    except FileError as error:
        raise BackendError(f"{error}; {advice}") from error
    if not isinstance(data, dict):
        raise BackendError(f"{path} must hold a JSON object, not {type(data).__name__}; {advice}")
    return data
