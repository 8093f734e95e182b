"""The rooms that all rows share, embedded once with and without a known frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from statistics import fmean

from ...gaussians.language.encoders import Encoder
from ...gaussians.scene import Frame
from .._rows import Level, Row
from .._select import cases
from .._select.cases import Case
from .._select.stability import names_miou

SEEDS, DETAIL = (7201, 7202, 7203), 0.3
QUICK_SEEDS, QUICK_DETAIL = (7202,), 0.3


@dataclass(frozen=True, eq=False)
class Ground:
    """Furnished rooms of a few seeds, few enough that every row can embed them anew.

    Attributes:
        encoder: that of users.
        quick: whether few levels are wanted.
    """

    encoder: Encoder
    quick: bool
    _known: dict[str, list[Case]] = field(default_factory=dict)

    @property
    def seeds(self) -> tuple[int, ...]:
        return QUICK_SEEDS if self.quick else SEEDS

    @property
    def detail(self) -> float:
        return QUICK_DETAIL if self.quick else DETAIL

    @cached_property
    def rooms(self) -> list[Case]:
        """Not embedded."""
        return [cases.furnished(seed, self.detail) for seed in self.seeds]

    @cached_property
    def known(self) -> list[Case]:
        """Embedded, with the frame that their makers gave them."""
        return [cases.embedded(room, self.encoder) for room in self.rooms]

    @cached_property
    def bare(self) -> list[Case]:
        """Embedded as most files are: without cameras, and with up, floor and scale unknown."""
        return [cases.embedded(unframed(room), self.encoder) for room in self.rooms]

    def embedded(self, rooms: Sequence[Case]) -> list[Case]:
        return [cases.embedded(room, self.encoder) for room in rooms]

    def miou(self, known: Sequence[Case]) -> float:
        """Mean IoU of every kind that a room holds once, asked by its bare name."""
        return fmean(v for case in known for v in names_miou(case, self.encoder))

    @property
    def asked(self) -> int:
        """How many names are asked for in all rooms."""
        return sum(len(room.alone()) for room in self.rooms)

    def row(
        self, name: str, baseline: float, values: Sequence[tuple[str, float]], unit: str = "IoU", n: int = 0
    ) -> Row:
        """A row of figures at levels."""
        return Row(name, baseline, tuple(Level(label, value) for label, value in values), unit, n or self.asked)


def unframed(case: Case) -> Case:
    """The case as if it were loaded from a file that tells nothing but its Gaussians."""
    scene = case.scene.replace(frame=Frame(), language=None)
    return replace(case, scene=scene)
