"""How much an edit changes of what is seen: a picture of it, and numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.color import ciede2000, rgb_to_lab
from ...gaussians.render import render
from ..session.result import Result
from .image_files import beside
from .scene_pictures import MARK, Picture, edge
from .unfilled import with_unfilled

_SEEN = 2.3  # CIEDE2000 from which two colours side by side are told apart


@dataclass(frozen=True, eq=False)
class Change:
    """What an edit changes.

    Attributes:
        picture: before, after and `marked`, side by side.
        marked: after, with what changed outlined and the rest dimmed.
        gaussians: how many are changed, added or removed.
        of: how many Gaussians the scene had.
        share: of the picture's pixels that look different.
        difference: mean CIEDE2000 of these pixels, 0 if there are none.
    """

    picture: Picture
    marked: Picture
    gaussians: int
    of: int
    share: float
    difference: float

    def sentence(self) -> str:
        """ "5,199 of 218,885 Gaussians (2.4 %); 3.1 % of the picture looks different, by 12 ΔE on average"."""
        counted = f"{self.gaussians:,} of {self.of:,} Gaussians ({self.gaussians / max(self.of, 1):.1%})"
        if not self.share:
            return f"{counted}; nothing of the picture looks different from here"
        return f"{counted}; {self.share:.1%} of the picture looks different, by {self.difference:.0f} ΔE on average"

    def to_json(self) -> dict[str, Any]:
        """The numbers."""
        return {
            "gaussians": self.gaussians,
            "of": self.of,
            "share_of_picture": round(self.share, 5),
            "mean_delta_e": round(self.difference, 2),
        }


def change_of(result: Result, camera: Camera) -> Change:
    """What an edit changes as a camera sees it, of a dry run too."""
    drawn = [render(scene.cloud, camera) for scene in (result.before, result.scene)]
    was, now = (rgb_to_lab(r.rgb.clamp(0, 1).to(torch.float64)) for r in drawn)
    apart = ciede2000(was, now).cpu().numpy()
    seen: NDArray[np.bool_] = apart >= _SEEN
    before, after = (r.to_uint8() for r in drawn)
    after = with_unfilled(after, camera, [f for r in result.receipts for f in r.filled])
    marked: Picture = np.where(seen[..., None], after, after // 3 + 20).astype(np.uint8)
    marked[edge(seen)] = MARK
    count = sum(r.changed + r.added + r.removed for r in result.receipts)
    difference = float(apart[seen].mean()) if seen.any() else 0.0
    return Change(
        beside([before, after, marked]), marked, count, len(result.before.cloud), float(seen.mean()), difference
    )
