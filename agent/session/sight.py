"""Selection by sight: a vision model says which numbered groups a phrase means, and the field keeps the name.

It is asked only where the field's verdict is ambiguous, absent or unconfirmed, and at most twice for a
phrase, with at most three pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...gaussians.errors import BackendError
from ...gaussians.language.field.naming import joined, with_names
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.terms import is_name
from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.field.language_field import NamedBy
    from ...gaussians.language.query.selection import Selection
    from .vision_client import VisionClient

MOST_CANDIDATES = 60  # groups that get a number; more could not be told apart in three pictures
MOST_PIECES = 40
SURE = 0.5  # confidence from which what the model points at is taken


@dataclass(frozen=True, eq=False)
class Sighted:
    """What a vision model was asked about a phrase.

    Attributes:
        scene: the scene, whose field keeps the name if something was pointed at.
        query: the query for what was pointed at; None if nothing was.
        told: one sentence for the user: who was asked, with how many pictures, and what came of it.
    """

    scene: Scene
    query: Query | None
    told: str


def needs_sight(selection: Selection) -> bool:
    """Whether the field leaves open what a query means: ambiguous, absent, or not confirmed."""
    query = selection.query
    if (
        query.last
        or query.groups
        or query.invert
        or query.pick == "rest"
        or not (query.text or query.relations or query.colors)
    ):
        return False
    return selection.verdict != "found" and not query.confirmed


def point_out(scene: Scene, selection: Selection, viewer: Camera, vision: VisionClient) -> Sighted:
    """Ask which groups a query means that the field left open.

    A model that fails leaves the field's verdict as it was; `told` says why.
    """
    from ...planners.vision.pointing import PICTURES, point
    from .looker import SceneLooker

    query = selection.query
    groups = _candidates(scene, selection)
    if not groups:
        return Sighted(scene, None, "there is no group to point at")
    try:
        backend = vision.backend
        looker, purse = SceneLooker(scene, viewer), vision.purse(PICTURES)
        seen = point(_phrase(query), groups, looker, backend, purse, lambda found: _pieces(scene, found))
    except BackendError as error:
        return Sighted(scene, None, f"the vision model was no help: {error}")
    pictures = f"{len(seen.views)} picture{'s' if len(seen.views) != 1 else ''}"
    if not seen.groups or seen.confidence < SURE:
        doubt = "sees no such thing" if not seen.groups else "is not sure which thing it is"
        return Sighted(scene, None, f"{backend.name} {doubt} in {pictures}")
    if seen.part:
        return Sighted(scene, None, f"{backend.name} says that only a part of a group is meant; say which thing it is")
    shown, meant = named(scene, query, seen.groups, "sight")
    agreed = "confirmed by a second look" if seen.confirmed else "not confirmed by a second look"
    return Sighted(shown, meant, f"pointed out by {backend.name} in {pictures}, {agreed}")


def _candidates(scene: Scene, selection: Selection) -> tuple[int, ...]:
    """The groups in question: the candidates of an ambiguous query, else all things, the largest first; none where a
    candidate is not in the scene, as what an earlier step of the same plan inserts."""
    assert scene.language is not None
    table = scene.language.groups
    known = tuple(dict.fromkeys(c.group for c in selection.candidates if c.group >= 0))
    if selection.verdict == "ambiguous" and known:  # places that were found by their colour are no groups
        there = all(group < len(table) and table[group].count for group in known)
        return known[:MOST_CANDIDATES] if there else ()
    things = [g for g in scene.language.objects() if g.count]
    things.sort(key=lambda g: (-max(g.box.size), g.id))
    return tuple(g.id for g in things[:MOST_CANDIDATES])


def _pieces(scene: Scene, groups: Sequence[int]) -> tuple[int, ...]:
    """The parts of groups, the largest first; none of groups that are in one piece."""
    assert scene.language is not None
    table = scene.language.groups
    pieces = [table[i] for g in groups for i in scene.language.leaves(g) if table[i].level == "part" and table[i].count]
    return tuple(g.id for g in sorted(pieces, key=lambda g: (-g.count, g.id))[:MOST_PIECES])


def _phrase(query: Query) -> str:
    """The query in words, without what a single picture does not tell."""
    return query.model_copy(update={"also": (), "exclude": (), "grow": None}).describe()


def named(scene: Scene, query: Query, groups: tuple[int, ...], by: NamedBy) -> tuple[Scene, Query]:
    """The scene with the name of the query on what was pointed at, and the query that means it.

    Several groups are one thing in pieces if one thing is asked for, and several things otherwise.
    """
    kept = bare(query)
    if not is_name(query.text):
        return scene, kept.model_copy(update={"groups": groups})
    if query.pick in ("one", "any") and query.count in (None, 1):
        scene, whole = joined(scene, groups, query.text, by)
        return scene, kept.model_copy(update={"groups": (whole,)})
    return with_names(scene, dict.fromkeys(groups, query.text), by), kept.model_copy(update={"groups": groups})


def bare(query: Query) -> Query:
    """The query without what decided among candidates; its name and colours are kept for messages."""
    return Query(text=query.text, colors=query.colors, size=query.size, also=query.also, exclude=query.exclude,
                 grow=query.grow)  # fmt: skip
