"""Models that turn pictures of a thing into pictures of it in another material, behind one protocol."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ...gaussians.diffusion import pipeline_in
from ...gaussians.errors import BackendError
from .inpainters import F32, Shot, checked
from .inpainters.diffusers import fitted_to
from .inpainters.sizes import bytes_of

_STEPS = 30


@runtime_checkable
class Restyler(Protocol):
    """Paints a thing anew, image to image. It is deterministic: the same arguments give the same picture."""

    @property
    def name(self) -> str: ...

    def restyle(self, shot: Shot, prompt: str, strength: float, seed: int = 0) -> F32:
        """The picture `[H, W, 3]` with the thing, which `shot.mask` marks, as the prompt says.

        Args:
            strength: how far the picture may leave the one that is given, in (0, 1].

        Raises:
            BackendError: the model failed, or what it returned is no such picture.
        """
        ...


@dataclass(frozen=True, eq=False)
class Diffusers:
    """A pipeline of the diffusers library that takes a picture and a prompt; `name` is its specification."""

    name: str
    pipeline: Any

    def restyle(self, shot: Shot, prompt: str, strength: float, seed: int = 0) -> F32:
        """See `Restyler`."""
        import torch
        from PIL import Image

        fitted = fitted_to(shot.mask.shape)
        try:
            out = self.pipeline(
                prompt=prompt, image=Image.fromarray(bytes_of(fitted.picture(shot.rgb))), strength=strength,
                num_inference_steps=_STEPS, generator=torch.Generator().manual_seed(seed),
            )  # fmt: skip
            picture = np.asarray(out.images[0])
        except Exception as error:  # pipelines raise whatever their parts raise
            raise BackendError(f"{self.name} failed: {error}; try its folder with diffusers alone") from error
        if picture.shape != (*fitted.taken, 3):
            return checked(picture, shot, self.name)
        scale = 255 if picture.dtype == np.uint8 else 1
        return checked(fitted.back((picture / scale).astype(np.float32)), shot, self.name, same_outside=False)


def load(spec: str) -> Restyler:
    """Load a model by its specification, "diffusers:FOLDER" (a folder with a text-to-image pipeline).

    Raises:
        BackendError: unknown back end, or its files or packages are missing; the message says what to do.
    """
    name, _, argument = spec.partition(":")
    if name != "diffusers" or not argument:
        raise BackendError(f"unknown back end {spec!r} for restyle; use diffusers:FOLDER")
    return Diffusers(spec, pipeline_in(argument, "AutoPipelineForImage2Image", "--restyle"))
