"""The colours of some Gaussians: which of them have which colour, with folds and shadows counted to their material.

Colours are averaged over the nearest Gaussians, so that grain and the black ones under a weave do not count, and
compared at one lightness: light scales a and b of CIE Lab with lightness, so the folds of a purple cloth keep its hue.
These colours are clustered; those that are too dark, or as near to one cluster as to another, go with what is around
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import torch
from numpy.typing import NDArray

from ...color import BASIC, name_of, rgb_to_lab, shade_of
from ...errors import UserError
from ...harmonics import dc_to_color
from ...scene import Scene
from ..field.measure import lit_of
from ..segmentation.surface import MIN_OPACITY
from .attributes import color_scores

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

AVERAGED = 12  # Gaussians that a colour is averaged over
WIDELY = 60  # the same where it is dark
DIM = 22.0  # lightness below which it is dark
SHOWN = 40.0  # lightness that dark colours are shown at to tell their hue
HUED = 8.0  # chroma that they have there at least
SAMPLE = 30_000  # Gaussians that colours are found on
LEVEL = 45.0  # lightness at which hues are compared
STEEPEST = 3.0  # factor by which the hue of dark colours is raised at most
LIGHT = 0.4  # weight of lightness beside a and b
DARK = 7.0  # lightness below which a colour has no hue
CLUSTERS = 6
APART = 14.0  # distance of colours below which two clusters are one
CLEAR = 0.8  # of the distance to the second nearest cluster: up to which a colour is of the nearest
NEIGHBOURS = 9  # clear Gaussians that decide an unclear one
SMALLEST = 0.015  # share by area of a colour that is told
GREY = 12.0  # chroma below which a colour has no hue
HUE = 0.38  # cosine of the angle between two hues up to which one may be called by the other, if nothing fits better
MATCHES = 0.05  # score of a word from which a colour has it
DIMMED = 0.9  # factor of the score that a dark colour would have in more light
_ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Palette:
    """The colours of some rows of a cloud.

    Attributes:
        rows: `[M]` int64, ascending.
        part: `[M]` int64, the colour of each row.
        labs: `[C, 3]` CIE Lab of the lit places of each colour, the largest first.
        shares: `[C]` of each by area; sums to one.
    """

    rows: I64
    part: I64
    labs: F64
    shares: F64

    @property
    def names(self) -> tuple[str, ...]:
        """The colours in words; of dark ones as more light would show them."""
        told = []
        for lab, lit in zip(self.labs, self._lit, strict=True):
            hued = lab[0] < DIM and float(np.linalg.norm(lit[1:])) > HUED
            name = name_of((float(lit[0]), float(lit[1]), float(lit[2]))) if hued else ""
            told.append(f"dark {name}" if name in BASIC else name_of((float(lab[0]), float(lab[1]), float(lab[2]))))
        return tuple(told)

    @property
    def _lit(self) -> F64:
        """The colours `[C, 3]` as they would be in light enough to tell hues."""
        lit = self.labs.copy()
        dim = lit[:, 0] < DIM
        lit[dim, 1:] *= (SHOWN + 16) / (lit[dim, :1] + 16)
        lit[dim, 0] = SHOWN
        return lit

    def of(self, words: Sequence[str]) -> I64:
        """The rows that have any of some colours; ascending, empty if no colour has one of them.

        Raises:
            UserError: a colour word is unknown.
        """
        chosen = np.zeros(len(self.labs), bool)
        lit = self._lit
        for word in words:
            scores = np.maximum(color_scores(word, self.labs), DIMMED * color_scores(word, lit))
            said = np.array([word in name.split() for name in self.names])
            hits = said | ((scores >= MATCHES) & (scores >= 0.5 * scores.max(initial=0.0)))
            chosen |= hits if hits.any() else self._of_hue(word)
        found: I64 = self.rows[chosen[self.part]]
        return found

    def of_hue(self, word: str) -> NDArray[np.bool_]:
        """Which colours `[C]` have nearly the hue of a word, whatever their lightness; none if the word names a grey.

        Raises:
            UserError: it is no colour word.
        """
        return self._nearness(word) >= HUE

    def _of_hue(self, word: str) -> NDArray[np.bool_]:
        """Which colour `[C]` has most nearly the hue of a word; none if no colour has."""
        near = self._nearness(word)
        return np.asarray((near >= HUE) & (near == near.max()))

    def _nearness(self, word: str) -> F64:
        """Cosine `[C]` of the angle between the hue of each colour and that of a word; -1 for greys."""
        asked = rgb_to_lab(torch.tensor(shade_of(word), dtype=torch.float64)).numpy()[1:]
        own = self._lit[:, 1:]
        chroma = np.linalg.norm(own, axis=1)
        if np.linalg.norm(asked) < GREY:
            return np.full(len(own), -1.0)
        cosine = own @ asked / np.maximum(chroma * np.linalg.norm(asked), 1e-9)
        return np.where(chroma >= GREY, cosine, -1.0)

    def told(self) -> str:
        """The colours that are more than a trace: "white (69%), red (28%)"; those of one name count together."""
        total: dict[str, float] = {}
        for name, share in zip(self.names, self.shares.tolist(), strict=True):
            total[name] = total.get(name, 0.0) + share
        seen = sorted(total.items(), key=lambda item: -item[1])
        return ", ".join(f"{name} ({share:.0%})" for name, share in seen if share >= SMALLEST)


def palette(scene: Scene, rows: I64) -> Palette:
    """The colours of some rows `[M]` of a scene, ascending.

    Raises:
        UserError: no row is given.
    """
    from scipy.spatial import cKDTree

    if not len(rows):
        raise UserError("there is nothing whose colours could be told")
    at = torch.from_numpy(rows)
    cloud = scene.cloud
    opacity = cloud.opacities[at].double().cpu().numpy()
    solid = np.flatnonzero(opacity > MIN_OPACITY)
    solid = solid if len(solid) else np.arange(len(rows))
    solid = solid[:: -(-len(solid) // SAMPLE)]
    rgb = dc_to_color(cloud.sh[at[solid], 0]).clamp(0, 1).double().cpu().numpy()
    sides = cloud.scales[at[solid]].double().sort(dim=1).values.cpu().numpy()
    area = sides[:, 1] * sides[:, 2] * opacity[solid]
    area = np.minimum(area, np.quantile(area, 0.98)) + 1e-12
    points = cloud.means[at].double().cpu().numpy()
    lab = _averaged(points[solid], rgb, area)
    hue = _hue(lab)
    centers = _clusters(hue, area * (lab[:, 0] >= DARK) + 1e-12 * area)
    own = _smoothed(hue, lab[:, 0], points[solid], centers)
    part = own[cKDTree(points[solid]).query(points)[1]] if len(solid) < len(rows) else own
    return _ordered(rows, part, own, area, lab)


def _averaged(points: F64, rgb: F64, area: F64) -> F64:
    """CIE Lab `[M, 3]` of the colour around each point, by area; dark places are averaged farther, as of dark
    Gaussians hardly any tells the hue."""
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    lab = _around(tree, points, rgb, area, AVERAGED)
    dim = np.flatnonzero(lab[:, 0] < DIM)
    if len(dim):
        lab[dim] = _around(tree, points[dim], rgb, area, WIDELY)
    return lab


def _around(tree: cKDTree, points: F64, rgb: F64, area: F64, count: int) -> F64:
    count = min(count, len(rgb))
    near = tree.query(points, k=count)[1].reshape(len(points), count)
    weight = area[near]
    mean = (rgb[near] * weight[..., None]).sum(axis=1) / weight.sum(axis=1, keepdims=True)
    lab: F64 = rgb_to_lab(torch.from_numpy(mean)).numpy()
    return lab


def _hue(lab: F64) -> F64:
    """Colours `[M, 3]` as they are compared: a and b at one lightness, and some of the lightness."""
    level = (LEVEL + 16) / (lab[:, :1] + 16)
    return np.concatenate([lab[:, 1:] * np.minimum(level, STEEPEST), LIGHT * lab[:, :1]], axis=1)


def _clusters(hue: F64, weight: F64) -> F64:
    """Centres `[C, 3]` of the clusters of some colours: k-means from the farthest points, near ones joined."""
    bins, place = np.unique(np.round(hue / 4).astype(np.int64), axis=0, return_inverse=True)
    mass = np.bincount(place.reshape(-1), weights=weight)
    spots = bins * 4.0
    centers: NDArray[np.floating] = spots[[int(mass.argmax())]]
    common = mass > 0.002 * mass.sum()
    for _ in range(CLUSTERS - 1):
        far = np.linalg.norm(spots[:, None] - centers[None], axis=2).min(axis=1) * common * np.sqrt(mass)
        if not far.max(initial=0.0) > 0:
            break
        centers = np.concatenate([centers, spots[[int(far.argmax())]]])
    for _ in range(_ROUNDS):
        own = np.linalg.norm(spots[:, None] - centers[None], axis=2).argmin(axis=1)
        total = np.bincount(own, weights=mass, minlength=len(centers))
        sums = np.stack(
            [np.bincount(own, weights=mass * spots[:, k], minlength=len(centers)) for k in range(3)], axis=1
        )
        centers = np.where(total[:, None] > 0, sums / np.maximum(total, 1e-20)[:, None], centers)
    own = np.linalg.norm(spots[:, None] - centers[None], axis=2).argmin(axis=1)
    total = np.bincount(own, weights=mass, minlength=len(centers))
    while len(centers) > 1:
        apart = np.linalg.norm(centers[:, None] - centers[None], axis=2) + 1e9 * np.eye(len(centers))
        i, j = (int(v) for v in np.unravel_index(int(apart.argmin()), apart.shape))
        if apart[i, j] >= APART:
            break
        both = max(float(total[i] + total[j]), 1e-20)
        centers[i] = (total[i] * centers[i] + total[j] * centers[j]) / both
        total[i] = both
        keep = np.arange(len(centers)) != j
        centers, total = centers[keep], total[keep]
    return centers.astype(np.float64)


def _smoothed(hue: F64, light: F64, where: F64, centers: F64) -> I64:
    """The cluster of each place; unclear ones go with the clear ones around them."""
    from scipy.spatial import cKDTree

    if len(centers) == 1:
        return np.zeros(len(hue), np.int64)
    apart = np.linalg.norm(hue[:, None] - centers[None], axis=2)
    best = apart.argmin(axis=1)
    ranked = np.sort(apart, axis=1)
    clear = (light >= DARK) & (ranked[:, 0] <= CLEAR * ranked[:, 1])
    if clear.all() or not clear.any():
        return best
    count = min(NEIGHBOURS, int(clear.sum()))
    near = cKDTree(where[clear]).query(where[~clear], k=count)[1].reshape(int((~clear).sum()), count)
    votes = np.stack([(best[clear][near] == c).mean(axis=1) for c in range(len(centers))], axis=1)
    nearness = 1 / (1 + apart[~clear] / APART)
    best[~clear] = (votes + 0.5 * nearness * (light[~clear, None] >= DARK)).argmax(axis=1)
    return best


def _ordered(rows: I64, part: I64, own: I64, area: F64, lab: F64) -> Palette:
    """The palette with the largest colour first, each told by its lit places.

    Args:
        part: `[M]` colour of each row.
        own, area, lab: of the Gaussians that the colours were found on.
    """
    total = np.bincount(own, weights=area)
    order = np.argsort(-total, kind="stable")
    order = order[total[order] > 0]
    rank = np.zeros(len(total), np.int64)
    rank[order] = np.arange(len(order))
    labs = []
    for k in order.tolist():
        weight = area[own == k] / max(float(area[own == k].sum()), 1e-20)
        labs.append(lit_of(torch.from_numpy(weight), torch.from_numpy(lab[own == k])).numpy())
    return Palette(rows, rank[part], np.array(labs), total[order] / total.sum())
