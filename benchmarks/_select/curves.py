"""The points of the chart, time against mIoU of names, for all settings on the same rooms."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from statistics import fmean

import numpy as np

from ...gaussians.language.encoders import Encoder
from ...gaussians.language.segmentation.segment import VIEWS_PER_CANDIDATE
from .. import _clip, _data
from .._effort.named import words
from ..harness import Metric, Point
from . import lifted, pictures, vectors
from .cases import Case, Part, embedded
from .stability import names_miou
from .variants import forgetful, without_negatives, without_size
from .vectors import Outcome

WIDTHS = (8, 32, 128)
GROUPED = ("groups", "true groups")
ACCEPTED = 0.01  # loss of mIoU of groups against vectors above which a note explains it


def measure(rooms: Sequence[Case], encoder: Encoder, grouped: Callable[[Case], Case], quick: bool) -> tuple[Part, ...]:
    """All points; quick runs leave out lifted masks and vectors of single Gaussians."""
    counts = (1, VIEWS_PER_CANDIDATE) if quick else (1, 2, VIEWS_PER_CANDIDATE, 4)
    bare = portraits(rooms, encoder, grouped, counts), rules(rooms, encoder, grouped)
    if quick:
        return (*bare, Part(notes=("quick runs leave out lifted masks and vectors of single Gaussians",)))
    return (*bare, lifted.points(rooms, encoder), against_vectors(rooms, encoder))


def portraits(rooms: Sequence[Case], encoder: Encoder, grouped: Callable[[Case], Case], counts: Sequence[int]) -> Part:
    """The embedded path with one to four portraits a thing."""
    points = []
    for count in counts:
        known = [grouped(room) if count == VIEWS_PER_CANDIDATE else embedded(room, encoder, count) for room in rooms]
        name = f"{count} portrait{'s' * (count > 1)}{words('embed') if count == VIEWS_PER_CANDIDATE else ''}"
        points.append(_embedded_point(name, known, encoder, count == VIEWS_PER_CANDIDATE))
    return Part(points=tuple(points))


def rules(rooms: Sequence[Case], encoder: Encoder, grouped: Callable[[Case], Case]) -> Part:
    """The default field, queried under rules without the size term or the negatives."""
    known = [grouped(room) for room in rooms]
    ways = {"no size": without_size(encoder), "no negatives": without_negatives(encoder)}
    ways["neither"] = without_size(ways["no negatives"])
    points = (_embedded_point(n, [forgetful(k) for k in known], way, method="rule") for n, way in ways.items())
    return Part(points=tuple(points))


def _embedded_point(
    setting: str, known: Sequence[Case], encoder: Encoder, default: bool = False, method: str = "embedded"
) -> Point:
    miou = fmean(v for case in known for v in names_miou(case, encoder))
    seconds, held = fmean(case.seconds for case in known), fmean(case.field_bytes for case in known)
    return Point(method, setting, seconds, miou, int(held), default)


def against_vectors(rooms: Sequence[Case], encoder: Encoder) -> Part:
    """Groups and vectors of all widths from the same true masks: with the embedded encoder, and with real vectors."""
    found: dict[tuple[str, str], list[Outcome]] = {}
    folder = _data.folder("clip_vectors")
    pairs = _clip.load(folder.parent) if folder else None
    for room in rooms:
        eyes = pictures.eyes(room.scene, lifted.VIEWS, lifted.SIZE)
        tellers: list[tuple[str, Encoder, pictures.Pictured, list[str], tuple[int, ...]]] = [
            ("crops", encoder, pictures.Crops(encoder), [o.kind for o in room.alone()], WIDTHS)
        ]
        if pairs is not None:
            tellers.append(_real(room, pairs))
        for method, asked, pictured, names, widths in tellers:
            up = vectors.uplift(room, [pictures.true_masks(room, eye, pictured, i) for i, eye in enumerate(eyes)])
            found.setdefault((method, "groups"), []).append(vectors.as_groups(room, up, asked, names))
            found.setdefault((method, "true groups"), []).append(vectors.as_true_groups(room, up, asked, names))
            for width in widths:
                outcome = vectors.as_vectors(room, up, asked, names, width)
                found.setdefault((method, f"{width} a Gaussian"), []).append(outcome)
    return Part(_losses(found), tuple(_outcome_point(*way, outcomes) for way, outcomes in found.items()), _why(found))


def _real(room: Case, pairs: _clip.Pairs) -> tuple[str, Encoder, pictures.Pictured, list[str], tuple[int, ...]]:
    """Real vectors: each kind's class among those of all kinds that the names know, asked by the kind's word."""
    meant = {kind: sorted(pairs.encoder.vocabulary.covered(kind)) for kind in room.present}
    row = {kind: pairs.names.index(classes[0]) for kind, classes in meant.items() if len(classes) == 1}
    exemplars = np.zeros((len(room.objects), pairs.images.shape[1]))
    for o in room.objects:
        if o.kind in row:
            exemplars[o.id] = pairs.images[row[o.kind]]
    competing = np.array(sorted({*_clip.room_rows(pairs).tolist(), *row.values()}))
    count = {r: sum(room.present[k] for k in row if row[k] == r) for r in row.values()}
    names = [o.kind for o in room.alone() if o.kind in row and count[row[o.kind]] == 1]
    photos = pictures.Photos(exemplars, np.random.default_rng([zlib.crc32(b"photos"), room.seed]))
    return "real vectors", pairs.among(competing), photos, names, (*WIDTHS, 512)


def _outcome_point(method: str, setting: str, outcomes: Sequence[Outcome]) -> Point:
    seconds, held = fmean(o.seconds for o in outcomes), fmean(o.bytes for o in outcomes)
    return Point(method, setting, seconds, vectors.miou(outcomes), int(held))


def _losses(found: dict[tuple[str, str], list[Outcome]]) -> tuple[Metric, ...]:
    """For each setting the margin in probability, the time of a query, and the gain of groups over vectors."""
    metrics = []
    for (method, setting), outcomes in found.items():
        key = f"{method.replace(' ', '_')}.{setting.replace(' ', '_')}"
        metrics.append(Metric(f"{key}.margin", fmean(o.margin for o in outcomes), "probability", "higher", 0.1))
        metrics.append(Metric(f"{key}.query", 1e3 * fmean(o.query for o in outcomes), "ms", "lower", 0.5))
        if setting not in GROUPED:
            gain = vectors.miou(found[method, GROUPED[0]]) - vectors.miou(outcomes)
            metrics.append(Metric(f"{key}.groups_gain", gain, "IoU"))
    return tuple(metrics)


def _why(found: dict[tuple[str, str], list[Outcome]]) -> tuple[str, ...]:
    """Notes on the names where groups lose to vectors, and on the share of the loss due to mask association."""
    notes = []
    for method in dict.fromkeys(method for method, _ in found):
        groups, flawless = (found[method, setting] for setting in GROUPED)
        rivals = {s: outcomes for (m, s), outcomes in found.items() if m == method and s not in GROUPED}
        best = max(rivals, key=lambda setting: vectors.miou(rivals[setting]))
        loss = vectors.miou(rivals[best]) - vectors.miou(groups)
        if loss <= ACCEPTED:
            notes.append(f"{method}: groups lose at most {ACCEPTED:g} mIoU to vectors of any width from the same masks")
            continue
        lost = sorted(((b - a, name) for g, v in zip(groups, rivals[best], strict=True)
                       for name, a, b in zip(g.names, g.iou, v.iou, strict=True)), reverse=True)  # fmt: skip
        worst = ", ".join(f"{name} {value:.2f}" for value, name in lost[:5])
        gain = vectors.miou(flawless) - vectors.miou(rivals[best])
        notes.append(
            f"{method}: groups lose {loss:.3f} mIoU to {best}, most at {worst}; the loss comes from the "
            "association of masks (masks of one object in two groups, or discarded): with masks grouped by the true "
            f"objects, groups are better by {gain:.3f}"
            if gain > 0
            else f"{method}: groups lose {loss:.3f} mIoU to {best}, most at {worst}, {-gain:.3f} of it even with masks "
            "grouped by the true objects: a group's single vector is refused where some of its Gaussians' are not"
        )
    return tuple(notes)
