"""Queries by bare name in furnished rooms: kinds that occur once, more than once, or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np
import torch

from ...gaussians import assets
from ...gaussians.camera import Camera
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.query.selection import Verdict
from ...gaussians.render import render
from .._iou import Mask, border_iou, contour_iou, iou, trimap_iou
from ..harness import Metric
from .cases import RIGHT, Case, Part, ask

WIDE = 0.1  # metres: deeper than a splat of wall or floor, which are up to 6 cm long
PICTURE = (480, 320)  # pixels of the pictures that selections are drawn in
SHOWN = 100  # pixels of a thing from which a picture shows it
ABSENT = 20  # names of kinds of ours that are not in the room, asked of each room
# Things of which we have no asset and that no calibration used; no head noun among them names one of our kinds.
STRANGE = (
    "accordion", "anvil", "birdcage", "canoe", "chainsaw", "fire hydrant", "giraffe", "hammock", "helicopter",
    "ironing board", "jet ski", "lawn mower", "parking meter", "rocking horse", "sewing machine", "skateboard",
    "snowman", "stroller", "surfboard", "telescope", "trombone", "trumpet", "violin", "wheelchair",
)  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """One room's answers.

    Attributes:
        iou, border, trimap: of each kind that is there once, 0 where it was refused; None where it has no border.
        wide: as `border`, of a border `WIDE` deep.
        drawn: as `border`, of the silhouettes of truth and answer, each drawn alone; None where no camera shows it.
        verdicts: of the same.
        oracle, oracle_border: of the best group for each object.
        union: IoU of the best union of groups for each object.
        several: verdicts for kinds that are there more than once.
        absent, strange: verdicts for names of our kinds that are not there, and of what is no kind of ours.
    """

    iou: list[float]
    border: list[float | None]
    wide: list[float | None]
    drawn: list[float | None]
    trimap: list[float | None]
    verdicts: list[Verdict]
    oracle: list[float]
    oracle_border: list[float | None]
    union: list[float]
    several: list[Verdict]
    absent: list[Verdict]
    strange: list[Verdict]


def ask_names(case: Case, encoder: Encoder) -> Asked:
    """All bare names of one embedded room."""
    answers = [(o, ask(case, o.kind, encoder)) for o in case.alone()]
    groups = case.groups()
    best = [_best(groups, case.truth(o)) for o in case.objects]
    # An armchair may be called the chair where no plain chair stands, so neither word is absent then.
    missing = [k for k in assets.kinds(shown=True) if not any(there.endswith(k) for there in case.present)]
    chosen = np.random.default_rng(case.seed).choice(missing, ABSENT, replace=False)
    return Asked(
        iou=[iou(case.truth(o), a.mask) for o, a in answers],
        border=[border_iou(case.truth(o), a.mask, case.points) for o, a in answers],
        wide=[border_iou(case.truth(o), a.mask, case.points, WIDE) for o, a in answers],
        drawn=[_drawn(case, case.truth(o), a.mask) for o, a in answers],
        trimap=[trimap_iou(case.truth(o), a.mask, case.points) for o, a in answers],
        verdicts=[a.verdict for _, a in answers],
        oracle=[iou(m, case.truth(o)) for m, o in zip(best, case.objects, strict=True)],
        oracle_border=[border_iou(case.truth(o), m, case.points) for m, o in zip(best, case.objects, strict=True)],
        union=[case.best_union(case.truth(o)) for o in case.objects],
        several=[ask(case, kind, encoder).verdict for kind, n in sorted(case.present.items()) if n > 1],
        absent=[ask(case, str(kind), encoder).verdict for kind in chosen],
        strange=[ask(case, name, encoder).verdict for name in STRANGE],
    )


def _best(groups: Sequence[Mask], truth: Mask) -> Mask:
    """The group that agrees best with an object."""
    return groups[int(np.argmax([iou(mask, truth) for mask in groups]))]


def _drawn(case: Case, truth: Mask, found: Mask) -> float | None:
    """Boundary IoU of silhouettes: the chosen Gaussians drawn alone, mean over the cameras that show the thing."""
    scores = []
    for camera in case.scene.cameras:
        small = camera.resized(*PICTURE)
        true = _silhouette(case, truth, small)
        if true.sum() >= SHOWN:
            scores.append(contour_iou(true, _silhouette(case, found, small)))
    return fmean(scores) if scores else None


def _silhouette(case: Case, mask: Mask, camera: Camera) -> Mask:
    """`[H, W]` bool: where some Gaussians, drawn alone, cover half of a pixel."""
    return (render(case.scene.cloud[torch.from_numpy(mask)], camera).alpha > 0.5).numpy()


def miou(rooms: Sequence[Asked]) -> float:
    """Mean over all names asked of things that are there once."""
    return fmean(v for room in rooms for v in room.iou)


def measure(rooms: Sequence[Asked], seconds: Sequence[float]) -> Part:
    """The figures over all rooms; `seconds` that embedding each took."""
    found = [v for r in rooms for v in r.iou]
    verdicts = [v for r in rooms for v in r.verdicts]
    oracle = [v for r in rooms for v in r.oracle]
    borders, wide, drawn, trimaps, best = (
        [v for r in rooms for v in getattr(r, key) if v is not None]
        for key in ("border", "wide", "drawn", "trimap", "oracle_border")
    )
    absent, strange, several = ([v for r in rooms for v in getattr(r, key)] for key in ("absent", "strange", "several"))
    metrics = (
        Metric("name.miou", fmean(found), "IoU", "higher", 0.03, 0.85),
        Metric("name.boundary_iou", fmean(drawn), "IoU", "higher", 0.03, 0.85),
        Metric("name.boundary_iou_3cm", fmean(borders), "IoU", "higher", 0.03),
        Metric("name.boundary_iou_10cm", fmean(wide), "IoU", "higher", 0.03),
        Metric("name.trimap_iou", fmean(trimaps), "IoU", "higher", 0.03),
        Metric("name.right", fmean(v >= RIGHT for v in found), "share", "higher", 0.03),
        Metric("name.refused", verdicts.count("absent") / len(verdicts), "share", "lower", 0.5, 0.05),
        Metric("name.ambiguous", verdicts.count("ambiguous") / len(verdicts), "share", "lower", 0.5),
        Metric("name.asked", len(found), "count"),
        Metric("oracle.union.miou", fmean(v for r in rooms for v in r.union), "IoU", "higher", 0.03, 0.95),
        Metric("oracle.miou", fmean(oracle), "IoU", "higher", 0.03, 0.95),
        Metric("oracle.right", fmean(v >= RIGHT for v in oracle), "share", "higher", 0.03),
        Metric("oracle.boundary_iou_3cm", fmean(best), "IoU", "higher", 0.03),
        Metric("absent.refused", absent.count("absent") / len(absent), "share", "higher", 0.03, 0.95),
        Metric("absent.asked", len(absent), "count"),
        Metric("strange.refused", strange.count("absent") / len(strange), "share", "higher", 0.03, 0.95),
        Metric("strange.asked", len(strange), "count"),
        Metric("several.ambiguous", several.count("ambiguous") / max(len(several), 1), "share", "higher", 0.05, 0.95),
        Metric("several.asked", len(several), "count"),
        Metric("embed.room.seconds", fmean(seconds), "s", "lower", 0.3),
    )
    notes = (
        f"names: {len(rooms)} furnished rooms from held-out seeds. A kind that a room holds once is asked by name; a "
        f"kind that it holds several times must be reported ambiguous. right: an IoU of Gaussians of {RIGHT} or more",
        f"absent: {ABSENT} of our kinds that a room does not hold. strange: {len(STRANGE)} names outside our kinds, "
        "which an encoder with a finite vocabulary refuses by the words alone",
        "boundary IoU (Cheng et al. 2021): of the rims of silhouettes, 2 % of the picture's diagonal wide; the true "
        "and the selected Gaussians are rendered alone from the room's cameras. At 3 and 10 cm: the same in 3D, of "
        "the members within that distance of a non-member; the splats of floor and walls are 4 to 6 cm wide. Trimap "
        "IoU: of truth and answer among all Gaussians within 3 cm of the true border, on both sides",
    )
    return Part(metrics, notes=notes)
