"""What an edit changed in the viewer's picture, inside and outside the target's silhouette.

Knows pictures and masks. Refuses to know what was edited and why.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from .receipt import Check, Pixels, at_most

CHANGED = 2 / 255  # a difference that an 8-bit picture shows beyond rounding
SEEN = 1e-3  # a target this faint still tints a pixel by less than `CHANGED`
_GROW = 2  # pixels; antialiasing reaches that far beyond an edge
_OUTSIDE = 1e-3  # share of the picture that may change outside: blending order of equals at rounding


@dataclass(frozen=True, eq=False)
class Stage:
    """A cloud and which of its rows are the target."""

    cloud: GaussianCloud
    target: Tensor


def compare(before: Stage, after: Stage, viewer: Camera, width: int, backend: str) -> Pixels:
    """Render both from the viewer, `width` pixels wide, and count changed pixels in and out of the silhouettes."""
    from ..gaussians.render import render

    camera = viewer.resized(width, max(1, round(viewer.height * width / viewer.width)))
    old, new = (render(stage.cloud, camera, backend=backend).rgb for stage in (before, after))
    covered = torch.zeros(camera.height, camera.width, dtype=torch.bool)
    for stage in (before, after):
        if bool(stage.target.any()):
            covered |= render(stage.cloud[stage.target], camera, backend=backend).alpha.cpu() > SEEN
    covered = _grown(covered, _GROW)
    changed = ((old - new).abs().amax(dim=-1) > CHANGED).cpu()
    return Pixels(
        width=camera.width,
        height=camera.height,
        changed=int(changed.sum()),
        changed_outside=int((changed & ~covered).sum()),
        silhouette=int(covered.sum()),
        threshold=CHANGED,
    )


def check(pixels: Pixels) -> Check:
    """Pixels that changed though the target never covered them."""
    bound = int(_OUTSIDE * pixels.width * pixels.height)
    said = f"{pixels.changed_outside} of {pixels.changed} changed pixels lie outside the target's silhouette"
    return at_most("pixels outside", pixels.changed_outside, bound, "px", said)


def _grown(mask: Tensor, by: int) -> Tensor:
    grown = torch.nn.functional.max_pool2d(mask[None, None].float(), 2 * by + 1, stride=1, padding=by)
    return grown[0, 0] > 0
