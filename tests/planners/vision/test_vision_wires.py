"""Questions about pictures over servers that speak the three wire formats: pictures, streams, retries and budgets."""

from __future__ import annotations

import io
import json
from typing import Any

import loopback as wires
import pytest
from PIL import Image
from scripted_looker import ScriptedLooker

from scenewright.planners import model
from scenewright.planners.budget import Budget, Ledger
from scenewright.planners.model import pictures
from scenewright.planners.model.backend import Message, UnreachableError
from scenewright.planners.model.remote import errors
from scenewright.planners.questions.answer import Answer
from scenewright.planners.vision.answering import Terms, ask_about
from scenewright.planners.vision.facts import Facts
from scenewright.planners.vision.judging import verdict

pytest.importorskip("pydantic_ai", reason="needs the extra llm")

Wire = Any
WIRES = [wires.OpenAI, wires.Anthropic, wires.Google]
each_wire = pytest.mark.parametrize("wire", WIRES, ids=[wire.kind for wire in WIRES])
LIMITS = {"openai": pictures.OPENAI, "anthropic": pictures.ANTHROPIC, "google": pictures.GOOGLE}

YES = json.dumps({"because": "It is tidy.", "answer": "yes", "answer_type": "yesno", "confidence": 0.9})
MORE = json.dumps({"answer_type": "yesno", "confidence": 0.2, "need_more": ["close:#2", "plan"]})
VERDICT = json.dumps(
    {"reason": "The vase is gone.", "done": True, "right_thing": True, "residue": False, "looks_right": True}
)


@pytest.fixture(autouse=True)
def surroundings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("SCENEWRIGHT_API_KEY", "sk-scenewright-0123456789-abcdefghij")
    monkeypatch.setattr(errors, "FIRST_PAUSE", 0.01)
    monkeypatch.setattr(errors, "_SHORTEST_PAUSE", 0.01)


def asked(wire: Wire, *script: Any, looker: Any = None, **terms: Any) -> tuple[Answer, list[Any]]:
    with wires.serving(*script) as server:
        backend = model.load(f"{wire.kind}:small@{server.url}")
        answer = ask_about("is it tidy?", Facts(), looker or ScriptedLooker(), backend, Terms(**terms))
        return answer, server.asked


def written(asked: Any) -> str:
    return json.dumps(asked.body, ensure_ascii=False)


@each_wire
def test_pictures_arrive_in_order_and_the_answer_comes_back(wire: Wire) -> None:
    answer, (sent,) = asked(wire, wire.answer(YES))
    assert (answer.answer, answer.confidence, answer.text) == ("yes", 0.9, "Yes: It is tidy.")
    assert wire.pictures(sent.body) == [wires.png(32, 24, seed) for seed in (1, 2, 3)]
    text = written(sent)
    assert text.index("Picture 1:") < text.index("Picture 2:") < text.index("Picture 3:") < text.index("is it tidy?")
    assert "cannot_tell" in wire.schema(sent.body)["properties"]
    assert answer.usage is not None and (answer.usage.input_tokens, answer.usage.output_tokens) == (11, 7)


@each_wire
def test_what_it_asks_for_is_sent_in_the_next_request(wire: Wire) -> None:
    looker = ScriptedLooker()
    answer, sent = asked(wire, wire.answer(MORE), wire.answer(YES), looker=looker)
    assert answer.answer == "yes" and looker.made[-2:] == ["close:20", "plan"]
    assert [len(wire.pictures(one.body)) for one in sent] == [3, 5]


@each_wire
def test_pictures_are_scaled_down_to_what_the_server_reads(wire: Wire) -> None:
    limits = LIMITS[wire.kind]
    _, (sent,) = asked(wire, wire.answer(YES), looker=ScriptedLooker(size=(limits.long + 64, 100)), first=1)
    (arrived,) = wire.pictures(sent.body)
    size = Image.open(io.BytesIO(arrived)).size
    assert size == limits.size(limits.long + 64, 100) and len(arrived) <= limits.bytes


@each_wire
def test_a_stream_shows_progress(wire: Wire) -> None:
    heard: list[str] = []
    pieces = [YES[i : i + 20] for i in range(0, len(YES), 20)]
    answer, _ = asked(wire, wire.stream(pieces), progress=lambda stage, share: heard.append(stage))
    assert answer.answer == "yes" and len(heard) > 3 and "3 pictures" in heard[0]


@each_wire
def test_busy_and_failing_servers_are_asked_again(wire: Wire) -> None:
    answer, sent = asked(wire, wire.error(429, "slow down"), wire.error(503, "overloaded"), wire.answer(YES))
    assert answer.answer == "yes" and len(sent) == 3


@each_wire
def test_a_malformed_reply_is_repaired_with_the_pictures_still_there(wire: Wire) -> None:
    bad = YES.replace("0.9", "9")
    answer, sent = asked(wire, wire.answer(bad), wire.answer(YES))
    assert answer.answer == "yes" and "confidence: Input should be less than" in written(sent[1])
    assert written(sent[1]).count("iVBORw0KGgo") == 3


@each_wire
def test_a_refused_schema_is_left_out(wire: Wire) -> None:
    answer, sent = asked(wire, wire.error(400, "response_format and tools are not supported"), wire.answer(YES))
    assert answer.answer == "yes" and len(sent) == 2


@each_wire
def test_a_model_that_refuses_pictures_is_told(wire: Wire) -> None:
    with pytest.raises(UnreachableError, match="takes no pictures"):
        asked(wire, wire.error(400, "image input is not supported by this model"))


@each_wire
def test_a_dead_server_is_told(wire: Wire) -> None:
    with pytest.raises(UnreachableError, match="key"):
        asked(wire, wire.error(401, "no such key"))


@each_wire
def test_tokens_and_views_of_the_budget_hold(wire: Wire) -> None:
    looker = ScriptedLooker()
    answer, sent = asked(wire, wire.answer(MORE), looker=looker, ledger=Ledger(Budget(tokens=18, views=2)))
    assert answer.answer is None and "18 tokens" in answer.text
    assert len(sent) == 1 and len(wire.pictures(sent[0].body)) == 2 and len(looker.made) == 2


@each_wire
def test_a_slow_server_ends_with_the_seconds(wire: Wire) -> None:
    slow = wire.stream([YES], pause=3.0)
    with pytest.raises(UnreachableError, match="did not answer within"):
        asked(wire, slow, ledger=Ledger(Budget(seconds=0.3)))


@each_wire
def test_a_verdict_sees_before_and_after_in_turn(wire: Wire) -> None:
    looker = ScriptedLooker()
    before, after = looker.overview((), 2), looker.overview((), 2)
    with wires.serving(wire.answer(VERDICT)) as server:
        backend = model.load(f"{wire.kind}:small@{server.url}")
        found = verdict("delete the vase", before, after, backend)
        (sent,) = server.asked
    assert found.passed and found.reason == "The vase is gone."
    assert wire.pictures(sent.body) == [one.png for pair in zip(before, after, strict=True) for one in pair]


@each_wire
def test_the_last_message_alone_is_counted_as_shown(wire: Wire) -> None:
    """Pictures of earlier turns are sent too, in their place."""
    talk = [
        Message("system", "JSON."), Message("user", "look", (wires.png(9, 9, 1), wires.png(9, 9, 2))),
        Message("assistant", "seen"), Message("user", "and here?", (wires.png(9, 9, 3),)),
    ]  # fmt: skip
    with wires.serving(wire.answer(YES)) as server:
        model.load(f"{wire.kind}:small@{server.url}").answer(talk, {"type": "object"}, seconds=30)
        (sent,) = server.asked
    assert wire.pictures(sent.body) == [wires.png(9, 9, 3)] and written(sent).count("iVBORw0KGgo") == 3
