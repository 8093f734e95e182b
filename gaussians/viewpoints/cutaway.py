"""Cuts away what hides a room from outside: the ceiling, walls on the near side, and all above a height."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..language.field.language_field import Group, LanguageField
from ..scene import Scene

F64 = NDArray[np.float64]

CUT_HEIGHT = 2.2  # metres above the floor, where the scale is known: above furniture, below ceilings
TOPS = 0.9  # share of the objects that end below the cut, where the scale is unknown
FLAT = 0.3  # of a typical object's size: thickness up to which a thing at a wall is cut away with it
AGAINST = 0.3  # of a typical object's size: gap up to which a thing is at a wall


@dataclass(frozen=True)
class Cut:
    """What is left out of a view.

    Attributes:
        groups: groups of the language field that are not drawn.
        above: height along the scene's up, scene units, above which nothing is drawn; None draws all heights.
    """

    groups: frozenset[int] = frozenset()
    above: float | None = None

    def __bool__(self) -> bool:
        return bool(self.groups) or self.above is not None

    def kept(self, scene: Scene) -> torch.Tensor:
        """Whether each row `[N]` of the scene's cloud is drawn."""
        cloud = scene.cloud
        kept = torch.ones(len(cloud), dtype=torch.bool, device=cloud.device)
        if self.groups and scene.language is not None:
            leaves = sorted({leaf for g in self.groups for leaf in scene.language.leaves(g)})
            kept &= ~torch.isin(cloud.group, torch.tensor(leaves, dtype=torch.int32, device=cloud.device))
        if self.above is not None:
            up = torch.tensor(scene.frame.up, dtype=cloud.means.dtype, device=cloud.device)
            kept &= cloud.means @ up <= self.above
        return kept

    def apply(self, scene: Scene) -> GaussianCloud:
        """The cloud without what is cut away."""
        return scene.cloud[self.kept(scene)] if self else scene.cloud


NOTHING = Cut()  # all is drawn


def from_above(scene: Scene, groups: Sequence[int] = ()) -> Cut:
    """The cut for a view from above: the ceiling, and all above furniture and above `groups`."""
    field = _field(scene)
    up = scene.frame.up_vector
    ceilings = frozenset(g.id for g in field.groups if g.level == "structure" and g.label == "ceiling")
    tops = [g.box.top(up) for g in field.objects() if g.count]
    asked = [field.groups[g].box.top(up) for g in groups if g not in ceilings]
    if scene.frame.metres_per_unit and scene.frame.floor is not None:
        height = scene.frame.floor + CUT_HEIGHT / scene.frame.metres_per_unit
    elif tops:
        height = float(np.quantile(tops, TOPS))
    else:
        return Cut(ceilings - frozenset(groups))
    margin = 0.05 * field.typical_size
    return Cut(ceilings - frozenset(groups), max([height, *(top + margin for top in asked)]))


def toward_inside(scene: Scene, eye: F64, groups: Sequence[int] = ()) -> Cut:
    """The cut for a view from `eye` `[3]` outside a room: as from above, and the walls between eye and room with the
    flat things on them; from below also the floor. `groups` are kept."""
    field = _field(scene)
    cut = from_above(scene, groups)
    gone = set(cut.groups)
    objects = [g for g in field.objects() if g.count]
    for wall in (g for g in field.groups if g.level == "structure" and g.label == "wall" and g.count):
        thin = int(np.argmin(wall.box.size[:2]))
        middle, outside = wall.box.local(np.stack([field.middle, eye]))[:, thin]
        if middle * outside < 0:
            gone.add(wall.id)
            gone.update(g.id for g in objects if _hangs_on(g, wall, thin, field.typical_size))
    up = scene.frame.up_vector
    floors = [g for g in field.groups if g.level == "structure" and g.label == "floor" and g.count]
    gone.update(g.id for g in floors if float(eye @ up) < g.box.bottom(up))
    return Cut(frozenset(gone) - frozenset(groups), cut.above)


def wall_between(scene: Scene, eye: F64, target: F64) -> bool:
    """Whether a wall hides a point `target` `[3]` of a room from an `eye` `[3]` outside it.

    A thing that hangs on the wall overlaps its plane; it counts as inside the room.
    """
    field = _field(scene)
    for wall in (g for g in field.groups if g.level == "structure" and g.label == "wall" and g.count):
        thin = int(np.argmin(wall.box.size[:2]))
        local = wall.box.local(np.stack([field.middle, eye, target]))
        middle, outside, inner = local[:, thin]
        if middle * outside >= 0:
            continue
        share = min(1.0, outside / (outside - inner)) if outside * (outside - inner) > 0 else 1.0
        crossing = np.delete(np.abs(local[1] + share * (local[2] - local[1])), thin)
        if (crossing <= np.delete(np.array(wall.box.size) / 2, thin)).all():
            return True
    return False


def _hangs_on(thing: Group, wall: Group, thin: int, typical: float) -> bool:
    """Whether a flat thing lies along a wall whose short side is the axis `thin`."""
    normal = np.array(wall.box.axes[thin])
    thick = thing.box.extent(normal)
    gap = abs(float(wall.box.local(np.array(thing.box.center)[None])[0, thin])) - (thick + wall.box.size[thin]) / 2
    return thick <= FLAT * typical and gap <= AGAINST * typical


def _field(scene: Scene) -> LanguageField:
    assert scene.language is not None  # callers check
    return scene.language
