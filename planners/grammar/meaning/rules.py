"""What all rules for commands share: the nouns of a clause, and what is there already.

Knows how a clause names its target. Refuses to know any verb: which rule does what is in commands.py, moving.py,
shaping.py and adding.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ....gaussians.language.query.query import Query
from ..nodes import Node, Refusal, tokens, trees
from .changes import Fields
from .described import Noun, union
from .phrases import Phrases

MOTIONS = ("direction", "distance", "nudge", "toward", "to", "spot", "times")
_SIDES = {"left": "leftmost", "right": "rightmost", "forward": "farthest", "backward": "nearest", "up": "highest",
          "down": "lowest"}  # fmt: skip


class Rules:
    """The rules of one instruction: what its words refer to, and what was done before."""

    def __init__(self, antecedent: str = "", before: Sequence[Fields] = (), colors: tuple[str, ...] = ()) -> None:
        self.phrases = Phrases(antecedent, colors)
        self.before = list(before)  # operations of the clause before, for "do the same to the lamp"

    def _nouns(self, node: Node, index: int = 0) -> list[Noun]:
        """The nouns of a clause; a direction behind them ("the chair to the left") is a side of the last one."""
        found = self.phrases.targets(trees(node, "targets")[index])
        if (side := tokens(node, "DIR")) and str(node.data) in ("delete", "select", "isolate", "hide"):
            query = found[-1].query
            if query.pick not in ("one", "any"):
                raise Refusal("a side picks one thing; say which one", side[0].text)
            found[-1] = replace(found[-1], query=query.model_copy(update={"pick": _SIDES[side[0].value]}))
        return found

    def _query(self, node: Node, index: int = 0) -> Query:
        return known(self._nouns(node, index))

    def _targeted(self, node: Node, op: str, **fields: Any) -> list[Fields]:
        return [{"op": op, "target": self._query(node), **fields}]


def known(found: Sequence[Noun]) -> Query:
    """The query for things that are there already; "some chairs" does not say which."""
    if any(n.article == "indef" and n.plural and n.number is None for n in found):
        raise Refusal("say which, or how many", "some")
    return union(found)
