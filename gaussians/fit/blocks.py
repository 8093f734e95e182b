"""Fit a large capture by blocks: everything with few bands first, then each block of space alone, in rounds.

A block is a cell of space. Its Gaussians are trained on the parts of the photographs that show it, between pictures of
what is in front of it and behind it (`layers`), which stays as it is. All of it is one training with one schedule: the
first part trains everything, the others go on from there block by block, with the optimiser's moments; each round draws
what is around a block anew, so that blocks meet without seams. A coarse fit first and blocks among it afterwards is the
scheme of CityGaussian (Liu et al. 2024).

A step draws and optimises one block; what it costs is a share of what a step of everything costs.
"""

from __future__ import annotations

import contextlib
import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
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
from .layers import Layers
from .parameters import Parameters
from .photographs.photos import MIN_PHOTOS, Photos
from .quality import measure
from .train import REFINE_STOP, Schedule, Shot, Trainer, morton_order

MOST_BLOCKS = 256
PER_BLOCK = 500_000  # Gaussians of a block at most, if the number of blocks is chosen by itself
COARSE = 0.4  # share of the training after which it goes on by blocks
COARSE_DEGREE = 1  # of the harmonics until then: 368 bytes a Gaussian with moments and gradient, 944 with degree 3
ROUNDS = ((COARSE, REFINE_STOP), (REFINE_STOP, 1.0))  # the parts of the training that go over the blocks
VISITS = 2  # of each photograph in a round at least: a short training uses fewer photographs, as layers take time
LAYERS = 0.25  # of a block's seconds at most in which its layers are drawn
GROW = 0.25  # of a block's Gaussians added per refinement: there are fewer of them than in a whole training
MARGIN = 8  # pixels around a block's part of a photograph
SMALLEST = 24  # pixels; photographs that show less of a block are not its business
SEEN = 0.01  # of a photograph that must show a block
COARSER = 4  # times larger are the pixels in which the parts of photographs are found
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
        settings: of the whole; everything together gets `COARSE` of its length, the blocks the rest. Counted in
            steps, each block makes as many of the rest as photographs show it; in seconds, blocks divide them.
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
    backend = "auto" if resolve_device(settings.device) == "cpu" else "cuda"
    for lap, (first, last) in enumerate(ROUNDS):
        parts = parts_of(photos.shots, parameters.cloud(), division)
        efforts = _efforts(parts, shares, photos.shots)
        for i, cell in enumerate(division):
            length = (last - first) * efforts[i]
            status = _share_of(on_status, first + (last - first) * sum(efforts[:i]), length)
            inside = cell.holds(parameters.means)
            own = parameters.only(np.flatnonzero(inside))
            parameters.take(np.flatnonzero(~inside))
            around = partial(among, own=i, division=division, backend=backend)
            turn = _Turn(lap, i, shares[i], efforts[i], tuple(parts[i]), around)
            task = partial(_block, own, parameters, turn, photos, settings, status)
            done = kept.part(f"round-{lap + 1}-block-{i + 1}", task)
            parameters = Parameters.joined([parameters, done.parameters])
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
        camera = smaller(shot.camera, COARSER)
        seen = render(cloud, camera)
        points = points_seen(camera, seen.depth.numpy())
        there = seen.alpha.numpy() > 0.5
        for cell, parts in zip(division, found, strict=True):
            box = _rectangle(there & cell.holds(points), shot.camera)
            if box is not None:
                parts.append(cropped(shot, *box))
    return found


def among(
    parts: Sequence[Shot], others: GaussianCloud, own: int, division: Sequence[Cell], backend: str = "auto"
) -> list[Shot]:
    """Parts of photographs with what is around a cell in each.

    Args:
        others: all Gaussians outside the cell.
        own: index of the cell in its division.
        backend: that draws them, see `render`.
    """
    home = np.argmax([cell.holds(others.means.numpy()) for cell in division], axis=0)
    ahead = [tuple(k for k, c in enumerate(division) if hides(c, division[own], p.camera.position)) for p in parts]
    found: dict[int, Shot] = {}
    for hiding in sorted(set(ahead)):
        rows = torch.from_numpy(np.isin(home, hiding))
        before, behind = others[rows], others[~rows]
        for i in (i for i, these in enumerate(ahead) if these == hiding):
            front, back = (render(cloud, parts[i].camera, backend=backend) for cloud in (before, behind))
            layers = Layers.of(front.rgb.numpy(), front.alpha.numpy(), back.rgb.numpy(), parts[i].share)
            found[i] = replace(parts[i], around=layers)
    return [found[i] for i in range(len(parts))]


def hides(cell: Cell, other: Cell, eye: NDArray[np.float64]) -> bool:
    """Whether rays from `eye` that meet both cells of a division meet `cell` first; False if none meets both."""
    ahead = ((cell.high <= other.low) & (eye < cell.high)) | ((cell.low >= other.high) & (eye >= cell.low))
    behind = ((other.high <= cell.low) & (eye < other.high)) | ((other.low >= cell.high) & (eye >= other.low))
    return bool(ahead.any() and not behind.any())


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
    part = np.ascontiguousarray(shot.photo[top:bottom, left:right])
    return replace(shot, camera=camera, photo=part, share=part.size / shot.photo.size)


def smaller(camera: Camera, times: int) -> Camera:
    """A camera with so many times larger pixels; some of the last rows and columns are left out."""
    c, width, height = camera, max(1, camera.width // times), max(1, camera.height // times)
    fx, fy, cx, cy = c.fx / times, c.fy / times, c.cx / times, c.cy / times
    return Camera(c.world_to_camera, fx, fy, cx, cy, width, height, c.name)


def _rectangle(mask: NDArray[np.bool_], camera: Camera) -> tuple[int, int, int, int] | None:
    """Left, top, right, bottom of the part of a photograph around a mask `[H, W]` of larger pixels; None if few."""
    y, x = np.nonzero(mask)
    if len(x) <= SEEN * mask.size:
        return None
    (left, right), (top, bottom) = (COARSER * np.quantile(v, [TRIM, 1 - TRIM]).astype(int) for v in (x, y))
    left, top = max(0, int(left) - MARGIN), max(0, int(top) - MARGIN)
    right = min(camera.width, int(right) + COARSER + MARGIN)
    bottom = min(camera.height, int(bottom) + COARSER + MARGIN)
    return None if min(right - left, bottom - top) < SMALLEST else (left, top, right, bottom)


def _efforts(parts: Sequence[Sequence[Shot]], shares: Sequence[float], shots: Sequence[Shot]) -> list[float]:
    """The share of a round that each block gets: by its photographs, and what a step costs, which is about as its share
    of the Gaussians and that of a photograph's pixels."""
    whole = _pixels(shots)
    costs = [len(p) * (share + _pixels(p) / whole) if p else 0.0 for p, share in zip(parts, shares, strict=True)]
    return [cost / max(sum(costs), 1e-9) for cost in costs]


@dataclass(frozen=True, eq=False)
class _Trained:
    """A finished part of the training, with its optimisers, and what it took."""

    parameters: Parameters
    steps: int
    seconds: float


def _coarse(photos: Photos, settings: Settings, on_status: Callable[[Status], None], path: Path | None) -> _Trained:
    """The beginning of the training, of everything."""
    rng, most = np.random.default_rng(settings.seed), settings.max_gaussians
    start, strategy = Parameters.of(initial_cloud(photos, most, rng)), MCMCStrategy(most, rng)
    few = COARSE_DEGREE if settings.degree == "auto" else min(COARSE_DEGREE, settings.degree)
    seconds, steps = settings.seconds, settings.steps
    shorter = replace(
        settings, degree=few, seconds=None if seconds is None else COARSE * seconds,
        steps=None if steps is None else max(1, round(COARSE * steps)),
    )  # fmt: skip
    return _trained(photos, photos.shots, start, strategy, rng, shorter, (0.0, COARSE), on_status, path)


@dataclass(frozen=True, eq=False)
class _Turn:
    """A block's part in a round.

    Attributes:
        lap: of `ROUNDS`.
        index: of the block.
        share: of the Gaussians.
        effort: share of the round's seconds.
        parts: of the photographs, that show it.
        among: adds what is around the block to parts, of all other Gaussians.
    """

    lap: int
    index: int
    share: float
    effort: float
    parts: tuple[Shot, ...]
    among: Callable[[Sequence[Shot], GaussianCloud], list[Shot]]


def _block(
    own: Parameters, others: Parameters, turn: _Turn, photos: Photos, settings: Settings,
    on_status: Callable[[Status], None], path: Path | None,
) -> _Trained:  # fmt: skip
    """One block trained while the others stay as they are."""
    if len(turn.parts) < MIN_PHOTOS or not len(own):
        return _Trained(own, 0, 0.0)
    first, last = ROUNDS[turn.lap]
    rng = np.random.default_rng((settings.seed, turn.lap, turn.index))
    strategy = MCMCStrategy(max(len(own), round(turn.share * settings.max_gaussians)), rng, GROW)
    strategy.opacity_reg *= turn.share  # means over a block's Gaussians; in a training of all they weigh as much less
    strategy.scale_reg *= turn.share
    if settings.steps is not None:
        steps = max(1, round((last - first) * settings.steps * len(turn.parts) / len(photos.shots)))
        shots = turn.among(_some(turn.parts, steps // VISITS, turn.lap), others.cloud())
        shorter = replace(settings, steps=steps)
    else:
        seconds = (last - first) * turn.effort * (settings.seconds or 0.0)
        shots, taken = _within(LAYERS * seconds, turn, others.cloud())
        shorter = replace(settings, seconds=max(seconds - taken, 0.5 * seconds))
    return _trained(photos, shots, own, strategy, rng, shorter, (first, last), on_status, path)


def _within(seconds: float, turn: _Turn, others: GaussianCloud) -> tuple[list[Shot], float]:
    """As many photographs with what is around a block as are drawn in about so many seconds; what they took."""
    started = time.perf_counter()
    turn.among(_some(turn.parts, MIN_PHOTOS, turn.lap), others)
    each = (time.perf_counter() - started) / MIN_PHOTOS
    shots = turn.among(_some(turn.parts, int(seconds / each), turn.lap), others)
    return shots, time.perf_counter() - started


def _some(parts: Sequence[Shot], count: int, lap: int) -> list[Shot]:
    """So many photographs, but `MIN_PHOTOS` at least, evenly spaced; others in the next round."""
    count = min(len(parts), max(MIN_PHOTOS, count))
    return [parts[(i * len(parts) + lap * len(parts) // 2) // count % len(parts)] for i in range(count)]


def _trained(
    photos: Photos,
    shots: Sequence[Shot],
    start: Parameters,
    strategy: MCMCStrategy,
    rng: np.random.Generator,
    settings: Settings,
    part: tuple[float, float],
    on_status: Callable[[Status], None],
    path: Path | None,
) -> _Trained:
    """A part of the training, on some photographs.

    Args:
        settings: with the length of this part.
        part: where in the whole training it begins and ends.
        path: of its checkpoint.
    """
    degree = held_out_choice.MAX_DEGREE if settings.degree == "auto" else settings.degree
    schedule = Schedule(settings.steps, settings.seconds, settings.coarse, degree, first=part[0], last=part[1])
    engine = engine_for(resolve_device(settings.device))
    trainer = Trainer(shots, start, strategy, photos.extent, schedule, rng, engine)
    name = f"{fitting.training_id(replace(photos, shots=tuple(shots)), settings)} {part}"
    record = Record() if path is None else fitting.resume(trainer, path, name)
    whole = replace(photos, held_out=())  # they show everything, which is measured at the end
    unreduced = replace(settings, gain=None, degree=degree)
    fitting.train(trainer, whole, unreduced, record, None if path is None else (path, name), on_status)
    return _Trained(trainer.parameters, trainer.steps, trainer.seconds)


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
