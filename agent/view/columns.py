"""The columns of a cloud as the page reads them: the bytes of rows, and back (docs/view-protocol.md, "Slots").

N: Gaussians; M: rows that are sent; K: coefficients a channel; G: groups of the language field.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.cloud import NO_GROUP, GaussianCloud
from ...gaussians.scene import Scene

COLUMNS = ("position", "shape", "color", "harmonics", "group")
# The tensors of a cloud that each column is made from. `sh` is split: band 0 is "color", the others "harmonics".
SOURCES = {
    "position": ("means",), "shape": ("quats", "scales"), "color": ("sh", "opacities"), "harmonics": ("sh",),
    "group": ("group",),
}  # fmt: skip

_UNIT = 32767  # of a quaternion's component
_OPAQUE = 65535
_HALF = float(np.finfo(np.float16).max)
_SHAPE = np.dtype([("quat", "<i2", 4), ("log_scale", "<f2", 3)])  # 14 bytes, packed
_COLOR = np.dtype([("dc", "<f2", 3), ("opacity", "<u2")])

Rows = NDArray[np.int64]
I32 = NDArray[np.int32]


def columns_of(degree: int) -> tuple[str, ...]:
    """The columns of a cloud whose harmonics have this degree."""
    return COLUMNS if degree else tuple(name for name in COLUMNS if name != "harmonics")


def width(column: str, degree: int) -> int:
    """Bytes of one row of a column."""
    fixed = {"position": 12, "shape": _SHAPE.itemsize, "color": _COLOR.itemsize, "group": 4}
    return 6 * ((degree + 1) ** 2 - 1) if column == "harmonics" else fixed[column]


def owners(scene: Scene) -> I32:
    """`[G + 1]`: the thing that a group belongs to, at its number plus one; a part belongs to its object."""
    groups = scene.language.groups if scene.language is not None else ()
    most = max(len(groups), int(scene.cloud.group.max()) + 1 if len(scene.cloud) else 0)
    table = np.arange(NO_GROUP, most, dtype=np.int32)
    for g in groups:
        table[g.id + 1] = g.parent if g.parent >= 0 else g.id
    return table


def encode(cloud: GaussianCloud, owner: I32, column: str, rows: Rows) -> bytes:
    """The bytes of a column at rows `[M]` of a cloud; -1 stands for an empty slot.

    Args:
        owner: `[G + 1]`, see `owners`.
    """
    full = rows >= 0
    index = torch.from_numpy(rows if full.all() else np.where(full, rows, 0))
    made = (
        _ENCODERS[column](cloud, owner, index) if len(cloud) else np.zeros(len(rows), f"V{width(column, cloud.degree)}")
    )
    if not full.all():
        made[~full] = NO_GROUP if column == "group" else np.zeros(1, made.dtype)
    return made.tobytes()


def decode(data: bytes, column: str) -> dict[str, NDArray[Any]]:
    """What the bytes of a column hold, as the page reads them: the reference that tests hold `encode` against.

    Returns:
        by name: `means [M, 3]`; `quats [M, 4]` and `scales [M, 3]`; `dc [M, 3]` and `opacities [M]` (0: empty);
        `rest [3 M (K - 1)]`; or `owner [M]`.
    """
    if column == "position":
        return {"means": np.frombuffer(data, "<f4").reshape(-1, 3)}
    if column == "shape":
        shape = np.frombuffer(data, _SHAPE)
        quats = shape["quat"].astype(np.float32) / _UNIT
        return {"quats": quats, "scales": np.exp(shape["log_scale"].astype(np.float32))}
    if column == "color":
        color = np.frombuffer(data, _COLOR)
        return {"dc": color["dc"].astype(np.float32), "opacities": color["opacity"].astype(np.float32) / _OPAQUE}
    if column == "harmonics":
        return {"rest": np.frombuffer(data, "<f2").astype(np.float32)}
    return {"owner": np.frombuffer(data, "<i4").astype(np.int32)}


def _position(cloud: GaussianCloud, owner: I32, rows: torch.Tensor) -> NDArray[np.void]:
    return _structured(_taken(cloud.means, rows), "<f4")


def _shape(cloud: GaussianCloud, owner: I32, rows: torch.Tensor) -> NDArray[np.void]:
    made = np.empty(len(rows), _SHAPE)
    quats = _taken(cloud.quats, rows)
    signed = np.where(quats[:, :1] < 0, -quats, quats)  # q and -q turn alike
    made["quat"] = np.rint(np.clip(signed, -1, 1) * _UNIT)
    made["log_scale"] = np.log(_taken(cloud.scales, rows))
    return made


def _color(cloud: GaussianCloud, owner: I32, rows: torch.Tensor) -> NDArray[np.void]:
    made = np.empty(len(rows), _COLOR)
    made["dc"] = np.clip(_taken(cloud.sh[:, 0], rows), -_HALF, _HALF)
    # 0 would say that the slot is empty.
    made["opacity"] = np.clip(np.rint(_taken(cloud.opacities, rows) * _OPAQUE), 1, _OPAQUE)
    return made


def _harmonics(cloud: GaussianCloud, owner: I32, rows: torch.Tensor) -> NDArray[np.void]:
    return _structured(np.clip(_taken(cloud.sh, rows)[:, 1:].reshape(len(rows), -1), -_HALF, _HALF), "<f2")


def _group(cloud: GaussianCloud, owner: I32, rows: torch.Tensor) -> NDArray[np.int32]:
    return owner[_taken(cloud.group, rows) + 1].astype("<i4")


def _taken(column: torch.Tensor, rows: torch.Tensor) -> NDArray[np.float32]:
    return column.index_select(0, rows).cpu().numpy()


def _structured(values: NDArray[np.float32], kind: str) -> NDArray[np.void]:
    """Rows `[M, C]` as `[M]`, each the bytes of its numbers."""
    made = np.ascontiguousarray(values.astype(kind))
    return made.view(f"V{made.itemsize * made.shape[1]}").reshape(-1)


_ENCODERS = {"position": _position, "shape": _shape, "color": _color, "harmonics": _harmonics, "group": _group}
