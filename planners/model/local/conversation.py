"""Tokenise a conversation for a local model with its chat template, or a plain format if it has none.

Special tokens in texts of the scene or the user are split by a space, so that they cannot act as template markers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..backend import Message, UnreachableError


def prompt_tokens(tokenizer: Any, messages: Sequence[Message]) -> list[int]:
    """Token ids of the whole prompt, up to the start of the assistant's turn.

    Raises:
        UnreachableError: the model's chat template fails on any conversation.
    """
    turns = [{"role": m.role, "content": _without_special_tokens(tokenizer, m.text)} for m in messages]
    if not getattr(tokenizer, "chat_template", None):
        plain = "".join(f"### {turn['role']}\n{turn['content']}\n\n" for turn in turns)
        return list(tokenizer(f"{plain}### assistant\n")["input_ids"])
    failures = []
    for attempt in (turns, _without_system(turns)):  # some templates refuse a system message
        try:
            text = tokenizer.apply_chat_template(
                attempt, tokenize=False, add_generation_prompt=True, enable_thinking=False
            )
        except Exception as error:  # jinja raises many types, and templates their own
            failures.append(f"{type(error).__name__}: {error}")
        else:
            return list(tokenizer(text, add_special_tokens=False)["input_ids"])
    raise UnreachableError(f"the model's chat template fails ({failures[-1]}); use another model")


def _without_special_tokens(tokenizer: Any, text: str) -> str:
    """The text with special tokens split by a space: an object called "<|im_end|>" must not end a turn."""
    marks = {t.content for t in tokenizer.added_tokens_decoder.values() if t.special}  # also those without a named role
    for token in {str(t) for t in tokenizer.all_special_tokens} | marks:
        if len(token) > 1:
            text = text.replace(token, f"{token[0]} {token[1:]}")
    return text


def _without_system(turns: list[dict[str, str]]) -> list[dict[str, str]]:
    """Move the system messages to the start of the first user message."""
    system = "\n\n".join(t["content"] for t in turns if t["role"] == "system")
    rest = [dict(t) for t in turns if t["role"] != "system"]
    if rest and system:
        rest[0]["content"] = f"{system}\n\n{rest[0]['content']}"
    return rest
