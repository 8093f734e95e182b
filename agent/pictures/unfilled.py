"""Outline in a picture the places that an edit revealed and that nothing fills."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...gaussians.camera import Camera

if TYPE_CHECKING:
    from ...tools.receipt import Filled, Vec3

Picture = NDArray[np.uint8]  # [H, W, 3], display space

OUTLINE = (255, 196, 0)  # display space
_DASH = 1 / 60  # of the picture's height
_NEAR = 1e-3  # of the distance to a place: what is nearer to the eye is not drawn


def with_unfilled(picture: Picture, camera: Camera, filled: Iterable[Filled]) -> Picture:
    """The picture with a thin dashed box around each place that an operation left open; itself if there is none.

    Args:
        picture: `[H, W, 3]`, of the scene after the operations as the camera sees it.
        filled: what the operations did to what they revealed.
    """
    places = [f.place for f in filled if f.place is not None]
    lines = [line for place in places for line in _edges(camera, place)]
    if not lines:
        return picture
    from PIL import Image, ImageDraw

    from .marks import INK

    canvas = Image.fromarray(np.ascontiguousarray(picture))
    draw = ImageDraw.Draw(canvas)
    for a, b in (dash for line in lines for dash in _dashes(line, max(4.0, _DASH * picture.shape[0]))):
        draw.line((*a, *b), fill=INK, width=3)
        draw.line((*a, *b), fill=OUTLINE, width=1)
    return np.asarray(canvas)


def _edges(camera: Camera, place: tuple[Vec3, Vec3]) -> list[NDArray[np.float64]]:
    """The edges of a box in pixels, `[2, 2]` each, as far as the picture shows them."""
    from .evidence import segment

    corners = [np.array(c) for c in itertools.product(*zip(*place, strict=True))]
    away = float(np.linalg.norm(np.mean(corners, axis=0) - camera.position))
    pairs = [(a, b) for k, a in enumerate(corners) for b in corners[k + 1 :] if (a != b).sum() == 1]
    seen = [segment(camera, a, b, _NEAR * away) for a, b in pairs]
    return [s for s in seen if s is not None]


def _dashes(line: NDArray[np.float64], length: float) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """The dashes of a line, each as long as the gap behind it."""
    whole = float(np.linalg.norm(line[1] - line[0]))
    way = (line[1] - line[0]) / max(whole, 1e-9)
    found = []
    for start in np.arange(0.0, whole, 2 * length):
        a, b = line[0] + way * start, line[0] + way * min(start + length, whole)
        found.append(((float(a[0]), float(a[1])), (float(b[0]), float(b[1]))))
    return found
