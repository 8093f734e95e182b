"""The ways in which a scene is made smaller, and what a scene becomes at a given strength (`Reducer.at`).

Gaussians are left out from the end of a ranking; those that keep a thing of the language field alive come first in it.
Higher SH bands are left out for the whole scene or for the Gaussians where they show least, and gathered into fewer
sets of coefficients, which SOG stores once each. Values are rounded for formats that pack bytes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import NO_GROUP, GaussianCloud
from ..files.formats import codebooks
from ..files.formats.morton import morton_sorted
from ..language.field.group_index import index_groups
from ..language.field.language_field import LanguageField
from ..scene import Scene
from .importance import Importance
from .rounding import Steps, round_for_sog, round_for_spz, steps_for

I64 = NDArray[np.int64]

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
        self.order, self.least = _protected(scene, order)
        self._harmonics: dict[tuple[int, float, int], torch.Tensor] = {}

    def at(self, strength: Strength) -> Scene:
        """The smaller scene, its rows along a Morton curve; ids and groups are those of the original."""
        cloud = self.scene.cloud.replace(sh=self._bands(strength))
        kept = cloud[torch.from_numpy(np.sort(self.order[: max(strength.count, self.least)]))]
        smaller = morton_sorted(self.scene.replace(cloud=self._rounded(kept, strength)))
        return recounted(smaller)

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
        """`[N, K, 3]` harmonics of all Gaussians of the original; computed once for each strength."""
        key = strength.degree, strength.dull, strength.sets
        if key not in self._harmonics:
            sh = self.scene.cloud.with_degree(min(strength.degree, self.scene.cloud.degree)).sh
            if sh.shape[1] > 1 and strength.dull > 0:
                order = np.argsort(self.importance.bands[:, 0], kind="stable")
                sh = sh.clone()
                sh[torch.from_numpy(order[: round(strength.dull * len(sh))]), 1:] = 0
            if sh.shape[1] > 1 and 0 < strength.sets < len(sh):
                rest = sh[:, 1:].reshape(len(sh), -1).contiguous().numpy()
                centres, labels = codebooks.palette(rest, strength.sets)
                gathered = torch.from_numpy(centres[labels]).reshape(len(sh), -1, 3)
                sh = torch.cat([sh[:, :1], gathered], dim=1)
            self._harmonics[key] = sh.contiguous()
        return self._harmonics[key]


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


def _protected(scene: Scene, order: I64) -> tuple[I64, int]:
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
