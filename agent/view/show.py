"""A scene in a notebook: the page of `scenewright export` in a frame of the output cell."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...gaussians.camera import Camera
from ...gaussians.errors import UserError
from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ..session.result import Result

HEIGHT = 480  # CSS pixels


@dataclass(frozen=True)
class Shown:
    """What `show` returns; a notebook displays it.

    Attributes:
        page: the whole page, HTML.
        height: of its frame, CSS pixels; it is as wide as the cell.
    """

    page: str
    height: int

    def _repr_html_(self) -> str:
        frame = "width:100%;border:0;border-radius:6px"
        return f'<iframe srcdoc="{html.escape(self.page)}" height="{self.height}" style="{frame}"></iframe>'


def picture(scene: Scene) -> bytes | None:
    """A scene as the bytes of a PNG file, from its first camera or a view chosen from it; None if it is empty."""
    from ...gaussians.render import render
    from ..pictures.image_files import encoded_png
    from ..pictures.named_cameras import default_view

    return encoded_png(render(scene.cloud, default_view(scene)).to_uint8()) if len(scene.cloud) else None


def show(scene: Scene | Result, view: Camera | None = None, *, title: str = "", height: int = HEIGHT) -> Shown:
    """A scene, or the scene of a result, to look around in, in a notebook.

    The cell holds the renderer and the scene: it needs no server and no network, and shows the scene when the notebook
    is opened again. `scenewright.agent.view.standalone.page` writes the same page for a file.

    Args:
        view: where it is seen from first; by default the result's viewer, the scene's first camera, or a view chosen
            from the scene.
        title: what the page is called; by default the name of the scene's file.
        height: of the frame, CSS pixels.

    Raises:
        UserError: the scene has no Gaussians, or the height is not positive.
    """
    from ..pictures.named_cameras import default_view
    from .standalone import page

    if height <= 0:
        raise UserError(f"the height of the frame must be positive, got {height}")
    shown = scene if isinstance(scene, Scene) else scene.scene
    if not len(shown.cloud):
        raise UserError("the scene has no Gaussians; there is nothing to show")
    if view is None:
        view = default_view(scene) if isinstance(scene, Scene) else scene.viewer
    name = title or (shown.path.name if shown.path is not None else "scene")
    return Shown(page(shown, view, name).decode(), height)
