"""Chooses the views that a scene is made smaller by, and the held-out views that the promise is measured from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, Vec3
from ..errors import UserError
from ..language.segmentation.orient import estimate_frame
from ..language.segmentation.surface import surface_of
from ..render import render
from ..scene import Frame, Scene
from ..viewpoints.coverage import candidates
from ..viewpoints.orbit import choose_ring

SIZE = 512  # pixels of the longer side of all views
MOST = 40  # cameras of a capture in the choice, and as many held out
MIN_CAMERAS = 8  # of a capture; fewer leave most of a scene unseen
MIN_COVER = 0.05  # mean alpha of a view that counts; an empty picture loses nothing
PROBE_SIZE = 64  # pixels of the pictures that cover is measured with
RING = 8  # frames of the held-out orbit
TWINS = 4  # most moved copies of each chosen view, so that the Gaussians between the views are ranked too
MOST_RANKED = 120  # views that Gaussians are ranked by
TRAINED = 6  # moved copies of each chosen view that what is left is optimised by
MOVED = 0.12  # of the distance to what a view shows, by which its copies are moved
TURNED = 6.0  # degrees by which they are turned
FARTHER = 2.5  # times as far are the copies moved that only train
BLACK: Vec3 = (0.0, 0.0, 0.0)
WHITE: Vec3 = (1.0, 1.0, 1.0)
SEED = 16


@dataclass(frozen=True, eq=False)
class View:
    """A camera and the background behind the scene, display-space RGB."""

    camera: Camera
    background: Vec3


@dataclass(frozen=True, eq=False)
class Views:
    """The views of a scene, all different.

    Attributes:
        choice: the strength is chosen by these.
        ranking: `choice` and moved copies of it; the Gaussians are ranked by these.
        training: more moved copies, without `choice`; what is left is optimised by these.
        held_out: the promise is measured from these: every second view, and an orbit.
        source: where the cameras come from, for the report.
    """

    choice: tuple[View, ...]
    ranking: tuple[View, ...]
    training: tuple[View, ...]
    held_out: tuple[View, ...]
    source: str


def choose_views(scene: Scene, cameras: Sequence[Camera] = (), size: int = SIZE) -> Views:
    """The views of a scene, from its photographs' cameras or else around and inside it.

    Backgrounds alternate between black and white, so that lost opacity shows. Equal input gives equal views.

    Args:
        cameras: of photographs; if there are fewer than `MIN_CAMERAS`, the scene's own, then computed ones.
        size: pixels of the longer side of a view.

    Raises:
        UserError: no view shows anything of the scene.
    """
    frame = estimated_frame(scene, cameras)
    own = cameras if len(cameras) >= MIN_CAMERAS else scene.cameras
    if len(own) >= MIN_CAMERAS:
        pool = [_fitted(own[i], size) for i in _even(len(own), 2 * MOST)]
        source = f"{len(own)} cameras of photographs"
    else:
        pool, source = candidates(scene.cloud, frame, size), "computed around and inside the scene"
    ring = choose_ring(scene.replace(frame=frame), own if len(own) >= MIN_CAMERAS else ())
    orbit = [c for c in ring.cameras(RING, size, size) if shows(scene, c)]
    shown = [c for c in pool if shows(scene, c)]
    choice, held_out = _views(shown[::2]), _views(shown[1::2] + orbit)
    if not choice or not held_out:
        raise UserError("no view shows enough of this scene to measure what it loses; give its cameras with --capture")
    twins = _views(_twins(scene, shown[::2]))
    ranked = min(TWINS * len(choice), max(MOST_RANKED - len(choice), len(choice)))
    return Views(choice, choice + twins[:ranked], twins, held_out, source)


def estimated_frame(scene: Scene, cameras: Sequence[Camera] = ()) -> Frame:
    """The scene's frame, with up and floor estimated where its file does not say them."""
    if scene.frame.up_source != "unknown" or not len(scene.cloud):
        return scene.frame
    return estimate_frame(surface_of(scene.cloud), cameras or scene.cameras, scene.frame)


def _views(cameras: Sequence[Camera]) -> tuple[View, ...]:
    return tuple(View(camera, (BLACK, WHITE)[i % 2]) for i, camera in enumerate(cameras))


def _fitted(camera: Camera, size: int) -> Camera:
    """The same view, its longer side `size` pixels if it is longer."""
    gain = min(1.0, size / max(camera.width, camera.height))
    return camera.resized(max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))


def _even(count: int, most: int) -> list[int]:
    """At most `most` evenly spaced indices below `count`."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()


def shows(scene: Scene, camera: Camera) -> bool:
    """Whether a view shows more than empty space."""
    return float(render(scene.cloud, camera.resized(PROBE_SIZE, PROBE_SIZE)).alpha.mean()) > MIN_COVER


def _twins(scene: Scene, cameras: Sequence[Camera]) -> list[Camera]:
    """`TRAINED` copies of each camera, moved and turned at random by a little: first one of each, then the next."""
    rng, found = np.random.default_rng(SEED), list[Camera]()
    distances = [_distance(scene, camera) for camera in cameras]
    for number in range(TRAINED):
        far = 1.0 if number < TWINS else FARTHER
        for camera, distance in zip(cameras, distances, strict=True):
            turn = far * np.radians(TURNED) * rng.normal(size=3) / np.sqrt(3)
            pose = np.eye(4)
            pose[:3, :3] = _rotation(turn) @ camera.world_to_camera[:3, :3]
            eye = camera.position + far * MOVED * distance * rng.normal(size=3) / np.sqrt(3)
            pose[:3, 3] = -pose[:3, :3] @ eye
            twin = Camera(
                pose, camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height, f"{camera.name} moved"
            )
            found.append(twin)
    return found


def _distance(scene: Scene, camera: Camera) -> float:
    """Median distance of what a view shows, scene units."""
    seen = render(scene.cloud, camera.resized(PROBE_SIZE, PROBE_SIZE))
    depth = seen.depth[seen.alpha > 0.5]
    return float(depth.median()) if len(depth) else float(seen.depth.max())


def _rotation(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """`[3, 3]` rotation by a vector of axis times angle (Rodrigues)."""
    angle = float(np.linalg.norm(vector)) or 1e-12
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
