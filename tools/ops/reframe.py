"""The operation reframe: turn, move or scale the whole scene with its cameras, or state its frame.

Gaussians, harmonics, cameras, boxes, up, floor and scale change together, so that the scene's cameras see what they
saw. The viewer stays, so that a turn shows another side. A turn about the viewer's axes is about the middle of the
scene; x, y and z are the file's axes through its origin. A factor changes the length of a unit: things keep their size
in metres.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import InstructionError
from ...gaussians.language.field.language_field import LanguageField
from ...gaussians.language.field.measure import as_axes
from ...gaussians.language.query.query import ALL, Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Box
from ...gaussians.world.core import least_opacity
from ..alternatives import NOT_GIVEN, Given, Keywords, either, given
from ..checks import count_matches, moved_as_asked
from ..operation import Affine, Context, Direction, EditOp, Length, Outcome
from ..placement.bodies import Array, bodies_of, heading
from ..receipt import Check, at_most
from ..transform import shift, transformed

Axis = Literal["up", "right", "forward", "x", "y", "z"]
Signed = Literal["x", "y", "z", "-x", "-y", "-z"]
_UNIT: dict[str, tuple[float, float, float]] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_WAYS = ("degrees", "up", "factor", "direction", "origin", "unit")
_SAMPLE = 2_000  # Gaussians whose pictures are compared
_SEEN = 0.05  # pixels by which a camera may see them elsewhere: rounding of single-precision centres


def _alone(name: str, **more: Given | Keywords) -> dict[str, Given | Keywords]:
    """The schema alternative in which one way to reframe is given and the others are not."""
    return {**dict.fromkeys(_WAYS, NOT_GIVEN), name: given(), **more}


class Reframe(EditOp):
    """Turn, move or scale the whole scene with its cameras, or state its up axis, origin or unit; one of them."""

    model_config = ConfigDict(
        json_schema_extra=either(
            _alone("degrees", at=NOT_GIVEN), _alone("up"), _alone("factor"),
            _alone("direction", distance=given()), _alone("origin"), _alone("unit"),
        )
    )  # fmt: skip
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "rotate the scene 90 degrees around x",
        {"op": "reframe", "degrees": 90, "axis": "x"},
    )
    op: Literal["reframe"] = "reframe"
    degrees: Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)] | None = None
    axis: Axis = "up"
    up: Signed | None = None
    factor: Annotated[float, Field(ge=0.0001, le=10_000, allow_inf_nan=False)] | None = None
    direction: Direction | None = None
    distance: Length | None = None
    origin: Literal["floor", "middle"] | None = None
    unit: Length | None = None
    at: Query | None = None
    """Whose origin, or whose true height `unit` is; without it that of a scene unit."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        said = [n for n in _WAYS if getattr(self, n) is not None]
        if len(said) != 1:
            raise ValueError(f"reframe needs exactly one of {', '.join(_WAYS)}, got {said or 'none'}")
        if self.direction is not None and self.distance is None:
            raise ValueError("to move the whole scene, give a distance")
        if self.at is not None and self.degrees is not None:
            raise ValueError("the whole scene turns about its middle or about an axis of the file, not at a thing")
        return self

    def stronger(self, times: float) -> Self | None:
        if self.degrees is not None:
            return self.model_copy(update={"degrees": min(max(self.degrees * times, -3600.0), 3600.0)})
        if self.factor is not None:
            return self.model_copy(update={"factor": min(max(self.factor**times, 0.0001), 10_000.0)})
        return None if self.distance is None else self.model_copy(update={"distance": self.distance.times(times)})

    def subject(self) -> str:
        return "the whole scene"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.ones(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        if self.unit is not None:
            return self._stated(scene, self.unit, context)
        factor, rotation, offset, notes = self._map(scene, context)
        matrix = factor * rotation
        cloud = _mapped(scene.cloud, matrix, offset)
        after = scene.replace(
            cloud=cloud,
            frame=_frame(scene.frame, factor, rotation, offset),
            cameras=tuple(_camera(c, factor, rotation, offset) for c in scene.cameras),
            language=_field(scene.language, factor, rotation, offset),
        )
        rows = torch.arange(len(cloud), device=cloud.device)
        told = (*notes, f"{len(scene.cameras)} cameras went along") if scene.cameras else notes
        every = Selection(Query(text="everything", pick="all"), "found", cloud.ids.sort().values)
        return Outcome(after, touched=every.ids, moved=(Affine(rows, matrix, offset, rows),), notes=told, focus=every)

    def _map(self, scene: Scene, context: Context) -> tuple[float, Array, Array, tuple[str, ...]]:
        """Factor, rotation and offset of `x -> factor * rotation @ x + offset`, and notes."""
        frame, none = scene.frame, np.zeros(3)
        if self.degrees is not None:
            if self.axis in _UNIT:
                said = f"turned about the {self.axis} axis of the file, through its origin"
                return 1.0, axis_rotation(np.array(_UNIT[self.axis]), self.degrees), none, (said,)
            way: Direction = self.axis  # type: ignore[assignment]
            rotation = axis_rotation(heading(context.viewer, frame, way), self.degrees)
            middle = _middle(scene.cloud)
            return 1.0, rotation, middle - rotation @ middle, ("turned about the middle of the scene",)
        if self.up is not None:
            rotation = _onto(frame.up_vector, (-1 if self.up[0] == "-" else 1) * np.array(_UNIT[self.up[-1]]))
            return 1.0, rotation, none, (f"up is {self.up} now; it was {_told(frame.up_vector)}",)
        if self.factor is not None:
            note = "metres per unit follow: things keep their size in metres" if frame.metres_per_unit else ""
            return self.factor, np.eye(3), none, ((note,) if note else ())
        if self.direction is not None:
            assert self.distance is not None
            step = self.distance.in_units(frame) * heading(context.viewer, frame, self.direction)
            return 1.0, np.eye(3), np.asarray(step), self.distance.assumption(frame)
        point = self._origin(scene, context)
        return 1.0, np.eye(3), -point, (f"the origin was at {_told(-point)} as seen from the new one, scene units",)

    def _origin(self, scene: Scene, context: Context) -> Array:
        """`[3]` the point that becomes the origin."""
        up = scene.frame.up_vector
        if self.at is not None:
            (body, *_) = bodies_of(scene, context.resolve(scene, self.at).require())
            return body.foot(up) if self.origin == "floor" else np.asarray(body.center)
        middle = _middle(scene.cloud)
        if self.origin == "middle":
            return middle
        if scene.frame.floor is None:
            raise InstructionError("the height of the floor is not known: say the middle of the scene, or a thing")
        return np.asarray(middle + up * (scene.frame.floor - float(middle @ up)))

    def _stated(self, scene: Scene, unit: Length, context: Context) -> Outcome:
        """The scene with a stated length of its unit."""
        frame, length = scene.frame, 1.0
        if unit.unit == "units":
            raise InstructionError("say the length of a unit in metres, centimetres, feet or inches")
        if self.at is not None:
            (body, *_) = bodies_of(scene, context.resolve(scene, self.at).require())
            length = body.box.size[2]
        metres = unit.in_units(Frame(metres_per_unit=1.0)) / length
        before = "unknown" if frame.metres_per_unit is None else f"{frame.metres_per_unit:.4g} m"
        after = scene.replace(frame=replace(frame, metres_per_unit=metres, scale_source="given"))
        return Outcome(after, notes=(f"a scene unit is {metres:.4g} m now; it was {before}",))

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        checks = [count_matches(before, outcome.scene, outcome)]
        if outcome.moved:
            checks.append(moved_as_asked(before, outcome.scene, outcome.moved))
        if outcome.moved and before.cameras:
            checks.append(_same_pictures(before, outcome.scene))
        return tuple(checks)


def of_everything(op: EditOp) -> EditOp:
    """The operation that turns, moves or scales the whole scene where one of things is asked to do it to everything.

    Raises:
        InstructionError: the whole scene cannot be placed relative to something in it.
    """
    query = op.query()
    if query is None or op.op not in ("rotate", "scale", "move") or query != Query(text=query.text, pick=query.pick):
        return op
    if query.text not in ALL:
        return op
    said = op.model_dump(exclude_none=True, exclude={"op", "target"})
    if op.op == "rotate" and "toward" not in said:
        return Reframe(degrees=said["degrees"], axis=said["axis"])
    if op.op == "scale" and "factor" in said and said["axis"] == "all":
        return Reframe(factor=said["factor"])
    if op.op == "move" and "direction" in said and "distance" in said:
        return Reframe(direction=said["direction"], distance=Length(**said["distance"]))
    if op.op == "move" and said.get("place") == {"relation": "center", "anchors": ()}:
        return Reframe(origin="middle")
    raise InstructionError(
        "the whole scene is turned by degrees, scaled by a factor, or moved by a distance in a direction; "
        "name things to place them"
    )


def _mapped(cloud: GaussianCloud, matrix: Array, offset: Array) -> GaussianCloud:
    """The cloud under a similarity; a shift writes only the centres."""
    if not np.array_equal(matrix, np.eye(3)):
        return transformed(cloud, matrix, offset)
    from ..cloud_diff import Draft

    draft = Draft(cloud)
    shift(draft, torch.arange(len(cloud), device=cloud.device), offset)
    return draft.done()


def _frame(frame: Frame, factor: float, rotation: Array, offset: Array) -> Frame:
    """Up, floor and scale under the map."""
    up = rotation @ frame.up_vector
    floor = None if frame.floor is None else factor * frame.floor + float(up @ offset)
    metres = None if frame.metres_per_unit is None else frame.metres_per_unit / factor
    return replace(frame, up=(float(up[0]), float(up[1]), float(up[2])), floor=floor, metres_per_unit=metres)


def _camera(camera: Camera, factor: float, rotation: Array, offset: Array) -> Camera:
    """The camera that sees the mapped scene as it saw the scene: depths grow by the factor."""
    pose = camera.world_to_camera
    turned = pose[:3, :3] @ rotation.T
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = turned, factor * pose[:3, 3] - turned @ offset
    return replace(camera, world_to_camera=made)


def _field(field: LanguageField | None, factor: float, rotation: Array, offset: Array) -> LanguageField | None:
    """The table with mapped boxes."""
    if field is None:
        return None

    def mapped(box: Box) -> Box:
        center = factor * (rotation @ np.array(box.center)) + offset
        size = tuple(factor * s for s in box.size)
        axes = as_axes(np.array(box.axes) @ rotation.T)
        return Box((float(center[0]), float(center[1]), float(center[2])), axes, size)  # type: ignore[arg-type]

    return replace(field, groups=tuple(replace(g, box=mapped(g.box)) for g in field.groups))


def _middle(cloud: GaussianCloud) -> Array:
    """`[3]` median of the solid Gaussians."""
    solid = cloud.opacities >= least_opacity(cloud.opacities)
    return np.asarray(cloud.means[solid].to(torch.float64).median(dim=0).values.cpu().numpy())


def _onto(up: Array, axis: Array) -> Array:
    """`[3, 3]` the smallest rotation that takes one unit vector to another."""
    about, cosine = np.cross(up, axis), float(np.clip(up @ axis, -1, 1))
    if np.linalg.norm(about) < 1e-12:
        if cosine > 0:
            return np.eye(3)
        about = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    angle = float(np.degrees(np.arctan2(np.linalg.norm(np.cross(up, axis)), cosine)))
    return axis_rotation(about, angle)


def _told(point: Array) -> str:
    return f"({', '.join(f'{c:.3g}' for c in point)})"


def _same_pictures(before: Scene, after: Scene) -> Check:
    """The cameras of the scene see every Gaussian where they saw it before."""
    step = max(1, len(before.cloud) // _SAMPLE)
    was, now = (s.cloud.means[::step].to(torch.float64).cpu().numpy() for s in (before, after))
    worst = 0.0
    for old, new in list(zip(before.cameras, after.cameras, strict=True))[:8]:
        seen = old.contains(*old.project(was))
        if seen.any():
            worst = max(worst, float(np.abs(old.project(was[seen])[0] - new.project(now[seen])[0]).max()))
    said = f"the scene's cameras see every Gaussian within {worst:.2g} pixels of where they saw it"
    return at_most("same pictures", worst, _SEEN, "px", said)
