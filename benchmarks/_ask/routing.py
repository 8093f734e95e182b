"""Where questions of other people go: to geometry, to a vision-language model, or to neither.

Their scenes are not at hand. They are read in a room that holds one thing of every kind, so that hardly a noun is
absent; what counts is who would answer, not the answer.
"""

from __future__ import annotations

import gzip
import json
import math
from collections import Counter
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from ...gaussians.world import kinds
from ...planners.questions import asking
from ...planners.questions.survey import Survey
from ...planners.rooms.graph import SceneGraph
from ...planners.rooms.node import Node, RoomShape
from .. import _data
from .._select.cases import Part
from ..harness import Metric
from .written import FOLDER

FILES = {"sqa3d": "sqa3d_questions.json.gz", "open_eqa": "open_eqa_questions.json.gz"}
CHECKED = FOLDER / "routing.jsonl"
ROUTES = ("geometry", "vlm", "neither")
_NAMES = {"none": "neither", "nobody": "neither", "abstain": "neither", "sight": "vlm"}
STRIDE = 2.5  # metres between the things of the room


@cache
def everything() -> Survey:
    """A room with one thing of every kind on a square grid."""
    found = list(kinds.table().kinds.values())
    side = math.ceil(math.sqrt(len(found)))
    nodes = []
    for i, kind in enumerate(found):
        width, depth, height = ((low + high) / 2 for low, high in kind.size)
        x, y = (STRIDE * (k - (side - 1) / 2) for k in (i % side, i // side))
        color = kind.colors[0] if kind.colors else "gray"
        nodes.append(Node(id=i, label=kind.name, color=color, size=(width, depth, height), position=(x, y, height / 2)))
    extent = STRIDE * side
    return Survey.of_graph(SceneGraph(room=RoomShape(size=(extent, extent, 3.0)), nodes=tuple(nodes)))


def route(text: str) -> str:
    """Who answers a question: "geometry", "vlm" or "neither"; a question that raises an error goes to nobody."""
    try:
        reading = asking.route(text, everything())
    except Exception:  # counted as an error of routing, not one of the benchmark
        return "neither"
    if reading.sight:
        return "vlm"
    answered = reading.answer.source != "none" or bool(reading.answer.evidence.ids)
    return "geometry" if answered else "neither"


def told(case: dict[str, Any]) -> str:
    """A question with its situation before it, where it has one."""
    situation = (case.get("situation") or "").strip()
    if situation and not situation.endswith((".", "!", "?")):
        situation += "."
    return f"{situation} {case['question'].strip()}".strip()


def measure(quick: bool) -> Part:
    """Shares of both sets by who answers, and errors on the hand-checked sample, as far as they are there."""
    folder, metrics, notes = _data.folder("language"), list[Metric](), list[str]()
    if folder is None:
        notes.append(_data.missing("language"))
    else:
        for name, file in FILES.items():
            every = 20 if quick else 1
            routes = Counter(route(told(c)) for c in _questions(folder / file)[::every])
            metrics += [Metric(f"routing.{name}.{r}", routes[r] / routes.total(), "share") for r in ROUTES]
            metrics.append(Metric(f"routing.{name}.questions", routes.total(), "count"))
        notes.append(
            "routing: questions of SQA3D (with their situations) and OpenEQA, read in a room with one thing of every "
            "kind, as their scenes are not at hand. geometry: read, with an answer or with things that it names; vlm: "
            "left to somebody who sees pictures; neither: said to be unanswerable"
        )
    return Part((*metrics, *_checked(CHECKED)), notes=tuple(notes))


def _questions(path: Path) -> list[dict[str, Any]]:
    with gzip.open(path, "rt", encoding="utf-8") as file:
        found: list[dict[str, Any]] = json.load(file)
    return found


def checked(path: Path = CHECKED) -> list[tuple[dict[str, Any], str]]:
    """The hand-checked sample with the routes that were taken; nothing if it is not there."""
    sample = _data.instructions(path) if path.is_file() else []
    return [(case, route(told(case))) for case in sample]


def is_right(case: dict[str, Any], taken: str) -> bool:
    """Whether a route is the written one, or one that is also accepted."""
    also = case.get("also_ok") or []
    allowed = [case["route"], *([also] if isinstance(also, str) else also)]
    return taken in {_NAMES.get(a, a) for a in allowed}


def _checked(path: Path) -> list[Metric]:
    """Share of errors on the sample; and of what geometry should not have taken, which is the worse error."""
    found: Sequence[tuple[dict[str, Any], str]] = checked(path)
    if not found:
        return []
    wrong = [(case, taken) for case, taken in found if not is_right(case, taken)]
    taken_wrongly = sum(taken == "geometry" for _, taken in wrong)
    return [
        Metric("routing.checked.errors", len(wrong) / len(found), "share", "lower", 0.1),
        Metric("routing.checked.wrongly_to_geometry", taken_wrongly / len(found), "share", "lower", 0.1),
        Metric("routing.checked.questions", len(found), "count"),
    ]
