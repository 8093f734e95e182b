"""A conversation with pictures as the input tensors of a local image-text-to-text model, through its processor.

The processor scales pictures to the size that its vision tower reads. A processor that would crop gets pictures padded
to the shape of its crop, so that their edges are seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .. import pictures
from ..backend import Message, UnreachableError
from .conversation import with_spaces, without_system

if TYPE_CHECKING:
    from PIL.Image import Image


@dataclass(frozen=True)
class Prompt:
    """A prompt for the model.

    Attributes:
        tokens: its ids; each picture takes as many as its features need.
        tensors: what the model takes beside them, pixels above all; empty where no picture is shown.
    """

    tokens: list[int]
    tensors: dict[str, Any] = field(default_factory=dict)


def prompt(processor: Any, messages: Sequence[Message], model: Any) -> Prompt:
    """The prompt of a conversation, up to the start of the assistant's turn; tensors on the model's device.

    Raises:
        UnreachableError: no chat template of the model takes these messages.
        UserError: a picture cannot be read.
    """
    shown = [_picture(processor, one) for message in messages for one in message.pictures]
    text = _text(processor, messages, len(shown))
    begin = processor.tokenizer.bos_token
    # As transformers does: a template that writes the first token itself must not get another.
    options = {"add_special_tokens": not (begin and text.startswith(begin)), "return_tensors": "pt"}
    if not shown:
        return Prompt(processor.tokenizer([text], **options)["input_ids"][0].tolist())
    given = processor(text=[text], images=shown, **options).to(model.device, model.dtype)
    tensors = {name: value for name, value in given.items() if name != "input_ids"}
    return Prompt(given["input_ids"][0].tolist(), tensors)


def _picture(processor: Any, data: bytes) -> Image:
    image = pictures.scaled_down(pictures.decoded(data), pictures.LOCAL)
    reader = processor.image_processor
    crop = getattr(reader, "crop_size", None) if getattr(reader, "do_center_crop", False) else None
    if not crop:
        return image
    height, width = int(crop["height"]), int(crop["width"])
    return _padded(image, width / height)


def _padded(image: Image, shape: float) -> Image:
    """The image in the middle of a canvas of its mean colour whose width is `shape` times its height."""
    from PIL import Image
    from PIL.ImageStat import Stat

    width = max(image.width, round(image.height * shape))
    height = max(image.height, round(width / shape))
    if (width, height) == image.size:
        return image
    mean = tuple(round(value) for value in Stat(image).mean)
    canvas = Image.new("RGB", (width, height), mean)
    canvas.paste(image, ((width - image.width) // 2, (height - image.height) // 2))
    return canvas


def _text(processor: Any, messages: Sequence[Message], count: int) -> str:
    """The conversation by the model's template, with one placeholder a picture."""
    marks = _placeholders(processor)
    listed: list[dict[str, Any]] = [{"role": m.role, "content": _content(processor, m)} for m in messages]
    inlined = [{"role": t["role"], "content": _inlined(marks[0], t["content"])} for t in listed]
    failures = []
    for turns in (listed, without_system(listed), inlined, without_system(inlined)):
        for template in (processor, processor.tokenizer):
            if not getattr(template, "chat_template", None):
                continue
            try:
                text = str(template.apply_chat_template(turns, tokenize=False, add_generation_prompt=True))
            except Exception as error:  # jinja raises many types, and templates their own
                failures.append(f"{type(error).__name__}: {error}")
                continue
            if any(text.count(mark) == count for mark in marks) and _spoken(text, listed[-1]["content"]):
                return text
            failures.append("it leaves out pictures or words")
    if not failures:
        plain = "".join(f"### {turn['role']}\n{turn['content']}\n\n" for turn in inlined)
        return f"{plain}### assistant\n"
    raise UnreachableError(f"the model's chat template fails ({failures[-1]}); use another model")


def _spoken(text: str, last: Sequence[dict[str, str]]) -> bool:
    """Whether the last message is in the text; templates for plain strings may write a list as nothing."""
    words = last[-1]["text"].split()
    return not words or words[-1] in text


def _placeholders(processor: Any) -> list[str]:
    """The tokens that templates write for a picture."""
    found = [getattr(processor, name, None) for name in ("image_token", "boi_token")]
    return [str(token) for token in found if token] or ["<image>"]


def _content(processor: Any, message: Message) -> list[dict[str, str]]:
    reserved = [str(value) for name, value in vars(processor).items() if name.endswith("_token") and value]
    return [
        {"type": "image"}
        if isinstance(part, bytes)
        else {"type": "text", "text": with_spaces(processor.tokenizer, part, reserved)}
        for part in pictures.parts(message)
    ]


def _inlined(mark: str, content: list[dict[str, str]]) -> str:
    return "\n".join(part.get("text", mark) for part in content)
