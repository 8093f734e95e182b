"""The ways in which a scene is made smaller, and what a scene becomes at a given strength (`Reducer.at`).

Gaussians are left out from the end of a ranking; those that keep a thing of the language field alive come first in it.
Higher SH bands are left out for the whole scene or for the Gaussians where they show least, and gathered into fewer
sets of coefficients, which SOG stores once each. Values are rounded for formats that pack bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import NO_GROUP, GaussianCloud
from ..files.formats import codebooks
from ..files.formats.morton import morton_sorted
from ..harmonics import SH_C0
from ..language.field.group_index import index_groups
from ..language.field.language_field import LanguageField
from ..scene import Scene
from .importance import Importance, measure
from .rounding import Steps, round_for_sog, round_for_spz, steps_for
from .views import View

I64 = NDArray[np.int64]

FORMAT_SETS = 4  # Gaussians for each set in SOG, which gathers more sets by itself
UNSEEN = 0.1  # of the mean spread, added to each direction of coefficients: other views may show it
SEED = 16
KEPT_OF_GROUP = 16  # Gaussians that every group keeps, so that it can still be found


@dataclass(frozen=True)
class Strength:
    """How much of a scene is left out.

    Attributes:
        count: Gaussians that are kept.
        degree: SH degree that is kept.
        dull: share of the Gaussians that lose all bands above the constant one.
        sets: number of different sets of higher coefficients; 0 leaves them as they are.
        rounding: mean squared error of the pictures that rounding may add.
    """

    count: int
    degree: int
    dull: float = 0.0
    sets: int = 0
    rounding: float = 0.0


class Reducer:
    """Makes a scene smaller at any strength.

    Args:
        scene: the original; nothing in it is changed.
        order: `[N]` rows, the ones to keep first.
        importance: of the original's Gaussians.
        suffix: of the file format, which rounding suits.
    """

    def __init__(self, scene: Scene, order: I64, importance: Importance, suffix: str) -> None:
        self.scene, self.importance, self.suffix = scene, importance, suffix
        self.order, self.least = protected(scene, order)
        self._kept_ids = scene.cloud.ids.numpy()[self.order[: self.least]]
        self._key: tuple[int, float, int] | None = None
        self._harmonics = scene.cloud.sh

    def at(self, strength: Strength) -> Scene:
        """The smaller scene, its rows along a Morton curve; ids and groups are those of the original."""
        return self.finished(self.plain(strength), strength)

    def plain(self, strength: Strength) -> GaussianCloud:
        """The smaller cloud before rounding, in the order of the original's rows."""
        cloud = self.scene.cloud.replace(sh=self._bands(strength))
        return cloud[torch.from_numpy(np.sort(self.order[: max(strength.count, self.least)]))]

    def finished(self, cloud: GaussianCloud, strength: Strength) -> Scene:
        """The scene with these Gaussians, rounded, along a Morton curve, with its language field."""
        return recounted(morton_sorted(self.scene.replace(cloud=self._rounded(cloud, strength))))

    def fewest(self, cloud: GaussianCloud, count: int, views: Sequence[View]) -> GaussianCloud:
        """The `count` Gaussians of a changed, smaller cloud that matter most to some views, and what keeps groups."""
        score = measure(cloud, views).removal
        score[np.isin(cloud.ids.numpy(), self._kept_ids)] = np.inf
        return cloud[torch.from_numpy(np.sort(np.argsort(-score, kind="stable")[:count]))]

    def _rounded(self, cloud: GaussianCloud, strength: Strength) -> GaussianCloud:
        steps = self._steps(cloud, strength.rounding)
        if steps == Steps():
            return cloud
        return round_for_sog(cloud, steps) if self.suffix == ".sog" else round_for_spz(cloud, steps)

    def _steps(self, cloud: GaussianCloud, error: float) -> Steps:
        if self.suffix not in (".sog", ".spz"):
            return Steps()
        return steps_for(self.importance.slopes, self.importance.pixels, len(cloud), error, self.suffix == ".sog")

    def _bands(self, strength: Strength) -> torch.Tensor:
        """`[N, K, 3]` harmonics of all Gaussians of the original; kept for the next call with the same bands.

        What the higher coefficients lose is made up for in the constant one, so that the mean colour over the views
        stays.
        """
        sets = min(strength.sets, max(1, strength.count // FORMAT_SETS))
        key = strength.degree, strength.dull, sets
        if self._key != key:
            self._key, self._harmonics = key, self._gathered(strength, sets)
        return self._harmonics

    def _gathered(self, strength: Strength, sets: int) -> torch.Tensor:
        whole = self.scene.cloud.sh.numpy()
        rest = whole[:, 1 : (strength.degree + 1) ** 2].copy()
        if rest.shape[1] and strength.dull > 0:
            order = np.argsort(self.importance.bands[:, 0], kind="stable")
            rest[order[: round(strength.dull * len(rest))]] = 0
        if rest.shape[1] and 0 < sets < len(rest):
            rest = gathered(rest, sets, self.importance)
        return torch.from_numpy(made_up(whole, rest, self.importance))


def made_up(whole: NDArray[np.float32], rest: NDArray[np.float32], importance: Importance) -> NDArray[np.float32]:
    """Harmonics `[N, k, 3]` with the higher coefficients `rest` `[N, k - 1, 3]` in place of those of `whole`
    `[N, K, 3]`, and the constant one such that the mean colour over the views stays."""
    lost = whole[:, 1:].copy()
    lost[:, : rest.shape[1]] -= rest
    if not lost.any():
        return whole[:, : rest.shape[1] + 1].copy()
    constant = whole[:, 0] + np.einsum("nk,nkc->nc", importance.mean_basis, lost) / SH_C0
    return np.concatenate([constant[:, None].astype(np.float32), rest], axis=1)


def gathered(rest: NDArray[np.float32], sets: int, importance: Importance) -> NDArray[np.float32]:
    """Higher coefficients `[N, K - 1, 3]` replaced by at most `sets` different ones, finer where they show.

    Distances are those that the views see (`Importance.basis_spread`): on a capture of degree 2 that keeps 2.8 dB more
    than distances between coefficients. Rows are drawn again by the root of their weight and clustered together with
    all rows, so that a set stands for rows that matter: 0.8 dB.
    """
    spread = importance.basis_spread[: rest.shape[1], : rest.shape[1]]
    unseen = UNSEEN * max(float(np.trace(spread)), 1e-12) / len(spread)
    root = np.linalg.cholesky(spread + unseen * np.eye(len(spread)))
    flat = np.einsum("nkc,kj->njc", rest, root).astype(np.float32).reshape(len(rest), -1)
    share = np.sqrt(np.maximum(importance.weights, 0))
    rows = flat
    if share.sum() > 0:
        drawn = np.random.default_rng(SEED).choice(len(flat), len(flat), p=share / share.sum())
        rows = np.concatenate([flat, flat[drawn]])
    centres, labels = codebooks.palette(rows, sets)
    back = np.einsum("njc,jk->nkc", centres.reshape(len(centres), -1, 3), np.linalg.inv(root)).astype(np.float32)
    out: NDArray[np.float32] = back[labels[: len(rest)]]
    return out


def recounted(scene: Scene) -> Scene:
    """The scene with the numbers of Gaussians in its language field counted again; all else of the field stays."""
    field = scene.language
    if field is None:
        return scene
    members = index_groups(scene.cloud)
    groups = tuple(
        g if (count := len(members.rows(field.leaves(g.id)))) == g.count else replace(g, count=count)
        for g in field.groups
    )
    table = LanguageField(groups, field.embeddings, field.encoder, field.notes, field.making)
    return scene.replace(language=table)


def protected(scene: Scene, order: I64) -> tuple[I64, int]:
    """The order with the first rows of every group in front, and their number."""
    group = scene.cloud.group.cpu().numpy()[order]
    if scene.language is None or not (group != NO_GROUP).any():
        return order, 1
    by_group = np.argsort(group, kind="stable")  # rows of a group keep the order of importance
    starts = np.searchsorted(group[by_group], group[by_group])
    first = np.zeros(len(order), bool)
    first[by_group] = np.arange(len(order)) - starts < KEPT_OF_GROUP
    first &= group != NO_GROUP
    return np.concatenate([order[first], order[~first]]), int(first.sum())
