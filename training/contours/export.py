"""Export the contour network as ONNX: half precision on the disk, float32 arithmetic, any height and width."""

from __future__ import annotations

from pathlib import Path

import torch

from .. import export
from .model import CHANNELS, STRIDE, ContourGraph, Contours


def write(path: Path, net: Contours) -> None:
    """Write the graph with input `picture [1, 8, H, W]` and output `contour [1, 1, H, W]`.

    Raises:
        BackendError: onnx is not installed.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    plain = Contours(net.widths, net.blocks)
    plain.load_state_dict(net.state_dict())
    example = torch.zeros(1, CHANNELS, 4 * STRIDE, 5 * STRIDE)
    free = {2: "height", 3: "width"}
    export.write_graph(ContourGraph(plain).eval(), example, ("picture", "contour"), free, path)
