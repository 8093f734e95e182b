"""Renders a view of a scene together with which group each of its pixels shows, for marks and outlines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...gaussians.camera import Camera
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.cutaway import NOTHING, Cut
from ...gaussians.viewpoints.visibility import label_table, visible_labels
from .marks import Labels, Picture

BACKGROUND = (0.93, 0.93, 0.92)  # display space, where a cut or a capture's border leaves nothing


@dataclass(frozen=True, eq=False)
class Drawing:
    """A rendered view and what each of its pixels shows.

    Attributes:
        image: `[H, W, 3]` uint8.
        labels: `[H, W]` int32, position in the groups asked for, -1 for others.
        camera: of the view.
    """

    image: Picture
    labels: Labels
    camera: Camera

    def shares(self, count: int) -> tuple[float, ...]:
        """Share of the image that each of `count` groups covers."""
        pixels = np.bincount(self.labels[self.labels >= 0], minlength=count)[:count]
        return tuple((pixels / self.labels.size).tolist())


def draw_view(scene: Scene, camera: Camera, groups: Sequence[int], cut: Cut = NOTHING) -> Drawing:
    """Render a view once: its colours, and which of `groups` each pixel shows.

    A Gaussian whose part and object are both among the groups counts for the part.
    """
    assert scene.language is not None
    drawn = render(cut.apply(scene), camera, BACKGROUND if cut else (0.0, 0.0, 0.0))
    boxes = [scene.language.groups[g].box for g in groups]
    labels = visible_labels(drawn, camera, label_table(scene.language, groups), boxes)
    return Drawing(drawn.to_uint8(), labels, camera)
