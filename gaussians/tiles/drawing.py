"""Renders a folder of tiles exactly: tiles in the view, in slabs of depth, every Gaussian in one order by depth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import torch

from ..camera import Camera, Render, Vec3
from ..render import convention
from .records import Tile
from .store import Tiles
from .window import centres

_COLUMNS = ("means", "quats", "scales", "opacities", "sh", "group")
_LEAST, _MOST = 1 << 18, 1 << 23  # footprints of a slab
_SHARE = 3  # of the memory one part is for the footprints of a slab
_MARGIN = 1e-4  # relative, of depths in float32
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Drawing:
    """A rendered picture and what it took.

    Attributes:
        render: the picture.
        tiles: tiles in the view, of `of`.
        gaussians: footprints drawn.
        slabs: of depth that it was drawn in.
        read: tiles read, those that lie in several slabs once for each.
    """

    render: Render
    tiles: int
    of: int
    gaussians: int
    slabs: int
    read: int

    def text(self) -> str:
        """A sentence for a person."""
        return (
            f"{self.tiles} of {self.of} tiles in view, {self.gaussians:,} Gaussians drawn in {self.slabs} "
            f"slab{'s' * (self.slabs != 1)} of depth, exactly (no level of detail)"
        )


class Album:
    """Pictures of one scene in tiles, whose near plane is measured and whose tiles are compared with their hashes once.

    Args:
        memory: bytes that footprints and tiles may take, roughly.
    """

    def __init__(self, tiles: Tiles, memory: int = 4 << 30) -> None:
        from ..render.cpu.slabs import BYTES

        self.tiles = tiles
        self._room = int(np.clip(memory // (_SHARE * BYTES), _LEAST, _MOST))
        self._near = near_plane(tiles)
        self._checked: set[int] = set()

    def draw(
        self,
        camera: Camera,
        background: Vec3 = (0.0, 0.0, 0.0),
        progress: Progress = lambda stage, share: None,
    ) -> Drawing:
        """Render the scene as `gaussians.render.render` would render all of it at once.

        Raises:
            FileError: a tile in the view is torn.
        """
        from ..render.cpu.slabs import Canvas

        tiles, checked = self.tiles, self._checked
        canvas = Canvas(camera, self._near, min(self._room, max(len(tiles), 1)))
        waiting = sorted(_in_view(tiles, camera, self._near))
        seen, read = len(waiting), 0
        while waiting and not canvas.finished:
            for nearest, _, number in waiting:
                if nearest > canvas.ends[0]:
                    break
                progress("drawing", 1 - len(waiting) / max(seen, 1))
                columns = [tiles.column(number, name, number not in checked) for name in (*_COLUMNS, "ids")]
                checked.add(number)
                *shown, ids = (np.array(column) for column in columns)  # kernels are compiled for what can be written
                canvas.add(tuple(shown), ids)
                read += 1
            canvas.draw()
            waiting = [tile for tile in waiting if tile[1] >= canvas.begins[0]]
        out = canvas.picture(background, camera)
        render = Render(*map(torch.from_numpy, out))
        return Drawing(render, seen, len(tiles.state.tiles), canvas.drawn, canvas.slabs, read)


def draw(
    tiles: Tiles, camera: Camera, background: Vec3 = (0.0, 0.0, 0.0), *, memory: int = 4 << 30,
    progress: Progress = lambda stage, share: None,
) -> Drawing:  # fmt: skip
    """One picture of a scene in tiles; see `Album`.

    Raises:
        FileError: a tile in the view is torn.
    """
    return Album(tiles, memory).draw(camera, background, progress)


def near_plane(tiles: Tiles) -> float:
    """Distance of the near plane, scene units, by the same sample of centres as in memory."""
    return convention.near_plane(centres(tiles, convention.sample_step(len(tiles))))


def _in_view(tiles: Tiles, camera: Camera, near: float) -> Iterator[tuple[float, float, int]]:
    """The tiles that a picture may show: nearest and farthest depth of their centres, and number."""
    for number, tile in enumerate(tiles.state.tiles):
        if tile.rows and (depths := _depths_in_view(tile, camera, near)) is not None:
            yield (*depths, number)


def _depths_in_view(tile: Tile, camera: Camera, near: float) -> tuple[float, float] | None:
    """Nearest and farthest depth of the centres of a tile; None if it surely lies outside the picture.

    The sides are compared only where all of the tile is before the near plane; there a centre's footprint reaches no
    further than that of an opaque ball of the tile's largest standard deviation (see `project._outside_image`).
    """
    box = np.array([tile.low, tile.high])
    corners = np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1).reshape(8, 3)
    local = corners @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]
    z = local[:, 2]
    slack = _MARGIN * float(np.abs(local).max() + np.abs(camera.position).max() + np.abs(box).max())
    nearest, farthest = float(z.min()) - slack, float(z.max()) + slack
    if farthest <= near:
        return None
    if nearest > near:
        for axis, focal, center, side in (
            (0, camera.fx, camera.cx, camera.width),
            (1, camera.fy, camera.cy, camera.height),
        ):
            place = focal * local[:, axis] / z + center
            reach = _reach(focal, tile.largest / nearest, side, center) + 1.0
            if place.max() + reach < 0 or place.min() - reach > side:
                return None
    return max(nearest, 0.0), farthest


def _reach(focal: float, ratio: float, side: int, center: float) -> float:
    """Pixels that the footprint of an opaque ball reaches at most; `ratio` is its standard deviation over its depth."""
    tangent = (max(center, side - center) + convention.EDGE * side) / focal
    variance = (focal * ratio) ** 2 * (1 + tangent * tangent) + convention.DILATION
    return float(np.sqrt(2.1 * np.log(1 / convention.ALPHA_MIN) * variance))
