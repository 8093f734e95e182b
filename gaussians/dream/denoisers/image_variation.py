"""Stable Diffusion Image Variations as a denoiser: a picture of the object instead of words."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
from torch import Tensor

from ...diffusion import pipeline_in
from ...errors import BackendError, UserError
from ..views import Asked
from .latent import Latent

_WEIGHTS = {"front": 1.0, "side": 0.8, "back": 0.5, "above": 0.8}  # a picture shows a face, which is not behind


class ImageVariation(Latent):
    """The embedding of a picture, which counts most from the front."""

    def __init__(self, name: str, pipeline: Any, image: Path, guidance: float) -> None:
        import torch
        from PIL import Image, ImageOps, UnidentifiedImageError

        try:
            with Image.open(image) as file:
                shown = ImageOps.exif_transpose(file).convert("RGBA")
        except (OSError, UnidentifiedImageError, Image.DecompressionBombError) as error:
            raise UserError(f"cannot read the picture {image}: {error}") from error
        white = Image.new("RGBA", shown.size, (255, 255, 255, 255))
        picture = Image.alpha_composite(white, shown).convert("RGB")
        digest = hashlib.sha256(np.asarray(picture).tobytes()).hexdigest()[:16]
        super().__init__(f"{name} {digest} {guidance:g}", pipeline, guidance)
        encoder = pipeline.image_encoder
        pixels = pipeline.feature_extractor(images=picture, return_tensors="pt").pixel_values
        with torch.no_grad():
            self._seen = encoder(pixels.to(encoder.device, encoder.dtype)).image_embeds[:, None].float()
        self._none = torch.zeros_like(self._seen)

    @classmethod
    def load(cls, folder: str, image: Path, guidance: float) -> ImageVariation:
        """The pipeline in a folder.

        Raises:
            BackendError: it cannot be loaded, or takes no picture.
            UserError: the picture cannot be read.
        """
        pipeline = pipeline_in(folder, "DiffusionPipeline", "--model")
        if any(getattr(pipeline, part, None) is None for part in ("image_encoder", "feature_extractor", "unet", "vae")):
            kind = type(pipeline).__name__
            raise BackendError(
                f"{folder} holds a {kind}; a picture needs one of the class StableDiffusionImageVariationPipeline"
            )
        return cls(f"diffusers:{folder}", pipeline, image, guidance)

    def noise(self, noisy: Tensor, step: int, asked: Asked) -> Tensor:
        """See `Denoiser`."""
        part = _WEIGHTS[asked.side]
        return self.guided(noisy, step, part * self._seen + (1 - part) * self._none, self._none)
