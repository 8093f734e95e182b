"""Rows of masks that guide the embedding: fewer views, faults of the masks, cameras that are off, occluders."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...gaussians.camera import Camera
from ...gaussians.language.masks import ViewMasks
from ...gaussians.rotations import axis_rotation
from .._rows import Row
from .._select import faults, lifted, pictures
from .._select.cases import Case
from .ground import Ground
from .spoiling import screened

SIZE = 256  # pixels a side
ROOMS = 2
Spoil = Callable[[ViewMasks, np.random.Generator], ViewMasks]


@dataclass(frozen=True, eq=False)
class _Seen:
    """A room, and the true masks of its pictures."""

    room: Case
    views: tuple[pictures.Seen, ...]


def rows(ground: Ground) -> Iterator[Row]:
    """All of them; none in a quick run."""
    if ground.quick:
        return
    seen = [_Seen(room, tuple(_views(room))) for room in ground.rooms[:ROOMS]]
    n = sum(len(one.room.alone()) for one in seen)
    base = _measured(ground, seen, _as_they_are)
    steps: tuple[tuple[str, Sequence[tuple[str, Spoil]]], ...] = (
        ("masks.views_dropped", [(f"{s:.0%}", _dropping(s)) for s in (0.2, 0.5, 0.8)]),
        ("masks.cameras_off", [(f"{d:g} deg", _turning(d)) for d in (0.25, 0.5, 1.0, 2.0)]),
        ("masks.borders_off", [(f"{p:g} px", faults.border(p)) for p in (2, 4, 8)]),
        ("masks.split", [(f"{s:.0%}", faults.split(s)) for s in (0.2, 0.5)]),
        ("masks.merged", [(f"{s:.0%}", faults.merged(s)) for s in (0.15, 0.3)]),
        ("masks.missed", [(f"{s:.0%}", faults.missed(s)) for s in (0.3, 0.6)]),
        ("masks.in_layers", [("four layers", faults.layered)]),
    )
    for name, levels in steps:
        values = [(label, _measured(ground, seen, spoil)) for label, spoil in levels]
        yield ground.row(name, base, values, n=n)
    names = ground.encoder.vocabulary.names
    called = [replace(one, views=tuple(_called(one))) for one in seen]
    labelled = _measured(ground, called, _as_they_are)
    values = [(f"{s:.0%}", _measured(ground, called, faults.mislabelled(s, names))) for s in (0.2, 0.4)]
    yield ground.row("masks.mislabelled", labelled, values, n=n)
    hidden = [(f"{s:.0%} hidden", _occluded(ground, seen, s)) for s in (0.25, 0.5)]
    yield ground.row("masks.occluders", base, hidden, n=n)


def _views(room: Case) -> Iterator[pictures.Seen]:
    for i, eye in enumerate(pictures.eyes(room.scene, lifted.VIEWS, SIZE)):
        yield pictures.true_masks(room, eye, pictures.nothing_said, i)


def _called(one: _Seen) -> Iterator[pictures.Seen]:
    """The views with the names of their objects."""
    masks = faults.with_names(one.room, [v.masks for v in one.views], [v.objects for v in one.views])
    yield from (replace(view, masks=own) for view, own in zip(one.views, masks, strict=True))


def _measured(ground: Ground, seen: Sequence[_Seen], spoil: Spoil) -> float:
    cases = []
    for one in seen:
        views = [spoil(v.masks, np.random.default_rng([one.room.seed, i])) for i, v in enumerate(one.views)]
        views = [v for v in views if len(v)]
        cases.append(replace(one.room, scene=lifted.guiding(one.room, views, ground.encoder)))
    return ground.miou(cases)


def _as_they_are(view: ViewMasks, rng: np.random.Generator) -> ViewMasks:
    return view


def _dropping(share: float) -> Spoil:
    """Leaves a view out with a probability: it then holds no mask."""

    def spoil(view: ViewMasks, rng: np.random.Generator) -> ViewMasks:
        if rng.random() >= share:
            return view
        return replace(view, ids=np.full_like(view.ids, -1), labels=(), scores=np.zeros(0, np.float32))

    return spoil


def _turning(degrees: float) -> Spoil:
    """Turns the camera that a view is taken for, about a random axis: poses by structure from motion are off."""

    def spoil(view: ViewMasks, rng: np.random.Generator) -> ViewMasks:
        return replace(view, camera=_turned(view.camera, rng.standard_normal(3), degrees))

    return spoil


def _turned(camera: Camera, axis: np.ndarray, degrees: float) -> Camera:
    pose = camera.world_to_camera.copy()
    pose[:3] = axis_rotation(axis, degrees) @ pose[:3]
    return replace(camera, world_to_camera=pose)


def _occluded(ground: Ground, seen: Sequence[_Seen], share: float) -> float:
    """The masks of the clear rooms, where panels stand in the scene: a mask then lies on what hides its thing."""
    cases = []
    for one in seen:
        room = screened(one.room, share)
        views = []
        for i, eye in enumerate(v.masks.camera for v in one.views):
            views.append(pictures.true_masks(room, eye, pictures.nothing_said, i).masks)
        cases.append(replace(room, scene=lifted.guiding(room, views, ground.encoder)))
    return ground.miou(cases)
