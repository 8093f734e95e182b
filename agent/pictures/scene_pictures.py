"""Pictures of a scene for the user: plain, with the selection highlighted, or with numbered candidates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.language.query.selection import Candidate, Selection
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ..session.result import Result

Picture = NDArray[np.uint8]  # [H, W, 3], display space

_MARK = np.array([255, 196, 0], dtype=np.uint8)


def picture(scene: Scene, camera: Camera) -> Picture:
    """The scene as the camera sees it."""
    return render(scene.cloud, camera).to_uint8()


def spotlight(scene: Scene, camera: Camera, selection: Selection) -> Picture:
    """The scene with the selection outlined and everything else dimmed."""
    chosen = scene.cloud.replace(group=selection.mask(scene.cloud).int())
    drawn = render(chosen, camera)
    lit: NDArray[np.bool_] = (drawn.group == 1).cpu().numpy()
    image = drawn.to_uint8()
    shown: Picture = np.where(lit[..., None], image, image // 3 + 20).astype(np.uint8)
    shown[_edge(lit)] = _MARK
    return shown


def after(result: Result, camera: Camera) -> Picture:
    """The scene after an instruction; if only the selection changed, it is highlighted."""
    if result.scene is result.before and result.selection is not None:
        return spotlight(result.scene, camera, result.selection)
    return picture(result.scene, camera)


def numbered(scene: Scene, camera: Camera, candidates: Sequence[Candidate]) -> Picture:
    """The scene with a number at each candidate that lies in front of the camera."""
    from PIL import Image, ImageDraw, ImageFont

    image = Image.fromarray(picture(scene, camera))
    draw = ImageDraw.Draw(image)
    pixels, depth = camera.project(np.array([c.center for c in candidates], dtype=np.float64).reshape(-1, 3))
    radius = max(11, camera.height // 28)
    font = ImageFont.load_default(round(radius * 1.3))
    for number, ((x, y), z) in enumerate(zip(pixels, depth, strict=True), start=1):
        if z <= 0:
            continue
        x, y = (float(np.clip(v, radius, side - radius)) for v, side in ((x, camera.width), (y, camera.height)))
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=tuple(_MARK.tolist()), outline=(30, 30, 34))
        draw.text((x, y), str(number), fill=(30, 30, 34), font=font, anchor="mm")
    return np.asarray(image)


def _edge(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The two-pixel border just outside a mask."""
    grown = mask.copy()
    for _ in range(2):
        padded = np.pad(grown, 1)
        grown = padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:] | grown
    return grown & ~mask
