"""Rooms in which a thing changes its shape (`soft_room`): a towel that waves, a plant that bends, a jelly that hops.

Displacements of single Gaussians are the truth here, of rank one or two; the jelly has a path, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets.modeling.materials import Material
from ...gaussians.assets.modeling.round_shapes import rod
from ...gaussians.assets.modeling.shapes import boxes, join
from ...gaussians.color import parse
from ...gaussians.motion.motion import Motion, Residual, Track
from ...gaussians.motion.runs import ids_of
from ...gaussians.scene import Scene
from . import paths
from .rooms import Node, Room, one_of
from .things import Parts

F64 = NDArray[np.float64]

_KEYS = np.round(np.arange(0.0, paths.STOP + 0.025, 0.05), 6)  # seconds, of displacements
_TOWEL = (0.9, 1.2, 1.75)  # width, length, and height of its upper edge, metres
_STALKS = 7
_JELLY = 0.36  # metres, the side
_HOPS = ((0.6, 1.4), (1.4, 2.2), (2.2, 3.0))  # seconds, from which to which it is in the air or squashed


def soft_room(name: str, detail: float = 1.0) -> Scene:
    """One of the three rooms, 0 to 5 s; the same arguments give the same bytes.

    Args:
        name: one of `names()`.
        detail: factor on the number of Gaussians.

    Raises:
        UserError: no room has this name.
    """
    furnished = one_of(_ROOMS, name, "soft room")
    room = Room.of(
        (4.0, 3.4, 2.6),
        (
            Node("bench", (1.2, 0.38, 0.45), -1.76, -0.3, 90.0),
            Node("bookshelf", (0.9, 0.3, 1.8), 1.1, 1.5),
            Node("chair", (0.45, 0.5, 0.9), 1.5, 0.2, -90.0),
        ),
        detail,
    )
    return furnished(room)


def names() -> tuple[str, ...]:
    """The rooms there are."""
    return tuple(_ROOMS)


def _towel(room: Room) -> Scene:
    """A striped towel hangs from a rail and waves from 0.5 to 4.5 s; the wave runs down."""
    x, y = 0.0, 0.3
    room.put(_rail(x, y))
    _, long, top = _TOWEL
    runs = room.runs["towel"]
    down = (top - _means(room, runs)[:, 2]) / long
    way = 0.2 * np.clip(down, 0, None)[:, None] * np.stack([np.cos(2.2 * down), np.sin(2.2 * down)], axis=1)
    swing, phase = _swell(0.5, 4.5), 2 * math.pi * 0.5 * (_KEYS - 0.5)
    basis = swing[:, None] * np.stack([np.sin(phase), -np.cos(phase)], axis=1)
    return _bent(room, runs, basis, way[:, :, None] * np.array([0.0, 1.0, 0.0]))


def _rail(x: float, y: float) -> Parts:
    wide, long, top = _TOWEL
    rows = 8
    high = long / rows
    stripes = [
        boxes([(wide, 0.02, high, x, y, top - (k + 1) * high) for k in range(first, rows, 2)], 0.0).named(
            "stripe", Material(parse(color), main=not first)
        )
        for first, color in enumerate(("#c23b2e", "#f0e6d0"))
    ]
    mark = boxes([(0.16, 0.03, 0.16, x + s * 0.22, y, top - 0.95 + s * 0.25) for s in (-1, 1)], 0.0)
    half = wide / 2 + 0.12
    posts = [rod((x + s * half, y, 0), (x + s * half, y, top + 0.02), 0.02) for s in (-1, 1)]
    bar = rod((x - half, y, top + 0.02), (x + half, y, top + 0.02), 0.02)
    return {
        "towel": [*stripes, mark.named("mark", Material(parse("#1f4f9c")))],
        "rail": [join(*posts, bar).named("rail", Material((0.3, 0.3, 0.32)))],
    }


def _plant(room: Room) -> Scene:
    """A tall plant bends in a draught, there and back."""
    x, y, foot = 0.0, 0.2, 0.3
    turns = 2 * math.pi * np.arange(_STALKS) / _STALKS
    stalks = [rod((x + 0.03 * c, y + 0.03 * s, foot), (x + 0.2 * c, y + 0.2 * s, 1.35 + 0.1 * (k % 3)), 0.022)
              for k, (c, s) in enumerate(zip(np.cos(turns), np.sin(turns), strict=True))]  # fmt: skip
    heads = boxes(
        [(0.14, 0.14, 0.1, x + 0.2 * c, y + 0.2 * s, 1.3 + 0.1 * (k % 3)) for k, (c, s) in enumerate(
            zip(np.cos(turns), np.sin(turns), strict=True))], 0.02
    )  # fmt: skip
    room.put({
        "plant": [
            join(*stalks).named("stalk", Material(parse("#3f8f3a"), main=True)),
            heads.named("head", Material(parse("#d9a520"))),
        ],
        "pot": [boxes([(0.34, 0.34, foot, x, y, 0.0)], 0.02).named("pot", Material(parse("#a8552d")))],
    })  # fmt: skip
    runs = room.runs["plant"]
    means = _means(room, runs)
    high = np.clip(means[:, 2] - foot, 0, None) / 1.2
    bend = np.stack([0.32 * high**2, 0.1 * high**2, -0.06 * high**3], axis=1)
    basis = _swell(0.4, 4.6) * np.sin(2 * math.pi * 0.45 * (_KEYS - 0.4))
    return _bent(room, runs, basis[:, None], bend[:, None])


def _jelly(room: Room) -> Scene:
    """A striped cube of jelly hops three times, and is squashed whenever it lands."""
    x, y, side = -0.9, -0.4, _JELLY
    layers = [
        boxes([(side, side, side / 4, x, y, k * side / 4) for k in range(first, 4, 2)], 0.01).named(
            "layer", Material(parse(color), main=not first)
        )
        for first, color in enumerate(("#3aa655", "#e8d44a"))
    ]
    room.put({"jelly": layers})
    runs = room.runs["jelly"]
    from_foot = _means(room, runs) - np.array([x, y, 0.0])
    ways = from_foot * np.array([0.3, 0.3, -0.45])
    squash, gone, high = np.zeros((3, len(_KEYS)))
    for start, stop in _HOPS:
        share = np.clip((_KEYS - start) / (stop - start), 0, 1)
        jump = np.clip((share - 0.45) / 0.5, 0, 1)
        gone += 0.6 * jump
        high += 0.9 * jump * (1 - jump)
        squash += np.sin(np.pi * np.clip(share / 0.5, 0, 1)) ** 2
    offsets = np.stack([gone, 0.1 * gone, high], axis=1)
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(_KEYS), 1))
    room.tracks.append(Track(runs, _KEYS, quats, offsets, np.array([x, y, 0.0]), "rigid", None, None, name="jelly"))
    return _bent(room, runs, squash[:, None], ways[:, None])


def _bent(room: Room, runs: NDArray[np.int64], basis: F64, ways: F64) -> Scene:
    """The room with displacements of a part: `basis` `[K, B]` and weights `[n, B, 3]`."""
    scene = room.done()
    assert scene.motion is not None
    residual = Residual(ids_of(runs), _KEYS, basis, ways.astype(np.float32))
    return scene.replace(motion=Motion(scene.motion.tracks, (), (residual,), paths.START, paths.STOP))


def _means(room: Room, runs: NDArray[np.int64]) -> F64:
    """Where the Gaussians of a part are, `[n, 3]`; their ids are their rows."""
    return room.scene.cloud.means.numpy().astype(np.float64)[ids_of(runs)]


def _swell(start: float, stop: float) -> F64:
    """`[K]` from 0 to 1 within 0.6 s, and back before the end."""
    rise = np.clip(np.minimum(_KEYS - start, stop - _KEYS) / 0.6, 0, 1)
    return np.asarray(rise * rise * (3 - 2 * rise))


_ROOMS: dict[str, Callable[[Room], Scene]] = {"towel": _towel, "plant": _plant, "jelly": _jelly}
