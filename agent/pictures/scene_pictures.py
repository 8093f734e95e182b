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
from .unfilled import OUTLINE, with_unfilled

Picture = NDArray[np.uint8]  # [H, W, 3], display space

_SMALL = 96  # side of the picture in which it is looked for, pixels
MARK = np.array(OUTLINE, dtype=np.uint8)


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
    shown[edge(lit)] = MARK
    return shown


def camera_showing(scene: Scene, selection: Selection, viewer: Camera) -> Camera:
    """The viewer's camera if it shows the selection, else one from which its groups are seen."""
    drawn = render(scene.cloud.replace(group=selection.mask(scene.cloud).int()), viewer.resized(_SMALL, _SMALL))
    if bool((drawn.group == 1).any()) or not selection.groups or scene.language is None:
        return viewer
    from ...gaussians.viewpoints.for_groups import Sights, choose

    chosen = choose(Sights.of(scene), selection.groups, 1, (viewer.width, viewer.height))
    return chosen[0].view.camera if chosen else viewer


def after(result: Result, camera: Camera) -> Picture:
    """The scene after an instruction, places that it left open outlined; if only the selection changed, it is
    highlighted."""
    if result.scene is result.before and result.selection is not None:
        return spotlight(result.scene, camera, result.selection)
    return with_unfilled(picture(result.scene, camera), camera, [f for r in result.receipts for f in r.filled])


def numbered(scene: Scene, camera: Camera, candidates: Sequence[Candidate]) -> Picture:
    """The scene with a number at each candidate that the camera sees; candidates without a group in it, as what an
    earlier step of a failed plan made, at their centre."""
    from .marked_views import draw_view
    from .marks import draw_marks, numbered_marks

    if scene.language is None or any(not 0 <= c.group < len(scene.language.groups) for c in candidates):
        return _numbered_at_centres(scene, camera, candidates)
    drawing = draw_view(scene, camera, [c.group for c in candidates])
    return draw_marks(drawing.image, drawing.labels, numbered_marks(len(candidates)), outlines=False)[0]


def _numbered_at_centres(scene: Scene, camera: Camera, candidates: Sequence[Candidate]) -> Picture:
    """The scene with a number at the centre of each candidate that lies in front of the camera."""
    from .marks import Placed, draw_placed, half_size, numbered_marks

    marks = numbered_marks(len(candidates))
    pixels, depth = camera.project(np.array([c.center for c in candidates], dtype=np.float64).reshape(-1, 3))
    placed = []
    for i in np.flatnonzero(depth > 0):
        half = half_size(marks[i].text, camera.height)
        x, y = (
            float(np.clip(v, h, side - h))
            for v, h, side in zip(pixels[i], half, (camera.width, camera.height), strict=True)
        )
        placed.append(Placed(int(i), (x, y), (x, y), half))
    return draw_placed(picture(scene, camera), marks, placed)


def edge(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The two-pixel border just outside a mask."""
    grown = mask.copy()
    for _ in range(2):
        padded = np.pad(grown, 1)
        grown = padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:] | grown
    return grown & ~mask
