"""New objects in a scene: make an asset, scale it to the scene, find a spot for it and add it to the group table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import torch
from torch import Tensor

from ..gaussians.camera import Vec3
from ..gaussians.cloud import NO_GROUP, GaussianCloud
from ..gaussians.errors import InstructionError
from ..gaussians.language.field.measure import reach, solid_points
from ..gaussians.language.field.scale import SHAPE
from ..gaussians.scene import Scene
from ..gaussians.world import finishes, kinds
from ..gaussians.world.box import Axes, Box
from ..gaussians.world.person import HUNG_AT
from . import field_update
from .cloud_diff import fresh_ids, joined
from .field_update import NewObject
from .operation import Affine, AssetSource, Context, Length, Placement
from .placement.bodies import Array, Body, as_vec, contact_box, heading
from .placement.occupancy import obstacle_points
from .placement.overhead import Mount, region_above
from .placement.place import Spot, anchors_of, free_spot, hanging_spot
from .placement.seen_surface import seen_height
from .placement.surroundings import FLOOR_WORDS, Surroundings
from .transform import transformed

if TYPE_CHECKING:
    from .harmony.form import Pigment

_ASSUMED_WIDTH = 4.5  # metres, assumed width of a scene that gives no other hint of its scale
_EYES = 1.35  # metres above the floor at which people hold a camera that they point at a room
_THIN = 0.6  # depth over the shorter of its other sides: what falls over
_FEW_EYES = 8  # cameras that tell it
_FLOOR_BAND, _FLOOR_SHARE = 0.05, 0.03  # of that height, how thick a floor is; of the scene's Gaussians, its share
_SURE = 0.5  # probability from which a name tells a size
_WIDER = 1.3  # of the footprint of what is replaced: how wide a thing of unknown scale may be in its place
# How furniture of a colour is painted or stained where nobody asked for one.
_PAINTS = {
    "red": "#8e3b32", "blue": "#465c7c", "green": "#5c7250", "yellow": "#c29a4c", "orange": "#b66a3e",
    "purple": "#68506f", "pink": "#c08d93", "brown": "#96683f", "black": "#2e2c2b", "white": "#dedad0",
    "gray": "#84858a", "beige": "#c6b597",
}  # fmt: skip
_AXIS, _FIRST, _FEW_MET = 0.06, 0.25, 12  # tangent of the angle about a viewer's axis; which point there, of how many
_DETAIL = 2.5  # of library assets: people look at new things from close by
_DOOR_HEIGHT = 1.6  # metres: taller objects at walls (doors, curtains, wardrobes) reach down to the floor


@dataclass(frozen=True)
class SceneScale:
    """How many scene units a metre has, and the assumptions behind that as notes for the receipt.

    `guessed` where nothing in the scene told it.
    """

    units_per_metre: float
    notes: tuple[str, ...] = ()
    guessed: bool = False


def scene_scale(scene: Scene, anchors: Sequence[tuple[Body, str]] = ()) -> SceneScale:
    """The scene's scale: the known one, else what the sizes of named things tell, else the assumed width of a room.

    A thing tells the scale by the middle of the usual sizes of its kind, if its length and its height agree: what does
    not have the shape of its kind is misnamed, or was found only in part.

    Args:
        anchors: things near the new one, each with what the user calls it ("" if nothing); they count twice.
    """
    if scene.frame.metres_per_unit is not None:
        return SceneScale(1 / scene.frame.metres_per_unit)
    votes: list[tuple[float, str]] = []
    for body, word in anchors:
        votes += 2 * _vote(body.box, word or _sure_label(scene, body.group))
    if scene.language is not None:
        near = {body.group for body, _ in anchors}
        for group in scene.language.objects():
            if group.count and group.id not in near and group.label_score > _SURE:
                votes += _vote(group.box, group.label)
    if votes:
        names = ", ".join(dict.fromkeys(name for _, name in votes))
        said = f"the scene's scale is unknown; it was judged by the usual size of: {names}"
        return SceneScale(float(np.exp(np.median([value for value, _ in votes]))), (said,))
    if long := [
        vote for body, word in anchors for vote in _long_vote(body.box, word or _sure_label(scene, body.group))
    ]:
        said = (
            f"the scene's scale is unknown; it was judged by the usual length of: {', '.join(name for _, name in long)}"
        )
        return SceneScale(float(np.exp(np.median([value for value, _ in long]))), (said,))
    if (eyes := _by_eyes(scene)) is not None:
        said = "the scene's scale is unknown; it was judged by the height from which people photograph a floor"
        return SceneScale(eyes, (said,), guessed=True)
    across = _across(scene)
    said = f"the scene's scale is unknown; it was taken to be {_ASSUMED_WIDTH:g} m across"
    return SceneScale(across / _ASSUMED_WIDTH, (said,), guessed=True)


def _sure_label(scene: Scene, group: int) -> str:
    """The name of a group if it is sure, else ""."""
    if scene.language is None or group < 0 or scene.language.groups[group].label_score <= _SURE:
        return ""
    return scene.language.groups[group].label


def _vote(box: Box, name: str) -> list[tuple[float, str]]:
    """Logarithm of units per metre that a thing of that name tells, and the name; empty if its shape is another."""
    kind = kinds.find(name) if name else None
    if kind is None or min(box.size) <= 0:
        return []
    width, depth, height = kind.usual_size
    by_length, by_height = np.log(max(box.size[:2]) / max(width, depth)), np.log(box.size[2] / height)
    return [] if abs(by_length - by_height) > np.log(SHAPE) else [(float(by_length + by_height) / 2, name)]


def _long_vote(box: Box, name: str) -> list[tuple[float, str]]:
    """As `_vote`, by the longest side alone: what is found only in part, or lies, is hardly longer than its kind."""
    kind = kinds.find(name) if name else None
    if kind is None or max(box.size) <= 0:
        return []
    usual = max(kind.usual_size)
    return [(float(np.log(max(box.size) / usual)), name)]


def _by_eyes(scene: Scene) -> float | None:
    """Scene units per metre if the cameras are as high above the floor as people hold them; None without cameras or
    where no floor was seen from them."""
    if len(scene.cameras) < _FEW_EYES or scene.frame.floor is None:
        return None
    up, floor = scene.frame.up_vector, scene.frame.floor
    high = float(np.median([c.position @ up for c in scene.cameras])) - floor
    points = scene.cloud.means[:: max(1, len(scene.cloud) // 50_000)].to(torch.float64).cpu().numpy()
    near = np.abs(points @ up - floor) < _FLOOR_BAND * abs(high)
    return high / _EYES if high > 0 and near.mean() > _FLOOR_SHARE else None


def _across(scene: Scene) -> float:
    """Horizontal extent of the scene, scene units, without the outer tenth of the points at each side (backgrounds)."""
    east, north, _ = scene.frame.basis()
    points = scene.cloud.means[:: max(1, len(scene.cloud) // 50_000)].to(torch.float64).cpu().numpy()
    if not len(points):
        return _ASSUMED_WIDTH
    return max(*[float(np.subtract(*np.quantile(points @ a, [0.9, 0.1]))) for a in (east, north)], 1e-6)


@dataclass(frozen=True, eq=False)
class ScaledAsset:
    """An asset in scene units: it stands on the origin, +z up, its front along -y.

    Attributes:
        cloud: of the scene's harmonic degree.
        label: its kind.
        size: (width, depth, height) of its solid Gaussians, scene units.
        support: what its kind stands on or hangs from: "floor", "table", "wall" or "ceiling".
        notes: for the receipt.
        pigment: colours of its Gaussians without light; None if they cannot be told from its light.
    """

    cloud: GaussianCloud
    label: str
    size: Vec3
    support: str
    notes: tuple[str, ...] = ()
    pigment: Pigment | None = None


@dataclass(frozen=True)
class AssetRequest:
    """A request to the asset library: kind, colour, design seed, height, the scene's scale, the user's own assets."""

    kind: str
    color: str | None
    seed: int
    scale: SceneScale
    height: Length | None = None
    own: AssetSource | None = None


def make_asset(scene: Scene, request: AssetRequest) -> ScaledAsset:
    """Make the requested asset in scene units.

    Raises:
        UserError: the library has no such kind, or the colour is unknown.
    """
    from .harmony.form import Pigment

    made, told = request.own.natural(request.kind, request.color) if request.own is not None else (None, ())
    owned = made is not None
    if made is None:
        from ..gaussians import assets

        color = request.color or _usual_color(request) or _usual_paint(request)
        made = assets.make(_known_name(request.kind), request.seed, color=color, detail=_DETAIL)
    factor, notes = request.scale.units_per_metre, request.scale.notes
    if request.height is not None:
        factor = request.height.in_units(scene.frame) / made.size[2]
        notes = request.height.assumption(scene.frame)
    cloud = transformed(made.cloud, np.eye(3) * factor, np.zeros(3)).with_degree(scene.cloud.degree)
    cloud = cloud.to(scene.cloud.device)
    points = solid_points(cloud, torch.arange(len(cloud), device=cloud.device))
    spans = [reach(points[:, i]) for i in range(3)]
    center = np.array([-(low + high) / 2 for low, high in spans[:2]] + [-spans[2][0]])
    cloud = transformed(cloud, np.eye(3), center)
    size = as_vec(np.array([max(high - low, 1e-6) for low, high in spans]))
    kind = kinds.find(made.kind)
    pigment = Pigment(made.unlit.albedo, made.unlit.two_sided, not owned) if made.unlit.is_pigment else None
    support = kind.support if kind is not None else "floor"
    return ScaledAsset(cloud, made.kind, size, support, (*told, *notes), pigment)


def _usual_color(request: AssetRequest) -> str | None:
    """A usual colour of a small thing that is called by the very name of its kind: an apple is red or green. None for
    furniture, which comes in any colour, and for what is drawn as something like it."""
    if (material := _material(request.kind)) is not None:
        return material[0]
    kind = kinds.find(request.kind)
    if kind is None or kind.support != "surface" or not kind.colors:
        return None
    said = " ".join(kinds.words_of(request.kind))
    named = {kind.name, *(kind.also or ())}
    return kind.colors[request.seed % len(kind.colors)] if said in named else None


def _usual_paint(request: AssetRequest) -> str | None:
    """How furniture of a kind is usually painted, stained or covered; None for kinds of no usual colour."""
    kind = kinds.find(request.kind)
    if kind is None or kind.support != "floor" or not kind.colors:
        return None
    return _PAINTS.get(kind.colors[request.seed % len(kind.colors)])


def _material(name: str) -> tuple[str, str] | None:
    """The pigment of the material that a name begins with, and the rest of the name: "wooden chair"; None if it begins
    with none, or is itself the name of a kind."""
    words, known = name.lower().split(), kinds.find(name)
    if known is not None and known.name == name.lower():
        return None
    for length in range(len(words) - 1, 0, -1):
        found = finishes.said(" ".join(words[:length]))
        if found is not None and (color := found.color or finishes.FINISHES[found.finish].color):
            return color, " ".join(words[length:])
    return None


def _known_name(name: str) -> str:
    """A name without the material that it begins with, if only so it is the name of a kind: "wooden bench"."""
    said = _material(name)
    return said[1] if said is not None and kinds.find(name) is None and kinds.find(said[1]) is not None else name


def fitted(scale: SceneScale, kind: str, old: Box) -> SceneScale:
    """The scale at which a new thing is as large as what it replaces, where nothing tells the scale of the scene."""
    size = kinds.find(kind)
    if not scale.guessed or size is None:
        return scale
    width, depth, height = size.usual_size
    factor = min(old.size[2] / height, _WIDER * max(old.size[:2]) / max(width, depth))
    said = "the scene's scale is unknown; the new thing is as large as what it replaces"
    return SceneScale(max(factor, 1e-9), (said,))


def set_down(asset: ScaledAsset, foot: Array, axes: Axes) -> GaussianCloud:
    """The asset's Gaussians, rotated so that width, depth and height run along `axes`, standing at `foot`."""
    return transformed(asset.cloud, np.array(axes).T, foot)


def in_its_light(
    cloud: GaussianCloud, scene: Scene, wanted: bool, free: bool, pigment: Pigment | None = None
) -> tuple[GaussianCloud, tuple[str, ...]]:
    """A new thing with its colours fitted to the light of the scene if that is wanted, and a note of what changed.

    Args:
        free: whether nobody asked for a colour of it.
        pigment: its colours without light, if they are known.
    """
    if not wanted:
        return cloud, ()
    from .harmony.matched import matched

    cloud, told = matched(cloud, scene, free, pigment)
    said = told.describe()
    return cloud, (f"its colours were fitted to the light of the scene: {said}",) if said else ()


def laid(asset: ScaledAsset, place: Placement | None) -> ScaledAsset:
    """A thing that leans on a seat, as a cushion, lying flat where there is no seat."""
    kind = kinds.find(asset.label)
    width, depth, height = asset.size
    leans = kind is not None and any(k is not None and k.seats for k in map(kinds.find, kind.on or ()))
    if not leans or depth > _THIN * min(width, height) or (place is not None and place.relation != "on"):
        return asset
    if place is not None and any(q.text.lower() not in FLOOR_WORDS for q in place.anchors):
        return asset
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # its front, -y, comes to face up
    cloud = transformed(asset.cloud, turn, np.array([0.0, -height / 2, depth / 2]))
    return replace(asset, cloud=cloud, size=(width, height, depth))


def rested(around: Surroundings, spot: Spot, asset: ScaledAsset) -> Spot:
    """A spot in a capture at the height at which its surface is seen there: the ground of a capture is uneven, and its
    Gaussians lie above and below what a picture shows."""
    if around.sight is None or not around.rests:
        return spot
    height = seen_height(around.scene.cloud, around.moving, spot.foot, spot.axes, asset.size)
    if height is None:
        return spot
    return replace(spot, foot=spot.foot + around.up * height, support=spot.support + height)


def find_spot(around: Surroundings, asset: ScaledAsset, place: Placement | None, start: Array) -> Spot:
    """A spot for an asset that faces the viewer; without a `place`, assets for walls and ceilings hang there.

    Raises:
        InstructionError: there is none.
    """
    if place is not None and place.relation == "above":
        if asset.support not in ("wall", "ceiling"):
            raise InstructionError(f"a {asset.label} stands and does not hang: say on something, or next to it")
        mount: Mount = "wall" if asset.support == "wall" else "ceiling"
        region, axes = region_above(around, asset.size, anchors_of(around, place)[0], mount)
        return hanging_spot(around, asset.size, place, region, axes)
    unit = asset.size[2]
    around.lift = 0.0
    if place is None and asset.support == "wall":
        place = Placement(relation="against")
        metre_units = scene_scale(around.scene).units_per_metre
        around.lift = max(0.0, HUNG_AT * metre_units - unit / 2) if unit < _DOOR_HEIGHT * metre_units else 0.0
    if place is None and asset.support == "ceiling":
        heights = around.sampled @ around.up.astype(np.float32)
        around.lift = max(0.0, float(np.quantile(heights, 0.995)) - around.floor - unit) if len(heights) else 0.0
    anchors = anchors_of(around, place) if place is not None else []
    axes = standing_axes(around, anchors)
    if place is None or place.relation != "against" or anchors:
        around.back = None
        return free_spot(around, asset.size, axes, place, start)
    for _ in range(3):  # try the other walls
        try:
            around.back = np.array(axes[1])
            return free_spot(around, asset.size, axes, place, start)
        except InstructionError:
            axes = (axes[1], as_vec(-np.array(axes[0])), axes[2])
    around.back = np.array(axes[1])
    return free_spot(around, asset.size, axes, place, start)


def standing_axes(around: Surroundings, anchors: Sequence[Body]) -> Axes:
    """Axes for a new object: those of its anchor or the room, with the front (-y) that points most to the viewer."""
    base = anchors[0].box.axes if anchors else around.room_axes
    forward = heading(around.context.viewer, around.frame, "forward")
    choices = [sign * np.array(axis) for axis in base[:2] for sign in (1, -1)]
    back = max(choices, key=lambda axis: float(axis @ forward))
    return as_vec(np.cross(back, around.up)), as_vec(back), as_vec(around.up)


def viewed_point(around: Surroundings) -> Array:
    """`[3]`, the point of the floor that the viewer looks at; if there is none, the scene's middle on the floor."""
    camera, up = around.context.viewer, around.up
    down = float(camera.forward @ up)
    height = float(camera.position @ up) - around.floor
    middle = np.median(around.sampled, axis=0).astype(np.float64) if len(around.sampled) else np.zeros(3)
    middle = middle + up * (around.floor - float(middle @ up))
    if down > -0.05 or height <= 0:
        return middle
    away = height / -down
    if around.sight is not None and (thing := _first_seen(around)) is not None:
        away = min(away, thing)  # a picture of a thing looks at it, and not at the floor behind it
    seen = camera.position + camera.forward * away
    seen = seen + up * (around.floor - float(seen @ up))
    spread = float(np.linalg.norm(np.ptp(np.quantile(around.sampled, [0.05, 0.95], axis=0), axis=0)))
    return seen if np.linalg.norm(seen - middle) < spread else middle


def _first_seen(around: Surroundings) -> float | None:
    """Distance along the viewer's axis at which it meets a thing; None if it meets none."""
    camera = around.context.viewer
    apart = around.sampled.astype(np.float64) - camera.position
    along = apart @ camera.forward
    aside = np.linalg.norm(apart - along[:, None] * camera.forward, axis=1)
    met = along[(along > 0) & (aside < _AXIS * along)]
    return float(np.quantile(met, _FIRST)) if len(met) >= _FEW_MET else None


@dataclass(eq=False)
class NewObjects:
    """A collection of new objects; `insert_into` adds them all to the scene at once.

    Attributes:
        scene: the scene they are added to; new ids are above all of its ids.
        leaving: `[N]` bool, those of its Gaussians that are removed; the new rows follow the others. None: all stay.
        clouds: Gaussians of each object.
        entries: each object for the group table.
    """

    scene: Scene
    leaving: Tensor | None = None
    clouds: list[GaussianCloud] = field(default_factory=list)
    entries: list[NewObject] = field(default_factory=list)

    def add(self, cloud: GaussianCloud, label: str, axes: Axes | None, like: int | None = None) -> Tensor:
        """Add an object, its Gaussians in place and its box along `axes`; return its rows in the new cloud."""
        top = self.clouds[-1] if self.clouds else self.scene.cloud
        ids = fresh_ids(top, len(cloud))
        group = torch.full((len(cloud),), NO_GROUP, dtype=torch.int32, device=cloud.device)
        self.clouds.append(cloud.replace(ids=ids, group=group))
        self.entries.append(NewObject(self.clouds[-1], label, axes, like))
        gone = int(self.leaving.sum()) if self.leaving is not None else 0
        first = len(self.scene.cloud) - gone + sum(len(c) for c in self.clouds[:-1])
        return torch.arange(first, first + len(cloud), device=cloud.device)

    def ids(self) -> Tensor:
        """Ids of all new Gaussians, ascending."""
        return torch.cat([c.ids for c in self.clouds])

    def build_scene(self, context: Context) -> tuple[Scene, tuple[int, ...]]:
        """The scene with the new objects, and the group id of each."""
        scene = self.scene
        table, groups = field_update.append_objects(scene.language, self.entries, scene.frame, context.encoder)
        counts = [
            cloud.replace(group=torch.full_like(cloud.group, group))
            for cloud, group in zip(self.clouds, groups, strict=True)
        ]
        cloud = joined(scene.cloud, self.leaving, counts)
        if self.leaving is not None:
            gone = scene.cloud.ids[self.leaving]
            table = field_update.after_removal(scene.replace(language=table), cloud, gone)
        return scene.replace(cloud=cloud, language=table), tuple(g for g in groups if g >= 0)


def add_obstacle(cloud: GaussianCloud, scene: Scene, around: Surroundings) -> None:
    """Make a new object an obstacle for the objects placed after it."""
    points = obstacle_points(cloud)
    if len(points):
        around.add_obstacle(points.astype(np.float64), contact_box(points.astype(np.float64), scene.frame))


def affine_of(rows: Tensor, support: float | None, touches: bool = False) -> Affine:
    """A new object (its rows of the new cloud) for the checks: it has no old rows, only a support."""
    return Affine(rows, np.eye(3), np.zeros(3), rows[:0], support, touches)
