"""`slim_tiles`: fewer Gaussians of a scene in tiles, at most as bad as promised.

Each part is ranked and reduced alone, by views of it, as `slim` does it with a scene. The promise is then measured in
pictures of the whole, before and after, from views that chose nothing; parts that lack something get more Gaussians.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...errors import UserError
from ...slim.importance import Progress
from ...slim.loss import Loss, loss_of
from ...slim.preparing import Settings
from ...slim.views import BLACK, MIN_CAMERAS, MIN_COVER, PROBE_SIZE, RING, WHITE, View, estimated_frame
from ...viewpoints.orbit import choose_ring
from ..blocks import divided, margin_of, sampled
from ..drawing import Album
from ..making import new_folder, require_room
from ..records import row_bytes
from ..store import PIECES, Tiles, by_id
from ..window import outline
from .checking import MEASURING, Check
from .ranking import Places, Ranking

ROWS = 150_000  # of a part at most: about a room, so that its views see all of it
BYTES = 2400  # that ranking takes for a Gaussian of a part, on top of the program and the pictures
LEAST = 4096  # rows of a part, however little memory there is
_SAMPLE = 300_000  # rows by which space is divided and up is estimated


@dataclass(frozen=True, eq=False)
class SlimmedTiles:
    """A scene in tiles made smaller.

    Attributes:
        tiles: the new folder.
        ids: `[N]` int64, of each of its rows the id in the scene before.
        held_out: loss over all views that did not choose, each drawn of the whole.
        parts: loss of each part over its views; None if no view shows it, and all of it is kept.
        orbit: loss over an orbit around the whole; None if that shows nothing.
        raised: how often parts got more Gaussians for the held-out views.
        cameras: where the views come from.
        same_thing: share of the held-out pixels that show the same thing as before; None without a language field.
        views: the held-out views of the parts, and of the orbit.
    """

    tiles: Tiles
    ids: NDArray[np.int64]
    held_out: Loss
    parts: tuple[Loss | None, ...]
    orbit: Loss | None
    raised: int
    cameras: str
    same_thing: float | None
    views: tuple[View, ...]


def slim_tiles(
    tiles: Tiles,
    output: Path,
    settings: Settings,
    memory: int,
    cameras: Sequence[Camera] = (),
    force: bool = False,
    progress: Progress | None = None,
) -> SlimmedTiles:
    """Write a scene in tiles with fewer Gaussians as a folder of tiles. Same input and memory, same bytes.

    The held-out views of every part keep `settings.psnr` dB, and so does an orbit around the whole. What is kept of a
    row keeps its bytes, but for its id; harmonics keep their degree.

    Args:
        memory: bytes that a part and the work on it may take, besides the pictures of its views.
        cameras: of photographs of the scene; else its own, else computed ones.

    Raises:
        UserError: `output` exists and `force` is not set, or it is the scene itself; or an optimisation is asked for.
        FileError: a tile is torn, or a file cannot be written; there is then no new folder.
    """
    if settings.steps or settings.seconds:
        raise UserError("only a scene that fits into the memory can be optimised; leave it out")
    if output.exists() and output.resolve() == tiles.folder.resolve():
        raise UserError(f"{output} is the scene itself; write to another folder")
    say = progress or (lambda stage, share: None)
    require_room(output, len(tiles) * (row_bytes(tiles.state.degree) + 8))
    with new_folder(output, force) as folder:
        say("up and floor", 0.0)
        sample = sampled(tiles, _SAMPLE)
        known = tuple(cameras) if len(cameras) >= MIN_CAMERAS else tiles.cameras
        frame = estimated_frame(tiles.scene(by_id(sample)), known)
        margin = margin_of(sample, frame.metres_per_unit)
        division = divided(tiles, sample, margin, min(ROWS, max(LEAST, memory // BYTES)), 0.0)
        del sample
        (folder / PIECES).mkdir()
        places, album = Places(folder / PIECES, tiles, division), Album(tiles, memory)
        work = Ranking(tiles, division, places, frame, known, settings.psnr, settings.size, album)
        parts = []
        for number in range(len(division)):

            def told(stage: str, share: float, number: int = number) -> None:
                stage = f"part {number + 1} of {len(division)}: {stage}"
                say(stage, MEASURING * (number + share) / len(division))

            parts.append(work.part(number, told))
        orbit = _orbit(work)
        check = Check(work, folder, parts, orbit, memory, say)
        ids = check.kept_promise()
        del places, work
        shutil.rmtree(folder / PIECES)
        photographed = sum(part.photographed for part in parts)
    source = f"cameras of photographs for {photographed} of {len(parts)} parts" if photographed else "computed"
    losses = tuple(loss_of(own) if own else None for own in check.errors)
    return SlimmedTiles(
        Tiles.open(output), ids, loss_of([e for own in check.errors for e in own]), losses[:-1], losses[-1],
        check.raised, source, check.same_thing, tuple(view for own in check.views for view in own),
    )  # fmt: skip


def _orbit(work: Ranking) -> tuple[View, ...]:
    """Views of an orbit around the whole."""
    scene = outline(work.tiles).replace(frame=work.frame, cameras=())
    cameras = [camera for camera in choose_ring(scene).cameras(RING, work.size, work.size) if _shows(work, camera)]
    return tuple(View(camera, (BLACK, WHITE)[i % 2]) for i, camera in enumerate(cameras))


def _shows(work: Ranking, camera: Camera) -> bool:
    probe = camera.resized(PROBE_SIZE, PROBE_SIZE)
    return float(work.album.draw(probe).render.alpha.mean()) > MIN_COVER
