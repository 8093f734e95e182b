"""Draws a scene from above as a plan: numbered marks, a metre grid, a scale bar and the viewer's position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ...gaussians.camera import Camera
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.for_groups import Sights
from ...gaussians.viewpoints.view_candidates import View, plan
from .marked_views import Drawing, draw_view
from .marks import INK, PAPER, Mark, Picture, draw_marks

STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)  # spacing of the grid, in the scene's unit of length
LINES = 12  # most lines of the grid along the longer side
FAINT = 0.22  # opacity of grid lines
VIEWER = (30, 90, 220)


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan of a scene.

    Attributes:
        image: `[H, W, 3]` uint8.
        view: its camera and what it leaves out.
        numbers: indices of the marks that are drawn.
        shares: share of the image that each asked group covers.
        step: spacing of the grid, metres, or scene units where the scale is unknown.
    """

    image: Picture
    view: View
    numbers: tuple[int, ...]
    shares: tuple[float, ...]
    step: float


def draw_plan(
    sights: Sights,
    groups: Sequence[int],
    marks: Sequence[Mark],
    size: tuple[int, int],
    viewer: Camera | None = None,
    *,
    outlines: bool = True,
) -> Plan:
    """The plan with `marks[i]` on `groups[i]`, north (the frame's second axis) up."""
    scene = sights.scene
    view = plan(scene, groups, size, sights.space)
    drawing = draw_view(scene, view.camera, groups, view.cut)
    gridded, step = with_grid(scene, sights, drawing)
    image, placed = draw_marks(gridded, drawing.labels, marks, outlines=outlines)
    if viewer is not None:
        image = with_viewer(image, view.camera, viewer, sights)
    image = with_scale_bar(image, view.camera, sights, step)
    return Plan(image, view, tuple(sorted(p.index for p in placed)), drawing.shares(len(groups)), step)


def with_grid(scene: Scene, sights: Sights, drawing: Drawing) -> tuple[Picture, float]:
    """The drawing with faint lines on the floor, and their spacing in metres or scene units."""
    scale = scene.frame.metres_per_unit or 1.0
    low, high = sights.space.low * scale, sights.space.high * scale
    step = next((s for s in STEPS if (high - low)[:2].max() / s <= LINES), STEPS[-1])
    layer = Image.fromarray(np.ascontiguousarray(drawing.image))
    draw = ImageDraw.Draw(layer)
    for axis in (0, 1):
        for k in range(int(np.ceil(low[axis] / step)), int(np.floor(high[axis] / step)) + 1):
            ends = np.array([[low[0], low[1], 0.0], [high[0], high[1], 0.0]])
            ends[:, axis] = k * step
            ends = ends / scale
            ends[:, 2] = sights.space.floor
            (a, b), _ = drawing.camera.project(ends @ scene.frame.basis())
            draw.line((*a, *b), fill=INK, width=1)
    lined = np.asarray(layer).astype(np.float64)
    return (FAINT * lined + (1 - FAINT) * drawing.image + 0.5).astype(np.uint8), step


def with_scale_bar(image: Picture, camera: Camera, sights: Sights, length: float) -> Picture:
    """The picture with a bar of `length` (metres, or scene units) at the bottom left, measured on the floor."""
    frame = sights.scene.frame
    unit = "m" if frame.metres_per_unit else "units"
    pixels = length / (frame.metres_per_unit or 1.0) * _pixels_per_unit(camera, sights)
    height, width = image.shape[:2]
    while pixels < width / 12:
        length, pixels = 2 * length, 2 * pixels
    canvas = Image.fromarray(np.ascontiguousarray(image))
    draw = ImageDraw.Draw(canvas)
    size = max(11, height // 40)
    x, y = size, height - size
    draw.rectangle((x - 6, y - 2 * size, x + pixels + 6, y + 8), fill=PAPER, outline=INK)
    draw.line((x, y, x + pixels, y), fill=INK, width=3)
    for end in (x, x + pixels):
        draw.line((end, y - 4, end, y + 4), fill=INK, width=2)
    draw.text((x, y - 6), f"{length:g} {unit}", fill=INK, font=ImageFont.load_default(size), anchor="ls")
    return np.asarray(canvas)


def with_viewer(image: Picture, camera: Camera, viewer: Camera, sights: Sights) -> Picture:
    """The picture with the viewer's position as a dot and an arrow the way they look; at the border if outside."""
    frame = sights.scene.frame
    up = frame.up_vector
    eye = viewer.position
    level = viewer.forward - up * (viewer.forward @ up)
    if np.linalg.norm(level) < 0.05:  # looks straight down or up
        return image
    ground = eye + up * (sights.space.floor - eye @ up)
    reach = 0.25 * float(np.linalg.norm((sights.space.high - sights.space.low)[:2]))
    (at, ahead), _ = camera.project(np.stack([ground, ground + reach * level / np.linalg.norm(level)]))
    way = (ahead - at) / max(float(np.linalg.norm(ahead - at)), 1e-9)
    height, width = image.shape[:2]
    edge = max(14.0, height / 36)
    at = np.clip(at, edge, [width - edge, height - edge])
    canvas = Image.fromarray(np.ascontiguousarray(image))
    _arrow(ImageDraw.Draw(canvas), at, way, edge)
    return np.asarray(canvas)


def _arrow(draw: ImageDraw.ImageDraw, at: NDArray[np.float64], way: NDArray[np.float64], size: float) -> None:
    """A dot with an arrow head: an eye and the way it looks."""
    side = np.array([-way[1], way[0]])
    tip = at + 1.6 * size * way
    base = at + 0.5 * size * way
    head = [tuple(tip), tuple(base + 0.55 * size * side), tuple(base - 0.55 * size * side)]
    draw.polygon(head, fill=VIEWER, outline=PAPER)
    r = 0.5 * size
    draw.ellipse((at[0] - r, at[1] - r, at[0] + r, at[1] + r), fill=VIEWER, outline=PAPER, width=2)


def _pixels_per_unit(camera: Camera, sights: Sights) -> float:
    """Pixels of one scene unit on the floor, in a view from above."""
    up = sights.scene.frame.up_vector
    depth = float(camera.position @ up) - sights.space.floor
    return camera.fx / max(depth, 1e-9)
