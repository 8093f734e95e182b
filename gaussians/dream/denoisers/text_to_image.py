"""Stable Diffusion as a denoiser: words, with the side from which the object is seen."""

from __future__ import annotations

from typing import Any

from torch import Tensor

from ...diffusion import pipeline_in
from ...errors import BackendError
from ..views import Asked
from .latent import Latent

GUIDANCE = 50.0  # Poole et al. 2022 use 100 in pixels; latents saturate earlier
SIDES = {"front": "front view", "side": "side view", "back": "back view", "above": "overhead view"}
UNWANTED = "blurry, cropped, several objects, text, shadow on the ground"


class TextToImage(Latent):
    """A prompt for each side (Poole et al. 2022, section 3.1), encoded once."""

    def __init__(self, name: str, pipeline: Any, prompt: str, guidance: float) -> None:
        super().__init__(f"{name} {prompt!r} {guidance:g}", pipeline, guidance)
        self._words = {side: self._encoded(pipeline, f"{prompt}, {said}, whole object") for side, said in SIDES.items()}
        self._none = self._encoded(pipeline, UNWANTED)

    @classmethod
    def load(cls, folder: str, prompt: str, guidance: float = GUIDANCE) -> TextToImage:
        """The pipeline in a folder.

        Raises:
            BackendError: it cannot be loaded, or takes other conditions than words.
        """
        pipeline = pipeline_in(folder, "DiffusionPipeline", "--model")
        if any(getattr(pipeline, part, None) is None for part in ("tokenizer", "text_encoder", "unet", "vae")):
            kind = type(pipeline).__name__
            raise BackendError(f"{folder} holds a {kind}; words need one of the class StableDiffusionPipeline")
        return cls(f"diffusers:{folder}", pipeline, prompt, guidance)

    def noise(self, noisy: Tensor, step: int, asked: Asked) -> Tensor:
        """See `Denoiser`."""
        return self.guided(noisy, step, self._words[asked.side], self._none)

    @staticmethod
    def _encoded(pipeline: Any, text: str) -> Tensor:
        """`[1, L, D]`."""
        import torch

        with torch.no_grad():
            found = pipeline.encode_prompt(text, pipeline.unet.device, 1, do_classifier_free_guidance=False)
        encoded: Tensor = found[0]
        return encoded
