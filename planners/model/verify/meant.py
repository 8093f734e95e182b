"""Which things of a scene the noun phrases of an instruction mean, and whether a step may be about others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from ...rooms.graph_scene import Id
from ...rooms.label_encoder import THRESHOLD, agreement
from .rehearsal import Rehearsal
from .said import Phrase


class Meant:
    """The things that noun phrases mean.

    Args:
        scene: with sanitised names.
        phrases: of the instruction.
        refers: whether a pronoun stands for a thing as well.
    """

    def __init__(self, scene: Rehearsal, phrases: Sequence[Phrase], refers: bool) -> None:
        self._scene, self._refers = scene, refers
        self._found = [
            (phrase, [frozenset(ids) for query in phrase.readings if (ids := scene.by_query(query))])
            for phrase in phrases
        ]

    @cached_property
    def called(self) -> frozenset[Id]:
        """Nodes whose names are those of a phrase, and nodes that a phrase means."""
        nodes = [n for n in self._scene.graph.nodes if n.label]
        labels = [n.label for n in nodes]
        found = {i for _, meant in self._found for group in meant for i in group}
        for phrase, _ in self._found:
            found |= {n.id for n, p in zip(nodes, agreement(phrase.noun, labels), strict=True) if p >= THRESHOLD}
        return frozenset(found)

    def may_be(self, ids: set[Id], placed: bool) -> bool:
        """Whether things are those that phrases with their names mean; also where such a phrase is not clear.

        Args:
            placed: whether they are what something is put at, so that phrases behind a preposition count as well.
        """
        labels = [n.label for n in self._scene.graph.nodes if n.id in ids and n.label]
        clear = [(phrase, meant) for phrase, meant in self._found if placed or not phrase.placed]
        named = [
            (phrase, meant) for phrase, meant in clear if _names(phrase, labels) or any(ids & group for group in meant)
        ]
        if named:
            groups = [group for _, meant in named for group in meant]
            return not all(meant for _, meant in named) or ids == set().union(*(g for g in groups if g <= ids))
        told = any(_names(phrase, labels) for phrase, _ in self._found)
        return told or placed or self._refers or not clear or not all(meant for _, meant in clear)


def _names(phrase: Phrase, labels: Sequence[str]) -> bool:
    return max(agreement(phrase.noun, labels), default=0.0) >= THRESHOLD
