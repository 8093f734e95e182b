"""Planning by language models, behind one protocol (`backend.py`), each loaded only when it is named."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import UserError

if TYPE_CHECKING:
    from .backend import ModelBackend
    from .planner import ModelPlanner

FORMS = ("openai:MODEL[@BASE_URL]", "anthropic:MODEL[@URL]", "google:MODEL[@URL]", "transformers:FOLDER")
_REMOTE = ("openai", "anthropic", "google")
_LOCAL = "transformers"


def is_model(spec: str) -> bool:
    """Whether a string names a language model rather than another planner; it may still be wrong."""
    return spec.partition(":")[0] in (*_REMOTE, _LOCAL)


def load(spec: str) -> ModelBackend:
    """The language model that one string names: one of `FORMS`.

    Raises:
        UserError: it names no kind of model, or no model of that kind.
        BackendError: what it needs is not installed, or there is no such folder or key.
    """
    kind, _, name = spec.partition(":")
    if kind not in (*_REMOTE, _LOCAL) or not name.strip():
        raise UserError(f"{spec!r} names no language model; it is one of {', '.join(FORMS)}")
    module: Any = importlib.import_module(f"{__name__}.{'local' if kind == _LOCAL else 'remote'}.backend")
    loaded: ModelBackend = module.load(name if kind == _LOCAL else spec)
    return loaded


def load_planner(spec: str, **settings: Any) -> ModelPlanner:
    """A planner that asks the language model that one string names.

    Args:
        spec: as `load` takes it.
        settings: keywords of `ModelPlanner`.

    Raises:
        UserError, BackendError: as `load`.
    """
    from .planner import ModelPlanner

    return ModelPlanner(load(spec), **settings)
