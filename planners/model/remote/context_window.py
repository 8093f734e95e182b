"""The context window of a model on a server of one's own: what the server tells, in any of the ways that servers do.

| server | where | what |
| --- | --- | --- |
| vLLM, SGLang and hosts of many models | GET /v1/models | `max_model_len`, `context_length` or `context_window` |
| llama.cpp | GET /props | `default_generation_settings.n_ctx` |
| LM Studio | GET /api/v0/models | `loaded_context_length` |
| Ollama | GET /api/ps, once the model is loaded; POST /api/show | `context_length`; `num_ctx` of its parameters |

A model's longest possible window, which servers also state, is not taken: what the server allocates is mostly shorter,
and some servers drop the beginning of a longer prompt without a word.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from . import http
from .address import Address
from .wait import Emit, Failed, wait

if TYPE_CHECKING:
    import httpx2

SECONDS = 3.0  # for all questions together; a server that answers at all does so in milliseconds
LEAST, MOST = 512, 100_000_000  # tokens; what is outside is no window
_OF_MODELS = ("max_model_len", "context_length", "context_window", "max_context_length", "n_ctx")
_NUM_CTX = re.compile(r"^num_ctx\s+(\d+)", re.MULTILINE)


def told_by(address: Address) -> int | None:
    """The window that a server in OpenAI's format states for a model; None if it states none, or does not answer."""
    if address.kind != "openai":
        return None

    async def work(emit: Emit) -> int | None:
        until = time.monotonic() + SECONDS
        async with http.open_client(address, SECONDS) as client:
            client.headers["Authorization"] = f"Bearer {address.key}"
            return await _ask(client, address, until)

    found = wait(work, SECONDS)
    return None if isinstance(found, Failed) else found


async def _ask(client: httpx2.AsyncClient, address: Address, until: float) -> int | None:
    """The first window that is told; raises the client's errors if nothing listens at all."""
    root = address.url.removesuffix("/v1")
    listed = await _json(client, "GET", f"{address.url}/models")
    if (window := _first(_entries(listed, "data", address.model), _OF_MODELS)) is not None:
        return window
    props = await _json(client, "GET", f"{root}/props")
    settings = props.get("default_generation_settings")
    if isinstance(settings, dict) and (window := _tokens(settings.get("n_ctx"))) is not None:
        return window
    lm_studio = await _json(client, "GET", f"{root}/api/v0/models")
    if (window := _first(_entries(lm_studio, "data", address.model), ("loaded_context_length",))) is not None:
        return window
    loaded = await _json(client, "GET", f"{root}/api/ps")
    if (window := _first(_entries(loaded, "models", address.model), ("context_length",))) is not None:
        return window
    if "models" not in loaded or time.monotonic() > until:
        return None
    shown = await _json(client, "POST", f"{root}/api/show", {"model": address.model})
    stated = _NUM_CTX.search(str(shown.get("parameters", "")))
    return _tokens(int(stated[1])) if stated else None


async def _json(client: httpx2.AsyncClient, verb: str, url: str, body: object = None) -> dict[str, Any]:
    """The JSON object at an address; empty if there is none."""
    reply = await client.request(verb, url, json=body) if body is not None else await client.request(verb, url)
    if reply.status_code != 200:
        return {}
    try:
        data = reply.json()
    except ValueError:
        return {}
    return data if isinstance(data, dict) else {}


def _entries(listed: dict[str, Any], key: str, model: str) -> Iterator[dict[str, Any]]:
    """The entries of a list of models that mean this one: by name, or the only one that is served."""
    every = listed.get(key)
    entries = [e for e in every if isinstance(e, dict)] if isinstance(every, list) else []
    names = {model, f"{model}:latest"}
    own = [
        e for e in entries if names & {e.get(name) for name in ("id", "name", "model") if isinstance(e.get(name), str)}
    ]
    yield from own or (entries if len(entries) == 1 and key == "data" else [])


def _first(entries: Iterator[dict[str, Any]], names: tuple[str, ...]) -> int | None:
    for entry in entries:
        more = entry.get("meta")
        for place in (entry, more if isinstance(more, dict) else {}):
            for name in names:
                if (window := _tokens(place.get(name))) is not None:
                    return window
    return None


def _tokens(value: object) -> int | None:
    """A number of tokens; None for anything else."""
    whole = isinstance(value, int) and not isinstance(value, bool)
    return int(value) if whole and LEAST <= int(value) <= MOST else None  # type: ignore[call-overload]
