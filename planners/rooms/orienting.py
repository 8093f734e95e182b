"""Which side of a thing is its front, so that a graph's yaw says which way the thing faces.

Knows a scene's language field. Refuses to turn what faces nowhere: its box keeps the axes it was embedded with.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...gaussians.language.field.group_index import members_of
from ...gaussians.language.field.language_field import Group
from ...gaussians.scene import Scene
from ...gaussians.world.facing import facing_of


class Orienter:
    """The fronts of one embedded scene."""

    def __init__(self, scene: Scene) -> None:
        assert scene.language is not None
        self.cloud, self.field = scene.cloud, scene.language
        self.members = members_of(scene.cloud)
        self.walls = [g for g in self.field.groups if g.level == "structure" and g.label == "wall" and g.count]

    def sides(self, group: Group) -> tuple[NDArray[np.float64], float, float]:
        """`[3]` the way a thing's width runs, world frame, its front being to the right of that, and width and depth.

        Seen from above with the width running to the right, the front is below: the -y side of a graph's box.
        """
        first, second, up = (np.array(a) for a in group.box.axes)
        across, along, _ = group.box.size
        rows = self.members.rows(self.field.leaves(group.id))
        front = facing_of(self.cloud, rows, group, self.walls, self.field.typical_size).front
        if front is None:
            return first, across, along
        width = np.cross(up, front)
        turned = abs(float(width @ first)) < abs(float(width @ second))
        return width, *((along, across) if turned else (across, along))
