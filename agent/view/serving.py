"""Serves the page on this machine until the process is stopped."""

from __future__ import annotations

import socket
import threading
import webbrowser

import uvicorn

from ...gaussians.errors import UserError
from ..terminal.output import terminal
from .hub import Hub
from .messages import MAX_BYTES
from .server import HOST, App

CONNECTIONS = 128  # at once; more are answered 503


def serve(hub: Hub, port: int, *, open_page: bool) -> None:
    """Serve a hub until Ctrl-C or another signal to end; then its session is closed.

    Args:
        port: 0 takes a free one.
        open_page: also open the page in the user's browser.

    Raises:
        UserError: the port cannot be used.
    """
    listening = listen(port)
    app = App(hub, listening.getsockname()[1])
    if terminal.as_json:
        terminal.row({"url": app.address})
    terminal.say(f"the page: {app.address} (this address opens it once; Ctrl-C ends the server)")
    if open_page:
        threading.Thread(target=webbrowser.open, args=(app.address,), daemon=True).start()
    try:
        with listening:
            server(app).run(sockets=[listening])
    except KeyboardInterrupt:
        terminal.say("ended")
    finally:
        hub.stop()


def listen(port: int) -> socket.socket:
    """A socket on this machine only; raises UserError if the port cannot be used."""
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((HOST, port))
        listening.listen(CONNECTIONS)  # before the address is told: who is early waits
    except (OSError, OverflowError) as error:
        listening.close()
        why = getattr(error, "strerror", None) or error
        raise UserError(f"cannot listen on port {port} ({why}); choose another one with --port, or 0") from error
    return listening


def server(app: App) -> uvicorn.Server:
    """The web server of an application, with bounds on what it takes. Gaussians do not compress."""
    config = uvicorn.Config(
        app, log_config=None, access_log=False, lifespan="on", ws="websockets-sansio", ws_max_size=MAX_BYTES,
        ws_per_message_deflate=False, limit_concurrency=CONNECTIONS, timeout_graceful_shutdown=2, server_header=False,
        proxy_headers=False,
    )  # fmt: skip
    return uvicorn.Server(config)
