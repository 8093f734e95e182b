"""Offers for a thing that is not found by its name: what the views show, numbered, so that a person can say which of
it is meant.

A capture holds things that the encoder cannot name. A person who reads the numbers in a picture can; the field then
keeps the name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...gaussians.errors import AbsentError
from ...gaussians.language.encoders.probability import why_unknown
from ...gaussians.language.field.apart import set_apart
from ...gaussians.language.query.attributes import COLOR_HOLDS, color_scores
from ...gaussians.language.query.color.fallback import PARTS, is_reliable
from ...gaussians.language.query.palette import palette
from ...gaussians.language.query.portions import rows_of, rows_of_candidates
from ...gaussians.language.query.query import ALL, BACKGROUND, FLOATERS
from ...gaussians.language.query.terms import STRUCTURE, candidate_of, is_name
from ...gaussians.viewpoints.visibility import GroupPixels
from .sight import bare, named

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...gaussians.camera import Camera
    from ...gaussians.errors import ScenewrightError
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.field.language_field import Group, LanguageField
    from ...gaussians.language.query.query import Query
    from ...gaussians.language.query.selection import Candidate, Selection
    from ...gaussians.scene import Scene
    from .clarify import Question

MOST = 36  # things that get a number
PARTS_PAGE = 1000  # the page from which parts are offered, however many pages of things there are
HINT = "or a portion: 'the red part of 2', '3 without the wall', 'pieces of 3'"
_VIEWS = 5  # of the scene's cameras that are looked through beside the viewer's
_ELSEWHERE = 0.4  # what a share of another view's picture counts against one of the viewer's
_TRACE, _MINOR = 0.08, 0.5  # shares of Gaussians between which the colour that was said tells a part of what was chosen
_SMALLEST = 0.0005  # share of a picture from which a thing is worth a number


def offered(
    scene: Scene,
    selection: Selection,
    viewer: Camera,
    encoder: Encoder | None,
    resolve: Callable[[Query], Selection],
    *,
    page: int = 0,
) -> Selection | None:
    """An absent selection with the things that may be meant as its candidates, those of its colours first, then by how
    much of the views they fill; None where its name is known, names are reliable and there are several things, so that
    it is not there.

    Args:
        resolve: selects the owner of a part in the same scene.
        page: how often nothing was meant of what was offered: the less visible things follow, and then parts of things.
    """
    field, query = scene.language, selection.query
    if field is None or not _is_open(query):
        return None
    if not (_unknown(query, encoder) or not is_reliable(field) or _is_alone(field)):
        return None
    whole, parts = _pool(field, query, resolve)
    ranked = _ranked(scene, query, whole, viewer)
    pages = -(-len(ranked) // MOST)
    page = page if page < PARTS_PAGE else pages + page - PARTS_PAGE
    if page >= pages:
        ranked, page = _ranked(scene, query, parts, viewer), page - pages
    found = ranked[page * MOST : (page + 1) * MOST]
    if not found:
        return None
    kind = "parts" if found[0].group not in {g.id for g in whole} else "things"
    told = f"if it is among the {len(found)} numbered {kind}, say its number, or several, {HINT}"
    return replace(selection, candidates=tuple(found)).noting(
        told + ("; 'none' for others, '3 and more' to keep 3 and see others" if len(found) == MOST else "")
    )


def offers_of(
    asked: Question, scene: Scene, groups: Sequence[int], viewer: Camera
) -> tuple[ScenewrightError, Question]:
    """A question that offers some groups, the most visible first, and the error that says so."""
    assert scene.language is not None
    field, query = scene.language, asked.selection.query
    shown = _ranked(scene, query.model_copy(update={"colors": ()}), [field.groups[g] for g in groups], viewer)
    hidden = [candidate_of(field.groups[g]) for g in groups if g not in {c.group for c in shown}]
    found = (*shown, *hidden)[:MOST]
    told = f"nothing was changed; {query.describe()}: it is in {len(found)} numbered pieces now; say which, {HINT}"
    selection = replace(asked.selection, verdict="absent", candidates=found, ids=asked.selection.ids[:0], groups=())
    selection = replace(selection, reason=told)
    return AbsentError(told), replace(asked, selection=selection, offered=True)


def _ranked(scene: Scene, query: Query, groups: Sequence[Group], viewer: Camera) -> list[Candidate]:
    """Groups that the views show, those of the query's colours first, then by how much of the views they fill."""
    if not groups:
        return []
    weight, colored = _seen(scene, [g.id for g in groups], viewer), _colored(query, groups)
    shown = [i for i in range(len(groups)) if weight[i] >= _SMALLEST]
    shown.sort(key=lambda i: (-int(colored[i]), -weight[i], groups[i].id))
    return [candidate_of(groups[i], round(float(weight[i]), 4)) for i in shown]


def _is_open(query: Query) -> bool:
    """Whether a query is for things by a name or an attribute, and not by ids or for parts of space."""
    fixed = query.last or query.groups or query.invert or query.pick == "rest" or query.region is not None
    return not fixed and query.text not in ALL | BACKGROUND | FLOATERS and bool(query.text or query.colors)


def _is_alone(field: LanguageField) -> bool:
    """Whether a scene is one thing, so that what is named is a part of it."""
    return sum(bool(g.count) for g in field.objects()) == 1


def _unknown(query: Query, encoder: Encoder | None) -> bool:
    return encoder is not None and is_name(query.text) and why_unknown(encoder, query.text) is not None


def _pool(field: LanguageField, query: Query, resolve: Callable[[Query], Selection]) -> tuple[list[Group], list[Group]]:
    """The things that may be meant, and the parts: of an owner that is named and found only its parts; floor and walls
    if the query asks for them; of an only thing only its parts."""
    owner = next((r for r in query.relations if r.name == "part_of"), None)
    if owner is not None:
        found = resolve(owner.anchors[0])
        if found.verdict == "found" and (parts := _parts(field, found.groups)):
            return [], parts
    things = [g for g in field.objects() if g.count]
    parts = _parts(field, [g.id for g in things])
    if len(things) == 1 and parts:
        return [], parts
    if query.text in STRUCTURE:
        things += [g for g in field.groups if g.level == "structure" and g.count]
    return things, parts


def _parts(field: LanguageField, groups: Sequence[int]) -> list[Group]:
    leaves = [field.groups[i] for g in groups for i in field.leaves(g)]
    return [g for g in leaves if g.level == "part" and g.count]


def _seen(scene: Scene, groups: Sequence[int], viewer: Camera) -> NDArray[np.float64]:
    """How much each group fills the viewer's picture or, counted less, that of another camera of the scene `[G]`."""
    assert scene.language is not None
    step = max(1, len(scene.cameras) // _VIEWS)
    others = scene.cameras[::step][:_VIEWS]
    pixels = GroupPixels(scene, groups)
    weight = pixels.shares(viewer)
    for camera in others:
        weight = np.maximum(weight, _ELSEWHERE * pixels.shares(camera))
    return weight


def _colored(query: Query, groups: Sequence[Group]) -> NDArray[np.bool_]:
    """Whether each group has every colour of the query `[G]`; all have where it names none."""
    lab = np.array([g.lab for g in groups])
    scores = [color_scores(word, lab) >= COLOR_HOLDS for word in query.colors]
    return np.logical_and.reduce(scores) if scores else np.ones(len(groups), dtype=bool)


def chosen(scene: Scene, query: Query, candidates: Sequence[Candidate], places: Sequence[int]) -> tuple[Scene, Query]:
    """What a person chose by numbers: the scene, whose field keeps the name for it, and the query that means it.

    A part keeps its place in its object and gets no name. Where the query says a colour that is not the main one of
    what was chosen, only what has it is meant.
    """
    field, groups = _field(scene), tuple(candidates[i].group for i in places)
    if any(candidates[i].ids is not None for i in places):
        own = rows_of_candidates(scene, [candidates[i] for i in places])
        scene, group = set_apart(scene, own, query.text if is_name(query.text) else "", "user")
        return scene, bare(query).model_copy(update={"groups": (group,), "confirmed": True})
    if query.colors and (rows := _minor_color(scene, groups, query)) is not None:
        part = all(field.groups[g].level == "part" for g in groups)
        scene, group = set_apart(scene, rows, "" if part or not is_name(query.text) else query.text, "user", part=part)
        return scene, bare(query).model_copy(update={"groups": (group,)})
    if any(field.groups[g].level != "object" for g in groups):
        return scene, bare(query).model_copy(update={"groups": groups})
    return named(scene, query, groups, "user")


def _minor_color(scene: Scene, groups: Sequence[int], query: Query) -> NDArray[np.int64] | None:
    """The rows of some groups that have the colours of a query, where most of the groups is of others: the red frame of
    a bicycle that is one group with the wall. None where the colours are the main ones, or are not there."""
    if query.not_colors or is_reliable(_field(scene)) or query.text in PARTS:
        return None
    found = palette(scene, rows_of(scene, groups))
    rows, near = found.of(query.colors), sum(float(found.shares[found.of_hue(w)].sum()) for w in query.colors)
    share = len(rows) / len(found.rows)
    return rows if _TRACE <= share <= _MINOR and near <= _MINOR else None


def _field(scene: Scene) -> LanguageField:
    assert scene.language is not None
    return scene.language
