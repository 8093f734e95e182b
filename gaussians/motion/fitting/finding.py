"""Finds what moves, and its paths (`Finder`), from the scene at the first time.

Seeds are tracked, and those that a path explains are kept. They are sorted out, put on an axis where the frames tell no
more, and each Gaussian near them is assigned to one of them or to what stands still.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...fit.parameters import Parameters
from .axes import agrees, line_of
from .bending import Torn, bent, bent_alone, gain_by_bending
from .bends import Bend
from .bodies import Body, Columns, Labelled
from .budget import SEARCH_UNTIL, SEEDS_UNTIL, Budget, OutOfTime
from .footage import Footage
from .rolling import Ball
from .seeds import LEAST, Flags, around, changing_partly, gone, halves, reach, seeds, together
from .sharing import shared, without_ground
from .smoothing import smoothed
from .supposing import supposed
from .tracking import Tracker

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

EXPLAINS = 0.7  # of the difference without a body, to which its path must bring the pictures
MOST_BODIES = 12
ALIKE = 0.01  # of the radius of the cameras: bodies whose paths differ by less, on average, are one
AS_WELL = 1.05  # times the difference with its own path, up to which a body follows another, or stands still
FREE_ALONE, LINE_ALONE = 1.5, 1.2  # the same of one camera, before which a free path explains what it should not
PASSED = 0.5  # of the difference without the bodies that are known, to which they bring what they cover
TOGETHER = 0.6  # of the difference standing still, below which a body follows another without a search of its own
BENDS = 0.75  # of the difference with its path, below which a body bends
ONE = 1.1  # of the difference with the paths of bodies that touch, below which they are one thing that bends
ALONE = 1.1  # times what a body gains by bending on its path, up to which bending without a path is as good
RIGHT = 0.05  # root mean square difference of colours up to which what stands still is taken to be covered meanwhile
SORTED = 10  # times at which that is measured
SETTLED = 1  # rounds in which paths are mended and Gaussians assigned to bodies


class Finder:
    """Finds what moves in a footage.

    Args:
        footage: its first time is that of the scene from which bodies are tracked.
        seed: of the searches.
        rng: draws the order of frames.
        budget: of the fit.
        tell: is called before each search.
        bends: whether bodies may change their shape; before one camera that moves none does.

    Attributes:
        cut: whether there was no time for all that could be searched or improved.
    """

    def __init__(
        self, footage: Footage, seed: int, rng: np.random.Generator, budget: Budget, tell: Callable[[], None],
        bends: bool = False,
    ) -> None:  # fmt: skip
        self._footage, self._seed, self._rng, self._budget, self._tell = footage, seed, rng, budget, tell
        self._alone, self._until, self.cut = bool(footage.at_first), SEEDS_UNTIL, False
        self._bends = bends and not self._alone

    def find(self, start: Parameters) -> tuple[Labelled, list[Body], int]:
        """What moves, by the number of its label, its paths, and how many bodies were tried.

        Args:
            start: of the Gaussians of the scene at the first time.
        """
        columns = start.columns()
        labels, bodies, tried = self._found(columns, gone(columns, self._footage))
        labelled = Labelled.labelled(start, labels)
        self._until = SEARCH_UNTIL
        try:
            if bodies:
                self._improve(labelled, bodies)
        except OutOfTime:  # paths are as good as they are: all is trained together afterwards
            self.cut = True
        return labelled, bodies, tried

    def _improve(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Sort out bodies, mend their paths and assign Gaussians to them; in place."""
        self._sort_out(labelled, bodies)
        for _ in range(SETTLED):
            self._follow(labelled, bodies)
            if self._bends:
                self._let_bend(labelled, bodies)
            self._settle(labelled, bodies)
        self._sort_out(labelled, bodies)
        self._follow(labelled, bodies)

    def _check(self) -> None:
        """Raises OutOfTime if the share of the time is gone that the present part of the search has."""
        self._budget.check(self._until)

    def _found(self, columns: Columns, flags: Flags) -> tuple[NDArray[np.int32], list[Body], int]:
        """Labels `[N]` of the seeds that a path or a bend explains, the paths, and how many were tried."""
        footage, found = self._footage, list[tuple[I64, Body]]()
        queue = seeds(columns, footage, flags)[:MOST_BODIES]
        whole = list(queue)
        still, tried = np.ones(len(flags), bool), 0
        for rows in queue:
            still[rows] = False
        while queue and not self.cut:
            rows = queue.pop(0)
            self._tell()
            try:
                tracker = Tracker(columns, rows, still, footage, self._seed + tried, found, self._check)
                if _covered(tracker, np.flatnonzero(flags[rows].any(axis=0)), self._alone):
                    continue
                if (path := _goes_with(tracker, [body for _, body in found])) is not None:
                    found.append((rows, path))
                    continue
                path = self._path(tracker)
            except OutOfTime:
                self.cut = True
                continue
            tried += 1
            if path is not None:
                found.append((rows, path))
            elif tried < 2 * MOST_BODIES and not self._alone:
                queue = [*queue, *halves(rows, flags)]
        if self._bends:
            found += self._without_path(columns, whole, still, found)
        labels, bodies = np.zeros(len(flags), np.int32), list[Body]()
        for rows, body in found:
            same = next((k for k, b in enumerate(bodies) if _alike(b, body, columns[0][rows], footage.radius)), None)
            if same is None:
                same = len(bodies)
                bodies.append(body)
            labels[rows] = same + 1
        return labels, bodies, tried

    def _without_path(
        self, columns: Columns, whole: Sequence[I64], still: Flags, found: Sequence[tuple[I64, Body]]
    ) -> list[tuple[I64, Body]]:  # fmt: skip
        """Of seeds of which nothing has a path, those that bend, with what they bend with."""
        still, more = still.copy(), list[tuple[I64, Body]]()
        for rows, _ in found:
            still[rows] = False
        known = np.concatenate([np.zeros(0, np.int64), *(rows for rows, _ in found)])
        free = [rows for rows in whole if not np.isin(rows, known).any()]
        for rows in free:
            still[rows] = True
        partly = None
        for rows in free:
            if not still[rows].all():
                continue  # an earlier one took it along
            self._tell()
            try:
                self._check()
                if partly is None:
                    partly = changing_partly(columns, self._footage)
                rows = around(columns, self._footage, rows, partly)
                rows = rows[still[rows]]
                rest = still.copy()
                rest[rows] = False
                tracker = Tracker(columns, rows, rest, self._footage, self._seed, [*found, *more], self._check)
                body = bent_alone(tracker, _some(range(1, len(self._footage.times))))
            except OutOfTime:
                self.cut = True
                break
            if body is not None:
                more.append((rows, body))
                still[rows] = False
        return more

    def _let_bend(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Let bodies bend where that explains the frames much better than their paths, bodies that touch as one: on the
        path of the largest, or without one and with what touches them; in place."""
        groups = self._touching(labelled, bodies)
        partly = changing_partly(labelled.columns(), self._footage) if groups else np.zeros(0, bool)
        for numbers in groups:
            self._check()
            times = _some(sorted({t for k in numbers for t, _ in bodies[k - 1].runs[1:]}), 2 * SORTED)
            if not times:
                continue
            own = np.flatnonzero(np.isin(labelled.labels, numbers))
            wide = around(labelled.columns(), self._footage, own, partly)
            wide = wide[np.isin(labelled.labels[wide], [0, *numbers])]
            ways = list[tuple[float, Tracker, Body, F64 | None, I64]]()
            for rows in (wide, own):
                tracker, torn = self._torn(labelled, bodies, numbers, rows)
                path, starts = bodies[numbers[0] - 1].seen_from(tracker.pivot), None
                if rows is wide:
                    path = Body.at_rest(tracker.pivot, len(tracker.seconds))
                    starts = torn.moves(Bend.none(tracker.means, len(tracker.seconds)), tracker.means)
                ways.append((gain_by_bending(tracker, torn, path, starts, times), tracker, path, starts, rows))
            alone, on = ways
            gain, tracker, path, told, rows = alone if alone[0] <= ALONE * on[0] else on
            if gain > (BENDS if len(numbers) == 1 else ONE):
                continue
            if len(numbers) == 1:  # nodes are followed better from time to time than from a path that is not theirs
                told = None
            bodies[numbers[0] - 1] = bent(tracker, path, told)
            labelled.labels[own] = 0
            labelled.labels[rows] = numbers[0]
        self._renumber(labelled, bodies, labelled.labels)

    def _touching(self, labelled: Labelled, bodies: list[Body]) -> list[list[int]]:
        """Numbers of bodies that may be one thing that bends: groups of those that touch, the largest body first."""
        rows = np.flatnonzero(labelled.labels > 0)
        labels, size = labelled.labels[rows], np.bincount(labelled.labels, minlength=len(bodies) + 1)
        pairs = cKDTree(labelled.means[rows]).query_pairs(reach(self._footage), output_type="ndarray")
        groups = together(labels[pairs], len(size))
        free = [k for k in range(1, len(size)) if bodies[k - 1].bend is None and size[k]]
        each = [[k for k in free if groups[k] == group] for group in np.unique(groups[free])]
        return [sorted(group, key=lambda k: -int(size[k])) for group in each]

    def _torn(self, labelled: Labelled, bodies: list[Body], numbers: list[int], rows: I64) -> tuple[Tracker, Torn]:
        """A tracker of rows as one body while other bodies go their ways, and each row on the path that it has."""
        labels = labelled.labels
        others = [(np.flatnonzero(labels == k), b) for k, b in enumerate(bodies, 1) if k not in numbers]
        still = labels == 0
        still[rows] = False
        parts = tuple((np.flatnonzero(labels[rows] == k), bodies[k - 1]) for k in numbers)
        return Tracker(labelled.columns(), rows, still, self._footage, self._seed, others, self._check), Torn(parts)

    def _path(self, tracker: Tracker) -> Body | None:
        """A path that explains a body, if there is one."""
        tracked, footage = tracker.track(), self._footage
        if not self._alone:
            return tracked.body if tracked.gain < EXPLAINS else None
        free = smoothed(tracker, tracked.body, footage.radius)
        on = supposed(tracker, len(footage.times))
        assert on.line is not None
        best = on if agrees(tracker, free, on.line) else free
        return best if self._explains(tracker, best) else None

    def _explains(self, tracker: Tracker, path: Body) -> bool:
        """Whether one camera's frames are explained much better by a path than by standing still."""
        still, errors = Body.at_rest(path.pivot, len(path.offsets)), np.zeros(2)
        for t in range(1, len(path.offsets)):
            errors += tracker.errors_of(t, (path, still))[0]
        return bool(errors[1] > self._as_well(path) * errors[0])

    def _as_well(self, path: Body) -> float:
        """Times the difference with a path, up to which standing still, or another path, is as good."""
        if not self._alone:
            return AS_WELL
        return FREE_ALONE if path.line is None else LINE_ALONE

    def _follow(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Mend the path of each body, put it on one axis where the frames tell no more, or let it roll; in place."""
        for k in range(len(bodies)):
            self._check()
            if bodies[k].bend is not None:
                continue
            tracker = self._tracker(labelled, bodies, k + 1)
            body = bodies[k].seen_from(tracker.pivot)
            if self._alone and body.line is None:
                body = smoothed(tracker, body, self._footage.radius)
            line = line_of(tracker, body)
            if line is None:
                if not self._alone:
                    tracker.mend(body)
                body = self._rolled(labelled, k + 1, body)
            bodies[k] = body if line is None else body.on(line)

    def _rolled(self, labelled: Labelled, number: int, body: Body) -> Body:
        """A body as it is, or, if it is a ball that rolls, with its turns and the Gaussians of all its surface."""
        columns, rows = labelled.columns(), np.flatnonzero(labelled.labels == number)
        ball = Ball.of(columns[0][rows].astype(np.float64), columns[3][rows].astype(np.float64))
        found = None if ball is None else ball.rolled(body, self._footage)
        if found is None:
            return body
        ball, rolled = found
        ball.filled(labelled, number, rolled, self._footage)
        return rolled

    def _sort_out(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Let a body stand still, or join another, where that explains the frames about as well as its own path while
        the others go theirs: what something passed before stands, and fragments of a thing are one; in place."""
        for number in sorted(range(1, len(bodies) + 1), key=lambda k: int((labelled.labels == k).sum())):
            tracker = self._tracker(labelled, bodies, number)
            own = bodies[number - 1].seen_from(tracker.pivot)
            others = [k for k in range(1, len(bodies) + 1) if k != number and (labelled.labels == k).any()]
            paths = [
                own,
                Body.at_rest(own.pivot, len(own.offsets)),
                *(bodies[k - 1].seen_from(own.pivot) for k in others),
            ]
            some = _some(sorted({t for path in paths for t, _ in path.runs[1:]}))
            if not some:
                labelled.labels[labelled.labels == number] = 0
                continue
            errors = np.sum([tracker.errors_of(t, paths)[0] for t in some], axis=0)
            enough = self._as_well(own) * errors[0]
            if errors[1] <= enough:  # as little motion as needed: what stands still joins nothing
                labelled.labels[labelled.labels == number] = 0
            elif errors[1:].min() <= enough:
                labelled.labels[labelled.labels == number] = others[int(errors[2:].argmin())]
        self._renumber(labelled, bodies, labelled.labels)

    def _settle(self, labelled: Labelled, bodies: list[Body]) -> None:
        """Assign Gaussians to bodies by the frames, in place; a body that keeps too few is dropped.

        What bends keeps those that it has: frames tell nothing of what goes along with a part of it that stands.
        """
        self._check()
        labels = shared(labelled.columns(), labelled.labels, bodies, self._footage, self._rng)
        labels = without_ground(labelled.columns(), labels, self._footage)
        soft = [k for k, body in enumerate(bodies, 1) if body.bend is not None]
        kept = np.isin(labelled.labels, soft) | np.isin(labels, soft)
        labels = np.where(kept, labelled.labels, labels).astype(np.int32)
        self._renumber(labelled, bodies, labels)

    def _renumber(self, labelled: Labelled, bodies: list[Body], labels: NDArray[np.int32]) -> None:
        """Take over labels, without bodies that have too few Gaussians; in place."""
        kept = [k for k in range(1, len(bodies) + 1) if (labels == k).sum() >= LEAST]
        number = np.zeros(len(bodies) + 1, np.int32)
        number[kept] = np.arange(1, len(kept) + 1)
        labelled.labels, bodies[:] = number[labels], [bodies[k - 1] for k in kept]

    def _tracker(self, labelled: Labelled, bodies: list[Body], number: int) -> Tracker:
        """For the path of a body while the paths of the others are known."""
        labels = labelled.labels
        others = [(np.flatnonzero(labels == k), b) for k, b in enumerate(bodies, 1) if k != number]
        rows = np.flatnonzero(labels == number)
        return Tracker(labelled.columns(), rows, labels == 0, self._footage, self._seed, others, self._check)


def _covered(tracker: Tracker, times: I64, alone: bool) -> bool:
    """Whether what stands still looks right at times at which it is gone, since known bodies pass before it.

    Args:
        alone: of one camera: whether it looks much better with these is enough.
    """
    if not tracker.moving:
        return False
    rest, some = Body.at_rest(tracker.pivot, len(tracker.seconds)), _some(times.tolist())
    each = [tracker.errors_of(t, (rest,)) for t in some]
    known = sum(float(e[0]) for e, _ in each)
    if known < 3 * RIGHT**2 * sum(pixels for _, pixels in each):
        return True
    return alone and known < PASSED * sum(float(tracker.without_moving(t, rest)) for t in some)


def _goes_with(tracker: Tracker, paths: Sequence[Body]) -> Body | None:
    """The path of those that are known by which a body is explained much better than by standing still."""
    best: tuple[float, Body | None] = (TOGETHER, None)
    for path in paths:
        body = path.seen_from(tracker.pivot)
        rest = Body.at_rest(body.pivot, len(body.offsets))
        some = _some([t for t, _ in body.runs[1:]])
        each = [tracker.errors_of(t, (body, rest))[0] for t in some]
        with_it, without = np.sum(each, axis=0) if each else (1.0, 1.0)
        if with_it / max(without, 1e-9) < best[0]:
            best = with_it / max(without, 1e-9), body
    return best[1]


def _some(times: Sequence[int], most: int = SORTED) -> list[int]:
    """At most so many of some times, evenly chosen."""
    chosen = np.unique(np.linspace(0, len(times) - 1, min(most, len(times))).astype(int))
    return [int(times[k]) for k in chosen]


def _alike(a: Body, b: Body, means: NDArray[np.float32], radius: float) -> bool:
    """Whether the path of one body moves the means of another as its own path does, so that both are one."""
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(means), 1)).astype(np.float32)
    away = [
        float(np.linalg.norm(a.placed(t, means, quats)[0] - b.placed(t, means, quats)[0], axis=1).mean())
        for t in range(len(a.offsets))
    ]
    return float(np.mean(away)) < ALIKE * radius
