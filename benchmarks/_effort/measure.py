"""Measures what the points of the dial (`gaussians/effort/points.json`) say, one JSON row a setting and job.

Usage: python -m scenewright.benchmarks._effort.measure embed|captures|compose|edit|ask|slim|fit|probes
Set OMP_NUM_THREADS=1 and NUMBA_NUM_THREADS=1: seconds are of the processor, and then those of one core. The means over
the rows are written into `points.json` by hand, with the revision; `fixed` and `per` are fitted to seconds over sizes.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from statistics import fmean
from types import SimpleNamespace
from typing import Any, TypeVar

from ...gaussians.camera import Camera
from ...gaussians.files import load
from ...gaussians.files.captures.capture import read_capture
from ...gaussians.language import encoders
from ...gaussians.language.field.embed import embed
from ...gaussians.language.masks.sources import pictures
from ...tools.execute import carry_out
from ...tools.operation import Context
from ...tools.registry import parse
from .. import _data, _fits, _rooms, edit, fill, layout
from .._fill.rooms import deletions
from .._select import cases
from .._select.real.captures import reached
from .._select.real.settings import truth_of
from .._select.stability import names_miou

Row = dict[str, Any]
T = TypeVar("T")
ROOMS = (
    (7001, 1.0),
    (7002, 1.0),
    (7003, 1.0),
    (7004, 1.0),
    (7001, 0.3),
    (7002, 3.0),
)  # seeds, and factors on Gaussians
EFFORTS = (0.0, 0.2, 0.5, 1.0, 2.0, 4.0)
ALONE = 81_000  # Gaussians of the scene in which a deletion alone is timed
STEPS = (0, 300, 900)  # of the optimisation of slim
LENGTHS = (60.0, 300.0)  # s, of trainings


def embed_rows() -> Iterator[Row]:
    """Furnished rooms: the path without masks, with 1 to 4 portraits of a candidate."""
    encoder = encoders.load()
    for seed, detail in ROOMS:
        room = cases.furnished(seed, detail)
        for portraits in (1, 2, 3, 4):
            known, seconds = _timed(partial(cases.embedded, room, encoder, portraits))
            miou = fmean(names_miou(known, encoder))
            yield {
                "seed": seed,
                "size": len(room.scene.cloud),
                "portraits": portraits,
                "seconds": seconds,
                "miou": miou,
            }


def capture_rows() -> Iterator[Row]:
    """The fitted bonsai room: without masks, with masks of rendered pictures, and with those of photographs."""
    captures, scenes = _data.folder("captures"), _data.folder("scenes")
    if captures is None or scenes is None:
        return
    truth, encoder, scene = truth_of(captures, "bonsai_room"), encoders.load(), load(scenes / "bonsai_room.ply")
    taken = read_capture(truth.capture)
    scene = scene if scene.cameras else scene.replace(cameras=taken.cameras)
    for capture, count in ((None, 0), (None, 8), (None, 32), (taken, 8), (taken, 16), (taken, 32)):
        masks = replace(pictures.load(), capture=capture, count=count) if count else None
        made, seconds = _timed(partial(embed, scene, encoder, masks=masks))
        union = fmean(reached(truth, made, False)[0].values())
        yield {"photographs": capture is not None, "pictures": count, "seconds": seconds, "best_union": union}


def compose_rows() -> Iterator[Row]:
    """Composed rooms, and rooms whose relations are read from witnesses, at each effort of the solver."""
    problems = [*layout.composed(24), *_rooms.problems(16, layout.SEED + 500)]
    layout.judge(*problems[0])
    for effort in EFFORTS:
        for kind, problem in problems:
            one = layout.judge(kind, problem, effort)
            kept, asked = (a + b for a, b in zip(one.hard, one.soft, strict=True))
            yield {"effort": effort, "size": one.count, "seconds": one.seconds, "kept": kept, "asked": asked}


def edit_rows() -> Iterator[Row]:
    """Deletions: the pixels that the thing hid, deleted alone and filled."""
    for seed in (101, 102, 103):
        for case in deletions(seed, 4):
            if (one := fill.measured(case)) is not None:
                bare, filled = one.scores[0].psnr, one.scores[1].psnr
                yield {"size": len(case.before.cloud), "seconds": one.seconds, "bare": bare, "filled": filled}
    scene = edit.crowded(ALONE)
    viewer = Camera.look_at([3.2, -6, 3], [3.2, 3, 0.5], [0, 0, 1], 512, 384)
    context, op = Context(viewer, infill=False), parse(edit.EDITS["delete"])
    yield {"size": ALONE, "deleting": edit.best_of(partial(carry_out, scene, op, context), 4)[0]}


def ask_rows() -> Iterator[Row]:
    """Views that are chosen and rendered for questions, answered by the scripted stand-in for a vision model."""
    from .._ask import views

    with _ProcessorTime(views):
        for point in views.measure((7824, 7827), encoders.load(), 1.0, False).points:
            yield {"method": point.method, "setting": point.setting, "seconds": point.seconds, "right": point.accuracy}


def slim_rows() -> Iterator[Row]:
    """The guitar as SOG at 40 dB, optimised for some steps."""
    from ...gaussians.slim import Settings, prepare, slim
    from ...gaussians.slim.report import inria_bytes

    scenes = _data.folder("scenes")
    if scenes is None:
        return
    scene = load(scenes / "guitar.compressed.ply")
    ready, preparing = _timed(partial(prepare, scene))
    for steps in STEPS:
        done, seconds = _timed(partial(slim, scene, ".sog", Settings(steps=steps or None), (), None, ready))
        times = inria_bytes(scene.cloud) / len(done.data)
        size = len(scene.cloud) * len(ready.views.choice)
        yield {"steps": steps, "size": size, "seconds": seconds, "preparing": preparing, "times_smaller": times}


def fit_rows() -> Iterator[Row]:
    """Trainings on the bonsai capture; their length counts seconds of the processor too."""
    from ...gaussians.fit import Settings, fit, load_photos, train
    from ...gaussians.fit.fitting import megapixels

    place = _data.folder(_fits.CAPTURE)
    if place is None:
        return
    fit(_fits.small_photos(), Settings(steps=1))  # compiles the kernels
    photos = load_photos(place, _fits.SCALE)
    with _ProcessorTime(train):
        for length in LENGTHS:
            done, seconds = _timed(partial(fit, photos, Settings(seconds=length)))
            yield {"length": length, "size": megapixels(photos), "seconds": seconds, "steps": done.steps,
                   "psnr": done.quality.psnr}  # fmt: skip


def probe_rows() -> Iterator[Row]:
    """The jobs of `scenewright bench calibrate`."""
    from ...agent import calibrating

    for name in calibrating.PROBES:
        yield {"method": name, "seconds": calibrating.probed(name, time.process_time)}


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    start = time.process_time()
    done = work()
    return done, time.process_time() - start


class _ProcessorTime:
    """Lets a module that counts seconds by `time.perf_counter` count those of the processor."""

    def __init__(self, module: Any) -> None:
        self._module, self._time = module, module.time

    def __enter__(self) -> None:
        self._module.time = SimpleNamespace(perf_counter=time.process_time)

    def __exit__(self, *_: object) -> None:
        self._module.time = self._time


MEASURES = {
    "embed": embed_rows, "captures": capture_rows, "compose": compose_rows, "edit": edit_rows, "ask": ask_rows,
    "slim": slim_rows, "fit": fit_rows, "probes": probe_rows,
}  # fmt: skip

if __name__ == "__main__":
    for row in MEASURES[sys.argv[1]]():
        print(json.dumps(row), flush=True)
