"""Reads and writes .splat: 32 bytes per Gaussian, without a header.

The layout is that of antimatter15/splat (github.com/antimatter15/splat, convert.py and main.js): three float32 of
position, three of standard deviation, RGBA bytes of base colour and opacity, four bytes of the wxyz quaternion as
128 + 128 q. The format cannot hold harmonics above the constant band.
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
    """Always False: any bytes could be this format, so only the file name identifies it."""
    return False


def read(path: Path) -> tuple[Scene, Report]:
    """Read the scene.

    Raises:
        FileError: the file is empty, cut off inside a row, or without a usable row.
    """
    size = path.stat().st_size
    if size == 0 or size % _ROW.itemsize:
        raise FileError(
            f"{path}: a .splat file holds {_ROW.itemsize} bytes for each Gaussian, this one has {size:,} bytes; it is "
            "empty, cut off or another format"
        )
    rows = np.fromfile(path, _ROW)
    scales = rows["scale"]
    with np.errstate(invalid="ignore"):  # a negative standard deviation makes a row invalid, like NaN
        scales = np.where(scales >= 0, np.maximum(scales, np.float32(values.SCALE_MIN)), np.float32(np.nan))
    quats = ((rows["quat"].astype(np.float64) - 128) / 128).astype(np.float32)
    dc = ((rows["rgba"][:, :3] / 255 - 0.5) / SH_C0).astype(np.float32)
    means, opacities = np.ascontiguousarray(rows["mean"]), values.opacities_from_bytes(rows["rgba"][:, 3])
    cloud, notes = values.sound_cloud(means, quats, scales, opacities, dc[:, None])
    return Scene(cloud, path=path), Report(NAME, len(rows), len(cloud), notes)


def write(scene: Scene, file: BinaryIO) -> None:
    """Write the scene in row order; harmonics above the constant band are dropped."""
    cloud = values.columns(scene.cloud)
    rows = np.empty(len(cloud["means"]), _ROW)
    rows["mean"], rows["scale"] = cloud["means"], cloud["scales"]
    rows["rgba"][:, :3] = values.codes(cloud["sh"][:, 0].astype(np.float64) * SH_C0 + 0.5, 255)
    rows["rgba"][:, 3] = values.codes(cloud["opacities"], 255)
    quats = values.unit_quats(cloud["quats"])[0]
    # Of q and -q, write the one whose largest component is negative: a byte can hold -1 but not 1.
    largest = np.take_along_axis(quats, np.argmax(np.abs(quats), axis=1)[:, None], axis=1)
    rows["quat"] = np.clip(np.rint(np.where(largest > 0, -quats, quats) * 128 + 128), 0, 255)
    file.write(rows.tobytes())


FORMAT = Format(NAME, (".splat",), recognises, read, write)
