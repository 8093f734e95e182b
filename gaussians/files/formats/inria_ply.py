"""Reads and writes the .ply of the original 3D Gaussian Splatting (Kerbl et al. 2023).

Properties: x y z, f_dc_0..2, f_rest_* (channel-major: all of red, then green, then blue), opacity (logit), scale_0..2
(natural logarithm), rot_0..3 (wxyz). Order of properties, byte order and extra properties do not matter. Our own files
store frame and cameras in header comments (see `comments`).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...cloud import SH_BANDS, GaussianCloud
from ...errors import FileError
from ...scene import Scene
from ..format import Format, Report
from . import comments, ply, values

_REQUIRED = (
    "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
    "rot_0", "rot_1", "rot_2", "rot_3",
)  # fmt: skip
NAME = "INRIA .ply"


def recognises(path: Path, head: bytes) -> bool:
    """Whether the file starts as a PLY that is not the compressed one."""
    return head[:4] in (b"ply\n", b"ply\r") and b"packed_position" not in head


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: the file is cut off, malformed or empty, or lacks properties of Gaussians.
    """
    with open(path, "rb") as file:
        head = ply.read_header(file, path)
        vertex = head.element("vertex")
        degree = _degree(path, vertex)
        assert vertex is not None
        blocks = ply.read_rows(file, path, head, "vertex")
        means, quats, logs, logits, sh = _gather(blocks, vertex.count, degree)
        more = ply.left_over(file, head, "vertex")
    scales, opacities = values.scales_from_logs(logs), values.opacities_from_logits(logits)
    cloud, notes = values.sound_cloud(means, quats, scales, opacities, sh)
    frame, cameras, ignored = comments.parse(head.comments)
    scene = Scene(cloud, frame, cameras, path=path)
    return scene, Report(NAME, vertex.count, len(cloud), notes + ignored + more)


def outline(path: Path) -> tuple[Scene, int, int]:
    """Frame and cameras of a file, in a scene without Gaussians; its number of rows, and its harmonics degree.

    Raises:
        FileError: as `read`.
    """
    with open(path, "rb") as file:
        head = ply.read_header(file, path)
        vertex = head.element("vertex")
        degree = _degree(path, vertex)
        assert vertex is not None
        ply.read_rows(file, path, head, "vertex")  # compares the counts with the size
    frame, cameras, _ = comments.parse(head.comments)
    return Scene(GaussianCloud.empty(degree), frame, cameras, path=path), vertex.count, degree


def blocks(path: Path, rows: int, every: int = 1) -> Iterator[tuple[GaussianCloud, int]]:
    """The sound Gaussians of a file, `rows` of its rows at a time, with row numbers as ids; and how many of their
    quaternions became the identity. No more than one block is in memory.

    Args:
        every: read only each so many-th block, for a sample; those between are passed over.

    Raises:
        FileError: as `read`.
    """
    with open(path, "rb") as file:
        head = ply.read_header(file, path)
        vertex = head.element("vertex")
        degree = _degree(path, vertex)
        assert vertex is not None
        for first, found in ply.read_blocks(file, path, head, "vertex", rows, every):
            means, quats, logs, logits, sh = _gather(
                ((k, found[k : k + ply.BLOCK_ROWS]) for k in range(0, len(found), ply.BLOCK_ROWS)), len(found), degree
            )
            scales, opacities = values.scales_from_logs(logs), values.opacities_from_logits(logits)
            yield values.sound_rows(means, quats, scales, opacities, sh, first)


def _degree(path: Path, vertex: ply.Element | None) -> int:
    """Check that the vertex element has the properties of Gaussians; returns the harmonics degree."""
    if vertex is None:
        raise FileError(f"{path}: the PLY file has no vertex element, so no Gaussians")
    missing = [name for name in _REQUIRED if name not in vertex.names]
    if missing:
        what = "a mesh or point cloud" if len(missing) > 4 else "incomplete"
        raise FileError(
            f"{path}: not a Gaussian scene ({what}): the vertex properties {', '.join(missing)} are missing"
        )
    if vertex.count == 0:
        raise FileError(f"{path}: the file holds zero Gaussians")
    rest = [name for name in vertex.names if name.startswith("f_rest_")]
    by_count = {3 * (k - 1): degree for k, degree in SH_BANDS.items()}
    if len(rest) not in by_count or {f"f_rest_{i}" for i in range(len(rest))} != set(rest):
        raise FileError(
            f"{path}: {len(rest)} f_rest properties; degrees 0 to 3 have f_rest_0 to 0, 9, 24 or 45 of them"
        )
    return by_count[len(rest)]


def _gather(blocks: Any, count: int, degree: int) -> tuple[values.Floats, ...]:
    """Stored columns `means [N,3], quats [N,4], logs [N,3], logits [N], sh [N,K,3]` from blocks of rows."""
    k = (degree + 1) ** 2
    means, quats, logs = (np.empty((count, width), np.float32) for width in (3, 4, 3))
    logits, sh = np.empty(count, np.float32), np.empty((count, k, 3), np.float32)
    with np.errstate(over="ignore"):  # a double beyond float32 becomes infinite, and `sound_cloud` drops its row
        for start, rows in blocks:
            span = slice(start, start + len(rows))
            for axis in range(3):
                means[span, axis] = rows["xyz"[axis]]
                logs[span, axis] = rows[f"scale_{axis}"]
                sh[span, 0, axis] = rows[f"f_dc_{axis}"]
                for band in range(1, k):
                    sh[span, band, axis] = rows[f"f_rest_{axis * (k - 1) + band - 1}"]
            for axis in range(4):
                quats[span, axis] = rows[f"rot_{axis}"]
            logits[span] = rows["opacity"]
    return means, quats, logs, logits, sh


def write(scene: Scene, file: BinaryIO) -> None:
    """Write the scene in row order, little-endian float32, with the zero normals that INRIA's viewer expects."""
    file.write(header(len(scene.cloud), scene.cloud.degree, comments.describe(scene)))
    write_rows(scene.cloud, file)


def write_rows(cloud: GaussianCloud, file: BinaryIO) -> None:
    """Write the rows of a cloud, as they follow a `header`."""
    columns = {name: column.detach().cpu().numpy() for name, column in cloud.columns()}
    means, scales, opacities, sh = (columns[name] for name in ("means", "scales", "opacities", "sh"))
    quats, _ = values.unit_quats(columns["quats"])
    k = sh.shape[1]
    rest = 9 + 3 * (k - 1)
    for start in range(0, len(means), ply.BLOCK_ROWS):
        span = slice(start, start + ply.BLOCK_ROWS)
        rows = np.zeros((len(means[span]), rest + 8), "<f4")
        rows[:, 0:3] = means[span]
        rows[:, 6:9] = sh[span, 0]
        rows[:, 9:rest] = sh[span, 1:].transpose(0, 2, 1).reshape(len(rows), -1)  # to channel-major
        rows[:, rest] = values.logits_from_opacities(opacities[span])
        rows[:, rest + 1 : rest + 4] = values.logs_from_scales(scales[span])
        rows[:, rest + 4 :] = quats[span]
        file.write(rows.data)


def header(count: int, degree: int, notes: tuple[str, ...]) -> bytes:
    """The header of a file of `count` rows, with comments.

    They come last: INRIA's viewer reads the vertex count from the third line.
    """
    names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"]
    names += [f"f_rest_{i}" for i in range(3 * ((degree + 1) ** 2 - 1))]
    names += ["opacity", *(f"scale_{i}" for i in range(3)), *(f"rot_{i}" for i in range(4))]
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    lines += [f"property float {name}" for name in names]
    lines += [f"comment {note}" for note in notes]
    return ("\n".join([*lines, "end_header"]) + "\n").encode("ascii")


FORMAT = Format(NAME, (".ply",), recognises, read, write)
