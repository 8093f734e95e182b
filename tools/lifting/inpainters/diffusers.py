"""Inpainting pipelines of the diffusers library in a local folder: `diffusers:FOLDER`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....gaussians.diffusion import pipeline_in
from ....gaussians.errors import BackendError
from . import F32, Shot, checked
from .sizes import Fitted, bytes_of

PROMPT = "an empty place, only the background"
_STEPS = 30
_GROW = 9  # px: latents are an eighth of the picture
_MULTIPLE = 64  # of the sides: what pipelines of all kinds take
_LONGEST = 512  # px: smaller pictures are enlarged to it, as the pipelines were trained


@dataclass(frozen=True, eq=False)
class Diffusers:
    """A pipeline that takes a picture and a mask; `name` is its specification."""

    name: str
    pipeline: Any
    grow: int = _GROW

    def prepare(self, shots: Sequence[Shot]) -> None:
        """Nothing to prepare."""

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        """See `Inpainter`."""
        import torch
        from PIL import Image

        fitted = fitted_to(shot.mask.shape)
        height, width = fitted.taken
        try:
            out = self.pipeline(
                prompt=PROMPT,
                image=Image.fromarray(bytes_of(fitted.picture(shot.rgb))),
                mask_image=Image.fromarray(fitted.mask(shot.mask).astype(np.uint8) * 255),
                height=height, width=width, num_inference_steps=_STEPS,
                generator=torch.Generator().manual_seed(seed),
            )  # fmt: skip
            picture = np.asarray(out.images[0])
        except Exception as error:  # pipelines raise whatever their parts raise
            raise BackendError(f"{self.name} failed: {error}; try its folder with diffusers alone") from error
        if picture.shape != (height, width, 3):
            return checked(picture, shot, self.name)
        scale = 255 if picture.dtype == np.uint8 else 1
        return checked(fitted.back((picture / scale).astype(np.float32)), shot, self.name)


def fitted_to(size: tuple[int, ...]) -> Fitted:
    """How a picture is brought to a size that pipelines take."""
    height, width = size
    gain = max(1.0, _LONGEST / max(height, width))
    up = [max(_MULTIPLE, round(gain * side / _MULTIPLE) * _MULTIPLE) for side in (height, width)]
    return Fitted.to((height, width), (up[0], up[1]))


def load(argument: str) -> Diffusers:
    """The pipeline in the folder `argument`.

    Raises:
        BackendError: the folder holds no pipeline, diffusers is not installed, or the pipeline cannot be loaded.
    """
    return Diffusers(f"diffusers:{argument}", pipeline_in(argument, "AutoPipelineForInpainting", "--infill"))
