"""Resolve a query to a selection in a scene, with one verdict.

The steps are set algebra, anchors, terms (`terms.py`) and choice (`picking.py`). Several matches are "ambiguous", none
is "absent", and a choice whose name, or the name of an anchor of it, is not confirmed is "unconfirmed". Every candidate
carries the score of each of its terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import torch

from ...camera import Camera
from ...errors import BackendError
from ...scene import Scene
from ...world import compounds, kinds, relations
from ...world.facing import Facing, facing_in
from ...world.relation_geometry import HOLDS, Stand, object_stand, viewer_stand
from ..encoders.probability import why_unknown
from ..field.group_index import GroupIndex, difference, index_groups, union
from ..field.language_field import Group, LanguageField
from ..field.measure import box_of
from . import owned, wholes
from .attributes import COLOR_HOLDS, color_scores
from .background import background
from .color.fallback import PARTS, by_color, by_hue, is_reliable
from .floaters import floaters
from .keeping import without_strays
from .moving import begins, moving_groups
from .owned import Whole
from .part_query import Piece, pieces_of
from .parts import NAMED
from .picking import by_distance, pick
from .query import ALL, BACKGROUND, FLOATERS, Query, Region, Relation
from .readings import is_known
from .reshape import reshaped
from .selection import Candidate, Selection, nothing
from .space import Inside, inside, mostly_in
from .terms import (
    LOOSE,
    ORDERING,
    STRUCTURE,
    Anchor,
    Scored,
    candidate_of,
    is_name,
    present_groups,
    related,
    scored,
)

if TYPE_CHECKING:
    from ..encoders import Encoder

_NAMED = 0.5  # probability of a name from which a thing is called so
_REST = "the rest of what? nothing was named before: say 'everything but the ...', or 'the background'"
_SPOTS = ("corner", "middle", "foreground")  # of a room, which no thing marks
_STACKED = 2  # how often a crop looks for what stands on what it keeps

__all__ = ["STRUCTURE", "Resolver", "resolve"]  # builders of scenes need the words for structure


def resolve(
    scene: Scene, query: Query, viewer: Camera, encoder: Encoder | None = None, last: Selection | None = None
) -> Selection:
    """The selection of `query` in `scene` as seen by `viewer`.

    Args:
        encoder: the encoder the scene was embedded with; needed only if the query names a kind of thing.
        last: the selection that "it" refers to.

    Raises:
        BackendError: the scene has no language field, or it was made with another encoder.
        UserError: a colour word is unknown.
    """
    return Resolver(scene, viewer, encoder, last).select(query)


class Unresolved(Exception):  # not an error: the verdict of an anchor is the result
    """An anchor could not be resolved; its selection is the result of the whole query."""

    def __init__(self, selection: Selection) -> None:
        super().__init__(selection.reason)
        self.selection = selection


@dataclass(frozen=True)
class Resolver:
    """Resolves any number of queries for one scene, viewer and encoder. See `resolve`."""

    scene: Scene
    viewer: Camera
    encoder: Encoder | None = None
    last: Selection | None = None
    bare: bool = False  # whether only groups are wanted: named selections then hold no ids

    @cached_property
    def field(self) -> LanguageField:
        if self.scene.language is None:
            raise BackendError("this scene has no language field yet; run `scenewright embed` or call embed() first")
        return self.scene.language

    @cached_property
    def stand(self) -> Stand:
        field = self.field
        return viewer_stand(self.viewer, self.scene.frame.up_vector, field.typical_size, field.middle)

    @cached_property
    def members(self) -> GroupIndex:
        return index_groups(self.scene.cloud)

    @cached_property
    def _anchors(self) -> dict[Relation, list[Anchor]]:
        """The anchors that were resolved before: a query needs those of a relation several times."""
        return {}

    @cached_property
    def _anchored(self) -> dict[Query, Selection]:
        return {}

    # -- from query to selection -----------------------------------------------------------------------------------

    def select(self, query: Query) -> Selection:
        """The selection of a query, with set algebra, growing and inversion."""
        found = self._combined(query)
        if found.chosen and (query.grow or query.invert):
            found = reshaped(self.scene, self.members, found, query)
        if found.verdict == "unconfirmed" and query.confirmed:
            return replace(found, verdict="found", reason=f"{found.reason}; confirmed")
        return found

    def _combined(self, query: Query) -> Selection:
        """The selection of a query with its set algebra, without growing and inversion."""
        outs = []
        for other in query.exclude:
            out = self.select(other.model_copy(update={"pick": "all"}) if other.pick == "one" else other)
            if not out.chosen and self._is_gone(other) and query.text not in ALL:
                continue  # "now both of the others", behind a deletion
            if not out.chosen:
                rest = other.last and query.text in ALL
                why = _REST if rest else f"cannot leave out what is not there: {out.reason}"
                return replace(out, query=query, reason=why)
            outs.append(out)
        unmeant = frozenset(g for out in outs for g in out.groups) if query.pick == "one" and not query.also else None
        own = self._own(query, unmeant or frozenset())
        if not own.chosen:
            return own
        pots = [] if self.bare or query.pick == "rest" else self._pots(query.text, own.groups)
        if pots and wholes.means_both(query.text):
            own = _joined(own, self._take(query, pots)).noting(f"with {wholes.named(pots)}")
        for other in query.also:
            more = self.select(other)
            if more.verdict == "absent" and _is_included(query, other):
                own = own.noting(f"no {other.text} of its own is there: what is seen of one is in the {query.text}")
                continue
            if not more.chosen:
                return replace(more, query=query)
            own = _doubted(_joined(own, more), more)
        for out in outs:
            if query.text in ALL and not _describes(query):  # what is kept alone takes no haze with it
                out = replace(out, ids=without_strays(self.scene, self.members, out)) if len(out) else out
            own = _doubted(_without(own, out), out)
        if (left := [pot for pot in pots if pot.group not in own.groups]) and not outs:
            own = own.noting(wholes.without(query.text, left))
        if not len(own) and not (self.bare and own.groups):
            return nothing(query, f"nothing is left of {query.describe()}", own.candidates)
        return own

    def _own(self, query: Query, out: frozenset[int]) -> Selection:
        """The selection of a query without its set algebra; groups in `out` are excluded."""
        if query.last:
            return self._last_selection(query)
        if query.groups:
            return self._explicit(query)
        if query.text in ALL and _describes(query):
            query = query.model_copy(update={"text": ""})  # "everything red": every thing that is red
        if query.text in ALL and query.region is not None:
            return self._in_region(query, query.region)
        if query.text in ALL:
            groups = tuple(g for g in present_groups(self.field, "all") if g.parent < 0)
            told = tuple(candidate_of(g) for g in groups)  # every_id includes Gaussians without a group
            return Selection(query, "found", self.members.every_id, tuple(g.id for g in groups), told)
        if query.text in FLOATERS and not query.colors:
            return self._floaters(query)
        if query.text in BACKGROUND and not self._is_named(query.text):
            return self._background(query)
        try:
            if query.region is not None:
                held = mostly_in(self.scene, self._inside(query.region).rows)
                out = out | {g.id for g in self.field.groups if g.id not in held}
            if query.moving is not None:
                moving = moving_groups(self.scene, self.members)
                if query.moving and not moving:
                    return nothing(query, "nothing moves in this scene")
                out = out | {g.id for g in self.field.groups if (g.id in moving) != query.moving}
            found = self.described(query, out)
            fronts = self._frames_told(query) if query.relations else ""
            for relation in query.relations if found.chosen else ():
                for anchor in self._anchor_selections(relation):
                    found = _doubted(found, anchor)
        except Unresolved as anchor:
            return self._wherever(query, out) or replace(anchor.selection, query=query)
        return found.noting(fronts)

    def _wherever(self, query: Query, out: frozenset[int]) -> Selection | None:
        """The selection without spots of the room, which no thing marks: "the lamp in the corner" is the only lamp;
        None if that is not one thing, or no such spot is named."""
        near = [r for r in query.relations if not _is_spot(r)]
        if len(near) == len(query.relations) or query.pick != "one" or not query.text:
            return None
        found = self._own(query.model_copy(update={"relations": tuple(near)}), out)
        if found.verdict != "found":
            return None
        return replace(found, query=query).noting("the only one; where in the room it stands was not checked")

    def described(self, query: Query, out: frozenset[int] = frozenset()) -> Selection:
        """The selection of a query by name, attributes and relations."""
        owner = next((r for r in query.relations if r.name == "part_of"), None)
        if owner is not None and is_name(query.text):
            return self._part(query, owner)
        whole = self._whole(query)
        ranks = [rank.without(out) for rank in self.readings(query)]
        rank = _first_matching(ranks)
        if whole is not None and whole.part in NAMED and whole.groups and not rank.matches():
            shaped = replace(self._part(*_by_shape(query, whole)), query=query)
            return _doubted(shaped, whole.found) if shaped.chosen else shaped
        if (
            query.colors
            and query.text not in STRUCTURE
            and (found := self._by_its_color(query, ranks, rank)) is not None
        ):
            return found
        if not rank.matches():
            if whole is not None and not rank.named:
                return self._absent_part(query, whole, rank)
            near = tuple(rank.candidate(i) for i in rank.nearest()[:3])
            return nothing(query, self._why_absent(query, near), near)
        found = self._picked(query, rank)
        return found if whole is None else _doubted(found, whole.found)

    def _picked(self, query: Query, rank: Scored) -> Selection:
        """What a query picks of the candidates that match it, of which there is one at least."""
        order = next((r for r in query.relations if r.name in ORDERING), None)
        if order is not None:
            near_what = [a.group for a in self.anchors(order)]
            choice = by_distance(query, rank, near_what, order.name == "nearest_to")
        else:
            choice = pick(query, rank, self.stand, lambda group: begins(self.scene, group.id))
        if choice.refusal is not None:
            return choice.refusal
        if query.pick == "rest":
            return _as_read(self._rest(query, rank, choice.chosen), rank, choice.chosen)
        return _as_read(self._take(query, tuple(rank.candidate(i) for i in choice.chosen)), rank, choice.chosen)

    def _pots(self, text: str, plants: Sequence[int]) -> list[Candidate]:
        """The pots in which groups stand that a phrase names as plants, where they are objects of their own."""
        up = self.scene.frame.up_vector
        found = [wholes.vessel_of(self.field, i, up) for i in plants] if wholes.names_plant(text) else []
        return [candidate_of(self.field.groups[i]) for i in dict.fromkeys(found) if i is not None and i not in plants]

    def _last_selection(self, query: Query) -> Selection:
        """The Gaussians of the last selection that still exist, for "it"."""
        there = self.members.present(self.last.ids) if self.last is not None else torch.zeros(0)
        if self.last is None or not len(there):
            return nothing(query, "there is nothing that 'it' could mean (any more); name the object")
        return replace(self.last, query=query, ids=there)

    def _is_gone(self, query: Query) -> bool:
        """Whether a query is "it", and what that means was deleted since: there is nothing left to leave out."""
        return query == Query(last=True) and self.last is not None and not len(self.members.present(self.last.ids))

    def _floaters(self, query: Query) -> Selection:
        """The Gaussians that lie apart from every surface."""
        cloud = self.scene.cloud
        found = floaters(cloud, query.strength)
        ids = self.members.ids_at(np.flatnonzero(found))
        if not len(ids):
            return nothing(query, "every Gaussian of this scene lies at some surface; there are no floaters")
        rows = torch.from_numpy(found).to(cloud.device)
        share = float(cloud.opacities[rows].sum() / cloud.opacities.sum())
        told = f"{len(ids):,} Gaussians that lie apart from every surface, {share:.1%} of all opacity"
        return Selection(query, "found", ids, (), (), told)

    def _is_named(self, text: str) -> bool:
        """Whether a thing of the scene is called so."""
        return any(g.label == text and g.label_score >= _NAMED for g in present_groups(self.field, "object"))

    def _background(self, query: Query) -> Selection:
        """Everything but the subject of the scene, or but what the background is said to be of."""
        if query.relations:
            anchors = tuple(a for relation in query.relations for a in relation.anchors)
            found = self.select(Query(text="everything", pick="all", exclude=anchors))
            return replace(found, query=query)
        return background(self.scene, self.members, query)

    def _in_region(self, query: Query, region: Region) -> Selection:
        """Every Gaussian of a part of space."""
        try:
            found = self._inside(region)
        except Unresolved as anchor:
            return replace(anchor.selection, query=query)
        ids = self.members.ids_at(np.flatnonzero(found.rows))
        if not len(ids):
            return nothing(query, f"nothing lies {region.describe()} ({found.told})")
        whole = mostly_in(self.scene, found.rows)
        groups = tuple(g.id for g in present_groups(self.field, "object") if g.id in whole and g.parent < 0)
        told = tuple(candidate_of(self.field.groups[i]) for i in groups)
        made = Selection(query, "found", ids, groups, told, f"{len(ids):,} Gaussians {region.describe()}: {found.told}")
        for of in region.of:
            made = _doubted(made, self._anchored_at(of))
        return made

    def _inside(self, region: Region) -> Inside:
        """The Gaussians in a region.

        Raises:
            Unresolved: one of its things is absent or ambiguous.
        """
        things = []
        for query in region.of:
            found = self._anchored_at(query)
            if not found.chosen:
                raise Unresolved(found)
            things.append(self.select(query))
        if region.name == "around" and region.distance is None:
            seen = {g for found in things for g in found.groups}
            for _ in range(_STACKED):
                on = tuple(Query(groups=(g,)) for g in sorted(seen) if self.field.groups[g].level == "object")[:16]
                more = [self._on(anchor) for anchor in on]
                fresh = [g for g in dict.fromkeys(g for found in more for g in found) if g not in seen]
                things += [self.select(Query(groups=(g,))) for g in fresh]
                seen |= set(fresh)
        return inside(self.scene, region, things, self.stand)

    def _on(self, anchor: Query) -> tuple[int, ...]:
        """Groups that stand on one group."""
        return self.select(Query(pick="all", relations=(Relation(name="on", anchors=(anchor,)),))).groups

    def _explicit(self, query: Query) -> Selection:
        known = {g.id: g for g in present_groups(self.field, "all")}
        lost = [i for i in query.groups if i not in known]
        if lost:
            return nothing(query, f"group {lost[0]} is not in this scene (any more)")
        return self._take(query, [candidate_of(known[i]) for i in query.groups])

    # -- terms ------------------------------------------------------------------------------------------------------

    def scored(self, query: Query) -> Scored:
        """The candidates of a query with their terms, without its set algebra, under the first reading that matches."""
        return _first_matching(self.readings(query))

    def readings(self, query: Query) -> list[Scored]:
        """The candidates of a query with their terms under each reading of its noun, the closest first."""
        whole = self._whole(query)
        placed = [
            (r, self.anchors(r))
            for r in query.relations
            if r.name not in ORDERING and (whole is None or r.name != "part_of")
        ]
        metres = self.scene.frame.metres_per_unit
        if whole is None:
            return list(scored(query, self.field, self.encoder, metres, placed))
        part, beside = query.model_copy(update={"text": whole.part}), owned.named_parts(self.field, whole)
        ranks = scored(part, self.field, self.encoder, metres, placed, beside)
        return [owned.restricted(rank, whole, self.field) for rank in ranks]

    def anchors(self, relation: Relation) -> list[Anchor]:
        """The anchors of a relation, each with its frame of reference.

        Raises:
            Unresolved: one of them is absent or ambiguous.
        """
        if relation not in self._anchors:
            self._anchors[relation] = self._found_anchors(relation)
        return self._anchors[relation]

    def _found_anchors(self, relation: Relation) -> list[Anchor]:
        groups: list[Group] = []
        for found in self._anchor_selections(relation):
            # A selection by colour alone may have no group.
            own = [self.field.groups[i] for i in found.groups]
            groups.extend(own or [self._stand_in(found.mask(self.scene.cloud))])
        if relations.named(relation.name).anchors == 2 and len(groups) < 2:
            raise Unresolved(nothing(relation.anchors[0], f"'{relation.name}' needs two things"))
        return [Anchor(g, self._stand_at(g, relation)) for g in groups]

    def _anchor_selections(self, relation: Relation) -> list[Selection]:
        """What the queries of a relation's anchors select; raises as `anchors`."""
        chosen = []
        for query in relation.anchors:  # "on the wall" means on any wall
            found = self._anchored_at(query)
            if found.verdict == "ambiguous" and relation.name in LOOSE and query.pick == "one":
                # The relation decides which of them is meant: "the lamp on the desk" where one of two holds a lamp.
                found = self._anchored_at(query.model_copy(update={"pick": "all"}))
            if not found.chosen:
                raise Unresolved(found)
            chosen.append(found)
        return chosen

    def _anchored_at(self, query: Query) -> Selection:
        if query not in self._anchored:
            self._anchored[query] = self._anchor_selection(query)
        return self._anchored[query]

    def _anchor_selection(self, query: Query) -> Selection:
        if query.text in STRUCTURE:
            query = query.model_copy(update={"pick": "all"})
        if query.last or query.exclude or query.also or query.grow or query.invert or query.pick == "rest":
            return self.select(query)  # what depends on the Gaussians
        return self._for_groups.select(query)

    @cached_property
    def _for_groups(self) -> Resolver:
        """This resolver for anchors, of which only the groups count: a large one takes milliseconds to list."""
        return self if self.bare else replace(self, bare=True)

    def _stand_at(self, group: Group, relation: Relation) -> Stand:
        """The frame of the viewer, or of the anchor if the relation is in its own frame and its front is known."""
        front = self.facing(group).front if relation.frame == "object" else None
        return self.stand if front is None else object_stand(group, front, self.stand)

    def facing(self, group: Group) -> Facing:
        """The direction that a group faces."""
        if group.id < 0:
            return Facing(None, "nothing")
        return facing_in(self.field, self.scene.cloud, self.members.rows(self.field.leaves(group.id)), group)

    def _frames_told(self, query: Query) -> str:
        """How the front of each anchor was determined, for relations in the frame of the anchor; "" without any."""
        told = []
        for relation in query.relations:
            if relation.frame == "object" and relations.named(relation.name).aim:
                for anchor in self.anchors(relation):
                    by, name = self.facing(anchor.group).by, relation.anchors[0].describe()
                    told.append({
                        "shape": f"the front of {name} is told by its shape",
                        "wall": f"the front of {name} is taken to be away from the wall it stands at",
                        "nothing": f"which way {name} faces cannot be told, so the side is as you see it",
                    }[by])  # fmt: skip
        return "; ".join(dict.fromkeys(told))

    # -- parts of things --------------------------------------------------------------------------------------------

    def _whole(self, query: Query) -> Whole | None:
        """The things of which a query names a part, by one name ("wardrobe door") or by a relation ("door of the
        wardrobe"); None if it names no part, or the encoder knows its name as that of a kind.

        Raises:
            Unresolved: the thing that a relation names is absent or ambiguous.
        """
        owner = next((r for r in query.relations if r.name == "part_of"), None)
        if owner is not None:
            if not compounds.is_part(query.text):
                return None
            groups = tuple(a.group for a in self.anchors(owner) if a.group.id >= 0)
            return Whole(owner.anchors[0].text, query.text, groups, self._anchored_at(owner.anchors[0]))
        named = compounds.split(query.text)
        if named is None or (self.encoder is not None and len(self.encoder.vocabulary.head(query.text)[0]) > 1):
            return None
        found = self._anchored_at(Query(text=named.whole, pick="all"))
        if named.place and not found.chosen:
            return None
        return Whole(named.whole, named.part, tuple(self.field.groups[i] for i in found.groups), found)

    def _belonging(self, query: Query) -> Selection | None:
        """The things that have the name of a part and belong to the thing that a relation names; None if none do."""
        if self.encoder is None or self._whole(query) is None:
            return None
        rank = _first_matching(self.readings(query))
        return self._picked(query, rank) if rank.matches() else None

    def _absent_part(self, query: Query, whole: Whole, rank: Scored) -> Selection:
        """That no such part is there: the thing itself, and what has the name of the part and belongs to others."""
        things = [candidate_of(g) for g in whole.groups[:2]]
        stray = rank.likely - whole.ids
        others = [rank.candidate(i) for i in rank.nearest() if rank.groups[i].id in stray][:2]
        near = (*things, *others)
        if not things:
            why = f"{query.describe()} is not in this scene, nor is any {whole.name}"
            return nothing(query, f"{why}; the nearest match is {near[0].describe()}" if near else why, near)
        why = f"{query.describe()} is not in this scene: no {whole.part} of {_listed(things)} is a thing of its own"
        theirs = f"{_listed(others)} {'are no parts' if len(others) > 1 else 'is no part'} of it"
        return nothing(query, f"{why}, and {theirs}" if others else why, near)

    def _part(self, query: Query, owner: Relation) -> Selection:
        """A named part of an object: pieces recognised by shape, else things of that name on the object."""
        anchors = [a.group.id for a in self.anchors(owner) if a.group.id >= 0]
        if wholes.names_vessel(query.text) and (pots := self._pots(owner.anchors[0].text, anchors)):
            return self._take(query, pots)
        if wholes.names_vessel(query.text) and wholes.names_plant(owner.anchors[0].text):
            below = [wholes.beneath(self.field, i, self.scene.frame.up_vector) for i in anchors]
            if places := [candidate_of(self.field.groups[i]) for i in dict.fromkeys(below) if i is not None]:
                why = f"{query.describe()} is told by its place alone, below the {owner.anchors[0].text}"
                return replace(self._take(query, places), verdict="unconfirmed", reason=why)
        made: list[Piece] = []
        refusals: list[str] = []
        for anchor in self.anchors(owner):
            group = anchor.group
            rows = self.members.rows(self.field.leaves(group.id)) if group.id >= 0 else np.zeros(0, np.int64)
            front = self.facing(group).front if len(rows) else None
            found, refusal = pieces_of(self.scene, rows, group, front, query.text)
            made += found
            refusals += [refusal] if refusal else []
        if not made:
            why = refusals[0] if refusals else "its shape is not known"
            found_there = self._belonging(query) or self._lying_on(query, owner)
            return found_there or nothing(query, f"{query.describe()}: {why}")
        kept = [piece for piece in made if self._fits(query, piece.group)]
        if not kept:
            return nothing(query, f"{query.describe()} is not there; the {query.text} is otherwise")
        rank = Scored(tuple(p.group for p in kept), {}, {}, np.ones(len(kept), bool))
        choice = pick(query, rank, self.stand)
        if choice.refusal is not None:
            return choice.refusal
        rows = np.unique(np.concatenate([kept[i].rows for i in choice.chosen]))
        told = tuple(rank.candidate(i) for i in choice.chosen)
        made_of = Selection(query, "found", self.members.ids_at(rows), (), told, "told by its shape")
        if not any(self._is_of_no_kind(a) for a in anchors):
            return made_of
        return replace(made_of, verdict="unconfirmed").noting(f"whether it has a {query.text} at all is not known")

    def _is_of_no_kind(self, group: int) -> bool:
        """Whether a group has a name that was given to it later, of a kind whose parts are not known."""
        known = self.field.groups[group]
        return bool(known.named_by) and kinds.find(known.label) is None

    def _fits(self, query: Query, piece: Group) -> bool:
        """Whether a piece has the colours of the query and satisfies its other relations."""
        lab = np.array(piece.lab)
        painted = all(float(color_scores(w, lab)) >= COLOR_HOLDS for w in query.colors)
        barred = any(float(color_scores(w, lab)) > COLOR_HOLDS for w in query.not_colors)
        others = tuple(r for r in query.relations if r.name != "part_of")
        return painted and not barred and self.stands(query.model_copy(update={"relations": others}), piece)

    def _lying_on(self, query: Query, owner: Relation) -> Selection | None:
        """Things of the name of the part that are on the object; None if the name is unknown or there are none."""
        if self.encoder is None or why_unknown(self.encoder, query.text) is not None:
            return None
        on = tuple(r.model_copy(update={"name": "on"}) if r is owner else r for r in query.relations)
        found = self.described(query.model_copy(update={"relations": on}))
        return replace(found, query=query) if found.verdict != "absent" else None

    def _by_its_color(self, query: Query, ranks: Sequence[Scored], rank: Scored) -> Selection | None:
        """The selection by colours where no confirmed name has them: by the hue of named things, then by colour alone,
        which a likely name with the colour precedes. None if colour does not resolve the query.

        Args:
            ranks: the readings of the query.
            rank: the first of them that matches, else the plain one.
        """

        def stands(rows: torch.Tensor) -> bool:
            return not query.relations or self.stands(query, self._stand_in(rows))

        parts, matched = query.text in PARTS, bool(rank.holds.any())
        if not parts and matched and rank.confirmed:
            return None
        found = by_hue(self.scene, self.field, query, stands, ranks[0].named)
        if found is None and (parts or not matched) and self._goes_by_color(query):
            found = by_color(self.scene, self.field, query, self.viewer, stands)
        return found

    # -- colour fallback -------------------------------------------------------------------------------------------

    def _goes_by_color(self, query: Query) -> bool:
        """Whether a query whose name matches nothing may be resolved by its colour alone.

        It may if the encoder is not reliable: for a word that it does not know, or a scene unlike its training data.
        Otherwise what it does not find is absent.
        """
        if not is_name(query.text) or self.encoder is None or not is_reliable(self.field):
            return True
        return self._why_unknown(query.text) is not None

    def _why_unknown(self, text: str) -> str | None:
        """Why a name can match nothing: neither the encoder nor a detector knows it; None if one does, or without an
        encoder."""
        if self.encoder is None or is_known(self.encoder, self.field, text):
            return None
        return why_unknown(self.encoder, text)

    def stands(self, query: Query, thing: Group) -> bool:
        """Whether a group outside the table satisfies every relation of the query."""
        return all(
            related(r, [thing], self.field, self.anchors(r))[0] >= HOLDS
            for r in query.relations
            if r.name not in ORDERING
        )

    def _stand_in(self, rows: torch.Tensor) -> Group:
        """A group outside the table for some Gaussians (mask or row indices), to evaluate relations on."""
        part = self.scene.cloud[rows]
        box = box_of(part, self.scene.frame)
        return Group(-1, "part", -1, "", 0.0, box, (0.0, 0.0, 0.0), len(part), 0, 0.0)

    # -- results ----------------------------------------------------------------------------------------------------

    def _why_absent(self, query: Query, near: Sequence[Candidate]) -> str:
        if is_name(query.text) and (why := self._why_unknown(query.text)):
            return f"{query.describe()}: {why}; describe it by colour or place, or load a larger encoder"
        if not near:
            return f"{query.describe()} is not in this scene, nor is anything that could be compared with it"
        return f"{query.describe()} is not in this scene; the nearest match is {near[0].describe()}"

    def _rest(self, query: Query, rank: Scored, chosen: Sequence[int]) -> Selection:
        """All Gaussians that do not belong to a match, including structure and those without a group."""
        matched = {rank.groups[i].id for i in chosen}
        kept = self.members.ids_but(leaf for g in matched for leaf in self.field.leaves(g))
        groups = tuple(g.id for g in present_groups(self.field, "all") if g.parent < 0 and g.id not in matched)
        told = tuple(rank.candidate(i) for i in chosen)
        return Selection(query, "found", kept, groups, told, f"everything but {len(matched)} thing(s)")

    def _take(self, query: Query, chosen: Sequence[Candidate]) -> Selection:
        groups = tuple(dict.fromkeys(c.group for c in chosen))
        ids = torch.zeros(0, dtype=torch.int64)
        if not self.bare:
            ids = self.members.ids_of(leaf for g in groups for leaf in self.field.leaves(g))
        return Selection(query, "found", ids, groups, tuple(chosen))


def _describes(query: Query) -> bool:
    """Whether a query restricts what it names by an attribute or a place."""
    return bool(query.colors or query.not_colors or query.size or query.relations)


def _is_included(query: Query, other: Query) -> bool:
    """Whether a query is for what the things of another hold anyway, if it is not told apart: the pot of a plant, or a
    part that is told by shape ("the lamp with its shade")."""
    owned = any(r.name == "part_of" and r.anchors[0].text == query.text for r in other.relations)
    potted = wholes.names_plant(query.text) and wholes.names_vessel(other.text)
    return owned and (potted or other.text in NAMED)


def _doubted(found: Selection, of: Selection) -> Selection:
    """`found`, unconfirmed if `of`, which it rests on, is unconfirmed."""
    if of.verdict != "unconfirmed":
        return found
    reasons = dict.fromkeys(r for r in (of.reason, found.reason) if r)
    return replace(found, verdict="unconfirmed", reason="; ".join(reasons))


def _first_matching(ranks: Sequence[Scored]) -> Scored:
    """The first of some readings under which something matches, else the plain one."""
    return next((rank for rank in ranks if rank.holds.any()), ranks[0])


def _as_read(found: Selection, rank: Scored, chosen: Sequence[int]) -> Selection:
    """A selection that says how its noun was read, unconfirmed if the name is only likely."""
    if rank.reading is None or not rank.reading.note:
        return found
    labels = " and ".join(dict.fromkeys(rank.groups[i].label for i in chosen))
    note = rank.reading.note.format(label=labels)
    reason = "; ".join(r for r in (note, found.reason) if r)
    return replace(found, verdict="found" if rank.reading.confirmed else "unconfirmed", reason=reason)


def _joined(a: Selection, b: Selection) -> Selection:
    return replace(a, ids=union(a.ids, b.ids), groups=tuple(dict.fromkeys((*a.groups, *b.groups))),
                   candidates=(*a.candidates, *b.candidates))  # fmt: skip


def _without(a: Selection, b: Selection) -> Selection:
    return replace(a, ids=difference(a.ids, b.ids), groups=tuple(g for g in a.groups if g not in b.groups),
                   candidates=tuple(c for c in a.candidates if c.group not in b.groups))  # fmt: skip


def _by_shape(query: Query, whole: Whole) -> tuple[Query, Relation]:
    """A query for a part by one name as that for a part of the things, and the relation to them: "chair leg"."""
    owner = Relation(name="part_of", anchors=(Query(text=whole.name, pick="all"),))
    return query.model_copy(update={"text": whole.part, "relations": (*query.relations, owner)}), owner


def _listed(things: Sequence[Candidate]) -> str:
    return " and ".join(f"the {t.describe()}" for t in things)


def _is_spot(relation: Relation) -> bool:
    """Whether a relation only says that something is at a spot of the room, and not of a thing in it."""
    spots = (a.text in _SPOTS and not a.relations and not a.colors for a in relation.anchors)
    return relation.name in ("inside", "on", "next_to") and all(spots)
