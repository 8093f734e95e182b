"""Remote models, over servers on this machine that speak the three wire formats: success, and everything that fails."""

from __future__ import annotations

import asyncio
import functools
import importlib.util
import json
import logging
import socket
import ssl
import threading
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import loopback as wires
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.errors import BackendError, UserError
from scenewright.planners.model.backend import Answer, Message, ModelBackend, UnreachableError
from scenewright.planners.model.remote import backend, errors, http, wait
from scenewright.planners.model.remote.address import read
from scenewright.planners.model.remote.wire import import_libraries, loosened
from scenewright.planners.schemas import schema

pytest.importorskip("pydantic_ai", reason="needs the extra llm")

Wire = Any
WIRES = [wires.OpenAI, wires.Anthropic, wires.Google]
each_wire = pytest.mark.parametrize("wire", WIRES, ids=[wire.kind for wire in WIRES])

KEY = "sk-scenewright-0123456789-abcdefghij"
PNG = wires.png(40, 30)
PLAN = '{"instruction": "delete the cup", "ops": []}'
TALK = [Message("system", "Answer in JSON."), Message("user", "delete the cup")]
VARIABLES = ("OPENAI", "ANTHROPIC", "GOOGLE", "GEMINI", "SCENEWRIGHT")


@pytest.fixture(scope="module", autouse=True)
def libraries() -> Iterator[None]:
    """The libraries imported, and the system's certificates read once instead of up to three times a request."""
    for kind in ("openai", "anthropic", "google"):
        import_libraries(kind)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ssl, "create_default_context", functools.cache(ssl.create_default_context))
        yield


@pytest.fixture(autouse=True)
def surroundings(monkeypatch: pytest.MonkeyPatch) -> None:
    """One key, no other addresses, a proxy that leads nowhere, and no waiting."""
    for name in VARIABLES:
        monkeypatch.delenv(f"{name}_API_KEY", raising=False)
    for name in ("OPENAI_BASE_URL", "ANTHROPIC_BASE_URL", "GOOGLE_GEMINI_BASE_URL", "NO_PROXY", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
    for name in ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    monkeypatch.setenv("SCENEWRIGHT_API_KEY", KEY)
    monkeypatch.setattr(errors, "FIRST_PAUSE", 0.01)
    monkeypatch.setattr(errors, "_SHORTEST_PAUSE", 0.01)


def model_at(wire: Wire, url: str) -> ModelBackend:
    return backend.load(f"{wire.kind}:small@{url}")


def ask(wire: Wire, *script: Any, seconds: float = 30.0, **how: Any) -> tuple[Answer, list[Any]]:
    with wires.serving(*script) as server:
        return model_at(wire, server.url).answer(TALK, schema("plan"), seconds=seconds, **how), server.asked


def fails(wire: Wire, *script: Any, seconds: float = 30.0, **how: Any) -> str:
    """The message of the failure, after looking that nothing of a library and no key leaks with it."""
    with pytest.raises(UnreachableError) as caught:
        ask(wire, *script, seconds=seconds, **how)
    return sound(caught.value)


def sound(error: BaseException) -> str:
    shown = "".join(traceback.format_exception(error)) + repr(error)
    assert KEY not in shown
    assert error.__cause__ is None and error.__context__ is None
    message = str(error)
    assert message and "\n" not in message
    return message


# Success ---------------------------------------------------------------------------------------------------------


@each_wire
def test_an_answer_comes_back_with_what_it_cost(wire: Wire) -> None:
    answer, asked = ask(wire, wire.answer(PLAN))
    assert json.loads(answer.text) == json.loads(PLAN)
    assert answer.end == "done"
    assert (answer.usage.requests, answer.usage.input_tokens, answer.usage.output_tokens) == (1, 11, 7)
    assert answer.usage.dollars is None  # a server of one's own has no price
    assert 0 < answer.usage.seconds < 30
    assert len(asked) == 1 and KEY in str(asked[0].headers)


@each_wire
def test_the_schema_is_on_the_wire(wire: Wire) -> None:
    _, (asked,) = ask(wire, wire.answer(PLAN))
    sent, given = wire.schema(asked.body), schema("plan")
    assert set(sent["properties"]) == set(given["properties"])
    assert set(sent["required"]) == set(given["required"])
    assert set(sent["$defs"]) == set(given["$defs"])
    for name, definition in given["$defs"].items():
        assert set(sent["$defs"][name].get("required", ())) == set(definition.get("required", ()))
    assert '"#/$defs/Query"' in json.dumps(sent["$defs"]["Query"])  # a query may hold queries
    assert "anyOf" not in sent
    assert '"strict": true' not in json.dumps(asked.body)


@each_wire
def test_every_turn_of_the_conversation_is_sent_in_order(wire: Wire) -> None:
    talk = [*TALK, Message("assistant", "first answer"), Message("user", "that is no JSON")]
    with wires.serving(wire.answer(PLAN)) as server:
        model_at(wire, server.url).answer(talk, schema("plan"), seconds=30)
    text = json.dumps(server.asked[0].body.get("messages") or server.asked[0].body["contents"])
    places = [text.index(message.text) for message in talk[1:]]
    assert places == sorted(places)
    assert "Answer in JSON." in json.dumps(server.asked[0].body)


@each_wire
def test_the_answer_is_asked_for_as_repeatably_as_the_wire_allows(wire: Wire) -> None:
    _, (asked,) = ask(wire, wire.answer(PLAN))
    settings = asked.body.get("generationConfig", asked.body)
    assert settings["temperature"] == 0
    assert ("seed" in settings) == (wire is not wires.Anthropic)


@each_wire
def test_a_picture_arrives_whole(wire: Wire) -> None:
    with wires.serving(wire.answer(PLAN)) as server:
        model = model_at(wire, server.url)
        assert model.sees
        model.answer([TALK[0], Message("user", "look", (PNG,))], schema("plan"), seconds=30)
    assert wire.pictures(server.asked[0].body) == [PNG]


@each_wire
def test_a_streamed_answer_is_heard_in_pieces_in_the_callers_thread(wire: Wire) -> None:
    heard: list[tuple[str, int]] = []
    pieces = [PLAN[:7], PLAN[7:20], PLAN[20:]]
    answer, (asked,) = ask(
        wire, wire.stream(pieces), on_text=lambda piece: heard.append((piece, threading.get_ident()))
    )
    assert "".join(piece for piece, _ in heard) == PLAN
    assert len(heard) == len(pieces)
    assert {thread for _, thread in heard} == {threading.get_ident()}
    assert json.loads(answer.text) == json.loads(PLAN)
    assert (answer.usage.input_tokens, answer.usage.output_tokens) == (11, 7)
    assert asked.body.get("stream") or "streamGenerateContent" in asked.path


@each_wire
def test_it_works_inside_a_running_event_loop_and_from_a_thread_beside_one(wire: Wire) -> None:
    async def within() -> list[Answer]:
        with wires.serving(wire.answer(PLAN)) as server:
            model = model_at(wire, server.url)
            here = model.answer(TALK, schema("plan"), seconds=30)
            return [here, await asyncio.to_thread(model.answer, TALK, schema("plan"), seconds=30)]

    assert [json.loads(answer.text) for answer in asyncio.run(within())] == [json.loads(PLAN)] * 2


def test_hosted_models_have_a_price() -> None:
    from pydantic_ai.messages import ModelResponse, TextPart
    from pydantic_ai.usage import RequestUsage

    from scenewright.planners.model.remote.wire import _reply

    usage = RequestUsage(input_tokens=1_000_000, output_tokens=0)
    response = ModelResponse([TextPart("{}")], usage=usage, model_name="gpt-4o-mini", provider_name="openai")
    address = read("openai:gpt-4o-mini", {"OPENAI_API_KEY": KEY})
    assert _reply(response, address).dollars == pytest.approx(0.15)  # per million tokens read, as published in 2024
    response.model_name = "a model that nobody sells"
    assert _reply(response, address).dollars is None


# How an answer ends ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("wire", "finish"), list(zip(WIRES, ("length", "max_tokens", "MAX_TOKENS"), strict=True)))
@pytest.mark.parametrize("streamed", [False, True])
def test_an_answer_cut_off_says_so(wire: Wire, finish: str, streamed: bool) -> None:
    if streamed:
        answer, _ = ask(wire, wire.stream(['{"ops": [{'], finish), on_text=lambda piece: None)
    else:
        answer, _ = ask(wire, wire.answer('{"ops": [{', finish))
    assert (answer.text, answer.end) == ('{"ops": [{', "cut")


@each_wire
def test_a_refusal_comes_back_in_its_words(wire: Wire) -> None:
    answer, _ = ask(wire, wire.answer("", refusal="I would rather not."))
    assert (answer.text, answer.end) == ("I would rather not.", "declined")


@pytest.mark.parametrize(("wire", "finish"), list(zip(WIRES, ("content_filter", "refusal", "SAFETY"), strict=True)))
def test_a_filter_that_gives_no_words_is_named(wire: Wire, finish: str) -> None:
    answer, _ = ask(wire, wire.stream([], finish), on_text=lambda piece: None)
    assert answer.end == "declined" and finish in answer.text


@each_wire
def test_an_empty_answer_is_an_answer(wire: Wire) -> None:
    answer, _ = ask(wire, wire.answer(""))
    assert (answer.text, answer.end) == ("", "done")


@pytest.mark.parametrize("count", [-5, 10**30, None])
def test_absurd_counts_of_tokens_do_no_harm(count: int | None) -> None:
    usage = {"prompt_tokens": count, "completion_tokens": count, "total_tokens": count}
    try:
        answer, _ = ask(wires.OpenAI, wires.OpenAI.answer(PLAN, usage=usage))
    except UnreachableError:
        return  # the wire's own client may refuse them
    assert 0 <= answer.usage.input_tokens <= 10**9


# What a server does not take --------------------------------------------------------------------------------------


def formats(asked: list[Any]) -> list[str | None]:
    return [request.body.get("response_format", {}).get("type") for request in asked]


def test_a_server_that_knows_no_response_format_is_asked_without_and_remembered() -> None:
    def choosy(asked: Any) -> Any:
        if "response_format" in asked.body:
            return wires.OpenAI.error(400, "Unrecognized request argument supplied: response_format")
        return wires.OpenAI.answer(PLAN)

    with wires.serving(choosy) as server:
        model = model_at(wires.OpenAI, server.url)
        for _ in range(2):
            assert model.answer(TALK, schema("plan"), seconds=30).text == PLAN
    assert formats(server.asked) == ["json_schema", None, None]  # a function's arguments are the next tightest form
    assert ["tools" in request.body for request in server.asked] == [False, True, True]
    assert server.asked[-1].body["temperature"] == 0  # only what was complained about is left out


def test_a_server_whose_grammar_fails_is_asked_for_plain_json() -> None:
    failed = wires.OpenAI.error(500, "failed to parse grammar")
    answer, asked = ask(wires.OpenAI, failed, wires.OpenAI.answer(PLAN))
    assert answer.text == PLAN
    assert formats(asked) == ["json_schema", "json_object"]


def test_anthropic_without_tools_is_asked_in_words() -> None:
    refused = wires.Anthropic.error(400, "tools.0.input_schema: too complex")
    answer, asked = ask(wires.Anthropic, refused, wires.Anthropic.answer(PLAN, tool=False))
    assert answer.text == PLAN
    assert ["tools" in request.body for request in asked] == [True, False]


def test_google_that_takes_no_such_schema_is_asked_for_json() -> None:
    refused = wires.Google.error(400, "The specified schema produces a constraint that has too many states")
    _, asked = ask(wires.Google, refused, wires.Google.answer(PLAN))
    sent = [request.body["generationConfig"] for request in asked]
    assert ["responseJsonSchema" in one for one in sent] == [True, False]
    assert {one["responseMimeType"] for one in sent} == {"application/json"}


@each_wire
@pytest.mark.parametrize("name", ["temperature", "max_tokens"])
def test_a_setting_that_is_refused_is_left_out(wire: Wire, name: str) -> None:
    refused = wire.error(400, f"Unsupported value: '{name}' does not support this with this model.")
    answer, asked = ask(wire, refused, wire.answer(PLAN))
    assert json.loads(answer.text) == json.loads(PLAN)
    first, second = (request.body.get("generationConfig", request.body) for request in asked)
    spelled = "maxOutputTokens" if wire is wires.Google and name == "max_tokens" else name
    assert spelled in first
    if (wire, name) != (wires.Anthropic, "max_tokens"):  # which that wire cannot do without
        assert spelled not in second


def test_a_refusal_without_reason_is_met_with_the_barest_request() -> None:
    answer, asked = ask(wires.OpenAI, wires.OpenAI.error(422, "Unprocessable Entity"), wires.OpenAI.answer(PLAN))
    assert answer.text == PLAN
    assert set(asked[1].body) == {"model", "messages", "stream"}


@each_wire
def test_a_server_that_ignores_the_wish_for_a_stream_is_asked_at_once(wire: Wire) -> None:
    heard: list[str] = []
    answer, asked = ask(wire, wire.answer(PLAN), on_text=heard.append)
    assert json.loads(answer.text) == json.loads(PLAN) and json.loads("".join(heard)) == json.loads(PLAN)
    assert len(asked) <= 2  # Google's client reads such an answer at the first request


def test_a_server_that_cannot_stream_is_asked_at_once() -> None:
    heard: list[str] = []
    refused = wires.OpenAI.error(400, "stream_options is not supported")
    answer, asked = ask(wires.OpenAI, refused, wires.OpenAI.answer(PLAN), on_text=heard.append)
    assert answer.text == PLAN and heard == [PLAN]
    assert [request.body["stream"] for request in asked] == [True, False]


@each_wire
def test_a_server_that_refuses_everything_is_asked_a_few_times_only(wire: Wire) -> None:
    refused = wire.error(400, "response_format temperature seed max_tokens stream tools are not what I want")
    with wires.serving(refused) as server, pytest.raises(UnreachableError) as caught:
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=30)
    assert "are not what I want" in sound(caught.value)
    assert 2 <= len(server.asked) <= 6


def test_alternatives_beside_properties_are_dropped_and_nothing_else() -> None:
    union = {"oneOf": [{"type": "string"}, {"type": "null"}]}
    given = {"properties": {"a": union, "b": {"anyOf": [{"$ref": "#/$defs/B"}]}}, "anyOf": [{"required": ["a"]}]}
    assert loosened(given) == {"properties": given["properties"]}
    assert loosened([union, 3, "x", None]) == [union, 3, "x", None]


# What fails ------------------------------------------------------------------------------------------------------


@each_wire
@pytest.mark.parametrize("status", [401, 403])
def test_a_wrong_key_names_the_variable(wire: Wire, status: int) -> None:
    message = fails(wire, wire.error(status, "invalid key"))
    assert "SCENEWRIGHT_API_KEY" in message and "invalid key" in message


@each_wire
def test_a_model_that_is_not_there_is_named(wire: Wire) -> None:
    assert "no model 'small'" in fails(wire, wire.error(404, "model 'small' not found, try pulling it first"))


def test_a_page_that_is_not_there_hints_at_the_address() -> None:
    page = wires.plain("404 page not found", 404, Content_Type="text/plain")
    assert "/v1" in fails(wires.OpenAI, page)


@each_wire
@pytest.mark.parametrize(
    "words",
    [
        "This model's maximum context length is 8192 tokens. However, your messages resulted in 9000 tokens",
        "prompt is too long: 250000 tokens > 200000 maximum",
        "the request exceeds the available context size. try increasing it",
    ],
)
def test_a_conversation_too_long_for_the_model_is_not_tried_again(wire: Wire, words: str) -> None:
    with wires.serving(wire.error(400, words)) as server, pytest.raises(UnreachableError) as caught:
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=30)
    assert "longer than small" in sound(caught.value)
    assert len(server.asked) == 1


def test_an_answer_longer_than_fits_is_asked_for_without_a_longest() -> None:
    words = "'max_tokens' is too large: 16384. This model's maximum context length is 8192 tokens"
    answer, asked = ask(wires.OpenAI, wires.OpenAI.error(400, words), wires.OpenAI.answer(PLAN))
    assert answer.text == PLAN
    assert ["max_tokens" in request.body for request in asked] == [True, False]


@each_wire
def test_a_model_that_takes_no_pictures_says_so(wire: Wire) -> None:
    assert "takes no pictures" in fails(wire, wire.error(400, "image input is not supported by this model"))


@each_wire
def test_a_busy_server_is_asked_again(wire: Wire) -> None:
    busy = wire.error(429, "slow down", Retry_After="0")
    answer, asked = ask(wire, busy, busy, busy, busy, wire.answer(PLAN))
    assert json.loads(answer.text) == json.loads(PLAN)
    assert len(asked) == 5


@each_wire
def test_a_busy_server_that_asks_for_more_patience_than_there_is_ends_it_at_once(wire: Wire) -> None:
    began = time.monotonic()
    message = fails(wire, wire.error(429, "slow down", Retry_After="3600"), seconds=20)
    assert "3600 s" in message and "slow down" in message
    assert time.monotonic() - began < 15  # it did not wait


@each_wire
def test_a_server_that_stays_busy_is_given_up_when_time_is_up(wire: Wire) -> None:
    with wires.serving(wire.error(429, "slow down")) as server, pytest.raises(UnreachableError) as caught:
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=1)
    assert "no more requests" in sound(caught.value)
    assert len(server.asked) > 1


def test_an_empty_purse_is_not_waited_for() -> None:
    broke = wires.OpenAI.error(429, "You exceeded your current quota", code="insufficient_quota")
    with wires.serving(broke) as server, pytest.raises(UnreachableError, match="billing"):
        model_at(wires.OpenAI, server.url).answer(TALK, schema("plan"), seconds=30)
    assert len(server.asked) == 1


@each_wire
def test_a_broken_server_is_asked_again_but_not_for_ever(wire: Wire) -> None:
    broken = wire.error(503, "out of order")
    answer, asked = ask(wire, broken, broken, wire.answer(PLAN))
    assert json.loads(answer.text) == json.loads(PLAN) and len(asked) == 3
    with wires.serving(broken) as server, pytest.raises(UnreachableError) as caught:
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=30)
    assert "503" in sound(caught.value) and len(server.asked) == 3


@each_wire
@pytest.mark.parametrize("on_text", [None, lambda piece: None])
@pytest.mark.parametrize("body", ["<html>Welcome to your router</html>", "", "[1, 2", '"yes"', "{}", '{"choices": 7}'])
def test_an_answer_that_is_none(wire: Wire, on_text: Any, body: str) -> None:
    assert "no answer of a language model" in fails(wire, wires.plain(body), on_text=on_text)


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner, max_size=3),
    max_leaves=5,
)


def spoiled(body: Any, data: st.DataObject) -> Any:
    """The body with one part of it, at any depth, something else or gone."""
    if not isinstance(body, dict | list) or not body or data.draw(st.integers(0, 3)) == 0:
        return data.draw(JUNK)
    copy: Any = body.copy()
    at = data.draw(st.sampled_from(sorted(body) if isinstance(body, dict) else range(len(body))))
    if data.draw(st.integers(0, 4)) == 0:
        del copy[at]
    else:
        copy[at] = spoiled(body[at], data)
    return copy


@pytest.fixture(scope="module")
def pliable() -> Iterator[tuple[Any, list[Any]]]:
    """A server, and a list whose last turn it takes next: starting one for each example costs more than the example."""
    turns: list[Any] = []
    with wires.serving(lambda asked: turns[-1]) as server:
        yield server, turns


@each_wire
@settings(max_examples=6)
@given(data=st.data())
def test_whatever_a_server_says_there_is_an_answer_or_a_sentence(
    wire: Wire, pliable: tuple[Any, list[Any]], data: st.DataObject
) -> None:
    spoiled_answer_is_told(wire, pliable, data)


@pytest.mark.slow
@each_wire
@settings(max_examples=80)
@given(data=st.data())
def test_much_that_a_server_says_is_an_answer_or_a_sentence(
    wire: Wire, pliable: tuple[Any, list[Any]], data: st.DataObject
) -> None:
    spoiled_answer_is_told(wire, pliable, data)


def spoiled_answer_is_told(wire: Wire, pliable: tuple[Any, list[Any]], data: st.DataObject) -> None:
    server, turns = pliable
    if data.draw(st.booleans(), label="streamed"):
        lines = b"".join(wire.stream([PLAN[:9], PLAN[9:]]).chunks).decode().split("\n")
        at = data.draw(st.sampled_from([i for i, line in enumerate(lines) if line.startswith("data: {")]))
        lines[at] = f"data: {json.dumps(spoiled(json.loads(lines[at][6:]), data))}"
        turn, on_text = wires.Turn(["\n".join(lines).encode()], streamed=True), list[str]().append
    else:
        turn, on_text = wires.plain(spoiled(json.loads(b"".join(wire.answer(PLAN).chunks)), data)), None
    turns.append(turn)
    try:
        answer = model_at(wire, server.url).answer(TALK, {"type": "object"}, seconds=30, on_text=on_text)
    except UnreachableError as error:
        sound(error)
    else:
        assert isinstance(answer.text, str)
        assert answer.end in ("done", "cut", "declined")


@pytest.mark.parametrize("seconds", [0.0, -1.0])
def test_without_time_nobody_is_asked(seconds: float) -> None:
    assert "did not answer within" in fails(wires.OpenAI, wires.OpenAI.answer(PLAN), seconds=seconds)


@each_wire
def test_a_body_that_breaks_off(wire: Wire) -> None:
    whole = b"".join(wire.answer(PLAN).chunks)
    assert "broke off" in fails(wire, wires.Turn([whole], promised=50))


@each_wire
def test_a_stream_that_breaks_off(wire: Wire) -> None:
    heard: list[str] = []

    def pieces() -> Iterator[str]:
        yield PLAN[:9]
        yield PLAN[9:]

    turn = wire.stream(pieces(), cut=True)
    chunks = list(turn.chunks)[: 4 if wire is wires.Anthropic else 2]
    assert "broke off" in fails(wire, wires.Turn(chunks, streamed=True, cut=True), on_text=heard.append)
    assert heard  # and it was not asked again: what was heard cannot be taken back


@each_wire
def test_a_server_that_trickles_is_left_in_time(wire: Wire) -> None:
    began = time.monotonic()
    body = b"".join(wire.answer(PLAN).chunks)
    message = fails(wire, wires.Turn([body[i : i + 1] for i in range(len(body))], pause=0.1), seconds=0.4)
    assert "within 0.4 s" in message
    assert time.monotonic() - began < 1 + 8  # the body would take 30 s


@each_wire
def test_a_stream_without_end_is_left_in_time(wire: Wire) -> None:
    def endless() -> Iterator[str]:
        while True:
            yield " "

    heard: list[str] = []
    assert "within 0.4 s" in fails(wire, wire.stream(endless(), pause=0.02), seconds=0.4, on_text=heard.append)


@each_wire
def test_an_answer_of_a_hundred_megabytes_is_not_read(wire: Wire) -> None:
    sent = []

    def flood() -> Iterator[bytes]:
        for _ in range(100):
            sent.append(1)
            yield b" " * (1 << 20)

    headers = {"Content-Type": "application/json"}
    assert "more than any answer" in fails(wire, wires.Turn(flood(), streamed=True, headers=headers))
    assert len(sent) < 60  # 32 were read, some lay in the pipe


@each_wire
def test_a_stream_without_end_is_not_read_for_ever(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http, "_MAX_BYTES", 1 << 20)

    def endless() -> Iterator[str]:
        while True:
            yield "x" * 10_000

    assert "more than any answer" in fails(wire, wire.stream(endless()), on_text=lambda piece: None)


@each_wire
def test_a_compressed_answer_is_not_unpacked(wire: Wire) -> None:
    assert "compresses" in fails(wire, wires.plain("x", Content_Encoding="gzip"))


@each_wire
def test_nobody_is_followed_elsewhere(wire: Wire) -> None:
    with wires.serving(wire.answer(PLAN)) as thief:
        turn = wires.plain("", 307, Location=f"{thief.url}/v1/there")
        assert f"{thief.url}/v1/there" in fails(wire, turn)
    assert not thief.asked


@each_wire
def test_no_server(wire: Wire) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{taken.getsockname()[1]}"
    with pytest.raises(UnreachableError) as caught:
        model_at(wire, url).answer(TALK, schema("plan"), seconds=30)
    assert f"nothing answers at {url}" in sound(caught.value)


@each_wire
def test_no_such_host(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere(*args: object, **kwargs: object) -> None:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", nowhere)
    with pytest.raises(UnreachableError) as caught:
        model_at(wire, "http://nosuchhost").answer(TALK, schema("plan"), seconds=30)
    assert "no host of the name" in sound(caught.value)


@each_wire
def test_a_name_look_up_that_hangs_does_not_hold_the_caller(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    enough = threading.Event()

    def hanging(*args: object, **kwargs: object) -> None:
        enough.wait(20)
        raise socket.gaierror(socket.EAI_AGAIN, "Temporary failure in name resolution")

    monkeypatch.setattr(socket, "getaddrinfo", hanging)
    monkeypatch.setattr(wait, "_GRACE", 0.2)
    try:
        with pytest.raises(UnreachableError) as caught:
            model_at(wire, "http://slowhost").answer(TALK, schema("plan"), seconds=0.3)
    finally:
        enough.set()
    assert "within 0.3 s" in sound(caught.value)


@each_wire
def test_a_plain_server_behind_an_https_address(wire: Wire) -> None:
    with wires.serving(wire.answer(PLAN)) as server, pytest.raises(UnreachableError) as caught:
        secure = server.url.replace("http://", "https://")
        model_at(wire, secure).answer(TALK, schema("plan"), seconds=30)
    assert "no trusted connection" in sound(caught.value)


@each_wire
def test_a_certificate_that_nobody_vouches_for(wire: Wire, tmp_path: Path) -> None:
    tls = _self_signed(tmp_path)
    with wires.serving(wire.answer(PLAN), tls=tls) as server, pytest.raises(UnreachableError) as caught:
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=30)
    assert "CERTIFICATE_VERIFY_FAILED" in sound(caught.value)
    assert "SSL_CERT_FILE" in str(caught.value)


def _self_signed(folder: Path) -> ssl.SSLContext:
    import datetime

    x509 = pytest.importorskip("cryptography.x509")
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "127.0.0.1")])
    now = datetime.datetime.now(datetime.UTC)
    made = x509.CertificateBuilder().subject_name(name).issuer_name(name).public_key(key.public_key())
    made = made.serial_number(1).not_valid_before(now).not_valid_after(now + datetime.timedelta(days=1))
    certificate = made.sign(key, hashes.SHA256())
    pem = key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
    (folder / "server.pem").write_bytes(pem + certificate.public_bytes(serialization.Encoding.PEM))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(folder / "server.pem")
    return context


# Keys ------------------------------------------------------------------------------------------------------------


@each_wire
@pytest.mark.parametrize("status", [200, 400, 401, 404, 418, 429, 500])
@pytest.mark.parametrize("on_text", [None, lambda piece: None])
def test_a_key_that_the_server_echoes_is_not_shown(
    wire: Wire, status: int, on_text: Any, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    caplog.set_level(logging.DEBUG)
    for logger in ("openai", "anthropic", "google_genai", "httpx2", "httpcore2"):
        caplog.set_level(logging.DEBUG, logger)
    echoed = f"no good: {KEY}, that is {KEY[:-4]}**** and {json.dumps(KEY)}; dear \x1b[31m{KEY}\x1b[0m"
    message = fails(wire, wire.error(status, echoed, Retry_After="999"), on_text=on_text)
    assert KEY[:20] not in message and "\x1b" not in message
    assert KEY not in caplog.text
    assert KEY not in "".join(capfd.readouterr())


@each_wire
def test_a_key_in_an_answer_is_not_handed_on(wire: Wire) -> None:
    answer, _ = ask(wire, wire.answer(json.dumps({"instruction": f"my key is {KEY}"})))
    assert KEY not in answer.text and "[key]" in answer.text


def test_a_key_does_not_show_in_what_a_model_looks_like() -> None:
    address = read("openai:small", {"OPENAI_API_KEY": KEY})
    assert address.key == KEY
    assert KEY not in repr(address)


# Stopping --------------------------------------------------------------------------------------------------------


@each_wire
@pytest.mark.parametrize("stop", [KeyboardInterrupt, RuntimeError])
def test_what_the_listener_raises_ends_the_request(wire: Wire, stop: type[BaseException]) -> None:
    def endless() -> Iterator[str]:
        while True:
            yield "x"

    def listener(piece: str) -> None:
        raise stop("enough")

    with wires.serving(wire.stream(endless(), pause=0.01)) as server, pytest.raises(stop, match="enough"):
        model_at(wire, server.url).answer(TALK, schema("plan"), seconds=30, on_text=listener)
    for _ in range(200):
        if not any(thread.name == "scenewright-model" for thread in threading.enumerate()):
            return
        time.sleep(0.05)
    pytest.fail("the request goes on behind the caller's back")


# Addresses -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("spec", "model", "url"),
    [
        ("openai:gpt-4o", "gpt-4o", "https://api.openai.com/v1"),
        ("openai:qwen3:8b@http://localhost:11434/v1", "qwen3:8b", "http://localhost:11434/v1"),
        ("openai:qwen3:8b@http://localhost:11434", "qwen3:8b", "http://localhost:11434/v1"),
        ("openai:Qwen/Qwen3-VL@HTTP://10.0.0.7:8000/v1/", "Qwen/Qwen3-VL", "HTTP://10.0.0.7:8000/v1"),
        ("openai:publisher/model@2024@https://x.example/a/b", "publisher/model@2024", "https://x.example/a/b"),
        ("openai:hf.co/a/b:Q4_K_M@http://[::1]:80/v1", "hf.co/a/b:Q4_K_M", "http://[::1]:80/v1"),
        ("anthropic:claude@20240620", "claude@20240620", "https://api.anthropic.com"),
        ("anthropic:small@http://localhost:1/v1", "small", "http://localhost:1"),
        ("google:models/small@http://localhost:1/v1beta/", "models/small", "http://localhost:1"),
    ],
)
def test_specifications(spec: str, model: str, url: str) -> None:
    address = read(spec, {"SCENEWRIGHT_API_KEY": KEY})
    assert (address.name, address.model, address.url) == (spec, model, url)
    assert backend.load(spec).name == spec


@pytest.mark.parametrize(
    "spec",
    [
        "",
        "openai",
        "openai:",
        "mistral:small",
        "openai:@http://localhost/v1",
        "openai:a b",
        "openai:small@ftp://localhost",
        "openai:small@http://",
        "openai:small@http://user:password@localhost/v1",
        "openai:small@http://localhost/v1?key=1",
        "openai:small@http://localhost:99999/v1",
        "openai:small@http://localhost:x/v1",
        "openai:small@http://[::1/v1",
        "openai:small@http://local host/v1",
        "google:../../files@http://localhost",
        "google:small?alt=sse@http://localhost",
        "openai:" + "x" * 300,
        f"openai:{KEY}",
        f"openai:small@http://localhost/{KEY}/v1",
        "openai:small\x00",
    ],
)
def test_specifications_that_are_none(spec: str) -> None:
    with pytest.raises(UserError) as caught:
        read(spec, {"SCENEWRIGHT_API_KEY": KEY})
    assert KEY not in str(caught.value) and "password@" not in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "variable"), [("openai", "OPENAI"), ("anthropic", "ANTHROPIC"), ("google", "GOOGLE"), ("google", "GEMINI")]
)
def test_keys_come_from_the_environment(kind: str, variable: str) -> None:
    own = {f"{variable}_API_KEY": f" {KEY}\n"}
    assert read(f"{kind}:small", own).key == KEY
    assert read(f"{kind}:small", {**own, "SCENEWRIGHT_API_KEY": "another-key"}).key == "another-key"
    with pytest.raises(BackendError, match=f"{variable}_API_KEY"):
        read(f"{kind}:small", {})
    with pytest.raises(BackendError, match=f"{variable}_API_KEY holds letters"):
        read(f"{kind}:small", {f"{variable}_API_KEY": f"“{KEY}”"})


def test_a_server_of_ones_own_needs_no_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SCENEWRIGHT_API_KEY")
    with wires.serving(wires.OpenAI.answer(PLAN)) as server:
        assert model_at(wires.OpenAI, server.url).answer(TALK, schema("plan"), seconds=30).text == PLAN
        with pytest.raises(BackendError, match="ANTHROPIC_API_KEY"):
            model_at(wires.Anthropic, server.url)


@pytest.mark.parametrize("missing", ["pydantic_ai", "google"])
def test_a_missing_package_is_named_when_the_model_is(missing: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec

    def without(name: str, *args: Any) -> Any:
        if name.split(".")[0] == missing:
            if "." in name:
                raise ModuleNotFoundError(name)
            return None
        return found(name, *args)

    monkeypatch.setattr(importlib.util, "find_spec", without)
    with pytest.raises(BackendError, match=r"pip install 'scenewright\[llm\]'"):
        backend.load("google:small")


@each_wire
def test_another_address_comes_from_the_variable_that_its_own_tools_read(
    wire: Wire, monkeypatch: pytest.MonkeyPatch
) -> None:
    variable = {"openai": "OPENAI_BASE_URL", "anthropic": "ANTHROPIC_BASE_URL", "google": "GOOGLE_GEMINI_BASE_URL"}
    with wires.serving(wire.answer(PLAN)) as server:
        monkeypatch.setenv(variable[wire.kind], server.url)
        answer = backend.load(f"{wire.kind}:small").answer(TALK, schema("plan"), seconds=30)
    assert json.loads(answer.text) == json.loads(PLAN)
    assert answer.usage.model == f"{wire.kind}:small"


@pytest.mark.parametrize(
    ("url", "near"),
    [
        ("http://localhost:1", True),
        ("http://127.0.0.1:1", True),
        ("http://[::1]:1", True),
        ("http://192.168.3.4", True),
        ("http://ollama:11434", True),
        ("http://workshop.local", True),
        ("https://8.8.8.8", False),
        ("https://openrouter.ai/api/v1", False),
    ],
)
def test_what_is_near_is_asked_without_a_proxy_and_thought_small(url: str, near: bool) -> None:
    model = backend.load(f"openai:small@{url}")
    assert read(f"openai:small@{url}", {}).near == near
    assert model.window == (backend.NEAR_WINDOW if near else backend.HOSTED_WINDOW)


def test_what_is_far_is_asked_through_the_proxy() -> None:
    with pytest.raises(UnreachableError) as caught:  # the proxy of the surroundings leads nowhere
        backend.load("openai:small@http://8.8.8.8").answer(TALK, schema("plan"), seconds=30)
    assert "proxy" in sound(caught.value)


@pytest.mark.parametrize("proxy", ["socks9://127.0.0.1:9", "ftp://127.0.0.1:9"])
def test_a_proxy_that_is_none(proxy: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", proxy)
    with pytest.raises(UnreachableError, match="ALL_PROXY"):
        backend.load("openai:small@http://8.8.8.8").answer(TALK, schema("plan"), seconds=30)


@pytest.mark.parametrize(
    ("spec", "sees"),
    [
        ("openai:gpt-4o-mini", True),
        ("openai:gpt-4", False),
        ("openai:gpt-3.5-turbo", False),
        ("openai:o3-mini", False),
        ("anthropic:claude-sonnet-4-5", True),
        ("google:gemini-2.5-flash", True),
        ("openai:gpt-3.5-turbo@http://localhost:1", True),
    ],
)
def test_who_sees(spec: str, sees: bool) -> None:
    assert backend.load(spec).sees == sees
