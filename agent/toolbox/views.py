"""Pictures of a session's scene for replies, at bounded sizes."""

from __future__ import annotations

from dataclasses import replace

from ...gaussians.camera import Camera
from ...gaussians.viewpoints.coverage import fit_camera
from ..session.clarify import Question
from ..session.result import Result
from ..session.session import Session
from .reply import MAX_SIDE

WIDTH = 640  # pixels, of pictures beside a receipt


def sized(camera: Camera, width: int, height: int | None = None) -> Camera:
    """The camera at a width, with its own aspect unless a height is given; no side is larger than `MAX_SIDE`."""
    if height is None:
        height = max(round(camera.height * width / camera.width), 1)
    shrink = min(1.0, MAX_SIDE / max(width, height))
    return fit_camera(camera, max(round(width * shrink), 1), max(round(height * shrink), 1))


def after_edit(result: Result) -> bytes:
    """The scene after an instruction, from the viewer; a bare selection is highlighted."""
    from ..pictures.image_files import encoded_png
    from ..pictures.scene_pictures import after

    return encoded_png(after(result, sized(result.viewer, WIDTH)))


def of_question(session: Session, question: Question) -> bytes:
    """The scene from the viewer with a number at each candidate."""
    from ..pictures.image_files import encoded_png
    from ..pictures.scene_pictures import numbered

    return encoded_png(numbered(session.scene, sized(session.viewer, WIDTH), question.candidates))


def of_camera(session: Session, camera: Camera, width: int, height: int | None) -> tuple[bytes, Camera]:
    """The scene from a camera, and the camera at the size that was drawn."""
    from ..pictures.image_files import encoded_png
    from ..pictures.scene_pictures import picture

    camera = replace(sized(camera, width, height))
    return encoded_png(picture(session.scene, camera)), camera
