"""What geometry measured, as a table for a vision model, and where the model's answer contradicts it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from ...gaussians.world.support import SHELL
from ...gaussians.world.words import normalise, plural
from ..model.prompt.labels import sanitize
from ..model.prompt.pruning import Relevance, tokens
from ..questions.answer import Answer
from ..rooms.graph import SceneGraph
from ..rooms.node import Node, NodeId

_NONE = "(none were measured)"
_SAME_LENGTH = 0.2  # relative difference up to which two lengths count as the same
_COUNT = re.compile(r"\bhow many\b|\bnumber of\b|\bcount\b", re.IGNORECASE)
_EXISTS = re.compile(r"^\s*(is|are) there\b", re.IGNORECASE)
# Words of a question that do not narrow what is counted.
_PLAIN = """
how many number count the of a an any are is there here do does you can i we see in on at this that room scene place
picture house and all together total altogether have has it be present visible what
"""
_PLAIN_WORDS = frozenset(_PLAIN.split())


@dataclass(frozen=True)
class Facts:
    """What is known of a scene before a vision model is asked.

    Attributes:
        graph: its things; None if nothing is known. Node ids that are numbers are ids of groups.
        measured: geometry's own answer to the question, None if it has none.
        notes: further measured sentences.
    """

    graph: SceneGraph | None = None
    measured: Answer | None = None
    notes: tuple[str, ...] = field(default=())

    @cached_property
    def clean(self) -> SceneGraph | None:
        """The graph with implausible names replaced by ""; only this one reaches a model."""
        return None if self.graph is None else sanitize(self.graph)

    def table(self, question: str, marks: Mapping[int, int], budget: int, only_marked: bool = False) -> str:
        """The things, those that matter to the question first, one line each, in at most `budget` tokens.

        Args:
            marks: numbers in the pictures to ids of groups. Things without a number are called "id 12".
            only_marked: leave out things without a number.
        """
        if self.clean is None or not self.clean.nodes:
            return "\n".join([_NONE, *self._sentences()])
        numbers = {group: mark for mark, group in marks.items()}
        width, depth, height = (f"{side:.2f}" for side in self.clean.room.size)
        lines = [f"Room: {width} x {depth} x {height} m.", *self._sentences()]
        left = budget - sum(map(tokens, lines)) - 20
        kept: dict[int, str] = {}
        for index in Relevance(self.clean, [question]).order():
            if only_marked and self.clean.nodes[index].id not in numbers:
                continue
            line = _line(self.clean.nodes[index], numbers)
            left -= tokens(line) + 1
            if left < 0:
                break
            kept[index] = line
        missing = 0 if only_marked else len(self.clean.nodes) - len(kept)
        more = [f"Not shown: {missing} more things."] if missing else []
        return "\n".join([*lines, *(kept[i] for i in sorted(kept)), *more])

    def _sentences(self) -> list[str]:
        known = self.measured
        measured = [f"Measured answer: {known.text}"] if known is not None and known.answer is not None else []
        return [*measured, *self.notes]

    def contradictions(self, question: str, answer: object, answer_type: str) -> list[str]:
        """Sentences that say where an answer contradicts what was measured.

        Args:
            answer: as in `questions.answer.Answer`, None for no answer.
        """
        if answer is None:
            return []
        known = self.measured
        if known is not None and known.answer is not None:
            differs = known.answer_type == answer_type and not same(known.answer, answer, answer_type)
            return [f"This contradicts what was measured: {known.text}"] if differs else []
        named = self._named(question)
        if answer_type == "number" and isinstance(answer, float) and _COUNT.search(question):
            return self._counted(question, answer, named)
        if answer == "no" and _EXISTS.search(question) and named and _only_names(question, named[0].label):
            return [f"But a {named[0].label} was measured there."]
        return []

    def _counted(self, question: str, answer: float, named: list[Node]) -> list[str]:
        """Contradictions of a count: with words that narrow it, only more things than there are contradict."""
        if not named or len({node.label for node in named}) != 1:
            return []
        there, label = len(named), named[0].label
        wrong = answer != there if _only_names(question, label) else answer > there
        name = label if there == 1 else plural(label)
        return [f"But {there} {name} {'was' if there == 1 else 'were'} measured there."] if wrong else []

    def _named(self, question: str) -> list[Node]:
        if self.clean is None:
            return []
        relevance = Relevance(self.clean, [question])
        return [node for i, node in enumerate(self.clean.nodes) if node.label and relevance.named(i)]


def _only_names(question: str, label: str) -> bool:
    """Whether a question names a label and says nothing that narrows it."""
    spoken = set(normalise(question)) | set(re.findall(r"[a-z]+", question.lower()))
    names = set(normalise(label)) | set(label.lower().split()) | set(plural(label).lower().split())
    return not spoken - names - _PLAIN_WORDS - set(normalise(" ".join(sorted(_PLAIN_WORDS))))


def _line(node: Node, numbers: Mapping[int, int]) -> str:
    """One thing: "#3: green armchair, 0.80 x 0.80 x 0.90 m, at (-2.20, 0.60, 0.45), on floor"."""
    size = " x ".join(f"{side:.2f}" for side in node.size)
    at = ", ".join(f"{place + 0.0:.2f}" for place in node.position)
    name = f"{node.color} {node.label or 'thing'}".strip()
    return f"{_handle(node.id, numbers)}: {name}, {size} m, at ({at}), on {_on(node, numbers)}"


def _on(node: Node, numbers: Mapping[int, int]) -> str:
    return str(node.support) if node.support in SHELL else _handle(node.support, numbers)


def _handle(node_id: NodeId, numbers: Mapping[int, int]) -> str:
    if not isinstance(node_id, int):
        return "a thing"  # the author's own name, which may say anything
    return f"#{numbers[node_id]}" if node_id in numbers else f"id {node_id}"


def same(one: object, other: object, answer_type: str) -> bool:
    """Whether two answers of a type mean the same: lengths within a fifth, labels and lists by their words."""
    if isinstance(one, float) and isinstance(other, float):
        tolerance = _SAME_LENGTH * max(abs(one), abs(other)) if answer_type == "metres" else 1e-6
        return abs(one - other) <= tolerance
    return key(one) == key(other)


def key(answer: object) -> object:
    """What answers in other words have in common: their normalised words."""
    if isinstance(answer, str):
        return normalise(answer)
    if isinstance(answer, tuple):
        return frozenset(key(one) for one in answer)
    return answer
