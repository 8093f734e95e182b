"""Estimate the poses of photographs and store them as a capture, reused while the photographs are unchanged.

The capture is a separate folder, never the user's: `transforms.json`, which references the photographs where they are,
and `sparse/0`, the COLMAP model. It is reused as long as the photographs are identical byte for byte, and it is written
atomically. The reconstruction runs in a separate process (`reconstruct`). Untrusted images are decoded here by Pillow;
the other process reads only images that were written here.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import math
import os
import secrets
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ...errors import BackendError, FileError, UserError
from ...files import writing
from ...files.captures import colmap
from ...files.captures.capture import TRANSFORMS, to_transforms
from ...files.captures.image_file import read_photo
from ...files.foreign import read_json

MAX_SIDE = 1600  # px of the longer side of the images that features are extracted from
MIN_PHOTOS = 4
MIN_SHARE = 0.25  # of the photographs; a model with fewer is refused
MIN_POINTS = 100  # sparse points; a model with fewer is refused
METHOD = 1  # version of the method; to be increased when it finds other poses, so that stored ones are not reused
DIAGONAL = math.hypot(36, 24)  # mm of 35 mm film, to which focal lengths in EXIF are equivalent (CIPA DCG-001)
EXIF, FOCAL = 0x8769, 0xA405  # the directory, and FocalLengthIn35mmFilm in it (Exif 2.32, table 8)
_HELP = (
    "take more photographs: sharp, of textured surfaces, from places a step apart, each overlapping its neighbours by "
    "two thirds"
)
Progress = Callable[[str, float], None]


def estimate_poses(
    photos: Sequence[Path], folder: Path, progress: Progress = lambda stage, share: None
) -> tuple[str, ...]:
    """Make `folder` a capture of `photos` with estimated poses, unless it already is one of identical photographs.

    Returns:
        names of the photographs without a pose.

    Raises:
        UserError: `folder` exists and is not such a capture.
        FileError: a photograph cannot be read, too few of them could be placed, or the capture cannot be written.
        BackendError: pycolmap is not installed, or failed.
    """
    _check_names(photos)
    digest = _digest(photos)
    stored = _read_stored(folder)
    if stored is None or stored["photographs"] != digest:
        if importlib.util.find_spec("pycolmap") is None:
            raise BackendError(
                'poses of photographs are estimated by pycolmap, which is not installed: pip install "scenewright[sfm]"'
            )
        return _estimate(photos, digest, folder, progress)
    transforms = _transforms(photos, folder, folder, digest)
    if transforms != stored:  # the folder or the photographs were moved
        with writing(folder / TRANSFORMS, force=True) as file:
            file.write(_to_json(transforms).encode())
    return tuple(transforms["unplaced"])


def _check_names(photos: Sequence[Path]) -> None:
    if len(photos) < MIN_PHOTOS:
        raise FileError(f"{photos[0].parent} has {len(photos)} photographs; at least {MIN_PHOTOS} are needed, 30 or "
                        "more from all sides are recommended")  # fmt: skip
    if twice := [name for name, times in Counter(p.stem.lower() for p in photos).items() if times > 1]:
        raise FileError(f"{photos[0].parent}: two photographs are called {twice[0]}; rename one of them")
    for photo in photos:
        try:
            photo.name.encode()
        except UnicodeEncodeError as error:
            raise FileError(f"{photo.parent}: the file name {photo.name!r} is not valid UTF-8; rename it") from error


def _digest(photos: Sequence[Path]) -> str:
    digest = hashlib.sha256(f"{METHOD}".encode())
    for photo in photos:
        try:
            digest.update(f"/{photo.name}/".encode() + hashlib.sha256(photo.read_bytes()).digest())
        except OSError as error:
            raise FileError(f"cannot read the photograph {photo}: {error.strerror or error}") from error
    return digest.hexdigest()


def _read_stored(folder: Path) -> dict[str, Any] | None:
    """The `transforms.json` that an earlier run stored; None if the folder does not exist.

    Raises:
        UserError: the folder holds something else.
    """
    if not folder.exists():
        return None
    stored = read_json(folder / TRANSFORMS) if (folder / TRANSFORMS).is_file() else None
    if not isinstance(stored, dict) or "photographs" not in stored or not (folder / "sparse" / "0").is_dir():
        raise UserError(f"{folder} is where estimated poses are stored, but it holds something else; move it away or "
                        "choose another output")  # fmt: skip
    return stored


def _estimate(photos: Sequence[Path], digest: str, folder: Path, progress: Progress) -> tuple[str, ...]:
    """Estimate poses and replace `folder`, which stays unchanged on failure; returns the names without a pose."""
    work = folder.with_name(f".{folder.name[:100]}.{secrets.token_hex(6)}.part")
    try:
        work.mkdir()
        run(_lots(photos, work / "pictures", progress), work, progress)
        _check_model(photos, work)
        made = work / "made"
        made.mkdir()
        (work / "sparse").rename(made / "sparse")
        transforms = _transforms(photos, made, folder, digest)
        (made / TRANSFORMS).write_text(_to_json(transforms))
        if folder.exists():
            folder.rename(work / "before")
        made.rename(folder)
        return tuple(transforms["unplaced"])
    except OSError as error:
        raise FileError(f"cannot write {folder}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _lots(photos: Sequence[Path], folder: Path, progress: Progress) -> list[dict[str, Any]]:
    """Write all photographs to `folder`, downscaled and numbered, grouped by camera: same size and focal length.

    Returns:
        for each camera: `width`, `height` of its images, `full` size of its photographs, `focal` in pixels of the
        images or None, and `photos`, names of images to names of photographs.
    """
    from PIL import Image

    lots: dict[tuple[Any, ...], dict[str, Any]] = {}
    folder.mkdir()
    for i, photo in enumerate(photos):
        progress("preparing photographs", i / len(photos))
        size, focal = _header(photo)
        picture = Image.fromarray(read_photo(photo, size))
        full = picture.size
        factor = min(1.0, MAX_SIDE / max(full))
        small = max(1, round(full[0] * factor)), max(1, round(full[1] * factor))
        if small != full:
            picture = picture.resize(small, Image.Resampling.LANCZOS)
        picture.save(folder / f"{i:05d}.jpg", quality=95, subsampling=0)
        lot = {"width": small[0], "height": small[1], "full": list(full), "photos": {}}
        lot["focal"] = None if focal is None else focal / DIAGONAL * math.hypot(*small)
        lots.setdefault((full, focal), lot)["photos"][f"{i:05d}.jpg"] = photo.name
    return list(lots.values())


def _header(photo: Path) -> tuple[tuple[int, int], float | None]:
    """Width and height as stored, and the EXIF focal length in mm of 35 mm film if it is plausible."""
    from PIL import Image

    try:
        with Image.open(photo) as file:
            size = file.size
            try:
                focal = float(file.getexif().get_ifd(EXIF).get(FOCAL, 0))
            except Exception:  # Pillow raises many kinds of error for broken metadata; the image itself may be good
                focal = 0.0
    except Exception:  # likewise; `read_photo` reports what is wrong with the image
        return (0, 0), None
    return size, focal if 5 <= focal <= 1000 else None


def run(lots: list[dict[str, Any]], work: Path, progress: Progress) -> None:
    """Reconstruct `work/pictures` into `work/sparse/0` in a separate process; without a model that folder is missing.

    Raises:
        BackendError: the process failed.
    """
    (work / "plan.json").write_text(json.dumps(lots))
    command = [sys.executable, "-m", "scenewright.gaussians.fit.photographs.reconstruct", str(work.absolute())]
    with (
        open(work / "errors.txt", "wb") as errors,
        subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors) as process,
    ):
        assert process.stdout is not None
        try:
            for line in process.stdout:
                if line.startswith(b'["'):  # libraries may print to stdout too
                    progress(*json.loads(line))
            code = process.wait()
        finally:
            process.kill()
    if code:
        lines = (work / "errors.txt").read_text(errors="replace").strip().splitlines()
        raise BackendError(f"pycolmap failed to estimate poses: {lines[-1] if lines else f'exit code {code}'}")


def _check_model(photos: Sequence[Path], work: Path) -> None:
    sparse = work / "sparse" / "0"
    placed = len(colmap.read_views(sparse)) if sparse.is_dir() else 0
    points = len(colmap.read_points(sparse).means) if placed else 0
    if placed < max(MIN_PHOTOS, MIN_SHARE * len(photos)) or points < MIN_POINTS:
        raise FileError(f"only {placed} of {len(photos)} photographs in {photos[0].parent} could be placed, "
                        f"with {points} common points; {_HELP}")  # fmt: skip


def _transforms(photos: Sequence[Path], model: Path, folder: Path, digest: str) -> dict[str, Any]:
    """Content of `folder/transforms.json`: the cameras of `model/sparse` with the current paths of the photographs."""
    views = {view.name: view for view in colmap.read_views(model / "sparse" / "0")}
    placed = [p for p in photos if p.name in views]
    home = os.path.realpath(folder)
    paths = [(Path(os.path.relpath(os.path.realpath(p.parent), home)) / p.name).as_posix() for p in placed]
    cameras = to_transforms([views[p.name].camera for p in placed], [views[p.name].lens for p in placed], paths)
    return {**cameras, "photographs": digest, "unplaced": [p.name for p in photos if p.name not in views]}


def _to_json(transforms: dict[str, Any]) -> str:
    return json.dumps(transforms, indent=1) + "\n"
