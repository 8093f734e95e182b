"""Structure from motion by pycolmap (https://colmap.github.io/pycolmap/) on the CPU: SIFT features, image retrieval,
matching, and global mapping, from photographs to poses, intrinsics and sparse points.

Run by `pose_estimation` as a separate process, `python -m scenewright.gaussians.fit.photographs.reconstruct FOLDER`: an
abort of the C++ library ends only this process, an interrupt ends it at once, and its memory is freed before training
begins. Reads only the plan and the images in FOLDER, which `pose_estimation` wrote.
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
SMALL = 1000  # px of the longer side; features of smaller images are extracted at twice the size
WIDEST = 300  # features of a photograph that pairs are selected by, those of the largest scale
PARTNERS = 16  # most similar photographs that each one is matched with
SEQUENTIAL = 3  # following photographs by name that each one is also matched with
RATIO = 0.8  # ratio test: distances to the nearest and the second nearest feature (Lowe 2004)
BATCH = 8  # photographs between two progress reports
SEED = 0


def main(folder: Path) -> None:
    """Reconstruct the photographs of `folder/plan.json`; writes the largest model to `folder/sparse/0`, if any."""
    pycolmap.logging.minloglevel = int(pycolmap.logging.ERROR)
    pycolmap.set_random_seed(SEED)
    lots = json.loads((folder / PLAN).read_text(encoding="utf-8"))
    database = folder / "features.db"
    find_features(database, folder / PICTURES, lots)
    match(database, folder)
    report("placing cameras", 0.0)
    model = reconstruct(database, folder)
    if model is not None:
        _restore_sizes(model, lots)
        (folder / MODEL).mkdir(parents=True)
        model.write(folder / MODEL)
    report("placing cameras", 1.0)


def report(stage: str, share: float) -> None:
    """Print one line of progress for the parent process."""
    print(json.dumps([stage, round(share, 4)]), flush=True)


def find_features(database: Path, pictures: Path, lots: list[dict[str, Any]]) -> None:
    """Extract SIFT features of all images; each lot shares one camera.

    Images are imported before extraction, so that their ids do not depend on the timing of threads.
    """
    with pycolmap.Database.open(database):
        pass  # opening creates it
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
        for batch in (names[i : i + BATCH] for i in range(0, len(names), BATCH)):
            report("finding features", done / total)
            pycolmap.extract_features(database, pictures, batch, extraction_options=options, device=pycolmap.Device.cpu)
            done += len(batch)


def match(database: Path, folder: Path) -> None:
    """Match features of likely pairs and verify the matches geometrically."""
    with pycolmap.Database.open(database) as opened:
        images = sorted(opened.read_all_images(), key=lambda image: image.name)
        widest = [_widest(opened, image.image_id) for image in images]
    pairs = sorted(likely_pairs(widest))
    verify = pycolmap.TwoViewGeometryOptions()
    verify.ransac.random_seed = SEED
    pairing = pycolmap.ImportedPairingOptions()
    pairing.match_list_path = folder / "pairs.txt"
    size = BATCH * PARTNERS
    for i in range(0, len(pairs), size):
        report("matching photographs", i / len(pairs))
        lines = (f"{images[a].name} {images[b].name}\n" for a, b in pairs[i : i + size])
        (folder / "pairs.txt").write_text("".join(lines))
        pycolmap.match_image_pairs(
            database, pairing_options=pairing, verification_options=verify, device=pycolmap.Device.cpu
        )


def _widest(database: Any, number: int) -> NDArray[np.float32]:
    """Unit descriptors `[N, 128]` of an image's largest-scale features, which are the most repeatable (Wu 2013)."""
    frames = database.read_keypoints(number)[:, 2:]  # x, y and the 2x2 shape
    width = np.abs(frames[:, 0] * frames[:, 3] - frames[:, 1] * frames[:, 2])
    chosen = np.argsort(-width, kind="stable")[:WIDEST]
    found = database.read_descriptors(number).data[chosen].astype(np.float32)
    return found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-6)


def likely_pairs(descriptors: list[NDArray[np.float32]]) -> set[tuple[int, int]]:
    """Pairs `a < b` of photographs to match: all of few photographs, else the most similar and consecutive ones.

    Args:
        descriptors: unit descriptors of each photograph, `[N, D]`, in the order of names.
    """
    count = len(descriptors)
    if count <= 2 * PARTNERS:
        return {(a, b) for b in range(count) for a in range(b)}
    alike = np.zeros((count, count), np.int64)
    for a in range(count):
        if not a % BATCH:
            report("choosing pairs", 1 - (1 - a / count) ** 2)
        for b in range(a + 1, count):
            alike[a, b] = alike[b, a] = count_matches(descriptors[a], descriptors[b])
    return set(_select_pairs(alike))


def count_matches(a: NDArray[np.float32], b: NDArray[np.float32]) -> int:
    """Number of mutual nearest neighbours among the features of two photographs that pass the ratio test."""
    if min(len(a), len(b)) < 2:
        return 0
    cosines = a @ b.T
    nearest = cosines.argmax(axis=1)
    mutual = cosines.argmax(axis=0)[nearest] == np.arange(len(a))
    second, first = np.partition(cosines, -2, axis=1)[:, -2:].T
    return int((mutual & (1 - first < RATIO**2 * (1 - second))).sum())  # squared distances are 2 - 2 cosines


def _select_pairs(alike: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    """Consecutive photographs, and the most similar ones by the numbers of matches `[N, N]`."""
    count = len(alike)
    for a in range(count):
        yield from ((a, b) for b in range(a + 1, min(a + 1 + SEQUENTIAL, count)))
        best = [int(b) for b in np.argsort(-alike[a], kind="stable")[: PARTNERS + 1] if b != a][:PARTNERS]
        yield from ((min(a, b), max(a, b)) for b in best)


def reconstruct(database: Path, folder: Path) -> Any | None:
    """Global mapping, then incremental mapping of unregistered photographs; the largest model, None if there is none.

    Uses one thread: with several, the order of summation varies, and the same photographs must give the same poses.
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


def _restore_sizes(model: Any, lots: list[dict[str, Any]]) -> None:
    """Convert a model of downscaled images to the names and sizes of the photographs."""
    lot_of = {name: lot for lot in lots for name in lot["photos"]}
    done = set()
    for image in model.images.values():
        lot = lot_of[image.name]
        image.name = lot["photos"][image.name]
        width, height = lot["full"]
        ratio = np.array([width / lot["width"], height / lot["height"]])
        for point in image.points2D:
            point.xy = point.xy * ratio
        if image.camera_id not in done:
            model.cameras[image.camera_id].rescale(width, height)
            done.add(image.camera_id)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
