"""`Kind`: one kind of question, as the phrases in which it is asked and the geometry that answers it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .answer import Answer, AnswerType
from .reading.phrase_templates import Template
from .reading.situation import Situation
from .survey import Survey, Thing
from .timeline.bodies import Timeline


@dataclass(frozen=True)
class Asked:
    """A question that was read.

    Attributes:
        text: as asked.
        slots: the values of the template's holes, by name.
        situation: where the person who asks says to be, None if nothing is said.
        words: of the question, in plain form.
        timeline: what moves in the scene, None if nothing does.
    """

    text: str
    slots: Mapping[str, Any] = field(default_factory=dict)
    situation: Situation | None = None
    words: tuple[str, ...] = ()
    timeline: Timeline | None = None

    @property
    def said(self) -> str:
        """The words of the question without the situation, in plain form."""
        return " ".join(self.words)


@dataclass(frozen=True)
class Undecided:
    """A question that boxes, labels and colours cannot answer.

    Attributes:
        text: one sentence that says why.
        sight: whether somebody who sees pictures of the scene may answer it: material, text, state, style.
        answer_type: the type that the question asks for.
        things: what it is about.
        confidence: estimated probability that it cannot be answered from geometry.
    """

    text: str
    sight: bool
    answer_type: AnswerType = "text"
    things: tuple[Thing, ...] = ()
    confidence: float = 0.95


@dataclass(frozen=True)
class Kind:
    """One kind of question.

    Attributes:
        name: short name, for `--json` and benchmarks.
        templates: the ways of asking it, the most specific first.
        answer: the answer, or why there is none; None if the filled template is no such question after all. Raises
            `NotResolved` where a phrase is absent or ambiguous.
    """

    name: str
    templates: tuple[Template, ...]
    answer: Callable[[Asked, Survey], Answer | Undecided | None]
