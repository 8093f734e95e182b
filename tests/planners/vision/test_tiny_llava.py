"""The tiny LLaVA of random weights is asked everything that vision models are asked: its replies are valid."""

from __future__ import annotations

from pathlib import Path

import pytest
from scripted_looker import ScriptedLooker

from scenewright.planners.questions.answer import AnswerType
from scenewright.planners.vision import answering
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


def drawn(parts: checkpoint.Checkpoint, seeds: range) -> int:
    """How many replies ended by themselves; all of them must be valid by their type."""
    ended = 0
    for seed in seeds:
        kind = KINDS[seed % len(KINDS)]
        messages = [Message("system", "Answer with JSON."), Message("user", f"look {seed}", (png(28, 28, seed),))]
        answer = model(parts, seed + 1).answer(messages, schema(kind), seconds=60)
        if answer.end == "done":
            ended += 1
            read(answer.text, kind)
    return ended


def test_replies_follow_their_types(parts: checkpoint.Checkpoint) -> None:
    assert drawn(parts, range(4)) >= 2


@pytest.mark.slow
def test_two_hundred_replies_follow_their_types(parts: checkpoint.Checkpoint) -> None:
    assert drawn(parts, range(10, 210)) >= 150


@pytest.mark.parametrize("wanted", ["yesno", "number", "list"])
def test_answers_have_the_type_that_is_asked_for_and_numbers_that_are_there(
    parts: checkpoint.Checkpoint, wanted: AnswerType
) -> None:
    messages = [Message("system", "Answer with JSON."), Message("user", "look", (png(28, 28),))]
    for seed in (1, 2):
        answer = model(parts, seed).answer(messages, answering._schema(wanted, 1, {4, 5}), seconds=60)
        if answer.end == "done":
            reply = read(answer.text, SeenReply)
            assert reply.answer is None or reply.answer_type == wanted
            assert set(reply.things) <= {4, 5} and set(reply.evidence_views) <= {1}


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
