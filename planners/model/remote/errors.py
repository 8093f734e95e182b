"""Handle errors of remote models: a message that says what to do, parameters to omit after a refusal, retry delays."""

from __future__ import annotations

import re
import socket
import ssl
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal
from urllib.parse import urlsplit
from urllib.request import getproxies, proxy_bypass

from .address import SERVICES, Address, Kind

# What holds an answer to its form: a schema, a function whose arguments it is, JSON of any kind, or words alone.
Form = Literal["schema", "tool", "json", "words"]
# From the tightest to the loosest, by wire; Anthropic's schema is that of a tool.
_FORMS: dict[Kind, tuple[Form, ...]] = {
    "openai": ("schema", "tool", "json", "words"),
    "anthropic": ("schema", "words"),
    "google": ("schema", "json", "words"),
}

FIRST_PAUSE = 1.0  # seconds before the first retry if the server gives no delay; doubled each time
_SHORTEST_PAUSE = 0.1
_MAX_RETRIES = 2  # retries of a failing server; a busy one (code 429) is retried until the time limit
_READ = 20_000  # characters of an error body that are examined


class StoppedError(Exception):
    """We ended a request; the message is for the user."""


class NothingError(Exception):
    """The server sent neither text nor a reason for its absence."""


@dataclass(frozen=True)
class Extras:
    """Optional parameters of a request, omitted if the server refuses them.

    Attributes:
        form: constraint of the answer.
        temperature, seed: whether to send them, for reproducible answers.
        length: whether to send a maximum length.
        stream: whether to stream the answer.
    """

    form: Form = "schema"
    temperature: bool = True
    seed: bool = True
    length: bool = True
    stream: bool = True


BARE = Extras(form="words", temperature=False, seed=False, length=False, stream=False)

_FORM = r"response_?format|json_?schema|schema|grammar|response_?mime|json_?object|structured"
_COMPLAINTS = {
    "form": re.compile(_FORM + r"|\btools?\b|tool_?choice|guided", re.IGNORECASE),
    "temperature": re.compile("temperature", re.IGNORECASE),
    "seed": re.compile(r"\bseed\b", re.IGNORECASE),
    "length": re.compile(r"max_?(completion_?|output_?)?tokens", re.IGNORECASE),
    "stream": re.compile(r"\bstream", re.IGNORECASE),
}
_TOO_LONG = re.compile(r"context[_ ](length|window|size)|(prompt|input|request) is too (long|large)", re.IGNORECASE)
_REFUSALS = {400, 415, 422, 501}  # status codes with which servers refuse a parameter
# In messages of servers that fail, with code 500, to convert a schema to a grammar.
_NO_GRAMMAR = re.compile(_FORM, re.IGNORECASE)


def fewer_extras(extras: Extras, error: BaseException, kind: Kind) -> Extras | None:
    """Parameters for the next request after a refusal, always fewer than before; None if that would not help.

    Parameters that the refusal names are omitted; if it names none, all are.
    """
    from pydantic_ai import exceptions as failures

    hopeless = (failures.ModelAuthenticationError, failures.ModelNotFoundError, failures.ModelQuotaExceededError)
    if not isinstance(error, failures.ModelHTTPError) or isinstance(error, hopeless) or extras == BARE:
        return None
    body = str(error.body)[:_READ]
    if error.status_code == 500 and _NO_GRAMMAR.search(body) and extras.form != "words":
        form = looser(extras.form, kind)  # a function's arguments are held to the same grammar
        return replace(extras, form=looser(form, kind) if form == "tool" else form)
    if error.status_code not in _REFUSALS:
        return None
    too_long = isinstance(error, failures.ModelContextWindowExceededError) or _TOO_LONG.search(body)
    if too_long and not (extras.length and _COMPLAINTS["length"].search(body)):
        return None
    blamed = {name for name, words in _COMPLAINTS.items() if words.search(body)}
    omitted: dict[str, Any] = dict.fromkeys(blamed, False)
    if "form" in blamed:
        omitted["form"] = looser(extras.form, kind)
    less = replace(extras, **omitted)
    return less if less != extras else BARE


def without_stream(extras: Extras, error: BaseException) -> Extras | None:
    """Parameters that ask for the answer at once, after a stream that held none or broke; None if the error is another.

    Some servers accept `stream`, ignore it and send a whole answer; others send events that are none, or stop halfway.
    """
    import httpx2
    from pydantic_ai import exceptions as failures

    chain = list(_chain(error))
    if not extras.stream or _first(chain, StoppedError, httpx2.TimeoutException, httpx2.ConnectError):
        return None
    broken = (failures.UnexpectedModelBehavior, httpx2.RemoteProtocolError, httpx2.ReadError, ConnectionResetError)
    said_so = isinstance(error, failures.ModelAPIError) and error.in_stream
    if _first(chain, *broken, ValueError) is None and not said_so:
        return None
    return replace(extras, stream=False)


def learned(extras: Extras, text: str, kind: Kind) -> Extras:
    """Parameters for the next request after an answer: a looser form if the answer shows that the server ignores this
    one, since an answer that is held to JSON has a brace; and no stream if its end is missing."""
    if "{" not in text:
        return replace(extras, form=looser(extras.form, kind))
    return replace(extras, stream=False) if extras.stream and "}" not in text else extras


def looser(form: Form, kind: Kind) -> Form:
    """The next form that a server may take."""
    forms = _FORMS[kind]
    return forms[min(forms.index(form) + 1, len(forms) - 1)] if form in forms else "words"


def retry_delay(error: BaseException, tries: int) -> float | None:
    """Seconds after which a retry may help; None if it will not.

    Args:
        tries: number of retries so far.
    """
    from pydantic_ai import exceptions as failures

    if not isinstance(error, failures.ModelHTTPError) or isinstance(error, failures.ModelQuotaExceededError):
        return None
    busy = error.status_code == 429
    if not busy and (tries >= _MAX_RETRIES or error.status_code not in (408, 500, 502, 503, 504, 529)):
        return None
    asked = error.retry_after
    return FIRST_PAUSE * 2.0 ** min(tries, 6) if asked is None else max(asked, _SHORTEST_PAUSE)


def describe(error: BaseException, address: Address, seconds: float) -> str:
    """The error in one line: what happened, where, and what to do. Contains no key, even if the server echoed it."""
    from pydantic_ai import exceptions as failures

    if isinstance(error, failures.ModelHTTPError):
        text = _status_error(error, address)
    else:
        text = _transport_error(list(_chain(error)), address, seconds) or _invalid_response(error, address)
    return address.without_keys(text)


def _chain(error: BaseException) -> Iterator[BaseException]:
    """The error, its causes and contexts, and the members of exception groups."""
    waiting, seen = [error], set[int]()
    while waiting:
        one = waiting.pop(0)
        if id(one) not in seen:
            seen.add(id(one))
            yield one
            waiting += [e for e in (one.__cause__, one.__context__) if e is not None]
            waiting += list(one.exceptions) if isinstance(one, BaseExceptionGroup) else []


def _first(chain: list[BaseException], *kinds: type[BaseException]) -> Any:
    return next((one for one in chain if isinstance(one, kinds)), None)


def _transport_error(chain: list[BaseException], address: Address, seconds: float) -> str:
    """Message for an error of connection or transport; "" if there is none in the chain."""
    import httpx2

    at, model = address.url, address.model
    proxy = ", or at the proxy of the environment" if _proxied(address) else ""
    if stopped := _first(chain, StoppedError):
        return str(stopped)
    if (refused := _first(chain, ssl.SSLError)) or any("certificate" in str(one).lower() for one in chain):
        why = address.hide(getattr(refused, "reason", None) or "")
        return f"no trusted connection to {at} ({why}); name the server's certificate in SSL_CERT_FILE, or use http://"
    if _first(chain, socket.gaierror):
        return f"there is no host of the name in {at}; look for a slip in it{proxy}, or whether the network is up"
    if _first(chain, ConnectionRefusedError):
        return f"nothing answers at {at}{proxy}: is the server running? Start it, or name another address after the @"
    if _first(chain, httpx2.ConnectTimeout):
        return f"no connection to {at}: is the address right, is a firewall or a proxy in the way?"
    if _first(chain, httpx2.TimeoutException, TimeoutError):
        return f"{model} at {at} did not answer within {seconds:g} s; give it longer, or use a smaller model"
    if _first(chain, httpx2.RemoteProtocolError, httpx2.ReadError, httpx2.WriteError, ConnectionError):
        return f"{at} broke off in the middle of its answer; ask again, and look into the server's log"
    if _first(chain, httpx2.ProxyError, httpx2.ConnectError, OSError):
        return f"no connection to {at}: is the address right, is the server running? Look there{proxy}"
    return ""


def _proxied(address: Address) -> bool:
    """Whether requests go through a proxy set in the environment."""
    parts = urlsplit(address.url)
    proxies = getproxies()
    named = any(proxies.get(scheme) for scheme in (parts.scheme.lower(), "all"))
    return named and not address.near and not proxy_bypass(parts.hostname or "")


def _invalid_response(error: BaseException, address: Address) -> str:
    """Message for a response that is no answer of a language model, or an error of the libraries."""
    from pydantic_ai import exceptions as failures

    kind, at = address.kind, address.url
    if isinstance(error, failures.ModelAPIError) and error.in_stream:
        return f"{address.model} at {at} failed in the middle of its answer: {_server_message(error.body, address)}"
    own = f"; does it speak the {kind} format, and is its address complete?" if address.own else "; ask again later"
    return f"{at} answered something that is no answer of a language model{own}"


def _status_error(error: Any, address: Address) -> str:
    """Message for a request that the server refused or failed to answer.

    Args:
        error: pydantic-ai's ModelHTTPError.
    """
    from pydantic_ai import exceptions as failures

    code, model, at = error.status_code, address.model, address.url
    service = SERVICES[address.kind]
    said = _server_message(error.body, address)
    quoted = f' It said: "{said}"' if said else ""
    if isinstance(error, failures.ModelQuotaExceededError) or code == 402:
        return f"the account at {at} has no credit or quota left; look at its billing, or use another model.{quoted}"
    if isinstance(error, failures.ModelContextWindowExceededError) or code == 413 or _TOO_LONG.search(said):
        return f"the request is longer than {model} at {at} can read; give it a longer context or use another.{quoted}"
    if isinstance(error, failures.ModelAuthenticationError) or code in (401, 403):
        names = ", ".join(("SCENEWRIGHT_API_KEY", *service.keys))
        return f"{at} does not accept the key, or not for {model}; look at {names}.{quoted}"
    if code in (404, 405):
        return _missing_model(model, address, said) + quoted
    if code == 429:
        asked = f" and asks to wait {error.retry_after:g} s" if error.retry_after else ""
        return f"{at} takes no more requests for now{asked}, longer than there was time; ask again later.{quoted}"
    if code >= 500 or code == 408:
        return f"the server at {at} failed (code {code}); try later, or look into its log.{quoted}"
    if re.search("image|vision|multimodal", said, re.IGNORECASE):
        return f"{model} at {at} takes no pictures; ask without one, or use another model.{quoted}"
    return f"{at} refused the request for {model} (code {code}).{quoted or ' It did not say why; look into its log.'}"


def _missing_model(model: str, address: Address, said: str) -> str:
    if model.rsplit("/", 1)[-1].lower() in said.lower() or "model" in said.lower():
        return f"there is no model {model!r} at {address.url}; look for a slip, or fetch it onto the server."
    hint = " (addresses of this format usually end in /v1)" if address.kind == "openai" and address.own else ""
    return (
        f"{address.url} has neither the model {model!r} nor, it seems, a language model's address{hint}; look at both."
    )


def _server_message(body: object, address: Address) -> str:
    """The message in the body of an error, safe to display; "" if there is none."""
    for _ in range(4):  # {"error": {"message": "…"}}, [{"error": …}], {"detail": "…"}
        if isinstance(body, list) and body:
            body = body[0]
        elif isinstance(body, dict):
            body = next((body[k] for k in ("message", "error", "detail", "msg") if body.get(k)), None)
    if not isinstance(body, str) or body.lstrip().startswith("<"):  # a page for browsers
        return ""
    return address.hide(body[:_READ])
