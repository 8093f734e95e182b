"""The chat on a scene in tiles: edits are in its folder at once, and pictures are drawn of the tiles in view."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from .chat import Chat, picture_size
from .halfblocks import depth_of, draw

if TYPE_CHECKING:
    from ...gaussians.language.query.selection import Selection
    from ..session.tiled import TiledSession

_WHOLE = "needs the whole scene in memory: write it to a .ply with /save, and chat with that"


class TiledChat(Chat):
    """One chat on a scene in tiles.

    What only works on a scene in memory says so and what to do instead.
    """

    session: TiledSession
    elsewhere: ClassVar[Mapping[str, str]] = {
        "/preview": "/preview compares pictures of the whole scene in memory; /plan TEXT says what would be done, and "
        "/undo takes it back",
        "/replay": f"/replay {_WHOLE}",
        "/export": 'write a selection with: scenewright select NAME.tiles "the red chair" --save chair.glb',
        "/time": "a scene in tiles stands still: it has no time",
        "/grow": f"/grow {_WHOLE}",
        "/shrink": f"/shrink {_WHOLE}",
        "/invert": f"/invert {_WHOLE}",
    }

    @property
    def unsaved(self) -> bool:
        """Never: edits are in the folder when their answer is shown."""
        return False

    def say(self, line: str) -> None:
        """See `Chat.say`."""
        self.session.look_away()
        super().say(line)

    def show_picture(self, doubted: Selection | None = None) -> None:
        """See `Chat.show_picture`; what is asked about is shown without what is around it."""
        if doubted is not None:
            super().show_picture(doubted)
            return
        from ...gaussians.tiles.drawing import draw as draw_tiles
        from ...gaussians.viewpoints.coverage import fit_camera

        columns, rows, width, height = picture_size()
        camera = fit_camera(self.session.viewer, width, height)
        drawn = draw_tiles(self.session.tiles, camera, memory=self.session.memory)
        self.terminal.picture(draw(drawn.render.to_uint8(), columns, rows, depth_of(self.terminal.out)))

    def _greet(self) -> None:
        tiles = self.session.tiles
        self.terminal.say(
            f"{tiles.folder.name}: {len(tiles):,} Gaussians in {len(tiles.state.tiles)} tiles. Say what to change, or "
            "ask; edits are in the folder at once. /help lists more."
        )
        self.show_picture()
