"""Planning with language models behind one protocol (`backend.py`); a back end is imported when a spec names it."""

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
    """Whether a planner spec has the prefix of a language model; the rest is not validated."""
    return spec.partition(":")[0] in (*_REMOTE, _LOCAL)


def load(spec: str) -> ModelBackend:
    """Load the language model of a spec, which has one of the `FORMS`.

    Raises:
        UserError: unknown kind of model, or no model name.
        BackendError: a package, folder or key is missing.
    """
    kind, _, name = spec.partition(":")
    if kind not in (*_REMOTE, _LOCAL) or not name.strip():
        raise UserError(f"{spec!r} names no language model; give one of {', '.join(FORMS)}")
    module: Any = importlib.import_module(f"{__name__}.{'local' if kind == _LOCAL else 'remote'}.backend")
    loaded: ModelBackend = module.load(name if kind == _LOCAL else spec)
    return loaded


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
