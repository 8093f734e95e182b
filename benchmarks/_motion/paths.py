"""The true motions of the six rooms, as tracks. Seconds, metres, the room's frame (z up)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians import rotations
from ...gaussians.camera import Vec3
from ...gaussians.motion.motion import Track
from .things import BALL, BOOK

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

START, STOP = 0.0, 5.0  # seconds, of every room
GRAVITY = 9.81
_STEP = 0.1  # seconds between two keys of what goes along a curve


def rolling(runs: I64, begin: Vec3, length: float, lift: Callable[[float], float], times: tuple[float, float]) -> Track:
    """A ball that is kicked along +x and comes to rest after `length`; it turns as it rolls.

    Args:
        begin: its centre at rest.
        lift: height of what it rolls on, by the way it has gone.
    """
    (start, stop), keys = times, np.arange(times[0], times[1] + _STEP / 2, _STEP)
    gone = length * (1 - (1 - np.clip((keys - start) / (stop - start), 0, 1)) ** 1.6)
    offsets = np.stack([gone, np.zeros(len(keys)), [lift(s) for s in gone]], axis=1)
    return _rigid(runs, keys, _about((0.0, 1.0, 0.0), gone / BALL), offsets, begin, "ball")


def falling(runs: I64, begin: Vec3, away: float, start: float, name: str) -> Track:
    """A book that tips over the edge of a board, falls freely and lands on its face, `away` before the wall's board.

    Args:
        begin: its middle at rest; it comes to lie at half its own height.
    """
    drop = begin[2] - BOOK[2] / 2
    seconds = math.sqrt(2 * drop / GRAVITY)
    share = np.linspace(0, 1, 13)
    offsets = np.stack([0 * share, -away * share, -drop * share**2], axis=1)
    turns = math.pi * share * (2 - share)
    return _rigid(runs, start + seconds * share, _about((1.0, 0.0, 0.0), turns), offsets, begin, name)


def walking(runs: I64, begin: Vec3, first: float, second: float) -> Track:
    """A robot that walks `first` metres along +x until 2 s, turns left, walks `second` metres and stops at 4 s; it bobs
    by 2 cm, once a step."""
    keys = np.round(np.arange(0.2, 4.0 + _STEP / 2, _STEP), 6)
    one, other = np.clip((keys - 0.2) / 1.7, 0, 1), np.clip((keys - 2.2) / 1.8, 0, 1)
    walks = ((one > 0) & (one < 1)) | ((other > 0) & (other < 1))
    bob = 0.02 * np.sin(np.pi * keys / 0.4) ** 2 * walks
    turn = 0.5 * math.pi * np.clip((keys - 1.9) / 0.3, 0, 1)
    offsets = np.stack([first * one, second * other, bob], axis=1)
    return _rigid(runs, keys, _about((0.0, 0.0, 1.0), turn), offsets, begin, "robot")


def hinged(
    runs: I64, pivot: Vec3, axis: Vec3, times: tuple[float, ...], degrees: tuple[float, ...], name: str
) -> Track:
    """A leaf on a hinge through `pivot`."""
    angles = np.radians(degrees)
    quats = _about(axis, angles)
    return Track(
        runs, np.array(times), quats, np.zeros((len(times), 3)), np.array(pivot), "hinge", np.array(axis), angles,
        name=name,
    )  # fmt: skip


def sliding(runs: I64, axis: Vec3, times: tuple[float, ...], way: tuple[float, ...], name: str) -> Track:
    """A drawer that slides along an axis."""
    quats, offsets = _about(axis, np.zeros(len(times))), np.outer(way, axis)
    return Track(
        runs, np.array(times), quats, offsets, np.zeros(3), "slide", np.array(axis), np.array(way), name=name
    )  # fmt: skip


def spinning(runs: I64, pivot: Vec3, times: tuple[float, ...], turns: tuple[float, ...], name: str) -> Track:
    """A fan that turns about the vertical through `pivot` at an even rate between keys."""
    axis, angles = (0.0, 0.0, 1.0), 2 * math.pi * np.array(turns)
    return Track(
        runs, np.array(times), _about(axis, angles), np.zeros((len(times), 3)), np.array(pivot), "spin",
        np.array(axis), angles, smooth=False, name=name,
    )  # fmt: skip


def _rigid(runs: I64, times: F64, quats: F64, offsets: F64, pivot: Vec3, name: str) -> Track:
    return Track(runs, times, quats, offsets, np.array(pivot), "rigid", None, None, name=name)


def _about(axis: Vec3, radians: F64) -> F64:
    """`[K, 4]` turns about one axis."""
    return rotations.from_axis_angle(axis, torch.from_numpy(np.asarray(radians, dtype=np.float64))).numpy()
