"""A served session and a page without a browser, for tests and benchmarks."""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from types import TracebackType
from typing import Any, Self

import numpy as np
import uvicorn
from numpy.typing import NDArray
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from ...agent.session.session import Session
from ...agent.toolbox.folder import Folder
from ...agent.view import wire
from ...agent.view.columns import columns_of, width
from ...agent.view.hub import Hub
from ...agent.view.server import HOST, App
from ...agent.view.serving import listen, server
from ...agent.view.slots import slots_of
from ...gaussians.errors import BackendError

_PATIENCE = 60.0  # seconds for an answer


class Server:
    """A session that is served from a thread of this process.

    Attributes:
        port: on which it is.
        cookie: what a page that has shown the token sends.
    """

    def __init__(self, hub: Hub) -> None:
        self.hub = hub
        self._listening = listen(0)
        self.port = self._listening.getsockname()[1]
        self.app = App(hub, self.port)
        self._server: uvicorn.Server = server(self.app)
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [self._listening]}, daemon=True)
        self._thread.start()
        while not self._server.started:
            time.sleep(0.01)
        self.cookie = entered(self.app.address)

    def stop(self) -> None:
        """End the server and its session."""
        self._server.should_exit = True
        self._thread.join(10)
        self._listening.close()
        self.hub.stop()


@contextmanager
def served(session: Session, folder: Folder | None = None) -> Iterator[Server]:
    """A session that is served until the context ends; its scenes are saved in a folder, or nowhere."""
    made = Server(Hub(session, "test.ply", folder))
    try:
        yield made
    finally:
        made.stop()


def asked(port: int, path: str, headers: dict[str, str] | None = None) -> tuple[int, dict[str, str], bytes]:
    """The status, headers (small letters) and body of GET on a path, which is sent as it is."""
    connection = http.client.HTTPConnection(HOST, port, timeout=_PATIENCE)
    try:
        connection.request("GET", path, headers=headers or {})
        answer = connection.getresponse()
        return answer.status, {k.lower(): v for k, v in answer.getheaders()}, answer.read()
    finally:
        connection.close()


def entered(address: str) -> str:
    """The cookie that an address with its token gives. Raises ValueError if it gives none."""
    host, _, path = address.removeprefix("http://").partition("/")
    status, headers, _ = asked(int(host.rpartition(":")[2]), f"/{path}")
    if status != 200 or "set-cookie" not in headers:
        raise ValueError(f"the address was refused: {status}")
    return headers["set-cookie"].split(";")[0]


class Page:
    """What a tab shows.

    Attributes:
        revision: of what it shows; None: nothing yet.
        columns: by name, `[S, bytes]` uint8: the rows of all slots.
        state, welcome: the last messages of these types.
        received: bytes of binary messages, and of those since the last call of `ask`.
    """

    def __init__(self, port: int, cookie: str) -> None:
        self._port, self._cookie = port, cookie
        self.revision: int | None = None
        self.columns: dict[str, NDArray[np.uint8]] = {}
        self.state: dict[str, Any] = {}
        self.welcome: dict[str, Any] = {}
        self.received = 0
        self.headers: list[dict[str, Any]] = []
        self._number = 0
        self._open = ExitStack()
        self.socket: ClientConnection
        self.connect()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        self._open.close()

    def connect(self) -> None:
        """Open a socket and resume from what is shown, until the state is there."""
        self.socket = self._open.enter_context(connected(self._port, self._cookie))
        self.send({"type": "resume", "revision": self.revision})
        self.state = {}
        while not self.state:
            self.take()

    def cut(self) -> None:
        """Lose the connection without a word."""
        self.socket.socket.close()
        self._open.close()

    def send(self, message: dict[str, Any]) -> None:
        self.socket.send(json.dumps(message))

    def ask(self, type: str, **fields: Any) -> dict[str, Any]:
        """The answer to a message."""
        self._number += 1
        self.received, self.headers = 0, []
        self.send({"type": type, "id": self._number, **fields})
        while True:
            answer = self.take()
            if answer.get("id") == self._number and answer["type"] in ("said", "error"):
                return answer

    def take(self) -> dict[str, Any]:
        """The next message; of a binary one its header.

        Raises:
            BackendError: none comes.
        """
        try:
            data = self.socket.recv(timeout=_PATIENCE)
        except TimeoutError as error:
            raise BackendError(
                f"the server of the page sent nothing for {_PATIENCE:.0f} s; measure again while the machine is idle"
            ) from error
        if isinstance(data, bytes):
            self.received += len(data)
            return self._write(data)
        message: dict[str, Any] = json.loads(data)
        if message["type"] in ("state", "welcome"):
            setattr(self, message["type"], message)
        return message

    def _write(self, data: bytes) -> dict[str, Any]:
        header, parts = wire.read(data)
        self.headers.append(dict(header))
        if header["type"] != "columns":
            return dict(header)
        if header["base"] is None and header["chunk"][0] == 0:
            self.columns = {
                c: np.zeros((0, width(c, header["degree"])), np.uint8) for c in columns_of(header["degree"])
            }
        for name, rows in self.columns.items():
            more = np.zeros((header["slots"] - len(rows), rows.shape[1]), np.uint8)
            self.columns[name] = np.concatenate([rows, more]) if len(more) else rows
        for part in parts.values():
            rows = self.columns[part.column]
            rows[slots_of(part.ranges)] = np.frombuffer(part.data, np.uint8).reshape(-1, rows.shape[1])
        if header["base"] is not None or header["chunk"][0] + 1 == header["chunk"][1]:
            self.revision = header["revision"]
        return dict(header)


def connected(port: int, cookie: str, origin: str | None = None) -> AbstractContextManager[ClientConnection]:
    """A WebSocket of a page, which the context closes."""
    return connect(
        f"ws://{HOST}:{port}/ws", origin=Origin(origin or f"http://{HOST}:{port}"),
        additional_headers={"Cookie": cookie}, max_size=None, compression=None, close_timeout=2, proxy=None,
    )  # fmt: skip


def same(page: Page, hub: Hub) -> bool:
    """Whether a page shows every Gaussian of what the hub shows, bit for bit, and nothing else."""
    shown = hub.shown
    full = shown.slots.rows >= 0
    for chunk in wire.load(shown):
        _, parts = wire.read(chunk)
        for part in parts.values():
            (first, count), held = part.ranges[0], page.columns[part.column]
            if first + count > len(held):
                return False
            there = full[first : first + count]
            if part.column in ("color", "group"):
                there = np.ones_like(there)  # these say that a slot is empty
            rows = np.frombuffer(part.data, np.uint8).reshape(count, -1)
            mine = held[first : first + count]
            if part.column == "color":  # of an empty slot only the opacity counts
                empty = ~full[first : first + count]
                if (mine[empty, 6:] != 0).any():
                    return False
                there = ~empty
            if (rows[there] != mine[there]).any():
                return False
    return True
