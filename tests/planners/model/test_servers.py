"""What servers of one's own can and tell: streams that break, forms of answers that they take, and their window."""

from __future__ import annotations

import functools
import json
import ssl
from collections.abc import Callable, Iterator
from typing import Any

import loopback
import pytest

from scenewright.gaussians.errors import UserError
from scenewright.planners import model as models
from scenewright.planners.model.backend import Answer, Message, ModelBackend, UnreachableError
from scenewright.planners.model.remote import backend, context_window, errors
from scenewright.planners.model.remote.wire import import_libraries
from scenewright.planners.schemas import schema

pytest.importorskip("pydantic_ai", reason="needs the extra llm")

OpenAI = loopback.OpenAI
PLAN = '{"instruction": "delete the cup", "ops": []}'
TALK = [Message("system", "Answer in JSON."), Message("user", "delete the cup")]


@pytest.fixture(scope="module", autouse=True)
def libraries() -> Iterator[None]:
    import_libraries("openai")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ssl, "create_default_context", functools.cache(ssl.create_default_context))
        patch.setattr(errors, "FIRST_PAUSE", 0.01)
        for name in ("SCENEWRIGHT_API_KEY", "OPENAI_API_KEY", "OPENAI_BASE_URL", "SCENEWRIGHT_WINDOW"):
            patch.delenv(name, raising=False)
        yield


def at(server: loopback.Server) -> ModelBackend:
    return backend.load(f"openai:small@{server.url}")


def ask(model: ModelBackend, heard: list[str] | None = None) -> Answer:
    return model.answer(TALK, schema("plan"), seconds=20, on_text=None if heard is None else heard.append)


def half() -> loopback.Turn:
    """A stream that breaks off in the middle of an event's answer."""
    whole = list(OpenAI.stream([PLAN[:12], PLAN[12:]]).chunks)
    return loopback.Turn(whole[:1], streamed=True, cut=True)


# Streams ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "broken",
    [
        half,
        lambda: loopback.Turn([b"data: {no json\n\n"], streamed=True),
        lambda: loopback.Turn([b"<html>hello</html>"], streamed=True),
        lambda: loopback.events([{"error": {"message": "CUDA out of memory"}}]),
    ],
    ids=["dies", "garbage", "page", "error event"],
)
def test_a_stream_that_breaks_costs_one_request_without(broken: Callable[[], loopback.Turn]) -> None:
    def answer(asked: loopback.Asked) -> loopback.Turn:
        return broken() if asked.body.get("stream") else OpenAI.answer(PLAN)

    heard: list[str] = []
    with loopback.serving(answer) as server:
        model = at(server)
        assert ask(model, heard).text == PLAN and "".join(heard).endswith(PLAN)
        assert [bool(a.body.get("stream")) for a in server.asked] == [True, False]
        ask(model, heard)
        assert not server.asked[-1].body.get("stream")  # remembered


def test_a_server_that_dies_both_ways_is_asked_twice_only() -> None:
    def answer(asked: loopback.Asked) -> loopback.Turn:
        if asked.body.get("stream"):
            return half()
        return loopback.Turn([b"{"], promised=100)

    with loopback.serving(answer) as server, pytest.raises(UnreachableError, match="broke off"):
        ask(at(server), [])
    assert len(server.asked) == 2


def test_a_stream_whose_end_is_missing_is_not_asked_for_again() -> None:
    def answer(asked: loopback.Asked) -> loopback.Turn:
        return OpenAI.stream(['{"ops": [']) if asked.body.get("stream") else OpenAI.answer(PLAN)

    with loopback.serving(answer) as server:
        model = at(server)
        assert ask(model, []).text == '{"ops": ['
        assert ask(model, []).text == PLAN


# Forms of answers ------------------------------------------------------------------------------------------------


def taken(asked: loopback.Asked) -> str:
    form = asked.body.get("response_format", {}).get("type")
    return form or ("tools" if "tools" in asked.body else "words")


def choosy(*takes: str) -> Callable[[loopback.Asked], loopback.Turn]:
    """A server that takes these forms only."""

    def answer(asked: loopback.Asked) -> loopback.Turn:
        form = taken(asked)
        if form not in takes:
            named = {"tools": '"auto" tool choice requires --enable-auto-tool-choice', "words": "?"}
            return OpenAI.error(400, named.get(form, f"response_format: {form} is unavailable"))
        return OpenAI.call(PLAN) if form == "tools" else OpenAI.answer(PLAN)

    return answer


@pytest.mark.parametrize(
    ("takes", "expected"),
    [
        (("json_schema",), ["json_schema"]),
        (("tools", "json_object", "words"), ["json_schema", "tools"]),
        (("json_object", "words"), ["json_schema", "tools", "json_object"]),
        (("words",), ["json_schema", "tools", "json_object", "words"]),
    ],
    ids=["schema", "functions", "json only", "words only"],
)
def test_the_tightest_form_that_a_server_takes_is_found_and_kept(takes: tuple[str, ...], expected: list[str]) -> None:
    with loopback.serving(choosy(*takes)) as server:
        model = at(server)
        assert json.loads(ask(model).text) == json.loads(PLAN)
        ask(model)
    assert [taken(a) for a in server.asked] == [*expected, expected[-1]]


def test_a_server_that_ignores_the_schema_gets_a_function_next() -> None:
    def answer(asked: loopback.Asked) -> loopback.Turn:
        return OpenAI.call(PLAN) if "tools" in asked.body else OpenAI.answer("Sure, I will delete the cup!")

    with loopback.serving(answer) as server:
        model = at(server)
        assert ask(model).text.startswith("Sure")
        assert json.loads(ask(model).text) == json.loads(PLAN)


def test_a_server_that_ignores_functions_too_is_read_all_the_same() -> None:
    with loopback.serving(OpenAI.error(400, "response_format"), OpenAI.answer(PLAN)) as server:
        assert json.loads(ask(at(server)).text) == json.loads(PLAN)


# The window ------------------------------------------------------------------------------------------------------

VLLM = {"/v1/models": {"object": "list", "data": [{"id": "small", "max_model_len": 16384}]}}
ROUTER = {"/v1/models": {"data": [{"id": "large", "context_length": 9000}, {"id": "small", "context_length": 65536}]}}
LLAMA_CPP: dict[str, Any] = {
    "/v1/models": {"data": [{"id": "/models/q.gguf", "meta": {"n_ctx_train": 131072}}]},
    "/props": {"default_generation_settings": {"n_ctx": 12288}, "total_slots": 1},
}
LM_STUDIO: dict[str, Any] = {
    "/v1/models": {"data": [{"id": "small"}, {"id": "other"}]},
    "/api/v0/models": {"data": [{"id": "small", "max_context_length": 131072, "loaded_context_length": 10240}]},
}
OLLAMA: dict[str, Any] = {
    "/v1/models": {"data": [{"id": "small:latest", "owned_by": "library"}]},
    "/api/ps": {"models": [{"name": "small:latest", "model": "small:latest", "context_length": 20480}]},
}


def window_of(pages: dict[str, Any], *script: Any) -> int:
    with loopback.serving(*(script or (OpenAI.answer(PLAN),))) as server:
        server.pages |= {path: loopback.plain(body) for path, body in pages.items()}
        return at(server).window


@pytest.mark.parametrize(
    ("pages", "window"),
    [(VLLM, 16384), (ROUTER, 65536), (LLAMA_CPP, 12288), (LM_STUDIO, 10240), (OLLAMA, 20480)],
    ids=["vllm", "router", "llama.cpp", "lm studio", "ollama"],
)
def test_a_server_that_tells_its_window_is_believed(pages: dict[str, Any], window: int) -> None:
    assert window_of(pages) == window


def test_ollama_tells_what_a_model_that_is_not_loaded_is_set_to() -> None:
    shown = {
        "parameters": 'num_ctx                        24576\nstop "<eos>"',
        "model_info": {"q.context_length": 99999},
    }
    assert window_of({"/api/ps": {"models": []}}, loopback.plain(shown)) == 24576


@pytest.mark.parametrize("told", [-1, 0, 1e400, "many", True, None, {"n": 1}, 10**12, 3.5])
def test_an_absurd_window_is_none(told: Any) -> None:
    body = json.dumps({"data": [{"id": "small", "max_model_len": told}]})
    assert window_of({"/v1/models": json.loads(body)}) == backend.NEAR_WINDOW


@pytest.mark.parametrize("page", ["[1]", "nothing", "{", '{"data": {"id": 3}}', '{"data": [[], null]}'])
def test_a_server_that_tells_garbage_has_the_usual_window(page: str) -> None:
    with loopback.serving(OpenAI.answer(PLAN)) as server:
        server.pages |= dict.fromkeys(("/v1/models", "/props", "/api/ps", "/api/v0/models"), loopback.plain(page))
        assert at(server).window == backend.NEAR_WINDOW


def test_a_server_that_is_not_there_has_the_usual_window() -> None:
    with loopback.serving(OpenAI.answer(PLAN)) as server:
        model = at(server)
    assert model.window == backend.NEAR_WINDOW


def test_a_window_that_is_told_is_asked_for_once() -> None:
    with loopback.serving(OpenAI.answer(PLAN)) as server:
        server.pages |= {path: loopback.plain(body) for path, body in VLLM.items()}
        model = at(server)
        assert [model.window, model.window] == [16384, 16384]
    assert server.looked_up == ["/v1/models"] and not server.asked


def test_a_window_that_is_set_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCENEWRIGHT_WINDOW", "32k")
    with loopback.serving(OpenAI.answer(PLAN)) as server:
        server.pages |= {path: loopback.plain(body) for path, body in VLLM.items()}
        assert models.load(f"openai:small@{server.url}").window == 32768
    assert not server.looked_up


def test_hosted_models_are_not_asked() -> None:
    address = backend.read("anthropic:small@http://127.0.0.1:9", {"ANTHROPIC_API_KEY": "k" * 20})
    assert context_window.told_by(address) is None


@pytest.mark.parametrize(("text", "tokens"), [("", None), ("8192", 8192), ("32k", 32768), ("131_072", 131072)])
def test_a_window_is_written_in_tokens(text: str, tokens: int | None) -> None:
    assert models.window(text) == tokens


@pytest.mark.parametrize("text", ["many", "-5", "12", "1e9", "9" * 40, "٣٢٧٦٨", "32kb"])
def test_what_is_no_window_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="--window"):
        models.window(text)
