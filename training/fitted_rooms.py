"""Rooms with known objects, fitted from photographs of them as a user would fit a capture, for training.

    python -m scenewright.training.fitted_rooms --cache FOLDER

Each room is photographed from inside with sensor noise, varying exposure and JPEG, fitted (`gaussians/fit`), and the
true objects are carried over to the fitted Gaussians from the nearest true one. Fits take minutes each and are kept in
the cache. `ROOMS` train, `HELD_OUT` evaluate. Some fits are short and some long, since their faults differ: short ones
are noisy and faint, long ones nearly as clear as a generated room.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..gaussians.assets import furnish
from ..gaussians.camera import Camera
from ..gaussians.files import load, save
from ..gaussians.files.captures.capture import to_transforms
from ..gaussians.fit import Settings, fit, load_photos
from ..gaussians.lens import Lens
from ..gaussians.render import render
from ..gaussians.scene import Scene
from .composed_rooms import named_room

F64 = NDArray[np.float64]
REACH = 0.15  # metres; a Gaussian farther from every true one belongs to no object
FIELD_OF_VIEW = 75.0  # degrees
JPEG_QUALITY = 92
SURVEY_ERROR = 0.006  # metres, standard deviation of a surveyed point
STRUCTURE_SHARE = 0.25  # of surveyed points on floor and walls, against objects: these have more texture
MIN_DISTANCE, NEAR_SHARE = 0.45, 0.03  # metres; photographs that show more than this share nearer are not taken
MAX_TRIES = 20  # views tried for each photograph that is wanted


@dataclass(frozen=True)
class FittedRoom:
    """How a room is made, photographed and fitted.

    Attributes:
        name: of its folder in the cache.
        room: "furnished" or a description to compose.
        seed: of the room, of its photographs and of the fit.
        steps: of the fit.
        limit: maximum number of Gaussians.
        width: of the photographs, pixels; their height is 3/4 of it.
        noise: standard deviation of the sensor's noise, in [0, 1].
        growth: densification of the fit; the classic one makes fewer and more opaque Gaussians, as most captures have.
        photographs, points: numbers of photographs and of surveyed points.
    """

    name: str
    room: str
    seed: int
    steps: int
    limit: int
    width: int
    noise: float
    growth: Literal["budgeted", "classic"] = "budgeted"
    photographs: int = 40
    points: int = 6000


ROOMS = (
    FittedRoom("studio-short", "furnished", 9200, 1000, 20_000, 320, 0.012),
    FittedRoom("office-long", "furnished", 9204, 4000, 40_000, 224, 0.004, "classic", points=25_000),
    FittedRoom("kids-room", "kids room", 31, 2000, 30_000, 224, 0.008),
    FittedRoom("home-office-long", "home office", 32, 3000, 40_000, 208, 0.004, "classic", points=25_000),
    FittedRoom("kitchen", "furnished", 9206, 2000, 30_000, 208, 0.012, points=4000),
)
HELD_OUT = (FittedRoom("studio-long", "furnished", 9231, 3000, 40_000, 224, 0.004, "classic", points=25_000),)


def known_room(recipe: FittedRoom) -> tuple[Scene, NDArray[np.int32]]:
    """The true room and the object of each Gaussian `[N]`, -1 for structure."""
    scene, objects, _ = _known(recipe)
    return scene, objects


def names(recipe: FittedRoom) -> tuple[str, ...]:
    """The name of each object of the room."""
    return _known(recipe)[2]


def _known(recipe: FittedRoom) -> tuple[Scene, NDArray[np.int32], tuple[str, ...]]:
    if recipe.room != "furnished":
        return named_room(recipe.room, recipe.seed)
    room = furnish(recipe.seed, detail=1.6, ceiling=True)
    return room.scene, room.truth.ids.numpy(), tuple(o.kind for o in room.truth.objects)


def fitted_room(recipe: FittedRoom, cache: Path) -> tuple[Scene, NDArray[np.int32]]:
    """The fitted room and the object of each Gaussian `[N]`, -1 for structure and for what is far from everything.

    The fit is read from the cache if a fit of the same recipe is there, and is kept there otherwise.
    """
    folder = cache / recipe.name
    done, made = folder / "recipe.json", folder / "scene.ply"
    true, objects = known_room(recipe)
    if not (done.is_file() and json.loads(done.read_text(encoding="utf-8")) == asdict(recipe)):
        photograph(true, objects, recipe, folder)
        settings = Settings(steps=recipe.steps, max_gaussians=recipe.limit, growth=recipe.growth, seed=recipe.seed)
        result = fit(load_photos(folder), settings)
        print(f"{recipe.name}: {len(result.scene.cloud):,} Gaussians, {result.quality.psnr:.2f} dB on held-out "
              f"photographs, {result.seconds:.0f} s", file=sys.stderr, flush=True)  # fmt: skip
        save(result.scene, made, force=True)
        done.write_text(json.dumps(asdict(recipe)), encoding="utf-8")
    scene = load(made)
    return replace(scene, frame=true.frame), carried_over(true, objects, scene)


def carried_over(true: Scene, objects: NDArray[np.int32], scene: Scene) -> NDArray[np.int32]:
    """The object of each Gaussian of `scene` `[N]`: that of the nearest true Gaussian, -1 beyond `REACH`."""
    distance, nearest = cKDTree(true.cloud.means.numpy()).query(scene.cloud.means.numpy())
    return np.where(distance < REACH, objects[nearest], -1).astype(np.int32)


def photograph(scene: Scene, objects: NDArray[np.int32], recipe: FittedRoom, folder: Path) -> None:
    """Write a capture of a room: photographs from inside, their poses, and points as a reconstruction finds them."""
    from PIL import Image

    rng = np.random.default_rng(recipe.seed)
    (folder / "images").mkdir(parents=True, exist_ok=True)
    structure = scene.cloud.means.numpy()[objects < 0].astype(np.float64)
    low, high = np.quantile(structure, 0.01, axis=0), np.quantile(structure, 0.99, axis=0)
    cameras: list[Camera] = []
    for _ in range(MAX_TRIES * recipe.photographs):
        if len(cameras) == recipe.photographs:
            break
        camera = _view(low, high, recipe.width, f"{len(cameras):03d}", rng)
        picture = render(scene.cloud, camera)
        seen = picture.depth[picture.alpha > 0.5]
        if not len(seen) or np.quantile(seen.numpy(), NEAR_SHARE) < MIN_DISTANCE:
            continue
        rgb = picture.rgb.numpy() * rng.uniform(0.94, 1.05) + rng.normal(0, recipe.noise, picture.rgb.shape)
        stored = Image.fromarray((np.clip(rgb, 0, 1) * 255).astype(np.uint8))
        stored.save(folder / "images" / f"{camera.name}.jpg", quality=JPEG_QUALITY)
        cameras.append(camera)
    paths = [f"images/{camera.name}.jpg" for camera in cameras]
    poses = to_transforms(cameras, [Lens()] * len(cameras), paths)
    (folder / "transforms.json").write_text(json.dumps(poses), encoding="utf-8")
    _write_points(scene, objects, recipe.points, folder, rng)


def _view(low: F64, high: F64, width: int, name: str, rng: np.random.Generator) -> Camera:
    """A view from near the walls of a room across its middle, at the height of a standing or crouching person."""
    middle, half = (low + high)[:2] / 2, (high - low)[:2] / 2
    angle, out = rng.uniform(0, 2 * np.pi), 0.95 * rng.uniform(0.45, 0.92)
    aside = out * half * [np.cos(angle), np.sin(angle)]
    eye = middle + aside
    target = middle - rng.uniform(0.2, 0.9, 2) * aside + rng.normal(0, 0.5, 2)
    return Camera.look_at(
        (float(eye[0]), float(eye[1]), float(low[2] + rng.uniform(1.0, 1.9))),
        (float(target[0]), float(target[1]), float(low[2] + rng.uniform(0.2, 1.1))),
        (0.0, 0.0, 1.0), width, width * 3 // 4, FIELD_OF_VIEW, name,
    )  # fmt: skip


def _write_points(scene: Scene, objects: NDArray[np.int32], count: int, folder: Path, rng: np.random.Generator) -> None:
    """Surveyed points with errors, in COLMAP's text format."""
    sparse = folder / "sparse" / "0"
    sparse.mkdir(parents=True, exist_ok=True)
    share = np.where(objects < 0, STRUCTURE_SHARE, 1.0)
    rows = rng.choice(len(objects), count, replace=False, p=share / share.sum())
    places = scene.cloud.means.numpy()[rows] + rng.normal(0, SURVEY_ERROR, (count, 3))
    color = (scene.cloud.sh[:, 0].numpy()[rows] * 0.2820948 + 0.5).clip(0, 1) * 255
    lines = [
        f"{k + 1} {x:.6f} {y:.6f} {z:.6f} {r:.0f} {g:.0f} {b:.0f} 0.5"
        for k, ((x, y, z), (r, g, b)) in enumerate(zip(places.tolist(), color.tolist(), strict=True))
    ]
    (sparse / "points3D.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (sparse / "cameras.txt").write_text("", encoding="utf-8")


def main() -> None:
    """Fit all rooms that are not in the cache yet."""
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.fitted_rooms")
    parser.add_argument("--cache", type=Path, required=True, help="folder of the fits")
    parser.add_argument("--only", nargs="*", help="names of rooms")
    options = parser.parse_args()
    for recipe in (*ROOMS, *HELD_OUT):
        if not options.only or recipe.name in options.only:
            fitted_room(recipe, options.cache)


if __name__ == "__main__":
    main()
