"""The contour network: class-agnostic borders between things, trained by `scenewright.training.contours`.

Input and output are those of `Detector.contours`. The network may be exchanged for another with the same interface.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import BackendError
from ...encoders.sessions import open_session

F32 = NDArray[np.float32]

WEIGHTS = Path(__file__).parents[1] / "weights" / "contours.onnx"
STRIDE = 16  # height and width of the input are multiples of it
ADVICE = "reinstall with: pip install --force-reinstall scenewright"


@cache
def session() -> Any:
    """The network, loaded once, on one thread: pictures are small.

    Raises:
        BackendError: the weights are missing or broken.
    """
    return open_session(WEIGHTS, ADVICE, threads=1)


def contours(picture: F32) -> F32:
    """Contour strength `[H, W]` in [0, 1] of a picture `[8, H, W]`, whose channels `channels.py` lists.

    Raises:
        BackendError: the weights are missing or broken.
    """
    height, width = picture.shape[1:]
    whole = padded(picture)
    try:
        (found,) = session().run(["contour"], {"picture": whole[None]})
    except BackendError:
        raise
    except Exception as error:  # onnxruntime raises its own classes, which share no public base
        raise BackendError(f"{WEIGHTS} fails on a picture of {width}x{height}: {error}; {ADVICE}") from error
    result: F32 = np.clip(found[0, 0, :height, :width], 0, 1).astype(np.float32)
    return result


def padded(picture: F32) -> F32:
    """The picture, extended right and down by reflection until its sides are multiples of STRIDE."""
    down, right = (-side % STRIDE for side in picture.shape[1:])
    edges = ((0, 0), (0, down), (0, right))
    whole = np.pad(picture, edges, "reflect") if min(picture.shape[1:]) > STRIDE else np.pad(picture, edges, "edge")
    return np.ascontiguousarray(whole, dtype=np.float32)
