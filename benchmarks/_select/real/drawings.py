"""Outlines drawn by hand on photographs, silhouettes of selected Gaussians, and how well the two agree.

The chosen Gaussians are rendered white and the others black from the camera of a photograph, so that the whole scene
hides them where it would; this silhouette is compared with the outlines. Photographs and masks of the captures may be
used for measuring but not be redistributed; the outlines in `drawn/` are our own.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from ....gaussians.camera import Camera
from ....gaussians.files.captures.capture import read_capture
from ....gaussians.harmonics import color_to_dc
from ....gaussians.render import render, split
from ....gaussians.scene import Scene

Bools = NDArray[np.bool_]
UNLABELED = 255  # pixel value without annotation
MIN_PIXELS = 200  # pixels of a thing from which a photo counts as showing it
IGNORE, BACKGROUND = "ignore", "background"  # names of regions that are not counted, and that show nothing drawn
ROUNDS = 4  # passes of the local search of `best_union`


@dataclass(frozen=True, eq=False)
class Drawing:
    """One annotated photo: its camera, and the label of each pixel `[H, W]`."""

    camera: Camera
    labels: NDArray[np.uint8]

    def shows(self, labels: Sequence[int]) -> bool:
        """Whether enough of these labels is in the photo to judge by."""
        return int(np.isin(self.labels, labels).sum()) >= MIN_PIXELS


def cameras(capture: Path) -> dict[str, Camera]:
    """The cameras of a capture by the name of the photo without its suffix."""
    return {Path(camera.name).stem: camera for camera in read_capture(capture).cameras}


def painted(capture: Path, folder: str, photos: Sequence[str] = ()) -> list[Drawing]:
    """The label images in a folder of a capture, of all photos or of these."""
    from PIL import Image

    by_name = cameras(capture)
    found = []
    for path in sorted((capture / folder).glob("*.png")):
        if not photos or path.stem in photos:
            labels = np.array(Image.open(path))
            found.append(Drawing(by_name[path.stem].resized(labels.shape[1], labels.shape[0]), labels))
    return found


def outlined(capture: Path, outlines: Path, numbers: Mapping[str, int]) -> list[Drawing]:
    """The photos of a file of outlines: closed polygons in full-size pixels, a later one covers an earlier one."""
    from PIL import Image, ImageDraw

    by_name = cameras(capture)
    found = []
    for name, photo in json.loads(outlines.read_text(encoding="utf-8")).items():
        image = Image.new("L", tuple(photo["size"]), 0)
        for thing, points in photo["regions"]:
            ImageDraw.Draw(image).polygon(points, fill=numbers[thing])
        found.append(Drawing(by_name[name].resized(*photo["size"]), np.array(image)))
    return found


def silhouette(scene: Scene, chosen: Bools, camera: Camera) -> Bools:
    """`[H, W]`: pixels mostly covered by the chosen Gaussians `[N]`, with occlusion by the whole scene."""
    return silhouettes(scene, chosen[None], camera)[0]


def silhouettes(scene: Scene, chosen: Bools, camera: Camera) -> Bools:
    """`[K, H, W]`: the silhouettes of K choices `[K, N]`; three share a render, one in each colour."""
    found: list[Bools] = []
    for start in range(0, len(chosen), 3):
        three = np.zeros((3, chosen.shape[1]), np.float32)
        three[: len(chosen[start : start + 3])] = chosen[start : start + 3]
        colors = torch.from_numpy(np.ascontiguousarray(three.T))
        cloud = scene.cloud.with_degree(0).replace(sh=color_to_dc(colors)[:, None].contiguous())
        seen = (render(cloud, camera).rgb > 0.5).numpy()
        found += [seen[..., k] for k in range(len(chosen[start : start + 3]))]
    return np.stack(found) if found else np.zeros((0, camera.height, camera.width), bool)


def agreement(found: Bools, drawing: Drawing, labels: Sequence[int]) -> float | None:
    """Intersection over union of a silhouette and the annotated labels; None if the photo does not show them."""
    true, counted = np.isin(drawing.labels, labels), drawing.labels != UNLABELED
    if true.sum() < MIN_PIXELS:
        return None
    shown = found & counted
    return float((shown & true).sum() / (shown | true).sum())


def mean_agreement(shown: Sequence[Bools], drawn: Sequence[Drawing], labels: Sequence[int]) -> float | None:
    """Mean over the photos that show the labels of the agreement with one silhouette a photo; None if none does."""
    each = [agreement(s, d, labels) for s, d in zip(shown, drawn, strict=True)]
    known = [value for value in each if value is not None]
    return fmean(known) if known else None


@dataclass(frozen=True, eq=False)
class Weights:
    """Blending weight of every Gaussian in every label of every photo.

    Attributes:
        by_label: for each photo `[N, L]`, the weight in pixels of each label.
        labels: for each photo the L labels, those to be ignored left out.
    """

    by_label: tuple[csr_matrix, ...]
    labels: tuple[NDArray[np.int32], ...]

    @classmethod
    def of(cls, scene: Scene, drawn: Sequence[Drawing]) -> Weights:
        """Those of a scene; one pass of the rasteriser for each photo."""
        tables, names = [], []
        for drawing in drawn:
            shares = split(scene.cloud, drawing.camera, drawing.labels.astype(np.int32))
            kept = shares.labels != UNLABELED
            found, column = np.unique(shares.labels[kept], return_inverse=True)
            size = (len(scene.cloud), len(found))
            tables.append(
                csr_matrix((shares.weights[kept].astype(np.float64), (shares.rows[kept], column)), shape=size)
            )
            names.append(found.astype(np.int32))
        return cls(tuple(tables), tuple(names))

    def best_union(self, owner: NDArray[np.integer], drawn: Sequence[Drawing], labels: Sequence[int]) -> Bools:
        """`[N]`: the union of whole groups that agrees best with some labels over all photos.

        Ordered by the share of a group's weight inside the labels, the best union by pooled weight is a prefix; a
        local search then adds and removes single groups by the mean over photos.

        Args:
            owner: `[N]` group of each Gaussian, negative for none.
        """
        grouped = self._grouped(owner, drawn, labels)
        return np.zeros(len(owner), bool) if grouped is None else np.isin(owner, _choose(*grouped))

    def best_group(self, owner: NDArray[np.integer], drawn: Sequence[Drawing], labels: Sequence[int]) -> Bools:
        """`[N]`: the single group that agrees best with some labels over all photos; see `best_union`."""
        grouped = self._grouped(owner, drawn, labels)
        if grouped is None:
            return np.zeros(len(owner), bool)
        inside, outside, true = grouped
        best: Bools = owner == int((inside / (true[:, None] + outside)).mean(axis=0).argmax())
        return best

    def _grouped(
        self, owner: NDArray[np.integer], drawn: Sequence[Drawing], labels: Sequence[int]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
        """The arguments of `_choose`, of the photos that show the labels; None if none does."""
        count = int(owner.max(initial=-1)) + 1
        own = np.flatnonzero(owner >= 0)
        member = csr_matrix((np.ones(len(own)), (owner[own], own)), shape=(count, len(owner)))
        inside, outside, true = [], [], []
        for table, names, drawing in zip(self.by_label, self.labels, drawn, strict=True):
            if not drawing.shows(labels):
                continue
            grouped, is_true = np.asarray((member @ table).todense()), np.isin(names, labels)
            inside.append(grouped[:, is_true].sum(axis=1))
            outside.append(grouped[:, ~is_true].sum(axis=1))
            true.append(float(np.isin(drawing.labels, labels).sum()))
        return (np.stack(inside), np.stack(outside), np.array(true)) if true else None


def _choose(inside: NDArray[np.float64], outside: NDArray[np.float64], true: NDArray[np.float64]) -> NDArray[np.int64]:
    """Numbers of the groups of the best union.

    Args:
        inside, outside: `[V, G]` weight of each group inside and outside of the truth in each photo.
        true: `[V]` pixels of the truth.
    """
    gain, cost = (inside / true[:, None]).sum(axis=0), (outside / true[:, None]).sum(axis=0)
    order = np.argsort(-gain / np.maximum(gain + cost, 1e-12), kind="stable")
    pooled = np.cumsum(gain[order]) / (len(true) + np.cumsum(cost[order]))
    chosen = np.zeros(inside.shape[1], bool)
    chosen[order[: int(pooled.argmax()) + 1]] = True
    worth = np.flatnonzero(gain > 1e-3)
    if len(worth) > 2000:  # single Gaussians: the prefix is as good as a search
        return np.flatnonzero(chosen)
    have, extra = inside[:, chosen].sum(axis=1), outside[:, chosen].sum(axis=1)
    reached = float((have / (true + extra)).mean())
    for _ in range(ROUNDS):
        before = reached
        for g in worth.tolist():
            sign = -1 if chosen[g] else 1
            now = float(((have + sign * inside[:, g]) / (true + extra + sign * outside[:, g])).mean())
            if now > reached:
                chosen[g], reached = not chosen[g], now
                have, extra = have + sign * inside[:, g], extra + sign * outside[:, g]
        if reached == before:
            break
    return np.flatnonzero(chosen)
