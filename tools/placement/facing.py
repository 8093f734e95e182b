"""Which way bodies face and how they must turn to face something else.

Knows the walls and objects of a scene. Refuses to guess silently: where neither shape nor wall tells, the box's own
front (-y) is taken and a note says so.
"""

from __future__ import annotations

import math

import numpy as np

from ...gaussians.errors import InstructionError
from ...gaussians.scene import Scene
from ...gaussians.world.facing import facing_in
from .bodies import Array, Body


def front_of(scene: Scene, body: Body) -> Array | None:
    """`[3]` level unit vector out of a body's front, None where neither its shape nor a wall tells."""
    field = scene.language
    if field is None or body.group < 0:
        return None
    rows = body.rows.cpu().numpy()
    if body.riders:  # what stands on it says nothing about its back
        riders = [leaf for g in body.riders for leaf in field.leaves(g)]
        rows = rows[~np.isin(scene.cloud.group.cpu().numpy()[rows], riders)]
    return facing_in(field, scene.cloud, rows, field.groups[body.group]).front


def turn_to_face(scene: Scene, body: Body, goal: Array) -> tuple[float, tuple[str, ...]]:
    """Degrees about up by which a body must turn so that its front points at `goal` `[3]`, and notes.

    Raises:
        InstructionError: the goal is right above or below it.
    """
    up = scene.frame.up_vector
    way = goal - body.center
    way = way - up * (way @ up)
    if float(np.linalg.norm(way)) < 1e-3 * max(body.box.size):
        raise InstructionError(f"the {body.label or 'thing'} stands where it should turn to: name something else")
    front = front_of(scene, body)
    notes: tuple[str, ...] = ()
    if front is None:
        front = -np.array(body.box.axes[1])
        notes = (f"which way the {body.label or 'thing'} faces cannot be told; the front of its box was turned there",)
    return angle_between(front, way, up), notes


def angle_between(start: Array, end: Array, up: Array) -> float:
    """Degrees counter-clockwise about `up` from one level vector `[3]` to another, in (-180, 180]."""
    return math.degrees(math.atan2(float(np.cross(start, end) @ up), float(start @ end)))
