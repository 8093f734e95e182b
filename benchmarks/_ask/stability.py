"""How answers change when the viewer moves, the scene is mirrored, views of its masks are dropped or floaters come in.

Agreement is that of an answer with the answer before the change, for the same words; where the change exchanges sides
(a mirrored scene), left and right are exchanged in the words and in the answer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

import numpy as np

from ...gaussians.language.encoders import Encoder
from ...planners.questions.survey import Survey
from ...planners.rooms.graph import SceneGraph
from ...planners.rooms.node import Viewpoint
from .._select import cases, lifted, pictures
from .._select.mirror import mirrored
from .._select.stability import with_floaters
from ..harness import Metric
from . import rooms
from .generate import questions
from .generated import ask, every_kind, furnished, shown_kinds
from .question import Judged, judge
from .rooms import Known
from .truth import Table

FAMILIES = {
    "what": ("existence", "count", "count_is", "colour", "colour_is", "list", "superlative", "absent", "several",
             "undecidable"),
    "lengths": ("size", "compare", "compare_is", "distance", "distance_is", "nearest", "farthest", "nearer",
                "room_size"),
    "viewer's sides": ("viewer_side",),
    "other sides": ("object_side", "seated", "facing"),
    "contact": ("on", "on_is", "under_is", "next_is", "between_is", "inside"),
    "floor": ("free_floor", "fits", "fits_between", "hazard", "route"),
}  # fmt: skip
DROPPED = (0.2, 0.5, 0.8)  # of the views with masks
FLOATERS = (0.02, 0.1)  # of the Gaussians of a scene, added
TURNS = (90.0, 180.0, 270.0)  # degrees by which the viewer of a graph walks round the room
ASKED = 60  # questions a room


@dataclass(frozen=True)
class Compared:
    """An answer after a change: whether it agrees with the one before, and whether it is right."""

    kind: str
    agrees: bool
    right: bool


def of_graphs(count: int, seed: int) -> list[Metric]:
    """The viewer walks round written rooms; the rooms in the mirror."""
    moved, swapped = list[Compared](), list[Compared]()
    for name, own, graph in rooms.graphs(count, seed):
        table = rooms.table_of_graph(graph, name, own)
        before = _answers(Known(table, Survey.of_graph(graph)), every_kind())
        for turn in TURNS:
            seen, turned = walked(graph, table, turn)
            moved += _after_move(before, Known(turned, Survey.of_graph(seen)), every_kind())
        swapped += _in_mirror(before, Known(table, Survey.of_graph(in_mirror(graph))))
    return [*_metrics("graphs.viewer_moved", moved), *_metrics("graphs.mirrored", swapped)]


def in_rooms(seeds: Sequence[int], encoder: Encoder, detail: float) -> list[Metric]:
    """The viewer moves to other cameras of furnished rooms; rooms in the mirror; fewer views of masks; floaters."""
    found: dict[str, list[Compared]] = {}
    vocabulary = shown_kinds(encoder)
    for seed in seeds:
        case, size = furnished(seed, detail)
        known = rooms.surveyed(cases.embedded(case, encoder), size, encoder)
        before = _answers(known, vocabulary)
        assert known.case is not None
        for camera in known.case.scene.cameras[1:3]:
            moved = rooms.surveyed(known.case, size, encoder, camera)
            found.setdefault("viewer_moved", []).extend(_after_move(before, moved, vocabulary))
        flipped = rooms.surveyed(cases.embedded(mirrored(case), encoder), size, encoder)
        found.setdefault("mirrored", []).extend(_in_mirror(before, flipped))
        for share in FLOATERS:
            hazy = rooms.surveyed(cases.embedded(with_floaters(case, share), encoder), size, encoder)
            found.setdefault(f"floaters_{share:.0%}", []).extend(_same_words(before, hazy))
        for name, pairs in _fewer_views(case, size, encoder):
            found.setdefault(name, []).extend(pairs)
    return [m for name, pairs in found.items() for m in _metrics(f"gaussians.{name}", pairs)]


def _fewer_views(
    case: cases.Case, size: tuple[float, float, float], encoder: Encoder
) -> Iterator[tuple[str, list[Compared]]]:
    """True masks with shaky outlines of 24 views guide the embedding; then of fewer views of the same."""
    eyes = pictures.eyes(case.scene, lifted.VIEWS, lifted.SIZE)
    order = np.random.default_rng(case.seed).permutation(lifted.VIEWS)

    def seen_in(share: float) -> Known:
        kept = sorted(order[round(share * lifted.VIEWS) :].tolist())
        made = lifted.made(case, [eyes[i] for i in kept], lifted.true_masks, lifted.guiding, encoder)
        return rooms.surveyed(made, size, encoder)

    before = _answers(seen_in(0.0), shown_kinds(encoder))
    for share in DROPPED:
        yield f"views_dropped_{share:.0%}", _same_words(before, seen_in(share))


# -- comparing ------------------------------------------------------------------------------------------------------


def _answers(known: Known, vocabulary: Sequence[str]) -> list[Judged]:
    return [ask(known, q) for q in questions([known.table], vocabulary, ASKED)]


def _same_words(before: Sequence[Judged], known: Known) -> list[Compared]:
    """The same questions in a changed scene, of which the same is true; those that had no answer are left out."""
    before = [j for j in before if _answered(j)]
    after = [ask(known, j.question) for j in before]
    return [Compared(a.question.kind, agrees(b.answer, a), a.right) for b, a in zip(before, after, strict=True)]


def _after_move(before: Sequence[Judged], known: Known, vocabulary: Sequence[str]) -> list[Compared]:
    """The same questions where the viewer is of no account; else new ones, which agree where they are right."""
    told = _same_words([j for j in before if not j.question.side], known)
    sides = [ask(known, q) for q in questions([known.table], vocabulary, 4 * ASKED) if q.side]
    return [*told, *(Compared(j.question.kind, j.right, j.right) for j in sides)]


def _in_mirror(before: Sequence[Judged], known: Known) -> list[Compared]:
    """The same questions of the mirrored scene, with left and right exchanged where sides are asked for."""
    found = []
    for b in filter(_answered, before):
        question, answer = b.question, b.answer
        if question.kind in (*FAMILIES["viewer's sides"], *FAMILIES["other sides"]):
            truth = tuple(swapped(t) for t in question.truth)
            question = replace(question, text=swapped(question.text), truth=truth)
            answer = swapped(answer) if isinstance(answer, str) else answer
        a = ask(known, question)
        found.append(Compared(question.kind, agrees(answer, a), a.right))
    return found


def _answered(judged: Judged) -> bool:
    return not judged.refused or judged.question.expect != "answer"


def swapped(text: str) -> str:
    """A text that says left or right with the other side; one that says both, as a question for either, stays."""
    if len(set(re.findall(r"\b(?:left|right)\b", text))) > 1:
        return text
    other = {"left": "right", "right": "left"}
    return re.sub(r"\b(left|right)\b", lambda m: other[m.group()], text)


def agrees(before: object, after: Judged) -> bool:
    """Whether an answer is the one that was given before, as lengths and lists are compared."""
    if before is None or after.answer is None:
        return before is None and after.answer is None
    if after.question.type == "none":
        return before == after.answer
    return judge(replace(after.question, truth=(before,), expect="answer"), after.answer, after.told).right


def _metrics(name: str, compared: Sequence[Compared]) -> list[Metric]:
    """Agreement by family of kinds, and the share right of all."""
    found: list[Metric] = []
    if not compared:
        return found
    for family, kinds in FAMILIES.items():
        if own := [c for c in compared if c.kind in kinds]:
            key = family.replace("'", "").replace(" ", "_")
            found.append(Metric(f"{name}.agree.{key}", fmean(c.agrees for c in own), "share", "higher", 0.05))
    found.append(Metric(f"{name}.agree", fmean(c.agrees for c in compared), "share", "higher", 0.05))
    found.append(Metric(f"{name}.right", fmean(c.right for c in compared), "share", "higher", 0.05))
    return found


# -- written rooms --------------------------------------------------------------------------------------------------


def walked(graph: SceneGraph, table: Table, degrees: float) -> tuple[SceneGraph, Table]:
    """The room before a viewer who walked round it counter-clockwise from the front, and looks at its middle."""
    turn = np.radians(degrees)
    reach = max(table.size[:2]) / 2 + 1.0
    eye = (float(reach * np.sin(turn)), float(-reach * np.cos(turn)))
    ahead = (-eye[0] / reach, -eye[1] / reach)
    viewer = Viewpoint(position=(*eye, 1.5), target=(0.0, 0.0, 1.5))
    return graph.model_copy(update={"viewer": viewer}), table.seen_by(eye, ahead)


def in_mirror(graph: SceneGraph) -> SceneGraph:
    """The room in the mirror x = 0."""
    nodes = tuple(
        n.model_copy(update={"position": (-n.position[0], *n.position[1:]), "yaw": -n.yaw}) for n in graph.nodes
    )
    return graph.model_copy(update={"nodes": nodes})
