"""`Thing`: one thing of a scene as questions see it; and what a phrase of a question means."""

from __future__ import annotations

from dataclasses import dataclass

from ...gaussians.language.field.language_field import Group
from ...gaussians.language.query.query import Query
from ...gaussians.world.box import distance
from ..rooms.graph_scene import Id
from ..rooms.node import Node


@dataclass(frozen=True, eq=False)
class Thing:
    """One thing of a survey, or the floor, a wall or the ceiling.

    Attributes:
        id: its id in the scene graph; "floor", "wall" or "ceiling" for those without a node.
        row: its row on the stage.
        label: what it is, "" if nobody could tell.
        node: its node; None for a floor, wall or ceiling without one.
        group: its row of the stage's table, with its box.
    """

    id: Id
    row: int
    label: str
    node: Node | None
    group: Group

    @property
    def color(self) -> str:
        """Name of its main colour, "" if unknown."""
        return self.node.color if self.node is not None else ""

    @property
    def name(self) -> str:
        """Its label, or "unnamed thing"."""
        return self.label or "unnamed thing"


@dataclass(frozen=True)
class Found:
    """What a query means in a survey.

    Attributes:
        verdict: "found", "ambiguous" or "absent".
        things: what was found, or the candidates of an ambiguous query; none if it is absent.
        near: of an absent query the nearest things.
        reason: one sentence for a person.
        about: the phrase within the query that is absent or ambiguous; None: the query itself.
    """

    verdict: str
    things: tuple[Thing, ...]
    near: tuple[Thing, ...] = ()
    reason: str = ""
    about: Query | None = None


class NotResolved(Exception):  # not an error: asking.py tells it as an answer
    """A phrase of a question is absent or ambiguous; `found` says which, `query` is the phrase."""

    def __init__(self, query: Query, found: Found) -> None:
        super().__init__(found.reason)
        self.query, self.found = found.about or query, found


def gap(a: Thing, b: Thing) -> float:
    """Metres between the surfaces of two boxes; 0 where they touch."""
    return max(distance(a.group.box, b.group.box), 0.0)
