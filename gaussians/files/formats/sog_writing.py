"""Writes SOG version 2 (see `sog` for reading): meta.json and lossless WebP images, in one zip archive.

The specification is developer.playcanvas.com/user-manual/gaussian-splatting/formats/sog.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...errors import FileError
from ...scene import Scene
from . import codebooks, values

PALETTE_COLUMNS = 64
PALETTE_LIMIT = 1 << 16  # labels have 16 bits
_GAUSSIANS_PER_SET = 4  # of coefficients, in scenes with enough Gaussians
_CODEBOOK_SIZE = 256
_LOG_LIMIT = 20.0  # of log scales: 2e-9 to 5e8 units
_DATE = (1980, 1, 1, 0, 0, 0)  # the first date of zip, so that equal scenes give equal bytes
Bytes = NDArray[np.uint8]


def write(scene: Scene, file: BinaryIO) -> None:
    """Write the scene in row order: one pixel per Gaussian, row by row of each image."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, data in encoded(scene.cloud).items():
            archive.writestr(zipfile.ZipInfo(name, _DATE), data)


def encoded(gaussians: GaussianCloud) -> dict[str, bytes]:
    """The bytes of meta.json and of the images by name, with the rows in their order."""
    cloud = values.columns(gaussians)
    count = len(gaussians)
    meta: dict[str, Any] = {"version": 2, "asset": {"generator": "scenewright"}, "count": count}
    parts: dict[str, Bytes] = {}
    meta["means"] = _means(cloud["means"], parts)
    thirds, largest = values.without_largest(cloud["quats"])
    parts["quats.webp"] = _square(values.codes(thirds / 2 + 0.5, 255), largest + 252)
    meta["quats"] = {"files": ["quats.webp"]}
    logs = np.clip(values.logs_from_scales(cloud["scales"]), -_LOG_LIMIT, _LOG_LIMIT).astype(np.float32)
    for name, column, alpha in (
        ("scales", logs, np.full(count, 255)),
        ("sh0", cloud["sh"][:, 0], values.codes(cloud["opacities"], 255)),
    ):
        book = codebooks.codebook(column, _CODEBOOK_SIZE)
        parts[f"{name}.webp"] = _square(codebooks.nearest(column, book), alpha)
        meta[name] = {"codebook": _padded(book), "files": [f"{name}.webp"]}
    if gaussians.degree:
        meta["shN"] = _bands(cloud["sh"][:, 1:], gaussians.degree, parts)
    index = json.dumps(meta, separators=(",", ":")).encode()
    return {"meta.json": index} | {name: _webp(pixels) for name, pixels in parts.items()}


def _means(means: values.Floats, parts: dict[str, Bytes]) -> dict[str, Any]:
    """Store positions as `sign(x) log(1 + |x|)` in 16 bits between bounds, one image per byte; returns their meta."""
    logs = np.sign(means) * np.log1p(np.abs(means.astype(np.float64)))
    low, high = logs.min(axis=0), logs.max(axis=0)
    span = np.where(high > low, high - low, 1.0)
    codes = values.codes((logs - low) / span, 65535)
    opaque = np.full(len(means), 255)
    parts["means_l.webp"], parts["means_u.webp"] = _square(codes & 255, opaque), _square(codes >> 8, opaque)
    return {"mins": low.tolist(), "maxs": high.tolist(), "files": ["means_l.webp", "means_u.webp"]}


def _bands(rest: values.Floats, degree: int, parts: dict[str, Bytes]) -> dict[str, Any]:
    """Store coefficients above the constant band `[N, K - 1, 3]` as a palette of sets and one label per Gaussian."""
    count, k, _ = rest.shape
    size = min(PALETTE_LIMIT, max(count // _GAUSSIANS_PER_SET, min(count, 1024)))
    centres, labels = codebooks.palette(rest.reshape(count, -1), size)
    book = codebooks.codebook(centres, _CODEBOOK_SIZE)
    rows = -(-len(centres) // PALETTE_COLUMNS)
    image = np.zeros((rows * PALETTE_COLUMNS, k, 4), np.uint8)
    image[..., 3] = 255
    image[: len(centres), :, :3] = codebooks.nearest(centres, book).reshape(-1, k, 3)
    parts["shN_centroids.webp"] = image.reshape(rows, PALETTE_COLUMNS * k, 4)
    low, high = labels & 255, labels >> 8
    parts["shN_labels.webp"] = _square(np.stack([low, high, np.zeros_like(low)], axis=1), np.full(count, 255))
    files = ["shN_centroids.webp", "shN_labels.webp"]
    return {"count": len(centres), "bands": degree, "codebook": _padded(book), "files": files}


def _padded(book: values.Floats) -> list[float]:
    """A codebook padded with its last value to exactly 256 entries, as readers expect."""
    return [float(v) for v in np.concatenate([book, np.repeat(book[-1:], _CODEBOOK_SIZE - len(book))])]


def _square(rgb: NDArray[np.integer], alpha: NDArray[np.integer]) -> Bytes:
    """`[height, width, 4]` image, about square, one pixel per Gaussian; width and height are multiples of four."""
    count = len(rgb)
    width = 4 * math.ceil(math.sqrt(count) / 4)
    height = 4 * math.ceil(count / width / 4)
    image = np.zeros((height * width, 4), np.uint8)
    image[:count, :3], image[:count, 3] = rgb, alpha
    return image.reshape(height, width, 4)


def _webp(pixels: Bytes) -> bytes:
    """A lossless WebP that keeps the colours of transparent pixels."""
    from PIL import Image, features

    if not features.check("webp"):
        raise FileError("this Pillow cannot write WebP, which SOG needs; reinstall it: pip install -U pillow")
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "WEBP", lossless=True, exact=True, quality=75, method=3)
    return out.getvalue()
