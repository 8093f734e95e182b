"""The tiny LLaVA of random weights is asked everything that vision models are asked: its replies are valid."""

from __future__ import annotations

from pathlib import Path

import pytest
from scripted_looker import ScriptedLooker

from scenewright.planners.vision.answering import SeenReply, Terms, ask_about
from scenewright.planners.vision.asking import Purse, read, schema
from scenewright.planners.vision.captions import CaptionsReply, captions
from scenewright.planners.vision.facts import Facts
from scenewright.planners.vision.judging import VerdictReply, verdict
from scenewright.planners.vision.pointing import PointReply, point

pytest.importorskip("llguidance", reason="pip install 'scenewright[models]'")

from loopback import png

from scenewright.planners.model.backend import Message
from scenewright.planners.model.local import backend, checkpoint
from scenewright.planners.plan import NoPlanError

KINDS = (SeenReply, CaptionsReply, VerdictReply, PointReply)


@pytest.fixture(scope="module")
def parts(tiny_llava: Path) -> checkpoint.Checkpoint:
    return checkpoint.read(str(tiny_llava))


def model(parts: checkpoint.Checkpoint, seed: int = 0) -> backend.LocalModel:
    return backend.LocalModel(parts, "transformers:tiny", temperature=0.7 if seed else 0.0, seed=seed, max_tokens=500)


def drawn(parts: checkpoint.Checkpoint, seeds: range) -> tuple[int, int]:
    """How many replies ended by themselves, and how many of these are valid by their type or say something that only
    the type's own rules refuse (an answer and cannot_tell at once)."""
    ended = shaped = 0
    for seed in seeds:
        kind = KINDS[seed % len(KINDS)]
        messages = [Message("system", "Answer with JSON."), Message("user", f"look {seed}", (png(28, 28, seed),))]
        answer = model(parts, seed + 1).answer(messages, schema(kind), seconds=60)
        if answer.end != "done":
            continue
        ended += 1
        try:
            read(answer.text, kind)
        except ValueError as error:
            shaped += str(error).startswith("the answer: ")  # a rule between fields, which no schema says
        else:
            shaped += 1
    return ended, shaped


def test_replies_follow_their_schemas(parts: checkpoint.Checkpoint) -> None:
    ended, shaped = drawn(parts, range(4))
    assert ended >= 2 and shaped == ended


@pytest.mark.slow
def test_two_hundred_replies_follow_their_schemas(parts: checkpoint.Checkpoint) -> None:
    ended, shaped = drawn(parts, range(10, 210))
    assert ended >= 150 and shaped == ended


@pytest.mark.slow
def test_all_questions_about_pictures_go_through(parts: checkpoint.Checkpoint) -> None:
    llava, looker = model(parts), ScriptedLooker()
    answer = ask_about("is it tidy?", Facts(), looker, llava, Terms(first=2, samples=1))
    assert answer.source in ("vlm", "none") and answer.usage is not None and answer.usage.input_tokens > 500
    for ask in (
        lambda: captions((10, 20), Facts(), looker, llava, Purse(views=2)),
        lambda: point("the cup", (), looker, llava, Purse(views=3)),
        lambda: verdict("delete it", looker.overview((), 1), looker.overview((), 1), llava),
    ):
        try:
            ask()
        except NoPlanError as error:
            assert "no usable reply" in str(error)
