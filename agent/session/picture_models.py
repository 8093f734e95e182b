"""The models and photographs of a session that work on pictures: they fill holes, and paint what is restyled."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.errors import FileError
from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ...gaussians.files.captures.capture import Capture
    from ...tools.lifting.behind import Photographs
    from ...tools.lifting.inpainters import Inpainter
    from ...tools.lifting.restylers import Restyler

SCENE, NONE = "scene", "none"  # what `--infill` takes besides the name of a model


def photographed(scene: Scene, capture: str | Path | Capture | None) -> tuple[Scene, Photographs | None]:
    """A scene, with the cameras of its photographs if it has none, and the photographs; None without a capture.

    Raises:
        FileError: the capture cannot be read, or none of its photographs is there.
    """
    if capture is None:
        return scene, None
    from ...gaussians.files.captures.capture import read_capture
    from ...gaussians.viewpoints.pictures import present
    from ...tools.lifting.behind import Photographs

    taken = read_capture(Path(capture)) if isinstance(capture, str | Path) else capture
    if not present(taken):
        raise FileError(
            f"none of the {len(taken.photos)} photographs of {taken.path} is there, such as {taken.photos[0]}; restore "
            "them, or leave --capture out"
        )
    if not scene.cameras:
        scene = scene.replace(cameras=taken.cameras)
    return scene, Photographs(taken, scene.cloud)


def infill_of(infill: bool | str | Inpainter) -> tuple[bool, Inpainter | None]:
    """Whether holes are filled, and the model that inpaints them too, if any.

    Raises:
        BackendError: there is no such model, or its files or packages are missing.
    """
    if isinstance(infill, bool) or infill in (SCENE, NONE):
        return infill not in (False, NONE), None
    from ...tools.lifting.inpainters import load

    return True, load(infill) if isinstance(infill, str) else infill


def restyler_of(restyle: str | Restyler | None) -> Restyler | None:
    """The model that paints views of what is restyled, if any.

    Raises:
        BackendError: there is no such model, or its files or packages are missing.
    """
    if not isinstance(restyle, str):
        return restyle
    from ...tools.lifting.restylers import load

    return load(restyle)
