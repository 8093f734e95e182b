"""Fixtures for tests of language models: a model of random weights with its own tokenizer, built on the spot because
none can be fetched here."""

from __future__ import annotations

import importlib.util
import json
import shutil
from pathlib import Path

import pytest
import torch

from scenewright.gaussians.torchvision_fix import import_torchvision

SENTENCES = (
    "make the armchair teal and remove the coffee table",
    "move the lamp 40 cm to the left of the sofa, then turn it by 90 degrees",
    'answer with JSON: {"verdict":"ok","ops":[{"op":"delete","target":{"text":"chair","pick":"all"}}],"reason":""}',
    '{"op":"insert","asset":"vase","place":{"relation":"on","anchors":[{"text":"coffee table","colors":["red"]}]}}',
)
TEMPLATE = (
    "{% for message in messages %}<|{{ message['role'] }}|>\n{{ message['content'] }}<|end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|assistant|>\n{% endif %}"
)
WINDOW = 4096


@pytest.fixture(scope="session")
def tiny_llama(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as save_pretrained writes it: two layers of a Llama, 400 tokens, a chat template."""
    for package in ("transformers", "tokenizers", "llguidance"):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed (pip install 'scenewright[models]')")
    if importlib.util.find_spec("torchvision") is not None:
        import_torchvision()
    from transformers import LlamaConfig, LlamaForCausalLM

    folder = tmp_path_factory.mktemp("llama")
    save_tokenizer(folder)
    torch.manual_seed(4)
    config = LlamaConfig(
        vocab_size=400, hidden_size=48, intermediate_size=96, num_hidden_layers=2, num_attention_heads=4,
        num_key_value_heads=2, max_position_embeddings=WINDOW, bos_token_id=0, eos_token_id=1, initializer_range=0.3,
    )  # fmt: skip
    LlamaForCausalLM(config).save_pretrained(folder)
    return folder


@pytest.fixture
def copied(tiny_llama: Path, tmp_path: Path) -> Path:
    """A folder of one's own to break."""
    return Path(shutil.copytree(tiny_llama, tmp_path / "model"))


def save_tokenizer(folder: Path) -> None:
    """Byte-level byte-pair encoding, as Llama 3 and most of today's models have it."""
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers, trainers
    from transformers import PreTrainedTokenizerFast

    coder = Tokenizer(models.BPE())
    coder.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    coder.decoder = decoders.ByteLevel()
    marks = ["<|begin|>", "<|end|>", "<|system|>", "<|user|>", "<|assistant|>"]
    alphabet = pre_tokenizers.ByteLevel.alphabet()
    coder.train_from_iterator(
        SENTENCES, trainers.BpeTrainer(vocab_size=400, special_tokens=marks, initial_alphabet=alphabet)
    )
    tokenizer = PreTrainedTokenizerFast(tokenizer_object=coder, bos_token="<|begin|>", eos_token="<|end|>")
    tokenizer.chat_template = TEMPLATE
    tokenizer.save_pretrained(folder)
    assert json.loads((folder / "tokenizer_config.json").read_text())
