"""bench select: all measures of selection by words, and the chart of time against mIoU.

The selected Gaussians are compared with the object's own in 3D; only the photographs of a real room are compared in
pixels. Rooms come from seeds that nothing was fitted on; each score is printed beside its upper bound. Each measure is
a function of `_select`; figures with real CLIP vectors come from `_clip`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from ..gaussians.language import encoders
from ..gaussians.language.encoders import Encoder
from . import _clip, _data
from ._select import (
    cases,
    composed,
    costs,
    curves,
    faults,
    finer,
    floor_noise,
    lifted,
    meshes,
    names,
    pairs,
    relations,
    stability,
)  # fmt: skip
from ._select.cases import Case, Part
from ._select.real import captures
from .harness import Metric, Result


@dataclass(frozen=True)
class Plan:
    """The seeds of each measure; no seed from 7000 to 7999 was used for fitting."""

    names: tuple[int, ...]
    attributes: tuple[int, ...]
    swaps: tuple[int, ...]
    relations: tuple[int, ...]
    staged: tuple[int, ...]
    stability: tuple[int, ...]
    masked: tuple[int, ...]
    chart: tuple[int, ...]
    meshes: int = 7101

    @property
    def seeds(self) -> tuple[int, ...]:
        """All of them."""
        return tuple(sorted({*self.names, *self.attributes, *self.swaps, *self.relations, *self.staged, self.meshes}))


FULL = Plan(
    names=tuple(range(7001, 7011)),
    attributes=tuple(range(7011, 7017)),
    swaps=tuple(range(7021, 7025)),
    relations=tuple(range(7001, 7004)),
    staged=tuple(range(7031, 7033)),
    stability=(7001, 7002),
    masked=(7001,),
    chart=(7001, 7002),
)
EVERY = 2  # of the kinds of composed rooms, one of so many
CLIP_GOALS = {"room.named.ours": 0.90, "all.named.ours": 0.629}  # what the vectors themselves allow
SECONDS = "embedding, lifting in the chart, and the chart: seconds of the processor"
QUICK = Plan((7001,), (7011,), (7021,), (), (7031,), (), (), (7001,))


PARTS = (
    "names", "attributes", "relations", "meshes", "vectors", "composed", "captures", "costs", "thresholds", "floaters",
    "finer", "views", "masks", "floor", "chart",
)  # fmt: skip
_LONG = frozenset({"floaters", "finer", "views", "masks", "floor"})  # what quick runs leave out


def run(quick: bool, parts: Sequence[str] = PARTS) -> Result:
    """The measures `parts`, in the order of the table they answer."""
    plan, encoder = QUICK if quick else FULL, encoders.load("auto")
    cases.embedded(cases.furnished(plan.names[0], detail=0.3), encoder)  # compile and load outside the clock

    @cache
    def grouped(case: Case) -> Case:
        return cases.embedded(case, encoder)

    @cache
    def room(seed: int) -> Case:
        return cases.furnished(seed)

    def known(seeds: Sequence[int]) -> list[Case]:
        return [grouped(room(seed)) for seed in seeds]

    def steady() -> list[Case]:
        return [room(seed) for seed in plan.stability]

    def spatial() -> list[Case]:
        return [*(room(s) for s in plan.relations), *(relations.staged_room(s) for s in plan.staged)]

    def named() -> Part:
        found = known(plan.names)
        return names.measure([names.ask_names(case, encoder) for case in found], [case.seconds for case in found])

    measures: dict[str, Callable[[], Iterable[Part]]] = {
        "names": lambda: [named()],
        "attributes": lambda: [pairs.measure(plan.attributes, plan.swaps, encoder, grouped)],
        "relations": lambda: [
            relations.measure(spatial(), encoder, grouped, lambda case: cases.with_true_groups(case, encoder))
        ],
        "meshes": lambda: [_strangers(plan, encoder, grouped, quick)],
        "vectors": lambda: [_real_vectors(quick)],
        "composed": lambda: [_composed(encoder, quick)],
        "captures": lambda: [_captures(quick)],
        "costs": lambda: [costs.measure(room(plan.names[0]), encoder, grouped, quick)],
        "thresholds": lambda: [stability.thresholds(known(plan.names), encoder)],
        "floaters": lambda: [stability.floaters(steady(), encoder, grouped, stability.FLOATERS)],
        "finer": lambda: [finer.measure(known(plan.names[:4]), encoder)],
        "views": lambda: [lifted.fewer_views(steady(), encoder)],
        "masks": lambda: [faults.measure([room(s) for s in plan.masked], known(plan.masked), encoder)],
        "floor": lambda: [floor_noise.measure(plan.stability, grouped)],
        "chart": lambda: curves.measure([room(s) for s in plan.chart], encoder, grouped, quick),
    }
    wanted = [name for name in PARTS if name in parts and not (quick and name in _LONG)]
    found = [part for name in wanted for part in measures[name]()]
    return Result(
        title="selection by words in held-out rooms",
        accuracy="mIoU of names",
        metrics=tuple(m for part in found for m in part.metrics),
        points=tuple(p for part in found for p in part.points),
        notes=(*(n for part in found for n in part.notes), SECONDS),
        seeds=plan.seeds,
    )


def _strangers(plan: Plan, encoder: Encoder, grouped: Callable[[Case], Case], quick: bool) -> Part:
    """The measure on meshes made by others, if the data are there."""
    folder = _data.folder("meshes")
    if folder is None:
        return Part(notes=(_data.missing("meshes"),))
    return meshes.measure(folder, plan.meshes, encoder, grouped, 1 if quick else meshes.ROOMS)


def _real_vectors(quick: bool) -> Part:
    """The measure with real CLIP vectors in place of the embedded encoder's, if the data are there."""
    folder = _data.folder("clip_vectors")
    if folder is None:
        return Part(notes=(_data.missing("clip_vectors"),))
    figures = _clip.figures(folder.parent, quick)
    return Part(tuple(
        Metric(f"clip.{k}", v, "share", "lower" if k.endswith("wrongly_refused") else "higher", 0.03, CLIP_GOALS.get(k))
        for k, v in figures.items()
    ))  # fmt: skip


def _composed(encoder: Encoder, quick: bool) -> Part:
    """The measure on rooms composed from sentences; quick runs take one room."""
    kinds = composed.room_names()
    return composed.measure(lambda case: cases.embedded(case, encoder), encoder, kinds[:1] if quick else kinds[::EVERY])


def _captures(quick: bool) -> Part:
    """The measure on real and rendered captures, if the data are there."""
    if quick:
        return Part(notes=("captures: quick runs leave out the captures",))
    wanted = ("captures", "scenes", "clip_vectors")
    if None in (found := [_data.folder(name) for name in wanted]):
        return Part(notes=(_data.missing(" and ".join(wanted)),))
    assert found[0] is not None
    return captures.measure(found[0])
