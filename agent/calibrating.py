"""`scenewright bench calibrate`: how fast this machine is at each method of the dial, from one small job of each.

Each job is the same on every machine, from seeds and without files or a network. Its seconds divided by those of the
reference machine (`probes` of `points.json`) scale all predictions of the method. Accuracies are not measured again:
the same settings give the same accuracy on every machine.
"""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from datetime import date
from functools import cache
from typing import TYPE_CHECKING

from ..gaussians.assets import Room, furnish
from ..gaussians.effort import points
from ..gaussians.effort.user_file import Calibration
from ..gaussians.scene import Scene

if TYPE_CHECKING:
    from ..gaussians.fit import Photos

SEED, DETAIL = 7, 0.2  # of the furnished room
LONGEST = 240.0  # seconds after which no further job begins; the last one takes well under a minute
LOW, HIGH = 0.02, 50.0  # factors beyond which a measurement is taken for a mistake
Clock = Callable[[], float]


def calibrated(say: Callable[[str, float], None] = lambda stage, share: None) -> tuple[Calibration, dict[str, float]]:
    """The calibration of this machine, and the seconds of each job. Methods that no time was left for are missing."""
    started, seconds = time.perf_counter(), dict[str, float]()
    for k, name in enumerate(PROBES):
        if time.perf_counter() - started > LONGEST:
            break
        say(f"measuring {name}", k / len(PROBES))
        seconds[name] = probed(name)
    say("measured", 1.0)
    reference = points.probes()
    factors = {name: min(max(took / reference[name], LOW), HIGH) for name, took in seconds.items()}
    machine = f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores"
    every = {m: factors[METHODS.get(m, m)] for m in points.methods() if METHODS.get(m, m) in factors}
    told = Calibration(every, machine, date.today().isoformat(), points.method("embed").revision)
    return told, seconds


def probed(name: str, clock: Clock = time.perf_counter) -> float:
    """Seconds of one job, the lesser of two runs: the first also compiles what is not compiled yet."""
    times = []
    for _ in range(2):
        work = PROBES[name]()
        started = clock()
        work()
        times.append(clock() - started)
    return min(times)


@cache
def _room() -> Room:
    return furnish(SEED, detail=DETAIL)


@cache
def _embedded() -> Scene:
    from ..gaussians.language import encoders
    from ..gaussians.language.field.embed import embed

    return embed(_room().scene, encoders.load())


def _embed() -> Callable[[], object]:
    from ..gaussians.language import encoders
    from ..gaussians.language.field.embed import embed

    encoder, scene = encoders.load(), _room().scene
    return lambda: embed(scene, encoder)


def _compose() -> Callable[[], object]:
    from ..planners.compose.compose import arranged
    from ..planners.compose.sampling import sample_brief

    briefs = [sample_brief(kind, 14, SEED) for kind in ("office", "bedroom", "restaurant")]
    return lambda: [arranged(brief, SEED, 1.0) for brief in briefs]


def _edit() -> Callable[[], object]:
    from ..tools.filling.fill import merged, patches_behind

    room = _room()
    thing = max(room.truth.objects, key=lambda o: int((room.truth.ids == o.id).sum()))
    gone = room.truth.ids == thing.id
    rest = room.scene.replace(cloud=room.scene.cloud[~gone])
    return lambda: merged(rest, patches_behind(rest, room.scene.cloud[gone]))


def _ask() -> Callable[[], object]:
    from ..gaussians.render import render
    from ..gaussians.viewpoints import for_groups

    scene = _embedded()
    assert scene.language is not None
    groups = [g.id for g in scene.language.objects()][:2]

    def look() -> None:
        for chosen in for_groups.choose(for_groups.Sights.of(scene), groups, 3):
            render(chosen.view.cut.apply(scene), chosen.view.camera)

    return look


def _slim() -> Callable[[], object]:
    from ..gaussians.slim import Settings, slim

    return lambda: slim(_room().scene, ".sog", Settings(size=128))


def _fit() -> Callable[[], object]:
    from ..gaussians.fit import Settings, fit

    photos = _photos()
    return lambda: fit(photos, Settings(steps=150, max_gaussians=10_000))


@cache
def _photos() -> Photos:
    import numpy as np

    from ..gaussians.camera import Camera
    from ..gaussians.files.captures.colmap import Points
    from ..gaussians.fit import Photos
    from ..gaussians.fit.train import Shot
    from ..gaussians.render import render

    scene, (width, depth, _) = _room().scene, _room().size
    turns = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    eyes = [(0.4 * width * np.cos(a), 0.4 * depth * np.sin(a), 1.5) for a in turns]
    cameras = [Camera.look_at(e, (0, 0, 0.6), (0, 0, 1), 200, 150, 70.0, f"{k:02d}") for k, e in enumerate(eyes)]
    shots = tuple(Shot(camera, render(scene.cloud, camera).to_uint8()) for camera in cameras)
    means = scene.cloud.means[::10].double().numpy()
    surveyed = Points(means, np.full(means.shape, 0.5))
    return Photos(tuple(s for k, s in enumerate(shots) if k % 8), shots[::8], surveyed, float(max(width, depth)))


PROBES: dict[str, Callable[[], Callable[[], object]]] = {
    "embed": _embed, "compose": _compose, "edit": _edit, "ask": _ask, "slim": _slim, "fit": _fit,
}  # fmt: skip
METHODS = {"embed a fit": "embed", "embed with photographs": "embed"}  # measured by the job of another
