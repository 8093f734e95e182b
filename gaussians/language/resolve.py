"""From a query to a selection: text, measured attributes and geometry as separate terms, and one verdict.

Knows the language field and the query. Refuses to guess: several matches are "ambiguous", none is "absent", and every
candidate carries the score of each of its terms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import torch

from ..camera import Camera
from ..cloud import NO_GROUP
from ..color import name_of
from ..errors import BackendError
from ..scene import Scene
from . import attributes, relations
from .calibration import doubt, probability
from .colored import PARTS, by_color
from .field import Group, LanguageField
from .measure import box_of
from .query import Query, Relation
from .selection import Candidate, Selection, Verdict, nothing

if TYPE_CHECKING:
    from .encoders import Encoder

ANYTHING = frozenset({"", "thing", "object", "item", "one", "stuff", "furniture"})
ALL = frozenset({"everything", "all", "scene", "room", "whole scene"})
STRUCTURE = {
    "floor": "floor", "ground": "floor", "terrain": "floor", "soil": "floor", "grass": "floor", "carpeting": "floor",
    "wall": "wall", "ceiling": "ceiling",
}  # fmt: skip
FLOATERS = frozenset({"floater", "noise", "floating bit", "stray"})
NAMED = 0.25  # a label less probable than this is not worth telling
CLEAR_LEAD = 0.55  # the second best match is a rival when it scores at least this share of the best


def resolve(
    scene: Scene, query: Query, viewer: Camera, encoder: Encoder | None = None, last: Selection | None = None
) -> Selection:
    """What `query` means in `scene` for someone at `viewer`.

    Args:
        encoder: the encoder the scene was embedded with; needed only where the query names a kind of thing.
        last: the selection that "it" refers to.

    Raises:
        BackendError: the scene has no language field, or it was made with another encoder.
        UserError: a colour word is unknown.
    """
    return _Resolver(scene, viewer, encoder, last).select(query)


@dataclass(frozen=True)
class _Resolver:
    scene: Scene
    viewer: Camera
    encoder: Encoder | None
    last: Selection | None

    @cached_property
    def field(self) -> LanguageField:
        if self.scene.language is None:
            raise BackendError("this scene has no language field yet; run `scenewright embed` or call embed() first")
        return self.scene.language

    @cached_property
    def scale(self) -> float:
        """A typical object size: the median of the objects' largest extents, scene units."""
        sizes = [max(g.box.size) for g in self.field.objects() if g.count]
        return float(np.median(sizes)) if sizes else 1.0

    @cached_property
    def stand(self) -> relations.Stand:
        return relations.viewer_stand(self.viewer, self.scene.frame.up_vector, self.scale)

    # -- the line from query to selection ---------------------------------------------------------------------------

    def select(self, query: Query) -> Selection:
        own = self._own(query)
        if own.verdict != "found":
            return own
        for other in query.also:
            more = self.select(other)
            if more.verdict != "found":
                return replace(more, query=query)
            own = _union(own, more)
        for other in query.exclude:
            out = self.select(other.model_copy(update={"pick": "all"}) if other.pick == "one" else other)
            if out.verdict != "found":
                return replace(out, query=query, reason=f"cannot leave out what is not there: {out.reason}")
            own = _difference(own, out)
        if not len(own):
            return nothing(query, f"nothing is left of {query.describe()}", own.candidates)
        return own

    def _own(self, query: Query) -> Selection:
        """The query without its set algebra."""
        if query.last:
            there = self.last.ids[torch.isin(self.last.ids, self.scene.cloud.ids)] if self.last else torch.zeros(0)
            if self.last is None or not len(there):
                return nothing(query, "there is nothing that 'it' could mean (any more); name the object")
            return replace(self.last, query=query, verdict="found", ids=there)
        if query.groups:
            return self._explicit(query)
        if query.text in ALL and not query.colors:
            whole = self._take(query, [_candidate(g, {}) for g in self._alive("all") if g.parent < 0])
            return replace(whole, ids=self.scene.cloud.ids.sort().values)  # with what belongs to no group
        if query.text in FLOATERS and not query.colors:
            return self._floaters(query)
        ranked = self._rank(query)
        anchors_problem = next((r for r in ranked if isinstance(r, Selection)), None)
        if anchors_problem is not None:
            return replace(anchors_problem, query=query)
        candidates = [r for r in ranked if isinstance(r, Candidate)]
        matches = [c for c in candidates if self._holds(c)]
        if query.colors and query.text not in STRUCTURE and (query.text in PARTS or not matches):

            def stands(rows: torch.Tensor) -> bool:
                return not query.relations or self._stands(query, self._stand_in(rows))

            if (found := by_color(self.scene, self.field, query, stands)) is not None:
                return found
        if not matches:
            return nothing(query, self._why_absent(query, candidates), tuple(candidates[:3]))
        return self._pick(query, matches)

    def _floaters(self, query: Query) -> Selection:
        """What belongs to no group: haze and strays off every surface."""
        ids = self.scene.cloud.ids[self.scene.cloud.group == NO_GROUP].sort().values
        if not len(ids):
            return nothing(query, "every Gaussian of this scene belongs to something; there are no floaters")
        return Selection(query, "found", ids, (), (), f"{len(ids)} Gaussians that belong to no group")

    def _explicit(self, query: Query) -> Selection:
        known = {g.id: g for g in self._alive("all")}
        lost = [i for i in query.groups if i not in known]
        if lost:
            return nothing(query, f"group {lost[0]} is not in this scene (any more)")
        return self._take(query, [_candidate(known[i], {}) for i in query.groups])

    # -- terms ------------------------------------------------------------------------------------------------------

    def _rank(self, query: Query) -> list[Candidate] | list[Selection]:
        """Candidates with their terms, best first; or the failed selection of a relation's anchor."""
        groups = self._pool(query)
        scores: list[dict[str, float]] = [{} for _ in groups]
        for terms, value in zip(scores, self._text_term(query.text, groups), strict=True):
            if value is not None:
                terms["text"] = value
        for word in query.colors:
            for terms, g in zip(scores, groups, strict=True):
                terms[f"color {word}"] = attributes.group_color_score(self.field, g, word)
        for word in query.not_colors:
            for terms, g in zip(scores, groups, strict=True):
                terms[f"not {word}"] = 1 - attributes.group_color_score(self.field, g, word)
        for relation in query.relations:
            if relation.name in ("nearest_to", "farthest_from"):
                continue  # these order matches, see _pick
            found = self._anchors(relation)
            if isinstance(found, Selection):
                return [found]
            for terms, g in zip(scores, groups, strict=True):
                terms[relation.name] = self._relation_term(relation, g, found)
        if query.size is not None:
            fit = [i for i, t in enumerate(scores) if all(self._term_holds(k, v) for k, v in t.items())]
            sized = attributes.size_scores([groups[i] for i in fit], query.size)
            for i, value in zip(fit, sized, strict=True):
                scores[i][query.size] = value
        candidates = [_candidate(g, terms) for g, terms in zip(groups, scores, strict=True)]
        return sorted(candidates, key=lambda c: (-c.score, c.group))

    def _pool(self, query: Query) -> list[Group]:
        if query.text in PARTS:
            return [g for g in self._alive("parts")]
        if query.text in STRUCTURE:
            return [g for g in self._alive("structure") if g.label == STRUCTURE[query.text]]
        return self._alive("object")

    def _alive(self, level: str) -> list[Group]:
        """Groups that still have Gaussians: objects, structure, the leaves of the objects ("parts"), or all."""
        rows = [g for g in self.field.groups if g.count > 0]
        if level == "all":
            return rows
        if level == "parts":
            split = {g.parent for g in rows if g.parent >= 0}
            return [g for g in rows if g.level != "structure" and g.id not in split]
        return [g for g in rows if g.level == level]

    def _text_term(self, text: str, groups: Sequence[Group]) -> Iterable[float | None]:
        if text in ANYTHING or text in PARTS:
            return [None] * len(groups)
        if text in STRUCTURE or not groups:
            return [1.0] * len(groups)
        if self.encoder is None:
            raise BackendError(f"finding {text!r} needs a text encoder; pass encoder='auto'")
        self.field.require_encoder(self.encoder.fingerprint)
        vectors = self.field.embeddings[[g.id for g in groups]]
        metres = self.scene.frame.metres_per_unit
        sizes = np.array([g.box.size for g in groups]) * metres if metres is not None else None
        return [float(p) for p in probability(self.encoder, text, vectors, sizes)]

    def _anchors(self, relation: Relation) -> list[Group] | Selection:
        anchors: list[Group] = []
        for query in relation.anchors:
            found = self.select(query)
            if found.verdict != "found":
                return found
            rows = found.mask(self.scene.cloud)  # found by colour alone, it has no group
            anchors.extend([self.field.groups[i] for i in found.groups] or [self._stand_in(rows)])
        if relation.name == "between" and len(anchors) < 2:
            return nothing(relation.anchors[0], "'between' needs two things")
        return anchors

    def _relation_term(self, relation: Relation, group: Group, anchors: Sequence[Group]) -> float:
        if group in anchors:
            return 0.0
        if relation.name == "between":
            return relations.score("between", group, anchors, self.stand)
        if relation.name == "part_of":
            return float(any(group.parent == a.id >= 0 for a in anchors))
        best = 0.0
        for anchor in anchors:
            stand = self.stand if relation.frame == "viewer" else relations.object_stand(anchor, self.stand)
            best = max(best, relations.score(relation.name, group, [anchor], stand))
        return best

    def _holds(self, candidate: Candidate) -> bool:
        return all(self._term_holds(name, value) for name, value in candidate.terms.items())

    def _term_holds(self, name: str, value: float) -> bool:
        if name == "text":
            return value >= self._text_threshold
        if name.startswith(("color ", "not ")):
            return value >= (attributes.COLOR_HOLDS if name.startswith("color ") else 1 - attributes.COLOR_HOLDS)
        return value >= relations.HOLDS

    @cached_property
    def _text_threshold(self) -> float:
        return self.encoder.calibration.threshold if self.encoder is not None else 0.5

    # -- choosing among matches -------------------------------------------------------------------------------------

    def _pick(self, query: Query, matches: list[Candidate]) -> Selection:
        for relation in query.relations:
            if relation.name in ("nearest_to", "farthest_from"):
                anchors = self._anchors(relation)
                if isinstance(anchors, Selection):
                    return replace(anchors, query=query)
                ordered = sorted(matches, key=lambda c: self._gap(c, anchors))
                others = [c for c in ordered if self.field.groups[c.group] not in anchors]
                return self._take(query, others[:1] if relation.name == "nearest_to" else others[-1:])
        if query.pick == "rest":
            return self._rest(query, matches)
        if query.pick == "all":
            return self._counted(query, matches)
        if query.pick == "any":
            return self._take(query, matches[:1])
        if query.pick == "one":
            return self._only_one(query, matches)
        return self._ordered(query, matches)

    def _only_one(self, query: Query, matches: list[Candidate]) -> Selection:
        rivals = [c for c in matches if c.score >= CLEAR_LEAD * matches[0].score]
        if len(rivals) == 1:
            return self._take(query, rivals)
        listed = ", ".join(c.describe() for c in rivals[:6])
        reason = f"{query.describe()}: {len(rivals)} things match ({listed}); say which one, or 'all'"
        return replace(nothing(query, reason, tuple(rivals)), verdict="ambiguous")

    def _counted(self, query: Query, matches: list[Candidate]) -> Selection:
        if query.count is not None and query.count != len(matches):
            listed = ", ".join(c.describe() for c in matches[:6])
            reason = f"{query.describe()}: {query.count} were asked for, {len(matches)} match ({listed})"
            verdict: Verdict = "ambiguous" if len(matches) > query.count else "absent"
            return replace(nothing(query, reason, tuple(matches)), verdict=verdict)
        return self._take(query, matches)

    def _ordered(self, query: Query, matches: list[Candidate]) -> Selection:
        """Superlatives, and the n-th from the viewer's left."""
        keys: dict[str, Callable[[Candidate], float]] = {
            "largest": lambda c: -attributes.extent(self.field.groups[c.group], "large"),
            "smallest": lambda c: attributes.extent(self.field.groups[c.group], "large"),
            "tallest": lambda c: -c.size[2],
            "shortest": lambda c: c.size[2],
            "nearest": self._from_eye,
            "farthest": lambda c: -self._from_eye(c),
            "leftmost": lambda c: self._rightward(c),
            "rightmost": lambda c: -self._rightward(c),
            "highest": lambda c: -self._height(c),
            "lowest": self._height,
            "nth": lambda c: self._rightward(c),
        }
        ordered = sorted(matches, key=lambda c: (keys[query.pick](c), c.group))
        place = (query.ordinal or 1) - 1 if query.pick == "nth" else 0
        if place >= len(ordered):
            return nothing(query, f"{query.describe()}: there are only {len(ordered)}", tuple(ordered))
        return self._take(query, [ordered[place]])

    def _rightward(self, candidate: Candidate) -> float:
        return float(np.array(candidate.center) @ self.stand.right)

    def _height(self, candidate: Candidate) -> float:
        return float(np.array(candidate.center) @ self.stand.up)

    def _from_eye(self, candidate: Candidate) -> float:
        return float(np.linalg.norm(np.array(candidate.center) - self.stand.eye))

    def _gap(self, candidate: Candidate, anchors: Sequence[Group]) -> float:
        return min(relations.distance(self.field.groups[candidate.group], a) for a in anchors)

    def _rest(self, query: Query, matches: list[Candidate]) -> Selection:
        """Every Gaussian that does not belong to a match, floor and walls and unassigned ones included."""
        out = self._ids(c.group for c in matches)
        ids = self.scene.cloud.ids
        kept = ids[~torch.isin(ids, out)].sort().values
        matched = {c.group for c in matches}
        groups = tuple(g.id for g in self._alive("all") if g.parent < 0 and g.id not in matched)
        return Selection(query, "found", kept, groups, tuple(matches), f"everything but {len(matches)} thing(s)")

    # -- colour where words fail ------------------------------------------------------------------------------------

    def _stands(self, query: Query, thing: Group) -> bool:
        """Whether something that is no row of the table stands in every asked relation."""
        for relation in query.relations:
            anchors = self._anchors(relation)
            if isinstance(anchors, Selection) or self._relation_term(relation, thing, anchors) < relations.HOLDS:
                return False
        return True

    def _stand_in(self, rows: torch.Tensor) -> Group:
        """Some Gaussians (mask or indices of rows) as something that relations can be asked of."""
        part = self.scene.cloud[rows]
        box = box_of(part, self.scene.frame)
        return Group(-1, "part", -1, "", 0.0, box, (0.0, 0.0, 0.0), len(part), 0, 0.0)

    # -- results ----------------------------------------------------------------------------------------------------

    def _why_absent(self, query: Query, candidates: Sequence[Candidate]) -> str:
        named = query.text not in ANYTHING | PARTS and query.text not in STRUCTURE
        if named and self.encoder is not None and (why := doubt(self.encoder, query.text)):
            return f"{query.describe()}: {why}; describe it by colour or place, or load a larger encoder"
        nearest = candidates[0].describe() if candidates else "nothing"
        return f"{query.describe()} is not in this scene; the nearest match is {nearest}"

    def _take(self, query: Query, chosen: Sequence[Candidate]) -> Selection:
        ids = self._ids(c.group for c in chosen)
        groups = tuple(dict.fromkeys(c.group for c in chosen))
        return Selection(query, "found", ids, groups, tuple(chosen))

    def _ids(self, groups: Iterable[int]) -> torch.Tensor:
        leaves = sorted({leaf for g in groups for leaf in self.field.leaves(g)})
        wanted = torch.tensor(leaves, dtype=torch.int32, device=self.scene.cloud.device)
        return self.scene.cloud.ids[torch.isin(self.scene.cloud.group, wanted)].sort().values


def _candidate(group: Group, terms: dict[str, float]) -> Candidate:
    score = float(np.prod(list(terms.values()))) if terms else 1.0
    return Candidate(
        group.id,
        group.label if group.label_score >= NAMED else "object",
        name_of(group.lab),
        group.box.center,
        group.box.size,
        score,
        terms,
    )


def _union(a: Selection, b: Selection) -> Selection:
    ids = torch.unique(torch.cat([a.ids, b.ids]))
    return replace(a, ids=ids, groups=tuple(dict.fromkeys((*a.groups, *b.groups))),
                   candidates=(*a.candidates, *b.candidates))  # fmt: skip


def _difference(a: Selection, b: Selection) -> Selection:
    ids = a.ids[~torch.isin(a.ids, b.ids)]
    return replace(a, ids=ids, groups=tuple(g for g in a.groups if g not in b.groups),
                   candidates=tuple(c for c in a.candidates if c.group not in b.groups))  # fmt: skip
