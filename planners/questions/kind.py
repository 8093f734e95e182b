"""`Kind`: one kind of question, as the phrases in which it is asked and the geometry that answers it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .answer import Answer
from .reading.phrase_templates import Template
from .reading.situation import Situation
from .survey import Survey


@dataclass(frozen=True)
class Asked:
    """A question that was read.

    Attributes:
        text: as asked.
        slots: the values of the template's holes, by name.
        situation: where the person who asks says to be, None if nothing is said.
    """

    text: str
    slots: Mapping[str, Any] = field(default_factory=dict)
    situation: Situation | None = None


@dataclass(frozen=True)
class Kind:
    """One kind of question.

    Attributes:
        name: short name, for `--json` and benchmarks.
        templates: the ways of asking it, the most specific first.
        answer: the answer, None if the filled template is no such question after all; raises `NotResolved` where a
            phrase is absent or ambiguous.
    """

    name: str
    templates: tuple[Template, ...]
    answer: Callable[[Asked, Survey], Answer | None]
