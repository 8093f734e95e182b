"""bench start: commands that start cold, each in a process of its own, on a furnished room with a saved language field.

They run in turns, and of each the least is kept: what else the machine does only adds. The number of modules does not
depend on the machine.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..gaussians.assets import furnish
from ..gaussians.errors import BackendError
from ..gaussians.files import load, save
from ..gaussians.language import encoders
from ..gaussians.language.field.embed import embed
from ..gaussians.language.field.store import save_field
from .harness import Metric, Result

SEED = 3  # of a room of 122,000 Gaussians, with a fridge in it
RUNS, QUICK_RUNS = 5, 2
GOALS = {"select": 1.5, "edit": 2.0, "help": 0.5}  # seconds
_COUNTED = """
import sys
from scenewright.agent import cli
try:
    cli.main(sys.argv[1:])
except SystemExit:
    print(len(sys.modules))
"""


@dataclass(frozen=True)
class Cost:
    """Of one process: seconds by the clock, and of the processor."""

    elapsed: float
    processor: float


def run(quick: bool) -> Result:
    """Each command several times."""
    with tempfile.TemporaryDirectory() as place:
        room = Path(place) / "room.ply"
        save(furnish(SEED).scene, room)
        save_field(embed(load(room), encoders.load()), room)
        commands = _commands(room)
        least = measured(commands, QUICK_RUNS if quick else RUNS)
        modules = {name: _modules(command) for name, command in commands.items()}
    metrics = list[Metric]()
    for name, cost in least.items():
        metrics += [
            Metric(f"{name}.elapsed", cost.elapsed, "s", "lower", 0.2, GOALS.get(name)),
            Metric(f"{name}.processor", cost.processor, "s", "lower", 0.2),
            Metric(f"{name}.modules", modules[name], "count", "lower", 0.05),
        ]
    return Result(
        title="commands that start cold on a scene with a saved language field",
        accuracy="",
        metrics=tuple(metrics),
        points=(),
        notes=(
            "Of each command the least of its runs, which take turns. Elapsed times hold only where a core is idle; "
            "seconds of the processor grow by a sixth where both cores are busy.",
            "Files lie in the cache of the system, kernels and tables of the grammar in the user's.",
        ),
        seeds=(SEED,),
    )


def _commands(room: Path) -> dict[str, list[str]]:
    scene, out = str(room), str(room.with_name("out.ply"))
    return {
        "help": ["--help"],
        "info": ["info", scene],
        "plan": ["plan", "recolor the fridge teal"],
        "select": ["select", scene, "the blue fridge"],
        "ask": ["ask", scene, "how many chairs are there?"],
        "describe": ["describe", scene],
        "edit": ["edit", scene, "recolor the fridge teal", "-o", out, "--force"],
    }


def measured(commands: Mapping[str, Sequence[str]], runs: int) -> dict[str, Cost]:
    """The least cost of each command line; one more run before these fills the caches.

    Raises:
        BackendError: a command fails.
    """
    least = dict[str, Cost]()
    for turn in range(runs + 1):
        for name, command in commands.items():
            cost, before = _timed(command), least.get(name)
            if turn == 1 or before is None:
                least[name] = cost
            else:
                least[name] = Cost(min(cost.elapsed, before.elapsed), min(cost.processor, before.processor))
    return least


def _timed(command: Sequence[str]) -> Cost:
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    _done([sys.executable, "-m", "scenewright", *command])
    elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Cost(elapsed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def _modules(command: Sequence[str]) -> int:
    """How many modules a command line loads."""
    return int(_done([sys.executable, "-c", _COUNTED, *command]).splitlines()[-1])


def _done(command: Sequence[str]) -> str:
    """What a process prints. Raises BackendError if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "COLUMNS": "100"})
    if done.returncode:
        raise BackendError(f"{' '.join(command[3:])} ended with {done.returncode}: {done.stderr.strip()[-300:]}")
    return done.stdout
