""".splat: 32 bytes a Gaussian and nothing else, read and written.

Knows the layout of antimatter15/splat (github.com/antimatter15/splat, convert.py and main.js): three float32 of
position, three of standard deviation, RGBA bytes of base colour and opacity, four bytes of the quaternion wxyz as
128 + 128 q. Refuses to know harmonics above the constant one, which the format cannot hold.
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...errors import FileError
from ...harmonics import SH_C0
from ...scene import Scene
from ..format import Format, Report
from . import values

NAME = "antimatter15 .splat"
_ROW = np.dtype([("mean", "<f4", 3), ("scale", "<f4", 3), ("rgba", "u1", 4), ("quat", "u1", 4)])


def recognises(path: Path, head: bytes) -> bool:
    """Never: any bytes could be this format, so only the name says it."""
    return False


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: empty, cut off inside a row, or without a usable row.
    """
    size = path.stat().st_size
    if size == 0 or size % _ROW.itemsize:
        raise FileError(
            f"{path}: a .splat file holds {_ROW.itemsize} bytes for each Gaussian, this one has {size:,} bytes; it is "
            "empty, cut off or another format"
        )
    rows = np.fromfile(path, _ROW)
    scales = rows["scale"]
    with np.errstate(invalid="ignore"):  # a negative deviation is a fault like NaN
        scales = np.where(scales >= 0, np.maximum(scales, np.float32(values.SCALE_MIN)), np.float32(np.nan))
    quats = ((rows["quat"].astype(np.float64) - 128) / 128).astype(np.float32)
    dc = ((rows["rgba"][:, :3] / 255 - 0.5) / SH_C0).astype(np.float32)
    cloud, notes = values.sound_cloud(
        np.ascontiguousarray(rows["mean"]),
        quats,
        scales,
        values.opacities_from_bytes(rows["rgba"][:, 3]),
        dc[:, None],
    )
    return Scene(cloud, path=path), Report(NAME, len(rows), len(cloud), notes)


def write(scene: Scene, file: BinaryIO) -> None:
    """Write the scene in row order; only the constant band of the harmonics has a place."""
    cloud = values.columns(scene.cloud)
    rows = np.empty(len(cloud["means"]), _ROW)
    rows["mean"], rows["scale"] = cloud["means"], cloud["scales"]
    rows["rgba"][:, :3] = values.codes(cloud["sh"][:, 0].astype(np.float64) * SH_C0 + 0.5, 255)
    rows["rgba"][:, 3] = values.codes(cloud["opacities"], 255)
    quats = values.unit_quats(cloud["quats"])[0]
    # Of q and -q the one whose largest component is negative: -1 has a byte, 1 has none.
    largest = np.take_along_axis(quats, np.argmax(np.abs(quats), axis=1)[:, None], axis=1)
    rows["quat"] = np.clip(np.rint(np.where(largest > 0, -quats, quats) * 128 + 128), 0, 255)
    file.write(rows.tobytes())


FORMAT = Format(NAME, (".splat",), recognises, read, write)
