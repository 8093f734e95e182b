"""How much of each group a camera sees: counted in small rendered group images, and bounded by projected boxes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera, Render
from ..language.field.language_field import LanguageField
from ..render import render
from ..scene import Scene
from ..world.box import Box
from .coverage import sample
from .cutaway import Cut

F64 = NDArray[np.float64]

SIZE = 128  # pixels of the longer side of the images in which pixels are counted
NEAR = 1e-3  # of the distance between eye and box: corners nearer than this to the eye's plane count as behind it
IN_FRONT = 0.03  # of a box's nearest depth: pixels nearer than this before it show what stands before it
DRAWN = 0.5  # alpha from which a pixel shows anything
# Corners of each face of a box in `Box.corners` order, counter-clockwise seen from outside.
_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


class GroupPixels:
    """Counts the visible pixels of some groups of a scene in small renders.

    Args:
        scene: with its language field.
        groups: ids of the groups; the index of a group in this sequence is its label in the images. A Gaussian whose
            part and object are both listed counts for the one that comes first.
    """

    def __init__(self, scene: Scene, groups: Sequence[int]) -> None:
        assert scene.language is not None
        self.rows, cloud = sample(scene.cloud)
        self._scene = scene.replace(cloud=cloud.replace(sh=cloud.sh[:, :1].contiguous()))
        self._table = label_table(scene.language, groups)
        self._count = len(groups)
        self._boxes = [scene.language.groups[g].box for g in groups]

    def shares(self, camera: Camera, cut: Cut | None = None) -> F64:
        """Share of the image `[G]` that each group covers after occlusion; `cut` is left out."""
        small = shrunk(camera, SIZE)
        cloud = cut.apply(self._scene) if cut is not None else self._scene.cloud
        labels = visible_labels(render(cloud, small), small, self._table, self._boxes)
        counted = np.bincount(labels[labels >= 0], minlength=self._count)
        return counted / labels.size


def label_table(field: LanguageField, groups: Sequence[int]) -> NDArray[np.int32]:
    """`[L + 1]` position in `groups` of each leaf id plus one, -1 for the others (and for -1, no group).

    A leaf whose object is among the groups too counts for itself; of two equal ones the first counts.
    """
    table = np.full(len(field.groups) + 1, -1, np.int32)
    for i in sorted(reversed(range(len(groups))), key=lambda i: field.groups[groups[i]].level == "part"):
        table[np.array(field.leaves(groups[i])) + 1] = i
    return table


def visible_labels(drawn: Render, camera: Camera, table: NDArray[np.int32], boxes: Sequence[Box]) -> NDArray[np.int32]:
    """Which group each pixel shows, `[H, W]`: a position of a `label_table`, -1 for others and where little is drawn.

    A wall of many faint Gaussians has less weight each than the opaque thing behind it, which would count as seen.
    Such pixels lie nearer than the thing's box and are left out.

    Args:
        boxes: of the groups, in the order of the table.
    """
    leaves = drawn.group.cpu().numpy()
    labels: NDArray[np.int32] = table[np.where(leaves + 1 < len(table), leaves + 1, 0)]
    if not boxes:
        return labels
    corners = np.stack([box.corners() for box in boxes]).reshape(-1, 3)
    nearest = camera.project(corners)[1].reshape(-1, 8).min(axis=1)
    before = drawn.depth.cpu().numpy() < (1 - IN_FRONT) * nearest[labels]
    hidden = before | (drawn.alpha.cpu().numpy() < DRAWN)
    return np.where(hidden, np.int32(-1), labels)


def shrunk(camera: Camera, size: int) -> Camera:
    """The same view with a longer side of at most `size` pixels."""
    gain = min(1.0, size / max(camera.width, camera.height))
    return camera.resized(max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))


def silhouettes(camera: Camera, boxes: Sequence[Box]) -> tuple[F64, F64]:
    """Bounds from boxes alone, each `[B]` as shares of the image's area.

    Returns:
        whole: area of the box's silhouette, also outside the image; infinite if a part of it is behind the eye.
        within: upper bound of the part of it within the image.
    """
    corners = np.stack([box.corners() for box in boxes]) if boxes else np.zeros((0, 8, 3))
    pixels, depth = camera.project(corners.reshape(-1, 3))
    pixels, depth = pixels.reshape(-1, 8, 2), depth.reshape(-1, 8)
    reach = np.linalg.norm(corners.mean(axis=1) - camera.position, axis=1) if boxes else np.zeros(0)
    ahead = depth > NEAR * reach[:, None]
    area = float(camera.width * camera.height)
    faces = pixels[:, _FACES]  # [B, 6, 4, 2]
    following = np.roll(faces, -1, axis=2)
    signed = (faces[..., 0] * following[..., 1] - faces[..., 1] * following[..., 0]).sum(axis=2) / 2  # [B, 6]
    # Of a convex body seen from outside, the faces toward the eye tile the silhouette; the others have the other sign.
    whole = np.maximum(np.maximum(signed, 0).sum(axis=1), np.maximum(-signed, 0).sum(axis=1)) / area
    low, high = np.clip(pixels.min(axis=1), 0, None), np.minimum(pixels.max(axis=1), [camera.width, camera.height])
    frame = np.maximum(high - low, 0).prod(axis=1) / area
    whole = np.where(ahead.all(axis=1), whole, np.inf)
    within = np.where(ahead.all(axis=1), np.minimum(whole, frame), np.where(ahead.any(axis=1), 1.0, 0.0))
    return whole, within
