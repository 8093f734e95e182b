"""A folder of photographs without poses, made a capture: what is estimated, where it is kept, what is said of it.

The capture is a folder of its own, never the user's: `transforms.json`, which names the photographs where they are, and
`sparse/0`, the model as COLMAP writes it. It is found again as long as the photographs are the same, byte for byte, and
appears whole or not at all. Knows files and pictures. Refuses to know how poses are found (`reconstruct`, in a process
of its own). Pictures of strangers are decoded here, by Pillow; what the other process reads was written here.
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
from ...files.captures.capture import TRANSFORMS, described
from ...files.foreign import read_json
from .image_file import read_photo

LONGEST = 1600  # px of the longer side, up to which features are looked for
LEAST = 4  # photographs
LEAST_SHARE = 0.25  # of the photographs, below which what was placed is a splinter
LEAST_POINTS = 100  # surveyed, below which nothing was understood
METHOD = 1  # changes when other poses would be found
DIAGONAL = math.hypot(36, 24)  # mm of 35 mm film, to which focal lengths in EXIF are equivalent (CIPA DCG-001)
EXIF, FOCAL = 0x8769, 0xA405  # the directory, and FocalLengthIn35mmFilm in it (Exif 2.32, table 8)
_HELP = (
    "take more of them, sharp, each overlapping its neighbours by two thirds, from places a step apart, and with "
    "something to see on what they show"
)
Progress = Callable[[str, float], None]


def survey(photos: Sequence[Path], kept: Path, progress: Progress = lambda stage, share: None) -> tuple[str, ...]:
    """Make the folder `kept` a capture of `photos`, unless it already is one of these very photographs.

    Returns:
        names of the photographs that found no place.

    Raises:
        UserError: something else stands where the capture is to be kept.
        FileError: a photograph cannot be read, too few of them could be placed, or nothing can be written.
        BackendError: pycolmap is not installed, or failed.
    """
    _check_names(photos)
    digest = _digest(photos)
    before = _kept(kept)
    if before is None or before["photographs"] != digest:
        if importlib.util.find_spec("pycolmap") is None:
            raise BackendError(
                'poses of photographs are estimated by pycolmap, which is not installed: pip install "scenewright[sfm]"'
            )
        return _estimate(photos, digest, kept, progress)
    told = _told(photos, kept, kept, digest)
    if told != before:  # moved to where its photographs have another path
        with writing(kept / TRANSFORMS, force=True) as file:
            file.write(_text(told).encode())
    return tuple(told["unplaced"])


def _check_names(photos: Sequence[Path]) -> None:
    if len(photos) < LEAST:
        raise FileError(f"{photos[0].parent} has {len(photos)} photographs; at least {LEAST} are needed, and 30 or "
                        "more from all around do better")  # fmt: skip
    if twice := [name for name, times in Counter(p.stem.lower() for p in photos).items() if times > 1]:
        raise FileError(f"{photos[0].parent}: two photographs are called {twice[0]}; they need different names")
    for photo in photos:
        try:
            photo.name.encode()
        except UnicodeEncodeError as error:
            raise FileError(f"{photo.parent}: the name {photo.name!r} is no text (UTF-8); rename it") from error


def _digest(photos: Sequence[Path]) -> str:
    told = hashlib.sha256(f"{METHOD}".encode())
    for photo in photos:
        try:
            told.update(f"/{photo.name}/".encode() + hashlib.sha256(photo.read_bytes()).digest())
        except OSError as error:
            raise FileError(f"cannot read the photograph {photo}: {error.strerror or error}") from error
    return told.hexdigest()


def _kept(folder: Path) -> dict[str, Any] | None:
    """What an earlier run left; None if there is nothing.

    Raises:
        UserError: it is not from here.
    """
    if not folder.exists():
        return None
    told = read_json(folder / TRANSFORMS) if (folder / TRANSFORMS).is_file() else None
    if not isinstance(told, dict) or "photographs" not in told or not (folder / "sparse" / "0").is_dir():
        raise UserError(f"{folder} is where estimated poses are kept, but holds something else; move it away or "
                        "choose another output")  # fmt: skip
    return told


def _estimate(photos: Sequence[Path], digest: str, kept: Path, progress: Progress) -> tuple[str, ...]:
    """Fill `kept`, or leave it as it was; returns what found no place."""
    work = kept.with_name(f".{kept.name[:100]}.{secrets.token_hex(6)}.part")
    try:
        work.mkdir()
        run(_lots(photos, work / "pictures", progress), work, progress)
        _check_model(photos, work)
        made = work / "made"
        made.mkdir()
        (work / "sparse").rename(made / "sparse")
        told = _told(photos, made, kept, digest)
        (made / TRANSFORMS).write_text(_text(told))
        if kept.exists():
            kept.rename(work / "before")
        made.rename(kept)
        return tuple(told["unplaced"])
    except OSError as error:
        raise FileError(f"cannot write {kept}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _lots(photos: Sequence[Path], folder: Path, progress: Progress) -> list[dict[str, Any]]:
    """Write all photographs to `folder`, shrunk and numbered, and part them by camera: one size, one focal length.

    Returns:
        of each camera: `width`, `height` of its pictures, `full` size of its photographs, `focal` in pixels of the
        picture or None, and `photos`, names of pictures to names of photographs.
    """
    from PIL import Image

    lots: dict[tuple[Any, ...], dict[str, Any]] = {}
    folder.mkdir()
    for i, photo in enumerate(photos):
        progress("preparing photographs", i / len(photos))
        size, focal = _header(photo)
        picture = Image.fromarray(read_photo(photo, size))
        full = picture.size
        factor = min(1.0, LONGEST / max(full))
        small = max(1, round(full[0] * factor)), max(1, round(full[1] * factor))
        if small != full:
            picture = picture.resize(small, Image.Resampling.LANCZOS)
        picture.save(folder / f"{i:05d}.jpg", quality=95, subsampling=0)
        told = {"width": small[0], "height": small[1], "full": list(full), "photos": {}}
        told["focal"] = None if focal is None else focal / DIAGONAL * math.hypot(*small)
        lots.setdefault((full, focal), told)["photos"][f"{i:05d}.jpg"] = photo.name
    return list(lots.values())


def _header(photo: Path) -> tuple[tuple[int, int], float | None]:
    """Width and height as stored, and the focal length in mm of 35 mm film, if it says one that a lens can have."""
    from PIL import Image

    try:
        with Image.open(photo) as file:
            size = file.size
            try:
                focal = float(file.getexif().get_ifd(EXIF).get(FOCAL, 0))
            except Exception:  # whatever Pillow raises at broken metadata: the picture itself may be good
                focal = 0.0
    except Exception:  # likewise; what is wrong with the picture is for `read_photo` to say
        return (0, 0), None
    return size, focal if 5 <= focal <= 1000 else None


def run(lots: list[dict[str, Any]], work: Path, progress: Progress) -> None:
    """Reconstruct from `work/pictures` to `work/sparse/0`, which is not there afterwards if nothing could be.

    Raises:
        BackendError: it failed.
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
                if line.startswith(b'["'):  # libraries may talk there too
                    progress(*json.loads(line))
            code = process.wait()
        finally:
            process.kill()
    if code:
        said = (work / "errors.txt").read_text(errors="replace").strip().splitlines()
        raise BackendError(f"pycolmap failed at estimating poses: {said[-1] if said else f'it ended with {code}'}")


def _check_model(photos: Sequence[Path], work: Path) -> None:
    sparse = work / "sparse" / "0"
    placed = len(colmap.read_views(sparse)) if sparse.is_dir() else 0
    points = len(colmap.read_points(sparse).means) if placed else 0
    if placed < max(LEAST, LEAST_SHARE * len(photos)) or points < LEAST_POINTS:
        raise FileError(f"only {placed} of {len(photos)} photographs in {photos[0].parent} could be placed, "
                        f"by {points} points that they share; {_HELP}")  # fmt: skip


def _told(photos: Sequence[Path], model: Path, folder: Path, digest: str) -> dict[str, Any]:
    """What `folder/transforms.json` says: the cameras of `model/sparse`, with the photographs where they are now."""
    views = {view.name: view for view in colmap.read_views(model / "sparse" / "0")}
    placed = [p for p in photos if p.name in views]
    home = os.path.realpath(folder)
    paths = [(Path(os.path.relpath(os.path.realpath(p.parent), home)) / p.name).as_posix() for p in placed]
    told = described([views[p.name].camera for p in placed], [views[p.name].lens for p in placed], paths)
    return {**told, "photographs": digest, "unplaced": [p.name for p in photos if p.name not in views]}


def _text(told: dict[str, Any]) -> str:
    return json.dumps(told, indent=1) + "\n"
