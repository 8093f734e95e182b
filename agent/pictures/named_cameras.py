"""Parses cameras of the command line: a camera of the scene by number or name, or eye and target; and picture sizes.

Views are chosen automatically in `gaussians.viewpoints.coverage`.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from ...gaussians.errors import UserError
from ...gaussians.kept import Kept

if TYPE_CHECKING:
    from ...gaussians.camera import Camera, Vec3
    from ...gaussians.scene import Frame, Scene

PICTURE = (960, 640)  # pixels, by default
_FOV_Y = 55.0  # degrees, of a view given by eye and target


def choose_view(scene: Scene, view: str = "auto", size: str | None = None) -> Camera:
    """The camera that `view` names, at `size` ("1280x720").

    Raises:
        UserError: there is no such camera, or the view or size cannot be parsed.
    """
    from ...gaussians.camera import Camera

    if view == "auto":
        camera = default_view(scene)
    elif ":" in view and "," in view:
        eye, target, *angle = view.split(":", 2)
        fov = _angle(angle[0]) if angle else _FOV_Y
        camera = Camera.look_at(_point(eye), _point(target), scene.frame.up, *PICTURE, fov_y=fov, name="given")
    else:
        camera = scene.cameras[camera_index(scene, view)]
    if size is None:
        return camera
    from ...gaussians.viewpoints.coverage import fit_camera

    return fit_camera(camera, *parse_size(size))


def default_view(scene: Scene) -> Camera:
    """The scene's first camera, or a view from which much of it can be seen."""
    from ...gaussians.viewpoints.coverage import default_viewer

    return default_viewer(scene if scene.cameras else framed(scene), *PICTURE)


_frames: Kept[Frame] = Kept(1)  # estimating takes seconds, and what opens a scene asks twice


def framed(scene: Scene) -> Scene:
    """The scene with up and floor estimated, if its up direction is unknown."""
    if scene.frame.up_source != "unknown":
        return scene
    return scene.replace(frame=_frames.get((scene,), lambda: _estimated(scene)))


def _estimated(scene: Scene) -> Frame:
    from ...gaussians.language.segmentation.orient import estimate_frame
    from ...gaussians.language.segmentation.surface import surface_of

    return estimate_frame(surface_of(scene.cloud), scene.cameras, scene.frame)


def with_frame(scene: Scene, up: str | None, metres_per_unit: float | None) -> Scene:
    """The scene with the up direction ("0,0,1") and scale that the user gives; None leaves each as it is.

    Raises:
        UserError: the direction is zero or cannot be parsed, or the scale is not positive.
    """
    from dataclasses import replace

    frame = scene.frame
    if up is not None:
        if not any(_point(up)):
            raise UserError(f"--up {up} points nowhere; write for example --up 0,0,1")
        frame = replace(frame, up=_point(up), up_source="given", floor=None)
    if metres_per_unit is not None:
        if not 0 < metres_per_unit < math.inf:
            raise UserError(f"--metres-per-unit must be a number above zero, not {metres_per_unit:g}")
        frame = replace(frame, metres_per_unit=metres_per_unit, scale_source="given")
    return scene.replace(frame=frame)


def parse_size(text: str) -> tuple[int, int]:
    """ "1280x720" as `(1280, 720)`.

    Raises:
        UserError: it is not a size, or larger than 8192 pixels a side.
    """
    match = re.fullmatch(r"(\d{1,5})\s*[xX×]\s*(\d{1,5})", text.strip())
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(1 <= side <= 8192 for side in size):
        raise UserError(f"{text!r} is not a picture size; write for example 1280x720 (at most 8192 a side)")
    return size


def camera_index(scene: Scene, view: str) -> int:
    """The number of the scene's camera that a name or number means.

    Raises:
        UserError: there is none.
    """
    for i, camera in enumerate(scene.cameras):
        if camera.name and camera.name.lower() == view.lower():
            return i
    if view.isascii() and view.isdigit() and len(view) < 10 and int(view) < len(scene.cameras):
        return int(view)
    known = ", ".join(f"{i} {c.name}".strip() for i, c in enumerate(scene.cameras[:12])) or "none"
    raise UserError(f"no camera {view!r} in this scene (cameras: {known}); or give 'x,y,z:x,y,z' as eye and target")


def view_text(camera: Camera) -> str:
    """A camera as `choose_view` takes it: 'eye:target:angle', exact to a thousandth of a unit and of a degree.

    `choose_view` gives the same view for pictures of the camera's size, if it is not rolled.
    """
    eye, ahead = camera.position, camera.position + camera.forward
    gain = min(camera.width / PICTURE[0], camera.height / PICTURE[1])
    angle = 2 * math.degrees(math.atan(PICTURE[1] / 2 / (camera.fy / gain)))
    points = (",".join(f"{round(float(c), 4) + 0.0:g}" for c in point) for point in (eye, ahead))
    return ":".join([*points, f"{angle:.3f}"])


def _angle(text: str) -> float:
    """The vertical field of view of a view, degrees."""
    try:
        angle = float(text)
    except ValueError:
        angle = math.nan
    if not 0 < angle < 180:
        raise UserError(f"{text!r} is not a field of view; give degrees between 0 and 180, e.g. 0,-3,1.5:0,0,1:55")
    return angle


def _point(text: str) -> Vec3:
    try:
        x, y, z = (float(c) for c in text.split(","))
    except ValueError:
        raise UserError(f"{text!r} is not a point; write three numbers x,y,z") from None
    if not all(map(math.isfinite, (x, y, z))):
        raise UserError(f"{text!r} is not a point; its numbers must be finite")
    return (x, y, z)
