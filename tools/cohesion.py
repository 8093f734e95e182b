"""Remarks on whether what an edit of a capture took is the thing that was meant, measured by colours and borders.

A segmentation of a capture cuts a thing in two, or leaves a patch of the wall in it. Where that happens, Gaussians of
one colour lie side by side on both sides of the border of a selection, without an edge between them; or the picture of
what is taken away stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
import torch
from numpy.typing import NDArray

from ..gaussians.color import rgb_to_lab
from ..gaussians.harmonics import dc_to_color
from ..gaussians.language.query.palette import palette
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..gaussians.world.core import core_of, least_opacity
from .carried_objects import is_told_apart
from .cloud_diff import rows_of
from .operation import EditOp

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

STAYS = 0.2  # share of the picture of what is taken away from which it is told that it stays
LARGE, LONG, SMOOTH = 0.25, 0.12, 0.3  # share, reach and smoothness of a border from which it is told
PIECES = 0.6  # share of the largest connected piece below which it is told
MOST_TOLD = 2
MOST = 40_000  # of them, inside and around together
NEAREST = 8  # neighbours of each that are compared
AVERAGED = 8  # Gaussians that a colour is averaged over, on either side
ALIKE = 10.0  # Lab distance up to which there is no edge
AROUND = 0.15  # of the size of a selection: how far around it is looked
FEWEST = 40  # Gaussians at the border below which it tells nothing


_LEAVE = frozenset({"delete", "replace", "move", "scale", "rotate", "exchange", "arrange"})
_SILENT = frozenset({"select", "isolate", "merge", "split", "reframe", "insert"})


@dataclass(frozen=True, eq=False)
class Border:
    """The border of a selection, or of the part of one colour.

    Attributes:
        color: of the part in words.
        share: of the Gaussians of the selection that are in it.
        length: how many of its sampled Gaussians are at the border.
        reach: share of its sampled Gaussians that are there.
        smooth: share of the border that has no edge, in [0, 1].
    """

    color: str
    share: float
    length: int
    reach: float
    smooth: float


def remarks(scene: Scene, op: EditOp, selection: Selection) -> tuple[str, ...]:
    """What makes it doubtful that a selection is what was meant, a sentence each, the worst first; empty in rooms of
    known scale, where names are sure, and for parts of space."""
    query, field = op.query(), scene.language
    if query is None or query.spatial or op.op in _SILENT or field is None or is_told_apart(scene):
        return ()
    if len(selection) < FEWEST or any(field.groups[g].level == "structure" for g in selection.groups):
        return ()
    told = []
    if op.op in _LEAVE and selection.shows is not None and selection.shows >= STAYS:
        told.append(f"{selection.shows:.0%} of its picture looks as before, as more of it belongs to what is behind")
    found = borders(scene, selection)
    for border in found:
        if border.share >= LARGE and border.reach >= LONG and border.smooth >= SMOOTH and border.length >= FEWEST:
            told.append(
                f"its {border.color} goes on without an edge in what stays: it may be a piece of something larger"
            )
            break
    unity = core_of(scene.cloud, rows_of(scene.cloud, selection.ids)).unity
    if unity < PIECES:
        told.append(f"it is in pieces apart from each other, the largest {unity:.0%} of it")
    return tuple(told[:MOST_TOLD])


def borders(scene: Scene, selection: Selection) -> list[Border]:
    """The border of each colour of a selection with what is around it, the largest part first; empty where too little
    of it is solid, or nothing is around it."""
    cloud = scene.cloud
    own, solid = mask_of(cloud, selection.ids), cloud.opacities >= least_opacity(cloud.opacities)
    inner = (own & solid).nonzero().squeeze(1).cpu().numpy()
    if len(inner) < FEWEST:
        return []
    points = cloud.means[torch.from_numpy(inner)].double().cpu().numpy()
    low, high = np.quantile(points, [0.01, 0.99], axis=0)
    pad = AROUND * float((high - low).max())
    least, most = (torch.from_numpy(v).to(cloud.means) for v in (low - pad, high + pad))
    near = ((cloud.means > least) & (cloud.means < most)).all(dim=1)
    outer = (near & ~own & solid).nonzero().squeeze(1).cpu().numpy()
    step = -(-(len(inner) + len(outer)) // MOST)
    inner, outer = inner[::step], outer[::step]
    told = palette(scene, inner)
    where, lab = (np.concatenate(pair) for pair in zip(_placed(scene, inner), _placed(scene, outer), strict=True))
    beside = scipy.spatial.cKDTree(where).query(where[: len(inner)], k=min(NEAREST + 1, len(where)))[1][:, 1:]
    out = beside >= len(inner)
    at = out.sum(axis=1) >= 2
    alike = out & (np.linalg.norm(lab[beside] - lab[: len(inner), None], axis=2) <= ALIKE)
    smooth = alike.sum(axis=1) / np.maximum(out.sum(axis=1), 1)
    found = []
    for k, name in enumerate(told.names):
        edge = (told.part == k) & at
        length = int(edge.sum())
        reach = length / max(int((told.part == k).sum()), 1)
        lies = float(smooth[edge].mean()) if length else 0.0
        found.append(Border(name, float(told.shares[k]), length, reach, lies))
    return found


def _placed(scene: Scene, rows: I64) -> tuple[F64, F64]:
    """Centres `[M, 3]` of some rows and the colours around them, CIE Lab, averaged on their own side of the border."""
    cloud, at = scene.cloud, torch.from_numpy(rows)
    points = cloud.means[at].double().cpu().numpy()
    rgb = dc_to_color(cloud.sh[at, 0]).clamp(0, 1).double().cpu().numpy()
    if not len(rows):
        return points, rgb
    count = min(AVERAGED, len(rows))
    near = scipy.spatial.cKDTree(points).query(points, k=count)[1].reshape(len(rows), count)
    return points, rgb_to_lab(torch.from_numpy(rgb[near].mean(axis=1))).numpy()
