"""How a part opens: about which hinge or along which slide, found from its shape, its handle and what it touches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import solid_points
from ...gaussians.rows import rows_where
from ...gaussians.scene import Scene
from ...gaussians.world.words import head, singular
from ..placement.bodies import Body, centimetre, front_of

F64 = NDArray[np.float64]
How = Literal["door", "drawer", "lid"]

# By the last word of its name; what is not listed opens as its shape tells.
_NAMED: dict[str, How] = {
    **dict.fromkeys(("door", "gate", "shutter", "window", "casement", "hatch"), "door"),
    **dict.fromkeys(("drawer", "tray"), "drawer"),
    **dict.fromkeys(("lid", "cover", "flap", "trapdoor"), "lid"),
}
_THIN = 0.3  # of its width: a door or a lid is not thicker
_OUT = 0.7  # of its depth: how far a drawer comes out
_WIDE_OPEN = {"door": math.radians(80), "lid": math.radians(75)}
_HANDLE = 1.2  # centimetres by which a handle stands out of a leaf
_ASIDE = 0.2  # of a leaf's width from its middle, at least, is a handle that tells where it hangs
_WITHIN, _HALFWAY = 0.43, 0.22  # of a leaf's width and height from its middle: where a handle is and no frame
_FEW, _COMPACT = 4, 0.2  # points of a handle at least, and how far across they may lie, of the leaf's width
_NEAR = 4.0  # centimetres: what is nearer to an edge holds it
_CLEARLY = 1.6  # times as many points at one edge as at the other tell on which side a leaf hangs
_SAMPLE = 20_000


@dataclass(frozen=True, eq=False)
class Opening:
    """How something opens.

    Attributes:
        how: a door swings about an upright hinge, a lid about a level one, a drawer slides.
        axis: `[3]` unit: of the hinge, so that positive angles open it; or the way out of a drawer.
        pivot: `[3]` a point of the hinge; the middle of a drawer.
        most: radians, or scene units of a drawer, when it is wide open.
        told: what it was found from.
    """

    how: How
    axis: F64
    pivot: F64
    most: float
    told: str


def opening_of(scene: Scene, body: Body, name: str) -> Opening:
    """How a body of a scene opens.

    Args:
        name: what it is called.

    Raises:
        InstructionError: neither its name nor its shape tells.
    """
    up = scene.frame.up_vector
    points = solid_points(scene.cloud, body.rows)
    points = points[:: max(1, len(points) // _SAMPLE)]
    how = opens_as(name, body.box.size)
    if how is None:
        raise InstructionError(
            f"nothing tells how {name or 'it'} opens: it is no flat door or lid, nor a drawer: name its part"
        )
    if how == "drawer":
        way, told = _way_out(scene, body, up)
        return Opening("drawer", way, np.asarray(body.center), _OUT * body.box.extent(way), told)
    if how == "lid":
        return _lid(scene, body, points, up)
    return _door(scene, body, points, up, name)


def opens_as(name: str, size: tuple[float, float, float]) -> How | None:
    """How a thing of this name opens, or else of this shape: an upright leaf like a door, a lying one like a lid.

    Args:
        size: across, deep and high, in any unit.

    Returns:
        None: nothing tells.
    """
    return _NAMED.get(head(name)) or _by_shape(size)


def owner_of_part(name: str) -> str:
    """What the name of a part that opens says of its whole: "refrigerator" of "refrigerator door"; else ""."""
    *whole, part = name.split() or [""]
    return " ".join(whole) if singular(part) in _NAMED else ""


def _by_shape(size: tuple[float, float, float]) -> How | None:
    a, b, h = size
    if min(a, b) < _THIN * max(a, b) and h > 0.5 * max(a, b):
        return "door"
    return "lid" if h < _THIN * min(a, b) else None


def _door(scene: Scene, body: Body, points: F64, up: F64, name: str) -> Opening:
    axes, size = np.array(body.box.axes), np.array(body.box.size)
    thin, wide = (0, 1) if size[0] < size[1] else (1, 0)
    if size[thin] > _THIN * size[wide]:
        raise InstructionError(f"{name} is as deep as wide, and not a leaf that swings: name its door")
    center, cm = np.asarray(body.center), centimetre(scene.frame, float(size.max()))
    across, normal = axes[wide], axes[thin]
    local = points - center
    into = _room_side(scene, center, normal)
    out, side = local @ normal, local @ across
    handle = _handle(local @ into, side / size[wide], local @ up / size[2], _HANDLE * cm)
    if handle is None:
        stands_out = np.abs(out) > np.quantile(np.abs(out), 0.5) + _HANDLE * cm
        found = side[stands_out & (np.abs(side) < 0.49 * size[wide])] / size[wide]
        handle = float(np.median(found)) if len(found) >= 8 else 0.0
    told = ""
    sign = 0.0
    if abs(handle) > _ASIDE:
        sign = -float(np.sign(handle))  # the hinge is on the other side
        told = "its handle is at the other side"
    else:
        held = [_held(scene, body, center + s * across * size[wide] / 2, across, up, size, cm) for s in (-1.0, 1.0)]
        if max(held) > _CLEARLY * min(held) and max(held) > 20:
            sign = 1.0 if held[1] > held[0] else -1.0
            told = "what it touches holds it at that side"
    if not sign:
        raise InstructionError(
            f"nothing tells on which side {name or 'it'} hangs: no handle is seen, and both sides touch alike"
        )
    edge = center + sign * across * size[wide] / 2 - up * size[2] / 2
    pivot = edge + into * size[thin] / 2
    # Positive angles about `axis` take the free edge, which is at -sign * across, towards the room.
    axis = up if float(np.cross(up, -sign * across) @ into) > 0 else -up
    return Opening("door", np.asarray(axis), np.asarray(pivot), _WIDE_OPEN["door"], told)


def _handle(off: F64, side: F64, height: F64, stands: float) -> float | None:
    """Where the handle of a leaf is across, of its width from its middle; None if nothing stands out at one place.

    A frame stands out at the edges and above, a handle within the leaf and about half-way up.

    Args:
        off: of the leaf's points towards the room, scene units.
        side, height: of these across and up, of the size of the leaf from its middle.
        stands: how far a handle stands out of the leaf, scene units.
    """
    within = (np.abs(side) < _WITHIN) & (np.abs(height) < _HALFWAY)
    if within.sum() < 8:
        return None
    found = side[within & (off > np.quantile(off[within], 0.75) + stands)]
    if len(found) < _FEW or float(np.ptp(np.quantile(found, [0.1, 0.9]))) > _COMPACT:
        return None
    return float(np.median(found))


def _held(scene: Scene, body: Body, edge: F64, across: F64, up: F64, size: F64, cm: float) -> int:
    """How many Gaussians of other things are at an upright edge `[3]` of a leaf."""
    means = scene.cloud.means.double().cpu().numpy()
    own = np.zeros(len(means), dtype=bool)
    own[body.rows.cpu().numpy()] = True
    away = means - edge
    height = away @ up
    level = away - np.outer(height, up)
    near = (np.linalg.norm(level, axis=1) < _NEAR * cm) & (np.abs(height) < size[2] / 2)
    return int((near & ~own).sum())


def _lid(scene: Scene, body: Body, points: F64, up: F64) -> Opening:
    front = front_of(scene, body)
    told = "it opens at its front"
    center, size, axes = np.asarray(body.center), np.array(body.box.size), np.array(body.box.axes)
    if front is None:
        middle = scene.language.middle if scene.language is not None else center
        towards = middle - center
        towards = towards - up * (towards @ up)
        candidates = [s * axes[i] for i in (0, 1) for s in (-1, 1)]
        if float(np.linalg.norm(towards)) < 1e-6:
            raise InstructionError("nothing tells where the front of it is, so that it cannot be opened")
        front = max(candidates, key=lambda v: float(v @ towards))
        told = "its front was taken to be the side towards the room"
    depth = float(np.abs(axes[:2] @ front) @ size[:2])
    low = center - up * size[2] / 2
    return Opening(
        "lid", np.asarray(np.cross(up, front) * -1.0), np.asarray(low - front * depth / 2), _WIDE_OPEN["lid"], told
    )


def _way_out(scene: Scene, body: Body, up: F64) -> tuple[F64, str]:
    """`[3]` the level direction in which a drawer comes out."""
    axes, center = np.array(body.box.axes), np.asarray(body.center)
    cm = centimetre(scene.frame, max(body.box.size))
    means = scene.cloud.means.double().cpu().numpy()
    own = np.zeros(len(means), dtype=bool)
    own[body.rows.cpu().numpy()] = True
    local = (means[~own] - center) @ axes.T
    half = np.array(body.box.size) / 2
    free: list[tuple[int, F64]] = []
    for i in (0, 1):
        for s in (-1.0, 1.0):
            ahead = (s * local[:, i] > half[i] - 2 * cm) & (s * local[:, i] < half[i] + max(half[i], 20 * cm))
            other = 1 - i
            inside = (np.abs(local[:, other]) < 0.9 * half[other]) & (np.abs(local[:, 2]) < 0.8 * half[2])
            free.append((int((ahead & inside).sum()), s * axes[i]))
    free.sort(key=lambda f: f[0])
    if free[0][0] == free[1][0]:
        front = front_of(scene, body)
        if front is None:
            raise InstructionError(
                "nothing tells in which direction the drawer comes out: several sides of it are free"
            )
        return np.asarray(front), "it faces that way"
    way = free[0][1]
    return np.asarray(way - up * (way @ up)), "that side of it is free"


def _room_side(scene: Scene, center: F64, normal: F64) -> F64:
    """`[3]` the normal that points to the side where the room is."""
    middle = scene.language.middle if scene.language is not None else np.zeros(3)
    away = float((middle - center) @ normal)
    if abs(away) < 1e-6:
        rows = rows_where(torch.ones(len(scene.cloud), dtype=torch.bool))
        away = float((scene.cloud.means[rows].double().mean(dim=0).cpu().numpy() - center) @ normal)
    return np.asarray(normal if away >= 0 else -normal)
