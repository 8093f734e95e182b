"""A language model on this machine: a tiny Llama of random weights is held to the plan's schema, whatever it wants."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch

from scenewright.planners.model.backend import Answer, Message, UnreachableError
from scenewright.planners.model.planner import ModelPlanner
from scenewright.planners.model.verify import reply
from scenewright.planners.plan import EditPlan, NoPlanError, Usage

pytest.importorskip("llguidance", reason="pip install 'scenewright[models]'")

from scenewright.planners.model.local import backend, checkpoint
from scenewright.planners.model.local.constrained import Constrained
from scenewright.planners.model.local.conversation import prompt_tokens

SCHEMA = EditPlan.model_json_schema()
SYSTEM = "You turn an instruction into operations. Answer with JSON. " + " ".join(f"Rule {i}." for i in range(90))
BRIEF = 120  # tokens
WORDS = ("make the armchair teal", "delete all chairs", "what time is it?", "put a vase on the table", "move it left")


def asked(instruction: str, system: str = SYSTEM) -> list[Message]:
    return [Message("system", system), Message("user", instruction)]


@pytest.fixture(scope="module")
def parts(tiny_llama: Path) -> checkpoint.Checkpoint:
    return checkpoint.read(str(tiny_llama))


@pytest.fixture
def llama(parts: checkpoint.Checkpoint) -> backend.LocalModel:
    """A back end that has read nothing yet and is brief; what is slow to load is shared."""
    return backend.LocalModel(parts, "transformers:tiny", max_tokens=BRIEF)


def drawn(parts: checkpoint.Checkpoint, seed: int) -> Answer:
    """One answer of many kinds: another instruction, seed and temperature each time."""
    warm = backend.LocalModel(parts, "transformers:tiny", temperature=(0.4, 0.7, 1.0, 1.5)[seed % 4], seed=seed)
    return warm.answer(asked(f"{WORDS[seed % len(WORDS)]} {seed}", "Answer with JSON."), SCHEMA, seconds=120)


def counted(parts: checkpoint.Checkpoint, seeds: range) -> tuple[int, int]:
    """How many answers are valid plans, and how many ended by themselves."""
    answers = [drawn(parts, seed) for seed in seeds]
    for answer in answers:
        EditPlan.model_validate_json(answer.text)
    return len(answers), sum(answer.end == "done" for answer in answers)


@pytest.mark.parametrize("count", [4, 12])
@pytest.mark.slow
def test_random_weights_give_valid_plans(parts: checkpoint.Checkpoint, count: int) -> None:
    valid, ended = counted(parts, range(count))
    assert valid == count and ended >= count * 10 / 12  # a text of random words may well be cut


@pytest.mark.slow
def test_a_hundred_of_a_hundred_are_valid(parts: checkpoint.Checkpoint) -> None:
    valid, ended = counted(parts, range(100, 200))
    assert valid == 100 and ended >= 90


@pytest.mark.slow
def test_the_reply_that_planners_ask_for_is_valid_too(parts: checkpoint.Checkpoint) -> None:
    for seed in range(6):
        warm = backend.LocalModel(parts, "transformers:tiny", temperature=1.0, seed=seed, max_tokens=400)
        answer = warm.answer(asked("delete it", "JSON."), reply.schema(), seconds=120)
        reply.read(answer.text)


@pytest.mark.slow
def test_the_same_question_gets_the_same_answer(parts: checkpoint.Checkpoint, llama: backend.LocalModel) -> None:
    first = llama.answer(asked(WORDS[0]), SCHEMA, seconds=120)
    llama.answer(asked(WORDS[1]), SCHEMA, seconds=120)
    again = llama.answer(asked(WORDS[0]), SCHEMA, seconds=120)
    fresh = backend.LocalModel(parts, "transformers:tiny", max_tokens=BRIEF)
    assert first.text == again.text == fresh.answer(asked(WORDS[0]), SCHEMA, seconds=120).text
    assert drawn(parts, 3).text == drawn(parts, 3).text != drawn(parts, 7).text


@pytest.mark.slow
def test_it_says_what_reading_everything_again_gives(parts: checkpoint.Checkpoint, llama: backend.LocalModel) -> None:
    """Against the slow reference: no cache, no chunks, every token read again for each."""
    messages = asked(WORDS[3])
    answer = llama.answer(messages, SCHEMA, seconds=120)
    prompt = prompt_tokens(parts.tokenizer, messages)
    assert len(prompt) > 512  # more than two chunks
    slow = Constrained(llama._vocabulary, SCHEMA)
    slow.take_forced()
    while not slow.done and len(slow.tokens) < 60:
        with torch.inference_mode():
            scores = parts.model(torch.tensor([prompt + slow.tokens])).logits[0, -1]
        slow.take(int(scores.masked_fill(~torch.from_numpy(slow.allowed()), -torch.inf).argmax()))
    assert answer.text.startswith(slow.text) and len(slow.text) > 20


def test_a_shared_beginning_is_read_once(parts: checkpoint.Checkpoint, llama: backend.LocalModel) -> None:
    read: list[int] = []
    hook = parts.model.register_forward_pre_hook(
        lambda _, __, given: read.append(given["input_ids"].shape[1]), with_kwargs=True
    )
    try:
        first = llama.answer(asked(WORDS[0]), SCHEMA, seconds=120)
        at_first, _ = sum(read), read.clear()
        second = llama.answer(asked(WORDS[1]), SCHEMA, seconds=120)
        saved = second.usage.input_tokens + second.usage.output_tokens - sum(read)
    finally:
        hook.remove()
    assert at_first >= first.usage.input_tokens
    assert saved >= 512  # two chunks of the system message


def test_it_is_heard_as_it_speaks(llama: backend.LocalModel) -> None:
    pieces: list[str] = []
    answer = llama.answer(asked(WORDS[0]), SCHEMA, seconds=120, on_text=pieces.append)
    assert "".join(pieces) == answer.text and len(pieces) > 3


def test_tokens_are_counted(parts: checkpoint.Checkpoint) -> None:
    llama = backend.LocalModel(parts, "transformers:tiny", temperature=1.0)
    answer = llama.answer(asked(WORDS[0], "JSON."), SCHEMA, seconds=120)
    usage = answer.usage
    assert answer.end == "done" and usage.input_tokens == len(prompt_tokens(parts.tokenizer, asked(WORDS[0], "JSON.")))
    assert len(parts.tokenizer(answer.text)["input_ids"]) <= usage.output_tokens <= len(answer.text.encode())
    assert (usage.model, usage.requests, usage.dollars) == ("transformers:tiny", 1, None) and usage.seconds > 0
    assert not llama.sees and llama.window == 4096


@pytest.mark.parametrize("longest", [1, 2, 7, 20, 33])
def test_what_is_too_long_is_cut_and_still_valid(parts: checkpoint.Checkpoint, longest: int) -> None:
    brief = backend.LocalModel(parts, "transformers:tiny", max_tokens=longest, temperature=1.0)
    pieces: list[str] = []
    answer = brief.answer(asked(WORDS[0], "JSON."), SCHEMA, seconds=120, on_text=pieces.append)
    EditPlan.model_validate_json(answer.text)
    assert answer.end == "closed" and "".join(pieces) == answer.text
    assert longest <= answer.usage.output_tokens < longest + 20  # forced tokens may go a little beyond


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every look at the clock takes a second."""
    ticks = iter(range(100_000))
    monkeypatch.setattr(backend.time, "perf_counter", lambda: float(next(ticks)))
    yield


def test_time_cuts_it_short(clock: None, llama: backend.LocalModel) -> None:
    answer = llama.answer(asked(WORDS[0]), SCHEMA, seconds=14)
    EditPlan.model_validate_json(answer.text)
    assert answer.end == "closed" and 1 < answer.usage.output_tokens < 60


@pytest.mark.parametrize("seconds", [1.5, 3.5])
def test_no_time_at_all_is_said(clock: None, llama: backend.LocalModel, seconds: float) -> None:
    with pytest.raises(UnreachableError, match="allow more seconds"):
        llama.answer(asked(WORDS[0]), SCHEMA, seconds=seconds)


class Halting:
    """A back end whose every answer is a valid plan that was brought to its end without the model."""

    name, sees, window = "transformers:halting", False, 100_000

    def answer(self, messages: Any, schema: Any, *, seconds: float, on_text: Any = None) -> Answer:
        plan = {"verdict": "ok", "ops": [{"op": "delete", "target": {"text": "chair"}}]}
        return Answer(json.dumps(plan), Usage(model=self.name, requests=1), "closed")


def test_half_a_plan_is_never_carried_out() -> None:
    with pytest.raises(NoPlanError, match="cut off"):
        ModelPlanner(Halting()).plan("delete the chair on the left")


def test_a_prompt_beyond_the_window_is_said(llama: backend.LocalModel) -> None:
    with pytest.raises(UnreachableError, match=r"prompt has \d{4,} tokens.*window of transformers:tiny is 4096"):
        llama.answer(asked("a chair " * 2000), SCHEMA, seconds=120)


def test_memory_that_does_not_suffice_is_said(
    parts: checkpoint.Checkpoint, llama: backend.LocalModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = llama.answer(asked(WORDS[0]), SCHEMA, seconds=120).text

    def fail(*_: Any, **__: Any) -> None:
        raise torch.OutOfMemoryError("CUDA out of memory. Tried to allocate 2 GiB")

    with monkeypatch.context() as patch:
        patch.setattr(parts.model.model.layers[1].mlp, "forward", fail)
        with pytest.raises(UnreachableError, match="ran out of memory; use a smaller model"):
            llama.answer(asked(WORDS[1]), SCHEMA, seconds=120)
    # The cache broke half way, and nothing of it is used again.
    assert llama.answer(asked(WORDS[0]), SCHEMA, seconds=120).text == expected


def test_a_schema_that_cannot_be_followed_is_said(llama: backend.LocalModel) -> None:
    with pytest.raises(UnreachableError, match="held to this schema"):
        llama.answer(asked(WORDS[0]), {"type": "string", "format": "poem"}, seconds=120)
