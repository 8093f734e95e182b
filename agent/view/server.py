"""The server of the page: static files and one WebSocket a tab, for this machine and this user only.

Who may speak stands in docs/view-protocol.md: the address with its token once, then a cookie; the right Host, and for
the WebSocket the right Origin. Files are a fixed table of names.
"""

from __future__ import annotations

import asyncio
import hmac
import mimetypes
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from concurrent.futures import Future
from http.cookies import CookieError, SimpleCookie
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, quote

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse, Response
from starlette.websockets import WebSocket

from .hub import MADE, Hub
from .tab import ServedTab

HOST = "127.0.0.1"
PAGE = Path(__file__).parent / "page"
TABS = 32  # that are served at once
_BYTES = 4096  # of an address or a cookie that is looked at

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


def files(folder: Path = PAGE) -> dict[str, Path]:
    """The files that are served, by their path in an address; "/" is index.html."""
    found = {f"/{p.relative_to(folder).as_posix()}": p for p in sorted(folder.rglob("*")) if p.is_file()}
    if "/index.html" in found:
        found["/"] = found.pop("/index.html")
    return {path: file for path, file in found.items() if not file.name.startswith(".")}


class App:
    """The application (ASGI) of one session.

    Args:
        hub: the session.
        port: on which it is served.
        table: the files, as `files` gives them.

    Attributes:
        address: to open in a browser; its token counts once.
    """

    def __init__(self, hub: Hub, port: int, table: dict[str, Path] | None = None) -> None:
        self._hub = hub
        self._host = f"{HOST}:{port}"
        self._origin = f"http://{self._host}"
        self._token: str | None = secrets.token_urlsafe(24)
        self._cookie_name = f"scenewright-{port}"  # cookies are shared by all ports of a host
        self._cookie = secrets.token_urlsafe(32)
        self._table = files() if table is None else table
        self._tabs = 0
        self.address = f"{self._origin}/?token={self._token}"
        self._always = {
            "content-security-policy": "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; "
            f"connect-src 'self' ws://{self._host}; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'",
            "x-content-type-options": "nosniff", "referrer-policy": "no-referrer", "cache-control": "no-store",
            "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp",
            "cross-origin-resource-policy": "same-origin",
        }  # fmt: skip

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            answer = await self._answer(scope)
            await answer(scope, receive, send)
        elif scope["type"] == "websocket":
            await self._serve(scope, receive, send)
        else:
            await self._lifespan(receive, send)

    async def _lifespan(self, receive: Receive, send: Send) -> None:
        while True:
            event = await receive()
            if event["type"] == "lifespan.startup":
                self._hub.start()
            await send({"type": f"{event['type']}.complete"})
            if event["type"] == "lifespan.shutdown":
                return

    # -- who may speak -----------------------------------------------------------------------------------------------

    def _for_us(self, scope: Scope) -> bool:
        """Whether the Host header is this address, given once."""
        return Headers(scope=scope).getlist("host") == [self._host]

    def _known(self, scope: Scope) -> bool:
        """Whether the cookie is there."""
        given = Headers(scope=scope).get("cookie", "")
        if len(given) > _BYTES:
            return False
        try:
            morsel = SimpleCookie(given).get(self._cookie_name)
        except CookieError:
            return False
        return morsel is not None and _same(morsel.value, self._cookie)

    # -- files -------------------------------------------------------------------------------------------------------

    async def _answer(self, scope: Scope) -> Response:
        if not self._for_us(scope):
            return self._refusal(421, f"this server answers at {self._origin} only")
        if scope["method"] not in ("GET", "HEAD"):
            return self._refusal(405, "this server is read with GET")
        query = scope["query_string"]
        if scope["path"] == "/" and query:
            return self._entered(query)
        if not self._known(scope):
            return self._refusal(403, "open the address that `scenewright view` printed; its token counts once")
        if scope["path"] == MADE and self._hub.made is not None:
            name, page = self._hub.made
            there = {"content-disposition": f"attachment; filename*=UTF-8''{quote(name, safe='')}"}
            return Response(page, headers={**self._always, **there}, media_type="text/html")
        if (picture := self._hub.gallery.at(scope["path"])) is not None:
            return await self._picture(picture)
        file = self._table.get(scope["path"])
        if file is None:
            return self._refusal(404, "there is no such file")
        kind = mimetypes.guess_type(file.name)[0] or "application/octet-stream"
        kind = "text/javascript" if file.suffix in (".js", ".mjs") else kind
        return Response(file.read_bytes(), headers=self._always, media_type=kind)

    async def _picture(self, picture: Future[bytes]) -> Response:
        """A picture of an answer, as soon as it is drawn."""
        try:
            drawn = await asyncio.shield(asyncio.wrap_future(picture))
        except Exception:  # why stands in the server's own log
            return self._refusal(404, "this picture could not be drawn")
        return Response(drawn, headers=self._always, media_type="image/png")

    def _entered(self, query: bytes) -> Response:
        """The answer to the address with the token: the cookie, and on to the page.

        A page that goes on by itself, as a redirect would not carry a strict cookie where another site has the link.
        """
        given = parse_qs(query[:_BYTES].decode("latin-1")).get("token", [""])[0]
        if self._token is None or not _same(given, self._token):
            return self._refusal(403, "this token was used, or is none; `scenewright view` prints a new one")
        self._token = None
        cookie = f"{self._cookie_name}={self._cookie}; HttpOnly; SameSite=Strict; Path=/"
        headers = {**self._always, "set-cookie": cookie, "refresh": "0; url=/"}
        return Response(
            '<!doctype html><title>Scenewright</title><link rel="icon" href="data:,"><a href="/">Open</a>',
            200,
            headers,
            "text/html",
        )

    def _refusal(self, status: int, text: str) -> Response:
        return PlainTextResponse(text, status, self._always)

    # -- tabs --------------------------------------------------------------------------------------------------------

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        socket = WebSocket(scope, receive, send)
        origin = Headers(scope=scope).getlist("origin")
        if not (self._for_us(scope) and self._known(scope) and origin == [self._origin] and scope["path"] == "/ws"):
            await socket.close(1008)
            return
        if self._tabs >= TABS:
            await socket.close(1013)
            return
        self._tabs += 1
        try:
            await ServedTab(socket, self._hub).run()
        finally:
            self._tabs -= 1


def _same(given: str, secret: str) -> bool:
    """Whether two texts are the same, in a time that tells nothing."""
    return hmac.compare_digest(given.encode(), secret.encode())
