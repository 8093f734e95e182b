"""Fits of films of the moving rooms, and how near they are to the truth: pictures, paths, what belongs to a thing."""

from __future__ import annotations

import math
import os
import time
from dataclasses import dataclass
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.cloud import GaussianCloud
from ...gaussians.files.captures import colmap
from ...gaussians.fit import Photos, Settings
from ...gaussians.fit.train import Shot
from ...gaussians.motion.at import at
from ...gaussians.motion.fitting.fit import Detail, fit_film
from ...gaussians.motion.motion import poses
from ...gaussians.render import render
from ...gaussians.scene import Scene
from .films import Film, Frame, Rig, film, middles
from .identity import belonging

LEAST_MASK = 20  # pixels of a mask within which PSNR is measured
ONLY = "SCENEWRIGHT_BENCH_ONLY"  # rooms and rigs to fit, e.g. "ball-12,toy-4"; none: all


@dataclass(frozen=True)
class Figures:
    """How near a fit is to the truth.

    Attributes:
        whole, inside: mean PSNR of held-out frames, and within the masks of what moves, dB.
        path: mean distance of the middle of each moving thing from where it is, scene units (metres); NaN: none moves.
        worst: the largest such distance.
        found: share of the things on a track whose path is within half their way; NaN: nothing is on one.
        overlap: intersection over union of the pixels of what moves, over all held-out frames.
        assigned, kept: the same of Gaussians, see `identity.Belonging`.
        residual: share of the Gaussians that have a displacement of their own.
        kinds: of the tracks.
        keys: of all tracks.
        bytes: of the columns of the cloud and of the motion.
        cpu: seconds of the processor that the fit took.
    """

    whole: float
    inside: float
    path: float
    worst: float
    found: float
    overlap: float
    assigned: float
    kept: float
    residual: float
    kinds: tuple[str, ...]
    keys: int
    bytes: int
    cpu: float


def wanted(name: str, rig: Rig) -> bool:
    """Whether a room on a rig is to be fitted."""
    only = os.environ.get(ONLY)
    return not only or f"{name}-{rig}" in only.split(",")


def fitted(made: Film, steps: int, detail: Detail = "residual") -> Figures:
    """Fit a film and measure it."""
    started = time.process_time()
    shots, held = (tuple(Shot(f.camera, f.photo, f.time) for f in part) for part in (made.frames, made.held_out))
    eyes = np.stack([shot.camera.position for shot in shots])
    radius = 1.1 * float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max())
    nothing = colmap.Points(np.zeros((0, 3)), np.zeros((0, 3)))
    chosen = held[1::4] if detail == "residual" else held[:0]  # what residuals are chosen by
    scene = fit_film(Photos(shots, chosen, nothing, radius), Settings(steps=steps, degree=0), detail=detail).scene
    return judged(scene, made, time.process_time() - started)


def judged(scene: Scene, made: Film, cpu: float) -> Figures:
    """The figures of a fitted scene."""
    pictures = [_compared(scene, frame) for frame in made.held_out]
    away, found = _paths(scene, made)
    union = sum(p.union for p in pictures)
    motion, same = scene.motion, belonging(scene, made)
    single = sum(len(r.ids) for r in motion.residuals) if motion is not None else 0
    return Figures(
        whole=fmean(p.whole for p in pictures),
        inside=fmean(p.inside for p in pictures if p.inside is not None),
        path=float(np.mean(away)) if len(away) else math.nan,
        worst=float(np.max(away)) if len(away) else math.nan,
        found=found,
        overlap=sum(p.shared for p in pictures) / max(union, 1),
        assigned=same.assigned,
        kept=same.kept,
        residual=single / len(scene.cloud),
        kinds=tuple(t.kind for t in motion.tracks) if motion is not None else (),
        keys=sum(len(t.times) for t in motion.tracks) if motion is not None else 0,
        bytes=scene.cloud.nbytes + (motion.nbytes if motion is not None else 0),
        cpu=cpu,
    )


@dataclass(frozen=True)
class _Compared:
    """A held-out frame against the fit: PSNR, and pixels of what moves in both and in either."""

    whole: float
    inside: float | None
    shared: int
    union: int


def _compared(scene: Scene, frame: Frame) -> _Compared:
    cloud: GaussianCloud = at(scene, frame.time).cloud
    picture = render(cloud, frame.camera)
    off = np.square(picture.to_uint8().astype(np.float64) / 255 - frame.photo / 255)
    moves = (picture.group.numpy() >= 0) & (picture.alpha.numpy() > 0.5)
    inside = _psnr(off[frame.mask]) if frame.mask.sum() >= LEAST_MASK else None
    return _Compared(_psnr(off), inside, int((moves & frame.mask).sum()), int((moves | frame.mask).sum()))


def _psnr(squares: NDArray[np.float64]) -> float:
    return -10 * math.log10(max(float(squares.mean()), 1e-10))


def _paths(scene: Scene, made: Film) -> tuple[NDArray[np.float64], float]:
    """Distances `[M, T]` of the middles of the found things from where they are, and the share that was found.

    To each thing belongs the track that takes its middle nearest to where it goes.
    """
    true = middles(made.scene, made.times)
    if scene.motion is None or not scene.motion.tracks:
        return np.zeros((0, len(made.times))), 0.0 if len(true) else math.nan
    away = []
    for path in true:
        each = []
        for track in scene.motion.tracks:
            turns, shifts = poses(track, made.times)
            each.append(np.linalg.norm(turns @ path[0] + shifts - path, axis=1))
        best = min(each, key=lambda e: float(e.mean()))
        if best.max() < 0.5 * max(float(np.ptp(path, axis=0).max()), _reach(made, path[0])):
            away.append(best)
    return np.array(away).reshape(-1, len(made.times)), len(away) / len(true) if len(true) else math.nan


def _reach(made: Film, middle: NDArray[np.float64]) -> float:
    """How far the moving thing around a point reaches, metres: what a fan moves while its middle stays."""
    assert made.scene.motion is not None
    sizes = []
    for track in made.scene.motion.tracks:
        means = made.scene.cloud.means[torch.isin(made.scene.cloud.ids, torch.from_numpy(track.ids))].double().numpy()
        sizes.append((float(np.linalg.norm(means.mean(axis=0) - middle)), float(np.ptp(means, axis=0).max()) / 2))
    return min(sizes)[1]


def small() -> Film:
    """The film of quick runs."""
    return film("toy", "12", (128, 96), 4.0, 0.3)
