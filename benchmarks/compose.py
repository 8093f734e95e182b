"""bench compose: rooms described in sentences, judged by what the sentences name (`_composed`) and by the checker.

Sets: `rooms.jsonl` and `rooms_of_forms.jsonl` of `tests/planners/written` and, where SCENEWRIGHT_ROOMS names a file of
the same form, that file too.
"""

from __future__ import annotations

import os
import statistics
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..gaussians.effort.points import method
from ..gaussians.errors import InstructionError
from ..planners.compose import Composition, compose, sample_brief
from ..planners.rooms.check import check
from . import _composed, _data
from ._composed import Case, Judged
from ._effort.named import words
from .harness import Metric, Point, Result

FOLDER = Path(__file__).resolve().parent.parent / "tests" / "planners" / "written"
_UNSOUND = ("collision", "bounds", "support")
_SEED = 0
_OBJECTS = 30  # things of the rooms whose time is measured


@dataclass(frozen=True)
class Made:
    """One room composed and judged.

    Attributes:
        case: as written.
        judged: what of it is as said.
        wrong: number of violations of each kind that the checker finds.
        things: how many stand in it.
        refused: why nothing was made as said, "" if it was.
        untold: what is not as said and is named in no remark or conflict.
        seconds: of a core.
    """

    case: Case
    judged: Judged
    wrong: Counter[str]
    things: int
    refused: str
    untold: tuple[str, ...]
    seconds: float


def made(case: Case, seed: int = _SEED, effort: float = 1.0) -> Made:
    """A case composed by the embedded reader; a refused one has no graph."""
    started = time.process_time()
    result: Composition | None = None
    try:
        result = compose(case["text"], seed=seed, effort=effort)
        refused = "; ".join(s for c in result.layout.conflicts[:1] for s in c.statements)
    except InstructionError as error:
        refused = str(error)
    seconds = time.process_time() - started
    graph = result.layout.graph if result is not None else None
    judged = _composed.judge(graph, case)
    wrong = Counter[str](v.kind for v in check(graph).violations) if graph is not None else Counter[str]()
    told = " ".join((*result.remarks, *result.unmet, refused)) if result is not None else refused
    untold = tuple(f for f in judged.faults if not _told(f, told))
    return Made(case, judged, wrong, len(graph.nodes) if graph is not None else 0, refused, untold, seconds)


def _told(fault: str, remarks: str) -> bool:
    """Whether a remark names something of a fault."""
    words = [w for w in fault.replace("_", " ").split() if len(w) > 3 and w.isalpha()]
    return any(w in remarks for w in words)


def cases(path: Path) -> list[Case]:
    """The rooms of a file, one JSON object a line; raises as `_data.instructions`."""
    return _data.instructions(path)


def metrics(name: str, found: Sequence[Made]) -> Iterator[Metric]:
    """The shares of a set of rooms."""
    judged = [m.judged for m in found]
    for part, goal in (("things", 0.97), ("relations", 0.97), ("colors", None)):
        kept, said = _composed.shares(judged, part)
        yield Metric(f"{name}.{part}.as_said", kept / said if said else 1.0, "share", "higher", goal=goal)
    sized = [j.size for j in judged if j.size is not None]
    yield Metric(f"{name}.size.as_said", sum(sized) / len(sized) if sized else 1.0, "share", "higher")
    stand = max(sum(m.things for m in found), 1)
    strange = sum(len(j.strange) for j in judged)
    listed = max(sum(j.odd[1] for j in judged), 1)
    yield Metric(f"{name}.unexpected.things", strange / stand, "share", "lower", goal=0.02)
    yield Metric(f"{name}.unexpected.nouns", sum(j.odd[0] for j in judged) / listed, "share", "lower", goal=0.02)
    for kind in (*_UNSOUND, "reach"):
        goal = 0.0 if kind in _UNSOUND else None
        yield Metric(f"{name}.{kind}", float(sum(m.wrong[kind] for m in found)), "count", "lower", goal=goal)
    yield Metric(f"{name}.refused", sum(bool(m.refused) for m in found) / len(found), "share", "lower", goal=0.02)
    every = sum(len(m.judged.faults) for m in found)
    untold = sum(len(m.untold) for m in found)
    yield Metric(f"{name}.untold", untold / every if every else 0.0, "share", "lower")
    yield Metric(f"{name}.seconds.median", statistics.median(m.seconds for m in found), "s", "lower", 0.5)
    yield Metric(f"{name}.seconds.worst", max(m.seconds for m in found), "s", "lower", 0.5)


def run(quick: bool = False) -> Result:
    """All sets; `quick` takes every fourth room."""
    step = 4 if quick else 1
    compose("a room with a chair", seed=_SEED)  # imports are not the time of the first room
    sets = {"written": FOLDER / "rooms.jsonl", "forms": FOLDER / "rooms_of_forms.jsonl"}
    if more := os.environ.get("SCENEWRIGHT_ROOMS", "").strip():
        sets["given"] = Path(more)
    found: list[Metric] = []
    counts = []
    for name, path in sets.items():
        rooms = [made(case) for case in cases(path)[::step]]
        counts.append(f"{name}: {len(rooms)} rooms, {sum(len(m.case.get('things', [])) for m in rooms)} named things, "
                      f"{sum(len(m.case.get('relations', [])) for m in rooms)} relations.")  # fmt: skip
        found += metrics(name, rooms)
    times = list(_times(2 if quick else 8))
    found.append(Metric("thirty_things.seconds.worst", max(times), "s", "lower", 0.5, goal=2.0))
    return Result(
        "rooms composed from sentences",
        "share as said",
        tuple(found),
        tuple(_dialled(cases(FOLDER / "rooms.jsonl")[:: 4 * step])),
        (
            *counts,
            "points: every fourth of the written rooms at each effort of the dial.",
            "written: by somebody who saw neither the reader nor its words. forms: by the author of the reader, for "
            "rows, circles, distances, sides and quantifiers that distribute.",
            "things, relations, colors: as said in the finished graph, judged by names and boxes with tolerances of "
            "the benchmark's own; a thing counts only in the number said.",
            "unexpected.things: of all things that stand in the rooms, those that the writer listed as odd there and "
            "blocks that the sentence does not name; unexpected.nouns: of the listed odd nouns, those that are there.",
            "refused: sentences that were refused or reported as impossible; all of them are possible.",
            "untold: of what is not as said, the share that no remark or conflict names.",
            f"thirty_things: processor time of rooms with {_OBJECTS} things, from brief to graph.",
        ),
        (_SEED,),
    )


def _dialled(rooms: Sequence[Case]) -> Iterator[Point]:
    """Seconds a room against the share of what was said, at each setting of the dial."""
    known = method("compose")
    for k, point in enumerate(known.points):
        found = [made(room, effort=float(point.settings["effort"])) for room in rooms]
        parts = [_composed.shares([m.judged for m in found], part) for part in ("things", "relations", "colors")]
        kept, said = (sum(column) for column in zip(*parts, strict=True))
        seconds = statistics.fmean(m.seconds for m in found)
        setting = point.setting + words("compose", **point.settings)
        yield Point("written rooms", setting, seconds, kept / max(said, 1), 0, k == known.default)


def _times(count: int) -> Iterator[float]:
    """Processor time of rooms with 30 things."""
    for k, kind in zip(range(count), ("office", "restaurant", "classroom", "library", "gym", "deli", "bar", "room"),
                       strict=False):  # fmt: skip
        started = time.process_time()
        compose(sample_brief(kind, _OBJECTS, _SEED + k), seed=_SEED + k)
        yield time.process_time() - started
