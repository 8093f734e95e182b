"""Planning with language models behind one protocol (`backend.py`); a back end is imported when a spec names it."""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import UserError

if TYPE_CHECKING:
    from .backend import ModelBackend
    from .planner import ModelPlanner

FORMS = ("openai:MODEL[@BASE_URL]", "anthropic:MODEL[@URL]", "google:MODEL[@URL]", "transformers:FOLDER")
_REMOTE = ("openai", "anthropic", "google")
_LOCAL = "transformers"
WINDOW_VARIABLE = "SCENEWRIGHT_WINDOW"  # tokens of prompt and answer together, for servers that do not tell
_WINDOWS = (1024, 100_000_000)


def is_model(spec: str) -> bool:
    """Whether a planner spec has the prefix of a language model; the rest is not validated."""
    return spec.partition(":")[0] in (*_REMOTE, _LOCAL)


def load(spec: str) -> ModelBackend:
    """Load the language model of a spec, which has one of the `FORMS`.

    `SCENEWRIGHT_WINDOW` sets its context window in tokens; without it a server is asked, or a file of the model read.

    Raises:
        UserError: unknown kind of model, no model name, or a window that is no number of tokens.
        BackendError: a package, folder or key is missing.
    """
    kind, _, name = spec.partition(":")
    if kind not in (*_REMOTE, _LOCAL) or not name.strip():
        raise UserError(f"{spec!r} names no language model; give one of {', '.join(FORMS)}")
    module: Any = importlib.import_module(f"{__name__}.{'local' if kind == _LOCAL else 'remote'}.backend")
    loaded: ModelBackend = module.load(name if kind == _LOCAL else spec, window(os.environ.get(WINDOW_VARIABLE, "")))
    return loaded


def window(text: str) -> int | None:
    """The context window that a text states ("32768", "32k"), in tokens; None for an empty text.

    Raises:
        UserError: it is no number of tokens.
    """
    plain = text.strip().lower().replace("_", "").replace(",", "")
    if not plain:
        return None
    digits, thousand = plain.removesuffix("k"), 1024 if plain.endswith("k") else 1
    if not (digits.isascii() and digits.isdigit()) or not _WINDOWS[0] <= int(digits[:12]) * thousand <= _WINDOWS[1]:
        raise UserError(
            f"{text[:40]!r} is no context window; write its tokens, {_WINDOWS[0]} or more, as in 32768 or 32k "
            f"({WINDOW_VARIABLE}, --window)"
        )
    return int(digits) * thousand


def load_planner(spec: str, **settings: Any) -> ModelPlanner:
    """A planner that uses the language model of a spec.

    Args:
        spec: as `load` takes it.
        settings: keywords of `ModelPlanner`.

    Raises:
        UserError, BackendError: as `load`.
    """
    from .planner import ModelPlanner

    return ModelPlanner(load(spec), **settings)
