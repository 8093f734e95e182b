"""Latent diffusion of the class of Stable Diffusion (Rombach et al. 2022): what its pipelines have in common."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from ...errors import BackendError
from ..sds import F64


class Latent:
    """A VAE, a U-Net that predicts noise, and a schedule.

    Args:
        name: specification of the denoiser.
        pipeline: of diffusers.
        guidance: weight of the condition against none (Ho and Salimans 2022).

    Raises:
        BackendError: the U-Net predicts neither noise nor velocity, or wants conditions that are not known here.
    """

    def __init__(self, name: str, pipeline: Any, guidance: float) -> None:
        self.name, self._guidance = name, guidance
        self._vae, self._unet = pipeline.vae, pipeline.unet
        for part in (self._vae, self._unet):
            part.requires_grad_(False)
        schedule = pipeline.scheduler
        self._kind = schedule.config.prediction_type
        if self._kind not in ("epsilon", "v_prediction"):
            raise BackendError(f"{name} predicts {self._kind!r}; one that predicts noise or velocity is needed")
        if getattr(self._unet.config, "addition_embed_type", None) is not None:
            raise BackendError(f"{name} wants more than words (as SDXL does); use Stable Diffusion 1 or 2")
        self.alphas: F64 = np.asarray(schedule.alphas_cumprod.cpu().numpy(), np.float64)
        self.side = int(self._unet.config.sample_size) * 2 ** (len(self._vae.config.block_out_channels) - 1)

    def encode(self, picture: Tensor) -> Tensor:
        """See `Denoiser`."""
        found = self._vae.encode((2 * picture - 1).to(self._vae.device, self._vae.dtype)).latent_dist.mean
        code: Tensor = found * self._vae.config.scaling_factor
        return code.float()

    def guided(self, noisy: Tensor, step: int, condition: Tensor, none: Tensor) -> Tensor:
        """The noise under a condition `[1, L, D]`, away from that under `none`."""
        both = torch.cat([none, condition]).to(self._unet.device, self._unet.dtype)
        given = noisy.to(both).repeat(2, 1, 1, 1)
        out = self._unet(given, torch.tensor(step, device=both.device), encoder_hidden_states=both).sample.float()
        if self._kind == "v_prediction":  # Salimans and Ho 2022, appendix D
            alpha = float(self.alphas[step])
            out = alpha**0.5 * out + (1 - alpha) ** 0.5 * noisy.to(out)
        without, with_ = out.chunk(2)
        found: Tensor = without + self._guidance * (with_ - without)
        return found
