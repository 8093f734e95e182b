"""Strangers at the server: no token, wrong Host or Origin, odd paths, odd messages. Refused, and nothing changes."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from scenewright.agent.session.session import Session
from scenewright.agent.view.messages import BadMessage, parse
from scenewright.benchmarks._view.client import Page, Server, asked, connected, served
from scenewright.benchmarks._view.faults import random_messages, strangers
from scenewright.gaussians.scene import Scene


@pytest.fixture
def server(boxes: Scene, encoder: Any) -> Iterator[Server]:
    with served(Session(boxes, encoder=encoder)) as made:
        yield made


def test_without_the_cookie_nothing_is_served(server: Server) -> None:
    for path in ("/", "/index.html", "/ws", "/?token=wrong", f"/?token={server.app.address.partition('=')[2]}"):
        assert asked(server.port, path)[0] == 403  # the token was spent by the fixture's own entry
    with pytest.raises(InvalidStatus), connected(server.port, "scenewright=wrong"):
        pass


def test_the_host_and_the_origin_are_those_of_the_address(server: Server) -> None:
    cookie = {"Cookie": server.cookie}
    assert asked(server.port, "/nothing", cookie)[0] == 404
    for host in ("localhost", "evil.example", f"127.0.0.1:{server.port + 1}", f"127.0.0.1:{server.port}.evil.example"):
        assert asked(server.port, "/nothing", {**cookie, "Host": host})[0] == 421
    for origin in ("http://evil.example", "null", f"http://localhost:{server.port}", "http://127.0.0.1"):
        with pytest.raises(InvalidStatus), connected(server.port, server.cookie, origin):
            pass


def test_paths_that_lead_elsewhere_are_no_files(server: Server) -> None:
    tricks = ("/../server.py", "/%2e%2e/server.py", "/..%2f..%2fsession.py", "//etc/passwd", "/page/../server.py",
              "/viewer/%2e%2e/%2e%2e/hub.py", "/\\..\\server.py", "/index.html%00.js", "/./", "/.hidden")  # fmt: skip
    for path in tricks:
        assert asked(server.port, path, {"Cookie": server.cookie})[0] == 404, path


def test_the_page_and_all_that_it_names_are_served(server: Server) -> None:
    status, headers, body = asked(server.port, "/", {"Cookie": server.cookie})
    assert status == 200 and headers["content-type"].startswith("text/html")
    named = re.findall(rb'(?:src|href)="([^"#:]+)"', body)
    assert named
    for name in named:
        path = "/" + name.decode().removeprefix("./").removeprefix("/")
        status, headers, _ = asked(server.port, path, {"Cookie": server.cookie})
        assert status == 200, name
        assert not name.endswith(b".js") or headers["content-type"].startswith("text/javascript")


def test_answers_allow_this_origin_only(server: Server) -> None:
    _, headers, _ = asked(server.port, "/nothing", {"Cookie": server.cookie})
    policy = headers["content-security-policy"]
    assert "default-src 'self'" in policy and "unsafe" not in policy and "frame-ancestors 'none'" in policy
    assert headers["x-content-type-options"] == "nosniff" and "server" not in headers


@pytest.mark.parametrize(
    "text",
    [
        "", "7", "[]", "null", "{}", '{"type": "resume", "revision": "1"}', '{"type": "resume", "more": 1}',
        '{"type": "say", "id": 1, "text": ""}', '{"type": "say", "id": true, "text": "x"}',
        '{"type": "say", "id": 1, "text": "\\u0000"}', '{"type": "select", "id": 1, "mode": "set"}',
        '{"type": "select", "id": 1, "mode": "part", "group": 1}', '{"type": "operate", "id": 1, "ops": []}',
        '{"type": "select_slots", "id": 1, "mode": "set", "ranges": [[5, 2], [6, 1]]}',
        '{"type": "select_slots", "id": 1, "mode": "set", "ranges": [[0, 0]]}',
        '{"type": "say", "id": 1, "text": "x", "camera": {"position": [NaN, 0, 0], "forward": [1, 0, 0],'
        ' "up": [0, 0, 1], "fov_y": 50, "width": 1, "height": 1}}',
        "[" * 100_000, '{"a":' * 50_000,
    ],
)  # fmt: skip
def test_a_message_that_no_page_sends_is_none(text: str) -> None:
    with pytest.raises(BadMessage):
        parse(text)


def test_an_odd_message_closes_its_socket_and_changes_nothing(server: Server) -> None:
    scene = server.hub.session.scene
    for message in ("{}", b"\x00\x01", json.dumps({"type": "resume", "revision": None, "x": 1})):
        with connected(server.port, server.cookie) as socket:
            socket.send(message)
            with pytest.raises(ConnectionClosed) as closed:
                socket.recv(timeout=10)
            assert closed.value.rcvd is not None and closed.value.rcvd.code == 1008
    assert server.hub.session.scene is scene


@pytest.mark.slow
def test_a_few_hundred_random_messages(server: Server) -> None:
    assert random_messages(server, 300, seed=1) == []


@pytest.mark.slow
def test_ten_thousand_random_messages_and_a_gigabyte(server: Server) -> None:
    assert random_messages(server, 10_000, seed=2) == []
    rows = {row["what"]: row for row in strangers(server, huge=1 << 30)}
    assert all(row["refused"] and not row["changed"] for row in rows.values()), rows
    with Page(server.port, server.cookie) as page:
        assert page.ask("say", text="make the green thing blue")["ok"]
