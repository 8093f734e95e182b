"""A sentence to a room: briefs, what rooms are like, and how one is composed."""

from __future__ import annotations

from .brief import Brief, RefusedError
from .compose import Composition, compose
from .problems import problem_of
from .sampling import sample_brief
from .sentence.read import read

__all__ = ["Brief", "Composition", "RefusedError", "compose", "problem_of", "read", "sample_brief"]
