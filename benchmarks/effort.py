"""bench effort: whether `--effort SECONDS` is kept within 15 %: five promises each of select, ask, fit and compose.

Each is a command that starts cold, and imports, reading and writing count. A promise counts if it is kept by the clock,
or if the receipt says that nothing that was measured fits. Run it on an idle machine.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from ..gaussians.assets import furnish
from ..gaussians.files import save
from ._data import folder, missing
from ._effort.promises import Promise, promised
from .harness import Metric, Result

SEED = 7001  # of the furnished room
PROMISES: Mapping[str, tuple[float, ...]] = {
    "select": (10, 20, 25, 35, 45),
    "ask": (5, 12, 15, 20, 30),
    "fit": (10, 15, 20, 30, 45),
    "compose": (1, 3, 4, 6, 10),
}
QUICK: Mapping[str, tuple[float, ...]] = {"ask": (5,), "compose": (3,)}
WISH = "a restaurant with eight tables for four, a bar, a piano and plants"
QUESTION, THING = "what is left of the sofa?", "the bicycle"
SCENE, CAPTURE, SCALE = "bonsai_room.ply", "captures/bonsai_room", "0.25"


def run(quick: bool) -> Result:
    """Every promise of every method whose data are here, after one run of each that compiles and reads files."""
    promises, notes = list[Promise](), list[str]()
    with tempfile.TemporaryDirectory() as place:
        commands = _commands(Path(place), quick)
        for method, seconds in (QUICK if quick else PROMISES).items():
            if method not in commands:
                notes.append(missing({"select": "scenes", "fit": "captures"}[method]))
                continue
            if not quick:
                promised(method, commands[method], seconds[0])
            promises += [promised(method, commands[method], asked) for asked in seconds]
    metrics = [m for p in promises for m in _metrics(p)] + _kept(promises)
    notes = [p.sentence() for p in promises] + notes
    notes.append("a promise is kept if the command took at most 15 % more by the clock, from its start to its end")
    return Result("promises of --effort SECONDS", "", tuple(metrics), (), tuple(notes), seeds=(SEED,))


def _commands(place: Path, quick: bool) -> dict[str, list[str]]:
    """Arguments of each verb; scenes without a language field, so that they are embedded first."""
    room = place / "room.ply"
    save(furnish(SEED, detail=0.3 if quick else 1.0).scene, room)
    found = {
        "ask": [str(room), QUESTION],
        "compose": [WISH, "-o", str(place / "graph.json"), "--force"],
    }
    scenes, capture = folder("scenes"), folder(CAPTURE)
    if scenes is not None and (scenes / SCENE).exists():
        found["select"] = [str(scenes / SCENE), THING]
    if capture is not None:
        found["fit"] = [str(capture), "-o", str(place / "fitted.ply"), "--scale", SCALE, "--force"]
    return found


def _metrics(promise: Promise) -> list[Metric]:
    key = f"{promise.method}.{promise.asked:g} s"
    found = [
        Metric(f"{key}.by the clock", promise.clock, "s"),
        Metric(f"{key}.of processors", promise.processor, "s"),
    ]
    if promise.predicted is not None:
        found.insert(0, Metric(f"{key}.predicted", promise.predicted, "s"))
    return found


def _kept(promises: list[Promise]) -> list[Metric]:
    """Of each method, promises that were kept or told as not fitting, and the worst overrun of those that fit."""
    found = []
    for method in dict.fromkeys(p.method for p in promises):
        own = [p for p in promises if p.method == method]
        kept = sum(p.kept or not p.fits for p in own)
        found.append(Metric(f"{method}.kept or told", kept, f"of {len(own)}", "higher", 0.0, len(own)))
        over = [p.clock / p.asked for p in own if p.fits]
        if over:
            found.append(Metric(f"{method}.taken by asked, at most", max(over), "x", "lower", 0.2, 1.15))
    return found
