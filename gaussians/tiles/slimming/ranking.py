"""Ranks the Gaussians of one part of a scene in tiles, and finds how many of them keep a PSNR (`Ranking`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ...camera import Camera
from ...cloud import GaussianCloud
from ...errors import UserError
from ...render import render
from ...scene import Frame
from ...slim.counting import SLOPE, Tried, next_count
from ...slim.importance import Progress, rank
from ...slim.loss import Truth
from ...slim.reductions import protected
from ...slim.search import CLOSE, TRIES
from ...slim.views import BLACK, MIN_CAMERAS, MIN_COVER, MOST, PROBE_SIZE, WHITE, View, Views, choose_views
from .. import files
from ..blocks import Parts, part_of
from ..drawing import Album
from ..store import Tiles

CHECKED = 12  # held-out views of a part in pictures of the whole
SLOPES = 6.0, SLOPE  # dB gained by e times as many Gaussians, that a part may be measured to have
STEP = 1.02  # times as many Gaussians at least where a part gets more
MARGIN = 0.03  # dB by which a part is raised beyond what it lacks
_LOCAL = 1.3  # times in depth, within which a part is what a picture of the whole shows
_SOLID = 0.5  # alpha from which a pixel shows something
_POINTS = 2000  # of a part, by which cameras are chosen
_IN_PICTURE = 0.05  # share of them that a camera must see


@dataclass(frozen=True, eq=False)
class Part:
    """A ranked part.

    Attributes:
        rows: its Gaussians.
        least: those that are kept in any case, so that things are still found.
        count: those that are kept, the first of its order.
        slope: dB gained by e times as many.
        views: held-out views in which it shows in pictures of the whole; without one all of it is kept.
        photographed: whether the views are cameras of photographs.
    """

    rows: int
    least: int
    count: int
    slope: float
    views: tuple[View, ...]
    photographed: bool = False

    @property
    def whole(self) -> bool:
        """Whether all of it is kept."""
        return self.count >= self.rows

    def raised(self, lacking: float) -> int:
        """How many Gaussians are kept where the held-out views lack so many dB."""
        more = max(math.exp((lacking + MARGIN) / self.slope), STEP)
        return min(self.rows, math.ceil(self.count * more) + 1)


class Places:
    """For each row of a scene its place in the order of its part, on the disk: four bytes a row.

    Args:
        folder: an empty one.
    """

    def __init__(self, folder: Path, tiles: Tiles, parts: Parts) -> None:
        self._tiles, self._parts = tiles, parts
        self._places = [
            files.allocated(folder / f"{k}.places", np.dtype("<i4"), (tile.rows,))
            for k, tile in enumerate(tiles.state.tiles)
        ]

    def keep(self, tile: NDArray[np.int32], row: NDArray[np.int32], order: NDArray[np.int64]) -> None:
        """Keep the order of a part.

        Args:
            tile, row: `[N]`, where its rows are stored.
            order: `[N]`, those rows, the ones to keep first.
        """
        places = np.empty(len(order), np.int32)
        places[order] = np.arange(len(order), dtype=np.int32)
        for k in np.unique(tile).tolist():
            here = tile == k
            self._places[k][row[here]] = places[here]

    def kept(self, number: int, counts: NDArray[np.int64]) -> NDArray[np.bool_]:
        """`[rows]`: which rows of a tile are among the first `counts` `[parts]` of their parts."""
        means = np.asarray(self._tiles.column(number, "means", checked=False))
        kept: NDArray[np.bool_] = np.asarray(self._places[number]) < counts[self._parts.tree.leaf_of(means)]
        return kept


@dataclass(frozen=True)
class Ranking:
    """What all parts are ranked with.

    Attributes:
        frame: of the scene, up known or estimated.
        cameras: of photographs.
        psnr, size: see `slim.Settings`.
        album: pictures of the whole.
    """

    tiles: Tiles
    parts: Parts
    places: Places
    frame: Frame
    cameras: tuple[Camera, ...]
    psnr: float
    size: int
    album: Album

    def part(self, number: int, say: Progress) -> Part:
        """Rank a part, keep its order, and find how many of its Gaussians keep the PSNR in its own views.

        Raises:
            FileError: a tile is torn.
        """
        block = part_of(self.tiles, self.parts, number)
        cloud = block.cloud
        say("views", 0.0)
        views = self._views(cloud)
        held_out = () if views is None else self._held_out(cloud, views)
        if views is None or not held_out:
            self.places.keep(block.tile, block.row, np.arange(len(cloud)))
            return Part(len(cloud), len(cloud), len(cloud), SLOPE, ())
        found, _ = rank(cloud, views.ranking, say)
        order, least = protected(self.tiles.scene(cloud), found)
        self.places.keep(block.tile, block.row, order)
        say("search", 1.0)
        count, slope = _fewest(cloud, order, least, Truth(cloud, views.choice), self.psnr)
        return Part(len(cloud), least, count, slope, held_out, "photographs" in views.source)

    def _views(self, cloud: GaussianCloud) -> Views | None:
        """The views of a part alone; None if none shows anything."""
        scene = self.tiles.scene(cloud).replace(frame=self.frame, cameras=(), language=None)
        try:
            return choose_views(scene, seeing(cloud, self.cameras), self.size)
        except UserError:
            return None

    def _held_out(self, cloud: GaussianCloud, views: Views) -> tuple[View, ...]:
        """Evenly chosen ones of the held-out views in which the part shows in a picture of the whole."""
        shown = [view.camera for view in views.held_out if self._shows(cloud, view.camera)]
        chosen = [shown[i] for i in np.unique(np.linspace(0, len(shown) - 1, min(len(shown), CHECKED)).astype(int))]
        return tuple(View(camera, (BLACK, WHITE)[i % 2]) for i, camera in enumerate(chosen))

    def _shows(self, cloud: GaussianCloud, camera: Camera) -> bool:
        """Whether a view of a part shows it in a picture of the whole too, and not what lies before it."""
        probe = camera.resized(PROBE_SIZE, PROBE_SIZE)
        alone = render(cloud, probe)
        whole = self.album.draw(probe).render
        local = (whole.depth < alone.depth * _LOCAL) & (whole.depth * _LOCAL > alone.depth)
        return float(((alone.alpha > _SOLID) & local).float().mean()) > MIN_COVER


def seeing(cloud: GaussianCloud, cameras: Sequence[Camera]) -> tuple[Camera, ...]:
    """The cameras that have a part in their picture, those nearest to it if there are many; none if there are few."""
    if len(cameras) < MIN_CAMERAS:
        return ()
    points = cloud.means[:: max(1, len(cloud) // _POINTS)].double().numpy()
    low, high = points.min(axis=0), points.max(axis=0)
    found = []
    for index, camera in enumerate(cameras):
        local = points @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]
        z = np.where(local[:, 2] > 0, local[:, 2], np.inf)
        x, y = camera.fx * local[:, 0] / z + camera.cx, camera.fy * local[:, 1] / z + camera.cy
        inside = np.isfinite(z) & (x >= 0) & (x < camera.width) & (y >= 0) & (y < camera.height)
        if inside.mean() > _IN_PICTURE:
            away = np.linalg.norm(camera.position - np.clip(camera.position, low, high))
            found.append((float(away), index))
    nearest = sorted(index for _, index in sorted(found)[: 2 * MOST])
    return tuple(cameras[i] for i in nearest) if len(nearest) >= MIN_CAMERAS else ()


def _fewest(
    cloud: GaussianCloud, order: NDArray[np.int64], least: int, truth: Truth, target: float
) -> tuple[int, float]:
    """The fewest of the first rows of an order that keep a PSNR, and how many dB e times as many gain."""
    above: Tried | None = None
    below: Tried | None = None
    wanted: int | None = max(least, len(cloud) // 2)
    for _ in range(TRIES):
        if wanted is None:
            break
        rows = torch.from_numpy(np.sort(order[:wanted]))
        found = Tried(wanted, truth.loss(cloud[rows]).psnr)
        if found.psnr < target:
            below = found
        else:
            above = found
            if found.psnr < target + CLOSE:
                break
        wanted = next_count(above, below, target, len(cloud), least)
    slope = SLOPE
    if above is not None and below is not None and above.count > below.count:
        slope = float(np.clip((above.psnr - below.psnr) / math.log(above.count / below.count), *SLOPES))
    return (above.count if above is not None else len(cloud)), slope
