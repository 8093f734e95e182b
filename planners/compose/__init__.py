"""Compose a room from a sentence: briefs, knowledge about rooms, and the steps from a brief to a layout."""

from __future__ import annotations

from .brief import Brief, RefusedError
from .compose import Composition, compose
from .problems import problem_of
from .sampling import sample_brief
from .sentence.read import read

__all__ = ["Brief", "Composition", "RefusedError", "compose", "problem_of", "read", "sample_brief"]
