"""New objects for a scene: taken from the asset library, scaled to the scene, set down and entered in its table.

Knows assets and scenes. Refuses to know which operation wants them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from ..gaussians import assets
from ..gaussians.camera import Vec3
from ..gaussians.cloud import NO_GROUP, GaussianCloud
from ..gaussians.errors import InstructionError
from ..gaussians.language.field.measure import reach, solid_points
from ..gaussians.scene import Scene
from ..gaussians.world import kinds
from ..gaussians.world.box import Axes
from ..gaussians.world.person import HUNG_AT
from . import field_update
from .cloud_diff import fresh_ids, joined
from .field_update import Newcomer
from .operation import Affine, Context, Length, Placement
from .placement.bodies import Array, Body, as_vec, contact_box, heading
from .placement.occupancy import obstacle_points
from .placement.overhead import Hung, over
from .placement.place import Spot, anchors_of, free_spot, spot_to_hang
from .placement.surroundings import Surroundings
from .transform import transformed

_ROOM = 4.5  # metres across, taken for a scene that gives no other hint of its scale
_STANDING = 1.6  # metres: taller wall things (doors, curtains, wardrobes) reach down to the floor


@dataclass(frozen=True)
class Metre:
    """How many scene units a metre has, and what had to be assumed to say so."""

    units: float
    notes: tuple[str, ...] = ()


def metre(scene: Scene, anchors: Sequence[Body] = ()) -> Metre:
    """The scene's scale: known; or from things whose usual height is known; or as if the scene were one room."""
    if scene.frame.metres_per_unit is not None:
        return Metre(1 / scene.frame.metres_per_unit)
    known = [(b.label, b.box.size[2]) for b in anchors]
    if scene.language is not None and not any(_usual_height(label) for label, _ in known):
        known = [(g.label, g.box.size[2]) for g in scene.language.objects() if g.count and g.label_score > 0.5]
    ratios = sorted(size / usual for label, size in known if (usual := _usual_height(label)))
    if ratios:
        names = ", ".join(dict.fromkeys(label for label, _ in known if _usual_height(label)))
        said = f"the scene's scale is unknown; it was judged by the usual height of: {names}"
        return Metre(ratios[len(ratios) // 2], (said,))
    across = _across(scene)
    return Metre(across / _ROOM, (f"the scene's scale is unknown; it was taken to be {_ROOM:g} m across",))


def _usual_height(label: str) -> float | None:
    """Middle of the usual heights of a kind, metres; None for things the library does not know."""
    kind = kinds.find(label)
    return None if kind is None else (kind.size[2][0] * kind.size[2][1]) ** 0.5


def _across(scene: Scene) -> float:
    """Level extent of the scene, the outer fifth left out at each side, as backgrounds reach far."""
    east, north, _ = scene.frame.basis()
    points = scene.cloud.means[:: max(1, len(scene.cloud) // 50_000)].to(torch.float64).cpu().numpy()
    if not len(points):
        return _ROOM
    spans = [float(np.subtract(*np.quantile(points @ a, [0.9, 0.1]))) for a in (east, north)]
    return max(*spans, 1e-6)


@dataclass(frozen=True, eq=False)
class Piece:
    """An asset in scene units: standing on the origin, +z up, its front along -y.

    Attributes:
        cloud: of the scene's harmonic degree.
        label: its kind.
        size: (width, depth, height) of its solid Gaussians, scene units.
        support: what such things stand on or hang from: "floor", "table", "wall" or "ceiling".
        notes: for the receipt.
    """

    cloud: GaussianCloud
    label: str
    size: Vec3
    support: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Wish:
    """What is wanted from the library: kind, colour, design seed, height, and the scale to make it in."""

    kind: str
    color: str | None
    seed: int
    metre: Metre
    height: Length | None = None


def fetch(scene: Scene, wish: Wish) -> Piece:
    """Make the wished asset in scene units.

    Raises:
        UserError: the library has no such kind, or the colour is unknown.
    """
    made = assets.make(wish.kind, wish.seed, color=wish.color)
    factor, notes = wish.metre.units, wish.metre.notes
    if wish.height is not None:
        factor = wish.height.in_units(scene.frame) / made.size[2]
        notes = wish.height.assumption(scene.frame)
    cloud = transformed(made.cloud, np.eye(3) * factor, np.zeros(3)).with_degree(scene.cloud.degree)
    cloud = cloud.to(scene.cloud.device)
    points = solid_points(cloud, torch.arange(len(cloud), device=cloud.device))
    spans = [reach(points[:, i]) for i in range(3)]
    center = np.array([-(low + high) / 2 for low, high in spans[:2]] + [-spans[2][0]])
    cloud = transformed(cloud, np.eye(3), center)
    size = as_vec(np.array([max(high - low, 1e-6) for low, high in spans]))
    return Piece(cloud, made.kind, size, kinds.table().kinds[made.kind].support, notes)


def set_down(piece: Piece, foot: Array, axes: Axes) -> GaussianCloud:
    """The piece turned so that its width, depth and height run along `axes`, standing at `foot`."""
    return transformed(piece.cloud, np.array(axes).T, foot)


def find_spot(around: Surroundings, piece: Piece, place: Placement | None, start: Array) -> Spot:
    """A spot for a piece, facing the viewer; things for walls and ceilings hang there unless told otherwise.

    Raises:
        InstructionError: there is none.
    """
    if place is not None and place.relation == "above":
        if piece.support not in ("wall", "ceiling"):
            raise InstructionError(f"a {piece.label} stands and does not hang: say on something, or next to it")
        hung: Hung = "wall" if piece.support == "wall" else "ceiling"
        region, axes = over(around, piece.size, anchors_of(around, place)[0], hung)
        return spot_to_hang(around, piece.size, place, region, axes)
    unit = piece.size[2]
    around.lift = 0.0
    if place is None and piece.support == "wall":
        place = Placement(relation="against")
        metre_units = metre(around.scene).units
        around.lift = max(0.0, HUNG_AT * metre_units - unit / 2) if unit < _STANDING * metre_units else 0.0
    if place is None and piece.support == "ceiling":
        heights = around.thin @ around.up.astype(np.float32)
        around.lift = max(0.0, float(np.quantile(heights, 0.995)) - around.floor - unit) if len(heights) else 0.0
    anchors = anchors_of(around, place) if place is not None else []
    axes = standing_axes(around, anchors)
    if place is None or place.relation != "against" or anchors:
        around.back = None
        return free_spot(around, piece.size, axes, place, start)
    for _ in range(3):  # another wall is as good
        try:
            around.back = np.array(axes[1])
            return free_spot(around, piece.size, axes, place, start)
        except InstructionError:
            axes = (axes[1], as_vec(-np.array(axes[0])), axes[2])
    around.back = np.array(axes[1])
    return free_spot(around, piece.size, axes, place, start)


def standing_axes(around: Surroundings, anchors: Sequence[Body]) -> Axes:
    """Axes for a new thing: along its anchor's or the room's, its front (-y) turned to the viewer as far as it goes."""
    base = anchors[0].box.axes if anchors else around.room_axes
    forward = heading(around.context.viewer, around.frame, "forward")
    choices = [sign * np.array(axis) for axis in base[:2] for sign in (1, -1)]
    back = max(choices, key=lambda axis: float(axis @ forward))
    return as_vec(np.cross(back, around.up)), as_vec(back), as_vec(around.up)


def gaze(around: Surroundings) -> Array:
    """`[3]`, where the viewer looks at the floor, or the point of the scene's middle on the floor if nowhere."""
    camera, up = around.context.viewer, around.up
    down = float(camera.forward @ up)
    height = float(camera.position @ up) - around.floor
    middle = np.median(around.thin, axis=0).astype(np.float64) if len(around.thin) else np.zeros(3)
    middle = middle + up * (around.floor - float(middle @ up))
    if down > -0.05 or height <= 0:
        return middle
    seen = camera.position + camera.forward * (height / -down)
    spread = float(np.linalg.norm(np.ptp(np.quantile(around.thin, [0.05, 0.95], axis=0), axis=0)))
    return seen if np.linalg.norm(seen - middle) < spread else middle


@dataclass(eq=False)
class Arrivals:
    """New objects being collected; `enter` makes the new scene of them in one go.

    Attributes:
        scene: what they come into; ids are given out above all of its ids.
        leaving: `[N]` bool, those of its Gaussians that go; the arrivals' rows follow the others. None: all stay.
    """

    scene: Scene
    leaving: Tensor | None = None
    clouds: list[GaussianCloud] = field(default_factory=list)
    newcomers: list[Newcomer] = field(default_factory=list)

    def add(self, cloud: GaussianCloud, label: str, axes: Axes | None, like: int | None = None) -> Tensor:
        """One more object, its Gaussians in place, its box along `axes`; the rows they get in the new cloud."""
        top = self.clouds[-1] if self.clouds else self.scene.cloud
        ids = fresh_ids(top, len(cloud))
        group = torch.full((len(cloud),), NO_GROUP, dtype=torch.int32, device=cloud.device)
        self.clouds.append(cloud.replace(ids=ids, group=group))
        self.newcomers.append(Newcomer(self.clouds[-1], label, axes, like))
        gone = int(self.leaving.sum()) if self.leaving is not None else 0
        first = len(self.scene.cloud) - gone + sum(len(c) for c in self.clouds[:-1])
        return torch.arange(first, first + len(cloud), device=cloud.device)

    def ids(self) -> Tensor:
        """Ids of all arrivals, ascending."""
        return torch.cat([c.ids for c in self.clouds])

    def enter(self, context: Context) -> tuple[Scene, tuple[int, ...]]:
        """The scene with the arrivals, and the group each got."""
        scene = self.scene
        table, groups = field_update.enter(scene.language, self.newcomers, scene.frame, context.encoder)
        filed = [
            cloud.replace(group=torch.full_like(cloud.group, group))
            for cloud, group in zip(self.clouds, groups, strict=True)
        ]
        cloud = joined(scene.cloud, self.leaving, filed)
        if self.leaving is not None:
            gone = scene.cloud.ids[self.leaving]
            table = field_update.thinned(scene.replace(language=table), cloud, gone)
        return scene.replace(cloud=cloud, language=table), tuple(g for g in groups if g >= 0)


def taken_by(cloud: GaussianCloud, scene: Scene, around: Surroundings) -> None:
    """From now on a new object is in the way."""
    points = obstacle_points(cloud)
    if len(points):
        around.take(points.astype(np.float64), contact_box(points.astype(np.float64), scene.frame))


def as_moved(rows: Tensor, support: float | None) -> Affine:
    """A new object (its rows of the new cloud) for the checks: nothing to compare it with, only where it stands."""
    return Affine(rows, np.eye(3), np.zeros(3), rows[:0], support)
