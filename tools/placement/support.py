"""What is right under a thing: the floor, or the top of something else, as measured on points.

Knows points and heights. Refuses to know labels: what hangs on a wall is what nothing is found under.
"""

from __future__ import annotations

import numpy as np

from ...gaussians.language.field.measure import solid_points
from ...gaussians.scene import Scene
from ..operation import Context
from .bodies import Body, centimetre, contact_box, mask_of_bodies
from .occupancy import obstacle_points
from .surroundings import Surroundings

_FEW = 8  # points under a thing; fewer are floaters
_SHARE = 0.03  # of its height that a thing may be off its support: splats reach about that far beyond their centres


def support_height(scene: Scene, body: Body, context: Context) -> float | None:
    """Height along up of what a body stands on, scene units; None where nothing is within two centimetres below it."""
    up = scene.frame.up_vector
    box = contact_box(solid_points(scene.cloud, body.rows), scene.frame, body.box.axes)
    bottom = float(np.array(box.center) @ up) - box.size[2] / 2
    slack = max(2 * centimetre(scene.frame, max(box.size)), _SHARE * box.size[2])
    floor = Surroundings(scene, context).floor
    if abs(bottom - floor) <= slack:
        return floor
    others = obstacle_points(scene.cloud, mask_of_bodies(scene, [body]))
    local = np.abs(box.local(others)[:, :2])
    under = (local <= np.array(box.size[:2]) / 2).all(axis=1)
    heights = others[under] @ up.astype(np.float32)
    near = heights[np.abs(heights - bottom) <= slack]
    return float(np.median(near)) if len(near) >= _FEW else None
