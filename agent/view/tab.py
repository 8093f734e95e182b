"""One tab: reads its messages, and sends it what it lacks, at its own pace.

A slow tab never makes a queue of changes: when it is ready, it gets the change from what it shows to what is shown.
"""

from __future__ import annotations

import asyncio
import json
from collections import deque
from contextlib import suppress
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from .hub import Hub
from .messages import Asked, BadMessage, Message, Resume, parse

ANSWERS = 1024  # that wait for a tab; of one that reads none of them, the oldest are dropped
_LONG = 65_536  # characters of a message from which it is parsed beside the event loop
_REFUSED = 1008  # policy violation, RFC 6455


class ServedTab:
    """A tab on a WebSocket."""

    def __init__(self, socket: WebSocket, hub: Hub) -> None:
        self._socket, self._hub = socket, hub
        self._loop = asyncio.get_running_loop()
        self._woken = asyncio.Event()
        self._resumed: Resume | None = None  # what was asked for and is not answered yet
        self._revision: int | None = None  # what the tab shows; None: nothing that is known
        self._state = ""  # the last `state` that it was sent
        self._progress: dict[str, Any] | None = None
        self._answers: deque[dict[str, Any] | bytes] = deque(maxlen=ANSWERS)

    # -- from any thread ---------------------------------------------------------------------------------------------

    def tell(self, message: dict[str, Any] | bytes) -> None:
        """Send a message after what is shown; of progress only the last."""
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._take, message)

    def wake(self) -> None:
        """Look at what is shown, and send what is missing."""
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._woken.set)

    # -- on the event loop -------------------------------------------------------------------------------------------

    async def run(self) -> None:
        """Serve the tab until it goes."""
        await self._socket.accept()
        writing = asyncio.create_task(self._write())
        try:
            await self._read()
        except WebSocketDisconnect:
            pass
        except BadMessage as error:
            await self._close(str(error))
        finally:
            self._hub.leave(self)
            writing.cancel()
            with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await writing

    async def _read(self) -> None:
        first = await self._next()
        if not isinstance(first, Resume):
            raise BadMessage("the first message is `resume`")
        self._resume(first)
        self._hub.join(self)
        while True:
            message = await self._next()
            if isinstance(message, Resume):
                self._resume(message)
            elif isinstance(message, Asked):
                self._hub.ask(self, message)

    async def _next(self) -> Message:
        event = await self._socket.receive()
        if event["type"] == "websocket.disconnect":
            raise WebSocketDisconnect(event.get("code", 1005))
        text = event.get("text")
        if text is None:
            raise BadMessage("a binary message")
        return parse(text) if len(text) < _LONG else await asyncio.to_thread(parse, text)

    def _resume(self, message: Resume) -> None:
        self._resumed = message
        self._woken.set()

    def _take(self, message: dict[str, Any] | bytes) -> None:
        if isinstance(message, dict) and message["type"] == "progress":
            self._progress = message
        else:
            self._answers.append(message)
        self._woken.set()

    async def _write(self) -> None:
        """Send what is missing, whenever something is: first the Gaussians, then the state, then answers."""
        try:
            while True:
                await self._woken.wait()
                self._woken.clear()
                while await self._sent_something():
                    pass
        except (WebSocketDisconnect, RuntimeError, OSError):
            return  # it went while something was sent

    async def _sent_something(self) -> bool:
        if self._resumed is not None:
            asked, self._resumed = self._resumed.revision, None
            self._revision = asked if asked is not None and self._hub.knows(asked) else None
            self._state = ""
            await self._text(self._hub.welcome())
        await self._send_progress()
        if self._revision != self._hub.shown.revision:
            await self._send_columns()
        elif self._state != self._hub.state:
            self._state = self._hub.state
            await self._socket.send_text(self._state)
        elif self._answers:
            answer = self._answers.popleft()
            await (self._socket.send_bytes(answer) if isinstance(answer, bytes) else self._text(answer))
        else:
            return False
        return True

    async def _send_columns(self) -> None:
        """Send the change from what the tab shows, or everything."""
        if self._revision is not None:
            change = await asyncio.to_thread(self._hub.change_from, self._revision)
            if change is not None:
                await self._socket.send_bytes(change[0])
                self._revision = change[1].revision
                return
        shown = self._hub.shown
        chunks = self._hub.load(shown)
        while (chunk := await asyncio.to_thread(next, chunks, None)) is not None:
            await self._socket.send_bytes(chunk)
            await self._send_progress()
            if self._resumed is not None:
                return  # it begins anew
        self._revision = shown.revision

    async def _send_progress(self) -> None:
        if self._progress is not None:
            told, self._progress = self._progress, None
            await self._text(told)

    async def _text(self, message: dict[str, Any]) -> None:
        await self._socket.send_text(json.dumps(message, ensure_ascii=False, allow_nan=False))

    async def _close(self, reason: str) -> None:
        if self._socket.application_state is WebSocketState.CONNECTED:
            with suppress(RuntimeError):
                await self._socket.close(_REFUSED, reason)
