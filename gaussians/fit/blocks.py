"""Fit a large capture by blocks: a coarse fit of everything, then each block of space alone, twice.

A block is a cell of space. Its Gaussians are trained on the parts of the photographs that show it, while all others
stand around it and stay as they are. In the first round, blocks that were not trained yet are those of the coarse
fit; in the second, each is trained among blocks that are done, so that they meet without seams. A coarse fit first and
blocks among it afterwards is the scheme of CityGaussian (Liu et al. 2024).

What a training optimises is one block; what it holds besides are the other Gaussians, without gradients and moments.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..errors import FileError, UserError
from ..scene import Scene
from . import checkpoint, fitting
from .densify import MCMCStrategy
from .engine import engine_for, resolve_device
from .fitting import Fitted, Record, Settings, Status
from .held_out_choice import Choice
from .parameters import Parameters
from .photographs.photos import MIN_PHOTOS, Photos
from .quality import measure
from .train import REFINE_EVERY, Schedule, Shot, Trainer, morton_order

MOST_BLOCKS = 256
PER_BLOCK = 500_000  # Gaussians of a block at most, if the number of blocks is chosen by itself
COARSE = 0.4  # share of the training, and of the Gaussians, for the coarse fit
ROUNDS = (0.35, 0.25)  # shares of the training for each round over the blocks
LR_START = (0.3, 0.1)  # learning rate of means at the start of a block in each round, over that of the whole's start
GROW = 0.4  # of a block's Gaussians added per refinement: a block is trained for a shorter time than a whole
MARGIN = 8  # pixels around a block's part of a photograph
SMALLEST = 24  # pixels; photographs that show less of a block are not its business
SEEN = 0.02  # of a block's Gaussians that a photograph must show
TRIM = 0.02  # of a block's Gaussians on each side of a photograph that its part may leave out
_COLUMNS = ("means", "quats", "scales", "opacities", "sh")
F32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Cell:
    """A box of space, `low` and `high` `[3]`, world; infinite where nothing is beyond."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def holds(self, points: F32) -> NDArray[np.bool_]:
        """`[M]` of points `[M, 3]`; cells of one division hold each point once."""
        return np.asarray(((points >= self.low) & (points < self.high)).all(axis=1))


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
        settings: of the whole; the coarse fit gets `COARSE` of its length, the blocks the rest. Steps are
            steps of whole photographs: a block makes as many more as its parts of them are smaller.
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
    kept = _Kept(folder, f"{fitting.training_id(photos, settings)} in {blocks} blocks")
    coarse = kept.part("coarse", partial(_coarse, photos, settings, _share_of(on_status, 0, COARSE)))
    means, division = coarse.cloud.means.numpy(), cells(coarse.cloud.means.numpy(), blocks)
    held = [cell.holds(means) for cell in division]
    parts, shares = [coarse.cloud[torch.from_numpy(h)] for h in held], [float(h.mean()) for h in held]
    steps, seconds, first = coarse.steps, coarse.seconds, COARSE
    for k, length in enumerate(ROUNDS):
        for i, share in enumerate(shares):
            status = _share_of(on_status, first, length * share)
            train = partial(_block, parts, i, share, photos, settings, k, status)
            done = kept.part(f"round-{k + 1}-block-{i + 1}", train)
            parts[i] = done.cloud
            steps, seconds, first = steps + done.steps, seconds + done.seconds, first + length * share
    cloud = _together(parts)
    cameras = tuple(sorted((s.camera for s in (*photos.shots, *photos.held_out)), key=lambda camera: camera.name))
    return Fitted(Scene(cloud, cameras=cameras), measure(cloud, photos.held_out), steps, seconds, (), coarse.choices)


def parts_of(shots: tuple[Shot, ...], points: F32) -> list[Shot]:
    """Those photographs that show a block, cut to where they show it.

    Args:
        points: `[M, 3]` the block's Gaussians in the coarse fit.
    """
    found = []
    for shot in shots:
        box = _rectangle(shot.camera, points)
        if box is not None:
            found.append(cropped(shot, *box))
    return found


def cropped(shot: Shot, left: int, top: int, right: int, bottom: int) -> Shot:
    """A part of a photograph with the camera that sees just this part."""
    c = shot.camera
    camera = Camera(
        c.world_to_camera, c.fx, c.fy, c.cx - left, c.cy - top, right - left, bottom - top, c.name
    )  # fmt: skip
    return Shot(camera, np.ascontiguousarray(shot.photo[top:bottom, left:right]))


def _rectangle(camera: Camera, points: F32) -> tuple[int, int, int, int] | None:
    """Left, top, right, bottom of where a camera sees points; None if it sees hardly any of them."""
    pose = camera.world_to_camera
    seen = points @ pose[:3, :3].T + pose[:3, 3]
    seen = seen[seen[:, 2] > 1e-6]
    x = camera.fx * seen[:, 0] / seen[:, 2] + camera.cx
    y = camera.fy * seen[:, 1] / seen[:, 2] + camera.cy
    inside = (x >= 0) & (x < camera.width) & (y >= 0) & (y < camera.height)
    if inside.sum() < max(1.0, SEEN * len(points)):
        return None
    spans = [np.quantile(v[inside], [TRIM, 1 - TRIM]) for v in (x, y)]
    left, top = (max(0, math.floor(span[0]) - MARGIN) for span in spans)
    right = min(camera.width, math.ceil(spans[0][1]) + MARGIN)
    bottom = min(camera.height, math.ceil(spans[1][1]) + MARGIN)
    return None if min(right - left, bottom - top) < SMALLEST else (left, top, right, bottom)


def _together(parts: Sequence[GaussianCloud]) -> GaussianCloud:
    """The parts as one cloud, neighbours in space near in memory, with new ids."""
    columns = [torch.cat([getattr(part, name) for part in parts]) for name in _COLUMNS]
    order = torch.from_numpy(morton_order(columns[0].numpy()))
    return GaussianCloud.create(*(column[order] for column in columns))


@dataclass(frozen=True, eq=False)
class _Trained:
    """A finished part: its Gaussians, and what it took."""

    cloud: GaussianCloud
    steps: int
    seconds: float
    choices: tuple[Choice, ...] = ()


def _coarse(photos: Photos, settings: Settings, on_status: Callable[[Status], None], path: Path | None) -> _Trained:
    """The fit of everything, short and with few Gaussians."""
    short = replace(
        settings,
        seconds=None if settings.seconds is None else COARSE * settings.seconds,
        steps=None if settings.steps is None else max(1, round(COARSE * settings.steps)),
        max_gaussians=max(1, round(COARSE * settings.max_gaussians)),
    )
    done = fitting.fit(photos, short, checkpoint_path=path, on_status=on_status)
    return _Trained(done.scene.cloud, done.steps, done.seconds, done.choices)


def _block(
    parts: Sequence[GaussianCloud],
    index: int,
    share: float,
    photos: Photos,
    settings: Settings,
    lap: int,
    on_status: Callable[[Status], None],
    path: Path | None,
) -> _Trained:
    """One block trained while the others stay as they are.

    Args:
        parts: the blocks as they are by now.
        share: of the coarse fit's Gaussians that the block got.
        lap: of `ROUNDS`.
    """
    own = parts[index]
    shots = parts_of(photos.shots, own.means.numpy())
    if len(shots) < MIN_PHOTOS:
        return _Trained(own, 0, 0.0)
    around = _together([part for i, part in enumerate(parts) if i != index])
    rng = np.random.default_rng((settings.seed, lap, index))
    length = ROUNDS[lap] * share
    settings = replace(
        settings,
        seconds=None if settings.seconds is None else length * settings.seconds,
        steps=None if settings.steps is None else _steps(length * settings.steps, shots, photos.shots),
        degree=own.degree,
        gain=None,
    )
    schedule = Schedule(settings.steps, settings.seconds, 0.0, own.degree, refine_start=REFINE_EVERY)
    engine = engine_for(resolve_device(settings.device), Parameters.of(around).columns())
    strategy = MCMCStrategy(max(len(own), round(share * settings.max_gaussians)), rng, GROW)
    trainer = Trainer(shots, Parameters.of(own), strategy, LR_START[lap] * photos.extent, schedule, rng, engine)
    name = f"{fitting.training_id(replace(photos, shots=tuple(shots)), settings)} round {lap} block {index}"
    record = Record() if path is None else fitting.resume(trainer, path, name)
    unseen = replace(photos, held_out=())  # they show the whole, which is measured at the end
    fitting.train(trainer, unseen, settings, record, None if path is None else (path, name), on_status)
    return _Trained(trainer.parameters.cloud(), trainer.steps, trainer.seconds)


def _steps(whole: float, parts: Sequence[Shot], shots: Sequence[Shot]) -> int:
    """As many steps with parts of photographs as make as many pixels as `whole` steps with photographs."""
    return max(1, round(whole * _pixels(shots) / _pixels(parts)))


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
        columns = {name: getattr(done.cloud, name).numpy() for name in _COLUMNS}
        values = {"name": self._name, "steps": done.steps, "seconds": done.seconds}
        checkpoint.save(path, columns, {**values, "choices": [asdict(c) for c in done.choices]})
        checkpoint.delete(under_way)
        return done

    def _read(self, path: Path, arrays: Mapping[str, Any], values: Mapping[str, Any]) -> _Trained:
        if values.get("name") != self._name:
            raise FileError(f"{path} is of another training (other photographs or settings); delete it to start over")
        try:
            cloud = GaussianCloud.create(*(torch.from_numpy(arrays[name]) for name in _COLUMNS))
            choices = tuple(Choice(**{**c, "psnr": tuple(c["psnr"])}) for c in values["choices"])
            return _Trained(cloud, int(values["steps"]), float(values["seconds"]), choices)
        except (KeyError, ValueError, TypeError) as error:
            raise FileError(f"cannot go on from {path} ({error}); delete it to start over") from error
