"""Pieces of floor, walls and ceiling that the segmentation left as things of their own.

They are large and flat, and lie in the plane of a floor, wall or ceiling, or at the border of a room whose wall there
is not known.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....camera import Vec3
from ....scene import Scene
from ....world.kinds import Kind
from ...field.language_field import Group, LanguageField

F64 = NDArray[np.float64]

FLAT = 0.3  # thickness by the second longest side up to which a piece is flat
LARGE = 0.2  # longest side by the room's middle extent from which a piece is large
ROOM_SIZED = 0.6  # second longest side by the room's middle extent from which something is no thing in it
WIDE = 0.5  # longest side by the room's middle extent from which a piece of any colour belongs to the plane it lies in
COPLANAR = 0.015  # of the room's diagonal: distance from the plane of a structure within which a piece lies in it
NEAR = 0.1  # likewise, within which a structure is the border of the room there
THIN = 0.02  # of the room's diagonal: thickness up to which what lies on the floor is a covering of it
PARALLEL = 0.9  # cosine of the angle between the normals
BEYOND = 0.03  # share of the Gaussians that lie farther out than a piece at the border of the room
SAME_COLOR = 25.0  # distance in CIE Lab below which a flat piece has the colour of the structure that it lies in
MOST_POINTS = 4000
_KEPT = 4


@dataclass(frozen=True, eq=False)
class Slab:
    """A flat piece, or the plane of a structure: centre, unit normal and ascending sides `[3]`, colour in CIE Lab."""

    center: F64
    normal: F64
    sides: F64
    lab: Vec3 | None


@dataclass(frozen=True, eq=False)
class Shell:
    """The planes and bounds of a room.

    Attributes:
        planes: its floors, walls and ceilings.
        up: `[3]` unit.
        extents: `[3]` extents of the scene without the outermost 2 % on each side, ascending, scene units.
        sample: `[S, 3]` centres of some Gaussians, scene units.
        objects: the objects that are large and flat, by id.
    """

    planes: tuple[Slab, ...]
    up: F64
    extents: F64
    sample: F64
    objects: dict[int, Slab]

    def is_room_sized(self, size: Vec3) -> bool:
        """Whether something is too large for a thing in the room."""
        return float(np.sort(size)[1]) > ROOM_SIZED * float(self.extents[1])

    def remnants(self, kind: Kind | None) -> frozenset[int]:
        """Objects that are pieces of floor, wall or ceiling, and not the kind of thing that is asked for."""
        return frozenset(i for i, slab in self.objects.items() if self._is_piece(slab, kind))

    def is_remnant(self, points: F64, lab: Vec3, kind: Kind | None) -> bool:
        """Whether Gaussians with these centres `[M, 3]` and of this colour are such a piece."""
        if len(points) < 4:
            return False
        points = points[:: max(1, len(points) // MOST_POINTS)]
        center = np.median(points, axis=0)
        values, vectors = np.linalg.eigh(np.cov((points - center).T))
        sides = np.sqrt(np.maximum(values, 0) * 12.0)  # of a box with these variances
        return self._is_large(sides) and self._is_piece(Slab(center, vectors[:, 0], sides, lab), kind)

    def _is_large(self, sides: F64) -> bool:
        return bool(sides[0] <= FLAT * sides[1] and sides[2] >= LARGE * self.extents[1])

    def _is_piece(self, slab: Slab, kind: Kind | None) -> bool:
        """Whether a large flat piece belongs to a structure.

        What lies in the plane of a structure belongs to it if it has its colour or is very wide; what covers the floor,
        unless rugs are asked for. Where no structure is near, what has nothing behind it is a wall or a floor itself.
        """
        diagonal, thick = float(np.linalg.norm(self.extents)), float(slab.sides[0])
        level = abs(float(slab.normal @ self.up)) > PARALLEL
        rug = kind is not None and kind.is_rug
        bordered = False
        for plane in self.planes:
            if abs(float(plane.normal @ slab.normal)) < PARALLEL:
                continue
            away = abs(float((slab.center - plane.center) @ plane.normal)) - thick / 2
            bordered |= away < NEAR * diagonal
            if away > COPLANAR * diagonal:
                continue
            if slab.lab is None or plane.lab is None or np.linalg.norm(np.subtract(slab.lab, plane.lab)) < SAME_COLOR:
                return True
            if not rug and (slab.sides[2] > WIDE * self.extents[1] or (level and thick < THIN * diagonal)):
                return True
        if bordered or (kind is not None and (rug or kind.opening or kind.support == "wall")):
            return False
        along = self.sample @ slab.normal
        beyond = float((along > slab.center @ slab.normal + thick).mean())
        before = float((along < slab.center @ slab.normal - thick).mean())
        return min(beyond, before) < BEYOND


_known: OrderedDict[int, tuple[weakref.ref[LanguageField], Shell]] = OrderedDict()


def shell_of(scene: Scene, field: LanguageField) -> Shell:
    """The shell of a scene, made on the first call for its field."""
    if (known := _known.get(id(field))) is not None and known[0]() is field:
        _known.move_to_end(id(field))
        return known[1]
    made = _shell(scene, field)
    _known[id(field)] = (weakref.ref(field), made)
    while len(_known) > _KEPT:
        _known.popitem(last=False)
    return made


def _shell(scene: Scene, field: LanguageField) -> Shell:
    sample = scene.cloud.means[:: max(1, len(scene.cloud) // 20_000)].double().cpu().numpy()
    low, high = np.quantile(sample, [0.02, 0.98], axis=0) if len(sample) else np.zeros((2, 3))
    there = [g for g in field.groups if g.count]
    planes = tuple(_slab(g) for g in there if g.level == "structure")
    empty = Shell(planes, scene.frame.up_vector, np.sort(high - low), sample, {})
    slabs = {g.id: _slab(g) for g in there if g.level == "object"}
    flat = {i: slab for i, slab in slabs.items() if empty._is_large(slab.sides)}
    return Shell(planes, empty.up, empty.extents, sample, flat)


def _slab(group: Group) -> Slab:
    thin = int(np.argmin(group.box.size))
    return Slab(np.array(group.box.center), np.array(group.box.axes[thin]), np.sort(group.box.size), group.lab)
