"""Reads and writes PlayCanvas' compressed .ply: chunks of 256 Gaussians share bounds, a Gaussian is four 32-bit words.

The layout is that of SuperSplat and splat-transform (github.com/playcanvas/splat-transform, reader of compressed
PLY): element `chunk` with float bounds of position, log scale and, in newer files, colour; element `vertex` with
packed position and scale (11, 10, 11 bits), rotation (index of the largest component in 2 bits, the other three in 10
each) and colour with opacity (8 bits each); optional element `sh` with one byte per coefficient.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...cloud import SH_BANDS
from ...errors import FileError
from ...harmonics import SH_C0
from ...scene import Scene
from ..format import Format, Report
from . import comments, ply, values

NAME = "PlayCanvas compressed .ply"
_CHUNK = 256
_LOG_LIMIT = 20.0
_PACKED = ("packed_position", "packed_rotation", "packed_scale", "packed_color")
_POSITION, _SCALE, _COLOR = ("x", "y", "z"), ("scale_x", "scale_y", "scale_z"), ("r", "g", "b")
_Words = NDArray[np.uint32]
Number = TypeVar("Number", bound=np.generic)


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file starts as a PLY with packed vertices."""
    return head[:4] in (b"ply\n", b"ply\r") and b"packed_position" in head


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: the file is cut off, malformed or empty, or its chunks or harmonics do not match the vertices.
    """
    with open(path, "rb") as file:
        header = ply.read_header(file, path)
        count, degree = _check(path, header)
        words = _table(file, path, header, ("vertex", _PACKED), np.uint32)
        bounds = _bounds(file, path, header)
        rest = _harmonics(file, path, header, degree)
    chunk = np.arange(count) // _CHUNK
    position, rotation, scale, color = words.T
    rgb = _interpolate(bounds, _COLOR, chunk, _unpack(color, (8, 8, 8, 8))[:, :3])
    sh = np.concatenate([values.rounded((rgb - 0.5) / SH_C0)[:, None], rest], axis=1)
    logs = _interpolate(bounds, _SCALE, chunk, _unpack(scale, (11, 10, 11)))
    cloud, notes = values.sound_cloud(
        values.rounded(_interpolate(bounds, _POSITION, chunk, _unpack(position, (11, 10, 11)))),
        _rotations(rotation),
        values.scales_from_logs(values.rounded(logs)),
        values.opacities_from_bytes(color & 255),
        sh,
    )
    frame, cameras, ignored = comments.parse(header.comments)
    return Scene(cloud, frame, cameras, path=path), Report(NAME, count, len(cloud), notes + ignored)


def _check(path: Path, header: ply.Header) -> tuple[int, int]:
    """Check that the elements fit together; returns the number of Gaussians and the harmonics degree."""
    chunk, vertex, sh = (header.element(name) for name in ("chunk", "vertex", "sh"))
    if chunk is None or vertex is None:
        raise FileError(f"{path}: a compressed PLY needs the elements chunk and vertex")
    wanted = [f"{end}_{name}" for end in ("min", "max") for name in (*_POSITION, *_SCALE)]
    missing = [n for n in wanted if n not in chunk.names] + [n for n in _PACKED if n not in vertex.names]
    if missing:
        raise FileError(f"{path}: the compressed PLY lacks {', '.join(missing)}")
    if any(kind not in ("u4", "i4") for name, kind in vertex.properties if name in _PACKED):
        raise FileError(f"{path}: packed properties must be 32-bit integers")
    if vertex.count == 0:
        raise FileError(f"{path}: the file holds zero Gaussians")
    if chunk.count * _CHUNK < vertex.count:
        raise FileError(
            f"{path}: {chunk.count:,} chunks cannot describe {vertex.count:,} Gaussians at {_CHUNK} a chunk; "
            "the file is damaged"
        )
    if sh is None:
        return vertex.count, 0
    degrees = {3 * (k - 1): degree for k, degree in SH_BANDS.items() if degree}
    if sh.count != vertex.count or set(sh.names) not in [{f"f_rest_{i}" for i in range(n)} for n in degrees]:
        raise FileError(f"{path}: the sh element must hold 9, 24 or 45 f_rest properties for each Gaussian")
    return vertex.count, degrees[len(sh.names)]


def _table(
    file: BinaryIO, path: Path, header: ply.Header, columns: tuple[str, tuple[str, ...]], dtype: type[Number]
) -> NDArray[Number]:
    """Columns `(element, names)` of the file as `[rows, names]`."""
    element, names = columns
    found = header.element(element)
    assert found is not None
    blocks = ply.read_rows(file, path, header, element)
    table = np.empty((found.count, len(names)), dtype)
    with np.errstate(invalid="ignore"):
        for start, rows in blocks:
            for i, name in enumerate(names):
                table[start : start + len(rows), i] = rows[name].astype(dtype)
    return table


def _bounds(file: BinaryIO, path: Path, header: ply.Header) -> dict[str, NDArray[np.float64]]:
    """Bounds by property name, `[chunks]` each; colour spans 0 to 1 in files that do not store it."""
    chunk = header.element("chunk")
    assert chunk is not None
    table = _table(file, path, header, ("chunk", chunk.names), np.float64)
    bounds = {name: table[:, i] for i, name in enumerate(chunk.names)}
    for name in _COLOR:
        bounds.setdefault(f"min_{name}", np.zeros(len(table)))
        bounds.setdefault(f"max_{name}", np.ones(len(table)))
    return bounds


def _harmonics(file: BinaryIO, path: Path, header: ply.Header, degree: int) -> values.Floats:
    """Coefficients above the constant band, `[N, K - 1, 3]`, one byte each for -4 to 4; channel-major in the file.

    Bytes 0 and 255 mean exactly -4 and 4, the others the middle of their interval.
    """
    vertex, k = header.element("vertex"), (degree + 1) ** 2
    assert vertex is not None
    if degree == 0:
        return np.empty((vertex.count, 0, 3), np.float32)
    steps = (np.arange(256) + 0.5) / 256
    steps[0], steps[255] = 0, 1
    lookup = ((steps - 0.5) * 8).astype(np.float32)
    names = tuple(f"f_rest_{i}" for i in range(3 * (k - 1)))
    codes = _table(file, path, header, ("sh", names), np.uint8)
    channels: values.Floats = lookup[codes].reshape(vertex.count, 3, k - 1)
    return np.ascontiguousarray(channels.transpose(0, 2, 1))


def _unpack(words: _Words, bits: tuple[int, ...]) -> NDArray[np.float64]:
    """Unsigned bit fields of words as `[N, fields]` in [0, 1]; the first field has the highest bits."""
    out = np.empty((len(words), len(bits)))
    shift = 32
    for i, width in enumerate(bits):
        shift -= width
        out[:, i] = ((words >> np.uint32(shift)) & np.uint32((1 << width) - 1)) / ((1 << width) - 1)
    return out


def _interpolate(
    bounds: dict[str, NDArray[np.float64]], names: tuple[str, ...], chunk: NDArray[np.int64], t: NDArray[np.float64]
) -> NDArray[np.float64]:
    """`[N, 3]` linear interpolation between the bounds of each Gaussian's chunk, at fractions `t` `[N, 3]`."""
    low, high = (np.stack([bounds[f"{end}_{name}"] for name in names], axis=1)[chunk] for end in ("min", "max"))
    with np.errstate(all="ignore"):  # bounds that are not finite give rows that `sound_cloud` drops
        mixed: NDArray[np.float64] = low * (1 - t) + high * t
    return mixed


def _rotations(words: _Words) -> values.Floats:
    """Unit quaternions `[N, 4]` wxyz: index of the largest component in the high bits, the others over ±1/√2."""
    return values.smallest_three(_unpack(words, (2, 10, 10, 10))[:, 1:], words >> np.uint32(30))


def write(scene: Scene, file: BinaryIO) -> None:
    """Write the scene in row order; rows of one chunk should be neighbours in space (`morton.morton_sorted`).

    Log scales are clamped to ±20 (2e-9 and 5e8 units), so that one flat Gaussian does not widen the bounds of its
    chunk. Coefficients above the constant band are clamped to ±4, the range of the format.
    """
    cloud = values.columns(scene.cloud)
    means, sh, n = cloud["means"].astype(np.float64), cloud["sh"], len(cloud["means"])
    logs = np.clip(values.logs_from_scales(cloud["scales"]).astype(np.float64), -_LOG_LIMIT, _LOG_LIMIT)
    colors = sh[:, 0].astype(np.float64) * SH_C0 + 0.5
    chunks, words = np.empty((-(-n // _CHUNK), 18), "<f4"), np.empty((n, 4), "<u4")
    for part, (column, (low, high), widths) in enumerate(
        ((means, (0, 3), (11, 10, 11)), (logs, (6, 9), (11, 10, 11)), (colors, (12, 15), (8, 8, 8)))
    ):
        fractions = _normalise(column, chunks[:, low:high], chunks[:, high : high + 3])
        words[:, (0, 2, 3)[part]] = _pack(fractions, widths)
    words[:, 3] = (words[:, 3] << np.uint32(8)) | values.codes(cloud["opacities"], 255)
    thirds, largest = values.without_largest(cloud["quats"])
    words[:, 1] = (largest.astype(np.uint32) << np.uint32(30)) | _pack(thirds / 2 + 0.5, (10, 10, 10))
    rest = sh[:, 1:].transpose(0, 2, 1).reshape(n, -1)  # to channel-major
    file.write(_header(scene, len(chunks), rest.shape[1]))
    file.write(chunks.tobytes())
    file.write(words.tobytes())
    for start in range(0, n if rest.shape[1] else 0, ply.BLOCK_ROWS):
        block = rest[start : start + ply.BLOCK_ROWS]
        file.write(np.clip(np.floor(block * 32 + 128), 0, 255).astype(np.uint8).tobytes())


def _header(scene: Scene, chunks: int, rest: int) -> bytes:
    """The header's bytes; `rest` is the number of coefficients per Gaussian above the constant band."""
    bounds = [f"{end}_{n}" for group in (_POSITION, _SCALE, _COLOR) for end in ("min", "max") for n in group]
    lines = ["ply", "format binary_little_endian 1.0", *(f"comment {note}" for note in comments.describe(scene))]
    lines += [f"element chunk {chunks}", *(f"property float {name}" for name in bounds)]
    lines += [f"element vertex {len(scene.cloud)}", *(f"property uint {name}" for name in _PACKED)]
    if rest:
        lines += [f"element sh {len(scene.cloud)}", *(f"property uchar f_rest_{i}" for i in range(rest))]
    return ("\n".join([*lines, "end_header"]) + "\n").encode("ascii")


def _normalise(column: NDArray[np.float64], low: NDArray[Any], high: NDArray[Any]) -> NDArray[np.float64]:
    """Fractions `[N, 3]` of `column` between the bounds of its chunks; the bounds are written to `low` and `high`."""
    starts = np.arange(0, len(column), _CHUNK)
    low[:], high[:] = np.minimum.reduceat(column, starts), np.maximum.reduceat(column, starts)
    chunk = np.arange(len(column)) // _CHUNK
    base, span = low[chunk].astype(np.float64), (high.astype(np.float64) - low)[chunk]
    return np.divide(column - base, span, out=np.zeros_like(column), where=span > 0)


def _pack(fractions: NDArray[np.float64], widths: tuple[int, ...]) -> _Words:
    """Pack fields in [0, 1] into `[N]` words; the last field gets the lowest bits."""
    words = np.zeros(len(fractions), np.uint32)
    for i, width in enumerate(widths):
        words = (words << np.uint32(width)) | values.codes(fractions[:, i], (1 << width) - 1)
    return words


FORMAT = Format(NAME, (".compressed.ply",), recognises, read, write, morton_order=True)
