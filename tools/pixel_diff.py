"""Count the pixels that an edit changed in the viewer's picture, inside and outside the target's silhouette."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from .receipt import Check, Pixels, at_most

CHANGED = 2 / 255  # a difference that an 8-bit picture shows beyond rounding
VISIBLE_ALPHA = 1e-3  # a target of this alpha changes a pixel by less than `CHANGED`
_MARGIN = 2  # pixels; antialiasing reaches that far beyond an edge
_MAX_OUTSIDE = 1e-3  # share of the picture that may change outside: rounding reorders Gaussians of equal depth


@dataclass(frozen=True, eq=False)
class TargetedCloud:
    """A cloud and which of its rows are the target."""

    cloud: GaussianCloud
    target: Tensor


def compare(before: TargetedCloud, after: TargetedCloud, viewer: Camera, width: int, backend: str) -> Pixels:
    """Render both clouds from the viewer, `width` pixels wide, and count the pixels that changed, in all and outside.

    "Outside" means outside the target's dilated silhouettes before and after.
    """
    from ..gaussians.render import render

    camera = viewer.resized(width, max(1, round(viewer.height * width / viewer.width)))
    old, new = (render(stage.cloud, camera, backend=backend).rgb for stage in (before, after))
    covered = torch.zeros(camera.height, camera.width, dtype=torch.bool)
    for stage in (before, after):
        if bool(stage.target.any()):
            covered |= render(stage.cloud[stage.target], camera, backend=backend).alpha.cpu() > VISIBLE_ALPHA
    covered = _dilated(covered, _MARGIN)
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
    """The check that bounds the number of changed pixels outside the target's silhouettes."""
    bound = int(_MAX_OUTSIDE * pixels.width * pixels.height)
    said = f"{pixels.changed_outside} of {pixels.changed} changed pixels lie outside the target's silhouette"
    return at_most("pixels outside", pixels.changed_outside, bound, "px", said)


def _dilated(mask: Tensor, by: int) -> Tensor:
    return torch.nn.functional.max_pool2d(mask[None, None].float(), 2 * by + 1, stride=1, padding=by)[0, 0] > 0
