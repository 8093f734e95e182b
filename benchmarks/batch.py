"""bench batch: many scenes, one job each: worker processes and Ray against the plain loop, and workers and the batch
itself that are killed.

A job embeds a small scene and recolours the thing in it. What a job costs besides its own seconds is told by jobs that
do hardly anything.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from ..agent.batch.engines import TRIES, Engine, Here, OnRay, Processes
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
PAUSES = 0.5, 4.0  # seconds from one kill to the next
SPEED, KILLED = PARTS = "speed", "killed"
_LOOK = 0.05
SPEED_UP, OVERHEAD = 1.7, 0.1  # goals; seconds a job


def run(quick: bool, parts: Sequence[str] = ()) -> Result:
    """The same jobs by each engine that is here."""
    count = QUICK_SCENES if quick else SCENES
    metrics, points, notes = list[Metric](), list[Point](), list[str]()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        scenes = _scenes(folder, count)
        edits = [_edit(path) for path in scenes]
        looks = [Job(id=path.stem, run=("info", str(path), "--json")) for path in scenes]
        clock = dict[str, float]()
        for name, engine in _engines(notes) if SPEED in (parts or PARTS) else ():
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
        if KILLED in (parts or PARTS):
            kills = QUICK_KILLS if quick else KILLS
            metrics += _killed("processes", edits, folder, kills)
            if _has_ray():
                metrics += _killed("ray", edits, folder, kills, "--ray", "local")
    return Result(
        title="batches: many scenes, one job each",
        accuracy="share of jobs done",
        metrics=tuple(metrics),
        points=tuple(points),
        notes=(
            f"{count} scenes of one thing; a job embeds one and recolours the thing. {WORKERS} workers, each with its "
            "share of the cores; the loop has all cores. Starting workers counts.",
            f"killed: {KILLS} workers, one each {PAUSES[0]} to {PAUSES[1]} s, and the batch itself when "
            "half of the jobs have their receipts; then the same command again.",
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
    if not _has_ray():
        notes.append("Ray was not measured: the package ray is not installed.")
        return
    yield "ray", lambda: OnRay("local", WORKERS)


def _has_ray() -> bool:
    return importlib.util.find_spec("ray") is not None


def _share(totals: Totals) -> float:
    return totals.done / totals.jobs


def _overhead(totals: Totals, workers: int) -> float:
    own = sum(float(receipt["seconds"]) for receipt in totals.receipts)
    return max(0.0, totals.seconds * workers - own) / totals.jobs


def _killed(name: str, jobs: list[Job], folder: Path, kills: int, *options: str) -> list[Metric]:
    """Workers that are killed at random moments, and the whole batch once, which the same command then ends: every job
    has one receipt and one result, and what had its receipt before keeps both."""
    file, out = folder / f"{name}.jsonl", folder / f"{name}-killed"
    file.write_text("".join(job.model_dump_json(include={"id", "run"}) + "\n" for job in jobs), encoding="utf-8")
    command = [sys.executable, "-m", "scenewright", "batch", str(file), "-o", str(out), "--json"]
    command += ["--workers", str(WORKERS), *options]
    killer = _Killer(kills, random.Random(0))
    head = killer.run(command, until=lambda: len(_receipts(out)) >= len(jobs) // 2)
    stopped = head.poll() is None
    head.kill()
    head.wait()
    before = _receipts(out)
    head = killer.run(command, until=lambda: False)
    told = json.loads(head.stdout.read()) if head.stdout else {}
    lines = (out / "receipts.jsonl").read_text(encoding="utf-8").splitlines()
    receipts = [json.loads(line) for line in lines]
    once = Counter(receipt["id"] for receipt in receipts if receipt["code"] == 0)
    given_up = sum(len(receipt.get("retries", ())) >= TRIES for receipt in receipts)
    right = sum(once[job.id] == 1 and (out / job.id / "red.ply").is_file() for job in jobs)
    after = _receipts(out)
    again = sum(after.get(path) != when for path, when in before.items())
    return [
        Metric(f"{name}.killed.workers", killer.killed, "count"),
        Metric(f"{name}.killed.batches", float(stopped), "count"),
        Metric(f"{name}.killed.done before", len(before), "count"),
        Metric(f"{name}.killed.done again", again + abs(told["kept"] - len(before)), "count", "lower", 0.0, 0.0),
        Metric(f"{name}.killed.given up", given_up, "count"),
        Metric(f"{name}.killed.done_once", right / len(jobs), "share", "higher", 0.0, 1.0),
    ]


def _receipts(out: Path) -> dict[Path, int]:
    """When each receipt was written."""
    return {path: path.stat().st_mtime_ns for path in (out / "receipts").glob("*.json")}


class _Killer:
    """Kills workers of batches now and then, a number in all."""

    def __init__(self, kills: int, chance: random.Random) -> None:
        self.killed, self._kills, self._chance = 0, kills, chance

    def run(self, command: list[str], until: Callable[[], bool]) -> subprocess.Popen[str]:
        """Start a batch and kill workers of it until it ends, or until something is so."""
        head = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True
        )
        due = time.monotonic() + self._pause()
        while head.poll() is None and not until():
            time.sleep(_LOOK)
            if self.killed < self._kills and time.monotonic() > due and (workers := _workers(head.pid)):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(self._chance.choice(workers), signal.SIGKILL)
                    self.killed += 1
                due = time.monotonic() + self._pause()
        return head

    def _pause(self) -> float:
        return self._chance.uniform(*PAUSES)


def _workers(head: int) -> list[int]:
    """Processes that do jobs of a batch: its own workers, or tasks of the Ray that it started."""
    told = [
        line.split(None, 1)
        for chosen in (["--ppid", str(head)], ["--sid", str(head)])
        for line in subprocess.run(
            ["ps", "-o", "pid=,args=", *chosen], capture_output=True, text=True, check=False
        ).stdout.splitlines()
    ]
    return sorted({int(pid) for pid, words in told if "batch.worker" in words or "ray::_work_in" in words})
