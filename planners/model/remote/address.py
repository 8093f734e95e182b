"""Parse the spec of a remote model, such as "openai:qwen3:8b@http://localhost:11434/v1", into URL, model and API key.

Also redacts keys from messages. Opens no connection.
"""

from __future__ import annotations

import importlib.util
import ipaddress
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal
from urllib.parse import quote, urlsplit

from ....gaussians.errors import BackendError, UserError

Kind = Literal["openai", "anthropic", "google"]

OVERRIDE = "SCENEWRIGHT_API_KEY"
_DUMMY_KEY = "none-needed"  # self-hosted servers seldom need a key, but the client libraries always send one
_LONGEST = 200  # characters of a specification; the limit of `plan.Usage.model`
_SHORTEST_SECRET = 8  # characters; shorter keys are placeholders such as "ollama" or "EMPTY"
_HEAD = (
    12  # first characters of a key; they and what follows are redacted, since servers show truncated or starred keys
)
_SHOWN = 300  # characters of a server's message in an error


@dataclass(frozen=True)
class Service:
    """One wire format and the provider that it is named after.

    Attributes:
        label: name of the provider in messages.
        keys: environment variables of its key; the first that is set wins.
        url_variable: environment variable with which its own tools set another address.
        url: its default address.
        version: path that the client adds to an address itself, so that it is removed from the address of a user.
        package: package that the client needs besides pydantic-ai.
    """

    label: str
    keys: tuple[str, ...]
    url_variable: str
    url: str
    version: str
    package: str


SERVICES: dict[Kind, Service] = {
    "openai": Service("OpenAI", ("OPENAI_API_KEY",), "OPENAI_BASE_URL", "https://api.openai.com/v1", "", "openai"),
    "anthropic": Service(
        "Anthropic", ("ANTHROPIC_API_KEY",), "ANTHROPIC_BASE_URL", "https://api.anthropic.com", "/v1", "anthropic"
    ),
    "google": Service(
        "Google",
        ("GOOGLE_API_KEY", "GEMINI_API_KEY"),
        "GOOGLE_GEMINI_BASE_URL",
        "https://generativelanguage.googleapis.com",
        "/v1beta",
        "google.genai",
    ),
}


@dataclass(frozen=True)
class Address:
    """A model behind a wire format.

    Attributes:
        name: the spec as the user wrote it.
        kind: the wire format.
        model: name of the model on its server.
        url: address of the server, without a trailing slash.
        own: whether the server is not the provider's.
        key: sent with each request.
        secrets: all keys in the environment; redacted from messages.
    """

    name: str
    kind: Kind
    model: str
    url: str
    own: bool
    key: str = field(repr=False)
    secrets: tuple[str, ...] = field(repr=False)

    @property
    def near(self) -> bool:
        """Whether the server is on this machine or its local network; such servers are reached without a proxy."""
        host = urlsplit(self.url).hostname or ""
        try:
            return ipaddress.ip_address(host).is_private
        except ValueError:
            return "." not in host or host.endswith((".localhost", ".local", ".lan", ".internal"))

    def hide(self, text: str) -> str:
        """Untrusted text made safe to display: one line, without keys and control characters, truncated."""
        shown = " ".join(self.without_keys(text).split())
        shown = "".join(c for c in shown if c.isprintable())
        return shown if len(shown) <= _SHOWN else shown[: _SHOWN - 1] + "…"

    def without_keys(self, text: str) -> str:
        """The text with each key of the environment replaced, also in its URL and JSON encodings."""
        for secret in self.secrets:
            for written in {secret, quote(secret, safe=""), json.dumps(secret)[1:-1]}:
                text = text.replace(written, "[key]")
            if len(secret) > _HEAD:
                text = re.sub(re.escape(secret[:_HEAD]) + r"[\w.*…-]*", "[key]", text)
        return text


def read(spec: str, environ: Mapping[str, str]) -> Address:
    """Parse "KIND:MODEL[@BASE_URL]"; MODEL may contain ":" and "/", and "@" except before a scheme.

    Raises:
        UserError: the specification is malformed, or contains a key.
        BackendError: the key or a package is missing; the message says how to get it.
    """
    kind, rest = _kind(spec)
    service = SERVICES[kind]
    model, separator, given = _parted(rest)
    if not re.fullmatch(r"[^\s?#%\\]+", model) or not model.isprintable() or ".." in model:
        raise UserError(f"{kind}: needs the name of a model, {kind}:MODEL or {kind}:MODEL@http://HOST:PORT")
    url = given if separator else environ.get(service.url_variable, "").strip()
    own = bool(url) and url.rstrip("/") != service.url
    secrets = _secrets(environ)
    if any(secret in spec for secret in secrets):
        raise UserError(f"the name of a model holds a key; leave it in {OVERRIDE} and write {kind}:MODEL[@BASE_URL]")
    _need_packages(service)
    key = _key(service, kind, own, environ)
    return Address(spec, kind, model, _tidy(url, service, kind) if url else service.url, own, key, secrets)


def _kind(spec: str) -> tuple[Kind, str]:
    kind, _, rest = spec.partition(":")
    if kind not in SERVICES or len(spec) > _LONGEST:
        kinds = ", ".join(f"{k}:MODEL[@BASE_URL]" for k in SERVICES)
        raise UserError(f"a remote model is named {kinds}, in at most {_LONGEST} letters")
    return kind, rest


def _parted(rest: str) -> tuple[str, str, str]:
    """Model, separator and URL, split at the last "@" before a scheme."""
    found = re.fullmatch(r"(.*)(@)([A-Za-z][A-Za-z0-9+.-]*://.*)", rest, re.DOTALL)
    return (found[1], found[2], found[3].strip()) if found else (rest, "", "")


def _tidy(url: str, service: Service, kind: Kind) -> str:
    """Normalise an address for the client of the service."""
    try:
        parts = urlsplit(url)
        fine = parts.scheme.lower() in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        fine = False
    if not fine or not re.fullmatch(r"[\x21-\x7e]+", url):
        raise UserError(f"the address of a server is written http://HOST:PORT or https://HOST, as in {kind}:MODEL@…")
    if parts.username or parts.password or parts.query or parts.fragment:
        raise UserError(f"the address of a server holds no password, ? or #; put the key into {OVERRIDE}")
    if kind == "openai" and not parts.path.strip("/"):
        return url.rstrip("/") + "/v1"  # where Ollama, vLLM, llama.cpp and LM Studio all serve this format
    return url.rstrip("/").removesuffix(service.version)


def _secrets(environ: Mapping[str, str]) -> tuple[str, ...]:
    names = (OVERRIDE, *(name for service in SERVICES.values() for name in service.keys))
    found = {environ.get(name, "").strip() for name in names}
    return tuple(sorted((s for s in found if len(s) >= _SHORTEST_SECRET), key=len, reverse=True))


def _key(service: Service, kind: Kind, own: bool, environ: Mapping[str, str]) -> str:
    for name in (OVERRIDE, *service.keys):
        if key := environ.get(name, "").strip():
            if not re.fullmatch(r"[\x21-\x7e]+", key):
                raise BackendError(
                    f"{name} holds letters that no key has; copy the key again, without quotes or breaks"
                )
            return key
    if own and kind == "openai":
        return _DUMMY_KEY
    names = " or ".join(service.keys)
    raise BackendError(f"{kind}: needs a key of {service.label}: set {names} (or {OVERRIDE}, which comes first)")


def _need_packages(service: Service) -> None:
    for package in ("pydantic_ai", service.package):
        try:
            found = importlib.util.find_spec(package) is not None
        except ModuleNotFoundError:  # the parent package is missing
            found = False
        if not found:
            raise BackendError(f"{service.label}'s models need {package}: pip install 'scenewright[llm]'")
