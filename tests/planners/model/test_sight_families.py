"""Vision-language models of other families than LLaVA, tiny and with random weights: pictures, caches and templates."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from loopback import png

pytest.importorskip("llguidance", reason="pip install 'scenewright[models]'")
pytest.importorskip("transformers", reason="pip install 'scenewright[models]'")

from scenewright.planners.model.backend import Message
from scenewright.planners.model.local import backend, checkpoint, sight
from scenewright.planners.vision.answering import SeenReply
from scenewright.planners.vision.asking import schema

pytestmark = pytest.mark.slow  # a second or two for each family

_WORDS = {
    "hidden_size": 48, "intermediate_size": 96, "num_hidden_layers": 2, "num_attention_heads": 4,
    "num_key_value_heads": 2, "max_position_embeddings": 4096, "bos_token_id": 0, "eos_token_id": 1,
    "initializer_range": 0.3,
}  # fmt: skip
_TOWER = {
    "hidden_size": 32, "intermediate_size": 48, "num_hidden_layers": 2, "num_attention_heads": 2, "image_size": 28,
    "patch_size": 14,
}  # fmt: skip


def template(mark: str, refuses_system: bool = False) -> str:
    refusal = "{% if m['role'] == 'system' %}{{ raise_exception('no system') }}{% endif %}" if refuses_system else ""
    return (
        f"{{% for m in messages %}}{refusal}<|{{{{ m['role'] }}}}|>\n{{% for p in m['content'] %}}"
        f"{{% if p['type'] == 'image' %}}{mark}{{% else %}}{{{{ p['text'] }}}}{{% endif %}}{{% endfor %}}<|end|>\n"
        "{% endfor %}{% if add_generation_prompt %}<|assistant|>\n{% endif %}"
    )


def tokenizer(source: Path, *marks: str, **named: str) -> Any:
    """The tiny Llama's tokenizer with further special tokens."""
    from transformers import PreTrainedTokenizerFast

    base = PreTrainedTokenizerFast.from_pretrained(source)
    base.add_special_tokens({"additional_special_tokens": [*marks, *named.values()]})
    return PreTrainedTokenizerFast(
        tokenizer_object=base.backend_tokenizer, bos_token="<|begin|>", eos_token="<|end|>", pad_token="<|end|>",
        additional_special_tokens=[*marks, *named.values()], extra_special_tokens=named,
    )  # fmt: skip


def qwen2_vl(source: Path, folder: Path) -> None:
    import transformers as tf

    words = tokenizer(source, "<|vision_start|>", "<|vision_end|>", "<|image_pad|>", "<|video_pad|>")
    numbers = [
        words.convert_tokens_to_ids(f"<|{n}|>") for n in ("image_pad", "video_pad", "vision_start", "vision_end")
    ]
    names = ("image_token_id", "video_token_id", "vision_start_token_id", "vision_end_token_id")
    tf.Qwen2VLProcessor(
        tf.Qwen2VLImageProcessor(min_pixels=28 * 28, max_pixels=28 * 28 * 16), words, tf.Qwen2VLVideoProcessor(),
        chat_template=template("<|vision_start|><|image_pad|><|vision_end|>"),
    ).save_pretrained(folder)  # fmt: skip
    rope = {"rope_type": "default", "mrope_section": [2, 2, 2], "rope_theta": 10000.0}
    tower = {"depth": 2, "embed_dim": 32, "hidden_size": 48, "num_heads": 2, "patch_size": 14, "mlp_ratio": 2}
    config = tf.Qwen2VLConfig(
        text_config={**_WORDS, "vocab_size": len(words), "rope_parameters": rope}, vision_config=tower,
        **dict(zip(names, numbers, strict=True)),
    )  # fmt: skip
    tf.Qwen2VLForConditionalGeneration(config).save_pretrained(folder)


def idefics3(source: Path, folder: Path) -> None:
    """As SmolVLM: a picture is split into tiles, each with tokens around it."""
    import transformers as tf

    tiles = [f"<row_{i}_col_{j}>" for i in (1, 2) for j in (1, 2)]
    words = tokenizer(source, "<image>", "<fake_token_around_image>", "<end_of_utterance>", "<global-img>", *tiles)
    reader = tf.Idefics3ImageProcessor(size={"longest_edge": 56}, max_image_size={"longest_edge": 28})
    tf.Idefics3Processor(reader, words, image_seq_len=1, chat_template=template("<image>")).save_pretrained(folder)
    config = tf.Idefics3Config(
        image_token_id=words.convert_tokens_to_ids("<image>"), scale_factor=2, vision_config=_TOWER,
        text_config={**_WORDS, "model_type": "llama", "vocab_size": len(words), "pad_token_id": 1},
    )  # fmt: skip
    tf.Idefics3ForConditionalGeneration(config).save_pretrained(folder)


def gemma3(source: Path, folder: Path) -> None:
    """Attention goes both ways within a picture, and the template takes no system message."""
    import transformers as tf

    marks = {"boi_token": "<start_of_image>", "eoi_token": "<end_of_image>", "image_token": "<image_soft_token>"}
    words = tokenizer(source, **marks)
    reader = tf.Gemma3ImageProcessor(size={"height": 28, "width": 28})
    written = "{{ bos_token }}" + template("<start_of_image>", refuses_system=True)
    tf.Gemma3Processor(reader, words, chat_template=written, image_seq_length=4).save_pretrained(folder)
    boi, eoi, image = (words.convert_tokens_to_ids(token) for token in marks.values())
    config = tf.Gemma3Config(
        text_config={**_WORDS, "vocab_size": len(words), "head_dim": 12}, boi_token_index=boi, eoi_token_index=eoi,
        vision_config={**_TOWER, "vision_use_head": False}, mm_tokens_per_image=4, image_token_index=image,
    )  # fmt: skip
    tf.Gemma3ForConditionalGeneration(config).save_pretrained(folder)


def llava_next(source: Path, folder: Path) -> None:
    """A picture takes as many tokens as its shape needs."""
    import transformers as tf

    words, grid = tokenizer(source, "<image>"), [[28, 56], [56, 28], [56, 56]]
    reader = tf.LlavaNextImageProcessor(
        size={"shortest_edge": 28}, crop_size={"height": 28, "width": 28}, image_grid_pinpoints=grid
    )
    tf.LlavaNextProcessor(
        reader, words, patch_size=14, vision_feature_select_strategy="default", num_additional_image_tokens=1,
        chat_template=template("<image>"),
    ).save_pretrained(folder)  # fmt: skip
    config = tf.LlavaNextConfig(
        vision_config=tf.CLIPVisionConfig(**_TOWER, projection_dim=32),
        text_config=tf.LlamaConfig(**_WORDS, vocab_size=len(words)),
        image_token_index=words.convert_tokens_to_ids("<image>"), image_grid_pinpoints=grid,
    )  # fmt: skip
    tf.LlavaNextForConditionalGeneration(config).save_pretrained(folder)


@pytest.fixture(scope="module", params=[qwen2_vl, idefics3, gemma3, llava_next], ids=lambda made: made.__name__)
def parts(
    request: pytest.FixtureRequest, tiny_llava: Path, tiny_llama: Path, tmp_path_factory: pytest.TempPathFactory
) -> checkpoint.Checkpoint:
    make: Callable[[Path, Path], None] = request.param
    folder = tmp_path_factory.mktemp(make.__name__)
    torch.manual_seed(1)
    make(tiny_llama, folder)
    return checkpoint.read(str(folder))


def asked(*shown: bytes) -> list[Message]:
    return [Message("system", "Answer with JSON."), Message("user", "what is on the table?", shown)]


def fresh(parts: checkpoint.Checkpoint) -> backend.LocalModel:
    return backend.LocalModel(parts, "transformers:tiny", max_tokens=60)


def test_a_reply_about_pictures_follows_the_schema(parts: checkpoint.Checkpoint) -> None:
    model = fresh(parts)
    answer = model.answer(asked(png(60, 40), png(40, 70, 1)), schema(SeenReply), seconds=60)
    assert model.sees and set(json.loads(answer.text)) >= {"answer_type", "confidence"}


def test_token_by_token_is_the_same_as_all_at_once(parts: checkpoint.Checkpoint) -> None:
    """The law behind the cache; the tolerance is that of sums in another order in float32."""
    model, more = fresh(parts), [5, 17, 40, 33, 21]
    given = sight.prompt(model._processor, asked(png(60, 40), png(40, 70, 1)), model._model)
    model._scores(given, [], 1e12)
    for token in more:
        one_by_one = model._forward([token])
    size = len(given.tokens)
    longer = {
        name: torch.cat([t, torch.full((1, len(more)), int(name == "attention_mask"), dtype=t.dtype)], 1)
        if t.shape == (1, size)
        else t
        for name, t in given.tensors.items()
    }
    at_once = fresh(parts)._forward(given.tokens + more, **longer)
    assert torch.allclose(one_by_one, at_once, atol=1e-4)


def test_earlier_pictures_leave_nothing_behind(parts: checkpoint.Checkpoint) -> None:
    model = fresh(parts)
    texts = []
    for shown in ((), (png(60, 40),), (), (png(40, 60, 1),), ()):
        texts.append(model.answer(asked(*shown), schema(SeenReply), seconds=60).text)
        assert texts[-1] == fresh(parts).answer(asked(*shown), schema(SeenReply), seconds=60).text
    assert texts[0] == texts[2] == texts[4]
