"""The MCP server and a client in memory: edits, undo, ambiguities, pictures, hints, hostile and concurrent calls."""

from __future__ import annotations

import asyncio
import base64
import io
import json
from collections.abc import Awaitable, Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from amounts import spread

pytest.importorskip("mcp", reason="needs the extra `mcp`")

from mcp import Client
from mcp.types import CallToolResult, ElicitResult, ImageContent, TextContent
from PIL import Image

from scenewright.agent.mcp.server import SceneServer
from scenewright.agent.mcp.serving import local_only
from scenewright.agent.session.session import Session
from scenewright.agent.toolbox.progress import Progress
from scenewright.agent.toolbox.toolbox import Toolbox
from scenewright.benchmarks._hostile_calls import hostile_calls
from scenewright.gaussians.scene import Scene

MODES = ("auto", "legacy")  # the revision of 2026, in which a call is answered by a question, and those before
RED = {"colors": ["red"], "pick": "all"}


@pytest.fixture
def toolbox(named_boxes: Scene, tmp_path: Path) -> Toolbox:
    progress = Progress()
    (tmp_path / "scenes").mkdir()
    session = Session(named_boxes, viewer=named_boxes.cameras[0], progress=progress)
    return Toolbox(session, tmp_path / "scenes", progress=progress)


def talk(toolbox: Toolbox, work: Callable[[Client], Awaitable[Any]], **options: Any) -> Any:
    """The result of `work` with a client that is connected to a server of the toolbox."""

    async def run() -> Any:
        async with Client(SceneServer(toolbox), **options) as client:
            return await work(client)

    return asyncio.run(run())


def texts(result: CallToolResult) -> list[str]:
    return [block.text for block in result.content if isinstance(block, TextContent)]


def pictures(result: CallToolResult) -> list[Image.Image]:
    images = [block for block in result.content if isinstance(block, ImageContent)]
    assert all(block.mime_type == "image/png" for block in images)
    return [Image.open(io.BytesIO(base64.b64decode(block.data))) for block in images]


@pytest.mark.parametrize("mode", MODES)
def test_five_edits_a_picture_and_undo_to_the_same_digest(toolbox: Toolbox, mode: str) -> None:
    async def work(client: Client) -> None:
        first = (await client.call_tool("render", {"width": 96})).structured_content["scene"]
        edits: list[tuple[str, dict[str, Any]]] = [
            ("do", {"instruction": "make the green thing blue"}),
            ("scale", {"target": RED, "factor": 0.5}),
            ("do", {"instruction": "delete the blue thing"}),
            ("opacity", {"target": RED, "value": 0.5}),
            ("recolor", {"target": RED, "color": "green", "picture": True}),
        ]
        for name, arguments in edits:
            result = await client.call_tool(name, arguments)
            assert not result.is_error, texts(result)
            data = result.structured_content
            assert json.loads(texts(result)[1]) == data and data["receipts"][0]["checks"]
        (picture,) = pictures(result)
        assert len(picture.convert("RGB").getcolors(1_000_000) or []) > 50
        assert data["scene"]["digest"] != first["digest"] and data["scene"]["undo"] == 5
        undone = await client.call_tool("undo", {"steps": 5})
        assert undone.structured_content["scene"] == first

    talk(toolbox, work, mode=mode)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("tool", ["do", "delete"])
def test_an_ambiguity_is_asked_where_the_client_can(toolbox: Toolbox, mode: str, tool: str) -> None:
    forms: list[Any] = []

    async def fill(context: Any, params: Any) -> ElicitResult:
        forms.append(params)
        return ElicitResult(action="accept", content={"choice": "the left one"})

    arguments = {"instruction": "delete the red thing"} if tool == "do" else {"target": {"colors": ["red"]}}

    async def work(client: Client) -> CallToolResult:
        return await client.call_tool(tool, arguments)

    result = talk(toolbox, work, mode=mode, elicitation_callback=fill)
    assert not result.is_error and result.structured_content["receipts"][0]["selection"]["groups"] == [0]
    assert len(forms) == 1 and "1. red" in forms[0].message and "2. red" in forms[0].message
    assert "`answer`" not in forms[0].message  # the form is for a person
    assert forms[0].requested_schema["properties"]["choice"]["type"] == "string"


@pytest.mark.parametrize("mode", spread(MODES, 2))
@pytest.mark.parametrize(
    "answer",
    [
        ElicitResult(action="decline"), ElicitResult(action="cancel"),
        ElicitResult(action="accept", content={"choice": "the purple piano"}),
        ElicitResult(action="accept", content={"other": "1"}), ElicitResult(action="accept", content={"choice": ["1"]}),
    ],
    ids=["declined", "cancelled", "no candidate", "no field", "a list"],
)  # fmt: skip
def test_a_question_that_is_not_answered_changes_nothing_and_can_be_answered_later(
    toolbox: Toolbox, mode: str, answer: ElicitResult
) -> None:
    async def fill(context: Any, params: Any) -> ElicitResult:
        return answer

    async def work(client: Client) -> None:
        before = toolbox.state()
        result = await client.call_tool("do", {"instruction": "delete the red thing"})
        assert result.is_error and result.structured_content["scene"] == before
        later = await client.call_tool("answer", {"answer": "2"})
        assert later.structured_content["receipts"][0]["selection"]["groups"] == [2]

    talk(toolbox, work, mode=mode, elicitation_callback=fill)


@pytest.mark.parametrize("mode", MODES)
def test_an_ambiguity_is_told_where_the_client_cannot_ask(toolbox: Toolbox, mode: str) -> None:
    async def work(client: Client) -> None:
        told = await client.call_tool("do", {"instruction": "make the red thing blue"})
        assert told.is_error and told.structured_content["verdict"] == "ambiguous" and len(pictures(told)) == 1
        assert "answer" in told.structured_content["how_to_answer"]
        done = await client.call_tool("answer", {"answer": "1", "question": told.structured_content["question"]})
        assert done.structured_content["groups"] == [0]

    talk(toolbox, work, mode=mode)


def test_tools_are_listed_with_schemas_and_hints(toolbox: Toolbox) -> None:
    async def work(client: Client) -> Any:
        return (await client.list_tools()).tools

    listed = {tool.name: tool for tool in talk(toolbox, work)}
    assert set(listed) == set(toolbox.tools)
    reading = {name for name, tool in listed.items() if tool.annotations.read_only_hint}
    assert {"render", "find_view", "ask", "describe", "graph", "check", "select"} <= reading
    assert not reading & {"do", "answer", "undo", "redo", "save", "move", "insert", "delete"}
    assert {n for n in ("delete", "isolate", "replace", "do", "save") if listed[n].annotations.destructive_hint} == {
        "delete", "isolate", "replace", "do", "save"
    }  # fmt: skip
    assert not listed["move"].annotations.destructive_hint
    assert all(tool.input_schema["type"] == "object" and tool.description for tool in listed.values())


@pytest.mark.parametrize("mode", MODES)
def test_progress_is_reported_and_rises(toolbox: Toolbox, mode: str) -> None:
    heard: list[float] = []

    async def hear(value: float, total: float | None, message: str | None) -> None:
        heard.append(value)

    async def work(client: Client) -> None:
        await client.call_tool("render", {"width": 64}, progress_callback=hear)

    talk(toolbox, work, mode=mode)
    assert len(heard) >= 2 and all(a < b for a, b in pairwise(heard))


def test_concurrent_calls_are_serialised(toolbox: Toolbox) -> None:
    colors = ["blue", "yellow", "purple", "orange", "pink", "white", "black", "brown"]

    async def work(client: Client) -> list[CallToolResult]:
        calls = (client.call_tool("recolor", {"target": {"groups": [1]}, "color": c}) for c in colors)
        return list(await asyncio.gather(*calls))

    told = talk(toolbox, work, mode="legacy")
    assert sorted(r.structured_content["scene"]["undo"] for r in told) == list(range(1, 9))
    assert len({r.structured_content["scene"]["digest"] for r in told}) == 8


@pytest.mark.parametrize("mode", MODES)
def test_hostile_calls_change_nothing_and_touch_no_file(toolbox: Toolbox, mode: str, tmp_path: Path) -> None:
    (tmp_path / "outside").mkdir()
    (tmp_path / "scenes" / "link").symlink_to(tmp_path / "outside")
    calls = hostile_calls(toolbox, group=1)
    assert len(calls) >= 200
    before, files = toolbox.state(), sorted(tmp_path.rglob("*"))

    async def work(client: Client) -> None:
        for name, arguments in calls:
            try:
                result = await client.call_tool(name, arguments, read_timeout_seconds=20)
            except Exception as error:  # refused by the protocol itself, before a tool is called
                assert "timed out" not in str(error).lower(), (name, str(arguments)[:200])
                continue
            assert toolbox.state()["digest"] == before["digest"], (name, str(arguments)[:200])
            assert (result.structured_content or {}).get("verdict") != "internal", (name, str(arguments)[:200])
            assert sum(len(t) for t in texts(result)) < 50_000
        still = await client.call_tool("do", {"instruction": "make the green thing blue"})
        assert not still.is_error  # the server lives

    talk(toolbox, work, mode=mode)
    toolbox.call("undo")
    assert toolbox.state() == before and sorted(tmp_path.rglob("*")) == files


def test_only_requests_for_this_machine_are_served(toolbox: Toolbox) -> None:
    """A web page whose name was bound to 127.0.0.1 sends its own name as Host, any other page its Origin."""
    from starlette.testclient import TestClient

    app = SceneServer(toolbox).streamable_http_app(transport_security=local_only(8123))
    message = {"jsonrpc": "2.0", "id": 1, "method": "tools/list", "params": {}}
    accept = {"accept": "application/json, text/event-stream", "content-type": "application/json"}
    with TestClient(app, base_url="http://127.0.0.1:8123") as http:
        for headers, refused in (
            ({"host": "evil.example"}, True), ({"host": "evil.example:8123"}, True), ({"host": "127.0.0.1:80"}, True),
            ({"origin": "http://evil.example"}, True), ({"origin": "null"}, True), ({}, False),
            ({"host": "localhost:8123", "origin": "http://localhost:8123"}, False),
        ):  # fmt: skip
            answer = http.post("/mcp", json=message, headers={**accept, **headers})
            assert (answer.status_code in (403, 421)) == refused, (headers, answer.status_code, answer.text)
