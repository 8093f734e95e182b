"""bench batch: many scenes, one job each: worker processes and Ray against the plain loop, and workers that are killed.

A job embeds a small scene and recolours the thing in it. What a job costs besides its own seconds is told by jobs that
do hardly anything.
"""

from __future__ import annotations

import importlib.util
import json
import os
import random
import signal
import subprocess
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..agent.batch.engines import Engine, Here, OnRay, Processes
from ..agent.batch.jobs import Job
from ..agent.batch.running import Totals, run_batch
from ..gaussians.assets import make
from ..gaussians.files import save
from ..gaussians.scene import Scene
from .harness import Metric, Point, Result

SCENES, QUICK_SCENES = 100, 6
KINDS = ("armchair", "guitar", "potted plant", "desk lamp", "bicycle")
WORKERS = 2
KILLS, QUICK_KILLS = 20, 2
SPEED_UP, OVERHEAD = 1.7, 0.1  # goals; seconds a job


def run(quick: bool) -> Result:
    """The same jobs by each engine that is here."""
    count = QUICK_SCENES if quick else SCENES
    metrics, points, notes = list[Metric](), list[Point](), list[str]()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        scenes = _scenes(folder, count)
        edits = [_edit(path) for path in scenes]
        looks = [Job(id=path.stem, run=("info", str(path), "--json")) for path in scenes]
        clock = dict[str, float]()
        for name, engine in _engines(notes):
            done = run_batch(edits, folder / name, engine())
            small = run_batch(looks, folder / f"{name}-small", engine())
            clock[name] = done.seconds
            workers = 1 if name == "loop" else WORKERS
            metrics += [
                Metric(f"{name}.done", _share(done), "share", "higher", 0.0, 1.0),
                Metric(f"{name}.seconds", done.seconds, "s"),
                Metric(f"{name}.overhead", _overhead(small, workers), "s", "lower", 0.3, OVERHEAD),
            ]
            if name != "loop":
                metrics.append(Metric(f"{name}.over_loop", clock["loop"] / done.seconds, "x", "higher", 0.1, SPEED_UP))
            points.append(Point(name, f"{count} scenes", done.seconds, _share(done), 0, name == "processes"))
        metrics += _killed(edits, folder / "killed", QUICK_KILLS if quick else KILLS)
    return Result(
        title="batches: many scenes, one job each",
        accuracy="share of jobs done",
        metrics=tuple(metrics),
        points=tuple(points),
        notes=(
            f"{count} scenes of one thing; a job embeds one and recolours the thing. {WORKERS} workers, each with its "
            "share of the cores; the loop has all cores. Starting workers counts.",
            "overhead: seconds of the workers besides those of jobs that print what a scene holds, for each job.",
            *notes,
        ),
        seeds=(0,),
    )


def _scenes(folder: Path, count: int) -> list[Path]:
    paths = []
    for i in range(count):
        path = folder / f"scene-{i:03d}.ply"
        save(Scene(make(KINDS[i % len(KINDS)], i).cloud), path)
        paths.append(path)
    return paths


def _edit(path: Path) -> Job:
    words = ("edit", str(path), "make everything red", "-o", "{out}/red.ply", "--json")
    return Job(id=path.stem, run=words)


def _engines(notes: list[str]) -> Iterator[tuple[str, Callable[[], Engine]]]:
    """Each engine by name; what is missing is noted."""
    yield "loop", Here
    yield "processes", lambda: Processes(WORKERS)
    if importlib.util.find_spec("ray") is None:
        notes.append("Ray was not measured: the package ray is not installed.")
        return
    yield "ray", lambda: OnRay("local", WORKERS)


def _share(totals: Totals) -> float:
    return totals.done / totals.jobs


def _overhead(totals: Totals, workers: int) -> float:
    own = sum(float(receipt["seconds"]) for receipt in totals.receipts)
    return max(0.0, totals.seconds * workers - own) / totals.jobs


def _killed(jobs: list[Job], out: Path, kills: int) -> list[Metric]:
    """Workers that are killed at random moments: every job has one receipt and one result."""
    with _killing(kills) as killed:
        run_batch(jobs, out, Processes(WORKERS))
    done = [json.loads(line) for line in (out / "receipts.jsonl").read_text(encoding="utf-8").splitlines()]
    once = Counter(receipt["id"] for receipt in done if receipt["code"] == 0)
    right = sum(once[job.id] == 1 and (out / job.id / "red.ply").is_file() for job in jobs)
    return [
        Metric("killed.workers", killed[0], "count"),
        Metric("killed.done_once", right / len(jobs), "share", "higher", 0.0, 1.0),
    ]


@contextmanager
def _killing(kills: int) -> Iterator[list[int]]:
    """Kills a worker of this process now and then; how many were, is in the list afterwards."""
    killed, ended, chance = [0], threading.Event(), random.Random(0)

    def kill() -> None:
        while killed[0] < kills and not ended.wait(chance.uniform(0.5, 4.0)):
            workers = _workers()
            if workers:
                os.kill(chance.choice(workers), signal.SIGKILL)
                killed[0] += 1

    thread = threading.Thread(target=kill, daemon=True)
    thread.start()
    try:
        yield killed
    finally:
        ended.set()
        thread.join()


def _workers() -> list[int]:
    """Processes that this one started as workers of a batch."""
    told = subprocess.run(
        ["ps", "-o", "pid=,args=", "--ppid", str(os.getpid())], capture_output=True, text=True, check=False
    ).stdout
    return [int(line.split()[0]) for line in told.splitlines() if "batch.worker" in line]
