"""Read masks of photographs that another program made: `folder:PATH`.

PATH is a COCO `.json` or a folder with one of:

- `masks.json` `{photo: [{"id", "label", "score"}]}` and a `NAME.png` for each photo, pixel value = id, 0 for none;
- `NAME.npz` for each photo: `masks` `[M, H, W]` bool, or `ids` `[H, W]` or `[L, H, W]` of integers with -1 for none;
  if wanted `labels` `[M]`, `scores` `[M]`, `vectors` `[M, D]`;
- COCO `.json`: results `[{"image_id", "segmentation", "score", …}]` or a data set with images, categories, annotations.

The camera of a photo is found by the photo's name without folder and suffix. A photo without an entry is not a view;
one with an empty entry is a view in which nothing was found. Files that do not fit are an error; nothing is guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....camera import Camera
from ....errors import FileError, UserError
from ....files.captures.capture import TRANSFORMS, read_capture
from ....files.foreign import read_archive, read_json
from ....scene import Scene
from ..view import NONE, ViewMasks, pack_layers
from . import rle

INDEX = "masks.json"
MAX_MASKS = 1 << 16  # of a photo: as many ids as a 16-bit image holds
MAX_PIXELS = 1 << 32  # of all masks of a photo together, one byte each while they are read
MAX_RESIDUAL = 1.0  # pixels by which a side may deviate from the photograph's aspect ratio, by rounding of halved sizes

Reader = Callable[[Camera], ViewMasks]


def load(argument: str, capture: Path | None = None) -> Folder:
    """See `masks.load`.

    Raises:
        FileError: the folder or the capture does not exist.
        UserError: no folder is given.
    """
    if not argument:
        raise UserError("name the folder of masks: folder:PATH")
    path = Path(argument).expanduser()
    if not path.exists():
        raise FileError(f"there are no masks at {path}; give folder:PATH of a folder or a COCO .json")
    home = path if path.is_dir() else path.parent
    if capture is None:
        capture = next((f for f in (home / TRANSFORMS, home.parent / TRANSFORMS) if f.is_file()), None)
    return Folder(path, None if capture is None else read_capture(capture).cameras)


@dataclass(frozen=True)
class Folder:
    """Masks on disk.

    Attributes:
        path: the folder or `.json`.
        cameras: of the photographs; None for those of the scene.
    """

    path: Path
    cameras: tuple[Camera, ...] | None

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`. Photographs come in the order of their names."""
        cameras = self.cameras if self.cameras is not None else scene.cameras
        if not cameras:
            raise FileError(f"the cameras of the photographs of {self.path} are unknown; give --capture")
        by_name = {c.name.lower(): c for c in reversed(cameras)} | {
            Path(c.name).stem.lower(): c for c in reversed(cameras)
        }
        readers = _readers(self.path)
        if not readers:
            raise FileError(f"{self.path} holds no masks: no {INDEX}, no .npz and no COCO .json")
        for i, name in enumerate(sorted(readers, key=lambda photo: (Path(photo).stem, photo))):
            camera = by_name.get(Path(name).stem.lower())
            if camera is None:
                raise FileError(f"{self.path}: no camera is called {Path(name).stem}; give the right --capture")
            try:
                view = readers[name](camera)
            except UserError as error:
                raise FileError(f"{self.path}, {name}: {error}") from error
            yield view
            progress("masks", (i + 1) / len(readers))


def _readers(path: Path) -> dict[str, Reader]:
    """A reader for the masks of each photo."""
    if path.is_file():
        return _coco(path)
    if (path / INDEX).is_file():
        return _indexed(path)
    archives = sorted(path.glob("*.npz"))
    if archives:
        return {file.stem: _archive(file) for file in archives}
    files = sorted(f for f in path.glob("*.json") if f.name != TRANSFORMS)
    return _coco(files[0]) if len(files) == 1 else {}


def _sized(camera: Camera, width: int, height: int) -> Camera:
    """The camera at the size of the masks. Raises UserError if the masks have another aspect ratio than the
    photograph."""
    gain = width / camera.width
    if abs(camera.height * gain - height) > MAX_RESIDUAL * max(gain, 1):
        raise UserError(f"masks of {width}x{height} do not fit a photograph of {camera.width}x{camera.height}")
    return camera.resized(width, height)


# -- masks.json and images of ids


def _indexed(folder: Path) -> dict[str, Reader]:
    table = read_json(folder / INDEX)
    if not isinstance(table, dict) or not all(isinstance(v, list) for v in table.values()):
        raise FileError(f"{folder / INDEX} must hold {{photo: [{{id, label, score}}]}}")
    return {photo: _id_image(folder / f"{Path(photo).stem}.png", entries) for photo, entries in table.items()}


def _id_image(path: Path, entries: list[Any]) -> Reader:
    def read(camera: Camera) -> ViewMasks:
        ids = _read_ids(path)
        try:
            numbers = [int(e["id"]) for e in entries]
            labels = tuple(str(e.get("label", "")) for e in entries)
            scores = np.array([float(e.get("score", 1.0)) for e in entries], np.float32)
        except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
            raise UserError(f"{INDEX} has an entry without a readable id, label and score ({error!r})") from error
        if len(set(numbers)) < len(numbers) or not all(1 <= n < MAX_MASKS for n in numbers):
            raise UserError(
                f"{INDEX} must number the masks of a photo from 1 without repeating an id, got {numbers[:9]}"
            )
        unknown = sorted(set(np.unique(ids).tolist()) - {0, *numbers})
        if unknown:
            raise UserError(f"{path.name} has a pixel of value {unknown[0]}, which {INDEX} does not list")
        place = np.full(max([0, *numbers]) + 1, NONE, np.int32)
        place[numbers] = np.arange(len(numbers))
        return ViewMasks(_sized(camera, ids.shape[1], ids.shape[0]), place[ids], labels, scores)

    return read


def _read_ids(path: Path) -> NDArray[np.int32]:
    """The values `[H, W]` of an image with one channel."""
    from PIL import Image

    try:
        with Image.open(path) as picture:
            if picture.mode not in ("L", "P", "1", "I", "I;16"):
                raise UserError(f"{path.name} is an image in mode {picture.mode}; ids need one channel")
            return np.array(picture).astype(np.int32)
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        raise FileError(f"cannot read the masks {path}: {error}") from error


# -- archives


def _archive(path: Path) -> Reader:
    def read(camera: Camera) -> ViewMasks:
        columns = read_archive(path)
        ids, count = _numbered(columns)
        try:
            labels = tuple(str(v) for v in columns.get("labels", np.full(count, "")))
            scores = columns.get("scores", np.ones(count)).astype(np.float32, casting="same_kind")
            vectors = columns["vectors"].astype(np.float32, casting="same_kind") if "vectors" in columns else None
        except (TypeError, ValueError) as error:
            raise UserError(f"labels must be text, scores and vectors numbers, one per mask ({error})") from error
        return ViewMasks(_sized(camera, ids.shape[-1], ids.shape[-2]), ids, labels, scores, vectors)

    return read


def _numbered(columns: Mapping[str, NDArray[Any]]) -> tuple[NDArray[np.int32], int]:
    """The ids as `ViewMasks` takes them, and the number of masks; raises UserError if the archive holds no masks."""
    if "masks" in columns:
        masks = columns["masks"]
        if masks.ndim != 3 or masks.dtype.kind not in "biu":
            raise UserError(f"masks must be booleans [M, H, W], got {masks.dtype} {list(masks.shape)}")
        return pack_layers(masks.astype(bool)), len(masks)
    ids = columns.get("ids")
    if ids is None or ids.ndim not in (2, 3) or ids.dtype.kind not in "iu":
        raise UserError("an archive needs masks [M, H, W] or ids [H, W] or [L, H, W] of integers")
    least, most = (int(ids.min()), int(ids.max())) if ids.size else (NONE, NONE)
    if not NONE <= least <= most + 1 <= MAX_MASKS:
        raise UserError(f"ids must lie between -1 and {MAX_MASKS - 1}, got {least} to {most}")
    return ids.astype(np.int32), max(most + 1, *(np.size(columns.get(k, ())) for k in ("labels", "scores")))


# -- COCO


def _coco(path: Path) -> dict[str, Reader]:
    told = read_json(path)
    names: dict[Any, str] = {}
    kinds: dict[Any, str] = {}
    try:
        if isinstance(told, dict):
            names = {i["id"]: str(i["file_name"]) for i in told.get("images", ())}
            kinds = {c["id"]: str(c["name"]) for c in told.get("categories", ())}
            told = told.get("annotations")
        found: dict[str, list[Any]] = {name: [] for name in names.values()}
        for entry in told:
            image = entry["image_id"]
            found.setdefault(names.get(image, str(image)), []).append(entry)
    except (KeyError, TypeError, AttributeError) as error:
        raise FileError(f"{path} is neither a list of COCO results nor a COCO data set ({error!r})") from error
    return {name: _results(entries, kinds) for name, entries in found.items()}


def _results(entries: list[Any], kinds: Mapping[Any, str]) -> Reader:
    def read(camera: Camera) -> ViewMasks:
        try:
            sizes = {rle.size_of(e.get("segmentation")) for e in entries}
            if len(sizes) > 1:
                raise ValueError(f"the masks of one photo have different sizes: {sorted(sizes)}")
            height, width = next(iter(sizes), (camera.height, camera.width))
            fitting = _sized(camera, width, height)
            if len(entries) * height * width > MAX_PIXELS:
                raise ValueError(
                    f"{len(entries)} masks of {width}x{height} exceed the limit of memory; make them smaller"
                )
            masks = [rle.decode(e["segmentation"]) for e in entries]
            scores = np.array([float(e.get("score", 1.0)) for e in entries], np.float32)
            labels = tuple(str(e.get("label") or kinds.get(e.get("category_id"), "")) for e in entries)
        except (TypeError, ValueError, OverflowError, AttributeError) as error:
            raise UserError(f"a mask cannot be read: {error}") from error
        ids = pack_layers(np.stack(masks)) if masks else np.full((height, width), NONE, np.int32)
        return ViewMasks(fitting, ids, labels, scores)

    return read
