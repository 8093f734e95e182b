"""bench ask: questions answered from geometry and from views, edits judged, and what both cost.

Generated questions have an exact truth that the product's code has no part in (`_ask/generate.py`); written ones are
judged by what people wrote down (`_ask/written.py`). Each other measure is a module of `_ask`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import fmean, median

from ..gaussians.language import encoders
from ..gaussians.language.encoders import Encoder
from . import _ask, _ask_judge
from ._ask import generated, rooms, routing, sight, speed, stability, views, vision_loop, written
from ._ask.question import Judged
from ._ask.rooms import Known
from ._select.cases import Part
from .harness import Metric, Point, Result


@dataclass(frozen=True)
class Plan:
    """How much is asked.

    Attributes:
        rooms, questions: seeds of furnished rooms and the number of questions over them.
        graphs, graph_seed, graph_questions: the same of composed graphs, with seeds from `graph_seed` on.
        detail: factor on the number of Gaussians of furnished rooms.
        steady, steady_graphs: furnished rooms and number of graphs whose viewer, sides, masks and floaters change.
        watched: furnished rooms of which views are chosen.
    """

    rooms: tuple[int, ...]
    questions: int
    graphs: int
    graph_seed: int
    graph_questions: int
    detail: float = 1.0
    steady: tuple[int, ...] = ()
    steady_graphs: int = 0
    watched: tuple[int, ...] = ()


FULL = Plan(
    tuple(range(7801, 7809)), 240, 12, 7830, 200, steady=(7821, 7822), steady_graphs=4, watched=(7824, 7827, 7828)
)
QUICK = Plan((7801,), 60, 4, 7830, 60, 0.4, steady_graphs=1, watched=(7824,))


PARTS = ("geometry", "written", "stability", "routing", "views", "vision", "sight", "judge", "speed")


def run(quick: bool = False, parts: Sequence[str] = PARTS) -> Result:
    """The measures `parts`, in the order of the table that they answer."""
    plan, encoder = QUICK if quick else FULL, encoders.load("auto")

    @cache
    def known() -> list[Known]:
        return generated.gaussian_rooms(plan.rooms if "geometry" in parts else plan.rooms[:1], encoder, plan.detail)

    measures: dict[str, Callable[[], Iterable[Part]]] = {
        "geometry": lambda: _geometry(plan, known(), encoder),
        "written": lambda: [_written()],
        "stability": lambda: [Part((
            *stability.of_graphs(plan.steady_graphs, plan.graph_seed),
            *stability.in_rooms(plan.steady, encoder, plan.detail),
        ))],
        "routing": lambda: [routing.measure(quick)],
        "views": lambda: [views.measure(plan.watched, encoder, plan.detail, quick)],
        "vision": lambda: [vision_loop.measure(quick)],
        "sight": lambda: [sight.measure(quick)],
        "judge": lambda: [Part(tuple(_ask_judge.measure(quick)))],
        "speed": lambda: [Part(tuple(speed.measure(known()[0], encoder, plan.detail, quick)))],
    }  # fmt: skip
    found = [part for name in PARTS if name in parts for part in measures[name]()]
    return Result(
        title="questions answered",
        accuracy="share right",
        metrics=tuple(m for part in found for m in part.metrics),
        points=tuple(p for part in found for p in part.points),
        notes=(*_ask.NOTES, *(n for part in found for n in part.notes)),
        seeds=(*plan.rooms, *plan.steady, *plan.watched, *range(plan.graph_seed, plan.graph_seed + plan.graphs)),
    )


def _geometry(plan: Plan, known: Sequence[Known], encoder: Encoder) -> Iterator[Part]:
    """Generated questions: in rooms of Gaussians, with their true table, in graphs, and in wordings held back."""
    in_rooms = generated.asked(known, generated.shown_kinds(encoder), plan.questions)
    yield Part(tuple(generated.metrics(in_rooms, "gaussians")), (_point(in_rooms, "rooms of Gaussians", known, True),))
    bound = generated.asked([rooms.without_faults(k) for k in known], generated.shown_kinds(encoder), plan.questions)
    yield Part(tuple(generated.metrics(bound, "gaussians_true_table", by_kind=False)))
    graphs = generated.graph_rooms(plan.graphs, plan.graph_seed)
    on_graphs = generated.asked(graphs, generated.every_kind(), plan.graph_questions)
    yield Part(tuple(generated.metrics(on_graphs, "graphs")), (_point(on_graphs, "scene graphs", graphs, False),))
    reworded = generated.asked(graphs, generated.every_kind(), plan.graph_questions, held=True)
    yield Part(tuple(generated.metrics(reworded, "graphs_held_wordings", by_kind=False)))


def _point(judged: Sequence[Judged], setting: str, known: Sequence[Known], default: bool) -> Point:
    """Share right against seconds of the processor an answer."""
    size = fmean(k.case.field_bytes for k in known if k.case is not None) if default else 0.0
    seconds = median(j.seconds for j in judged)  # the first question of a room also measures its floor
    return Point("geometry", setting, seconds, fmean(j.right for j in judged), int(size), default)


def _written() -> Part:
    """Both sets of written questions, as far as they are there."""
    metrics = list[Metric]()
    for which in written.SETS:
        metrics += written.metrics(which, written.measure(which))
    return Part(tuple(metrics))
