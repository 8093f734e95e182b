"""Serves an MCP server over stdin and stdout, or over HTTP on this machine only."""

from __future__ import annotations

import socket

import anyio
import uvicorn
from mcp.server.transport_security import TransportSecuritySettings

from ...gaussians.errors import UserError
from ..terminal.output import terminal
from .server import SceneServer

HOST = "127.0.0.1"


def serve_stdio(server: SceneServer) -> None:
    """Serve one client until it closes stdin. Nothing but the protocol reaches its stdout."""
    server.run("stdio")


def serve_http(server: SceneServer, port: int) -> None:
    """Serve clients on this machine until the process is stopped. `port` 0 takes a free one.

    Requests whose Host or Origin header names another host are refused, so that no web page reaches the scene.

    Raises:
        UserError: the port cannot be used.
    """
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((HOST, port))
    except (OSError, OverflowError) as error:
        listening.close()
        why = getattr(error, "strerror", None) or error
        raise UserError(f"cannot listen on port {port} ({why}); choose another one with --http") from error
    port = listening.getsockname()[1]
    app = server.streamable_http_app(host=HOST, transport_security=local_only(port))
    config = uvicorn.Config(app, log_config=None, access_log=False, lifespan="on", timeout_graceful_shutdown=2)
    url = f"http://{HOST}:{port}/mcp"
    if terminal.as_json:
        terminal.row({"url": url})
    terminal.say(f"MCP server: {url} (Ctrl-C stops it)")
    with listening:
        anyio.run(lambda: uvicorn.Server(config).serve(sockets=[listening]))


def local_only(port: int) -> TransportSecuritySettings:
    """Settings that refuse requests which are not for this machine and port (DNS rebinding)."""
    hosts = [f"{name}:{port}" for name in (HOST, "localhost")]
    return TransportSecuritySettings(
        enable_dns_rebinding_protection=True, allowed_hosts=hosts, allowed_origins=[f"http://{host}" for host in hosts]
    )
