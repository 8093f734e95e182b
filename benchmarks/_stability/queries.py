"""Rows of queries in rooms that are embedded once: thresholds, absent names, negation, sides, borders, vectors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from statistics import fmean

import numpy as np

from ...gaussians.assets import TruthObject
from ...gaussians.color import BASIC
from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds
from .._iou import Mask, border_iou, iou
from .._rows import Row
from .._select import relations
from .._select.cases import Case, ask
from .._select.mirror import mirrored
from .._select.spatial import SIDES
from .._select.stability import names_miou
from .._select.variants import forgetful, with_threshold
from .ground import Ground

TIMES = (1.5, 2.0, 4.0)  # factors on the threshold, up and down
PLATEAU = 0.95  # share of the frozen rule's score that belongs to its plateau
GRID = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8)
UNKNOWN = ("flurbo", "zibblewick", "quantum stapler", "gribbet", "wompus", "moss harp", "tardle", "neon walrus")
EDGES = (0.1, 0.05, 0.03, 0.02)  # metres from a border


def rows(ground: Ground) -> Iterator[Row]:
    """All of them."""
    yield from _thresholds(ground)
    yield _ceiling(ground)
    yield from _absent(ground)
    yield from _negation(ground)
    yield from _sides(ground)
    yield _borders(ground)
    yield from _small(ground)
    yield from _vectors(ground)
    yield _luck(ground)


# -- thresholds -----------------------------------------------------------------------------------------------------


def _score(case: Case, threshold: float, ground: Ground) -> float:
    """Mean of the IoU of names and of the share of as many absent names that are refused."""
    encoder, case = with_threshold(ground.encoder, threshold), forgetful(case)
    absent = _absent_kinds(case, ground, len(case.alone()))
    refused = fmean(ask(case, name, encoder).verdict == "absent" for name in absent)
    return (fmean(names_miou(case, encoder)) + refused) / 2


def _absent_kinds(case: Case, ground: Ground, count: int) -> list[str]:
    there = [k for k in ground.encoder.vocabulary.names if k not in case.present]
    return [str(k) for k in np.random.default_rng(case.seed).choice(there, count, replace=False)]


def _thresholds(ground: Ground) -> Iterator[Row]:
    frozen = ground.encoder.calibration.threshold

    @cache
    def score(case: Case, threshold: float) -> float:
        return _score(case, threshold, ground)

    def of(threshold: float) -> float:
        return fmean(score(case, threshold) for case in ground.known)

    own = of(frozen)
    along = [(f"x{t:g} or /{t:g}", min(of(min(frozen * t, 0.95)), of(frozen / t))) for t in TIMES]
    yield ground.row("query.threshold", own, along, "score")
    plateau = [t for t in GRID if of(t) >= PLATEAU * max(of(t) for t in GRID)]
    width = max(plateau) / min(plateau)
    yield ground.row("query.threshold_plateau", 2.0, [("highest over lowest", min(width, 2.0))], "x")
    if len(ground.known) > 1:
        best = fmean(max(score(case, t) for t in (*GRID, frozen)) for case in ground.known)
        left = [
            score(case, max(GRID, key=lambda t: fmean(score(c, t) for c in ground.known if c is not case)))
            for case in ground.known
        ]
        values = [("frozen rule", own), ("fitted on the others", fmean(left))]
        yield ground.row("query.leave_one_scene_out", best, values, "score")


def _ceiling(ground: Ground) -> Row:
    """The best union of groups, and what names find: what is lost by the match of names alone."""
    best = fmean(c.best_union(c.truth(o)) for c in ground.known for o in c.alone())
    return ground.row("query.names_below_oracle", best, [("by name", ground.miou(ground.known))])


# -- what is not there ----------------------------------------------------------------------------------------------


def _absent(ground: Ground) -> Iterator[Row]:
    encoder = ground.encoder

    def refused(pairs: Sequence[tuple[Case, Query]]) -> float:
        return fmean(ask(case, query, encoder).verdict == "absent" for case, query in pairs)

    far = [(c, Query(text=k)) for c in ground.known for k in _absent_kinds(c, ground, 20)]
    near = [(c, Query(text=k)) for c in ground.known for k in _relatives(c, ground)][: len(far)]
    made = [(c, Query(text=k)) for c in ground.known for k in UNKNOWN]
    values = [("other kinds", refused(far)), ("made-up words", refused(made)), ("their relatives", refused(near))]
    yield ground.row("query.absent", 1.0, values, "share refused", len(far) + len(near) + len(made))
    wrong = [(c, Query(text=o.kind, colors=(_other_color(o),))) for c in ground.known for o in c.alone()]
    yield ground.row("query.absent_colour", 1.0, [("another colour", refused(wrong))], "share refused", len(wrong))


def _relatives(case: Case, ground: Ground) -> list[str]:
    """Kinds that are not there, of a family of which something is."""
    names = set(ground.encoder.vocabulary.names)
    found = [
        other
        for family in kinds.table().families.values()
        if any(k in case.present for k in family)
        for other in family
        if other in names and other not in case.present
    ]
    return sorted(set(found))


def _other_color(thing: TruthObject) -> str:
    """A basic colour far from the thing's."""
    opposite = {
        "red": "blue",
        "blue": "orange",
        "green": "purple",
        "yellow": "blue",
        "orange": "blue",
        "purple": "green",
    }
    own = thing.color.split()[-1]
    return opposite.get(own, "red" if own in BASIC else "blue")


def _negation(ground: Ground) -> Iterator[Row]:
    """What is left without a thing, against the thing itself."""
    encoder = ground.encoder
    plain = fmean(v for c in ground.known for v in names_miou(c, encoder))

    def against(make: Callable[[str], Query], truth: Callable[[Case, TruthObject], Mask]) -> float:
        return fmean(
            iou(ask(c, make(o.kind), encoder).mask & (c.ids >= 0), truth(c, o)) for c in ground.known for o in c.alone()
        )

    def rest(case: Case, thing: TruthObject) -> Mask:
        return np.asarray((case.ids >= 0) & (case.ids != thing.id))

    values = [
        ("everything but", against(lambda k: Query(text="everything", pick="all", exclude=(Query(text=k),)), rest)),
        ("inverted", against(lambda k: Query(text=k, invert=True), rest)),
        ("twice inverted", against(
            lambda k: Query(text="everything", pick="all", exclude=(Query(text=k, invert=True),)),
            lambda c, o: c.truth(o),
        )),
    ]  # fmt: skip
    yield ground.row("query.negation", plain, values)


# -- sides ----------------------------------------------------------------------------------------------------------


def _sides(ground: Ground) -> Iterator[Row]:
    """Relations before the first camera, before others, and in the mirror."""
    encoder = ground.encoder

    def right(cases_: Sequence[Case], eyes: Sequence[int], beside: bool = True) -> tuple[float, int]:
        every = [
            (c, one)
            for c in cases_
            for one in relations.generate(c, eyes)
            if (one.name in SIDES) == beside and one.frame == "viewer"
        ]
        good = [relations.right(c, one, encoder) for c, one in every]
        return (fmean(good) if good else 1.0), len(good)

    one, n = right(ground.known, (0,))
    values = [(f"camera {i + 1}", right(ground.known, (i,))[0]) for i in (1, 2)]
    yield ground.row("query.viewer_moved", one, values, "share right", n)
    if not ground.quick:
        flipped = ground.embedded([mirrored(room) for room in ground.rooms])
        yield ground.row("query.mirrored_sides", one, [("mirrored", right(flipped, (0,))[0])], "share right", n)
        other, m = right(flipped, (0,), beside=False)
        base = right(ground.known, (0,), beside=False)[0]
        yield ground.row("query.mirrored_contact", base, [("mirrored", other)], "share right", m)
    contact, m = right(ground.known, (0,), beside=False)
    yield ground.row("query.relations", 1.0, [("sides", one), ("contact and order", contact)], "share right", n + m)


# -- borders and sizes ----------------------------------------------------------------------------------------------


def _borders(ground: Ground) -> Row:
    """IoU of what names find, and only near the borders."""
    found = [
        (c, c.truth(o), answer.mask)
        for c in ground.known
        for o in c.alone()
        if (answer := ask(c, o.kind, ground.encoder)).means(c.truth(o))
    ]
    whole = fmean(iou(mask, truth) for _, truth, mask in found)

    def near(metres: float) -> float:
        each = [border_iou(truth, mask, c.points, metres) for c, truth, mask in found]
        return fmean(v for v in each if v is not None)

    return ground.row("query.border", whole, [(f"{d * 100:g} cm", near(d)) for d in EDGES], n=len(found))


def _small(ground: Ground) -> Iterator[Row]:
    """The best group for each thing, by how large and how thin it is."""
    best = [
        (o, max(iou(mask, c.truth(o)) for mask in groups))
        for c in ground.known
        for groups in (c.groups(),)
        for o in c.objects
    ]
    large = fmean(v for o, v in best if max(o.size) >= 0.5)

    def upto(measure: Callable[[TruthObject], float], low: float, high: float) -> float | None:
        values = [v for o, v in best if low <= measure(o) < high]
        return fmean(values) if values else None

    for name, measure, steps in (
        ("query.small_things", lambda o: max(o.size), (0.5, 0.35, 0.25, 0.15)),
        ("query.thin_things", lambda o: min(o.size), (0.2, 0.1, 0.05, 0.02)),
    ):
        values = [
            (f"below {high * 100:g} cm", value)
            for low, high in zip((*steps[1:], 0.0), steps, strict=True)
            if (value := upto(measure, low, high)) is not None
        ]
        if values:
            yield ground.row(name, large, values, n=len(best))


# -- vectors --------------------------------------------------------------------------------------------------------


def _vectors(ground: Ground) -> Iterator[Row]:
    """Noise in the vectors of the groups, and fewer bits of them."""

    def changed(spoil: Callable[[np.ndarray, np.random.Generator], np.ndarray]) -> float:
        cases_ = []
        for case in ground.known:
            field = case.scene.language
            assert field is not None
            vectors = spoil(field.embeddings.copy(), np.random.default_rng(case.seed))
            there = np.linalg.norm(field.embeddings, axis=1, keepdims=True) > 0
            vectors = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12) * there
            scene = case.scene.replace(language=replace(field, embeddings=vectors.astype(np.float32)))
            cases_.append(replace(case, scene=scene))
        return ground.miou(cases_)

    def noisy(cosine: float) -> float:
        size = np.sqrt(1 / cosine**2 - 1)
        return changed(lambda v, rng: v + size * rng.standard_normal(v.shape) / np.sqrt(v.shape[1]))

    def rounded(bits: int) -> float:
        def spoil(v: np.ndarray, rng: np.random.Generator) -> np.ndarray:
            top = np.abs(v).max(axis=1, keepdims=True).clip(1e-12)
            steps = 2 ** (bits - 1) - 0.5
            return (np.floor(v / top * steps) + 0.5) / steps * top

        return changed(spoil)

    base = ground.miou(ground.known)
    yield ground.row("query.vector_noise", base, [(f"cosine {c:g}", noisy(c)) for c in (0.98, 0.95, 0.9, 0.8)])
    yield ground.row("query.vector_bits", base, [(f"{b} bits", rounded(b)) for b in (8, 4, 2, 1)])


def _luck(ground: Ground) -> Row:
    """The mean room and the worst one: what the choice of seeds makes."""
    each = [fmean(names_miou(c, ground.encoder)) for c in ground.known]
    return ground.row("query.worst_room", fmean(each), [("worst room", min(each))])
