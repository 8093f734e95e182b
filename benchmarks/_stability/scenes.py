"""Rows of scenes that are disturbed before they are embedded: how well names still find things."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from ...gaussians import assets
from .._rows import Row
from .._select import cases
from .._select.cases import Case
from .._select.mirror import mirrored
from .._select.stability import with_floaters
from . import spoiling
from .ground import Ground, unframed

Spoil = Callable[[Case], Case]


@dataclass(frozen=True)
class Disturbance:
    """A disturbance of scenes.

    Attributes:
        name: of its row.
        levels: a label and what is done, from the mildest on.
        bare: whether scenes lose what is known of their frame, so that they are compared with such.
        quick: which levels a quick run measures; none leaves the row out.
    """

    name: str
    levels: tuple[tuple[str, Spoil], ...]
    bare: bool = False
    quick: tuple[int, ...] = ()


def _levels(spoil: Callable[..., Case], unit: str, values: Sequence[float]) -> tuple[tuple[str, Spoil], ...]:
    return tuple((f"{v:g} {unit}".strip(), partial(_with, spoil, v)) for v in values)


def _share(spoil: Callable[..., Case], values: Sequence[float]) -> tuple[tuple[str, Spoil], ...]:
    return tuple((f"{v:.0%}", partial(_with, spoil, v)) for v in values)


def _with(spoil: Callable[..., Case], value: Any, case: Case) -> Case:
    return spoil(case, value)


def _metres(spoil: Callable[..., Case], millimetres: Sequence[float]) -> tuple[tuple[str, Spoil], ...]:
    return tuple((f"{v:g} mm", partial(_with, spoil, v / 1000)) for v in millimetres)


def _turns(axis: Sequence[float], degrees: Sequence[float]) -> tuple[tuple[str, Spoil], ...]:
    return tuple((f"{d:g} deg", partial(_turned, axis, d)) for d in degrees)


def _turned(axis: Sequence[float], degrees: float, case: Case) -> Case:
    return spoiling.turned(case, axis, degrees)


def _roofed(case: Case, detail: float) -> Case:
    return cases.case_of(assets.furnish(case.seed, detail=detail, ceiling=True), case.seed)


_UPS = {
    "y up": ((1, 0, 0), -90.0),
    "y down": ((1, 0, 0), 90.0),
    "x up": ((0, 1, 0), 90.0),
    "z down": ((1, 0, 0), 180.0),
}


def disturbances(detail: float) -> tuple[Disturbance, ...]:
    """All of them."""
    return (
        Disturbance("scene.floaters", _share(with_floaters, (0.01, 0.05, 0.2))),
        Disturbance("scene.mirrored", (("mirrored", mirrored),)),
        Disturbance("scene.position_noise", _metres(spoiling.jittered, (2, 5, 10, 20))),
        Disturbance("scene.larger_gaussians", _levels(spoiling.inflated, "x", (1.5, 2, 3))),
        Disturbance("scene.gaussians_dropped", _share(spoiling.thinned, (0.2, 0.5, 0.8)), quick=(1,)),
        Disturbance("scene.fainter", _levels(spoiling.hazy, "x", (0.7, 0.4, 0.2))),
        Disturbance("scene.half_captured", tuple(
            (f"{n} pictures", partial(_with, spoiling.seen_from, n)) for n in (16, 8, 4, 2)
        )),
        Disturbance("scene.occluders", _share(spoiling.screened, (0.25, 0.5))),
        Disturbance("scene.rows_shuffled", (("shuffled", spoiling.shuffled),)),
        Disturbance("scene.two_sided_walls", _metres(spoiling.two_sided, (30, 100, 250))),
        Disturbance("scene.ceiling", (("with a ceiling", partial(_with, _roofed, detail)),)),
        Disturbance("scene.far_outliers", _levels(spoiling.with_outliers, "", (10, 100, 1000))),
        Disturbance("scene.degenerate", _share(spoiling.with_degenerate, (0.01, 0.05, 0.2))),
        Disturbance("scene.colour_noise", _levels(spoiling.colour_noise, "", (0.02, 0.05, 0.1))),
        Disturbance("scene.dimmed", tuple(
            (f"{v:g} x", partial(_with, spoiling.lit, (v, v, v))) for v in (0.7, 0.4, 0.2)
        )),
        Disturbance("scene.warm_light", (
            ("2700 K", partial(_with, spoiling.lit, (1.1, 0.9, 0.6))),
        )),
        Disturbance("frame.unknown", (("nothing stated", unframed),)),
        Disturbance("frame.scale", _levels(spoiling.scaled, "x", (0.1, 10, 0.01, 100)), True),
        Disturbance("frame.up", tuple(
            (name, partial(_turned, axis, degrees)) for name, (axis, degrees) in _UPS.items()
        ), True),
        Disturbance("frame.tilted", _turns((1.0, 0.4, 0.0), (2, 5, 10, 20)), True),
    )  # fmt: skip


def rows(ground: Ground) -> Iterator[Row]:
    """The row of each disturbance."""
    for one in disturbances(ground.detail):
        wanted = [one.levels[i] for i in one.quick] if ground.quick else one.levels
        if not wanted:
            continue
        baseline = ground.miou(ground.bare if one.bare and not ground.quick else ground.known)
        values = [(label, ground.miou(ground.embedded([spoil(r) for r in ground.rooms]))) for label, spoil in wanted]
        yield ground.row(one.name, baseline, values)
