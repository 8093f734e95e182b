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

from .address import SERVICES, Address

Form = Literal["schema", "json", "words"]  # the answer held to a schema, to JSON, to nothing

FIRST_PAUSE = 1.0  # seconds before asking again where the server does not say; doubled each time
_SHORTEST_PAUSE = 0.1
_REPAIRS = 2  # how often a broken server is asked again; one that is only busy, as long as there is time
_READ = 20_000  # letters of an error's body that are looked at


class StoppedError(Exception):
    """We ended a request; the message is for the user."""


class NothingError(Exception):
    """The server sent neither words nor a reason for ending without them."""


@dataclass(frozen=True)
class Extras:
    """What is asked of a server beyond the wire format's core; left out where it complains.

    Attributes:
        form: how its answer is bound.
        temperature, seed: the same answer to the same words, where it can.
        length: a longest answer.
        stream: the answer in pieces.
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
_REFUSALS = {400, 415, 422, 501}  # codes that servers refuse a parameter with
_NO_GRAMMAR = re.compile(_FORM, re.IGNORECASE)  # what servers say that fail, code 500, at making a grammar of a schema


def without(extras: Extras, error: BaseException) -> Extras | None:
    """What to ask for instead after a refusal, always less than before; None where less would not help.

    A refusal that names parameters is asked without those, one that names none without any.
    """
    from pydantic_ai import exceptions as failures

    hopeless = (failures.ModelAuthenticationError, failures.ModelNotFoundError, failures.ModelQuotaExceededError)
    if not isinstance(error, failures.ModelHTTPError) or isinstance(error, hopeless) or extras == BARE:
        return None
    body = str(error.body)[:_READ]
    if error.status_code == 500 and _NO_GRAMMAR.search(body) and extras.form != "words":
        return replace(extras, form=_looser(extras.form))
    if error.status_code not in _REFUSALS:
        return None
    too_long = isinstance(error, failures.ModelContextWindowExceededError) or _TOO_LONG.search(body)
    if too_long and not (extras.length and _COMPLAINTS["length"].search(body)):
        return None
    blamed = {name for name, words in _COMPLAINTS.items() if words.search(body)}
    omitted: dict[str, Any] = dict.fromkeys(blamed, False)
    if "form" in blamed:
        omitted["form"] = _looser(extras.form)
    less = replace(extras, **omitted)
    return less if less != extras else BARE


def _looser(form: Form) -> Form:
    return "json" if form == "schema" else "words"


def pause(error: BaseException, tries: int) -> float | None:
    """Seconds after which asking again may help; None where it will not.

    Args:
        tries: how often it was asked again already.
    """
    from pydantic_ai import exceptions as failures

    if not isinstance(error, failures.ModelHTTPError) or isinstance(error, failures.ModelQuotaExceededError):
        return None
    busy = error.status_code == 429
    if not busy and (tries >= _REPAIRS or error.status_code not in (408, 500, 502, 503, 504, 529)):
        return None
    asked = error.retry_after
    return FIRST_PAUSE * 2.0 ** min(tries, 6) if asked is None else max(asked, _SHORTEST_PAUSE)


def say(error: BaseException, address: Address, seconds: float) -> str:
    """The error in one line: what happened, where, and what to do. Never holds a key, whatever the server echoed."""
    from pydantic_ai import exceptions as failures

    if isinstance(error, failures.ModelHTTPError):
        text = _status(error, address)
    else:
        text = _transport(list(_chain(error)), address, seconds) or _nonsense(error, address)
    return address.without_keys(text)


def _chain(error: BaseException) -> Iterator[BaseException]:
    """The error and all that it came from."""
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


def _transport(chain: list[BaseException], address: Address, seconds: float) -> str:
    """Of what kept the request from its answer; "" where nothing did."""
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
    """Whether requests go through a proxy that the environment names."""
    parts = urlsplit(address.url)
    proxies = getproxies()
    named = any(proxies.get(scheme) for scheme in (parts.scheme.lower(), "all"))
    return named and not address.near and not proxy_bypass(parts.hostname or "")


def _nonsense(error: BaseException, address: Address) -> str:
    """Of an answer that is none, or of an error of our libraries."""
    from pydantic_ai import exceptions as failures

    kind, at = address.kind, address.url
    if isinstance(error, failures.ModelAPIError) and error.in_stream:
        return f"{address.model} at {at} failed in the middle of its answer: {_words(error.body, address)}"
    own = f"; does it speak the {kind} format, and is its address complete?" if address.own else "; ask again later"
    return f"{at} answered something that is no answer of a language model{own}"


def _status(error: Any, address: Address) -> str:
    """Of a request that the server refused or failed at.

    Args:
        error: pydantic-ai's ModelHTTPError.
    """
    from pydantic_ai import exceptions as failures

    code, model, at = error.status_code, address.model, address.url
    service = SERVICES[address.kind]
    said = _words(error.body, address)
    quoted = f' It said: "{said}"' if said else ""
    if isinstance(error, failures.ModelQuotaExceededError) or code == 402:
        return f"the account at {at} has no credit or quota left; look at its billing, or use another model.{quoted}"
    if isinstance(error, failures.ModelContextWindowExceededError) or code == 413 or _TOO_LONG.search(said):
        return f"the request is longer than {model} at {at} can read; give it a longer context or use another.{quoted}"
    if isinstance(error, failures.ModelAuthenticationError) or code in (401, 403):
        names = ", ".join(("SCENEWRIGHT_API_KEY", *service.keys))
        return f"{at} does not accept the key, or not for {model}; look at {names}.{quoted}"
    if code in (404, 405):
        return _missing(model, address, said) + quoted
    if code == 429:
        asked = f" and asks to wait {error.retry_after:g} s" if error.retry_after else ""
        return f"{at} takes no more requests for now{asked}, longer than there was time; ask again later.{quoted}"
    if code >= 500 or code == 408:
        return f"the server at {at} failed (code {code}); try later, or look into its log.{quoted}"
    if re.search("image|vision|multimodal", said, re.IGNORECASE):
        return f"{model} at {at} takes no pictures; ask without one, or use another model.{quoted}"
    return f"{at} refused the request for {model} (code {code}).{quoted or ' It did not say why; look into its log.'}"


def _missing(model: str, address: Address, said: str) -> str:
    if model.rsplit("/", 1)[-1].lower() in said.lower() or "model" in said.lower():
        return f"there is no model {model!r} at {address.url}; look for a slip, or fetch it onto the server."
    hint = " (addresses of this format usually end in /v1)" if address.kind == "openai" and address.own else ""
    return (
        f"{address.url} has neither the model {model!r} nor, it seems, a language model's address{hint}; look at both."
    )


def _words(body: object, address: Address) -> str:
    """What the server said for people in an error's body, fit to be shown; "" where nothing is."""
    for _ in range(4):  # {"error": {"message": "…"}}, [{"error": …}], {"detail": "…"}
        if isinstance(body, list) and body:
            body = body[0]
        elif isinstance(body, dict):
            body = next((body[k] for k in ("message", "error", "detail", "msg") if body.get(k)), None)
    if not isinstance(body, str) or body.lstrip().startswith("<"):  # a page for browsers
        return ""
    return address.hide(body[:_READ])
