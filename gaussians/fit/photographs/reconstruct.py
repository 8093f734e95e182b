"""From photographs alone to poses, lenses and surveyed points: SIFT, pairs that look alike, matches, and a global
reconstruction, all by pycolmap (https://colmap.github.io/pycolmap/) on the CPU.

Run by `survey` as a process of its own, `python -m scenewright.gaussians.fit.photographs.reconstruct FOLDER`: an abort
of the C++ library ends only this process, an interrupt ends it at once, and its memory is free before training begins.
Reads only the plan and the pictures in FOLDER, which `survey` wrote.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
from numpy.typing import NDArray

PLAN, PICTURES, MODEL = "plan.json", "pictures", "sparse/0"
LENS = "SIMPLE_RADIAL"
FEATURES = 4096  # of a photograph
SMALL = 1000  # px of the longer side, up to which features are looked for at twice the size
WIDEST = 300  # features of a photograph by which pairs are chosen
PARTNERS = 16  # photographs that each is matched with at least, where there are more
AHEAD = 3  # and the next ones by name, as people walk
RATIO = 0.8  # of the distances to the nearest and the second nearest feature (Lowe 2004)
LOT = 8  # photographs between two words of progress
SEED = 0


def main(folder: Path) -> None:
    """Reconstruct what `folder/plan.json` names; the largest model goes to `folder/sparse/0`, if there is one."""
    pycolmap.logging.minloglevel = int(pycolmap.logging.ERROR)
    pycolmap.set_random_seed(SEED)
    lots = json.loads((folder / PLAN).read_text(encoding="utf-8"))
    database = folder / "features.db"
    find_features(database, folder / PICTURES, lots)
    match(database, folder)
    tell("placing cameras", 0.0)
    model = reconstruct(database, folder)
    if model is not None:
        _as_taken(model, lots)
        (folder / MODEL).mkdir(parents=True)
        model.write(folder / MODEL)
    tell("placing cameras", 1.0)


def tell(stage: str, share: float) -> None:
    """One line of progress for whoever started this."""
    print(json.dumps([stage, round(share, 4)]), flush=True)


def find_features(database: Path, pictures: Path, lots: list[dict[str, Any]]) -> None:
    """SIFT features of all pictures; each lot has one camera. Pictures are listed before they are looked at, so that
    their numbers do not depend on which thread is done first."""
    with pycolmap.Database.open(database):
        pass  # opening makes it
    for lot in lots:
        reader = pycolmap.ImageReaderOptions()
        reader.camera_model = LENS
        if lot["focal"] is not None:
            reader.camera_params = f"{lot['focal']},{lot['width'] / 2},{lot['height'] / 2},0"
        names = sorted(lot["photos"])
        pycolmap.import_images(database, pictures, pycolmap.CameraMode.SINGLE, names, reader)
    done, total = 0, sum(len(lot["photos"]) for lot in lots)
    for lot in lots:
        options = pycolmap.FeatureExtractionOptions()
        options.sift.max_num_features = FEATURES
        options.sift.first_octave = -1 if max(lot["width"], lot["height"]) <= SMALL else 0
        names = sorted(lot["photos"])
        for some in (names[i : i + LOT] for i in range(0, len(names), LOT)):
            tell("finding features", done / total)
            pycolmap.extract_features(database, pictures, some, extraction_options=options, device=pycolmap.Device.cpu)
            done += len(some)


def match(database: Path, folder: Path) -> None:
    """Match features of likely pairs, and keep what one camera motion explains."""
    with pycolmap.Database.open(database) as opened:
        images = sorted(opened.read_all_images(), key=lambda image: image.name)
        widest = [_widest(opened, image.image_id) for image in images]
    pairs = sorted(likely_pairs(widest))
    verify = pycolmap.TwoViewGeometryOptions()
    verify.ransac.random_seed = SEED
    pairing = pycolmap.ImportedPairingOptions()
    pairing.match_list_path = folder / "pairs.txt"
    size = LOT * PARTNERS
    for i in range(0, len(pairs), size):
        tell("matching photographs", i / len(pairs))
        lines = (f"{images[a].name} {images[b].name}\n" for a, b in pairs[i : i + size])
        (folder / "pairs.txt").write_text("".join(lines))
        pycolmap.match_image_pairs(
            database, pairing_options=pairing, verification_options=verify, device=pycolmap.Device.cpu
        )


def _widest(database: Any, number: int) -> NDArray[np.float32]:
    """Descriptors `[N, 128]` of unit length of a picture's widest features, which are the most likely to be found
    again (Wu 2013)."""
    frames = database.read_keypoints(number)[:, 2:]  # x, y and the 2x2 shape
    width = np.abs(frames[:, 0] * frames[:, 3] - frames[:, 1] * frames[:, 2])
    chosen = np.argsort(-width, kind="stable")[:WIDEST]
    found = database.read_descriptors(number).data[chosen].astype(np.float32)
    return found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-6)


def likely_pairs(descriptors: list[NDArray[np.float32]]) -> set[tuple[int, int]]:
    """Pairs `a < b` of photographs worth matching.

    Args:
        descriptors: of each photograph, in the order of names, `[N, D]` of unit length.
    """
    count = len(descriptors)
    if count <= 2 * PARTNERS:
        return {(a, b) for b in range(count) for a in range(b)}
    alike = np.zeros((count, count), np.int64)
    for a in range(count):
        if not a % LOT:
            tell("choosing pairs", 1 - (1 - a / count) ** 2)
        for b in range(a + 1, count):
            alike[a, b] = alike[b, a] = shared(descriptors[a], descriptors[b])
    return set(_chosen(alike))


def shared(a: NDArray[np.float32], b: NDArray[np.float32]) -> int:
    """How many features of two photographs are each other's nearest, and clearly so."""
    if min(len(a), len(b)) < 2:
        return 0
    cosines = a @ b.T
    nearest = cosines.argmax(axis=1)
    mutual = cosines.argmax(axis=0)[nearest] == np.arange(len(a))
    second, first = np.partition(cosines, -2, axis=1)[:, -2:].T
    return int((mutual & (1 - first < RATIO**2 * (1 - second))).sum())  # squared distances are 2 - 2 cosines


def _chosen(alike: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    count = len(alike)
    for a in range(count):
        yield from ((a, b) for b in range(a + 1, min(a + 1 + AHEAD, count)))
        best = [int(b) for b in np.argsort(-alike[a], kind="stable")[: PARTNERS + 1] if b != a][:PARTNERS]
        yield from ((min(a, b), max(a, b)) for b in best)


def reconstruct(database: Path, folder: Path) -> Any | None:
    """The model that holds the most photographs; None if there is none. What it left out is then tried one by one.

    By one thread: several sum in the order in which they are done, and the same photographs are to give the same poses.
    """
    options = pycolmap.GlobalPipelineOptions()
    options.num_threads = options.mapper.num_threads = 1
    options.mapper.bundle_adjustment.ceres.solver_options.num_threads = 1
    options.random_seed = options.mapper.random_seed = SEED
    options.mapper.rotation_averaging.random_seed = options.mapper.global_positioning.random_seed = SEED
    options.mapper.retriangulation.random_seed = SEED
    first, then = folder / "global", folder / "added"
    first.mkdir()
    then.mkdir()
    models = pycolmap.global_mapping(database, folder / PICTURES, first, options)
    if not models:
        return None
    which, model = max(models.items(), key=lambda found: found[1].num_reg_images())
    if model.num_reg_images() == sum(1 for _ in (folder / PICTURES).iterdir()):
        return model
    adding = pycolmap.IncrementalPipelineOptions()
    adding.num_threads = adding.mapper.num_threads = 1
    adding.random_seed = adding.mapper.random_seed = adding.triangulation.random_seed = SEED
    adding.multiple_models = False
    more = pycolmap.incremental_mapping(database, folder / PICTURES, then, adding, first / str(which))
    return max([model, *more.values()], key=lambda found: found.num_reg_images())


def _as_taken(model: Any, lots: list[dict[str, Any]]) -> None:
    """Give a model of shrunken pictures the names and sizes of the photographs."""
    of = {name: lot for lot in lots for name in lot["photos"]}
    done = set()
    for image in model.images.values():
        lot = of[image.name]
        image.name = lot["photos"][image.name]
        across, down = lot["full"]
        ratio = np.array([across / lot["width"], down / lot["height"]])
        for point in image.points2D:
            point.xy = point.xy * ratio
        if image.camera_id not in done:
            model.cameras[image.camera_id].rescale(across, down)
            done.add(image.camera_id)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
