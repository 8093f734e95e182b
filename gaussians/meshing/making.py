"""A scene, or a part of it, as a textured mesh (`mesh`)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from ..camera import Camera
from ..cloud import GaussianCloud
from ..errors import UserError
from ..files import writing
from ..rotations import to_matrix
from ..rows import mask_of_ids
from ..scene import Frame, Scene
from . import glb, outlines, texturing
from .shaping import Grid, Shape, shape_of, sphere_cameras

F64 = NDArray[np.float64]
Progress = Callable[[str, float], None]

PER_SIGMA = 0.7  # cell over a typical Gaussian's middle standard deviation
LEAST_CELLS, MOST_CELLS = 24, 160  # along the longest side, unless asked for
VIEWS = 64  # around the part
INSIDE = 48  # more of a whole scene: its own cameras, and computed ones within it
OUTLINED = 2  # every second of the views around the part fits its outlines
FARTHEST = 0.5  # cells that this moves a vertex
PER_CELL = 2.2  # pixels of a view
MOST_PIXELS = 512
TEXTURE = 1024
LEVEL = 0.5  # share of the light that is left at the surface
FAINT = 0.02  # opacity below which a Gaussian does not widen the grid
SPREAD = 1.5  # standard deviations that a Gaussian reaches
STRAY = 0.25  # of the extent, beyond which a Gaussian is a floater
OUTER = 0.01  # share of the Gaussians at each end of each axis that do not define the extent
LARGEST = 4096  # texels per side: solving for more takes gigabytes
_MARGIN = 4  # cells around the part


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh with colours, in the scene's own place.

    Attributes:
        vertices: `[V, 3]` float64, world, scene units; a vertex on a seam of the texture is there several times.
        faces: `[F, 3]` int64, counter-clockwise seen from outside.
        uv: `[V, 2]` from the texture's top-left corner, or None.
        texture: `[H, W, 3]` display colours, 0 to 1, or None.
        colors: `[V, 3]` display colours of the vertices where there is no texture, or None.
        to_file: `[4, 4]`, from world to the file: metres, y up, what faces -y in a scene with z up faces +z.
        closed: whether every edge has two faces.
        cell: scene units, side of the grid's cells.
        gaussians: number of Gaussians that it was made of.
        name: of the object in the file.
    """

    vertices: F64
    faces: NDArray[np.int64]
    uv: F64 | None
    texture: F64 | None
    colors: F64 | None
    to_file: F64
    closed: bool
    cell: float
    gaussians: int
    name: str

    @property
    def placed(self) -> F64:
        """`[V, 3]`, the vertices in the file: metres, y up."""
        return self.vertices @ self.to_file[:3, :3].T + self.to_file[:3, 3]

    @property
    def size(self) -> F64:
        """`[3]` width, height and depth in the file, metres."""
        return np.ptp(self.placed, axis=0)

    @property
    def scale(self) -> float:
        """Metres per scene unit."""
        return float(np.linalg.norm(self.to_file[0, :3]))

    def encode(self) -> bytes:
        """The bytes of a .glb file: metres, y up; equal meshes give equal bytes."""
        return glb.encode(self.placed, self.faces, self.uv, self.texture, self.colors, self.name, not self.closed)

    def save(self, path: str | Path, force: bool = False) -> None:
        """Write a .glb file.

        Raises:
            UserError: the name does not end in ".glb", or the file exists and `force` is not set.
            FileError: it cannot be written.
        """
        check(Path(path), None, 0, None)
        data = self.encode()
        with writing(path, force) as file:
            file.write(data)


def check(path: Path | None, faces: int | None, texture: int, cells: int | None) -> None:
    """Check what `mesh` is asked for before any work, and that a mesh can be written under this name.

    Raises:
        UserError: an argument is out of range, or the suffix is not ".glb".
        BackendError: a texture is asked for and xatlas is not installed.
    """
    if path is not None and path.suffix.lower() != ".glb":
        raise UserError(f"meshes are written as .glb; name it {path.with_suffix('.glb').name}")
    if faces is not None and faces < 4:
        raise UserError(f"a mesh has at least 4 faces, not {faces}")
    if texture != 0 and not 16 <= texture <= LARGEST:
        raise UserError(f"the texture's side must be 0 (none) or 16 to {LARGEST} texels, not {texture}")
    if cells is not None and not 8 <= cells <= 512:
        raise UserError(f"the grid must have 8 to 512 cells, not {cells}")
    if texture:
        texturing.check_installed()


def mesh(
    scene: Scene | GaussianCloud,
    ids: Tensor | ArrayLike | None = None,
    *,
    faces: int | None = None,
    texture: int = TEXTURE,
    watertight: bool = False,
    cells: int | None = None,
    in_place: bool = False,
    name: str = "scene",
    progress: Progress | None = None,
) -> Mesh:
    """A scene, or the Gaussians with these ids, as a mesh with a texture.

    Views all around see which space is free; what is not is filled, and its surface becomes triangles. A thing without
    an inside, as a wall or a leaf, becomes a sheet of about a cell's thickness. The same input gives the same bytes.

    Args:
        ids: `[M]` whole numbers, of the Gaussians, as `Selection.ids`; None: all.
        faces: triangles at most; None: as many as the shape needs.
        texture: texels per side of the texture, which needs the extra "mesh"; 0: colours of the vertices instead.
        watertight: keep the faces that no view sees, so that every edge has two faces.
        cells: of the grid along the longest side; None: as the size of the Gaussians asks for.
        in_place: keep the scene's origin; otherwise the mesh stands on its own, centred.
        progress: called with what is done and the share that is.

    Raises:
        UserError: nothing is selected, the ids are none, it is too faint, or an argument is out of range.
        BackendError: a texture is asked for and xatlas is not installed.
    """
    check(None, faces, texture, cells)
    named = None if ids is None else _whole(ids)
    told = progress or (lambda text, share: None)
    whole = scene if isinstance(scene, Scene) else Scene(scene)
    cloud = whole.cloud if named is None else whole.cloud[mask_of_ids(whole.cloud.ids, named)]
    if not len(cloud):
        raise UserError("nothing is selected, so there is nothing to make a mesh of")
    part = near_middle(cloud.to("cpu"))
    grid = grid_of(part, cells)
    cameras = cameras_of(part, grid, whole if ids is None else None)
    told("looking from all sides", 0.1)
    shape = shape_of(part, cameras, grid, LEVEL, faces)
    shape = outlines.fitted(shape, part, cameras[:VIEWS:OUTLINED], FARTHEST * grid.step)
    told("mesh made", 0.5)
    if not watertight:
        shape = texturing.without_hidden(shape, cameras)
    to_file = _placement(shape, whole.frame, in_place)
    if not texture:
        colors = texturing.vertex_colors(shape, part, cameras)
        return Mesh(shape.vertices, shape.faces, None, None, colors, to_file, watertight, grid.step, len(cloud), name)
    atlas = texturing.unwrap(shape, texture)
    told("texture", 0.7)
    picture = texturing.texture_of(shape, atlas, part, cameras, texture)
    vertices = shape.vertices[atlas.source]
    return Mesh(vertices, atlas.faces, atlas.uv, picture, None, to_file, watertight, grid.step, len(cloud), name)


def _whole(ids: Tensor | ArrayLike) -> Tensor:
    """Ids `[M]` int64. Raises UserError if they are no whole numbers."""
    try:
        found = ids if isinstance(ids, Tensor) else torch.from_numpy(np.array(ids))
    except (TypeError, ValueError):
        found = torch.zeros(0, dtype=torch.bool)
    if not found.numel() and found.dtype != torch.bool:
        return found.reshape(-1).long()
    if found.dtype == torch.bool or found.is_floating_point() or found.is_complex():
        raise UserError(
            "the ids of a mesh are whole numbers, as `session.select(...).ids`; of a mask take scene.cloud.ids[mask]"
        )
    return found.reshape(-1).long()


def near_middle(cloud: GaussianCloud) -> GaussianCloud:
    """The Gaussians without non-finite ones and without floaters far outside the others.

    Raises:
        UserError: none is left.
    """
    finite = torch.isfinite(cloud.means).all(dim=1) & torch.isfinite(cloud.scales).all(dim=1)
    finite &= torch.isfinite(cloud.quats).all(dim=1) & (cloud.scales > 0).all(dim=1)
    cloud = cloud[finite]
    if not len(cloud):
        raise UserError("every selected Gaussian has a value that is not finite; there is nothing to make a mesh of")
    means = cloud.means.numpy().astype(np.float64)
    low, high = np.quantile(means, OUTER, axis=0), np.quantile(means, 1 - OUTER, axis=0)
    slack = STRAY * float((high - low).max()) + 3 * float(cloud.scales.max(dim=1).values.median())
    return cloud[torch.from_numpy(((means > low - slack) & (means < high + slack)).all(axis=1))]


def extent(cloud: GaussianCloud) -> tuple[F64, F64]:
    """Lowest and highest corner of what Gaussians reach, world."""
    means, scales = cloud.means.numpy().astype(np.float64), cloud.scales.numpy().astype(np.float64)
    axes = to_matrix(cloud.quats).numpy().astype(np.float64)
    reach = SPREAD * np.sqrt(np.einsum("nij,nj->ni", axes**2, scales**2))
    # One huge faint Gaussian must not take the grid from the others.
    reach = np.minimum(reach, 4 * np.median(reach.max(axis=1)))
    solid = cloud.opacities.numpy() > FAINT
    if not solid.any():
        solid[:] = True
    return (means - reach)[solid].min(axis=0), (means + reach)[solid].max(axis=0)


def grid_of(cloud: GaussianCloud, cells: int | None) -> Grid:
    """A grid around Gaussians; without `cells` the cells follow the Gaussians' size."""
    low, high = extent(cloud)
    longest = float((high - low).max())
    if cells is None:
        middle = float(cloud.scales.median(dim=1).values.median())
        cells = int(np.clip(math.ceil(longest / (PER_SIGMA * middle)), LEAST_CELLS, MOST_CELLS))
    step = longest / cells
    shape = np.ceil((high - low) / step).astype(int) + 2 * _MARGIN + 1
    return Grid(low - _MARGIN * step, step, (int(shape[0]), int(shape[1]), int(shape[2])))


def cameras_of(cloud: GaussianCloud, grid: Grid, scene: Scene | None) -> list[Camera]:
    """Cameras of one size all around the grid; with a whole `scene` also its own and some within it."""
    low, high = grid.low + _MARGIN * grid.step, grid.low + (np.array(grid.shape) - 1 - _MARGIN) * grid.step
    radius = float(np.linalg.norm(high - low)) / 2
    size = int(np.clip(PER_CELL * 2 * radius / grid.step, 64, MOST_PIXELS))
    cameras = sphere_cameras((low + high) / 2, radius, VIEWS, size)
    if scene is None:
        return cameras
    from ..viewpoints.coverage import choose_views

    inside = choose_views(scene, INSIDE, size).cameras
    return cameras + [camera.resized(size, size) for camera in inside]


def _placement(shape: Shape, frame: Frame, in_place: bool) -> F64:
    """`[4, 4]` from world to the file, see `Mesh.to_file`."""
    scale = frame.metres_per_unit or 1.0
    local = shape.vertices @ frame.basis().T * scale
    low, high = local.min(axis=0), local.max(axis=0)
    foot = np.zeros(3) if in_place else np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    y_up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = scale * y_up @ frame.basis(), -y_up @ foot
    return made
