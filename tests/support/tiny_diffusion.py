"""Pipelines of the diffusers library with random weights, saved as real ones are."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import torch

_WORDS = ("a", "red", "chair", "view", "front", "side", "back", "overhead", "whole", "object", "blurry")


def save_stable_diffusion(folder: Path, prediction: str = "epsilon") -> None:
    """A Stable Diffusion of pictures of 32 px, with a text tower of two layers."""
    from diffusers import StableDiffusionPipeline
    from transformers import CLIPTextConfig, CLIPTextModel

    torch.manual_seed(0)
    tokenizer = _tokenizer(folder)
    words = CLIPTextConfig(
        vocab_size=len(tokenizer), hidden_size=32, intermediate_size=37, num_hidden_layers=2, num_attention_heads=4,
        projection_dim=32, bos_token_id=0, eos_token_id=2, pad_token_id=1, max_position_embeddings=77,
    )  # fmt: skip
    StableDiffusionPipeline(
        **_parts(prediction), text_encoder=CLIPTextModel(words), tokenizer=tokenizer, safety_checker=None,
        feature_extractor=None, image_encoder=None, requires_safety_checker=False,
    ).save_pretrained(folder)  # fmt: skip


def save_image_variation(folder: Path) -> None:
    """A Stable Diffusion Image Variations of pictures of 32 px."""
    from diffusers import StableDiffusionImageVariationPipeline
    from transformers import CLIPImageProcessor, CLIPVisionConfig, CLIPVisionModelWithProjection

    torch.manual_seed(1)
    sight = CLIPVisionConfig(
        hidden_size=32, intermediate_size=37, num_hidden_layers=2, num_attention_heads=4, projection_dim=32,
        image_size=28, patch_size=14,
    )  # fmt: skip
    StableDiffusionImageVariationPipeline(
        **_parts("epsilon"), image_encoder=CLIPVisionModelWithProjection(sight), safety_checker=None,
        feature_extractor=CLIPImageProcessor(size={"shortest_edge": 28}, crop_size={"height": 28, "width": 28}),
        requires_safety_checker=False,
    ).save_pretrained(folder)  # fmt: skip


def _parts(prediction: str) -> dict[str, Any]:
    from diffusers import AutoencoderKL, DDIMScheduler, UNet2DConditionModel

    unet = UNet2DConditionModel(
        block_out_channels=(32, 64), layers_per_block=1, sample_size=16, in_channels=4, out_channels=4,
        down_block_types=("DownBlock2D", "CrossAttnDownBlock2D"), up_block_types=("CrossAttnUpBlock2D", "UpBlock2D"),
        cross_attention_dim=32, attention_head_dim=8,
    )  # fmt: skip
    vae = AutoencoderKL(
        block_out_channels=[32, 64], in_channels=3, out_channels=3, latent_channels=4,
        down_block_types=["DownEncoderBlock2D", "DownEncoderBlock2D"],
        up_block_types=["UpDecoderBlock2D", "UpDecoderBlock2D"],
    )  # fmt: skip
    schedule = DDIMScheduler(
        beta_start=0.00085, beta_end=0.012, beta_schedule="scaled_linear", prediction_type=prediction
    )
    return {"unet": unet, "vae": vae, "scheduler": schedule}


def _tokenizer(folder: Path) -> Any:
    from transformers import CLIPTokenizer

    folder.mkdir(parents=True, exist_ok=True)
    marks = ["<|startoftext|>", "<|pad|>", "<|endoftext|>"]
    letters = [chr(c) for c in range(ord("!"), ord("~") + 1)]
    vocabulary = [*marks, *letters, *(f"{c}</w>" for c in letters)]
    (folder / "vocab.json").write_text(json.dumps({word: i for i, word in enumerate(vocabulary)}))
    (folder / "merges.txt").write_text("#version: 0.2\n")
    return CLIPTokenizer(
        str(folder / "vocab.json"), str(folder / "merges.txt"), bos_token=marks[0], eos_token=marks[2],
        pad_token=marks[1], unk_token=marks[2], model_max_length=77,
    )  # fmt: skip
