"""The surfaces of a selection: Gaussians that share one map, because they have nearly the same colour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.language.field.measure import mean_lab, sample
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..placement.bodies import rows_by_thing
from .materials import Materials, Parts, materials

SAME_COLOR = 20.0  # Lab distance, lightness weighted by half, below which things share one colour map
_MEAN = 2048  # Gaussians that the mean of a thing is measured on


@dataclass(frozen=True, eq=False)
class Surfaces:
    """What of a selection is painted, and what is left.

    Attributes:
        painted: `[M]` int64 ascending rows of each surface; every surface gets a map of its own.
        parts: parts of other hues that are left as they are: colour in words and share of the selection.
        left: `[M]` int64 rows of these parts.
    """

    painted: tuple[Tensor, ...]
    parts: Parts
    left: Tensor

    def note(self) -> str | None:
        """What was left, for the receipt; None if nothing was."""
        if not self.parts:
            return None
        told = ", ".join(f"{name} ({share:.0%})" for name, share in self.parts[:4])
        return f'parts of other colours were left as they are: {told}; say "the whole ..." to include them'


def surfaces(scene: Scene, selection: Selection, *, whole: bool = False, bare: GaussianCloud | None = None) -> Surfaces:
    """The surfaces of a selection: one for all things of nearly the same colour, else one for each thing.

    So patches of one cloth keep their shading relative to each other, while a white and a black chair both turn red.
    What is left is told by the colours that are seen; what shares a map, by those of `bare`.

    Args:
        whole: paint parts of other hues too, each as a surface of its own.
        bare: the cloud before any paint (see `gaussians.painted`); None: as it is.
    """
    things: list[Tensor] = []
    parts: dict[str, float] = {}
    left = [torch.zeros(0, dtype=torch.int64)]
    apart = _apart(scene, selection)
    count = max(sum(len(rows) for rows in apart), 1)
    bare = scene.cloud if bare is None else bare
    for rows in apart:
        made = materials(scene.cloud, rows)
        main, *others = _by_material(rows, made)
        things += [main] if bare is scene.cloud else _by_material(main, materials(bare, main))
        if whole:
            things += others
            continue
        for name, share in made.shares:
            parts[name] = parts.get(name, 0.0) + share * len(rows) / count
        left.append(rows[~made.main])
    painted = alike(scene.replace(cloud=bare), [rows for rows in things if len(rows)])
    told = tuple(sorted(parts.items(), key=lambda p: -p[1]))
    return Surfaces(painted, told, torch.cat(left).sort().values)


def _by_material(rows: Tensor, made: Materials) -> list[Tensor]:
    """The rows of each material of a thing, the main one first."""
    return [rows[made.main], *(rows[made.part == n] for n in range(1, len(made.shares) + 1))]


def _apart(scene: Scene, selection: Selection) -> list[Tensor]:
    """Rows of each selected thing; those of things that were not selected as such (a region of colour) together."""
    chosen: list[Tensor] = []
    others: list[Tensor] = []
    for group, rows in rows_by_thing(scene, selection):
        (chosen if group in selection.groups else others).append(rows)
    return [*chosen, *([torch.cat(others).sort().values] if others else [])]


def alike(scene: Scene, things: Sequence[Tensor]) -> tuple[Tensor, ...]:
    """Rows of things, put together where their mean colours are within `SAME_COLOR`."""
    found: list[tuple[Tensor, list[Tensor]]] = []
    for rows in things:
        mean = mean_lab(sample(scene.cloud, rows, _MEAN))
        for other, same in found:
            if float(torch.linalg.vector_norm((mean - other) * torch.tensor([0.5, 1, 1]))) < SAME_COLOR:
                same.append(rows)
                break
        else:
            found.append((mean, [rows]))
    return tuple(torch.cat(same).sort().values for _, same in found)
