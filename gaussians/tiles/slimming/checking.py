"""Measures the promise in pictures of the whole scene before and after, and keeps more where something lacks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera, Render
from ...slim.importance import Progress
from ...slim.loss import decibels, loss_of
from ...slim.report import SOLID
from ...slim.views import View
from ..drawing import Album
from ..store import Tiles
from .ranking import Part, Ranking
from .writing import write_kept

RAISES = 8  # times that parts get more Gaussians before those that lack something are kept whole
MOST = 6.0  # dB by which a part is raised at once
SHARE = 0.05  # of the error of some views, from which a part is to blame for it
MEASURING = 0.75  # share of the progress before


class Check:
    """The check of some ranked parts.

    Attributes:
        views: held-out ones of each part, and those of the orbit, last.
        errors: mean squared error of each of these.
        raised: how often parts got more Gaussians.
    """

    def __init__(
        self, work: Ranking, folder: Path, parts: list[Part], orbit: tuple[View, ...], memory: int, say: Progress
    ) -> None:
        self._work, self._folder, self._parts, self._memory, self._say = work, folder, parts, memory, say
        self.views = [*(part.views for part in parts), orbit]
        self.errors: list[list[float]] = [[] for _ in self.views]
        self.raised = 0
        self._things = np.zeros((len(self.views), 2), np.int64)  # pixels of the same thing, of those with one
        self._blame = [dict[int, tuple[float, int]]() for _ in self.views]  # squared error and pixels, by part
        field = work.tiles.field
        groups = () if field is None else field.groups
        self._owner = np.array([*(g.parent if g.parent >= 0 else g.id for g in groups), -1])

    @property
    def same_thing(self) -> float | None:
        """Share of the pixels that show a thing and show the same after; None without a language field."""
        same, shown = self._things.sum(axis=0).tolist()
        return same / shown if shown and self._work.tiles.field is not None else None

    def kept_promise(self) -> NDArray[np.int64]:
        """Write the smallest folder found that keeps the promise; returns the ids of its rows in the scene.

        Raises:
            FileError: a tile is torn, or a file cannot be written.
        """
        ids = self._write()
        every = list(range(len(self.views)))
        waiting = every
        while True:
            self._measure(waiting)
            lacking = [k for k in waiting if self.errors[k] and loss_of(self.errors[k]).psnr < self._work.psnr]
            if not lacking and waiting == every:
                return ids
            if lacking:
                self._raise(lacking)
                ids = self._write()
            waiting = lacking or every

    def _raise(self, lacking: list[int]) -> None:
        """Keep more of the parts that are to blame for what some views lack."""
        self.raised += 1
        needs = dict[int, float]()
        for k in lacking:
            total = sum(error for error, _ in self._blame[k].values())
            for number, (error, pixels) in self._blame[k].items():
                need = self._work.psnr - float(decibels(error / pixels))
                if need > 0 and error > SHARE * total and not self._parts[number].whole:
                    needs[number] = max(needs.get(number, 0.0), min(need, MOST))
        if not needs:  # nothing that shows is to blame
            needs = {k: MOST for k, part in enumerate(self._parts) if not part.whole}
        for k, need in needs.items():
            part = self._parts[k]
            self._parts[k] = replace(part, count=part.raised(need) if self.raised <= RAISES else part.rows)

    def _write(self) -> NDArray[np.int64]:
        self._say("writing", MEASURING)
        tiles = self._work.tiles
        counts = np.array([part.count for part in self._parts], np.int64)
        kept = [self._work.places.kept(k, counts) for k in range(len(tiles.state.tiles))]
        return write_kept(tiles, kept, self._folder)

    def _measure(self, numbers: list[int]) -> None:
        """Draw some of the views before and after."""
        after = Album(Tiles.open(self._folder), self._memory)
        total, done = sum(len(self.views[k]) for k in numbers), 0
        for k in numbers:
            self.errors[k], self._things[k], self._blame[k] = [], 0, {}
            for view in self.views[k]:
                self._say("measuring", MEASURING + (1 - MEASURING) * done / max(total, 1))
                done += 1
                old = self._work.album.draw(view.camera, view.background).render
                new = after.draw(view.camera, view.background).render
                error = (new.rgb.clamp(0, 1).numpy() - old.rgb.clamp(0, 1).numpy()).astype(np.float64) ** 2
                self.errors[k].append(float(error.mean()))
                self._things[k] += self._same(old, new)
                self._count(k, view.camera, old, error.mean(axis=-1))

    def _same(self, old: Render, new: Render) -> tuple[int, int]:
        """Pixels that show a thing in both pictures, the same one, and pixels that show one in the first."""
        was, now = self._owner[old.group.numpy()], self._owner[new.group.numpy()]
        seen = (old.alpha > SOLID).numpy() & (was >= 0)
        return int((was == now)[seen].sum()), int(seen.sum())

    def _count(self, number: int, camera: Camera, old: Render, error: NDArray[np.float64]) -> None:
        """Add the error `[H, W]` of a picture to the parts whose surfaces its pixels show."""
        solid = (old.alpha > SOLID).numpy()
        depth = old.depth.numpy()[solid].astype(np.float64)
        y, x = np.nonzero(solid)
        across, down = (x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy
        local = np.stack([across * depth, down * depth, depth], axis=1)
        places = camera.position + local @ camera.world_to_camera[:3, :3]
        parts = self._work.parts.tree.leaf_of(places.astype(np.float32))
        errors = np.bincount(parts, error[solid], len(self._parts))
        pixels = np.bincount(parts, minlength=len(self._parts))
        for part in np.flatnonzero(pixels).tolist():
            before = self._blame[number].get(part, (0.0, 0))
            self._blame[number][part] = before[0] + float(errors[part]), before[1] + int(pixels[part])
