"""`ViewMasks`: the masks of one image with their camera, labels, scores and vectors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...errors import UserError

NONE = -1  # a pixel without a mask


@dataclass(frozen=True, eq=False)
class ViewMasks:
    """The masks of one image.

    Attributes:
        camera: camera of the image, at the size of the masks.
        ids: `[H, W]` or, where masks overlap, `[L, H, W]` int32: index of the mask at each pixel, -1 for none. A
            mask may lie in several layers.
        labels: M names, "" for unknown.
        scores: `[M]` float32 in [0, 1], confidence of the name.
        vectors: `[M, D]` float32, unit rows in an encoder's space, a zero row for none; None if no mask has a vector.

    Raises:
        UserError: shapes do not match, ids are out of range, or numbers are not finite.
    """

    camera: Camera
    ids: NDArray[np.int32]
    labels: tuple[str, ...]
    scores: NDArray[np.float32]
    vectors: NDArray[np.float32] | None = None

    def __post_init__(self) -> None:
        if self.ids.ndim not in (2, 3) or not np.issubdtype(self.ids.dtype, np.integer):
            raise UserError(f"mask ids must be integers [H, W] or [L, H, W], got {self.ids.dtype} {self.ids.shape}")
        own, needed = self.ids.shape[-2:], (self.camera.height, self.camera.width)
        if own != needed:
            raise UserError(f"masks of {own[1]}x{own[0]} pixels do not fit a camera of {needed[1]}x{needed[0]}")
        count = len(self.labels)
        if self.ids.size and not NONE <= int(self.ids.min()) <= int(self.ids.max()) < count:
            raise UserError(
                f"mask ids must lie between -1 and {count - 1} for {count} masks, "
                f"got {self.ids.min()} to {self.ids.max()}"
            )
        scores = np.asarray(self.scores, dtype=np.float32)
        if scores.shape != (count,) or not np.isfinite(scores).all():
            raise UserError(f"{count} masks need {count} finite scores, got {scores.shape}")
        object.__setattr__(self, "ids", self.ids.astype(np.int32, copy=False))
        object.__setattr__(self, "scores", scores)
        object.__setattr__(self, "vectors", None if self.vectors is None else _unit(self.vectors, count))

    def __len__(self) -> int:
        return len(self.labels)

    @property
    def layers(self) -> NDArray[np.int32]:
        """The ids as layers `[L, H, W]`."""
        return self.ids if self.ids.ndim == 3 else self.ids[None]

    @cached_property
    def cells(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """The image partitioned by all masks: cell of each pixel `[H, W]` and the masks of each cell `[C, L]`.

        With cells, overlapping masks need one pass over the image instead of one each.
        """
        layers = self.layers
        height, width = layers.shape[1:]
        if not len(layers):
            return np.zeros((height, width), np.int32), np.zeros((1, 0), np.int32)
        flat = layers.reshape(len(layers), -1)
        code = flat[0].astype(np.int64) + 1
        for layer in flat[1:]:  # renumbered after each layer, so that the product cannot overflow
            code = np.unique(code, return_inverse=True)[1] * (len(self) + 1) + layer + 1
        _, first, cell = np.unique(code, return_index=True, return_inverse=True)
        return cell.reshape(height, width).astype(np.int32), flat[:, first].T.copy()

    def areas(self) -> NDArray[np.int64]:
        """Number of pixels of each mask `[M]`."""
        cell, inside = self.cells
        pixels = np.bincount(cell.ravel(), minlength=len(inside))
        total = np.zeros(len(self), np.int64)
        for layer in range(inside.shape[1]):
            held = inside[:, layer] >= 0
            np.add.at(total, inside[held, layer], pixels[held])
        return total


def pack_layers(masks: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Pack overlapping masks `[M, H, W]` into layers `[L, H, W]` of ids by first fit; at least one layer."""
    count, height, width = masks.shape
    layers = [np.full((height, width), NONE, np.int32)]
    for i in range(count):
        free = next((layer for layer in layers if not (layer[masks[i]] >= 0).any()), None)
        if free is None:
            free = np.full((height, width), NONE, np.int32)
            layers.append(free)
        free[masks[i]] = i
    return np.stack(layers)


def _unit(vectors: NDArray[np.floating], count: int) -> NDArray[np.float32]:
    rows = np.asarray(vectors, dtype=np.float32)
    if rows.ndim != 2 or len(rows) != count or not np.isfinite(rows).all():
        raise UserError(f"{count} masks need {count} rows of finite vectors, got {list(rows.shape)}")
    norms = np.linalg.norm(rows, axis=1, keepdims=True)
    units: NDArray[np.float32] = (rows / np.where(norms > 1e-8, norms, 1)).astype(np.float32)
    return units
