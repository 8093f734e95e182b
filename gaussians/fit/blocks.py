"""Fit a large capture by blocks: everything coarsely first, then each block of space alone, twice.

A block is a cell of space. Its Gaussians are trained on the parts of the photographs that show it, while all others
stand around it and stay as they are. All of it is one training with one schedule: the first part trains everything, the
others go on from there block by block, with the optimiser's moments; the last goes over blocks that are all done, so
that they meet without seams. A coarse fit first and blocks among it afterwards is the scheme of CityGaussian (Liu et
al. 2024).

What a step optimises is one block; what it draws besides are the other Gaussians in the same part of the photograph.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..errors import FileError, UserError
from ..render import render
from ..scene import Scene
from . import checkpoint, fitting, held_out_choice
from .densify import MCMCStrategy
from .engine import engine_for, resolve_device
from .fitting import Fitted, Record, Settings, Status
from .held_out_choice import Choice
from .initialize import initial_cloud
from .parameters import Parameters
from .photographs.photos import MIN_PHOTOS, Photos
from .quality import measure
from .train import REFINE_STOP, Schedule, Shot, Trainer, morton_order

MOST_BLOCKS = 256
PER_BLOCK = 500_000  # Gaussians of a block at most, if the number of blocks is chosen by itself
COARSE = 0.4  # share of the training after which it goes on by blocks
COARSE_GAUSSIANS = 0.5  # share of the Gaussians that everything together may have until then
ROUNDS = ((COARSE, REFINE_STOP), (REFINE_STOP, 1.0))  # the parts of the training that go over the blocks
GROW = 0.25  # of a block's Gaussians added per refinement: there are fewer of them than in a whole training
MARGIN = 8  # pixels around a block's part of a photograph
SMALLEST = 24  # pixels; photographs that show less of a block are not its business
SEEN = 0.01  # of a photograph that must show a block
TRIM = 0.01  # of the pixels that show a block, on each side, that its part may leave out
F32 = NDArray[np.float32]
_PART = re.compile(r"(?:coarse|round-\d+-block-\d+)(?:\.checkpoint)?")  # files of a training


@dataclass(frozen=True, eq=False)
class Cell:
    """A box of space, `low` and `high` `[3]`, world; infinite where nothing is beyond."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def holds(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """`[...]` of points `[..., 3]`; cells of one division hold each point once."""
        return np.asarray(((points >= self.low) & (points < self.high)).all(axis=-1))


def blocks_for(max_gaussians: int) -> int:
    """The number of blocks that keeps each under `PER_BLOCK` Gaussians; 1: the capture is fitted as a whole."""
    return min(MOST_BLOCKS, math.ceil(max_gaussians / PER_BLOCK))


def cells(points: F32, count: int) -> list[Cell]:
    """Divide space into cells that hold about as many of the points `[M, 3]` each, across the longest side first.

    Raises:
        UserError: there are fewer points than cells.
    """
    if count > len(points):
        raise UserError(f"{len(points)} Gaussians cannot be divided into {count} blocks; give fewer --blocks")
    whole = Cell(np.full(3, -np.inf), np.full(3, np.inf))
    found: list[Cell] = []
    todo = [(whole, points, count)]
    while todo:
        cell, inside, parts = todo.pop()
        if parts == 1:
            found.append(cell)
            continue
        low, high = np.quantile(inside, [0.02, 0.98], axis=0)  # strays do not tell where a place is long
        axis, left = int(np.argmax(high - low)), parts // 2
        at = float(np.quantile(inside[:, axis], left / parts))
        below, above = cell.high.copy(), cell.low.copy()
        below[axis] = above[axis] = at
        under = inside[:, axis] < at
        todo += [(Cell(above, cell.high), inside[~under], parts - left), (Cell(cell.low, below), inside[under], left)]
    return found


def fit_by_blocks(
    photos: Photos,
    settings: Settings,
    blocks: int,
    *,
    folder: Path | None = None,
    on_status: Callable[[Status], None] = lambda status: None,
) -> Fitted:
    """Train a scene by blocks.

    Args:
        settings: of the whole; everything together gets `COARSE` of its length, the blocks the rest. Steps are steps
            of whole photographs: a block makes as many more as its parts of them are smaller.
        folder: keeps checkpoints and finished blocks, so that a training that was stopped goes on from there. The
            caller deletes it after saving the scene.
        on_status: as in `fit`.

    Raises:
        UserError: the number of blocks is out of range, or the capture is too small for it.
        FileError: the folder belongs to another training, or cannot be written.
        BackendError: the device is not available.
    """
    if not 2 <= blocks <= MOST_BLOCKS:
        raise UserError(f"--blocks must be from 2 to {MOST_BLOCKS}, 1 for a whole, or auto, got {blocks}")
    wanted = f"{settings.seconds} s" if settings.steps is None else f"{settings.steps} steps"  # finished parts keep it
    kept = _Kept(folder, f"{fitting.training_id(photos, settings)} in {blocks} blocks, {wanted}")
    begun = kept.part("coarse", partial(_coarse, photos, settings, _share_of(on_status, 0, COARSE)))
    parameters, steps, seconds, choices = begun.parameters, begun.steps, begun.seconds, list[Choice]()
    division = cells(parameters.means, blocks)
    shares = [float(cell.holds(parameters.means).mean()) for cell in division]
    for lap, (first, last) in enumerate(ROUNDS):
        parts = parts_of(photos.shots, parameters.cloud(), division)
        for i, (cell, share) in enumerate(zip(division, shares, strict=True)):
            length = (last - first) * share
            status = _share_of(on_status, first + (last - first) * sum(shares[:i]), length)
            inside = cell.holds(parameters.means)
            own, others = (parameters.only(np.flatnonzero(rows)) for rows in (inside, ~inside))
            task = partial(_block, own, others, parts[i], share, photos, settings, lap, i, status)
            done = kept.part(f"round-{lap + 1}-block-{i + 1}", task)
            parameters = Parameters.joined([others, done.parameters])
            steps, seconds = steps + done.steps, seconds + done.seconds
        if last == REFINE_STOP:
            choices = fitting.reduced(parameters, photos, settings)
    parameters.take(morton_order(parameters.means))
    cloud = parameters.cloud()
    cameras = tuple(sorted((s.camera for s in (*photos.shots, *photos.held_out)), key=lambda camera: camera.name))
    quality = measure(cloud, photos.held_out)
    return Fitted(Scene(cloud, cameras=cameras), quality, steps, seconds, (), tuple(choices))


def parts_of(shots: Sequence[Shot], cloud: GaussianCloud, division: Sequence[Cell]) -> list[list[Shot]]:
    """For each cell, those photographs that show it, cut to where they do: where the surface seen lies in the cell."""
    found: list[list[Shot]] = [[] for _ in division]
    for shot in shots:
        seen = render(cloud, shot.camera)
        points = points_seen(shot.camera, seen.depth.numpy())
        there = seen.alpha.numpy() > 0.5
        for cell, parts in zip(division, found, strict=True):
            box = _rectangle(there & cell.holds(points))
            if box is not None:
                parts.append(cropped(shot, *box))
    return found


def points_seen(camera: Camera, depth: F32) -> NDArray[np.float64]:
    """World points `[H, W, 3]` at depths `[H, W]` of a camera's pixels."""
    y, x = np.mgrid[: camera.height, : camera.width] + 0.5
    rays = np.stack([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, np.ones_like(x)], axis=-1)
    pose = camera.world_to_camera
    return np.asarray((rays * depth[..., None] - pose[:3, 3]) @ pose[:3, :3])


def cropped(shot: Shot, left: int, top: int, right: int, bottom: int) -> Shot:
    """A part of a photograph with the camera that sees just this part."""
    c = shot.camera
    camera = Camera(
        c.world_to_camera, c.fx, c.fy, c.cx - left, c.cy - top, right - left, bottom - top, c.name
    )  # fmt: skip
    return Shot(camera, np.ascontiguousarray(shot.photo[top:bottom, left:right]))


def _rectangle(mask: NDArray[np.bool_]) -> tuple[int, int, int, int] | None:
    """Left, top, right, bottom around the pixels of a mask `[H, W]`; None if they are few."""
    height, width = mask.shape
    y, x = np.nonzero(mask)
    if len(x) <= SEEN * mask.size:
        return None
    (left, right), (top, bottom) = (np.quantile(v, [TRIM, 1 - TRIM]).astype(int) for v in (x, y))
    left, top = max(0, left - MARGIN), max(0, top - MARGIN)
    right, bottom = min(width, right + 1 + MARGIN), min(height, bottom + 1 + MARGIN)
    return None if min(right - left, bottom - top) < SMALLEST else (left, top, right, bottom)


@dataclass(frozen=True, eq=False)
class _Trained:
    """A finished part of the training, with its optimisers, and what it took."""

    parameters: Parameters
    steps: int
    seconds: float


def _coarse(photos: Photos, settings: Settings, on_status: Callable[[Status], None], path: Path | None) -> _Trained:
    """The beginning of the training, of everything."""
    rng = np.random.default_rng(settings.seed)
    most = max(1, round(COARSE_GAUSSIANS * settings.max_gaussians))
    start, strategy = Parameters.of(initial_cloud(photos, most, rng)), MCMCStrategy(most, rng)
    shorter = replace(settings, **_length(settings, COARSE, photos.shots, photos.shots))
    return _trained(photos, photos.shots, start, strategy, rng, shorter, (0.0, COARSE), None, on_status, path)


def _block(
    own: Parameters,
    others: Parameters,
    parts: Sequence[Shot],
    share: float,
    photos: Photos,
    settings: Settings,
    lap: int,
    index: int,
    on_status: Callable[[Status], None],
    path: Path | None,
) -> _Trained:
    """One block trained while the others stay as they are.

    Args:
        parts: of the photographs.
        share: of the training that the block gets.
        lap: of `ROUNDS`.
    """
    if len(parts) < MIN_PHOTOS or not len(own):
        return _Trained(own, 0, 0.0)
    first, last = ROUNDS[lap]
    rng = np.random.default_rng((settings.seed, lap, index))
    strategy = MCMCStrategy(max(len(own), round(share * settings.max_gaussians)), rng, GROW)
    shorter = replace(settings, **_length(settings, (last - first) * share, parts, photos.shots))
    return _trained(photos, parts, own, strategy, rng, shorter, (first, last), others, on_status, path)


def _trained(
    photos: Photos,
    shots: Sequence[Shot],
    start: Parameters,
    strategy: MCMCStrategy,
    rng: np.random.Generator,
    settings: Settings,
    part: tuple[float, float],
    others: Parameters | None,
    on_status: Callable[[Status], None],
    path: Path | None,
) -> _Trained:
    """A part of the training, on some photographs.

    Args:
        settings: with the length of this part.
        part: where in the whole training it begins and ends.
        others: Gaussians that stay as they are.
        path: of its checkpoint.
    """
    degree = held_out_choice.MAX_DEGREE if settings.degree == "auto" else settings.degree
    schedule = Schedule(settings.steps, settings.seconds, settings.coarse, degree, first=part[0], last=part[1])
    engine = engine_for(resolve_device(settings.device), None if others is None else others.columns())
    trainer = Trainer(shots, start, strategy, photos.extent, schedule, rng, engine)
    name = f"{fitting.training_id(replace(photos, shots=tuple(shots)), settings)} {part}"
    record = Record() if path is None else fitting.resume(trainer, path, name)
    whole = replace(photos, held_out=())  # they show everything, which is measured at the end
    unreduced = replace(settings, gain=None, degree=degree)
    fitting.train(trainer, whole, unreduced, record, None if path is None else (path, name), on_status)
    return _Trained(trainer.parameters, trainer.steps, trainer.seconds)


def _length(settings: Settings, share: float, parts: Sequence[Shot], shots: Sequence[Shot]) -> dict[str, Any]:
    """The length of a share of the training; in steps, as many with parts of photographs as make as many pixels."""
    if settings.steps is None:
        return {"seconds": share * (settings.seconds or 0.0)}
    return {"steps": max(1, round(share * settings.steps * _pixels(shots) / _pixels(parts)))}


def _pixels(shots: Sequence[Shot]) -> float:
    """Mean number of pixels of photographs."""
    return sum(s.camera.width * s.camera.height for s in shots) / len(shots)


def _share_of(on_status: Callable[[Status], None], first: float, length: float) -> Callable[[Status], None]:
    """Reports the progress of a part as that of the whole, of which it is `length` from `first` on."""

    def report(status: Status) -> None:
        share = first + length * status.share
        left = status.seconds_left * (1 - share) / max(length * (1 - status.share), 1e-9) if status.share < 1 else 0.0
        on_status(replace(status, share=share, seconds_left=left))

    return report


def delete(folder: Path) -> None:
    """Delete what a training by blocks kept in its folder; the folder itself if nothing else is in it."""
    for path in [p for p in folder.glob("*") if _PART.fullmatch(p.name)]:
        checkpoint.delete(path)
    with contextlib.suppress(OSError):
        folder.rmdir()


class _Kept:
    """Finished parts in a folder, one file each, beside the checkpoint of the part under way."""

    def __init__(self, folder: Path | None, name: str) -> None:
        self._folder, self._name = folder, name
        if folder is not None:
            try:
                folder.mkdir(exist_ok=True)
            except OSError as error:
                raise FileError(f"cannot make the folder {folder}: {error.strerror or error}") from error

    def part(self, part: str, train: Callable[[Path | None], _Trained]) -> _Trained:
        """The finished part of that name, or what `train` makes with the path of its checkpoint, which is then kept."""
        if self._folder is None:
            return train(None)
        path, under_way = self._folder / part, self._folder / f"{part}.checkpoint"
        found = checkpoint.load(path)
        if found is not None:
            return self._read(path, *found)
        done = train(under_way)
        values = {"name": self._name, "steps": done.steps, "seconds": done.seconds}
        checkpoint.save(path, done.parameters.state(), values)
        checkpoint.delete(under_way)
        return done

    def _read(self, path: Path, arrays: Mapping[str, Any], values: Mapping[str, Any]) -> _Trained:
        if values.get("name") != self._name:
            raise FileError(
                f"{path} is of another training (other photographs, settings or length); delete it to start over"
            )
        try:
            return _Trained(Parameters.load(arrays), int(values["steps"]), float(values["seconds"]))
        except (KeyError, ValueError, TypeError) as error:
            raise FileError(f"cannot go on from {path} ({error}); delete it to start over") from error
