"""The HTTP client for remote models: bounded response size, no redirects, no proxy for servers on the local network."""

from __future__ import annotations

from collections.abc import AsyncIterator
from functools import partial
from typing import TYPE_CHECKING, Any

from .address import Address
from .errors import StoppedError

if TYPE_CHECKING:
    import httpx2

_MAX_BYTES = 32 << 20  # of one response: a streamed token costs about 300 bytes, so five times the longest answer
_CONNECT = 10.0  # seconds to connect; a reachable server needs less than one


def open_client(address: Address, seconds: float) -> httpx2.AsyncClient:
    """An HTTP client that reads at most `_MAX_BYTES` of a response and follows no redirects.

    Raises:
        StoppedError: the environment names a proxy that cannot be used.
    """
    import httpx2
    from pydantic_ai.models import create_async_httpx2_client

    try:
        client = create_async_httpx2_client(
            timeout=httpx2.Timeout(seconds, connect=min(_CONNECT, seconds)),
            transport=httpx2.AsyncHTTPTransport() if address.near else None,  # an explicit transport bypasses proxies
        )
    except (ImportError, ValueError):  # an unknown type of proxy, or one that needs another package
        raise StoppedError(
            "the proxy that HTTPS_PROXY, HTTP_PROXY or ALL_PROXY names cannot be used; correct it, or see NO_PROXY"
        ) from None
    client.headers["Accept-Encoding"] = "identity"  # so that the bytes counted are those in memory
    client.headers["Connection"] = "close"  # a kept connection may close while the next request is sent
    client.event_hooks["response"].append(partial(_limit, address))
    return client


async def _limit(address: Address, response: httpx2.Response) -> None:
    """Refuse redirects, which would forward the key, and compressed responses; limit the size of all others."""
    if response.is_redirect:
        elsewhere = address.hide(response.headers.get("location", ""))
        raise StoppedError(f"{address.url} sends elsewhere ({elsewhere}); name that address after the @ instead")
    if response.headers.get("content-encoding", "identity") != "identity":
        raise StoppedError(
            f"{address.url} compresses its answers though asked not to; turn that off in the server or the proxy "
            "before it"
        )
    response.stream = _counted(address, response.stream)


def _counted(address: Address, stream: Any) -> httpx2.AsyncByteStream:
    import httpx2

    class Counted(httpx2.AsyncByteStream):
        async def __aiter__(self) -> AsyncIterator[bytes]:
            size = 0
            async for chunk in stream:
                size += len(chunk)
                if size > _MAX_BYTES:
                    raise StoppedError(
                        f"{address.model} at {address.url} sent more than any answer needs; it may be caught in a "
                        "loop, ask again or another model"
                    )
                yield chunk

        async def aclose(self) -> None:
            await stream.aclose()

    return Counted()
