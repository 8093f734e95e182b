"""How many views an answer needs: questions answered by a scripted stand-in for a vision model from chosen views.

The stand-in sees only what the pictures that it is sent show: a thing counts as seen if it covers enough pixels of the
rendered group image of one of them. It answers from what it saw as if there were nothing else, so that it is right if
the things that decide the answer were seen. It is no estimate of a real model, only of what its pictures contain.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any

import numpy as np

from ...gaussians import assets
from ...gaussians.language.encoders import Encoder
from ...gaussians.render import render
from ...gaussians.viewpoints import for_groups
from .._effort.named import words
from .._select import cases
from .._select.cases import Part
from ..harness import Metric, Point
from .generate import questions
from .generated import shown_kinds
from .question import OVERLAP, Question, overlap
from .rooms import table_of_case
from .truth import Table

COUNTS = (1, 2, 3, 4, 6, 8)
SIZE = (320, 240)  # pixels of the group images that are read
SEEN = 136  # pixels of them from which a thing counts as seen: one patch of 28 x 28 of a 768 x 576 picture
SEEDS = 3  # of the random choice
ASKED = 40  # questions a room
CROWD = 26  # things that a room is filled up to
OURS, EVEN = 3, 8  # ours with 3 views is to be at least as good as uniform with 8
KINDS = ("existence", "count", "colour", "compare", "compare_is", "nearer", "viewer_side", "object_side", "seated",
         "on", "on_is", "under_is", "next_is", "between_is", "several", "superlative", "list")  # fmt: skip


@dataclass(frozen=True)
class Shown:
    """What one picture shows: ids of the things seen in it."""

    things: frozenset[int]


@dataclass(frozen=True, eq=False)
class Watched:
    """A room with true groups, whose pictures are taken and read.

    Attributes:
        table: its truth; the id of a thing is that of its group.
        sights: prepared for choosing views.
    """

    table: Table
    sights: for_groups.Sights

    @classmethod
    def of(cls, seed: int, encoder: Encoder, detail: float) -> Watched:
        """A crowded room with a ceiling, with its true groups: a wrong segmentation is not a fault of the views."""
        room = assets.furnish(seed, objects=CROWD, detail=detail, ceiling=True)
        case, size = cases.case_of(room, seed), room.size
        known = cases.with_true_groups(case, encoder)
        return cls(table_of_case(case, size, case.scene.cameras[0]), for_groups.Sights.of(known.scene))

    def shown(self, view: Any) -> Shown:
        """Reads the group image of a view."""
        image = render(view.cut.apply(self.sights.scene), view.camera.resized(*SIZE)).group.numpy()
        ids, pixels = np.unique(image[image >= 0], return_counts=True)
        return Shown(frozenset(int(i) for i in ids[pixels >= SEEN]))


def is_right(question: Question, pictures: Sequence[Shown], table: Table) -> bool:
    """Whether what the pictures show, taken for all there is, gives the right answer."""
    seen = frozenset[int]().union(*(p.things for p in pictures))
    about = set(question.about)
    if question.kind == "existence":
        return bool(about & seen)
    if question.type == "list":
        named = set(question.names)
        found = [table.by_id(i).label for i in sorted(about & seen - named)]
        return named <= seen and any(overlap(found, truth) >= OVERLAP for truth in question.truth)
    return about <= seen


def measure(seeds: Sequence[int], encoder: Encoder, detail: float, quick: bool) -> Part:
    """Share right by number of views, for views chosen for the question, evenly and at random."""
    counts = (3, 8) if quick else COUNTS
    right: dict[tuple[str, int], list[float]] = {}
    seconds: dict[tuple[str, int], list[float]] = {}
    for seed in seeds:
        room = Watched.of(seed, encoder, detail)
        asked = [q for q in questions([room.table], shown_kinds(encoder), 8 * ASKED) if q.kind in KINDS and q.about]
        asked = asked[:: max(1, len(asked) // (ASKED // (4 if quick else 1)))]
        for key, shares, spent in _compared(room, asked, counts):
            right.setdefault(key, []).extend(shares)
            seconds.setdefault(key, []).append(spent)
    metrics = [Metric(f"views.{name}.{n}", fmean(v), "share", "higher", 0.05) for (name, n), v in right.items()]
    ours, even = fmean(right["ours", OURS]), fmean(right["uniform", EVEN])
    metrics.append(Metric(f"views.ours_{OURS}_minus_uniform_{EVEN}", ours - even, "share", "higher", 0.0, 0.0))
    metrics.append(Metric("views.questions", len(right["ours", OURS]), "count"))
    points = [
        Point(
            f"stand-in for a vision model, views {how}",
            ("1 view" if n == 1 else f"{n} views") + (words("ask", views=n) if name == "ours" else ""),
            fmean(seconds[name, n]),
            fmean(v),
            0,
            name == "ours" and n == OURS,
        )
        for name, how in (("ours", "for the question"), ("uniform", "evenly"), ("random", "at random"))
        for (other, n), v in right.items()
        if other == name
    ]
    note = (
        f"views: a scripted stand-in for a vision model, which sees what covers {SEEN} pixels of a group image of "
        f"{SIZE[0]} x {SIZE[1]} of one of its pictures, in crowded furnished rooms with a ceiling and true groups. "
        "Seconds are those of "
        "choosing and rendering the views; a real model's come on top. ours: chosen for the things that the question "
        f"names; uniform: evenly over the same candidates; random: drawn from them, {SEEDS} times"
    )
    return Part(tuple(metrics), tuple(points), (note,))


Compared = tuple[tuple[str, int], list[float], float]


def _compared(room: Watched, asked: Sequence[Question], counts: Sequence[int]) -> list[Compared]:
    """For each way of choosing and number of views: whether each question is right, and seconds a question."""
    found: list[Compared] = []
    most, size = max(counts), (for_groups.WIDTH, for_groups.HEIGHT)
    picture = _seconds_of_a_picture(room)
    orders, spent = list[list[Shown]](), 0.0
    for question in asked:
        start = time.process_time()
        chosen = for_groups.choose(room.sights, question.names, most, size)
        spent += time.process_time() - start
        orders.append([room.shown(c.view) for c in chosen])
    for n in counts:
        shares = [float(is_right(q, order[:n], room.table)) for q, order in zip(asked, orders, strict=True)]
        found.append((("ours", n), shares, spent / len(asked) + n * picture))
    for n in counts:
        even = [room.shown(c.view) for c in for_groups.choose_uniform(room.sights, (), n, size)]
        found.append((("uniform", n), [float(is_right(q, even, room.table)) for q in asked], n * picture))
    for seed in range(SEEDS):
        drawn = [room.shown(c.view) for c in for_groups.choose_random(room.sights, (), most, size, seed)]
        for n in counts:
            shares = [float(is_right(q, drawn[:n], room.table)) for q in asked]
            found.append((("random", n), shares, n * picture))
    return found


def _seconds_of_a_picture(room: Watched) -> float:
    """Seconds to render one picture as a model is sent it."""
    view = for_groups.choose_uniform(room.sights, (), 1)[0].view
    cloud = view.cut.apply(room.sights.scene)
    times = []
    for _ in range(2):
        start = time.process_time()
        render(cloud, view.camera)
        times.append(time.process_time() - start)
    return min(times)
