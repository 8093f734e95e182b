"""Servers on this machine that speak the wire formats of OpenAI, Anthropic and Google, and answer by a script.

A script is a list of turns, one a
request, the last of them repeated; a turn is a `Turn`, or a function from the request to one.
"""

from __future__ import annotations

import base64
import io
import json
import ssl
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar

import numpy as np
from PIL import Image


def png(width: int, height: int, seed: int = 0) -> bytes:
    """A picture of noise, so that no two seeds give the same bytes."""
    out = io.BytesIO()
    noise = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    Image.fromarray(noise).save(out, "PNG")
    return out.getvalue()


@dataclass(frozen=True)
class Asked:
    """A request as it arrived."""

    path: str
    headers: dict[str, str]
    body: dict[str, Any]


@dataclass(frozen=True)
class Turn:
    """What to send back.

    Attributes:
        chunks: of the body, sent one by one.
        status, headers: as they stand; a Content-Length is added unless the body is streamed.
        pause: seconds before each chunk.
        promised: bytes that the Content-Length claims beyond those sent.
        cut: whether the connection breaks off instead of ending as a stream must.
    """

    chunks: Iterable[bytes]
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    pause: float = 0.0
    promised: int = 0
    streamed: bool = False
    cut: bool = False


Step = Turn | Callable[[Asked], Turn]


class Server:
    """A scripted server; `asked` holds the requests it got.

    Attributes:
        pages: answers to GET requests by their path; every other path is not found.
        looked_up: the paths of GET requests.
    """

    def __init__(self, script: Sequence[Step], tls: ssl.SSLContext | None = None) -> None:
        self.asked: list[Asked] = []
        self.pages: dict[str, Turn] = {}
        self.looked_up: list[str] = []
        self._script = list(script)
        self._lock = threading.Lock()
        self._http = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._http.daemon_threads = True
        if tls is not None:
            self._http.socket = tls.wrap_socket(self._http.socket, server_side=True)
        self.url = f"http{'s' if tls else ''}://127.0.0.1:{self._http.server_address[1]}"
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._http.shutdown()
        self._http.server_close()

    def _next(self, asked: Asked) -> Turn:
        with self._lock:
            step = self._script[min(len(self.asked), len(self._script) - 1)]
            self.asked.append(asked)
        return step if isinstance(step, Turn) else step(asked)

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                turn = server.pages.get(self.path, plain({"error": "not found"}, 404))
                server.looked_up.append(self.path)
                self.close_connection = True
                self._send(turn)

            def do_POST(self) -> None:
                data = self.rfile.read(int(self.headers.get("content-length", 0)))
                headers = {name.lower(): value for name, value in self.headers.items()}
                turn = server._next(Asked(self.path, headers, json.loads(data or b"{}")))
                self.close_connection = True
                try:
                    self._send(turn)
                except OSError:
                    return  # the client has had enough

            def _send(self, turn: Turn) -> None:
                chunks = turn.chunks if turn.streamed else list(turn.chunks)
                self.send_response(turn.status)
                kind = "text/event-stream" if turn.streamed else "application/json"
                # It closes after every turn: unsaid, a client's next request may meet the closing connection.
                headers = {"Content-Type": kind, "Connection": "close", **turn.headers}
                if turn.streamed:
                    headers["Transfer-Encoding"] = "chunked"
                else:
                    headers["Content-Length"] = str(sum(map(len, chunks)) + turn.promised)
                for name, value in headers.items():
                    self.send_header(name, value)
                self.end_headers()
                for chunk in chunks:
                    time.sleep(turn.pause)
                    self.wfile.write(b"%x\r\n%s\r\n" % (len(chunk), chunk) if turn.streamed else chunk)
                    self.wfile.flush()
                if turn.streamed and not turn.cut:
                    self.wfile.write(b"0\r\n\r\n")

            def log_message(self, format: str, *args: object) -> None:
                return

        return Handler


@contextmanager
def serving(*script: Step, tls: ssl.SSLContext | None = None) -> Iterator[Server]:
    """A server for as long as the block runs."""
    server = Server(script, tls)
    try:
        yield server
    finally:
        server.close()


def plain(body: object, status: int = 200, **headers: str) -> Turn:
    """A JSON body; a string goes as it stands."""
    data = body if isinstance(body, str) else json.dumps(body)
    return Turn([data.encode()], status, {name.replace("_", "-"): value for name, value in headers.items()})


def events(bodies: Iterable[object], *, names: bool = False, done: bool = False, **how: Any) -> Turn:
    """Server-sent events; `names` adds the type of each as its event name, `done` OpenAI's last line."""

    def lines() -> Iterator[bytes]:
        for body in bodies:
            name = f"event: {body['type']}\n" if names and isinstance(body, dict) else ""
            yield f"{name}data: {json.dumps(body)}\n\n".encode()
        if done:
            yield b"data: [DONE]\n\n"

    return Turn(lines(), streamed=True, **how)


class OpenAI:
    """Chat completions: https://platform.openai.com/docs/api-reference/chat."""

    kind = "openai"
    usage: ClassVar[Any] = {"prompt_tokens": 11, "completion_tokens": 7, "total_tokens": 18}

    @classmethod
    def answer(cls, text: str, finish: str = "stop", refusal: str | None = None, usage: Any = None) -> Turn:
        message = {"role": "assistant", "content": None if refusal else text, "refusal": refusal}
        choice = {"index": 0, "message": message, "finish_reason": finish}
        head = {"id": "chatcmpl-1", "object": "chat.completion", "created": 1, "model": "small"}
        return plain({**head, "choices": [choice], "usage": usage or cls.usage})

    @classmethod
    def stream(cls, pieces: Iterable[str], finish: str = "stop", **how: Any) -> Turn:
        head = {"id": "chatcmpl-1", "object": "chat.completion.chunk", "created": 1, "model": "small"}

        def bodies() -> Iterator[object]:
            for piece in pieces:
                yield {**head, "choices": [{"index": 0, "delta": {"content": piece}, "finish_reason": None}]}
            yield {**head, "choices": [{"index": 0, "delta": {}, "finish_reason": finish}]}
            yield {**head, "choices": [], "usage": cls.usage}

        return events(bodies(), done=True, **how)

    @classmethod
    def call(cls, text: str) -> Turn:
        """The answer as the arguments of a function."""
        call = {"id": "call_1", "type": "function", "function": {"name": "answer", "arguments": text}}
        message = {"role": "assistant", "content": None, "tool_calls": [call]}
        head = {"id": "chatcmpl-1", "object": "chat.completion", "created": 1, "model": "small"}
        choice = {"index": 0, "message": message, "finish_reason": "tool_calls"}
        return plain({**head, "choices": [choice], "usage": cls.usage})

    @staticmethod
    def error(status: int, message: str, code: str | None = None, **headers: str) -> Turn:
        return plain({"error": {"message": message, "type": "invalid_request_error", "code": code}}, status, **headers)

    @staticmethod
    def schema(body: dict[str, Any]) -> Any:
        return body.get("response_format", {}).get("json_schema", {}).get("schema")

    @staticmethod
    def pictures(body: dict[str, Any]) -> list[bytes]:
        """The pictures of the last message."""
        urls = [p["image_url"]["url"] for p in body["messages"][-1]["content"] if p["type"] == "image_url"]
        assert all(url.startswith("data:image/") for url in urls)
        return [base64.b64decode(url.partition(";base64,")[2]) for url in urls]


class Anthropic:
    """Messages: https://docs.anthropic.com/en/api/messages. Answers are arguments of the tool, if there is one."""

    kind = "anthropic"

    @staticmethod
    def answer(text: str, finish: str = "", refusal: str | None = None, usage: Any = None, tool: bool = True) -> Turn:
        try:
            arguments = json.loads(text) if tool and not refusal else None
        except ValueError:
            arguments = None
        block = {"type": "text", "text": refusal or text}
        if isinstance(arguments, dict):
            block = {"type": "tool_use", "id": "toolu_1", "name": "answer", "input": arguments}
        reason = finish or ("refusal" if refusal else "tool_use" if arguments else "end_turn")
        head = {"id": "msg_1", "type": "message", "role": "assistant", "model": "small", "stop_sequence": None}
        usage = usage or {"input_tokens": 11, "output_tokens": 7}
        return plain({**head, "content": [block], "stop_reason": reason, "usage": usage})

    @staticmethod
    def stream(pieces: Iterable[str], finish: str = "tool_use", **how: Any) -> Turn:
        def bodies() -> Iterator[object]:
            head = {"id": "msg_1", "type": "message", "role": "assistant", "model": "small", "content": []}
            usage = {"input_tokens": 11, "output_tokens": 1}
            start = {**head, "stop_reason": None, "stop_sequence": None, "usage": usage}
            block = {"type": "tool_use", "id": "toolu_1", "name": "answer", "input": {}}
            yield {"type": "message_start", "message": start}
            yield {"type": "content_block_start", "index": 0, "content_block": block}
            for piece in pieces:
                delta = {"type": "input_json_delta", "partial_json": piece}
                yield {"type": "content_block_delta", "index": 0, "delta": delta}
            yield {"type": "content_block_stop", "index": 0}
            delta = {"stop_reason": finish, "stop_sequence": None}
            yield {"type": "message_delta", "delta": delta, "usage": {"output_tokens": 7}}
            yield {"type": "message_stop"}

        return events(bodies(), names=True, **how)

    @staticmethod
    def error(status: int, message: str, code: str | None = None, **headers: str) -> Turn:
        kinds = {401: "authentication_error", 404: "not_found_error", 429: "rate_limit_error", 529: "overloaded_error"}
        error = {"type": kinds.get(status, "invalid_request_error"), "message": message}
        return plain({"type": "error", "error": error}, status, **headers)

    @staticmethod
    def schema(body: dict[str, Any]) -> Any:
        return next((tool["input_schema"] for tool in body.get("tools", ())), None)

    @staticmethod
    def pictures(body: dict[str, Any]) -> list[bytes]:
        """The pictures of the last message."""
        sources = [p["source"] for p in body["messages"][-1]["content"] if p["type"] == "image"]
        assert all(source["type"] == "base64" for source in sources)
        return [base64.b64decode(source["data"]) for source in sources]


class Google:
    """generateContent: https://ai.google.dev/api/generate-content."""

    kind = "google"
    usage: ClassVar[Any] = {"promptTokenCount": 11, "candidatesTokenCount": 7, "totalTokenCount": 18}

    @classmethod
    def answer(cls, text: str, finish: str = "STOP", refusal: str | None = None, usage: Any = None) -> Turn:
        head = {"usageMetadata": usage or cls.usage, "modelVersion": "small"}
        if refusal:
            return plain({**head, "promptFeedback": {"blockReason": "SAFETY", "blockReasonMessage": refusal}})
        return plain({**head, "candidates": [cls._candidate(text, finish)]})

    @staticmethod
    def _candidate(text: str, finish: str | None) -> dict[str, Any]:
        candidate = {"content": {"role": "model", "parts": [{"text": text}]}, "index": 0}
        return candidate if finish is None else {**candidate, "finishReason": finish}

    @classmethod
    def stream(cls, pieces: Iterable[str], finish: str = "STOP", **how: Any) -> Turn:
        def bodies() -> Iterator[object]:
            for piece in pieces:
                yield {"candidates": [cls._candidate(piece, None)], "modelVersion": "small"}
            last = cls._candidate("", finish)
            yield {"candidates": [last], "usageMetadata": cls.usage, "modelVersion": "small"}

        return events(bodies(), **how)

    @staticmethod
    def error(status: int, message: str, code: str | None = None, **headers: str) -> Turn:
        kinds = {400: "INVALID_ARGUMENT", 401: "UNAUTHENTICATED", 404: "NOT_FOUND", 429: "RESOURCE_EXHAUSTED"}
        error = {"code": status, "message": message, "status": kinds.get(status, "INTERNAL")}
        return plain({"error": error}, status, **headers)

    @staticmethod
    def schema(body: dict[str, Any]) -> Any:
        return body.get("generationConfig", {}).get("responseJsonSchema")

    @staticmethod
    def pictures(body: dict[str, Any]) -> list[bytes]:
        """The pictures of the last message, whichever of base64's alphabets its client writes."""
        parts = body["contents"][-1]["parts"]
        return [base64.urlsafe_b64decode(_urlsafe(p["inlineData"]["data"])) for p in parts if "inlineData" in p]


def _urlsafe(data: str) -> str:
    return data.replace("+", "-").replace("/", "_")
