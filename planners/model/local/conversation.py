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
    turns = [{"role": m.role, "content": with_spaces(tokenizer, m.text)} for m in messages]
    if not getattr(tokenizer, "chat_template", None):
        plain = "".join(f"### {turn['role']}\n{turn['content']}\n\n" for turn in turns)
        return list(tokenizer(f"{plain}### assistant\n")["input_ids"])
    failures = []
    for attempt in (turns, without_system(turns)):  # some templates refuse a system message
        try:
            text = tokenizer.apply_chat_template(
                attempt, tokenize=False, add_generation_prompt=True, enable_thinking=False
            )
        except Exception as error:  # jinja raises many types, and templates their own
            failures.append(f"{type(error).__name__}: {error}")
        else:
            return list(tokenizer(text, add_special_tokens=False)["input_ids"])
    raise UnreachableError(f"the model's chat template fails ({failures[-1]}); use another model")


def with_spaces(tokenizer: Any, text: str, reserved: Sequence[str] = ()) -> str:
    """The text with special and reserved tokens split by a space: an object called "<|im_end|>" must not end a turn."""
    marks = {t.content for t in tokenizer.added_tokens_decoder.values() if t.special}  # also those without a named role
    for token in sorted({str(t) for t in tokenizer.all_special_tokens} | marks | set(reserved)):
        if len(token) > 1:
            text = text.replace(token, f"{token[0]} {token[1:]}")
    return text


def without_system(turns: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Move the system messages to the start of the first user message; contents are texts, or all lists of parts."""
    system = [t["content"] for t in turns if t["role"] == "system"]
    rest = [dict(t) for t in turns if t["role"] != "system"]
    if rest and system:
        said = [*system, rest[0]["content"]]
        listed = isinstance(said[-1], list)
        rest[0]["content"] = [part for content in said for part in content] if listed else "\n\n".join(said)
    return rest
