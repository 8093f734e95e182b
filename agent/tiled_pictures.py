"""Pictures of a scene in tiles on the command line."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .terminal.output import terminal

if TYPE_CHECKING:
    from ..gaussians.camera import Camera, Render, Vec3
    from ..gaussians.scene import Scene
    from ..gaussians.tiles.drawing import Drawing
    from ..gaussians.tiles.store import Tiles


@dataclass(eq=False)
class DrawnTiles:
    """A scene in tiles, of which each picture reads the tiles in its view.

    Attributes:
        tiles: the scene.
        memory: bytes that drawing may take.
        drawings: what the pictures so far took.
    """

    tiles: Tiles
    memory: int
    drawings: list[Drawing] = field(default_factory=list)
    KEY = "tiles"

    @classmethod
    def of(cls, path: Path, backend: str) -> DrawnTiles:
        """Open a scene.

        Raises:
            UserError: another renderer than that for tiles is asked for.
            FileError: it cannot be read.
        """
        from ..gaussians.errors import UserError
        from ..gaussians.tiles.budget import memory
        from ..gaussians.tiles.store import Tiles

        if backend not in ("auto", "cpu"):
            raise UserError(f"tiles are drawn by the cpu renderer, not by {backend!r}; leave out --backend")
        return cls(Tiles.open(path), memory())

    def scene(self) -> Scene:
        """Some Gaussians of each part of the scene, by which views are chosen."""
        from ..gaussians.tiles.window import outline

        return outline(self.tiles)

    def render(self, camera: Camera, background: Vec3, backend: str) -> Render:
        """A picture of the whole scene."""
        from ..gaussians.tiles.drawing import draw

        drawn = draw(self.tiles, camera, background, memory=self.memory, progress=terminal.progress)
        self.drawings.append(drawn)
        return drawn.render

    def data(self) -> dict[str, Any]:
        """What the last picture was drawn of."""
        last = self.drawings[-1]
        return {"in_view": last.tiles, "of": last.of, "gaussians": last.gaussians, "slabs": last.slabs, "exact": True}

    def text(self) -> str:
        return self.drawings[-1].text()
