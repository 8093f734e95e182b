"""Multi-view lifting in the chart: the same cameras and masks, lifted alone or as input of the default embedding.

Lifted alone, a Gaussian belongs to the track with most of its weight, and surfaces have no influence; "guiding", the
masks go through `embed`. Names are compared with renders of the groups either way, so that only the groups differ.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

import numpy as np

from ...gaussians.camera import Camera
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.field.embed import embed
from ...gaussians.language.field.group_table import with_table
from ...gaussians.language.masks import ViewMasks
from ...gaussians.language.masks.lifting import lift
from ...gaussians.language.masks.sources.embedded import of_view
from ...gaussians.language.segmentation.segment import Segment
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.coverage import Views
from ..harness import Metric, Point
from . import pictures
from .association import INSIDE, associate
from .cases import Case, Part
from .stability import names_miou

Draw = Callable[[Case, Camera, int], ViewMasks]
VIEWS, SIZE = 24, 256  # pictures and pixels a side, where these are not what is varied
MANY_VIEWS, SIZES = (4, 8, 16, 24, 64), (128, 256, 512)
DROPPED = (0.2, 0.5, 0.8)


@dataclass(frozen=True)
class Given:
    """Masks that are there already, as a source of masks."""

    views: tuple[ViewMasks, ...]

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`."""
        yield from self.views


def patches(case: Case, eye: Camera, index: int) -> ViewMasks:
    """What the embedded source sees in one rendered view."""
    return of_view(render(case.scene.cloud, eye), eye)


def true_masks(case: Case, eye: Camera, index: int) -> ViewMasks:
    """The true objects with shaky outlines, and no names: what lifting does with masks that are right."""
    return pictures.true_masks(case, eye, pictures.nothing_said, index).masks


def alone(case: Case, views: Sequence[ViewMasks], encoder: Encoder) -> Scene:
    """The field of lifted tracks and nothing else."""
    tracks = associate(lift(case.scene.cloud, views))
    things = [k for k, track in enumerate(tracks.tracks) if track.parent < 0]
    share = np.asarray(tracks.share[:, things].todense())
    held = share.max(axis=1, initial=0.0) > INSIDE
    column = np.where(held, share.argmax(axis=1), -1) if things else np.full(len(case.ids), -1)
    rows = np.arange(len(column))
    unseen = Views((), rows, np.zeros((0, len(rows)), bool), 0.0)
    table = [Segment((), "object") for _ in things]
    return with_table(case.scene, table, column.astype(np.int32), held, unseen, encoder)


def guiding(case: Case, views: Sequence[ViewMasks], encoder: Encoder) -> Scene:
    """The field that users get who have these masks."""
    return embed(case.scene, encoder, masks=Given(tuple(views)))


def made(case: Case, eyes: Sequence[Camera], draw: Draw, how: Callable[..., Scene], encoder: Encoder) -> Case:
    """The case with its field, and the seconds of the processor that pictures, masks and all else took."""
    start = time.process_time()
    views = [draw(case, eye, i) for i, eye in enumerate(eyes)]
    scene = how(case, views, encoder)
    return replace(case, scene=scene, seconds=time.process_time() - start)


def points(rooms: Sequence[Case], encoder: Encoder) -> Part:
    """Views and resolutions for both kinds of masks lifted alone; the default number of both guiding."""
    settings = [(n, SIZE) for n in MANY_VIEWS] + [(VIEWS, side) for side in SIZES if side != SIZE]
    eyes = [pictures.eyes(room.scene, max(n for n, _ in settings), SIZE) for room in rooms]

    def point(method: str, draw: Draw, how: Callable[..., Scene], count: int, side: int, setting: str) -> Point:
        known = [
            made(room, [e.resized(side, side) for e in own[:count]], draw, how, encoder)
            for room, own in zip(rooms, eyes, strict=True)
        ]
        miou = fmean(v for case in known for v in names_miou(case, encoder))
        size = fmean(case.field_bytes for case in known)
        return Point(method, setting, fmean(case.seconds for case in known), miou, int(size))

    found = []
    for name, draw in (("true masks", true_masks), ("patches", patches)):
        for count, side in settings:
            varied = f"{count} views" if side == SIZE else f"{side} px"
            method = f"{name}, lifted" if side == SIZE else f"{name}, lifted, {VIEWS} views"
            found.append(point(method, draw, alone, count, side, varied))
        found.append(point("masks guide the default", draw, guiding, VIEWS, SIZE, name))
    note = (
        "lifted: groups from masks of rendered views alone; renders of each group (portraits) give its name. True "
        f"masks are those of the objects, with noise of {pictures.SHAKE:.1%} of the picture on their outlines. "
        f"Patches are the masks of the embedded source. {VIEWS} views of {SIZE} x {SIZE} unless stated"
    )
    return Part(points=tuple(found), notes=(note,))


def fewer_views(rooms: Sequence[Case], encoder: Encoder) -> Part:
    """True masks of 24 views, of which a share is dropped at random: lifted alone and guiding."""
    metrics = []
    eyes = [pictures.eyes(room.scene, VIEWS, SIZE) for room in rooms]
    for share in (0.0, *DROPPED):
        for way, how in (("lifted", alone), ("guiding", guiding)):
            if way == "guiding" and share not in (0.0, DROPPED[-1]):
                continue
            found = []
            for room, own in zip(rooms, eyes, strict=True):
                left = np.random.default_rng(room.seed).permutation(VIEWS)[round(share * VIEWS) :]
                known = made(room, [own[i] for i in sorted(left.tolist())], true_masks, how, encoder)
                found += names_miou(known, encoder)
            metrics.append(Metric(f"views.{way}.without_{share:.0%}.miou", fmean(found), "IoU", "higher", 0.05))
    return Part(tuple(metrics), notes=(f"views: a random share of {VIEWS} pictures with true masks is dropped",))
