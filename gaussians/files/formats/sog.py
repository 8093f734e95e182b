"""Reads SOG version 2 (PlayCanvas, "Spatially Ordered Gaussians"): a folder of meta.json and images, or its .sog zip.

The specification is developer.playcanvas.com/user-manual/gaussian-splatting/formats/sog: one pixel per Gaussian, row
by row; positions as 16 bits of a signed logarithm, the three smaller components of a rotation in a byte each, scales
and colours through codebooks, the bands above the constant one through a palette. Writing is in `sog_writing`.
Archives are untrusted: file names with a folder and entries or images far larger than the scene needs are refused.
"""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...cloud import SH_BANDS
from ...errors import FileError
from ...scene import Scene
from ..format import Format, Report
from . import values
from .sog_writing import PALETTE_COLUMNS, PALETTE_LIMIT, write

NAME = "SOG version 2"
META = "meta.json"

# Real scenes need 8 to 20 bytes a Gaussian; a file of constant images compresses without bound.
MIN_BYTES_A_GAUSSIAN = 1 / 4
FREE_GAUSSIANS = 1 << 18  # allowed for any file size
_SPARE_PIXELS = 1 << 16  # writers round the sides of images up
_META_LIMIT = 1 << 24

Finite = Annotated[float, Field(allow_inf_nan=False)]
Triple = tuple[Finite, Finite, Finite]
FileName = Annotated[str, Field(pattern=r"^[^/\\:\x00]+$", max_length=255)]
Codebook = Annotated[tuple[Finite, ...], Field(min_length=1, max_length=256)]
Bytes = NDArray[np.uint8]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")


class _Means(_Part):
    mins: Triple
    maxs: Triple
    files: tuple[FileName, FileName]


class _Coded(_Part):
    codebook: Codebook
    files: tuple[FileName]


class _Quats(_Part):
    files: tuple[FileName]


class _Palette(_Part):
    count: Annotated[int, Field(ge=1, le=PALETTE_LIMIT)]
    bands: Annotated[int, Field(ge=1, le=3)]
    codebook: Codebook
    files: tuple[FileName, FileName]


class _Meta(_Part):
    version: Literal[2]
    count: Annotated[int, Field(ge=0, le=1 << 31)]
    means: _Means
    scales: _Coded
    quats: _Quats
    sh0: _Coded
    shN: _Palette | None = None  # the format's own name


class _Bundle:
    """The parts of a scene in a folder or zip: `get(name, limit)` reads one, `size` is the size on disk of all."""

    def __init__(self, path: Path) -> None:
        self.path = path if path.name != META else path.parent
        self.get: Callable[[str, int], bytes] = self._from_folder if self.path.is_dir() else self._from_zip

    @property
    def size(self) -> int:
        """Bytes on disk of the archive, or of the folder's files."""
        if self.path.is_dir():
            return sum(p.stat().st_size for p in self.path.iterdir() if p.is_file())
        return self.path.stat().st_size

    def _from_folder(self, name: str, limit: int) -> bytes:
        part = self.path / name
        if not part.is_file():
            raise FileError(f"{self.path}: the part {name} is missing")
        if part.stat().st_size > limit:
            raise FileError(f"{part}: larger than this part of a scene can be")
        return part.read_bytes()

    def _from_zip(self, name: str, limit: int) -> bytes:
        try:
            with zipfile.ZipFile(self.path) as archive:
                entry = archive.getinfo(name)
                if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise FileError(f"{self.path}: the compression of its part {name} is not supported by SOG")
                with archive.open(entry) as part:  # a limited read, because the size in the archive may be wrong
                    data = part.read(limit + 1) if entry.file_size <= limit else b""
                if entry.file_size > limit or len(data) > limit:
                    raise FileError(f"{self.path}: its part {name} is larger than this part of a scene can be")
                return data
        except KeyError as error:
            raise FileError(f"{self.path}: the part {name} is missing from the archive") from error
        except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError, NotImplementedError) as error:
            raise FileError(f"{self.path}: not a valid zip archive ({error}); it is cut off or damaged") from error


def recognises(path: Path, head: bytes) -> bool:
    """Whether the path is a folder with a meta.json, a meta.json, or a zip archive."""
    if path.is_dir():
        return (path / META).is_file()
    return path.name == META or head[:4] == b"PK\x03\x04"


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: a part is missing, damaged, too small or too large, or the version is not 2.
    """
    bundle = _Bundle(path)
    meta = _read_meta(bundle)
    images = _Images(bundle, meta.count)
    base = images.pixels(meta.sh0.files[0])
    dc = _decode(bundle.path, meta.sh0.codebook, base[:, :3])
    sh = dc[:, None] if meta.shN is None else np.concatenate([dc[:, None], _bands(images, meta.shN)], axis=1)
    logs = _decode(bundle.path, meta.scales.codebook, images.pixels(meta.scales.files[0])[:, :3])
    cloud, notes = values.sound_cloud(
        _means(images, meta.means),
        _rotations(images.pixels(meta.quats.files[0])),
        values.scales_from_logs(logs),
        values.opacities_from_bytes(base[:, 3]),
        sh,
    )
    return Scene(cloud, path=path), Report(NAME, meta.count, len(cloud), notes)


def _read_meta(bundle: _Bundle) -> _Meta:
    text = bundle.get(META, _META_LIMIT)
    try:
        meta = _Meta.model_validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the text"
        raise FileError(
            f"{bundle.path}: {META} does not describe a SOG version 2 scene: {where}: {first['msg']}"
        ) from error
    if meta.count == 0:
        raise FileError(f"{bundle.path}: the file holds zero Gaussians")
    if meta.count > FREE_GAUSSIANS + bundle.size / MIN_BYTES_A_GAUSSIAN:
        raise FileError(f"{bundle.path}: {meta.count:,} Gaussians do not fit into {bundle.size:,} bytes")
    return meta


class _Images:
    """Decoder of the images of a bundle with `count` Gaussians."""

    def __init__(self, bundle: _Bundle, count: int) -> None:
        self.bundle, self.count = bundle, count

    def pixels(self, name: str) -> Bytes:
        """`[count, 4]` RGBA bytes, one row per Gaussian."""
        flat = self.decode(name, 4 * self.count + _SPARE_PIXELS).reshape(-1, 4)
        if len(flat) < self.count:
            raise FileError(f"{self.bundle.path}: {name} holds {len(flat):,} pixels for {self.count:,} Gaussians")
        return flat[: self.count]

    def decode(self, name: str, max_pixels: int) -> Bytes:
        """`[height, width, 4]` RGBA bytes of an image of at most `max_pixels` pixels."""
        from PIL import Image, features

        if not features.check("webp"):
            raise FileError("this Pillow cannot read WebP, which SOG needs; reinstall it: pip install -U pillow")
        data = self.bundle.get(name, 8 * max_pixels + _SPARE_PIXELS)
        try:
            with Image.open(io.BytesIO(data), formats=("WEBP", "PNG")) as image:
                if image.width * image.height > max_pixels:
                    raise FileError(f"{self.bundle.path}: {name} is larger ({image.size}) than its scene needs")
                return np.asarray(image.convert("RGBA"))
        except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
            raise FileError(f"{self.bundle.path}: {name} is not a readable WebP image ({error})") from error


def _means(images: _Images, means: _Means) -> values.Floats:
    """Positions `[N, 3]`, stored as `sign(x) log(1 + |x|)` in 16 bits between bounds."""
    low, high = (images.pixels(name)[:, :3].astype(np.float64) for name in means.files)
    mins, maxs = np.array(means.mins), np.array(means.maxs)
    logs = mins + (maxs - mins) * ((low + 256 * high) / 65535)
    with np.errstate(over="ignore", invalid="ignore"):  # huge bounds give infinite rows, which `sound_cloud` drops
        return values.rounded(np.sign(logs) * np.expm1(np.abs(logs)))


def _rotations(pixels: Bytes) -> values.Floats:
    """Unit quaternions `[N, 4]` wxyz: RGB are the smaller three over ±1/√2, alpha is 252 + index of the largest.

    A pixel with a smaller alpha has no rotation: it becomes zero, and `sound_cloud` repairs and counts it.
    """
    tagged = pixels[:, 3] >= 252
    quats = values.smallest_three(pixels[:, :3] / 255, np.where(tagged, pixels[:, 3], 252) - 252)
    return np.where(tagged[:, None], quats, np.float32(0))


def _decode(path: Path, codebook: tuple[float, ...], codes: NDArray[Any]) -> values.Floats:
    """The codebook's values at the indices `codes`, float32."""
    if int(codes.max(initial=0)) >= len(codebook):
        raise FileError(f"{path}: a code lies beyond its codebook of {len(codebook)} values; the file is damaged")
    decoded: values.Floats = values.rounded(np.array(codebook))[codes]
    return decoded


def _bands(images: _Images, palette: _Palette) -> values.Floats:
    """Coefficients above the constant band, `[N, K - 1, 3]`: each Gaussian refers to a set of a palette by its label.

    The palette image has 64 sets per row, each K - 1 pixels wide, with the channels in RGB.
    """
    centroids, labels = palette.files
    k = next(k for k, degree in SH_BANDS.items() if degree == palette.bands)
    width, rows = PALETTE_COLUMNS * (k - 1), -(-palette.count // PALETTE_COLUMNS)
    image = images.decode(centroids, 2 * width * rows + _SPARE_PIXELS)
    if image.shape[0] < rows or image.shape[1] < width:
        raise FileError(f"{images.bundle.path}: {centroids} is too small for {palette.count:,} sets of coefficients")
    codes = image[:rows, :width, :3].reshape(rows * PALETTE_COLUMNS, k - 1, 3)[: palette.count]
    sets = _decode(images.bundle.path, palette.codebook, codes)
    pixels = images.pixels(labels).astype(np.int64)
    chosen = pixels[:, 0] + 256 * pixels[:, 1]
    if int(chosen.max()) >= palette.count:
        raise FileError(f"{images.bundle.path}: {labels} has labels beyond the palette of {palette.count:,} sets")
    bands: values.Floats = sets[chosen]
    return bands


FORMAT = Format(NAME, (".sog",), recognises, read, write, morton_order=True)
