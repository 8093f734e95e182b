"""Export the towers as ONNX to the folder that `encoders.backends.embedded` loads.

Weights are stored in half precision and widened by a Cast when the session starts, so files are half as large and the
arithmetic stays float32.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

from ..gaussians.errors import BackendError
from ..gaussians.language.encoders.calibration import Calibration
from .fit import Task, Towers
from .model import DIM, IMAGE_SIZE, LENGTH, ImageGraph

_HALVED_FROM = 64  # numbers in a tensor; smaller ones stay float32
_OPSET = 17


def write_weights(folder: Path, towers: Towers, job: Task) -> None:
    """Write `image.onnx`, `text.onnx` and `words.json` to `folder`.

    Raises:
        BackendError: onnx is not installed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pictures = torch.zeros(2, IMAGE_SIZE, IMAGE_SIZE, 3, dtype=torch.uint8)
    tokens = torch.zeros(2, LENGTH, dtype=torch.int64)
    _export(ImageGraph(towers.image).eval(), pictures, "images", folder / "image.onnx")
    _export(towers.text.eval(), tokens, "tokens", folder / "text.onnx")
    words = sorted(job.index, key=lambda word: job.index[word])
    content = {
        "dim": DIM, "image_size": IMAGE_SIZE, "length": LENGTH,
        "vocabulary": job.vocabulary.to_json(), "words": words,
    }  # fmt: skip
    write_json(folder / "words.json", content)


def write_calibration(folder: Path, calibration: Calibration) -> None:
    """Write `calibration.json` to `folder`."""
    write_json(folder / "calibration.json", calibration.to_json())


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write indented JSON with keys in the given order and a final newline."""
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _export(module: nn.Module, example: torch.Tensor, name: str, path: Path) -> None:
    """Export one tower with a dynamic batch size."""
    write_graph(module, example, (name, "vectors"), {0: "batch"}, path)


def write_graph(
    module: nn.Module, example: torch.Tensor, names: tuple[str, str], free: dict[int, str], path: Path
) -> None:
    """Export one graph with its larger weights in half precision.

    Args:
        example: an input of the right shape.
        names: of the input and the output.
        free: axes of both whose length may vary, with their names.

    Raises:
        BackendError: onnx is not installed.
    """
    try:
        import onnx
    except ImportError as error:
        raise BackendError("training needs onnx; run: pip install 'scenewright[train]'") from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter announces its successor, which needs one more package
        torch.onnx.export(
            module, (example,), str(path), input_names=[names[0]], output_names=[names[1]],
            dynamic_axes=dict.fromkeys(names, free), opset_version=_OPSET, dynamo=False,
        )  # fmt: skip
    model = onnx.load(str(path))
    halve(model)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString(deterministic=True))


def halve(model: Any) -> None:
    """Store float32 initializers as float16 behind a Cast node each; onnxruntime folds the casts when it loads."""
    import onnx

    casts, kept = [], []
    for tensor in model.graph.initializer:
        values = onnx.numpy_helper.to_array(tensor)
        if values.dtype != np.float32 or values.size < _HALVED_FROM:
            kept.append(tensor)
            continue
        kept.append(onnx.numpy_helper.from_array(values.astype(np.float16), f"{tensor.name}.half"))
        casts.append(onnx.helper.make_node("Cast", [f"{tensor.name}.half"], [tensor.name], to=onnx.TensorProto.FLOAT))
    nodes = [*casts, *model.graph.node]
    del model.graph.initializer[:], model.graph.node[:]
    model.graph.initializer.extend(kept)
    model.graph.node.extend(nodes)
